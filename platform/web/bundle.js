// Puts the page, its modules, its scenes and the programs of boards into one file: node bundle.js MODULES ROOT OUT
'use strict';
const {execFileSync} = require('child_process');
const fs = require('fs');
const path = require('path');
const zlib = require('zlib');
const {Baker} = require('./baker.js');
const {Look} = require('./look.js');
const {KERNELS, wgsl} = require('../gpu/kernel/wgsl.js');
const {Machine, Table, crc32} = require('./machine.js');
const {SHELF} = require('./shelf.js');

const [, , modules, root, out] = process.argv;
const MOST_BYTES = 1200000;
const own = (name) => fs.readFileSync(path.join(__dirname, name), 'utf8');
// The page's sources are scripts one after the other; each is a module of its own under Node.
const script = ['machine.js', 'lzma.js', 'baker.js', 'look.js', 'crew.js', 'orbit.js', 'shelf.js', 'gpu.js', 'around.js', 'shop.js', 'page.js'].map((name) => own(name)
  .replace(/^'use strict';\n/m, '')
  .replace(/\nif \(typeof module !== 'undefined'\) \{[^]*?\n\}\n/, '\n')
  .replace(/^\s*\/\/.*\n/gm, '')).join('\n');

// Files as one of LZMA (lzma.js) in base 85, a fifteenth less of the page than base 64, and where each of them ends.
function pack(id, files, coding) {
  const all = Buffer.concat(files.map(([, bytes]) => bytes));
  const packed = execFileSync('xz', ['-c', '--format=lzma', `--lzma1=preset=9e,${coding}`], {input: all, maxBuffer: 2 ** 30});
  packed.writeUInt32LE(all.length, 5);
  const words = Buffer.concat([packed, Buffer.alloc(-packed.length & 3)]);
  let text = '';
  for (let at = 0; at < words.length; at += 4) {
    for (let word = words.readUInt32BE(at), unit = 85 ** 4; unit >= 1; word %= unit, unit /= 85) {
      const code = 40 + Math.floor(word / unit);
      text += String.fromCharCode(code === 60 ? 125 : code);
    }
  }
  let end = 0;
  const ends = files.map(([name, bytes]) => `${name}:${end += bytes.length}`);
  return `<script type="application/octet-stream" id="${id}" data-ends="${ends}">${text}</script>`;
}
const load = (name) => [name, fs.readFileSync(path.join(modules, name))];
const scenes = ['castle.vox', 'room.scene', 'waves.scene'].map((name) => [name, fs.readFileSync(path.join(root, 'tools/gallery/scenes', name))]);
const kernels = Object.keys(KERNELS).map((name) => [`${name}.wgsl`, Buffer.from(wgsl(name))]);
const images = path.join(root, 'build/images');
const programs = (fs.existsSync(images) ? fs.readdirSync(images) : []).filter((name) => Object.entries(SHELF).some(([board, {glass}]) => name.startsWith(`${board}-demo-`) || (glass && name.startsWith(`${board}-water-`))))
  .map((name) => [name.replace('.elf.gz', ''), zlib.gunzipSync(fs.readFileSync(path.join(images, name)))]);

// The small pictures of the strip: what the page itself draws, as PNG with five bits a channel.
const [WIDTH, HEIGHT] = [112, 84];
const moduleOf = (name) => new WebAssembly.Module(load(name)[1]);
function rgbOf(scene) {
  if (scene !== null) {
    const baker = new Baker(moduleOf('bake.wasm'), scenes.map(([name, bytes]) => ({name, bytes})));
    const {baked} = baker.bake(scene, {index: 0}, {size: [WIDTH, HEIGHT]});
    const look = new Look(moduleOf('scene.wasm'), baked, WIDTH, HEIGHT);
    const camera = {eye: look.point(false), target: look.point(true), zoom: 256, own: true};
    look.see(camera);
    look.take(baker.look(camera, WIDTH, HEIGHT, 320).block);
    look.band('fine', 0, HEIGHT, look.expose());
    return look.rows(0, HEIGHT);
  }
  const table = new Table(moduleOf('plane.wasm'));
  const board = table.boards.find(({name}) => name === 'mps2-an500');
  const machine = new Machine(moduleOf('plane.wasm'), {board, app: 'particles'});
  while (machine.frames < 60) machine.step();
  const rgba = new Uint8Array(4 * board.width * board.height);
  table.expand(machine.display, 0, board.height, rgba);
  return Uint8Array.from({length: 3 * WIDTH * HEIGHT}, (_, i) => {
    const [x, y] = [Math.floor(i / 3) % WIDTH, Math.floor(i / 3 / WIDTH)];
    return rgba[4 * (board.width * Math.floor(y * board.height / HEIGHT) + Math.floor(x * board.width / WIDTH)) + i % 3];
  });
}
function png(rgb) {
  const chunk = (kind, bytes) => {
    const words = new DataView(new ArrayBuffer(8));
    const named = Buffer.concat([Buffer.from(kind), bytes]);
    words.setUint32(0, bytes.length);
    words.setUint32(4, parseInt(crc32(named), 16));
    return Buffer.concat([Buffer.from(words.buffer, 0, 4), named, Buffer.from(words.buffer, 4)]);
  };
  const stride = 3 * WIDTH;
  const rows = Array.from({length: HEIGHT}, (_, y) => Buffer.from([2, ...Array.from({length: stride},
    (_, x) => (rgb[y * stride + x] & 248) - ((rgb[(y - 1) * stride + x] ?? 0) & 248) & 255)]));
  return Buffer.concat([Buffer.from('\x89PNG\r\n\x1a\n', 'latin1'),
    chunk('IHDR', Buffer.from([0, 0, 0, WIDTH, 0, 0, 0, HEIGHT, 8, 2, 0, 0, 0])),
    chunk('IDAT', zlib.deflateSync(Buffer.concat(rows), {level: 9})), chunk('IEND', Buffer.alloc(0))]);
}
const pictures = {valley: 'demo', castle: 'castle.vox', room: 'room.scene', water: 'waves.scene', particles: null};
const strip = Object.entries(pictures).map(([name, scene]) => `${name}: 'data:image/png;base64,${png(rgbOf(scene)).toString('base64')}'`);

const page = own('page.html')
  .replace('/*STYLE*/', () => own('page.css'))
  .replace('<!--MODULES-->', () => [pack('modules', [...['bake.wasm', 'plane.wasm', 'scene.wasm'].map(load), ...scenes, ...kernels], 'lc=3,lp=0,pb=0'),
    pack('programs', programs, 'lc=2,lp=1,pb=1')].join('\n'))
  .replace('/*SCRIPT*/', () => `'use strict';\nconst PICTURES = {${strip.join()}};\n${script}`);
fs.writeFileSync(out, page);
const size = Buffer.byteLength(page);
console.log(`${out}: ${size} of at most ${MOST_BYTES} bytes, ${programs.length} programs for boards${programs.length === 0 ? '; make images builds them' : ''}`);
if (size > MOST_BYTES) {
  console.error(`web: ${out} has ${size - MOST_BYTES} bytes too many`);
  process.exitCode = 1;
}
