#include "scene/baking.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <new>

#include "readers/oct.h"
#include "scene/built_scene.h"
#include "scene/generators.h"
#include "scene/host_memory.h"
#include "thimble/octree.h"

namespace thimble::tools {
namespace {

// Colours up to the last one that the tree uses.
std::vector<Rgb8> used_palette(const SceneSource& source, const CompactTree& tree) {
  int last = tree.uniform_material();
  if (tree.many_materials()) {
    last = 0;
    for_each_block(tree,
                   [&](const Vec3i&, int, std::uint8_t material) { last = std::max<int>(last, material); });
  }
  std::vector<Rgb8> palette;
  for (int index = 0; index <= last && !tree.empty(); ++index) {
    const Rgb color = source.palette()[static_cast<std::size_t>(index)].color;
    palette.push_back({color.r, color.g, color.b});
  }
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

// The parts of a baked scene around a tree.
class Assembly {
 public:
  Assembly(const SceneSource& source, const BakingOptions& options, const CompactTree& tree)
      : palette_(used_palette(source, tree)), name_(cut_off(options.name)) {
    parts_.tree = {tree.bytes(), tree.size_bytes()};
    parts_.palette = {palette_.data(), palette_.size()};
    parts_.name = {reinterpret_cast<const std::uint8_t*>(name_.data()), name_.size()};
    if (options.camera) {
      camera_ = options.camera(tree.level(), tree.bounds());
      parts_.camera = &camera_;
    }
  }
  Assembly(const Assembly&) = delete;
  Assembly& operator=(const Assembly&) = delete;

  std::size_t bytes() const { return baked_bytes(parts_); }

  void write(Baked* result) const {
    const std::size_t size = bytes();
    if (size == SIZE_MAX) {
      throw InputError("too large to be baked: a baked scene holds less than 4 GiB");
    }
    result->bytes.resize(size);
    if (bake(parts_, {result->bytes.data(), size}) != Status::kOk ||
        BakedScene::open({result->bytes.data(), size}, &result->scene) != Status::kOk) {
      throw InputError("internal error: the scene cannot be baked");
    }
  }

 private:
  std::vector<Rgb8> palette_;
  std::string name_;
  SceneCamera camera_;
  BakedParts parts_;
};

// A pool that can be set back to where it was.
class Coarsener {
 public:
  Coarsener(const SceneSource& source, const Progress& progress) : memory_(HostMemory::largest()) {
    if (octree_.init(memory_.bytes(), source.level()) != Status::kOk) {
      throw InputError("internal error: no pool to coarsen in");
    }
    const auto insert = [&](const Vec3i& at, int level, std::uint8_t material) {
      // As BuiltScene does: in a point set the greatest material wins.
      if (source.is_point_set() && !source.single_material() && octree_.material(at) >= material) {
        return;
      }
      if (octree_.insert_block(at, level, material) != Status::kOk) {
        throw InputError("the scene does not fit into this machine's memory");
      }
    };
    if (const BakedScene* baked = source.baked()) {
      for_each_block(baked->tree(), insert);
    } else {
      source.stream(
          [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
            insert({x, y, z}, 0, material);
          },
          progress);
    }
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
  bool coarsen_to(std::uint64_t nodes) {
    return octree_.coarsen_to(static_cast<std::size_t>(nodes)) == Status::kOk;
  }
  /// The pool as a compact tree; 0 bytes where it is too large for one.
  std::size_t tree_bytes() const { return compact_bytes(compact_shape(octree_)); }
  std::vector<std::uint8_t> tree() const {
    std::vector<std::uint8_t> bytes(tree_bytes());
    std::size_t written = 0;
    if (bytes.empty() ||
        compact_from_octree(octree_, {bytes.data(), bytes.size()}, &written) != Status::kOk) {
      throw InputError("internal error: the coarsened tree cannot be written");
    }
    return bytes;
  }

 private:
  HostMemory memory_;
  Octree octree_;
  Octree kept_;
  std::vector<std::uint8_t> kept_bytes_;
  std::uint64_t most_bytes_ = 0;
};

// The largest tree of at most `limit` bytes that merging gives, or the smallest of all. Coarsening is nested:
// what a larger pool merges, a smaller one merges too, so each trial starts from the last that was too large.
std::vector<std::uint8_t> coarsened_tree(const SceneSource& source, std::uint64_t limit,
                                         std::uint64_t* work_bytes, const Progress& progress) {
  Coarsener pool(source, progress);
  std::uint64_t low = 1;                            // tried, or the least there is
  std::uint64_t high = pool.octree().nodes_used();  // too large
  std::vector<std::uint8_t> best;
  const auto attempt = [&](std::uint64_t nodes) {
    if (!pool.coarsen_to(nodes)) {
      throw InputError("internal error: the tree does not coarsen");
    }
    const std::size_t size = pool.tree_bytes();
    if (size != 0 && size <= limit) {
      best = pool.tree();
      return true;
    }
    return false;
  };
  // The first guess by proportion: most of the search then works on a tree near the right size.
  const std::size_t full = pool.tree_bytes();
  std::uint64_t guess =
      full == 0 ? high / 2
                : static_cast<std::uint64_t>(static_cast<double>(high) * static_cast<double>(limit) /
                                             static_cast<double>(full));
  while (low + 1 < high) {
    guess = std::clamp(guess, low + 1, high - 1);
    if (attempt(guess)) {
      low = guess;
      pool.restore();
    } else {
      high = std::min<std::uint64_t>(guess, std::max<std::uint64_t>(pool.octree().nodes_used(), low + 1));
      pool.save();
    }
    guess = low + (high - low) / 2;
  }
  if (best.empty()) {
    attempt(1);
    best = pool.tree();
  }
  *work_bytes = pool.most_bytes();
  return best;
}

}  // namespace

Baked bake_scene(const SceneSource& source, const BakingOptions& options, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  Baked result;
  const std::uint64_t limit = options.limit_bytes.value_or(UINT32_MAX);
  // What stands around the tree takes the same room whatever the tree, or less: merging can only leave
  // materials unused.
  std::uint64_t around = 0;
  {
    const BuiltScene built(source, {}, progress);
    const Assembly assembly(source, options, built.compact());
    around = assembly.bytes() - built.compact().size_bytes();
    result.work_bytes = built.high_water_bytes();
    result.fits = assembly.bytes() <= limit;
    if (result.fits || !options.coarsen) {
      assembly.write(&result);
    }
  }
  if (!result.fits && options.coarsen) {
    const std::vector<std::uint8_t> bytes =
        coarsened_tree(source, limit > around ? limit - around : 0, &result.work_bytes, progress);
    CompactTree tree;
    if (CompactTree::open({bytes.data(), bytes.size()}, &tree) != Status::kOk) {
      throw InputError("internal error: the coarsened tree does not open");
    }
    const Assembly assembly(source, options, tree);
    result.fits = assembly.bytes() <= limit;
    assembly.write(&result);
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

std::string scene_name(const std::string& scene) {
  if (parse_generator(scene)) {
    return scene;
  }
  return std::filesystem::path(scene).filename().string();
}

}  // namespace thimble::tools
