#include "output/part_file.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>

#include "output/file_place.h"
#include "output/output_file.h"
#include "output/units.h"
#include "readers/file_bytes.h"
#include "thimble/picture/camera.h"

namespace thimble::tools {
namespace {

constexpr std::string_view kMagic = "thmPART1";
constexpr std::size_t kHeaderBytes = 48;
constexpr std::size_t kCrcBytes = 4;
using HeaderBytes = std::array<std::uint8_t, kHeaderBytes>;
// Those of 32 bits in their order.
constexpr std::size_t kNumbersAt = 12;
constexpr std::array kNumbers{&PartHeader::width_px,     &PartHeader::height_px,    &PartHeader::first,
                              &PartHeader::count,        &PartHeader::all,          &PartHeader::scene_crc32,
                              &PartHeader::camera_crc32, &PartHeader::options_crc32};

std::uint32_t crc_from(std::uint32_t crc, std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(crc, bytes.data(), bytes.size()));
}

std::uint32_t number_at(const std::uint8_t* from) {
  return static_cast<std::uint32_t>(load_bits(from, 4, false));
}

HeaderBytes bytes_of(const PartHeader& header) {
  HeaderBytes bytes{};
  std::copy(kMagic.begin(), kMagic.end(), bytes.begin());
  bytes[8] = static_cast<std::uint8_t>(header.kind);
  bytes[9] = static_cast<std::uint8_t>(header.pixels);
  bytes[10] = header.has_finer_shades ? 1 : 0;
  for (std::size_t i = 0; i < kNumbers.size(); ++i) {
    put_little(bytes.data() + kNumbersAt + 4 * i, header.*kNumbers[i]);
  }
  put_little(bytes.data() + 44, crc_from(0, std::span(bytes).first(44)));
  return bytes;
}

// What bytes with the right checksum say; false where no writer would say so.
bool parse(const HeaderBytes& bytes, PartHeader* header) {
  if (bytes[8] > static_cast<std::uint8_t>(PartKind::kAnimation) ||
      bytes[9] > static_cast<std::uint8_t>(PartPixels::kMono) || bytes[10] > 1 || bytes[11] != 0) {
    return false;
  }
  header->kind = static_cast<PartKind>(bytes[8]);
  header->pixels = static_cast<PartPixels>(bytes[9]);
  header->has_finer_shades = bytes[10] == 1;
  for (std::size_t i = 0; i < kNumbers.size(); ++i) {
    header->*kNumbers[i] = number_at(bytes.data() + kNumbersAt + 4 * i);
  }
  const bool is_picture = header->kind == PartKind::kRows;
  const auto is_side = [](std::uint32_t side) { return side >= 1 && side <= kMaxPicturePx; };
  return is_side(header->width_px) && is_side(header->height_px) &&
         (is_picture
              ? header->all == header->height_px
              : header->all >= 1 && header->all <= kMostFilmFrames && header->pixels == PartPixels::kRgb) &&
         header->count >= 1 && header->first < header->all && header->count <= header->all - header->first;
}

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {
    std::error_code error;
    // Before it is opened, which waits for whoever writes into a pipe.
    fail_if(std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error),
            "is no file that can be read twice, as a part must be");
    claim_input(path);
    file_.reset(std::fopen(path.c_str(), "rbe"));
    fail_if(file_ == nullptr, std::strerror(errno));
    size_ = std::filesystem::file_size(path, error);
    fail_if(static_cast<bool>(error), error.message());
  }
  template <class... Pieces>
  void fail_if(bool is_wrong, const Pieces&... pieces) const {
    tools::fail_if(is_wrong, printable(path_), ": ", pieces...);
  }
  std::uint64_t size() const { return size_; }
  void seek(std::uint64_t offset) const {
    fail_if(std::fseek(file_.get(), static_cast<long>(offset), SEEK_SET) != 0, std::strerror(errno));
  }
  // All of `bytes`, from where the last read ended.
  void read(std::span<std::uint8_t> bytes) const {
    fail_if(std::fread(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size(),
            std::ferror(file_.get()) != 0 ? "cannot be read" : "became shorter while it was read");
  }

 private:
  const std::string& path_;
  File file_;
  std::uint64_t size_ = 0;
};

}  // namespace

std::size_t PartHeader::unit_bytes() const {
  const auto width = static_cast<std::int32_t>(width_px);
  const std::size_t row = pixels == PartPixels::kMono   ? row_bytes(PixelFormat::kMono1, width)
                          : pixels == PartPixels::kRgba ? std::size_t{4} * width_px
                                                        : row_bytes(PixelFormat::kRgb888, width);
  return kind == PartKind::kRows ? row : row * height_px;
}

PartWriter::PartWriter(OutputFile* file, const PartHeader& header) : file_(file) {
  add(bytes_of(header));
}

void PartWriter::add(std::span<const std::uint8_t> bytes) {
  crc_ = crc_from(crc_, bytes);
  file_->write(bytes);
}

void PartWriter::end() {
  std::array<std::uint8_t, kCrcBytes> bytes{};
  put_little(bytes.data(), crc_);
  file_->write(bytes);
}

PartFile PartFile::open(const std::string& path) {
  const Reader reader(path);
  HeaderBytes head{};
  const std::size_t begun = static_cast<std::size_t>(std::min<std::uint64_t>(reader.size(), kHeaderBytes));
  reader.read(std::span(head).first(begun));
  const std::size_t compared = std::min(begun, kMagic.size());
  reader.fail_if(
      begun == 0 ||
          !std::equal(kMagic.begin(), kMagic.begin() + static_cast<std::ptrdiff_t>(compared), head.begin()),
      "is no part that thimble render --rows or --part wrote");
  reader.fail_if(begun < kHeaderBytes, "is cut off within its header of ", kHeaderBytes, " bytes");
  PartFile part;
  part.path_ = path;
  reader.fail_if(
      number_at(head.data() + 44) != crc_from(0, std::span(head).first(44)) || !parse(head, &part.header_),
      "is damaged: its header's checksum is wrong");
  const std::uint64_t expected =
      kHeaderBytes + std::uint64_t{part.header_.unit_bytes()} * part.header_.count + kCrcBytes;
  reader.fail_if(reader.size() != expected,
                 reader.size() < expected ? "is cut off: it has " : "is too long: it has ",
                 grouped(reader.size()), " bytes of ", grouped(expected));
  std::uint32_t crc = crc_from(0, head);
  std::vector<std::uint8_t> block(std::size_t{1} << 16);
  for (std::uint64_t left = expected - kHeaderBytes - kCrcBytes; left != 0;) {
    const auto bytes =
        std::span(block).first(static_cast<std::size_t>(std::min<std::uint64_t>(left, block.size())));
    reader.read(bytes);
    crc = crc_from(crc, bytes);
    left -= bytes.size();
  }
  std::array<std::uint8_t, kCrcBytes> stored{};
  reader.read(stored);
  reader.fail_if(number_at(stored.data()) != crc, "is damaged: its checksum is wrong");
  return part;
}

std::vector<std::uint8_t> PartFile::read(std::uint32_t unit) const {
  const Reader reader(path_);
  std::vector<std::uint8_t> bytes(header_.unit_bytes());
  reader.seek(kHeaderBytes + std::uint64_t{unit - header_.first} * bytes.size());
  reader.read(bytes);
  return bytes;
}

}  // namespace thimble::tools
