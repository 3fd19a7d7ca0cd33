// Box2D 2.4 as an engine of the comparison, as its manual tells one to use it: metres and seconds, circles of
// 0.2 to 1.2 m, 8 velocity and 3 position iterations, sleeping allowed, no friction, no rotation to speak of.
#ifdef THIMBLE_HAVE_BOX2D

#include <box2d/box2d.h>
#include <malloc.h>

#include "engine.h"

namespace thimble::benchmarks {
namespace {

constexpr float kPixelsAMetre = 10;
constexpr float kStepsASecond = 60;
constexpr float kSpeed = kStepsASecond / kPixelsAMetre;  // of pixels a step in metres a second

std::size_t heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

class Box2dEngine : public Engine, private b2ContactListener {
 public:
  Box2dEngine(const Scene& scene, bool bullets) {
    const std::size_t before = heap_bytes();
    const float gravity = static_cast<float>(scene.gravity) * kSpeed * kStepsASecond;
    world_ = std::make_unique<b2World>(b2Vec2(0, gravity));
    world_->SetContactListener(this);
    b2BodyDef ground_definition;
    b2Body* ground = world_->CreateBody(&ground_definition);
    const float w = static_cast<float>(scene.width) / kPixelsAMetre;
    const float h = static_cast<float>(scene.height) / kPixelsAMetre;
    const b2Vec2 corners[5] = {{0, 0}, {w, 0}, {w, h}, {0, h}, {0, 0}};
    b2FixtureDef fixture;
    fixture.restitution = static_cast<float>(scene.restitution);
    fixture.friction = 0;
    fixture.density = 1;
    for (int side = 0; side < 4; ++side) {
      b2EdgeShape edge;
      edge.SetTwoSided(corners[side], corners[side + 1]);
      fixture.shape = &edge;
      ground->CreateFixture(&fixture);
    }
    for (const int x : scene.wall_columns) {
      b2PolygonShape box;
      box.SetAsBox(0.5F / kPixelsAMetre, h / 2, b2Vec2((static_cast<float>(x) + 0.5F) / kPixelsAMetre, h / 2),
                   0);
      fixture.shape = &box;
      ground->CreateFixture(&fixture);
    }
    for (const BallState& ball : scene.balls) {
      b2BodyDef definition;
      definition.type = b2_dynamicBody;
      definition.bullet = bullets;
      definition.position.Set(static_cast<float>(ball.x) / kPixelsAMetre,
                              static_cast<float>(ball.y) / kPixelsAMetre);
      definition.linearVelocity.Set(static_cast<float>(ball.vx) * kSpeed,
                                    static_cast<float>(ball.vy) * kSpeed);
      b2Body* body = world_->CreateBody(&definition);
      b2CircleShape circle;
      circle.m_radius = static_cast<float>(ball.diameter) / 2 / kPixelsAMetre;
      fixture.shape = &circle;
      body->CreateFixture(&fixture);
      bodies_.push_back(body);
    }
    step_without_time();
    memory_bytes_ = heap_bytes() - before;
  }

  void step() override { world_->Step(1 / kStepsASecond, 8, 3); }
  std::uint64_t collisions() const override { return collisions_; }
  std::vector<BallState> balls() const override {
    std::vector<BallState> result;
    for (const b2Body* body : bodies_) {
      const b2Vec2 place = body->GetPosition();
      const b2Vec2 velocity = body->GetLinearVelocity();
      const float radius = body->GetFixtureList()->GetShape()->m_radius;
      result.push_back({static_cast<double>(place.x * kPixelsAMetre),
                        static_cast<double>(place.y * kPixelsAMetre),
                        static_cast<double>(velocity.x / kSpeed), static_cast<double>(velocity.y / kSpeed),
                        static_cast<double>(2 * radius * kPixelsAMetre), !body->IsAwake()});
    }
    return result;
  }
  std::size_t asleep() const override {
    std::size_t count = 0;
    for (const b2Body* body : bodies_) {
      count += body->IsAwake() ? 0U : 1U;
    }
    return count;
  }
  std::size_t memory_bytes() const override { return memory_bytes_; }

 private:
  void BeginContact(b2Contact*) override { ++collisions_; }
  // Lets the broad phase make what it needs, so that the memory counts.
  void step_without_time() { world_->Step(0, 8, 3); }

  std::unique_ptr<b2World> world_;
  std::vector<b2Body*> bodies_;
  std::uint64_t collisions_ = 0;
  std::size_t memory_bytes_ = 0;
};

}  // namespace

std::unique_ptr<Engine> make_box2d_engine(const Scene& scene, bool bullets) {
  return std::make_unique<Box2dEngine>(scene, bullets);
}

}  // namespace thimble::benchmarks

#endif
