#include "commands/effect_options.h"

#include "commands/arguments.h"

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

}  // namespace

void EffectOptions::add_to(CLI::App& app, const std::string& more) {
  add_text_option(
      app, "--effects", "auto|none|LIST",
      [this](const std::string& text) {
        const auto parsed = parse_effects(text);
        choice = parsed.value_or(EffectChoice{});
        given = true;
        return parsed ? "" : "is not auto, none or a list such as shadows,sky of " + effect_names();
      },
      "what light does: auto (what the scene's materials, lights, water and sky call for), none, or with "
      "commas between them any of " +
          spaced_names() + more)
      .default_str("auto");
  add_whole_option(
      app, "--bounces", "N", 0, kMaxBounces,
      [this](std::int64_t number) { bounces = static_cast<std::uint8_t>(number); },
      "rays that follow one another from a pixel by mirrors, glass and water, 0 to " +
          std::to_string(kMaxBounces) + " (default: the scene's own, else " +
          std::to_string(kDefaultBounces) + ")");
}

LitDescription EffectOptions::lighting(const SceneSource& source) const {
  LitDescription lit = source.lighting();
  lit.rest.bounces = bounces.value_or(lit.rest.bounces);
  return lit;
}

}  // namespace thimble::tools
