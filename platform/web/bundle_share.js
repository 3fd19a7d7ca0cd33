// Puts the modules and scripts of a page of one scene into its template, which `thimble render SCENE -o F.html` fills in:
// node bundle_share.js MODULES OUT
'use strict';
const {execFileSync} = require('child_process');
const fs = require('fs');
const path = require('path');

const MOST_BYTES = 270000;  // with a poster of 60,000 bytes in base 64 350,000
const [, , modules, out] = process.argv;
const own = (name) => fs.readFileSync(path.join(__dirname, name), 'utf8');
const script = ['baker.js', 'look.js', 'crew.js', 'orbit.js', 'share.js'].map((name) => own(name)
  .replace(/^'use strict';\n/m, '')
  .replace(/\nif \(typeof module !== 'undefined'\) \{[^]*?\n\}\n/, '\n')
  .replace(/^\s*\/\/.*\n/gm, '')).join('\n');
const packed = ['look', 'share'].map((name) => {
  const file = execFileSync('zopfli', ['-c', '--zlib', path.join(modules, `${name}.wasm`)]);
  return `<script type="application/octet-stream" id="module-${name}">${file.toString('base64')}</script>`;
});
const page = own('share.html')
  .replace('<!--MODULES-->', () => packed.join('\n'))
  .replace('/*SCRIPT*/', () => `'use strict';\n${script}`);
fs.writeFileSync(out, page);
const size = Buffer.byteLength(page);
console.log(`${out}: ${size} of at most ${MOST_BYTES} bytes`);
if (size > MOST_BYTES) {
  console.error(`web: ${out} has ${size} bytes, ${size - MOST_BYTES} too many`);
  process.exitCode = 1;
}
