#include "commands/part_options.h"

#include "commands/arguments.h"
#include "commands/render_command.h"
#include "output/output_file.h"
#include "output/units.h"
#include "scene/film.h"

namespace thimble::tools {
namespace {

// "FIRST:COUNT"; nothing for anything else.
std::optional<RowRange> parse_range(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    return std::nullopt;
  }
  const auto first = parse_whole(text.substr(0, colon), 0, INT32_MAX);
  const auto count = parse_whole(text.substr(colon + 1), 1, INT32_MAX);
  if (!first || !count) {
    return std::nullopt;
  }
  return RowRange{static_cast<std::int32_t>(*first), static_cast<std::int32_t>(*count)};
}

void check_part(const RenderCommand& command) {
  if (command.rows && command.is_film()) {
    refuse_usage("--rows is a part of a picture; of a film with --turntable or --camera-path take --part");
  }
  if (command.frames && !command.is_film()) {
    refuse_usage(
        "--part is a part of a film, which wants --turntable or --camera-path; of a picture take --rows");
  }
  if (!command.hits_path.empty() || !command.depth_path.empty()) {
    refuse_usage("--hits and --depth-image are of whole pictures, without --rows and --part");
  }
  const std::string& name = command.output;
  if (name != "-" && (image_kind(name) || is_film(name))) {
    refuse_usage("--output", in_quotes(name) +
                                 " is named as a picture or a film, and --rows and --part write a "
                                 "part of one for thimble join: call it F.part");
  }
  if (is_mono_part(name) && (command.is_film() || command.look.background.kind == BackgroundKind::kNone)) {
    refuse_usage("--output", in_quotes(name) +
                                 " is named as rows of a .pbm, which holds neither films nor what is "
                                 "transparent");
  }
}

}  // namespace

void add_range(CLI::App& app, const std::string& name, std::optional<RowRange>* range,
               const std::string& help) {
  add_text_option(
      app, name, "FIRST:COUNT",
      [range](const std::string& text) {
        *range = parse_range(text);
        return *range ? "" : "is not FIRST:COUNT, whole numbers from 0 and from 1";
      },
      help);
}

void check_range(const std::string& name, const RowRange& range, std::int64_t all,
                 const std::string& of_what) {
  if (std::int64_t{range.first} + range.count > all) {
    refuse_usage(name, std::to_string(range.first) + ":" + std::to_string(range.count) + " goes beyond " +
                           of_what + ", whose last is " + std::to_string(all - 1));
  }
}

bool is_mono_part(const std::string& output) {
  return output.ends_with(".pbm.part");
}

void check_output(const RenderCommand& command) {
  if (command.rows || command.frames) {
    check_part(command);
    return;
  }
  const bool named_film = is_film(command.output);
  if (!named_film && !image_kind(command.output)) {
    refuse_usage("--output", in_quotes(command.output) + " does not end in .ppm, .pgm, .pbm or .png");
  }
  if (named_film != command.is_film()) {
    refuse_usage(named_film ? "a .gif and a .y4m are films, which want --turntable or --camera-path"
                            : "--turntable and --camera-path make a film: -o wants a .gif or .y4m");
  }
}

void write_rows(OutputFile* file, PartHeader header, const Image& image, std::int32_t height_px) {
  header.kind = PartKind::kRows;
  header.pixels = image.format == PixelFormat::kMono1 ? PartPixels::kMono
                  : image.alpha.empty()               ? PartPixels::kRgb
                                                      : PartPixels::kRgba;
  header.width_px = static_cast<std::uint32_t>(image.width_px);
  header.height_px = static_cast<std::uint32_t>(height_px);
  header.first = static_cast<std::uint32_t>(image.first_row);
  header.count = static_cast<std::uint32_t>(image.height_px);
  header.all = header.height_px;
  PartWriter part(file, header);
  part.add(header.pixels == PartPixels::kMono ? image.pixels : file_pixels(image, ImageKind::kPng));
  part.end();
}

}  // namespace thimble::tools
