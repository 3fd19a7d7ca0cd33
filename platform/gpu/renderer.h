/// The core's picture by a GPU: every pixel is a thread that traces its ray exactly, in integers of 32 bits, so it is
/// the same picture, byte for byte, and the same hits. Vulkan 1.1; it needs no 64-bit integers and no floats of the
/// device.
///
/// What it draws: depth, normal, colour and mono of both cameras, one ray a pixel; lit pictures with the effects
/// `kEffectsInKernels`; and lists of rays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "gpu/scene_words.h"
#include "thimble/light/render.h"
#include "thimble/picture/render.h"

namespace thimble::gpu {

/// What went wrong, as a sentence without its full stop.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct DeviceInfo {
  std::string name;
  bool is_software = false;  ///< it runs on the processor
};

/// The devices that there are, the one that is used first; empty also where there is no Vulkan loader.
std::vector<DeviceInfo> devices();

struct Options {
  int frames = 1;  ///< that may be under way at a time, 1 or more
};

/// What became of a frame.
struct Frame {
  const std::uint32_t* pixels = nullptr;  ///< 0x00BBGGRR, row by row; null when it was not read back
  double seconds = 0;                     ///< of the kernel, by the device's own clock; 0: it has none
};

/// A scene on the device. Not for several threads at a time.
class Renderer {
 public:
  /// Copies the scene to the best device. Throws DeviceError: there is none, or the scene is larger than its memory or
  /// than what a kernel may see.
  Renderer(const CompactTree& tree, Span<const Rgb8> palette, const Options& options);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  const DeviceInfo& device() const;
  std::size_t scene_bytes() const;

  /// Most rows of a band for `draw` and `draw_lit`, of pictures of that width.
  static std::int32_t most_rows(std::int32_t width_px);
  /// As `render_band`, but `node_visits` are steps of the kernel, and formats whose rows share bytes are a
  /// kBadArgument. The palette is that of the constructor. Throws DeviceError.
  Status draw(const Camera& camera, const Shading& shading, const Band& band, RenderCounts* counts = nullptr);
  /// As `render_lit_band`, with the same exceptions, and the surfaces are those of the frame. With a backdrop `shares`
  /// gets a byte a pixel. kBadArgument for effects that are not in `kEffectsInKernels`. All visits are counted as those
  /// of primary rays.
  Status draw_lit(const LitFrame& frame, const Band& band, Bytes shares = {}, LitCounts* counts = nullptr);
  /// Single pixels of such a picture: x | y << 16 each, in whose place comes 0x00BBGGRR, with the share on top.
  Status draw_places(const LitFrame& frame, Span<std::uint32_t> places);
  /// As `closest_hit` for each ray; `visits` are steps of the kernel. Throws DeviceError.
  Status trace(Span<const Ray> rays, Span<Hit> hits);

  /// Frames in turn: `begin` starts one as number `frame` (0 to Options::frames - 1), which had ended or never begun;
  /// `end` waits for it. What `end` returns is valid until that number begins again. Pictures up to most_rows(width)
  /// rows. Throw DeviceError.
  void begin(int frame, const Camera& camera, const Shading& shading, bool read_back);
  /// The same for lit pictures that `draw_lit` takes, with the backdrop's share on top of each word.
  void begin(int frame, const LitFrame& lit, bool read_back);
  Frame end(int frame);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace thimble::gpu
