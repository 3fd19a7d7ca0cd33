#include "support/gpu_kernels.h"

#include "gpu/kernel/cpp.h"

namespace thimble::tests {
namespace {

using namespace gpu::kernel;

// Each kernel is a class, whose members the text's functions become.
#define FN
#define OUT(T) T&
#define P(i) buffers.parameters[static_cast<std::size_t>(i)]
#define S(i) buffers.scene_word(i)
#define R(i) buffers.output_word(i)
#define STORE(i, v) buffers.store(i, v)
// What follows uses what stands before.
// clang-format off
struct OctreeKernel {
  const Buffers& buffers;
#include "gpu/kernel/numbers.inc"
#include "gpu/kernel/picture.inc"
#include "gpu/kernel/octree.inc"
#include "gpu/kernel/invocation.inc"
};
#undef State
#define PAIRS
struct OctreePairsKernel {
  const Buffers& buffers;
#include "gpu/kernel/numbers.inc"
#include "gpu/kernel/picture.inc"
#include "gpu/kernel/octree.inc"
#include "gpu/kernel/invocation.inc"
};
// clang-format on

template <class Kernel>
void run_all(const Buffers& buffers) {
  Kernel kernel{buffers};
  for (uint y = 0; y < buffers.parameters[kHeight]; ++y) {
    for (uint x = 0; x < buffers.parameters[kWidth]; ++x) {
      kernel.invocation(x, y);
    }
  }
}

bool takes_pairs(const gpu::SceneWords& scene, const Vec3i& largest, Pairs pairs) {
  return pairs == Pairs::kAlways || gpu::needs_pairs(scene.level, largest);
}

}  // namespace

KernelRun run_kernel(const gpu::SceneWords& scene, const gpu::Parameters& parameters, bool pairs,
                     std::vector<std::uint32_t> output) {
  KernelRun run;
  run.output = std::move(output);
  const Buffers buffers{parameters, scene.words, run.output};
  pairs ? run_all<OctreePairsKernel>(buffers) : run_all<OctreeKernel>(buffers);
  run.outside = buffers.outside;
  return run;
}

std::vector<std::uint8_t> draw_by_kernel(const gpu::SceneWords& scene, const Camera& camera,
                                         const Shading& shading, const Band& band, Pairs pairs,
                                         std::uint64_t* outside) {
  gpu::SceneWords colored = scene;
  gpu::set_palette(shading.palette, colored.words.data());
  const std::int32_t width = camera.width_px();
  const Camera part = camera.window(0, band.first_row, width, band.rows);
  gpu::Parameters parameters = scene.parameters;
  gpu::set_frame(part, shading, &parameters);
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(band.rows);
  const KernelRun run =
      run_kernel(colored, parameters, takes_pairs(scene, gpu::largest_direction(part), pairs),
                 std::vector<std::uint32_t>(pixels));
  if (outside != nullptr) {
    *outside += run.outside;
  }
  const std::size_t line = row_bytes(band.format, width);
  const std::size_t stride = band.stride_bytes == 0 ? line : band.stride_bytes;
  std::vector<std::uint8_t> bytes(band.rows == 0 ? 0
                                                 : stride * static_cast<std::size_t>(band.rows - 1) + line);
  std::size_t at = 0;
  for (std::int32_t y = 0; y < band.rows; ++y) {
    for (std::int32_t x = 0; x < width; ++x) {
      const std::uint32_t pixel = run.output[at++];
      store_pixel(bytes.data() + stride * static_cast<std::size_t>(y), x, band.first_row + y, band.format,
                  {static_cast<std::uint8_t>(pixel), static_cast<std::uint8_t>(pixel >> 8),
                   static_cast<std::uint8_t>(pixel >> 16)});
    }
  }
  return bytes;
}

std::vector<Hit> trace_by_kernel(const gpu::SceneWords& scene, Span<const Ray> rays, Pairs pairs,
                                 std::uint64_t* outside) {
  std::vector<std::uint32_t> records(kRecordWords * rays.size);
  for (std::size_t i = 0; i < rays.size; ++i) {
    gpu::set_record(rays[i], records.data() + kRecordWords * i);
  }
  gpu::Parameters parameters = scene.parameters;
  gpu::set_rays(static_cast<std::uint32_t>(rays.size), 64, &parameters);
  const KernelRun run = run_kernel(scene, parameters, takes_pairs(scene, gpu::largest_direction(rays), pairs),
                                   std::move(records));
  if (outside != nullptr) {
    *outside += run.outside;
  }
  std::vector<Hit> hits;
  for (std::size_t i = 0; i < rays.size; ++i) {
    hits.push_back(gpu::hit_of_record(run.output.data() + kRecordWords * i));
  }
  return hits;
}

}  // namespace thimble::tests
