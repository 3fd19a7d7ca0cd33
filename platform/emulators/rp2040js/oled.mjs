// A module of 128 x 64 pixels as the chip sees it: an SSD1306 (Solomon Systech data sheet Rev 1.1) at address 3Ch of I2C0,
// modelled from the bytes on the wires, with its glass. What the controller would not take, it does not take here.
import { Carrier } from './panel.mjs';

const kPins = [4, 5]; // SDA, SCL
const kI2cOfPin = 3; // 2.19.2 of the RP2040's data sheet
const kAddress = 0x3c;
const kLeastNs = 2500; // table 13-6: a bit takes 2.5 us at least
const kColumns = 128;
const kPages = 8;
// Bytes that follow each command (table 9-1, and the appendix on the charge pump); those of one byte are in `isAlone`.
const kFollowing = {
  0x20: 1, 0x21: 2, 0x22: 2, 0x26: 6, 0x27: 6, 0x29: 5, 0x2a: 5, 0x81: 1, 0x8d: 1, 0xa3: 2, 0xa8: 1, 0xd3: 1, 0xd5: 1,
  0xd9: 1, 0xda: 1, 0xdb: 1,
};
const isAlone = (code) => code < 0x20 || (code >= 0x40 && code < 0x80) || (code >= 0xb0 && code < 0xb8) ||
  [0x2e, 0x2f, 0xa0, 0xa1, 0xa4, 0xa5, 0xa6, 0xa7, 0xae, 0xaf, 0xc0, 0xc8, 0xe3].includes(code);

export class Oled extends Carrier {
  constructor(chip, carrier) {
    super(chip, carrier);
    this.i2c = chip.i2c[0];
    this.memory = new Uint8Array(kColumns * kPages).fill(0xa5); // anything, by the segment's number and the row's
    // As a reset leaves it (8.5, table 9-1).
    Object.assign(this, { on: false, pump: false, allOn: false, inverse: false, mirrorsColumns: false, mirrorsRows: false });
    Object.assign(this, { scrolls: false, rows: 64, pins: 0x12, offset: 0, firstLine: 0, mode: 2 });
    Object.assign(this, { column: 0, page: 0, columns: [0, kColumns - 1], pages: [0, kPages - 1] });
    this.command = []; // bytes of one that is not whole yet
    // Each step takes its bits' time: a byte 8, and the bit that acknowledges it.
    const { i2c } = this;
    let finish;
    const done = chip.clock.createAlarm(() => finish());
    const after = (bits, next) => {
      finish = next;
      done.schedule(bits * this.bitNs());
    };
    i2c.onStart = () => after(1, () => i2c.completeStart());
    i2c.onConnect = (address, isRead) => after(9, () => i2c.completeConnect(this.hears(address, isRead)));
    i2c.onWriteByte = (byte) => after(9, () => i2c.completeWrite(this.byte(byte)));
    i2c.onStop = () => after(1, () => i2c.completeStop());
  }

  // 4.3.14.2 of the RP2040's data sheet.
  bitNs() {
    const { i2c } = this;
    return (i2c.sclHighPeriod + i2c.spikelen + 7 + i2c.sclLowPeriod + 1) * 1e9 / this.chip.clkSys;
  }

  hears(address, isRead) {
    this.control = undefined; // the byte that says what follows, for all or for one
    return address === kAddress && !isRead && kPins.every((pin) => this.chip.gpio[pin].functionSelect === kI2cOfPin);
  }

  // A byte of a transfer; false: not acknowledged.
  byte(value) {
    const { control } = this;
    if (this.bitNs() < kLeastNs) {
      this.complaint = `a bit of ${this.bitNs().toFixed()} ns on I2C, ${kLeastNs} at least`;
    } else if (control === undefined) {
      this.control = value;
      if ((value & 0x3f) !== 0) { // 8.1.5.2
        this.complaint = `control byte 0x${value.toString(16)}`;
      }
    } else {
      this.control = (control & 0x80) === 0 ? control : undefined;
      if ((control & 0x40) === 0) {
        this.take(value);
      } else {
        this.store(value);
      }
    }
    return this.complaint === '';
  }

  take(value) {
    this.command.push(value);
    const [code, first, second] = this.command;
    if (this.command.length <= (kFollowing[code] ?? 0)) {
      return;
    }
    this.command = [];
    if (!this.obey(code, first, second)) {
      this.complaint = `command 0x${code.toString(16)} with ${first ?? 'nothing'}, ${second ?? 'nothing'}`;
    }
  }

  // Whether the controller has that command, with these values.
  obey(code, first, second) {
    const range = (last) => first <= second && second <= last;
    switch (code) {
      case 0x20: this.mode = first; return first <= 2;
      case 0x21: [this.column, this.columns] = [first, [first, second]]; return range(kColumns - 1);
      case 0x22: [this.page, this.pages] = [first, [first, second]]; return range(kPages - 1);
      case 0x8d: this.pump = first === 0x14; return first === 0x14 || first === 0x10;
      case 0xa8: this.rows = first + 1; return first >= 15 && first <= 63;
      case 0xd3: this.offset = first; return first <= 63;
      case 0xda: this.pins = first; return (first & ~0x30) === 0x02;
      case 0xdb: return (first & ~0x70) === 0;
      case 0xd9: return (first & 0x0f) !== 0 && first >> 4 !== 0;
      case 0x2e: case 0x2f: this.scrolls = code === 0x2f; return true;
      case 0xa0: case 0xa1: this.mirrorsColumns = code === 0xa1; return true;
      case 0xa4: case 0xa5: this.allOn = code === 0xa5; return true;
      case 0xa6: case 0xa7: this.inverse = code === 0xa7; return true;
      case 0xae: case 0xaf: this.on = code === 0xaf; return !this.on || this.isWired();
      case 0xc0: case 0xc8: this.mirrorsRows = code === 0xc8; return true;
      default:
    }
    if (code < 0x10) {
      this.column = this.column & 0xf0 | code;
    } else if (code < 0x20) {
      this.column = this.column & 0x0f | (code & 7) << 4;
    } else if (code >= 0xb0 && code < 0xb8) {
      this.page = code & 7;
    } else if (code >= 0x40 && code < 0x80) {
      this.firstLine = code & 63;
    }
    return isAlone(code) || code in kFollowing;
  }

  // What this module's glass wants before it is on: its pump, 64 rows that are wired in turns, and nothing that moves.
  isWired() {
    return this.pump && this.rows === 64 && this.pins === 0x12 && this.offset === 0 && !this.scrolls;
  }

  // 10.1.3: in which order addresses follow. A mirrored column is another segment from here on (10.1.8).
  store(value) {
    const segment = this.mirrorsColumns ? kColumns - 1 - this.column : this.column;
    this.memory[this.page * kColumns + segment] = value;
    const step = (at, [from, to]) => (at === to ? [from, true] : [at + 1, false]);
    let ended;
    if (this.mode === 1) {
      [this.page, ended] = step(this.page, this.pages);
      [this.column] = ended ? step(this.column, this.columns) : [this.column];
    } else if (this.mode === 0) {
      [this.column, ended] = step(this.column, this.columns);
      [this.page] = ended ? step(this.page, this.pages) : [this.page];
    } else {
      [this.column] = step(this.column, [0, kColumns - 1]);
    }
  }

  // What somebody sees, as PPM. Segment 127 is the glass's left column, and row 63 of the controller its top one.
  picture() {
    const picture = Buffer.alloc(3 * kColumns * 64);
    for (let y = 0; y < 64 && this.on; ++y) {
      const row = ((this.mirrorsRows ? y : 63 - y) + this.firstLine) % 64;
      for (let x = 0; x < kColumns; ++x) {
        const bit = this.memory[(row >> 3) * kColumns + kColumns - 1 - x] >> (row & 7) & 1;
        picture.fill(this.allOn || (bit === 1) !== this.inverse ? 255 : 0, 3 * (y * kColumns + x), 3 * (y * kColumns + x + 1));
      }
    }
    return Buffer.concat([Buffer.from(`P6\n${kColumns} 64\n255\n`), picture]);
  }
}
