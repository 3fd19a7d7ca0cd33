// thimble sim: the firmware's own application in the host simulator.
#include <cstdlib>
#include <cstring>

#include "apps/app_table.h"
#include "commands/bake_command.h"
#include "commands/commands.h"
#include "commands/render_command.h"
#include "commands/sim_session.h"
#include "readers/picture.h"
#include "scene/named_scenes.h"
#include "scene/wide_frames.h"

namespace thimble::tools {
namespace {

constexpr const char* kDefaultBoard = "lm3s6965evb";
constexpr const char* kDefaultScene = "demo";
constexpr const char* kDefaultWaterScene = "water";
// What the demonstration shows in a few greys on a small display: the valley's trees and rocks are one there.
constexpr const char* kOledScene = "oled";

struct SimCommand {
  SceneOptions scene;
  SessionOptions session;
  EffectChoice effects;
  EngineOptions engine;
  std::string shot_path;
  std::string check_path;
  std::string keys_path;
  std::string record_path;
  bool chooses_application = true;  ///< by the scene
  /// As the application wants it, once that is known; `session.board` points to it then.
  platform::BoardFacts board{};
};

const char* default_scene(const SessionOptions& session) {
  if (std::strcmp(session.application->name, "water") == 0) {
    return kDefaultWaterScene;
  }
  const std::vector<std::string> installed = scene_names();
  const bool for_oled = session.board->screen == platform::Screen::kOled &&
                        std::strcmp(session.application->name, "demo") == 0 &&
                        std::find(installed.begin(), installed.end(), kOledScene) != installed.end();
  return for_oled ? kOledScene : kDefaultScene;
}

// Whether a baked scene was baked with water that can move.
bool has_water(const std::vector<std::uint8_t>& bytes) {
  BakedScene scene;
  BakedLighting lighting;
  return BakedScene::open({bytes.data(), bytes.size()}, &scene) == Status::kOk &&
         BakedLighting::open(scene.section(SectionKind::kLighting), scene.tree().level(), &lighting) ==
             Status::kOk &&
         (lighting.effects & Effect::kWater) != 0;
}

// The scene as it lies in the board's flash: baked for its display, or a baked file as it is.
std::vector<std::uint8_t> flash_bytes(const SimCommand& command) {
  const platform::BoardFacts& board = *command.session.board;
  const auto source = command.scene.open();
  std::uint64_t limit = scene_flash_bytes(board);
  std::vector<std::uint8_t> bytes;
  if (const BakedScene* baked = source->baked()) {
    bytes.assign(baked->bytes().begin(), baked->bytes().end());
  } else {
    BakeCommand baking;
    baking.scene = command.scene;
    baking.scene.board = &board;
    baking.effects = command.effects;
    // Framed as `thimble render` does.
    use_display(&board, &baking.view);
    baking.view.side = NamedView::kBest;
    baking.view.fov_degrees = kPictureFov;
    BakingOptions options = baking_options(baking, *source, nullptr);
    options.coarsen = command.scene.coarsen;
    const Baked made = with_progress("baking", command.scene.quiet, [&](const Progress& progress) {
      return bake_within({&board, std::nullopt}, *source, &options, progress);
    });
    limit = *options.limit_bytes;
    bytes.assign(made.bytes.begin(), made.bytes.end());
  }
  fail_if(bytes.size() > limit, "takes ", grouped(bytes.size()), " bytes baked; ", board.name, " has ",
          grouped(limit), " bytes of flash for a scene",
          source->baked() == nullptr && !command.scene.coarsen
              ? "; a smaller --depth may fit, --coarsen merges blocks until it does"
              : "");
  return bytes;
}

// How `picture` differs from `wanted`, as a sentence; empty when it does not.
std::string difference(const Image& picture, const Image& wanted) {
  std::uint64_t count = 0;
  std::size_t first = 0;
  const std::size_t pixels = picture.pixels.size() / 3;
  for (std::size_t i = pixels; i-- > 0;) {
    if (!std::equal(picture.pixels.begin() + static_cast<std::ptrdiff_t>(3 * i),
                    picture.pixels.begin() + static_cast<std::ptrdiff_t>(3 * i + 3),
                    wanted.pixels.begin() + static_cast<std::ptrdiff_t>(3 * i))) {
      ++count;
      first = i;
    }
  }
  if (count == 0) {
    return {};
  }
  const auto color = [first](const Image& image) { return color_text(image.pixels.data() + 3 * first); };
  const auto width = static_cast<std::size_t>(picture.width_px);
  return concat(grouped(count), " of ", grouped(pixels), count == 1 ? " pixels differs" : " pixels differ",
                "; the first is at ", first % width, ",", first / width, ": ", color(picture), " where ",
                color(wanted), " should be");
}

// What drew the frames that the port may draw; with both words where it could not draw all of them.
std::string engine_text(const WideFrames& wide) {
  return wide.drawn() == 0 ? "ray64" : wide.left() == 0 ? "wide" : "wide, ray64";
}

// As the other subcommands name things; without what is not counted here.
std::string stats_text(const SimCommand& command, const SessionResult& result, const std::string& engine) {
  const SessionOptions& session = command.session;
  JsonRow json;
  put_all(&json, "scene", session.application->wants_scene ? command.scene.arguments.scene : "", "board",
          session.board->name, "application", session.application->name);
  BakedScene scene;
  if (session.application->wants_scene && BakedScene::open(session.scene, &scene) == Status::kOk) {
    put_all(&json, "depth", scene.tree().level(), "voxels", scene.tree().voxel_count(), "tree_bytes",
            scene.tree().size_bytes(), "baked_bytes", session.scene.size, "baked_crc32",
            crc_text(scene.crc32()));
  }
  put_all(&json, "budget_bytes", result.use.ram_limit_bytes, "high_water_bytes", result.use.ram_bytes,
          "stack_bytes", result.use.stack_bytes, "frames", result.pictures, "frame_seconds",
          result.mean_frame_seconds, "rows_sent", result.rows_sent, "rows_kept", result.rows_kept);
  if (!engine.empty()) {
    put_all(&json, "threads", command.engine.threads, "engine", engine);
  }
  const bool is_drawn = result.pictures != 0;
  put_all(&json, "frame_crc32",
          is_drawn ? crc_of(converted(result.picture, PixelFormat::kRgb888).pixels) : "", "display_crc32",
          is_drawn ? crc_of(result.picture.pixels) : "");
  return json_text(json);
}

void report(const SimCommand& command, const SessionResult& result, const std::string& engine) {
  if (command.scene.quiet) {
    return;
  }
  const std::string time =
      result.mean_frame_seconds == 0
          ? ""
          : ", " + fixed(1000 * result.mean_frame_seconds, 2) + " ms each on this machine";
  // Where something was left as it was.
  const std::string rows = result.rows_kept == 0 ? std::string()
                                                 : "rows drawn " + grouped(result.rows_sent) +
                                                       ", unchanged " + grouped(result.rows_kept) + "\n";
  const std::string by = engine.empty() ? std::string() : ", engine " + engine;
  std::fprintf(stderr, "%s on %s: %s%s%s\n%s%s\n", command.session.application->name,
               command.session.board->name, counted(result.pictures, "frame").c_str(), time.c_str(),
               by.c_str(), rows.c_str(), memory_text(result.use, "\n").c_str());
}

int run_and_write(SimCommand* command, std::string* sentence) {
  enum : std::size_t { kShot, kRecording, kStats };
  OutputSet outputs({command->shot_path, command->record_path, command->scene.stats_path},
                    {command->scene.arguments.scene, command->check_path, command->keys_path});
  SessionOptions& session = command->session;
  session.recording = outputs[kRecording];
  platform::BoardFacts& board = command->board;
  board = *session.board;
  std::optional<Image> wanted;
  if (!command->check_path.empty()) {
    wanted = about(command->check_path,
                   [&] { return read_picture(command->check_path, board.width_px, board.height_px); });
  }
  if (!command->keys_path.empty()) {
    session.keys = about(command->keys_path, [&] {
      return KeyScript(load_file(command->keys_path, std::uint64_t{1} << 20).text());
    });
  }
  std::vector<std::uint8_t> scene;
  if (session.application->wants_scene) {
    scene = flash_bytes(*command);
    // Only the demonstration holds a rate of frames, or has them drawn by another engine.
    if (command->chooses_application && session.hold_fps == 0 && command->engine.name != "wide" &&
        has_water(scene)) {
      session.application = apps::find_application("water");
    }
  }
  session.scene = {scene.data(), scene.size()};
  board = platform::board_for(*session.board, session.application->name);
  session.board = &board;

  WideFrames wide(command->engine.name == "wide", command->engine.threads);
  const bool asks_port = session.application->asks_port;
  session.painter = asks_port && command->engine.name != "ray64" ? &wide : nullptr;

  const SessionResult result = run_session(session);
  session.painter = nullptr;  // it ends with this function
  const std::string engine = asks_port ? engine_text(wide) : "";
  const std::string who = std::string(session.application->name) + " on " + board.name;
  if (!result.fault.empty()) {
    *sentence = who + " was stopped: " + result.fault;
    return result.status;
  }
  report(*command, result, engine);
  if (result.status != 0) {
    *sentence = concat(who, " ended with status ", result.status);
    return result.status;
  }
  if (result.pictures == 0 && (outputs[kShot] != nullptr || wanted || outputs[kRecording] != nullptr)) {
    *sentence = who + " drew no picture";
    return 1;
  }
  const Image picture = converted(result.picture, PixelFormat::kRgb888);
  if (outputs[kShot] != nullptr) {
    write_picture(outputs[kShot], command->shot_path, picture);
  }
  outputs.write(kStats, stats_text(*command, result, engine));
  outputs.commit();
  if (wanted) {
    const std::string differs = difference(picture, *wanted);
    if (!differs.empty()) {
      *sentence = command->check_path + ": " + differs;
      return 1;
    }
    if (!command->scene.quiet) {
      std::fprintf(stderr, "%s: equal, pixel by pixel\n", printable(command->check_path).c_str());
    }
  }
  *sentence = result.screen_fault;
  return result.screen_fault.empty() ? 0 : 1;
}

void run(const SimCommand& given) {
  SimCommand command = given;
  SessionOptions& session = command.session;
  refuse_if(!session.application->wants_scene && !command.scene.arguments.scene.empty(),
            "SCENE: ", in_quotes(command.scene.arguments.scene), " is not for the application ",
            session.application->name, ", which draws no scene");
  refuse_if(session.hold_fps != 0 &&
                (std::strcmp(session.application->name, "demo") != 0 || session.board->visits_a_second == 0),
            "--hold: ", session.application->name, " on ", session.board->name, " holds no rate of frames");
  refuse_if(command.engine.name == "wide" && !session.application->asks_port,
            "--engine: wide draws for the application demo only, not for ", session.application->name);
  if (command.scene.arguments.scene.empty()) {
    command.scene.arguments.scene = default_scene(session);
  }
  std::string sentence;
  int status = 0;
  try {
    status = run_and_write(&command, &sentence);
  } catch (const host::ScreenError& error) {
    throw OutputError(error.what());
  } catch (const host::SimulationError& error) {
    throw OutputError(error.what());
  }
  if (status != 0) {
    std::fprintf(stderr, "thimble: %s\n", printable(sentence).c_str());
    std::exit(status);  // the application's own is the command's
  }
}

void add_display_options(CLI::App& sub, SimCommand* command) {
  add_choice_option(
      sub, "--display",
      {{"auto", host::ScreenKind::kAuto},
       {"window", host::ScreenKind::kWindow},
       {"terminal", host::ScreenKind::kTerminal},
       {"none", host::ScreenKind::kNone}},
      &command->session.display,
      "where the display is shown; auto: in an X11 window where DISPLAY works, else in the terminal where "
      "standard output is one, else not at all; a board without a display gets one by window or terminal");
  add_choice_option(sub, "--theme",
                    {{"auto", std::nullopt},
                     {"oled", host::Theme::kOled},
                     {"lcd", host::Theme::kLcd},
                     {"plain", host::Theme::kPlain}},
                    &command->session.theme,
                    "how the display looks; auto: as the board's does; pictures in files never have a theme");
  add_whole_option(sub, "--scale", "N", 1, 32, &command->session.scale,
                   "screen pixels a pixel at most (default: as fits)");
  add_whole_option(
      sub, "--hold", "FPS", 1, 1000, &command->session.hold_fps,
      "demo: hold so many frames a second of the board's time: while the camera moves a frame has squares "
      "of 2 to 8 pixels or, without a brick map, is refined from coarse to fine, as the board has time for, "
      "and it is exact when the camera stands still; the key h switches it, t stops the turning; the work a "
      "frame depends on the board alone, so the pictures are the board's");
  add_whole_option(sub, "--fps", "N", 1, 1000, &command->session.frames_a_second,
                   "frames a second at most in a window or terminal, and of the recording");
}

void add_file_options(CLI::App& sub, SimCommand* command) {
  add_whole_option(
      sub, "--frames", "N", 1, 1'000'000'000, &command->session.frames,
      "end after N frames (default: 1 where nobody watches, else when the window is closed or Esc is "
      "pressed)");
  add_output_option(
      sub, "--shot", "FILE", &command->shot_path,
      [](const std::string& text) { return image_kind(text) && text != "-"; }, kImageEndings,
      "write the last frame: the display's exact pixels, with 8 bits");
  add_path_option(
      sub, "--check", "REF", &command->check_path,
      "compare the last frame with a PNG, PPM or PGM; status 1 and how many pixels differ, and the "
      "first, unless they are equal");
  add_output_option(
      sub, "--record", "FILE.y4m", &command->record_path, names_y4m, ".y4m",
      "write all frames as YUV4MPEG2, which ffmpeg and mpv play; greys exact (mono), colours as 4:4:4");
  add_path_option(
      sub, "--keys", "SCRIPT", &command->keys_path,
      "buttons and typed text by frame: a file with lines \"FRAME: down BUTTON...\", \"FRAME: up "
      "BUTTON...\" (up, down, left, right, select) and \"FRAME: type TEXT\" (over the UART, with "
      "\\n \\r \\t \\\\ \\xHH); a line takes effect before its frame is drawn, frames count from 0; "
      "# begins a comment");
}

}  // namespace

void add_sim(CLI::App& app) {
  const Span<const apps::Application> applications = apps::applications();
  if (applications.empty()) {
    return;
  }
  CLI::App* sub = add_command(
      app, "sim",
      "Run the firmware's own application on this machine, with a board's RAM, flash and display.");
  SimCommand* const command = options_for<SimCommand>(*sub, run);
  command->session.board = platform::find_board(kDefaultBoard);
  command->session.application = &applications[0];
  command->scene.add_scene(*sub, false);
  add_board(*sub, &command->session.board,
            std::string("whose limits and display count (default: ") + kDefaultBoard + ")");
  std::vector<std::string> names;
  for (const apps::Application& application : applications) {
    names.emplace_back(application.name);
  }
  add_choice_option(
      *sub, "--app", names,
      [command](std::size_t index) {
        command->session.application = &apps::applications()[index];
        command->chooses_application = false;
      },
      "the application (default: water for a scene with water, else " + names.front() + ")");
  add_flag(*sub, "--coarsen", &command->scene.coarsen,
           "when the scene does not fit the flash, merge blocks of voxels until it just does");
  add_effect_list(
      *sub, &command->effects,
      "what the scene is baked for: auto (what it calls for), none, or effects with commas between them "
      "(default: auto, for a file that states no light a sun over the viewer's shoulder with shadows, and "
      "for a display of few greys dark edges)",
      "");
  add_display_options(*sub, command);
  add_file_options(*sub, command);
  command->engine.add_board_engines_to(*sub);
  command->scene.add_report(*sub);
}

}  // namespace thimble::tools
