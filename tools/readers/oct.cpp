// `.oct`: scenes baked by `thimble bake` (src/FORMAT.md). The one reader that hands over a tree, because that is what the
// file holds; nothing is rebuilt or copied. Every byte is validated, so what comes back is sound; but of a mapped file only what
// walks rely on, so that it opens at once.
#include "readers/oct.h"

#include "readers/formats.h"
#include "thimble/light/scene.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kVersionOffset = 3;
constexpr std::size_t kSizeOffset = 4;

std::uint64_t load32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return load_bits(&bytes[at], 4, false);
}

// `kAnotherVersion`, with what this version does not know.
InputError another_version(const std::string& unknown) {
  const std::string_view text = kAnotherVersion;
  const std::size_t colon = text.find(':');
  return InputError(text.substr(0, colon), " (", unknown, ")", text.substr(colon));
}

// Whether each level has the nodes that the masks of the level above call for, down to the voxels, and the directory
// counts them: what walks along the levels and down them relies on that. It takes a tenth of the time of a whole check,
// and no memory.
bool adds_up(const CompactTree& tree) {
  const std::uint64_t nodes = tree.node_count();
  std::uint64_t node = 0;
  std::uint64_t end = nodes == 0 ? 0 : 1;
  std::uint64_t behind = 1;  // the number of the next child
  const std::uint64_t block = std::uint64_t{1} << tree.rank_shift();
  for (int level = tree.level(); level >= 1; --level) {
    if (end > nodes) {
      return false;
    }
    while (node < end) {
      const bool begins_block = node % block == 0;
      if (begins_block &&
          tree.first_child(static_cast<std::uint32_t>(node)) != static_cast<std::uint32_t>(behind)) {
        return false;
      }
      std::array<std::uint64_t, 8> words{};
      const std::uint64_t next = std::min({end, node - node % block + block, node + sizeof words});
      std::memcpy(words.data(), tree.masks() + node, static_cast<std::size_t>(next - node));
      behind += count_bits({words.data(), words.size()});
      node = next;
    }
    end = level > 1 ? behind : end;
  }
  return end == nodes;
}

// Whether a whole scene is sound, to its last byte; of a large one what nothing can do without.
const char* fault_of(ConstBytes bytes, std::uint32_t* place) {
  if (bytes.size < kMappedBytes) {
    return BakedScene::validate(bytes, place);
  }
  BakedScene scene;
  if (BakedScene::open(bytes, &scene) != Status::kOk) {
    return BakedScene::validate(bytes, place);
  }
  *place = static_cast<std::uint32_t>(scene.tree().masks() - bytes.data);
  return adds_up(scene.tree()) ? nullptr : "another number of nodes than the masks or the directory call for";
}

}  // namespace

Source read_oct(const SharedBytes& file, const ReadOptions&, const Progress&) {
  const auto bytes = file.bytes;
  // What a person can do something about gets a sentence of its own.
  fail_if(!file.text().starts_with("TMS"),  // the version follows
          "not a scene baked by thimble bake (its first bytes are not TMS)");
  if (bytes.size() > kVersionOffset && bytes[kVersionOffset] != kBakedVersion) {
    throw another_version(concat(bytes[kVersionOffset], "; this one reads ", kBakedVersion));
  }
  if (bytes.size() >= kBakedHeaderBytes && load32(bytes, kSizeOffset) != bytes.size()) {
    throw InputError("holds ", bytes.size(), " bytes, its header says ", load32(bytes, kSizeOffset),
                     load32(bytes, kSizeOffset) > bytes.size() ? ": it is truncated" : "");
  }
  const ConstBytes view{bytes.data(), bytes.size()};
  std::uint32_t place = 0;
  if (const char* fault = fault_of(view, &place)) {
    if (fault == std::string_view(kAnotherVersion)) {
      throw another_version(
          concat("with a section of kind ", load32(bytes, place), ", which this one does not know"));
    }
    throw InputError("damaged at ", place, ": ", fault);
  }
  BakedFile result;
  result.file = file;
  fail_if(BakedScene::open(view, &result.scene) != Status::kOk, "damaged");
  // The core leaves this to whoever draws light; here the whole file must be sound.
  const ConstBytes lighting = result.scene.section(SectionKind::kLighting);
  if (lighting.data != nullptr) {
    if (const char* fault = BakedLighting::validate(lighting, result.scene.tree().level(), &place)) {
      if (fault == std::string_view(kAnotherVersion)) {
        throw another_version(
            concat("lighting of version ", lighting.data[place], "; this one reads ", kLightingVersion));
      }
      throw InputError("damaged at ", static_cast<std::size_t>(lighting.data - view.data) + place, ": ",
                       fault);
    }
  }
  return result;
}

UsedMaterials used_materials(const CompactTree& tree) {
  UsedMaterials used;
  for (const std::uint8_t material : tree.materials()) {
    used.is[material] = true;
  }
  if (!tree.empty() && !tree.many_materials()) {
    used.is[tree.uniform_material()] = true;
  }
  return used;
}

Vec3i corner_of(const CompactTree& tree, std::uint32_t number) {
  Vec3i corner;
  int up = 0;
  for (; number != 0; ++up) {
    // The parent is the last node whose first child is not behind it.
    std::uint32_t parent = 0;
    for (std::uint64_t step = std::bit_floor(tree.node_count()); step != 0; step /= 2) {
      const std::uint64_t next = parent + step;
      if (next < tree.node_count() && tree.first_child(static_cast<std::uint32_t>(next)) <= number) {
        parent = static_cast<std::uint32_t>(next);
      }
    }
    unsigned mask = tree.mask(parent);
    for (std::uint32_t before = number - tree.first_child(parent); before != 0; --before) {
      mask &= mask - 1;
    }
    const auto octant = static_cast<unsigned>(std::countr_zero(mask));
    for (int axis = 0; axis < 3; ++axis) {
      corner[axis] |= static_cast<std::int32_t>(octant >> axis & 1U) << up;
    }
    number = parent;
  }
  const int level = tree.level() - up;
  return {corner.x << level, corner.y << level, corner.z << level};
}

}  // namespace thimble::tools
