// Embree 3: packets of 4 x 4 rays over unit boxes, which are geometry of our own with a test for 16 rays.
#include "benchmarks/peers/peer.h"

#ifdef THIMBLE_HAVE_EMBREE
#include <embree3/rtcore.h>

#include <stdexcept>
#endif

namespace thimble::benchmarks {
#ifdef THIMBLE_HAVE_EMBREE
namespace {

void bounds_of(const RTCBoundsFunctionArguments* given) {
  const auto& voxels = *static_cast<const std::vector<Voxel>*>(given->geometryUserPtr);
  const Voxel voxel = voxels[given->primID];
  RTCBounds& box = *given->bounds_o;
  // A little more than the box: rays in its faces are lost otherwise. The test below decides.
  constexpr float kMore = 1.0F / 512;
  box.lower_x = static_cast<float>(voxel.x) - kMore;
  box.lower_y = static_cast<float>(voxel.y) - kMore;
  box.lower_z = static_cast<float>(voxel.z) - kMore;
  box.upper_x = static_cast<float>(voxel.x) + 1 + kMore;
  box.upper_y = static_cast<float>(voxel.y) + 1 + kMore;
  box.upper_z = static_cast<float>(voxel.z) + 1 + kMore;
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
  const auto& voxels = *static_cast<const std::vector<Voxel>*>(given->geometryUserPtr);
  const Voxel voxel = voxels[given->primID];
  const float low[3] = {static_cast<float>(voxel.x), static_cast<float>(voxel.y),
                        static_cast<float>(voxel.z)};
  meet_box(given->valid, reinterpret_cast<RTCRayHit16*>(given->rayhit), low, given->primID, given->geomID);
}

void meet_any(const RTCOccludedFunctionNArguments* given) {
  const auto& voxels = *static_cast<const std::vector<Voxel>*>(given->geometryUserPtr);
  const Voxel voxel = voxels[given->primID];
  const float low[3] = {static_cast<float>(voxel.x), static_cast<float>(voxel.y),
                        static_cast<float>(voxel.z)};
  // Rays come without hits here: the loop gets some of its own.
  RTCRayHit16 rays;
  rays.ray = *reinterpret_cast<RTCRay16*>(given->ray);
  std::fill(std::begin(rays.hit.primID), std::end(rays.hit.primID), RTC_INVALID_GEOMETRY_ID);
  meet_box(given->valid, &rays, low, given->primID, given->geomID);
  auto* const ray = reinterpret_cast<RTCRay16*>(given->ray);
  for (int i = 0; i < 16; ++i) {
    ray->tfar[i] = rays.hit.primID[i] != RTC_INVALID_GEOMETRY_ID ? -std::numeric_limits<float>::infinity()
                                                                 : ray->tfar[i];
  }
}

class Embree : public Peer {
 public:
  explicit Embree(const std::vector<Voxel>& voxels) : Embree("Embree", &voxels) {
    RTCGeometry boxes = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(boxes, static_cast<unsigned>(voxels.size()));
    rtcSetGeometryUserData(boxes, const_cast<std::vector<Voxel>*>(voxels_));
    rtcSetGeometryBoundsFunction(boxes, bounds_of, nullptr);
    rtcSetGeometryIntersectFunction(boxes, meet);
    rtcSetGeometryOccludedFunction(boxes, meet_any);
    build(boxes);
  }
  explicit Embree(const std::vector<float>& corners) : Embree("Embree, triangles", nullptr) {
    RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* const places = static_cast<float*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, corners.size() / 3));
    std::copy(corners.begin(), corners.end(), places);
    auto* const numbers = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, corners.size() / 9));
    for (unsigned i = 0; i < corners.size() / 3; ++i) {
      numbers[i] = i;
    }
    build(mesh);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  std::string name() const override { return name_; }
  std::size_t bytes() const override {
    return static_cast<std::size_t>(bytes_) + (voxels_ == nullptr ? 0 : voxels_->size() * sizeof(Voxel));
  }

  void draw(const View& view, std::uint8_t* gray, Voxel* voxels) override {
    alignas(64) int valid[16];
    alignas(64) RTCRayHit16 rays;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (std::int32_t y = 0; y < view.height_px; y += 4) {
      for (std::int32_t x = 0; x < view.width_px; x += 4) {
        for (int i = 0; i < 16; ++i) {
          set(ray_of(view, x + i % 4, y + i / 4), i, &rays.ray);
          valid[i] = x + i % 4 < view.width_px && y + i / 4 < view.height_px ? -1 : 0;
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
            voxels[pixel] = met ? (*voxels_)[rays.hit.primID[i]] : kNoVoxel;
          }
        }
      }
    }
  }

  bool trace(const std::vector<FloatRay>& rays, bool any, float* t) override {
    alignas(64) int valid[16];
    alignas(64) RTCRayHit16 packet;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (std::size_t first = 0; first < rays.size(); first += 16) {
      const std::size_t count = std::min<std::size_t>(16, rays.size() - first);
      for (std::size_t i = 0; i < 16; ++i) {
        const int lane = static_cast<int>(i);
        set(rays[first + std::min(i, count - 1)], lane, &packet.ray);
        valid[i] = i < count ? -1 : 0;
        packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      }
      if (any) {
        rtcOccluded16(valid, scene_, &context, &packet.ray);
      } else {
        rtcIntersect16(valid, scene_, &context, &packet);
      }
      for (std::size_t i = 0; i < count; ++i) {
        // What is occluded has its end at minus infinity.
        t[first + i] = any && packet.ray.tfar[i] < 0 ? 0 : packet.ray.tfar[i];
      }
    }
    return true;
  }

 private:
  Embree(const char* name, const std::vector<Voxel>* voxels)
      : name_(name), voxels_(voxels), device_(rtcNewDevice("threads=1")) {
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
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  }

  void build(RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }

  static void set(const FloatRay& ray, int i, RTCRay16* rays) {
    rays->org_x[i] = ray.origin[0];
    rays->org_y[i] = ray.origin[1];
    rays->org_z[i] = ray.origin[2];
    rays->dir_x[i] = ray.direction[0];
    rays->dir_y[i] = ray.direction[1];
    rays->dir_z[i] = ray.direction[2];
    rays->tnear[i] = 0;
    rays->tfar[i] = std::numeric_limits<float>::infinity();
    rays->mask[i] = UINT32_MAX;
    rays->flags[i] = 0;
    rays->time[i] = 0;
  }

  const char* name_;
  const std::vector<Voxel>* voxels_;
  RTCDevice device_;
  RTCScene scene_ = nullptr;
  std::int64_t bytes_ = 0;
};

}  // namespace

std::unique_ptr<Peer> make_embree(const std::vector<Voxel>& voxels) {
  return std::make_unique<Embree>(voxels);
}
std::unique_ptr<Peer> make_embree_triangles(const std::vector<float>& corners) {
  return std::make_unique<Embree>(corners);
}
#else
std::unique_ptr<Peer> make_embree_triangles(const std::vector<float>&) {
  return nullptr;
}
std::unique_ptr<Peer> make_embree(const std::vector<Voxel>&) {
  return nullptr;
}
#endif

}  // namespace thimble::benchmarks
