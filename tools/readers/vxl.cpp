// `.vxl` maps of Voxlap (Ken Silverman) and of Ace of Spades.
//
// What is read: a map of Ace of Spades, which is 512 x 512 columns and nothing else, or one of Voxlap, whose header
// says how many. Columns are 64 voxels deep, or 256 where one of them reaches below 64. The file has colours for the
// voxels that can be seen; the others are solid, too, and have the colour of earth. In the file z is down; here it is
// up, and y turns with it, which keeps the hand. The camera of Voxlap's header is passed over.
//
// Sources of the format: Silver Spaceship, "The AoS map file format"; Ken Silverman, Voxlap's "VOXLAP5.TXT".
#include <algorithm>

#include "readers/formats.h"

namespace thimble::tools {
namespace {

constexpr std::uint32_t kVoxlapMagic = 0x09072000;
constexpr std::uint64_t kVoxlapCameraBytes = 96;
constexpr std::array<std::uint32_t, 2> kDepths{64, 256};
constexpr std::size_t kColorBytes = 4;    // blue, green, red, brightness
constexpr Rgb kHiddenColor{103, 64, 40};  // what Ace of Spades shows where one digs

class VxlGrid final : public VoxelGrid {
 public:
  explicit VxlGrid(const SharedBytes& file) : file_(file) {
    if (file.text().starts_with("Voxel Animation")) {
      throw InputError("is a model of Command & Conquer, and only maps of Voxlap are read");
    }
    if (looks_like_vxl(file.bytes)) {
      ByteReader reader(file.bytes, "the header");
      reader.skip(4);
      for (std::size_t axis = 0; axis < 2; ++axis) {
        sides_[axis] = reader.u32();
        if (sides_[axis] < 1 || sides_[axis] > kGridSideLimit) {
          reader.fail("a side of ", sides_[axis], " columns; there are 1 to ", kGridSideLimit);
        }
      }
      reader.skip(kVoxlapCameraBytes);
      first_offset_ = static_cast<std::size_t>(reader.offset());
    }
    std::uint32_t deepest = 0;
    sides_[2] = kDepths[1];
    const std::size_t left =
        walk([&](auto, auto, std::uint32_t first, std::uint32_t end, const std::uint8_t* colors) {
          deepest = std::max(deepest, colors == nullptr ? first : end);
        });
    sides_[2] = deepest <= kDepths[0] ? kDepths[0] : kDepths[1];
    set_size(sides_[0], sides_[1], sides_[2]);
    if (left != 0) {
      notes.push_back(
          concat(left, " bytes behind the last of ", sides_[0], " x ", sides_[1], " columns are not read"));
    }
    check_solid("the map holds no voxels");
  }

  void for_each(const Visit& visit) const override {
    walk([&](std::uint32_t x, std::uint32_t y, std::uint32_t first, std::uint32_t end,
             const std::uint8_t* color) {
      for (std::uint32_t z = first; z < end; ++z) {
        visit(static_cast<std::int32_t>(x), static_cast<std::int32_t>(sides_[1] - 1 - y),
              static_cast<std::int32_t>(sides_[2] - 1 - z),
              color == nullptr ? kHiddenColor : Rgb{color[2], color[1], color[0]});
        color += color == nullptr ? 0 : kColorBytes;
      }
    });
  }

 private:
  /// Calls take(x, y, first, end, colors) for runs of solid voxels from the top of each column down; `colors` is null
  /// where they are hidden. Returns how many bytes are left behind the last column.
  ///
  ///     span: words, top, bottom, air | colours of top ... bottom | colours that end where the next air begins
  ///
  /// `words` counts the span's groups of four bytes, and is 0 for a column's last span, which has no second colours.
  template <class Take>
  std::size_t walk(const Take& take) const {
    ByteReader reader(file_.bytes.subspan(first_offset_), "the columns", first_offset_);
    for (std::uint32_t column = 0; column < sides_[0] * sides_[1]; ++column) {
      const std::uint32_t x = column % sides_[0];
      const std::uint32_t y = column / sides_[0];
      std::span<const std::uint8_t> lower;  // second colours of the span before
      std::uint32_t hidden = 0;             // where the hidden voxels of the span before begin
      for (bool is_first = true, is_last = false; !is_last; is_first = false) {
        const std::uint32_t words = reader.u8();
        const std::uint32_t top = reader.u8();
        const std::uint32_t end = reader.u8() + 1U;
        const std::uint32_t air = reader.u8();  // means nothing in a first span
        const auto below = static_cast<std::uint32_t>(lower.size() / kColorBytes);
        is_last = words == 0;
        if (top > end || end > sides_[2] ||
            (!is_first && (air < hidden || air > top || below > air - hidden)) ||
            (!is_last && words < 1 + end - top)) {
          reader.fail("column ", x, ",", y, " has a span from ", top, " to ", end,
                      " that its neighbours leave no room for, before byte offset ", reader.offset());
        }
        if (!is_first) {
          take(x, y, hidden, air - below, nullptr);
          take(x, y, air - below, air, lower.data());
        }
        const std::uint32_t count = end - top;
        take(x, y, top, end, reader.take(kColorBytes * count).data());
        lower = is_last ? lower : reader.take(kColorBytes * (words - 1 - count));
        hidden = end;
      }
      take(x, y, hidden, sides_[2], nullptr);
    }
    return reader.remaining();
  }

  SharedBytes file_;
  std::array<std::uint32_t, 3> sides_{512, 512, 0};
  std::size_t first_offset_ = 0;
};

}  // namespace

/// True for Voxlap's own maps; those of Ace of Spades have nothing to know them by.
bool looks_like_vxl(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 4 && load_bits(bytes.data(), 4, false) == kVoxlapMagic;
}

/// @throws InputError  a side of 0 or over `kGridSideLimit`, spans that overlap, go up or leave the column, too few
///   bytes for the columns
Source read_vxl(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<VxlGrid>(file);
}

}  // namespace thimble::tools
