#include "support/gpu_kernels.h"

#include <cstring>

#include "support/glsl.h"
#include "thimble/light/host/asked.h"

namespace thimble::tests {
namespace {

using namespace gpu::kernel;

// Each kernel is a class, whose members the text's functions become.
#define FN
#define OUT(T) T&
#define INOUT(T) T&
#define P(i) buffers.parameters[static_cast<std::size_t>(i)]
#define S(i) buffers.scene_word(i)
#define R(i) buffers.output_word(i)
#define STORE(i, v) buffers.store(i, v)
// What follows uses what stands before.
// clang-format off
struct OctreeKernel {
  explicit OctreeKernel(const Buffers& to) : buffers(to) {}
  const Buffers& buffers;
#include "gpu/kernel/numbers.inc"
#include "gpu/kernel/picture.inc"
#include "gpu/kernel/octree.inc"
#include "gpu/kernel/invocation.inc"
#include "gpu/kernel/optics.inc"
#include "gpu/kernel/slope.inc"
#include "gpu/kernel/light.inc"
};
#undef State
#define PAIRS
struct OctreePairsKernel {
  explicit OctreePairsKernel(const Buffers& to) : buffers(to) {}
  const Buffers& buffers;
#include "gpu/kernel/numbers.inc"
#include "gpu/kernel/picture.inc"
#include "gpu/kernel/octree.inc"
#include "gpu/kernel/invocation.inc"
#include "gpu/kernel/optics.inc"
#include "gpu/kernel/slope.inc"
#include "gpu/kernel/light.inc"
};
struct FinishKernel {
  explicit FinishKernel(const Buffers& to) : buffers(to) {}
  const Buffers& buffers;
#include "gpu/kernel/finish.inc"
};
// clang-format on

template <class Kernel>
void run_all(const Buffers& buffers) {
  Kernel kernel(buffers);
  for (uint y = 0; y < buffers.parameters[kHeight]; ++y) {
    for (uint x = 0; x < buffers.parameters[kWidth]; ++x) {
      buffers.parameters[kMode] == kModeLit ? kernel.lit_invocation(x, y) : kernel.invocation(x, y);
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
  const Buffers buffers{parameters.words, scene.words, run.output};
  pairs ? run_all<OctreePairsKernel>(buffers) : run_all<OctreeKernel>(buffers);
  run.outside = buffers.outside;
  return run;
}

KernelRun finish_by_kernel(const std::vector<std::uint32_t>& parameters,
                           const std::vector<std::uint32_t>& samples) {
  KernelRun run;
  run.output.resize(std::size_t{parameters[0]} * parameters[1]);
  const Buffers buffers{parameters, samples, run.output};
  FinishKernel kernel(buffers);
  for (uint y = 0; y < parameters[1]; ++y) {
    for (uint x = 0; x < parameters[0]; ++x) {
      kernel.finish_invocation(x, y);
    }
  }
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

LitDrawn draw_lit_by_kernel(const gpu::SceneWords& scene, const FrameCase& frame, const LitCase& lit,
                            const gpu::Backdrop* backdrop, std::vector<std::uint8_t>* shares, Pairs pairs,
                            std::uint64_t* outside) {
  const Band& band = frame.band;
  const std::int32_t width = frame.camera.width_px();
  const Camera part = frame.camera.window(0, band.first_row, width, band.rows);
  gpu::Parameters parameters = scene.parameters;
  gpu::set_frame(part, frame.shading, &parameters);
  const gpu::LitFrame light{lit.effects, part, frame.shading, lit.scene, backdrop};
  gpu::set_light(light, &parameters);
  parameters[kWantSteps] = 1;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(band.rows);
  const KernelRun run =
      run_kernel(scene, parameters, takes_pairs(scene, gpu::largest_direction(light), pairs),
                 std::vector<std::uint32_t>(kLitWords * pixels));
  *outside += run.outside;
  LitDrawn drawn{std::vector<std::uint8_t>(band_size(frame), 0xA5), {}};
  const CompactTree none;
  const lit::Frame to{none, frame.camera, frame.shading, lit.scene, lit.options, lit.effects};
  const std::size_t line = row_bytes(band.format, width);
  const std::size_t stride = band.stride_bytes == 0 ? line : band.stride_bytes;
  const std::uint32_t* from = run.output.data();
  for (std::int32_t y = 0; y < band.rows; ++y) {
    std::uint8_t* const row = drawn.pixels.data() + stride * static_cast<std::size_t>(y);
    std::memset(row, 0, line);
    for (std::int32_t x = 0; x < width; ++x, from += kLitWords) {
      lit::store(to, band, row, x, band.first_row + y, {{from[0] & 65535U, from[0] >> 16, from[1] & 65535U}});
      shares->push_back(static_cast<std::uint8_t>(from[1] >> 24));
      for (int kind = 0; kind < kCountedRays; ++kind) {
        drawn.counts.rays[kind] += from[3 + kind] & 65535U;
        drawn.counts.hits[kind] += from[3 + kind] >> 16;
      }
    }
  }
  return drawn;
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
