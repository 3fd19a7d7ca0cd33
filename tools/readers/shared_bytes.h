/// The bytes of a file as readers take them: a view and whatever keeps it alive.
///
/// A reader whose result streams from the file (`PointCloud`) keeps a copy of this struct, which shares the
/// bytes and copies none. The owner may be anything: a loaded file, a mapped one, or nothing at all when the
/// bytes outlive the result anyway (a fuzzer's input, a literal).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace thimble::tools {

struct SharedBytes {
  std::span<const std::uint8_t> bytes;
  std::shared_ptr<const void> owner;  ///< keeps `bytes` valid; may be empty

  /// The same bytes as text, not terminated by a zero.
  std::string_view text() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

  /// Takes over `content` (moved, not copied, when it is a temporary).
  static SharedBytes own(std::string content) {
    auto kept = std::make_shared<const std::string>(std::move(content));
    return {{reinterpret_cast<const std::uint8_t*>(kept->data()), kept->size()}, kept};
  }
};

}  // namespace thimble::tools
