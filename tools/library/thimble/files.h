/// @file thimble/files.h
/// A scene from a file, for programs on a desktop: everything that the `thimble` command reads, in one object that owns
/// its memory. thimble::files, libthimble_files; the command does what it does by the same code.
///
///     thimble::files::Scene scene("castle.vox", {"--depth", "8"});
///     thimble::files::Image picture = scene.render(800, 600, {"--turn", "30"});  // the bytes of `thimble render`
///     thimble::Hit hit;
///     thimble::closest_hit(scene.tree(), ray, &hit);                             // and all else of the core
///
/// Options are the words of the command: what `thimble render --help` and the others list. World axes are right-handed,
/// z up, a voxel is 1 long.
///
/// Errors are `Error`, whose sentence says what is wrong with the file or the option. Whoever wants none thrown calls
/// `Scene::open`. What a call that throws would have made is not there; the scene is as it was.
///
/// A scene does not change. Any number of threads may call its const functions at a time.
#ifndef THIMBLE_FILES_H
#define THIMBLE_FILES_H

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "thimble/base/memory.h"
#include "thimble/base/status.h"
#include "thimble/light/scene.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/pixel.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/compact_tree.h"

#define THIMBLE_FILES_API __attribute__((visibility("default")))

namespace thimble::files {

/// A file that cannot be read or written, or an option that makes no sense: one sentence.
class THIMBLE_FILES_API Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Words of the command line, such as {"--depth", "8", "--z-up"}.
using Options = std::vector<std::string>;

/// Rows from the top without gaps; red, green, blue (and alpha, with `--background none`), a byte each.
struct Image {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  int channels = 3;
  std::vector<std::uint8_t> pixels;
};

class THIMBLE_FILES_API Scene {
 public:
  /// Reads and builds. `scene`: a file, a generator such as "points:1000000", or a scene that comes along.
  /// `options`: those of `thimble info` that say how it is read (--depth, --as-voxels, --z-up, ...).
  explicit Scene(const std::string& scene, const Options& options = {});
  /// The same of a file's bytes, decompressed, which are copied; `name` (castle.vox) says what they are where they do not
  /// say so themselves, and where other files lie that they name.
  Scene(ConstBytes bytes, const std::string& name, const Options& options = {});
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  /// As the first constructor, without exceptions: null, and the sentence in `error` unless that is null.
  static std::unique_ptr<Scene> open(const std::string& scene, const Options& options = {},
                                     std::string* error = nullptr) noexcept;

  /// For a person: "voxel model", "triangle mesh, voxelised", ...
  const std::string& kind() const;
  /// What its reader left out or had to decide, a sentence each.
  const std::vector<std::string>& notes() const;
  /// Its voxels, in the scene's own memory: what the core traces, draws, copies into an Octree and bakes.
  const CompactTree& tree() const;
  /// Of the materials, 256 colours.
  Span<const Rgb8> palette() const;
  bool has_colors() const;
  /// What light does in it by its file and its materials: for the core's render_lit_band and for wide::LitRenderer. Views
  /// into the scene.
  const LitScene& light() const;
  EffectSet effects() const;

  /// What many rays hit first: as `closest_hit` in each, with vectors where this machine has them. `hits[i]` is of
  /// `rays[i]`. kBadArgument, with nothing done, where there are fewer hits than rays; the status of `closest_hit` for the
  /// first ray outside the limits of ray.h: what the others hit is then not said.
  Status trace(Span<const Ray> rays, Span<Hit> hits) const;

  /// The camera of `render`: `options` are its own (--view, --eye, --fov, ...).
  Camera camera(std::int32_t width_px, std::int32_t height_px, const Options& options = {}) const;
  /// The picture that `thimble render SCENE --size WxH OPTIONS` writes as a .png, byte for byte.
  Image render(std::int32_t width_px, std::int32_t height_px, const Options& options = {}) const;
  /// The bytes of `thimble bake SCENE OPTIONS` (--board, --memory, --coarsen, --effects, ...).
  std::vector<std::uint8_t> bake(const Options& options = {}) const;
  /// What it takes at every depth: the JSON of `thimble memory SCENE --frames FRAMES`.
  std::string memory(int frames = 0) const;
  /// Writes its voxels for other programs, as `thimble export` does: .vox, .npy, .ply or .csv by the path's ending.
  void write(const std::string& path) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

/// `image`, of 1 to 4 channels, as a PNG's bytes.
THIMBLE_FILES_API std::vector<std::uint8_t> png(const Image& image);

}  // namespace thimble::files

#endif
