// The display of platform/example on a desktop: checks what is sent to it, and prints the picture as P5.
#include <cstdint>
#include <cstdio>
#include <vector>

extern "C" void display_send(int first_row, int rows, const std::uint8_t* bytes, std::size_t size);
extern "C" int voxel_view_draw(std::int32_t sideways_q8);

namespace {

constexpr int kRowBytes = 64;
constexpr int kHeight = 64;
std::vector<std::uint8_t> picture;

}  // namespace

void display_send(int first_row, int rows, const std::uint8_t* bytes, std::size_t size) {
  if (picture.size() != static_cast<std::size_t>(first_row) * kRowBytes ||
      size != static_cast<std::size_t>(rows) * kRowBytes) {
    std::fprintf(stderr, "example: rows %d..%d in %zu bytes are not the next ones\n", first_row,
                 first_row + rows - 1, size);
    picture.clear();
    return;
  }
  picture.insert(picture.end(), bytes, bytes + size);
}

int main() {
  const int status = voxel_view_draw(0);
  if (status != 0 || picture.size() != std::size_t{kHeight} * kRowBytes) {
    std::fprintf(stderr, "example: status %d, %zu bytes\n", status, picture.size());
    return 1;
  }
  std::printf("P5\n128 64\n255\n");
  for (const std::uint8_t pair : picture) {
    std::putchar((pair >> 4) * 17);
    std::putchar((pair & 15) * 17);
  }
  return 0;
}
