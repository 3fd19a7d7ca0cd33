/// @file sun_bricks.h
/// From where nothing is in the way to a distant light: a bit a brick, proven once for a light, so that most shadow
/// rays end after a few voxels (map_render.h).
///
///     SunBricks sun;
///     const Bytes bytes = arena.take(SunBricks::bytes(map));
///     SunBricks::make(map, scene.lights[0].place, bytes, &sun)
#ifndef THIMBLE_LIGHT_SUN_BRICKS_H
#define THIMBLE_LIGHT_SUN_BRICKS_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"
#include "../tree/brick_map.h"

namespace thimble {

/// The bits of one light over one map; its bytes and the map's outlive it.
class SunBricks {
 public:
  SunBricks() = default;

  /// Bytes that `make` takes: a bit a brick of the map's box, 512 for a full world of 64.
  static size_t bytes(const BrickMap& map);

  /// Proves for each brick of `map` whether anything solid lies behind it towards the light: `towards` as
  /// `Light::place` of a distant one. Errors, `*sun` as it was: kOutOfMemory; kBadArgument for no direction or no map.
  /// Cost: some ten instructions for each brick that lies behind another, up to the first that is not empty; some
  /// millions in a world of 64.
  static Status make(const BrickMap& map, const Vec3i& towards, Bytes room, SunBricks* sun);

  /// The same a few bricks at a time, for a light that moves: `begin` knows of none that it is free, which is never
  /// wrong; each `prove` looks at up to `bricks` more and says whether any are left.
  static Status begin(const BrickMap& map, const Vec3i& towards, Bytes room, SunBricks* sun);
  bool prove(uint32_t bricks);

  /// Whether it is of this map, which has not been opened anew, and of a distant light there.
  bool belongs_to(const BrickMap& map, const Vec3i& towards) const {
    return bits_ != nullptr && directory_ == map.directory() && towards_ == towards;
  }
  /// A bit a brick, in the directory's order, the lowest of a byte first.
  const uint8_t* bits() const { return bits_; }

 private:
  bool is_free(const Vec3i& brick) const;

  uint8_t* bits_ = nullptr;
  const uint8_t* directory_ = nullptr;
  Vec3i towards_;
  Vec3i side_;
  uint32_t done_ = 0;
  uint32_t cells_ = 0;
};

}  // namespace thimble

#endif
