// Runs an image as a Raspberry Pi Pico would: the UART on stdin and stdout, the exit status the application's.
//
//   node emulate.mjs MODULES SHIFT IMAGE.uf2 [-carrier NAME] [-qmp unix:SOCKET,...] [-shot PICTURE.ppm]
//
// MODULES is where npm put rp2040js; an instruction takes 2^SHIFT ns. -carrier: one of panel.mjs. -qmp answers as QEMU's
// machine protocol does to tests/boards/qemu_screen.cpp: screendump, input-send-event, quit. -shot writes what the
// display shows at the end.
import { rmSync, writeFileSync, writeSync } from 'node:fs';
import { createServer } from 'node:net';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Refusal, boot } from './bootrom.mjs';
import { LockUp, Machine } from './machine.mjs';
import { Oled } from './oled.mjs';
import { Panel, kCarriers } from './panel.mjs';

const kRefused = 96;
const kLockedUp = 98;
const kInstructionsATime = 200000;
const kLeftNs = 50e6;
const kSemihosting = 0xab;
const kExitExtended = 0x20;

const [modules, shift, image, ...options] = process.argv.slice(2);
const option = (name) => (options.includes(name) ? options[options.indexOf(name) + 1] : undefined);
const library = pathToFileURL(resolve(modules, 'rp2040js/dist/esm/index.js')).href;
const machine = new Machine(await import(library), Number(shift));
const { chip } = machine;
const carrier = kCarriers[option('-carrier') ?? 'pico-lcd-1.3'];
if (carrier === undefined) {
  tell(`there is no carrier ${option('-carrier')}; those there are: ${Object.keys(kCarriers).join(', ')}`);
  process.exit(2);
}
const panel = new (carrier.isOled ? Oled : Panel)(chip, carrier);
const uart = chip.uart[0];
let status = -1; // once it has ended

function tell(text) {
  process.stderr.write(`rp2040js: ${text}\n`);
}

// What the board says, written before anything else happens.
let said = [];
uart.onByte = (byte) => {
  said.push(byte);
};
function flush() {
  let bytes = Buffer.from(said);
  said = [];
  while (bytes.length > 0) {
    try {
      bytes = bytes.subarray(writeSync(1, bytes));
    } catch (error) {
      if (error.code === 'EPIPE') {
        status = 0;
        return;
      }
      if (error.code !== 'EAGAIN') {
        throw error;
      }
    }
  }
}

// Keys wait here until the board reads.
const keys = [];
process.stdin.on('data', (bytes) => keys.push(...bytes));
process.stdin.on('error', () => {});
function feed() {
  while (keys.length > 0 && uart.enabled && uart.rxEnabled && !uart.rxFIFO.full) {
    uart.feedByte(keys.shift());
  }
}

// Without a debugger the core faults here; this one knows one wish (SYS_EXIT_EXTENDED).
chip.onBreak = (code) => {
  const [operation, block] = chip.core.registers;
  if (code === kSemihosting && operation === kExitExtended) {
    status = chip.readUint32(block + 4);
  } else {
    machine.fault = `breakpoint ${code}`;
  }
};

// One wish a line.
function answer(line) {
  const { execute, arguments: wanted } = JSON.parse(line);
  if (execute === 'screendump') {
    writeFileSync(wanted.filename, panel.picture());
  } else if (execute === 'input-send-event') {
    for (const { data } of wanted.events) {
      if (!(data.key.data in carrier.keys)) {
        return { error: { desc: `the carrier has no key ${data.key.data}` } };
      }
      panel.press(data.key.data, data.down);
    }
  } else if (execute === 'quit') {
    status = 0;
  } else if (execute !== 'qmp_capabilities') {
    return { error: { desc: `no such wish: ${execute}` } };
  }
  return { return: {} };
}
function serve(path) {
  const server = createServer((socket) => {
    let text = '';
    socket.on('error', () => {});
    socket.write('{"QMP":{}}\n');
    socket.on('data', (bytes) => {
      text += bytes;
      for (let end = text.indexOf('\n'); end >= 0; end = text.indexOf('\n')) {
        socket.write(`${JSON.stringify(answer(text.slice(0, end)))}\n`);
        text = text.slice(end + 1);
      }
    });
  });
  rmSync(path, { force: true });
  server.listen(path);
}

function end() {
  flush();
  if (status < kRefused) {
    chip.clock.tick(kLeftNs); // what DMA has begun still arrives
  }
  if (panel.complaint !== '') {
    tell(`the display refused: ${panel.complaint}`);
    status = status === 0 ? kRefused : status;
  }
  if (option('-shot') !== undefined) {
    writeFileSync(option('-shot'), panel.picture());
  }
  process.exit(status);
}

function go() {
  try {
    feed();
    machine.run(kInstructionsATime, () => status >= 0);
  } catch (error) {
    if (!(error instanceof LockUp)) {
      throw error;
    }
    flush();
    tell(error.message);
    status = kLockedUp;
  }
  flush();
  if (status >= 0) {
    end();
  } else {
    setImmediate(go);
  }
}

try {
  const place = boot(chip, image);
  if (options.includes('-v')) {
    tell(`started from ${place}`);
  }
} catch (error) {
  if (!(error instanceof Refusal)) {
    throw error;
  }
  tell(error.message);
  process.exit(kRefused);
}
const socket = option('-qmp');
if (socket !== undefined) {
  serve(socket.replace(/^unix:/, '').replace(/,.*/, ''));
}
go();
