// What a cartridge begins with (GBATEK, GBA Cartridge Header): 192 bytes, the first of them a branch over the
// rest. The 156 bytes of a picture that a console compares with its own before it starts are left zero, since
// they are Nintendo's: emulators start the image as it is; for a console, a tool of the flash cartridge fills
// them in.
#include <stdint.h>

namespace {

struct Header {
  uint32_t branch;
  uint8_t picture[156];
  char title[12];
  char game[4];
  char maker[2];
  uint8_t fixed;
  uint8_t unit;
  uint8_t device;
  uint8_t reserved[7];
  uint8_t version;
  uint8_t complement;
  uint8_t unused[2];
};
static_assert(sizeof(Header) == 0xC0);

constexpr Header make_header() {
  // B 0xC0, from 0: the program counter is two instructions ahead, and counts words.
  Header header = {
      0xEA000000U | (sizeof(Header) - 8) / 4,
      {},
      {'T', 'H', 'I', 'M', 'B', 'L', 'E', 0, 0, 0, 0, 0},
      {'Z', 'T', 'H', 'E'},
      {'0', '0'},
      0x96,
      0,
      0,
      {},
      0,
      0,
      {},
  };
  // Bytes 0xA0 to 0xBC, 0x19 and the complement come to 0; the others among them are 0.
  uint32_t sum = 0x19U + header.fixed;
  for (const char letter : header.title) {
    sum += static_cast<uint8_t>(letter);
  }
  for (const char letter : header.game) {
    sum += static_cast<uint8_t>(letter);
  }
  for (const char letter : header.maker) {
    sum += static_cast<uint8_t>(letter);
  }
  header.complement = static_cast<uint8_t>(0U - sum);
  return header;
}

[[gnu::section(".boot_flash"), gnu::used]] constexpr Header kHeader = make_header();

}  // namespace
