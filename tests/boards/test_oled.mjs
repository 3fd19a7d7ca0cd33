// The model of the SSD1306 on I2C refuses what the controller could not take, and shows what it was sent
// (platform/emulators/rp2040js).       node test_oled.mjs PATH_OF_oled.mjs
import assert from 'node:assert/strict';
import { pathToFileURL } from 'node:url';

const { Oled } = await import(pathToFileURL(process.argv[2]).href);

// A chip of what the module asks for: pins, one I2C, and a clock whose alarms ring at once.
function module(counts = {}) {
  const gpio = Array.from({ length: 30 }, () => ({ functionSelect: 3, setInputValue() {} }));
  const answers = [];
  const i2c = {
    sclHighPeriod: 120, sclLowPeriod: 198, spikelen: 7, completeStart() {}, completeStop() {},
    completeConnect: (heard) => answers.push(heard), completeWrite: (taken) => answers.push(taken), ...counts,
  };
  const clock = { createAlarm: (rings) => ({ schedule: () => rings() }) };
  const made = new Oled({ gpio, i2c: [i2c], clock, clkSys: 133e6 }, { keys: {} });
  // Whether the address and each byte are acknowledged.
  const send = (bytes, address = 0x3c, isRead = false) => {
    answers.length = 0;
    i2c.onStart();
    i2c.onConnect(address, isRead);
    bytes.forEach((byte) => i2c.onWriteByte(byte));
    i2c.onStop();
    return answers.every((answer) => answer);
  };
  return { made, gpio, send };
}
const kStart = [0x00, 0x8d, 0x14, 0xa8, 63, 0xd3, 0, 0xda, 0x12, 0x20, 0, 0xa1, 0xc8, 0xaf];

// Nobody else's address, no reading, and nothing over pins that are not I2C's.
assert.equal(module().send([0x00, 0xe3]), true);
assert.equal(module().send([0x00, 0xe3], 0x3d), false);
assert.equal(module().send([0x00, 0xe3], 0x3c, true), false);
for (const pin of [4, 5]) {
  const { gpio, send } = module();
  gpio[pin].functionSelect = 5;
  assert.equal(send([0x00, 0xe3]), false, `pin ${pin}`);
}

// Transfers that are refused, and why.
const refused = (why, ...transfers) => {
  const { made, send } = module();
  assert.equal(transfers.map((bytes) => send(bytes)).at(-1), false, `${why}: ${transfers}`);
  assert.match(made.complaint, why);
};
refused(/control byte 0x1/, [0x01, 0xe3]);
for (const bytes of [[0x23], [0x30], [0x87], [0xa2], [0xb8], [0xe2], [0xff], [0x20, 3], [0x21, 5, 4], [0x21, 0, 128],
  [0x22, 0, 8], [0x8d, 0x15], [0xa8, 14], [0xd3, 64], [0xd9, 0x0f], [0xd9, 0xf0], [0xda, 0x10], [0xdb, 0x80]]) {
  refused(new RegExp(`command 0x${bytes[0].toString(16)} with`), [0x00, ...bytes]);
}
// On, with something that this glass wants otherwise.
for (const bytes of [[0x8d, 0x10], [0xa8, 31], [0xd3, 1], [0xda, 0x02], [0x2f]]) {
  refused(/command 0xaf/, kStart.slice(0, -1), [0x00, ...bytes], [0x00, 0xaf]);
}
{
  const { made, send } = module({ sclLowPeriod: 197 });
  assert.equal(send([0x00, 0xe3]), false);
  assert.match(made.complaint, /a bit of 249\d ns on I2C, 2500 at least/);
}

// Pixels that are lit, `x,y`.
const lit = (made) => {
  const picture = made.picture();
  const head = 'P6\n128 64\n255\n';
  assert.equal(picture.subarray(0, head.length).toString(), head);
  assert.equal(picture.length, head.length + 3 * 128 * 64);
  const found = [];
  for (let at = 0; at < 128 * 64; ++at) {
    if (picture[head.length + 3 * at] === 255) {
      found.push(`${at % 128},${Math.floor(at / 128)}`);
    }
  }
  return found.join(' ');
};
// What `commands` show after a byte in each of the four corners of a window and nothing elsewhere.
const shown = (...commands) => {
  const { made, send } = module();
  made.memory.fill(0);
  assert.equal(send(kStart), true);
  assert.ok(send([0x00, ...commands, 0x21, 2, 3, 0x22, 1, 2]), `${commands}`);
  assert.ok(send([0x40, 0x01, 0x02, 0x04, 0x80]));
  return lit(made);
};
assert.equal(shown(), '2,8 3,9 2,18 3,23');
assert.equal(shown(0x20, 1), '2,8 3,10 2,17 3,23'); // down, then to the right
assert.equal(shown(0xa0), '125,8 124,9 125,18 124,23'.split(' ').sort((a, b) => a.split(',')[1] - b.split(',')[1]).join(' '));
assert.equal(shown(0xc0), '3,40 2,45 3,54 2,55');
assert.equal(shown(0x48), '2,0 3,1 2,10 3,15'); // the first line is 8
assert.equal(shown(0xae), '');
assert.equal(shown(0xa7).split(' ').length, 128 * 64 - 4);
assert.equal(shown(0xa5).split(' ').length, 128 * 64);
// In pages: page 3, column 82; behind the last column comes the first of the same page. Control bytes for one byte each.
{
  const { made, send } = module();
  made.memory.fill(0);
  assert.ok(send([...kStart, 0x21, 80, 82])); // a window, which this mode has not
  assert.ok(send([0x80, 0x20, 0x80, 0x02, 0x80, 0xb3, 0x80, 0x15, 0x80, 0x02, 0xc0, 0x01, 0x40, 0x02]));
  assert.equal(lit(made), '82,24 83,25');
  assert.ok(send([0x00, 0x17, 0x0f]));
  assert.ok(send([0x40, 0x04, 0x08]));
  assert.equal(lit(made), '82,24 83,25 127,26 0,27');
}
// What was there when the power came on is something.
assert.notEqual(new Set(module().made.memory).has(0), true);
console.log('oled: refuses what an SSD1306 could not take, shows what it was sent');
