// Puts the page, its modules and its scenes into one file: node bundle.js MODULES ROOT OUT
'use strict';
const {execFileSync} = require('child_process');
const fs = require('fs');
const path = require('path');

const [, , modules, root, out] = process.argv;
const own = (name) => fs.readFileSync(path.join(__dirname, name), 'utf8');
// The page's sources are scripts one after the other; each is a module of its own under Node.
const script = ['machine.js', 'baker.js', 'look.js', 'crew.js', 'orbit.js', 'around.js', 'page.js'].map((name) => own(name)
  .replace(/^'use strict';\n/m, '')
  .replace(/\nif \(typeof module !== 'undefined'\) \{[^]*?\n\}\n/, '\n')
  .replace(/^\s*\/\/.*\n/gm, '')).join('\n');

const packed = [];
// Base 85 (page.js, unpack): a fifteenth less of the page than base 64. zopfli's gzip: a twenty-fifth less than zlib's.
function pack(id, file) {
  const gzip = execFileSync('zopfli', ['-c', file]);
  const words = Buffer.concat([gzip, Buffer.alloc(-gzip.length & 3)]);
  let text = '';
  for (let at = 0; at < words.length; at += 4) {
    for (let word = words.readUInt32BE(at), unit = 85 ** 4; unit >= 1; word %= unit, unit /= 85) {
      const code = 40 + Math.floor(word / unit);
      text += String.fromCharCode(code === 60 ? 125 : code);
    }
  }
  packed.push(`<script type="application/octet-stream" id="${id}" data-bytes="${gzip.length}">${text}</script>`);
}
for (const name of ['scene', 'plane', 'bake']) {
  pack(`module-${name}`, path.join(modules, `${name}.wasm`));
}
for (const name of ['castle.vox', 'room.scene', 'waves.scene']) {
  pack(`file-${name}`, path.join(root, 'tools/gallery/scenes', name));
}
const page = own('page.html')
  .replace('/*STYLE*/', () => own('page.css'))
  .replace('<!--MODULES-->', () => packed.join('\n'))
  .replace('/*SCRIPT*/', () => `'use strict';\n${script}`);
fs.writeFileSync(out, page);
const over = (name, size, most) => {
  console.log(`${name}: ${size} of at most ${most} bytes`);
  if (size <= most) return;
  console.error(`web: ${name} has ${size} bytes, ${size - most} too many`);
  process.exitCode = 1;
};
for (const name of ['scene', 'plane']) over(`${name}.wasm`, fs.statSync(path.join(modules, `${name}.wasm`)).size, 352 * 1024);
over(out, Buffer.byteLength(page), 720000);
