// `.kvx` models (Ken Silverman's Build engine).
//
// What is read: the first, finest of the models in the file, and the palette of six bits a channel at its
// end. The file holds the visible voxels only, so the model is hollow. In the file z is down; here it is up,
// and y turns with it, which keeps the hand.
//
// From the specification alone: no file of another program was at hand. Source of the format: Ken Silverman,
// "SLAB6.TXT".
#include "readers/formats.h"

#include <memory>
#include <string>

#include "readers/file_bytes.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kPaletteBytes = 768;
constexpr std::size_t kKvxHeaderBytes = 28;  // bytes of the model, three sides, three pivots

class KvxGrid final : public VoxelGrid {
 public:
  explicit KvxGrid(const SharedBytes& file) : file_(file) {
    ByteReader reader(file.bytes, "the header");
    const std::uint32_t model_bytes = reader.u32();
    for (std::uint32_t& side : size_) {
      side = reader.u32();
      if (side < 1 || side > kGridSideLimit) {
        reader.fail("a side of " + std::to_string(side) + " voxels; there are 1 to " +
                    std::to_string(kGridSideLimit));
      }
    }
    const std::uint64_t end = std::uint64_t{model_bytes} + 4;
    if (file.bytes.size() < kPaletteBytes || end > file.bytes.size() - kPaletteBytes) {
      throw InputError("the model announces " + std::to_string(model_bytes) +
                       " bytes, which the file does not hold before a palette of 768");
    }
    const std::uint64_t tables =
        4 * (std::uint64_t{size_[0]} + 1) + 2 * std::uint64_t{size_[0]} * (size_[1] + 1);
    if (kKvxHeaderBytes + tables > end) {
      throw InputError("the model of " + std::to_string(model_bytes) +
                       " bytes has no room for the table of " + std::to_string(size_[0]) + " x " +
                       std::to_string(size_[1]) + " columns");
    }
    end_ = static_cast<std::size_t>(end);
    check_solid("the model holds no voxels");
  }

  void for_each(const Visit& visit) const override {
    const std::uint8_t* palette = file_.bytes.data() + file_.bytes.size() - kPaletteBytes;
    const auto up = [](std::uint8_t six) { return static_cast<std::uint8_t>((six & 63U) * 255 / 63); };
    for (std::uint32_t x = 0; x < size_[0]; ++x) {
      for (std::uint32_t y = 0; y < size_[1]; ++y) {
        ByteReader slabs = column(x, y);
        while (slabs.remaining() > 0) {
          const std::uint32_t top = slabs.u8();
          const std::uint32_t length = slabs.u8();
          slabs.skip(1);  // which sides are visible
          if (top + length > size_[2]) {
            slabs.fail("a slab reaches from " + std::to_string(top) + " to " + std::to_string(top + length) +
                       ", below the model's " + std::to_string(size_[2]) + " voxels");
          }
          for (std::uint32_t z = top; z < top + length; ++z) {
            const std::uint8_t* color = palette + 3 * std::size_t{slabs.u8()};
            visit(static_cast<std::int32_t>(x), static_cast<std::int32_t>(size_[1] - 1 - y),
                  static_cast<std::int32_t>(size_[2] - 1 - z), {up(color[0]), up(color[1]), up(color[2])});
          }
        }
      }
    }
  }
  std::array<std::int32_t, 3> size() const override {
    return {static_cast<std::int32_t>(size_[0]), static_cast<std::int32_t>(size_[1]),
            static_cast<std::int32_t>(size_[2])};
  }
  bool has_color() const override { return true; }

 private:
  /// The slabs of a column. Offsets count from the table of them on; a row of columns has one, each column
  /// one within.
  ByteReader column(std::uint32_t x, std::uint32_t y) const {
    ByteReader row(file_.bytes.subspan(kKvxHeaderBytes + 4 * std::size_t{x}));
    ByteReader inner(file_.bytes.subspan(kKvxHeaderBytes + 4 * (std::size_t{size_[0]} + 1) +
                                         2 * (std::size_t{x} * (size_[1] + 1) + y)));
    const std::uint64_t first_row = row.u32();
    const std::uint64_t first = kKvxHeaderBytes + first_row + inner.u16();
    const std::uint64_t last = kKvxHeaderBytes + first_row + inner.u16();
    const std::string place = "column " + std::to_string(x) + "," + std::to_string(y);
    if (first > last || last > end_) {
      throw InputError(place + " lies from byte offset " + std::to_string(first) + " to " +
                       std::to_string(last) + ", outside of the model, which ends at " +
                       std::to_string(end_));
    }
    return ByteReader(
        file_.bytes.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first)), place,
        first);
  }

  SharedBytes file_;
  std::array<std::uint32_t, 3> size_{};
  std::size_t end_ = 0;
};

}  // namespace

/// @throws InputError  a size of 0 or over `kGridSideLimit`, columns or slabs that leave their place, no
///   palette, no voxel
Source read_kvx(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<KvxGrid>(file);
}

}  // namespace thimble::tools
