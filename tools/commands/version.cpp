// thimble --version
#include "output/version.h"

#include "commands/commands.h"
#include "host/screen.h"
#include "output/units.h"
#include "scene/gpu_engine.h"
#include "scene/wide_renderer.h"

namespace thimble::tools {

std::string version_text() {
  const std::string sets = joined(WideRenderer::instruction_sets(), ", ");
  const std::string gpus = joined(GpuEngine::devices(), ", ");
  const char* const no_gpu = GpuEngine::is_in_build()
                                 ? "none: there is no Vulkan loader or device"
                                 : "not in this build (-DTHIMBLE_GPU=OFF): the processor draws";
  const char* const windows = host::window_kind();
  return std::string("thimble ") + kVersionNumber + "\ncommit         " + kVersionCommit +
         "\nwide renderer  " +
         (sets.empty() ? "not in this build (-DTHIMBLE_WIDE=OFF): the core draws ray by ray"
                       : sets + " on this machine; the first is used") +
         "\nGPU            " + (gpus.empty() ? no_gpu : gpus) + "\nwindows        " +
         (windows == nullptr ? "not in this build (-DTHIMBLE_WINDOW=OFF): the terminal and files" : windows);
}

}  // namespace thimble::tools
