/// Programs that are there before their scene (platform/images/README.md): found, opened, joined with a scene.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "boards/board_table.h"
#include "images/image_file.h"
#include "images/scene_mark.h"
#include "thimble/light/scene.h"

namespace thimble::tools {

struct BoardImage {
  platform::SceneMark mark;
  platform::Program program;

  /// Bytes of flash behind the program.
  std::uint64_t room() const { return mark.end - mark.place; }
  bool draws(EffectSet effects) const;
};

/// The program in an ELF file that `make images` made for the board. Throws InputError, which says what is wrong: no such
/// file, another board's, one of another version, without a place for a scene.
BoardImage open_image(std::string_view elf, const platform::BoardFacts& board);

/// Those of a board and an application, the smallest program first. `folder` empty: $THIMBLE_IMAGES, or the folder beside
/// the program. Throws InputError, also where there is none.
std::vector<BoardImage> load_images(std::string folder, const platform::BoardFacts& board,
                                    const std::string& app);

/// What a file of the board may end in: elf, bin, hex, and its own (uf2, gba).
bool takes_ending(const platform::BoardFacts& board, std::string_view path);
/// The bytes of such a file: the program with `scene`, which is no larger than `room()`, behind it.
std::string image_file(const BoardImage& image, std::span<const std::uint8_t> scene,
                       const platform::BoardFacts& board, std::string_view path);

}  // namespace thimble::tools
