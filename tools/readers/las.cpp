// `.las` and `.laz` laser scans, versions 1.0 to 1.4, point formats 0 to 10.
//
// What is read: positions, and colours of the formats that have them (2, 3, 5, 7, 8, 10). Colours have 16
// bits, but many files hold bytes: where no component of the file is above 255, they are taken to be that;
// where all are 0, there are none. Points marked as withheld are left out, which is what the mark is for.
// All else (intensity, returns, classes, waves, records of variable length, the coordinate system) is passed
// over. z is up, as it is in the file.
//
// Points that are compressed (laz.cpp) are unpacked first, what is read of them alone.
//
// Source of the format: ASPRS, "LAS Specification 1.4 - R15", and those of the versions before it.
#include "readers/formats.h"

namespace thimble::tools {
namespace {

constexpr std::uint64_t kNoColor = 0;

struct PointFormat {
  std::uint16_t least_bytes;
  std::uint16_t color_offset;  ///< `kNoColor` without
};
constexpr std::array<PointFormat, 11> kFormats{{{20, 0},
                                                {28, 0},
                                                {26, 20},
                                                {34, 28},
                                                {57, 0},
                                                {63, 28},
                                                {30, 0},
                                                {36, 30},
                                                {38, 30},
                                                {59, 0},
                                                {67, 30}}};

class LasCloud final : public PointCloud {
 public:
  LasCloud(const SharedBytes& file, const ReadOptions& options, const Progress& progress) : file_(file) {
    read_header(progress);
    ProgressMeter meter(progress, file_.bytes.size());
    std::uint16_t highest = 0;
    std::uint64_t kept = 0;
    walk([&](const CloudPoint& point, const std::uint8_t* color) {
      ++kept;
      fail_if(!point.is_finite(), "the position of point ", point.line, " is not finite");
      for (std::size_t channel = 0; color != nullptr && channel < 3; ++channel) {
        highest = std::max(highest, component(color, channel));
      }
      meter.at(first_offset_ + (point.line - 1) * record_bytes_);
    });
    fail_if(kept == 0, count_ == 0 ? "the file holds no points" : "all points of the file are withheld");
    has_color_ = highest > 0;
    // 16 bits by the specification; cameras of 8 and 12 bits write what they have, or 8 bits times 16.
    full_ = options.full_color != 0 ? options.full_color
            : highest <= 255        ? 255
            : highest <= 4080       ? 4080
            : highest <= 4095       ? 4095
                                    : 65535;
    note_if(has_color_ && full_ != 65535 && options.full_color == 0, notes, "no color is above ", highest,
            ": they are taken for ", full_ == 255 ? "8" : "12", " bits, not 16 (--colors says otherwise)");
  }

  void for_each(const Visit& visit) const override {
    walk([&](CloudPoint& point, const std::uint8_t* color) {
      if (has_color_) {
        point.color = {byte_of(component(color, 0)), byte_of(component(color, 1)),
                       byte_of(component(color, 2))};
      }
      visit(point);
    });
  }
  bool has_color() const override { return has_color_; }

 private:
  void read_header(const Progress& progress) {
    ByteReader header(file_.bytes, "the header");
    header.expect("LASF", "LAS file");
    header.skip(20);
    const unsigned major = header.u8();
    const unsigned minor = header.u8();
    fail_if(major != 1 || minor > 4, "version ", major, ".", minor,
            " at byte offset 24 is not supported, only 1.0 to 1.4 are");
    header.skip(68);
    const std::uint16_t header_bytes = header.u16();
    first_offset_ = header.u32();
    header.skip(4);
    const unsigned marked_format = header.u8();
    const unsigned format = marked_format & 0x3FU;
    const bool is_packed = marked_format != format;
    record_bytes_ = header.u16();
    count_ = header.u32();
    header.skip(20);
    for (double& scale : scale_) {
      scale = header.f64();
    }
    for (double& offset : offset_) {
      offset = header.f64();
    }
    constexpr std::uint16_t kHeaderBytes14 = 375;
    if (minor == 4 && header_bytes >= kHeaderBytes14) {
      header.skip(247 - header.offset());
      const std::uint64_t count = header.u64();
      count_ = count != 0 ? count : count_;
    }
    fail_if(format >= kFormats.size(), "point format ", format,
            " at byte offset 104 is not supported, only 0 to 10 are");
    is_new_format_ = format >= 6;
    color_offset_ = kFormats[format].color_offset;
    fail_if(record_bytes_ < kFormats[format].least_bytes, "points of format ", format, " take at least ",
            kFormats[format].least_bytes, " bytes, but the header says ", record_bytes_);
    if (is_packed) {
      const bool has_color = color_offset_ != kNoColor;
      file_ = unpack_laz(file_, {first_offset_, count_, record_bytes_}, has_color, progress);
      first_offset_ = 0;
      record_bytes_ = has_color ? kColoredPointBytes : kPlainPointBytes;
      color_offset_ = has_color ? kPlainPointBytes : kNoColor;
    }
    const std::uint64_t room =
        first_offset_ < file_.bytes.size() ? (file_.bytes.size() - first_offset_) / record_bytes_ : 0;
    fail_if(count_ > room, "the header counts ", count_, " points, but from byte offset ", first_offset_,
            " on the file has room for ", room);
  }

  /// Calls take(point, color) for each point that is not withheld, without its colour, whose three components of 16 bits
  /// stand at `color` (null: the format has none).
  template <class Take>
  void walk(const Take& take) const {
    const std::uint8_t* record = file_.bytes.data() + first_offset_;
    const auto coordinate = [&](std::size_t axis) {
      const auto bits = static_cast<std::uint32_t>(load_bits(record + 4 * axis, 4, false));
      return static_cast<std::int32_t>(bits) * scale_[axis] + offset_[axis];
    };
    for (std::uint64_t i = 0; i < count_; ++i, record += record_bytes_) {
      CloudPoint point{coordinate(0), coordinate(1), coordinate(2), {}, i + 1};
      const bool is_withheld = (record[15] & (is_new_format_ ? 0x04U : 0x80U)) != 0;
      if (!is_withheld) {
        take(point, color_offset_ == kNoColor ? nullptr : record + color_offset_);
      }
    }
  }
  static std::uint16_t component(const std::uint8_t* color, std::size_t channel) {
    return static_cast<std::uint16_t>(load_bits(color + 2 * channel, 2, false));
  }
  std::uint8_t byte_of(std::uint16_t component) const {
    return static_cast<std::uint8_t>(std::min((component * 255U + full_ / 2) / full_, 255U));
  }

  SharedBytes file_;
  std::uint64_t first_offset_ = 0;
  std::uint64_t record_bytes_ = 0;
  std::uint64_t count_ = 0;
  std::uint64_t color_offset_ = kNoColor;
  std::array<double, 3> scale_{}, offset_{};
  bool is_new_format_ = false;
  bool has_color_ = false;
  unsigned full_ = 255;
};

}  // namespace

/// @throws InputError  another version or format, compressed points, a count that the bytes cannot hold, a
///   record too short for its format, a position that is not finite, no point
Source read_las(const SharedBytes& file, const ReadOptions& options, const Progress& progress) {
  return std::make_unique<LasCloud>(file, options, progress);
}

}  // namespace thimble::tools
