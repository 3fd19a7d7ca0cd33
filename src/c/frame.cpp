#include "picture.h"
#include "thimble/picture/anytime.h"

namespace thimble::c_face {

extern "C" size_t thimble_frame_bytes(int32_t format, int32_t width_px, int32_t height_px) {
  return !is_format(format) || width_px < 1 || width_px > kMaxPicturePx || height_px < 1 ||
                 height_px > kMaxPicturePx
             ? 0
             : anytime_bytes(width_px, height_px, static_cast<PixelFormat>(format));
}

extern "C" int32_t thimble_frame_make(thimble_frame_t* frame, const thimble_tree_t* tree,
                                      const thimble_camera_t* camera, const thimble_shading_t* shading,
                                      int32_t format, void* bytes, size_t size_bytes) {
  const CompactTree* const from = held<CompactTree>(tree);
  const Camera* const view = held<Camera>(camera);
  Shading look;
  if (from == nullptr || view == nullptr || !take_shading(shading, &look) || !is_format(format)) {
    return number(Status::kBadArgument);
  }
  return make_held<AnytimeFrame>(frame, bytes, size_bytes, [&](Bytes memory, AnytimeFrame* begun) {
    return AnytimeFrame::make(*from, *view, look, static_cast<PixelFormat>(format), memory, begun);
  });
}

extern "C" int32_t thimble_frame_refine(thimble_frame_t* frame, const thimble_tree_t* tree,
                                        uint32_t max_visits) {
  AnytimeFrame* const begun = held<AnytimeFrame>(frame);
  const CompactTree* const from = held<CompactTree>(tree);
  return number(begun == nullptr || from == nullptr ? Status::kBadArgument
                                                    : begun->refine(*from, max_visits));
}

extern "C" uint32_t thimble_frame_inexact(const thimble_frame_t* frame) {
  const AnytimeFrame* const begun = held<AnytimeFrame>(frame);
  return begun == nullptr ? 0 : begun->inexact();
}

}  // namespace thimble::c_face
