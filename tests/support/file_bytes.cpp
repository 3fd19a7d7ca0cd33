#include "support/file_bytes.h"

#include <doctest/doctest.h>
#include <zlib.h>

#include <algorithm>
#include <bit>

namespace thimble::tests {

std::string little(std::uint64_t value, std::size_t bytes) {
  std::string out;
  for (std::size_t i = 0; i < bytes; ++i) {
    out += i < 8 ? static_cast<char>(value >> (8 * i)) : '\0';
  }
  return out;
}

std::string big(std::uint64_t value, std::size_t bytes) {
  std::string out = little(value, bytes);
  std::reverse(out.begin(), out.end());
  return out;
}

std::string little(float value) {
  return little(std::bit_cast<std::uint32_t>(value), 4);
}

std::string little(double value) {
  return little(std::bit_cast<std::uint64_t>(value), 8);
}

std::string repeated(const std::string& part, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) {
    out += part;
  }
  return out;
}

std::string vox_chunk(const std::string& id, const std::string& content, const std::string& children) {
  return id + little(content.size(), 4) + little(children.size(), 4) + content + children;
}

std::string vox_model(const std::array<int, 3>& sides, const std::vector<std::array<int, 4>>& voxels) {
  std::string size;
  for (const int side : sides) {
    size += little(static_cast<std::uint32_t>(side), 4);
  }
  std::string places = little(voxels.size(), 4);
  for (const std::array<int, 4>& voxel : voxels) {
    for (const int part : voxel) {
      places += static_cast<char>(part);
    }
  }
  return vox_chunk("SIZE", size) + vox_chunk("XYZI", places);
}

std::string vox_file(const std::string& chunks, std::uint32_t version) {
  return "VOX " + little(version, 4) + vox_chunk("MAIN", "", chunks);
}

std::string npy(const std::string& type, const std::string& shape, const std::string& data, bool fortran) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': " + (fortran ? "True" : "False") +
                       ", 'shape': " + shape + ", }";
  header += std::string(64 - (header.size() + 11) % 64, ' ') + "\n";
  return std::string("\x93NUMPY\x01\x00", 8) + little(header.size(), 2) + header + data;
}

std::string glb(std::string json, const std::string& binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  return "glTF" + little(2, 4) + little(28 + json.size() + binary.size(), 4) + little(json.size(), 4) +
         "JSON" + json + little(binary.size(), 4) + std::string("BIN\0", 4) + binary;
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
