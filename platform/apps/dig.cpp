// Digging: the baked scene is copied into RAM, where its voxels come and go; a cross in the middle of the
// picture says where.
//
//   arrows  look round; with select held: up and down nearer and away
//   select  digs a ball of 19 voxels round the voxel under the cross; with down held puts one before it
//   d u     the same over the UART: dig, put
//   q       ends, with status 0; told are the last picture's CRC-32 and what an edit took at most
//
// Until somebody does something it shows what it does: a bite a frame into what is in the middle, two in all,
// then a ball before it.
//
// Tree and brick map change in place (thimble/tree/edited_world.h), and frames are fast ones as before. Where
// there is no room for an edit the application says so and the world is as it was.
#include "apps/apps.h"
#include "apps/band_turns.h"
#include "apps/demo_view.h"
#include "apps/place.h"
#include "apps/shown_scene.h"
#include "apps/text.h"
#include "port.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/edited_world.h"

namespace thimble::apps {
namespace {

constexpr int kKeysAFrame = 16;
/// A bite: the voxels whose middles lie within the root of 2 of the middle one's.
constexpr int32_t kBiteSquare = 2;
/// Bites that it takes by itself.
constexpr uint32_t kOwnBites = 2;
/// The cross: pixels from its middle, which it leaves free.
constexpr int32_t kCrossFrom = 2;
constexpr int32_t kCrossTo = 4;

struct Dig : Placed {
  ShownScene shown;
  EditedWorld world;
  Orbit orbit;
  Steering steering;
  Camera camera;
  Shading shading;
  Bands bands;
  bool is_touched = false;  ///< a key or button has come
  uint32_t held = 0;        ///< buttons
  uint32_t edits = 0;
  uint32_t refused = 0;
  uint32_t most_instructions = 0;  ///< of the edit of a voxel, where they are counted
};

/// The cross with its middle at (x, y).
void draw_cross(const Band& band, int32_t x, int32_t y, Rgb8 color) {
  const port::Display& screen = display();
  const int32_t scale = screen.height_px < 128 ? 1 : 2;
  const size_t stride = row_bytes(band.format, screen.width_px);
  for (int32_t i = 0; i < band.rows; ++i) {
    const int32_t row_y = band.first_row + i;
    uint8_t* const row = band.pixels.data + stride * row_place(band.format, i);
    const int32_t down = row_y < y ? y - row_y : row_y - y;
    for (int32_t across = -kCrossTo * scale; across <= kCrossTo * scale; ++across) {
      const int32_t from_middle = across < 0 ? -across : across;
      const int32_t along = down == 0 ? from_middle : across == 0 ? down : 0;
      if (along >= kCrossFrom * scale && along <= kCrossTo * scale && x + across >= 0 &&
          x + across < screen.width_px) {
        store_pixel(row, x + across, row_y, band.format, color);
      }
    }
  }
}

/// White, with a shadow where a pixel can be made dark again: where it has bytes of its own.
void draw_cross(const Band& band) {
  const port::Display& screen = display();
  if (band.format == PixelFormat::kGray8 || band.format == PixelFormat::kRgb565 ||
      band.format == PixelFormat::kRgb888) {
    draw_cross(band, screen.width_px / 2 + 1, screen.height_px / 2 + 1, {0, 0, 0});
  }
  draw_cross(band, screen.width_px / 2, screen.height_px / 2, {255, 255, 255});
}

[[gnu::noinline]] Status draw_frame(Dig* dig, uint32_t* crc) {
  const port::Display& screen = display();
  Status status = view_at(dig->orbit, dig->world.tree(), 0, dig->steering, screen.width_px, screen.height_px,
                          &dig->camera);
  for (int32_t y = 0; y < screen.height_px && status == Status::kOk; y += dig->bands.rows) {
    const Band band = dig->bands.next(y, screen.height_px);
    status = render_band(dig->world.tree(), dig->world.map(), dig->camera, dig->shading, band);
    if (status == Status::kOk) {
      draw_cross(band);
      dig->bands.send(band);
      *crc = crc32(band.pixels, *crc);
    }
  }
  return status;
}

/// One voxel; counts what it took.
void edit(Dig* dig, const Vec3i& voxel, bool puts, uint8_t material) {
  const uint32_t start = port::instructions();
  const Status status = puts ? dig->world.set(voxel, material) : dig->world.clear(voxel);
  const uint32_t taken = port::instructions() - start;
  dig->most_instructions = taken > dig->most_instructions ? taken : dig->most_instructions;
  dig->edits += status == Status::kOk ? 1 : 0;
  dig->refused += status == Status::kOutOfMemory ? 1 : 0;
}

/// A ball round the voxel under the cross goes, or one before it comes.
[[gnu::noinline]] void bite(Dig* dig, bool puts) {
  const Ray ray = dig->camera.ray(display().width_px / 2, display().height_px / 2);
  Hit hit;
  if (closest_hit(dig->world.tree(), ray, &hit) != Status::kOk || hit.kind != HitKind::kHit) {
    put("nothing there\n");
    return;
  }
  Vec3i middle = hit.voxel;
  if (puts && hit.axis >= 0) {
    middle[hit.axis] += ray.direction[hit.axis] > 0 ? -1 : 1;
  }
  dig->edits = 0;
  dig->refused = 0;
  for (int32_t z = -1; z <= 1; ++z) {
    for (int32_t y = -1; y <= 1; ++y) {
      for (int32_t x = -1; x <= 1; ++x) {
        if (x * x + y * y + z * z <= kBiteSquare) {
          edit(dig, {middle.x + x, middle.y + y, middle.z + z}, puts, hit.material);
        }
      }
    }
  }
  const EditRoom left = dig->world.free_room();
  put(puts ? "put at " : "dug at ");
  for (int axis = 0; axis < 3; ++axis) {
    put(static_cast<uint32_t>(middle[axis]), axis < 2 ? "," : ": voxels ");
  }
  put(dig->world.tree().voxel_count(), ", left are nodes ", left.nodes, " leaves ", left.leaves, " bricks ",
      left.bricks, dig->refused != 0 ? "; no room for all of it\n" : "\n");
}

void obey_buttons(Dig* dig) {
  const uint32_t buttons = port::buttons();
  const uint32_t pressed = buttons & ~dig->held;
  const bool selects = (buttons & port::kSelect) != 0;
  if (selects && (pressed & port::kSelect) != 0) {
    bite(dig, (buttons & port::kDown) != 0);
  } else if (!selects || (buttons & (port::kUp | port::kDown)) != 0) {
    steer(buttons, &dig->steering);
  }
  dig->held = buttons;
  dig->is_touched = dig->is_touched || buttons != 0;
}

/// Whether to continue.
[[gnu::noinline]] bool obey(Dig* dig) {
  obey_buttons(dig);
  for (int i = 0; i < kKeysAFrame; ++i) {
    const int key = port::read();
    dig->is_touched = dig->is_touched || key >= 0;
    switch (key) {
      case -1:
        return true;
      case 'q':
        return false;
      case 'd':
        bite(dig, false);
        break;
      case 'u':
        bite(dig, true);
        break;
      default:
        break;
    }
  }
  return true;
}

/// The scene's copy in what is left of the arena. Null, or why not.
[[gnu::noinline]] const char* begin(Dig* dig, Arena* arena) {
  if (const char* wrong = open_scene(&dig->shown)) {
    return wrong;
  }
  const CompactTree& tree = dig->shown.scene.tree();
  const bool has_bands = dig->bands.take(arena);
  const Bytes rest = arena->rest();
  const EditRoom room = EditedWorld::room_in(tree, rest.size);
  const Status status = !has_bands || (room.nodes == 0 && !tree.empty())
                            ? Status::kOutOfMemory
                            : EditedWorld::make(tree, room, rest, &dig->world);
  if (status == Status::kOutOfMemory) {
    return "the arena does not hold the scene, its brick map and a band of the picture";
  }
  if (status != Status::kOk) {
    return tree.merged() ? "the scene was coarsened: its blocks are no voxels"
                         : "the world has more than 256 voxels a side";
  }
  dig->orbit = orbit_of(dig->shown.scene);
  dig->shading = demo_shading(dig->shown.scene.palette());
  return nullptr;
}

}  // namespace

int dig() {
  Arena arena(port::arena());
  Dig* const state = place<Dig>(&arena);
  if (state == nullptr) {
    return refuse("the arena is too small");
  }
  if (const char* wrong = begin(state, &arena)) {
    return refuse(wrong);
  }
  tell_board_and_scene("dig", state->shown);
  const EditRoom room = state->world.room();
  put("room for nodes ", room.nodes, " leaves ", room.leaves, " bricks ", room.bricks, "\n");
  uint32_t crc = 0;
  for (uint32_t drawn = 0; port::running(drawn); ++drawn) {
    // The first picture comes before the first key: the cross wants a camera.
    if (drawn != 0 && !obey(state)) {
      break;
    }
    if (drawn != 0 && drawn <= kOwnBites + 1 && !state->is_touched) {
      bite(state, drawn > kOwnBites);
    }
    crc = 0;
    const Status status = draw_frame(state, &crc);
    if (status != Status::kOk) {
      return refuse(status_text(status));
    }
  }
  put("last crc ", Hex{crc}, "\n");
  if (state->most_instructions != 0) {
    put("most instructions of an edit: ", state->most_instructions, "\n");
  }
  return 0;
}

}  // namespace thimble::apps
