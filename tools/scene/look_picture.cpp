#include "scene/look_picture.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

#include "scene/workers.h"
#include "thimble/light/render.h"

namespace thimble::tools {
namespace {

Shading shading_of(const LookCanvas& canvas, const Camera& camera) {
  const std::vector<Rgb8>& palette = canvas.look->palette;
  Shading shading =
      scene_shading(ShadeMode::kColor, {palette.data(), palette.size()}, camera, canvas.tree->bounds());
  for (std::uint16_t& light : shading.face_light) {
    light = static_cast<std::uint16_t>(2U * light / 3);
  }
  return shading;
}

// Draws the picture, `at_once` rows at a time: draw(first, how many), counted from its first row. `counts` is what the
// threads then counted.
template <class Draw>
Status paint_rows(std::int32_t at_once, const std::vector<LitCounts>& counts, const Progress& progress,
                  Painting* painting, const Draw& draw) {
  const std::int32_t height_px = painting->image.height_px;
  Status status = Status::kOk;
  for (std::int32_t y = 0; y < height_px && status == Status::kOk; y += at_once) {
    status = draw(y, std::min(at_once, height_px - y));
    tell(progress, static_cast<double>(y) / height_px);
  }
  for (const LitCounts& part : counts) {
    lit::add_counts(part, &painting->counts.lit);
  }
  painting->counts.all = totals_of(painting->counts.lit);
  return status;
}

// With samples where edges are: the rows that `canvas.work` has room for at a time.
Status paint_at_edges(const LookCanvas& canvas, std::uint32_t exposure, const Progress& progress,
                      Painting* painting) {
  Image& image = painting->image;
  const LookRows look(canvas, canvas.framing->camera, exposure);
  std::vector<LitCounts> counts(static_cast<std::size_t>(canvas.threads));
  std::vector<std::uint8_t> colors;  // of the samples that are drawn together
  const DrawPlaces draw_places = [&](const Camera& camera, Span<const SamplePlace> places, Bytes samples) {
    colors.resize(3 * places.size);
    return look.draw_places(camera, places, Bytes(colors.data(), colors.size()), samples, &counts[0]);
  };
  EdgeRows rows(canvas.framing->camera, canvas.fine, 4, canvas.threads,
                {[&](const SampleRun& run, Bytes samples, std::size_t worker) {
                   return look.draw_run(run, samples, &counts[worker]);
                 },
                 [&](std::int32_t px, std::int32_t py, const std::uint32_t* sums, std::uint32_t count) {
                   LookRows::finish_sums(px, py, sums, count, &image);
                 },
                 canvas.streams != nullptr ? draw_places : DrawPlaces()});
  const std::int32_t at_once = std::min(
      EdgeRows::rows_within(canvas.work.size, 4, image.width_px, canvas.threads, 0), image.height_px);
  return paint_rows(at_once, counts, progress, painting, [&](std::int32_t y, std::int32_t count) {
    return rows.draw(image.first_row + y, count, canvas.work);
  });
}

// Pixel by pixel, with all samples of each.
Status paint_whole(const LookCanvas& canvas, std::uint32_t exposure, const Progress& progress,
                   Painting* painting) {
  Image& image = painting->image;
  const LookRows rows(canvas, canvas.fine, exposure);
  const std::size_t row_bytes = look_work_bytes(image.width_px, canvas.look->across);
  const auto at_once = static_cast<std::int32_t>(
      std::min<std::size_t>(canvas.work.size / row_bytes, static_cast<std::size_t>(image.height_px)));
  std::vector<LitCounts> counts(static_cast<std::size_t>(canvas.threads));
  return paint_rows(at_once, counts, progress, painting, [&](std::int32_t y, std::int32_t count) {
    return rows.draw(image.first_row + y, count, canvas.work, &image, counts.data());
  });
}

// Rays that are traced together: a few for each lane of the widest vectors, little on the stack.
constexpr std::size_t kAtOnce = 256;

// Shares of what stands near the model: without what it closes off above. At most kAtOnce places.
Status darken_corners(const Look& look, const LitStreams& streams, Span<const Vec3Q8> places,
                      std::uint8_t* const* shares) {
  std::array<Ray, kAtOnce> rays;
  std::array<RayPoint, kAtOnce> entries;
  std::array<std::size_t, kAtOnce> place_of;  // by ray
  std::array<std::int64_t, kAtOnce> closed{};
  std::size_t count = 0;
  const auto trace = [&] {
    const Status status = streams.first_entry_before({rays.data(), count}, {look.ground.reach, kAroundLength},
                                                     {entries.data(), count});
    for (std::size_t ray = 0; ray < count; ++ray) {
      closed[place_of[ray]] +=
          entries[ray].t_denominator == 0 ? 0 : closed_at(entries[ray], look.ground.reach);
    }
    count = 0;
    return status;
  };
  Status status = Status::kOk;
  for (std::size_t place = 0; place < places.size && status == Status::kOk; ++place) {
    for (const Vec3i& direction : kAround) {
      place_of[count] = place;
      rays[count++] = {places.data[place], direction};
    }
    if (count + kAroundCount > kAtOnce) {
      status = trace();
    }
  }
  if (status == Status::kOk) {
    status = trace();
  }
  for (std::size_t place = 0; place < places.size; ++place) {
    *shares[place] = in_corner(*shares[place], closed[place]);
  }
  return status;
}

// Of at most kAtOnce rays. On an error the shares are not to be used.
Status find_in_vectors(const CompactTree& tree, const Look& look, const LitStreams& streams,
                       Span<const Ray> rays, std::uint8_t* shares) {
  std::array<std::uint8_t, kAtOnce> hits;
  Status status = streams.any_hit(rays, {hits.data(), rays.size});
  std::array<Vec3Q8, kAtOnce> places;
  std::array<std::uint8_t*, kAtOnce> lights;
  std::size_t count = 0;  // that meet the ground
  for (std::size_t i = 0; i < rays.size; ++i) {
    shares[i] = hits[i] != 0 ? kNothingBehind : kFullShare;
    if (hits[i] == 0 && meets_ground(tree, look.ground, rays.data[i], &places[count])) {
      lights[count++] = shares + i;
    }
  }
  if (status == Status::kOk && look.ground.toward_sun.z > 0) {
    std::array<Ray, kAtOnce> toward_sun;
    for (std::size_t i = 0; i < count; ++i) {
      toward_sun[i] = {places[i], look.ground.toward_sun};
    }
    status = streams.any_hit({toward_sun.data(), count}, {hits.data(), count});
    for (std::size_t i = 0; i < count; ++i) {
      *lights[i] = hits[i] != 0 ? in_shadow(*lights[i]) : *lights[i];
    }
  }
  std::size_t near = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (is_near_model(tree, look.ground, places[i])) {
      places[near] = places[i];
      lights[near++] = lights[i];
    }
  }
  return status != Status::kOk ? status : darken_corners(look, streams, {places.data(), near}, lights.data());
}

}  // namespace

Camera fine_camera(const Framing& framing, Look* look) {
  const std::int32_t width_px = framing.camera.width_px() * look->across;
  const std::int32_t height_px = framing.camera.height_px() * look->across;
  Camera fine;
  if (std::max(width_px, height_px) > kMaxPicturePx ||
      set_camera(framing.kept, width_px, height_px, framing.camera.level(), &fine) != Status::kOk) {
    look->across = 1;
    look->at_edges = false;
    return framing.camera;
  }
  return fine;
}

LookRows::LookRows(const LookCanvas& canvas, const Camera& camera, std::uint32_t exposure)
    : canvas_(canvas),
      camera_(camera),
      shading_(shading_of(canvas, camera)),
      scene_(canvas.look->lit_scene()),
      tone_(tone_table(exposure)),
      finds_shares_(canvas.look->has_backdrop && canvas.streams != nullptr &&
                    canvas.streams->finds_shares()) {}

LitView LookRows::view_of(const Camera& camera) const {
  return {canvas_.look->effects, camera, shading_, scene_, finds_shares_ ? &canvas_.look->ground : nullptr};
}

Status LookRows::trace_colors(const Camera& camera, std::int32_t first_row, std::int32_t rows, Bytes colors,
                              Bytes shares, LitCounts* counts) const {
  Band band;
  band.pixels = colors;
  band.first_row = first_row;
  band.rows = rows;
  return canvas_.streams != nullptr
             ? canvas_.streams->render(view_of(camera), band, counts, shares)
             : render_lit_band(canvas_.look->effects, *canvas_.tree, camera, shading_, scene_, band, counts);
}

void LookRows::find_shares(const Camera& camera, std::int32_t first_row, std::int32_t rows,
                           Bytes shares) const {
  if (finds_shares_) {
    return;
  }
  thread_local std::vector<Ray> row;
  const auto width = static_cast<std::size_t>(camera.width_px());
  row.resize(width);
  for (std::int32_t y = first_row; y < first_row + rows; ++y) {
    RowRays rays(camera, 0, y);
    for (Ray& ray : row) {
      ray = rays.ray();
      rays.next();
    }
    find_light_behind(*canvas_.tree, *canvas_.look, canvas_.streams, {row.data(), width},
                      shares.data + width * static_cast<std::size_t>(y - first_row));
  }
}

Status LookRows::trace(const Camera& camera, std::int32_t first_row, std::int32_t rows, Bytes colors,
                       Bytes shares, LitCounts* counts) const {
  const Status status = trace_colors(camera, first_row, rows, colors, shares, counts);
  if (status == Status::kOk) {
    find_shares(camera, first_row, rows, shares);
  }
  return status;
}

Status LookRows::draw(std::int32_t y, std::int32_t rows, Bytes work, Image* image, LitCounts* counts) const {
  const int across = canvas_.look->across;
  const auto samples = static_cast<std::size_t>(camera_.width_px()) * static_cast<std::size_t>(across);
  const Bytes all_colors = work.subspan(0, 3 * samples * static_cast<std::size_t>(rows));
  const Bytes all_shares = work.subspan(all_colors.size, samples * static_cast<std::size_t>(rows));
  const bool has_streams = canvas_.streams != nullptr;
  const Status status = has_streams
                            ? trace_colors(camera_, y * across, rows * across, all_colors, all_shares, counts)
                            : Status::kOk;
  if (status != Status::kOk) {
    return status;
  }
  const int threads = has_streams ? canvas_.streams->threads() : canvas_.threads;
  return each_until_error(rows, threads, [&](std::int32_t row, std::size_t thread) {
    const std::int32_t first = (y + row) * across;
    const Bytes colors = all_colors.subspan(3 * samples * static_cast<std::size_t>(row), 3 * samples);
    const Bytes shares = all_shares.subspan(samples * static_cast<std::size_t>(row), samples);
    const Status traced =
        has_streams ? Status::kOk : trace_colors(camera_, first, across, colors, shares, counts + thread);
    find_shares(camera_, first, across, shares);
    for (std::int32_t x = 0; traced == Status::kOk && x < image->width_px; ++x) {
      finish(x, y + row, colors, shares, image);
    }
    return traced;
  });
}

Status LookRows::draw_run(const SampleRun& run, Bytes samples, LitCounts* counts) const {
  thread_local std::vector<std::uint8_t> traced;
  const auto count = static_cast<std::size_t>(run.count);
  traced.resize(4 * count);
  const Bytes colors(traced.data(), 3 * count);
  const Bytes shares(traced.data() + 3 * count, count);
  const Status status = trace(run.camera, run.row, 1, colors, shares, counts);
  const Rgb8 behind = backdrop_color(canvas_.look->background, run.py, canvas_.framing->camera.height_px());
  for (std::size_t x = 0; x < count && status == Status::kOk; ++x) {
    put_sample(colors.data + 3 * x, shares[x], behind, samples.data + 4 * x);
  }
  return status;
}

Status LookRows::draw_places(const Camera& camera, Span<const SamplePlace> places, Bytes colors,
                             Bytes samples, LitCounts* counts) const {
  const int threads = canvas_.streams != nullptr ? canvas_.streams->threads() : canvas_.threads;
  const auto tasks = static_cast<std::int32_t>((places.size + kAtOnce - 1) / kAtOnce);
  const auto each = [&](const auto& draw) {
    return each_until_error(tasks, threads, [&](std::int32_t task, std::size_t /*thread*/) {
      const std::size_t first = kAtOnce * static_cast<std::size_t>(task);
      return draw(static_cast<std::size_t>(task), first, std::min(first + kAtOnce, places.size));
    });
  };
  std::vector<std::uint8_t> shares(places.size);
  const auto find = [&](std::size_t /*task*/, std::size_t first, std::size_t end) {
    std::array<Ray, kAtOnce> rays;
    for (std::size_t i = first; i < end; ++i) {
      rays[i - first] = camera.ray(places.data[i].x, places.data[i].y);
    }
    find_light_behind(*canvas_.tree, *canvas_.look, canvas_.streams, {rays.data(), end - first},
                      shares.data() + first);
    return Status::kOk;
  };
  if (!finds_shares_) {
    (void)each(find);
  }
  const auto is_traced = [&](std::size_t i) {
    return finds_shares_ || counts != nullptr || shares[i] == kNothingBehind;
  };
  // Where light behind is seen these rays hit nothing: they are traced only to be counted.
  std::vector<SamplePlace> wanted;
  std::vector<std::size_t> before(static_cast<std::size_t>(tasks));  // colours of the tasks before
  for (std::size_t i = 0; i < places.size; ++i) {
    if (i % kAtOnce == 0) {
      before[i / kAtOnce] = wanted.size();
    }
    if (is_traced(i)) {
      wanted.push_back(places.data[i]);
    }
  }
  const Status status = trace_places(camera, {wanted.data(), wanted.size()}, colors,
                                     Bytes(shares.data(), shares.size()), counts);
  if (status != Status::kOk) {
    return status;
  }
  return each([&](std::size_t task, std::size_t first, std::size_t end) {
    const std::uint8_t* color = colors.data + 3 * before[task];
    for (std::size_t i = first; i < end; ++i) {
      const Rgb8 behind =
          backdrop_color(canvas_.look->background, places.data[i].py, canvas_.framing->camera.height_px());
      put_sample(color, shares[i], behind, samples.data + 4 * i);
      color += is_traced(i) ? 3 : 0;
    }
    return Status::kOk;
  });
}

Status LookRows::trace_places(const Camera& camera, Span<const SamplePlace> places, Bytes colors,
                              Bytes shares, LitCounts* counts) const {
  if (canvas_.streams != nullptr) {
    return canvas_.streams->render_pixels(view_of(camera), places, colors, counts, shares);
  }
  return each_until_error(static_cast<std::int32_t>(places.size), canvas_.threads,
                          [&](std::int32_t place, std::size_t /*thread*/) {
                            const auto i = static_cast<std::size_t>(place);
                            return trace_colors(camera.window(places.data[i].x, places.data[i].y, 1, 1), 0, 1,
                                                colors.subspan(3 * i, 3), {}, nullptr);
                          });
}

void LookRows::finish_sums(std::int32_t x, std::int32_t y, const std::uint32_t* sums, std::uint32_t count,
                           Image* image) {
  const auto pixel =
      static_cast<std::size_t>(y - image->first_row) * static_cast<std::size_t>(image->width_px) +
      static_cast<std::size_t>(x);
  const std::uint32_t cover = sums[3];
  for (std::size_t c = 0; c < 3; ++c) {
    image->pixels[3 * pixel + c] = static_cast<std::uint8_t>(
        image->alpha.empty() ? (sums[c] + count / 2) / count
        : cover == 0         ? 0  // what is behind is black, so the sum is the cover's colour
                             : std::min(255U, (sums[c] * 255 + cover / 2) / cover));
  }
  if (!image->alpha.empty()) {
    image->alpha[pixel] = static_cast<std::uint8_t>((cover + count / 2) / count);
  }
}

// A sample with its tone, or with what is behind it, and how much of it covers that. Where light is seen behind it the
// colour is not looked at.
void LookRows::put_sample(const std::uint8_t* color, std::uint8_t share, Rgb8 behind,
                          std::uint8_t* to) const {
  const bool is_hit = share == kNothingBehind;
  const Rgb8 shown = is_hit ? tone_({color[0], color[1], color[2]}) : shaded(behind, share);
  to[0] = shown.r;
  to[1] = shown.g;
  to[2] = shown.b;
  to[3] = static_cast<std::uint8_t>(is_hit ? 255U : (kFullShare - share) * 255U / kFullShare);
}

// The mean of a pixel's samples.
void LookRows::finish(std::int32_t x, std::int32_t y, Bytes colors, Bytes shares, Image* image) const {
  const int across = canvas_.look->across;
  const Rgb8 behind = backdrop_color(canvas_.look->background, y, camera_.height_px() / across);
  std::array<std::uint32_t, 4> sums{};
  for (int j = 0; j < across; ++j) {
    for (int i = 0; i < across; ++i) {
      const auto at = static_cast<std::size_t>(j) * static_cast<std::size_t>(camera_.width_px()) +
                      static_cast<std::size_t>(x * across + i);
      std::array<std::uint8_t, 4> sample;
      put_sample(colors.data + 3 * at, shares[at], behind, sample.data());
      for (std::size_t c = 0; c < sums.size(); ++c) {
        sums[c] += sample[c];
      }
    }
  }
  finish_sums(x, y, sums.data(), static_cast<std::uint32_t>(across * across), image);
}

LookMeasure measure_look(const LookCanvas& canvas) {
  if (canvas.look->kind == LookKind::kStars) {
    return {};
  }
  const std::int32_t longest = std::max(canvas.fine.width_px(), canvas.fine.height_px());
  const Camera coarse = canvas.fine.thinned((longest + kExposurePx - 1) / kExposurePx);
  const LookRows rows(canvas, coarse, 256);
  GrayCounts counts;
  LitCounts traced;
  std::array<std::uint8_t, std::size_t{4} * kExposurePx> work{};
  const auto width = static_cast<std::size_t>(coarse.width_px());
  for (std::int32_t y = 0; y < coarse.height_px(); ++y) {
    const Bytes colors(work.data(), 3 * width);
    const Bytes shares(work.data() + 3 * width, width);
    if (rows.trace(coarse, y, 1, colors, shares, &traced) != Status::kOk) {
      return {};  // painting will say why
    }
    for (std::size_t x = 0; x < width; ++x) {
      if (shares[x] == kNothingBehind) {
        ++counts.of[gray_of({colors[3 * x], colors[3 * x + 1], colors[3 * x + 2]})];
      }
    }
  }
  const Camera& whole = canvas.framing->camera;
  const auto pixels = [](const Camera& camera) {
    return static_cast<std::uint64_t>(camera.width_px()) * static_cast<std::uint64_t>(camera.height_px());
  };
  return {is_dark_but_for_glow(canvas.look->lit_scene()) ? kOwnColorsQ8 : exposure_q8(counts),
          totals_of(traced).rays * 4 * pixels(whole) / pixels(coarse)};
}

Status paint_look(const LookCanvas& canvas, std::uint32_t exposure, const Progress& progress,
                  Painting* painting) {
  const Look& look = *canvas.look;
  *painting = {};
  Image& image = painting->image;
  image.width_px = canvas.framing->camera.width_px();
  image.height_px = canvas.rows.count != 0 ? canvas.rows.count : canvas.framing->camera.height_px();
  image.first_row = canvas.rows.first;
  const auto pixels = static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px);
  image.pixels.resize(3 * pixels);
  if (look.background.kind == BackgroundKind::kNone) {
    image.alpha.resize(pixels);
  }
  const auto start = std::chrono::steady_clock::now();
  Status status = Status::kOk;
  if (look.kind == LookKind::kStars) {
    status = paint_stars(canvas, progress, painting);
  } else {
    painting->engine = canvas.streams != nullptr ? canvas.streams->name() : "lit";
    painting->threads = canvas.streams != nullptr ? canvas.streams->threads() : canvas.threads;
    status = look.at_edges ? paint_at_edges(canvas, exposure, progress, painting)
                           : paint_whole(canvas, exposure, progress, painting);
  }
  painting->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return status;
}

void find_light_behind(const CompactTree& tree, const Look& look, const LitStreams* streams,
                       Span<const Ray> rays, std::uint8_t* shares) {
  if (!look.has_backdrop) {
    std::fill(shares, shares + rays.size, kNothingBehind);
    return;
  }
  for (std::size_t first = 0; first < rays.size; first += kAtOnce) {
    const Span<const Ray> some{rays.data + first, std::min(kAtOnce, rays.size - first)};
    if (streams != nullptr && find_in_vectors(tree, look, *streams, some, shares + first) == Status::kOk) {
      continue;
    }
    for (std::size_t i = 0; i < some.size; ++i) {
      if (!light_behind(tree, look.ground, some.data[i], shares + first + i)) {
        shares[first + i] = kNothingBehind;
      }
    }
  }
}

}  // namespace thimble::tools
