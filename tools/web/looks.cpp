#include "web/looks.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "scene/framing.h"
#include "scene/look_picture.h"
#include "web/look_block.h"

namespace thimble::tools {
namespace {

std::unique_ptr<SceneSource> source;
BakedScene scene;
std::optional<SceneShape> known_shape;
std::optional<SceneFacts> known_facts;
Framing framing;
Look look;
LookWishes look_wishes;
std::vector<std::uint8_t> block_bytes;
std::vector<std::uint8_t> star_pixels;
WebCamera web_camera;
std::int32_t framed[7];

const SceneShape& scene_shape() {
  if (!known_shape) {
    known_shape = shape_of(scene.tree());
  }
  return *known_shape;
}

const SceneFacts& scene_facts() {
  if (!known_facts) {
    LitDescription lighting = source->lighting();
    lighting.find_glow(scene.tree());
    known_facts = facts_of(*source, lighting, scene_shape());
  }
  return *known_facts;
}

void put_colors(const std::vector<Rgb8>& colors, Rgb8 (&to)[256]) {
  std::copy(colors.begin(), colors.end(), to);
}

// A view with the lens of `camera` in a picture of that size.
ViewWishes wishes_of(const SceneCamera& camera, std::int32_t width_px, std::int32_t height_px) {
  ViewWishes wishes;
  wishes.placed = true;
  wishes.orthographic = !camera.is_perspective;
  wishes.fov_degrees =
      camera.is_perspective ? static_cast<double>(camera.fov_degrees.raw) / Q16::kOne : kPictureFov;
  wishes.width_px = width_px;
  wishes.height_px = height_px;
  return wishes;
}

// What --eye, --target and the lens say of it.
ViewWishes placed_wishes(const SceneCamera& camera, std::int32_t width_px, std::int32_t height_px) {
  ViewWishes wishes = wishes_of(camera, width_px, height_px);
  wishes.eye = real_of(camera.eye);
  wishes.target = real_of(camera.target);
  if (wishes.orthographic) {
    wishes.span = static_cast<double>(camera.span.raw) / Q14::kOne;
  }
  return wishes;
}

LookBlock block_of(std::uint32_t exposure_q8) {
  LookBlock block;
  block.camera = framing.kept;
  block.is_stars = look.kind == LookKind::kStars;
  block.effects = block.is_stars ? Effect::kNone : look.effects;
  const bool has_water = (look.effects & Effect::kWater) != 0;  // which no voxels show
  block.quick_effects = look.has_backdrop && !has_water ? Effect::kNone : look.effects & kQuickEffects;
  block.quick_tone = quick_tone(look, exposure_q8 & ~kOneSample);
  block.across = look.across;
  block.colors = static_cast<std::uint32_t>(look.palette.size());
  block.has_backdrop = look.has_backdrop;
  block.background = look.background;
  block.ground = look.ground;
  put_colors(look.palette, block.palette);
  if (block.is_stars) {
    block.quick_mode = look.has_own_colors ? ShadeMode::kColor : ShadeMode::kDepth;
    block.quick_effects = Effect::kNone;
    put_colors(look.palette, block.quick_palette);
    return block;
  }
  const QuickLook quick = quick_look(look, block.quick_tone);
  std::copy(std::begin(quick.face_light), std::end(quick.face_light), block.quick_light);
  put_colors(quick.palette, block.quick_palette);
  return block;
}

}  // namespace

SceneShape shape_to_frame(const SceneSource& of, const CompactTree& tree) {
  const bool is_next_frame = known_shape && known_shape->owner != nullptr && of.in_frames() != nullptr &&
                             of.files() == source->files() && of.level() == known_shape->level &&
                             of.in_frames()->points() == source->in_frames()->points();
  return is_next_frame ? *known_shape : shape_of(of, tree);
}

void look_at_scene(std::unique_ptr<SceneSource> source_of_it, const BakedScene& baked,
                   const SceneShape& shape) {
  source = std::move(source_of_it);
  scene = baked;
  known_shape.reset();
  if (shape.owner != nullptr) {  // else it is of a tree that is gone
    known_shape = shape;
  }
  known_facts.reset();
}

void wish_of_looks(const LookWishes& wishes) {
  look_wishes = wishes;
}

extern "C" {

// Where the camera of the next calls is written.
[[clang::export_name("camera")]] WebCamera* thimble_camera() {
  return &web_camera;
}

// The look from that camera in a picture of that size: a LookBlock and what belongs to it, of look_bytes() bytes.
// `exposure`: that of the last finished picture.
[[clang::export_name("look")]] const std::uint8_t* thimble_look(std::int32_t width_px, std::int32_t height_px,
                                                                std::uint32_t exposure_q8) {
  framing = {};
  framing.kept = web_camera.of(scene.camera());
  if (set_camera(framing.kept, width_px, height_px, scene.tree().level(), &framing.camera) != Status::kOk) {
    return nullptr;
  }
  if (web_camera.is_own == 0) {
    framing = frame_scene(placed_wishes(framing.kept, width_px, height_px), *source, scene_shape());
  }
  look = default_look(scene_facts(), look_wishes, framing);
  LookBlock block = block_of(exposure_q8);
  const std::vector<std::uint8_t> lighting =
      lighting_section(look.lighting, look.used, block.effects, scene.tree().level());
  block.lighting_bytes = static_cast<std::uint32_t>(lighting.size());
  block_bytes.resize(sizeof(block) + lighting.size());
  std::memcpy(block_bytes.data(), &block, sizeof(block));
  std::copy(lighting.begin(), lighting.end(), block_bytes.data() + sizeof(block));
  return block_bytes.data();
}
[[clang::export_name("look_bytes")]] std::size_t thimble_look_bytes() {
  return block_bytes.size();
}
[[clang::export_name("is_stars")]] bool thimble_is_stars() {
  return look.kind == LookKind::kStars;
}

// The finished picture of stars, in RGB888, by the last look.
[[clang::export_name("stars")]] const std::uint8_t* thimble_stars() {
  const Camera& camera = framing.camera;
  Painting painting;
  Image& image = painting.image;
  image.width_px = camera.width_px();
  image.height_px = camera.height_px();
  const std::size_t pixels =
      static_cast<std::size_t>(camera.width_px()) * static_cast<std::size_t>(camera.height_px());
  image.pixels.resize(3 * pixels);
  std::vector<std::uint8_t> work(kStarBytes * pixels);
  const CompactTree tree = scene.tree();
  if (paint_stars({&tree, &look, &framing, camera, Bytes(work.data(), work.size()), 1}, {}, &painting) !=
      Status::kOk) {
    throw InputError("stars cannot be drawn");
  }
  star_pixels = std::move(image.pixels);
  return star_pixels.data();
}

// The view from a side (NamedView), its lens that of the scene's own camera: eye and target in 1/256 voxel, and how
// wide a parallel view is, in 1/256 of its own.
[[clang::export_name("frame")]] const std::int32_t* thimble_frame(std::int32_t side, std::int32_t width_px,
                                                                  std::int32_t height_px) {
  const SceneCamera& own = scene.camera();
  ViewWishes wishes = wishes_of(own, width_px, height_px);
  wishes.side = static_cast<NamedView>(side);
  const SceneCamera kept = frame_shape(wishes, scene_shape()).kept;
  for (int axis = 0; axis < 3; ++axis) {
    framed[axis] = kept.eye[axis].raw;
    framed[3 + axis] = kept.target[axis].raw;
  }
  framed[6] =
      own.is_perspective ? 256 : static_cast<std::int32_t>(256 * std::int64_t{kept.span.raw} / own.span.raw);
  return framed;
}
}

}  // namespace thimble::tools
