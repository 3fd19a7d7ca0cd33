#include "viewer/finished_picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <exception>
#include <new>

#include "scene/magnify.h"
#include "thimble/light/render.h"
#include "thimble/picture/render.h"
#include "thimble/tree/octree.h"

namespace thimble::tools::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPublishTime{60};  // between two states of a pass that are shown
constexpr std::int32_t kRowsAThread = 2;
// Many rows are drawn together, as long as a key need not wait for them.
constexpr std::chrono::milliseconds kChunkTime{40};
constexpr std::int32_t kMostRowsAThread = 8;
constexpr std::int32_t kEdgeRowsAThread = 8;  // many samples are drawn together

Band row_of(const Camera& camera, std::int32_t row, std::uint8_t* rgb) {
  return {Bytes(rgb, row_bytes(PixelFormat::kRgb888, camera.width_px())), PixelFormat::kRgb888, 0, row, 1};
}

// A picture by `paint`, of which `rgb` gets rows as they come where there `are_rows`. False where `goes_on` ended it.
template <class Paint>
bool paint_into(std::int32_t width_px, std::int32_t height_px, bool are_rows, std::vector<std::uint8_t>* rgb,
                const FinishedPicture::GoesOn& goes_on, const Paint& paint) {
  struct Ended {};
  const std::size_t line = 3 * static_cast<std::size_t>(width_px);
  rgb->resize(line * static_cast<std::size_t>(height_px));
  Painting painting;
  std::size_t shown = 0;
  const auto show = [&](double done) {
    const auto rows = are_rows ? static_cast<std::int32_t>(std::lround(done * height_px)) : 0;
    const std::size_t end = line * static_cast<std::size_t>(rows);
    std::copy(painting.image.pixels.data() + shown, painting.image.pixels.data() + end, rgb->data() + shown);
    shown = end;
    if (!goes_on(rows)) {
      throw Ended();
    }
  };
  try {
    check_lit_limits(paint(show, &painting));
  } catch (const Ended&) {
    return false;
  }
  rgb->swap(painting.image.pixels);
  return goes_on(height_px);
}

// Rows of a pass into `image`, which holds all of it: every `step`-th pixel with its first sample, or with step 0 all
// samples of all pixels. `fine` has `across` x `across` pixels for each of the picture's. What is in `kept` is of the
// same picture; a pass with a step leaves its own samples there.
Status draw_pass(const LookRows& look, const Camera& fine, int across, int step, std::int32_t first,
                 std::int32_t rows, KeptSamples* kept, Image* image) {
  constexpr std::size_t kChannels = 4;
  constexpr std::int32_t kColumns = 8;  // so that what lies side by side is drawn together
  // Of the pass's picture; (px, py) in the finished one. `is_known`: its first sample was drawn before.
  struct Pixel {
    std::int32_t x, y, px, py;
    bool is_known;
  };
  std::vector<Pixel> pixels;
  std::vector<SamplePlace> places;
  const std::int32_t every = std::max(step, 1);
  const std::int32_t count = step == 0 ? across * across : 1;  // of the samples that a pixel gets
  for (std::int32_t left = 0; left < image->width_px; left += kColumns) {
    for (std::int32_t y = first; y < first + rows; ++y) {
      for (std::int32_t x = left; x < std::min(left + kColumns, image->width_px); ++x) {
        const std::int32_t px = x * every;
        const std::int32_t py = y * every;
        const bool is_known = kept->step != 0 && px % kept->step == 0 && py % kept->step == 0;
        pixels.push_back({x, y, px, py, is_known});
        for (std::int32_t i = is_known ? 1 : 0; i < count; ++i) {
          places.push_back({px * across + i % across, py * across + i / across, px, py});
        }
      }
    }
  }
  std::vector<std::uint8_t> colors(3 * places.size());
  std::vector<std::uint8_t> samples(kChannels * places.size());
  const Status status =
      look.draw_places(fine, {places.data(), places.size()}, Bytes(colors.data(), colors.size()),
                       Bytes(samples.data(), samples.size()), nullptr);
  const std::uint8_t* next = samples.data();
  const auto width = static_cast<std::size_t>(fine.width_px() / across);
  for (const Pixel& pixel : pixels) {
    std::array<std::uint8_t, kChannels>& own =
        kept->drawn[static_cast<std::size_t>(pixel.py) * width + static_cast<std::size_t>(pixel.px)];
    if (!pixel.is_known) {
      std::copy_n(next, kChannels, own.begin());
      next += kChannels;
    }
    std::array<std::uint32_t, kChannels> sums{own[0], own[1], own[2], own[3]};
    for (std::int32_t i = 1; i < count; ++i, next += kChannels) {
      for (std::size_t channel = 0; channel < kChannels; ++channel) {
        sums[channel] += next[channel];
      }
    }
    LookRows::finish_sums(pixel.x, pixel.y, sums.data(), static_cast<std::uint32_t>(count), image);
  }
  return status;
}

}  // namespace

FinishedLook::FinishedLook(std::shared_ptr<const OpenScene> scene, const LookWishes& wishes)
    : scene_(std::move(scene)),
      engine_(wishes.engine),
      lighting_(wishes.effects.lighting(scene_->source->lighting())) {
  lighting_.find_glow(scene_->tree());
  used_ = used_materials(scene_->tree());
  choose(wishes);
  lit_ = lit_scene_for(lighting_, used_, effects_);
  quick_ = lit_scene_for(lighting_, used_, effects_ & kQuickEffects);
  empty_bytes_.resize(4096);
  Arena arena(Bytes(empty_bytes_.data(), empty_bytes_.size()));
  Octree octree;
  fail_if(Octree::make(scene_->level(), 16, arena, &octree) != Status::kOk ||
              CompactTree::make(octree, arena, &empty_) != Status::kOk,
          "internal error: there is no empty world");
}

void FinishedLook::choose(const LookWishes& wishes) {
  const EffectChoice& choice = wishes.effects.choice;
  if (choice.is_given) {
    words_.insert(words_.end(), {"--effects", choice.automatic ? "auto"
                                              : choice.on_top  ? "all"
                                                               : effects_text(choice.effects)});
  }
  if (wishes.shade) {
    words_.insert(words_.end(), {"--shade", wishes.shade_word});
  }
  if (!choice.is_given && !wishes.shade) {
    own_ = facts_of(*scene_->source, lighting_, scene_->shape);
    own_wishes_.across = wishes.across;
    own_wishes_.at_edges = wishes.at_edges;
    own_wishes_.smooth = choice.smooth;
  }
  if (choice.smooth) {
    words_.insert(words_.end(), {"--normals", *choice.smooth ? "smooth" : "face"});
  }
  // A --shade that is given shows no light.
  effects_ = choice.is_given ? chosen_effects(lighting_, used_, choice) : Effect::kNone;
  mode_ = wishes.shade.value_or(scene_->source->single_material() ? ShadeMode::kDepth : ShadeMode::kColor);
  if (wishes.effects.bounces) {
    words_.insert(words_.end(), {"--bounces", std::to_string(*wishes.effects.bounces)});
  }
  const int across = wishes.across != 0 ? wishes.across : 2;
  across_ = own_ ? 1 : across;
  at_edges_ = !own_ && wishes.at_edges;
  if (!own_ || wishes.across != 0) {
    words_.insert(words_.end(), {"--samples", wishes.at_edges ? "auto" : std::to_string(across * across)});
  }
}

// Takes a GPU of its own, with --engine gpu a software driver, too, where a small picture of this view has the pixels that
// the core's has.
void FinishedLook::try_gpu(const Look& look, const Camera& camera, const Shading& shading,
                           int threads) const {
  constexpr std::int32_t kMostPx = 64;
  gpu_tried_ = true;
  const std::vector<Rgb8>& palette = scene_->built->palette();
  auto gpu = GpuEngine::make(scene_->tree(), Span<const Rgb8>(palette.data(), palette.size()), threads);
  if (engine_ != "gpu" && gpu->is_software()) {
    return;
  }
  const Camera thin =
      camera.thinned((std::max(camera.width_px(), camera.height_px()) + kMostPx - 1) / kMostPx);
  std::vector<std::uint8_t> pixels[2];
  for (std::size_t by_gpu = 0; by_gpu < 2; ++by_gpu) {
    pixels[by_gpu].resize(band_bytes(PixelFormat::kRgb888, thin.width_px(), thin.height_px()));
    const Band band{Bytes(pixels[by_gpu].data(), pixels[by_gpu].size()), PixelFormat::kRgb888, 0, 0,
                    thin.height_px()};
    const LitScene scene = look.lit_scene();
    check_lit_limits(by_gpu != 0 ? gpu->render({look.effects, thin, shading, scene}, band, nullptr)
                                 : render_lit_band(look.effects, scene_->tree(), thin, shading, scene, band));
  }
  if (pixels[0] == pixels[1]) {
    gpu_ = std::move(gpu);
    has_gpu_.store(true);
  } else if (engine_ == "gpu") {
    throw InputError("--engine gpu: " + gpu->device() + " draws other pixels than the core");
  }
}

std::string FinishedLook::gpu() const {
  return has_gpu_.load() ? gpu_->device() : "";
}

// Null where there is no room, or nothing is to stand beside a large file: then the core draws.
LitStreams* FinishedLook::streams_for(const Look& look, const Camera& camera, const Shading& shading,
                                      int threads) const {
  const EffectSet effects = look.effects;
  const LitScene scene = look.lit_scene();
  const bool from_file = scene_->built->draws_from_file();
  if (engine_ != "wide" && (effects & ~GpuEngine::effects()) == 0 && (!from_file || engine_ == "gpu")) {
    try {
      if (!gpu_tried_) {
        try_gpu(look, camera, shading, threads);
      }
    } catch (const InputError&) {
      if (engine_ == "gpu") {
        throw;
      }
    }
    if (gpu_ != nullptr) {
      return gpu_.get();
    }
  }
  if (from_file) {
    return nullptr;
  }
  const std::size_t bytes = LitStreams::bytes(scene_->tree(), effects, scene, threads);
  if (bytes > streams_bytes_ || (effects & ~streams_effects_) != 0) {
    streams_bytes_ = bytes;
    streams_effects_ = effects;
    streams_.reset();
    try {
      streams_memory_ = HostMemory(bytes);
    } catch (const std::bad_alloc&) {
      return nullptr;
    }
    Arena arena(streams_memory_.bytes());
    streams_ = LitStreams::make(scene_->tree(), &arena, effects, scene, threads);
  }
  return streams_.get();
}

FinishedPicture::FinishedPicture(std::shared_ptr<const FinishedLook> look, const ViewWishes& wishes)
    : look_(std::move(look)), wishes_(wishes) {
  const OpenScene& scene = *look_->scene_;
  framing_ = frame_scene(wishes, *scene.source, scene.shape);
  shading_ = scene_shading(look_->mode_, {scene.built->palette().data(), scene.built->palette().size()},
                           camera(), scene.built->bounds());
  if (look_->own_) {
    take_own_look();
    return;
  }
  fine_ = across() == 1 ? framing_.camera
                        : frame_scene(finer(wishes, across()), *scene.source, scene.shape).camera;
  quick_shading_ = shading_;
  if (look_->effects_ != Effect::kNone) {
    quick_shading_.mode = ShadeMode::kColor;
    quick_light(look_->lit_, quick_shading_.face_light);
  }
}

// The scene's own look, as render_look.cpp takes it.
void FinishedPicture::take_own_look() {
  own_ = default_look(*look_->own_, look_->own_wishes_, framing_);
  const EffectSet missing = own_->effects & ~GpuEngine::effects();
  fail_if(look_->engine_ == "gpu" && (own_->kind == LookKind::kStars || missing != Effect::kNone),
          "--engine gpu does not draw " + (own_->kind == LookKind::kStars
                                               ? std::string("points as stars")
                                               : "the effects " + effects_text(missing)));
  fine_ = fine_camera(framing_, &*own_);
  constexpr std::uint32_t kFirstExposure = 320;
  const std::uint32_t measured = look_->exposure_.load();
  quick_tone_ = quick_tone(*own_, measured != 0 ? measured : kFirstExposure);
  quick_shading_ = shading_;
  if (own_->kind == LookKind::kStars) {
    quick_shading_.mode = own_->has_own_colors ? ShadeMode::kColor : ShadeMode::kDepth;
    return;
  }
  quick_shading_.mode = ShadeMode::kColor;
  const QuickLook quick = quick_look(*own_, quick_tone_);
  std::copy(std::begin(quick.face_light), std::end(quick.face_light), std::begin(quick_shading_.face_light));
  quick_palette_ = quick.palette;
  quick_shading_.palette = Span<const Rgb8>(quick_palette_.data(), quick_palette_.size());
}

void enlarge(const std::vector<std::uint8_t>& small, int step, std::int32_t width_px, std::int32_t height_px,
             wide::Threads* threads, std::vector<std::uint8_t>* rgb) {
  const std::int32_t rows = thinned_px(height_px, step);
  rgb->resize(3 * static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  const std::int32_t part = (rows + threads->count() - 1) / threads->count();
  threads->each(threads->count(), [&](int i) {
    const std::int32_t first = std::min(rows, part * i);
    const std::int32_t end = std::min(rows, first + part);
    if (first < end) {
      std::vector<std::uint16_t> work(magnify_work(width_px));
      magnify_rows(small.data(), step, width_px, height_px, first, end, work.data(), rgb->data());
    }
  });
}

bool FinishedPicture::draw(int step, wide::Threads* threads, std::vector<std::uint8_t>* rgb,
                           const GoesOn& goes_on, KeptSamples* kept) const {
  if (own_ && own_->kind == LookKind::kLit && (step != 0 || !own_->at_edges)) {
    KeptSamples none;
    return draw_own(step, threads, rgb, goes_on, kept != nullptr ? kept : &none);
  }
  if (own_ && step == 0) {
    return paint_own(threads->count(), rgb, goes_on);
  }
  // What --effects and --shade say.
  const Camera thin = camera().thinned(std::max(step, 1));
  const int many = step == 0 ? across() : 1;
  const Sampler sampler{
      "", threads->count(),
      [this](const Camera& view, bool /*is_fine*/, const Band& band, PaintCounts* /*counts*/) {
        return render_lit_band(look_->effects_, look_->scene_->tree(), view, shading_, look_->lit_, band);
      }};
  Quality quality;
  quality.across = many;
  quality.at_edges = step == 0 && at_edges();
  const std::int32_t rows = (quality.at_edges ? kEdgeRowsAThread : kRowsAThread) * threads->count();
  std::vector<std::uint8_t> work(static_cast<std::size_t>(
      quality_band_bytes(quality, PixelFormat::kRgb888, thin.width_px(), rows, threads->count())));
  const Bytes place(work.data(), work.size());
  const BandPainter painter =
      quality.at_edges ? edge_painter(sampler, camera(), fine_, PixelFormat::kRgb888, place)
                       : square_painter(sampler, many == 1 ? thin : fine_, many, PixelFormat::kRgb888, place);
  return paint_into(thin.width_px(), thin.height_px(), true, rgb, goes_on,
                    [&](const Progress& progress, Painting* painting) {
                      return paint(painter, thin.width_px(), {0, thin.height_px()}, PixelFormat::kRgb888,
                                   progress, painting);
                    });
}

// Also how many samples there are, as in render_look.cpp.
void FinishedPicture::expose(LookCanvas* canvas) const {
  std::call_once(exposed_, [&] {
    const LookMeasure measured = measure_look(*canvas);
    exposure_ = measured.exposure_q8;
    look_->exposure_.store(exposure_);
    if (look_->own_wishes_.across == 0 && !measured.allows_four()) {
      own_->across = 1;
      fine_ = framing_.camera;
    }
  });
  canvas->fine = fine_;
}

void FinishedPicture::keep_exposure() {
  if (const std::uint32_t measured = look_->exposure_.load(); measured != 0) {
    std::call_once(exposed_, [&] { exposure_ = measured; });
  }
}

bool FinishedPicture::draw_own(int step, wide::Threads* threads, std::vector<std::uint8_t>* rgb,
                               const GoesOn& goes_on, KeptSamples* kept) const {
  LookCanvas canvas{&look_->scene_->tree(), &*own_, &framing_, fine_, {}, threads->count()};
  const std::unique_lock<std::mutex> lock(look_->streams_mutex_, std::try_to_lock);
  if (lock.owns_lock()) {
    canvas.streams = look_->streams_for(*own_, camera(), shading_, threads->count());
  }
  expose(&canvas);
  const LookRows rows(canvas, fine_, exposure_);
  kept->drawn.resize(static_cast<std::size_t>(width_px()) * static_cast<std::size_t>(height_px()));
  Image image;
  image.width_px = thinned_px(width_px(), std::max(step, 1));
  image.height_px = thinned_px(height_px(), std::max(step, 1));
  const std::size_t line = 3 * static_cast<std::size_t>(image.width_px);
  image.pixels.resize(line * static_cast<std::size_t>(image.height_px));
  rgb->resize(image.pixels.size());
  std::int32_t chunk = kRowsAThread * threads->count();
  for (std::int32_t first = 0; first < image.height_px;) {
    const auto start = std::chrono::steady_clock::now();
    const std::int32_t count = std::min(chunk, image.height_px - first);
    check_lit_limits(draw_pass(rows, fine_, own_->across, step, first, count, kept, &image));
    std::memcpy(rgb->data() + line * static_cast<std::size_t>(first),
                image.pixels.data() + line * static_cast<std::size_t>(first),
                line * static_cast<std::size_t>(count));
    first += count;
    if (!goes_on(first)) {
      return false;
    }
    const auto took = std::chrono::steady_clock::now() - start;
    chunk = took < kChunkTime / 2 ? std::min(2 * chunk, kMostRowsAThread * threads->count())
            : took > kChunkTime   ? std::max(chunk / 2, 1)
                                  : chunk;
  }
  kept->step = std::max(step, 1);
  return true;
}

// The whole picture of the scene's own look at once: stars, or samples where edges are.
bool FinishedPicture::paint_own(int threads, std::vector<std::uint8_t>* rgb, const GoesOn& goes_on) const {
  const bool has_rows = at_edges();  // which are finished one after the other
  std::vector<std::uint8_t> work(has_rows ? look_edge_bytes(width_px(), kEdgeRowsAThread * threads, threads)
                                          : look_work_bytes(width_px(), 1) *
                                                static_cast<std::size_t>(height_px()));
  LookCanvas canvas{&look_->scene_->tree(),          &*own_, &framing_, fine_,
                    Bytes(work.data(), work.size()), threads};
  std::unique_lock<std::mutex> lock(look_->streams_mutex_, std::defer_lock);
  if (has_rows) {
    expose(&canvas);
    if (lock.try_lock()) {
      canvas.streams = look_->streams_for(*own_, camera(), shading_, threads);
    }
  }
  return paint_into(width_px(), height_px(), has_rows, rgb, goes_on,
                    [&](const Progress& progress, Painting* painting) {
                      return paint_look(canvas, has_rows ? exposure_ : 256, progress, painting);
                    });
}

bool FinishedPicture::is_plain() const {
  return (effects() & Effect::kWater) == 0;
}

const WaterSurface* FinishedPicture::water() const {
  if (is_plain()) {
    return nullptr;
  }
  return own_ ? &own_->lighting.rest.water : &look_->lighting_.rest.water;
}

bool FinishedPicture::has_behind() const {
  return own_ ? own_->kind == LookKind::kLit : (effects() & Effect::kSky) != 0;
}

void FinishedPicture::draw_quick_row(int step, std::int32_t row, std::uint8_t* rgb) const {
  const Camera thin = camera().thinned(step);
  const CompactTree& tree = look_->scene_->tree();
  const EffectSet quick = own_ && own_->kind == LookKind::kStars ? Effect::kNone : effects() & kQuickEffects;
  if (quick == Effect::kNone) {
    check_lit_limits(render_band(tree, thin, quick_shading_, row_of(thin, row, rgb)));
    return;
  }
  constexpr Rgb8 kBehind{1, 0, 2};  // no surface's colour by chance
  Shading shading = quick_shading_;
  if (own_) {
    shading.palette = Span<const Rgb8>(own_->palette.data(), own_->palette.size());  // toned below
  }
  if (own_ && own_->has_backdrop) {
    shading.background = kBehind;
  }
  LitScene scene = own_ ? own_->lit_scene() : look_->quick_;
  if (moving_water_) {
    scene.water = *moving_water_;
  }
  check_lit_limits(render_lit_band(quick, tree, thin, shading, scene, row_of(thin, row, rgb)));
  for (std::int32_t x = 0; own_ && x < thin.width_px(); ++x, rgb += 3) {
    const bool is_behind = own_->has_backdrop && Rgb8{rgb[0], rgb[1], rgb[2]} == kBehind;
    const Rgb8 color = is_behind ? backdrop_color(own_->background, row, thin.height_px())
                                 : Rgb8{quick_tone_[rgb[0]], quick_tone_[rgb[1]], quick_tone_[rgb[2]]};
    store_pixel(rgb, 0, row, PixelFormat::kRgb888, color);
  }
}

void FinishedPicture::draw_behind_row(int step, std::int32_t row, std::uint8_t* rgb) const {
  const Camera thin = camera().thinned(step);
  if (own_ && own_->has_backdrop) {
    const Rgb8 color = backdrop_color(own_->background, row, thin.height_px());
    for (std::int32_t x = 0; x < thin.width_px(); ++x) {
      store_pixel(rgb, x, row, PixelFormat::kRgb888, color);
    }
    return;
  }
  check_lit_limits(render_lit_band(Effect::kSky, look_->empty_, thin, quick_shading_,
                                   own_ ? own_->lit_scene() : look_->lit_, row_of(thin, row, rgb)));
  if (own_) {
    std::transform(rgb, rgb + 3 * static_cast<std::size_t>(thin.width_px()), rgb,
                   [this](std::uint8_t channel) { return quick_tone_[channel]; });
  }
}

Refinement::Refinement(std::shared_ptr<const FinishedPicture> picture, int threads)
    : picture_(std::move(picture)), threads_(threads), thread_([this] { run(); }) {}

Refinement::~Refinement() {
  cancel();
  thread_.join();
}

void Refinement::run() {
  try {
    bool goes_on = true;
    for (int every = kMostRefinedStep; goes_on && every > 1; every /= 2) {
      goes_on = draw_coarse(every);
    }
    if (goes_on && picture_->across() > 1) {
      goes_on = draw_full(false);
    }
    if (goes_on) {
      draw_full(true);
    }
  } catch (const std::exception& error) {
    const std::scoped_lock lock(mutex_);
    fault_ = error.what();
  }
  ended_.store(true);
}

// Whether it was drawn to its end.
bool Refinement::draw_coarse(int every) {
  std::vector<std::uint8_t> small;
  if (!picture_->draw(
          every, &threads_, &small, [&](std::int32_t /*rows*/) { return !cancelled_.load(); }, &kept_)) {
    return false;
  }
  std::vector<std::uint8_t> full;
  enlarge(small, every, picture_->width_px(), picture_->height_px(), &threads_, &full);
  const std::scoped_lock lock(mutex_);
  rgb_.swap(full);
  now_ = {now_.version + 1, false, every, 100};
  return true;
}

// The rows of the whole picture go over those of the pass before.
bool Refinement::draw_full(bool is_final) {
  const std::int32_t height = picture_->height_px();
  const std::size_t line = 3 * static_cast<std::size_t>(picture_->width_px());
  std::vector<std::uint8_t> full;
  std::int32_t shown = 0;
  Clock::time_point published = Clock::now();
  return picture_->draw(
      is_final ? 0 : 1, &threads_, &full,
      [&](std::int32_t drawn) {
        if (cancelled_.load()) {
          return false;
        }
        if (drawn < height && Clock::now() < published + kPublishTime) {
          return true;
        }
        const std::scoped_lock lock(mutex_);
        rgb_.resize(full.size());
        std::memcpy(rgb_.data() + line * static_cast<std::size_t>(shown),
                    full.data() + line * static_cast<std::size_t>(shown),
                    line * static_cast<std::size_t>(drawn - shown));
        shown = drawn;
        now_ = {now_.version + 1, is_final && drawn == height, is_final ? 0 : 1, 100 * drawn / height};
        published = Clock::now();
        return true;
      },
      &kept_);
}

bool Refinement::is_finished() const {
  const std::scoped_lock lock(mutex_);
  return now_.is_finished && taken_.version == now_.version;
}

std::string Refinement::fault() const {
  const std::scoped_lock lock(mutex_);
  return fault_;
}

bool Refinement::take(std::vector<std::uint8_t>* rgb) {
  const std::scoped_lock lock(mutex_);
  if (now_.version == taken_.version) {
    return false;
  }
  *rgb = rgb_;
  taken_ = now_;
  return true;
}

}  // namespace thimble::tools::viewer
