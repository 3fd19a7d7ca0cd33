// The modules as the page has them, under Node: test_modules.js MODULES THIMBLE
'use strict';
const {spawnSync} = require('child_process');
const fs = require('fs');
const path = require('path');
const zlib = require('zlib');
const {Display, Machine, Table, crc32} = require('../../platform/web/machine.js');
const {Baker} = require('../../platform/web/baker.js');
const {Look, nameOf} = require('../../platform/web/look.js');
const {unlzma} = require('../../platform/web/lzma.js');
const {SHELF} = require('../../platform/web/shelf.js');
const {Orbit} = require('../../platform/web/orbit.js');
const {judgeCases} = require('./cases.js');
const {crews} = require('./crew_cases.js');
const made = require('./files.js');
const {test, is, holds, end} = require('./check.js');

const [, , folder, thimble] = process.argv;
const work = 'build/web/tests';
const moduleOf = (name) => new WebAssembly.Module(fs.readFileSync(path.join(folder, `${name}.wasm`)));
const modules = {scene: moduleOf('scene'), plane: moduleOf('plane'), cases: moduleOf('cases'), bake: moduleOf('bake')};
const table = new Table(modules.plane);
const {boards} = table;
const boardOf = (name) => boards.find((board) => board.name === name);

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

  await judgeCases(boards, (board, app) => {
    const machine = run(modules.cases, {board, app, connected: false});
    return {...machine, ...machine.use()};
  });

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
  const shown = [['demo', 'demo', 'lm3s6965evb', 5], ['demo', 'castle', 'lm3s6965evb', 2], ['demo', 'room', 'lm3s6965evb', 2],
    ['water', 'waves', 'mps2-an500', 3], ['demo', 'demo', 'mps2-an500', 2],
    ...boards.map(({name}) => ['demo', 'spheres', name, 2]), ['demo', 'spheres,depth=9', 'raspi0', 3]];
  const sources = {castle: ['castle.vox'], room: ['room.scene'], waves: ['waves.scene'], demo: [], spheres: [], 'spheres,depth=9': []};
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
        table.expand(machine.display, 0, board.height, rgba);
        is('the canvas', crc32(rgba.filter((_, i) => i % 4 !== 3)), wanted.frame_crc32);
        const {ram, ramLimit} = machine.use();
        is('the RAM that there is', ramLimit, wanted.budget_bytes);
        // An address takes 4 bytes here, as on the boards, and 8 on a host.
        holds(`the RAM used, ${ram}, is about that of sim, ${wanted.high_water_bytes}`,
          ram <= wanted.high_water_bytes && ram > 0.8 * wanted.high_water_bytes - 2048);
      }
    });
  }

  await test('the pixels of every format are the core\'s, and one that there is not is an error', () => {
    const [width, height] = [16, 9];
    const rgba = new Uint8Array(4 * width * height);
    const header = fs.readFileSync('include/thimble/picture/pixel.h', 'utf8');
    const bits = header.match(/kFormatBits\[kPixelFormats\] = \{([\d, ]+)\}/)[1].split(',').map(Number);
    const shows = (format, rows_together) => {
      const display = new Display({name: 'a board', format, width, height, row_bytes: width * (bits[format] ?? 24) / 8, rows_together});
      display.bytes.set(display.bytes.map((_, i) => 37 * i));
      rgba.fill(0);
      table.expand(display, 0, height, rgba);
      const whole = rgba.slice();
      table.expand(display, 3, 5, rgba);
      holds(`rows alone, of format ${format}`, Buffer.from(rgba).equals(Buffer.from(whole)));
      holds(`format ${format} shows something`, new Set(rgba).size > 1);
    };
    const names = [...header.split('enum class PixelFormat')[1].split('}')[0]
      .matchAll(/k\w+/g)].map(String);
    is('formats that have bits', bits.length, names.length);
    names.forEach((name, format) => shows(format, name === 'kMono1Pages' ? 8 : 1));
    let said = '';
    try {
      shows(names.length, 1);
    } catch (error) {
      said = error.message;
    }
    is('one too many', said, `this page knows no pixels of format ${names.length}, which a board has`);
  });
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
    holds('an error is printed', /error: the scene is/.test(machine.output));
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
  await images();
  await mistakes();
  await looks();
  await plays();
  await crews(modules, (scene, files, index = boardOf('raspi0').index) => {
    const baker = new Baker(modules.bake, files);
    return {...baker.bake(scene, {index}), baker};
  }, 'room.scene', filesOf('tools/gallery/scenes/room.scene'));
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
  fs.mkdirSync(`${work}/sub`, {recursive: true});
  fs.writeFileSync(`${work}/tent.glb`, made.glb());
  fs.writeFileSync(`${work}/tent.bin`, made.NUMBERS);
  fs.writeFileSync(`${work}/sub/tent.png`, made.PICTURE);
  write('tent.gltf', JSON.stringify(made.gltf()));
  write('shop.mtl', 'newmtl cloth\nmap_Kd sub/tent.png\n');
  write('shop.obj', 'mtllib shop.mtl\nv 0 0 0\nv 4 0 0\nv 2 3 1\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl cloth\nf 1/1 2/2 3/3\n');
  const cases = [[`${work}/tent.glb`], [`${work}/tent.gltf`, `${work}/tent.bin`, `${work}/sub/tent.png`],
    [`${work}/shop.obj`, `${work}/shop.mtl`, `${work}/sub/tent.png`], ['demo'], ['spheres'], ['points:5000'], [`${scenes}/castle.vox`], [`${scenes}/fox.vox.gz`],
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

// What is downloaded for a board is what `thimble image` writes of the same programs, byte for byte, sentences too.
async function images() {
  const kept = 'build/images';
  const scenes = ['castle.vox', 'fox.vox.gz', 'room.scene', 'waves.scene'].map((name) => `tools/gallery/scenes/${name}`);
  const on = boards.filter(({name}) => fs.existsSync(`${kept}/${name}-demo-sun.elf.gz`) && name in SHELF);
  if (on.length === 0) console.log('images: skipped: there are no programs; make images builds them');
  for (const board of on) {
    const programs = Object.fromEntries(['demo', 'water'].map((app) =>
      [app, ['plain', 'sun', 'all'].map((set) => `${kept}/${board.name}-${app}-${set}.elf.gz`).filter(fs.existsSync).map(read)]));
    for (const scene of [...scenes, 'demo', 'points:400000']) {
      await test(`the file of ${path.basename(scene)} for ${board.name} is that of the command`, () => {
        const file = path.join(work, `wanted.${board.ending}`);
        const told = command('image', scene, '--board', board.name, '--images', kept, '-o', file, '--quiet',
          ...scene.includes('waves') && programs.water.length !== 0 ? ['--app', 'water'] : []);
        const baker = new Baker(modules.bake, scene.includes('/') ? filesOf(scene) : []);
        let said = '';
        try {
          baker.bake(path.basename(scene), board, {programs});
          holds('the bytes are equal', told.status === 0 && fs.readFileSync(file).equals(Buffer.from(baker.image(board))));
        } catch (error) {
          if (told.status === 0) throw error;
          said = error.message;
        }
        holds(`the command's "${told.stderr.trim()}" has "${said}"`, told.stderr.includes(said));
      });
    }
  }
  if (on.some(({name}) => name === 'pico')) {
    await test('a program of another board is refused in a sentence', () => {
      let said = '';
      try {
        new Baker(modules.bake, []).bake('demo', boardOf('gba'), {programs: {demo: [read(`${kept}/pico-demo-sun.elf.gz`)]}});
      } catch (error) {
        said = error.message;
      }
      is('sentence', said, 'is an image for another board');
    });
  }
  await test('what the page unpacks is what xz packed, of every kind of bytes', () => {
    for (const bytes of [fs.readFileSync(path.join(folder, 'plane.wasm')), Buffer.alloc(70000, 7), Buffer.from(boards.map(({name}) => name).join()), Buffer.from('a'),
      Buffer.from(Array.from({length: 40000}, (_, i) => Math.imul(i ^ i >> 7, 0x9e3779b1) >>> 24))]) {
      for (const coding of ['lc=3,lp=0,pb=0', 'lc=2,lp=1,pb=1', 'lc=0,lp=2,pb=2']) {
        const packed = spawnSync('xz', ['-c', '--format=lzma', `--lzma1=preset=9e,${coding}`], {input: bytes, maxBuffer: 2 ** 26}).stdout;
        packed.writeUInt32LE(bytes.length, 5);
        holds(`${bytes.length} bytes, ${coding}`, bytes.equals(Buffer.from(unlzma(packed))));
      }
    }
  });
}

// A scene to look around in, from the scene's own view; `file`: what the command calls it.
function opened(scene, width, height) {
  const file = [scene, `tools/gallery/scenes/${scene}`].find((name) => fs.existsSync(name));
  const baker = new Baker(modules.bake, file === undefined ? [] : filesOf(file, ...modelsOf(file)));
  const {baked} = baker.bake(path.basename(scene), boardOf('raspi0'), {size: [width, height]});
  const look = new Look(modules.scene, baked, width, height);
  const orbit = new Orbit(look.point(false), look.point(true), 1 << look.x.level(), look.isParallel());
  return {look, orbit, baker, width, height, file: file ?? scene};
}
// The models of a .scene that lie beside it.
function modelsOf(file) {
  if (!file.endsWith('.scene')) return [];
  return [...fs.readFileSync(file, 'utf8').matchAll(/^model (\S+)/gm)].map(([, name]) => path.join(path.dirname(file), name));
}
// The picture at rest from where the orbit stands.
function drawn({look, orbit, baker, width, height}, kind) {
  const camera = orbit.camera();
  holds('there is such a view', look.see(camera));
  const {block, isStars} = baker.look(camera, width, height, 320);
  if (isStars) return Buffer.from(baker.stars(width, height));
  look.take(block);
  look.band(kind, 0, height, look.expose());
  return Buffer.from(look.rows(0, height));
}
// What the command makes of the same file, as RGB.
function rendered({file, width, height}, ...words) {
  const out = path.join(work, 'look.ppm');
  const told = command('render', file, '--size', `${width}x${height}`, '-o', out, '--quiet', ...words);
  is(`what render says of ${words.join(' ')}`, told.stderr, '');
  return fs.readFileSync(out).subarray(-3 * width * height);
}
function lensOf({look, orbit}) {
  const {eye, target, zoom} = orbit.camera();
  const point = (q8) => q8.map((x) => x / 256).join();
  return ['--eye', point(eye), '--target', point(target), ...look.lens(zoom).split(' ')];
}
function pixelsThatDiffer(a, b) {
  let count = 0;
  for (let i = 0; i < a.length; i += 3) count += a.subarray(i, i + 3).equals(b.subarray(i, i + 3)) ? 0 : 1;
  return count;
}

// What is shown at rest is what `thimble render` makes of the same file without a word, byte for byte.
async function looks() {
  const [width, height] = [160, 120];
  write('glass.scene', 'depth 5\ncamera eye 16 -30 24 target 16 16 10 fov 40\nsun toward 1 -2 3\nsky zenith 40 90 200\n' +
    'fog color 200 200 210 density 0.01\nmaterial floor color 180 150 120\nmaterial gold metal color 220 180 60\n' +
    'material clear glass color 230 250 240\nbox floor from 0 0 0 to 32 32 2\nball gold at 10 16 8 radius 6\n' +
    'ball clear at 22 14 8 radius 6\n');
  write('mesh.obj', 'v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 2 2 3\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 4 3 2 1\n');
  write('parallel.scene', fs.readFileSync('tools/gallery/scenes/room.scene', 'utf8').replace(/ fov 62/, ' span 77'));
  const scenes = ['castle.vox', 'room.scene', 'waves.scene', 'house.scene', 'fox.vox.gz', 'demo', 'points:2000', 'spheres',
    path.join(work, 'tent.glb'), path.join(work, 'glass.scene'), path.join(work, 'mesh.obj'), path.join(work, 'parallel.scene')];
  for (const scene of scenes) {
    await test(`${path.basename(scene)} to look around in is what the command renders, from its own view and another`, () => {
      const shown = opened(scene, 96, 72);
      const mine = drawn(shown, 'fine');
      holds('it shows something', new Set(mine).size > 50);
      is('pixels that are others', pixelsThatDiffer(mine, rendered(shown)), 0);
      shown.orbit.turn(0.7, 0.15);
      shown.orbit.approach(0.8);
      is('pixels that are others, turned', pixelsThatDiffer(drawn(shown, 'fine'), rendered(shown, ...lensOf(shown))), 0);
    });
  }
  await test('a view as large as the page, whose direction 1/256 voxel says too coarsely, is what the command renders', () => {
    const shown = opened('castle.vox', 640, 480);
    shown.orbit.turn(0.5, 0.1);
    shown.orbit.approach(0.9);
    is('pixels that are others', pixelsThatDiffer(drawn(shown, 'fine'), rendered(shown, ...lensOf(shown))), 0);
  });
  await test('coarse pictures have blocks of four by four pixels, as bright as others', () => {
    const shown = opened('castle.vox', width, height);
    const [coarse, lit] = [drawn(shown, 'coarse'), drawn(shown, 'lit')];
    let wrong = 0;
    const stride = 3 * width;
    const at = (px, py) => py * stride + 3 * px;
    for (let y = 0; y < height; ++y) {
      for (let x = 0; x < width; ++x) {
        const [cx, cy] = [x - x % 4, y - y % 4];
        wrong += coarse.compare(coarse, at(cx, cy), at(cx, cy) + 3, at(x, y), at(x, y) + 3) === 0 ? 0 : 1;
      }
    }
    is('pixels that are not those of their block', wrong, 0);
    holds('they are about as bright', Math.abs(mean(coarse) - mean(lit)) < 4);
    holds('and not the lit ones', pixelsThatDiffer(coarse, lit) > 1000);
  });
  await test('fast pictures are about as bright as the finished ones, and have what stands behind', () => {
    for (const scene of ['castle.vox', 'waves.scene', 'fox.vox.gz']) {
      const shown = opened(scene, width, height);
      const fine = drawn(shown, 'fine');
      shown.look.fast(1);
      const fast = Buffer.from(shown.look.rows(0, height));
      const far = Math.abs(mean(fast) - mean(fine));
      holds(`${scene}: ${mean(fast).toFixed(0)} is near ${mean(fine).toFixed(0)}`, far < 40);
      if (scene === 'castle.vox') is('the corner above', fast.readUIntBE(0, 3), fine.readUIntBE(0, 3));
    }
  });
  for (const scene of ['castle.vox', 'room.scene']) {
    await test(`${scene}: what is under the pointer is what the command's ray hits`, () => {
      const {look, orbit, baker} = opened(scene, width, height);
      look.see(orbit.camera());
      const csv = path.join(work, 'look_hits.csv');
      const oct = path.join(work, 'look.oct');
      fs.writeFileSync(oct, baker.bake(scene, boardOf('raspi0'), {size: [width, height]}).baked);
      rendered({file: oct, width, height}, '--effects', 'auto', '--hits', csv);
      const rows = fs.readFileSync(csv, 'utf8').trim().split('\n').slice(1).map((row) => row.split(',').map(Number));
      let wrong = 0;
      let hits = 0;
      for (const [x, y, isHit, vx, vy, vz, t, axis, , ...ray] of rows) {
        const picked = look.pick(x, y);
        hits += isHit;
        if (isHit === 0 || picked === null) {
          wrong += isHit === 0 && picked === null ? 0 : 1;
          continue;
        }
        const far = picked.point.some((at, i) => Math.abs(at - ray[i] / 256 - t * ray[3 + i]) > 1 / 128);
        const face = 2 * axis + (ray[3 + axis] < 0 ? 1 : 0);
        wrong += far || picked.voxel.join() !== [vx, vy, vz].join() || picked.face !== face ? 1 : 0;
      }
      holds(`${hits} pixels hit something`, hits > 4000);
      is('pixels that are others', wrong, 0);
      is('beyond the picture', [look.pick(-1, 0), look.pick(0, height), look.pick(width, 0)].join(), ',,');
    });
  }
  await test('what is picked is named as on the desktop', () => {
    const picked = {voxel: [12, 3, 40], face: 5, material: 7, color: 0x0a522d, kind: 2};
    is('it', nameOf(picked), 'voxel 12,3,40: its top face (+z), material 7, #0a522d glass');
    is('inside', nameOf({...picked, face: -1, kind: 0}), 'voxel 12,3,40: the eye is in it, material 7, #0a522d');
  });
  for (const [kind, is_] of [['', ''], ['metal ', ' metal'], ['glass ', ' glass'], ['emit ', ' that glows']]) {
    await test(`a ${kind}box is named by its material and colour`, () => {
      write('named.scene', 'depth 4\ncamera eye 8 -20 8 target 8 8 8 fov 35\nambient color 255 255 255 brightness 1\n' +
        `material first color 1 2 3\nmaterial second ${kind}color 10 160 45\n` +
        'box first from 0 15 0 to 16 16 16\nbox second from 4 4 4 to 12 12 12\n');
      const {look, orbit} = opened(path.join(work, 'named.scene'), width, height);
      look.see(orbit.camera());
      const materials = [[80, 60], [50, 20]].map(([x, y]) => {
        const said = nameOf(look.pick(x, y));
        return said.replace(/^voxel \d+,(4|15),\d+: its front face \(-y\), material \d+, /, '');
      });
      is('they', materials.join('|'), `#0aa02d${is_}|#010203`);
      holds('each has its own', look.pick(80, 60).material !== look.pick(50, 20).material);
    });
  }
  // From its own lens, framed by its hull. The orbit keeps five digits, the camera 1/256 voxel.
  for (const scene of ['room.scene', 'castle.vox', path.join(work, 'parallel.scene')]) {
    for (const [key, name] of ['front', 'back', 'left', 'right', 'top', 'iso'].entries()) {
      await test(`key ${key + 1} shows ${path.basename(scene)} as --view ${name}`, () => {
        const shown = opened(scene, 80, 60);
        const frame = shown.baker.frame(key + 1, 80, 60);
        shown.orbit.show(frame);
        const {eye, target, zoom} = shown.orbit.camera();
        const off = [...eye, ...target].map((x, i) => Math.abs(x - [...frame.eye, ...frame.target][i]));
        if (!shown.look.isParallel()) is('1/256 voxels off', Math.max(...off) <= 1, true);
        else is('how wide it is', Math.abs(zoom - frame.zoom) <= 1, true);
        const own = shown.look.isParallel() ? ['--projection', 'orthographic'] : ['--fov', shown.look.lens(256).split(' ')[1]];
        const wanted = rendered(shown, '--view', name, ...own);
        const first = drawn(shown, 'fine');
        const far = [...first].reduce((sum, x, i) => sum + Math.abs(x - wanted[i]), 0) / first.length;
        holds(`the mean difference ${far.toFixed(2)} is small`, far < (shown.look.isParallel() ? 3 : 1.5));
        const camera = JSON.stringify(shown.orbit.camera());
        shown.orbit.take(shown.orbit.text());
        is('the camera of a link', JSON.stringify(shown.orbit.camera()), camera);
      });
    }
  }
  await test('hands lead a view as on the desktop', () => {
    const {look, orbit, baker} = opened('castle.vox', width, height);
    const show = (key) => orbit.show(baker.frame(key, width, height));
    const eye = () => orbit.camera().eye.map((q8) => q8 / 256);
    const near = (what, a, b) => holds(`${what}: ${a} is ${b}`, a.every((x, i) => Math.abs(x - b[i]) < 0.02));
    show(1);
    const [x, y, z] = eye();
    const speed = 0.7 * orbit.distance;
    for (const [way, to] of [[[0, 0, 1], [0, speed, 0]], [[1, 0, 0], [speed, 0, 0]], [[0, 1, 0], [0, 0, speed]]]) {
      orbit.fly(...way);
      near(`a second of flight ${way}`, eye(), [x + to[0], y + to[1], z + to[2]]);
      orbit.fly(...way.map((part) => -part));
      near('and back', eye(), [x, y, z]);
    }
    const point = [20.5, 30.25, 10];
    orbit.lookAt(point);
    near('what is looked at', orbit.target, point);
    near('the eye stays', eye(), [x, y, z]);
    orbit.turn(0.5, 0.25);
    near('and is turned around', orbit.target, point);
    const high = new Orbit([0, 0, 0], [256, 0, 0], 1024);
    holds('there is a link', high.take('-1.5708,1.5708,3000,512,512,512'));
    is('straight down is so from far away', high.camera().eye.join(), '131072,131072,899072');
    for (const [kind, act] of [['away', () => orbit.approach(1e9)], ['sideways', () => orbit.move(1e9, 1e9)],
      ['onward', () => orbit.fly(0, 0, 1e9)]]) {
      for (const key of [1, 2, 3, 4, 5, 6]) {
        show(key);
        act();
        holds(`far ${kind} from view ${key} there is a picture`, look.see(orbit.camera()));
      }
    }
  });
}
// What moves by itself: frames of an animation are the command's; rain leaves what is finished as it is.
async function plays() {
  const [width, height] = [96, 72];
  await test('frames of an animation, read ahead of their turn, are what the command bakes and renders', () => {
    const file = path.join(work, 'film.vox');
    fs.writeFileSync(file, made.vox(16, 3));
    const baker = new Baker(modules.bake, filesOf(file));
    const board = boardOf('raspi0');
    const first = baker.bake('film.vox', board, {size: [width, height]});
    is('frames', first.frames, 3);
    const taken = baker.x.memory.buffer.byteLength;
    const look = new Look(modules.scene, first.baked, width, height);
    const held = new Orbit(look.point(false), look.point(true), 1 << look.x.level());
    const shown = {look, baker, width, height, file, orbit: held};
    // Before it is turned a frame stands as the page frames it, alone; the command frames a film by all of its frames.
    held.turn(0.3, 0.1);
    const before = drawn(shown, 'fine');
    is('pixels of the first', pixelsThatDiffer(before, rendered(shown, ...lensOf(shown))), 0);
    for (const frame of [1, 2, 0]) {
      const words = ['--frame', String(frame)];
      const next = baker.bakeAhead('film.vox', board, {size: [width, height], frame}, [held.camera(), width, height, 320]);
      is('the frame before it is turn', pixelsThatDiffer(drawn(shown, 'fine'), shown.last ?? before), 0);
      const out = path.join(work, 'wanted.oct');
      command('bake', file, '--board', 'raspi0', '-o', out, '--quiet', ...words);
      const turned = new Baker(modules.bake, filesOf(file)).bake('film.vox', board, {frame}).baked;  // for the board
      holds(`frame ${frame} is baked as by the command`, fs.readFileSync(out).equals(Buffer.from(turned)));
      baker.turn();
      look.open(next.baked);
      look.take(next.seen.block);
      look.band('fine', 0, height, look.expose());
      shown.last = Buffer.from(look.rows(0, height));
      is(`pixels of frame ${frame}`, pixelsThatDiffer(shown.last, rendered(shown, ...words, ...lensOf(shown))), 0);
    }
    let said = '';
    try {
      baker.bakeAhead('film.vox', board, {size: [width, height], frame: 3}, []);
    } catch (error) {
      said = error.message;
    }
    is('beyond the last', said, 'there is no frame 3; the file has frames 0 to 2');
    baker.bakeAhead('film.vox', board, {size: [width, height], frame: 2}, [held.camera(), width, height, 320]);
    baker.turn();
    is('others come after it', baker.frame(1, width, height).eye.length, 3);
    baker.bakeAhead('film.vox', board, {size: [width, height], frame: 1}, [held.camera(), width, height, 320]);
    baker.bakeAhead('film.vox', board, {size: [width, height], frame: 0}, [held.camera(), width, height, 320]);
    holds('memory is taken once', baker.beside.memory.buffer.byteLength < 1.1 * taken);
  });
  write('pond.scene', 'depth 4\ncamera eye 8 -14 16 target 8 8 2 fov 40\nwater level 3 floor 0 from 0 0 to 16 16 color 120 180 200\n' +
    'material stone color 120 110 100\nbox stone from 6 6 0 to 10 10 5\n');
  for (const scene of ['waves.scene', path.join(work, 'pond.scene')]) {
    await test(`rain on ${path.basename(scene)}: the same in every run, and nothing of it in what is finished`, () => {
      const [shown, again] = [opened(scene, width, height), opened(scene, width, height)];
      const finished = drawn(shown, 'fine');
      is('pixels that are others', pixelsThatDiffer(finished, rendered(shown)), 0);
      drawn(again, 'lit');
      const fast = ({look}) => {
        look.fast(1);
        return Buffer.from(look.rows(0, height));
      };
      const still = fast(shown);
      let last = still;
      for (let frame = 0; frame < 16; ++frame) {
        holds('it rains', shown.look.rain(true) && again.look.rain(true));
        const now = fast(shown);
        is(`frame ${frame} of another run`, pixelsThatDiffer(now, fast(again)), 0);
        if (frame > 2) holds(`frame ${frame} is another`, pixelsThatDiffer(now, last) > 0);
        last = now;
      }
      is('finished in the rain', pixelsThatDiffer(drawn(shown, 'fine'), finished), 0);
      holds('it is laid to rest', shown.look.rain(false));
      is('at rest', pixelsThatDiffer(fast(shown), still), 0);
    });
  }
  await test('where no water is no rain falls', () => {
    const shown = opened('castle.vox', width, height);
    drawn(shown, 'coarse');
    is('it', [shown.look.rain(true), shown.look.x.has_water()].join(), 'false,0');
  });
}
function mean(picture) {
  return picture.reduce((sum, x) => sum + x, 0) / picture.length;
}

function write(name, text) {
  fs.writeFileSync(path.join(work, name), text);
}

// What a stranger drops, with the command's own sentences.
async function mistakes() {
  write('empty.vox', '');
  write('words.obj', 'v 0 0 zero\n');
  write('nan.xyz', 'nan 1 2\n');
  write('huge.xyz', '1e999 1 2\n');
  write('lonely.scene', 'model nowhere.vox at 0,0,0\n');
  const vox = fs.readFileSync('tools/gallery/scenes/castle.vox');
  fs.writeFileSync(path.join(work, 'cut.vox'), vox.subarray(0, 3000));
  for (const name of ['empty.vox', 'words.obj', 'nan.xyz', 'huge.xyz', 'cut.vox']) {
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
  // What the page cannot catch, or does without.
  const draco = made.gltf({accessors: Array.from({length: 3}, () => ({type: 'VEC3', componentType: 5126, count: 5}))});
  draco.meshes[0].primitives[0].extensions = {KHR_draco_mesh_compression: {bufferView: 0, attributes: {POSITION: 0}}};
  for (const [what, content, wanted] of [['broken JSON', '{"asset": ]', 'the JSON is broken at its byte 11'],
    ['a number beyond all', '{"asset": 1e999}', 'the JSON holds a number or a text that cannot be read'],
    ['a buffer that is not here', JSON.stringify(made.gltf()),
      "buffer 0: the file 'tent.bin' beside this one is not here: drop it together with the file that names it"],
    ['Draco', JSON.stringify(draco),
      'primitive 0 of mesh 0: it is compressed by Draco, which this page does not read; the thimble command does']]) {
    await test(`glTF with ${what} is refused in a sentence`, () => {
      let said = '';
      try {
        new Baker(modules.bake, [{name: 'a.gltf', bytes: Buffer.from(content)}]).bake('a.gltf', boardOf('raspi0'));
      } catch (error) {
        said = error.message;
      }
      is('sentence', said, wanted);
    });
  }
  for (const [what, more, wanted] of [['is there', [{name: 'tent.png', bytes: made.PICTURE}], ''],
    ['is missing', [], "image 0: the file 'sub/tent%2Epng' beside this one is not here: drop it together with the file that names it"],
    ['is WebP', [{name: 'tent.png', bytes: Buffer.from('RIFF\x10\0\0\0WEBPVP8L')}],
      "the picture 'sub/tent%2Epng' is not drawn: it is no PNG, JPEG or WebP that this program reads"]]) {
    await test(`glTF whose picture ${what} is drawn, with a note of what is not`, () => {
      const files = [{name: 'a.gltf', bytes: Buffer.from(JSON.stringify(made.gltf()))}, {name: 'tent.bin', bytes: made.NUMBERS}, ...more];
      const {voxels, notes} = new Baker(modules.bake, files).bake('a.gltf', boardOf('raspi0'));
      holds('voxels', voxels > 1000);
      is('notes', notes, wanted === '' ? '' : `a.gltf: ${wanted}`);
    });
  }
  await test('.obj without its materials is drawn, with a note', () => {
    const {notes} = new Baker(modules.bake, filesOf(`${work}/shop.obj`)).bake('shop.obj', boardOf('raspi0'));
    is('notes', notes, "shop.obj: the materials of 'shop.mtl' beside it are not drawn: it is not here: drop it together with the file that names it");
  });
  await test('of a file that is nothing known it is said what this page reads', () => {
    const strange = path.join(work, 'strange.foo');
    fs.writeFileSync(strange, 'what is this');
    let said = '';
    try {
      new Baker(modules.bake, filesOf(strange)).bake('strange.foo', boardOf('raspi0'));
    } catch (error) {
      said = error.message;
    }
    const told = command('bake', strange, '-o', path.join(work, 'never.oct'), '--quiet').stderr.trim();
    is('the sentence', said, told.slice(`thimble: ${strange}: `.length));
  });
  for (const [what, files, wanted] of [['missing', {}, 'is not here: drop it together with the file that names it'],
    ['empty', {'m.vox': ''}, 'is empty'], ['damaged', {'m.vox': 'VOX garbage'}, /^version \d+ at byte offset 4 is not supported/]]) {
    await test(`a model that is ${what} is named, and what is wrong elsewhere is not its fault`, () => {
      const bakes = (scene, more) => {
        try {
          new Baker(modules.bake, [{name: 's.scene', bytes: Buffer.from(scene)},
            ...Object.entries(more).map(([name, text]) => ({name, bytes: Buffer.from(text)}))]).bake('./s.scene', boardOf('raspi0'));
          return '';
        } catch (error) {
          return error.message;
        }
      };
      const said = bakes('model m.vox at 0,0,0\n', files);
      holds(`"${said}" names it`, said.startsWith('m.vox: '));
      if (typeof wanted === 'string') is('the rest', said.slice(7), wanted);
      else holds('the rest', wanted.test(said.slice(7)));
      holds('a broken scene is itself', /^line 1, column/.test(bakes('modl m.vox\n', files)));
      const castle = {'m.vox': fs.readFileSync('tools/gallery/scenes/castle.vox')};
      const large = bakes('depth 12\nmodel m.vox at 0,0,0\nbox 1 from 0 0 0 to 4095 4095 4095\n', castle);
      holds(`"${large.slice(0, 60)}" is not the model's`, large !== '' && !large.startsWith('m.vox'));
    });
  }
  await test('the figures of the page\'s README are those of what was built, to half a per cent', () => {
    const rows = [...fs.readFileSync('platform/web/README.md', 'utf8').matchAll(/^\| `([\w.]+)` \|.*\| ([\d,]+) \|$/gm)];
    is('rows', rows.length, 4);
    for (const [, name, figure] of rows) {
      // The page may have been built without programs, which are not counted.
      const size = name.endsWith('.html') ? fs.readFileSync(path.join(folder, '..', name), 'latin1').replace(/<script [^>]*id="programs"[^]*?<\/script>/, '').length :
        fs.statSync(path.join(folder, name)).size;
      const said = Number(figure.replace(/,/g, ''));
      holds(`${name} has ${size} bytes; README says ${figure}`, Math.abs(size - said) < size / 200);
    }
  });
  await test('a model that was not dropped is requested', () => {
    let said = '';
    try {
      const house = filesOf('tools/gallery/scenes/house.scene');
      new Baker(modules.bake, house).bake('house.scene', boardOf('raspi0'));
    } catch (error) {
      said = error.message;
    }
    is('sentence', said, 'house.vox.gz: is not here: drop it together with the file that names it');
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
      is('the command', told.stderr.trim(), `thimble: points:60000: ${said}; --coarsen makes the finest tree that fits; ` +
        `--depth ${smaller.level} fits with ${smaller.bytes.toLocaleString('en')} bytes (make firmware takes such options as BAKE="...")`);
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
