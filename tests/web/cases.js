// The core's own cases (cases.wasm) on every board of the table, wherever WebAssembly runs: what each application says
// is compared with the CRCs of all boards.
'use strict';
const fs = require('fs');
const {test, is, holds} = require('./check.js');

const numbers = fs.readFileSync('tests/portable/result_crc.h', 'utf8');
const resultOf = (name) => new RegExp(`${name} = 0x([0-9A-F]+)`).exec(numbers)[1].toLowerCase();
const CASES = {selftest: 'kCoreCrc32', golden: 'kCommonGoldenCrc32', lit: 'kLitCrc32', formats: 'kPanelCrc32',
  worlds: 'kWorldCrc32', bricks: 'kCommonBrickCrc32', map_light: 'kMapLightCrc32'};
const FORMATS_BYTES = 4608;  // kCommonArenaBytes (tests/portable/groups.h): 8 KiB less a stack that draws are not enough

// All cases on the board with the least RAM and on the one with the most: of a board they know only that.
// `run(board, app)`: the status, the output and the RAM used of an application that runs until it ends.
async function judgeCases(boards, run) {
  const rooms = [...boards].sort((a, b) => (a.ram - a.stack) - (b.ram - b.stack));
  for (const board of [rooms[0], rooms[rooms.length - 1]]) {
    for (const [app, crc] of Object.entries(CASES)) {
      if (app === 'formats' && board.ram - board.stack < FORMATS_BYTES) continue;
      await test(`${app} on ${board.name}`, async () => {
        const {status, output, ram, ramLimit} = await run(board, app);
        is('status', status, 0);
        holds('none failed', /^[1-9]\d* passed, 0 failed$/m.test(output));
        is('the CRC of every board', /crc (\w+) of the \d+ cases that every board/.exec(output)?.[1], resultOf(crc));
        holds('the arena was used', ram > 0 && ram <= ramLimit);
      });
    }
  }
}

module.exports = {judgeCases};
