// The command's readers and bake as a WebAssembly module of the page: files that were dropped become the
// bytes of `thimble bake FILE --board NAME`. One instance bakes one scene: what is wrong with a file ends it
// (runtime.cpp).
#include <cstdint>
#include <cstring>
#include <string>

#include "boards/board_table.h"
#include "output/units.h"
#include "scene/baking.h"
#include "scene/board_fit.h"
#include "scene/board_images.h"
#include "scene/framing.h"
#include "scene/generators.h"
#include "scene/scene_source.h"
#include "web/files.h"
#include "web/looks.h"

namespace thimble::tools {
namespace {

Baked baked;
std::string facts;                  // of what was baked, as JSON
std::string notes;                  // of what its file says and is not drawn
std::vector<BoardImage> images[2];  // of the board, for what is downloaded; [1]: whose water moves
std::string image;

/// Those for a scene with these effects.
const std::vector<BoardImage>& images_for(EffectSet effects) {
  return images[(effects & Effect::kWater) != 0 && !images[1].empty() ? 1 : 0];
}

std::string number_field(const char* name, std::uint64_t value) {
  return std::string(",\"") + name + "\":" + std::to_string(value);
}

void tell(const SceneSource& source, const platform::BoardFacts& board) {
  const CompactTree& tree = baked.scene.tree();
  facts = "{\"level\":" + std::to_string(tree.level()) + number_field("voxels", tree.voxel_count()) +
          number_field("bytes", baked.bytes.size()) + number_field("added", tree.solid_added()) +
          number_field("effects", baked.effects) + number_field("points", source.points()) +
          number_field("frames", source.frames()) +
          number_field("code", code_flash_bytes(board, baked.effects)) +
          number_field("room", room_behind(images_for(baked.effects), baked.effects)) +
          number_field("ram", drawing_ram_bytes(board, baked.effects)) +
          number_field("water", (baked.effects & Effect::kWater) != 0 ? 1 : 0) + ",\"kind\":\"" +
          source.kind() + "\"}";
  notes.clear();
  for (const std::string& note : source.notes()) {
    notes += (notes.empty() ? "" : "; ") + note;
  }
}

}  // namespace

extern "C" {

// Room for the bytes of a file, or for a name.
[[clang::export_name("room")]] std::uint8_t* thimble_room(std::size_t bytes) {
  return new std::uint8_t[bytes == 0 ? 1 : bytes];
}

// A file of that name holds these bytes, which stay where they are.
[[clang::export_name("add_file")]] void thimble_add_file(const char* name, const std::uint8_t* bytes,
                                                         std::size_t size) {
  add_file(name, {bytes, size});
}

// A program of `make images` for board number `index`: the scene that is baked next is to lie behind one of those; where it
// has water, behind one that moves water.
[[clang::export_name("add_program")]] void thimble_add_program(const std::uint8_t* bytes, std::size_t size,
                                                               std::uint32_t index, bool moves_water) {
  images[moves_water].push_back(
      open_image({reinterpret_cast<const char*>(bytes), size}, platform::boards()[index]));
  sort_images(&images[moves_water]);
}

// Bakes `scene`, a file's name or a generator, for board number `index`; `depth` 0: its own; `frame` below 0: the first.
// `width_px` 0: for the board, which turns it, so that all of it stays in the picture; else to look around in, in a picture of
// that size, whatever its bytes. How many they are.
[[clang::export_name("bake")]] std::size_t thimble_bake(const char* scene, std::uint32_t index, int depth,
                                                        bool coarsen, std::int32_t frame,
                                                        std::int32_t width_px, std::int32_t height_px) {
  const platform::BoardFacts& board = platform::boards()[index];
  SceneArguments arguments;
  arguments.scene = scene;
  if (depth != 0) {
    arguments.depth = depth;
  }
  if (frame >= 0) {
    arguments.frame = static_cast<std::uint32_t>(frame);
  }
  auto source = open_scene(arguments);
  end_of_reading();
  ViewWishes view;
  view.side = NamedView::kBest;
  view.fov_degrees = kPictureFov;
  const bool turns = width_px == 0;
  view.width_px = turns ? board.width_px : width_px;
  view.height_px = turns ? board.height_px : height_px;
  FlashLimit limit{turns ? &board : nullptr, std::nullopt};
  if (!images[0].empty()) {
    limit.room = [](EffectSet effects) { return room_behind(images_for(effects), effects); };
  }
  BakingOptions options;
  options.limit_bytes = limit.bytes();
  options.name = scene_name(scene);
  options.brick_map = true;
  options.most_map_level = board.most_map_level;
  options.coarsen = coarsen;
  options.default_look = source->baked() == nullptr && !parse_generator(scene);
  options.display = DisplayFacts{board.format, view.width_px, view.height_px};
  SceneShape shape;
  options.camera = [&](const CompactTree& tree) {
    shape = shape_to_frame(*source, tree);
    return (turns ? frame_round(view, *source, shape) : frame_scene(view, *source, shape)).kept;
  };
  baked = bake_within(limit, *source, &options);
  if (limit.room && limit.room(baked.effects) == 0) {
    throw InputError("calls for " + effects_text(baked.effects) + ", which no image for " + board.name +
                     " draws together");
  }
  if (!baked.fits) {
    throw InputError(too_large_text(limit, baked, options, source->level()));
  }
  tell(*source, board);
  look_at_scene(std::move(source), baked.scene, shape);
  return baked.bytes.size();
}

[[clang::export_name("baked")]] const std::uint8_t* thimble_baked() {
  return baked.bytes.data();
}
// The file for the board, in the format of that ending: its bytes, image_bytes() of them.
[[clang::export_name("image")]] const char* thimble_image(std::uint32_t index, const char* ending) {
  const BoardImage* const found = image_for(images_for(baked.effects), baked);
  if (found == nullptr) {
    throw InputError("is drawn by no image for this board");
  }
  image = image_file(*found, baked.bytes, platform::boards()[index], std::string(".") + ending);
  return image.data();
}
[[clang::export_name("image_bytes")]] std::size_t thimble_image_bytes() {
  return image.size();
}
[[clang::export_name("facts")]] const char* thimble_facts() {
  return facts.c_str();
}
[[clang::export_name("notes")]] const char* thimble_notes() {
  return notes.c_str();
}
}

}  // namespace thimble::tools
