#include "commands/commands.h"
namespace thimble::tools {
void add_accuracy(CLI::App&) {}
}  // namespace thimble::tools
