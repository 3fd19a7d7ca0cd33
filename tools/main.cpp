// The `thimble` command: chooses the subcommand and turns every failure into one sentence and a status, 1 for
// input and output that cannot be used, 2 for wrong usage.
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include <CLI/CLI.hpp>

#include "commands/commands.h"
#include "output/output_file.h"
#include "readers/source.h"

namespace {

constexpr int kInputStatus = 1;
constexpr int kUsageStatus = 2;

extern "C" void clean_up_and_die(int signal_number) {
  thimble::tools::discard_unfinished_output();
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGINT, clean_up_and_die);
  std::signal(SIGTERM, clean_up_and_die);
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is an error of the write, with a sentence

  CLI::App app(
      "Thimble: a voxel ray tracer in a fixed block of memory.\nThe same picture, bit for bit, on every "
      "machine.",
      "thimble");
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  thimble::tools::add_all_commands(app);
  // The file that an input error is about, for the sentence: the subcommand's first argument.
  const auto subject = [&]() -> std::string {
    for (const CLI::App* command : app.get_subcommands()) {
      if (const CLI::Option* scene = command->get_option_no_throw("scene");
          scene != nullptr && scene->count() > 0) {
        return scene->results().front() + ": ";
      }
    }
    return {};
  };
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    app.exit(error, std::cout, std::cerr);
    return error.get_exit_code() == 0 ? 0 : kUsageStatus;
  } catch (const thimble::tools::InputError& error) {
    std::fprintf(stderr, "thimble: %s%s\n", subject().c_str(), error.what());
  } catch (const thimble::tools::OutputError& error) {
    std::fprintf(stderr, "thimble: %s\n", error.what());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "thimble: %snot enough memory on this machine\n", subject().c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "thimble: %s%s\n", subject().c_str(), error.what());
  }
  return kInputStatus;
}
