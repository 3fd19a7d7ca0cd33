#include "viewer/picking.h"

#include <array>
#include <cstdio>

#include "thimble/trace/ray.h"

namespace thimble::tools::viewer {
namespace {

const char* kind_name(SurfaceKind kind) {
  constexpr std::array kNames{"", " metal", " glass", " that glows",
                              " cloud"};  // in the order of `SurfaceKind`
  return kNames[static_cast<std::size_t>(kind)];
}

const char* face_name(const Face& face) {
  constexpr std::array kNegative{"left face (-x)", "front face (-y)", "bottom face (-z)"};
  constexpr std::array kPositive{"right face (+x)", "back face (+y)", "top face (+z)"};
  return (face.negative ? kNegative : kPositive)[static_cast<std::size_t>(face.axis)];
}

}  // namespace

std::optional<Picked> pick(const OpenScene& scene, const Camera& camera, std::int32_t x_px,
                           std::int32_t y_px) {
  if (x_px < 0 || y_px < 0 || x_px >= camera.width_px() || y_px >= camera.height_px()) {
    return std::nullopt;
  }
  const Ray ray = camera.ray(x_px, y_px);
  Picked picked;
  if (closest_hit(scene.tree(), ray, &picked.hit) != Status::kOk || picked.hit.kind != HitKind::kHit) {
    return std::nullopt;
  }
  const double t = static_cast<double>(picked.hit.t_numerator) / picked.hit.t_denominator;
  for (int axis = 0; axis < 3; ++axis) {
    picked.point[static_cast<std::size_t>(axis)] =
        static_cast<double>(ray.origin[axis].raw) / Q8::kOne + t * ray.direction[axis];
  }
  return picked;
}

std::string picked_text(const OpenScene& scene, const Camera& camera, const Picked& picked, std::int32_t x_px,
                        std::int32_t y_px) {
  const Hit& hit = picked.hit;
  std::string text = "voxel " + std::to_string(hit.voxel.x) + "," + std::to_string(hit.voxel.y) + "," +
                     std::to_string(hit.voxel.z);
  text += hit.axis < 0 ? ": the eye is in it"
                       : std::string(": its ") + face_name(face_of(hit, camera.ray(x_px, y_px).direction));
  const Material& material = scene.source->palette()[hit.material];
  std::array<char, 16> color{};
  std::snprintf(color.data(), color.size(), "#%02x%02x%02x", material.color.r, material.color.g,
                material.color.b);
  return text + ", material " + std::to_string(hit.material) + ", " + color.data() + kind_name(material.kind);
}

}  // namespace thimble::tools::viewer
