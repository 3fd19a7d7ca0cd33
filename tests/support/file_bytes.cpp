#include "support/file_bytes.h"

#include <doctest/doctest.h>
#include <zlib.h>

#include <bit>

namespace thimble::tests {

std::string little(std::uint64_t value, std::size_t bytes) {
  std::string out;
  for (std::size_t i = 0; i < bytes; ++i) {
    out += i < 8 ? static_cast<char>(value >> (8 * i)) : '\0';
  }
  return out;
}

std::string little(float value) {
  return little(std::bit_cast<std::uint32_t>(value), 4);
}

std::string little(double value) {
  return little(std::bit_cast<std::uint64_t>(value), 8);
}

std::string vox_chunk(const std::string& id, const std::string& content, const std::string& children) {
  return id + little(content.size(), 4) + little(children.size(), 4) + content + children;
}

std::string deflated(const std::string& bytes, int window_bits) {
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 9, Z_DEFLATED, window_bits, 9, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

}  // namespace thimble::tests
