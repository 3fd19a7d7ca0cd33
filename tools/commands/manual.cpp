// thimble manual: the man page, from the same description as --help. The build writes it to share/man.
#include "commands/commands.h"
#include "output/version.h"
#include "scene/named_scenes.h"

namespace thimble::tools {
namespace {

// `text` so that roff prints it as it stands, wherever in a line it comes.
std::string plain(const std::string& text) {
  constexpr std::array<std::pair<char, const char*>, 6> kEscapes{
      {{'\\', "\\e"}, {'-', "\\-"}, {'\'', "\\(aq"}, {'`', "\\(ga"}, {'^', "\\(ha"}, {'~', "\\(ti"}}};
  std::string out = text.starts_with('.') ? "\\&" : "";  // else it would be a request
  for (const char c : text) {
    const auto* const escape =
        std::find_if(kEscapes.begin(), kEscapes.end(), [c](const auto& each) { return each.first == c; });
    out += escape == kEscapes.end() ? std::string(1, c) : escape->second;
  }
  return out;
}

// In lines of at most 80 characters, about, as sources of manuals are.
std::string paragraph(const std::string& text) {
  std::string out;
  for (const std::string& line : CLI::detail::split(wrapped(text, 0, 71), '\n')) {
    out += plain(line) + "\n";
  }
  return out;
}

std::string option_entry(const CLI::Option& option, bool is_argument) {
  std::string label = label_of(option, is_argument);
  std::string value;
  const std::size_t blank = label.find_last_of(' ');
  if (!is_argument && !option.get_type_name().empty()) {
    value = " \\fI" + plain(label.substr(blank + 1)) + "\\fR";
    label = label.substr(0, blank);
  }
  return ".TP\n\\fB" + plain(label) + "\\fR" + value + "\n" + paragraph(description_of(option, is_argument));
}

std::string entries_of(const CLI::App& app, bool with_help) {
  std::string text;
  for (const CLI::Option* option : app.get_options()) {
    const bool is_argument = option->get_positional();
    if (with_help || option != app.get_help_ptr()) {
      text += option_entry(*option, is_argument);
    }
  }
  return text;
}

std::string manual(const CLI::App& app) {
  std::string text = std::string(".TH THIMBLE 1 \"") + kVersionDate + "\" \"thimble " + kVersionNumber +
                     "\" \"User Commands\"\n.ad l\n"
                     ".SH NAME\nthimble \\- draws voxels exactly, in a fixed block of memory\n"
                     ".SH SYNOPSIS\n.B thimble\n.I SUBCOMMAND\n.RI [ OPTIONS ]\n"
                     ".SH DESCRIPTION\n" +
                     paragraph(app.get_description()) +
                     ".SH OPTIONS\nEach subcommand has\n.B \\-\\-help\nas well.\n" + entries_of(app, true) +
                     ".SH SUBCOMMANDS\n";
  for (const CLI::App* command :
       app.get_subcommands([](const CLI::App* sub) { return !sub->get_group().empty(); })) {
    std::string usage = "thimble " + command->get_name();
    for (const CLI::Option* option : command->get_options()) {
      if (option->get_positional()) {
        usage +=
            option->get_required() ? " " + option->get_type_name() : " [" + option->get_type_name() + "]";
      }
    }
    text +=
        ".SS " + plain(usage) + "\n" + paragraph(command->get_description()) + entries_of(*command, false);
  }
  text +=
      ".SH SCENES\nThese come with Thimble and are found by name, where the current folder has no such "
      "file:\n";
  const std::string names = joined(scene_names(), ", ");
  text += paragraph(names.empty() ? "none are installed" : names) +
          ".SH EXIT STATUS\n"
          ".TP\n0\nsuccess\n"
          ".TP\n1\ninput or output that cannot be used; a sentence on standard error says where\n"
          ".TP\n2\nwrong usage\n";
  return text;
}

}  // namespace

void add_manual(CLI::App& app) {
  CLI::App* sub = add_command(app, "manual", "prints this command's manual page, for man");
  sub->group("");
  when_chosen(*sub, [&app] {
    const std::string text = manual(app);
    std::fwrite(text.data(), 1, text.size(), stdout);
  });
}

}  // namespace thimble::tools
