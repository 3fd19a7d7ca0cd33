// thimble new: a project that draws a scene on a board, by templates (tools/new).
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "commands/bake_command.h"
#include "commands/commands.h"
#include "output/version.h"
#include "scene/named_scenes.h"

namespace thimble::tools {
namespace {

// A module with a driver (thimble/drivers/panel.h), as the picture lies on it.
struct PanelKind {
  std::string name;
  const char* driver;  // its class
  bool is_i2c;
  PixelFormat format;
  std::int32_t width_px;
  std::int32_t height_px;
  const char* geometry;    // what `begin` takes in C++
  const char* c_geometry;  // and in C
};
const char* const kTurned = ", PixelFormat::kRgb565Be, drivers::Rotation::k90";
const std::vector<PanelKind> kPanels{
    {"ssd1306", "Ssd1306", true, PixelFormat::kMono1Pages, 128, 64, "{128, 64}", "128, 64, -1, 0"},
    {"sh1106", "Sh1106", true, PixelFormat::kMono1Pages, 128, 64, "{128, 64}", "128, 64, -1, 0"},
    {"st7567", "St7567", false, PixelFormat::kMono1Pages, 128, 64, "{128, 64}", "128, 64, -1, 0"},
    {"st7735", "St7735", false, PixelFormat::kRgb565Be, 160, 128, "k128x160", "THIMBLE_ST7735_128X160, "},
    {"st7789", "St7789", false, PixelFormat::kRgb565Be, 240, 240, "k240x240", "THIMBLE_ST7789_240X240, "},
    {"st7789-320x240", "St7789", false, PixelFormat::kRgb565Be, 320, 240, "k240x320",
     "THIMBLE_ST7789_240X320, "},
    {"ili9341", "Ili9341", false, PixelFormat::kRgb565Be, 320, 240, "k240x320", ""}};

// What PlatformIO and Arduino call a board that they have.
struct SketchBoard {
  const char* board;
  const char* pio_platform;
  const char* pio_board;
  const char* fqbn;
};
constexpr SketchBoard kSketchBoards[] = {
    {"pico", "raspberrypi", "pico", "rp2040:rp2040:rpipico"},
    {"pico-lcd-2", "raspberrypi", "pico", "rp2040:rp2040:rpipico"},
    {"pico-oled", "raspberrypi", "pico", "rp2040:rp2040:rpipico"},
    {"microbit", "nordicnrf51", "bbcmicrobit", "sandeepmistry:nRF5:BBCmicrobit"},
    {"netduinoplus2", "ststm32", "genericSTM32F405RG",
     "STMicroelectronics:stm32:GenF4:pnum=GENERIC_F405RGTX"},
    {"stm32vldiscovery", "ststm32", "disco_f100rb", "STMicroelectronics:stm32:Disco:pnum=DISCO_F100RB"}};

struct NewCommand : BakeCommand {
  std::string folder;
  const PanelKind* panel = nullptr;
  std::string build = "cmake";
  bool in_c = false;

  std::string name() const {
    return std::filesystem::absolute(folder + "/.").lexically_normal().parent_path().filename().string();
  }
  const SketchBoard* sketch() const {
    for (const SketchBoard& one : kSketchBoards) {
      if (std::string(one.board) == scene.board->name) {
        return &one;
      }
    }
    return nullptr;
  }
  std::string kit() const { return panel == nullptr ? "port" : build == "cmake" ? "pico-sdk" : build; }
};

using Meanings = std::map<std::string, std::string>;

// A template with the lines that one of `kinds` wants (`%KIND LINE`), and words (`@WORD@`) said.
std::string filled(const std::string& name, const std::set<std::string>& kinds, const Meanings& words) {
  const std::string folder = folder_beside_program("new");
  fail_if(folder.empty(), "the templates of projects (new) are not beside this command");
  std::istringstream lines(std::string(load_file(folder + "/" + name + ".in").text()));
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    if (line[0] == '%') {
      const std::size_t end = line.find(' ');
      if (!kinds.contains(line.substr(1, end - 1))) {
        continue;
      }
      line.erase(0, end + 1);
    }
    text += line + "\n";
  }
  for (const auto& [word, meaning] : words) {
    const std::string mark = "@" + word + "@";
    for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += meaning.size()) {
      text.replace(at, mark.size(), meaning);
    }
  }
  return text;
}

// What the templates say of the panel.
Meanings words_of(const PanelKind& panel) {
  const bool is_mono = panel.format == PixelFormat::kMono1Pages;
  const std::string driver = panel.driver;
  return {{"PANEL", panel.name.substr(0, panel.name.find('-'))},
          {"CLASS", driver},
          {"BUS", panel.is_i2c ? "wire.bus()" : "{nullptr, bus_command, bus_data, bus_wait}"},
          {"KIND", is_mono ? "page" : "color"},
          {"FORMAT", is_mono ? "kMono1Pages" : "kRgb565Be"},
          {"C_FORMAT", is_mono ? "MONO1_PAGES" : "RGB565_BE"},
          {"WIDTH", std::to_string(panel.width_px)},
          {"HEIGHT", std::to_string(panel.height_px)},
          {"BAND_BYTES", std::to_string(band_bytes(panel.format, panel.width_px, 8))},
          {"GEOMETRY", is_mono ? panel.geometry : "drivers::" + driver + "::" + panel.geometry + kTurned},
          {"C_GEOMETRY", panel.c_geometry + std::string(is_mono ? "" : "THIMBLE_FORMAT_RGB565_BE, 1")}};
}

void check(const NewCommand& command) {
  std::string name = command.name();
  std::replace(name.begin(), name.end(), '-', command.panel == nullptr ? '-' : '_');
  refuse_if(!is_identifier(name), "DIR: \"", command.name(),
            "\" is no name of a project: letters, digits and _ (- with --panel), a letter first, and no word "
            "of C or "
            "C++");
  const std::string board = command.scene.board->name;
  const bool is_cmake = command.build == "cmake";
  const bool has_sketch = command.sketch() != nullptr;
  if (command.panel == nullptr) {
    refuse_if(!is_cmake || command.in_c, command.in_c ? "--language" : "--build",
              ": what draws on a board's own display is C++ and built by CMake; --panel names another");
    return;
  }
  refuse_if(is_cmake ? !board.starts_with("pico") : !has_sketch, "--board: ",
            is_cmake && has_sketch ? "with a panel " + board + " wants --build platformio or arduino"
                                   : "there is no project with a panel for " + board);
  refuse_if(command.in_c && !is_cmake, "--language: a sketch is C++; --build cmake takes C");
}

// The files of the project by name.
std::map<std::string, std::string> project(const NewCommand& command, const Baked& baked) {
  const platform::BoardFacts& board = *command.scene.board;
  const std::string kit = command.kit();
  const bool has_map = !baked.scene.section(SectionKind::kBrickMap).empty();
  const std::string main = kit == "arduino" ? command.name() + ".ino" : command.in_c ? "main.c" : "main.cpp";
  const std::string folder = kit == "platformio" ? "src/" : "";
  Meanings words{
      {"SCENE", printable(std::filesystem::path(command.scene.arguments.scene).filename().string())},
      {"MAIN", folder + main},
      {"FOLDER", folder},
      {"MAP", has_map ? "bricks, " : ""},
      {"WHERE", command.panel == nullptr ? concat("the display of ", board.title)
                                         : concat("an ", command.panel->name, " at a ", board.name)},
      {"BOARD", board.name},
      {"NAME", command.name()},
      {"VERSION", kVersionNumber},
      {"C_RENDER", has_map ? "thimble_scene_render_fast(&scene, &bricks, &camera, &shading, &band)"
                           : "thimble_scene_render(&scene, &camera, &shading, &band)"}};
  if (const SketchBoard* const sketch = command.sketch()) {
    words.insert(
        {{"PIO_PLATFORM", sketch->pio_platform}, {"PIO_BOARD", sketch->pio_board}, {"FQBN", sketch->fqbn}});
  }
  // Ink where the RAM holds its two pictures beside what a sketch has.
  const bool is_ink = bits_per_pixel(board.format) == 1 && board.ram_bytes > 65536;
  std::set<std::string> kinds{kit, command.build, has_map ? "map" : "no-map", is_ink ? "ink" : "bands"};
  std::map<std::string, std::string> files;
  if (const PanelKind* const panel = command.panel) {
    words.merge(words_of(*panel));
    const std::string chip = kit == "pico-sdk" ? "pico" : "ino";
    const std::string bus = panel->is_i2c ? "i2c" : "spi";
    kinds.insert({"panel", chip, bus, chip + "-" + bus});
    files[folder + "wiring.h"] = filled("wiring.h", kinds, words);
  }
  files[folder + main] = filled(kit == "port"  ? "port.cpp"
                                : command.in_c ? "main.c"
                                               : "main.cpp",
                                kinds, words);
  files[folder + "scene.h"] = c_header_text(baked.scene, kDefaultIdentifier);
  files["README.md"] = filled("README.md", kinds, words);
  if (kit == "platformio") {
    files["platformio.ini"] = filled("platformio.ini", kinds, words);
  } else if (kit != "arduino") {
    files["CMakeLists.txt"] = filled("CMakeLists.txt", kinds, words);
  }
  return files;
}

void run(const NewCommand& given) {
  namespace fs = std::filesystem;
  NewCommand command = given;
  std::error_code error;
  if (fs::exists(fs::symlink_status(command.folder, error)) && !fs::is_empty(command.folder, error)) {
    throw OutputError(command.folder + ": is there already, and no empty folder");
  }
  platform::BoardFacts board = *command.scene.board;
  if (command.panel != nullptr) {
    board.format = command.panel->format;
    board.width_px = command.panel->width_px;
    board.height_px = command.panel->height_px;
    board.most_map_level = 8;  // of the core as packages compile it
  }
  command.scene.board = &board;
  use_display(&board, &command.view);
  command.effects.automatic = false;
  command.effects.is_given = true;
  const auto source = command.scene.open();
  BakingOptions options;
  const Baked baked = bake(&command, *source, &options);
  const std::map<std::string, std::string> files = project(command, baked);
  std::vector<std::string> paths;
  std::vector<std::string> names;
  const bool was_there = fs::exists(command.folder, error);
  for (const auto& [name, text] : files) {
    paths.push_back(command.folder + "/" + name);
    fs::create_directories(fs::path(paths.back()).parent_path(), error);
    if (error) {
      throw OutputError(command.folder + ": cannot be made: " + error.message());
    }
    names.push_back(name);
  }
  try {
    OutputSet outputs(paths, {command.scene.arguments.scene});
    for (std::size_t i = 0; const auto& [name, text] : files) {
      outputs[i++]->write(text);
    }
    outputs.commit();
  } catch (...) {
    fs::remove(command.folder + "/src", error);  // where they are empty
    if (!was_there) {
      fs::remove(command.folder, error);
    }
    throw;
  }
  if (!command.scene.quiet) {
    std::fputs(
        (baked_text(command, options, baked) + command.folder + ": " + joined(names, ", ") + "\n").c_str(),
        stderr);
  }
}

}  // namespace

void add_new(CLI::App& app) {
  CLI::App* sub =
      add_command(app, "new",
                  "Write a project that draws a scene on a board: source, scene header, build file, "
                  "README.");
  NewCommand* const command = options_for<NewCommand>(*sub, run);
  sub->add_option("dir", command->folder, "the project's folder, which is made")
      ->type_name("DIR")
      ->required();
  command->scene.add_scene(*sub);
  add_board(*sub, &command->scene.board, "the board, which must be given")->required();
  std::vector<std::string> panels;
  panels.reserve(kPanels.size());
  for (const PanelKind& panel : kPanels) {
    panels.push_back(panel.name);
  }
  add_choice_option(
      *sub, "--panel", panels, [command](std::size_t index) { command->panel = &kPanels[index]; },
      "the panel that is connected to the board, drawn on by Thimble's driver (default: the board's own "
      "display, by Thimble's port)");
  add_choice_option(*sub, "--build", {"cmake", "platformio", "arduino"}, &command->build,
                    "what builds it: CMake (with a panel by the Pico's SDK), PlatformIO, or Arduino");
  add_choice_option<bool>(*sub, "--language", {{"c++", false}, {"c", true}}, &command->in_c,
                          "what the program is written in");
  add_fitting(*sub, command);
  add_picture_view(*sub, &command->view);
  command->scene.add_report(*sub);
  also_check(*sub, [command] { check(*command); });
}

}  // namespace thimble::tools
