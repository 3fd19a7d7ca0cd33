#include "scene/baking.h"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "output/units.h"
#include "readers/oct.h"
#include "scene/backdrop.h"
#include "scene/board_fit.h"
#include "scene/built_scene.h"
#include "scene/default_look.h"
#include "scene/generators.h"
#include "scene/named_scenes.h"
#include "thimble/light/render.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/octree.h"

namespace thimble::tools {
namespace {

// Colours up to the last one that the tree uses.
std::vector<Rgb8> used_palette(const SceneSource& source, const CompactTree& tree) {
  const UsedMaterials used = used_materials(tree);
  int last = 255;
  while (last > 0 && !used.is[static_cast<std::size_t>(last)]) {
    --last;
  }
  std::vector<Rgb8> palette = colors_of(source.palette());
  palette.resize(tree.empty() ? 0 : static_cast<std::size_t>(last) + 1);
  return palette;
}

// The largest front of `text` within the limit that ends between two characters of UTF-8.
std::string cut_off(std::string text) {
  if (text.size() > kMaxNameBytes) {
    std::size_t size = kMaxNameBytes;
    while (size > 0 && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) {
      --size;
    }
    text.resize(size);
  }
  return text;
}

// In front of the first section, the tree.
constexpr std::size_t kFrontBytes = (kBakedHeaderBytes + kMaxSections * kBakedEntryBytes + 7) / 8 * 8;

// The parts of a baked scene around a tree.
class Assembly {
 public:
  Assembly(const SceneSource& source, const BakingOptions& options, const CompactTree& tree)
      : palette_(used_palette(source, tree)), name_(cut_off(options.name)) {
    parts_.tree = {tree.bytes(), tree.size_bytes()};
    parts_.palette = {palette_.data(), palette_.size()};
    parts_.name = {reinterpret_cast<const std::uint8_t*>(name_.data()), name_.size()};
    if (options.camera) {
      camera_ = options.camera(tree);
      parts_.camera = &camera_;
    }
    LitDescription lit = source.lighting();
    const UsedMaterials used = used_materials(tree);
    const bool by_rule = options.default_look && !options.effects.is_given && options.camera;
    if (by_rule) {
      light_by_rule(source, options, tree, used, &lit);
    } else {
      lit.find_glow(tree);
      effects_ = chosen_effects(lit, used, options.effects);
      if (const std::optional<LookNote> note = source.look_note(); note && !options.effects.is_given) {
        keep(*note);  // baked again
      }
    }
    lighting_ = lighting_section(lit, used, effects_, tree.level());
    parts_.lighting = {lighting_.data(), lighting_.size()};
  }
  Assembly(const Assembly&) = delete;
  Assembly& operator=(const Assembly&) = delete;

  std::size_t bytes() const { return baked_bytes(parts_); }

  /// Adds a brick map of the tree, unless the world has none, is above that level, or all of it would then exceed
  /// `limit`.
  void add_brick_map(const CompactTree& tree, int most_level, std::uint64_t limit) {
    const std::size_t most = most_brick_map_bytes(tree);
    if (tree.empty() || most == 0 || tree.level() > most_level) {
      return;
    }
    // A deep map takes nothing more while it is made, so what would not be kept needs no room.
    const std::uint64_t wanted =
        tree.level() > kMaxBrickMapLevel ? std::min<std::uint64_t>(most, limit) : most;
    map_.resize(static_cast<std::size_t>(wanted / sizeof(std::uint64_t)) + 1);
    std::size_t written = 0;
    const Bytes room{reinterpret_cast<std::uint8_t*>(map_.data()), map_.size() * sizeof(std::uint64_t)};
    if (BrickMap::make(tree, room, nullptr, &written) != Status::kOk) {
      return;  // more bricks than a map has numbers for, or than the limit has room for
    }
    parts_.brick_map = {room.data, written};
    if (bytes() > limit) {
      parts_.brick_map = {};
    }
  }

  /// Into `memory`, in which the tree may lie behind kFrontBytes, where there is room.
  void write(HostMemory memory, Baked* result) const {
    const std::size_t size = bytes();
    fail_if(size == SIZE_MAX, "too large to be baked: a baked scene holds less than 4 GiB");
    result->effects = effects_;
    result->memory = memory.bytes().size < size ? HostMemory(size) : std::move(memory);
    const bool is_made =
        BakedScene::make(parts_, result->memory.bytes().subspan(0, size), nullptr) == Status::kOk;
    result->memory.keep(size);
    result->bytes = {result->memory.bytes().data, size};
    fail_if(!is_made || BakedScene::open({result->bytes.data(), size}, &result->scene) != Status::kOk,
            "internal error: the scene cannot be baked");
  }

 private:
  void light_by_rule(const SceneSource& source, const BakingOptions& options, const CompactTree& tree,
                     const UsedMaterials& used, LitDescription* lit) {
    Framing framing;
    framing.kept = camera_;
    const SceneFacts facts = facts_of(source, *lit, shape_of(source, tree));
    *lit = baked_look(facts, framing);
    if (is_clay(facts)) {
      std::fill(palette_.begin(), palette_.end(), kClay);
      parts_.palette = {palette_.data(), palette_.size()};
    }
    lit->find_glow(tree);
    effects_ = chosen_effects(*lit, used, options.effects);
    if (!options.keeps_look && options.display && effects_ != Effect::kNone) {
      suit(*options.display, tree, used, lit);
    } else if (options.display && effects_ != Effect::kNone && !states_light(facts.lighting)) {
      // Light alone: what the scene states itself is to be found again.
      const LitDescription stated = *lit;
      suit(*options.display, tree, used, lit);
      lit->surfaces = stated.surfaces;
      lit->rest.sky = stated.rest.sky;
      lit->rest.fog = stated.rest.fog;
    }
    const bool many_colors = !options.display || !has_few_grays(options.display->format);
    if (many_colors && effects_ != Effect::kNone && add_baked_sky(facts, lit)) {
      effects_ |= Effect::kSky;
    }
    if (options.keeps_look) {
      keep(note_of(facts));
    }
  }

  void keep(const LookNote& note) {
    look_ = look_section(note);
    parts_.look = {look_.data(), look_.size()};
  }

  void suit(const DisplayFacts& display, const CompactTree& tree, const UsedMaterials& used,
            LitDescription* lit) {
    if (has_few_grays(display.format) && (lit->off & Effect::kEdges) == 0) {
      effects_ |= Effect::kEdges;
    }
    suit_display(display, tree, camera_, parts_.palette, used, effects_, lit);
  }

  std::vector<Rgb8> palette_;
  std::string name_;
  SceneCamera camera_;
  EffectSet effects_ = Effect::kNone;
  std::vector<std::uint8_t> lighting_;
  std::vector<std::uint8_t> look_;
  std::vector<std::uint64_t> map_;  // for its alignment
  BakedParts parts_;
};

// A pool that can be set back to where it was.
class Coarsener {
 public:
  explicit Coarsener(const CompactTree& tree) : memory_(HostMemory::largest()) {
    fail_if(Octree::make(tree.level(), memory_.bytes(), &octree_) != Status::kOk,
            "internal error: no pool to coarsen in");
    // In Morton order, so that the passes over the pool go through memory from front to back.
    walk_blocks(tree, [&](const Vec3i& at, int level, std::uint8_t material) {
      fail_if(octree_.insert_block(at, level, material) != Status::kOk,
              "the scene does not fit into this machine's memory");
    });
    save();
  }

  const Octree& octree() const { return octree_; }
  std::uint64_t most_bytes() const { return most_bytes_; }

  void save() {
    kept_ = octree_;
    const std::size_t used = octree_.high_water_bytes() + alignof(std::uint64_t);
    kept_bytes_.assign(memory_.bytes().data, memory_.bytes().data + std::min(used, memory_.bytes().size));
    most_bytes_ = std::max<std::uint64_t>(most_bytes_, 2 * kept_bytes_.size());
  }
  void restore() {
    octree_ = kept_;
    std::memcpy(memory_.bytes().data, kept_bytes_.data(), kept_bytes_.size());
  }
  void coarsen_at(int step) { octree_.coarsen_at(step); }
  void coarsen_to(std::uint64_t nodes) {
    fail_if(octree_.coarsen_to(static_cast<std::size_t>(nodes)) != Status::kOk,
            "internal error: the tree does not coarsen");
  }
  /// The pool as a compact tree; 0 bytes where it is too large for one.
  std::size_t tree_bytes() const { return compact_bytes(compact_shape(octree_)); }
  std::vector<std::uint8_t> tree() const {
    std::vector<std::uint8_t> bytes(tree_bytes());
    std::size_t written = 0;
    fail_if(bytes.empty() ||
                CompactTree::make(octree_, {bytes.data(), bytes.size()}, nullptr, &written) != Status::kOk,
            "internal error: the coarsened tree cannot be written");
    return bytes;
  }

 private:
  HostMemory memory_;
  Octree octree_;
  Octree kept_;
  std::vector<std::uint8_t> kept_bytes_;
  std::uint64_t most_bytes_ = 0;
};

// A tree of at most `limit` bytes that merging gives, less than 1/1024 of the limit or one merge below it;
// the smallest of all where none is small enough. Coarsening is nested: what a larger pool merges, a smaller
// one merges too, so each trial starts from the last that was too large.
std::vector<std::uint8_t> coarsened_tree(const CompactTree& exact, std::uint64_t limit,
                                         std::uint64_t* work_bytes, const Progress& progress) {
  Coarsener pool(exact);
  std::uint64_t high = pool.octree().nodes_used();  // so many nodes are too many
  std::size_t best_bytes = 0;
  // Whether the pool's tree fits. If so it goes back to the last that did not, else continues from here.
  int trials = 0;
  const auto fits = [&] {
    tell(progress, 1 - 1.0 / (1 + ++trials));
    const std::size_t size = pool.tree_bytes();
    if (size == 0 || size > limit) {
      high = pool.octree().nodes_used();
      pool.save();
      return false;
    }
    best_bytes = size;
    return true;
  };
  // First prices, a pass over the nodes each: the trees are then near the right size for the second search,
  // which needs many.
  int cheap = -1;
  int dear = Octree::kPriceSteps;
  std::uint64_t low = 0;  // so many nodes fit, or none do
  while (cheap + 1 < dear) {
    const int step = cheap + (dear - cheap) / 2;
    pool.coarsen_at(step);
    if (fits()) {
      dear = step;
      low = pool.octree().nodes_used();
      pool.restore();
    } else {
      cheap = step;
    }
  }
  bool by_price = true;
  while (low + 1 < high && (best_bytes == 0 || best_bytes < limit - limit / 1024)) {
    // Of so many nodes at most; a merge may save many at once.
    const std::uint64_t most = low + (high - low) / 2;
    pool.coarsen_to(most);
    if (fits()) {
      low = most;
      by_price = false;
      pool.restore();
    }
  }
  // The best once more, which takes longer to write than to make.
  if (best_bytes != 0 && by_price) {
    pool.coarsen_at(dear);
  } else {
    pool.coarsen_to(std::max<std::uint64_t>(1, low));
  }
  *work_bytes = pool.most_bytes();
  return pool.tree();
}

constexpr std::int32_t kMostLookedAt = 96;
// Of a display of few greys: what its brightest twentieth becomes, and the most exposure; what glares is dimmed by so
// much, and looked at again.
constexpr std::uint32_t kBrightGray = 244;
constexpr std::uint32_t kMostQ8 = 1024;
constexpr std::uint32_t kGlaring = 250;
constexpr std::uint32_t kDimmedQ8 = 144;
constexpr int kMostTurns = 4;

// Greys of what the camera sees that is solid, and of the sky behind it.
GrayCounts seen_grays(const CompactTree& tree, const Camera& camera, const Shading& shading,
                      const LitScene& scene, EffectSet effects) {
  GrayCounts counts;
  std::vector<std::uint8_t> row(static_cast<std::size_t>(camera.width_px()) * 3);
  for (std::int32_t y = 0; y < camera.height_px(); ++y) {
    const Band band{{row.data(), row.size()}, PixelFormat::kRgb888, 0, y, 1};
    if (render_lit_band(effects, tree, camera, shading, scene, band) != Status::kOk) {
      return {};
    }
    for (std::int32_t x = 0; x < camera.width_px(); ++x) {
      Hit hit;
      if ((effects & Effect::kSky) != 0 ||
          (closest_hit(tree, camera.ray(x, y), &hit) == Status::kOk && hit.kind == HitKind::kHit)) {
        const std::uint8_t* const pixel = row.data() + 3 * static_cast<std::size_t>(x);
        ++counts.of[gray_of({pixel[0], pixel[1], pixel[2]})];
      }
    }
  }
  return counts;
}

std::string limit_text(const FlashLimit& limit, EffectSet effects, std::uint64_t bytes) {
  const platform::BoardFacts* const board = limit.board;
  if (board != nullptr && bytes == limit.board_bytes(effects)) {
    if (limit.room) {
      return std::string(board->name) + " has " + grouped(bytes) +
             " bytes of flash for a scene behind the image";
    }
    return std::string(board->name) + " has " + grouped(bytes) + " bytes of flash for a scene (" +
           grouped(board->flash_bytes) + " less " + grouped(code_flash_bytes(*board, effects)) +
           " for the demonstration)";
  }
  return "the limit is " + grouped(bytes) + " bytes (--memory)";
}

// Whether the scene with its light keeps the limit, uncoarsened, and the board can draw it.
bool has_room_for_light(const FlashLimit& limit, const Baked& baked) {
  const platform::BoardFacts* const board = limit.board;
  return baked.fits && baked.bytes.size() <= limit.bytes(baked.effects).value_or(UINT64_MAX) &&
         baked.scene.tree().solid_added() == 0 &&
         (board == nullptr || drawing_ram_bytes(*board, baked.effects) <= board->ram_bytes);
}

}  // namespace

Baked bake_scene(const SceneSource& source, const BakingOptions& options, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  Baked result;
  const std::uint64_t limit = options.limit_bytes.value_or(UINT32_MAX);
  BuildOptions build;
  build.threads = options.threads;
  build.front_bytes =
      kFrontBytes;  // so that the tree, which may be large, becomes a part of the scene where it is
  BuiltScene built(source, build, progress);
  const CompactTree& exact = built.compact();
  Assembly whole(source, options, exact);
  result.work_bytes = built.high_water_bytes();
  result.fits = whole.bytes() <= limit;
  const auto write = [&](Assembly* assembly, const CompactTree& tree, HostMemory memory) {
    if (options.brick_map) {
      assembly->add_brick_map(tree, options.most_map_level, limit);
    }
    assembly->write(std::move(memory), &result);
  };
  if (result.fits || !options.coarsen) {
    write(&whole, exact, built.take_memory());
  } else {
    // What stands around the tree takes the same room whatever the tree, or less: merging can only leave
    // materials unused.
    const std::uint64_t around = whole.bytes() - exact.size_bytes();
    std::uint64_t pool_bytes = 0;
    const std::vector<std::uint8_t> bytes =
        coarsened_tree(exact, limit > around ? limit - around : 0, &pool_bytes, progress);
    result.work_bytes += pool_bytes;
    CompactTree tree;
    fail_if(CompactTree::open({bytes.data(), bytes.size()}, &tree) != Status::kOk,
            "internal error: the coarsened tree does not open");
    Assembly coarse(source, options, tree);
    result.fits = coarse.bytes() <= limit;
    write(&coarse, tree, {});
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

std::string scene_name(const std::string& scene) {
  return parse_generator(scene) ? scene : utf8_text(file_name(scene));
}

bool has_few_grays(PixelFormat format) {
  return is_gray(format) && format != PixelFormat::kGray8;
}

void suit_display(const DisplayFacts& display, const CompactTree& tree, const SceneCamera& camera,
                  Span<const Rgb8> palette, const UsedMaterials& used, EffectSet effects,
                  LitDescription* lit) {
  Camera view;
  if (set_camera(camera, display.width_px, display.height_px, tree.level(), &view) != Status::kOk) {
    return;
  }
  const std::int32_t longest = std::max(display.width_px, display.height_px);
  const Camera looked = view.thinned((longest + kMostLookedAt - 1) / kMostLookedAt);
  Shading shading;
  shading.palette = palette;
  const bool few = has_few_grays(display.format);
  // What glares is one white: how bright it is shows when it is dimmed.
  for (int turn = 0; turn < kMostTurns; ++turn) {
    const LitScene scene = lit_scene_for(*lit, used, effects);
    const std::uint32_t gray =
        bright_gray(seen_grays(tree, looked, shading, scene, effects & ~Effect::kEdges), few ? 20 : 10);
    if (gray == 0) {
      return;
    }
    const bool glares = few && gray >= kGlaring;
    const std::uint32_t exposure =
        glares ? kDimmedQ8
        : few  ? std::min(kBrightGray * 256 / gray, kMostQ8)
               : std::clamp(kExposedGray * 256 / gray, kLeastExposureQ8, kMostExposureQ8);
    expose_light(exposure, used, lit);
    if (!glares) {
      return;
    }
  }
}

std::uint64_t FlashLimit::board_bytes(EffectSet effects) const {
  return room ? room(effects) : scene_flash_bytes(*board, effects);
}

std::optional<std::uint64_t> FlashLimit::bytes(EffectSet effects) const {
  if (board == nullptr) {
    return memory_bytes;
  }
  return std::min(board_bytes(effects), memory_bytes.value_or(UINT64_MAX));
}

Baked bake_within(const FlashLimit& limit, const SceneSource& source, BakingOptions* options,
                  const Progress& progress) {
  const bool coarsen = options->coarsen;
  options->coarsen = false;
  Baked baked = bake_scene(source, *options, progress);
  const auto keep_limit = [&] {
    // With the code of its effects it does not fit: without a brick map, or not at all.
    options->limit_bytes = limit.bytes(baked.effects);
    if (options->limit_bytes && (!baked.fits || baked.bytes.size() > *options->limit_bytes)) {
      baked = bake_scene(source, *options, progress);
    }
  };
  keep_limit();
  if (options->default_look && baked.effects != Effect::kNone && !has_room_for_light(limit, baked)) {
    options->default_look = false;  // light that nobody asked for never costs a scene its place
    options->limit_bytes = limit.bytes();
    baked = bake_scene(source, *options, progress);
    keep_limit();
  }
  options->coarsen = coarsen;
  if (coarsen && !baked.fits) {
    baked = bake_scene(source, *options, progress);
  }
  return baked;
}

std::string too_large_text(const FlashLimit& limit, const Baked& baked, const BakingOptions& options,
                           int level) {
  const std::uint64_t most = options.limit_bytes.value_or(UINT64_MAX);
  const std::uint64_t over = baked.bytes.size() - most;
  return concat(options.coarsen ? "even the coarsest tree takes " : "takes ", grouped(baked.bytes.size()),
                " bytes at depth ", level, ", ", limit_text(limit, baked.effects, most), ": ",
                counted(over, "byte"), " too many");
}

}  // namespace thimble::tools
