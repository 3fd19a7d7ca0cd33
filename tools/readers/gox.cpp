// `.gox` scenes of Goxel, versions 1 and 2.
//
// What is read: the layers that are visible, each over those before it, and layers that are copies of others, moved by
// whole voxels. A voxel is solid where its alpha is at least a half, as Goxel draws it. Layers that are shapes, and
// copies that are turned, scaled, moved by less than a voxel or of a later layer, are left out with a note. Materials, cameras, lights
// and the picture of the whole are passed over. z is up in the file, too; the lowest corner of what is solid is 0,0,0.
//
// A file holds blocks of 16 x 16 x 16 voxels as pictures of 64 x 64 pixels, x the fastest, then y; layers say which
// block lies where. Blocks are decoded each time that they are streamed, for they take many times their bytes in the
// file; but constant ones, which take least there, once.
//
// Source of the format: Guillaume Chereau, the head of Goxel's "gox.c".
#include <map>
#include <set>
#include <tuple>

#include "output/units.h"
#include "readers/formats.h"
#include "readers/picture.h"

namespace thimble::tools {
namespace {

constexpr std::uint32_t kNewestVersion = 2;
constexpr int kPictureSide = 64;
constexpr std::int64_t kBlockSide = 16;
constexpr std::int64_t kBlockVoxels = kBlockSide * kBlockSide * kBlockSide;
constexpr std::uint64_t kBlockPlaceBytes = 20;  // picture, x, y, z, 0
constexpr std::uint8_t kSolidAlpha = 127;
constexpr std::size_t kMostBlocks = std::size_t{1} << 17;  // of what is kept, and for one call of `for_each`

class GoxGrid final : public VoxelGrid {
 public:
  explicit GoxGrid(const SharedBytes& file) : file_(file) {
    read_chunks();
    note_if(left_out_ != 0, notes, counted(left_out_, "layer is", "layers are"),
            " not drawn: a shape, or a copy of another that is more than moved by whole voxels");
    place_blocks();
    measure();
  }

  void for_each(const Visit& visit) const override {
    stream([&](const Corner& at, Rgb color) {
      visit(static_cast<std::int32_t>(at[0] - low_[0]), static_cast<std::int32_t>(at[1] - low_[1]),
            static_cast<std::int32_t>(at[2] - low_[2]), color);
    });
  }

 private:
  using Corner = std::array<std::int64_t, 3>;
  struct Layer {
    ByteReader blocks;
    Corner moved_by{};
    bool is_drawn = true;
  };

  struct Block {
    std::uint32_t picture = 0;
    Corner corner{};
    // libc++ 14 has no <=> for arrays.
    bool operator<(const Block& other) const {
      return std::tie(picture, corner) < std::tie(other.picture, other.corner);
    }
  };

  void read_chunks() {
    ByteReader reader(file_.bytes);
    reader.expect("GOX ", "Goxel scene");
    const std::uint32_t version = reader.u32();
    fail_if(version < 1 || version > kNewestVersion, "version ", version,
            " of Goxel's scenes is not read, only 1 and 2 are");
    for (std::size_t chunks = 0; reader.remaining() > 0;) {
      const std::string place = "the chunk at byte offset " + std::to_string(reader.offset());
      const std::string_view kind = reader.text(4);
      ByteReader chunk = reader.sub(reader.u32(), place);
      reader.skip(4);  // a check sum, which Goxel leaves 0
      if (kind == "BL16") {
        pictures_.push_back(chunk);
        ++chunks;
      } else if (kind == "LAYR") {
        read_layer(chunk);
        ++chunks;
      }
      chunk.fail_if(chunks > kMostBlocks || blocks_ > kMostBlocks, "there are more than the limit of ",
                    kMostBlocks, " blocks");
    }
  }

  void read_layer(ByteReader& chunk) {
    Layer layer{chunk.sub(kBlockPlaceBytes * chunk.u32(), chunk.place())};
    Corner moved_by{};
    std::uint32_t id = 0;
    std::uint32_t copy_of = 0;
    bool is_visible = true;
    bool is_only_moved = true;
    while (chunk.remaining() > 0) {
      const std::string_view key = chunk.text(chunk.u32());
      if (key.empty()) {
        break;
      }
      ByteReader value = chunk.sub(chunk.u32(), chunk.place());
      if (key == "id") {
        id = value.u32();
      } else if (key == "base_id") {
        copy_of = value.u32();
      } else if (key == "visible") {
        is_visible = value.u8() != 0;
      } else if (key == "shape") {
        layer.is_drawn = false;
      } else if (key == "mat") {
        is_only_moved = read_move(value, moved_by);
      }
    }
    if (copy_of != 0) {  // what is no copy lies where its blocks do
      const auto original = by_id_.find(copy_of);
      layer.is_drawn = original != by_id_.end() && original->second.is_drawn && is_only_moved;
      if (layer.is_drawn) {
        layer = original->second;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          layer.moved_by[axis] += moved_by[axis];
        }
      }
    }
    if (id != 0) {
      by_id_.emplace(id, layer);
    }
    if (is_visible) {
      left_out_ += layer.is_drawn ? 0 : 1;
      blocks_ += layer.blocks.remaining() / kBlockPlaceBytes;
      layers_.push_back(std::move(layer));
    }
  }

  /// Of four columns of four numbers the last says where to; true where they do no more, and move by whole voxels.
  static bool read_move(ByteReader& value, Corner& moved_by) {
    bool is_only_moved = true;
    for (std::size_t i = 0; i < 16; ++i) {
      const float number = value.f32();
      if (i >= 12 && i < 15) {
        is_only_moved &= std::abs(number) < 1 << 24 && std::round(number) == number;
        moved_by[i - 12] = is_only_moved ? static_cast<std::int64_t>(number) : 0;
      } else {
        is_only_moved &= number == (i % 5 == 0 ? 1.0F : 0.0F);
      }
    }
    return is_only_moved;
  }

  /// The blocks of all layers, but for those that come again later at the same place.
  void place_blocks() {
    constant_.resize(pictures_.size());
    for (const Layer& layer : layers_) {
      for (ByteReader reader = layer.blocks; reader.remaining() > 0;) {
        Block block{reader.u32(), layer.moved_by};
        for (std::int64_t& coordinate : block.corner) {
          coordinate +=
              reader.i32();  // version 1 counts from the middle, which moving to 0,0,0 makes the same
        }
        reader.skip(4);
        reader.fail_if(block.picture >= pictures_.size(), "block ", block.picture, " is not among the ",
                       pictures_.size(), " of the file");
        placed_.push_back(block);
      }
    }
    std::set<Block> later;
    std::set<std::uint32_t> seen;
    std::vector<Block> blocks;
    for (; !placed_.empty(); placed_.pop_back()) {
      if (!later.insert(placed_.back()).second) {
        continue;
      }
      blocks.push_back(placed_.back());
      const std::uint32_t picture = blocks.back().picture;
      if (seen.insert(picture).second) {
        const auto rgba = decode(pictures_[picture]);
        if (std::memcmp(rgba.get(), rgba.get() + 4, 4 * (kBlockVoxels - 1)) == 0) {
          constant_[picture] = std::array{rgba.get()[0], rgba.get()[1], rgba.get()[2], rgba.get()[3]};
        }
      }
    }
    placed_.assign(blocks.rbegin(), blocks.rend());
  }

  template <class Take>
  void stream(const Take& take) const {
    // Copies of a layer come back to its blocks.
    constexpr std::size_t kKept = 64;
    std::array<std::pair<std::uint32_t, std::shared_ptr<const std::uint8_t>>, kKept> kept{};
    for (const auto& [number, corner] : placed_) {
      auto& [decoded, rgba] = kept[number % kKept];
      const auto& constant = constant_[number];
      if (!constant && (rgba == nullptr || decoded != number)) {
        rgba = decode(pictures_[number]);
        decoded = number;
      }
      for (std::int64_t i = 0; i < kBlockVoxels; ++i) {
        const std::uint8_t* pixel = constant ? constant->data() : rgba.get() + 4 * i;
        if (pixel[3] >= kSolidAlpha) {
          take(Corner{corner[0] + i % kBlockSide, corner[1] + i / kBlockSide % kBlockSide,
                      corner[2] + i / kBlockSide / kBlockSide},
               Rgb{pixel[0], pixel[1], pixel[2]});
        }
      }
    }
  }

  static std::shared_ptr<const std::uint8_t> decode(ByteReader picture) {
    const auto encoded = picture.take(picture.remaining());
    picture.fail_if(picture_size(encoded) != std::array<int, 2>{kPictureSide, kPictureSide},
                    "the block is no picture of 64 x 64 pixels");
    return decode_picture(encoded, 4, picture.place() + ": the block ");
  }

  void measure() {
    fail_if(layers_.empty(), "no layer of the file is visible");
    Extent<std::int64_t> box;
    stream([&](const Corner& at, Rgb) { box.add(at); });
    fail_if(box.empty, "the file holds no voxels that are drawn");
    low_ = box.low;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t side = box.high[axis] - low_[axis] + 1;
      fail_if(side > std::int64_t{kGridSideLimit}, "the layers reach over ", side, " voxels, the limit is ",
              kGridSideLimit);
      size_[axis] = static_cast<std::int32_t>(side);
    }
  }

  SharedBytes file_;
  std::vector<ByteReader> pictures_;
  std::vector<std::optional<std::array<std::uint8_t, 4>>>
      constant_;  ///< the one pixel of a picture that is all alike
  std::map<std::uint32_t, Layer> by_id_;
  std::vector<Layer> layers_;  ///< those that are visible
  std::vector<Block> placed_;
  std::uint64_t blocks_ = 0, left_out_ = 0;
  Corner low_{};
};

}  // namespace

/// Memory: some 200 bytes a block and layer of the file.
/// @throws InputError  another beginning or version, chunks that end early, a block that the file does not have or
///   that is no picture of 64 x 64 pixels, more than 2^17 blocks, a scene over `kGridSideLimit` on a side, no voxel
Source read_gox(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<GoxGrid>(file);
}

}  // namespace thimble::tools
