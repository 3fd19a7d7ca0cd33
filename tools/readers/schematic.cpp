// Minecraft schematics: `.schematic` (MCEdit) and `.schem` (Sponge, versions 1 to 3).
//
// What is read: Width (x), Height (y, up) and Length (z) and the blocks. Of a `.schematic`: Blocks,
// AddBlocks (four more bits each) and the colour in Data. Of a `.schem`: Palette and BlockData, on the first
// level or, as version 3 has it, within Schematic and Blocks. Blocks have the colours of block_colors.h and
// all are whole cubes; entities, biomes and what chests hold are passed over. Here z is up: (x, y, z) -> (x,
// -z, y).
//
// Sources of the formats: Minecraft Wiki, "Schematic file format"; SpongePowered, "Sponge Schematic
// Specification" 1 to 3.
#include "readers/formats.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "readers/block_colors.h"
#include "readers/nbt.h"
#include "readers/text.h"

namespace thimble::tools {
namespace {

class SchematicGrid final : public VoxelGrid {
 public:
  explicit SchematicGrid(const SharedBytes& file) : file_(file) {
    if (!looks_like_schematic(file.bytes)) {
      throw InputError("is no schematic: it does not begin with a compound tag named Schematic");
    }
    ByteReader reader(file.bytes, "the tags");
    std::string_view name;
    nbt_head(reader, &name);
    read_compound(reader);
    check();
  }

  void for_each(const Visit& visit) const override {
    walk([&](std::uint64_t index, const std::optional<Rgb>& color) {
      if (color) {
        const auto x = static_cast<std::int32_t>(index % size_[0]);
        const auto z = static_cast<std::int32_t>(index / size_[0] % size_[2]);
        const auto y = static_cast<std::int32_t>(index / size_[0] / size_[2]);
        visit(x, static_cast<std::int32_t>(size_[2]) - 1 - z, y, *color);
      }
    });
  }
  std::array<std::int32_t, 3> size() const override {
    return {static_cast<std::int32_t>(size_[0]), static_cast<std::int32_t>(size_[2]),
            static_cast<std::int32_t>(size_[1])};
  }
  bool has_color() const override { return true; }

 private:
  /// The compounds named Schematic and Blocks stand for the one that they are in.
  void read_compound(ByteReader& reader) {
    int depth = 1;
    while (depth > 0) {
      std::string_view name;
      const NbtKind kind = nbt_head(reader, &name);
      if (kind == NbtKind::kEnd) {
        --depth;
      } else if (kind == NbtKind::kCompound && (name == "Schematic" || name == "Blocks")) {
        ++depth;
      } else {
        read_entry(reader, kind, name);
      }
    }
  }

  void read_entry(ByteReader& reader, NbtKind kind, std::string_view name) {
    static constexpr std::array<std::string_view, 3> kSides{"Width", "Height", "Length"};
    const auto* side = std::find(kSides.begin(), kSides.end(), name);
    if (side != kSides.end()) {
      // Sponge counts to 65535 in a short.
      const std::int64_t value = nbt_integer(reader, kind) & 0xFFFF;
      if (value < 1 || value > std::int64_t{kGridSideLimit}) {
        throw InputError(std::string(name) + " is " + std::to_string(value) + "; a side has 1 to " +
                         std::to_string(kGridSideLimit) + " blocks");
      }
      size_[static_cast<std::size_t>(side - kSides.begin())] = static_cast<std::uint32_t>(value);
    } else if (kind == NbtKind::kCompound && name == "Palette") {
      has_palette_ = true;
      nbt_compound(reader, [&](NbtKind entry_kind, std::string_view block) {
        add_to_palette(nbt_integer(reader, entry_kind), block);
      });
    } else if (kind == NbtKind::kBytes && (name == "Blocks" || name == "BlockData")) {
      blocks_ = nbt_bytes(reader);
    } else if (kind == NbtKind::kBytes && name == "Data") {
      data_ = nbt_bytes(reader);
    } else if (kind == NbtKind::kBytes && name == "AddBlocks") {
      add_ = nbt_bytes(reader);
    } else {
      nbt_skip(reader, kind);
    }
  }

  void add_to_palette(std::int64_t index, std::string_view block) {
    // Palettes are dense, and an entry takes at least seven bytes.
    if (index < 0 || static_cast<std::uint64_t>(index) > file_.bytes.size() / 7) {
      throw InputError("the palette has the number " + std::to_string(index) + " for " + quoted(block) +
                       ", more than the file has entries");
    }
    palette_.resize(std::max(palette_.size(), static_cast<std::size_t>(index) + 1));
    palette_[static_cast<std::size_t>(index)] = block_color(block);
  }

  void check() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (size_[axis] == 0) {
        throw InputError("Width, Height and Length are not all there");
      }
    }
    // Version 3 calls the numbers of its palette Data.
    if (has_palette_ && blocks_.empty()) {
      blocks_ = std::exchange(data_, {});
    }
    const std::uint64_t cells = std::uint64_t{size_[0]} * size_[1] * size_[2];
    if (has_palette_ ? blocks_.size() < cells : blocks_.size() != cells) {
      throw InputError("the blocks take " + std::to_string(blocks_.size()) + " bytes, but " +
                       std::to_string(size_[0]) + " x " + std::to_string(size_[1]) + " x " +
                       std::to_string(size_[2]) + " of them are announced");
    }
    check_solid("the schematic holds nothing but air");
  }

  template <class Take>
  void walk(const Take& take) const {
    const std::uint64_t cells = std::uint64_t{size_[0]} * size_[1] * size_[2];
    if (has_palette_) {
      walk_palette(cells, take);
      return;
    }
    for (std::size_t i = 0; i < cells; ++i) {
      unsigned number = blocks_[i];
      if (i / 2 < add_.size()) {
        number |= (unsigned{add_[i / 2]} >> (i % 2 == 0 ? 4U : 0U) & 0xFU) << 8;
      }
      take(i, block_color(number, i < data_.size() ? data_[i] : 0U));
    }
  }

  /// Numbers of seven bits a byte, lowest first; the eighth says that more follow.
  template <class Take>
  void walk_palette(std::uint64_t cells, const Take& take) const {
    std::size_t at = 0;
    for (std::uint64_t i = 0; i < cells; ++i) {
      std::uint64_t number = 0;
      for (unsigned shift = 0;; shift += 7) {
        if (at == blocks_.size() || shift > 28) {
          throw InputError("block " + std::to_string(i) + " of " + std::to_string(cells) +
                           " is cut off or too long");
        }
        number |= std::uint64_t{blocks_[at] & 0x7FU} << shift;
        if ((blocks_[at++] & 0x80U) == 0) {
          break;
        }
      }
      if (number >= palette_.size()) {
        throw InputError("block " + std::to_string(i) + " has the number " + std::to_string(number) +
                         ", which is not among the " + std::to_string(palette_.size()) + " of the palette");
      }
      take(i, palette_[static_cast<std::size_t>(number)]);
    }
  }

  SharedBytes file_;
  std::array<std::uint32_t, 3> size_{};  ///< x, y, z of the file
  std::span<const std::uint8_t> blocks_, data_, add_;
  std::vector<std::optional<Rgb>> palette_;
  bool has_palette_ = false;
};

}  // namespace

/// True for a compound of the names that such files begin with, unpacked.
bool looks_like_schematic(std::span<const std::uint8_t> bytes) {
  const std::string_view text = SharedBytes{bytes, nullptr}.text();
  constexpr std::string_view kNamed("\x0A\x00\x09Schematic", 12);
  // Version 3: a nameless compound around it.
  constexpr std::string_view kNested("\x0A\x00\x00\x0A\x00\x09Schematic", 15);
  return text.starts_with(kNamed) || text.starts_with(kNested);
}

/// Memory: 4 bytes a palette entry.
/// @throws InputError  broken tags; a size that is missing, 0 or over `kGridSideLimit`; not as many blocks as
///   the size says; a block that the palette does not have; nothing but air
Source read_schematic(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<SchematicGrid>(file);
}

}  // namespace thimble::tools
