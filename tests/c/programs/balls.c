/* Balls that fall in a field of bits. */
#include "thimble/thimble_c.h"

int32_t program(uint8_t* bytes, size_t size, uint32_t* cells);

int32_t program(uint8_t* bytes, size_t size, uint32_t* cells) {
  thimble_particle_config_t config;
  thimble_particles_t world;
  int32_t status;
  thimble_particle_config_default(&config);
  config.width = 128;
  config.height = 64;
  config.capacity = 60;
  config.most_diameter = 8;
  status = thimble_particles_make(&world, &config, bytes, size);
  if (status == THIMBLE_OK) {
    status = thimble_particles_add(&world, 40 << 16, 9 << 16, 0, 0, 5, NULL);
  }
  if (status == THIMBLE_OK) {
    status = thimble_particles_erase_box(&world, 0, 0, 9, 9);
  }
  if (status == THIMBLE_OK) {
    status = thimble_particles_step(&world);
  }
  *cells = thimble_particles_cells(&world, 32, 9);
  return status;
}
