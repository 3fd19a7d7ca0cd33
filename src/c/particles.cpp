#include "thimble/plane/particles.h"

#include "kinds.h"

namespace thimble::c_face {
namespace {

static_assert(kMaxBalls <= INT32_MAX && static_cast<uint32_t>(THIMBLE_NO_PARTICLE) == kNoBall);

ParticleConfig config_of(const thimble_particle_config_t& from) {
  ParticleConfig config;
  config.width = from.width;
  config.height = from.height;
  config.capacity = from.capacity;
  config.least_diameter = from.least_diameter;
  config.most_diameter = from.most_diameter;
  config.restitution_q16 = from.restitution_q16;
  config.gravity_q16 = {from.gravity_x_q16, from.gravity_y_q16};
  config.seed = from.seed;
  config.substeps_log2 = from.substeps_log2;
  config.subpixel_bits = from.subpixel_bits;
  return config;
}

// The end of `size` cells from `at` on, kept where a number can say it.
int32_t end_of(int32_t at, int32_t size) {
  return at > INT32_MAX - size ? INT32_MAX : at + size;
}

// The errors of draw_box and erase_box, and the box.
Status take_box(const ParticleWorld* world, int32_t x, int32_t y, int32_t width, int32_t height,
                CellBox* box) {
  if (world == nullptr) {
    return Status::kBadArgument;
  }
  if (width < 0 || height < 0) {
    return Status::kOutOfRange;
  }
  *box = {{x, y}, {end_of(x, width), end_of(y, height)}};
  return Status::kOk;
}

// Stores the number of a ball that was put there.
int32_t tell_id(Status status, uint32_t id, int32_t* to) {
  if (status == Status::kOk && to != nullptr) {
    *to = static_cast<int32_t>(id);
  }
  return number(status);
}

}  // namespace

extern "C" void thimble_particle_config_default(thimble_particle_config_t* config) {
  if (config == nullptr) {
    return;
  }
  const ParticleConfig from;
  config->width = from.width;
  config->height = from.height;
  config->capacity = from.capacity;
  config->least_diameter = from.least_diameter;
  config->most_diameter = from.most_diameter;
  config->restitution_q16 = from.restitution_q16;
  config->gravity_x_q16 = from.gravity_q16.x;
  config->gravity_y_q16 = from.gravity_q16.y;
  config->seed = from.seed;
  config->substeps_log2 = from.substeps_log2;
  config->subpixel_bits = from.subpixel_bits;
}

extern "C" size_t thimble_particles_bytes(const thimble_particle_config_t* config) {
  return config == nullptr ? 0 : particles_bytes(config_of(*config));
}

extern "C" int32_t thimble_particles_make(thimble_particles_t* world, const thimble_particle_config_t* config,
                                          void* bytes, size_t size_bytes) {
  Bytes memory;
  if (!stands(world) || config == nullptr || !take_bytes(bytes, size_bytes, &memory)) {
    return number(Status::kBadArgument);
  }
  ParticleWorld made;
  return hold(ParticleWorld::make(config_of(*config), memory, &made), made, world);
}

extern "C" int32_t thimble_particles_add(thimble_particles_t* world, int32_t x_q16, int32_t y_q16,
                                         int32_t vx_q16, int32_t vy_q16, int32_t diameter, int32_t* id) {
  ParticleWorld* const balls = held<ParticleWorld>(world);
  if (balls == nullptr) {
    return number(Status::kBadArgument);
  }
  uint32_t added = kNoBall;
  const Status status = balls->spawn(x_q16, y_q16, vx_q16, vy_q16, diameter, &added);
  return tell_id(status, added, id);
}

extern "C" int32_t thimble_particles_add_random(thimble_particles_t* world, int32_t max_speed_q16,
                                                int32_t* id) {
  ParticleWorld* const balls = held<ParticleWorld>(world);
  if (balls == nullptr) {
    return number(Status::kBadArgument);
  }
  uint32_t added = kNoBall;
  const Status status = balls->spawn_random(max_speed_q16, &added);
  return tell_id(status, added, id);
}

extern "C" int32_t thimble_particles_remove(thimble_particles_t* world, int32_t id) {
  ParticleWorld* const balls = held<ParticleWorld>(world);
  return number(balls == nullptr ? Status::kBadArgument : balls->remove(static_cast<uint32_t>(id)));
}

extern "C" int32_t thimble_particles_set_velocity(thimble_particles_t* world, int32_t id, int32_t vx_q16,
                                                  int32_t vy_q16) {
  ParticleWorld* const balls = held<ParticleWorld>(world);
  return number(balls == nullptr ? Status::kBadArgument
                                 : balls->set_velocity(static_cast<uint32_t>(id), vx_q16, vy_q16));
}

extern "C" int32_t thimble_particles_set_gravity(thimble_particles_t* world, int32_t x_q16, int32_t y_q16) {
  ParticleWorld* const balls = held<ParticleWorld>(world);
  return number(balls == nullptr ? Status::kBadArgument : balls->set_gravity({x_q16, y_q16}));
}

extern "C" int32_t thimble_particles_draw_box(thimble_particles_t* world, int32_t x, int32_t y, int32_t width,
                                              int32_t height) {
  ParticleWorld* const balls = held<ParticleWorld>(world);
  CellBox box;
  const Status status = take_box(balls, x, y, width, height, &box);
  if (status == Status::kOk) {
    balls->draw_box(box);
  }
  return number(status);
}

extern "C" int32_t thimble_particles_erase_box(thimble_particles_t* world, int32_t x, int32_t y,
                                               int32_t width, int32_t height) {
  ParticleWorld* const balls = held<ParticleWorld>(world);
  CellBox box;
  const Status status = take_box(balls, x, y, width, height, &box);
  if (status == Status::kOk) {
    balls->erase_box(box);
  }
  return number(status);
}

extern "C" int32_t thimble_particles_step(thimble_particles_t* world) {
  ParticleWorld* const balls = held<ParticleWorld>(world);
  if (balls == nullptr) {
    return number(Status::kBadArgument);
  }
  balls->step();
  return number(Status::kOk);
}

extern "C" int32_t thimble_particles_get_info(const thimble_particles_t* world,
                                              thimble_particles_info_t* info) {
  const ParticleWorld* const balls = held<ParticleWorld>(world);
  if (balls == nullptr || info == nullptr) {
    return number(Status::kBadArgument);
  }
  info->width = balls->field().width();
  info->height = balls->field().height();
  info->count = balls->count();
  info->asleep = balls->asleep();
  info->id_limit = balls->id_limit();
  info->steps = balls->steps();
  return number(Status::kOk);
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
