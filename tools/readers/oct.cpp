// `.oct`: scenes baked by `thimble bake` (src/FORMAT.md). The one reader that hands over a tree, because that is what the
// file holds; nothing is rebuilt or copied. Every byte is validated, so what comes back is sound.
#include "readers/oct.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "readers/file_bytes.h"
#include "readers/formats.h"
#include "thimble/light/scene.h"

namespace thimble::tools {
namespace {

// "TMS"; the version follows.
constexpr std::array<std::uint8_t, 3> kOctMagic{0x54, 0x4D, 0x53};
constexpr std::size_t kVersionOffset = 3;
constexpr std::size_t kSizeOffset = 4;

std::uint64_t load32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return load_bits(&bytes[at], 4, false);
}

// `kAnotherVersion`, with what this version does not know.
InputError another_version(const std::string& unknown) {
  const std::string_view text = kAnotherVersion;
  const std::size_t colon = text.find(':');
  return InputError(std::string(text.substr(0, colon)) + " (" + unknown + ")" +
                    std::string(text.substr(colon)));
}

}  // namespace

bool looks_like_oct(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kOctMagic.size() && std::equal(kOctMagic.begin(), kOctMagic.end(), bytes.begin());
}

Source read_oct(const SharedBytes& file, const ReadOptions&, const Progress&) {
  const auto bytes = file.bytes;
  // What a person can do something about gets a sentence of its own.
  if (!looks_like_oct(bytes)) {
    throw InputError("not a scene baked by thimble bake (its first bytes are not TMS)");
  }
  if (bytes.size() > kVersionOffset && bytes[kVersionOffset] != kBakedVersion) {
    throw another_version(std::to_string(bytes[kVersionOffset]) + "; this one reads " +
                          std::to_string(kBakedVersion));
  }
  if (bytes.size() >= kBakedHeaderBytes && load32(bytes, kSizeOffset) != bytes.size()) {
    throw InputError("holds " + std::to_string(bytes.size()) + " bytes, its header says " +
                     std::to_string(load32(bytes, kSizeOffset)) +
                     (load32(bytes, kSizeOffset) > bytes.size() ? ": it is truncated" : ""));
  }
  const ConstBytes view{bytes.data(), bytes.size()};
  std::uint32_t place = 0;
  if (const char* fault = BakedScene::validate(view, &place)) {
    if (fault == std::string_view(kAnotherVersion)) {
      throw another_version("with a section of kind " + std::to_string(load32(bytes, place)) +
                            ", which this one does not know");
    }
    throw InputError("damaged at " + std::to_string(place) + ": " + fault);
  }
  BakedFile result;
  result.file = file;
  if (BakedScene::open(view, &result.scene) != Status::kOk) {
    throw InputError("damaged");
  }
  // The core leaves this to whoever draws light; here the whole file must be sound.
  const ConstBytes lighting = result.scene.section(SectionKind::kLighting);
  if (lighting.data != nullptr) {
    if (const char* fault = BakedLighting::validate(lighting, result.scene.tree().level(), &place)) {
      if (fault == std::string_view(kAnotherVersion)) {
        throw another_version("lighting of version " + std::to_string(lighting.data[place]) +
                              "; this one reads " + std::to_string(kLightingVersion));
      }
      throw InputError("damaged at " +
                       std::to_string(static_cast<std::size_t>(lighting.data - view.data) + place) + ": " +
                       fault);
    }
  }
  return result;
}

void for_each_block(const CompactTree& tree, const VisitBlock& visit) {
  walk_blocks(tree, visit);
}

}  // namespace thimble::tools
