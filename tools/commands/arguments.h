/// Command-line options whose errors are sentences, and help that fits a terminal. The subcommands add their
/// options through these instead of CLI11's typed ones, which accept NaN and print limits with 300 digits. What a command
/// says and writes comes with it: words, numbers, files and bars.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "output/output_file.h"
#include "output/progress.h"
#include "output/units.h"
#include "readers/input_error.h"

namespace thimble::tools {

/// `text` as a whole number of low .. high: digits and an optional minus, nothing else.
std::optional<std::int64_t> parse_whole(std::string_view text, std::int64_t low, std::int64_t high);
/// `text` as a finite number.
std::optional<double> parse_real(std::string_view text);
/// "1,2.5,-3" as finite numbers, as many as there is room for.
bool parse_reals(std::string_view text, std::span<double> numbers);
/// "800x600" and the like: two whole numbers up to `most` with `between` between them, the second from 1 on.
std::optional<std::pair<std::int32_t, std::int32_t>> parse_pair(std::string_view text, char between,
                                                                std::int32_t low, std::int32_t most);

/// A subcommand of `app`, which keeps it.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description);
/// A paragraph below the options in the help of `command`, wrapped as the rest.
void add_paragraph_below(CLI::App& command, const std::string& text);
/// What the subcommand does, once all options are read.
void when_chosen(CLI::App& command, std::function<void()> action);
/// What its options are kept in, by the subcommand, and given to `run`.
template <class Options>
Options* options_for(CLI::App& command, std::type_identity_t<void (*)(const Options&)> run) {
  const auto options = std::make_shared<Options>();
  when_chosen(command, [options, run] { run(*options); });
  return options.get();
}
/// What is looked at before that: options that are sound one by one and make no sense together. `check` calls
/// refuse_if.
void also_check(CLI::App& command, std::function<void()> check);

/// An option without a value: `flag` becomes true.
void add_flag(CLI::App& app, const std::string& name, bool* flag, const std::string& help);

/// An option whose text goes to `take`; what `take` returns, unless empty, is what is wrong with it, and
/// completes the sentence `--name: "text" ...`.
CLI::Option* add_text_option(CLI::App& app, const std::string& name, const std::string& type_name,
                             std::function<std::string(const std::string&)> take, const std::string& help);

/// An option that is a whole number of low .. high, kept where `to` says: in a whole number, or an optional one. Its
/// default is what `to` holds, unless that is below `low`: then there is none.
template <class Number>
CLI::Option* add_whole_option(CLI::App& app, const std::string& name, const std::string& type_name,
                              std::int64_t low, std::int64_t high, Number* to, const std::string& help) {
  const auto take = [=](const std::string& text) -> std::string {
    const auto number = parse_whole(text, low, high);
    if (!number) {
      return concat("is not a whole number from ", low, " to ", high);
    }
    if constexpr (std::is_integral_v<Number>) {
      *to = static_cast<Number>(*number);
    } else {
      *to = static_cast<typename Number::value_type>(*number);
    }
    return {};
  };
  CLI::Option* const option = add_text_option(app, name, type_name, take, help);
  if constexpr (std::is_integral_v<Number>) {
    option->default_str(std::cmp_less(*to, low) ? "" : std::to_string(*to));
  }
  return option;
}

/// An option that is a finite number of low .. high.
CLI::Option* add_real_option(CLI::App& app, const std::string& name, const std::string& type_name, double low,
                             double high, const std::function<void(double)>& take, const std::string& help);
/// The same, kept in `to`, which holds its default.
CLI::Option* add_real_option(CLI::App& app, const std::string& name, const std::string& type_name, double low,
                             double high, double* to, const std::string& help);

/// An option that is one of a few words, in any case. `take` gets the index into `words`.
CLI::Option* add_choice_option(CLI::App& app, const std::string& name, const std::vector<std::string>& words,
                               std::function<void(std::size_t)> take, const std::string& help);

/// The same; `to` gets what stands beside the word. What it holds is the default, where there is a word for that.
template <class Value>
CLI::Option* add_choice_option(
    CLI::App& app, const std::string& name,
    const std::vector<std::pair<std::string, std::type_identity_t<Value>>>& choices, Value* to,
    const std::string& help) {
  std::vector<std::string> words;
  std::string usual;
  for (const auto& [word, value] : choices) {
    words.push_back(word);
    usual = usual.empty() && value == *to ? word : usual;
  }
  const auto take = [choices, to](std::size_t index) { *to = choices[index].second; };
  return add_choice_option(app, name, words, take, help)->default_str(usual);
}

/// The same; `to` gets the word.
inline CLI::Option* add_choice_option(CLI::App& app, const std::string& name,
                                      const std::vector<std::string>& words, std::string* to,
                                      const std::string& help) {
  return add_choice_option(
             app, name, words, [words, to](std::size_t index) { *to = words[index]; }, help)
      ->default_str(*to);
}

/// The path of a file.
CLI::Option* add_path_option(CLI::App& app, const std::string& name, const std::string& type_name,
                             std::string* path, const std::string& help);

/// The same of one whose name `takes` accepts, which is what ends in `endings`.
CLI::Option* add_output_option(CLI::App& app, const std::string& name, const std::string& type_name,
                               std::string* path, bool (*takes)(const std::string& path),
                               const std::string& endings, const std::string& help);

/// Whether a name is one of moving pictures.
bool names_y4m(const std::string& path);
/// Whether a plot may go there: to a file of its ending, to standard output, a descriptor, a device or a pipe.
bool takes_svg(const std::string& path);

/// Whether `app` has such an option and the user gave it.
bool is_given(const CLI::App& app, const std::string& name);
/// What the user gave for it, in small letters; empty where he did not.
std::string text_given(const CLI::App& app, const std::string& name);
/// The names of all that the user gave.
std::vector<std::string> options_given(const CLI::App& app);

/// Ends the command as wrong usage (status 2) by a sentence of these pieces: "--name: ..." where it is about one option.
template <class... Pieces>
[[noreturn]] void refuse_usage(const Pieces&... pieces) {
  throw CLI::ValidationError(concat(pieces...));
}
/// The same where `is_wrong`.
template <class... Pieces>
void refuse_if(bool is_wrong, const Pieces&... pieces) {
  if (is_wrong) {
    refuse_usage(pieces...);
  }
}

/// What was wrong with the usage, as one sentence. `first`: the first argument.
std::string usage_sentence(const CLI::App& app, const CLI::ParseError& error, const std::string& first);
std::vector<std::string> subcommand_names(const CLI::App& app);

/// For CLI::Option::check: words that a shell completes the value to, besides those that the type's name tells.
CLI::Validator offering(const std::vector<std::string>& words);
/// What was given to offering(), else what the type's name tells: those words of `a|b|NAME` that are not in
/// capitals.
std::vector<std::string> words_offered(CLI::Option* option);
/// How the help shows an option: "-o, --output FILE", or an argument's "SCENE".
std::string label_of(const CLI::Option& option, bool is_argument);
/// Its description, with its default, and whether it must be given.
std::string description_of(const CLI::Option& option, bool is_argument);

/// `text` broken at blanks so that no line is wider than so many characters, the first one beginning at `column`, under
/// which the others begin.
std::string wrapped(const std::string& text, std::size_t column, std::size_t width = 100);
/// Help in lines of at most 100 characters.
std::shared_ptr<CLI::FormatterBase> help_formatter();

/// What is read besides the scene: its errors name the file.
template <class Read>
auto about(const std::string& path, const Read& read) {
  try {
    return read();
  } catch (const InputError& error) {
    throw OutputError(path + ": " + error.what());
  }
}

}  // namespace thimble::tools
