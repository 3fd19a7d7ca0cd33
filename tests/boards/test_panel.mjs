// The model of the Pico's display refuses what the wires of a real one could not take (platform/emulators/rp2040js):
// above all a write into a band that is still being sent.       node test_panel.mjs PATH_OF_panel.mjs
import assert from 'node:assert/strict';
import { pathToFileURL } from 'node:url';

const { Panel, kCarriers } = await import(pathToFileURL(process.argv[2]).href);

class Pin {
  outputEnable = true;
  outputValue = true;
  isHigh = false;
  setInputValue(isHigh) {
    this.isHigh = isHigh;
  }
  addListener() {}
}

// A chip of what the panel asks for: memory, pins, one channel of DMA, one SPI, and a clock that stands.
class Chip {
  memory = new Map();
  gpio = Array.from({ length: 30 }, () => new Pin());
  dma = { channels: [{ active: false, readAddr: 0, transCount: 0, dataSize: 2 }] };
  spi = [{}, { enabled: true, clockFrequency: 62.5e6, control0: 0, dataBits: 8, completeTransmit() {} }];
  clock = { nanos: 1e9, createAlarm: (rings) => ({ schedule: () => rings() }) };
  writeUint8(address, value) {
    this.memory.set(address, value);
  }
  writeUint16(address, value) {
    this.memory.set(address, value);
  }
  writeUint32(address, value) {
    this.memory.set(address, value);
  }
}

function panel(carrier = kCarriers['pico-lcd-1.3']) {
  const chip = new Chip();
  const made = new Panel(chip, carrier);
  made.readyAt = 0;
  return { chip, made };
}

const kBand = 0x20001000;
for (const [name, bytes] of [['writeUint8', 1], ['writeUint16', 2], ['writeUint32', 4]]) {
  const tried = (address, sending) => {
    const { chip, made } = panel();
    Object.assign(chip.dma.channels[0], { active: sending, readAddr: kBand, transCount: 100 });
    chip[name](address, 7);
    assert.equal(chip.memory.get(address), 7, `${name} writes all the same`);
    return made.complaint;
  };
  for (const address of [kBand, kBand + 96, kBand + 199 - (199 % bytes), kBand - bytes + 1]) {
    assert.match(tried(address, true), /written while the band there was being sent/, `${name} at ${address - kBand}`);
    assert.equal(tried(address, false), '', `${name} at ${address - kBand}, nothing being sent`);
  }
  // What was sent already, what lies in front, and the band that is drawn beside it.
  for (const address of [kBand - bytes, kBand + 200, kBand + 4096]) {
    assert.equal(tried(address, true), '', `${name} at ${address - kBand}`);
  }
}

// On the wires: too fast, of another mode, and a command before the controller is ready.
{
  const { chip, made } = panel();
  chip.gpio[9].outputValue = false; // selected
  chip.gpio[8].outputValue = false; // a command
  chip.spi[1].onTransmit(0x29);
  assert.equal(made.complaint, '');
  assert.equal(made.on, true);
  chip.spi[1].clockFrequency = 63e6;
  chip.spi[1].onTransmit(0x28);
  assert.match(made.complaint, /SPI at 63000000 Hz/);
  assert.equal(made.on, true);
}
{
  const { chip, made } = panel();
  chip.gpio[9].outputValue = false;
  chip.gpio[8].outputValue = false;
  made.readyAt = chip.clock.nanos + 1e6;
  chip.spi[1].onTransmit(0x29);
  assert.match(made.complaint, /command 0x29 1 ms too early/);
  assert.equal(made.on, false);
}
// Each carrier: keys are pulled up, one that is held is low; a picture as wide and high as the glass, in which the pixel
// that is sent first is at the top left and the last of a row at its right.
for (const [name, width, height, up] of [['pico-lcd-1.3', 240, 240, 2], ['pico-lcd-2', 320, 240, 15]]) {
  const { chip, made } = panel(kCarriers[name]);
  assert.equal(chip.gpio[up].isHigh, true, name);
  made.press('up', true);
  assert.equal(chip.gpio[up].isHigh, false, name);
  made.press('up', false);
  assert.equal(chip.gpio[up].isHigh, true, name);
  Object.assign(made, { asleep: false, on: true, inverted: true, order: 0x70, pixels: 0x55, x: 0, y: 0 });
  Object.assign(made, { command: 0x2c, columns: [0, width - 1], rows: [0, height - 1] });
  for (let x = 0; x <= width; ++x) {
    const pixel = x === 0 ? 0xf800 : x === width - 1 ? 0x07e0 : x === width ? 0x001f : 0;
    made.pixelByte(pixel >> 8);
    made.pixelByte(pixel & 0xff);
  }
  const picture = made.picture();
  const head = `P6\n${width} ${height}\n255\n`;
  assert.equal(picture.subarray(0, head.length).toString(), head);
  const at = (x, y) => [...picture.subarray(head.length + 3 * (y * width + x)).subarray(0, 3)];
  assert.deepEqual(at(0, 0), [255, 0, 0], name);
  assert.deepEqual(at(width - 1, 0), [0, 255, 0], name);
  assert.deepEqual(at(0, 1), [0, 0, 255], name);
  assert.equal(picture.length, head.length + 3 * width * height);
}
console.log('panel: refuses what a display could not take');
