#include "thimble/plane/particles.h"

#include "handle.h"

namespace thimble::c_face {
namespace {

static_assert(kMaxBalls <= INT32_MAX && static_cast<uint32_t>(THIMBLE_NO_PARTICLE) == kNoBall);

// All but gravity, which is a vector in the core.
template <class From, class To>
void copy_config(const From& from, To* to) {
  to->width = from.width;
  to->height = from.height;
  to->capacity = from.capacity;
  to->least_diameter = from.least_diameter;
  to->most_diameter = from.most_diameter;
  to->restitution_q16 = from.restitution_q16;
  to->seed = from.seed;
  to->substeps_log2 = from.substeps_log2;
  to->subpixel_bits = from.subpixel_bits;
}

ParticleConfig config_of(const thimble_particle_config_t& from) {
  ParticleConfig config;
  copy_config(from, &config);
  config.gravity_q16 = {from.gravity_x_q16, from.gravity_y_q16};
  return config;
}

// The end of `size` cells from `at` on, kept where a number can say it.
int32_t end_of(int32_t at, int32_t size) {
  return at > INT32_MAX - size ? INT32_MAX : at + size;
}

// Draws or erases a box, as `change(world, box)` does.
template <class Change>
int32_t change_box(thimble_particles_t* world, Vec2i from, Vec2i size, const Change& change) {
  return with<ParticleWorld>(world, [&](ParticleWorld& balls) {
    if (size.x < 0 || size.y < 0) {
      return Status::kOutOfRange;
    }
    change(balls, CellBox{from, {end_of(from.x, size.x), end_of(from.y, size.y)}});
    return Status::kOk;
  });
}

// Puts a ball somewhere, as `spawn(world, &number)` does, and stores its number.
template <class Spawn>
int32_t add(thimble_particles_t* world, int32_t* id, const Spawn& spawn) {
  return with<ParticleWorld>(world, [&](ParticleWorld& balls) {
    uint32_t added = kNoBall;
    const Status status = spawn(balls, &added);
    if (status == Status::kOk && id != nullptr) {
      *id = static_cast<int32_t>(added);
    }
    return status;
  });
}

}  // namespace

extern "C" void thimble_particle_config_default(thimble_particle_config_t* config) {
  if (config == nullptr) {
    return;
  }
  const ParticleConfig from;
  copy_config(from, config);
  config->gravity_x_q16 = from.gravity_q16.x;
  config->gravity_y_q16 = from.gravity_q16.y;
}

extern "C" size_t thimble_particles_bytes(const thimble_particle_config_t* config) {
  return config == nullptr ? 0 : particles_bytes(config_of(*config));
}

extern "C" int32_t thimble_particles_make(thimble_particles_t* world, const thimble_particle_config_t* config,
                                          void* bytes, size_t size_bytes) {
  return config == nullptr
             ? number(Status::kBadArgument)
             : make_held<ParticleWorld>(world, bytes, size_bytes, [=](Bytes memory, ParticleWorld* made) {
                 return ParticleWorld::make(config_of(*config), memory, made);
               });
}

extern "C" int32_t thimble_particles_add(thimble_particles_t* world, int32_t x_q16, int32_t y_q16,
                                         int32_t vx_q16, int32_t vy_q16, int32_t diameter, int32_t* id) {
  return add(world, id, [=](ParticleWorld& balls, uint32_t* added) {
    return balls.spawn(x_q16, y_q16, vx_q16, vy_q16, diameter, added);
  });
}

extern "C" int32_t thimble_particles_add_random(thimble_particles_t* world, int32_t max_speed_q16,
                                                int32_t* id) {
  return add(world, id,
             [=](ParticleWorld& balls, uint32_t* added) { return balls.spawn_random(max_speed_q16, added); });
}

extern "C" int32_t thimble_particles_remove(thimble_particles_t* world, int32_t id) {
  return with<ParticleWorld>(world,
                             [=](ParticleWorld& balls) { return balls.remove(static_cast<uint32_t>(id)); });
}

extern "C" int32_t thimble_particles_set_velocity(thimble_particles_t* world, int32_t id, int32_t vx_q16,
                                                  int32_t vy_q16) {
  return with<ParticleWorld>(world, [=](ParticleWorld& balls) {
    return balls.set_velocity(static_cast<uint32_t>(id), vx_q16, vy_q16);
  });
}

extern "C" int32_t thimble_particles_set_gravity(thimble_particles_t* world, int32_t x_q16, int32_t y_q16) {
  return with<ParticleWorld>(world, [=](ParticleWorld& balls) { return balls.set_gravity({x_q16, y_q16}); });
}

extern "C" int32_t thimble_particles_draw_box(thimble_particles_t* world, int32_t x, int32_t y, int32_t width,
                                              int32_t height) {
  return change_box(world, {x, y}, {width, height},
                    [](ParticleWorld& balls, const CellBox& box) { balls.draw_box(box); });
}

extern "C" int32_t thimble_particles_erase_box(thimble_particles_t* world, int32_t x, int32_t y,
                                               int32_t width, int32_t height) {
  return change_box(world, {x, y}, {width, height},
                    [](ParticleWorld& balls, const CellBox& box) { balls.erase_box(box); });
}

extern "C" int32_t thimble_particles_step(thimble_particles_t* world) {
  return with<ParticleWorld>(world, [](ParticleWorld& balls) {
    balls.step();
    return Status::kOk;
  });
}

extern "C" int32_t thimble_particles_get_info(const thimble_particles_t* world,
                                              thimble_particles_info_t* info) {
  return tell<ParticleWorld>(world, info, [=](const ParticleWorld& balls) {
    info->width = balls.field().width();
    info->height = balls.field().height();
    info->count = balls.count();
    info->asleep = balls.asleep();
    info->id_limit = balls.id_limit();
    info->steps = balls.steps();
  });
}

extern "C" int32_t thimble_particles_get(const thimble_particles_t* world, int32_t id,
                                         thimble_particle_t* particle) {
  const ParticleWorld* const balls = held<ParticleWorld>(world);
  if (balls == nullptr || particle == nullptr) {
    return number(Status::kBadArgument);
  }
  Particle one;
  if (!balls->particle(static_cast<uint32_t>(id), &one)) {
    return number(Status::kOutOfRange);
  }
  particle->id = static_cast<int32_t>(one.id);
  particle->x_q16 = one.x_q16;
  particle->y_q16 = one.y_q16;
  particle->vx_q16 = one.vx_q16;
  particle->vy_q16 = one.vy_q16;
  particle->diameter = one.diameter;
  particle->corner_x = one.corner.x;
  particle->corner_y = one.corner.y;
  particle->is_asleep = one.asleep ? 1 : 0;
  return number(Status::kOk);
}

extern "C" int32_t thimble_particles_at(const thimble_particles_t* world, int32_t x, int32_t y) {
  const ParticleWorld* const balls = held<ParticleWorld>(world);
  return static_cast<int32_t>(balls == nullptr ? kNoBall : balls->ball_at({x, y}));
}

extern "C" uint32_t thimble_particles_cells(const thimble_particles_t* world, int32_t x, int32_t y) {
  const ParticleWorld* const balls = held<ParticleWorld>(world);
  return balls == nullptr ? 0 : balls->field().window(x, y);
}

extern "C" uint32_t thimble_particles_crc32(const thimble_particles_t* world) {
  const ParticleWorld* const balls = held<ParticleWorld>(world);
  return balls == nullptr ? 0 : balls->state_crc32();
}

}  // namespace thimble::c_face
