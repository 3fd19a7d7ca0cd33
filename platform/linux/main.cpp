// thimble-fb: an application of Thimble on a Linux framebuffer, without a window system.
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <new>
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

constexpr int kUsageStatus = 2;

int complain(const std::string& sentence, int status = 1) {
  fprintf(stderr, "thimble-fb: %s\n", sentence.c_str());
  return status;
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
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    return path + " is no regular file";  // which may have no end
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return "cannot open " + path + ": " + strerror(errno);
  }
  bytes->resize(std::filesystem::file_size(path, error));
  file.read(reinterpret_cast<char*>(bytes->data()), static_cast<std::streamsize>(bytes->size()));
  return file ? "" : "cannot read " + path;
}

int run(const Options& options) {
  const apps::Application* application = apps::find_application(options.app.c_str());
  if (application == nullptr) {
    return complain("there is no application " + options.app + "; there are " + application_names(),
                    kUsageStatus);
  }
  std::vector<uint8_t> scene;
  if (!options.scene.empty()) {
    if (!application->wants_scene) {
      return complain("SCENE: \"" + options.scene + "\" is not for the application " + options.app +
                          ", which draws no scene",
                      kUsageStatus);
    }
    if (const std::string fault = read_file(options.scene, &scene); !fault.empty()) {
      return complain(fault);
    }
    std::error_code none;
    if (std::filesystem::equivalent(options.scene, options.stand_in, none)) {
      return complain(options.stand_in + " is the scene and would be overwritten");
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
  if (why == nullptr && status != 0) {
    // The application has said why, and does not know what its scene is called.
    return complain(options.app + (options.scene.empty() ? "" : " with " + options.scene) +
                        " ended with status " + std::to_string(status),
                    status);
  }
  return why != nullptr ? complain(why) : status;
}

void describe(CLI::App* program, const std::string& apps, Options* options) {
  program->description("Runs an application of Thimble on a Linux framebuffer: arrows move, q ends.");
  program->add_option("SCENE", options->scene, "a baked scene (thimble bake SCENE -o F.oct)");
  program->add_option("--app", options->app, apps)->type_name("NAME")->capture_default_str();
  program->add_option("--device", options->device, "the framebuffer")->capture_default_str();
  program->add_option("--input", options->input, "folder of the input devices")->capture_default_str();
  // Numbers with commas between them end with the word: what follows may be the scene.
  const auto numbers = [&](const char* name, std::vector<int>* to, int count, int most, const char* help) {
    return program->add_option(name, *to, help)
        ->delimiter(',')
        ->expected(count)
        ->allow_extra_args(false)
        ->check(CLI::Range(1, most));
  };
  CLI::Option* stand_in = program->add_option("--stand-in", options->stand_in,
                                              "to draw into instead of a device; --layout says how");
  CLI::Option* layout =
      numbers("--layout", &options->layout, 4, 1 << 20, "of the stand-in, in pixels and bytes");
  stand_in->needs(layout)->option_text("FILE");
  layout->needs(stand_in)->option_text("WIDTH,HEIGHT,BITS,STRIDE");
  numbers("--size", &options->size, 2, 16384, "pixels of the picture (the largest that is magnified 4 times)")
      ->option_text("WIDTH,HEIGHT");
  program->add_option("--memory", options->memory, "for the application, K and M too (default: 256K)")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::Range(uint64_t{1}, uint64_t{UINT32_MAX}))
      ->option_text("BYTES");
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
    return run(options);
  } catch (const CLI::Success& help) {
    return program.exit(help);
  } catch (const CLI::ParseError& error) {
    return complain(std::string(error.what()) + "; thimble-fb --help lists what there is", kUsageStatus);
  } catch (const std::bad_alloc&) {
    return complain("not enough memory on this machine");
  }
}
