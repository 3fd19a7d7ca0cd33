// The page with WebGPU, in Debian's Chromium by SwiftShader: test_gpu.js PAGE THIMBLE
'use strict';
const {spawnSync} = require('child_process');
const fs = require('fs');
const path = require('path');
const {Chromium} = require('./chromium.js');
const {test, is, holds, end} = require('./check.js');
const {KERNELS, translate, wgsl} = require('../../platform/gpu/kernel/wgsl.js');
const made = require('./files.js');

const [, , page, thimble] = process.argv;
const work = path.resolve('build/web/tests');
const [WIDTH, HEIGHT] = [96, 72];  // a software adapter takes seconds for more
const url = `file://${path.resolve(page)}`;
Chromium.hasGpu = true;

let browser = null;
const gpu = () => browser.eval('document.documentElement.dataset.gpu');
const finished = () => browser.until(`viewer.phase === 'finished' && document.documentElement.dataset.phase === 'finished'`, 120);
// The page at a scene, at rest. `first` runs before its own scripts; a frame may take `mostMs`.
async function opened(scene, {first = '', mostMs = 1e9} = {}) {
  browser = await Chromium.open(`${url}#scene=${scene}&look=1&size=${WIDTH}x${HEIGHT}`,
    {media: [{name: 'prefers-reduced-motion', value: 'reduce'}], first});
  await browser.until(`typeof GPU_LIMITS === 'object' && ((GPU_LIMITS.ms = ${mostMs}), document.documentElement.dataset.gpu)`, 60);
  await finished();
}
// The canvas shows what the command makes of `file` from there.
async function isTheCommands(what, file) {
  await finished();
  const [, options] = /^thimble render \S+ (.*) -o picture\.png$/.exec(await browser.eval('renderCommand()'));
  const picture = path.join(work, 'gpu.ppm');
  const told = spawnSync(thimble, ['render', file, ...options.split(' '), '-o', picture, '--quiet'], {encoding: 'utf8'});
  is('the command', told.stderr, '');
  const rgb = fs.readFileSync(picture).subarray(-3 * WIDTH * HEIGHT).toString('base64');
  is(`the picture ${what}`, await browser.canvasCrc(), await browser.eval(`crc32(Uint8Array.from(atob('${rgb}'), (c) => c.charCodeAt(0)))`));
}
const castle = path.resolve('tools/gallery/scenes/castle.vox');
const byGpu = () => browser.eval('viewer.gpu.drawn');

async function kernels() {
  await test('what is beyond the text that becomes WGSL is refused', async () => {
    const refused = [
      'FN int f(uint a) { return a; }', 'FN int f(int a) { return a + 1u; }', 'FN int f(int a) { return b; }',
      'FN int f(int a) { a + 1; return a; }', 'FN void f(float a) { }', 'FN int f(int a) { return g(a); }',
      'FN void g(OUT(int) a) { a = 1; }\nFN void f() { ivec3 v; g(v.x); }', 'FN int f(ivec3 v) { return v.w; }',
      'FN bool g(OUT(int) a) { a = 1; return true; }\nFN int f(bool b) { int a = 0; return b ? (g(a) ? 1 : 2) : 0; }',
      'FN int f(bool a) { return a ? 1 : 2u; }', 'FN int f(int a) { if (a) { return 1; } return 2; }', '#include "x.inc"',
      'FN bool f(bool a) { return a < true; }', 'FN int f(int a) { return abs(a, a); }', 'FN int f(int a) { do { a = 1; } while (true); }',
    ];
    for (const text of refused) {
      let why = null;
      try {
        translate(text);
      } catch (error) {
        why = error.message;
      }
      holds(`it is refused: ${text}`, why !== null);
    }
    is('a parameter that is assigned', translate('FN int f(int a) { a += 1; return a; }').replace(/\s+/g, ' '),
      'fn f_(a_in: i32) -> i32 { var a_: i32 = a_in; a_ += 1i; return a_; } ');
  });
  await test('the kernels are compiled without a word', async () => {
    await opened('castle');
    for (const name of Object.keys(KERNELS)) {
      is(`messages about ${name}`, await browser.eval(`(async () => {
        const module = (await gpuDevice).device.createShaderModule({code: ${JSON.stringify(wgsl(name))}});
        return (await module.getCompilationInfo()).messages.map(({message}) => message).join(); })()`), '');
    }
  });
}
async function draws() {
  await test('by WebGPU: the picture at rest is the command\'s', async () => {
    is('WebGPU', await gpu(), 'draws');
    const before = await byGpu();
    await browser.eval('moved(() => {})');
    await isTheCommands('at rest', castle);
    holds('the GPU drew it', await byGpu() > before);
  });
  await test('by WebGPU: while the pointer drags each frame has all of its light and samples; so has the last', async () => {
    await browser.eval('viewer.asks = true');  // so that the picture is none at rest
    const before = await byGpu();
    await browser.drag('#screen', 120, 10);
    await browser.until(`!viewer.gpu.busy && viewer.phase === 'waits' && viewer.picture.changed[1] === 0`, 120);
    holds('frames', await byGpu() > before);
    holds('what is said of it', /GPU/.test(await browser.text('frame')));
    is('the frame', await browser.canvasCrc(), await browser.eval(`(() => {
      viewer.look.band('fine', 0, ${HEIGHT}, viewer.exposure);
      return crc32(viewer.look.rows(0, ${HEIGHT})); })()`));
    await browser.eval('viewer.asks = false');
    await isTheCommands('after it', castle);
  });
  await test('by WebGPU: pairs of words draw the same', async () => {
    await browser.eval(`GpuPicture.prototype.run = ((run) => function(told) {
      told[told.length - 1] = 1; return run.call(this, told); })(GpuPicture.prototype.run); moved(() => {})`);
    await isTheCommands('by pairs', castle);
    is('the kernels that were made', await browser.eval('Object.keys(viewer.gpu.of.pipelines).join()'), '0,1,2');
    is('WebGPU', await gpu(), 'draws');
  });
  await test('by WebGPU: a scene that is dropped; where the kernels draw it not the page does', async () => {
    const ball = path.join(work, 'gpu_ball.npy');
    fs.writeFileSync(ball, made.npy(24));
    await browser.drop([ball]);
    await browser.until(`viewer?.gpu && current().title === 'gpu_ball.npy'`, 60);
    const before = await byGpu();
    await browser.eval('moved(() => {})');
    await isTheCommands('of the ball', ball);
    holds('the GPU drew it', await byGpu() > before);
    await browser.click('#scene-water');
    await browser.until(`/kernels/.test(document.documentElement.dataset.gpu)`, 60);
    is('the GPU', await browser.eval('viewer.gpu'), null);
  });
  await test('the device is lost: the page draws on by itself', async () => {
    await browser.click('#scene-castle');
    await browser.until(`document.documentElement.dataset.gpu === 'draws'`, 60);
    await finished();
    await browser.eval('viewer.gpu.of.device.destroy()');
    await browser.drag('#screen', 60, 20);
    await browser.until('viewer.gpu === null', 30);
    await isTheCommands('without it', castle);
    await browser.close();
  });
}
async function withoutIt() {
  const wrong = `GPUDevice.prototype.createShaderModule = ((make) => function({code}) {
    return make.call(this, {code: code.replace('160u', '161u')}); })(GPUDevice.prototype.createShaderModule)`;
  const no = 'Object.defineProperty(Navigator.prototype, "gpu", {get: () => undefined})';
  for (const [what, options, why] of [['draws a shadow wrong by one part of 256', {first: wrong}, 'wrong'],
    ['takes long', {mostMs: 0}, 'late'], ['is not there', {first: no}, 'none']]) {
    await test(`a GPU that ${what}: the page is as without`, async () => {
      await opened('castle', options);
      is('WebGPU', await gpu(), why);
      is('the GPU', await browser.eval('viewer.gpu'), null);
      await browser.drag('#screen', 60, 20);
      await isTheCommands('by the page', castle);
      await browser.close();
    });
  }
}

kernels().then(draws).then(withoutIt).then(() => Chromium.quit()).then(() => end('the page with WebGPU')).catch((error) => {
  console.error(`test-web: ${error.message}`);
  Chromium.kill();
  process.exit(1);
});
