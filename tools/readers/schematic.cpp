// Minecraft's blocks: `.schematic` (MCEdit), `.schem` (Sponge, versions 1 to 3), `.litematic` (Litematica) and
// `.nbt` (structures), whose tags tell which of them a file is, not its name; and Minetest's `.mts`, versions 1 to 4.
//
// What is read: Width (x), Height (y, up) and Length (z) and the blocks. Of a `.schematic`: Blocks,
// AddBlocks (four more bits each) and the colour in Data. Of a `.schem`: Palette and BlockData, on the first
// level or, as version 3 has it, within Schematic and Blocks. Of a `.litematic`: all Regions where they lie, with
// their palettes; the numbers lie in words of 64 bits and cross them. Of a structure: size, the listed blocks and the
// palette, or the first of several. Blocks have the colours of block_colors.cpp and all are whole cubes; entities,
// biomes and what chests hold are passed over. Of an `.mts`: the size, the names of the nodes, and which node is where;
// nodes that it leaves to chance are there unless the chance is 0. In the files y is up, here z is: (x, y, z) -> (x, -z, y);
// of an `.mts`, whose axes are left-handed, (x, z, y).
//
// Sources of the formats: Markus Persson, "Named Binary Tag specification", 2011; Minecraft Wiki, "Schematic file format", "Structure file"; SpongePowered, "Sponge Schematic
// Specification" 1 to 3; masa, Litematica, `LitematicaSchematic` and `LitematicaBitArray`;
// Minetest, comment of `src/mapgen/mg_schematic.h`.
#include "readers/formats.h"

namespace thimble::tools {
namespace {

// Named binary tags, the bytes that all of them are made of.
enum class NbtKind : std::uint8_t {
  kEnd,
  kByte,
  kShort,
  kInt,
  kLong,
  kFloat,
  kDouble,
  kBytes,
  kText,
  kList,
  kCompound,
  kInts,
  kLongs
};

NbtKind kind_of(ByteReader& reader) {
  const unsigned kind = reader.u8();
  reader.fail_if(kind > static_cast<unsigned>(NbtKind::kLongs), "there is no tag of kind ", kind,
                 ", before byte offset ", reader.offset());
  return static_cast<NbtKind>(kind);
}

/// Bytes of one value, 0 where that is not the same for all.
std::uint64_t fixed_bytes(NbtKind kind) {
  constexpr std::array<std::uint8_t, 13> kBytes{0, 1, 2, 4, 8, 4, 8, 0, 0, 0, 0, 0, 0};
  return kBytes[static_cast<std::size_t>(kind)];
}

/// A kind, and a name; `kEnd` has none.
NbtKind nbt_head(ByteReader& reader, std::string_view* name) {
  const NbtKind kind = kind_of(reader);
  *name = kind == NbtKind::kEnd ? std::string_view() : reader.text(reader.u16_be());
  return kind;
}

/// Reads the entries of a compound whose kind and name were read; `entry` reads each one's value, or passes
/// over it.
void nbt_compound(ByteReader& reader, const std::function<void(NbtKind kind, std::string_view name)>& entry) {
  std::string_view name;
  for (NbtKind kind = nbt_head(reader, &name); kind != NbtKind::kEnd; kind = nbt_head(reader, &name)) {
    entry(kind, name);
  }
}

/// The bytes of an array of `kind`; its numbers begin with their highest byte.
std::span<const std::uint8_t> nbt_array(ByteReader& reader, NbtKind kind) {
  const std::int32_t count = reader.i32_be();
  const std::uint64_t each = kind == NbtKind::kBytes ? 1 : (kind == NbtKind::kInts ? 4 : 8);
  reader.fail_if(count < 0, "an array of ", count, " numbers, before byte offset ", reader.offset());
  return reader.take(each * static_cast<std::uint64_t>(count));
}

/// How many values of the kind `of` a list holds; they follow.
std::uint32_t nbt_list(ByteReader& reader, NbtKind* of) {
  *of = kind_of(reader);
  const std::int32_t count = reader.i32_be();
  reader.fail_if(count > 0 && *of == NbtKind::kEnd, "a list of ", count, " nothings, before byte offset ",
                 reader.offset());
  return static_cast<std::uint32_t>(std::max(count, 0));
}

/// A value of a kind that is a whole number.
std::int64_t nbt_integer(ByteReader& reader, NbtKind kind) {
  switch (kind) {
    case NbtKind::kByte:
      return reader.i8();
    case NbtKind::kShort:
      return reader.i16_be();
    case NbtKind::kInt:
      return reader.i32_be();
    case NbtKind::kLong:
      return static_cast<std::int64_t>(reader.u64_be());
    default:
      reader.fail("a tag before byte offset ", reader.offset(), " is no whole number");
  }
}

/// Passes over a value of `kind`. Nesting is limited to 512, as the format has it; nothing is kept.
/// @throws InputError  a kind that there is not, values that the bytes do not hold
void nbt_skip(ByteReader& reader, NbtKind kind, int depth = 0) {
  constexpr int kDeepest = 512;
  NbtKind of = kind;
  std::uint64_t count = kind == NbtKind::kList ? nbt_list(reader, &of) : 1;
  if (fixed_bytes(of) != 0 || count == 0) {
    reader.skip(fixed_bytes(of) * count);
    return;
  }
  const bool is_compound = kind == NbtKind::kCompound;
  reader.fail_if((is_compound || kind == NbtKind::kList) && depth == kDeepest,
                 "tags are nested deeper than the limit of ", kDeepest);
  if (is_compound) {
    nbt_compound(reader, [&](NbtKind inner, std::string_view) { nbt_skip(reader, inner, depth + 1); });
  } else if (kind == NbtKind::kText) {
    reader.text(reader.u16_be());
  } else if (kind != NbtKind::kList) {
    nbt_array(reader, kind);
  } else {
    for (; count > 0; --count) {
      nbt_skip(reader, of, depth + 1);
    }
  }
}

/// How the numbers of blocks are written.
enum class BlockCode : std::uint8_t {
  kBytes,    ///< one each, and no palette
  kVarints,  ///< seven bits a byte, lowest first; the eighth says that more follow
  kWords,    ///< just the bits that the palette takes, in big-endian words from their lowest bits on
  kList,     ///< compounds of pos and state
  kNodes     ///< two bytes each, and behind them their chances; y runs before z
};

/// Blocks of a box: x runs fastest, then z, then y.
struct BlockBox {
  std::array<std::int64_t, 3> corner{};  ///< lowest x, y, z
  std::array<std::uint32_t, 3> size{};
  std::span<const std::uint8_t> blocks;
  std::vector<std::optional<Rgb>> palette;

  std::uint64_t cells() const { return std::uint64_t{size[0]} * size[1] * size[2]; }
  /// Litematica's bits of a block.
  unsigned bits() const { return std::max(2U, static_cast<unsigned>(std::bit_width(palette.size() - 1))); }
};

std::uint32_t checked_side(std::string_view name, std::int64_t value) {
  fail_if(value < 1 || value > std::int64_t{kGridSideLimit}, name, " is ", value, "; a side has 1 to ",
          kGridSideLimit, " blocks");
  return static_cast<std::uint32_t>(value);
}

/// Three whole numbers: a list, or a compound of x, y and z.
std::array<std::int32_t, 3> read_triple(ByteReader& reader, NbtKind kind) {
  std::array<std::int32_t, 3> out{};
  NbtKind of = NbtKind::kEnd;
  if (kind == NbtKind::kCompound) {
    nbt_compound(reader, [&](NbtKind entry_kind, std::string_view name) {
      if (name == "x" || name == "y" || name == "z") {
        out[static_cast<std::size_t>(name[0] - 'x')] =
            static_cast<std::int32_t>(nbt_integer(reader, entry_kind));
      } else {
        nbt_skip(reader, entry_kind);
      }
    });
  } else {
    const bool has_three = kind == NbtKind::kList && nbt_list(reader, &of) == 3;
    reader.fail_if(!has_three, "no three numbers before byte offset ", reader.offset());
    for (std::int32_t& number : out) {
      number = static_cast<std::int32_t>(nbt_integer(reader, of));
    }
  }
  return out;
}

/// A list of blocks' names with their properties.
std::vector<std::optional<Rgb>> read_palette(ByteReader& reader) {
  std::vector<std::optional<Rgb>> palette;
  NbtKind of = NbtKind::kEnd;
  for (std::uint32_t left = nbt_list(reader, &of); left > 0; --left) {
    std::string_view block;
    if (of == NbtKind::kCompound) {
      nbt_compound(reader, [&](NbtKind kind, std::string_view name) {
        if (kind == NbtKind::kText && name == "Name") {
          block = reader.text(reader.u16_be());
        } else {
          nbt_skip(reader, kind);
        }
      });
    }
    reader.fail_if(block.empty(), "entry ", palette.size(), " of a palette has no Name, before byte offset ",
                   reader.offset());
    palette.push_back(block_color(block));
  }
  return palette;
}

class SchematicGrid final : public VoxelGrid {
 public:
  SchematicGrid(const SharedBytes& file, bool is_minetest) : file_(file) {
    if (is_minetest) {
      read_nodes(ByteReader(file.bytes, "the header"));
      check();
      return;
    }
    fail_if(!looks_like_schematic(file.text()),
            "is no schematic: it does not begin with a compound tag, nameless or named Schematic");
    ByteReader reader(file.bytes, "the tags");
    std::string_view name;
    nbt_head(reader, &name);
    read_compound(reader);
    check();
  }

  void for_each(const Visit& visit) const override {
    for (const BlockBox& box : boxes_) {
      walk(box, [&](std::uint64_t index, const std::optional<Rgb>& color) {
        if (color) {
          const auto at = [&](std::size_t axis, std::uint64_t local) {
            return static_cast<std::int32_t>(box.corner[axis] - low_[axis] +
                                             static_cast<std::int64_t>(local));
          };
          const std::int32_t depth = at(2, index / box.size[0] % box.size[2]);
          visit(at(0, index % box.size[0]), code_ == BlockCode::kNodes ? depth : size_[1] - 1 - depth,
                at(1, index / box.size[0] / box.size[2]), *color);
        }
      });
    }
  }

 private:
  void read_nodes(ByteReader reader) {
    reader.expect("MTSM", "Minetest schematic");
    const unsigned version = reader.u16_be();
    fail_if(version < 1 || version > 4, "version ", version,
            " at byte offset 4 is not supported, only 1 to 4 are");
    for (std::uint32_t& side : box_.size) {
      side = reader.u16_be();
      reader.fail_if(side < 1 || side > kGridSideLimit, "a side of ", side, " nodes; there are 1 to ",
                     kGridSideLimit);
    }
    if (version >= 3) {
      reader.skip(box_.size[1]);  // chances of the layers
    }
    for (unsigned left = reader.u16_be(); left > 0; --left) {
      box_.palette.push_back(block_color(reader.text(reader.u16_be())));
    }
    constexpr std::uint64_t kNodeBytes = 4;  // a number, a chance, a turn; each for all nodes together
    const std::uint64_t bytes = box_.cells() * kNodeBytes;
    file_ = inflate_bytes(reader.take(reader.remaining()), Deflated::kZlib, bytes, "the nodes");
    box_.blocks = file_.bytes;
    fail_if(box_.blocks.size() != bytes, "the nodes take ", box_.blocks.size(), " bytes, not 4 for each of ",
            box_.cells());
    code_ = BlockCode::kNodes;
    chance_bits_ = version < 2 ? 0 : version < 4 ? 0xFFU : 0x7FU;
  }

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
      box_.size[static_cast<std::size_t>(side - kSides.begin())] =
          checked_side(name, nbt_integer(reader, kind) & 0xFFFF);
    } else if (kind == NbtKind::kCompound && name == "Palette") {
      code_ = BlockCode::kVarints;
      nbt_compound(reader, [&](NbtKind entry_kind, std::string_view block) {
        add_to_palette(nbt_integer(reader, entry_kind), block);
      });
    } else if (kind == NbtKind::kBytes && (name == "Blocks" || name == "BlockData")) {
      box_.blocks = nbt_array(reader, kind);
    } else if (kind == NbtKind::kBytes && name == "Data") {
      data_ = nbt_array(reader, kind);
    } else if (kind == NbtKind::kBytes && name == "AddBlocks") {
      add_ = nbt_array(reader, kind);
    } else if (kind == NbtKind::kCompound && name == "Regions") {
      nbt_compound(reader, [&](NbtKind entry_kind, std::string_view region) {
        if (entry_kind == NbtKind::kCompound) {
          read_region(reader, region);
        } else {
          nbt_skip(reader, entry_kind);
        }
      });
    } else if (kind == NbtKind::kList) {
      read_structure_list(reader, name);
    } else {
      nbt_skip(reader, kind);
    }
  }

  void read_structure_list(ByteReader& reader, std::string_view name) {
    if (name == "size") {
      const std::array<std::int32_t, 3> size = read_triple(reader, NbtKind::kList);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box_.size[axis] = checked_side("size", size[axis]);
      }
    } else if (name == "palette") {
      box_.palette = read_palette(reader);
    } else if (name == "palettes") {
      NbtKind of = NbtKind::kEnd;
      const std::uint32_t count = nbt_list(reader, &of);
      for (std::uint32_t i = 0; i < count; ++i) {
        if (i == 0 && of == NbtKind::kList) {
          box_.palette = read_palette(reader);
        } else {
          nbt_skip(reader, of);
        }
      }
      note_if(count > 1, notes, "of its ", count, " palettes the first is shown");
    } else {
      const std::size_t from = static_cast<std::size_t>(reader.offset());
      nbt_skip(reader, NbtKind::kList);
      if (name == "blocks") {
        code_ = BlockCode::kList;
        box_.blocks = file_.bytes.subspan(from, static_cast<std::size_t>(reader.offset()) - from);
      }
    }
  }

  /// A negative size reaches from the position down.
  void read_region(ByteReader& reader, std::string_view name) {
    BlockBox box;
    std::array<std::int32_t, 3> position{};
    std::array<std::int32_t, 3> size{};
    nbt_compound(reader, [&](NbtKind kind, std::string_view entry) {
      if (entry == "Position") {
        position = read_triple(reader, kind);
      } else if (entry == "Size") {
        size = read_triple(reader, kind);
      } else if (kind == NbtKind::kList && entry == "BlockStatePalette") {
        box.palette = read_palette(reader);
      } else if (kind == NbtKind::kLongs && entry == "BlockStates") {
        box.blocks = nbt_array(reader, kind);
      } else {
        nbt_skip(reader, kind);
      }
    });
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t side = size[axis];
      box.corner[axis] = position[axis] + std::min<std::int64_t>(side + 1, 0);
      box.size[axis] = checked_side("Size of region " + quoted(name), side < 0 ? -side : side);
    }
    fail_if(box.palette.empty() || box.blocks.size() / 8 < (box.cells() * box.bits() + 63) / 64, "region ",
            quoted(name), " has no room for ", box.cells(), " blocks of ", box.palette.size(), " kinds in ",
            box.blocks.size(), " bytes");
    boxes_.push_back(std::move(box));
  }

  void add_to_palette(std::int64_t index, std::string_view block) {
    // Palettes are dense, and an entry takes at least seven bytes.
    fail_if(index < 0 || static_cast<std::uint64_t>(index) > file_.bytes.size() / 7,
            "the palette has the number ", index, " for ", quoted(block), ", more than the file has entries");
    box_.palette.resize(std::max(box_.palette.size(), static_cast<std::size_t>(index) + 1));
    box_.palette[static_cast<std::size_t>(index)] = block_color(block);
  }

  void check() {
    if (boxes_.empty()) {
      check_box();
      boxes_.push_back(std::move(box_));
    } else {
      code_ = BlockCode::kWords;
    }
    Extent<std::int64_t> all;
    for (const BlockBox& box : boxes_) {
      all.add(box.corner);
      all.add({box.corner[0] + box.size[0], box.corner[1] + box.size[1], box.corner[2] + box.size[2]});
    }
    low_ = all.low;
    const auto side = [&](std::size_t axis) {
      return checked_side("a side of all regions", all.high[axis] - low_[axis]);
    };
    set_size(side(0), side(2), side(1));  // here z is up
    check_solid("the schematic holds nothing but air");
  }

  void check_box() {
    const std::uint64_t cells = box_.cells();
    fail_if(cells == 0, "Width, Height and Length are not all there, nor are Regions or a structure's size");
    // Version 3 calls the numbers of its palette Data.
    if (code_ == BlockCode::kVarints && box_.blocks.empty()) {
      box_.blocks = std::exchange(data_, {});
    }
    fail_if(code_ == BlockCode::kBytes ? box_.blocks.size() != cells
                                       : code_ == BlockCode::kVarints && box_.blocks.size() < cells,
            "the blocks take ", box_.blocks.size(), " bytes, but ", box_.size[0], " x ", box_.size[1], " x ",
            box_.size[2], " of them are announced");
  }

  template <class Take>
  void walk(const BlockBox& box, const Take& take) const {
    if (code_ == BlockCode::kList) {
      walk_list(box, take);
      return;
    }
    const std::uint64_t cells = box.cells();
    std::size_t at = 0;
    for (std::uint64_t i = 0; i < cells; ++i) {
      if (code_ == BlockCode::kBytes) {
        take(i, numbered_color(box, static_cast<std::size_t>(i)));
      } else if (code_ == BlockCode::kNodes) {
        const auto& color = palette_color(box, i, load_bits(&box.blocks[2 * i], 2, true));
        const bool is_there = chance_bits_ == 0 || (box.blocks[2 * cells + i] & chance_bits_) != 0;
        const std::uint64_t y = i / box.size[0] % box.size[1];
        const std::uint64_t z = i / box.size[0] / box.size[1];
        take((y * box.size[2] + z) * box.size[0] + i % box.size[0], is_there ? color : std::nullopt);
      } else {
        take(i, palette_color(box, i, code_ == BlockCode::kWords ? packed(box, i) : varint(box, i, &at)));
      }
    }
  }

  std::optional<Rgb> numbered_color(const BlockBox& box, std::size_t i) const {
    unsigned number = box.blocks[i];
    if (i / 2 < add_.size()) {
      number |= (unsigned{add_[i / 2]} >> (i % 2 == 0 ? 4U : 0U) & 0xFU) << 8;
    }
    return block_color(number, i < data_.size() ? data_[i] : 0U);
  }

  static const std::optional<Rgb>& palette_color(const BlockBox& box, std::uint64_t i, std::uint64_t number) {
    fail_if(number >= box.palette.size(), "block ", i, " has the number ", number,
            ", which is not among the ", box.palette.size(), " of the palette");
    return box.palette[static_cast<std::size_t>(number)];
  }

  static std::uint64_t varint(const BlockBox& box, std::uint64_t i, std::size_t* at) {
    std::uint64_t number = 0;
    for (unsigned shift = 0;; shift += 7) {
      fail_if(*at == box.blocks.size() || shift > 28, "block ", i, " of ", box.cells(),
              " is cut off or too long");
      const std::uint8_t byte = box.blocks[(*at)++];
      number |= std::uint64_t{byte & 0x7FU} << shift;
      if ((byte & 0x80U) == 0) {
        return number;
      }
    }
  }

  static std::uint64_t packed(const BlockBox& box, std::uint64_t i) {
    const unsigned bits = box.bits();
    const std::uint8_t* const word = box.blocks.data() + i * bits / 64 * 8;
    const unsigned first = static_cast<unsigned>(i * bits % 64);
    std::uint64_t number = load_bits(word, 8, true) >> first;
    if (first + bits > 64) {
      number |= load_bits(word + 8, 8, true) << (64 - first);
    }
    return number & ((std::uint64_t{1} << bits) - 1);
  }

  template <class Take>
  void walk_list(const BlockBox& box, const Take& take) const {
    ByteReader reader(box.blocks, "the blocks");
    NbtKind of = NbtKind::kEnd;
    const std::uint32_t count = nbt_list(reader, &of);
    for (std::uint32_t i = 0; i < count; ++i) {
      std::array<std::int32_t, 3> at{-1, -1, -1};
      std::int64_t state = -1;
      if (of == NbtKind::kCompound) {
        nbt_compound(reader, [&](NbtKind kind, std::string_view name) {
          if (name == "pos") {
            at = read_triple(reader, kind);
          } else if (name == "state") {
            state = nbt_integer(reader, kind);
          } else {
            nbt_skip(reader, kind);
          }
        });
      }
      std::array<std::uint64_t, 3> place{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        place[axis] = static_cast<std::uint64_t>(at[axis]);
        fail_if(place[axis] >= box.size[axis], "block ", i, " of the list is not within the size");
      }
      take((place[1] * box.size[2] + place[2]) * box.size[0] + place[0],
           palette_color(box, i, static_cast<std::uint64_t>(state)));
    }
  }

  SharedBytes file_;
  BlockBox box_;  ///< until it is the only one of `boxes_`
  std::vector<BlockBox> boxes_;
  std::array<std::int64_t, 3> low_{};  ///< x, y, z of the file
  std::span<const std::uint8_t> data_, add_;
  BlockCode code_ = BlockCode::kBytes;
  unsigned chance_bits_ = 0;  ///< of a node's byte; none: all nodes are there
};

}  // namespace

/// True for a compound named Schematic, or a nameless one whose first tag has a name, unpacked.
bool looks_like_schematic(std::string_view text) {
  constexpr std::string_view kNamed("\x0A\x00\x09Schematic", 12);
  constexpr std::string_view kNameless("\x0A\x00\x00", 3);
  return text.starts_with(kNamed) || (text.starts_with(kNameless) && text.size() > 6 && text[3] > 0 &&
                                      text[3] <= static_cast<char>(NbtKind::kLongs) && text[4] == 0 &&
                                      text[5] != 0 && static_cast<std::uint8_t>(text[6]) > ' ');
}

/// Memory: 4 bytes a palette entry, 80 a region.
/// @throws InputError  broken tags; a size that is missing, 0 or over `kGridSideLimit`, of all regions together, too;
///   not as many blocks as the size says; a block outside of it, or that the palette does not have; nothing but air
Source read_schematic(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<SchematicGrid>(file, false);
}

/// Memory: 4 bytes a node of the schematic, as many as it unpacks to.
/// @throws InputError  another version, a side of 0 or over `kGridSideLimit`, damaged deflated data or not as
///   much of it as the size says, a node without a name, nothing but air
Source read_mts(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<SchematicGrid>(file, true);
}

}  // namespace thimble::tools
