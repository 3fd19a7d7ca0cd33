// thimble render SCENE -o F.html: one file that shows the scene and lets it be turned, without a network. Its page and
// modules are a template that `make web` builds (platform/web/share.html); what is filled in is written here.
#include <zlib.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "commands/arguments.h"
#include "commands/render_command.h"
#include "output/png.h"
#include "output/units.h"
#include "output/version.h"
#include "readers/file_bytes.h"
#include "scene/baking.h"
#include "scene/named_scenes.h"

namespace thimble::tools {
namespace {

constexpr std::uint64_t kMostTemplateBytes = std::uint64_t{4} << 20;
constexpr std::size_t kMostPosterBytes = 60000;
constexpr std::size_t kMostPreviewBytes = 8000;
constexpr std::int32_t kPreviewPx = 320;  // the longer side of what stands for the file in a list
constexpr int kFramesASecond = 10;

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

std::vector<std::uint8_t> deflated(std::span<const std::uint8_t> bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::uint8_t> packed(size);
  if (compress2(packed.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 9) != Z_OK) {
    throw std::bad_alloc();
  }
  packed.resize(size);
  return packed;
}

// Without braces, either, which are the template's.
std::string for_html(std::string_view text) {
  std::string out;
  for (const char c : utf8_text(text, true)) {
    out += c == '&'   ? "&amp;"
           : c == '<' ? "&lt;"
           : c == '"' ? "&quot;"
           : c == '{' ? "&#123;"
                      : std::string(1, c);
  }
  return out;
}

std::string load_template() {
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

// A JPEG of that picture within so many bytes: as good as there is room for.
std::vector<unsigned char> poster_file(const Image& image, std::size_t most_bytes) {
  std::vector<unsigned char> file;
  for (int quality = 90; quality >= 10; quality -= 10) {
    file = jpeg_file(image.width_px, image.height_px, image.pixels, quality);
    if (file.size() <= most_bytes) {
      return file;
    }
  }
  throw InputError("its picture takes " + grouped(file.size()) + " bytes, and the poster of a page has " +
                   grouped(most_bytes) + "; choose a smaller --size");
}

std::string corner_color(const Image& image, std::int32_t row) {
  const std::uint8_t* const pixel =
      image.pixels.data() + static_cast<std::size_t>(row) * 3 * static_cast<std::size_t>(image.width_px);
  std::string text = "#";
  for (int channel = 0; channel < 3; ++channel) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    text += kDigits[pixel[channel] >> 4];
    text += kDigits[pixel[channel] & 15U];
  }
  return text;
}

// The bytes that the page shows: those of `thimble bake`, whose picture is that of the scene itself.
std::vector<std::uint8_t> baked_bytes(const RenderCommand& command, const SceneSource& source,
                                      const LookPicture& picture) {
  BakingOptions options;
  options.name = scene_name(command.scene.arguments.scene);
  options.brick_map = true;  // by which it moves fast
  options.default_look = source.baked() == nullptr;
  options.keeps_look = options.default_look;
  options.display = DisplayFacts{PixelFormat::kRgb888, command.view.width_px, command.view.height_px};
  options.camera = [&](const CompactTree&) { return picture.camera; };
  return bake_scene(source, options).bytes;
}

// Each of the scene's frames that are to be shown, or the scene.
std::string scene_scripts(const RenderCommand& command, const SceneSource& first,
                          const LookPicture& picture) {
  std::string text;
  const auto add = [&](const SceneSource& source) {
    text += "<script type=\"application/octet-stream\" data-scene>" +
            base64(deflated(baked_bytes(command, source, picture))) + "</script>\n";
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

void fill_in(std::string* page, std::string_view name, std::string_view value) {
  const std::string key = "{{" + std::string(name) + "}}";
  bool is_there = false;
  for (std::size_t at = page->find(key); at != std::string::npos; at = page->find(key, at + value.size())) {
    page->replace(at, key.size(), value);
    is_there = true;
  }
  if (!is_there) {
    throw OutputError("the page to put the scene in has no place for " + key + "; make web builds it anew");
  }
}

}  // namespace

bool names_page(std::string_view path) {
  return ends_in(path, ".html");
}

void check_page(const RenderCommand& command) {
  const RenderOutput& output = command.output;
  if (!takes_look(command) || command.quality.is_sampled || command.effects.choice.smooth ||
      command.effects.bounces || !output.hits_path.empty() || !output.depth_path.empty() ||
      !output.camera_path.empty()) {
    refuse_usage(
        "an .html shows the scene's own look to turn it, without --shade, --effects, --normals, "
        "--bounces, --samples, --structure, --engine, --cutoff, --max-depth, --board, --hits, "
        "--depth-image and --camera-path");
  }
}

void render_page(const RenderCommand& command, const SceneSource& source, OutputSet& outputs) {
  std::string page = load_template();
  const LookPicture picture = draw_look(command, source);
  RenderCommand small = command;
  const std::int32_t side = std::max(command.view.width_px, command.view.height_px);
  small.view.width_px = std::max(1, command.view.width_px * std::min(kPreviewPx, side) / side);
  small.view.height_px = std::max(1, command.view.height_px * std::min(kPreviewPx, side) / side);
  const std::string name = scene_name(command.scene.arguments.scene);
  fill_in(&page, "title", for_html(name.substr(0, name.find('.'))));
  fill_in(&page, "description",
          grouped(picture.stats.voxels) + (picture.stats.voxels == 1 ? " voxel" : " voxels") +
              ", ray traced by Thimble. Drag to turn, wheel or pinch to come nearer.");
  fill_in(&page, "version", version_number());
  fill_in(&page, "top", corner_color(picture.image, 0));
  fill_in(&page, "bottom", corner_color(picture.image, picture.image.height_px - 1));
  fill_in(&page, "turn", shortest(static_cast<double>(command.output.turntable) / kFramesASecond));
  fill_in(&page, "background", std::to_string(background_number(command.look.wishes.background)));
  fill_in(&page, "ground", std::to_string(command.look.wishes.ground ? *command.look.wishes.ground : -1));
  fill_in(&page, "preview", base64(poster_file(draw_look(small, source).image, kMostPreviewBytes)));
  fill_in(&page, "poster", base64(poster_file(picture.image, kMostPosterBytes)));
  fill_in(&page, "scenes", scene_scripts(command, source, picture));
  outputs[kPicture]->write(page);
  finish(command, picture.stats, picture.note, outputs);
}

}  // namespace thimble::tools
