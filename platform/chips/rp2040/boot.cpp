// What the boot ROM starts (RP2040 Datasheet, 2.8): the first 256 bytes of an image. Each image takes the
// section that its linker script names; the other one is dropped.

// In flash: the second stage (2.8.1). The ROM copies it to the end of the RAM, compares the CRC-32 of its
// first 252 bytes with the last four (platform/uf2 writes them) and jumps to it. It makes flash readable at
// 0x10000000: the SSI (4.10) sends the read command that every serial flash knows (03h, an address of 24
// bits) and takes 32 bits, one line each way, at a quarter of the core's clock: 33 of the 50 MHz that the
// Pico's W25Q16JV takes for it.
asm(R"(
  .section .boot_flash, "ax", %progbits
  .balign 4
  .syntax unified
  .thumb
boot_flash:
  ldr r0, =0x18000000     @ SSI
  movs r1, #0
  str r1, [r0, #0x08]     @ SSIENR: off, to be set up
  movs r1, #4
  str r1, [r0, #0x14]     @ BAUDR: clk_sys / 4
  ldr r1, =0x001F0300     @ frames of 32 bits, one line, EEPROM read
  str r1, [r0, #0x00]     @ CTRLR0
  movs r1, #0
  str r1, [r0, #0x04]     @ CTRLR1: one frame a read
  ldr r1, =0x03000218     @ command 03h of 8 bits, address of 24
  movs r2, #0xF4
  str r1, [r0, r2]        @ SPI_CTRLR0
  movs r1, #1
  str r1, [r0, #0x08]     @ SSIENR: on
  ldr r0, =thimble_image_vectors
  ldr r1, =0xE000ED08     @ VTOR
  str r0, [r1]
  ldr r1, [r0, #0]
  mov sp, r1
  ldr r1, [r0, #4]
  bx r1
  .ltorg
  .org 252
  .word 0
  .previous
)");

// In RAM: the ROM jumps to the lowest address of what it was sent (2.8.4), stack pointer and VTOR not set.
asm(R"(
  .section .boot_ram, "ax", %progbits
  .balign 4
  .syntax unified
  .thumb
boot_ram:
  ldr r0, =thimble_image_vectors
  ldr r1, =0xE000ED08     @ VTOR
  str r0, [r1]
  ldr r1, [r0, #0]
  mov sp, r1
  ldr r1, [r0, #4]
  bx r1
  .ltorg
  .org 256
  .previous
)");
