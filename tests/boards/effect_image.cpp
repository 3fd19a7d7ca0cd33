// One frame of the baked scene, by a renderer for a set of effects that is chosen when this is compiled:
//
//   THIMBLE_IMAGE_PLAIN        render_band: an image that has never heard of effects
//   THIMBLE_IMAGE_EFFECTS=SET  render_lit_band<SET>
//   THIMBLE_IMAGE_BASE         the loop of a lit picture with no effect in it, and what opens the lighting
//
// The images' sizes tell what an effect takes of the flash (platform/boards/effect_flash.h); the frame's
// instructions tell that no effect takes no time.
#include "apps/demo_view.h"
#include "apps/place.h"
#include "apps/text.h"
#include "port.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"
#ifndef THIMBLE_IMAGE_PLAIN
#include "thimble/light/render.h"
#include "thimble/light/scene.h"
#endif

namespace thimble {
namespace {

constexpr int32_t kBandRows = 8;

struct Image : apps::Placed {
  BakedScene scene;
  Camera camera;
  Shading shading;
  Bytes band;
#if defined(THIMBLE_IMAGE_BASE)
  BakedLighting lighting;
#elif defined(THIMBLE_IMAGE_EFFECTS) && THIMBLE_IMAGE_EFFECTS != 0
  BakedLighting lighting;
#endif
};

Status open_light([[maybe_unused]] Image* image) {
#if defined(THIMBLE_IMAGE_BASE) || (defined(THIMBLE_IMAGE_EFFECTS) && THIMBLE_IMAGE_EFFECTS != 0)
  const ConstBytes section = image->scene.section(SectionKind::kLighting);
  return BakedLighting::open(section, image->scene.tree().level(), &image->lighting);
#else
  return Status::kOk;
#endif
}

Status draw(const Image& image, const Band& band) {
  const CompactTree& tree = image.scene.tree();
#if defined(THIMBLE_IMAGE_PLAIN)
  return render_band(tree, image.camera, image.shading, band);
#elif defined(THIMBLE_IMAGE_BASE)
  return lit::draw<Effect::kNone>(
      {tree, image.camera, image.shading, image.lighting.scene, LitOptions{}, Effect::kNone}, band, nullptr);
#elif THIMBLE_IMAGE_EFFECTS == 0
  return render_lit_band<Effect::kNone>(tree, image.camera, image.shading, LitScene{}, band);
#else
  return render_lit_band<THIMBLE_IMAGE_EFFECTS>(tree, image.camera, image.shading, image.lighting.scene,
                                                band);
#endif
}

int draw_frame() {
  Arena arena(port::arena());
  Image* const image = apps::place<Image>(&arena);
  const port::Display& screen = port::facts().display;
  if (image == nullptr || BakedScene::open(port::scene(), &image->scene) != Status::kOk ||
      open_light(image) != Status::kOk) {
    return 1;
  }
  image->band = arena.take(band_bytes(screen.format, screen.width_px, kBandRows));
  image->shading = apps::demo_shading(image->scene.palette());
  if (image->band.empty() || set_camera(image->scene.camera(), screen.width_px, screen.height_px,
                                        image->scene.tree().level(), &image->camera) != Status::kOk) {
    return 1;
  }
  uint32_t crc = 0;
  uint32_t instructions = 0;
  for (int32_t y = 0; y < screen.height_px; y += kBandRows) {
    const Band band{image->band, screen.format, 0, y, kBandRows};
    const uint32_t start = port::instructions();
    if (draw(*image, band) != Status::kOk) {
      return 1;
    }
    instructions += port::instructions() - start;
    port::flush(band);
    crc = crc32(band.pixels, crc);
  }
  apps::put("instructions ", instructions, " crc ", apps::Hex{crc}, "\n");
  return 0;
}

}  // namespace
}  // namespace thimble

int thimble_application();

int thimble_application() {
  return thimble::draw_frame();
}
