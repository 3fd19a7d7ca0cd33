// Pages to hand on, and thimble render SCENE -o F.html: one file that shows the scene and lets it be turned, without a
// network.
#include <zlib.h>

#include <cstdlib>
#include <filesystem>
#include <new>

#include "commands/render_command.h"
#include "output/plot.h"
#include "output/version.h"
#include "scene/baking.h"
#include "scene/named_scenes.h"

namespace thimble::tools {
namespace {

constexpr std::uint64_t kMostTemplateBytes = std::uint64_t{4} << 20;

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      word = word << 8 | (i < left ? bytes[at + i] : 0U);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      text += i <= left ? kDigits[word >> (18 - 6 * i) & 63U] : '=';
    }
  }
  return text;
}

constexpr std::size_t kMostPreviewBytes = 8000;
constexpr std::int32_t kPreviewPx = 320;  // the longer side of what stands for the file in a list
constexpr int kFramesASecond = 10;

// Each of the scene's frames that are to be shown, or the scene.
std::string scene_scripts(const RenderCommand& command, const SceneSource& first,
                          const LookPicture& picture) {
  std::string text;
  const auto add = [&](const SceneSource& source) {
    text += scene_element(page_scene(command, source, picture.camera));
  };
  add(first);
  for (std::int32_t i = 1; i < command.output.played.value_or(RowRange{}).count; ++i) {
    SceneArguments arguments = command.scene.arguments;
    arguments.frame = static_cast<std::uint32_t>(command.output.played->first + i);
    add(*open_scene(arguments));
  }
  return text;
}

// As share.cpp of tools/web reads it.
std::uint32_t background_number(const Background& background) {
  const Rgb8 color = background.color;
  return background.kind == BackgroundKind::kColor      ? 2U + (static_cast<std::uint32_t>(color.r) << 16 |
                                                           static_cast<std::uint32_t>(color.g) << 8 | color.b)
         : background.kind == BackgroundKind::kGradient ? 1U
                                                        : 0U;
}

}  // namespace

std::string load_page() {
  const char* const named = std::getenv("THIMBLE_WEB");
  const std::string folder = named != nullptr ? named : folder_beside_program("web");
  const std::string path = folder + "/share.html";
  std::error_code error;
  if (folder.empty() || !std::filesystem::exists(path, error)) {
    throw OutputError("there is no page to put the scene in" + (folder.empty() ? "" : " in " + folder) +
                      "; make web builds it, $THIMBLE_WEB says where it is");
  }
  return std::string(load_file(path, kMostTemplateBytes).text());
}

std::pair<std::string, std::string> around_scenes(
    const std::string& page, std::initializer_list<std::pair<std::string_view, std::string>> values) {
  const auto place_of = [](const std::string& text, const std::string& key) {
    const std::size_t at = text.find(key);
    if (at == std::string::npos) {
      throw OutputError("the page to put the scene in has no place for " + key + "; make web builds it anew");
    }
    return at;
  };
  const std::string scenes = "{{scenes}}";
  const std::size_t end = place_of(page, scenes);
  std::string before = page.substr(0, end);
  for (const auto& [name, value] : values) {
    const std::string key = "{{" + std::string(name) + "}}";
    for (std::size_t at = place_of(before, key); at != std::string::npos;
         at = before.find(key, at + value.size())) {
      before.replace(at, key.size(), value);
    }
  }
  return {std::move(before), page.substr(end + scenes.size())};
}

std::string poster_url(const Image& image, std::size_t most_bytes) {
  std::vector<unsigned char> file;
  for (int quality = 90; quality >= 10; quality -= 10) {
    file = jpeg_file(image.width_px, image.height_px, image.pixels, quality);
    if (file.size() <= most_bytes) {
      return "data:image/jpeg;base64," + base64(file);
    }
  }
  throw InputError("its picture takes ", grouped(file.size()), " bytes, and the poster of a page has ",
                   grouped(most_bytes), "; choose a smaller --size");
}

std::string edge_colors(const Image& image) {
  const std::uint8_t* const top = image.pixels.data();
  const std::uint8_t* const bottom = top + image.pixels.size() - 3 * static_cast<std::size_t>(image.width_px);
  return color_text(top) + ", " + color_text(bottom);
}

std::vector<std::uint8_t> page_scene(const RenderCommand& command, const SceneSource& source,
                                     const SceneCamera& camera, std::optional<std::uint64_t> most_bytes) {
  BakingOptions options;
  options.name = scene_name(command.scene.arguments.scene);
  options.limit_bytes = most_bytes;
  options.coarsen = most_bytes.has_value();
  options.default_look = source.baked() == nullptr;
  options.keeps_look = options.default_look;
  options.display = DisplayFacts{PixelFormat::kRgb888, command.view.width_px, command.view.height_px};
  options.camera = [&](const CompactTree&) { return camera; };
  const Baked baked = bake_scene(source, options);
  const std::span<const std::uint8_t> bytes = baked.bytes;
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::uint8_t> packed(size);
  if (compress2(packed.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 9) != Z_OK) {
    throw std::bad_alloc();
  }
  packed.resize(size);
  return packed;
}

std::string scene_element(std::span<const std::uint8_t> packed) {
  return "<script type=\"application/octet-stream\" data-scene>" + base64(packed) + "</script>\n";
}

bool names_page(std::string_view path) {
  return ends_in(path, ".html");
}

void check_page(const RenderCommand& command) {
  const RenderOutput& output = command.output;
  refuse_if(!takes_look(command) || command.quality.is_sampled || command.effects.choice.smooth ||
                command.effects.bounces || !output.hits_path.empty() || !output.depth_path.empty() ||
                !output.camera_path.empty(),
            "an .html shows the scene's own look to turn it, without --shade, --effects, --normals, "
            "--bounces, --samples, --structure, --engine, --cutoff, --max-depth, --board, --hits, "
            "--depth-image and --camera-path");
}

void render_page(const RenderCommand& command, const SceneSource& source, OutputSet& outputs) {
  const std::string page = load_page();
  const LookPicture picture = draw_look(command, source);
  RenderCommand small = command;
  const std::int32_t side = std::max(command.view.width_px, command.view.height_px);
  small.view.width_px = std::max(1, command.view.width_px * std::min(kPreviewPx, side) / side);
  small.view.height_px = std::max(1, command.view.height_px * std::min(kPreviewPx, side) / side);
  const std::string name = scene_name(command.scene.arguments.scene);
  const std::string title = xml_text(name.substr(0, name.find('.')));
  const auto [before, behind] = around_scenes(
      page, {{"description", counted(picture.stats.voxels, "voxel") +
                                 ", ray traced by Thimble. Drag to turn, wheel or pinch to come nearer."},
             {"version", kVersionNumber},
             {"colors", edge_colors(picture.image)},
             {"turn", shortest(static_cast<double>(command.output.turntable) / kFramesASecond)},
             {"background", std::to_string(background_number(command.look.wishes.background))},
             {"ground", std::to_string(command.look.wishes.ground ? *command.look.wishes.ground : -1)},
             {"preview", poster_url(draw_look(small, source).image, kMostPreviewBytes)},
             {"title", title}});
  OutputFile& file = *outputs[kPicture];
  file.write(before);
  file.write("<img id=\"poster\" alt=\"" + title + "\" src=\"" + poster_url(picture.image, kMostPosterBytes) +
             "\">\n");
  file.write(scene_scripts(command, source, picture));
  file.write(behind);
  finish(command, picture.stats, picture.note, outputs);
}

}  // namespace thimble::tools
