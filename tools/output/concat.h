/// Sentences put together.
#pragma once

#include <string>
#include <type_traits>

namespace thimble::tools {

/// Texts, characters and numbers, these in decimal, one after the other.
template <class... Pieces>
std::string concat(const Pieces&... pieces) {
  std::string text;
  const auto add = [&text](const auto& piece) {
    using Piece = std::decay_t<decltype(piece)>;
    static_assert(!std::is_same_v<Piece, bool>);
    if constexpr (std::is_arithmetic_v<Piece> && !std::is_same_v<Piece, char>) {
      text += std::to_string(piece);
    } else {
      text += piece;
    }
  };
  (add(pieces), ...);
  return text;
}

}  // namespace thimble::tools
