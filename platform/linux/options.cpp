#include "linux/options.h"

#include <CLI/CLI.hpp>

namespace thimble::linux_port {
namespace {

void describe(CLI::App* program, const std::string& apps, Options* options) {
  program->description("Runs an application of Thimble on a Linux framebuffer: arrows move, q ends.");
  program->add_option("SCENE", options->scene, "a baked scene (thimble bake SCENE -o F.oct)");
  program->add_option("--app", options->app, apps)->capture_default_str();
  program->add_option("--device", options->device, "the framebuffer")->capture_default_str();
  program->add_option("--input", options->input, "folder of the input devices")->capture_default_str();
  CLI::Option* stand_in =
      program->add_option("--stand-in", options->stand_in, "a file to draw into instead of a device");
  CLI::Option* layout =
      program->add_option("--layout", options->layout, "of the stand-in: width,height,bits,stride");
  layout->delimiter(',')->expected(4)->check(CLI::Range(1, 1 << 20));
  stand_in->needs(layout);
  layout->needs(stand_in);
  program
      ->add_option("--size", options->size,
                   "pixels of the picture: width,height (the largest that is magnified 4 times)")
      ->delimiter(',')
      ->expected(2)
      ->check(CLI::Range(1, 16384));
  program->add_option("--memory", options->memory, "bytes for the application")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 32))
      ->capture_default_str();
  program->add_option("--frames", options->frames, "end after so many; 0: when asked to")
      ->capture_default_str();
}

}  // namespace

std::optional<int> read_options(int argc, char** argv, const std::string& apps, Options* options) {
  CLI::App program("", "thimble-fb");
  describe(&program, apps, options);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  }
  return std::nullopt;
}

}  // namespace thimble::linux_port
