// The looks of one baked scene as a WebAssembly module, for files of a scene that opens by itself (`thimble render -o
// F.html`): looks.cpp without the readers of anything else.
#include <cstdint>
#include <utility>

#include "readers/formats.h"
#include "scene/scene_source.h"
#include "web/looks.h"

extern "C" {

[[clang::export_name("room")]] std::uint8_t* thimble_room(std::size_t bytes) {
  return new std::uint8_t[bytes];
}

// Opens a baked scene, whose bytes stay where they are. `background`: 0 the rule's, 1 the gradient, else 2 + its red,
// green, blue, red at bit 16; `ground`: -1 the rule's, else whether there is one.
[[clang::export_name("open")]] void thimble_open(const std::uint8_t* bytes, std::size_t size,
                                                 std::uint32_t background, std::int32_t ground) {
  using namespace thimble;
  using namespace thimble::tools;
  BakedFile file = std::get<BakedFile>(read_oct({{bytes, size}, nullptr}, {}, {}));
  const BakedScene scene = file.scene;
  look_at_scene(baked_scene(std::move(file)), scene, {});
  LookWishes wishes;
  if (background == 1) {
    wishes.background.kind = BackgroundKind::kGradient;
  } else if (background != 0) {
    const std::uint32_t color = background - 2;
    wishes.background = {BackgroundKind::kColor,
                         {static_cast<std::uint8_t>(color >> 16), static_cast<std::uint8_t>(color >> 8),
                          static_cast<std::uint8_t>(color)}};
  }
  if (ground >= 0) {
    wishes.ground = ground != 0;
  }
  wish_of_looks(wishes);
}
}
