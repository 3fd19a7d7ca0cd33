/// The baked scene of the port, opened and checked, with the fastest way to draw it.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "apps/text.h"
#include "port.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"

namespace thimble::apps {

struct ShownScene {
  BakedScene scene;
  BrickMap map;
  bool has_map = false;
  bool map_in_ram = false;
};

/// Opens and validates port::scene(). Null when it is sound, else an English phrase that says what is wrong.
[[gnu::noinline]] inline const char* open_scene(ShownScene* shown) {
  if (port::scene().empty()) {
    return "no scene was built in";
  }
  if (BakedScene::open(port::scene(), &shown->scene) != Status::kOk) {
    return "the scene is no baked scene, or damaged";
  }
  if (shown->scene.validate() != Status::kOk) {
    return "the scene is damaged";
  }
  return nullptr;
}

/// Takes the brick map that was baked in, or makes one in the arena when that leaves half of it. A scene
/// without one is drawn from its tree, with the same pixels.
[[gnu::noinline]] inline void open_map(ShownScene* shown, Arena* arena) {
  const CompactTree& tree = shown->scene.tree();
  const ConstBytes baked = shown->scene.section(SectionKind::kBrickMap);
  if (!baked.empty()) {
    shown->has_map = BrickMap::open(baked, &shown->map) == Status::kOk && shown->map.belongs_to(tree);
    return;
  }
  const Bytes half = arena->rest().subspan(0, arena->free_bytes() / 2);
  size_t written = 0;
  if (BrickMap::make(tree, half, nullptr, &written) == Status::kOk) {
    const Bytes bytes = arena->take(written);
    shown->has_map = BrickMap::open(bytes, &shown->map) == Status::kOk;
    shown->map_in_ram = shown->has_map;
  }
}

/// Draws a band of it: the port, if it can, else the core, which alone counts.
inline Status draw_scene(const ShownScene& shown, const Camera& camera, const Shading& shading,
                         const Band& band, RenderCounts* counts = nullptr) {
  if (counts == nullptr && port::draw(shown.scene.tree(), camera, shading, band)) {
    return Status::kOk;
  }
  return shown.has_map ? render_band(shown.scene.tree(), shown.map, camera, shading, band, counts)
                       : render_band(shown.scene.tree(), camera, shading, band, counts);
}

/// Two lines: the board with its memory, the scene with its sizes.
[[gnu::noinline]] inline void tell_board_and_scene(const char* application, const ShownScene& shown) {
  const port::Facts& facts = port::facts();
  const BakedScene& scene = shown.scene;
  put("thimble ", application, " on ", facts.name, ": RAM ", facts.ram_bytes, " flash ", facts.flash_bytes,
      " stack ", facts.stack_bytes, " arena ", port::arena().size, " bytes\nscene ");
  const ConstBytes name = scene.section(SectionKind::kName);
  port::write(name.subspan(0, 64));
  put(name.empty() ? "without a name" : "", ": depth ", static_cast<uint32_t>(scene.tree().level()),
      " voxels ", scene.tree().voxel_count(), " tree ", scene.tree().size_bytes(), " scene ",
      scene.bytes().size, " map ", shown.has_map ? shown.map.size_bytes() : 0,
      shown.map_in_ram ? " in RAM" : "", " bytes crc ", Hex{scene.crc32()}, "\n");
}

}  // namespace thimble::apps
