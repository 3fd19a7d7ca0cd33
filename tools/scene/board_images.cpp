#include "scene/board_images.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "readers/file_bytes.h"
#include "readers/input_error.h"
#include "scene/named_scenes.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/render.h"

namespace thimble::tools {
namespace {

constexpr std::uint64_t kMostImageBytes = std::uint64_t{16} << 20;
constexpr std::uint64_t kMostFlashBytes = std::uint64_t{64} << 20;
// Sets of effects that a board has programs for (platform/images.sh).
constexpr const char* kSets[] = {"plain", "sun", "all"};

static_assert(std::endian::native == std::endian::little, "the mark is read as it lies");

// The mark in the program's bytes, of which there is one.
platform::SceneMark mark_of(const platform::Program& program) {
  constexpr std::string_view magic(platform::kSceneMarkMagic);
  platform::SceneMark mark{};
  int found = 0;
  for (const platform::Segment& segment : program.segments) {
    for (std::size_t at = segment.bytes.find(magic); at != std::string::npos;
         at = segment.bytes.find(magic, at + 1)) {
      if (segment.bytes.size() - at >= sizeof mark) {
        std::memcpy(&mark, segment.bytes.data() + at, sizeof mark);
        ++found;
      }
    }
  }
  if (found != 1) {
    throw InputError("is no program that takes a scene behind it");
  }
  return mark;
}

}  // namespace

bool BoardImage::draws(EffectSet effects) const {
  return lies_within(effects, mark.effects);
}

BoardImage open_image(std::string_view elf, const platform::BoardFacts& board) {
  BoardImage image;
  try {
    image.program = platform::read_elf(elf);
  } catch (const platform::ImageError& error) {
    throw InputError(error.what());
  }
  image.mark = mark_of(image.program);
  if (std::string_view(image.mark.board, strnlen(image.mark.board, sizeof image.mark.board)) != board.name) {
    throw InputError("is an image for another board");
  }
  if (image.mark.baked_version != kBakedVersion) {
    throw InputError("takes scenes of another version; make images builds it anew");
  }
  if (image.mark.place < image.program.end() || image.mark.end < image.mark.place ||
      image.mark.place % 8 != 0 ||
      image.mark.end - std::uint64_t{image.program.segments.front().address} > kMostFlashBytes) {
    throw InputError("has no place for a scene behind it");
  }
  return image;
}

std::vector<BoardImage> load_images(std::string folder, const platform::BoardFacts& board,
                                    const std::string& app) {
  if (const char* named = std::getenv("THIMBLE_IMAGES"); folder.empty() && named != nullptr) {
    folder = named;
  }
  if (folder.empty()) {
    folder = folder_beside_program("images");
  }
  std::vector<BoardImage> images;
  for (const char* set : kSets) {
    const std::string path = folder + "/" + board.name + "-" + app + "-" + set + ".elf.gz";
    std::error_code error;
    if (!folder.empty() && std::filesystem::exists(path, error)) {
      try {
        images.push_back(open_image(load_file(path, kMostImageBytes).text(), board));
      } catch (const InputError& wrong) {
        throw InputError(path + " " + wrong.what());
      }
    }
  }
  if (images.empty()) {
    throw InputError("there is no image of " + app + " for " + board.name +
                     (folder.empty() ? "" : " in " + folder) +
                     "; make images builds them, --images or $THIMBLE_IMAGES says where they are");
  }
  std::stable_sort(images.begin(), images.end(),
                   [](const BoardImage& a, const BoardImage& b) { return a.room() > b.room(); });
  return images;
}

bool takes_ending(const platform::BoardFacts& board, std::string_view path) {
  return path.ends_with(".elf") || path.ends_with(".bin") || path.ends_with(".hex") ||
         (board.uf2_family != 0 && path.ends_with(".uf2")) ||
         (board.image_ending[0] != '\0' && path.ends_with(std::string(".") + board.image_ending));
}

std::string image_file(const BoardImage& image, std::span<const std::uint8_t> scene,
                       const platform::BoardFacts& board, std::string_view path) {
  platform::Program program = image.program;
  program.segments.push_back(
      {image.mark.place, image.mark.place, 0, std::string(scene.begin(), scene.end())});
  return path.ends_with(".uf2")   ? platform::uf2_of(program, board.uf2_family)
         : path.ends_with(".hex") ? platform::hex_of(program)
         : path.ends_with(".elf") ? platform::elf_of(program)
                                  : platform::bin_of(program);
}

}  // namespace thimble::tools
