// The demonstration: the baked scene turns; a hand on the buttons steers; bytes over the UART ask for more.
//
//   p   the picture on the display, as P5 or, in colour, P6; the exact one while a rate is held
//   b   builds a scene of spheres in a pool in RAM, voxel by voxel; when the pool is full it coarsens
//   s   back to the baked scene
//   h   holds a rate of frames (held_frame.h), or draws exact ones as fast as it can
//   t   stops turning, or turns again
//   l   light off, or on again, where the scene was baked for effects
//   c   CRC-32 of every frame on or off; on from the start where there is no display
//   q   ends, with status 0
//
// A scene that was baked for effects (scene_light.h) turns in their light where frames by the brick map allow it; what
// these leave out (edges) comes when it stands still.
// Else it stands still at first: while it moves, or while a rate is held, frames are fast and without effects; the first,
// and one as soon as it does not move, is drawn with them, and then nothing until it moves again.
//
// A frame is drawn in bands of a few rows. No picture is in RAM, but for the one that is refined while a rate
// is held, and those that ink on a display of one bit is made from; nothing but the arena is used.
#include "apps/apps.h"
#include "apps/band_crew.h"
#include "apps/band_turns.h"
#include "apps/demo_view.h"
#include "apps/held_frame.h"
#include "apps/ink_frame.h"
#include "apps/place.h"
#include "apps/scene_light.h"
#include "apps/shown_scene.h"
#include "apps/spheres.h"
#include "apps/text.h"
#include "port.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"
#include "thimble/tree/octree.h"

namespace thimble::apps {
namespace {

// The larger functions are not inlined: what one keeps on the stack is gone when the next one draws.

/// Bytes over the UART that are looked at in one frame.
constexpr int kKeysAFrame = 16;
/// Places that are looked at for a voxel of the scene that is built, in one frame.
constexpr uint32_t kPlacesAFrame = 2048;
/// Spheres that are still begun when the pool is full.
constexpr uint32_t kSpheresBeyond = 6;
/// The largest pool, so that it is full in a minute.
constexpr size_t kMostPoolBytes = size_t{256} << 10;

#if defined(THIMBLE_CORES)
/// What frames take that two cores draw.
struct Crew {
  CrewFrame frame;
  Bytes bands;
  Bytes stack;  ///< the second core's
  bool is_there = false;
  bool was_last = false;  ///< what was sent last is `frame.sending` of these bands, not of Demo::bands
  uint32_t crc = 0;

  void take(const Bytes& core_stack, const Bytes& all_bands) {
    stack = core_stack;
    bands = all_bands;
  }
  void leave() { was_last = false; }
};
#else
struct Crew {
  void take(const Bytes& /*stack*/, const Bytes& /*bands*/) {}
  void leave() {}
};
#endif

struct Demo : Placed {
  Arena arena{port::arena()};
  ShownScene shown;
  Orbit orbit;
  Steering steering;
  Camera camera;
  Shading shading;
  Bands bands;
  uint32_t frame = 0;   ///< of the scene that is shown
  uint32_t turned = 0;  ///< frames in which the camera has turned
  bool turns = true;
  bool tells_crc = false;
  [[no_unique_address]] Crew crew;
  [[no_unique_address]] InkFrame ink;

  // Holding a rate of frames.
  HeldFrame* held = nullptr;  ///< once it is allocated
  bool holds = false;
  bool changed = true;  ///< something that is seen, since the last frame
  uint32_t fps = kHoldFps;
  uint32_t inexact = 0;            ///< pixels of the last frame that may not be exact
  uint32_t most_instructions = 0;  ///< of a frame that was held, where they are counted

  // Light.
  SceneLight light;
  bool lights = false;            ///< as soon as it can (`lights_next`)
  bool is_lit = false;            ///< the picture that is shown
  bool is_whole = false;          ///< with all effects
  uint32_t lit_instructions = 0;  ///< of the last frame that was lit to its end, where they are counted

  // The scene that is built here.
  bool builds = false;
  bool is_full = false;  ///< the pool was full once: it coarsens
  Octree pool;
  SphereBuilder spheres;
};

/// Where bands are sent while others are drawn, one holds what a tile of a thinned picture becomes, every 4th
/// pixel both ways, so that the next tile is drawn meanwhile.
int32_t most_band_rows() {
  const int32_t rows = port::band_buffers() > 1 ? kBrickTilePx * 4 : kBandRows;
  return display().height_px < rows ? display().height_px : rows;
}

/// Bytes of the bands that all cores draw, of which one takes `band_bytes`: one for each core beside what is sent.
size_t crew_bands(size_t band_bytes) {
  return all_bands(band_bytes) + band_bytes * static_cast<size_t>(port::cores() - 1);
}

/// A cross from corner to corner: what a display shows that cannot show a message. Without an arena to draw
/// in, nothing.
void show_cross(Arena* arena) {
  const port::Display& screen = display();
  const Bytes row = arena->take(row_bytes(screen.format, screen.width_px));
  if (row.empty()) {
    return;
  }
  for (int32_t y = 0; y < screen.height_px; ++y) {
    for (size_t i = 0; i < row.size && begins_bytes(screen.format, y); ++i) {
      row[i] = 0;
    }
    const int32_t across = y * (screen.width_px - 1) / (screen.height_px > 1 ? screen.height_px - 1 : 1);
    const Rgb8 white{255, 255, 255};
    store_pixel(row.data, across, y, screen.format, white);
    if (2 * across != screen.width_px - 1) {
      store_pixel(row.data, screen.width_px - 1 - across, y, screen.format, white);
    }
    // A row at a time, or a page.
    const int32_t together = band_row_multiple(screen.format);
    if ((y + 1) % together == 0 || y + 1 == screen.height_px) {
      port::flush({row, screen.format, 0, y - y % together, y % together + 1});
    }
  }
}

[[gnu::noinline]] int refuse_with_cross(Arena* arena, const char* why) {
  const int status = refuse(why);
  show_cross(arena);
  return status;
}

/// Without light. `counts`: as for `draw_scene`.
Status draw_plain(const Demo& demo, const Shading& shading, const Band& band,
                  RenderCounts* counts = nullptr) {
  return demo.builds ? render_band(demo.pool, demo.camera, shading, band)
                     : draw_scene(demo.shown, demo.camera, shading, band, counts);
}

Status draw(const Demo& demo, const Band& band) {
  if (demo.ink.is_there) {
    return demo.ink.store(band);
  }
  if constexpr (kCanLight) {
    if (demo.is_lit) {
      return draw_lit_scene(demo.shown, demo.camera, demo.shading, demo.light, band, !demo.is_whole);
    }
  }
  return draw_plain(demo, demo.shading, band);
}

/// What bands of ink are taken from. Counted, so that the core draws it: what a port draws is what a display is sent.
[[gnu::noinline]] Status make_ink(Demo* demo) {
  RenderCounts counts;
  return demo->ink.draw(
      demo->camera, demo->builds ? demo->pool.bounds() : demo->shown.scene.tree().bounds(),
      [&](const Band& band) {
        return kCanLight && demo->is_lit ? draw_lit_scene(demo->shown, demo->camera, demo->shading,
                                                          demo->light, band, !demo->is_whole)
                                         : draw_plain(*demo, demo->shading, band, &counts);
      },
      [&](const Shading& depths, const Band& band) { return draw_plain(*demo, depths, band, &counts); });
}

/// The rows of the picture from `y` on that the band's memory holds, those before `end`.
[[gnu::noinline]] Band band_at(const Demo& demo, int32_t y, int32_t end) {
  return demo.bands.next(y, end);
}

void flush(Demo* demo, const Band& band, uint32_t* crc) {
  demo->bands.send(band);
  demo->crew.leave();
  if (demo->tells_crc) {
    *crc = crc32(band.pixels, *crc);
  }
}

#if defined(THIMBLE_CORES)
struct PortLock {
  static void lock() { port::lock(); }
  static void unlock() { port::unlock(); }
};

/// The bands of one core.
[[gnu::noinline]] void draw_bands(Demo* demo, int core) {
  Crew& crew = demo->crew;
  const port::Display& screen = display();
  const size_t memory_bytes = crew.bands.size / CrewFrame::kMemories;
  const auto band_of = [&](uint8_t memory, int32_t row, int32_t rows) {
    const size_t bytes = band_bytes(screen.format, screen.width_px, rows);
    return Band{crew.bands.subspan(memory * memory_bytes, bytes), screen.format, 0, row, rows};
  };
  draw_share<PortLock>(
      &crew.frame, core,
      [&](uint8_t memory, int32_t row, int32_t rows) { return draw(*demo, band_of(memory, row, rows)); },
      [&](uint8_t memory, int32_t row, int32_t rows) {
        const Band band = band_of(memory, row, rows);
        port::begin_flush(band);
        crew.crc = demo->tells_crc ? crc32(band.pixels, crew.crc) : 0;
      });
}

/// Called by the second core alone.
void draw_other_bands(void* demo) {
  draw_bands(static_cast<Demo*>(demo), 1);
}

/// As `draw_frame`, by both cores: in bands of half the memory, so that none of them waits long for the other's last.
[[gnu::noinline]] Status draw_frame_together(Demo* demo, uint32_t* crc) {
  Crew& crew = demo->crew;
  CrewFrame& frame = crew.frame;
  frame.height_px = display().height_px;
  frame.band_rows = demo->bands.rows > 2 * kBrickTilePx ? 2 * kBrickTilePx : demo->bands.rows;
  frame.in_order = demo->tells_crc;
  if (!crew.was_last) {
    frame.begin_after(demo->bands.second ? 0 : 1);
  }
  frame.begin();
  crew.crc = 0;
  port::begin_share(draw_other_bands, demo);
  draw_bands(demo, 0);
  port::await_share();
  crew.was_last = true;
  demo->bands.second = frame.sending == 0;
  *crc = crew.crc;
  return frame.status;
}

/// Whether both cores draw: not ink, and not where a hand may stop a frame whose light is slow.
bool draws_together(const Demo& demo) {
  return demo.crew.is_there && !demo.ink.is_there &&
         (!kCanLight || !demo.is_lit || !demo.is_whole || demo.light.moves_whole());
}

/// Starts the second core with as much stack as this one has.
[[gnu::noinline]] void start_crew(Demo* demo) {
  demo->crew.is_there = !demo->crew.stack.empty() && port::start_core(demo->crew.stack);
  put(demo->crew.is_there ? "two cores draw\n" : "one core draws\n");
}

void tell_crew(const Demo& demo) {
  uint32_t unused = 0;
  while (unused < demo.crew.stack.size && demo.crew.stack[unused] == port::kStackPaint) {
    ++unused;
  }
  put("second core's stack: ", static_cast<uint32_t>(demo.crew.stack.size) - unused, " of ",
      demo.crew.stack.size, " bytes used\n");
}
#else
bool draws_together(const Demo& /*demo*/) {
  return false;
}
Status draw_frame_together(Demo* /*demo*/, uint32_t* /*crc*/) {
  return Status::kOk;
}
void start_crew(Demo* /*demo*/) {}
void tell_crew(const Demo& /*demo*/) {}
#endif

/// Draws and flushes a frame; `crc` gets that of its bytes. A hand on the buttons need not wait for one whose light is
/// slow: the rest of it is then a fast one.
[[gnu::noinline]] Status draw_frame(Demo* demo, uint32_t* crc) {
  const int32_t height = display().height_px;
  const uint32_t start = kCanLight ? port::instructions() : 0;
  *crc = 0;
  if (port::kCanShare && draws_together(*demo)) {
    const Status status = draw_frame_together(demo, crc);
    if (kCanLight && demo->is_lit) {
      demo->lit_instructions = port::instructions() - start;
    }
    return status;
  }
  if (demo->ink.is_there) {
    const Status status = make_ink(demo);
    if (status != Status::kOk) {
      return status;
    }
  }
  for (int32_t y = 0; y < height; y += demo->bands.rows) {
    const Band band = band_at(*demo, y, height);
    const bool lights = kCanLight && demo->is_lit && !demo->ink.is_there;
    const bool slow = lights && demo->is_whole && !demo->light.moves_whole();
    if (slow && port::buttons() != 0) {
      demo->is_lit = demo->light.is_fast;
      demo->is_whole = false;
    }
    // Light is drawn from here: the less stands on the stack the better.
    const Status status = lights && demo->is_lit ? draw_lit_scene(demo->shown, demo->camera, demo->shading,
                                                                  demo->light, band, !demo->is_whole)
                                                 : draw(*demo, band);
    if (status != Status::kOk) {
      return status;
    }
    flush(demo, band, crc);
  }
  if (kCanLight && demo->is_lit) {
    demo->lit_instructions = port::instructions() - start;
  }
  return Status::kOk;
}

/// The squares of a row of the thinned picture, from row `y` of the display on: one row, flushed again.
[[gnu::noinline]] void flush_squares(Demo* demo, const uint8_t* thin, PixelFormat format, int32_t step,
                                     int32_t y, int32_t end, uint32_t* crc) {
  Band band = band_at(*demo, y, y + 1);
  widen_row(thin, format, step, y, band.pixels.data);
  flush(demo, band, crc);
  for (const int32_t below = y + step < end ? y + step : end; ++band.first_row < below;) {
    port::flush_again(band);
    if (demo->tells_crc) {
      *crc = crc32(band.pixels, *crc);
    }
  }
}

/// The picture of the thinned camera by the brick map, each pixel as a square. The rows of a square are one row, copied, or
/// flushed again where flushing is copying.
[[gnu::noinline]] Status draw_thinned(Demo* demo, int32_t step, uint32_t* crc) {
  const port::Display& screen = display();
  HeldFrame& held = *demo->held;
  held.thin_camera = demo->camera.thinned(step);
  const int32_t width = held.thin_camera.width_px();
  const int32_t height = held.thin_camera.height_px();
  const PixelFormat format = thin_format(screen.format);
  const bool rows_alike = widened_bytes(format) != 0;
  const bool flushes_again = rows_alike && port::band_buffers() == 1;
  // Rows of a tile, or as many as fill a band where it is sent meanwhile.
  const int32_t most_rows =
      rows_alike && !flushes_again && demo->bands.rows >= step && demo->bands.rows < kBrickTilePx * step
          ? demo->bands.rows / step
          : kBrickTilePx;
  demo->inexact = static_cast<uint32_t>(screen.width_px * screen.height_px - width * height);
  *crc = 0;
  for (int32_t thin_y = 0; thin_y < height; thin_y += most_rows) {
    const int32_t rows = height - thin_y < most_rows ? height - thin_y : most_rows;
    const Band thin{held.thin_bytes, format, 0, thin_y, rows};
    const Status status =
        render_band(demo->shown.scene.tree(), demo->shown.map, held.thin_camera, demo->shading, thin);
    if (status != Status::kOk) {
      return status;
    }
    const int32_t last = (thin_y + rows) * step;
    const int32_t end = last < screen.height_px ? last : screen.height_px;
    if (flushes_again) {
      for (int32_t i = 0; i < rows; ++i) {
        flush_squares(demo, held.thin_bytes.data + static_cast<size_t>(i) * row_bytes(format, width), format,
                      step, (thin_y + i) * step, end, crc);
      }
      continue;
    }
    for (int32_t y = thin_y * step; y < end;) {
      const Band band = band_at(*demo, y, end);
      const size_t row = row_bytes(screen.format, screen.width_px);
      for (int32_t i = 0; i < band.rows; ++i) {
        uint8_t* const to = band.pixels.data + row_place(screen.format, i) * row;
        if (rows_alike && i > 0 && (y + i) % step != 0) {
          __builtin_memcpy(to, to - row, row);  // the same squares
          continue;
        }
        const auto from = static_cast<size_t>((y + i) / step - thin_y);
        widen_row(held.thin_bytes.data + from * row_bytes(format, width), format, step, y + i, to);
      }
      flush(demo, band, crc);
      y += band.rows;
    }
  }
  return Status::kOk;
}

/// More of an any-time frame: begun anew when something has changed.
[[gnu::noinline]] Status draw_anytime(Demo* demo, uint32_t visits, uint32_t* crc) {
  const port::Display& screen = display();
  AnytimeFrame& frame = demo->held->frame;
  const Bytes bytes = demo->held->frame_bytes;
  const CompactTree& tree = demo->shown.scene.tree();
  Status status = Status::kOk;
  if (demo->changed) {
    status = demo->builds
                 ? AnytimeFrame::make(demo->pool, demo->camera, demo->shading, screen.format, bytes, &frame)
                 : AnytimeFrame::make(tree, demo->camera, demo->shading, screen.format, bytes, &frame);
  }
  if (status == Status::kOk) {
    status = demo->builds ? frame.refine(demo->pool, pool_visits(visits, !demo->spheres.is_done()))
                          : frame.refine(tree, visits);
  }
  if (status != Status::kOk) {
    return status;
  }
  demo->inexact = frame.inexact();
  const Band all = frame.band(0, screen.height_px);
  port::flush(all);
  *crc = demo->tells_crc ? crc32(all.pixels) : 0;
  return Status::kOk;
}

/// Draws and flushes what there is time for.
[[gnu::noinline]] Status draw_held(Demo* demo, uint32_t* crc) {
  if (demo->builds || !demo->shown.has_map) {
    return draw_anytime(demo, visits_a_frame(demo->fps), crc);
  }
  const int32_t step = demo->changed ? thinning_for(demo->fps) : 1;
  if (step > 1) {
    return draw_thinned(demo, step, crc);
  }
  demo->inexact = 0;
  return draw_frame(demo, crc);
}

/// The frame that was drawn last, once more and over the UART, in the display's own colours or greys.
[[gnu::noinline]] void send_picture(const Demo& demo) {
  const port::Display& screen = display();
  const PixelFormat format = screen.format;
  const bool has_colors = !is_gray(format);
  port::await_flush();  // the bands' memory is used here
  put(has_colors ? "P6\n" : "P5\n", static_cast<uint32_t>(screen.width_px), " ",
      static_cast<uint32_t>(screen.height_px), "\n255\n");
  for (int32_t y = 0; y < screen.height_px; ++y) {
    const int32_t together = band_row_multiple(format);
    const int32_t left = screen.height_px - y;
    const Band band{demo.bands.memory.subspan(0, row_bytes(format, screen.width_px)), format, 0, y,
                    left < together ? left : together};
    if (begins_bytes(format, y) && draw(demo, band) != Status::kOk) {
      return;
    }
    uint8_t bytes[30];  // whole pixels
    for (int32_t x = 0; x < screen.width_px;) {
      size_t count = 0;
      for (; count < sizeof bytes && x < screen.width_px; ++x) {
        const Rgb8 color = load_pixel(band.pixels.data, x, y, format);
        bytes[count++] = color.r;
        if (has_colors) {
          bytes[count++] = color.g;
          bytes[count++] = color.b;
        }
      }
      port::write({bytes, count});
    }
  }
  put("\n");
}

[[gnu::noinline]] void show_baked(Demo* demo) {
  demo->builds = false;
  demo->changed = true;
  demo->frame = 0;
  demo->turned = 0;
  demo->orbit = orbit_of(demo->shown.scene);
  demo->shading = demo_shading(demo->shown.scene.palette());
  if ((kImageEffects & Effect::kEdges) != 0 && is_dark_behind(demo->light.effects(), display().format)) {
    demo->shading.background = {0, 0, 0};
  }
  demo->is_lit = false;
}

[[gnu::noinline]] void begin_build(Demo* demo) {
  const Bytes bytes = demo->arena.rest().subspan(0, kMostPoolBytes);
  // A world that spheres cannot fill before they fill the pool.
  const int level = bytes.size > (size_t{64} << 10) ? 7 : 6;
  if (Octree::make(level, bytes, &demo->pool) != Status::kOk) {
    return;
  }
  demo->builds = true;
  demo->is_lit = false;
  demo->is_full = false;
  demo->changed = true;
  demo->frame = 0;
  demo->turned = 0;
  demo->spheres.begin(level);
  const int32_t side = int32_t{1} << level;
  demo->orbit = orbit_of(VoxelBox{{0, 0, 0}, {side, side, side}});
  demo->shading = demo_shading(SphereBuilder::palette());
  put("building in a pool of ", demo->pool.capacity(), " nodes\n");
}

/// Some voxels more. When the pool is full the tree coarsens from then on, for a few spheres more.
[[gnu::noinline]] void build_more(Demo* demo) {
  for (uint32_t i = 0; i < kPlacesAFrame && !demo->spheres.is_done(); ++i) {
    Voxel voxel;
    if (!demo->spheres.next(&voxel)) {
      continue;
    }
    if (demo->pool.insert(voxel.position, voxel.material) == Status::kOutOfMemory && !demo->is_full) {
      put("pool full: voxels ", demo->pool.voxels(), " nodes ", demo->pool.nodes_used(), "; coarsening\n");
      demo->is_full = true;
      demo->pool.set_coarsen(true);
      demo->spheres.end_after(demo->spheres.finished() + kSpheresBeyond);
      // A pool that coarsens takes everything, or holds no node at all.
      (void)demo->pool.insert(voxel.position, voxel.material);
    }
  }
}

/// Begins to hold a rate, or leaves it.
[[gnu::noinline]] void switch_hold(Demo* demo) {
  demo->changed = true;
  if (demo->holds || !can_hold()) {
    demo->holds = false;
    put(can_hold() ? "exact frames\n" : "this board holds no rate of frames\n");
    return;
  }
  if (demo->held == nullptr) {
    demo->held = place_held_frame(&demo->arena);
    if (demo->held == nullptr) {
      put("no room for a whole frame to hold a rate of frames\n");
      return;
    }
    if (demo->builds) {
      begin_build(demo);  // its pool lay there
    }
  }
  demo->holds = true;
  put("holding ", demo->fps, " frames a second: ");
  if (demo->shown.has_map) {
    put("a pixel of ", static_cast<uint32_t>(thinning_for(demo->fps)), " both ways\n");
  } else {
    put(visits_a_frame(demo->fps), " visits a frame\n");
  }
}

[[gnu::noinline]] void switch_light(Demo* demo) {
  if (demo->light.effects() == Effect::kNone) {
    put("the scene was baked for no effects\n");
    return;
  }
  demo->lights = !demo->lights;
  demo->turns = demo->light.is_fast ? demo->turns : !demo->lights;
  demo->changed = true;
}

/// Whether the next frame is drawn with light: the first, and any where that is fast, unless a rate is held; else once nothing
/// moves.
bool lights_next(const Demo& demo) {
  return kCanLight && demo.lights && !demo.builds &&
         (!demo.changed || ((demo.light.is_fast || demo.frame == 0) && !demo.holds));
}

/// Whether to continue.
[[gnu::noinline]] bool obey(Demo* demo) {
  const uint32_t buttons = port::buttons();
  demo->changed = demo->changed || buttons != 0;
  steer(buttons, &demo->steering);
  for (int i = 0; i < kKeysAFrame; ++i) {
    switch (port::read()) {
      case -1:
        return true;
      case 'q':
        return false;
      case 'p':
        if (demo->frame != 0) {
          send_picture(*demo);
        }
        break;
      case 'b':
        begin_build(demo);
        break;
      case 's':
        show_baked(demo);
        break;
      case 'h':
        switch_hold(demo);
        break;
      case 'l':
        if constexpr (kCanLight) {
          switch_light(demo);
        }
        break;
      case 't':
        demo->turns = !demo->turns;
        demo->changed = demo->changed || (demo->lights && demo->turns);
        break;
      case 'c':
        demo->tells_crc = !demo->tells_crc;
        demo->is_lit = false;  // draws it again
        break;
      default:
        break;
    }
  }
  return true;
}

[[gnu::noinline]] Status place_camera(Demo* demo) {
  const port::Display& screen = display();
  if (demo->builds) {
    return view_at(demo->orbit, demo->pool, demo->turned, demo->steering, screen.width_px, screen.height_px,
                   &demo->camera);
  }
  return view_at(demo->orbit, demo->shown.scene.tree(), demo->turned, demo->steering, screen.width_px,
                 screen.height_px, &demo->camera);
}

[[gnu::noinline]] Status draw_picture(Demo* demo, bool lights, uint32_t* crc) {
  demo->is_lit = lights;
  if constexpr (kCanLight) {
    demo->is_whole = lights && (!demo->changed || !demo->light.is_fast || demo->light.moves_whole());
  }
  return kCanHold && demo->holds && !(kCanLight && lights) ? draw_held(demo, crc) : draw_frame(demo, crc);
}

[[gnu::noinline]] void tell_frame(const Demo& demo, uint32_t crc) {
  put(demo.builds ? "build " : "frame ", demo.frame, " crc ", Hex{crc});
  if (demo.builds) {
    put(" voxels ", demo.pool.voxels(), " nodes ", demo.pool.nodes_used(), " added ", demo.pool.solid_added(),
        demo.spheres.is_done() ? " done" : "");
  }
  if (kCanLight && demo.is_lit) {
    put(" lit");
  }
  if (demo.holds) {
    put(" inexact ", demo.inexact);
  }
  put("\n");
}

/// Where the scene has a camera that this display cannot have: round what is solid.
[[gnu::noinline]] Status place_camera_round_solid(Demo* demo) {
  demo->orbit = orbit_of(demo->shown.scene.tree().bounds());
  return place_camera(demo);
}

/// Takes memory for bands, at most half of what is left: the other half is for the pool. False: not a row fits.
bool take_bands(Demo* demo) {
  const port::Display& screen = display();
  Bytes stack;
  if (port::cores() > 1 && demo->arena.free_bytes() > 8 * port::facts().stack_bytes) {
    stack = demo->arena.take(port::facts().stack_bytes);
  }
  demo->bands.rows = most_band_rows();
  while (demo->bands.rows > band_row_multiple(screen.format) &&
         crew_bands(Bands::bytes_for(demo->bands.rows)) > demo->arena.free_bytes() / 2) {
    --demo->bands.rows;
  }
  const size_t one = Bands::bytes_for(demo->bands.rows);
  const Bytes bands = demo->arena.take(crew_bands(one));
  demo->bands.memory = bands.subspan(0, all_bands(one));
  demo->crew.take(stack, bands);
  return !demo->bands.memory.empty();
}

/// Opens the scene, its light and map, and takes memory for bands. Null, or why not.
[[gnu::noinline]] const char* begin(Demo* demo) {
  if (const char* wrong = open_scene(&demo->shown)) {
    return wrong;
  }
  if (const char* wrong = open_light(demo->shown.scene, &demo->light)) {
    return wrong;
  }
  open_map(&demo->shown, &demo->arena);
  prove_light(demo->shown, &demo->arena, &demo->light);
  tell_board_and_scene("demo", demo->shown);
  demo->tells_crc = !display().connected;
  demo->ink.take(&demo->arena);
  if (!take_bands(demo)) {
    return "the arena does not hold a row of the picture";
  }
  start_crew(demo);
  show_baked(demo);
  demo->lights = demo->light.effects() != Effect::kNone;
  demo->turns = !demo->lights || demo->light.is_fast;
  if (port::facts().hold_fps != 0) {
    demo->fps = port::facts().hold_fps;
    switch_hold(demo);
  }
  return nullptr;
}

}  // namespace

int demo() {
  Arena whole(port::arena());
  Demo* const demo = place<Demo>(&whole);
  if (demo == nullptr) {
    return refuse_with_cross(&whole, "the arena is too small");
  }
  demo->arena = whole;
  if (const char* wrong = begin(demo)) {
    return refuse_with_cross(&demo->arena, wrong);
  }
  for (uint32_t drawn = 0; port::running(drawn) && obey(demo); ++drawn) {
    if (demo->builds && !demo->spheres.is_done()) {
      build_more(demo);
      demo->changed = true;
    }
    const bool lights = lights_next(*demo);
    if (lights && demo->is_lit && demo->is_whole && !demo->changed) {
      continue;  // it is there already
    }
    const uint32_t start = port::instructions();
    Status status = place_camera(demo);
    if (status != Status::kOk && !demo->builds) {
      status = place_camera_round_solid(demo);
    }
    uint32_t crc = 0;
    if (status == Status::kOk) {
      status = draw_picture(demo, lights, &crc);
    }
    if (demo->holds && demo->changed) {
      const uint32_t taken = port::instructions() - start;
      demo->most_instructions = taken > demo->most_instructions ? taken : demo->most_instructions;
    }
    demo->changed = demo->turns;
    if (status != Status::kOk) {
      return refuse_with_cross(&demo->arena, status_text(status));
    }
    if (demo->tells_crc) {
      tell_frame(*demo, crc);
    }
    ++demo->frame;
    demo->turned += demo->turns ? 1 : 0;
  }
  if (demo->most_instructions != 0) {
    put("most instructions of a held frame: ", demo->most_instructions, "\n");
  }
  if (kCanLight && demo->lit_instructions != 0) {
    put("instructions of a lit frame: ", demo->lit_instructions, "\n");
  }
  tell_crew(*demo);
#if defined(THIMBLE_HOLDS)
  while (port::holding() && obey(demo)) {
  }
#endif
  return 0;
}

}  // namespace thimble::apps
