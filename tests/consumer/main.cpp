// The smallest program that uses Thimble: all of its memory is one array, and every failure is a status.
#include <cstdint>
#include <cstdio>

#include "thimble/arena.h"
#include "thimble/ray.h"

int main() {
  static std::uint8_t memory[1024];
  thimble::Arena arena{thimble::Bytes(memory)};
  const thimble::Bytes row = arena.take(64);
  if (row.empty()) {
    std::fprintf(stderr, "consumer: the arena is too small\n");
    return 1;
  }

  thimble::Ray ray;
  ray.origin = {thimble::Q8::saturate(-3), thimble::Q8::saturate(5), thimble::Q8::saturate(5)};
  ray.direction = {1, 0, 0};
  const int level = 4;  // a world of 16 voxels a side
  const thimble::Status status = thimble::check_ray(ray, level);
  std::printf("ray: %s; %zu of %zu bytes used\n", thimble::status_text(status), arena.used_bytes(),
              arena.capacity_bytes());
  return status == thimble::Status::kOk ? 0 : 1;
}
