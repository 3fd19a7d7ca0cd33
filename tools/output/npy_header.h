/// The beginning of a NumPy array (readers/npy.cpp names the source of the format).
#pragma once

#include <string>

namespace thimble::tools {

/// @param type   what stands behind 'descr', a quoted name or a list: "'|u1'"
/// @param shape  lengths as in Python's tuple: "3, 4" or "3,"
inline std::string npy_header(const std::string& type, const std::string& shape) {
  std::string text = "{'descr': " + type + ", 'fortran_order': False, 'shape': (" + shape + "), }";
  // The magic number, version 1.0 and the length take 10 bytes; data begin at a multiple of 64.
  text.append(63 - (10 + text.size()) % 64, ' ').append("\n");
  const std::string length{static_cast<char>(text.size() & 255), static_cast<char>(text.size() >> 8)};
  return std::string("\x93NUMPY\x01\x00", 8) + length + text;
}

}  // namespace thimble::tools
