// A board in the page: one WebAssembly module with one application in it (port.cpp, boards.cpp). The page and the
// tests under Node drive it alike: step() runs the application until it asks for the next frame, or, in a long
// frame, until a slice of time is over.
'use strict';

const STACK_PAINT = 0xA5;  // port.h
const BUTTONS = {up: 1, down: 2, left: 4, right: 8, select: 16};

// A sentence that ends what a module does.
class Fault extends Error {}

// The display of a board: packed rows as they were flushed. As strict as the simulator's (host/strict_display.h).
class Display {
  constructor(board) {
    this.board = board;
    this.stride = board.row_bytes;
    this.bytes = new Uint8Array(this.packed(board.height));
    this.has = new Uint8Array(board.height);
    this.rows = 0;
    this.pictures = 0;
    this.changed = [board.height, 0];  // rows that a canvas does not show yet
  }
  // Bytes of so many rows, of which some formats keep several together.
  packed(rows) {
    return this.stride * Math.ceil(rows / this.board.rows_together);
  }
  take(bytes, first, rows) {
    const {height} = this.board;
    if (rows <= 0 || first < 0 || first + rows > height) {
      throw new Fault(`it flushed rows ${first} to ${first + rows - 1}, and the display has ${height}`);
    }
    if (bytes !== null && bytes.length < this.packed(rows)) {
      throw new Fault(`it flushed ${bytes.length} bytes for ${rows} rows of ${this.stride}`);
    }
    if (bytes === null && this.pictures === 0) {
      throw new Fault('it kept rows before there was a whole picture');
    }
    for (let row = first; row < first + rows; ++row) {
      if (this.has[row]) throw new Fault(`it flushed row ${row} twice in one frame`);
      this.has[row] = 1;
    }
    if (bytes !== null) {
      this.bytes.set(bytes.subarray(0, this.packed(rows)), this.packed(first));
      this.changed = [Math.min(this.changed[0], first), Math.max(this.changed[1], first + rows)];
    }
    this.rows += rows;
    if (this.rows === height) {
      this.has.fill(0);
      this.rows = 0;
      ++this.pictures;
    }
  }
  endFrame() {
    if (this.rows !== 0) throw new Fault(`a frame ended with ${this.rows} of ${this.board.height} rows flushed`);
  }
}

class Machine {
  // `module`: a WebAssembly.Module. `options`: board (of Table.boards), app, scene (Uint8Array), connected, slice_ms.
  constructor(module, options) {
    this.board = options.board;
    this.app = options.app;
    this.slice = options.slice_ms ?? Infinity;
    this.display = new Display(options.board);
    this.keys = [];
    this.buttons = 0;
    this.output = '';
    this.onFlush = options.onFlush ?? null;
    this.goOn = true;
    this.frames = 0;
    this.state = 'new';
    this.busy = 0;
    this.frameTime = 0;
    this.start = performance.now();
    this.x = new WebAssembly.Instance(module, {env: this.imports()}).exports;
    this.setUp(options.scene ?? new Uint8Array(0), options.connected ?? true);
  }

  setUp(scene, connected) {
    const board = this.board;
    if (scene.length > board.flash) {
      throw new Fault(`the scene takes ${scene.length} bytes, and the flash of ${board.name} has ${board.flash}`);
    }
    const name = new TextEncoder().encode(this.app + '\0');
    // The name lies where the application's stack will be painted over it.
    new Uint8Array(this.x.memory.buffer).set(name, 64);
    const at = this.x.set_up(board.index, 64, scene.length, connected);
    if (at === 0) throw new Fault(`there is no memory for ${board.name} here`);
    new Uint8Array(this.x.memory.buffer).set(scene, at);
    this.x.seal_flash();
  }

  imports() {
    return {
      flush: (at, size, first, rows) => {
        if (this.rewound()) return;
        const bytes = size === 0 ? null : new Uint8Array(this.x.memory.buffer, at, size);
        this.display.take(bytes, first, rows);
        if (this.onFlush !== null) this.onFlush(bytes, first, rows);
        if (performance.now() - this.began >= this.slice) this.suspend('band');
      },
      running: (frames) => {
        if (this.rewound()) return this.goOn;
        this.display.endFrame();
        this.frames = frames;
        this.suspend('frame');
        return false;
      },
      buttons: () => this.buttons,
      read: () => (this.keys.length === 0 ? -1 : this.keys.shift()),
      write: (at, size) => {
        const bytes = new Uint8Array(this.x.memory.buffer, at, size);
        for (const byte of bytes) this.output += String.fromCharCode(byte);
      },
      microseconds: () => (performance.now() - this.start) * 1000,
    };
  }
  // Whether this call of an import is the one that the application was suspended in.
  rewound() {
    if (this.x.asyncify_get_state() !== 2) return false;
    this.x.asyncify_stop_rewind();
    return true;
  }
  suspend(why) {
    this.state = why;
    this.place = this.x.suspension();
    this.x.asyncify_start_unwind(this.place);
  }

  // Runs on. 'frame': it asks for the next one; 'band': a slice of time is over; 'ended': see status and fault.
  step() {
    if (this.state === 'ended') return this.state;
    this.began = performance.now();
    try {
      if (this.state !== 'new') this.x.asyncify_start_rewind(this.place);
      this.state = 'ended';
      const status = this.x[this.app]();
      if (this.state !== 'ended') {
        this.x.asyncify_stop_unwind();
      } else {
        this.status = status;
        if (status === 0) this.display.endFrame();
      }
      if (!this.x.flash_is_whole()) throw new Fault('it wrote to its flash');
      if (!this.x.guard_is_whole()) throw new Fault('it wrote in front of its RAM');
    } catch (error) {
      this.state = 'ended';
      this.status = 97;
      this.fault = error instanceof Fault ? error.message : this.hasUsedAllStack() ? 'its stack overflowed' : faultOf(error);
    }
    this.busy += performance.now() - this.began;
    if (this.state !== 'band') {
      this.frameTime = this.busy;
      this.busy = 0;
    }
    return this.state;
  }

  // The stack grows down to address 0; its last bytes are paint until then.
  hasUsedAllStack() {
    return new Uint8Array(this.x.memory.buffer, 8, 256).some((byte) => byte !== STACK_PAINT);
  }

  type(text) {
    for (const character of text) this.keys.push(character.charCodeAt(0) & 255);
  }
  use() {
    return {
      ram: this.x.used_bytes(), ramLimit: this.x.arena_bytes(),
      stack: this.x.stack_bytes(), stackLimit: this.x.stack_limit(),
    };
  }
}

function faultOf(error) {
  const text = String(error.message);
  if (/out of bounds/.test(text)) return 'it touched a byte past its RAM';
  if (/call stack|recursion/i.test(text)) return 'its stack overflowed';
  if (/unreachable/.test(text)) return 'it gave up';
  return text;
}

// The table of boards, and what their pixels look like, from the module that has both (table.cpp).
class Table {
  constructor(module) {
    let text = '';
    this.x = new WebAssembly.Instance(module, {env: {
      flush() {}, running: () => 0, buttons: () => 0, read: () => -1, microseconds: () => 0,
      write: (at, size) => { text += new TextDecoder().decode(new Uint8Array(this.x.memory.buffer, at, size)); },
    }}).exports;
    this.x.boards();
    this.boards = JSON.parse(text).map((board, index) => ({...board, index}));
  }
  // Packed rows as RGBA, 8 bits each: what `thimble sim --shot` writes. `to` is of the whole picture.
  expand(display, from, end, to) {
    const {width, format, rows_together: together} = display.board;
    const first = from - from % together;
    const packed = display.bytes.subarray(display.packed(first), display.packed(end));
    const room = this.x.room(packed.length + 8 + 4 * width * (end - first));
    if (room === 0) throw new Fault('there is no memory for a picture here');
    const pixels = room + packed.length + 8 & ~7;
    new Uint8Array(this.x.memory.buffer).set(packed, room);
    if (!this.x.expand(format, room, width, first, end, pixels)) {
      throw new Fault(`this page knows no pixels of format ${format}, which ${display.board.name} has`);
    }
    to.set(new Uint8Array(this.x.memory.buffer, pixels + 4 * width * (from - first), 4 * width * (end - from)), 4 * width * from);
  }
}

const CRC_TABLE = Int32Array.from({length: 256}, (_, n) => {
  for (let k = 0; k < 8; ++k) n = n & 1 ? (n >>> 1) ^ 0xEDB88320 : n >>> 1;
  return n;
});
// CRC-32 as zlib computes it, as eight digits.
function crc32(bytes) {
  let crc = -1;
  for (let i = 0; i < bytes.length; ++i) crc = (crc >>> 8) ^ CRC_TABLE[(crc ^ bytes[i]) & 255];
  return ((crc ^ -1) >>> 0).toString(16).padStart(8, '0');
}

if (typeof module !== 'undefined') {
  module.exports = {BUTTONS, Fault, Display, Machine, Table, crc32};
}
