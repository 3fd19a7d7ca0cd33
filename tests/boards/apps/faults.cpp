// What a board must survive telling: faults on request. A byte over the UART chooses; each must end with a
// message of the port and port::kFaultStatus, and the application returns 1 when it comes back from one.
#include <stddef.h>
#include <stdint.h>

#include "apps/apps.h"
#include "apps/text.h"
#include "port.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/base/memory.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/octree.h"

namespace thimble::apps {
namespace {

// Deeper and deeper. The compiler must believe that it ends and that every frame is needed.
[[gnu::noinline]] uint32_t overflow_stack(volatile const uint8_t* limit, uint32_t depth) {
  volatile uint8_t frame[64] = {};
  frame[depth % sizeof(frame)] = static_cast<uint8_t>(depth);
  if (*limit == 0) {
    return depth;
  }
  return overflow_stack(limit, depth + 1) + frame[(depth + 1) % sizeof(frame)];
}

// From the arena's last byte upwards, 64 KiB at most.
void overrun_ram() {
  volatile uint8_t* const end = port::arena().end();
  for (size_t i = 0; i < 65536; i += 16) {
    end[i] = 0xEE;
  }
}

const uint32_t kConstant[4] = {1, 2, 3, 4};

bool write_flash() {
  volatile uint32_t* const word = const_cast<volatile uint32_t*>(&kConstant[1]);
  *word = ~*word;
  return *word != kConstant[1];
}

// A small baked scene, made here, in bytes of `arena`; empty when one of the steps failed.
Bytes bake_small_scene(Arena* arena) {
  constexpr size_t kNodes = 32;
  Octree octree;
  size_t tree_bytes = 0;
  const VoxelBox box = {{1, 2, 3}, {5, 4, 6}};
  if (Octree::make(3, arena->take(Octree::octree_bytes(kNodes)), &octree) != Status::kOk ||
      octree.insert_box(box, 1) != Status::kOk || octree.insert({7, 7, 7}, 2) != Status::kOk ||
      CompactTree::make(octree, arena->rest(), nullptr, &tree_bytes) != Status::kOk) {
    return {};
  }
  BakedParts parts;
  parts.tree = arena->take(tree_bytes, 1);
  const Bytes bytes = arena->take(baked_bytes(parts));
  return bytes.empty() || BakedScene::make(parts, bytes, nullptr) != Status::kOk ? Bytes{} : bytes;
}

// Opens and traces a scene that is damaged in one byte, for every byte of it. Nothing may hang or fault;
// returns whether each was seen to be damaged.
bool open_damaged_scenes() {
  Arena arena(port::arena());
  const Bytes bytes = bake_small_scene(&arena);
  BakedScene scene;
  if (bytes.empty() || BakedScene::open(bytes, &scene) != Status::kOk || scene.validate() != Status::kOk) {
    put("there is no sound scene to damage\n");
    return false;
  }
  const Ray ray = {{Q8::from_raw(-300), Q8::from_raw(700), Q8::from_raw(1000)}, {1000, 3, -2}};
  bool seen = true;
  for (uint8_t& byte : bytes) {
    const uint8_t sound = byte;
    byte = static_cast<uint8_t>(~sound);
    BakedScene damaged;
    if (BakedScene::open(bytes, &damaged) == Status::kOk) {
      Hit hit;
      static_cast<void>(closest_hit(damaged.tree(), ray, &hit));
      seen = seen && damaged.validate() == Status::kDamaged;
    }
    byte = sound;
  }
  return seen;
}

// All bits set is no instruction of Arm, Thumb or RISC-V.
const uint32_t kNonsense[4] = {UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX};

void execute_nonsense() {
#if defined(__thumb__)
  const uintptr_t thumb_bit = 1;
#else
  const uintptr_t thumb_bit = 0;
#endif
  const uintptr_t address = reinterpret_cast<uintptr_t>(kNonsense) + thumb_bit;
  __builtin_bit_cast(void (*)(), address)();
}

// Says which buttons are down whenever that changes, until `q`: for bringing up a board.
int tell_buttons() {
  static constexpr const char* kNames[] = {" up", " down", " left", " right", " select"};
  put("buttons\n");
  uint32_t told = 0;
  while (port::running(0) && port::read() != 'q') {
    const uint32_t down = port::buttons();
    if (down != told) {
      put("down:");
      for (uint32_t i = 0; i < 5; ++i) {
        put((down >> i & 1U) != 0 ? kNames[i] : "");
      }
      put("\n");
      told = down;
    }
  }
  return 0;
}

int run(int key) {
  switch (key) {
    case 's': {
      volatile uint8_t never = 1;
      put("overflowing the stack\n");
      overflow_stack(&never, 0);
      break;
    }
    case 'r':
      put("writing past the RAM\n");
      overrun_ram();
      break;
    case 'f':
      put("writing flash\n");
      write_flash();
      break;
    case 'n':
      put("executing nonsense\n");
      execute_nonsense();
      break;
    case 'd':
      if (open_damaged_scenes()) {
        put("fault: the scene is damaged\n");
        return port::kFaultStatus;
      }
      break;
    case 'b':
      return tell_buttons();
    default:
      return -1;
  }
  put("nobody noticed\n");
  return 1;
}

}  // namespace

int faults() {
  put("faults: s stack, r RAM, f flash, n nonsense, d damaged scene; b buttons\n");
  while (port::running(0)) {
    const int status = run(port::read());
    if (status >= 0) {
      return status;
    }
  }
  return 0;
}

}  // namespace thimble::apps
