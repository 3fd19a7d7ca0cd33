/// Bytes of files that tests put together by hand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace thimble::tests {

/// A number as so many bytes, the lowest first; zeros beyond its eight.
std::string little(std::uint64_t value, std::size_t bytes);
/// The bits of a float or double, the lowest byte first.
std::string little(float value);
std::string little(double value);

/// A chunk of a `.vox`: its id, both lengths, what it holds, its children.
std::string vox_chunk(const std::string& id, const std::string& content, const std::string& children = "");

/// zlib's streams, by the bits of the window: 15 + 16 is gzip, 15 zlib, -15 deflate without a header.
inline constexpr int kGzip = 15 + 16;
std::string deflated(const std::string& bytes, int window_bits);

}  // namespace thimble::tests
