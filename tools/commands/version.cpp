// thimble --version
#include "output/version.h"

#include "commands/commands.h"
#include "host/window_kind.h"
#include "scene/wide_renderer.h"

namespace thimble::tools {

std::string version_text() {
  std::string sets;
  for (const std::string& name : WideRenderer::instruction_sets()) {
    sets += (sets.empty() ? "" : ", ") + name;
  }
  const char* const windows = host::window_kind();
  return std::string("thimble ") + version_number() + "\ncommit         " + version_commit() +
         "\nwide renderer  " +
         (sets.empty() ? "not in this build (-DTHIMBLE_WIDE=OFF): the core draws ray by ray"
                       : sets + " on this machine; the first is used") +
         "\nwindows        " +
         (windows == nullptr ? "not in this build (-DTHIMBLE_WINDOW=OFF): the terminal and files" : windows);
}

}  // namespace thimble::tools
