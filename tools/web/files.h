/// The files that the page handed over, in place of a file system.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace thimble::tools {

/// `bytes` stay where they are; those of a .gz are inflated already.
void add_file(const std::string& name, std::span<const std::uint8_t> bytes);

/// "NAME: " of the model of a scene that is being read, for a sentence of what is wrong with it; empty while the scene itself is,
/// and once all is read.
std::string model_at_fault();
void end_of_reading();

}  // namespace thimble::tools
