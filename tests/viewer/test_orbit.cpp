// The viewer's camera: turning, moving, and staying where rays may start.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "viewer/camera_state.h"

namespace {

using thimble::tools::cross;
using thimble::tools::dot;
using thimble::tools::minus;
using thimble::tools::Real3;
using thimble::tools::viewer::Orbit;

constexpr double kRight = 1.57079632679489661923;

void check_near(const Real3& a, const Real3& b, double error = 0.01) {
  CAPTURE(a[0]);
  CAPTURE(a[1]);
  CAPTURE(a[2]);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(std::abs(a[i] - b[i]) < error);
  }
}

}  // namespace

TEST_CASE("orbit: made from eye and target -> gives them back; turned by right angles -> the other sides") {
  Orbit orbit({10, -20, 10}, {10, 10, 10}, {0, 0, 1}, 64);
  check_near(orbit.eye(), {10, -20, 10});
  check_near(orbit.target(), {10, 10, 10});
  check_near(orbit.right(), {1, 0, 0});
  orbit.turn(kRight, 0);  // looks along +x: the eye is on the left
  check_near(orbit.eye(), {-20, 10, 10});
  orbit.turn(kRight, 0);
  check_near(orbit.eye(), {10, 40, 10});
  orbit.turn(2 * kRight, -kRight);  // beyond straight down it does not go
  orbit.turn(0, -1);
  CHECK(orbit.is_vertical());
  check_near(orbit.eye(), {10, 10, 40});
  check_near(orbit.up(), {0, 1, 0});
  check_near(orbit.right(), {1, 0, 0});
}

TEST_CASE("orbit: looks at a point -> from where it stands, and turns around that from now on") {
  Orbit orbit({0, 0, 0}, {0, 30, 0}, {0, 0, 1}, 64);
  orbit.look_at({20, 20, 10});
  check_near(orbit.eye(), {0, 0, 0});
  CHECK(orbit.distance() == doctest::Approx(30));
  check_near(orbit.target(), {20, 20, 10});
  orbit.look_at(orbit.eye());  // no direction
  check_near(orbit.target(), {20, 20, 10});
}

TEST_CASE("orbit: straight down from the start -> the given up decides how the picture lies") {
  const Orbit down({5, 5, 50}, {5, 5, 0}, {1, 0, 0}, 64);
  CHECK(down.is_vertical());
  check_near(down.up(), {1, 0, 0});
  check_near(down.right(), {0, -1, 0});
  const Orbit up({5, 5, 0}, {5, 5, 50}, {0, 1, 0}, 64);
  check_near(up.up(), {0, 1, 0});
  check_near(up.right(), {-1, 0, 0});
}

TEST_CASE("orbit: whatever is done -> level, of unit axes, never where rays may not start") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  constexpr double kSide = 32;
  for (int world = 0; world < 20; ++world) {
    Orbit orbit({any(random) * 40, any(random) * 40, 20}, {any(random), 2, 3}, {0, 0, 1}, kSide);
    for (int i = 0; i < 200; ++i) {
      orbit.turn(any(random) * 3, any(random) * 3);
      orbit.move(any(random) * 50, any(random) * 50, any(random) * 50);
      orbit.approach(std::exp(3 * any(random)));
      const Real3 eye = orbit.eye();
      for (const double coordinate : eye) {
        CHECK(coordinate >= -4 * kSide);
        CHECK(coordinate <= 5 * kSide);
      }
      CHECK(orbit.right()[2] == 0);
      CHECK(dot(orbit.up(), orbit.up()) == doctest::Approx(1).epsilon(0.001));
      CHECK(std::abs(dot(orbit.up(), orbit.forward())) < 0.001);
      const Real3 way = minus(orbit.target(), eye);
      const double length = std::sqrt(dot(way, way));
      REQUIRE(length > 0.2);
      // The rounded points look where the camera does.
      CHECK(dot(way, orbit.forward()) / length > 1 - 1e-5);
    }
  }
}
