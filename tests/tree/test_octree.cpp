// The mutable octree, held to a map of voxels, to the canonical tree built from that map by recursion, and to
// a coarsening that searches the whole tree for the cheapest merge at every step.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "support/counts.h"
#include "support/scene_under_test.h"
#include "thimble/tree/octree.h"

namespace thimble::tests {
namespace {

const int kEffort = many_or_few(6, 1);

using Random = std::mt19937_64;
/// Morton index -> material.
using Model = std::map<std::uint64_t, std::uint8_t>;

std::int32_t below(Random& random, std::int32_t bound) {
  return static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(bound));
}

std::uint64_t morton(const Vec3i& p) {
  return morton_code(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y),
                     static_cast<std::uint32_t>(p.z));
}

/// A tree as plain as can be.
struct Ref {
  int level = 0;
  std::uint32_t mask = 0;  // 0: solid
  int material = 0;
  bool merged = false;
  std::uint64_t piece = 1;    // volume of the piece that a solid block's material comes from
  std::vector<Ref> children;  // in octant order
};

std::uint64_t volume(int level) {
  return std::uint64_t{1} << (3 * level);
}

std::size_t count_nodes(const Ref& ref) {
  std::size_t count = 1;
  for (const Ref& child : ref.children) {
    count += count_nodes(child);
  }
  return count;
}

std::uint64_t count_solid(const Ref& ref) {
  if (ref.mask == 0) {
    return volume(ref.level);
  }
  if (ref.level == 1) {
    return static_cast<std::uint64_t>(__builtin_popcount(ref.mask));
  }
  std::uint64_t total = 0;
  for (const Ref& child : ref.children) {
    total += count_solid(child);
  }
  return total;
}

bool collapses(const Ref& ref) {
  return ref.mask == 255 && ref.children.size() == 8 &&
         std::all_of(ref.children.begin(), ref.children.end(), [&](const Ref& child) {
           return child.mask == 0 && child.material == ref.children[0].material &&
                  child.merged == ref.children[0].merged;
         });
}

void make_solid(Ref& ref, int material, bool merged, std::uint64_t piece) {
  ref.mask = 0;
  ref.material = material;
  ref.merged = merged;
  ref.piece = piece;
  ref.children.clear();
}

void normalise(Ref& ref) {
  for (Ref& child : ref.children) {
    normalise(child);
  }
  if (collapses(ref)) {
    const Ref first = ref.children[0];
    std::uint64_t piece = first.merged ? 0 : volume(ref.level);
    for (const Ref& child : ref.children) {
      piece = std::max(piece, child.piece);
    }
    make_solid(ref, first.material, first.merged, piece);
  }
}

/// The canonical tree of the voxels [first, last) of a model, all in one block of `level`.
Ref canonical(Model::const_iterator first, Model::const_iterator last, int level) {
  Ref ref;
  ref.level = level;
  ref.material = first->second;
  const bool uniform =
      std::all_of(first, last, [&](const auto& voxel) { return voxel.second == first->second; });
  const std::uint64_t start = first->first & ~(volume(level) - 1);
  if (level == 0) {
    return ref;
  }
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    const std::uint64_t end = start + (octant + 1) * volume(level - 1);
    Model::const_iterator next = first;
    while (next != last && next->first < end) {
      ++next;
    }
    if (next != first) {
      ref.mask |= 1U << octant;
      if (level > 1 || !uniform) {
        ref.children.push_back(canonical(first, next, level - 1));
      }
    }
    first = next;
  }
  ref.piece = static_cast<std::uint64_t>(__builtin_popcount(ref.mask));
  if (level == 1 && ref.mask == 255 && uniform) {
    make_solid(ref, ref.material, false, 8);
  }
  if (collapses(ref)) {
    make_solid(ref, ref.children[0].material, false, volume(level));
  }
  return ref;
}

Ref canonical(const Model& model, int level) {
  return canonical(model.begin(), model.end(), level);
}

void describe(const Ref& ref, std::string& text) {
  if (ref.mask == 0) {
    text += (ref.merged ? "M" : "S") + std::to_string(ref.material);
    return;
  }
  text += "(" + std::to_string(ref.mask);
  if (ref.children.empty()) {
    text += ":" + std::to_string(ref.material);
  }
  for (const Ref& child : ref.children) {
    text += " ";
    describe(child, text);
  }
  text += ")";
}

/// The tree in the pool, read through the public views only.
Ref read(const Octree& tree, std::uint32_t index, int level) {
  const Octree::NodeView view = tree.node(index);
  Ref ref;
  ref.level = level;
  ref.mask = view.mask;
  ref.material = view.material;
  ref.merged = view.merged;
  CHECK(view.has_children == (view.first_child != Octree::kNone));
  CHECK(view.solid() == (view.mask == 0));
  if (view.has_children) {
    std::uint32_t next = view.first_child;
    for (int octant = 0; octant < 8; ++octant) {
      const std::uint32_t child = tree.child(view, octant);
      CHECK((child != Octree::kNone) == ((view.mask >> octant & 1) != 0));
      if (child != Octree::kNone) {
        CHECK(child == next);
        ref.children.push_back(read(tree, child, level - 1));
        next = tree.node(child).next;
      }
    }
    CHECK(next == Octree::kNone);
  }
  return ref;
}

std::string text_of(const Ref& ref) {
  std::string text;
  describe(ref, text);
  return text;
}

std::string text_of(const Octree& tree) {
  return tree.empty() ? std::string("empty") : text_of(read(tree, tree.root(), tree.level()));
}

std::string text_of(const Model& model, int level) {
  return model.empty() ? std::string("empty") : text_of(canonical(model, level));
}

std::size_t nodes_of(const Model& model, int level) {
  return model.empty() ? 0 : count_nodes(canonical(model, level));
}

/// The tree holds exactly the model, in its canonical form.
void check_same(const Octree& tree, const Model& model) {
  CHECK(text_of(tree) == text_of(model, tree.level()));
  CHECK(tree.voxels() == model.size());
  CHECK(tree.nodes_used() == nodes_of(model, tree.level()));
  CHECK(tree.nodes_free() + tree.nodes_used() == tree.capacity());
  CHECK(tree.nodes_used() <= tree.nodes_high_water());
  CHECK(tree.nodes_high_water() <= tree.capacity());
}

void check_holds(const Octree& tree, const Model& model) {
  std::size_t missing = 0;
  for (const auto& [index, material] : model) {
    missing += tree.test(morton_voxel(index)) ? 0U : 1U;
  }
  CHECK(missing == 0);
}

/// As many bytes as so many nodes take; the sanitized build sees what is written beside them.
HeapBytes pool_of(std::size_t nodes) {
  return HeapBytes(Octree::octree_bytes(nodes));
}

/// One change of a tree, and the same of a model.
struct Change {
  enum class Kind { kInsert, kRemove, kBlock } kind = Kind::kInsert;
  Vec3i at;
  std::uint8_t material = 0;
  int block_level = 0;

  Status apply(Octree& tree) const {
    switch (kind) {
      case Kind::kInsert:
        return tree.insert(at, material);
      case Kind::kRemove:
        return tree.remove(at);
      case Kind::kBlock:
        break;
    }
    return tree.insert_block(at, block_level, material);
  }
  void apply(Model& model) const {
    const std::uint64_t first = morton(at);
    if (kind == Kind::kRemove) {
      model.erase(first);
      return;
    }
    const std::uint64_t count = kind == Kind::kBlock ? volume(block_level) : 1;
    for (std::uint64_t index = first; index < first + count; ++index) {
      model[index] = material;
    }
  }
};

/// Changes that dwell in one small region for a while, so that blocks fill, split and empty.
std::vector<Change> random_changes(Random& random, int level, int materials, int count) {
  std::vector<Change> changes;
  const int side = 1 << level;
  Vec3i corner;
  int spread = side;
  int remove_share = 40;
  for (int i = 0; i < count; ++i) {
    if (i % 64 == 0) {
      spread = 1 << (1 + below(random, std::min(level, 3)));
      corner = {below(random, side) & ~(spread - 1), below(random, side) & ~(spread - 1),
                below(random, side) & ~(spread - 1)};
      remove_share = below(random, 100);
    }
    Change change;
    change.at = {corner.x + below(random, spread), corner.y + below(random, spread),
                 corner.z + below(random, spread)};
    change.material = static_cast<std::uint8_t>(below(random, materials));
    if (below(random, 100) < remove_share) {
      change.kind = Change::Kind::kRemove;
    } else if (below(random, 12) == 0) {
      change.kind = Change::Kind::kBlock;
      change.block_level = below(random, std::min(level, 3) + 1);
      const int mask = ~((1 << change.block_level) - 1);
      change.at = {change.at.x & mask, change.at.y & mask, change.at.z & mask};
    }
    changes.push_back(change);
  }
  return changes;
}

Model random_model(Random& random, int level, int materials, int count) {
  Model model;
  for (const Change& change : random_changes(random, level, materials, count)) {
    change.apply(model);
  }
  return model;
}

void fill(Octree& tree, const Model& model) {
  for (const auto& [index, material] : model) {
    REQUIRE(tree.insert(morton_voxel(index), material) == Status::kOk);
  }
}

// --- coarsening, the slow way ---------------------------------------------------------------------------

struct Candidate {
  Ref* ref = nullptr;
  std::uint64_t added = 0;
  std::uint64_t saved = 1;
};

/// The least added / saved, the first in post-order on a tie.
void find_cheapest(Ref& ref, Candidate& best) {
  for (Ref& child : ref.children) {
    find_cheapest(child, best);
  }
  const std::uint64_t saved = count_nodes(ref) - 1;
  if (saved == 0) {
    return;
  }
  const std::uint64_t added = volume(ref.level) - count_solid(ref);
  if (best.ref == nullptr || added * best.saved < best.added * saved) {
    best = {&ref, added, saved};
  }
}

/// The largest piece of one material, the first in Morton order on a tie.
void find_piece(const Ref& ref, std::uint64_t& piece, int& material) {
  if (ref.children.empty() && ref.piece > piece) {
    piece = ref.piece;
    material = ref.material;
  }
  for (const Ref& child : ref.children) {
    find_piece(child, piece, material);
  }
}

/// Merges until at most `max_nodes` are left; returns the added volume.
std::uint64_t coarsen_slowly(Ref& root, std::size_t max_nodes) {
  std::uint64_t added = 0;
  while (count_nodes(root) > max_nodes) {
    Candidate best;
    find_cheapest(root, best);
    std::uint64_t piece = 0;
    int material = 0;
    find_piece(*best.ref, piece, material);
    make_solid(*best.ref, material, true, piece);
    normalise(root);
    added += best.added;
  }
  return added;
}

constexpr int kMergedCell = 1000;

/// What each voxel is: -1 empty, else its material, plus kMergedCell in a merged block.
void flatten(const Ref& ref, std::uint64_t first, std::vector<int>& cells) {
  if (ref.mask == 0) {
    for (std::uint64_t index = first; index < first + volume(ref.level); ++index) {
      cells[index] = ref.material + (ref.merged ? kMergedCell : 0);
    }
    return;
  }
  auto child = ref.children.begin();
  for (std::uint64_t octant = 0; octant < 8; ++octant) {
    if ((ref.mask >> octant & 1) == 0) {
      continue;
    }
    const std::uint64_t start = first + octant * volume(ref.level - 1);
    if (ref.children.empty()) {
      cells[start] = ref.material;
    } else {
      flatten(*child++, start, cells);
    }
  }
}

std::vector<int> cells_of(const Octree& tree) {
  std::vector<int> cells(volume(tree.level()), -1);
  if (!tree.empty()) {
    flatten(read(tree, tree.root(), tree.level()), 0, cells);
  }
  return cells;
}

}  // namespace

TEST_CASE("octree: random inserts, removals and blocks -> the canonical tree of the model, in every world") {
  for (int level = 1; level <= 6; ++level) {
    for (const int materials : {1, 2, 256}) {
      const std::uint64_t seed = static_cast<std::uint64_t>(level * 1000 + materials);
      CAPTURE(seed);
      Random random(seed);
      const HeapBytes pool = pool_of(40000);
      Octree tree;
      REQUIRE(Octree::make(level, pool.span(), &tree) == Status::kOk);
      Model model;
      int step = 0;
      std::size_t wrong = 0;
      for (const Change& change : random_changes(random, level, materials, 600 * kEffort)) {
        REQUIRE(change.apply(tree) == Status::kOk);
        change.apply(model);
        for (int probe = 0; probe < 4; ++probe) {
          const int side = 1 << level;
          const Vec3i at =
              probe == 0 ? change.at : Vec3i{below(random, side), below(random, side), below(random, side)};
          const auto found = model.find(morton(at));
          wrong += tree.test(at) != (found != model.end()) ? 1U : 0U;
          wrong += tree.material(at) != (found != model.end() ? found->second : -1) ? 1U : 0U;
        }
        if (++step % 25 == 0) {
          check_same(tree, model);
        }
      }
      CHECK(wrong == 0);
      check_same(tree, model);
      CHECK(tree.solid_added() == 0);
    }
  }
}

TEST_CASE(
    "octree: every pool from no node to enough -> refused exactly when the result does not fit, unchanged") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const int level = 1 + static_cast<int>(seed % 4);
    const std::vector<Change> changes =
        random_changes(random, level, 1 + static_cast<int>(seed % 3), 20 * kEffort);
    std::size_t enough = 1;
    Model whole;
    for (const Change& change : changes) {
      change.apply(whole);
      enough = std::max(enough, nodes_of(whole, level));
    }
    for (std::size_t nodes = 0; nodes <= enough; ++nodes) {
      const HeapBytes pool = pool_of(nodes);
      Octree tree;
      REQUIRE(Octree::make(level, pool.span(), &tree) == Status::kOk);
      REQUIRE(tree.capacity() == nodes);
      Model model;
      for (const Change& change : changes) {
        Model changed = model;
        change.apply(changed);
        const HeapBytes before(pool.view());
        const std::uint64_t voxels = tree.voxels();
        const std::uint32_t used = tree.nodes_used();
        const Status status = change.apply(tree);
        if (nodes_of(changed, level) <= nodes) {
          REQUIRE(status == Status::kOk);
          model = changed;
        } else {
          REQUIRE(status == Status::kOutOfMemory);
          CHECK(pool == before);
          CHECK(tree.voxels() == voxels);
          CHECK(tree.nodes_used() == used);
        }
      }
      check_same(tree, model);
    }
  }
}

TEST_CASE("octree: coarsening to every size -> what the slow greedy search makes, node by node") {
  for (std::uint64_t seed = 1; seed <= 40U * static_cast<unsigned>(kEffort); ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const int level = 1 + below(random, 5);
    const int materials = seed % 2 == 0 ? 1 : 3;
    Model model = random_model(random, level, materials, 10 + below(random, 150));
    for (int scattered = below(random, 40); scattered > 0; --scattered) {
      model[random() % volume(level)] = static_cast<std::uint8_t>(below(random, materials));
    }
    if (model.empty()) {
      continue;
    }
    const std::size_t all = nodes_of(model, level);
    const HeapBytes step_pool = pool_of(all + 8 * static_cast<std::size_t>(level));
    Octree stepwise;
    REQUIRE(Octree::make(level, step_pool.span(), &stepwise) == Status::kOk);
    fill(stepwise, model);
    for (std::size_t max_nodes = all; max_nodes >= 1; max_nodes -= 1 + max_nodes / 8) {
      CAPTURE(max_nodes);
      Ref expected = canonical(model, level);
      const std::uint64_t added = coarsen_slowly(expected, max_nodes);
      const HeapBytes pool = pool_of(all + 8 * static_cast<std::size_t>(level));
      Octree tree;
      REQUIRE(Octree::make(level, pool.span(), &tree) == Status::kOk);
      fill(tree, model);
      REQUIRE(tree.coarsen_to(max_nodes) == Status::kOk);
      REQUIRE(text_of(tree) == text_of(expected));
      CHECK(tree.nodes_used() == count_nodes(expected));
      CHECK(tree.solid_added() == added);
      CHECK(tree.voxels() == model.size() + added);
      check_holds(tree, model);
      // In one step or in many, the same.
      REQUIRE(stepwise.coarsen_to(max_nodes) == Status::kOk);
      REQUIRE(text_of(stepwise) == text_of(expected));
      CHECK(stepwise.solid_added() == added);
    }
  }
}

TEST_CASE("octree: edits between coarsenings -> only the edit changes, and the tree stays canonical") {
  for (std::uint64_t seed = 1; seed <= 20U * static_cast<unsigned>(kEffort); ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const int level = 1 + static_cast<int>(seed % 3);
    const int materials = 1 + static_cast<int>(seed % 4);
    const HeapBytes pool = pool_of(10 + static_cast<std::size_t>(below(random, 200)));
    Octree tree;
    REQUIRE(Octree::make(level, pool.span(), &tree) == Status::kOk);
    for (const Change& change : random_changes(random, level, materials, 300)) {
      std::vector<int> before = cells_of(tree);
      bool wrong = false;
      if (below(random, 10) == 0) {
        const std::uint64_t added = tree.solid_added();
        const std::uint64_t voxels = tree.voxels();
        const std::size_t target = 1 + static_cast<std::size_t>(below(random, 60));
        REQUIRE(tree.coarsen_to(target) == Status::kOk);
        CHECK(tree.nodes_used() <= target);
        CHECK(tree.voxels() - voxels == tree.solid_added() - added);
        const std::vector<int> merged = cells_of(tree);
        for (std::size_t i = 0; i < merged.size(); ++i) {
          wrong = wrong || (merged[i] != before[i] && merged[i] < kMergedCell);
        }
        before = merged;
      }
      const Status status = change.apply(tree);
      const std::vector<int> after = cells_of(tree);
      if (status == Status::kOk) {
        const std::uint64_t first = morton(change.at);
        const std::uint64_t count =
            change.kind == Change::Kind::kBlock ? volume(change.block_level) : std::uint64_t{1};
        for (std::uint64_t index = 0; index < before.size(); ++index) {
          if (index < first || index >= first + count) {
            // The other seven of a merged block that lost a voxel are single voxels from then on.
            const bool neighbour = index / 8 == first / 8 && before[index] >= kMergedCell;
            wrong = wrong || (neighbour ? after[index] % kMergedCell != before[index] % kMergedCell
                                        : after[index] != before[index]);
          } else if (change.kind == Change::Kind::kRemove) {
            wrong = wrong || after[index] != -1;
          } else {
            // Inside a merged block nothing changes.
            wrong = wrong ||
                    (after[index] != change.material && (after != before || before[first] < kMergedCell));
          }
        }
      } else {
        CHECK(status == Status::kOutOfMemory);
        CHECK(after == before);
      }
      CHECK_FALSE(wrong);
      if (!tree.empty()) {
        Ref ref = read(tree, tree.root(), level);
        CHECK(count_nodes(ref) == tree.nodes_used());
        CHECK(count_solid(ref) == tree.voxels());
        const std::string text = text_of(ref);
        normalise(ref);
        CHECK(text_of(ref) == text);
      }
    }
  }
}

TEST_CASE(
    "octree: merging makes eight merged blocks of one material -> one block, and edits elsewhere stay "
    "right") {
  const HeapBytes pool = pool_of(200);
  Octree tree;
  REQUIRE(Octree::make(3, pool.span(), &tree) == Status::kOk);
  // One 4 x 4 x 4 block of eight voxel nodes, each of material 1 but for its last voxel.
  for (std::uint64_t index = 0; index < 64; ++index) {
    REQUIRE(tree.insert(morton_voxel(index), index % 8 == 7 ? 2 : 1) == Status::kOk);
  }
  REQUIRE(tree.insert({7, 7, 7}, 3) == Status::kOk);
  CHECK(tree.nodes_used() == 1 + 1 + 8 * 9 + 2);
  REQUIRE(tree.coarsen_to(1 + 1 + 8 + 2) == Status::kOk);
  CHECK(text_of(tree) == "(129 M1 (128 (128:3)))");
  CHECK(tree.insert({6, 7, 7}, 3) == Status::kOk);
  CHECK(text_of(tree) == "(129 M1 (128 (192:3)))");
  CHECK(tree.solid_added() == 0);
}

}  // namespace thimble::tests
