// What the page calls: the memory of a board, set up for an application.
#include "boards/board_table.h"

#include "web/layout.h"

extern "C" uint8_t __heap_base;  // the linker's: the end of constants and variables

namespace thimble::web {

Layout layout;

namespace {

// Where what a suspended application had on its stack is kept: two addresses, then bytes (binaryen's
// Asyncify).
struct Suspension {
  uint8_t* next;
  uint8_t* end;
  uint8_t bytes[8192];
};
Suspension suspension;
uint64_t seal;  // of the scene's bytes

constexpr size_t kPageBytes = 65536;
constexpr size_t kGuardBytes = 64;
constexpr uint32_t kStackBytes = 65536;  // CMakeLists.txt
constexpr size_t kAlignment = 8;         // without it a baked brick map is not taken

uint8_t* at(uintptr_t address) {
  return reinterpret_cast<uint8_t*>(address);
}

void paint(uint8_t* from, uint8_t* to) {
  for (volatile uint8_t* byte = from; byte < to; ++byte) {
    *byte = port::kStackPaint;
  }
}

// Of whole words, since a board's scene is looked at after each frame; a change of one byte always changes it.
uint64_t sum_of(ConstBytes bytes) {
  using Word [[gnu::may_alias]] = uint64_t;
  constexpr uint64_t kOdd = 0x9E3779B97F4A7C15U;
  uint64_t sum = bytes.size;
  const uint8_t* at = bytes.data;
  for (; bytes.end() - at >= static_cast<ptrdiff_t>(sizeof(Word)); at += sizeof(Word)) {
    sum = (sum ^ *reinterpret_cast<const Word*>(at)) * kOdd;
    sum ^= sum >> 32;
  }
  for (; at < bytes.end(); ++at) {
    sum = (sum ^ *at) * kOdd;
  }
  return sum;
}

}  // namespace

// The stack lies at the bottom of the memory, from address 0 to the first variable.
__attribute__((noinline)) uint32_t used_stack() {
  const uint8_t* const here = static_cast<uint8_t*>(__builtin_frame_address(0));
  volatile const uint8_t* byte = at(sizeof(uint64_t));
  while (byte < here && *byte == port::kStackPaint) {
    byte = byte + 1;
  }
  return kStackBytes - static_cast<uint32_t>(reinterpret_cast<uintptr_t>(byte));
}

}  // namespace thimble::web

using thimble::web::layout;

extern "C" {

// Sets the memory up for `app` on board number `index`, with a scene of so many bytes and `connected` saying
// whether a display is shown: once in the life of a module. Where the scene is to be copied to; null where
// the memory cannot be had or the scene exceeds the board's flash.
[[clang::export_name("set_up")]] uint8_t* thimble_set_up(uint32_t index, const char* app,
                                                         uint32_t scene_bytes, bool connected) {
  using namespace thimble;
  const Span<const platform::BoardFacts> all = platform::boards();
  if (index >= all.size) {
    return nullptr;
  }
  const platform::BoardFacts board = platform::board_for(all[index], app);
  if (scene_bytes > board.flash_bytes || board.stack_bytes >= board.ram_bytes) {
    return nullptr;
  }
  const auto up = [](uintptr_t bytes, size_t unit) { return (bytes + unit - 1) / unit * unit; };
  const uintptr_t scene = up(reinterpret_cast<uintptr_t>(&__heap_base), web::kAlignment);
  const size_t arena_bytes = board.ram_bytes - board.stack_bytes;
  const size_t pages =
      up(scene + up(scene_bytes, web::kAlignment) + web::kGuardBytes + arena_bytes, web::kPageBytes) /
      web::kPageBytes;
  const size_t before = __builtin_wasm_memory_size(0);
  if (pages > before && __builtin_wasm_memory_grow(0, pages - before) == SIZE_MAX) {
    return nullptr;
  }
  uint8_t* const end = web::at(__builtin_wasm_memory_size(0) * web::kPageBytes);
  layout.facts = {board.name,
                  board.ram_bytes,
                  board.flash_bytes,
                  board.stack_bytes,
                  {board.width_px, board.height_px, board.format, connected},
                  board.visits_a_second,
                  board.map_rays_a_second,
                  0};
  layout.band_buffers = board.band_buffers;
  layout.cores = board.cores;
  layout.scene = {web::at(scene), scene_bytes};
  layout.arena = {end - arena_bytes, arena_bytes};
  layout.guard = {layout.arena.data - web::kGuardBytes, web::kGuardBytes};
  web::paint(layout.guard.data, end);
  web::paint(web::at(sizeof(uint64_t)), static_cast<uint8_t*>(__builtin_frame_address(0)) - 512);
  return layout.scene.data;
}

// Readies the place where the application is to be suspended; its address.
[[clang::export_name("suspension")]] void* thimble_suspension() {
  using thimble::web::suspension;
  suspension.next = suspension.bytes;
  suspension.end = suspension.bytes + sizeof suspension.bytes;
  return &suspension;
}

[[clang::export_name("arena_bytes")]] uint32_t thimble_arena_bytes() {
  return static_cast<uint32_t>(layout.arena.size);
}
// Bytes of the arena up to the last one that was written to; whole words are looked at, since a board may
// have 8 MiB.
[[clang::export_name("used_bytes")]] uint32_t thimble_used_bytes() {
  using Word [[gnu::may_alias]] = uint64_t;
  constexpr uint64_t kPaint = 0x0101010101010101U * thimble::port::kStackPaint;
  const uint8_t* end = layout.arena.end();
  while (end - layout.arena.begin() >= static_cast<ptrdiff_t>(sizeof(Word)) &&
         *reinterpret_cast<const Word*>(end - sizeof(Word)) == kPaint) {
    end -= sizeof(Word);
  }
  while (end > layout.arena.begin() && end[-1] == thimble::port::kStackPaint) {
    --end;
  }
  return static_cast<uint32_t>(end - layout.arena.begin());
}
[[clang::export_name("stack_limit")]] uint32_t thimble_stack_limit() {
  return layout.facts.stack_bytes;
}
[[clang::export_name("stack_bytes")]] uint32_t thimble_stack_used() {
  return thimble::web::used_stack();
}
// To be called when the scene lies in its place: WebAssembly has no memory that is only read.
[[clang::export_name("seal_flash")]] void thimble_seal_flash() {
  thimble::web::seal = thimble::web::sum_of(layout.scene);
}
// Whether the scene is as it was when it was sealed.
[[clang::export_name("flash_is_whole")]] bool thimble_flash_is_whole() {
  return thimble::web::seal == thimble::web::sum_of(layout.scene);
}
// Whether nothing was written in front of the arena.
[[clang::export_name("guard_is_whole")]] bool thimble_guard_is_whole() {
  for (const uint8_t byte : layout.guard) {
    if (byte != thimble::port::kStackPaint) {
      return false;
    }
  }
  return true;
}
}
