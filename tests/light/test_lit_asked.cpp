// Lit pictures whose rays somebody else traces: the core defers its queries. Every byte is that of the
// picture for which it traced its rays itself.
#include <doctest/doctest.h>

#include <cstdint>
#include <random>

#include "support/counts.h"
#include "support/lit_cases.h"
#include "support/lit_world.h"
#include "support/wide_cases.h"
#include "thimble/light/host/asked.h"

namespace thimble::tests {
namespace {

// A frame with room for one question of each kind, and who answers it.
struct OneAsked {
  OneAsked(const testing::LitWorld& world, EffectSet effects)
      : frame{world.tree, world.camera, world.shading, world.scene, options, effects}, asked(frame) {
    for (int i = 0; i < lit::kQuestions; ++i) {
      questions[i] = {&rays[i], &before[i], &in[i], &number[i], 0};
    }
    asked.questions = questions;
    asked.slopes = &slope;
    asked.once = &frame;
  }
  void begin(std::uint32_t known) { asked.begin(&answer, 0, known, &ray, &light); }
  // Answers as the core does; returns the query's kind.
  lit::Question trace() {
    int kind = 0;
    while (kind + 1 < lit::kQuestions && questions[kind].count == 0) {
      ++kind;
    }
    REQUIRE(questions[kind].count == 1);
    questions[kind].count = 0;
    answer = {};
    const auto question = static_cast<lit::Question>(kind);
    const Status status = question != lit::Question::kOn ? closest_hit(frame.tree, rays[kind], &answer.hit)
                          : in[kind] == lit::kInNothing
                              ? closest_hit_from(frame.tree, rays[kind], before[kind], &answer.hit)
                              : leave_medium(frame.tree, rays[kind], static_cast<std::uint8_t>(in[kind]),
                                             &answer, before[kind]);
    REQUIRE(status == Status::kOk);
    return question;
  }

  LitOptions options;
  lit::Frame frame;
  lit::AskedFrame asked;
  Ray rays[lit::kQuestions];
  RayPoint before[lit::kQuestions];
  std::uint16_t in[lit::kQuestions];
  std::uint32_t number[lit::kQuestions];
  lit::Asked questions[lit::kQuestions];
  lit::AskedSlope slope;
  lit::Answer answer;
  lit::KnownRay ray;
  lit::KnownLight light;
};

// A pane of glass over a floor, and a lamp over that, in air or in a block of glass.
struct Panes : testing::LitWorld {
  explicit Panes(bool lamp_in_glass) {
    box({0, 0, 0}, {32, 32, 2}, 1);
    box({0, 0, 6}, {32, 32, 8}, 2);
    if (lamp_in_glass) {
      box({0, 0, 12}, {32, 32, 20}, 3);
    }
    surfaces[2] = testing::surface(SurfaceKind::kGlass, {200, 100, 50});
    surfaces[3] = testing::surface(SurfaceKind::kGlass, {50, 100, 200});
    surfaces[2].density_q8 = 60;
    surfaces[3].density_q8 = 30;
    lights = {testing::lamp({16 * 256, 16 * 256, 15 * 256})};
    shading.background = {90, 90, 90};
    finish();
    look({16 * 256, 0, 30 * 256}, {16 * 256, 16 * 256, 0});
    spot.at = point({14 * 256, 15 * 256, 2 * 256});
    spot.face = {2, false};
  }

  lit::Spot spot;
};

constexpr int kShadow = static_cast<int>(LitRayKind::kShadow);

}  // namespace

TEST_CASE(
    "lit asked: light through panes, a stretch after another -> the core's brightness, one ray, one hit") {
  for (const bool lamp_in_glass : {false, true}) {
    const Panes world(lamp_in_glass);
    OneAsked one(world, Effect::kShadows | Effect::kGlass);
    lit::LightRay expected;
    REQUIRE(light_ray(world.lights[0], world.spot, &expected));
    lit::LightRay light = expected;
    lit::Frame frame = one.frame;
    REQUIRE(light_arrives_through(frame, &expected));
    one.asked.way = &one.light.way;
    int stretches = 0;
    bool arrives = false;
    for (std::uint32_t known = 0; known == 0 || one.asked.waits; known = 1) {
      one.begin(known);
      one.asked.way = &one.light.way;
      arrives = light_arrives_through(one.asked, &light);
      if (one.asked.waits) {
        const lit::Question question = one.trace();
        CHECK((question == lit::Question::kBefore) == (stretches == 0));
        ++stretches;
      }
    }
    CHECK(arrives);
    CHECK(stretches == (lamp_in_glass ? 4 : 3));
    for (int i = 0; i < 3; ++i) {
      CHECK(light.brightness[i] == expected.brightness[i]);
      CHECK(light.brightness[i] > 0);
    }
    CHECK(one.frame.counts.hits[kShadow] == frame.counts.hits[kShadow]);
    CHECK(one.frame.counts.node_visits[kShadow] == frame.counts.node_visits[kShadow]);
    // What is met at the lamp counts, what is any further not.
    const RayPoint& before = one.before[static_cast<int>(lit::Question::kBefore)];
    CHECK(before.t_denominator == light.place.t_denominator);
    CHECK(before.t_numerator == light.place.t_numerator + 1);
  }
}

TEST_CASE("lit asked: a ray through glass before its answer -> the frame is open, nothing is shown") {
  const Panes world(false);
  OneAsked one(world, Effect::kGlass);
  const lit::Steps steps = lit::steps_of(one.frame.effects);
  lit::PendingRay now;
  now.ray = world.camera.ray(24, 18);
  lit::PendingRay pending[lit::pending_rays(Effect::kGlass)];
  std::size_t count = 0;
  lit::Color sum;
  one.begin(0);
  steps.follow(one.asked, now, pending, &count, &sum);
  CHECK(one.asked.is_open);
  CHECK_FALSE(one.asked.is_answered());
  CHECK(sum.c[0] == 0);
  CHECK(one.trace() == lit::Question::kClosest);
  one.begin(1);
  steps.follow(one.asked, now, pending, &count, &sum);
  CHECK(one.asked.is_answered());
  CHECK(count == 2);
}

TEST_CASE("lit asked: a slope from outside -> its visits are those of the ray that met it") {
  const Panes world(false);
  OneAsked one(world, Effect::kSmoothNormals);
  one.begin(0);
  slope_at(one.asked, LitRayKind::kPrimary, world.spot);
  CHECK(one.asked.is_open);
  CHECK(one.slope.at == world.spot.at);
  one.answer.hit.voxel = {0, 9830, 13107};
  one.answer.hit.visits = 77;
  one.begin(1);
  CHECK(slope_at(one.asked, LitRayKind::kPrimary, world.spot).bent);
  CHECK(one.asked.counts.node_visits[static_cast<int>(LitRayKind::kPrimary)] == 77);
}

}  // namespace thimble::tests
