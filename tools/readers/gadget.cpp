// Gadget-1 snapshots of N-body simulations (format 1), positions only.
//
// The file is a chain of Fortran records, each between two copies of its length in bytes:
//
//     +-----+------------------+-----+   +-----+--------------------+-----+   +-----+--
//     | 256 | header, 256 bytes| 256 |   | len | POS: x y z, x y z..| len |   | len | VEL, ID, ...
//     +-----+------------------+-----+   +-----+--------------------+-----+   +-----+--
//
// The header begins with the numbers of particles of six types, in which order their positions follow; they
// are of float or of double, as the record's length tells. The byte order is the one in which the first
// marker is 256. Records after the positions are not read, but their markers are held against the file's
// size, so that a file that was cut off is noticed. Of a snapshot in several files this is one.
//
// Colours tell the types apart: `kGadgetColors`. Format 2 (records with names) is refused by name.
//
// Source of the format: Springel, "User guide for GADGET-2", section 6.
#include "readers/formats.h"

namespace thimble::tools {

namespace {

/// The colour of each particle type.
constexpr std::array<Rgb, 6> kGadgetColors{{
    {64, 160, 255},   // 0 gas: blue
    {128, 96, 176},   // 1 halo (dark matter): violet
    {255, 208, 112},  // 2 disk: gold
    {255, 128, 64},   // 3 bulge: orange
    {255, 255, 240},  // 4 stars: white
    {96, 208, 128},   // 5 boundary: green
}};

constexpr std::uint32_t kGadgetHeaderBytes = 256;
constexpr std::size_t kMarkerBytes = 4;
constexpr std::size_t kParticleTypes = 6;

/// A record's data, without the markers.
struct Record {
  std::size_t offset = 0;
  std::uint32_t size_bytes = 0;
  std::size_t end() const { return offset + size_bytes + kMarkerBytes; }
};

/// The record whose first marker is at `offset`; both markers are in the file and agree.
Record record_at(std::span<const std::uint8_t> bytes, std::size_t offset, bool is_big_endian) {
  const std::string place = "record at byte offset " + std::to_string(offset);
  fail_if(bytes.size() - offset < kMarkerBytes, place, ": the file ends in its marker");
  Record record;
  record.offset = offset + kMarkerBytes;
  record.size_bytes = static_cast<std::uint32_t>(load_bits(&bytes[offset], kMarkerBytes, is_big_endian));
  const std::uint64_t left = bytes.size() - record.offset;
  fail_if(std::uint64_t{record.size_bytes} + kMarkerBytes > left, place, ": it takes ", record.size_bytes,
          " bytes and a marker of ", kMarkerBytes, ", but ", left, " bytes are left");
  const std::uint64_t marker =
      load_bits(&bytes[record.offset + record.size_bytes], kMarkerBytes, is_big_endian);
  fail_if(marker != record.size_bytes, place, ": its length is ", record.size_bytes, " before the data and ",
          marker, " after it");
  return record;
}

class GadgetCloud final : public PointCloud {
 public:
  SharedBytes file;
  bool is_big_endian = false;
  std::array<std::uint32_t, kParticleTypes> counts{};
  std::size_t positions_offset = 0;
  std::size_t number_bytes = sizeof(float);

  void for_each(const Visit& visit) const override {
    std::uint64_t line = 0;
    for (std::size_t type = 0; type < kParticleTypes; ++type) {
      for (std::uint32_t i = 0; i < counts[type]; ++i) {
        const std::size_t first = positions_offset + static_cast<std::size_t>(line) * 3 * number_bytes;
        visit({number(first), number(first + number_bytes), number(first + 2 * number_bytes),
               kGadgetColors[type], ++line});
      }
    }
  }
  bool has_color() const override { return true; }

 private:
  double number(std::size_t offset) const {
    return load_number(&file.bytes[offset], {'f', number_bytes}, is_big_endian);
  }
};

/// By the first marker.
bool is_file_big_endian(std::span<const std::uint8_t> bytes) {
  if (bytes.size() >= kMarkerBytes) {
    for (const bool is_big_endian : {false, true}) {
      const std::uint64_t marker = load_bits(&bytes[0], kMarkerBytes, is_big_endian);
      if (marker == kGadgetHeaderBytes) {
        return is_big_endian;
      }
      fail_if(marker == 8 && bytes.size() >= 8 && bytes[4] == 'H' && bytes[5] == 'E',
              "this is a Gadget snapshot of format 2; only format 1 is supported");
    }
  }
  throw InputError(
      "the file does not begin with a record of 256 bytes, as a Gadget snapshot of format 1 does");
}

}  // namespace

/// True when the bytes begin with a record of 256 bytes in either byte order.
bool looks_like_gadget(std::string_view text) {
  constexpr std::array kMarkers{std::string_view("\0\1\0\0", 4), std::string_view("\0\0\1\0", 4)};
  return std::any_of(kMarkers.begin(), kMarkers.end(), [&](std::string_view marker) {
    return text.starts_with(marker) && text.substr(kMarkerBytes).size() >= kGadgetHeaderBytes &&
           text.substr(kMarkerBytes + kGadgetHeaderBytes).starts_with(marker);
  });
}

/// `CloudPoint::line` is the particle's number, from 1.
/// @throws InputError  naming the byte offset or the particle: no such snapshot, markers that disagree or
///   leave the file, positions that are not as many as the header's particles, a position that is not finite,
///   no particles
Source read_gadget(const SharedBytes& file, const ReadOptions&, const Progress& progress) {
  auto cloud = std::make_unique<GadgetCloud>();
  const std::span<const std::uint8_t> bytes = file.bytes;
  cloud->is_big_endian = is_file_big_endian(bytes);
  const Record header = record_at(bytes, 0, cloud->is_big_endian);
  std::uint64_t particles = 0;
  for (std::size_t type = 0; type < kParticleTypes; ++type) {
    cloud->counts[type] =
        static_cast<std::uint32_t>(load_bits(&bytes[header.offset + 4 * type], 4, cloud->is_big_endian));
    particles += cloud->counts[type];
  }
  fail_if(particles == 0, "the header counts no particles");
  const Record positions = record_at(bytes, header.end(), cloud->is_big_endian);
  if (positions.size_bytes == particles * 3 * sizeof(float)) {
    cloud->number_bytes = sizeof(float);
  } else if (positions.size_bytes == particles * 3 * sizeof(double)) {
    cloud->number_bytes = sizeof(double);
  } else {
    throw InputError("the header counts ", particles,
                     " particles, but the record of positions at byte offset ", header.end(), " has ",
                     positions.size_bytes, " bytes, not ", particles * 12, " or ", particles * 24);
  }
  cloud->positions_offset = positions.offset;
  cloud->file = file;
  for (std::size_t offset = positions.end(); offset < bytes.size();) {
    offset = record_at(bytes, offset, cloud->is_big_endian).end();
  }
  ProgressMeter meter(progress, bytes.size());
  const std::size_t point_bytes = 3 * cloud->number_bytes;
  cloud->for_each([&](const CloudPoint& point) {
    fail_if(!point.is_finite(), "the position of particle ", point.line, " is not finite");
    meter.at(positions.offset + static_cast<std::size_t>(point.line) * point_bytes);
  });
  return cloud;
}

}  // namespace thimble::tools
