/// What tests of the command say again and again.
#pragma once

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "support/run_command.h"

namespace thimble::tests {

using Words = std::vector<std::string>;

inline Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// A line of these words, for messages.
inline std::string line_of_words(const Words& words) {
  std::string line;
  for (const std::string& word : words) {
    line += word + " ";
  }
  return line;
}

/// What the command with `words` does, which is to end well.
inline CommandResult check_done(const Words& words, const CommandLimits& limits = {}) {
  CommandResult result = run_command(words, limits);
  CAPTURE(line_of_words(words));
  CAPTURE(result.describe());
  REQUIRE(result.status == 0);
  return result;
}

/// The command with `words` is refused: that status, nothing but one sentence, which holds each of `named`.
inline CommandResult check_refused(const Words& words, int status, const Words& named,
                                   const CommandLimits& limits = {}) {
  CommandResult result = run_command(words, limits);
  CAPTURE(line_of_words(words));
  CAPTURE(result.describe());
  CHECK(result.status == status);
  CHECK(result.out.empty());
  CHECK(is_one_sentence(result.err));
  for (const std::string& name : named) {
    CAPTURE(name);
    CHECK(result.err.find(name) != std::string::npos);
  }
  return result;
}

}  // namespace thimble::tests
