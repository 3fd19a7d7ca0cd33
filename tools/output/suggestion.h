/// What somebody who mistyped a word most likely meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace thimble::tools {

/// " (did you mean render?)": the one of `words` that somebody who typed `word` most likely meant. At most a third of
/// its letters are missing, too many, wrong or swapped with their neighbour; where there is none, nothing.
std::string suggestion(std::string_view word, const std::vector<std::string>& words);

}  // namespace thimble::tools
