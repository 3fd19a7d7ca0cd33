/// What is thrown at input that cannot be used: by readers, and by all that takes a file or a word from somebody.
#pragma once

#include <stdexcept>

#include "output/concat.h"

namespace thimble::tools {

/// Input that cannot be used. `what()` is one clear sentence without the file's name and without a full stop
/// at its end: it names the place (line, byte offset, chunk) and the limit. The command prints
/// `thimble: FILE: sentence` on stderr and exits with status 1.
class InputError : public std::runtime_error {
 public:
  /// From the pieces of the sentence.
  template <class First, class... Rest>
  explicit InputError(const First& first, const Rest&... rest) : std::runtime_error(concat(first, rest...)) {}
};

/// Throws one of these pieces where `is_wrong`.
template <class... Pieces>
void fail_if(bool is_wrong, const Pieces&... pieces) {
  if (is_wrong) {
    throw InputError(pieces...);
  }
}

/// The input may be good, but the system has nothing left to open it with. Whoever can do without an input that is bad
/// does not do without this one.
class ShortageError : public InputError {
 public:
  using InputError::InputError;
};

/// An option that this input can never take, as the command line alone tells: exit status 2.
class UsageError : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace thimble::tools
