// A carrier as the chip sees it: an ST7789 (Sitronix data sheet V1.0) on SPI1 with its glass, and keys. The display
// is modelled from the bits on the wires; what the controller would not take, it does not take here.
const kPins = { data: 8, select: 9, reset: 12, light: 13 };
// As it is held: how wide and high the glass is, and the pin of each key.
export const kCarriers = {
  'pico-oled': { isOled: true, keys: { up: 10, down: 11, left: 12, right: 13 } }, // oled.mjs
  'pico-lcd-1.3': {
    width: 240,
    height: 240,
    keys: { up: 2, ctrl: 3, a: 15, left: 16, b: 17, down: 18, x: 19, right: 20, y: 21 },
  },
  'pico-lcd-2': { width: 320, height: 240, keys: { up: 15, down: 17, left: 2, right: 3 } },
};

const kColumns = 240; // of the controller's memory
const kRows = 320;
const kMostHz = 1e9 / 16; // 7.4.2: a bit takes 16 ns at least
const kAfterResetNs = 120e6; // 7.4.5, before it may wake
const kAfterWakeNs = 5e6; // 9.1.12, before the next command

// What all have: keys, and a complaint once the display was sent what it would not take.
export class Carrier {
  constructor(chip, carrier) {
    this.chip = chip;
    this.carrier = carrier;
    this.complaint = '';
    for (const pin of Object.values(carrier.keys)) {
      chip.gpio[pin].setInputValue(true); // pulled up, released
    }
  }

  press(key, isDown) {
    this.chip.gpio[this.carrier.keys[key]].setInputValue(!isDown);
  }
}

export class Panel extends Carrier {
  constructor(chip, carrier) {
    super(chip, carrier);
    this.memory = new Uint16Array(kColumns * kRows);
    this.restart();
    chip.gpio[kPins.reset].addListener(() => {
      this.restart();
    });
    const spi = chip.spi[1];
    // A frame takes its bits' time; the pins count at its end.
    this.watchBands();
    let frame = 0;
    const sent = chip.clock.createAlarm(() => {
      this.take(frame, spi);
      spi.completeTransmit(0);
    });
    spi.onTransmit = (next) => {
      frame = next;
      sent.schedule((1e9 * spi.dataBits) / (spi.clockFrequency || 1));
    };
  }

  restart() {
    this.command = 0;
    this.values = [];
    this.first = -1; // the first byte of a pixel that is not whole yet
    this.asleep = true;
    this.on = false;
    this.inverted = false;
    this.order = 0;
    this.pixels = 0x66; // 18 bits
    this.columns = [0, kColumns - 1];
    this.rows = [0, kRows - 1];
    this.readyAt = this.chip.clock.nanos + kAfterResetNs;
  }

  // What DMA has yet to read for the display is the display's: who writes there shows parts of two pictures.
  watchBands() {
    const { chip } = this;
    const channel = chip.dma.channels[0];
    for (const [name, bytes] of [['writeUint8', 1], ['writeUint16', 2], ['writeUint32', 4]]) {
      const write = chip[name].bind(chip);
      chip[name] = (address, value) => {
        if (address + bytes > channel.readAddr && channel.active &&
            address < channel.readAddr + channel.transCount * channel.dataSize) {
          this.complaint = `0x${address.toString(16)} written while the band there was being sent`;
        }
        write(address, value);
      };
    }
  }

  isHigh(pin) {
    return this.chip.gpio[pin].outputEnable && this.chip.gpio[pin].outputValue;
  }

  // A frame of SPI: one byte, or two with the high one first.
  take(frame, spi) {
    if (!this.isHigh(kPins.reset) || this.isHigh(kPins.select) || !spi.enabled) {
      return;
    }
    if (spi.clockFrequency > kMostHz || (spi.control0 & 0xf0) !== 0) {
      this.complaint = `SPI at ${spi.clockFrequency} Hz, control ${spi.control0.toString(16)}`;
      return;
    }
    if (spi.dataBits === 16) {
      this.byte(frame >> 8);
    }
    this.byte(frame & 0xff);
  }

  byte(value) {
    if (this.isHigh(kPins.data)) {
      this.parameter(value);
      return;
    }
    if (this.chip.clock.nanos < this.readyAt) {
      this.complaint = `command 0x${value.toString(16)} ${(this.readyAt - this.chip.clock.nanos) / 1e6} ms too early`;
      this.command = 0;
      return;
    }
    this.command = value;
    this.values = [];
    this.first = -1;
    if (value === 0x11) {
      this.asleep = false;
      this.readyAt = this.chip.clock.nanos + kAfterWakeNs;
    } else if (value === 0x20 || value === 0x21) {
      this.inverted = value === 0x21;
    } else if (value === 0x28 || value === 0x29) {
      this.on = value === 0x29;
    } else if (value === 0x2c) {
      [this.x, this.y] = [this.columns[0], this.rows[0]];
    }
  }

  parameter(value) {
    if (this.command === 0x2c) {
      this.pixelByte(value);
      return;
    }
    this.values.push(value);
    if (this.command === 0x36) {
      this.order = value;
    } else if (this.command === 0x3a) {
      this.pixels = value;
    } else if ((this.command === 0x2a || this.command === 0x2b) && this.values.length === 4) {
      const ends = [this.values[0] << 8 | this.values[1], this.values[2] << 8 | this.values[3]];
      if (this.command === 0x2a) {
        this.columns = ends;
      } else {
        this.rows = ends;
      }
    }
  }

  pixelByte(value) {
    if (this.first < 0) {
      this.first = value;
      return;
    }
    const pixel = this.first << 8 | value;
    this.first = -1;
    if (this.pixels !== 0x55 && this.pixels !== 0x05) {
      this.complaint = `pixels of another size: COLMOD 0x${this.pixels.toString(16)}`;
      return;
    }
    this.store(this.x, this.y, pixel);
    if (this.x < this.columns[1]) {
      ++this.x;
    } else {
      this.x = this.columns[0];
      this.y = this.y < this.rows[1] ? this.y + 1 : this.rows[0];
    }
  }

  // 8.12: bit 5 exchanges rows and columns, bits 6 and 7 mirror columns and rows.
  store(x, y, pixel) {
    let [column, row] = (this.order & 0x20) !== 0 ? [y, x] : [x, y];
    column = (this.order & 0x40) !== 0 ? kColumns - 1 - column : column;
    row = (this.order & 0x80) !== 0 ? kRows - 1 - row : row;
    if (column >= 0 && column < kColumns && row >= 0 && row < kRows) {
      this.memory[row * kColumns + column] = pixel;
    }
  }

  // What somebody sees who holds the long side of the controller's memory across, its joystick to the left, as PPM:
  // rows of the memory from left to right. This glass shows colours as they are when the controller inverts them.
  picture() {
    const { width, height } = this.carrier;
    const picture = Buffer.alloc(3 * width * height);
    if (!this.asleep && this.on && this.isHigh(kPins.light)) {
      for (let y = 0; y < height; ++y) {
        for (let x = 0; x < width; ++x) {
          const stored = this.memory[x * kColumns + kColumns - 1 - y];
          const pixel = this.inverted ? stored : ~stored & 0xffff;
          const [r, g, b] = [pixel >> 11, pixel >> 5 & 63, pixel & 31];
          const bytes = [r << 3 | r >> 2, g << 2 | g >> 4, b << 3 | b >> 2];
          picture.set((this.order & 8) !== 0 ? bytes.reverse() : bytes, 3 * (y * width + x));
        }
      }
    }
    return Buffer.concat([Buffer.from(`P6\n${width} ${height}\n255\n`), picture]);
  }
}
