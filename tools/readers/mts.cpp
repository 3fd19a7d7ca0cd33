// `.mts` schematics of Minetest, versions 1 to 4.
//
// What is read: the size, the names of the nodes, and which node is where; nodes that a schematic leaves to
// chance are there unless the chance is 0. Nodes have the colours of block_colors.h, all as whole cubes. In
// the file y is up; here z is: (x, y, z) -> (x, -z, y).
//
// Source of the format: Minetest, comment of `src/mapgen/mg_schematic.h`.
#include "readers/formats.h"

#include "readers/block_colors.h"

namespace thimble::tools {
namespace {

constexpr std::uint64_t kNodeBytes =
    4;  // a number of two bytes, a chance, a turn; each for all nodes together

class MtsGrid final : public VoxelGrid {
 public:
  explicit MtsGrid(const SharedBytes& file) {
    ByteReader reader(file.bytes, "the header");
    reader.expect("MTSM", "Minetest schematic");
    const unsigned version = reader.u16_be();
    if (version < 1 || version > 4) {
      throw InputError("version ", version, " at byte offset 4 is not supported, only 1 to 4 are");
    }
    for (std::uint32_t& side : sides_) {
      side = reader.u16_be();
      if (side < 1 || side > kGridSideLimit) {
        reader.fail("a side of ", side, " nodes; there are 1 to ", kGridSideLimit);
      }
    }
    set_size(sides_[0], sides_[2], sides_[1]);
    if (version >= 3) {
      reader.skip(sides_[1]);  // chances of the layers
    }
    const unsigned names = reader.u16_be();
    for (unsigned i = 0; i < names; ++i) {
      colors_.push_back(block_color(reader.text(reader.u16_be())));
    }
    const std::uint64_t cells = std::uint64_t{sides_[0]} * sides_[1] * sides_[2];
    nodes_ = inflate_bytes(reader.take(reader.remaining()), Deflated::kZlib, cells * kNodeBytes, "the nodes");
    if (nodes_.size() != cells * kNodeBytes) {
      throw InputError("the nodes take ", nodes_.size(), " bytes, not 4 for each of ", cells);
    }
    has_chances_ = version >= 2;
    chance_bits_ = version >= 4 ? 0x7FU : 0xFFU;
    for (std::uint64_t i = 0; i < cells; ++i) {
      if (number(i) >= colors_.size()) {
        throw InputError("node ", i, " has the number ", number(i), ", but there are ", colors_.size(),
                         " names");
      }
    }
    check_solid("the schematic holds nothing but air");
  }

  void for_each(const Visit& visit) const override {
    const std::uint64_t cells = std::uint64_t{sides_[0]} * sides_[1] * sides_[2];
    for (std::uint64_t i = 0; i < cells; ++i) {
      if (is_there(i, cells)) {
        const auto x = static_cast<std::int32_t>(i % sides_[0]);
        const auto y = static_cast<std::int32_t>(i / sides_[0] % sides_[1]);
        const auto z = static_cast<std::int32_t>(i / sides_[0] / sides_[1]);
        visit(x, static_cast<std::int32_t>(sides_[2]) - 1 - z, y, *colors_[number(i)]);
      }
    }
  }

 private:
  unsigned number(std::uint64_t i) const {
    return static_cast<unsigned>(load_bits(nodes_.bytes().data() + 2 * i, 2, true));
  }
  bool is_there(std::uint64_t i, std::uint64_t cells) const {
    const unsigned chance = nodes_.bytes()[static_cast<std::size_t>(2 * cells + i)] & chance_bits_;
    return colors_[number(i)].has_value() && (!has_chances_ || chance != 0);
  }

  std::array<std::uint32_t, 3> sides_{};  ///< x, y, z of the file
  std::vector<std::optional<Rgb>> colors_;
  FileBytes nodes_;
  unsigned chance_bits_ = 0xFF;
  bool has_chances_ = true;
};

}  // namespace

/// Memory: 4 bytes a node of the schematic, as many as it unpacks to.
/// @throws InputError  another version, a side of 0 or over `kGridSideLimit`, damaged deflated data or not as
///   much of it as the size says, a node without a name, nothing but air
Source read_mts(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<MtsGrid>(file);
}

}  // namespace thimble::tools
