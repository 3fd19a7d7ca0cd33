#include "scene/board_images.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "readers/input_error.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/render.h"

namespace thimble::tools {
namespace {

constexpr std::uint64_t kMostFlashBytes = std::uint64_t{64} << 20;

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
  fail_if(found != 1, "is no program that takes a scene behind it");
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
  fail_if(
      std::string_view(image.mark.board, strnlen(image.mark.board, sizeof image.mark.board)) != board.name,
      "is an image for another board");
  fail_if(image.mark.baked_version != kBakedVersion,
          "takes scenes of another version; make images builds it anew");
  fail_if(image.mark.place < image.program.end() || image.mark.end < image.mark.place ||
              image.mark.place % 8 != 0 ||
              image.mark.end - std::uint64_t{image.program.segments.front().address} > kMostFlashBytes,
          "has no place for a scene behind it");
  return image;
}

void sort_images(std::vector<BoardImage>* images) {
  std::stable_sort(images->begin(), images->end(),
                   [](const BoardImage& a, const BoardImage& b) { return a.room() > b.room(); });
}

std::uint64_t room_behind(std::span<const BoardImage> images, EffectSet effects) {
  std::uint64_t most = 0;
  for (const BoardImage& image : images) {
    most = std::max(most, image.draws(effects) ? image.room() : 0);
  }
  return most;
}

const BoardImage* image_for(std::span<const BoardImage> images, const Baked& baked) {
  BakedLighting lighting;
  bool has_metal = false;
  if (BakedLighting::open(baked.scene.section(SectionKind::kLighting), baked.scene.tree().level(),
                          &lighting) == Status::kOk) {
    for (const Surface& surface : lighting.scene.surfaces) {
      has_metal = has_metal || surface.kind == SurfaceKind::kMetal;
    }
  }
  // Metals show their own light where nobody wants mirrors, and a program that has mirrors would show them.
  const bool has_dull_metal = has_metal && (baked.effects & Effect::kMirror) == 0;
  const auto found = std::find_if(images.begin(), images.end(), [&](const BoardImage& image) {
    return image.draws(baked.effects) && !(has_dull_metal && (image.mark.effects & Effect::kMirror) != 0);
  });
  return found == images.end() ? nullptr : &*found;
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
