// Embree 3: packets of 4 x 4 rays over unit boxes, which are geometry of our own with a test for 16 rays.
#include "benchmarks/peers/peer.h"

#if THIMBLE_HAVE_EMBREE
#include <embree3/rtcore.h>

#include <stdexcept>
#endif

namespace thimble::benchmarks {
#if THIMBLE_HAVE_EMBREE
namespace {

void bounds_of(const RTCBoundsFunctionArguments* given) {
  const auto& voxels = *static_cast<const std::vector<std::uint32_t>*>(given->geometryUserPtr);
  const std::uint32_t voxel = voxels[given->primID];
  RTCBounds& box = *given->bounds_o;
  box.lower_x = static_cast<float>(voxel & 1023U);
  box.lower_y = static_cast<float>(voxel >> 10 & 1023U);
  box.lower_z = static_cast<float>(voxel >> 20);
  box.upper_x = box.lower_x + 1;
  box.upper_y = box.lower_y + 1;
  box.upper_z = box.lower_z + 1;
}

// The loop below for the machine at hand; without branches, so that it becomes vectors.
__attribute__((target_clones("avx512f", "avx2,fma", "default"),
               optimize("O3", "fast-math", "no-finite-math-only"))) void
meet_box(const int* valid, RTCRayHit16* rays, const float* low, unsigned primitive, unsigned geometry) {
  RTCRay16& ray = rays->ray;
  RTCHit16& hit = rays->hit;
  for (int i = 0; i < 16; ++i) {
    const float origin[3] = {ray.org_x[i], ray.org_y[i], ray.org_z[i]};
    const float direction[3] = {ray.dir_x[i], ray.dir_y[i], ray.dir_z[i]};
    float enter = ray.tnear[i];
    float leave = ray.tfar[i];
    for (int axis = 0; axis < 3; ++axis) {
      const float to_low = low[axis] - origin[axis];
      const bool still = direction[axis] == 0;
      const bool within = (to_low <= 0) & (to_low > -1);
      const float inverse = 1 / (still ? 1.0F : direction[axis]);
      const float first = to_low * inverse;
      const float second = (to_low + 1) * inverse;
      const float from = first < second ? first : second;
      const float to = first < second ? second : first;
      const float met_from = still ? 0.0F : from;
      const float met_to = still ? (within ? leave : -1.0F) : to;
      enter = enter > met_from ? enter : met_from;
      leave = leave < met_to ? leave : met_to;
    }
    const bool met = (valid[i] != 0) & (enter < leave);
    ray.tfar[i] = met ? enter : ray.tfar[i];
    hit.primID[i] = met ? primitive : hit.primID[i];
    hit.geomID[i] = met ? geometry : hit.geomID[i];
  }
}

void meet(const RTCIntersectFunctionNArguments* given) {
  const auto& voxels = *static_cast<const std::vector<std::uint32_t>*>(given->geometryUserPtr);
  const std::uint32_t voxel = voxels[given->primID];
  const float low[3] = {static_cast<float>(voxel & 1023U), static_cast<float>(voxel >> 10 & 1023U),
                        static_cast<float>(voxel >> 20)};
  meet_box(given->valid, reinterpret_cast<RTCRayHit16*>(given->rayhit), low, given->primID, given->geomID);
}

class Embree : public Peer {
 public:
  explicit Embree(const std::vector<std::uint32_t>& voxels)
      : voxels_(voxels), device_(rtcNewDevice("threads=1")) {
    if (device_ == nullptr) {
      throw std::runtime_error("Embree gives no device");
    }
    rtcSetDeviceMemoryMonitorFunction(
        device_,
        [](void* self, ssize_t more, bool) {
          static_cast<Embree*>(self)->bytes_ += more;
          return true;
        },
        this);
    scene_ = rtcNewScene(device_);
    // Without it, rays along an axis lose too many pixels to count.
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry boxes = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(boxes, static_cast<unsigned>(voxels.size()));
    rtcSetGeometryUserData(boxes, const_cast<std::vector<std::uint32_t>*>(&voxels_));
    rtcSetGeometryBoundsFunction(boxes, bounds_of, nullptr);
    rtcSetGeometryIntersectFunction(boxes, meet);
    rtcCommitGeometry(boxes);
    rtcAttachGeometry(scene_, boxes);
    rtcReleaseGeometry(boxes);
    rtcCommitScene(scene_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  std::string name() const override { return "Embree"; }
  std::size_t bytes() const override {
    return static_cast<std::size_t>(bytes_) + voxels_.size() * sizeof(std::uint32_t);
  }

  void draw(const View& view, std::uint8_t* gray, std::uint32_t* voxels) override {
    alignas(64) int valid[16];
    alignas(64) RTCRayHit16 rays;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (std::int32_t y = 0; y < view.height_px; y += 4) {
      for (std::int32_t x = 0; x < view.width_px; x += 4) {
        for (int i = 0; i < 16; ++i) {
          const FloatRay ray = ray_of(view, x + i % 4, y + i / 4);
          valid[i] = x + i % 4 < view.width_px && y + i / 4 < view.height_px ? -1 : 0;
          rays.ray.org_x[i] = ray.origin[0];
          rays.ray.org_y[i] = ray.origin[1];
          rays.ray.org_z[i] = ray.origin[2];
          rays.ray.dir_x[i] = ray.direction[0];
          rays.ray.dir_y[i] = ray.direction[1];
          rays.ray.dir_z[i] = ray.direction[2];
          rays.ray.tnear[i] = 0;
          rays.ray.tfar[i] = std::numeric_limits<float>::infinity();
          rays.ray.mask[i] = UINT32_MAX;
          rays.ray.flags[i] = 0;
          rays.ray.time[i] = 0;
          rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
          rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, scene_, &context, &rays);
        for (int i = 0; i < 16; ++i) {
          if (valid[i] == 0) {
            continue;
          }
          const std::size_t pixel =
              static_cast<std::size_t>(y + i / 4) * static_cast<std::size_t>(view.width_px) +
              static_cast<std::size_t>(x + i % 4);
          const bool met = rays.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
          gray[pixel] = met ? view.gray(rays.ray.tfar[i]) : 0;
          if (voxels != nullptr) {
            voxels[pixel] = met ? voxels_[rays.hit.primID[i]] : kNoVoxel;
          }
        }
      }
    }
  }

 private:
  const std::vector<std::uint32_t>& voxels_;
  RTCDevice device_;
  RTCScene scene_ = nullptr;
  std::int64_t bytes_ = 0;
};

}  // namespace

std::unique_ptr<Peer> make_embree(const std::vector<std::uint32_t>& voxels) {
  return std::make_unique<Embree>(voxels);
}
#else
std::unique_ptr<Peer> make_embree(const std::vector<std::uint32_t>&) {
  return nullptr;
}
#endif

}  // namespace thimble::benchmarks
