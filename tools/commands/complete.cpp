// thimble complete: what a shell completes a word to, from the same description as --help. Its callers are the
// scripts of tools/completions.
//
// The argument is the command line up to the cursor, a word a line, the program's name first. A line of the answer
// is a word, a tab and what it means; the line /files stands for names of files, which the shell knows better.
#include "commands/commands.h"
#include "scene/generators.h"
#include "scene/named_scenes.h"

namespace thimble::tools {
namespace {

using Words = std::vector<std::string>;

// The first thought of a description.
std::string brief(const std::string& text) {
  std::string out = text;
  for (const char* mark : {";", ":", " (", ", "}) {
    const std::size_t end = out.find(mark);
    if (end != std::string::npos && end > 20) {
      out.resize(end);
    }
  }
  return out;
}

// Offers `candidate` where it begins with `word`.
void offer(const std::string& word, const std::string& candidate, const std::string& meaning) {
  if (candidate.starts_with(word)) {
    std::printf("%s\t%s\n", candidate.c_str(), brief(meaning).c_str());
  }
}

constexpr const char* kFiles = "/files";

void offer_scenes(const std::string& before, const std::string& word) {
  for (const std::string& name : scene_names()) {
    offer(word, before + name, "a scene that comes with Thimble");
  }
  for (const std::string& example : generator_examples()) {
    offer(word, before + example, "a generator");
  }
  std::puts(kFiles);
}

// What may follow `before`, which is empty or "--option=".
void offer_values(CLI::Option* option, const std::string& before, const std::string& word) {
  const std::string type = option->get_type_name();
  const Words words = words_offered(option);
  // A list is completed behind its last comma.
  std::string start = before;
  if (type.find("LIST") != std::string::npos) {
    const std::size_t comma = word.find_last_of(',');
    start += comma == std::string::npos ? "" : word.substr(before.size(), comma + 1 - before.size());
  }
  for (const std::string& each : words) {
    offer(word, start + each, "");
  }
  if (type == "SCENE") {
    offer_scenes(before, word);
  } else if (words.empty() && (type.find("FILE") != std::string::npos || type == "SCRIPT" || type == "REF" ||
                               type == "LOG" || type == "DIR" || type == "FOLDER")) {
    std::puts(kFiles);
  }
}

CLI::Option* option_named(CLI::App& command, const std::string& name) {
  return name.starts_with("-") ? command.get_option_no_throw(name) : nullptr;
}

CLI::App* subcommand_named(CLI::App& app, const std::string& name) {
  const auto found = app.get_subcommands([&name](const CLI::App* each) { return each->get_name() == name; });
  return found.empty() ? nullptr : found.front();
}

void offer_options(CLI::App& command, const Words& given, const std::string& prefix) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) {
      continue;
    }
    const bool was_given = std::any_of(
        given.begin(), given.end(), [option](const std::string& word) { return option->check_name(word); });
    for (const std::string& name : option->get_lnames()) {
      if (!was_given) {
        offer(prefix, "--" + name, option->get_description());
      }
    }
  }
}

CLI::Option* argument_of(CLI::App& command) {
  const auto options = command.get_options([](CLI::Option* option) { return option->get_positional(); });
  return options.empty() ? nullptr : options.front();
}

void complete(CLI::App& app, Words words) {
  std::string word = words.back();
  words.pop_back();
  // Bash makes three words of --size=12.
  if (word == "=") {
    word.clear();
  } else if (words.size() > 1 && words.back() == "=") {
    words.pop_back();
  }
  CLI::App* command = nullptr;
  for (std::size_t i = 1; i < words.size() && command == nullptr; ++i) {
    command = subcommand_named(app, words[i]);
  }
  if (command == nullptr) {
    if (word.starts_with("-")) {
      offer_options(app, words, word);
      return;
    }
    for (const CLI::App* sub :
         app.get_subcommands([](CLI::App* each) { return !each->get_group().empty(); })) {
      offer(word, sub->get_name(), sub->get_description());
    }
    if (subcommand_named(app, "view") != nullptr) {
      offer_scenes("", word);  // `thimble SCENE` is short for it
    }
    return;
  }
  const std::size_t equals = word.find('=');
  if (CLI::Option* last = option_named(*command, words.back());
      last != nullptr && !last->get_type_name().empty() && words.size() > 2) {
    offer_values(last, "", word);
  } else if (CLI::Option* named =
                 equals == std::string::npos ? nullptr : option_named(*command, word.substr(0, equals));
             named != nullptr) {
    offer_values(named, word.substr(0, equals + 1), word);
  } else if (word.starts_with("-")) {
    offer_options(*command, words, word);
  } else if (CLI::Option* argument = argument_of(*command); argument != nullptr) {
    offer_values(argument, "", word);
  }
}

}  // namespace

void add_complete(CLI::App& app) {
  CLI::App* sub =
      add_command(app, "complete", "prints what the last word of a command line may become, for shells");
  sub->group("");
  auto line = std::make_shared<std::string>();
  sub->add_option("words", *line, "the words up to the cursor, a line each")->type_name("WORDS")->required();
  // A last line that is empty is a word, too.
  when_chosen(*sub, [&app, line] { complete(app, CLI::detail::split(*line + '\n', '\n')); });
}

}  // namespace thimble::tools
