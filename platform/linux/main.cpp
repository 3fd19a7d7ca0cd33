// thimble-fb: an application of Thimble on a Linux framebuffer, without a window system.
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "apps/app_table.h"
#include "linux/console.h"
#include "linux/session.h"

namespace {

using namespace thimble;

// The command line.
struct Options {
  std::string scene;  // empty: none
  std::string app = "demo";
  std::string device = "/dev/fb0";
  std::string input = "/dev/input";
  std::string stand_in;     // a file in place of the device
  std::vector<int> layout;  // of the stand-in: width, height, bits a pixel, stride
  std::vector<int> size;    // of the picture, in pixels; empty: the largest that is magnified 4 times
  uint64_t memory = uint64_t{256} << 10;
  uint32_t frames = 0;  // 0: until asked to end
};

int complain(const std::string& sentence) {
  fprintf(stderr, "thimble-fb: %s\n", sentence.c_str());
  return 1;
}

std::string application_names() {
  std::string names;
  for (const apps::Application& application : apps::applications()) {
    names += (names.empty() ? "" : ", ") + std::string(application.name);
  }
  return names;
}

// Empty, or a sentence.
std::string read_file(const std::string& path, std::vector<uint8_t>* bytes) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return "cannot open " + path;
  }
  bytes->assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  return file.bad() ? "cannot read " + path : "";
}

int run(const Options& options) {
  const apps::Application* application = apps::find_application(options.app.c_str());
  if (application == nullptr) {
    return complain("there is no application " + options.app + "; there are " + application_names());
  }
  std::vector<uint8_t> scene;
  if (!options.scene.empty()) {
    if (const std::string fault = read_file(options.scene, &scene); !fault.empty()) {
      return complain(fault);
    }
  }
  linux_port::Framebuffer framebuffer;
  const std::string fault =
      options.stand_in.empty()
          ? framebuffer.open_device(options.device)
          : framebuffer.open_stand_in(
                options.stand_in,
                linux_port::usual_layout(options.layout[0], options.layout[1],
                                         static_cast<size_t>(options.layout[3]), options.layout[2]));
  if (!fault.empty()) {
    return complain(fault);
  }
  const linux_port::Layout& layout = framebuffer.layout();

  linux_port::Session session;
  session.framebuffer = &framebuffer;
  port::Display& display = session.facts.display;
  display.width_px = options.size.empty() ? std::max(1, layout.width_px / 4) : options.size[0];
  display.height_px = options.size.empty() ? std::max(1, layout.height_px / 4) : options.size[1];
  display.format = PixelFormat::kRgb888;
  display.connected = true;
  session.placement = linux_port::place(display.width_px, display.height_px, layout);
  if (session.placement.scale < 1) {
    return complain("a picture of " + std::to_string(display.width_px) + " x " +
                    std::to_string(display.height_px) + " does not fit a screen of " +
                    std::to_string(layout.width_px) + " x " + std::to_string(layout.height_px));
  }
  std::vector<uint64_t> memory(static_cast<size_t>((options.memory + 7) / 8));
  session.arena = Bytes(reinterpret_cast<uint8_t*>(memory.data()), static_cast<size_t>(options.memory));
  session.scene = ConstBytes(scene.data(), scene.size());
  session.facts.name = "linux framebuffer";
  session.facts.ram_bytes = static_cast<uint32_t>(options.memory);
  session.facts.flash_bytes = static_cast<uint32_t>(scene.size());
  session.facts.stack_bytes = 256 << 10;
  session.most_frames = options.frames;
  linux_port::Keys keys;
  keys.open_all(options.input);
  session.keys = &keys;

  linux_port::take_console();
  framebuffer.clear();
  const char* why = nullptr;
  const int status = linux_port::run(session, application->run, &why);
  if (options.stand_in.empty()) {
    framebuffer.clear();
  }
  linux_port::restore_console();
  return why != nullptr ? complain(why) : status;
}

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

int main(int argc, char** argv) {
  Options options;
  CLI::App program("", "thimble-fb");
  describe(&program, application_names(), &options);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  }
  return run(options);
}
