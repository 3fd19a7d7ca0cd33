#include "readers/scene_text.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>
#include <utility>

#include "output/units.h"
#include "readers/text.h"
#include "thimble/light/baked_lighting.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {
namespace {

constexpr bool is_continuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

// Length of the character of UTF-8 at the front of `text`; 0 when there is none.
std::size_t character_bytes(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) {
    return 1;
  }
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || text.size() < length) {
    return 0;
  }
  for (std::size_t i = 1; i < length; ++i) {
    if (!is_continuation(text[i])) {
      return 0;
    }
  }
  // Longer than needed, halves of UTF-16, beyond the last character.
  const unsigned second = byte(1);
  const bool wrong = (first == 0xE0 && second < 0xA0) || (first == 0xED && second >= 0xA0) ||
                     (first == 0xF0 && second < 0x90) || (first == 0xF4 && second >= 0x90);
  return wrong ? 0 : length;
}

// A word or a number, and where it stands.
struct Word {
  std::string_view text;
  TextPlace place;
  bool is_quoted = false;
  bool empty() const { return text.empty() && !is_quoted; }
};

// One line, read word by word.
class Line {
 public:
  Line(std::string_view text, std::uint32_t number) : text_(text), number_(number) {}

  TextPlace place() const {
    const auto before = text_.substr(0, next_);
    const auto characters =
        std::count_if(before.begin(), before.end(), [](char c) { return !is_continuation(c); });
    return {number_, static_cast<std::uint32_t>(characters) + 1};
  }
  // The next word, empty at the end of the line or before a comment.
  Word word() {
    skip_blanks();
    Word result;
    result.place = place();
    if (next_ == text_.size()) {
      return result;
    }
    if (text_[next_] == '"') {
      const std::size_t end = text_.find('"', next_ + 1);
      if (end == std::string_view::npos) {
        fail_at(result.place, "the quotation mark is not closed on this line");
      }
      result.text = text_.substr(next_ + 1, end - next_ - 1);
      result.is_quoted = true;
      next_ = end + 1;
      if (next_ < text_.size() && !is_space(text_[next_])) {
        fail_at(place(), "a blank must follow the quotation mark");
      }
      return result;
    }
    result.text = run([](char c) { return !is_space(c); });
    return result;
  }
  // The next number: a comma may stand before it unless it is the first of several.
  Word number(bool is_first) {
    skip_blanks();
    if (!is_first && next_ < text_.size() && text_[next_] == ',') {
      ++next_;
      skip_blanks();
    }
    Word result;
    result.place = place();
    result.text = run([](char c) { return !is_space(c) && c != ','; });
    return result;
  }
  // Whether nothing but a comment is left.
  bool at_end() {
    skip_blanks();
    return next_ == text_.size();
  }

 private:
  void skip_blanks() {
    const std::size_t before = next_;
    while (next_ < text_.size() && is_space(text_[next_])) {
      ++next_;
    }
    if (next_ < text_.size() && text_[next_] == '#' &&
        (next_ == 0 || next_ != before || is_space(text_[next_ - 1]))) {
      text_ = text_.substr(0, next_);
    }
  }
  template <class Belongs>
  std::string_view run(const Belongs& belongs) {
    const std::size_t begin = next_;
    while (next_ < text_.size() && belongs(text_[next_])) {
      ++next_;
    }
    return text_.substr(begin, next_ - begin);
  }

  std::string_view text_;
  std::uint32_t number_;
  std::size_t next_ = 0;
};

// The clauses of a statement that were said already.
class Said {
 public:
  explicit Said(std::string_view statement) : statement_(statement) {}
  void once(const Word& word) {
    if (std::find(words_.begin(), words_.end(), word.text) != words_.end()) {
      fail_at(word.place, std::string(word.text) + " is said twice in this " + std::string(statement_));
    }
    words_.push_back(word.text);
  }
  bool has(std::string_view word) const {
    return std::find(words_.begin(), words_.end(), word) != words_.end();
  }
  // At the end of the line.
  void need(std::string_view word, Line& line) const {
    if (!has(word)) {
      line.at_end();
      fail_at(line.place(), std::string(statement_) + " needs " + std::string(word));
    }
  }
  [[noreturn]] void unknown(const Word& word, const char* known) const {
    fail_at(word.place,
            quoted(word.text) + " is not known in " + std::string(statement_) + "; there are " + known);
  }

 private:
  std::string_view statement_;
  std::vector<std::string_view> words_;
};

std::string range_text(double low, double high) {
  return shortest(low) + " to " + shortest(high);
}

double real(Line& line, const std::string& what, double low, double high, bool is_first = true) {
  const Word word = line.number(is_first);
  double value = 0;
  if (word.text.empty()) {
    fail_at(word.place, what + " is missing: a number from " + range_text(low, high) + " is expected here");
  }
  switch (parse_number(word.text, value)) {
    case NumberKind::kFinite:
      break;
    case NumberKind::kNotFinite:
      fail_at(word.place, what + " is " + quoted(word.text) + ", which is not finite");
    case NumberKind::kGarbage:
      fail_at(word.place, what + " is " + quoted(word.text) + ", which is not a number");
  }
  if (!(value >= low && value <= high)) {
    fail_at(word.place, what + " is " + quoted(word.text) + ", it must be " + range_text(low, high));
  }
  return value;
}

std::int32_t whole(Line& line, const std::string& what, std::int32_t low, std::int32_t high,
                   bool is_first = true) {
  const Word word = line.number(is_first);
  const std::string range = std::to_string(low) + " to " + std::to_string(high);
  if (word.text.empty()) {
    fail_at(word.place, what + " is missing: a whole number from " + range + " is expected here");
  }
  std::int64_t value = 0;
  double number = 0;
  if (!parse_integer(word.text, value)) {
    const NumberKind kind = parse_number(word.text, number);
    const bool is_large = kind == NumberKind::kFinite && std::abs(number) >= 9e18;
    fail_at(word.place, what + " is " + quoted(word.text) +
                            (is_large ? ", it must be " + range : ", which is not a whole number"));
  }
  if (value < low || value > high) {
    fail_at(word.place, what + " is " + quoted(word.text) + ", it must be " + range);
  }
  return static_cast<std::int32_t>(value);
}

using Real3 = std::array<double, 3>;

Real3 three_reals(Line& line, const std::string& what, double low, double high) {
  Real3 result{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result[axis] = real(line, std::string(1, "xyz"[axis]) + " of " + what, low, high, axis == 0);
  }
  return result;
}

Vec3i three_wholes(Line& line, const std::string& what, std::int32_t low, std::int32_t high) {
  Vec3i result;
  for (int axis = 0; axis < 3; ++axis) {
    result[axis] = whole(line, std::string(1, "xyz"[axis]) + " of " + what, low, high, axis == 0);
  }
  return result;
}

Rgb8 color(Line& line) {
  constexpr std::array<const char*, 3> kChannels{"red", "green", "blue"};
  std::array<std::uint8_t, 3> value{};
  for (std::size_t i = 0; i < 3; ++i) {
    value[i] = static_cast<std::uint8_t>(whole(line, kChannels[i], 0, 255, i == 0));
  }
  return {value[0], value[1], value[2]};
}

std::int32_t fixed(double value, double one) {
  return static_cast<std::int32_t>(std::lround(value * one));
}
std::uint8_t share(Line& line, const char* what) {
  return static_cast<std::uint8_t>(fixed(real(line, what, 0, 1), 255));
}
// A number that is above 0 stays above 0.
std::uint16_t fixed_q8(Line& line, const char* what, double high) {
  const double value = real(line, what, 0, high);
  return static_cast<std::uint16_t>(std::clamp(fixed(value, 256), value > 0 ? 1 : 0, 65535));
}

Vec3Q8 to_q8(const Real3& point) {
  Vec3Q8 result;
  for (int axis = 0; axis < 3; ++axis) {
    result[axis] = Q8::from_raw(fixed(point[static_cast<std::size_t>(axis)], Q8::kOne));
  }
  return result;
}

// The direction as integers up to `largest`.
Vec3i scaled(const Real3& vector, double largest) {
  const double most = std::max({std::abs(vector[0]), std::abs(vector[1]), std::abs(vector[2])});
  Vec3i result;
  for (int axis = 0; axis < 3; ++axis) {
    result[axis] = fixed(vector[static_cast<std::size_t>(axis)] / most, largest);
  }
  return result;
}

bool is_zero(const Real3& vector) {
  return vector[0] == 0 && vector[1] == 0 && vector[2] == 0;
}

int axis_of(Line& line, const char* what) {
  const Word word = line.word();
  for (int axis = 0; axis < 3; ++axis) {
    if (word.text.size() == 1 && word.text[0] == "xyz"[axis]) {
      return axis;
    }
  }
  fail_at(word.place, std::string(what) + " needs an axis: x, y or z" +
                          (word.empty() ? "" : ", not " + quoted(word.text)));
}

constexpr double kFar =
    9.0 * 4096;  // no world has anything farther away; the world's own limit is checked later
constexpr double kMostDirection = 65535;
constexpr double kMostBrightness = 100;
constexpr double kMostDensity = 200;
constexpr double kMostEmission = 200;

constexpr std::array<std::string_view, 5> kKinds{"diffuse", "metal", "glass", "emit", "media"};

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  std::shared_ptr<const SceneText> parse() {
    check_characters();
    LineReader lines(text_);
    std::string_view line;
    std::uint32_t number = 0;
    while (lines.next(line)) {
      ++number;
      statement(Line(line, number));
    }
    if (scene_->parts.empty()) {
      fail_at({number, 1}, "the file ends and shows nothing: there is no model, box or ball in it");
    }
    scene_->rest.has_shadows = !scene_->lights.empty();
    return scene_;
  }

 private:
  using Parse = void (Parser::*)(Line&, TextPlace);
  struct Statement {
    std::string_view word;
    Parse parse;
    bool once;
  };
  static const std::array<Statement, 15> kStatements;

  void check_characters() {
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    if (text_.starts_with(kMark)) {
      text_.remove_prefix(kMark.size());
    }
    if (text_.size() > kSceneTextBytes) {
      throw InputError("holds " + grouped(text_.size()) + " bytes, the limit of a .scene file is " +
                       grouped(kSceneTextBytes));
    }
    TextPlace place{1, 1};
    for (std::size_t at = 0; at < text_.size();) {
      const std::size_t length = character_bytes(text_.substr(at));
      const auto byte = static_cast<unsigned char>(text_[at]);
      if (length == 0) {
        fail_at(place, "the bytes here are not UTF-8 text");
      }
      const bool ends_line = byte == '\n' || byte == '\r';
      if ((byte < ' ' && byte != '\t' && !ends_line) || byte == 0x7F) {
        fail_at(place, "byte " + std::to_string(byte) + " is a control character, not text");
      }
      at += text_.substr(at).starts_with("\r\n") ? 2 : length;
      place = ends_line ? TextPlace{place.line + 1, 1} : TextPlace{place.line, place.column + 1};
    }
  }

  void statement(Line line) {
    const Word word = line.word();
    if (word.empty()) {
      return;
    }
    for (std::size_t i = 0; i < kStatements.size(); ++i) {
      if (word.text != kStatements[i].word || word.is_quoted) {
        continue;
      }
      if (kStatements[i].once && first_[i].line != 0) {
        fail_at(word.place, std::string(word.text) + " is said twice; the first stands in line " +
                                std::to_string(first_[i].line));
      }
      first_[i] = word.place;
      (this->*kStatements[i].parse)(line, word.place);
      if (!line.at_end()) {
        const auto place = line.place();  // before the word is read
        fail_at(place, "nothing more belongs into this line, but there is " + quoted(line.word().text));
      }
      return;
    }
    std::string known;
    for (const Statement& each : kStatements) {
      known += (known.empty() ? "" : ", ") + std::string(each.word);
    }
    fail_at(word.place, quoted(word.text) + " is no statement; there are " + known);
  }

  void depth(Line& line, TextPlace) { scene_->depth = whole(line, "depth", kMinLevel, kMaxLevel); }

  void camera(Line& line, TextPlace place) {
    Said said("camera");
    SceneCamera result;
    Real3 eye{};
    Real3 target{};
    Real3 up{};
    while (!line.at_end()) {
      const Word word = line.word();
      said.once(word);
      if (word.text == "eye") {
        eye = three_reals(line, "eye", -kFar, kFar);
      } else if (word.text == "target") {
        target = three_reals(line, "target", -kFar, kFar);
      } else if (word.text == "up") {
        up = three_reals(line, "up", -kMostDirection, kMostDirection);
        if (is_zero(up)) {
          fail_at(word.place, "up 0 0 0 has no direction");
        }
      } else if (word.text == "fov") {
        result.fov_degrees = Q16::from_raw(fixed(real(line, "fov", 1, 120), Q16::kOne));
      } else if (word.text == "span") {
        result.is_perspective = false;
        result.span = Q14::from_raw(std::max(1, fixed(real(line, "span", 0, 131071), Q14::kOne)));
      } else {
        said.unknown(word, "eye, target, up, fov and span");
      }
      if (said.has("fov") && said.has("span")) {
        fail_at(word.place, "fov is for perspective and span for parallel rays: there is one or the other");
      }
    }
    said.need("eye", line);
    said.need("target", line);
    const Real3 forward{target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]};
    result.eye = to_q8(eye);
    result.target = to_q8(target);
    if (is_zero(forward)) {
      fail_at(place, "eye and target of the camera are the same point");
    }
    result.forward = scaled(forward, kMaxViewComponent);
    result.up = is_zero(up) ? Vec3i{} : scaled(up, kMaxViewComponent);
    scene_->camera = result;
    scene_->camera_place = place;
  }

  void light(Line& line, TextPlace place, std::string_view statement, bool is_point) {
    if (scene_->lights.size() == kMaxLights) {
      fail_at(place, "there are more lights than the limit of " + std::to_string(kMaxLights));
    }
    Said said(statement);
    Light result;
    result.is_point = is_point;
    Rgb8 tint{255, 255, 255};
    double brightness = 1;
    while (!line.at_end()) {
      const Word word = line.word();
      said.once(word);
      if (word.text == "toward" && !is_point) {
        const Real3 direction = three_reals(line, "toward", -kMostDirection, kMostDirection);
        if (is_zero(direction)) {
          fail_at(word.place, "toward 0 0 0 has no direction");
        }
        result.place = scaled(direction, kMaxLightComponent);
      } else if (word.text == "at" && is_point) {
        const Vec3Q8 at = to_q8(three_reals(line, "at", -kFar, kFar));
        result.place = {at.x.raw, at.y.raw, at.z.raw};
      } else if (word.text == "reach" && is_point) {
        result.reach = static_cast<std::uint16_t>(whole(line, "reach", 1, 65535));
      } else if (word.text == "color") {
        tint = color(line);
      } else if (word.text == "brightness") {
        brightness = real(line, "brightness", 0, kMostBrightness);
      } else {
        said.unknown(word, is_point ? "at, reach, color and brightness" : "toward, color and brightness");
      }
    }
    said.need(is_point ? "at" : "toward", line);
    const std::array<std::uint16_t, 3> bright = brightness_q8(tint, brightness);
    std::copy(bright.begin(), bright.end(), result.color_q8);
    scene_->lights.push_back({result, place});
  }
  void sun(Line& line, TextPlace place) { light(line, place, "sun", false); }
  void lamp(Line& line, TextPlace place) { light(line, place, "lamp", true); }

  static std::array<std::uint16_t, 3> brightness_q8(Rgb8 tint, double brightness) {
    const auto channel = [&](std::uint8_t value) {
      return static_cast<std::uint16_t>(fixed(value / 255.0 * brightness, 256));
    };
    return {channel(tint.r), channel(tint.g), channel(tint.b)};
  }

  void ambient(Line& line, TextPlace) {
    Said said("ambient");
    Rgb8 tint{191, 213, 255};
    double brightness = 0.375;
    while (!line.at_end()) {
      const Word word = line.word();
      said.once(word);
      if (word.text == "color") {
        tint = color(line);
      } else if (word.text == "brightness") {
        brightness = real(line, "brightness", 0, kMostBrightness);
      } else {
        said.unknown(word, "color and brightness");
      }
    }
    const std::array<std::uint16_t, 3> bright = brightness_q8(tint, brightness);
    std::copy(bright.begin(), bright.end(), scene_->rest.ambient_q8);
  }

  void sky(Line& line, TextPlace) {
    Said said("sky");
    scene_->rest.has_sky = true;
    while (!line.at_end()) {
      const Word word = line.word();
      said.once(word);
      if (word.text == "zenith") {
        scene_->rest.sky.zenith = color(line);
      } else if (word.text == "horizon") {
        scene_->rest.sky.horizon = color(line);
      } else if (word.text == "ground") {
        scene_->rest.sky.ground = color(line);
      } else {
        said.unknown(word, "zenith, horizon and ground");
      }
    }
  }

  void fog(Line& line, TextPlace) {
    Said said("fog");
    while (!line.at_end()) {
      const Word word = line.word();
      said.once(word);
      if (word.text == "color") {
        scene_->rest.fog.color = color(line);
      } else if (word.text == "density") {
        const double density = real(line, "density", 0, kMostDensity);
        scene_->rest.fog.density_q16 =
            static_cast<std::uint32_t>(std::max(fixed(density, 65536), density > 0 ? 1 : 0));
      } else {
        said.unknown(word, "color and density");
      }
    }
    said.need("density", line);
  }

  void occlusion(Line& line, TextPlace) {
    Said said("occlusion");
    Occlusion& result = scene_->rest.occlusion;
    result.rays = 8;
    while (!line.at_end()) {
      const Word word = line.word();
      said.once(word);
      if (word.text == "rays") {
        const std::int32_t rays = whole(line, "rays", 4, 32);
        if (rays != 4 && rays != 8 && rays != 16 && rays != 32) {
          fail_at(word.place, "rays is " + std::to_string(rays) + ", it must be 4, 8, 16 or 32");
        }
        result.rays = static_cast<std::uint8_t>(rays);
      } else if (word.text == "reach") {
        result.reach = static_cast<std::uint16_t>(whole(line, "reach", 1, 4096));
      } else if (word.text == "strength") {
        result.strength = share(line, "strength");
      } else {
        said.unknown(word, "rays, reach and strength");
      }
    }
  }

  // A property of what light does in a material; false when `word` names none.
  static bool property(const Word& word, Line& line, Surface* surface) {
    if (word.text == "color") {
      surface->albedo = color(line);
    } else if (word.text == "roughness") {
      surface->roughness = share(line, "roughness");
    } else if (word.text == "mirror") {
      surface->mirror = share(line, "mirror");
    } else if (word.text == "index") {
      surface->index_q12 = static_cast<std::uint16_t>(fixed(real(line, "index", 1, 4), 4096));
    } else if (word.text == "density") {
      surface->density_q8 = fixed_q8(line, "density", kMostDensity);
    } else if (word.text == "emission") {
      surface->emission_q8 = fixed_q8(line, "emission", kMostEmission);
    } else {
      return false;
    }
    return true;
  }

  void water(Line& line, TextPlace place) {
    Said said("water");
    SceneText::WaterArea area;
    area.place = place;
    double level = 0;
    std::array<std::int32_t, 4> plan{};
    TextPlace level_place = place;
    while (!line.at_end()) {
      const Word word = line.word();
      said.once(word);
      const auto corner = [&](std::size_t first) {
        plan[first] = whole(line, "x of " + std::string(word.text), 0, 4096);
        plan[first + 1] = whole(line, "y of " + std::string(word.text), 0, 4096, false);
      };
      if (word.text == "level") {
        level = real(line, "level", 0, 4096);
        level_place = word.place;
      } else if (word.text == "floor") {
        area.floor = whole(line, "floor", 0, 4095);
      } else if (word.text == "from") {
        corner(0);
      } else if (word.text == "to") {
        corner(2);
      } else if (word.text == "roughness" || word.text == "mirror" || word.text == "emission" ||
                 !property(word, line, &scene_->rest.water_material)) {
        said.unknown(word, "level, floor, from, to, color, index and density");
      }
    }
    said.need("level", line);
    if (said.has("from") != said.has("to")) {
      said.need(said.has("from") ? "to" : "from", line);
    }
    if (said.has("from")) {
      if (plan[0] >= plan[2] || plan[1] >= plan[3]) {
        fail_at(place, "water from " + std::to_string(plan[0]) + " " + std::to_string(plan[1]) + " to " +
                           std::to_string(plan[2]) + " " + std::to_string(plan[3]) + " holds no column");
      }
      area.from_to = plan;
    }
    area.level_q8 = fixed(level, Q8::kOne);
    if (area.level_q8 <= area.floor * Q8::kOne) {
      fail_at(level_place, "the level of the water is not above its floor at " + std::to_string(area.floor));
    }
    scene_->water = area;
  }

  void material(Line& line, TextPlace place) {
    if (scene_->materials.size() == kSceneTextMaterials) {
      fail_at(place, "there are more materials than the limit of " + std::to_string(kSceneTextMaterials));
    }
    const Word name = line.word();
    if (name.empty()) {
      fail_at(name.place, "material needs a name");
    }
    if (name.text.empty() || std::any_of(name.text.begin(), name.text.end(), is_space)) {
      fail_at(name.place, "a material's name is one word");
    }
    if (find(name.text) >= 0) {
      fail_at(name.place, "there is a material " + quoted(name.text) + " already");
    }
    SceneText::NamedSurface result;
    result.name = name.text;
    result.place = name.place;
    Said said("material");
    while (!line.at_end()) {
      const Word word = line.word();
      said.once(word);
      const auto kind = std::find(kKinds.begin(), kKinds.end(), word.text);
      if (kind != kKinds.end()) {
        if (has_kind_) {
          fail_at(word.place, "a material has one kind; there is one already");
        }
        has_kind_ = true;
        result.surface.kind = static_cast<SurfaceKind>(kind - kKinds.begin());
        continue;
      }
      if (!property(word, line, &result.surface)) {
        said.unknown(
            word,
            "diffuse, metal, glass, emit, media, color, roughness, mirror, index, density and emission");
      }
    }
    has_kind_ = false;
    if (!said.has("index") && result.surface.kind == SurfaceKind::kGlass) {
      result.surface.index_q12 = 6144;  // 1.5, window glass
    }
    result.has_color = said.has("color");
    scene_->materials.push_back(std::move(result));
  }

  int find(std::string_view name) const {
    const auto found = std::find_if(scene_->materials.begin(), scene_->materials.end(),
                                    [&](const SceneText::NamedSurface& each) { return each.name == name; });
    return found == scene_->materials.end() ? -1 : static_cast<int>(found - scene_->materials.begin());
  }

  std::size_t named_material(Line& line, const char* what) {
    const Word word = line.word();
    if (word.empty()) {
      fail_at(word.place, std::string(what) + " needs the name of a material");
    }
    const int found = find(word.text);
    if (found < 0) {
      fail_at(word.place, "there is no material " + quoted(word.text) + " above this line");
    }
    return static_cast<std::size_t>(found);
  }

  SceneText::Part& add_part(SceneText::PartKind kind, TextPlace place) {
    if (scene_->parts.size() == kSceneTextParts) {
      fail_at(place, "there are more models, boxes and balls than the limit of " + grouped(kSceneTextParts));
    }
    SceneText::Part& part = scene_->parts.emplace_back();
    part.kind = kind;
    part.place = place;
    return part;
  }

  void box(Line& line, TextPlace place) {
    SceneText::Part& part = add_part(SceneText::PartKind::kBox, place);
    part.material = named_material(line, "box");
    Said said("box");
    while (!line.at_end()) {
      const Word word = line.word();
      said.once(word);
      if (word.text == "from") {
        part.low = three_wholes(line, "from", -kSceneTextReach, kSceneTextReach);
      } else if (word.text == "to") {
        part.high = three_wholes(line, "to", -kSceneTextReach, kSceneTextReach);
      } else {
        said.unknown(word, "from and to");
      }
    }
    said.need("from", line);
    said.need("to", line);
    if (VoxelBox{part.low, part.high}.empty()) {
      fail_at(place, "this box holds no voxel: each number after to must be above the one after from");
    }
  }

  void ball(Line& line, TextPlace place) {
    SceneText::Part& part = add_part(SceneText::PartKind::kBall, place);
    part.material = named_material(line, "ball");
    Said said("ball");
    while (!line.at_end()) {
      const Word word = line.word();
      said.once(word);
      if (word.text == "at") {
        part.center = to_q8(three_reals(line, "at", -kSceneTextReach, kSceneTextReach));
      } else if (word.text == "radius") {
        part.radius_q8 = fixed(real(line, "radius", 1, 4096), Q8::kOne);
      } else {
        said.unknown(word, "at and radius");
      }
    }
    said.need("at", line);
    said.need("radius", line);
  }

  // Turned voxel i comes from v[axis[i]]; one more turn by a quarter about `about`, against the clock when
  // that axis points at the reader.
  static void quarter_turn(SceneText::Part* part, std::size_t about) {
    const std::size_t first = (about + 1) % 3;
    const std::size_t second = (about + 2) % 3;
    std::swap(part->axis[first], part->axis[second]);
    std::swap(part->sign[first], part->sign[second]);
    part->sign[first] = static_cast<std::int8_t>(-part->sign[first]);
  }

  void model(Line& line, TextPlace place) {
    SceneText::Part& part = add_part(SceneText::PartKind::kModel, place);
    const Word file = line.word();
    if (file.text.empty()) {
      fail_at(file.place, "model needs the name of a file or a generator");
    }
    part.file = file.text;
    part.file_place = file.place;
    part.replaced.fill(-1);
    std::array<bool, 256> is_replaced{};
    bool all_replaced = false;
    Said said("model");
    while (!line.at_end()) {
      const Word word = line.word();
      if (word.text == "turn") {
        const int axis = axis_of(line, "turn");
        const std::int32_t turns = whole(line, "turn", -3, 3);
        for (int turn = 0; turn < (turns + 4) % 4; ++turn) {
          quarter_turn(&part, static_cast<std::size_t>(axis));
        }
        continue;
      }
      if (word.text == "mirror") {
        std::int8_t& sign = part.sign[static_cast<std::size_t>(axis_of(line, "mirror"))];
        sign = static_cast<std::int8_t>(-sign);
        continue;
      }
      if (word.text == "replace") {
        replace(line, &part, &is_replaced, &all_replaced);
        continue;
      }
      said.once(word);
      if (word.text == "at") {
        part.at = three_wholes(line, "at", -kSceneTextReach, kSceneTextReach);
      } else if (word.text == "depth") {
        part.depth = whole(line, "depth", kMinLevel, kMaxLevel);
      } else if (word.text == "crop") {
        part.crop = true;
      } else if (word.text == "as-voxels") {
        part.as_voxels = true;
      } else if (word.text == "z-up") {
        part.z_up = true;
      } else {
        said.unknown(word, "at, turn, mirror, replace, crop, depth, as-voxels and z-up");
      }
    }
  }

  void replace(Line& line, SceneText::Part* part, std::array<bool, 256>* done, bool* all) {
    const Word which = line.word();
    const bool is_all = which.text == "all";
    std::int64_t index = 0;
    if (!is_all && (!parse_integer(which.text, index) || index < 0 || index > 255)) {
      fail_at(which.place, "replace needs a palette index from 0 to 255, or all" +
                               (which.empty() ? std::string() : ", not " + quoted(which.text)));
    }
    if (is_all ? *all : (*done)[static_cast<std::size_t>(index)]) {
      fail_at(which.place, "replace " + std::string(which.text) + " is said twice in this model");
    }
    const auto material = static_cast<std::int16_t>(named_material(line, "replace"));
    part->replaces = true;
    if (is_all) {
      *all = true;
      for (std::size_t i = 0; i < part->replaced.size(); ++i) {
        part->replaced[i] = (*done)[i] ? part->replaced[i] : material;
      }
    } else {
      (*done)[static_cast<std::size_t>(index)] = true;
      part->replaced[static_cast<std::size_t>(index)] = material;
    }
  }

  void bounces(Line& line, TextPlace) {
    scene_->rest.bounces = static_cast<std::uint8_t>(whole(line, "bounces", 0, kMaxBounces));
  }

  void effects(Line& line, TextPlace) {
    const Word which = line.word();
    if (which.text != "on" && which.text != "off") {
      fail_at(which.place, "effects needs on or off" + (which.empty() ? "" : ", not " + quoted(which.text)));
    }
    EffectSet& set = which.text == "on" ? scene_->on : scene_->off;
    bool any = false;
    for (; !any || !line.at_end(); any = true) {
      const Word word = line.word();
      EffectSet found = Effect::kNone;
      std::string known;
      for (int bit = 0; bit < Effect::kCount; ++bit) {
        const std::string_view name = effect_name(EffectSet{1} << bit);
        found |= name == word.text ? EffectSet{1} << bit : Effect::kNone;
        known += (bit == 0 ? "" : ", ") + std::string(name);
      }
      if (found == Effect::kNone) {
        fail_at(word.place,
                (word.empty() ? "the name of an effect is missing" : quoted(word.text) + " is no effect") +
                    "; there are " + known);
      }
      if (((scene_->on | scene_->off) & found) != 0) {
        fail_at(word.place, std::string(word.text) + " is turned on or off twice");
      }
      set |= found;
    }
  }

  std::string_view text_;
  std::shared_ptr<SceneText> scene_ = std::make_shared<SceneText>();
  std::array<TextPlace, 15> first_{};
  bool has_kind_ = false;
};

const std::array<Parser::Statement, 15> Parser::kStatements{{
    {"model", &Parser::model, false},
    {"box", &Parser::box, false},
    {"ball", &Parser::ball, false},
    {"material", &Parser::material, false},
    {"depth", &Parser::depth, true},
    {"camera", &Parser::camera, true},
    {"sun", &Parser::sun, false},
    {"lamp", &Parser::lamp, false},
    {"ambient", &Parser::ambient, true},
    {"sky", &Parser::sky, true},
    {"fog", &Parser::fog, true},
    {"occlusion", &Parser::occlusion, true},
    {"water", &Parser::water, true},
    {"bounces", &Parser::bounces, true},
    {"effects", &Parser::effects, false},
}};

}  // namespace

void fail_at(const TextPlace& place, const std::string& sentence) {
  throw InputError("line " + std::to_string(place.line) + ", column " + std::to_string(place.column) + ": " +
                   sentence);
}

Source read_scene_text(const SharedBytes& file, const Progress& progress) {
  Source result = Parser(file.text()).parse();
  if (progress) {
    progress(1);
  }
  return result;
}

}  // namespace thimble::tools
