// The contract of port.h in a WebAssembly module: what the page supplies is imported, and the memory is laid
// out as on a board (layout.h).
#include "port.h"

#include "web/layout.h"

#define THIMBLE_FROM_PAGE(name) [[clang::import_module("env"), clang::import_name(#name)]]

extern "C" {
// May suspend the application, as `running` does.
THIMBLE_FROM_PAGE(flush)
void page_flush(const uint8_t* pixels, size_t bytes, int32_t first_row, int32_t rows);
THIMBLE_FROM_PAGE(running) bool page_running(uint32_t frames);
THIMBLE_FROM_PAGE(buttons) uint32_t page_buttons();
THIMBLE_FROM_PAGE(read) int page_read();
THIMBLE_FROM_PAGE(write) void page_write(const uint8_t* bytes, size_t size);
THIMBLE_FROM_PAGE(microseconds) uint32_t page_microseconds();
}

namespace thimble::port {

const Facts& facts() {
  return web::layout.facts;
}
Bytes arena() {
  return web::layout.arena;
}
ConstBytes scene() {
  return web::layout.scene;
}
void flush(const Band& band) {
  page_flush(band.pixels.data, band.pixels.size, band.first_row, band.rows);
}
// The page has the bytes when flush returns.
void begin_flush(const Band& band) {
  flush(band);
}
void await_flush() {}
int32_t band_buffers() {
  return web::layout.band_buffers;
}
int32_t cores() {
  return web::layout.cores;
}
uint32_t buttons() {
  return page_buttons();
}
int read() {
  return page_read();
}
void write(ConstBytes bytes) {
  page_write(bytes.data, bytes.size);
}
bool running(uint32_t frames) {
  return page_running(frames);
}
uint32_t instructions() {
  return 0;  // nobody counts them here
}
uint32_t microseconds() {
  return page_microseconds();
}
uint32_t stack_high_water() {
  return web::used_stack();
}

}  // namespace thimble::port
