// thimble join: parts of a picture or of a film, drawn apart, as the file that one process would have written.
#include "commands/commands.h"
#include "output/part_file.h"
#include "scene/animation.h"

namespace thimble::tools {
namespace {

struct JoinCommand {
  std::vector<std::string> parts;
  std::string output;
  bool quiet = false;
};

// The whole that parts make: for each row or frame the part that has it.
class Whole {
 public:
  explicit Whole(const std::vector<std::string>& paths) {
    for (const std::string& path : paths) {
      parts_.push_back(PartFile::open(path));
      check_belongs(parts_.back());
    }
    owners_.assign(header().all, kNone);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      place(i);
    }
    check_complete();
  }

  const PartHeader& header() const { return parts_.front().header(); }
  std::vector<std::uint8_t> read(std::uint32_t unit) const { return parts_[owners_[unit]].read(unit); }

 private:
  static constexpr std::size_t kNone = SIZE_MAX;

  void check_belongs(const PartFile& part) const {
    const PartHeader& one = header();
    const PartHeader& other = part.header();
    const auto refuse = [&](bool is_other, const auto&... why) {
      fail_if(is_other, printable(part.path()), ": does not belong to ", printable(parts_.front().path()),
              ": ", why...);
    };
    const auto size_of = [](const PartHeader& header) {
      return concat(header.width_px, "x", header.height_px);
    };
    const auto name = [](PartKind kind) {
      return kind == PartKind::kRows        ? "a picture"
             : kind == PartKind::kTurntable ? "a film by --turntable"
             : kind == PartKind::kAnimation ? "a film by --frames"
                                            : "a film by --camera-path";
    };
    refuse(other.kind != one.kind, "it is a part of ", name(other.kind), ", not of ", name(one.kind));
    refuse(other.width_px != one.width_px || other.height_px != one.height_px, "its size is ", size_of(other),
           ", not ", size_of(one));
    refuse(other.all != one.all, "its film has ", other.all, " frames, not ", one.all);
    refuse(other.scene_crc32 != one.scene_crc32,
           "it shows another scene, or one built otherwise (--depth, --frame, --coarsen and the like)");
    refuse(other.camera_crc32 != one.camera_crc32, "its camera is another");
    refuse(other.options_crc32 != one.options_crc32 || other.pixels != one.pixels ||
               other.has_finer_shades != one.has_finer_shades,
           "it was drawn with other options");
  }

  void place(std::size_t index) {
    const PartFile& part = parts_[index];
    const PartHeader& head = part.header();
    for (std::uint32_t unit = head.first; unit < head.first + head.count; ++unit) {
      if (owners_[unit] == kNone) {
        owners_[unit] = index;
      } else if (parts_[owners_[unit]].read(unit) != part.read(unit)) {
        throw InputError(printable(part.path()), ": differs from ", printable(parts_[owners_[unit]].path()),
                         " in ", head.unit(), " ", unit, ", which both hold");
      }
    }
  }

  void check_complete() const {
    constexpr int kMostNamed = 8;
    std::string text;
    std::uint32_t missing = 0;
    int gaps = 0;
    const auto all = static_cast<std::uint32_t>(owners_.size());
    for (std::uint32_t unit = 0; unit < all;) {
      std::uint32_t end = unit;
      while (end < all && owners_[end] == kNone) {
        ++end;
      }
      if (end != unit && ++gaps <= kMostNamed) {
        text += concat(text.empty() ? "" : ", ", unit, ":", end - unit);
      }
      missing += end - unit;
      unit = std::max(end, unit + 1);
    }
    fail_if(missing != 0, "of ", all, " ", header().unit(), "s these are missing (FIRST:COUNT): ", text,
            gaps > kMostNamed ? concat(" and ", gaps - kMostNamed, " gaps more") : "");
  }

  std::vector<PartFile> parts_;
  std::vector<std::size_t> owners_;
};

Image frame_of(const PartHeader& header, std::vector<std::uint8_t> pixels) {
  Image image;
  image.width_px = static_cast<std::int32_t>(header.width_px);
  image.height_px = static_cast<std::int32_t>(header.height_px);
  image.pixels = std::move(pixels);
  return image;
}

void join_film(const JoinCommand& command, const Whole& whole, OutputFile* file) {
  const PartHeader& header = whole.header();
  const auto frame = [&](std::size_t number) {
    return frame_of(header, whole.read(static_cast<std::uint32_t>(number)));
  };
  ProgressBar bar("joining", command.quiet);
  Film film(file, command.output, header.kind, header.all, frame);
  for (std::uint32_t i = 0; i < header.all; ++i) {
    film.add(frame(i));
    bar.update(static_cast<double>(i) / header.all);
  }
  film.end();
}

void join_picture(const JoinCommand& command, const Whole& whole, OutputFile* file) {
  const PartHeader& header = whole.header();
  Image image = frame_of(header, {});
  image.format = header.pixels == PartPixels::kMono ? PixelFormat::kMono1 : PixelFormat::kRgb888;
  for (std::uint32_t y = 0; y < header.all; ++y) {
    const std::vector<std::uint8_t> row = whole.read(y);
    if (header.pixels != PartPixels::kRgba) {
      image.pixels.insert(image.pixels.end(), row.begin(), row.end());
      continue;
    }
    for (std::size_t i = 0; i < row.size(); i += 4) {
      image.pixels.insert(image.pixels.end(), {row[i], row[i + 1], row[i + 2]});
      image.alpha.push_back(row[i + 3]);
    }
  }
  write_picture(file, command.output, image);
}

// What kind of file these parts can become.
void check_kind(const JoinCommand& command, const PartHeader& header) {
  const bool is_picture = header.kind == PartKind::kRows;
  refuse_if(is_picture ? is_film(command.output) : !is_film(command.output) && !is_sequence(command.output),
            "--output: ", in_quotes(command.output),
            (is_picture ? std::string(" is no picture, of which these parts are: ") + kImageEndings
                        : std::string(" is no film, of which these parts are: ") + kFilmEndings));
  const auto kind = image_kind(command.output);
  refuse_if(header.pixels == PartPixels::kRgba && kind != ImageKind::kPng,
            "--output: parts with --background none want a .png, the one that holds what is transparent");
  refuse_if(header.pixels == PartPixels::kMono && kind != ImageKind::kPbm,
            "--output: parts named .pbm.part are of one bit a pixel and make a .pbm only");
  refuse_if(header.has_finer_shades && kind == ImageKind::kPbm,
            "--output: a .pbm with light is dithered as it is drawn: name its parts F.pbm.part");
}

void run(const JoinCommand& command) {
  const Whole whole(command.parts);
  check_kind(command, whole.header());
  const bool is_picture = whole.header().kind == PartKind::kRows;
  OutputSet outputs(
      {is_picture || !is_sequence(command.output) ? command.output : ""}, command.parts,
      is_picture ? std::vector<std::string>() : sequence_names(command.output, whole.header().all));
  if (is_picture) {
    join_picture(command, whole, outputs[0]);
  } else {
    join_film(command, whole, outputs[0]);
  }
  outputs.commit();
}

}  // namespace

void add_join(CLI::App& app) {
  CLI::App* sub = add_command(app, "join", "Put parts of a picture or a film together.");
  JoinCommand* const command = options_for<JoinCommand>(*sub, run);
  sub->add_option(
         "parts", command->parts,
         "what render --rows or --part wrote, in any order: of one scene, camera, size and options; where "
         "they overlap they must agree")
      ->type_name("FILES")
      ->required();
  add_output_option(
      *sub, "-o,--output", "FILE", &command->output,
      [](const std::string& text) { return image_kind(text) || is_film(text); },
      std::string(".gif, .y4m, ") + kImageEndings,
      std::string("the picture (") + kImageEndings + "; - is a PPM on standard output) or film (" +
          kFilmEndings + "), byte for byte what one process would have written")
      ->required();
  add_flag(*sub, "--quiet", &command->quiet, "no progress bar on standard error");
}

}  // namespace thimble::tools
