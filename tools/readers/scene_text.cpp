// `.scene` files (src/FORMAT.md). Of each statement, the line stands behind its word, which stands at `place`; it reads
// what belongs to it and throws as `read_scene_text` does.
#include "readers/scene_text.h"

#include "output/units.h"
#include "readers/formats.h"
#include "readers/real3.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {
namespace {

// The language that statements are written in: words, numbers and clauses of one line, each with the place where it stands.

/// A word or a number, and where it stands.
struct Word {
  std::string_view text;
  TextPlace place;
  bool is_quoted = false;
  bool empty() const { return text.empty() && !is_quoted; }
};

/// One line, read word by word. Its comment is no part of it.
class TextLine {
 public:
  TextLine(std::string_view text, std::uint32_t number) : text_(text), number_(number) {}

  /// Where reading continues.
  TextPlace place() const {
    const auto before = text_.substr(0, next_);
    const auto characters = std::count_if(before.begin(), before.end(), [](char c) {
      return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // all but continuations
    });
    return {number_, static_cast<std::uint32_t>(characters) + 1};
  }
  /// The next word, empty at the end of the line or before a comment.
  Word word() {
    skip_blanks();
    Word result;
    result.place = place();
    if (next_ == text_.size() || text_[next_] != '"') {
      result.text = run_until(kSpaces);
      return result;
    }
    const std::size_t end = text_.find('"', next_ + 1);
    fail_if(end == std::string_view::npos, result.place, "the quotation mark is not closed on this line");
    result.text = text_.substr(next_ + 1, end - next_ - 1);
    result.is_quoted = true;
    next_ = end + 1;
    fail_if(next_ < text_.size() && !is_space(text_[next_]), place(),
            "a blank must follow the quotation mark");
    return result;
  }
  /// The next number: a comma may stand before it unless it is the first of several.
  Word number(bool is_first) {
    skip_blanks();
    if (!is_first && next_ < text_.size() && text_[next_] == ',') {
      ++next_;
      skip_blanks();
    }
    Word result;
    result.place = place();
    result.text = run_until(kSpacesAndComma);
    return result;
  }
  /// Whether nothing but a comment is left.
  bool at_end() {
    skip_blanks();
    return next_ == text_.size();
  }

  // Values, each by its name in an error's sentence and with both ends of its range.

  double real(const std::string& what, double low, double high, bool is_first = true) {
    const Word word = number(is_first);
    const std::string range = shortest(low) + " to " + shortest(high);
    fail_if(word.text.empty(), word.place, what, " is missing: a number from ", range, " is expected here");
    double value = 0;
    const NumberKind kind = parse_number(word.text, value);
    fail_if(kind != NumberKind::kFinite || !(value >= low && value <= high), word.place, what, " is ",
            quoted(word.text),
            kind == NumberKind::kFinite      ? ", it must be " + range
            : kind == NumberKind::kNotFinite ? ", which is not finite"
                                             : ", which is not a number");
    return value;
  }
  std::int32_t whole(const std::string& what, std::int32_t low, std::int32_t high, bool is_first = true) {
    const Word word = number(is_first);
    const std::string range = concat(low, " to ", high);
    fail_if(word.text.empty(), word.place, what, " is missing: a whole number from ", range,
            " is expected here");
    std::int64_t value = 0;
    const bool is_whole = parse_integer(word.text, value);
    if (!is_whole || value < low || value > high) {
      double large = 0;  // beyond 64 bits
      const bool is_number =
          is_whole || (parse_number(word.text, large) == NumberKind::kFinite && std::abs(large) >= 9e18);
      fail_at(word.place, what, " is ", quoted(word.text),
              is_number ? ", it must be " + range : ", which is not a whole number");
    }
    return static_cast<std::int32_t>(value);
  }
  std::array<double, 3> three_reals(const std::string& what, double low, double high) {
    return {real("x of " + what, low, high), real("y of " + what, low, high, false),
            real("z of " + what, low, high, false)};
  }
  Vec3i three_wholes(const std::string& what, std::int32_t low, std::int32_t high) {
    return {whole("x of " + what, low, high), whole("y of " + what, low, high, false),
            whole("z of " + what, low, high, false)};
  }
  /// Red, green and blue, 0 to 255 each.
  Rgb8 color() {
    const auto channel = [this](const char* name, bool is_first) {
      return static_cast<std::uint8_t>(whole(name, 0, 255, is_first));
    };
    return {channel("red", true), channel("green", false), channel("blue", false)};
  }
  /// 0 to 1, as 0 to 255.
  std::uint8_t share(const char* what) { return static_cast<std::uint8_t>(to_fixed(real(what, 0, 1), 255)); }
  /// In 1/256; a number that is above 0 stays above 0.
  std::uint16_t fixed_q8(const char* what, double high) {
    const double value = real(what, 0, high);
    return static_cast<std::uint16_t>(std::clamp(to_fixed(value, 256), value > 0 ? 1 : 0, 65535));
  }
  /// x, y or z, as 0 to 2.
  std::size_t axis(const char* what) {
    const Word name = word();
    const std::size_t found = std::string_view("xyz").find(name.text);
    fail_if(name.text.size() != 1 || found == std::string_view::npos, name.place, what,
            " needs an axis: x, y or z", name.empty() ? "" : ", not " + quoted(name.text));
    return found;
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
  /// What stands before the next one of `ends`.
  std::string_view run_until(std::string_view ends) {
    const std::size_t begin = std::exchange(next_, std::min(text_.find_first_of(ends, next_), text_.size()));
    return text_.substr(begin, next_ - begin);
  }

  static constexpr std::string_view kSpacesAndComma = ", \t\n\v\f\r";
  std::string_view text_;
  std::uint32_t number_;
  std::size_t next_ = 0;
};

/// A clause of a statement: its word, and what reads all that follows it.
struct Clause {
  std::string_view word;
  std::function<void(const Word&)> read;
  bool repeats = false;  ///< otherwise it stands once in a statement
};

/// The clauses of one statement, in any order.
class Clauses {
 public:
  /// @param needed  those that must be said by the end of the line
  Clauses(std::string_view statement, TextLine* line, std::vector<std::string_view> needed = {})
      : statement_(statement), line_(line), needed_(std::move(needed)) {}

  /// Reads to the end of the line.
  void read(const std::vector<Clause>& known) {
    while (!line_->at_end()) {
      const Word word = line_->word();
      const auto clause = std::find_if(known.begin(), known.end(), [&](const Clause& each) {
        return !word.is_quoted && each.word == word.text;
      });
      if (clause == known.end()) {
        std::string names(known.front().word);
        for (std::size_t i = 1; i < known.size(); ++i) {
          names += (i + 1 < known.size() ? ", " : " and ") + std::string(known[i].word);
        }
        fail_at(word.place, quoted(word.text), " is not known in ", statement_, "; there are ", names);
      }
      fail_if(!clause->repeats && has(word.text), word.place, word.text, " is said twice in this ",
              statement_);
      said_.push_back(word.text);
      clause->read(word);
    }
    std::for_each(needed_.begin(), needed_.end(), [this](std::string_view word) { need(word); });
  }
  bool has(std::string_view word) const { return std::find(said_.begin(), said_.end(), word) != said_.end(); }
  /// Fails at the end of the line where `word` was not said.
  void need(std::string_view word) const {
    if (!has(word)) {
      line_->at_end();
      fail_at(line_->place(), statement_, " needs ", word);
    }
  }

 private:
  std::string_view statement_;
  TextLine* line_;
  std::vector<std::string_view> needed_, said_{};
};

/// Fails where the bytes are not UTF-8 text, or hold control characters.
void check_characters(std::string_view text) {
  TextPlace place{1, 1};
  for (std::size_t at = 0; at < text.size();) {
    unsigned code = 0;
    const std::size_t length = character_bytes(text.substr(at), &code);
    const auto byte = static_cast<unsigned char>(text[at]);
    fail_if(length == 0, place, "the bytes here are not UTF-8 text");
    const bool ends_line = byte == '\n' || byte == '\r';
    fail_if((byte < ' ' && byte != '\t' && !ends_line) || byte == 0x7F, place, "byte ", byte,
            " is a control character, not text");
    at += text.substr(at).starts_with("\r\n") ? 2 : length;
    place = ends_line ? TextPlace{place.line + 1, 1} : TextPlace{place.line, place.column + 1};
  }
}

}  // namespace

namespace statements {
namespace {

constexpr double kMostDensity = 200;
/// Components of a direction as it is written.
constexpr double kMostDirection = 65535;
/// No world has anything farther away; the world's own limit is checked later.
constexpr double kFar = 9.0 * 4096;

// What stands in the world, and what it is made of.

// Kinds of materials, in the order of SurfaceKind.
constexpr std::array<std::string_view, 5> kThingKinds{"diffuse", "metal", "glass", "emit", "media"};

// Clauses that a material and water share.
Clause color_clause(TextLine& line, Surface& surface) {
  return {"color", [&](const Word&) { surface.albedo = line.color(); }};
}
Clause index_clause(TextLine& line, Surface& surface) {
  return {"index", [&](const Word&) {
            surface.index_q12 = static_cast<std::uint16_t>(to_fixed(line.real("index", 1, 4), 4096));
          }};
}
Clause density_clause(TextLine& line, Surface& surface) {
  return {"density", [&](const Word&) { surface.density_q8 = line.fixed_q8("density", kMostDensity); }};
}

// Index of the material, or -1.
int find(const SceneText& scene, std::string_view name) {
  const auto found = std::find_if(scene.materials.begin(), scene.materials.end(),
                                  [&](const SceneText::NamedSurface& each) { return each.name == name; });
  return found == scene.materials.end() ? -1 : static_cast<int>(found - scene.materials.begin());
}

std::size_t named_material(TextLine& line, const SceneText& scene, const char* what) {
  const Word word = line.word();
  fail_if(word.empty(), word.place, what, " needs the name of a material");
  const int found = find(scene, word.text);
  fail_if(found < 0, word.place, "there is no material ", quoted(word.text), " above this line");
  return static_cast<std::size_t>(found);
}

SceneText::Part& add_part(SceneText* scene, SceneText::PartKind kind, TextPlace place) {
  fail_if(scene->parts.size() == kSceneTextParts, place,
          "there are more models, boxes and balls than the limit of ", grouped(kSceneTextParts));
  SceneText::Part& part = scene->parts.emplace_back();
  part.kind = kind;
  part.place = place;
  return part;
}

// One more turn by a quarter about `about`, against the clock when that axis points at the reader.
void quarter_turn(SceneText::Part* part, std::size_t about) {
  const std::size_t first = (about + 1) % 3;
  const std::size_t second = (about + 2) % 3;
  std::swap(part->axis[first], part->axis[second]);
  std::swap(part->sign[first], part->sign[second]);
  part->sign[first] = static_cast<std::int8_t>(-part->sign[first]);
}

// What `replace` said so far in one model.
struct Replaced {
  std::array<bool, 256> done{};
  bool all = false;
};

void replace(TextLine& line, const SceneText& scene, SceneText::Part* part, Replaced* so_far) {
  const Word which = line.word();
  const bool is_all = which.text == "all";
  std::int64_t number = 0;
  fail_if(!is_all && (!parse_integer(which.text, number) || number < 0 || number > 255), which.place,
          "replace needs a palette index from 0 to 255, or all",
          which.empty() ? std::string() : ", not " + quoted(which.text));
  const auto index = static_cast<std::size_t>(number);
  bool& is_done = is_all ? so_far->all : so_far->done[index];
  fail_if(is_done, which.place, "replace ", which.text, " is said twice in this model");
  is_done = true;
  const auto material = static_cast<std::int16_t>(named_material(line, scene, "replace"));
  part->replaces = true;
  for (std::size_t i = 0; i < part->replaced.size(); ++i) {
    if (is_all ? !so_far->done[i] : i == index) {
      part->replaced[i] = material;
    }
  }
}

void water(TextLine& line, TextPlace place, SceneText* scene) {
  Clauses clauses("water", &line, {"level"});
  SceneText::WaterArea area;
  area.place = place;
  double level = 0;
  std::array<std::int32_t, 4> plan{};
  TextPlace level_place = place;
  const auto corner = [&](std::size_t first, const char* name) {
    plan[first] = line.whole("x of " + std::string(name), 0, 4096);
    plan[first + 1] = line.whole("y of " + std::string(name), 0, 4096, false);
  };
  Surface& surface = scene->rest.water_material;
  clauses.read({{"level",
                 [&](const Word& word) {
                   level = line.real("level", 0, 4096);
                   level_place = word.place;
                 }},
                {"floor", [&](const Word&) { area.floor = line.whole("floor", 0, 4095); }},
                {"from", [&](const Word&) { corner(0, "from"); }},
                {"to", [&](const Word&) { corner(2, "to"); }},
                color_clause(line, surface),
                index_clause(line, surface),
                density_clause(line, surface)});
  if (clauses.has("from") || clauses.has("to")) {
    clauses.need("to");
    clauses.need("from");
    fail_if(plan[0] >= plan[2] || plan[1] >= plan[3], place, "water from ", plan[0], " ", plan[1], " to ",
            plan[2], " ", plan[3], " holds no column");
    area.from_to = plan;
  }
  area.level_q8 = to_fixed(level, Q8::kOne);
  fail_if(area.level_q8 <= area.floor * Q8::kOne, level_place,
          "the level of the water is not above its floor at ", area.floor);
  scene->water = area;
}

void material(TextLine& line, TextPlace place, SceneText* scene) {
  fail_if(scene->materials.size() == kSceneTextMaterials, place,
          "there are more materials than the limit of ", kSceneTextMaterials);
  const Word name = line.word();
  fail_if(name.empty(), name.place, "material needs a name");
  fail_if(name.text.empty() || std::any_of(name.text.begin(), name.text.end(), is_space), name.place,
          "a material's name is one word");
  fail_if(find(*scene, name.text) >= 0, name.place, "there is a material ", quoted(name.text), " already");
  SceneText::NamedSurface result;
  result.name = name.text;
  result.place = name.place;
  Surface& surface = result.surface;
  Clauses clauses("material", &line);
  std::vector<Clause> known;
  bool has_kind = false;
  for (std::size_t kind = 0; kind < kThingKinds.size(); ++kind) {
    known.push_back({kThingKinds[kind], [&, kind](const Word& word) {
                       fail_if(has_kind, word.place, "a material has one kind; there is one already");
                       has_kind = true;
                       surface.kind = static_cast<SurfaceKind>(kind);
                     }});
  }
  constexpr double kMostEmission = 200;
  known.push_back(color_clause(line, surface));
  known.push_back({"roughness", [&](const Word&) { surface.roughness = line.share("roughness"); }});
  known.push_back({"mirror", [&](const Word&) { surface.mirror = line.share("mirror"); }});
  known.push_back(index_clause(line, surface));
  known.push_back(density_clause(line, surface));
  known.push_back(
      {"emission", [&](const Word&) { surface.emission_q8 = line.fixed_q8("emission", kMostEmission); }});
  clauses.read(known);
  if (!clauses.has("index") && surface.kind == SurfaceKind::kGlass) {
    surface.index_q12 = 6144;  // 1.5, window glass
  }
  result.has_color = clauses.has("color");
  scene->materials.push_back(std::move(result));
}

void box(TextLine& line, TextPlace place, SceneText* scene) {
  SceneText::Part& part = add_part(scene, SceneText::PartKind::kBox, place);
  part.material = named_material(line, *scene, "box");
  const auto corner = [&](const Word& word) {
    return line.three_wholes(std::string(word.text), -kSceneTextReach, kSceneTextReach);
  };
  Clauses("box", &line, {"from", "to"})
      .read({{"from", [&](const Word& word) { part.low = corner(word); }},
             {"to", [&](const Word& word) { part.high = corner(word); }}});
  fail_if(VoxelBox{part.low, part.high}.empty(), place,
          "this box holds no voxel: each number after to must be above the one after from");
}

void ball(TextLine& line, TextPlace place, SceneText* scene) {
  SceneText::Part& part = add_part(scene, SceneText::PartKind::kBall, place);
  part.material = named_material(line, *scene, "ball");
  Clauses clauses("ball", &line, {"at", "radius"});
  clauses.read(
      {{"at",
        [&](const Word&) { part.center = to_q8(line.three_reals("at", -kSceneTextReach, kSceneTextReach)); }},
       {"radius", [&](const Word&) { part.radius_q8 = to_fixed(line.real("radius", 1, 4096), Q8::kOne); }}});
}

void model(TextLine& line, TextPlace place, SceneText* scene) {
  SceneText::Part& part = add_part(scene, SceneText::PartKind::kModel, place);
  const Word file = line.word();
  fail_if(file.text.empty(), file.place, "model needs the name of a file or a generator");
  part.file = file.text;
  part.file_place = file.place;
  part.replaced.fill(-1);
  Replaced replaced;
  constexpr bool kRepeats = true;
  Clauses("model", &line)
      .read(
          {{"at", [&](const Word&) { part.at = line.three_wholes("at", -kSceneTextReach, kSceneTextReach); }},
           {"turn",
            [&](const Word&) {
              const std::size_t axis = line.axis("turn");
              const std::int32_t turns = line.whole("turn", -3, 3);
              for (int turn = 0; turn < (turns + 4) % 4; ++turn) {
                quarter_turn(&part, axis);
              }
            },
            kRepeats},
           {"mirror",
            [&](const Word&) {
              std::int8_t& sign = part.sign[line.axis("mirror")];
              sign = static_cast<std::int8_t>(-sign);
            },
            kRepeats},
           {"replace", [&](const Word&) { replace(line, *scene, &part, &replaced); }, kRepeats},
           {"crop", [&](const Word&) { part.crop = true; }},
           {"depth", [&](const Word&) { part.depth = line.whole("depth", kMinLevel, kMaxLevel); }},
           {"as-voxels", [&](const Word&) { part.as_voxels = true; }},
           {"z-up", [&](const Word&) { part.z_up = true; }}});
}

// How it is seen and lit.

// Light of a colour times a brightness.
struct Tinted {
  Rgb8 tint;
  double brightness;

  Clause color(TextLine& line) {
    return {"color", [this, &line](const Word&) { tint = line.color(); }};
  }
  Clause brightness_of(TextLine& line) {
    constexpr double kMostBrightness = 100;
    return {"brightness",
            [this, &line](const Word&) { brightness = line.real("brightness", 0, kMostBrightness); }};
  }
  std::array<std::uint16_t, 3> color_q8() const {
    const auto channel = [this](std::uint8_t value) {
      return static_cast<std::uint16_t>(to_fixed(value / 255.0 * brightness, 256));
    };
    return {channel(tint.r), channel(tint.g), channel(tint.b)};
  }
};

std::array<double, 3> direction(TextLine& line, const Word& word) {
  const std::string name(word.text);
  const std::array<double, 3> result = line.three_reals(name, -kMostDirection, kMostDirection);
  fail_if(largest(result) == 0, word.place, name, " 0 0 0 has no direction");
  return result;
}

// A lamp at a place, or a sun.
template <bool is_point>
void read_light(TextLine& line, TextPlace place, SceneText* scene) {
  fail_if(scene->lights.size() == kMaxLights, place, "there are more lights than the limit of ", kMaxLights);
  Clauses clauses(is_point ? "lamp" : "sun", &line, {is_point ? "at" : "toward"});
  Light light;
  light.is_point = is_point;
  Tinted tinted{{255, 255, 255}, 1};
  std::vector<Clause> known;
  if (is_point) {
    known.push_back({"at", [&](const Word&) {
                       const Vec3Q8 at = to_q8(line.three_reals("at", -kFar, kFar));
                       light.place = {at.x.raw, at.y.raw, at.z.raw};
                     }});
    known.push_back({"reach", [&](const Word&) {
                       light.reach = static_cast<std::uint16_t>(line.whole("reach", 1, 65535));
                     }});
  } else {
    known.push_back({"toward", [&](const Word& word) {
                       light.place = to_integers(direction(line, word), kMaxLightComponent);
                     }});
  }
  known.push_back(tinted.color(line));
  known.push_back(tinted.brightness_of(line));
  clauses.read(known);
  const auto color_q8 = tinted.color_q8();
  std::copy(color_q8.begin(), color_q8.end(), light.color_q8);
  scene->lights.push_back({light, place});
}

void camera(TextLine& line, TextPlace place, SceneText* scene) {
  Clauses clauses("camera", &line, {"eye", "target"});
  SceneCamera result;
  std::array<double, 3> eye{};
  std::array<double, 3> target{};
  std::array<double, 3> up{};
  const auto check_projection = [&](const Word& word) {
    fail_if(clauses.has("fov") && clauses.has("span"), word.place,
            "fov is for perspective and span for parallel rays: there is one or the other");
  };
  clauses.read({
      {"eye", [&](const Word&) { eye = line.three_reals("eye", -kFar, kFar); }},
      {"target", [&](const Word&) { target = line.three_reals("target", -kFar, kFar); }},
      {"up", [&](const Word& word) { up = direction(line, word); }},
      {"fov",
       [&](const Word& word) {
         result.fov_degrees = Q16::from_raw(to_fixed(line.real("fov", 1, 120), Q16::kOne));
         check_projection(word);
       }},
      {"span",
       [&](const Word& word) {
         result.is_perspective = false;
         result.span = Q14::from_raw(std::max(1, to_fixed(line.real("span", 0, 131071), Q14::kOne)));
         check_projection(word);
       }},
  });
  const Real3 forward = minus(target, eye);
  result.eye = to_q8(eye);
  result.target = to_q8(target);
  fail_if(largest(forward) == 0, place, "eye and target of the camera are the same point");
  result.forward = to_integers(forward, kMaxViewComponent);
  result.up = largest(up) == 0 ? Vec3i{} : to_integers(up, kMaxViewComponent);
  scene->camera = result;
  scene->camera_place = place;
}

void ambient(TextLine& line, TextPlace, SceneText* scene) {
  scene->has_ambient = true;
  Tinted tinted{{191, 213, 255}, 0.375};
  Clauses("ambient", &line).read({tinted.color(line), tinted.brightness_of(line)});
  const auto color_q8 = tinted.color_q8();
  std::copy(color_q8.begin(), color_q8.end(), scene->rest.ambient_q8);
}

void sky(TextLine& line, TextPlace, SceneText* scene) {
  Sky& sky = scene->rest.sky;
  scene->rest.has_sky = true;
  Clauses("sky", &line)
      .read({{"zenith", [&](const Word&) { sky.zenith = line.color(); }},
             {"horizon", [&](const Word&) { sky.horizon = line.color(); }},
             {"ground", [&](const Word&) { sky.ground = line.color(); }}});
}

void fog(TextLine& line, TextPlace, SceneText* scene) {
  Fog& fog = scene->rest.fog;
  Clauses clauses("fog", &line, {"density"});
  clauses.read({{"color", [&](const Word&) { fog.color = line.color(); }},
                {"density", [&](const Word&) {
                   const double density = line.real("density", 0, kMostDensity);
                   fog.density_q16 =
                       static_cast<std::uint32_t>(std::max(to_fixed(density, 65536), density > 0 ? 1 : 0));
                 }}});
}

void occlusion(TextLine& line, TextPlace, SceneText* scene) {
  Occlusion& result = scene->rest.occlusion;
  result.rays = 8;
  Clauses("occlusion", &line)
      .read({{"rays",
              [&](const Word& word) {
                const std::int32_t rays = line.whole("rays", 4, 32);
                fail_if(rays != 4 && rays != 8 && rays != 16 && rays != 32, word.place, "rays is ", rays,
                        ", it must be 4, 8, 16 or 32");
                result.rays = static_cast<std::uint8_t>(rays);
              }},
             {"reach",
              [&](const Word&) { result.reach = static_cast<std::uint16_t>(line.whole("reach", 1, 4096)); }},
             {"strength", [&](const Word&) { result.strength = line.share("strength"); }}});
}

void effects(TextLine& line, TextPlace, SceneText* scene) {
  constexpr EffectSet kEffectsOfLight = Effect::kShadows | Effect::kEmitterLight;
  const Word which = line.word();
  fail_if(which.text != "on" && which.text != "off", which.place, "effects needs on or off",
          which.empty() ? "" : ", not " + quoted(which.text));
  EffectSet& set = which.text == "on" ? scene->on : scene->off;
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
    fail_if(found == Effect::kNone, word.place,
            word.empty() ? "the name of an effect is missing" : quoted(word.text) + " is no effect",
            "; there are ", known);
    fail_if(((scene->on | scene->off) & found) != 0, word.place, word.text, " is turned on or off twice");
    set |= found;
    fail_if((scene->off & Effect::kDirectLight) != 0 && (scene->on & kEffectsOfLight) != 0, word.place,
            "without direct-light there are no shadows and no emitter-light: one is on, the other off");
  }
}

void depth(TextLine& line, TextPlace, SceneText* scene) {
  scene->depth = line.whole("depth", kMinLevel, kMaxLevel);
}

void bounces(TextLine& line, TextPlace, SceneText* scene) {
  scene->rest.bounces = static_cast<std::uint8_t>(line.whole("bounces", 0, kMaxBounces));
}

}  // namespace
}  // namespace statements

namespace {

struct Statement {
  std::string_view word;
  void (*read)(TextLine& line, TextPlace place, SceneText* scene);
  bool once;
};

constexpr std::array<Statement, 15> kStatements{{
    {"model", statements::model, false},
    {"box", statements::box, false},
    {"ball", statements::ball, false},
    {"material", statements::material, false},
    {"depth", statements::depth, true},
    {"camera", statements::camera, true},
    {"sun", statements::read_light<false>, false},
    {"lamp", statements::read_light<true>, false},
    {"ambient", statements::ambient, true},
    {"sky", statements::sky, true},
    {"fog", statements::fog, true},
    {"occlusion", statements::occlusion, true},
    {"water", statements::water, true},
    {"bounces", statements::bounces, true},
    {"effects", statements::effects, false},
}};

/// Lines in which the statements stand first; 0: nowhere yet.
using FirstLines = std::array<std::uint32_t, kStatements.size()>;

void read_statement(TextLine line, FirstLines* first, SceneText* scene) {
  const Word word = line.word();
  if (word.empty()) {
    return;
  }
  std::string known;
  for (std::size_t i = 0; i < kStatements.size(); ++i) {
    const Statement& statement = kStatements[i];
    if (word.text != statement.word || word.is_quoted) {
      known += (known.empty() ? "" : ", ") + std::string(statement.word);
      continue;
    }
    fail_if(statement.once && (*first)[i] != 0, word.place, word.text,
            " is said twice; the first stands in line ", (*first)[i]);
    (*first)[i] = word.place.line;
    statement.read(line, word.place, scene);
    if (!line.at_end()) {
      const auto place = line.place();  // before the word is read
      fail_at(place, "nothing more belongs into this line, but there is ", quoted(line.word().text));
    }
    return;
  }
  fail_at(word.place, quoted(word.text), " is no statement; there are ", known);
}

}  // namespace

/// @throws InputError  naming line and column: a word that is not known, one that is missing, a number that
///   is none, not finite or out of its range, something said twice, a name that is not defined, more than a
///   limit above, bytes that are not UTF-8; and a file that shows nothing
Source read_scene_text(const SharedBytes& file, const ReadOptions&, const Progress&) {
  const std::string_view text = file.text().substr(mark_bytes(file.text()));
  fail_if(text.size() > kSceneTextBytes, "holds ", grouped(text.size()),
          " bytes, the limit of a .scene file is ", grouped(kSceneTextBytes));
  check_characters(text);
  const auto scene = std::make_shared<SceneText>();
  FirstLines first{};
  LineReader lines(text);
  std::string_view line;
  std::uint32_t number = 0;
  while (lines.next(line)) {
    read_statement(TextLine(line, ++number), &first, scene.get());
  }
  fail_if(scene->parts.empty(), {number, 1},
          "the file ends and shows nothing: there is no model, box or ball in it");
  scene->rest.has_shadows = !scene->lights.empty();
  return std::shared_ptr<const SceneText>(scene);
}

}  // namespace thimble::tools
