// thimble bake: a scene as bytes for flash.
#include <cctype>

#include "commands/bake_command.h"
#include "commands/commands.h"
#include "scene/generators.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kMostIdentifier = 63;  // what C99 tells apart
constexpr std::size_t kLineWidth = 100;

// Keywords of C to C23 and C++ to C++20, and the names that <stdint.h> takes.
constexpr std::string_view kTaken =
    " alignas alignof and asm auto bool break case catch char class concept const consteval constexpr "
    "constinit continue decltype default delete do double else enum explicit export extern false float "
    "for friend goto if inline int long mutable namespace new noexcept not nullptr operator or private "
    "protected public register requires restrict return short signed sizeof static struct switch "
    "template this throw true try typedef typeid typename typeof union unsigned using virtual void "
    "volatile while xor bitand bitor compl and_eq or_eq xor_eq not_eq int8_t int16_t int32_t int64_t "
    "uint8_t uint16_t uint32_t uint64_t size_t wchar_t char8_t char16_t char32_t co_await co_return "
    "co_yield thread_local main intptr_t std thimble NULL ";

std::string capitals(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return out;
}

// A name that can stand in a comment, whatever it was: nothing that ends the comment or joins lines.
std::string for_comment(ConstBytes name) {
  std::string out;
  for (const std::uint8_t byte : name) {
    const bool plain = std::isalnum(byte) != 0 ||
                       std::string_view(" ._,:-+=()").find(static_cast<char>(byte)) != std::string_view::npos;
    out += plain ? static_cast<char>(byte) : '_';
  }
  return out;
}

// What would fit instead, what loses least first: found by baking so.
std::string advice(const BakeCommand& command, const SceneSource& source, EffectSet effects) {
  std::string text = ";";
  const auto fits = [&](const BakeCommand& other, const SceneSource& from, Baked* baked) {
    BakingOptions options = baking_options(other, from, nullptr);
    *baked = with_progress("trying what would fit", command.scene.quiet, [&](const Progress& progress) {
      return bake_within(other.limit(), from, &options, progress);
    });
    return baked->fits;
  };
  Baked baked;
  if (effects != Effect::kNone) {
    BakeCommand plain = command;
    plain.effects = {};
    plain.effects.automatic = false;
    plain.effects.is_given = true;
    if (fits(plain, source, &baked)) {
      text += " --effects none fits with all its voxels in " + grouped(baked.bytes.size()) + " bytes;";
    }
  }
  text += source.is_scalable() ? " --coarsen makes the finest tree that fits"
                               : " this scene has one depth only, --coarsen makes the finest tree that fits";
  BakeCommand shallow = command;
  for (int depth = source.level() - 1; source.is_scalable() && depth >= kMinLevel; --depth) {
    shallow.scene.arguments.depth = depth;
    try {
      const auto smaller = open_scene(shallow.scene.arguments);
      if (fits(shallow, *smaller, &baked)) {
        text += "; --depth " + std::to_string(depth) + " fits with " + grouped(baked.bytes.size()) + " bytes";
        break;
      }
    } catch (const InputError&) {
      break;  // a pipe is read only once; and a camera may suit one world and not another
    }
  }
  const bool is_for_make = command.scene.board != nullptr && !command.room;
  return text + (is_for_make ? " (make firmware takes such options as BAKE=\"...\")" : "");
}

void report(const BakeCommand& command, const BakingOptions& options, const Baked& baked) {
  std::string text = baked_text(command, options, baked);
  if (const platform::BoardFacts* board = command.scene.board) {
    const std::uint64_t ram = drawing_ram_bytes(*board, baked.effects);
    text += concat(board->name, ": flash ", grouped(baked.bytes.size()), " of the ",
                   grouped(scene_flash_bytes(*board, baked.effects)), " bytes beside the demonstration's ",
                   grouped(code_flash_bytes(*board, baked.effects)), "; RAM ", grouped(ram), " of ",
                   grouped(board->ram_bytes), " bytes (renderer ", grouped(lit_render_bytes(baked.effects)),
                   ", band of ", kBoardBandRows, " rows ", grouped(board_band_bytes(*board)), ", stack ",
                   grouped(board->stack_bytes), ")", ram > board->ram_bytes ? ": too much" : "", "\n");
  }
  std::fputs(text.c_str(), stderr);
}

void run(const BakeCommand& given) {
  BakeCommand command = given;
  use_display(command.scene.board, &command.view);
  OutputSet outputs({command.output, command.scene.stats_path}, {command.scene.arguments.scene});
  const auto source = command.scene.open();
  BakingOptions options;
  const Baked baked = bake(&command, *source, &options);
  if (command.as_header) {
    outputs[0]->write(c_header_text(baked.scene, command.identifier));
  } else {
    outputs[0]->write(baked.bytes);
  }
  outputs.write(1, stats_text(baked_stats(command, *source, baked, options.limit_bytes)));
  outputs.commit();
  if (!command.scene.quiet) {
    report(command, options, baked);
  }
}

}  // namespace

bool is_identifier(std::string_view text) {
  if (text.empty() || text.size() > kMostIdentifier ||
      std::isalpha(static_cast<unsigned char>(text[0])) == 0 || text.find("__") != std::string_view::npos ||
      kTaken.find(concat(" ", text, " ")) != std::string_view::npos) {
    return false;
  }
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; });
}

std::string c_header_text(const BakedScene& scene, std::string_view identifier) {
  const std::string name(identifier);
  const std::string prefix = capitals(identifier) + "_";
  const CompactTree& tree = scene.tree();
  std::string text = "/* A scene for Thimble, made by `thimble bake`";
  if (const ConstBytes made_from = scene.section(SectionKind::kName); !made_from.empty()) {
    text += " from " + for_comment(made_from);
  }
  text += ". Do not edit. */\n#ifndef " + prefix + "BAKED_H\n#define " + prefix +
          "BAKED_H\n\n#include <stdint.h>\n\n";
  const auto define = [&](const char* fact, const std::string& value) {
    text += "#define " + prefix + fact + " " + value + "\n";
  };
  text += "/* What it is, for choosing when a program is compiled. */\n";
  define("VERSION", std::to_string(kBakedVersion));
  define("BYTES", std::to_string(scene.bytes().size) + "u");
  define("CRC32", "0x" + crc_text(scene.crc32()) + "u");
  define("DEPTH", std::to_string(tree.level()));
  // A preprocessor computes in 64 bits; the suffix keeps a compiler of C90 quiet about large constants.
  define("VOXELS", std::to_string(tree.voxel_count()) + (tree.voxel_count() > UINT32_MAX ? "ull" : "ul"));
  define("NODES", std::to_string(tree.node_count()) + "ul");
  define("MANY_MATERIALS", tree.many_materials() ? "1" : "0");
  define("MERGED_BLOCKS", tree.merged() ? "1" : "0");
  define("PALETTE_COLORS", std::to_string(scene.palette().size));
  define("HAS_CAMERA", scene.has_camera() ? "1" : "0");
  define("IS_PERSPECTIVE", scene.has_camera() && scene.camera().is_perspective ? "1" : "0");
  define("IS_ORTHOGRAPHIC", scene.has_camera() && !scene.camera().is_perspective ? "1" : "0");
  BakedLighting lighting;
  if (BakedLighting::open(scene.section(SectionKind::kLighting), tree.level(), &lighting) != Status::kOk) {
    lighting.effects = Effect::kNone;  // baked without
  }
  // The bits are those of thimble/light/scene.h; words for a person.
  std::string names;
  for (const std::string& effect : effect_list(lighting.effects)) {
    names += " " + effect;
  }
  define("EFFECTS",
         concat("0x", hex_text(lighting.effects, 3), "u", names.empty() ? "" : " /*" + names + " */"));
  std::size_t lamps = 0;
  for (const Light& light : lighting.scene.lights) {
    lamps += light.is_point ? 1 : 0;
  }
  define("LAMPS", std::to_string(lamps));
  define("HAS_BRICK_MAP", scene.section(SectionKind::kBrickMap).empty() ? "0" : "1");
  text +=
      "\n/* Aligned as brick maps and chips that read whole words want it. Constant, so that it stays in "
      "flash. */\n"
      "#if defined(__cplusplus)\nalignas(8)\n"
      "#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L\n_Alignas(8)\n"
      "#elif defined(__GNUC__)\n__attribute__((aligned(8)))\n#endif\n"
      "static const uint8_t " +
      name + "[" + prefix + "BYTES] = {\n";
  std::string line;
  for (const std::uint8_t byte : scene.bytes()) {
    const std::string number = std::to_string(byte) + ",";
    if (line.size() + number.size() > kLineWidth) {
      text += line + "\n";
      line.clear();
    }
    line += number;
  }
  text += line + "\n};\n\n#endif\n";
  return text;
}

BakingOptions baking_options(const BakeCommand& command, const SceneSource& source, std::string* note) {
  BakingOptions options;
  options.limit_bytes = command.limit().bytes();
  options.threads =
      options.limit_bytes ? 1 : all_cores();  // within a limit, figures are those of any machine
  options.name = scene_name(command.scene.arguments.scene);
  options.brick_map = command.brick_map || command.scene.board != nullptr;
  options.effects = command.effects;
  options.default_look = source.baked() == nullptr && !parse_generator(command.scene.arguments.scene);
  if (const platform::BoardFacts* const board = command.scene.board) {
    options.most_map_level = board->most_map_level;
    options.display = DisplayFacts{board->format, board->width_px, board->height_px};
  } else {
    options.keeps_look = options.default_look;
    options.display = DisplayFacts{PixelFormat::kRgb888, command.view.width_px, command.view.height_px};
  }
  options.camera = [&command, &source, note](const CompactTree& tree) {
    const SceneShape shape = shape_of(source, tree);
    const bool for_board = command.scene.board != nullptr;
    Framing framing =
        for_board ? frame_round(command.view, source, shape) : frame_scene(command.view, source, shape);
    if (note != nullptr && !framing.note.empty()) {
      *note = framing.note;
    }
    return framing.kept;
  };
  return options;
}

std::string baked_text(const BakeCommand& command, const BakingOptions& options, const Baked& baked) {
  const CompactTree& tree = baked.scene.tree();
  const std::uint64_t bytes = baked.bytes.size();
  std::string text;
  if (!command.note.empty()) {
    text += "note: " + command.note + "\n";
  }
  const double a_voxel = static_cast<double>(bytes) / static_cast<double>(tree.voxel_count());
  text += concat(counted(tree.voxel_count(), "voxel"), " in ", grouped(bytes), " bytes (depth ", tree.level(),
                 tree.voxel_count() == 0 ? "" : ", " + fixed(a_voxel, 2) + " bytes a voxel", ")\n");
  if (baked.effects != Effect::kNone) {
    text += "for the effects " + effects_text(baked.effects) + "\n";
  }
  if (command.scene.board != nullptr && options.brick_map && !tree.empty() &&
      tree.level() <= options.most_map_level && baked.scene.section(SectionKind::kBrickMap).empty()) {
    text += "without a brick map, for which there is no room: frames take several times longer\n";
  }
  if (command.lost_light) {
    text += "without light, for which there is no room\n";
  }
  if (tree.solid_added() != 0) {
    text += "coarsened to fit: " + counted(tree.solid_added(), "voxel") + " of solid volume added\n";
  }
  return text;
}

Stats baked_stats(const BakeCommand& command, const SceneSource& source, const Baked& baked,
                  std::optional<std::uint64_t> limit) {
  const CompactTree& tree = baked.scene.tree();
  Stats stats(command.scene, source);
  stats.depth = tree.level();
  stats.voxels = tree.voxel_count();
  stats.nodes = tree.node_count();
  stats.tree_bytes = tree.size_bytes();
  stats.budget_bytes = limit.value_or(baked.bytes.size());
  stats.high_water_bytes = baked.work_bytes;
  stats.solid_added = tree.solid_added();
  stats.build_seconds = baked.seconds;
  stats.baked_bytes = baked.bytes.size();
  stats.baked_crc32 = crc_text(baked.scene.crc32());
  return stats;
}

Baked bake(BakeCommand* command, const SceneSource& source, BakingOptions* options) {
  *options = baking_options(*command, source, &command->note);
  options->coarsen = command->scene.coarsen;
  const bool lit = options->default_look;
  Baked baked = with_progress("baking", command->scene.quiet, [&](const Progress& progress) {
    return bake_within(command->limit(), source, options, progress);
  });
  if (command->room && command->room(baked.effects) == 0) {
    throw InputError(not_drawn_text(*command, baked.effects));
  }
  if (!baked.fits) {
    throw InputError(too_large_text(command->limit(), baked, *options, source.level()),
                     options->coarsen ? "" : advice(*command, source, baked.effects));
  }
  command->lost_light = lit && !options->default_look;
  return baked;
}

std::string not_drawn_text(const BakeCommand& command, EffectSet effects) {
  return "calls for " + effects_text(effects) + ", which no image for " + command.scene.board->name +
         " draws together; --effects none or fewer of them may do, and make firmware SCENE=... builds a "
         "program "
         "for them";
}

void add_fitting(CLI::App& app, BakeCommand* command) {
  add_bytes(app, "--memory", &command->scene.memory_bytes,
            "the most bytes that the baked scene may take, such as 65536, 64K or 2M (default: no limit)");
  add_flag(app, "--coarsen", &command->scene.coarsen,
           "when it does not fit, merge blocks of voxels until it just does; this only adds solid");
}

void add_bake_options(CLI::App& app, BakeCommand* command) {
  command->scene.add_scene(app);
  add_text_option(
      app, "-o,--output", "FILE",
      [command](const std::string& text) {
        command->output = text;
        command->as_header = ends_in(text, ".h");
        return text == "-" || command->as_header || ends_in(text, ".oct") ? "" : "does not end in .oct or .h";
      },
      "the bytes as a file (.oct) or as a C and C++ header (.h); - is the bytes on standard output")
      ->required();
  add_fitting(app, command);
  add_board(app, &command->scene.board,
            "the limit is what the demonstration leaves of the board's flash (the smaller counts if --memory "
            "is given too), and the camera frames the scene for its display, so that all of it stays in the "
            "picture while it turns");
  add_flag(app, "--brick-map", &command->brick_map,
           "add a table that makes frames on a chip several times faster, in worlds of up to 1,024 a side "
           "(256 on most boards), as long as all keeps the limit; --board always does");
  add_effect_list(
      app, &command->effects,
      "what the scene is baked for: auto (what its materials and lights call for), none, or effects with "
      "commas between them; a header states the set as a macro, so that firmware holds no others (default: "
      "auto, for a file that states no light a sun over the viewer's shoulder with shadows and a light "
      "sky, for a mesh smooth-normals, and for a board's display of few greys edges instead of the sky; the "
      "ground, which is no voxels, and the gentle end of bright tones are drawn by thimble render, for the "
      "baked scene as for its file, and never by a chip)",
      "");
  add_text_option(
      app, "--name", "IDENT",
      [command](const std::string& text) {
        command->identifier = text;
        return is_identifier(text) ? "" : "cannot be the name of an array in C and C++";
      },
      "what a header calls the array; its macros begin with the same in capitals")
      ->default_str(kDefaultIdentifier);
  add_picture_view(app, &command->view);
  command->scene.add_report(app);
}

void add_bake(CLI::App& app) {
  CLI::App* sub = add_command(
      app, "bake", "Bake a scene: its compact tree, palette and camera as one block of bytes for flash.");
  BakeCommand* const command = options_for<BakeCommand>(*sub, run);
  add_bake_options(*sub, command);
}

}  // namespace thimble::tools
