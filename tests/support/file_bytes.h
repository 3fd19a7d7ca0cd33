/// Bytes of files that tests put together by hand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace thimble::tests {

/// A number as so many bytes, the lowest first; zeros beyond its eight. And the highest first.
std::string little(std::uint64_t value, std::size_t bytes);
std::string big(std::uint64_t value, std::size_t bytes);
/// The bits of a float or double, the lowest byte first.
std::string little(float value);
std::string little(double value);
std::string repeated(const std::string& part, int times);

/// A chunk of a `.vox`: its id, both lengths, what it holds, its children.
std::string vox_chunk(const std::string& id, const std::string& content, const std::string& children = "");
/// The two chunks of a model: its sides, and its voxels as x, y, z and the number of a color.
std::string vox_model(const std::array<int, 3>& sides, const std::vector<std::array<int, 4>>& voxels);
/// A `.vox` of these chunks.
std::string vox_file(const std::string& chunks, std::uint32_t version = 200);

/// An array as NumPy writes it; `shape` with its brackets.
std::string npy(const std::string& type, const std::string& shape, const std::string& data,
                bool fortran = false);

/// A binary glTF; `binary` has whole words.
std::string glb(std::string json, const std::string& binary);

/// zlib's streams, by the bits of the window: 15 + 16 is gzip, 15 zlib, -15 deflate without a header.
inline constexpr int kGzip = 15 + 16;
std::string deflated(const std::string& bytes, int window_bits);

}  // namespace thimble::tests
