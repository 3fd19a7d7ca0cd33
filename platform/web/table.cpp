// What the page asks of the boards and of their pixels: so there is one table, and one reading of each format.
#include "boards/board_table.h"

#include "apps/text.h"
#include "thimble/picture/pixel.h"

extern "C" uint8_t __heap_base;  // the linker's: the end of constants and variables

extern "C" {

// Writes the table of boards (boards/board_table.h) as JSON.
[[clang::export_name("boards")]] void thimble_boards() {
  using namespace thimble;
  const char* between = "[";
  for (const platform::BoardFacts& board : platform::boards()) {
    // Of the file that is downloaded: what its drive or its emulators take.
    const char* const ending = board.uf2_family != 0        ? "uf2"
                               : board.image_ending[0] != 0 ? board.image_ending
                                                            : "hex";
    const auto number = [](auto value) { return static_cast<uint64_t>(value); };
    apps::put(between, "{\"name\":\"", board.name, "\",\"title\":\"", board.title, "\",\"ending\":\"", ending,
              "\",\"ram\":", number(board.ram_bytes), ",\"flash\":", number(board.flash_bytes),
              ",\"stack\":", number(board.stack_bytes), ",\"screen\":", number(board.screen),
              ",\"format\":", number(board.format),
              ",\"row_bytes\":", number(row_bytes(board.format, board.width_px)),
              ",\"rows_together\":", number(band_row_multiple(board.format)),
              ",\"width\":", number(board.width_px), ",\"height\":", number(board.height_px),
              ",\"buttons\":", number(board.buttons), "}");
    between = ",\n";
  }
  apps::put("]");
}

// Rows `first` to `end` of a picture of `width` pixels a row, as red, green, blue and 255 a pixel. Those are the first
// `rgba` holds, and `rows` points to the bytes of `first`, which starts whole bytes (`rows_together`). False for a format that
// there is not.
[[clang::export_name("expand")]] bool thimble_expand(uint32_t format, const uint8_t* rows, int32_t width,
                                                     int32_t first, int32_t end, uint8_t* rgba) {
  using namespace thimble;
  if (format >= kPixelFormats || !has_format(static_cast<PixelFormat>(format))) {
    return false;
  }
  const auto of = static_cast<PixelFormat>(format);
  const size_t stride = row_bytes(of, width);
  for (int32_t y = first; y < end; ++y) {
    const uint8_t* const row = rows + (row_place(of, y) - row_place(of, first)) * stride;
    for (int32_t x = 0; x < width; ++x) {
      const Rgb8 pixel = load_pixel(row, x, y, of);
      *rgba++ = pixel.r;
      *rgba++ = pixel.g;
      *rgba++ = pixel.b;
      *rgba++ = 255;
    }
  }
  return true;
}
// Where bytes for `expand` may lie: so many, from here to the end of the memory. Null where they cannot be had.
[[clang::export_name("room")]] uint8_t* thimble_table_room(uint32_t bytes) {
  constexpr size_t kPage = 65536;
  const uintptr_t at = (reinterpret_cast<uintptr_t>(&__heap_base) + 7) & ~uintptr_t{7};
  const size_t before = __builtin_wasm_memory_size(0);
  const size_t pages = (at + bytes + kPage - 1) / kPage;
  if (pages > before && __builtin_wasm_memory_grow(0, pages - before) == SIZE_MAX) {
    return nullptr;
  }
  return reinterpret_cast<uint8_t*>(at);
}
}
