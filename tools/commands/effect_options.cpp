#include "commands/effect_options.h"

#include <sstream>
#include <vector>

#include "commands/arguments.h"
#include "output/suggestion.h"

namespace thimble::tools {
namespace {

// For help, which breaks lines at blanks.
std::string spaced_names() {
  std::string text;
  for (const char c : effect_names()) {
    text += c == ',' ? ", " : std::string(1, c);
  }
  return text;
}

std::vector<std::string> offered() {
  std::vector<std::string> words{"auto", "none", "all"};
  std::istringstream names(effect_names());
  for (std::string name; std::getline(names, name, ',');) {
    words.push_back(name);
  }
  return words;
}

// What is wrong with `text`, if anything.
std::string take_effects(const std::string& text, EffectChoice* choice) {
  const auto parsed = parse_effects(text);
  const std::optional<bool> smooth = choice->smooth;
  *choice = parsed.value_or(EffectChoice{});
  choice->smooth = smooth;
  if (parsed) {
    return {};
  }
  std::string nearest;
  std::istringstream names(text);
  for (std::string name; nearest.empty() && std::getline(names, name, ',');) {
    nearest = parse_effects(name) ? "" : suggestion(name, offered());
  }
  return "is not auto, none, all or a list such as shadows,sky of " + effect_names() + nearest;
}

void add_normals(CLI::App& app, EffectChoice* choice) {
  add_text_option(
      app, "--normals", "auto|face|smooth",
      [choice](const std::string& text) {
        choice->smooth.reset();
        if (text != "auto") {
          choice->smooth = text == "smooth";
        }
        return text == "auto" || text == "face" || text == "smooth" ? "" : "is not auto, face or smooth";
      },
      "what light sees: the faces of the voxels, the slope of the surface (the effect smooth-normals), or "
      "what "
      "the effects say")
      .default_str("auto");
}

}  // namespace

void add_effect_list(CLI::App& app, EffectChoice* choice, const std::string& help, bool names_default) {
  add_text_option(
      app, "--effects", "LIST", [choice](const std::string& text) { return take_effects(text, choice); },
      help)
      .default_str(names_default ? "auto" : "")
      .offers(offered());
  add_normals(app, choice);
}

void add_effect_options(CLI::App& app, EffectWishes* wishes, const std::string& more,
                        const std::string& usual) {
  add_text_option(
      app, "--effects", "auto|none|all|LIST",
      [wishes](const std::string& text) {
        wishes->given = true;
        return take_effects(text, &wishes->choice);
      },
      "what light does: auto (what the scene's materials, lights, water and sky call for), none, all (that, "
      "light, shadows, occlusion, glow and smooth normals), or with commas between them any of " +
          spaced_names() + more)
      .default_str(usual)
      .offers(offered());
  add_normals(app, &wishes->choice);
  add_whole_option(
      app, "--bounces", "N", 0, kMaxBounces,
      [wishes](std::int64_t number) { wishes->bounces = static_cast<std::uint8_t>(number); },
      "rays that follow one another from a pixel by mirrors, glass and water, 0 to " +
          std::to_string(kMaxBounces) + " (default: the scene's own, else " +
          std::to_string(kDefaultBounces) + ")");
}

}  // namespace thimble::tools
