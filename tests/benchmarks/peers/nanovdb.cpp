// NanoVDB: its hierarchical DDA over which voxels are active. The library's own first-hit call steps on
// by 1.0001 voxel and so loses up to four hits of ten; here the DDA is begun anew at a millionth of a voxel
// beyond where nodes of another size begin, in double precision.
#include "benchmarks/peers/peer.h"

#ifdef THIMBLE_HAVE_NANOVDB
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/HDDA.h>
#include <nanovdb/util/Ray.h>
#endif

namespace thimble::benchmarks {
#ifdef THIMBLE_HAVE_NANOVDB
namespace {

// Its builder makes no grids of bits alone; values of 4 bits are the least, and only the bits are looked at.
using Build = nanovdb::Fp4;
using Grid = nanovdb::NanoGrid<Build>;
// Its rays find their points in floats, whatever their type; these do not.
struct RealRay : nanovdb::Ray<double> {
  using nanovdb::Ray<double>::Ray;
  nanovdb::Vec3d operator()(double t) const { return eye() + dir() * t; }
};

template <class Accessor>
bool first_voxel(RealRay ray, const nanovdb::CoordBBox& box, Accessor& accessor, nanovdb::Coord* voxel,
                 double* t) {
  constexpr double kBeyond = 1e-6;  // in voxels: directions have length 1
  if (!ray.clip(box)) {
    return false;
  }
  double begin = ray.t0();
  while (begin + kBeyond < ray.t1()) {
    *voxel = nanovdb::RoundDown<nanovdb::Coord>(ray(begin + kBeyond));
    const int size = static_cast<int>(accessor.getDim(*voxel, ray));
    nanovdb::HDDA<RealRay> walk;
    walk.init(ray, begin + kBeyond, ray.t1(), size);
    do {
      *voxel = walk.voxel();
      begin = walk.time();
      if (static_cast<int>(accessor.getDim(*voxel, ray)) != size) {
        break;
      }
      if (size == 1 && accessor.isActive(*voxel)) {
        *t = begin;
        return true;
      }
      begin = ray.t1();
    } while (walk.step());
  }
  return false;
}

class Nano : public Peer {
 public:
  explicit Nano(const std::vector<Voxel>& voxels) {
    nanovdb::GridBuilder<float, Build> builder(0);
    builder.setStats(nanovdb::StatsMode::BBox);
    builder.setChecksum(nanovdb::ChecksumMode::Disable);
    {
      auto accessor = builder.getAccessor();
      for (const Voxel voxel : voxels) {
        accessor.setValue(nanovdb::Coord(voxel.x, voxel.y, voxel.z), 1);
      }
    }
    handle_ = builder.getHandle<>();
  }
  std::string name() const override { return "NanoVDB"; }
  std::size_t bytes() const override { return handle_.size(); }

  void draw(const View& view, std::uint8_t* gray, Voxel* voxels) override {
    const Grid* const grid = handle_.grid<Build>();
    auto accessor = grid->getAccessor();
    const nanovdb::CoordBBox box = grid->tree().bbox();
    std::size_t pixel = 0;
    for (std::int32_t y = 0; y < view.height_px; ++y) {
      for (std::int32_t x = 0; x < view.width_px; ++x, ++pixel) {
        nanovdb::Coord voxel;
        float t = 0;
        const bool met = meet(ray_of(view, x, y), box, accessor, &voxel, &t);
        gray[pixel] = met ? view.gray(t) : 0;
        if (voxels != nullptr) {
          voxels[pixel] =
              met ? Voxel{static_cast<std::uint16_t>(voxel[0]), static_cast<std::uint16_t>(voxel[1]),
                          static_cast<std::uint16_t>(voxel[2])}
                  : kNoVoxel;
        }
      }
    }
  }

  bool trace(const std::vector<FloatRay>& rays, bool, float* t) override {
    const Grid* const grid = handle_.grid<Build>();
    auto accessor = grid->getAccessor();
    const nanovdb::CoordBBox box = grid->tree().bbox();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      nanovdb::Coord voxel;
      if (!meet(rays[i], box, accessor, &voxel, t + i)) {
        t[i] = std::numeric_limits<float>::infinity();
      }
    }
    return true;
  }

 private:
  template <class Accessor>
  static bool meet(const FloatRay& ray, const nanovdb::CoordBBox& box, Accessor& accessor,
                   nanovdb::Coord* voxel, float* t) {
    const nanovdb::Vec3d origin(ray.origin[0], ray.origin[1], ray.origin[2]);
    nanovdb::Vec3d direction(ray.direction[0], ray.direction[1], ray.direction[2]);
    const double per_length = 1 / direction.length();
    direction *= per_length;
    double way = 0;
    const bool met = first_voxel(RealRay(origin, direction), box, accessor, voxel, &way);
    *t = static_cast<float>(way * per_length);
    return met;
  }

  nanovdb::GridHandle<> handle_;
};

}  // namespace

std::unique_ptr<Peer> make_nanovdb(const std::vector<Voxel>& voxels) {
  return std::make_unique<Nano>(voxels);
}
#else
std::unique_ptr<Peer> make_nanovdb(const std::vector<Voxel>&) {
  return nullptr;
}
#endif

}  // namespace thimble::benchmarks
