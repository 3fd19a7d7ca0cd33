/// The GPU's kernels, compiled as C++: the same text, run pixel by pixel without a GPU.
#pragma once

#include <cstdint>
#include <vector>

#include "gpu/scene_words.h"
#include "support/lit_cases.h"
#include "thimble/picture/render.h"

namespace thimble::tests {

enum class Pairs : std::uint8_t {
  kAsNeeded,  ///< where words of 32 bits do not do
  kAlways,
};

struct KernelRun {
  std::vector<std::uint32_t> output;
  std::uint64_t outside = 0;  ///< reads and writes beyond the buffers
};

/// The words that a frame's, or a list's, kernel writes.
KernelRun run_kernel(const gpu::SceneWords& scene, const gpu::Parameters& parameters, bool pairs,
                     std::vector<std::uint32_t> output);

/// A page's picture, of the width and height that are the first parameters of finish.inc, from samples.
KernelRun finish_by_kernel(const std::vector<std::uint32_t>& parameters,
                           const std::vector<std::uint32_t>& samples);

/// `band` as `render_band` draws it; rows may share bytes in no format. `outside` (may be null) is added to.
std::vector<std::uint8_t> draw_by_kernel(const gpu::SceneWords& scene, const Camera& camera,
                                         const Shading& shading, const Band& band, Pairs pairs,
                                         std::uint64_t* outside);
/// The same as `render_lit_band`, with the rays and hits of each kind, and the light behind.
LitDrawn draw_lit_by_kernel(const gpu::SceneWords& scene, const FrameCase& frame, const LitCase& lit,
                            const gpu::Backdrop* backdrop, std::vector<std::uint8_t>* shares, Pairs pairs,
                            std::uint64_t* outside);
/// As `closest_hit`, but for the visits.
std::vector<Hit> trace_by_kernel(const gpu::SceneWords& scene, Span<const Ray> rays, Pairs pairs,
                                 std::uint64_t* outside);

}  // namespace thimble::tests
