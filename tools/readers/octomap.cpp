// `.bt` and `.ot` maps of OctoMap: octrees of 16 levels below the root.
//
// What is read: the occupied leaves, each as the cube that it stands for; what is free or unknown is empty. A `.bt`
// has two bits a child: unknown, free, occupied, or a node of its own. An `.ot` has log-odds for each node, and a
// leaf is occupied from 0 on (a probability of one half, OctoMap's own threshold); leaves of a ColorOcTree have
// colours. The lowest corner of what is occupied is 0,0,0, and a voxel is a leaf of the last level, whatever its
// length in metres. In the file z is up, as here.
//
// Source of the format: Kai M. Wurm, Armin Hornung, OctoMap, `AbstractOcTree::write`,
// `OccupancyOcTreeBase::writeBinaryNode`.
#include "readers/formats.h"

namespace thimble::tools {
namespace {

constexpr std::string_view kBinaryMapMagic = "# Octomap OcTree binary file";
constexpr std::string_view kFullMapMagic = "# Octomap OcTree file";
constexpr int kMapLevels = 16;
/// A cube costs no byte, but time.
constexpr std::uint64_t kMostMapVoxels = std::uint64_t{1} << 27;

class OctomapGrid final : public VoxelGrid {
 public:
  explicit OctomapGrid(const SharedBytes& file) : file_(file) {
    is_binary_ = file.text().starts_with(kBinaryMapMagic);
    fail_if(!looks_like_octomap(file.text()), "is no OctoMap file: it does not begin with \"", kFullMapMagic,
            "\" or \"", kBinaryMapMagic, "\"");
    read_head();
    std::uint64_t voxels = 0;
    Extent<std::int32_t> box;
    walk([&](const Vec3i& corner, int level, Rgb) {
      const std::int32_t side = std::int32_t{1} << level;
      box.add({corner.x, corner.y, corner.z});
      box.add({corner.x + side, corner.y + side, corner.z + side});
      voxels += std::uint64_t{1} << 3 * level;
    });
    fail_if(voxels == 0, "the map has no occupied leaf");
    low_ = {box.low[0], box.low[1], box.low[2]};
    size_ = {box.high[0] - low_.x, box.high[1] - low_.y, box.high[2] - low_.z};
    const std::int32_t longest = *std::max_element(size_.begin(), size_.end());
    fail_if(longest > static_cast<std::int32_t>(kGridSideLimit) || voxels > kMostMapVoxels,
            "the occupied leaves are ", voxels, " voxels and ", longest, " long; the limits are ",
            kMostMapVoxels, " and ", kGridSideLimit);
  }

  void for_each(const Visit& visit) const override {
    walk([&](const Vec3i& corner, int level, Rgb color) {
      for_voxels({corner.x - low_.x, corner.y - low_.y, corner.z - low_.z}, level,
                 [&](std::int32_t x, std::int32_t y, std::int32_t z) { visit(x, y, z, color); });
    });
  }

 private:
  void read_head() {
    LineReader lines(file_.text());
    std::string_view id;
    std::string_view key;
    for (std::string_view line; key != "data";) {
      fail_if(!lines.next(line), "the header has no line 'data'");
      key = take_word(line);
      id = key == "id" ? take_word(line) : id;
    }
    // Files from before classes had names say 1.
    has_color_ = id == "ColorOcTree" && !is_binary_;
    fail_if(id != "OcTree" && id != "1" && id != "ColorOcTree" && id != "OcTreeStamped",
            "holds a tree of class ", quoted(id), "; OcTree, ColorOcTree and OcTreeStamped are read");
    nodes_offset_ = lines.offset();
  }

  /// Calls take(corner, level, color) for each occupied leaf, a cube of 2^level voxels.
  template <class Take>
  void walk(const Take& take) const {
    ByteReader reader(file_.bytes.subspan(nodes_offset_), "the nodes", nodes_offset_);
    if (reader.remaining() > 0) {  // an empty map has no root
      read_node(reader, {0, 0, 0}, kMapLevels, take);
    }
  }

  template <class Take>
  void read_node(ByteReader& reader, const Vec3i& corner, int level, const Take& take) const {
    const float log_odds = is_binary_ ? 0.0F : reader.f32();
    Rgb color;
    if (has_color_) {
      color = {reader.u8(), reader.u8(), reader.u8()};
    }
    const unsigned children = is_binary_ ? reader.u16() : reader.u8();
    if (children == 0) {
      if (!is_binary_ && log_odds >= 0) {
        take(corner, level, color);
      }
      return;
    }
    reader.fail_if(level == 0, "a node below the last of ", kMapLevels, " levels, before byte offset ",
                   reader.offset());
    const std::int32_t half = std::int32_t{1} << (level - 1);
    for (unsigned octant = 0; octant < 8; ++octant) {
      const Vec3i at{corner.x + ((octant & 1U) != 0 ? half : 0), corner.y + ((octant & 2U) != 0 ? half : 0),
                     corner.z + ((octant & 4U) != 0 ? half : 0)};
      const unsigned code = is_binary_ ? children >> 2 * octant & 3U : (children >> octant & 1U) * 3;
      if (code == 3) {
        read_node(reader, at, level - 1, take);
      } else if (code == 2) {
        take(at, level - 1, color);
      }
    }
  }

  SharedBytes file_;
  std::size_t nodes_offset_ = 0;
  Vec3i low_{};
  bool is_binary_ = false;
};

}  // namespace

bool looks_like_octomap(std::string_view text) {
  return text.starts_with(kBinaryMapMagic) || text.starts_with(kFullMapMagic);
}

/// @throws InputError  no line 'data', a class of trees that is not read, nodes that end early or lie too deep, none
///   that is occupied, more than 2^27 voxels or a side over `kGridSideLimit`
Source read_octomap(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<OctomapGrid>(file);
}

}  // namespace thimble::tools
