// The model of the Pico's display refuses what the wires of a real one could not take (platform/emulators/rp2040js):
// above all a write into a band that is still being sent.       node test_panel.mjs PATH_OF_panel.mjs
import assert from 'node:assert/strict';
import { pathToFileURL } from 'node:url';

const { Panel } = await import(pathToFileURL(process.argv[2]).href);

class Pin {
  outputEnable = true;
  outputValue = true;
  setInputValue() {}
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

function panel() {
  const chip = new Chip();
  const made = new Panel(chip);
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
console.log('panel: refuses what a display could not take');
