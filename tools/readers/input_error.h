/// @file input_error.h
/// What is thrown at input that cannot be used: by readers, and by all that takes a file or a word from somebody.
#ifndef THIMBLE_TOOLS_READERS_INPUT_ERROR_H
#define THIMBLE_TOOLS_READERS_INPUT_ERROR_H

#include <stdexcept>

namespace thimble::tools {

/// Input that cannot be used. `what()` is one clear sentence without the file's name and without a full stop
/// at its end: it names the place (line, byte offset, chunk) and the limit. The command prints
/// `thimble: FILE: sentence` on stderr and exits with status 1.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An option that this input can never take, as the command line alone tells: exit status 2.
class UsageError : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace thimble::tools

#endif
