// The modules as the page has them, under Node: test_modules.js MODULES THIMBLE
'use strict';
const {spawnSync} = require('child_process');
const fs = require('fs');
const path = require('path');
const zlib = require('zlib');
const {Machine, boardsOf, crc32, expandRows} = require('../../platform/web/machine.js');
const {Baker} = require('../../platform/web/baker.js');
const {Look} = require('../../platform/web/look.js');
const {Orbit} = require('../../platform/web/orbit.js');
const {crews} = require('./crew_cases.js');
const made = require('./files.js');
const {test, is, holds, end} = require('./check.js');

const [, , folder, thimble] = process.argv;
const work = 'build/web/tests';
const moduleOf = (name) => new WebAssembly.Module(fs.readFileSync(path.join(folder, `${name}.wasm`)));
const modules = {scene: moduleOf('scene'), plane: moduleOf('plane'), cases: moduleOf('cases'), bake: moduleOf('bake')};
const boards = boardsOf(modules.scene);
const boardOf = (name) => boards.find((board) => board.name === name);
const numbers = fs.readFileSync('tests/portable/result_crc.h', 'utf8');
const resultOf = (name) => new RegExp(`${name} = 0x([0-9A-F]+)`).exec(numbers)[1].toLowerCase();

function command(...words) {
  return spawnSync(thimble, words, {encoding: 'utf8'});
}
function read(file) {
  const bytes = fs.readFileSync(file);
  return bytes[0] === 0x1f && bytes[1] === 0x8b ? zlib.gunzipSync(bytes) : bytes;
}
const filesOf = (...paths) => paths.map((file) => ({name: path.basename(file), bytes: read(file)}));

// Runs an application; `each` is called before each frame, and ends it by returning false.
function run(module, options, each = () => false) {
  const machine = new Machine(module, options);
  for (let frame = 0; ;) {
    const state = machine.step();
    if (state === 'ended') return machine;
    if (state === 'frame' && each(machine, frame++) === false) machine.goOn = false;
  }
}

async function main() {
  await test('the table of boards is that of the command', () => {
    const listed = command('boards', '--quiet').stdout;
    holds('some boards', boards.length >= 7);
    for (const board of boards) holds(`the command lists ${board.name}`, listed.includes(board.name));
  });

  for (const board of boards) {
    for (const [app, crc] of [['selftest', 'kCoreCrc32'], ['golden', 'kCommonGoldenCrc32'], ['lit', 'kLitCrc32']]) {
      await test(`${app} on ${board.name}`, () => {
        const machine = run(modules.cases, {board, app, connected: false});
        is('status', machine.status, 0);
        holds('none failed', /^[1-9]\d* passed, 0 failed$/m.test(machine.output));
        is('the CRC of every board', /crc (\w+) of the \d+ cases that every board/.exec(machine.output)?.[1],
          resultOf(crc));
        const use = machine.use();
        holds('the arena was used', use.ram > 0 && use.ram <= use.ramLimit);
      });
    }
  }

  const golden = fs.readFileSync('tests/golden/particles_table.h', 'utf8').toLowerCase();
  for (const board of boards) {
    await test(`particles on ${board.name}`, () => {
      const machine = run(modules.plane, {board, app: 'particles'}, (self, frame) => frame < 3);
      const crc = /steps 400 crc (\w+)/.exec(machine.output)?.[1];
      holds(`the state ${crc} is golden`, golden.includes(`0x${crc}`));
      is('pictures', machine.display.pictures, 3);
    });
  }

  // What a display shows is what `thimble sim` shows, byte for byte; with slices of time and without.
  const shown = [['demo', 'demo', 'lm3s6965evb', 5], ['demo', 'demo', 'mps2-an500', 2], ['demo', 'castle', 'microbit', 2],
    ['demo', 'room', 'lm3s6965evb', 2], ['water', 'waves', 'mps2-an500', 3], ['demo', 'demo', 'raspi0', 1]];
  const sources = {castle: ['castle.vox'], room: ['room.scene'], waves: ['waves.scene'], demo: []};
  for (const [app, scene, name, frames] of shown) {
    await test(`${app} ${scene} on ${name}`, () => {
      const board = boardOf(name);
      const files = filesOf(...sources[scene].map((file) => `tools/gallery/scenes/${file}`));
      const made = new Baker(modules.bake, files).bake(files[0]?.name ?? scene, board);
      const stats = path.join(work, 'stats.json');
      const from = files.length === 0 ? scene : `tools/gallery/scenes/${files[0].name}`;
      const told = command('sim', from, '--board', name, '--app', app, '--display', 'none', '--frames', String(frames),
        '--quiet', '--stats', stats);
      is('status of sim', told.status, 0);
      const wanted = JSON.parse(fs.readFileSync(stats, 'utf8'));
      for (const slice of [undefined, 0]) {
        const machine = run(app === 'demo' ? modules.scene : modules.plane,
          {board, app, scene: made.baked, connected: false, slice_ms: slice}, (self, frame) => frame < frames);
        is('fault', machine.fault, undefined);
        is('status', machine.status, 0);
        is('the display', crc32(machine.display.bytes), wanted.display_crc32);
        const rgba = new Uint8Array(4 * board.width * board.height);
        expandRows(machine.display, 0, board.height, rgba);
        is('the canvas', crc32(rgba.filter((_, i) => i % 4 !== 3)), wanted.frame_crc32);
      }
    });
  }

  await test('a scene beyond the flash is refused', () => {
    let said = '';
    try {
      new Machine(modules.scene, {board: boardOf('stm32vldiscovery'), app: 'demo', scene: new Uint8Array(200000)});
    } catch (error) {
      said = error.message;
    }
    is('sentence', said, 'the scene takes 200000 bytes, and the flash of stm32vldiscovery has 131072');
  });
  await test('a damaged scene ends with a sentence', () => {
    const board = boardOf('lm3s6965evb');
    const {baked} = new Baker(modules.bake, []).bake('spheres', board);
    baked[100] ^= 1;
    const machine = run(modules.scene, {board, app: 'demo', scene: baked});
    is('status', machine.status, 1);
    holds('an error is told', /error: the scene is/.test(machine.output));
  });
  await test('the arena ends where the memory ends, and its front is guarded', () => {
    for (const board of boards) {
      const machine = new Machine(modules.scene, {board, app: 'demo', scene: new Uint8Array(0)});
      is(`arena of ${board.name}`, machine.x.arena_bytes(), board.ram - board.stack);
      const memory = new Uint8Array(machine.x.memory.buffer);
      holds('the guard is whole', machine.x.guard_is_whole());
      memory[memory.length - machine.x.arena_bytes() - 1] = 0;
      holds('a byte in front is noticed', !machine.x.guard_is_whole());
    }
  });
  // An image gets its RAM and not a byte more, and its flash to read.
  const misdeeds = [['a', undefined], ['f', 'it wrote to its flash'], ['l', 'it wrote to its flash'],
    ['p', 'it touched a byte past its RAM'], ['b', 'it wrote in front of its RAM'],
    ['s', 'its stack overflowed']];
  for (const board of boards) {
    for (const [key, fault] of misdeeds) {
      await test(`misdeed ${key} on ${board.name}`, () => {
        const machine = new Machine(modules.cases, {board, app: 'misdeeds', scene: new Uint8Array(1001).fill(7)});
        machine.step();
        machine.type(key);
        machine.step();
        is('fault', machine.fault, fault);
        is('status', machine.status, fault === undefined ? undefined : 97);
      });
    }
  }

  await bakes();
  await mistakes();
  await looks();
  await crews(modules, (scene, files, index = boardOf('raspi0').index) => new Baker(modules.bake, files).bake(scene, {index}),
    'room.scene', filesOf('tools/gallery/scenes/room.scene'));
  await end('modules under Node');
}

// The bytes of `thimble bake FILE --board NAME`, whatever reads them.
async function bakes() {
  const scenes = 'tools/gallery/scenes';
  write('ball.xyz', Array.from({length: 900}, (_, i) => [Math.cos(i) * Math.sin(i / 300), Math.sin(i) * Math.sin(i / 300),
    Math.cos(i / 300)].join(' ')).join('\n'));
  write('tent.obj', 'v 0 0 0\nv 1 0 0\nv 0.5 1e0 .5\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 2 4 3\n');
  write('tent.ply', 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n' +
    'element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0.25 0\n-0.5 1 3.0625e-1\n3 0 1 2\n');
  fs.writeFileSync(path.join(work, 'tent.obj.gz'), zlib.gzipSync(fs.readFileSync(path.join(work, 'tent.obj'))));
  const inflating = ['npy', 'npz', 'mts', 'schematic'].map((kind) => `${work}/made.${kind}`);
  for (const file of inflating) fs.writeFileSync(file, made[file.split('.').pop()](20));
  command('bake', 'spheres', '-o', path.join(work, 'spheres.oct'), '--quiet');
  const cases = [['demo'], ['spheres'], ['points:5000'], [`${scenes}/castle.vox`], [`${scenes}/fox.vox.gz`],
    [`${scenes}/room.scene`], [`${scenes}/house.scene`, `${scenes}/house.vox.gz`], [`${work}/ball.xyz`],
    [`${work}/tent.obj`], [`${work}/tent.obj.gz`], [`${work}/tent.ply`], [`${work}/spheres.oct`],
    ...inflating.map((file) => [file])];
  for (const files of cases) {
    for (const name of ['lm3s6965evb', 'raspi0']) {
      for (const more of [{}, {coarsen: true}]) {
        await test(`bake ${files[0]} for ${name}${more.coarsen ? ', coarsened' : ''}`, () => {
          if (fs.existsSync(files[0]) === false && files[0].includes('/')) throw new Error(`${files[0]} is not there`);
          const out = path.join(work, 'wanted.oct');
          fs.rmSync(out, {force: true});
          const told = command('bake', files[0], '--board', name, '-o', out, '--quiet', ...(more.coarsen ? ['--coarsen'] : []));
          let made = null;
          let said = '';
          try {
            made = new Baker(modules.bake, files[0].includes('/') ? filesOf(...files) : [])
              .bake(path.basename(files[0]), boardOf(name), more);
          } catch (error) {
            said = error.message;
          }
          if (told.status === 0) {
            is('error', said, '');
            holds('the bytes are equal', Buffer.compare(Buffer.from(made.baked), fs.readFileSync(out)) === 0);
          } else {
            holds(`the command's sentence "${told.stderr.trim()}" has "${said}"`, said !== '' && told.stderr.includes(said));
          }
        });
      }
    }
  }
}

// What is shown at rest is what the command renders, pixel by pixel where a ray hits; what stands behind is the board's.
async function looks() {
  for (const [scene, ...files] of [['castle.vox', 'castle.vox'], ['room.scene', 'room.scene']]) {
    await test(`${scene} to look around in is lit as by the command`, () => {
      const [width, height] = [160, 120];
      const {baked} = new Baker(modules.bake, filesOf(...files.map((file) => `tools/gallery/scenes/${file}`)))
        .bake(scene, boardOf('raspi0'));
      const look = new Look(modules.scene, baked, width, height);
      look.see(new Orbit(look.point(false), look.point(true), 1 << look.x.level()).camera());
      look.band('lit', 0, height);
      const mine = Buffer.from(look.rows(0, height));
      const oct = path.join(work, 'look.oct');
      const out = path.join(work, 'look.ppm');
      fs.writeFileSync(oct, baked);
      const told = command('render', oct, '--size', `${width}x${height}`, '--effects', 'auto', '-o', out, '--quiet');
      is('status', told.status, 0);
      const wanted = fs.readFileSync(out).subarray(-3 * width * height);
      const behind = mine.subarray(0, 3);
      let hits = 0;
      let others = 0;
      for (let i = 0; i < mine.length; i += 3) {
        if (scene !== 'room.scene' && mine.subarray(i, i + 3).equals(behind)) continue;
        ++hits;
        others += mine.subarray(i, i + 3).equals(wanted.subarray(i, i + 3)) ? 0 : 1;
      }
      holds(`${hits} pixels show the scene`, hits > 4000);
      is('pixels that are others', others, 0);
    });
  }
}

function write(name, text) {
  fs.writeFileSync(path.join(work, name), text);
}

// What a stranger drops, with the command's own sentences.
async function mistakes() {
  write('empty.vox', '');
  write('words.obj', 'v 0 0 zero\n');
  write('nan.xyz', '0 0 0\nnan 1 2\n');
  write('huge.xyz', '0 0 0\n1e999 1 2\n');
  write('strange.foo', 'what is this');
  write('lonely.scene', 'model nowhere.vox at 0,0,0\n');
  const vox = fs.readFileSync('tools/gallery/scenes/castle.vox');
  fs.writeFileSync(path.join(work, 'cut.vox'), vox.subarray(0, 3000));
  for (const name of ['empty.vox', 'words.obj', 'nan.xyz', 'huge.xyz', 'strange.foo', 'cut.vox']) {
    await test(`${name} is refused as by the command`, () => {
      const file = path.join(work, name);
      const told = command('bake', file, '-o', path.join(work, 'never.oct'), '--quiet');
      let said = '';
      try {
        new Baker(modules.bake, filesOf(file)).bake(name, boardOf('raspi0'));
      } catch (error) {
        said = error.message;
      }
      is('status of the command', told.status, 1);
      holds(`the command's "${told.stderr.trim()}" ends with "${said}"`, said !== '' && told.stderr.trim().endsWith(said));
    });
  }
  // What is deflated inside a file, and damaged there.
  for (const [kind, wanted] of [['mts', /^the nodes: the deflated data is damaged or truncated$/],
    ['npz', /^the member 'ball.npy'(: the deflated data is damaged or truncated| has \d+ bytes, not the 8128 of the directory)$/]]) {
    await test(`a damaged .${kind} is refused in a sentence`, () => {
      const bytes = made[kind](20);
      const middle = kind === 'mts' ? bytes.length - 40 : 190;
      for (const cut of [(b) => b.fill(0xee, middle, kind === 'mts' ? middle + 30 : 310), (b) => (kind === 'mts' ? b.subarray(0, -40) : b.fill(0xee, 180, 330))]) {
        let said = '';
        try {
          new Baker(modules.bake, [{name: `cut.${kind}`, bytes: cut(Buffer.from(bytes))}]).bake(`cut.${kind}`, boardOf('raspi0'));
        } catch (error) {
          said = error.message;
        }
        holds(`"${said}" says that it is damaged`, wanted.test(said));
      }
    });
  }
  await test('what is not read is named, and what reads it', () => {
    let said = '';
    try {
      new Baker(modules.bake, [{name: 'a.glb', bytes: Buffer.from('glTF\x02\0\0\0\x0c\0\0\0', 'latin1')}]).bake('a.glb', boardOf('raspi0'));
    } catch (error) {
      said = error.message;
    }
    holds(`"${said}" names what is read`, /^is a glTF scene, which takes the thimble command; this page reads \.vox, .*\.npy, .*\.kvx$/.test(said));
    holds('and not what is not', !/gl(b|tf),/.test(said));
  });
  await test('a model that was not dropped is asked for', () => {
    let said = '';
    try {
      const house = filesOf('tools/gallery/scenes/house.scene');
      new Baker(modules.bake, house).bake('house.scene', boardOf('raspi0'));
    } catch (error) {
      said = error.message;
    }
    is('sentence', said, 'is not here: drop it together with the file that names it');
  });
  for (const board of boards) {
    await test(`what does not fit the flash of ${board.name} is said as by the command, with the depth that would`, () => {
      const points = new Baker(modules.bake, []);
      let said = '';
      try {
        points.bake('points:60000', board);
      } catch (error) {
        said = error.message;
      }
      const told = command('bake', 'points:60000', '--board', board.name, '-o', path.join(work, 'never.oct'), '--quiet');
      is('fits', said === '', told.status === 0);
      if (said === '') return;
      const smaller = points.smaller('points:60000', board, 10);
      is('the command', told.stderr.trim(), `thimble: points:60000: ${said}; --depth ${smaller.level} fits with ` +
        `${smaller.bytes.toLocaleString('en')} bytes, and --coarsen makes the finest tree that does`);
    });
  }
  await test('a depth that fits is found', () => {
    const board = boardOf('stm32vldiscovery');
    const baker = new Baker(modules.bake, filesOf('tools/gallery/scenes/house.scene', 'tools/gallery/scenes/house.vox.gz'));
    const points = new Baker(modules.bake, []);
    let said = '';
    try {
      points.bake('points:200000', board);
    } catch (error) {
      said = error.message;
    }
    holds(`"${said}" says how many bytes`, /^takes [\d,]+ bytes at depth 10, .* too many$/.test(said));
    const smaller = points.smaller('points:200000', board, 10);
    const told = command('bake', 'points:200000', '--board', board.name, '-o', path.join(work, 'never.oct'), '--quiet');
    holds('the command advises the same', told.stderr.includes(`--depth ${smaller?.level} fits with`));
    holds('the house is baked', baker.bake('house.scene', boardOf('raspi0')).voxels > 0);
  });
}

main();
