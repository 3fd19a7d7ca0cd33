// Statements of a `.scene` file: what stands in the world, and what it is made of.
#include <algorithm>

#include "output/units.h"
#include "readers/scene_statements.h"
#include "readers/text.h"

namespace thimble::tools::statements {
namespace {

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
  if (word.empty()) {
    fail_at(word.place, what, " needs the name of a material");
  }
  const int found = find(scene, word.text);
  if (found < 0) {
    fail_at(word.place, "there is no material ", quoted(word.text), " above this line");
  }
  return static_cast<std::size_t>(found);
}

SceneText::Part& add_part(SceneText* scene, SceneText::PartKind kind, TextPlace place) {
  if (scene->parts.size() == kSceneTextParts) {
    fail_at(place, "there are more models, boxes and balls than the limit of ", grouped(kSceneTextParts));
  }
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
  if (!is_all && (!parse_integer(which.text, number) || number < 0 || number > 255)) {
    fail_at(which.place, "replace needs a palette index from 0 to 255, or all",
            which.empty() ? std::string() : ", not " + quoted(which.text));
  }
  const auto index = static_cast<std::size_t>(number);
  bool& is_done = is_all ? so_far->all : so_far->done[index];
  if (is_done) {
    fail_at(which.place, "replace ", which.text, " is said twice in this model");
  }
  is_done = true;
  const auto material = static_cast<std::int16_t>(named_material(line, scene, "replace"));
  part->replaces = true;
  for (std::size_t i = 0; i < part->replaced.size(); ++i) {
    if (is_all ? !so_far->done[i] : i == index) {
      part->replaced[i] = material;
    }
  }
}

}  // namespace

void water(TextLine& line, TextPlace place, SceneText* scene) {
  Clauses clauses("water", &line);
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
  clauses.need("level");
  if (clauses.has("from") || clauses.has("to")) {
    clauses.need("to");
    clauses.need("from");
    if (plan[0] >= plan[2] || plan[1] >= plan[3]) {
      fail_at(place, "water from ", plan[0], " ", plan[1], " to ", plan[2], " ", plan[3], " holds no column");
    }
    area.from_to = plan;
  }
  area.level_q8 = to_fixed(level, Q8::kOne);
  if (area.level_q8 <= area.floor * Q8::kOne) {
    fail_at(level_place, "the level of the water is not above its floor at ", area.floor);
  }
  scene->water = area;
}

void material(TextLine& line, TextPlace place, SceneText* scene) {
  if (scene->materials.size() == kSceneTextMaterials) {
    fail_at(place, "there are more materials than the limit of ", kSceneTextMaterials);
  }
  const Word name = line.word();
  if (name.empty()) {
    fail_at(name.place, "material needs a name");
  }
  if (name.text.empty() || std::any_of(name.text.begin(), name.text.end(), is_space)) {
    fail_at(name.place, "a material's name is one word");
  }
  if (find(*scene, name.text) >= 0) {
    fail_at(name.place, "there is a material ", quoted(name.text), " already");
  }
  SceneText::NamedSurface result;
  result.name = name.text;
  result.place = name.place;
  Surface& surface = result.surface;
  Clauses clauses("material", &line);
  std::vector<Clause> known;
  bool has_kind = false;
  for (std::size_t kind = 0; kind < kThingKinds.size(); ++kind) {
    known.push_back({kThingKinds[kind], [&, kind](const Word& word) {
                       if (has_kind) {
                         fail_at(word.place, "a material has one kind; there is one already");
                       }
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
  Clauses clauses("box", &line);
  const auto corner = [&](const Word& word) {
    return line.three_wholes(std::string(word.text), -kSceneTextReach, kSceneTextReach);
  };
  clauses.read({{"from", [&](const Word& word) { part.low = corner(word); }},
                {"to", [&](const Word& word) { part.high = corner(word); }}});
  clauses.need("from");
  clauses.need("to");
  if (VoxelBox{part.low, part.high}.empty()) {
    fail_at(place, "this box holds no voxel: each number after to must be above the one after from");
  }
}

void ball(TextLine& line, TextPlace place, SceneText* scene) {
  SceneText::Part& part = add_part(scene, SceneText::PartKind::kBall, place);
  part.material = named_material(line, *scene, "ball");
  Clauses clauses("ball", &line);
  clauses.read(
      {{"at",
        [&](const Word&) { part.center = to_q8(line.three_reals("at", -kSceneTextReach, kSceneTextReach)); }},
       {"radius", [&](const Word&) { part.radius_q8 = to_fixed(line.real("radius", 1, 4096), Q8::kOne); }}});
  clauses.need("at");
  clauses.need("radius");
}

void model(TextLine& line, TextPlace place, SceneText* scene) {
  SceneText::Part& part = add_part(scene, SceneText::PartKind::kModel, place);
  const Word file = line.word();
  if (file.text.empty()) {
    fail_at(file.place, "model needs the name of a file or a generator");
  }
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

}  // namespace thimble::tools::statements
