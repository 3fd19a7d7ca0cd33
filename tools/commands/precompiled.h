// What most files of the commands include. Compiled once: each of them would read it again.
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "../precompiled.h"
