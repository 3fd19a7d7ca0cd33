#include "commands/command_line.h"

#include <fcntl.h>

#include <csignal>
#include <exception>
#include <filesystem>
#include <new>

#include "commands/commands.h"
#include "host/screen.h"
#include "output/held_signals.h"
#include "output/version.h"
#include "scene/gpu_engine.h"
#include "scene/named_scenes.h"

namespace thimble::tools {
namespace {

constexpr int kInputStatus = 1;
constexpr int kUsageStatus = 2;

// Whether the first argument is a scene, so that the command is to show it: a file, a generator, the name of a
// scene that comes along, or what can only be a file that is not there.
bool is_scene(const std::string& word) {
  if (word.empty() || word.starts_with("-")) {
    return false;
  }
  if (is_generator(word)) {
    return true;
  }
  std::error_code error;
  if (word.find_first_of("./") != std::string::npos || std::filesystem::exists(word, error)) {
    return true;
  }
  const std::vector<std::string> names = scene_names();
  return std::find(names.begin(), names.end(), word) != names.end();
}

// What `thimble --version` prints: version, commit, and what this build and this machine have.
std::string version_text() {
  const std::string sets = joined(WideRenderer::instruction_sets(), ", ");
  const std::string gpus = joined(GpuEngine::devices(), ", ");
  const char* const no_gpu = GpuEngine::is_in_build()
                                 ? "none: there is no Vulkan loader or device"
                                 : "not in this build (-DTHIMBLE_GPU=OFF): the processor draws";
  const char* const windows = host::window_kind();
  return std::string("thimble ") + kVersionNumber + "\ncommit         " + kVersionCommit +
         "\nwide renderer  " +
         (sets.empty() ? "not in this build (-DTHIMBLE_WIDE=OFF): the core draws ray by ray"
                       : sets + " on this machine; the first is used") +
         "\nGPU            " + (gpus.empty() ? no_gpu : gpus) + "\nwindows        " +
         (windows == nullptr ? "not in this build (-DTHIMBLE_WINDOW=OFF): the terminal and files" : windows);
}

constexpr const char* kFirstWords =
    "Thimble draws voxels: the same picture, bit for bit, on a desktop and on a small chip.\n"
    "  thimble FILE                           look around in a model (.vox .ply .obj .xyz and more)\n"
    "  thimble render FILE -o picture.png     draw a picture of it\n"
    "  thimble info FILE                      say what it is, and what it takes\n"
    "  thimble boards FILE                    say which boards it fits\n"
    "  thimble sim FILE --board microbit      see it as that board shows it\n"
    "  thimble bake FILE -o scene.h           write it as bytes for flash\n"
    "  thimble --help                         list all there is; thimble SUBCOMMAND --help each option\n";

// Standard streams that are closed would be taken by the next file opened, and a picture would get the
// sentences meant for a person. Reading from and writing to these stand-ins fails, as it should.
void occupy_standard_descriptors() {
  for (int descriptor = 0; descriptor <= 2; ++descriptor) {
    if (::fcntl(descriptor, F_GETFD) < 0 && ::open("/dev/null", descriptor == 0 ? O_WRONLY : O_RDONLY) < 0) {
      return;
    }
  }
}

// The options that help where a view cannot be, in the order of `FramingFault`.
const char* options_against(FramingFault fault) {
  constexpr std::array kOptions{" (--eye)",
                                " (--target)",
                                " (--eye, --target)",
                                " (--up)",
                                " (--span)",
                                "; leave out --direction-bits",
                                "; a wider --fov or a smaller --size helps",
                                " (--span)",
                                "; a smaller --span or another --eye helps",
                                "; another --size, or a camera of your own (--eye, --target, --span), helps"};
  return kOptions[static_cast<std::size_t>(fault)];
}

}  // namespace

int run_command_line(int argc, char** argv) {
  occupy_standard_descriptors();
  clean_up_on_signals();
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is an error of the write, with a sentence
  std::signal(SIGXFSZ, SIG_IGN);  // and so is the limit on a file's size

  CLI::App app(
      "Thimble, a voxel ray tracer in a fixed block of memory: the same picture, bit for bit, on every "
      "machine.",
      "thimble");
  app.require_subcommand(1);
  app.formatter(help_formatter());
  app.set_version_flag("--version", version_text,
                       "print version, commit, and what this build and this machine have");
  add_all_commands(app);
  add_paragraph_below(app,
                      "thimble SUBCOMMAND --help describes each. Behind -- nothing is an "
                      "option. The files that one run writes are all there whole, or none "
                      "and what was there before is as it was, also when a signal other than "
                      "KILL ends it; none may be what the run reads. What goes to -, to a "
                      "name of an open descriptor (/dev/stdout, /dev/fd/3), to a device or a "
                      "pipe is written straight on.");
  // The file that an input error is about, for the sentence: the subcommand's first argument.
  const auto subject = [&]() -> std::string {
    for (const CLI::App* command : app.get_subcommands()) {
      if (const CLI::Option* scene = command->get_option_no_throw("scene");
          scene != nullptr && scene->count() > 0) {
        const std::string name = scene->results().front();
        return (name.empty() ? "\"\"" : name) + ": ";
      }
    }
    return {};
  };
  std::string sentence;
  int status = kInputStatus;
  try {
    if (argc < 2) {
      std::fputs(kFirstWords, stdout);
      check_standard_output();
      return 0;
    }
    std::vector<char*> words(argv, argv + argc);
    char view[] = "view";
    char end_of_options[] = "--";
    const std::vector<std::string> names = subcommand_names(app);
    const auto is_subcommand = [&](const char* word) {
      return std::find(names.begin(), names.end(), word) != names.end();
    };
    if (words[1] == std::string(end_of_options) && argc > 2) {
      // What follows is no option, whatever it begins with.
      words.erase(words.begin() + 1);
      if (!is_subcommand(words[1])) {
        words.insert(words.begin() + 1, {view, end_of_options});
      }
    } else if (!is_subcommand(words[1]) && is_scene(words[1])) {
      words.insert(words.begin() + 1, view);
    }
    try {
      app.parse(static_cast<int>(words.size()), words.data());
    } catch (const CLI::Success& help) {
      app.exit(help);  // prints it, or the version
    }
    check_standard_output();
    return 0;
  } catch (const CLI::ParseError& error) {
    sentence = usage_sentence(app, error, argv[1]);
    status = kUsageStatus;
  } catch (const UsageError& error) {
    sentence = subject() + error.what();
    status = kUsageStatus;
  } catch (const OutputError& error) {
    sentence = error.what();
  } catch (const FramingError& error) {
    sentence = subject() + error.what() + options_against(error.fault);
  } catch (const std::bad_alloc&) {
    sentence = subject() + "not enough memory on this machine";
  } catch (const std::exception& error) {
    sentence = subject() + error.what();
  }
  std::fprintf(stderr, "thimble: %s\n", printable(sentence).c_str());
  return status;
}

}  // namespace thimble::tools
