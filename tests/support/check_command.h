/// @file check_command.h
/// What tests of the command say again and again.
#ifndef THIMBLE_TESTS_SUPPORT_CHECK_COMMAND_H
#define THIMBLE_TESTS_SUPPORT_CHECK_COMMAND_H

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "support/run_command.h"

namespace thimble::tests {

/// The command with `words` is refused: that status, nothing but one sentence, which holds each of `named`.
inline void check_refused(const std::vector<std::string>& words, int status,
                          const std::vector<std::string>& named) {
  const CommandResult result = run_command(words);
  std::string line;
  for (const std::string& word : words) {
    line += word + " ";
  }
  CAPTURE(line);
  CAPTURE(result.describe());
  CHECK(result.status == status);
  CHECK(result.out.empty());
  CHECK(is_one_sentence(result.err));
  for (const std::string& name : named) {
    CAPTURE(name);
    CHECK(result.err.find(name) != std::string::npos);
  }
}

}  // namespace thimble::tests

#endif
