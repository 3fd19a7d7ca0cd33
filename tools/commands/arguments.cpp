#include "commands/arguments.h"

#include <cmath>

#include "scene/named_scenes.h"

namespace thimble::tools {
namespace {

// A subcommand that keeps what is looked at before it acts.
class Subcommand : public CLI::App {
 public:
  Subcommand(CLI::App& parent, const std::string& name, const std::string& description)
      : CLI::App(description, name, &parent) {}
  std::vector<std::function<void()>> checks;
};

constexpr std::size_t kHelpColumn = 30;
constexpr char kOffered[] = "offered";  // the name of a check that keeps words

std::string entry(const std::string& label, const std::string& text) {
  std::string out = "  " + label;
  if (out.size() + 2 > kHelpColumn) {
    out += '\n' + std::string(kHelpColumn, ' ');
  } else {
    out.resize(kHelpColumn, ' ');
  }
  return out + wrapped(text, kHelpColumn) + '\n';
}

class HelpFormatter final : public CLI::Formatter {
 public:
  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), 0) + "\n\n";
  }
  std::string make_subcommand(const CLI::App* sub) const override {
    return entry(sub->get_name(), sub->get_description());
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    return entry(label_of(*option, is_positional), description_of(*option, is_positional));
  }
  std::string make_usage(const CLI::App* app, std::string name) const override {
    std::string usage = "Usage: " + name;
    for (const CLI::Option* option :
         app->get_options([](const CLI::Option* o) { return o->get_required(); })) {
      usage += " ";
      if (!option->get_positional()) {
        usage += option->get_name().substr(0, option->get_name().find(',')) + " ";
      }
      usage += option->get_type_name();
    }
    usage += " [OPTIONS]";
    if (!app->get_subcommands({}).empty()) {
      usage = "Usage: " + name + " SUBCOMMAND [OPTIONS]";
    }
    return usage + "\n";
  }
};

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

std::string wrapped(const std::string& text, std::size_t column, std::size_t width) {
  std::string out;
  std::size_t used = column;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::size_t length = end - at;
    if (used > column && used + 1 + length > width) {
      out += '\n' + std::string(column, ' ');
      used = column;
    } else if (used > column) {
      out += ' ';
      ++used;
    }
    out.append(text, at, length);
    used += length;
    at = end + 1;
  }
  return out;
}

std::optional<std::int64_t> parse_whole(std::string_view text, std::int64_t low, std::int64_t high) {
  const auto number = number_in<std::int64_t>(text);
  return number && *number >= low && *number <= high ? number : std::nullopt;
}

std::optional<double> parse_real(std::string_view text) {
  const auto number = number_in<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

bool parse_reals(std::string_view text, std::span<double> numbers) {
  const std::vector<std::string> words = CLI::detail::split(std::string(text) + ',', ',');
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto parsed = words.size() == numbers.size() ? parse_real(words[i]) : std::nullopt;
    if (!parsed) {
      return false;
    }
    numbers[i] = *parsed;
  }
  return true;
}

std::optional<std::pair<std::int32_t, std::int32_t>> parse_pair(std::string_view text, char between,
                                                                std::int32_t low, std::int32_t most) {
  const std::size_t middle = text.find(between);
  const auto first = parse_whole(text.substr(0, middle), low, most);
  const auto second =
      middle == std::string_view::npos ? std::nullopt : parse_whole(text.substr(middle + 1), 1, most);
  if (!first || !second) {
    return std::nullopt;
  }
  return std::pair{static_cast<std::int32_t>(*first), static_cast<std::int32_t>(*second)};
}

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description) {
  return app.add_subcommand(std::make_shared<Subcommand>(app, name, description));
}

void add_paragraph_below(CLI::App& command, const std::string& text) {
  command.footer("\n" + wrapped(text, 0));
}

void when_chosen(CLI::App& command, std::function<void()> action) {
  command.callback([&command, action = std::move(action)] {
    for (const auto& check : dynamic_cast<const Subcommand&>(command).checks) {
      check();
    }
    action();
  });
}

void also_check(CLI::App& command, std::function<void()> check) {
  dynamic_cast<Subcommand&>(command).checks.push_back(std::move(check));
}

void add_flag(CLI::App& app, const std::string& name, bool* flag, const std::string& help) {
  app.add_flag(name, *flag, help)->disable_flag_override();
}

CLI::Option* add_text_option(CLI::App& app, const std::string& name, const std::string& type_name,
                             std::function<std::string(const std::string&)> take, const std::string& help) {
  const std::size_t comma = name.find(',');
  const std::string shown = comma == std::string::npos ? name : name.substr(comma + 1);
  const auto check = [shown, take = std::move(take)](const std::string& text) {
    const std::string fault = take(text);
    refuse_if(!fault.empty(), shown, ": ", in_quotes(text), " ", fault);
  };
  return app.add_option_function<std::string>(name, check, help)->type_name(type_name);
}

CLI::Option* add_real_option(CLI::App& app, const std::string& name, const std::string& type_name, double low,
                             double high, const std::function<void(double)>& take, const std::string& help) {
  return add_text_option(
      app, name, type_name,
      [=](const std::string& text) -> std::string {
        const auto number = parse_real(text);
        if (!number || *number < low || *number > high) {
          return "is not a number from " + shortest(low) + " to " + shortest(high);
        }
        take(*number);
        return {};
      },
      help);
}

CLI::Option* add_real_option(CLI::App& app, const std::string& name, const std::string& type_name, double low,
                             double high, double* to, const std::string& help) {
  return add_real_option(
             app, name, type_name, low, high, [to](double number) { *to = number; }, help)
      ->default_str(shortest(*to));
}

CLI::Option* add_choice_option(CLI::App& app, const std::string& name, const std::vector<std::string>& words,
                               std::function<void(std::size_t)> take, const std::string& help) {
  return add_text_option(
      app, name, joined(words, "|"),
      [words, take = std::move(take)](const std::string& text) -> std::string {
        const auto found = std::find(words.begin(), words.end(), CLI::detail::to_lower(text));
        if (found == words.end()) {
          std::string fault = "is not ";
          for (std::size_t i = 0; i < words.size(); ++i) {
            fault += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
          }
          return fault;
        }
        take(static_cast<std::size_t>(found - words.begin()));
        return {};
      },
      help);
}

CLI::Option* add_path_option(CLI::App& app, const std::string& name, const std::string& type_name,
                             std::string* path, const std::string& help) {
  return add_text_option(
      app, name, type_name,
      [path](const std::string& text) -> std::string {
        *path = text;
        return text.empty() ? "is not a file's name" : "";
      },
      help);
}

CLI::Option* add_output_option(CLI::App& app, const std::string& name, const std::string& type_name,
                               std::string* path, bool (*takes)(const std::string& path),
                               const std::string& endings, const std::string& help) {
  return add_text_option(
      app, name, type_name,
      [=](const std::string& text) {
        *path = text;
        return takes(text) ? std::string() : "does not end in " + endings;
      },
      help);
}

bool names_y4m(const std::string& path) {
  return path.size() > 4 && path.ends_with(".y4m");
}

bool takes_svg(const std::string& path) {
  const FilePlace place(path);
  return ends_in("/" + path, ".svg") || path == "-" || place.is_descriptor ||
         (place.error == 0 && !S_ISREG(place.info.st_mode));
}

bool is_given(const CLI::App& app, const std::string& name) {
  const CLI::Option* const option = app.get_option_no_throw(name);
  return option != nullptr && option->count() != 0;
}

std::string text_given(const CLI::App& app, const std::string& name) {
  return is_given(app, name) ? CLI::detail::to_lower(app.get_option(name)->results().back()) : "";
}

std::vector<std::string> options_given(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() != 0) {
      names.push_back(option->get_name());
    }
  }
  return names;
}

CLI::Validator offering(const std::vector<std::string>& words) {
  // A check that is never made, which the help does not show.
  return CLI::Validator(joined(words, "|")).name(kOffered).active(false);
}

std::vector<std::string> words_offered(CLI::Option* option) {
  std::string text = option->get_type_name();
  try {
    CLI::Validator* kept = option->get_validator(kOffered);
    text = kept->active(true).get_description();
    kept->active(false);
  } catch (const CLI::OptionNotFound&) {
    // None were given.
  }
  std::vector<std::string> words;
  if (text.starts_with("FILE")) {
    return words;  // FILE.csv|.npy
  }
  for (const std::string& word : CLI::detail::split(text, '|')) {
    const bool is_name = std::none_of(word.begin(), word.end(), [](char c) { return c >= 'a' && c <= 'z'; });
    if (text.find('|') != std::string::npos && !(is_name && CLI::detail::to_lower(word) != word)) {
      words.push_back(word);
    }
  }
  return words;
}

std::string label_of(const CLI::Option& option, bool is_argument) {
  std::string label = is_argument ? option.get_type_name() : option.get_name(false, true);
  const std::size_t comma = label.find(',');
  if (comma != std::string::npos) {
    label.insert(comma + 1, " ");
  }
  if (!is_argument && option.get_type_size() != 0) {
    label += " " + option.get_type_name();
  }
  return label;
}

std::string description_of(const CLI::Option& option, bool is_argument) {
  std::string text = option.get_description();
  if (!option.get_default_str().empty()) {
    text += " (default: " + option.get_default_str() + ")";
  }
  if (option.get_required() && !is_argument) {
    text += " (required)";
  }
  return text;
}

std::shared_ptr<CLI::FormatterBase> help_formatter() {
  return std::make_shared<HelpFormatter>();
}

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) {
    names.push_back(command->get_name());
  }
  return names;
}

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
