
#include <zlib.h>

#include <cmath>

#include "commands/render_command.h"
#include "scene/animation.h"

namespace thimble::tools {
namespace {

constexpr const char* kFilmOptions = "--turntable, --camera-path or --frames";

// Whether a part of that name is drawn in one bit a pixel.
bool is_mono_part(const std::string& output) {
  return output.ends_with(".pbm.part");
}

void check_range(const std::string& name, const RowRange& range, std::int64_t all,
                 const std::string& of_what) {
  refuse_if(std::int64_t{range.first} + range.count > all, name, ": ", range.first, ":", range.count,
            " goes beyond ", of_what, ", whose last is ", all - 1);
}

void add_range(CLI::App& app, const std::string& name, std::optional<RowRange>* range,
               const std::string& help) {
  add_text_option(
      app, name, "FIRST:COUNT",
      [range](const std::string& text) {
        const auto pair = parse_pair(text, ':', 0, INT32_MAX);
        *range = pair ? std::optional(RowRange{pair->first, pair->second}) : std::nullopt;
        return pair ? "" : "is not FIRST:COUNT, whole numbers from 0 and from 1";
      },
      help);
}

void check_part(const RenderOutput& output, bool is_transparent) {
  refuse_if(output.rows && output.is_film(), "--rows is a part of a picture; of a film with ",
            output.film_option(), " take --part");
  refuse_if(output.frames && !output.is_film(), "--part is a part of a film, which wants ", kFilmOptions,
            "; of a picture take --rows");
  refuse_if(!output.hits_path.empty() || !output.depth_path.empty(),
            "--hits and --depth-image are of whole pictures, without --rows and --part");
  const std::string& name = output.path;
  refuse_if(name != "-" && (image_kind(name) || is_film(name) || names_page(name)),
            "--output: ", in_quotes(name),
            " is named as a picture or a film, and --rows and --part write a part of one for thimble join: "
            "call it F.part");
  refuse_if(is_mono_part(name) && (output.is_film() || is_transparent), "--output: ", in_quotes(name),
            " is named as rows of a .pbm, which holds neither films nor what is transparent");
}

// A grid knows neither materials nor light.
void add_grid(const DenseGrid& grid, CrcSum* sum) {
  const Vec3i size = grid.size();
  std::vector<std::uint8_t> row(static_cast<std::size_t>(size.x + 7) / 8);
  for (Vec3i at; at.z < size.z; ++at.z) {
    for (at.y = 0; at.y < size.y; ++at.y) {
      row.assign(row.size(), 0);
      for (at.x = 0; at.x < size.x; ++at.x) {
        const auto byte = static_cast<std::size_t>(at.x) / 8;
        row[byte] = static_cast<std::uint8_t>(row[byte] | (grid.solid_at(at) ? 1U << (at.x & 7) : 0U));
      }
      sum->add(row);
    }
  }
}

void add_tree(const CompactTree& tree, const SceneSource& source, CrcSum* sum) {
  sum->add(std::span(tree.bytes(), tree.size_bytes()));
  LitDescription lit = source.lighting();
  const UsedMaterials used = used_materials(tree);
  lit.find_glow(tree);
  add_lighting(lit, used, called_for(lit, used), tree.level(), sum);
}

// By the bytes that it has as a compact tree.
void add_pool(const Octree& pool, const SceneSource& source, CrcSum* sum) {
  std::vector<std::uint8_t> bytes(compact_bytes(compact_shape(pool)));
  CompactTree tree;
  fail_if(CompactTree::make(pool, {bytes.data(), bytes.size()}, &tree) != Status::kOk,
          "is too large for parts of a picture with --structure pool");
  add_tree(tree, source, sum);
}

std::uint32_t scene_crc32(const SceneSource& source, const BuiltScene& built) {
  const Structure& traced = built.traced();
  CrcSum sum;
  sum.add_all(built.level(), traced.kind == StructureKind::kDense);
  for (const Rgb8& color : built.palette()) {
    sum.add_all(color.r, color.g, color.b);
  }
  switch (traced.kind) {
    case StructureKind::kDense:
      add_grid(traced.dense, &sum);
      break;
    case StructureKind::kPool:
      add_pool(traced.pool, source, &sum);
      break;
    case StructureKind::kCompact:
      add_tree(traced.compact, source, &sum);
      break;
  }
  return sum.value();
}

void add_camera(const SceneCamera& camera, CrcSum* sum) {
  sum->add_all(camera.is_perspective, camera.direction_bits, camera.fov_degrees.raw, camera.span.raw);
  sum->add_all(camera.eye.x.raw, camera.eye.y.raw, camera.eye.z.raw);
  sum->add_all(camera.target.x.raw, camera.target.y.raw, camera.target.z.raw);
  sum->add_all(camera.forward.x, camera.forward.y, camera.forward.z);
  sum->add_all(camera.up.x, camera.up.y, camera.up.z);
}

}  // namespace

void RenderOutput::add_films(CLI::App& app) {
  add_whole_option(
      app, "--turntable", "N", 2, 1000, &turntable,
      "a film of N frames once around the scene, six seconds long where that is 1 to 50 frames a "
      "second; in an .html, which turns by itself, N tenths of a second");
  add_path_option(
      app, "--camera-path", "FILE.csv", &camera_path,
      std::string("a film of a frame a line, 25 a second; a header line is allowed; ") + kPathColumns);
  add_real_option(
      app, "--seconds", "S", 0.04, 3600, [this](double given) { seconds = given; },
      "with --camera-path: S seconds from each line to the next, on a smooth way through them all");
  app.get_option("--seconds")->needs(app.get_option("--camera-path"));
  add_text_option(
      app, "--frames", "A:B",
      [this](const std::string& text) {
        const std::size_t colon = std::min(text.find(':'), text.size());
        const auto first = parse_whole(text.substr(0, colon), 0, INT32_MAX - 1);
        const auto last = parse_whole(text.substr(std::min(colon + 1, text.size())), 0, INT32_MAX - 1);
        const bool is_known = first && last && *first <= *last && *last - *first < kMostFilmFrames;
        played.reset();
        if (is_known) {
          played = {static_cast<std::int32_t>(*first), static_cast<std::int32_t>(*last - *first + 1)};
        }
        return is_known ? "" : "is not A:B, the first and the last of at most 100,000 frames";
      },
      "a film of the frames A to B of a .vox animation, counted from 0, ten a second");
  for (const char* const place : {"--eye", "--target", "--up", "--view", "--turn", "--tilt", "--turntable"}) {
    app.get_option("--camera-path")->excludes(app.get_option(place));
  }
  for (const char* const other : {"--frame", "--turntable", "--camera-path"}) {
    app.get_option("--frames")->excludes(app.get_option(other));
  }
  add_range(
      app, "--rows", &rows,
      "draw only COUNT rows of the picture from row FIRST on, counted from 0 at the top, and write them as a "
      "part for thimble join; name it F.part, and with --effects for a .pbm F.pbm.part");
  add_range(app, "--part", &frames,
            std::string("with ") + kFilmOptions +
                ": draw only COUNT frames of the film from its frame FIRST on, counted from 0, and write "
                "them as a part for thimble join");
}

std::string RenderOutput::whole_path() const {
  return is_film() && is_sequence(path) ? "" : path;
}

std::vector<std::string> RenderOutput::sequence() const {
  return is_film() && !frames ? sequence_names(path, static_cast<std::size_t>(film_frames()))
                              : std::vector<std::string>();
}

ImageKind RenderOutput::kind(ImageKind of_rows) const {
  if (rows) {
    return is_mono_part(path) ? ImageKind::kPbm : of_rows;
  }
  return image_kind(path).value_or(ImageKind::kPpm);
}

void RenderOutput::check(bool is_transparent) const {
  if (rows || frames) {
    check_part(*this, is_transparent);
    return;
  }
  if (names_page(path)) {
    return;
  }
  const bool named_film = tools::is_film(path);
  refuse_if(!named_film && !image_kind(path), "--output: ", in_quotes(path), " does not end in ",
            kImageEndings, ", as pictures do, nor in .gif or .y4m, as films, nor in .html, as pages");
  refuse_if(named_film ? !is_film() : is_film() && !is_sequence(path),
            named_film ? std::string("a .gif and a .y4m are films, which want ") + kFilmOptions
                       : std::string(film_option()) + " makes a film: -o wants a " + kFilmEndings);
}

void RenderOutput::read_sizes(const ViewWishes& view, bool fov_given) {
  if (rows) {
    check_range("--rows", *rows, view.height_px, concat("the picture of ", view.height_px, " rows"));
  }
  if (!camera_path.empty()) {
    cameras = read_camera_path(camera_path, view);
    refuse_if(cameras.has_fov && (fov_given || view.orthographic), "--camera-path: ",
              fov_given ? "its fov is the angle, without --fov"
                        : "its fov is the angle of --projection perspective");
  }
  if (seconds) {
    const int rate = FilmTimes(PartKind::kCameraPath, 1).frames;
    cameras = about(printable(camera_path),
                    [&] { return smoothed(cameras, static_cast<int>(std::lround(rate * *seconds))); });
  }
  if (frames) {
    const std::int64_t all = film_frames();
    check_range("--part", *frames, all, concat("the film of ", all, " frames"));
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

void CrcSum::add(std::span<const std::uint8_t> bytes) {
  if (!bytes.empty()) {  // of no bytes at no address zlib says 0, whatever came before
    crc_ = static_cast<std::uint32_t>(crc32_z(crc_, bytes.data(), bytes.size()));
  }
}

void CrcSum::add(std::int64_t number) {
  std::array<std::uint8_t, 8> bytes{};
  put_little(bytes.data(), static_cast<std::uint64_t>(number), bytes.size());
  add(bytes);
}

std::string crc_of(std::span<const std::uint8_t> bytes) {
  CrcSum sum;
  sum.add(bytes);
  return crc_text(sum.value());
}

PartHeader part_header(const SceneSource& source, const BuiltScene& built,
                       const std::vector<Framing>& framings, const CrcSum& options) {
  PartHeader part;
  part.scene_crc32 = scene_crc32(source, built);
  CrcSum cameras;
  for (const Framing& framing : framings) {
    add_camera(framing.kept, &cameras);
  }
  part.camera_crc32 = cameras.value();
  part.options_crc32 = options.value();
  return part;
}

void add_lighting(const LitDescription& lit, const UsedMaterials& used, EffectSet effects, int level,
                  CrcSum* sum) {
  sum->add_all(effects, lit.rest.bounces);
  try {
    sum->add(lighting_section(lit, used, effects, level));
  } catch (const InputError&) {
    sum->add_all(lit.lights.size());  // beyond what bytes can say; drawing says why, or does without
  }
}

void add_look(const Look& look, int level, CrcSum* sum) {
  add_lighting(look.lighting, look.used, look.effects, level, sum);
  for (const Rgb8& color : look.palette) {
    sum->add_all(color.r, color.g, color.b);
  }
  const Rgb8 behind = look.background.color;
  sum->add_all(look.kind, look.has_own_colors, look.has_backdrop, look.background.kind, behind.r, behind.g,
               behind.b);
  sum->add_all(look.ground.is_there, look.ground.z, look.ground.toward_sun.x, look.ground.toward_sun.y,
               look.ground.toward_sun.z, look.ground.reach, look.at_edges ? 0 : look.across);
}

}  // namespace thimble::tools
