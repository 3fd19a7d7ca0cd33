/// The subcommands: one file each, and one line here.
#pragma once

#include "commands/arguments.h"

namespace thimble::tools {

// Each adds its subcommand with options, help and what it does when it is chosen.
void add_view_command(CLI::App& app);
void add_render(CLI::App& app);
void add_join(CLI::App& app);
void add_trace(CLI::App& app);
void add_table(CLI::App& app);
void add_bake(CLI::App& app);
void add_image(CLI::App& app);
void add_new(CLI::App& app);
void add_export(CLI::App& app);
void add_sheet(CLI::App& app);
void add_thumbnail(CLI::App& app);
void add_info(CLI::App& app);
void add_boards(CLI::App& app);
void add_memory(CLI::App& app);
void add_sim(CLI::App& app);
void add_particles(CLI::App& app);
void add_accuracy(CLI::App& app);
void add_effects(CLI::App& app);
// Not in the help: what shells and scripts ask for.
void add_complete(CLI::App& app);
void add_manual(CLI::App& app);
void add_uart_picture(CLI::App& app);

/// What `thimble --version` prints: version, commit, and what this build and this machine have.
std::string version_text();

inline void add_all_commands(CLI::App& app) {
  add_view_command(app);
  add_render(app);
  add_join(app);
  add_trace(app);
  add_table(app);
  add_bake(app);
  add_image(app);
  add_new(app);
  add_export(app);
  add_sheet(app);
  add_thumbnail(app);
  add_info(app);
  add_boards(app);
  add_memory(app);
  add_sim(app);
  add_particles(app);
  add_accuracy(app);
  add_effects(app);
  add_complete(app);
  add_manual(app);
  add_uart_picture(app);
}

}  // namespace thimble::tools
