#include "output/gif.h"

#include <algorithm>

namespace thimble::tools {
namespace {

void put(std::string* out, unsigned byte) {
  out->push_back(static_cast<char>(byte & 0xFFU));
}
void put_16(std::string* out, std::int32_t value) {
  put(out, static_cast<unsigned>(value));
  put(out, static_cast<unsigned>(value) >> 8);
}

// Codes of a changing number of bits, in blocks that begin with their length.
class Codes {
 public:
  explicit Codes(std::string* out) : out_(out) {}
  void write(unsigned code, int bits) {
    waiting_ |= code << count_;
    count_ += bits;
    for (; count_ >= 8; count_ -= 8, waiting_ >>= 8) {
      block_.push_back(static_cast<char>(waiting_ & 0xFFU));
      if (block_.size() == 255) {
        end_block();
      }
    }
  }
  void end() {
    if (count_ > 0) {
      block_.push_back(static_cast<char>(waiting_ & 0xFFU));
    }
    if (!block_.empty()) {
      end_block();
    }
    put(out_, 0);
  }

 private:
  void end_block() {
    put(out_, static_cast<unsigned>(block_.size()));
    *out_ += block_;
    block_.clear();
  }

  std::string* out_;
  std::string block_;
  unsigned waiting_ = 0;
  int count_ = 0;
};

void compress(const std::vector<std::uint8_t>& indices, std::string* out) {
  constexpr unsigned kClear = 256;
  constexpr unsigned kEnd = 257;
  constexpr unsigned kMostCodes = 4096;
  // By word and next index, the word of both; 0 is none, since words of two begin at 258.
  std::vector<std::uint16_t> next(std::size_t{kMostCodes} * 256);
  unsigned used = kEnd + 1;
  int bits = 9;
  Codes codes(out);
  codes.write(kClear, bits);
  unsigned word = indices.empty() ? kEnd : indices[0];
  for (std::size_t i = 1; i < indices.size(); ++i) {
    std::uint16_t& longer = next[std::size_t{word} * 256 + indices[i]];
    if (longer != 0) {
      word = longer;
      continue;
    }
    codes.write(word, bits);
    if (used == kMostCodes) {
      codes.write(kClear, bits);
      std::fill(next.begin(), next.end(), std::uint16_t{0});
      used = kEnd + 1;
      bits = 9;
    } else {
      // A reader knows each word one code later than its writer.
      bits += used == 1U << bits ? 1 : 0;
      longer = static_cast<std::uint16_t>(used++);
    }
    word = indices[i];
  }
  if (word != kEnd) {
    codes.write(word, bits);
    bits += used == 1U << bits && bits < 12 ? 1 : 0;
  }
  codes.write(kEnd, bits);
  codes.end();
}

}  // namespace

std::string gif_header(std::int32_t width_px, std::int32_t height_px, const GifPalette& palette) {
  std::string out = "GIF89a";
  put_16(&out, width_px);
  put_16(&out, height_px);
  put(&out, 0xF7);  // a palette of 2^8 colours, 8 bits a channel
  put(&out, 0);     // the background's index
  put(&out, 0);     // pixels are square
  for (const Rgb8& color : palette) {
    put(&out, color.r);
    put(&out, color.g);
    put(&out, color.b);
  }
  out += "\x21\xFF\x0BNETSCAPE2.0\x03\x01";
  put_16(&out, 0);  // for ever
  put(&out, 0);
  return out;
}

std::string gif_frame(std::int32_t width_px, std::int32_t height_px, const std::vector<std::uint8_t>& indices,
                      int hundredths) {
  std::string out = "\x21\xF9\x04\x04";  // what was drawn stays
  put_16(&out, hundredths);
  put(&out, 0);  // no colour is transparent
  put(&out, 0);
  put(&out, 0x2C);
  put_16(&out, 0);
  put_16(&out, 0);
  put_16(&out, width_px);
  put_16(&out, height_px);
  put(&out, 0);  // the palette of all; rows in order
  put(&out, 8);  // bits of an index
  compress(indices, &out);
  return out;
}

std::string gif_end() {
  return "\x3B";
}

}  // namespace thimble::tools
