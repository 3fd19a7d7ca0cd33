/// The picture that `thimble render` makes, and cheaper pictures of the same view.
///
/// This is the one place where the viewer knows how `render` frames, lights and samples a scene: what
/// `draw` ends with and what `thimble render` draws with the words of `FinishedLook::words` are the same
/// bytes. Without --shade and --effects it is the scene's own look (scene/default_look.h).
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "scene/default_look.h"
#include "scene/framing.h"
#include "scene/gpu_engine.h"
#include "scene/host_memory.h"
#include "scene/lit_description.h"
#include "scene/lit_streams.h"
#include "scene/look_picture.h"
#include "viewer/open_scene.h"
#include "wide/threads.h"

namespace thimble::tools::viewer {

// A picture from coarse to fine of which no sample is drawn twice: the samples of a coarse pass are among those of the
// finer ones.

/// The first samples of a picture's pixels, as far as passes have drawn them.
struct KeptSamples {
  int step = 0;                                    ///< every how-many-th pixel has it, each way; 0: none
  std::vector<std::array<std::uint8_t, 4>> drawn;  ///< a place for each pixel
};

/// What the command line says of how pictures look.
struct LookWishes {
  std::optional<ShadeMode> shade;  ///< --shade
  std::string shade_word;
  EffectWishes effects;
  int across = 0;               ///< --samples are its square; 0: not given
  bool at_edges = false;        ///< --samples auto; `across` is then kEdgeGrid
  std::string engine = "auto";  ///< --engine: of the scene's own look
};

/// What a scene's pictures have in common, whatever the camera.
class FinishedLook {
 public:
  /// Throws InputError for what the scene does not take.
  FinishedLook(std::shared_ptr<const OpenScene> scene, const LookWishes& wishes);

  /// The options of `thimble render` that look so.
  const std::vector<std::string>& words() const { return words_; }
  /// Samples a pixel are its square. 1 where the scene's own look decides: it takes fewer in a large picture.
  int across() const { return across_; }
  /// The GPU that draws, once it does; else "".
  std::string gpu() const;
  /// Has the exposure of the frame before.
  void keep_exposure(const FinishedLook& before) const { exposure_.store(before.exposure_.load()); }

 private:
  friend class FinishedPicture;
  void choose(const LookWishes& wishes);

  std::shared_ptr<const OpenScene> scene_;
  std::string engine_;
  std::optional<SceneFacts> own_;  // the scene's own look
  tools::LookWishes own_wishes_;
  LitDescription lighting_;
  UsedMaterials used_;
  EffectSet effects_ = Effect::kNone;
  LitScene lit_;
  LitScene quick_;  // of pictures while the camera moves
  ShadeMode mode_ = ShadeMode::kDepth;
  int across_ = 1;
  bool at_edges_ = false;
  std::vector<std::uint8_t> empty_bytes_;
  CompactTree empty_;  // a world with nothing in it
  std::vector<std::string> words_;
  /// Of the last picture that was measured, else 0; frames while something moves have it, too, so that nothing
  /// flickers.
  mutable std::atomic<std::uint32_t> exposure_{0};

  // Lit pictures by the GPU, with the scene on it, or by streams of rays: made when the first is drawn, for one that
  // draws at a time.
  LitStreams* streams_for(const Look& look, const Camera& camera, const Shading& shading, int threads) const;
  void try_gpu(const Look& look, const Camera& camera, const Shading& shading, int threads) const;
  mutable std::mutex streams_mutex_;  // of the next six
  mutable HostMemory streams_memory_;
  mutable std::size_t streams_bytes_ = 0;  // requested
  mutable EffectSet streams_effects_ = Effect::kNone;
  mutable std::unique_ptr<LitStreams> streams_;
  mutable std::unique_ptr<GpuEngine> gpu_;  // once it was found to draw the core's pixels
  mutable bool gpu_tried_ = false;
  mutable std::atomic<bool> has_gpu_{false};  // for those that do not hold the mutex; then it stays
};

/// Makes a picture of that size from every `step`-th pixel of it.
void enlarge(const std::vector<std::uint8_t>& small, int step, std::int32_t width_px, std::int32_t height_px,
             wide::Threads* threads, std::vector<std::uint8_t>* rgb);

/// One view. What draws is reentrant.
class FinishedPicture {
 public:
  /// Throws InputError for a camera that cannot be.
  FinishedPicture(std::shared_ptr<const FinishedLook> look, const ViewWishes& wishes);

  const FinishedLook& look() const { return *look_; }
  const ViewWishes& wishes() const { return wishes_; }
  const Framing& framing() const { return framing_; }
  const Camera& camera() const { return framing_.camera; }
  std::int32_t width_px() const { return camera().width_px(); }
  std::int32_t height_px() const { return camera().height_px(); }
  /// Samples a pixel are its square. Of the scene's own look it is known once something was drawn.
  int across() const { return !own_ ? look_->across_ : own_->kind == LookKind::kStars ? 1 : own_->across; }
  /// Whether there are samples where edges are instead (scene/edge_rows.h); `across` is then kEdgeGrid.
  bool at_edges() const {
    return !own_ ? look_->at_edges_ : own_->kind != LookKind::kStars && own_->at_edges;
  }

  /// Draws into `rgb`, which gets the size that it takes: `step` 0 the finished picture, else every `step`-th
  /// pixel with one sample and all of the light. `goes_on` gets now and then how many rows from the top
  /// are there, and ends it by false; then so does this. Throws InputError where the scene's lights are beyond
  /// the core's limits.
  using GoesOn = std::function<bool(std::int32_t rows)>;
  /// `kept` (may be null), which is for this picture alone, spares finer passes what coarser ones have drawn.
  bool draw(int step, wide::Threads* threads, std::vector<std::uint8_t>* rgb, const GoesOn& goes_on,
            KeptSamples* kept = nullptr) const;

  /// The same for a camera that moves: without shadows, occlusion, mirrors and glass.
  void draw_quick_row(int step, std::int32_t row, std::uint8_t* rgb) const;
  /// From now on what draw_quick_row draws has this water in place of the scene's; its columns must live as long.
  void show_water(const WaterSurface& water) { moving_water_ = water; }
  /// The water of the picture, or null.
  const WaterSurface* water() const;
  /// Whether there is light on surfaces.
  bool is_lit() const { return own_ ? own_->kind == LookKind::kLit : look_->effects_ != Effect::kNone; }
  /// From now on this picture has the exposure of the last that was measured, as the frames of a film have.
  void keep_exposure();
  /// Whether frames while the camera moves may be drawn by what knows only voxels (the wide renderer, with
  /// `quick_shading`); not so with water, which is none.
  bool is_plain() const;
  /// Whether there is more behind the voxels than one colour; then `draw_behind_row` draws it.
  bool has_behind() const;
  void draw_behind_row(int step, std::int32_t row, std::uint8_t* rgb) const;
  const Shading& quick_shading() const { return quick_shading_; }

 private:
  void take_own_look();
  bool draw_own(int step, wide::Threads* threads, std::vector<std::uint8_t>* rgb, const GoesOn& goes_on,
                KeptSamples* kept) const;
  void expose(LookCanvas* canvas) const;
  bool paint_own(int threads, std::vector<std::uint8_t>* rgb, const GoesOn& goes_on) const;
  EffectSet effects() const { return own_ ? own_->effects : look_->effects_; }

  std::shared_ptr<const FinishedLook> look_;
  ViewWishes wishes_;
  Framing framing_;
  mutable Camera fine_;  // so many times the pixels as there are samples across one
  Shading shading_;
  Shading quick_shading_;
  mutable std::optional<Look> own_;  // the scene's own look from here; `expose` settles its samples
  std::optional<WaterSurface> moving_water_;
  ToneTable quick_tone_;
  std::vector<Rgb8> quick_palette_;  // toned, as bright as the brightest face
  mutable std::once_flag exposed_;
  mutable std::uint32_t exposure_ = 256;
};

// From coarse to fine while nothing moves: the finished picture of a view, drawn on other threads.
//
// Every 8th, 4th and 2nd pixel with all of the light, stretched; every pixel; then the picture with its
// samples, row by row from the top. Whoever shows it takes what there is whenever there is more. Cancelling
// takes no time: the threads notice at their next row.

class Refinement final : public BackgroundTask {
 public:
  Refinement(std::shared_ptr<const FinishedPicture> picture, int threads);
  /// Cancels, and waits for the rows that are being drawn.
  ~Refinement() override;

  /// Whether what `take` gives now is the finished picture.
  bool is_finished() const;
  /// What the drawing threw, as a sentence; empty for nothing.
  std::string fault() const;
  /// Copies the picture as far as it is into `rgb`; false, and nothing done, where there is nothing new.
  bool take(std::vector<std::uint8_t>* rgb);
  /// Of the picture that `take` took last: every how-many-th pixel it has, 0 for the finished one; and the
  /// share of it that is drawn, in per cent.
  int step() const { return taken_.step; }
  int percent() const { return taken_.percent; }
  const FinishedPicture& picture() const { return *picture_; }

 private:
  static constexpr int kMostRefinedStep = 8;

  // How far the picture is; `version` counts up.
  struct State {
    std::uint64_t version = 0;
    bool is_finished = false;
    int step = kMostRefinedStep;
    int percent = 0;
  };

  void run();
  bool draw_coarse(int every);
  bool draw_full(bool is_final);

  std::shared_ptr<const FinishedPicture> picture_;
  wide::Threads threads_;
  KeptSamples kept_;
  State taken_;

  mutable std::mutex mutex_;  // of what follows
  std::vector<std::uint8_t> rgb_;
  State now_;
  std::string fault_;

  std::thread thread_;
};

}  // namespace thimble::tools::viewer
