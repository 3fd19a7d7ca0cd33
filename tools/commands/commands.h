/// The subcommands: one file each, which includes this and with it what all are made of, and its name here.
#pragma once

#include "commands/stats.h"

namespace thimble::tools {

/// Adds its subcommand with options, help and what it does when it is chosen.
using AddCommand = void(CLI::App& app);
AddCommand add_view_command, add_render, add_join, add_trace, add_table, add_bake, add_image, add_new,
    add_export, add_sheet, add_thumbnail, add_info, add_boards, add_memory, add_sim, add_particles,
    add_accuracy, add_effects;
// Not in the help: what shells and scripts ask for.
AddCommand add_complete, add_manual, add_uart_picture;

inline void add_all_commands(CLI::App& app) {
  for (AddCommand* const add :
       {add_view_command, add_render, add_join,        add_trace,     add_table,     add_bake,
        add_image,        add_new,    add_export,      add_sheet,     add_thumbnail, add_info,
        add_boards,       add_memory, add_sim,         add_particles, add_accuracy,  add_effects,
        add_complete,     add_manual, add_uart_picture}) {
    add(app);
  }
}

}  // namespace thimble::tools
