/// The `thimble` command.
#pragma once

namespace thimble::tools {

/// Chooses the subcommand and runs it. Every failure becomes one sentence on standard error and the status: 1 for input and
/// output that cannot be used, 2 for wrong usage.
int run_command_line(int argc, char** argv);

}  // namespace thimble::tools
