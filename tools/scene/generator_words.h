/// @file generator_words.h
/// Whether a word is a generator's, for who wants no scene of it.
#ifndef THIMBLE_TOOLS_SCENE_GENERATOR_WORDS_H
#define THIMBLE_TOOLS_SCENE_GENERATOR_WORDS_H

#include <string>

namespace thimble::tools {

/// Whether `parse_generator` (generators.h) takes it, or says what is wrong with it.
bool is_generator(const std::string& word);

}  // namespace thimble::tools

#endif
