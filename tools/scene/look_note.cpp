#include "scene/look_note.h"

#include <algorithm>
#include <iterator>

#include "scene/default_look.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kNoteBytes = 12;
constexpr std::uint8_t kNoteVersion = 1;
constexpr unsigned kIsMesh = 1;
constexpr unsigned kIsPoints = 2;
constexpr unsigned kHasColors = 4;
constexpr unsigned kHasOwnLight = 8;
constexpr unsigned kHasOwnSky = 16;
constexpr std::size_t kOn = 4;
constexpr std::size_t kOff = 8;

void store32(std::uint8_t* to, std::uint32_t value) {
  for (unsigned i = 0; i < 4; ++i) {
    to[i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}
std::uint32_t load32(const std::uint8_t* from) {
  return from[0] | std::uint32_t{from[1]} << 8 | std::uint32_t{from[2]} << 16 | std::uint32_t{from[3]} << 24;
}

}  // namespace

LookNote note_of(const SceneFacts& facts) {
  LookNote note;
  note.is_mesh = facts.is_mesh;
  note.is_points = facts.is_points;
  note.has_colors = facts.has_colors;
  note.has_own_light = states_light(facts.lighting);
  note.has_own_sky = facts.lighting.rest.has_sky;
  note.on = facts.lighting.on;
  note.off = facts.lighting.off;
  return note;
}

std::vector<std::uint8_t> look_section(const LookNote& note) {
  std::vector<std::uint8_t> bytes(kNoteBytes);
  bytes[0] = kNoteVersion;
  bytes[1] = static_cast<std::uint8_t>((note.is_mesh ? kIsMesh : 0U) | (note.is_points ? kIsPoints : 0U) |
                                       (note.has_colors ? kHasColors : 0U) |
                                       (note.has_own_light ? kHasOwnLight : 0U) |
                                       (note.has_own_sky ? kHasOwnSky : 0U));
  store32(bytes.data() + kOn, note.on);
  store32(bytes.data() + kOff, note.off);
  return bytes;
}

std::optional<LookNote> read_look_note(ConstBytes section) {
  if (section.size != kNoteBytes || section.data[0] != kNoteVersion) {
    return std::nullopt;
  }
  const unsigned flags = section.data[1];
  LookNote note;
  note.is_mesh = (flags & kIsMesh) != 0;
  note.is_points = (flags & kIsPoints) != 0;
  note.has_colors = (flags & kHasColors) != 0;
  note.has_own_light = (flags & kHasOwnLight) != 0;
  note.has_own_sky = (flags & kHasOwnSky) != 0;
  note.on = load32(section.data + kOn) & Effect::kAll;
  note.off = load32(section.data + kOff) & Effect::kAll;
  return note;
}

LitDescription without_rule(const LookNote& note, LitDescription baked) {
  baked.on = note.on;
  baked.off = note.off;
  const LitScene plain;
  if (!note.has_own_sky) {
    baked.rest.has_sky = plain.has_sky;
    baked.rest.sky = plain.sky;
  }
  if (!note.has_own_light) {
    baked.lights.clear();
    baked.lights_and_glow.clear();
    baked.has_baked_glow = false;
    baked.has_own_ambient = false;
    std::copy(std::begin(plain.ambient_q8), std::end(plain.ambient_q8), std::begin(baked.rest.ambient_q8));
    baked.rest.has_shadows = plain.has_shadows;
  }
  return baked;
}

}  // namespace thimble::tools
