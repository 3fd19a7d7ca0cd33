// The four functions that a compiler calls by itself. Whole words where both ends allow it: bands of pixels
// are cleared and sent with these. Compiled so that the loops are not recognised and turned into calls of
// themselves.
#include <stddef.h>
#include <stdint.h>

namespace {

constexpr uintptr_t kWordMask = sizeof(uint32_t) - 1;
// Words may alias anything here.
using Word [[gnu::may_alias]] = uint32_t;

Word* word_at(void* bytes) {
  return static_cast<Word*>(bytes);
}
const Word* word_at(const void* bytes) {
  return static_cast<const Word*>(bytes);
}

bool both_aligned(const void* one, const void* other) {
  return ((reinterpret_cast<uintptr_t>(one) | reinterpret_cast<uintptr_t>(other)) & kWordMask) == 0;
}

}  // namespace

extern "C" {

void* memcpy(void* to, const void* from, size_t count) {
  uint8_t* target = static_cast<uint8_t*>(to);
  const uint8_t* source = static_cast<const uint8_t*>(from);
  if (both_aligned(to, from)) {
    for (; count >= sizeof(Word); count -= sizeof(Word)) {
      *word_at(target) = *word_at(source);
      target += sizeof(Word);
      source += sizeof(Word);
    }
  }
  for (; count != 0; --count) {
    *target++ = *source++;
  }
  return to;
}

void* memmove(void* to, const void* from, size_t count) {
  if (reinterpret_cast<uintptr_t>(to) <= reinterpret_cast<uintptr_t>(from)) {
    return memcpy(to, from, count);  // which goes upwards
  }
  uint8_t* target = static_cast<uint8_t*>(to);
  const uint8_t* source = static_cast<const uint8_t*>(from);
  while (count != 0) {
    --count;
    target[count] = source[count];
  }
  return to;
}

void* memset(void* to, int value, size_t count) {
  uint8_t* target = static_cast<uint8_t*>(to);
  const uint8_t byte = static_cast<uint8_t>(value);
  for (; count != 0 && (reinterpret_cast<uintptr_t>(target) & kWordMask) != 0; --count) {
    *target++ = byte;
  }
  const Word word = byte * 0x01010101U;
  for (; count >= sizeof(Word); count -= sizeof(Word)) {
    *word_at(target) = word;
    target += sizeof(Word);
  }
  for (; count != 0; --count) {
    *target++ = byte;
  }
  return to;
}

int memcmp(const void* one, const void* other, size_t count) {
  const uint8_t* left = static_cast<const uint8_t*>(one);
  const uint8_t* right = static_cast<const uint8_t*>(other);
  for (; count != 0; --count, ++left, ++right) {
    if (*left != *right) {
      return *left < *right ? -1 : 1;
    }
  }
  return 0;
}
}
