// Frames by the map of bricks are those of the tree, byte for byte; frames that stop at small blocks; where samples go.
#include "portable/brick_world.h"
#include "portable/groups.h"
#include "portable/scene.h"
#include "thimble/base/memory.h"
#include "thimble/picture/cutoff.h"
#include "thimble/picture/render.h"

namespace thimble::portable {
namespace {

using namespace brick_world;

// --- Bricks

constexpr PixelFormat kFormats[] = {PixelFormat::kGray4, PixelFormat::kRgb565, PixelFormat::kRgb888,
                                    PixelFormat::kMono1, PixelFormat::kGray8};
constexpr uint32_t kBandBytes = 232;
constexpr uint32_t kBrickArena = kPoolBytes + kTreeBytes + kMapBytes + 2 * kBandBytes + sizeof(BrickMap) + 64;
static_assert(kBrickArena <= kLitArenaBytes);

// What frames are compared in: two bands.
struct Bands {
  explicit Bands(Check& check) : wanted(check.arena.take(kBandBytes)), drawn(check.arena.take(kBandBytes)) {}
  bool there() const { return wanted.size == kBandBytes && drawn.size == kBandBytes; }
  Bytes wanted;
  Bytes drawn;
};

// Draws the frame by the tree and by `map`, in bands of every format and shading.
void compare(Check& check, const BrickMap& map, const Bands& bands, int index) {
  for (int mode = 0; mode < 4; ++mode) {
    const PixelFormat format = kFormats[(index + mode) % 5];
    check.shading.mode = static_cast<ShadeMode>(mode);
    const int32_t fits = static_cast<int32_t>(kBandBytes / row_bytes(format, kWidth));
    // Bands of a tile's rows, and of others.
    const int32_t most = mode % 2 == 0 ? 8 : 5;
    const int32_t band_rows = fits < most ? fits : most;
    for (int32_t y = 0; y < kHeight; y += band_rows) {
      const int32_t rows = kHeight - y < band_rows ? kHeight - y : band_rows;
      set_band(check, bands.wanted, format, y, rows);
      for (uint8_t& byte : check.band.pixels) {
        byte = 0;
      }
      THIMBLE_REQUIRE_OK(
          render_band(check.world.compact, check.camera, check.shading, check.band, &check.counts));
      const uint64_t hits = check.counts.hits;
      const uint64_t rays = check.counts.rays;
      set_band(check, bands.drawn, format, y, rows);
      for (uint8_t& byte : check.band.pixels) {
        byte = 0;
      }
      THIMBLE_REQUIRE_OK(
          render_band(check.world.compact, map, check.camera, check.shading, check.band, &check.counts));
      THIMBLE_EQUAL(check.counts.rays, rays);
      THIMBLE_EQUAL(check.counts.hits, hits);
      check.note(static_cast<int64_t>(check.counts.node_visits));
      const size_t size = check.band.pixels.size;
      THIMBLE_REQUIRE(check.equal(crc32(bands.drawn.subspan(0, size)), crc32(bands.wanted.subspan(0, size)),
                                  THIMBLE_WHAT("the band of bricks is that of the tree")));
    }
  }
}

void bricks(Check& check, int index) {
  THIMBLE_REQUIRE(make_world(check));
  const Span<BrickMap> map = check.take<BrickMap>(1);
  const Bytes bytes = check.arena.take(kMapBytes);
  const Bands bands(check);
  THIMBLE_REQUIRE(map.size == 1 && bytes.size == kMapBytes && bands.there());
  map[0] = BrickMap();
  THIMBLE_REQUIRE_OK(BrickMap::make(check.world.compact, bytes, &map[0]));
  THIMBLE_REQUIRE(look(check, index));
  check.note(draws_fast(map[0], check.camera) ? 1 : 0);
  compare(check, map[0], bands, index);
  // What is not the tree's own is refused, and what the fast way does not take.
  set_band(check, bands.drawn, PixelFormat::kGray8, 0, 1);
  const BrickMap none;
  THIMBLE_EQUAL(render_band_32(check.world.compact, none, check.camera, check.shading, check.band),
                Status::kDamaged);
  if (!draws_fast(map[0], check.camera)) {
    THIMBLE_EQUAL(render_band_32(check.world.compact, map[0], check.camera, check.shading, check.band),
                  Status::kBadArgument);
  }
}

#ifdef THIMBLE_DEEP_WORLDS
// Worlds of level 9 and 10.
constexpr uint32_t kDeepMapBytes = 2048;
constexpr uint32_t kDeepArena = kCommonArenaBytes + kDeepMapBytes;
constexpr Site kDeepSites[] = {
    {9, {0, 0, 0}}, {9, {496, 240, 48}}, {10, {1008, 0, 512}}, {10, {512, 1008, 1008}}};

void deep_bricks(Check& check, int index) {
  const Site& site = kDeepSites[index % 4];
  THIMBLE_REQUIRE(make_world(check, site));
  const Span<BrickMap> map = check.take<BrickMap>(1);
  const size_t most = most_brick_map_bytes(check.world.compact);
  const Bytes bytes = check.arena.take(most);
  const Bands bands(check);
  THIMBLE_REQUIRE(map.size == 1 && bytes.size == most && bands.there());
  THIMBLE_REQUIRE(look(check, index, site));
  map[0] = BrickMap();
  size_t size = 0;
  THIMBLE_REQUIRE_OK(BrickMap::make(check.world.compact, bytes, &map[0], &size));
  THIMBLE_CHECK(BrickMap::validate(bytes.subspan(0, size)) == nullptr);
  THIMBLE_EQUAL(BrickMap::make(check.world.compact, bytes.subspan(0, size - 1), nullptr),
                Status::kOutOfMemory);
  THIMBLE_REQUIRE_OK(BrickMap::make(check.world.compact, bytes, &map[0], &size));
  THIMBLE_EQUAL(draws_fast(map[0], check.camera), check.camera.is_perspective());
  compare(check, map[0], bands, index);
  set_band(check, bands.drawn, PixelFormat::kGray8, 0, 1);
  THIMBLE_EQUAL(render_band_32(check.world.compact, map[0], check.camera, check.shading, check.band),
                Status::kBadArgument);
  bytes[size - 1] = static_cast<uint8_t>(bytes[size - 1] ^ 1U);
  THIMBLE_CHECK(BrickMap::validate(bytes.subspan(0, size)) != nullptr);
}
#endif

// --- Cut-off

constexpr uint32_t kCutArena = kPoolBytes + kTreeBytes + 2 * kPoolNodes + 2 * kBandBytes +
                               sizeof(NodeColors) + sizeof(Cutoff) + sizeof(CutHit) + 64;
static_assert(kCutArena <= kLitArenaBytes);

void cut_off(Check& check, int index) {
  THIMBLE_REQUIRE(make_world(check));
  const CompactTree& tree = check.world.compact;
  const Span<NodeColors> colors = check.take<NodeColors>(1);
  const Span<CutHit> hit = check.take<CutHit>(1);
  const Bytes bytes = check.arena.take(node_colors_bytes(tree));
  const Bytes wanted = check.arena.take(kBandBytes);
  const Bytes drawn = check.arena.take(kBandBytes);
  THIMBLE_REQUIRE(colors.size == 1 && hit.size == 1 && !bytes.empty() && drawn.size == kBandBytes);
  colors[0] = NodeColors();
  THIMBLE_REQUIRE(look(check, index));
  check.shading.mode = ShadeMode::kColor;
  THIMBLE_EQUAL(NodeColors::make(tree, check.shading.palette, check.shading.default_color,
                                 bytes.subspan(0, bytes.size - 1), &colors[0]),
                Status::kOutOfMemory);
  THIMBLE_REQUIRE_OK(
      NodeColors::make(tree, check.shading.palette, check.shading.default_color, bytes, &colors[0]));
  THIMBLE_EQUAL(colors[0].nodes(), tree.node_count());
  for (uint32_t node = 0; node < tree.node_count(); ++node) {
    const Rgb8 color = colors[0].color(node);
    check.note(color.r << 16 | color.g << 8 | color.b);
  }
  Cutoff cutoff;
  THIMBLE_CHECK(cutoff.cuts_nothing());
  THIMBLE_EQUAL(cutoff.set_level(kLevel + 9), Status::kOutOfRange);
  for (int setting = 0; setting < 5; ++setting) {
    cutoff = Cutoff();
    if (setting == 1) {
      THIMBLE_REQUIRE_OK(cutoff.set_level(2));
    } else if (setting >= 2) {
      THIMBLE_REQUIRE_OK(cutoff.set(check.camera, Q16::saturate(1 << (2 * (setting - 2)))));
    }
    check.note(cutoff.reach_q8(1000));
    check.note(cutoff.level());
    for (int32_t y = 0; y < kHeight; y += 2) {
      const PixelFormat format = PixelFormat::kRgb888;
      set_band(check, drawn, format, y, 2);
      THIMBLE_REQUIRE_OK(
          render_band_cut(tree, check.camera, check.shading, cutoff, colors[0], check.band, &check.counts));
      check.note(static_cast<int64_t>(check.counts.hits));
      check.note(static_cast<int64_t>(check.counts.node_visits));
      check.note_bytes(check.band.pixels);
      if (setting == 0) {
        set_band(check, wanted, format, y, 2);
        THIMBLE_REQUIRE_OK(render_band(tree, check.camera, check.shading, check.band));
        THIMBLE_EQUAL(crc32(drawn.subspan(0, check.band.pixels.size)),
                      crc32(wanted.subspan(0, check.band.pixels.size)));
      }
    }
    for (int32_t x = 0; x < kWidth; x += 5) {
      THIMBLE_REQUIRE_OK(closest_hit_cut(tree, check.camera.ray(x, 13), cutoff, &hit[0]));
      check.note(hit[0].hit);
      check.note(hit[0].cut ? 1 + static_cast<int64_t>(hit[0].node) : 0);
    }
  }
}

// --- Samples at edges

constexpr uint32_t kEdgeArena = 3 * 3 * kWidth + 2 * kWidth + 64;

void edges(Check& check, int channels) {
  const Bytes rows = check.arena.take(3 * 3 * kWidth);
  const Bytes strengths = check.arena.take(kWidth);
  const Bytes samples = check.arena.take(kWidth);
  THIMBLE_REQUIRE(samples.size == kWidth);
  Random random;
  for (int round = 0; round < 6; ++round) {
    for (uint8_t& byte : rows) {
      const int32_t edge = random.below(round < 3 ? 9 : 2);
      byte = static_cast<uint8_t>(edge == 0 ? random.below(256) : 60 + random.below(round == 0 ? 8 : 40));
    }
    const size_t size = static_cast<size_t>(channels) * kWidth;
    const ConstBytes above = round == 1 ? ConstBytes{} : ConstBytes(rows.subspan(0, size));
    const ConstBytes row = rows.subspan(size, size);
    const ConstBytes below = round == 2 ? ConstBytes{} : ConstBytes(rows.subspan(2 * size, size));
    THIMBLE_REQUIRE_OK(edge_strengths(above, row, below, channels, kWidth, strengths));
    for (int32_t x = 0; x < kWidth; ++x) {
      int32_t most = 0;
      for (int32_t c = 0; c < channels; ++c) {
        const auto at = [&](ConstBytes of, int32_t px) {
          return int32_t{
              of[static_cast<size_t>(px) * static_cast<size_t>(channels) + static_cast<size_t>(c)]};
        };
        const auto differ = [&](int32_t other) {
          const int32_t by = other < at(row, x) ? at(row, x) - other : other - at(row, x);
          most = by > most ? by : most;
        };
        if (x > 0) {
          differ(at(row, x - 1));
        }
        if (x + 1 < kWidth) {
          differ(at(row, x + 1));
        }
        if (!above.empty()) {
          differ(at(above, x));
        }
        if (!below.empty()) {
          differ(at(below, x));
        }
      }
      THIMBLE_EQUAL(int32_t{strengths[static_cast<size_t>(x)]}, most);
    }
    THIMBLE_REQUIRE_OK(place_edge_samples(strengths, kWidth, samples));
    int32_t sum = 0;
    for (int32_t x = 0; x < kWidth; ++x) {
      const uint8_t count = samples[static_cast<size_t>(x)];
      THIMBLE_CHECK(count == 0 || count == 2 || count == 4);
      THIMBLE_CHECK(count == 0 || strengths[static_cast<size_t>(x)] >= kEdgeStrength);
      sum += count;
      check.note(count);
    }
    THIMBLE_CHECK(sum <= kEdgeSegmentSamples * kWidth / kEdgeSegmentPx);
  }
  THIMBLE_EQUAL(edge_strengths({}, rows, {}, 5, 1, strengths), Status::kBadArgument);
  THIMBLE_EQUAL(edge_strengths({}, rows, {}, channels, -1, strengths), Status::kOutOfRange);
  THIMBLE_EQUAL(edge_strengths({}, rows.subspan(0, 2), {}, channels, kWidth, strengths),
                Status::kOutOfMemory);
  THIMBLE_EQUAL(place_edge_samples(strengths, kWidth, samples.subspan(0, 3)), Status::kOutOfMemory);
}

constexpr Case kCases[] = {
    {"bricks -> the tree's frame", kBrickArena, bricks, 0, "camera", kLookCount},
#ifdef THIMBLE_DEEP_WORLDS
    {"bricks at level 9 or 10 -> the tree's frame", kDeepArena, deep_bricks, 0, "camera", kLookCount},
#endif
    {"a frame that stops at small blocks -> the same everywhere", kCutArena, cut_off, kBefore},
    {"the same, from inside the world -> the same everywhere", kCutArena, cut_off, kInside},
    {"the same, parallel -> the same everywhere", kCutArena, cut_off, kParallel},
    {"edges of grey rows -> their strengths and samples", kEdgeArena, edges, 1},
    {"edges of coloured rows -> their strengths and samples", kEdgeArena, edges, 3},
};

}  // namespace

const Group kBrickGroup = group_of<kCases>("bricks", "cases_bricks.cpp");

}  // namespace thimble::portable
