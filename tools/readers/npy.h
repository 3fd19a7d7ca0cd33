/// A NumPy array as a table of numbers, for what is no scene. Scenes: formats.h.
#pragma once

#include <cstdint>
#include <functional>

#include "readers/shared_bytes.h"

namespace thimble::tools {

/// An array of two dimensions as it stands.
struct NumberTable {
  std::uint64_t rows = 0, columns = 0;
  std::function<double(std::uint64_t row, std::uint64_t column)> at;  ///< keeps the file
};
/// The table of a `.npy`, or of the member of an `.npz` that has the most numbers.
/// @throws InputError  a broken header, another type or number of dimensions, fewer bytes than the shape takes
NumberTable read_npy_table(const SharedBytes& file);

}  // namespace thimble::tools
