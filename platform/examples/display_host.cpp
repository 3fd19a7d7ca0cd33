// The examples' display on a desktop: checks what is sent to it, and prints the last frame as a PGM picture.
// The first argument is the number of frames (default: 1).
#include "display.h"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

constexpr std::size_t kRowBytes = kDisplayWidth / 2;
std::vector<std::uint8_t> picture;
std::uint32_t frames = 1;

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "display: %s\n", what);
  std::exit(1);
}

void print() {
  std::printf("P5\n%d %d\n255\n", kDisplayWidth, kDisplayHeight);
  for (const std::uint8_t pair : picture) {
    std::putchar((pair >> 4) * 17);
    std::putchar((pair & 15) * 17);
  }
}

}  // namespace

void display_send(std::int32_t first_row, std::int32_t rows, const std::uint8_t* bytes, std::size_t size) {
  if (picture.size() != static_cast<std::size_t>(first_row) * kRowBytes ||
      size != static_cast<std::size_t>(rows) * kRowBytes) {
    fail("the rows are not the next ones");
  }
  picture.insert(picture.end(), bytes, bytes + size);
}

bool display_wait(std::uint32_t number) {
  if (number > 0 && picture.size() != kDisplayHeight * kRowBytes) {
    fail("the frame before is not whole");
  }
  if (number == frames) {
    print();
    return false;
  }
  picture.clear();
  return true;
}

/// Reads the number of frames before `main`, which belongs to the example.
[[gnu::constructor]] static void read_arguments(int count, char** arguments) {
  if (count > 1) {
    frames = static_cast<std::uint32_t>(std::strtoul(arguments[1], nullptr, 10));
  }
}
