// Every public function of picture with any camera, shading, band and tree: refused with nothing drawn, or
// drawn
// within the band.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "misuse/odd_worlds.h"
#include "thimble/picture/anytime.h"
#include "thimble/picture/cutoff.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/render.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

const Rgb8 kPalette[] = {{1, 2, 3}, {250, 0, 0}, {0, 250, 0}, {0, 0, 250}};
const Span<const Rgb8> kColors(kPalette);

// Draws by `draw`; what is refused leaves the pixels alone.
template <class Draw>
void draw_band(OddValues& odd, const Camera& camera, Draw draw) {
  HeapBytes pixels;
  const Band band = odd_band(odd, camera, &pixels);
  const std::uint8_t filled = odd.any<std::uint8_t>();
  std::fill(pixels.span().begin(), pixels.span().end(), filled);
  if (draw(band) != Status::kOk) {
    CHECK(std::all_of(pixels.span().begin(), pixels.span().end(),
                      [&](std::uint8_t byte) { return byte == filled; }));
  }
}

void refine(OddValues& odd, const CompactTree& tree, const Camera& camera, const Shading& shading) {
  const auto format = static_cast<PixelFormat>(odd.bits() % 5);
  HeapBytes memory(odd_size(odd, anytime_bytes(camera.width_px(), camera.height_px(), format)));
  AnytimeFrame frame;
  (void)frame.refine(tree, odd.any<std::uint32_t>());
  if (AnytimeFrame::make(tree, camera, shading, format, memory.span(), &frame) == Status::kOk) {
    for (int i = 0; i < 4; ++i) {
      (void)frame.refine(tree, odd.one_in(2) ? odd.any<std::uint32_t>() : 500,
                         static_cast<Width>(odd.bits() % 3));
      (void)frame.mean_error_bound_q8();
      (void)frame.band(odd.any<std::int32_t>(), odd.any<std::int32_t>());
      CHECK(frame.inexact() <= frame.pixels());
    }
  }
}

}  // namespace

TEST_CASE(
    "misuse: any camera, shading and band over sound and damaged trees -> refused or drawn in the band") {
  misuse(20, 350, [](OddValues& odd) {
    const int level = odd.between_32(kMinLevel, 6);
    OddWorld world(odd, level);
    const OwnedMap made(world.compact, most_brick_map_bytes(world.compact));
    const BrickMap& map = made.map;
    if (odd.one_in(2)) {
      world.damage(odd);
    }
    for (int i = 0; i < 3; ++i) {
      const Camera camera = odd_camera(odd, level);
      const Shading shading = odd_shading(odd, kColors);
      const TraceOptions options = odd_options(odd);
      RenderCounts counts;
      RenderCounts* const counted = odd.one_in(2) ? &counts : nullptr;
      const auto draw = [&](const auto& tree) {
        draw_band(odd, camera, [&](const Band& band) {
          return render_band(tree, camera, shading, band, counted, options);
        });
      };
      draw(world.compact);
      draw(world.octree);
      draw(world.shared);
      draw(world.grid);
      draw_band(odd, camera, [&](const Band& band) {
        return render_band_32(world.compact, camera, shading, band, counted, options.max_visits);
      });
      draw_band(odd, camera, [&](const Band& band) {
        return render_band(world.compact, map, camera, shading, band, counted);
      });
      draw_band(odd, camera, [&](const Band& band) {
        return render_band_32(world.compact, map, camera, shading, band, counted);
      });
      (void)draws_fast(map, camera);
      Cutoff cutoff;
      (void)cutoff.set(camera, odd.one_in(2) ? Q16::from_raw(odd.any<std::int32_t>())
                                             : Q16::from_raw(odd.between_32(0, kMaxCutoff.raw)));
      (void)cutoff.set_level(odd.any_or(2, 0, kMaxLevel));
      HeapBytes color_bytes(odd_size(odd, node_colors_bytes(world.compact)));
      NodeColors colors;
      (void)NodeColors::make(world.compact, kColors, {9, 9, 9}, color_bytes.span(), &colors);
      draw_band(odd, camera, [&](const Band& band) {
        return render_band_cut(world.compact, camera, shading, cutoff, colors, band, counted, options);
      });
      CutHit cut;
      (void)closest_hit_cut(world.compact, odd_ray(odd, level), cutoff, &cut, options);
      refine(odd, world.compact, camera, shading);
      (void)depth_range(camera, world.compact.bounds());
    }
  });
}

TEST_CASE(
    "misuse: any map of level 9 and 10 under a tree, sound or damaged -> refused, or drawn in the band") {
  int opened = 0;
  misuse(23, 300, [&](OddValues& odd) {
    OddDeepWorld world(odd);
    const Camera camera = odd.one_in(2) ? odd_camera(odd, world.compact.level()) : world.near(odd);
    const Shading shading = odd_shading(odd, kColors);
    RenderCounts counts;
    RenderCounts* const counted = odd.one_in(2) ? &counts : nullptr;
    draw_band(odd, camera, [&](const Band& band) {
      const Status status = render_band(world.compact, world.map, camera, shading, band, counted);
      HeapBytes own(ConstBytes(band.pixels));
      Band same = band;
      same.pixels = own.span();
      CHECK(render_band(world.compact, camera, shading, same) == status);
      CHECK(std::equal(own.span().begin(), own.span().end(), band.pixels.begin()));
      return status;
    });
    draw_band(odd, camera, [&](const Band& band) {
      const Status status = render_band_32(world.compact, world.map, camera, shading, band, counted);
      CHECK(status == Status::kBadArgument);
      return status;
    });
    const auto draw = [&](const BrickMap& map) {
      (void)draws_fast(map, camera);
      draw_band(odd, camera, [&](const Band& band) {
        return render_band(world.compact, map, camera, shading, band, counted);
      });
    };
    // All but its tree's checksum may be wrong.
    HeapBytes bad(world.map_bytes.span());
    damage_deep_map(odd, bad.span());
    BrickMap map;
    if (BrickMap::open(bad.span(), &map) == Status::kOk) {
      draw(map);
      for (int i = 0; i < 4; ++i) {
        const Camera view = world.near(odd);
        HeapBytes pixels(band_bytes(PixelFormat::kGray8, view.width_px(), view.height_px()));
        const Band band{pixels.span(), PixelFormat::kGray8, 0, 0, view.height_px()};
        CHECK((view.width_px() == 0 || render_band(world.compact, map, view, shading, band) ==
                                           (map.belongs_to(world.compact) ? Status::kOk : Status::kDamaged)));
      }
      ++opened;
    }
    // Another tree's, of another level, and under a tree with other bytes behind its checksum.
    draw(BrickMap());
    const OddDeepWorld other(odd);
    draw(other.map);
    for (int i = 0; i < 6; ++i) {
      const std::size_t size = world.compact_bytes.span().size;
      if (size > kCompactHeaderBytes) {
        world.compact_bytes.span()[kCompactHeaderBytes + odd.bits() % (size - kCompactHeaderBytes)] =
            odd.any<std::uint8_t>();
      }
    }
    draw(world.map);
  });
  CHECK(opened > 30);
}

TEST_CASE("misuse: samples, colours and pixels of any numbers -> refused, or within their bytes") {
  misuse(22, 4000, [](OddValues& odd) {
    const int across = odd.any_or(3, 0, kMaxSamplesAcross + 1);
    const std::int32_t width = odd.any_or(3, 0, 70);
    const auto format = static_cast<PixelFormat>(odd.bits() % 5);
    const bool small = across >= 0 && across <= 16 && width >= 0 && width <= 1000;
    HeapBytes fine(odd_size(odd, small ? samples_bytes(width, across) : 64));
    HeapBytes row(odd_size(odd, small ? row_bytes(format, width) : 64));
    (void)average_samples(fine.span(), across, width, odd.any<std::int32_t>(), format, row.span());

    const int channels = odd.any_or(3, 0, 5);
    const std::size_t line =
        small && channels > 0 && channels < 5 ? static_cast<std::size_t>(width * channels) : 8;
    HeapBytes above(odd.one_in(3) ? 0 : odd_size(odd, line));
    HeapBytes below(odd.one_in(3) ? 0 : odd_size(odd, line));
    HeapBytes middle(odd_size(odd, line));
    HeapBytes strengths(odd_size(odd, small ? static_cast<std::size_t>(width) : 8));
    (void)edge_strengths(above.span(), middle.span(), below.span(), channels, width, strengths.span());
    (void)place_edge_samples(strengths.span(), width, strengths.span());

    Hit hit;
    hit.kind = static_cast<HitKind>(odd.bits() % 3);
    hit.axis = static_cast<std::int8_t>(odd.between(-1, 2));
    hit.material = odd.any<std::uint8_t>();
    hit.t_numerator = odd.between_32(0, 1 << 23);
    const Ray ray = good_ray(odd, 6);
    hit.t_denominator =
        hit.axis < 0 || ray.direction[hit.axis] == 0 ? 1 : 256 * std::abs(ray.direction[hit.axis]);
    const Camera camera = odd_camera(odd, 6);
    (void)shade(hit, ray, camera, odd_shading(odd, kColors));
    (void)planar_depth_q8(hit, camera);
    (void)face_of(hit, ray.direction);
    std::uint16_t face_light[6];
    Vec3i towards = odd.vector_between(-(1 << 14), 1 << 14);
    towards.x |= 1;
    light_from(towards, face_light);
    if (camera.width_px() != 0) {
      const Camera thin = camera.thinned(odd.between_32(1, 100));
      (void)thin.ray(thin.width_px() - 1, thin.height_px() - 1);
      const std::int32_t px = odd.between_32(0, camera.width_px() - 1);
      const std::int32_t py = odd.between_32(0, camera.height_px() - 1);
      const Camera window = camera.window(px, py, camera.width_px() - px, camera.height_px() - py);
      (void)window.ray(window.width_px() - 1, window.height_px() - 1);
    }
    (void)look_at(odd.any_point(), odd.any_point());
  });
}
