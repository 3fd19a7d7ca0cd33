/// @file arguments.h
/// Command-line options whose errors are sentences, and help that fits a terminal. The subcommands add their
/// options through these instead of CLI11's typed ones, which accept NaN and print limits with 300 digits.
#ifndef THIMBLE_TOOLS_COMMANDS_ARGUMENTS_H
#define THIMBLE_TOOLS_COMMANDS_ARGUMENTS_H

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace CLI {
class App;
class FormatterBase;
class Option;
}  // namespace CLI

namespace thimble::tools {

/// `text` as a whole number of low .. high: digits and an optional minus, nothing else.
std::optional<std::int64_t> parse_whole(std::string_view text, std::int64_t low, std::int64_t high);
/// `text` as a finite number.
std::optional<double> parse_real(std::string_view text);

/// An option whose text goes to `take`; what `take` returns, unless empty, is what is wrong with it, and
/// completes the sentence `--name: "text" ...`.
CLI::Option* add_text_option(CLI::App& app, const std::string& name, const std::string& type_name,
                             std::function<std::string(const std::string&)> take, const std::string& help);

/// An option that is a whole number of low .. high.
CLI::Option* add_whole_option(CLI::App& app, const std::string& name, const std::string& type_name,
                              std::int64_t low, std::int64_t high,
                              const std::function<void(std::int64_t)>& take, const std::string& help);

/// An option that is one of a few words, in any case. `take` gets the index into `words`.
CLI::Option* add_choice_option(CLI::App& app, const std::string& name, const std::vector<std::string>& words,
                               std::function<void(std::size_t)> take, const std::string& help);

/// The path of a file.
CLI::Option* add_path_option(CLI::App& app, const std::string& name, const std::string& type_name,
                             std::string* path, const std::string& help);

/// Help in lines of at most 100 characters.
std::shared_ptr<CLI::FormatterBase> help_formatter();

}  // namespace thimble::tools

#endif
