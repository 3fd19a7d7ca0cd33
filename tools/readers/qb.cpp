// `.qb` models (Qubicle Binary), version 1.1.0.0, packed or not, and `.qbcl` projects of Qubicle, version 2.
//
// What is read: all matrices at their positions, colours as RGBA or (`.qb`) BGRA; a voxel whose alpha (or mask of
// visible sides) is 0 is empty. What a project hides stays hidden; a compound is its matrix, in which the file has put
// its parts together. In the file y is up, and z comes towards the eye or, left-handed, goes away from it; here z is up, (x, y, z) -> (x, -z, y),
// and the lowest corner of all matrices is 0,0,0. Pivots, and 36 bytes of a model whose meaning is not known, are
// passed over.
//
// Sources of the formats: Minddesk, "Qubicle Binary File Format"; tostc, "Qubicle's proprietary format QBCL v2.0".
#include "readers/formats.h"

namespace thimble::tools {
namespace {

constexpr std::uint32_t kVersion = 0x00000101;  // bytes 1, 1, 0, 0
constexpr std::uint32_t kRunFlag = 2;
constexpr std::uint32_t kNextSliceFlag = 6;
constexpr std::uint32_t kProjectVersion = 2;
constexpr std::uint32_t kMatrixNode = 0;
constexpr std::uint32_t kModelNode = 1;
constexpr std::uint32_t kCompoundNode = 2;

struct Matrix {
  std::array<std::uint32_t, 3> size{};
  std::array<std::int64_t, 3> position{};
  std::size_t data_offset = 0;
};

class QubicleGrid final : public VoxelGrid {
 public:
  QubicleGrid(const SharedBytes& file, bool is_project)
      : file_(file), is_project_(is_project), is_packed_(is_project) {
    ByteReader reader(file.bytes, "the header");
    if (is_project) {
      read_project(reader);
    } else {
      read_binary(reader);
    }
    place();
  }

  void for_each(const Visit& visit) const override {
    for (const Matrix& matrix : matrices_) {
      ByteReader reader(file_.bytes.subspan(matrix.data_offset), "a matrix", matrix.data_offset);
      walk(matrix, reader, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t bits) {
        const auto at = [&](std::size_t axis, std::uint32_t local) {
          return static_cast<std::int32_t>(matrix.position[axis] + local - low_[axis]);
        };
        const Rgb color{static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
                        static_cast<std::uint8_t>(bits >> 16)};
        const std::int32_t depth = at(2, z);
        visit(at(0, x), is_left_handed_ ? depth : size_[1] - 1 - depth, at(1, y),
              is_bgra_ ? Rgb{color.b, color.g, color.r} : color);
      });
    }
  }

 private:
  static constexpr std::uint64_t kMostCells = std::uint64_t{1} << 28;

  void read_binary(ByteReader& reader) {
    fail_if(file_.bytes.size() < 4 || reader.u32() != kVersion,
            "is not a Qubicle file of version 1.1: it does not begin with the bytes 1, 1, 0, 0");
    is_bgra_ = flag(reader, "color format");
    is_left_handed_ = !flag(reader, "z axis");
    is_packed_ = flag(reader, "compression");
    bool is_goxel = !flag(reader, "visibility mask") && !is_packed_ && !is_left_handed_ && !is_bgra_;
    const std::uint32_t count = reader.u32();
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::string_view name = reader.text(reader.u8());
      is_goxel = is_goxel && (name.starts_with("Layer.") || name == "background");
      add_matrix(reader, true);
    }
    if (is_goxel && count != 0) {
      is_left_handed_ = true;
      notes.emplace_back(
          "Goxel wrote it, by the names of its layers: its z axis is taken as left-handed, which Goxel's is, "
          "although the file says right-handed");
    }
  }

  void read_project(ByteReader& reader) {
    reader.expect("QBCL", "Qubicle project");
    reader.skip(4);  // the program's version
    const std::uint32_t version = reader.u32();
    reader.fail_if(version != kProjectVersion, "version ", version,
                   " of Qubicle's projects is not read, only 2 is");
    const std::uint64_t thumbnail_width = reader.u32();
    reader.skip(4 * thumbnail_width * reader.u32());
    for (int i = 0; i < 7; ++i) {
      reader.skip(reader.u32());  // title, author and the like
    }
    reader.skip(16);  // two times
    read_nodes(reader);
  }

  /// Nodes come as the tree is walked, each before its children.
  void read_nodes(ByteReader& reader) {
    struct Level {
      std::uint32_t nodes_left;
      bool is_drawn;
    };
    std::vector<Level> levels{{1, true}};
    while (!levels.empty()) {
      if (levels.back().nodes_left == 0) {
        levels.pop_back();
        continue;
      }
      --levels.back().nodes_left;
      const std::uint32_t kind = reader.u32();
      reader.skip(4);
      reader.skip(reader.u32());  // the name
      const bool is_shown = reader.u8() != 0;
      const bool is_drawn = is_shown && levels.back().is_drawn;
      reader.skip(2);
      if (kind == kModelNode) {
        reader.skip(36);
        levels.push_back({reader.u32(), is_drawn});
      } else if (kind == kMatrixNode || kind == kCompoundNode) {
        add_matrix(reader, is_drawn);
        if (kind == kCompoundNode) {
          levels.push_back({reader.u32(), false});
        }
      } else {
        reader.fail("there is no kind of node ", kind, ", before byte offset ", reader.offset());
      }
    }
  }

  void add_matrix(ByteReader& reader, bool is_drawn) {
    Matrix matrix;
    for (std::uint32_t& side : matrix.size) {
      side = reader.u32();
      reader.fail_if(side > kGridSideLimit, "matrix ", matrices_.size(), " has a side of ", side,
                     " voxels, the limit is ", kGridSideLimit);
    }
    for (std::int64_t& coordinate : matrix.position) {
      coordinate = reader.i32();
    }
    reader.skip(is_project_ ? 12 : 0);  // the pivot
    if (!is_drawn) {
      reader.skip(reader.u32());
      return;
    }
    matrix.data_offset = static_cast<std::size_t>(reader.offset());
    if (is_packed_) {
      // What a run repeats costs no byte, but time.
      cells_ += std::uint64_t{matrix.size[0]} * std::max(matrix.size[1], 1U) * matrix.size[2];
      reader.fail_if(cells_ > kMostCells, "the matrices have more cells than the limit of ", kMostCells);
    }
    walk(matrix, reader, [](auto, auto, auto, auto) {});
    matrices_.push_back(matrix);
  }

  static bool flag(ByteReader& reader, const char* what) {
    const std::uint32_t value = reader.u32();
    reader.fail_if(value > 1, "the ", what, " is ", value, ", not 0 or 1");
    return value == 1;
  }

  /// Reads a matrix's voxels. `take` sees those that are there.
  template <class Take>
  void walk(const Matrix& matrix, ByteReader& reader, const Take& take) const {
    if (is_project_) {
      walk_columns(matrix, reader, take);
    } else {
      walk_slices(matrix, reader, take);
    }
  }

  /// Columns of y, z by z of each x, deflated together: how many groups of four bytes, then these.
  template <class Take>
  void walk_columns(const Matrix& matrix, ByteReader& reader, const Take& take) const {
    constexpr std::uint64_t kMostVoxelBytes = 8;  // a run of one
    const std::uint64_t columns = std::uint64_t{matrix.size[0]} * matrix.size[2];
    const std::string place = "the matrix at byte offset " + std::to_string(reader.offset());
    const std::uint64_t most_bytes = std::min(columns * (2 + kMostVoxelBytes * matrix.size[1]) + 1,
                                              3 * file_.bytes.size() + (std::uint64_t{64} << 20));
    const SharedBytes unpacked = inflate_bytes(reader.take(reader.u32()), Deflated::kZlib, most_bytes, place);
    ByteReader groups(unpacked.bytes, place + ", unpacked");
    for (std::uint64_t column = 0; column < columns; ++column) {
      const auto x = static_cast<std::uint32_t>(column / matrix.size[2]);
      const auto z = static_cast<std::uint32_t>(column % matrix.size[2]);
      std::uint32_t y = 0;
      for (std::uint32_t left = groups.u16(); left > 0; --left) {
        std::uint32_t bits = groups.u32();
        std::uint32_t times = 1;
        if (bits >> 24 == kRunFlag && left > 1) {
          times = bits & 0xFF;
          bits = groups.u32();
          --left;
        }
        groups.fail_if(times > matrix.size[1] - y, "column ", x, ",", z, " holds more than its ",
                       matrix.size[1], " voxels");
        for (const std::uint32_t end = y + times; y < end; ++y) {
          if (bits >> 24 != 0) {
            take(x, y, z, bits);
          }
        }
      }
    }
  }

  /// Slice by slice of z, rows of y of x.
  template <class Take>
  void walk_slices(const Matrix& matrix, ByteReader& reader, const Take& take) const {
    const std::uint64_t slice = std::uint64_t{matrix.size[0]} * matrix.size[1];
    const auto put = [&](std::uint64_t index, std::uint32_t z, std::uint32_t bits) {
      if ((bits >> 24) != 0) {
        take(static_cast<std::uint32_t>(index % matrix.size[0]),
             static_cast<std::uint32_t>(index / matrix.size[0]), z, bits);
      }
    };
    for (std::uint32_t z = 0; z < matrix.size[2]; ++z) {
      if (!is_packed_) {
        reader.fail_if(reader.remaining() / 4 < slice, "the file ends in slice ", z, " of ", matrix.size[2]);
        for (std::uint64_t index = 0; index < slice; ++index) {
          put(index, z, reader.u32());
        }
        continue;
      }
      std::uint64_t index = 0;
      for (std::uint32_t code = reader.u32(); code != kNextSliceFlag; code = reader.u32()) {
        const std::uint32_t times = code == kRunFlag ? reader.u32() : 1;
        const std::uint32_t bits = code == kRunFlag ? reader.u32() : code;
        reader.fail_if(times > slice - index, "slice ", z, " holds more than its ", slice,
                       " voxels, before byte offset ", reader.offset());
        for (const std::uint64_t end = index + times; index < end; ++index) {
          put(index, z, bits);
        }
      }
    }
  }

  void place() {
    Extent<std::int64_t> box;
    for (const Matrix& matrix : matrices_) {
      if (matrix.size[0] != 0 && matrix.size[1] != 0 && matrix.size[2] != 0) {
        box.add(matrix.position);
        box.add({matrix.position[0] + matrix.size[0], matrix.position[1] + matrix.size[1],
                 matrix.position[2] + matrix.size[2]});
      }
    }
    fail_if(box.empty, "the file holds no voxels");
    low_ = box.low;
    constexpr std::array<std::size_t, 3> kTurned{0, 2, 1};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t side = box.high[axis] - low_[axis];
      fail_if(side > std::int64_t{kGridSideLimit}, "the matrices reach over ", side, " voxels, the limit is ",
              kGridSideLimit);
      size_[kTurned[axis]] = static_cast<std::int32_t>(side);
    }
    check_solid("the file holds no voxels");
  }

  SharedBytes file_;
  std::vector<Matrix> matrices_;
  std::array<std::int64_t, 3> low_{};  ///< in the file's axes
  std::uint64_t cells_ = 0;
  bool is_project_ = false, is_packed_ = false, is_bgra_ = false, is_left_handed_ = false;
};

}  // namespace

/// @throws InputError  another version, a code that there is not, matrices or slices that the bytes do not
///   hold, a scene over `kGridSideLimit` on a side, no voxel
Source read_qb(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<QubicleGrid>(file, false);
}

/// Memory while reading and streaming: the bytes of one matrix, unpacked.
/// @throws InputError  the same, and damaged deflated data, a kind of node that there is not
Source read_qbcl(const SharedBytes& file, const ReadOptions&, const Progress&) {
  return std::make_unique<QubicleGrid>(file, true);
}

}  // namespace thimble::tools
