// `.las` laser scans, versions 1.0 to 1.4, point formats 0 to 10.
//
// What is read: positions, and colours of the formats that have them (2, 3, 5, 7, 8, 10). Colours have 16
// bits, but many files hold bytes: where no component of the file is above 255, they are taken to be that;
// where all are 0, there are none. Points marked as withheld are left out, which is what the mark is for.
// All else (intensity, returns, classes, waves, records of variable length, the coordinate system) is passed
// over. z is up, as it is in the file.
//
// Not read: `.laz`, the compressed form, for which Debian has no library. It is refused by name.
//
// Source of the format: ASPRS, "LAS Specification 1.4 - R15", and those of the versions before it.
#include "readers/formats.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include "readers/file_bytes.h"
#include "readers/text.h"

namespace thimble::tools {
namespace {

constexpr std::string_view kLasMagic = "LASF";
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
    read_header();
    ProgressMeter meter(progress, file.bytes.size());
    std::uint16_t highest = 0;
    std::uint64_t kept = 0;
    walk([&](const CloudPoint& point, ByteReader& record) {
      ++kept;
      if (!point.is_finite()) {
        throw InputError("the position of point " + std::to_string(point.line) + " is not finite");
      }
      if (color_offset_ != kNoColor) {
        record.skip(color_offset_);
        highest = std::max({highest, record.u16(), record.u16(), record.u16()});
      }
      meter.at(static_cast<std::size_t>(first_offset_ + (point.line - 1) * record_bytes_));
    });
    if (kept == 0) {
      throw InputError(count_ == 0 ? "the file holds no points" : "all points of the file are withheld");
    }
    has_color_ = highest > 0;
    // 16 bits by the specification; cameras of 8 and 12 bits write what they have, or 8 bits times 16.
    full_ = options.full_color != 0 ? options.full_color
            : highest <= 255        ? 255
            : highest <= 4080       ? 4080
            : highest <= 4095       ? 4095
                                    : 65535;
    if (has_color_ && full_ != 65535 && options.full_color == 0) {
      notes.push_back("no color is above " + std::to_string(highest) + ": they are taken for " +
                      (full_ == 255 ? "8" : "12") + " bits, not 16 (--colors says otherwise)");
    }
  }

  void for_each(const Visit& visit) const override {
    walk([&](CloudPoint& point, ByteReader& record) {
      if (has_color_) {
        record.skip(color_offset_);
        point.color.r = byte_of(record.u16());
        point.color.g = byte_of(record.u16());
        point.color.b = byte_of(record.u16());
      }
      visit(point);
    });
  }
  bool has_color() const override { return has_color_; }

 private:
  void read_header() {
    if (!looks_like_las(file_.bytes)) {
      throw InputError("is not a LAS file: it does not begin with \"LASF\"");
    }
    ByteReader header(file_.bytes, "the header");
    header.skip(24);
    const unsigned major = header.u8();
    const unsigned minor = header.u8();
    if (major != 1 || minor > 4) {
      throw InputError("version " + std::to_string(major) + "." + std::to_string(minor) +
                       " at byte offset 24 is not supported, only 1.0 to 1.4 are");
    }
    header.skip(68);
    const std::uint16_t header_bytes = header.u16();
    first_offset_ = header.u32();
    header.skip(4);
    const unsigned format = header.u8();
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
    if ((format & 0xC0U) != 0) {
      throw InputError(
          "its points are compressed (LAZ), which is not read; unpack it first, for example with \"pdal "
          "translate in.laz out.las\"");
    }
    if (format >= kFormats.size()) {
      throw InputError("point format " + std::to_string(format) +
                       " at byte offset 104 is not supported, only 0 to 10 are");
    }
    is_new_format_ = format >= 6;
    color_offset_ = kFormats[format].color_offset;
    if (record_bytes_ < kFormats[format].least_bytes) {
      throw InputError("points of format " + std::to_string(format) + " take at least " +
                       std::to_string(kFormats[format].least_bytes) + " bytes, but the header says " +
                       std::to_string(record_bytes_));
    }
    const std::uint64_t room =
        first_offset_ < file_.bytes.size() ? (file_.bytes.size() - first_offset_) / record_bytes_ : 0;
    if (count_ > room) {
      throw InputError("the header counts " + std::to_string(count_) + " points, but from byte offset " +
                       std::to_string(first_offset_) + " on the file has room for " + std::to_string(room));
    }
  }

  /// Calls take(point, record) for each point that is not withheld, without its colour.
  template <class Take>
  void walk(const Take& take) const {
    for (std::uint64_t i = 0; i < count_; ++i) {
      const ByteReader record(file_.bytes.subspan(static_cast<std::size_t>(first_offset_ + i * record_bytes_),
                                                  static_cast<std::size_t>(record_bytes_)));
      ByteReader place = record;
      CloudPoint point;
      point.x = place.i32() * scale_[0] + offset_[0];
      point.y = place.i32() * scale_[1] + offset_[1];
      point.z = place.i32() * scale_[2] + offset_[2];
      point.line = i + 1;
      place.skip(3);
      const bool is_withheld = (place.u8() & (is_new_format_ ? 0x04U : 0x80U)) != 0;
      if (!is_withheld) {
        ByteReader rest = record;
        take(point, rest);
      }
    }
  }
  std::uint8_t byte_of(std::uint16_t component) const {
    return static_cast<std::uint8_t>((component * 255U + full_ / 2) / full_);
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

bool looks_like_las(std::span<const std::uint8_t> bytes) {
  return SharedBytes{bytes, nullptr}.text().starts_with(kLasMagic);
}

/// @throws InputError  another version or format, compressed points, a count that the bytes cannot hold, a
///   record too short for its format, a position that is not finite, no point
Source read_las(const SharedBytes& file, const ReadOptions& options, const Progress& progress) {
  return std::make_unique<LasCloud>(file, options, progress);
}

}  // namespace thimble::tools
