// The operations of optics.h against exact arithmetic.
#include <cstdlib>

#include "instruments/operation_sweep.h"
#include "thimble/light/host/optics.h"

namespace thimble::tools::sweep {
namespace {

Real angle_urad(const Exact3& a, const Exact3& b) {
  return 1e6L * std::atan2(length(cross(a, b)), dot(a, b));
}

// How far a direction of `change` is from the one that it was made of.
Found turned_by(Draw& draw, std::uint64_t cases, Vec3i (*change)(const Vec3i&)) {
  Found found;
  while (found.cases < cases) {
    const Vec3i direction = any_vector(draw, 20);
    found.see(angle_urad(real(direction), real(change(direction))));
  }
  return found;
}

Found shortened(Draw& draw, std::uint64_t cases) {
  return turned_by(draw, cases, [](const Vec3i& direction) { return shorten(direction); });
}

Found unit_angles(Draw& draw, std::uint64_t cases) {
  return turned_by(draw, cases, [](const Vec3i& direction) { return unit_q14(direction); });
}

Found unit_lengths(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    found.see(length(real(unit_q14(any_vector(draw, 20)))) - kUnitQ14);
  }
  return found;
}

Found reflections(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const Vec3i direction = unit_q14(any_vector(draw, 20));
    const Vec3i normal = unit_q14(any_vector(draw, 20));
    const Exact3 d = real(direction);
    const Exact3 n = real(normal);
    const Exact3 exact = along(d, n, -2 * dot(d, n) / dot(n, n));
    found.see(angle_urad(exact, real(reflect(direction, normal))));
  }
  return found;
}

Vec3i rounded(const Exact3& v) {
  return {static_cast<std::int32_t>(std::lround(v[0])), static_cast<std::int32_t>(std::lround(v[1])),
          static_cast<std::int32_t>(std::lround(v[2]))};
}

// A direction near the critical angle, if there is one, or near grazing.
Vec3i near_critical(Draw& draw, const Vec3i& normal, std::uint32_t eta) {
  const Exact3 n = unit(real(normal));
  for (;;) {
    const Exact3 other = real(any_vector(draw, 14));
    const Exact3 side = along(other, n, -dot(other, n));
    if (length(side) < 100) {
      continue;
    }
    const Real critical = std::min(Real{1}, 4096 / static_cast<Real>(eta));
    const Real sine = std::min(Real{1}, critical + static_cast<Real>(draw.from(-9, 9)) / 10000);
    const Exact3 across = unit(side);
    const Real cosine = std::sqrt(1 - sine * sine);
    return rounded(
        along(Exact3{across[0] * sine * kUnitQ14, across[1] * sine * kUnitQ14, across[2] * sine * kUnitQ14},
              n, cosine * kUnitQ14));
  }
}

// Snell's law for the very integers given; only where light goes through.
Exact3 snell(const Vec3i& direction, const Vec3i& normal, std::uint32_t eta) {
  const Exact3 d = real(direction);
  const Exact3 n = unit(real(normal));
  const Real ratio = static_cast<Real>(eta) / 4096;
  const Real before = dot(d, n);
  const Exact3 sideways = along(d, n, -before);
  const Real square = dot(d, d) - ratio * ratio * dot(sideways, sideways);
  const Real after = std::sqrt(std::max(square, Real{0}));
  return along({sideways[0] * ratio, sideways[1] * ratio, sideways[2] * ratio}, n,
               before < 0 ? -after : after);
}

Found refractions(Draw& draw, std::uint64_t cases, bool bent) {
  Found found;
  while (found.cases < cases) {
    const int axis = draw.from32(0, 2);
    Vec3i normal;
    normal[axis] = kUnitQ14;
    if (bent) {
      normal = unit_q14(any_vector(draw, 20));
    }
    const auto eta = static_cast<std::uint32_t>(draw.from(kMinEtaQ12, kMaxEtaQ12));
    const Vec3i direction =
        draw.from(0, 3) == 0 ? near_critical(draw, normal, eta) : unit_q14(any_vector(draw, 20));
    Vec3i out;
    const bool through = bent ? refract(direction, normal, eta, &out) : refract(direction, axis, eta, &out);
    // What lies so near the critical angle that the two disagree is for the tests of the inequality.
    if (through && eta != kOneQ12) {
      found.see(angle_urad(snell(direction, normal, eta), real(out)));
    }
  }
  return found;
}
Found refractions_at_faces(Draw& draw, std::uint64_t cases) {
  return refractions(draw, cases, false);
}
Found refractions_bent(Draw& draw, std::uint64_t cases) {
  return refractions(draw, cases, true);
}

Found normal_shares(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const auto a = static_cast<std::uint32_t>(draw.from(1, 65535));
    const auto b = static_cast<std::uint32_t>(draw.from(1, 65535));
    const Real ratio = (static_cast<Real>(a) - static_cast<Real>(b)) / static_cast<Real>(a + b);
    found.see(static_cast<Real>(r0_q16(a, b)) - 65536 * ratio * ratio);
  }
  return found;
}

Found fresnel_shares(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const std::int32_t cosine = draw.from32(0, kUnitQ14);
    const auto normal = static_cast<std::uint32_t>(draw.from(1, 65536));
    const Real share = static_cast<Real>(normal) / 65536;
    const Real exact = share + (1 - share) * std::pow(1 - static_cast<Real>(cosine) / kUnitQ14, Real{5});
    found.see(static_cast<Real>(fresnel_q16(cosine, normal)) - 65536 * exact);
  }
  return found;
}

Found transmittances(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const auto halvings = static_cast<std::uint32_t>(draw.from(0, 18 << 16));
    found.see(static_cast<Real>(transmittance_q16(halvings)) -
              65536 * std::exp2(-static_cast<Real>(halvings) / 65536));
  }
  return found;
}

Found distances(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const Vec3i direction = any_vector(draw, 20);
    const int axis = draw.from32(0, 2);
    const std::int32_t numerator = draw.from32(0, std::int64_t{1} << draw.from(0, 24));
    if (direction[axis] == 0) {
      continue;
    }
    const std::int32_t denominator = 256 * std::abs(direction[axis]);
    const Real exact = length(real(direction)) * numerator * 256 / denominator;
    // Beyond what an answer can say it is clamped; the half unit of rounding is allowed besides.
    if (exact < INT32_MAX) {
      const Real off = std::abs(static_cast<Real>(distance_q8(direction, numerator, denominator)) - exact);
      found.see(std::max(Real{0}, off - 0.501L) / std::max(exact, Real{1}) * 1e6L);
    }
  }
  return found;
}

}  // namespace

std::vector<Operation> optics_operations() {
  return {
      {"shorten", "kShortenErrorUrad", "10^-6 rad", kShortenErrorUrad, shortened},
      {"unit_q14: direction", "kUnitErrorUrad", "10^-6 rad", kUnitErrorUrad, unit_angles},
      {"unit_q14: length", "kUnitLengthError", "1/16384", kUnitLengthError, unit_lengths},
      {"reflect: bent normal", "kReflectErrorUrad", "10^-6 rad", kReflectErrorUrad, reflections},
      {"refract: at a face", "kRefractErrorUrad", "10^-6 rad", kRefractErrorUrad, refractions_at_faces},
      {"refract: bent normal", "kRefractErrorUrad", "10^-6 rad", kRefractErrorUrad, refractions_bent},
      {"r0_q16", "kNormalErrorQ16", "1/65536", kNormalErrorQ16, normal_shares},
      {"fresnel_q16", "kSchlickErrorQ16", "1/65536", kSchlickErrorQ16, fresnel_shares},
      {"transmittance_q16", "kTransmittanceErrorQ16", "1/65536", kTransmittanceErrorQ16, transmittances},
      {"distance_q8", "kDistanceErrorPpm", "1/1000000", kDistanceErrorPpm, distances},
  };
}

}  // namespace thimble::tools::sweep
