// `.binvox` grids: one bit a voxel, run by run.
//
// What is read: the line `#binvox 1`, the lines `dim`, `translate` and `scale` in any order (the last two
// are held to nothing and not used), comments after a #, `data`, and pairs of bytes, a value (0 or 1) and how often it comes (1
// to 255). Y comes fastest, then z, then x.
//
// The axes are those of the mesh that the grid was made from, and the file does not say which of them is up;
// z is taken to be.
//
// Source of the format: Patrick Min, "BINVOX voxel file format specification".
#include "readers/formats.h"

namespace thimble::tools {
namespace {

constexpr std::string_view kBinvoxMagic = "#binvox";

class BinvoxGrid final : public VoxelGrid {
 public:
  BinvoxGrid(const SharedBytes& file, const Progress& progress) : file_(file) {
    header();
    set_size(dim_[0], dim_[2], dim_[1]);
    has_color_ = false;
    ProgressMeter meter(progress, file.bytes.size());
    const std::uint64_t cells = std::uint64_t{dim_[0]} * dim_[1] * dim_[2];
    std::uint64_t covered = 0;
    std::uint64_t solid = 0;
    std::size_t at = data_offset_;
    for (; covered < cells; at += 2) {
      const std::string place = "run at byte offset " + std::to_string(at);
      fail_if(at + 2 > file.bytes.size(), place, ": the file ends after ", covered, " of ", cells, " voxels");
      const unsigned value = file.bytes[at];
      const unsigned count = file.bytes[at + 1];
      fail_if(value > 1 || count == 0 || covered + count > cells, place, ": the value ", value, ", ", count,
              " times, with ", cells - covered, " voxels to go; values are 0 and 1, each 1 to 255 times");
      covered += count;
      solid += value * count;
      meter.at(at);
    }
    fail_if(solid == 0, "the grid holds no solid voxel");
  }

  void for_each(const Visit& visit) const override {
    std::uint64_t index = 0;
    const std::uint64_t cells = std::uint64_t{dim_[0]} * dim_[1] * dim_[2];
    for (std::size_t at = data_offset_; index < cells; at += 2) {
      const std::uint64_t end = index + file_.bytes[at + 1];
      for (; file_.bytes[at] != 0 && index < end; ++index) {
        const auto y = static_cast<std::int32_t>(index % dim_[2]);
        const auto z = static_cast<std::int32_t>(index / dim_[2] % dim_[1]);
        const auto x = static_cast<std::int32_t>(index / dim_[2] / dim_[1]);
        visit(x, y, z, Rgb{});
      }
      index = end;
    }
  }

 private:
  void header() {
    ByteReader(file_.bytes).expect(kBinvoxMagic, "binvox file");
    LineReader lines(file_.text());
    std::string_view line;
    lines.next(line);
    fail_at_line_if(line.substr(kBinvoxMagic.size()) != " 1", 1, quoted(line),
                    " is not version 1, the only one that is read");
    for (bool more = true; more;) {
      fail_if(!lines.next(line), "the header has no line 'data'");
      const std::string_view word = take_word(line);
      more = word != "data";
      if (word == "dim") {
        for (std::uint32_t& side : dim_) {
          std::int64_t value = 0;
          const std::string_view number = take_word(line);
          fail_at_line_if(!parse_integer(number, value) || value < 1 || value > std::int64_t{kGridSideLimit},
                          lines.line_number(), "the side ", quoted(number), " is no number from 1 to ",
                          kGridSideLimit);
          side = static_cast<std::uint32_t>(value);
        }
      } else {
        fail_at_line_if(more && word != "translate" && word != "scale" && !word.empty() && word[0] != '#',
                        lines.line_number(), quoted(word), " is not dim, translate, scale or data");
      }
    }
    fail_at_line_if(dim_[0] == 0, lines.line_number(), "'data' comes before 'dim'");
    data_offset_ = lines.offset();
  }

  SharedBytes file_;
  std::array<std::uint32_t, 3> dim_{};  ///< slowest first: x, z, y
  std::size_t data_offset_ = 0;
};

}  // namespace

/// @throws InputError  another version; no `dim` before `data`, a side of 0 or over `kGridSideLimit`; a value
///   other than 0 and 1, runs that end before or after the grid does; no solid voxel
Source read_binvox(const SharedBytes& file, const ReadOptions&, const Progress& progress) {
  return std::make_unique<BinvoxGrid>(file, progress);
}

}  // namespace thimble::tools
