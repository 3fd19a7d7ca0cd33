// The page in headless Chromium, from the disk, driven with real events: test_page.js PAGE THIMBLE
'use strict';
const {spawnSync} = require('child_process');
const fs = require('fs');
const path = require('path');
const zlib = require('zlib');
const {Chromium} = require('./chromium.js');
const {test, is, holds, end} = require('./check.js');

const [, , page, thimble] = process.argv;
const url = `file://${path.resolve(page)}`;
const work = path.resolve('build/web/tests');
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

let browser = null;
let shown = 0;  // how often the page began anew
async function began() {
  ++shown;
  await browser.until(`Number(document.documentElement.dataset.ready) >= ${shown}`, 30);
  shown = await browser.eval('Number(document.documentElement.dataset.ready)');
}
const text = (id) => browser.eval(`document.getElementById('${id}').textContent`);
// The CRC-32 of what the canvas shows, as RGB.
const canvasCrc = () => browser.eval(`(() => {
  const {width, height} = canvas;
  const rgba = canvas.getContext('2d').getImageData(0, 0, width, height).data;
  return crc32(rgba.filter((_, i) => i % 4 !== 3));
})()`);
async function changes(what, act) {
  const before = await canvasCrc();
  await act();
  for (let i = 0; i < 40; ++i) {
    if (await canvasCrc() !== before) return;
    await pause(50);
  }
  throw new Error(`${what} does not change the picture`);
}
async function choose(board) {
  await browser.eval(`(() => { const list = document.getElementById('board'); list.value = '${board}';
    list.dispatchEvent(new Event('change')); })()`);
  await began();
}
function sim(scene, board, app, frames, keys) {
  const stats = path.join(work, 'page_stats.json');
  const script = path.join(work, 'page_keys.txt');
  fs.writeFileSync(script, keys ?? '');
  const told = spawnSync(thimble, ['sim', scene, '--board', board, '--app', app, '--display', 'none', '--frames',
    String(frames), '--quiet', '--stats', stats, ...(keys ? ['--keys', script] : [])], {encoding: 'utf8'});
  if (told.status !== 0) throw new Error(told.stderr);
  return JSON.parse(fs.readFileSync(stats, 'utf8')).frame_crc32;
}

async function desktop() {
  browser = await Chromium.open(url);
  await began();
  await test('it opens from the disk and draws', async () => {
    holds('it says what it shows', (await text('said')).startsWith('Valley: 72,295 voxels in 39,060 bytes, depth 6'));
    await browser.until(`document.getElementById('frame').textContent.endsWith(' ms')`);
    holds('RAM', /^[\d,]+ of 61,440$/.test(await text('ram')));
    holds('flash', (await text('flash')).endsWith(' of 262,144'));
    holds('the picture moves', await canvasCrc() !== '00000000');
    await changes('time', () => pause(100));
  });
  await test('the canvas shows a frame of the simulator', async () => {
    // A scene with light stands still, drawn once fast and once lit.
    await browser.click('#scene-castle');
    await began();
    const wanted = sim('tools/gallery/scenes/castle.vox', 'lm3s6965evb', 'demo', 2);
    for (let i = 0; i < 60 && await canvasCrc() !== wanted; ++i) await pause(50);
    is('CRC of the canvas', await canvasCrc(), wanted);
  });
  await test('arrow keys and the row of buttons steer', async () => {
    await changes('an arrow key', () => browser.key('ArrowLeft'));
    await pause(300);
    await changes('a button', () => browser.click('[data-hold="right"]'));
    await changes('a drag', () => browser.drag('#canvas', 80, 0));
    await changes('a letter', () => browser.key('t', 'KeyT'));
  });
  await test('Pause holds the picture', async () => {
    await browser.click('#pause');
    await pause(200);
    const before = await canvasCrc();
    await pause(300);
    is('the canvas', await canvasCrc(), before);
    await changes('going on', () => browser.click('#pause'));
  });
  await test('another board has its own display, RAM and picture', async () => {
    await choose('mps2-an500');
    is('width', await browser.eval('canvas.width'), 320);
    await browser.until(`/ of 4,186,112$/.test(document.getElementById('ram').textContent)`);
    const wanted = sim('tools/gallery/scenes/castle.vox', 'mps2-an500', 'demo', 2);
    for (let i = 0; i < 60 && await canvasCrc() !== wanted; ++i) await pause(50);
    is('CRC of the canvas', await canvasCrc(), wanted);
    await choose('lm3s6965evb');
  });
  await test('? opens the help, Esc closes it', async () => {
    await browser.key('?', 'Slash');
    is('open', await browser.eval(`document.getElementById('dialog').open`), true);
    await browser.key('Escape');
    is('closed', await browser.eval(`document.getElementById('dialog').open`), false);
  });
  await test('water is touched, particles fall', async () => {
    await browser.click('#scene-water');
    await began();
    await pause(300);
    await changes('a touch', () => browser.click('#canvas'));
    await browser.click('#scene-particles');
    await began();
    await changes('time', () => pause(200));
  });
  await test('a lit room', async () => {
    await browser.click('#scene-room');
    await began();
    await changes('light', () => pause(300)).catch(() => {});
    holds('it is shown', (await text('said')).startsWith('Lit room: 379,726 voxels'));
  });
  await looks();
  await drops();
  await test('save and link', async () => {
    await browser.click('#link');
    await browser.until(`location.hash.includes('board=lm3s6965evb')`);
    await browser.send('Browser.setDownloadBehavior', {behavior: 'allow', downloadPath: work}).catch(() => {});
    is('a picture can be saved', await browser.eval(
      `new Promise((done) => canvas.toBlob((blob) => done(blob.type)))`), 'image/png');
  });
  await test('nothing was sent and nothing went wrong', () => {
    const asked = browser.events.filter((event) => event.method === 'Network.requestWillBeSent')
      .map((event) => event.params.request.url).filter((address) => !/^(file|data|blob):/.test(address));
    is('requests', asked.join(' '), '');
    const wrong = browser.events.filter((event) => event.method === 'Runtime.exceptionThrown' ||
      (event.method === 'Log.entryAdded' && event.params.entry.level === 'error'));
    is('errors', JSON.stringify(wrong.map((event) => event.params)), '[]');
  });
  await names();
  await browser.close();
}

async function looks() {
  await test('look around: dragged, turned by the wheel, lit at rest', async () => {
    await browser.click('#scene-castle');
    await began();
    await browser.click('#look');
    await began();
    await browser.until(`document.documentElement.dataset.phase === 'finished'`, 60);
    const finished = await canvasCrc();
    await changes('a drag', () => browser.drag('#canvas', 120, 40));
    await changes('the wheel', () => browser.wheel('#canvas', -120));
    await changes('an arrow', () => browser.key('ArrowLeft'));
    await browser.click('#link');
    const link = await browser.eval('location.hash');
    holds(`the link ${link} holds the view`, /look=[-\d.]+(%2C[-\d.]+){5}/.test(link));
    await browser.key('0', 'Digit0');
    await browser.until(`document.documentElement.dataset.phase === 'finished'`, 60);
    is('back at the scene\'s own view', await canvasCrc(), finished);
    await browser.click('#look');
    await began();
  });
}

async function drops() {
  await test('a dropped file is baked and shown', async () => {
    const file = path.resolve('tools/gallery/scenes/fox.vox.gz');
    await browser.drop([file]);
    await began();
    holds('it says so', (await text('said')).startsWith('fox.vox.gz: '));
    const wanted = sim(file, 'lm3s6965evb', 'demo', 2);
    for (let i = 0; i < 60 && await canvasCrc() !== wanted; ++i) await pause(50);
    is('CRC of the canvas', await canvasCrc(), wanted);
  });
  await test('what does not fit is said, with what would', async () => {
    const file = path.join(work, 'many.xyz');
    fs.writeFileSync(file, Array.from({length: 90000}, (_, i) =>
      [Math.sin(i * 12.9898) * 43758 % 1, Math.sin(i * 78.233) * 43758 % 1, Math.sin(i * 39.425) * 43758 % 1].join(' '))
      .join('\n'));
    await browser.drop([file]);
    await began();
    const said = await text('said');
    holds(`"${said}" has the bytes and a depth`, /many\.xyz: takes [\d,]+ bytes .* too many\. Depth \d+ fits with/.test(said));
    await browser.click('#offers button');
    await began();
    holds('the smaller one is shown', /many\.xyz: [\d,]+ voxels in/.test(await text('said')));
  });
  await test('what cannot be read is said in a sentence, and the page goes on', async () => {
    const file = path.join(work, 'cut.vox');
    fs.writeFileSync(file, fs.readFileSync('tools/gallery/scenes/castle.vox').subarray(0, 3000));
    await browser.drop([file]);
    await began();
    const told = spawnSync(thimble, ['bake', file, '-o', path.join(work, 'never.oct'), '--quiet'], {encoding: 'utf8'});
    is('the sentence', `thimble: ${work}/${await text('said')}`, told.stderr.trim());
    const broken = path.join(work, 'broken.vox.gz');
    fs.writeFileSync(broken, zlib.gzipSync('something').subarray(0, 15));
    await browser.drop([broken]);
    await browser.until(`document.getElementById('said').textContent.startsWith('broken.vox.gz')`);
    await browser.click('#scene-valley');
    await began();
    await changes('time', () => pause(200));
  });
}

// What a screen reader says, and what a keyboard reaches.
async function names() {
  await test('everything that is pressed has a name, and enough contrast', async () => {
    const nameless = await browser.eval(`[...document.querySelectorAll('button, select, canvas, meter, dialog')].filter(
      (element) => !(element.textContent.trim() || element.getAttribute('aria-label') || element.labels?.length ||
        element.getAttribute('aria-labelledby'))).map((element) => element.outerHTML).join()`);
    is('without a name', nameless, '');
    for (const scheme of ['light', 'dark']) {
      await browser.send('Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value: scheme}]});
      const least = await browser.eval(`(() => {
        const light = (text) => { const [r, g, b] = text.match(/\\d+(\\.\\d+)?/g).map(Number).map((v) =>
          v / 255 <= 0.03928 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4);
          return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
        const behind = (element) => { for (let e = element; e; e = e.parentElement) {
          const color = getComputedStyle(e).backgroundColor; if (!/, 0\\)$|transparent/.test(color)) return color; }
          return getComputedStyle(document.documentElement).backgroundColor; };
        return Math.min(...[...document.querySelectorAll('button:not(:disabled), p, dt, dd, summary, h1')]
          .filter((element) => element.offsetParent !== null && element.id !== 'busy').map((element) => {
          const [a, b] = [light(getComputedStyle(element).color), light(behind(element))];
          return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05); }));
      })()`);
      holds(`contrast of ${least} in ${scheme} is at least 4.5`, least >= 4.5);
    }
  });
}

async function telephone() {
  browser = await Chromium.open(`${url}#scene=castle&board=raspi0&look=1`, {width: 390, height: 844, mobile: true});
  shown = 0;
  await began();
  await test('on a telephone: nothing is wider than it, turned over too', async () => {
    is('width', await browser.eval('document.documentElement.scrollWidth'), 390);
    await browser.send('Emulation.setDeviceMetricsOverride', {width: 844, height: 390, deviceScaleFactor: 2, mobile: true});
    is('width, turned over', await browser.eval('document.documentElement.scrollWidth'), 844);
    await browser.send('Emulation.setDeviceMetricsOverride', {width: 390, height: 844, deviceScaleFactor: 2, mobile: true});
  });
  await test('a finger turns, two come nearer', async () => {
    await browser.until(`document.documentElement.dataset.phase === 'finished'`, 60);
    const {x, y} = await browser.middle('#canvas');
    await changes('a finger', async () => {
      await browser.touch('touchStart', [{x, y, id: 1}]);
      for (const step of [20, 40, 60]) await browser.touch('touchMove', [{x: x + step, y, id: 1}]);
      await browser.touch('touchEnd', []);
    });
    const before = await browser.eval('orbit.distance');
    await browser.touch('touchStart', [{x: x - 30, y, id: 1}, {x: x + 30, y, id: 2}]);
    for (const step of [40, 60, 80]) {
      await browser.touch('touchMove', [{x: x - step, y, id: 1}, {x: x + step, y, id: 2}]);
    }
    await browser.touch('touchEnd', []);
    holds('a pinch comes nearer', await browser.eval('orbit.distance') < 0.6 * before);
  });
  await browser.close();
}

async function calm() {
  browser = await Chromium.open(url, {media: [{name: 'prefers-reduced-motion', value: 'reduce'}]});
  shown = 0;
  await began();
  await test('who wants less motion gets none before asking', async () => {
    await pause(300);
    const before = await canvasCrc();
    await pause(400);
    is('the canvas', await canvasCrc(), before);
  });
  await browser.close();
}

desktop().then(telephone).then(calm).then(() => end('the page in Chromium')).catch((error) => {
  console.error(`test-web: ${error.message}`);
  browser?.process.kill('SIGKILL');
  process.exit(1);
});
