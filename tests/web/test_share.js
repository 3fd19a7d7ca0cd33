// The page that `thimble render SCENE -o F.html` writes, in headless Chromium from the disk: test_share.js THIMBLE
'use strict';
const {spawnSync} = require('child_process');
const fs = require('fs');
const path = require('path');
const zlib = require('zlib');
const {Chromium} = require('./chromium.js');
const {Firefox, hasFirefox} = require('./firefox.js');
const {test, is, holds, end} = require('./check.js');
const made = require('./files.js');

const [, , thimble] = process.argv;
const work = path.resolve('build/web/tests');
const [WIDTH, HEIGHT] = [160, 120];
const MOST_PAGE_BYTES = 350000;  // and the scene
const REST = 'document.body.dataset.phase === "finished"';
const CRC32 = `globalThis.crc32 = (bytes) => {
  let crc = -1;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = crc & 1 ? (crc >>> 1) ^ 0xEDB88320 : crc >>> 1;
  }
  return (~crc >>> 0).toString(16).padStart(8, '0');
};`;

fs.mkdirSync(work, {recursive: true});
function run(...words) {
  const told = spawnSync(thimble, [...words, '--quiet'], {encoding: 'utf8'});
  if (told.status !== 0) throw new Error(told.stderr);
}
function share(scene, ...words) {
  const file = path.join(work, 'share.html');
  run('render', scene, '-o', file, ...words);
  return file;
}
function crcOf(scene, ...words) {
  const stats = path.join(work, 'share.json');
  run('render', scene, '-o', path.join(work, 'share.png'), '--stats', stats, ...words);
  return JSON.parse(fs.readFileSync(stats, 'utf8')).frame_crc32;
}
// Hands the opened file to `judge`; fails on a request to a network and on an error that the page reports.
async function shown(file, options, judge) {
  const browser = await Chromium.open(`file://${file}`, {width: WIDTH, height: HEIGHT, ...options});
  await browser.until('document.readyState === "complete"');
  if (options.scripts !== false) await browser.eval(CRC32);
  await judge(browser);
  const asked = browser.events.filter(({method, params}) => method === 'Network.requestWillBeSent' &&
    !/^(file|data|blob):/.test(params.request.url));
  is('requests', asked.length, 0);
  is('faults', browser.events.filter(({method, params}) => method === 'Runtime.exceptionThrown' ||
    params.entry?.level === 'error').map(({params}) => params.entry?.text ?? params.exceptionDetails.text).join(), '');
  await browser.close();
}
// The options of `render` by which the picture at rest comes out.
const placed = async (browser) => {
  const {eye, target} = await browser.eval('shared.view.camera');
  const point = (q8) => q8.map((x) => x / 256).join();
  return ['--eye', point(eye), '--target', point(target), ...(await browser.eval('shared.look.lens(256)')).split(' ')];
};

async function main() {
  await test('a scene: at rest the pixels of render, also from elsewhere; the same bytes again', async () => {
    const size = ['--size', `${WIDTH}x${HEIGHT}`];
    const largest = fs.readFileSync(share('castle')).toString();
    const scene = largest.match(/data-scene>([^<]*)/)[1].length;
    holds(`${largest.length - scene} bytes beside the scene`, largest.length - scene < MOST_PAGE_BYTES);
    const file = share('castle', ...size);
    const bytes = fs.readFileSync(file);
    holds('the same bytes', bytes.equals(fs.readFileSync(share('castle', ...size))));
    await shown(file, {}, async (browser) => {
      is('the title', await browser.eval('document.title'), 'castle');
      is('the canvas before', await browser.eval('document.body.dataset.picture'), undefined);
      await browser.until(REST, 100);
      is('at rest', await browser.canvasCrc(), crcOf('castle', ...size));
      await browser.drag('#canvas', 30, -10);
      await browser.until(REST, 100);
      is('turned', await browser.canvasCrc(), crcOf('castle', ...size, ...await placed(browser)));
      const before = await browser.eval('shared.orbit.distance');
      await browser.wheel('#canvas', -200);
      await browser.until(`shared.orbit.distance < ${before}`);
      await browser.key('-');
      await browser.key('0');
      await browser.until(REST, 100);
      is('the first view', await browser.canvasCrc(), crcOf('castle', ...size));
    });
    await shown(file, {mobile: true, width: 60, height: 120}, async (browser) => {
      await browser.until(REST, 100);
      is('upright', await browser.canvasCrc(), crcOf('castle', '--size', '120x240', ...await placed(browser)));
      const yaw = await browser.eval('shared.orbit.yaw');
      await browser.touch('touchStart', [{x: 20, y: 60}]);
      await browser.touch('touchMove', [{x: 40, y: 60}]);
      await browser.touch('touchEnd', []);
      await browser.until(`shared.orbit.yaw !== ${yaw}`);
      const far = await browser.eval('shared.orbit.distance');
      await browser.touch('touchStart', [{x: 25, y: 60}, {x: 35, y: 60}]);
      await browser.touch('touchMove', [{x: 10, y: 60}, {x: 50, y: 60}]);
      await browser.touch('touchEnd', []);
      await browser.until(`shared.orbit.distance < ${far}`);
    });
    await shown(file, {scripts: false}, async (browser) => {
      await browser.shot(path.join(work, 'share_poster.png'));
      const {nodes} = await browser.send('Accessibility.getFullAXTree');
      holds('the poster', nodes.some(({role, name}) => /^ima?ge?$/.test(role?.value) && name?.value === 'castle'));
    });
  });
  await test('stars, a background and a ground of one\'s own: the pixels of render', async () => {
    for (const [scene, ...words] of [['cluster:2000'], ['castle', '--background', '204060', '--ground', 'off', '--turn', '40']]) {
      const all = ['--size', `${WIDTH}x${HEIGHT}`, ...words];
      await shown(share(scene, ...all), {}, async (browser) => {
        await browser.until(REST, 100);
        is(scene, await browser.canvasCrc(), crcOf(scene, ...all));
      });
    }
  });
  await test('it turns by itself until a hand takes it; with less motion it is still; rain plays', async () => {
    const file = share('castle', '--turntable', '40', '--size', `${WIDTH}x${HEIGHT}`);
    await shown(file, {}, async (browser) => {
      await browser.until('globalThis.shared?.plays');
      const yaw = await browser.eval('shared.orbit.yaw');
      await browser.until(`shared.orbit.yaw !== ${yaw} && 'picture' in document.body.dataset`);
      await browser.drag('#canvas', 10, 0);
      await browser.until(REST, 100);
    });
    await shown(file, {media: [{name: 'prefers-reduced-motion', value: 'reduce'}]}, async (browser) => {
      await browser.until(REST, 100);
      is('it plays', await browser.eval('shared.plays'), false);
    });
    const film = path.join(work, 'share.vox');
    fs.writeFileSync(film, made.vox(16, 3));
    await shown(share(film, '--frames', '0:2', '--size', `${WIDTH}x${HEIGHT}`), {}, async (browser) => {
      await browser.until('globalThis.shared?.frame === 2');
      await browser.until('shared.frame === 1');
      await browser.key(' ');
      await browser.until(REST, 100);
      const frame = await browser.eval('shared.frame');
      is(`frame ${frame}`, await browser.canvasCrc(), crcOf(film, '--frame', String(frame), '--size', `${WIDTH}x${HEIGHT}`));
    });
    await shown(share('water,depth=4', '--size', `${WIDTH}x${HEIGHT}`), {}, async (browser) => {
      await browser.until(REST, 100);
      await browser.changes('rain', () => browser.click('#play'));
      await browser.changes('rain that falls on', async () => {});
    });
  });
  await test('in another page: the wheel is that page\'s until the picture is clicked', async () => {
    const file = share('castle', '--size', `${WIDTH}x${HEIGHT}`);
    const outer = path.join(work, 'share_outer.html');
    fs.writeFileSync(outer, `<iframe src="${path.basename(file)}" width="150" height="100"></iframe><p style="height: 5000px">`);
    await shown(outer, {width: 300, height: 200}, async (browser) => {
      await new Promise((done) => setTimeout(done, 3000));
      await browser.wheel('iframe', 50);
      await browser.until('scrollY > 0');
      await browser.click('iframe');
      const before = await browser.eval('scrollY');
      await browser.wheel('iframe', 50);
      await new Promise((done) => setTimeout(done, 500));
      is('scrolled', await browser.eval('scrollY'), before);
    });
  });
  await test('a sheet: a tile for each file; one opens as its own page does, by its address, too', async () => {
    const folder = path.join(work, 'sheet');
    fs.rmSync(folder, {recursive: true, force: true});
    fs.mkdirSync(folder);
    for (const name of ['cas & tle.vox', 'other.vox']) fs.copyFileSync('tools/gallery/scenes/castle.vox', path.join(folder, name));
    fs.writeFileSync(path.join(folder, 'broken.vox'), 'VOX ?');
    const file = path.join(work, 'sheet.html');
    run('sheet', folder, '-o', file, '--size', '96');
    const bytes = fs.readFileSync(file);
    run('sheet', folder, '-o', file, '--size', '96', '--threads', '1');
    holds('the same bytes', bytes.equals(fs.readFileSync(file)));
    const baked = path.join(work, 'sheet.oct');
    fs.writeFileSync(baked, zlib.inflateSync(Buffer.from(bytes.toString().match(/data-scene>([^<]*)/)[1], 'base64')));
    const crc = async (browser) => crcOf(baked, '--size', `${WIDTH}x${HEIGHT}`,
      ...await browser.eval('shared.view.camera.own') ? [] : await placed(browser));
    const tile = 'figure[data-name="cas & tle.vox"] a';
    await shown(file, {}, async (browser) => {
      is('the title', await browser.eval('document.title'), 'sheet');
      is('the tiles', await browser.eval('[...document.querySelectorAll("figcaption")].map((one) => one.innerText.split("\\n")[0]).join()'),
        'broken.vox,cas & tle.vox,other.vox');
      holds('the sentence', await browser.eval('/truncated/.test(document.querySelector("figure p").textContent)'));
      await browser.click(tile);
      await browser.until(REST, 100);
      is('opened', await browser.canvasCrc(), await crc(browser));
      is('its title', await browser.eval('document.title'), 'cas & tle.vox');
      await browser.drag('#canvas', 30, -10);
      await browser.until(REST, 100);
      is('turned', await browser.canvasCrc(), await crc(browser));
      await browser.key('Escape');
      await browser.until('canvas.hidden && document.title === "sheet"');
      is('what has the focus', await browser.eval(`document.activeElement === document.querySelector('${tile}')`), true);
      await browser.eval('history.back()');
      await browser.until(REST, 100);
      await browser.click('#close');
      await browser.until('canvas.hidden');
      await browser.key('Enter');
      await browser.until('!canvas.hidden');
    });
    await shown(`${file}#other.vox`, {mobile: true, width: 60, height: 120}, async (browser) => {
      await browser.until(REST, 100);
      is('its title', await browser.eval('document.title'), 'other.vox');
    });
  });
  await Chromium.quit();
  if (hasFirefox) {
    await test('in Firefox, on a desktop and a telephone: the pixels of render', async () => {
      const file = share('castle', '--size', `${WIDTH}x${HEIGHT}`);
      for (const [width, height, ratio] of [[WIDTH, HEIGHT, 1], [60, 120, 2]]) {
        const browser = await Firefox.open(`file://${file}`, {width, height, ratio});
        browser.before = CRC32.replace('globalThis.crc32', 'const crc32');
        await browser.until(REST, 100);
        is(`${width} x ${height}`, await browser.canvasCrc(),
          crcOf('castle', '--size', `${width * ratio}x${height * ratio}`, ...(ratio === 1 ? [] : await placed(browser))));
        await browser.close();
      }
    });
  } else {
    console.log('test-web: without Firefox: neither firefox-esr nor firefox is installed');
  }
  end('the page of one scene');
}
main();
