// What is said of a command line that makes no sense.
#include <string>
#include <vector>

#include "commands/arguments.h"
#include "output/units.h"
#include "scene/named_scenes.h"

namespace thimble::tools {

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) {
    names.push_back(command->get_name());
  }
  return names;
}

namespace {

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      names.push_back("--" + name);
    }
  }
  return names;
}

// What the first argument may be: a subcommand, or the name of a scene.
std::vector<std::string> first_words(const CLI::App& app) {
  std::vector<std::string> words = subcommand_names(app);
  const std::vector<std::string> scenes = scene_names();
  words.insert(words.end(), scenes.begin(), scenes.end());
  return words;
}

}  // namespace

std::string usage_sentence(const CLI::App& app, const CLI::ParseError& error, const std::string& first) {
  const auto chosen = app.get_subcommands();
  const std::string command = chosen.empty() ? "thimble" : "thimble " + chosen.front()->get_name();
  const std::string advice = "; " + command + " --help lists what there is";
  if (chosen.empty()) {
    return first.starts_with("-")
               ? in_quotes(first) + " is not an option here" + suggestion(first, option_names(app)) + advice
               : in_quotes(first) + " is neither a subcommand nor a file" +
                     suggestion(first, first_words(app)) + advice;
  }
  const std::vector<std::string> extras = app.remaining(true);
  // What is required may be missing because it follows an option that is not there.
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
      dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) {
    for (const std::string& extra : extras) {
      if (extra == "--") {
        break;  // what follows it is no option
      }
      if (extra.size() > 1 && extra.starts_with("-")) {
        const std::string name = extra.substr(0, extra.find('='));
        return in_quotes(extra) + " is not an option of " + command +
               suggestion(name, option_names(*chosen.front())) + advice;
      }
    }
    if (!extras.empty() && dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
      const bool is_marked = extras.front() == "--" && extras.size() > 1;
      return in_quotes(extras[is_marked ? 1 : 0]) + " is one argument too many" + advice;
    }
  }
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    const std::string text = error.what();
    const std::size_t flag_end = text.find(" was given a disallowed flag override");
    if (flag_end != std::string::npos) {
      return "--" + text.substr(0, flag_end) + " takes no value" + advice;
    }
    const std::string name = text.substr(0, text.find(':'));
    const bool twice =
        text.find("received") != std::string::npos && text.find("At Most") != std::string::npos;
    return name + (twice ? " is given more than once" : " needs a value") + advice;
  }
  const std::string text = error.what();
  return (text == "scene is required"   ? "SCENE is required"
          : text == "parts is required" ? "PARTS are required"
                                        : text) +
         advice;
}

}  // namespace thimble::tools
