// What the RP2040's boot ROM does with a UF2 file, and no more (RP2040 Datasheet, 2.8): takes the blocks, and
//   flash  copies its first 256 bytes to the end of the RAM, compares their checksum, and jumps to them
//   RAM    jumps to the lowest address; stack pointer and VTOR are not set
import { readFileSync } from 'node:fs';

const kFamily = 0xe48bff56;
const kFlash = 0x10000000;
const kFlashBytes = 2 << 20; // the Pico's W25Q16JV
const kRam = 0x20000000;
const kRamBytes = 264 << 10;
const kSecondStage = 0x20041f00;

export class Refusal extends Error {}

// The blocks of a file as [address, 256 bytes].
function blocksOf(name) {
  const file = readFileSync(name);
  const blocks = [];
  for (let at = 0; at + 512 <= file.length; at += 512) {
    const word = (index) => file.readUInt32LE(at + 4 * index);
    const isBlock = word(0) === 0x0a324655 && word(1) === 0x9e5d5157 && file.readUInt32LE(at + 508) === 0x0ab16f30;
    // Blocks for other chips, or not for main memory, are passed over.
    if (!isBlock || (word(2) & 0x2000) === 0 || (word(2) & 1) !== 0 || word(7) !== kFamily) {
      continue;
    }
    if (word(4) !== 256 || word(3) % 256 !== 0) {
      throw new Refusal(`${name}: block ${word(5)} is no page of 256 bytes`);
    }
    blocks.push([word(3), file.subarray(at + 32, at + 32 + 256), word(5), word(6)]);
  }
  // The ROM starts what it was sent when all blocks are there.
  const total = blocks.length === 0 ? 0 : blocks[0][3];
  const numbers = new Set(blocks.filter((block) => block[3] === total).map((block) => block[2]));
  if (total === 0 || numbers.size !== total) {
    throw new Refusal(`${name}: ${numbers.size} of ${total} blocks for the RP2040; the drive would wait for the others`);
  }
  return blocks;
}

// Polynomial 0x04C11DB7, not reflected, all bits set at first.
function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte << 24;
    for (let bit = 0; bit < 8; ++bit) {
      crc = crc & 0x80000000 ? (crc << 1) ^ 0x04c11db7 : crc << 1;
    }
  }
  return crc >>> 0;
}

// Loads the file into the chip and sets where it begins. Says what was done in a word.
export function boot(chip, name) {
  const blocks = blocksOf(name);
  const inFlash = blocks.every(([address]) => address >= kFlash && address + 256 <= kFlash + kFlashBytes);
  const inRam = blocks.every(([address]) => address >= kRam && address + 256 <= kRam + kRamBytes);
  if (!inFlash && !inRam) {
    throw new Refusal(`${name}: a block lies outside the Pico's flash and RAM`);
  }
  for (const [address, page] of blocks) {
    (inFlash ? chip.flash : chip.sram).set(page, address - (inFlash ? kFlash : kRam));
  }
  const core = chip.core;
  core.VTOR = 0;
  core.SP = 0;
  if (inRam) {
    core.PC = Math.min(...blocks.map(([address]) => address));
    return 'RAM';
  }
  const stage = chip.flash.subarray(0, 256);
  const wanted = new DataView(stage.buffer, stage.byteOffset).getUint32(252, true);
  if (crc32(stage.subarray(0, 252)) !== wanted) {
    throw new Refusal('the second stage has a wrong checksum: the Pico would stay a drive');
  }
  chip.sram.set(stage, kSecondStage - kRam);
  core.PC = kSecondStage;
  return 'flash';
}
