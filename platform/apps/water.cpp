// A lit scene whose water moves. Touch it, drop things into it, walk round it; leave it alone and it comes to
// rest, and then nothing is computed any more.
//
//   buttons    left, right, up and down move the camera, as in the demonstration; select drops a ball where
//              the middle of the picture is, and while it is held up and down come nearer and go away
//   @X,Y.      over the UART: touches the water that pixel X, Y shows (the simulator sends it for the mouse)
//   !X,Y.      drops a ball there
//   x  b       the same in the middle of the picture
//   +  -       nearer, farther
//   m          rain: a ball now and then, or no more
//   t          the camera turns by itself, or no more
//   k          lays the water to rest
//   o          draws every band of every frame, or only what can have changed
//   i          the line with the counters, now; it comes at the end, too
//   q          ends, with status 0
//
// A frame is drawn in bands, and only those bands that can show something else than in the frame before
// (DirtyBands). The water is stepped only while it moves. The work a frame hangs on no clock.
#include "thimble/light/water.h"

#include "apps/apps.h"
#include "apps/band_turns.h"
#include "apps/demo_view.h"
#include "apps/moving_water.h"
#include "apps/place.h"
#include "apps/scene_light.h"
#include "apps/shown_scene.h"
#include "apps/text.h"
#include "port.h"
#include "thimble/base/memory.h"
#include "thimble/light/render.h"
#include "thimble/light/scene.h"

namespace thimble::apps {
namespace {

/// Which bands of the picture must be drawn again, so that an unchanged one costs nothing.
///
/// A pixel is a function of the scene and the camera alone, so a band is as it was unless something that one
/// of its rays can meet has changed. The display holds what it was sent; a band that is as it was is neither
/// drawn nor sent (`skip` tells the port). An application says what has changed:
///
///     camera moved           mark_all(): every band; what each of them sees is found out while it is drawn
///     something that moves   mark_seeing(): the bands whose rays met its bounds when they were last drawn
///                            after a mark_all() (`note_sees`), whatever way they took there
///     a ball in the air      mark_passing(ball): the bands of which some ray, however it went, can meet the ball on
///                            its fall (`note_passes`), when they were last drawn; a new ball: mark_all()
///     nothing                no band is drawn
///
/// One byte a band, the application's.
class DirtyBands {
 public:
  static constexpr int32_t kBalls = 6;
  /// For a picture of that height in bands of `band_rows`; `bytes` has at least `bytes_for` of them. All
  /// bands are marked.
  void begin(Bytes bytes, int32_t height_px, int32_t band_rows) {
    flags_ = bytes;
    height_px_ = height_px;
    band_rows_ = band_rows;
    mark_all();
  }
  static constexpr size_t bytes_for(int32_t height_px, int32_t band_rows) {
    return static_cast<size_t>((height_px + band_rows - 1) / band_rows);
  }

  int32_t count() const { return static_cast<int32_t>(bytes_for(height_px_, band_rows_)); }
  int32_t first_row(int32_t band) const { return band * band_rows_; }
  int32_t rows(int32_t band) const {
    const int32_t left = height_px_ - first_row(band);
    return left < band_rows_ ? left : band_rows_;
  }

  void mark(int32_t band) { flags_.data[band] |= kDirty; }
  void mark_all() { mark_if(0, 0); }
  void mark_seeing() { mark_if(kSees, kSees); }
  /// Whether the rays of a band can meet what moves: said when it is drawn with the bounds of all that may
  /// ever move.
  void note_sees(int32_t band, bool sees) {
    uint8_t& flags = flags_.data[band];
    flags = static_cast<uint8_t>((flags & ~kSees) | (sees ? kSees : 0));
  }
  /// Which balls some ray of a band can meet: a bit each, for the first kBalls.
  void note_passes(int32_t band, uint32_t balls) {
    uint8_t& flags = flags_.data[band];
    flags = static_cast<uint8_t>((flags & ((1U << kFirstBall) - 1)) | balls << kFirstBall);
  }
  void mark_passing(int32_t ball) {
    const auto bit = static_cast<uint8_t>(1U << (kFirstBall + ball));
    mark_if(bit, bit);
  }
  bool passes_any(int32_t band) const { return flags_.data[band] >> kFirstBall != 0; }
  bool is_dirty(int32_t band) const { return (flags_.data[band] & kDirty) != 0; }

  /// The band was drawn and sent.
  void drawn(int32_t band) {
    flags_.data[band] &= static_cast<uint8_t>(~kDirty);
    ++drawn_;
  }
  /// The band is as it was: says so to the port.
  void skip(int32_t band, PixelFormat format) {
    port::flush({{}, format, 0, first_row(band), rows(band)});
    ++skipped_;
  }
  /// Since the start.
  uint64_t bands_drawn() const { return drawn_; }
  uint64_t bands_skipped() const { return skipped_; }

 private:
  static constexpr uint8_t kDirty = 1;
  static constexpr uint8_t kSees = 2;
  static constexpr int kFirstBall = 2;

  void mark_if(uint8_t mask, uint8_t value) {
    for (int32_t band = 0; band < count(); ++band) {
      if ((flags_.data[band] & mask) == value) {
        mark(band);
      }
    }
  }

  Bytes flags_;
  int32_t height_px_ = 0;
  int32_t band_rows_ = 1;
  uint64_t drawn_ = 0;
  uint64_t skipped_ = 0;
};

// Balls that fall through the air of a scene, in integers, without being part of its tree, which is in flash
// (thimble/light/render.h says how they are drawn).

struct FallingBall {
  bool is_there = false;
  bool is_wet = false;  ///< it has met the surface
  Vec3i center;         ///< 1/256 voxel
  int32_t speed = 0;    ///< downwards, 1/256 voxel a frame
};

/// Half the side of a ball, its weight in what falls, and the way it falls: by the size of the world.
struct BallSize {
  int32_t half_q8 = 0;
  int32_t gravity_q8 = 0;  ///< a frame and frame
  int32_t height_q8 = 0;   ///< above the surface, where it begins
  int32_t mass_q8 = 0;     ///< in voxels of water: of a stone, twice its volume
};
constexpr BallSize ball_size(int level) {
  // 2 voxels of 64.
  const int32_t half = int32_t{8} << level;
  const int32_t side_q4 = half >> 3;  // (2 half) in 1/16 voxel
  // Beyond worlds of 2^9 the water takes no more.
  const int64_t mass = int64_t{side_q4} * side_q4 * side_q4 >> 3;
  return {half, (int32_t{5} << level) >> 4, int32_t{80} << level,
          mass > (int32_t{1} << 20) ? int32_t{1} << 20 : static_cast<int32_t>(mass)};
}

/// As it is drawn.
constexpr Ball drawn_ball(const FallingBall& ball, const BallSize& size) {
  Ball drawn;
  drawn.center = ball.center;
  drawn.half_q8 = ball.is_there ? size.half_q8 : 0;
  drawn.bottom_q8 = 0;
  drawn.top_q8 = ball.center.z + size.half_q8;
  drawn.surface.albedo = {250, 92, 64};
  return drawn;
}

constexpr int kKeysAFrame = 64;
constexpr int kBalls = 4;
static_assert(kBalls <= DirtyBands::kBalls);
/// Frames from one ball of the rain to the next.
constexpr uint32_t kRainFrames = 24;

/// A pixel that is being named over the UART.
struct Pointing {
  char what = 0;  ///< '@' or '!'; 0: nothing is
  bool has_x = false;
  int32_t x = 0;
  int32_t y = 0;
};

struct Pool : Placed {
  Arena arena{port::arena()};
  ShownScene shown;
  BakedLighting lighting;
  WaterSurface rest;  ///< the water as the scene has it
  MovingWater water;
  BallSize ball_size;
  FallingBall balls[kBalls];
  Orbit orbit;
  Steering steering;
  Camera camera;
  Shading shading;
  Bands bands;
  DirtyBands dirty;
  Pointing pointing;
  uint32_t buttons = 0;  ///< of the frame before
  uint32_t frames = 0;
  uint32_t turned = 0;
  uint32_t raining = 0;  ///< frames since it began, and one; 0: it does not
  uint32_t drops = 0;    ///< of the rain
  uint32_t touches = 0;
  uint32_t splashes = 0;
  uint32_t crc = 0;  ///< of all bands that were drawn
  bool turns = false;
  bool redraws = false;  ///< every band of every frame
  bool moved = true;     ///< the camera
  bool rippled = false;  ///< the water
  bool dropped = false;  ///< a new ball: any ray may meet it
};

const CompactTree& tree_of(const Pool& pool) {
  return pool.shown.scene.tree();
}

void put_fact(const char* name, uint64_t number) {
  put(name, number);
}

[[gnu::noinline]] void tell_counters(const Pool& pool) {
  put_fact("frames ", pool.frames);
  put_fact(" bands drawn ", pool.dirty.bands_drawn());
  put_fact(" bands skipped ", pool.dirty.bands_skipped());
  put_fact(" steps ", pool.water.columns.steps_done());
  put_fact(" columns stepped ", pool.water.columns.columns_updated());
  put_fact(" touches ", pool.touches);
  put_fact(" splashes ", pool.splashes);
  put(" crc ", Hex{pool.crc}, " water ", Hex{pool.water.columns.state_crc32()},
      pool.water.columns.is_still() ? " still\n" : " moving\n");
}

// ---- what happens

/// The place of the water that a pixel shows.
[[gnu::noinline]] bool point_at(const Pool& pool, int32_t px, int32_t py, int32_t* x_q8, int32_t* y_q8) {
  const port::Display& screen = display();
  return px >= 0 && py >= 0 && px < screen.width_px && py < screen.height_px &&
         find_surface(tree_of(pool), pool.water, pool.camera.ray(px, py), x_q8, y_q8);
}

/// A fingertip: a bowl with a rim.
void touch(Pool* pool, int32_t px, int32_t py) {
  int32_t x = 0;
  int32_t y = 0;
  const int32_t half = pool->ball_size.half_q8;
  const auto within = [](int32_t value) { return value < (1 << 14) ? value : 1 << 14; };
  if (point_at(*pool, px, py, &x, &y) &&
      pool->water.columns.touch(x, y, within(half * 5 / 4), within(half * 3 / 4)) == Status::kOk) {
    ++pool->touches;
    pool->rippled = true;
  }
}

/// A ball above a place of the water.
void drop_above(Pool* pool, int32_t x_q8, int32_t y_q8) {
  const MovingWater& water = pool->water;
  for (FallingBall& ball : pool->balls) {
    if (!ball.is_there) {
      ball = FallingBall{};
      ball.is_there = true;
      pool->dropped = true;
      ball.center = {water.corner.x * Q8::kOne + x_q8, water.corner.y * Q8::kOne + y_q8,
                     water.corner.z * Q8::kOne + water.columns.rest_q8() + pool->ball_size.height_q8};
      return;
    }
  }
}
void drop(Pool* pool, int32_t px, int32_t py) {
  int32_t x = 0;
  int32_t y = 0;
  if (point_at(*pool, px, py, &x, &y)) {
    drop_above(pool, x, y);
  }
}

/// One drop of the rain: places that follow one another evenly and never in the same way (Roberts, "The
/// unreasonable effectiveness of quasirandom sequences", 2018: multiples of 1/g and 1/g^2, g^3 = g + 1).
void rain(Pool* pool) {
  const auto place = [&](uint32_t step, int32_t columns) {
    const uint32_t share = (pool->drops * step + 0x8000U) & 0xFFFFU;
    return static_cast<int32_t>(share * static_cast<uint32_t>(columns) >> 8);
  };
  const int32_t x = place(49472, pool->water.columns.width());
  const int32_t y = place(37345, pool->water.columns.depth());
  ++pool->drops;
  drop_above(pool, x, y);
}

/// A frame of a ball's fall. Into the water it goes with its momentum, once, and on below at half its speed,
/// where nobody sees it any more; on something solid it ends.
[[gnu::noinline]] void fall(Pool* pool, FallingBall* ball) {
  const BallSize& size = pool->ball_size;
  MovingWater& water = pool->water;
  ball->speed += ball->is_wet ? 0 : size.gravity_q8;
  ball->center.z -= ball->speed;
  const int32_t x = ball->center.x - water.corner.x * Q8::kOne;
  const int32_t y = ball->center.y - water.corner.y * Q8::kOne;
  const int32_t column_x = x >> Q8::kBits;
  const int32_t column_y = y >> Q8::kBits;
  const Vec3i below{ball->center.x >> Q8::kBits, ball->center.y >> Q8::kBits,
                    (ball->center.z - size.half_q8) >> Q8::kBits};
  const bool is_over_water = column_x >= 0 && column_y >= 0 && column_x < water.columns.width() &&
                             column_y < water.columns.depth() &&
                             !water.columns.is_blocked(column_x, column_y);
  const int32_t surface =
      is_over_water ? water.corner.z * Q8::kOne + water.columns.height_q8(column_x, column_y) : -Q8::kOne;
  if (!ball->is_wet && ball->center.z - size.half_q8 <= surface) {
    const int32_t speed = ball->speed / kStepsAFrame;
    const int32_t radius = size.half_q8 < (1 << 14) ? size.half_q8 : 1 << 14;
    if (water.columns.drop(x, y, radius, size.mass_q8, speed < 65536 ? speed : 65536) == Status::kOk) {
      ++pool->splashes;
      pool->rippled = true;
    }
    ball->is_wet = true;
    ball->speed /= 2;
  }
  if (ball->center.z + size.half_q8 < surface || below.z < 0 || material_at(tree_of(*pool), below, nullptr)) {
    ball->is_there = false;
  }
}

/// A frame's time.
[[gnu::noinline]] void move(Pool* pool) {
  if (pool->raining != 0 && pool->raining++ % kRainFrames == 1) {
    rain(pool);
  }
  for (int i = 0; i < kBalls; ++i) {
    FallingBall& ball = pool->balls[i];
    if (ball.is_there) {
      pool->dirty.mark_passing(i);
      fall(pool, &ball);
    }
  }
  for (int i = 0; i < kStepsAFrame && !pool->water.columns.is_still(); ++i) {
    pool->water.columns.step();
    pool->rippled = true;
  }
}

// ---- the picture

/// With the scene's effects: those that it was compiled for, or whatever it was baked with. `passed`: DrawnBalls.
Status draw_band(const Pool& pool, const Band& band, LitCounts* counts, uint32_t* passed) {
  Ball balls[kBalls];
  for (int i = 0; i < kBalls; ++i) {
    balls[i] = drawn_ball(pool.balls[i], pool.ball_size);
  }
  const DrawnBalls drawn{{balls, kBalls}, passed};
#if defined(THIMBLE_SCENE_IN_FLASH)
  return render_lit_band_within<kImageEffects>(pool.lighting.effects, tree_of(pool), drawn, pool.camera,
                                               pool.shading, pool.lighting.scene, band, counts);
#elif defined(THIMBLE_IMAGE_EFFECTS)
  return render_lit_band<THIMBLE_IMAGE_EFFECTS>(tree_of(pool), drawn, pool.camera, pool.shading,
                                                pool.lighting.scene, band, counts);
#else
  return render_lit_band(pool.lighting.effects, tree_of(pool), drawn, pool.camera, pool.shading,
                         pool.lighting.scene, band, counts);
#endif
}

/// Apart from `draw_frame`, whose stack lies below that of all rays.
[[gnu::noinline]] void send(Pool* pool, const Band& band) {
  pool->bands.send(band);
  pool->crc = crc32(band.pixels, pool->crc);
}

/// Draws and flushes what can have changed.
[[gnu::noinline]] Status draw_frame(Pool* pool) {
  const port::Display& screen = display();
  DirtyBands& dirty = pool->dirty;
  // Which bands waves can change is found with a new camera, and where a ball can hide it.
  const bool moved = pool->moved;
  if (pool->moved || pool->redraws || pool->dropped) {
    dirty.mark_all();
  } else if (pool->rippled) {
    dirty.mark_seeing();
  }
  pool->moved = false;
  pool->rippled = false;
  pool->dropped = false;
  if constexpr ((kImageEffects & Effect::kRipples) != 0) {
    // They run while the water does: what is at rest is not drawn again.
    pool->lighting.scene.ripple_phase = static_cast<uint8_t>(pool->water.columns.steps_done());
  }
  for (int32_t i = 0; i < dirty.count(); ++i) {
    if (!dirty.is_dirty(i)) {
      dirty.skip(i, screen.format);
      continue;
    }
    const Band band = pool->bands.next(dirty.first_row(i), screen.height_px);
    const bool looks = moved || dirty.passes_any(i);
    pool->lighting.scene.water = surface_of(pool->water, looks);
    LitCounts counts;
    uint32_t passed = 0;
    const Status status = draw_band(*pool, band, &counts, &passed);
    if (status != Status::kOk) {
      return status;
    }
    if (looks) {
      // What a ball hides now is found when it has gone: until then its passing marks the band.
      dirty.note_sees(i, counts.node_visits[static_cast<int>(LitRayKind::kWaterRay)] != 0);
    }
    dirty.note_passes(i, passed);
    send(pool, band);
    dirty.drawn(i);
  }
  return Status::kOk;
}

// ---- the hand

/// One byte of a pixel's name; false where it belongs to none.
bool take_pointing(Pool* pool, int byte) {
  Pointing& pointing = pool->pointing;
  if (byte == '@' || byte == '!') {
    pointing = Pointing{};
    pointing.what = static_cast<char>(byte);
    return true;
  }
  if (pointing.what == 0) {
    return false;
  }
  int32_t& number = pointing.has_x ? pointing.y : pointing.x;
  if (byte >= '0' && byte <= '9' && number < 10000) {
    number = 10 * number + (byte - '0');
  } else if (byte == ',' && !pointing.has_x) {
    pointing.has_x = true;
  } else {
    if (byte == '.' && pointing.has_x) {
      (pointing.what == '@' ? touch : drop)(pool, pointing.x, pointing.y);
    }
    pointing.what = 0;
  }
  return true;
}

void zoom(Pool* pool, int32_t by) {
  const int32_t zoom = pool->steering.zoom + by;
  if (zoom >= kNearest && zoom <= kFarthest) {
    pool->steering.zoom = zoom;
    pool->moved = true;
  }
}

[[gnu::noinline]] bool still(Pool* pool) {
  pool->rippled = true;
  return calm_water(tree_of(*pool), pool->rest, &pool->arena, &pool->water) == Status::kOk;
}

/// Whether to continue.
[[gnu::noinline]] bool obey(Pool* pool) {
  const port::Display& screen = display();
  const uint32_t buttons = port::buttons();
  const Steering before = pool->steering;
  steer(buttons, &pool->steering);
  pool->moved = pool->moved || before.yaw != pool->steering.yaw || before.pitch != pool->steering.pitch ||
                before.zoom != pool->steering.zoom;
  if ((buttons & ~pool->buttons & port::kSelect) != 0) {
    drop(pool, screen.width_px / 2, screen.height_px / 2);
  }
  pool->buttons = buttons;
  for (int i = 0; i < kKeysAFrame; ++i) {
    const int byte = port::read();
    if (byte < 0) {
      return true;
    }
    if (take_pointing(pool, byte)) {
      continue;
    }
    switch (byte) {
      case 'q':
        return false;
      case 'x':
        touch(pool, screen.width_px / 2, screen.height_px / 2);
        break;
      case 'b':
        drop(pool, screen.width_px / 2, screen.height_px / 2);
        break;
      case '+':
        zoom(pool, -1);
        break;
      case '-':
        zoom(pool, 1);
        break;
      case 'm':
        pool->raining = pool->raining == 0 ? 1 : 0;
        break;
      case 't':
        pool->turns = !pool->turns;
        break;
      case 'k':
        static_cast<void>(still(pool));
        break;
      case 'o':
        pool->redraws = !pool->redraws;
        break;
      case 'i':
        tell_counters(*pool);
        break;
      default:
        break;
    }
  }
  return true;
}

[[gnu::noinline]] Status place_camera(Pool* pool) {
  const port::Display& screen = display();
  return view_at(pool->orbit, tree_of(*pool), pool->turned, pool->steering, screen.width_px, screen.height_px,
                 &pool->camera);
}

/// Opens the scene, takes all memory. Null, or what is wrong.
[[gnu::noinline]] const char* begin(Pool* pool) {
  if (const char* wrong = open_scene(&pool->shown)) {
    return wrong;
  }
  tell_board_and_scene("water", pool->shown);
  const BakedScene& scene = pool->shown.scene;
  if (BakedLighting::open(scene.section(SectionKind::kLighting), tree_of(*pool).level(), &pool->lighting) !=
          Status::kOk ||
      (pool->lighting.effects & Effect::kWater) == 0 || !pool->lighting.scene.has_water) {
    return "the scene holds no water";
  }
  if (!is_for(pool->lighting.effects)) {
    return "the image was built for other effects than the scene's";
  }
  pool->rest = pool->lighting.scene.water;
  const int32_t height = display().height_px;
  const bool has_bands = pool->bands.take(&pool->arena);
  const Bytes flags = pool->arena.take(DirtyBands::bytes_for(height, pool->bands.rows), 1);
  if (!has_bands || flags.empty()) {
    return "the arena does not hold a band of the picture";
  }
  pool->dirty.begin(flags, height, pool->bands.rows);
  if (!still(pool)) {
    return "the arena does not hold the water's columns";
  }
  pool->ball_size = ball_size(tree_of(*pool).level());
  pool->orbit = orbit_of(scene);
  pool->shading = demo_shading(scene.palette());
  if (place_camera(pool) != Status::kOk) {
    // A camera that this display cannot have: round what is solid then.
    pool->orbit = orbit_of(tree_of(*pool).bounds());
    if (place_camera(pool) != Status::kOk) {
      return "the display cannot show the scene";
    }
  }
  return nullptr;
}

}  // namespace

int water() {
  Arena whole(port::arena());
  Pool* const pool = place<Pool>(&whole);
  if (pool == nullptr) {
    return refuse("the arena is too small");
  }
  pool->arena = whole;
  if (const char* wrong = begin(pool)) {
    return refuse(wrong);
  }
  for (; port::running(pool->frames) && obey(pool); ++pool->frames) {
    pool->turned += pool->turns ? 1 : 0;
    pool->moved = pool->moved || pool->turns;
    Status status = Status::kOk;
    if (pool->moved) {
      status = place_camera(pool);
    }
    move(pool);
    if (status == Status::kOk) {
      status = draw_frame(pool);
    }
    if (status != Status::kOk) {
      return refuse(status_text(status));
    }
  }
  tell_counters(*pool);
  return 0;
}

}  // namespace thimble::apps
