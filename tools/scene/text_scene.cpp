#include "scene/scene_source.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <utility>

#include "output/units.h"
#include "scene/generators.h"
#include "scene/named_scenes.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {
namespace {

using MaterialMap = std::array<std::uint8_t, 256>;

// A part where it stands.
struct Placement {
  const SceneText::Part* part = nullptr;
  std::shared_ptr<const OpenedModel> model{};  // null: it is a box or a ball
  std::array<std::int32_t, 3> size{};          // of the model's box, unturned
  VoxelBox solid;                              // what it fills of the world, before anything is cut off
  MaterialMap material{};                      // of the model's; of a box or a ball the first
};

Vec3i placed(const Placement& placement, const Vec3i& voxel) {
  const SceneText::Part& part = *placement.part;
  Vec3i result;
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const int from = part.axis[at];
    const std::int32_t side = placement.size[static_cast<std::size_t>(from)];
    result[i] = part.at[i] + (part.sign[at] > 0 ? voxel[from] : side - 1 - voxel[from]);
  }
  return result;
}

void grow(VoxelBox* box, const Vec3i& voxel) {
  const bool was_empty = box->empty();
  for (int axis = 0; axis < 3; ++axis) {
    box->low[axis] = was_empty ? voxel[axis] : std::min(box->low[axis], voxel[axis]);
    box->high[axis] = was_empty ? voxel[axis] + 1 : std::max(box->high[axis], voxel[axis] + 1);
  }
}

// The box of voxels that a ball may fill.
VoxelBox box_of_ball(const SceneText::Part& ball) {
  VoxelBox box;
  for (int axis = 0; axis < 3; ++axis) {
    // From the first voxel whose centre lies within to the last.
    const std::int32_t center = ball.center[axis].raw - Q8::kOne / 2;
    box.low[axis] = -((ball.radius_q8 - center) >> Q8::kBits);
    box.high[axis] = ((ball.radius_q8 + center) >> Q8::kBits) + 1;
  }
  return box;
}

VoxelBox cut(const VoxelBox& box, std::int32_t side) {
  VoxelBox result;
  for (int axis = 0; axis < 3; ++axis) {
    result.low[axis] = std::clamp(box.low[axis], 0, side);
    result.high[axis] = std::clamp(box.high[axis], 0, side);
  }
  return result;
}

std::string corner_text(const Vec3i& corner) {
  return concat(corner.x, " ", corner.y, " ", corner.z);
}

// What a scene text puts together, and how it streams.
class TextScene {
 public:
  TextScene(const SceneText& text, const SceneArguments& arguments, SceneOpening* opening,
            const Progress& progress)
      : text_(text) {
    facts_.kind = "scene text";
    facts_.is_scalable = false;
    facts_.placements = text.parts.size();
    facts_.lighting.emplace();
    facts_.extent = {1, 1, 1};
    for (const SceneText::Part& part : text_.parts) {
      Placement& placement = placements_.emplace_back();
      placement.part = &part;
      if (part.kind == SceneText::PartKind::kModel) {
        add_model(arguments.scene, opening, progress, &placement);
      } else {
        placement.solid =
            part.kind == SceneText::PartKind::kBox ? VoxelBox{part.low, part.high} : box_of_ball(part);
      }
    }
    choose_level(arguments.depth);
    check_parts();
    check_numbers();
    merge_palettes();
    make_lighting();
    facts_.camera = text_.camera;
    facts_.single_material = materials_ <= 1;
    // A box's or a ball's material has a colour, and so has what replaces a model's.
    facts_.has_colors =
        !facts_.single_material ||
        std::any_of(placements_.begin(), placements_.end(), [](const Placement& each) {
          return each.model == nullptr || each.part->replaces || each.model->source->has_colors();
        });
  }

  const SourceFacts& facts() const { return facts_; }
  // Hands what its models were read from, and what was said of them, on to `source`.
  void add_models_to(SceneSource* source) const {
    for (const Placement& each : placements_) {
      if (each.model != nullptr) {
        for (const std::string& file : each.model->source->files()) {
          source->add_file(file);
        }
        source->add_notes(each.model->source->notes());
      }
    }
  }

  void stream_blocks(const VisitBlock& visit) const {
    for (const Placement& each : placements_) {
      if (each.model != nullptr) {
        stream_model(each, visit);
        continue;
      }
      const VoxelBox box = cut(each.solid, side());
      const auto filled = [&](const Vec3i& corner, int level) {
        return each.part->kind == SceneText::PartKind::kBox ? filled_by_box(box, corner, level)
                                                            : filled_by_ball(*each.part, corner, level);
      };
      stream_filled({}, facts_.level, filled, each.material[0], visit);
    }
  }

 private:
  std::int32_t side() const { return std::int32_t{1} << facts_.level; }
  bool inside(const Vec3i& voxel) const {
    const auto within = [this](std::int32_t v) { return v >= 0 && v < side(); };
    return within(voxel.x) && within(voxel.y) && within(voxel.z);
  }

  void stream_model(const Placement& model, const VisitBlock& visit) const {
    model.model->source->stream(
        [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
          const Vec3i at = placed(model, {x, y, z});
          if (inside(at)) {
            visit(at, 0, model.material[material]);
          }
        },
        {});
  }

  // How much of a block a part fills. A single voxel is never filled in part.
  enum class Filled : std::uint8_t { kNothing, kSome, kAll };

  // Visits the largest blocks that a part fills: those within the block at `corner` for which `filled(corner, level)`
  // says so.
  template <class HowFilled>
  static void stream_filled(const Vec3i& corner, int level, const HowFilled& filled, std::uint8_t material,
                            const VisitBlock& visit) {
    const Filled how = filled(corner, level);
    if (how == Filled::kAll) {
      visit(corner, level, material);
    }
    for (int octant = 0; how == Filled::kSome && octant < 8; ++octant) {
      const std::int32_t half = std::int32_t{1} << (level - 1);
      stream_filled({corner.x + (octant & 1) * half, corner.y + (octant >> 1 & 1) * half,
                     corner.z + (octant >> 2) * half},
                    level - 1, filled, material, visit);
    }
  }

  static Filled filled_by_box(const VoxelBox& box, const Vec3i& corner, int level) {
    bool within = true;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t low = corner[axis];
      const std::int32_t high = low + (std::int32_t{1} << level);
      if (low >= box.high[axis] || high <= box.low[axis]) {
        return Filled::kNothing;
      }
      within = within && low >= box.low[axis] && high <= box.high[axis];
    }
    return within ? Filled::kAll : Filled::kSome;
  }

  // By the voxels whose centres lie in the ball.
  static Filled filled_by_ball(const SceneText::Part& ball, const Vec3i& corner, int level) {
    const std::int64_t reach = std::int64_t{ball.radius_q8} * ball.radius_q8;
    std::int64_t nearest = 0;
    std::int64_t farthest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      // From the ball's centre to the centres of the block's first and last voxel.
      const std::int64_t first = std::int64_t{corner[axis]} * Q8::kOne + Q8::kOne / 2 - ball.center[axis].raw;
      const std::int64_t last = first + ((std::int64_t{1} << level) - 1) * Q8::kOne;
      nearest += first > 0 ? first * first : last < 0 ? last * last : 0;
      farthest += std::max(first * first, last * last);
    }
    return farthest <= reach ? Filled::kAll : nearest > reach ? Filled::kNothing : Filled::kSome;
  }

  void add_model(const std::string& own_path, SceneOpening* opening, const Progress& progress,
                 Placement* placement) {
    Placement& model = *placement;
    const SceneText::Part& part = *model.part;
    SceneArguments arguments;
    arguments.scene = part.file;
    arguments.depth = part.depth;
    arguments.as_voxels = part.as_voxels;
    arguments.z_up = part.z_up;
    try {
      const bool is_generated = parse_generator(part.file).has_value();
      if (!is_generated) {
        arguments.scene = path_beside(own_path, part.file);
      }
      const std::string key = concat(arguments.scene, '\n', part.depth.value_or(0), part.as_voxels ? "v" : "",
                                     part.z_up ? "z" : "");
      std::shared_ptr<const OpenedModel>& kept = opening->opened[key];
      fail_if(opening->opened.size() > kMostSceneModels, "the scene opens more than the limit of ",
              grouped(kMostSceneModels), " models");
      if (kept == nullptr) {
        std::unique_ptr<SceneSource> opened = open_scene(arguments, opening, progress);
        opening->generated += is_generated ? opened->points() : 0;
        fail_if(opening->generated > kMostGenerated,
                "with this the scene's generators make more than the limit of ", grouped(kMostGenerated),
                " points");
        kept = survey(std::move(opened), progress);
      }
      model.model = kept;
    } catch (const InputError& error) {
      fail_at(part.file_place, printable(part.file), ": ", error.what());
    }
    // Scenes within scenes multiply.
    facts_.placements += model.model->source->placements();
    fail_if(facts_.placements > kMostPlacements, part.place,
            "with this the scene places more than the limit of ", grouped(kMostPlacements),
            " models, boxes and balls");
    surveyed_ += model.model->voxels;
    fail_if(surveyed_ > kMostSceneVoxels, part.place, "with this the scene places more than the limit of ",
            grouped(kMostSceneVoxels), " voxels");
    model.size = model.model->source->extent();
    const VoxelBox& solid = model.model->solid;
    if (!solid.empty()) {
      grow(&model.solid, placed(model, solid.low));
      grow(&model.solid, placed(model, {solid.high.x - 1, solid.high.y - 1, solid.high.z - 1}));
    }
  }

  // Streams a model once.
  static std::shared_ptr<const OpenedModel> survey(std::shared_ptr<const SceneSource> source,
                                                   const Progress& progress) {
    auto model = std::make_shared<OpenedModel>();
    source->stream(
        [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
          model->used.is[material] = true;
          ++model->voxels;
          grow(&model->solid, {x, y, z});
        },
        progress);
    model->source = std::move(source);
    return model;
  }

  void choose_level(const std::optional<int>& asked) {
    std::int32_t largest = 1;
    TextPlace largest_place{1, 1};
    // What is cut off at a given depth counts for the depth when nobody gives one.
    for (const Placement& each : placements_) {
      const Vec3i& high = each.solid.high;
      const std::int32_t end = std::max({high.x, high.y, high.z});
      if (!each.solid.empty() && end > largest) {
        largest = end;
        largest_place = each.part->place;
      }
    }
    int& level = facts_.level;
    level = asked ? *asked : text_.depth.value_or(0);
    if (level == 0) {
      level = std::clamp(static_cast<int>(std::bit_width(static_cast<unsigned>(largest - 1))), kMinLevel,
                         kMaxLevel);
      fail_if(side() < largest, largest_place, "this reaches to ", largest, "; the largest world ends at ",
              side());
    }
  }

  void check_parts() {
    std::uint64_t primitive_voxels = 0;
    for (const Placement& each : placements_) {
      const VoxelBox& box = each.solid;
      const VoxelBox kept = cut(box, side());
      const TextPlace& place = each.part->place;
      std::uint64_t voxels = 0;
      if (each.model != nullptr) {
        fail_if(!each.part->crop && !(kept == box), place, "the model's voxels from ", corner_text(box.low),
                " to ", corner_text(box.high), " leave the world of ", side(), " voxels a side (depth ",
                facts_.level, "); crop cuts them off");
        voxels = each.model->voxels;
      } else {
        fail_if(kept.empty(), place, "all of this lies outside the world of ", side(),
                " voxels a side (depth ", facts_.level, ")");
        voxels = std::uint64_t{1} * static_cast<std::uint64_t>(kept.high.x - kept.low.x) *
                 static_cast<std::uint64_t>(kept.high.y - kept.low.y) *
                 static_cast<std::uint64_t>(kept.high.z - kept.low.z);
        primitive_voxels += voxels;
        fail_if(primitive_voxels > kMostPrimitiveVoxels, place, "boxes and balls up to here hold ",
                grouped(primitive_voxels), " voxels, the limit is ", grouped(kMostPrimitiveVoxels));
      }
      facts_.points += voxels;
      for (int axis = 0; axis < 3 && !kept.empty(); ++axis) {
        std::int32_t& end = (*facts_.extent)[static_cast<std::size_t>(axis)];
        end = std::max(end, kept.high[axis]);
      }
    }
  }

  // What only the world's size decides.
  void check_numbers() {
    const auto in_reach = [this](const Vec3i& at) {
      const std::int32_t world = Q8::kOne << facts_.level;
      const auto [least, most] = std::minmax({at.x, at.y, at.z});
      return least >= kMinOriginWorlds * world && most <= kMaxOriginWorlds * world;
    };
    const std::string limits =
        concat(kMinOriginWorlds * side(), " to ", kMaxOriginWorlds * side(), " (-4 to 5 world sizes)");
    for (const SceneText::PlacedLight& each : text_.lights) {
      fail_if(each.light.is_point && !in_reach(each.light.place), each.place,
              "the lamp is outside the accepted ", limits);
    }
    if (text_.camera) {
      const Vec3Q8& eye = text_.camera->eye;
      fail_if(!in_reach({eye.x.raw, eye.y.raw, eye.z.raw}), text_.camera_place,
              "the eye of the camera is outside the accepted ", limits);
      Camera camera;
      fail_if(set_camera(*text_.camera, 1, 1, facts_.level, &camera) == Status::kBadArgument,
              text_.camera_place, "up of the camera is parallel to the direction of view");
    }
    if (text_.water) {
      const SceneText::WaterArea& water = *text_.water;
      const bool fits = !water.from_to || ((*water.from_to)[2] <= side() && (*water.from_to)[3] <= side());
      fail_if(!fits || water.level_q8 > side() * Q8::kOne, water.place, "the water leaves the world of ",
              side(), " voxels a side (depth ", facts_.level, ")");
    }
  }

  // The first name that a surface has is the one that it keeps.
  std::uint8_t named_material(const SceneText::NamedSurface& named, const Surface& surface,
                              const TextPlace& place) {
    const std::uint8_t material = world_material(surface, place);
    facts_.lighting->material_names.emplace(material, named.name);
    return material;
  }

  std::uint8_t world_material(const Surface& surface, const TextPlace& place) {
    const auto begin = facts_.lighting->surfaces.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(materials_);
    const auto found = std::find(begin, end, surface);
    if (found == end) {
      fail_if(materials_ == kMaxSurfaces, place, "with this the scene has more than the limit of ",
              kMaxSurfaces, " different materials");
      facts_.lighting->surfaces[materials_] = surface;
      facts_.palette[materials_] = material_of(surface);
      return static_cast<std::uint8_t>(materials_++);
    }
    return static_cast<std::uint8_t>(found - begin);
  }

  void merge_palettes() {
    for (Placement& each : placements_) {
      const SceneText::Part& part = *each.part;
      if (each.model == nullptr) {
        const SceneText::NamedSurface& named = text_.materials[part.material];
        each.material[0] = named_material(named, named.surface, part.place);
        continue;
      }
      const LitDescription lit = each.model->source->lighting();
      for (std::size_t index = 0; index < 256; ++index) {
        if (!each.model->used.is[index]) {
          continue;
        }
        Surface surface = lit.surfaces[index];
        if (part.replaces && part.replaced[index] >= 0) {
          const auto& named = text_.materials[static_cast<std::size_t>(part.replaced[index])];
          const Rgb8 own = surface.albedo;
          surface = named.surface;
          surface.albedo = named.has_color ? surface.albedo : own;
          each.material[index] = named_material(named, surface, part.place);
          continue;
        }
        each.material[index] = world_material(surface, part.place);
      }
    }
  }

  void make_lighting() {
    for (const SceneText::PlacedLight& each : text_.lights) {
      facts_.lighting->lights.push_back(each.light);
    }
    facts_.lighting->rest = text_.rest;
    facts_.lighting->has_own_ambient = text_.has_ambient;
    facts_.lighting->on = text_.on | (text_.has_ambient ? Effect::kDirectLight & ~text_.off : Effect::kNone);
    facts_.lighting->off = text_.off;
    if (text_.water) {
      const SceneText::WaterArea& water = *text_.water;
      const std::array<std::int32_t, 4> plan = water.from_to.value_or(std::array{0, 0, side(), side()});
      facts_.lighting->rest.has_water = true;
      facts_.lighting->rest.water = still_water({plan[0], plan[1], water.floor}, plan[2] - plan[0],
                                                plan[3] - plan[1], water.level_q8 - water.floor * Q8::kOne);
    }
  }

  SceneText text_;
  std::vector<Placement> placements_;  // of the parts
  SourceFacts facts_;
  std::size_t materials_ = 0;
  std::uint64_t surveyed_ = 0;  // voxels of models
};

}  // namespace

std::unique_ptr<SceneSource> open_text_scene(const SceneText& text, const SceneArguments& arguments,
                                             SceneOpening* opening, const Progress& progress) {
  SceneOpening outermost;
  SceneOpening* const all = opening != nullptr ? opening : &outermost;
  const std::string path = canonical_path(arguments.scene);
  fail_if(std::find(all->path.begin(), all->path.end(), path) != all->path.end(),
          "this scene is a model of itself");
  fail_if(all->path.size() == kMostNestedScenes, "scenes stand within scenes deeper than the limit of ",
          kMostNestedScenes);
  all->path.push_back(path);
  const auto scene = std::make_shared<const TextScene>(text, arguments, all, progress);
  all->path.pop_back();
  auto source = std::make_unique<SceneSource>(
      scene->facts(),
      [scene](const VisitBlock& visit, const Progress& /*progress*/) { scene->stream_blocks(visit); });
  scene->add_models_to(source.get());
  return source;
}

}  // namespace thimble::tools
