// `.kvx` and `.kv6` models (Ken Silverman's Build and Voxlap engines), and `.vxl` maps of Voxlap and Ace of Spades.
//
// What is read: of a `.kvx` the first, finest of the models in the file, and the palette of six bits a channel at
// its end; of a `.kv6` its voxels, which have 24 bits of colour each. Both hold the visible voxels only, so the model
// is hollow. Of a `.vxl`: a map of Ace of Spades, which is 512 x 512 columns and nothing else, or one of Voxlap, whose
// header says how many. Columns are 64 voxels deep, or 256 where one of them reaches below 64. The file has colours for
// the voxels that can be seen; the others are solid, too, and have the colour of earth. The camera of Voxlap's header is
// passed over. In the files z is down; here it is up, and y turns with it, which keeps the hand.
//
// Sources of the formats: Ken Silverman, "SLAB6.TXT" and Voxlap's "VOXLAP5.TXT"; Silver Spaceship, "The AoS map file
// format".
#include "readers/formats.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kPaletteBytes = 768;
constexpr std::size_t kKvxHeaderBytes = 28;  // bytes of the model, three sides, three pivots

constexpr std::size_t kKv6HeaderBytes = 32;  // magic, three sides, three pivots, number of voxels
constexpr std::size_t kKv6VoxelBytes = 8;    // blue, green, red, 0, two of z, visible sides, slope

constexpr std::uint64_t kVoxlapCameraBytes = 96;
constexpr std::array<std::uint32_t, 2> kDepths{64, 256};
constexpr std::size_t kColorBytes = 4;    // blue, green, red, brightness
constexpr Rgb kHiddenColor{103, 64, 40};  // what Ace of Spades shows where one digs

/// Columns of voxels, z down.
class ColumnGrid : public VoxelGrid {
 protected:
  explicit ColumnGrid(const SharedBytes& file) : file_(file) {}
  void read_size(ByteReader& reader, std::size_t axes = 3, const char* what = "voxels") {
    for (std::size_t axis = 0; axis < axes; ++axis) {
      sides_[axis] = reader.u32();
      reader.fail_if(sides_[axis] < 1 || sides_[axis] > kGridSideLimit, "a side of ", sides_[axis], " ", what,
                     "; there are 1 to ", kGridSideLimit);
    }
    set_size(sides_[0], sides_[1], sides_[2]);
  }
  void put(const Visit& visit, std::uint32_t x, std::uint32_t y, std::uint32_t z, Rgb color) const {
    visit(static_cast<std::int32_t>(x), static_cast<std::int32_t>(sides_[1] - 1 - y),
          static_cast<std::int32_t>(sides_[2] - 1 - z), color);
  }

  SharedBytes file_;
  std::array<std::uint32_t, 3> sides_{};
};

class KvxGrid final : public ColumnGrid {
 public:
  explicit KvxGrid(const SharedBytes& file) : ColumnGrid(file) {
    ByteReader reader(file.bytes, "the header");
    const std::uint32_t model_bytes = reader.u32();
    read_size(reader);
    const std::uint64_t end = std::uint64_t{model_bytes} + 4;
    fail_if(file.bytes.size() < kPaletteBytes || end > file.bytes.size() - kPaletteBytes,
            "the model announces ", model_bytes,
            " bytes, which the file does not hold before a palette of 768");
    const std::uint64_t tables =
        4 * (std::uint64_t{sides_[0]} + 1) + 2 * std::uint64_t{sides_[0]} * (sides_[1] + 1);
    fail_if(kKvxHeaderBytes + tables > end, "the model of ", model_bytes,
            " bytes has no room for the table of ", sides_[0], " x ", sides_[1], " columns");
    end_ = static_cast<std::size_t>(end);
    check_solid("the model holds no voxels");
  }

  void for_each(const Visit& visit) const override {
    const std::uint8_t* palette = file_.bytes.data() + file_.bytes.size() - kPaletteBytes;
    const auto up = [](std::uint8_t six) { return static_cast<std::uint8_t>((six & 63U) * 255 / 63); };
    for (std::uint32_t x = 0; x < sides_[0]; ++x) {
      for (std::uint32_t y = 0; y < sides_[1]; ++y) {
        ByteReader slabs = column(x, y);
        while (slabs.remaining() > 0) {
          const std::uint32_t top = slabs.u8();
          const std::uint32_t length = slabs.u8();
          slabs.skip(1);  // which sides are visible
          slabs.fail_if(top + length > sides_[2], "a slab reaches from ", top, " to ", top + length,
                        ", below the model's ", sides_[2], " voxels");
          for (std::uint32_t z = top; z < top + length; ++z) {
            const std::uint8_t* color = palette + 3 * std::size_t{slabs.u8()};
            put(visit, x, y, z, {up(color[0]), up(color[1]), up(color[2])});
          }
        }
      }
    }
  }

 private:
  /// The slabs of a column. Offsets count from the table of them on; a row of columns has one, each column
  /// one within.
  ByteReader column(std::uint32_t x, std::uint32_t y) const {
    ByteReader row(file_.bytes.subspan(kKvxHeaderBytes + 4 * std::size_t{x}));
    ByteReader inner(file_.bytes.subspan(kKvxHeaderBytes + 4 * (std::size_t{sides_[0]} + 1) +
                                         2 * (std::size_t{x} * (sides_[1] + 1) + y)));
    const std::uint64_t first_row = row.u32();
    const std::uint64_t first = kKvxHeaderBytes + first_row + inner.u16();
    const std::uint64_t last = kKvxHeaderBytes + first_row + inner.u16();
    const std::string place = concat("column ", x, ",", y);
    fail_if(first > last || last > end_, place, " lies from byte offset ", first, " to ", last,
            ", outside of the model, which ends at ", end_);
    return ByteReader(
        file_.bytes.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first)), place,
        first);
  }

  std::size_t end_ = 0;
};

class Kv6Grid final : public ColumnGrid {
 public:
  explicit Kv6Grid(const SharedBytes& file) : ColumnGrid(file) {
    ByteReader reader(file.bytes);
    reader.expect("Kvxl", "KV6 model");
    read_size(reader);
    reader.skip(12);  // the pivot
    count_ = reader.u32();
    voxels_ = reader.take(kKv6VoxelBytes * std::uint64_t{count_});
    reader.skip(4 * std::uint64_t{sides_[0]});  // voxels of each row of columns
    lengths_ = reader.take(2 * std::uint64_t{sides_[0]} * sides_[1]);
    check_solid("the model holds no voxels");
  }

  void for_each(const Visit& visit) const override {
    ByteReader voxels(voxels_, "the voxels", kKv6HeaderBytes);
    ByteReader lengths(lengths_, "the columns");
    for (std::uint32_t x = 0; x < sides_[0]; ++x) {
      for (std::uint32_t y = 0; y < sides_[1]; ++y) {
        for (std::uint32_t left = lengths.u16(); left > 0; --left) {
          const auto color = voxels.take(4);
          const std::uint32_t z = voxels.u16();
          voxels.skip(2);
          voxels.fail_if(z >= sides_[2], "a voxel of column ", x, ",", y, " lies at ", z,
                         ", below the model's ", sides_[2], " voxels");
          put(visit, x, y, z, {color[2], color[1], color[0]});
        }
      }
    }
    voxels.fail_if(voxels.remaining() != 0, "there are ", count_, " of them, and the columns have ",
                   count_ - voxels.remaining() / kKv6VoxelBytes);
  }

 private:
  std::uint32_t count_ = 0;
  std::span<const std::uint8_t> voxels_, lengths_;
};

class VxlGrid final : public ColumnGrid {
 public:
  explicit VxlGrid(const SharedBytes& file) : ColumnGrid(file) {
    sides_ = {512, 512, 0};
    fail_if(file.text().starts_with("Voxel Animation"),
            "is a model of Command & Conquer, and only maps of Voxlap are read");
    if (file.text().starts_with(kVoxlapMagic)) {
      ByteReader reader(file.bytes, "the header");
      reader.skip(4);
      read_size(reader, 2, "columns");
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
    note_if(left != 0, notes, left, " bytes behind the last of ", sides_[0], " x ", sides_[1],
            " columns are not read");
    check_solid("the map holds no voxels");
  }

  void for_each(const Visit& visit) const override {
    walk([&](std::uint32_t x, std::uint32_t y, std::uint32_t first, std::uint32_t end,
             const std::uint8_t* color) {
      for (std::uint32_t z = first; z < end; ++z) {
        put(visit, x, y, z, color == nullptr ? kHiddenColor : Rgb{color[2], color[1], color[0]});
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
        reader.fail_if(top > end || end > sides_[2] ||
                           (!is_first && (air < hidden || air > top || below > air - hidden)) ||
                           (!is_last && words < 1 + end - top),
                       "column ", x, ",", y, " has a span from ", top, " to ", end,
                       " that its neighbours leave no room for, before byte offset ", reader.offset());
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

  std::size_t first_offset_ = 0;
};

}  // namespace

/// @throws InputError  a size of 0 or over `kGridSideLimit`, columns or slabs that leave their place, no
///   palette, no voxel
Source read_kvx(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<KvxGrid>(file);
}

/// @throws InputError  another beginning, a size of 0 or over `kGridSideLimit`, fewer bytes than voxels and columns
///   take, columns with more or fewer voxels than there are, a voxel below the model, no voxel
Source read_kv6(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<Kv6Grid>(file);
}

/// @throws InputError  a side of 0 or over `kGridSideLimit`, spans that overlap, go up or leave the column, too few
///   bytes for the columns
Source read_vxl(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<VxlGrid>(file);
}

}  // namespace thimble::tools
