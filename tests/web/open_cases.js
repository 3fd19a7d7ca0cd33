// What a visitor does who knows nothing, in Chromium: sees a scene turn, drops a model, chooses a board, takes the file for it along.
'use strict';
const {spawn, spawnSync} = require('child_process');
const fs = require('fs');
const path = require('path');
const {Chromium} = require('./chromium.js');
const {test, is, holds} = require('./check.js');
const made = require('./files.js');

const IMAGES = 'build/images';
const SCREENS = {desktop: {width: 1280, height: 800}, telephone: {width: 390, height: 844, mobile: true}, tablet: {width: 820, height: 1180, mobile: true}};

// What an image tells once it is sent the key, again and again: `count` lines of two words each; null where its emulator is not here.
function emulated(board, file, key, line, count) {
  const [emulator, ...options] = {pico: ['rp2040js', '-carrier', 'pico-lcd-1.3'], 'pico-lcd-2': ['rp2040js', '-carrier', 'pico-lcd-2'], 'pico-oled': ['rp2040js', '-carrier', 'pico-oled'], gba: ['mgba']}[board];
  if (spawnSync('sh', [`platform/emulators/${emulator}/fetch.sh`]).status !== 0) return null;
  const shift = /BOARD_ICOUNT_SHIFT (\d+)/.exec(fs.readFileSync(`platform/boards/${board.replace(/^pico.*/, 'pico')}/board.cmake`, 'utf8'))[1];
  return new Promise((done, fail) => {
    const child = spawn('sh', [`platform/emulators/${emulator}/run.sh`, shift, file, ...options], {stdio: ['pipe', 'pipe', 'ignore'], detached: true});
    const end = () => {
      clearInterval(sending);
      process.kill(-child.pid, 'SIGKILL');
    };
    const late = setTimeout(() => { end(); fail(new Error(`${board} says only: ${said}`)); }, 240000);
    let said = '';
    child.stdin.on('error', () => {});
    child.stdin.write(key);
    const sending = setInterval(() => key === 'i' && child.stdin.write(key), 500);
    child.stdout.on('data', (data) => {
      said += data;
      const told = [...said.matchAll(line)];
      if (told.length < count) return;
      clearTimeout(late);
      end();
      done(new Map(told.map(([, frame, crc]) => [frame, crc])));
    });
  });
}

async function judgeOpening(url, thimble, work) {
  for (const [name, screen] of Object.entries(SCREENS)) {
    await test(`on a ${name} it opens with a scene in colour that turns in the whole window, until a hand takes it`, async () => {
      const browser = await Chromium.open(url, screen);
      await browser.until(`document.documentElement.dataset.ready === '1'`, 30);
      const ratio = screen.mobile ? 2 : 1;
      is('the picture', await browser.eval('[canvas.width, canvas.height].join()'), [screen.width * ratio, screen.height * ratio].join());
      const box = await browser.middle('#canvas');
      is('its size on the screen', [box.width, box.height].join(), [screen.width, screen.height].join());
      const yaw = await browser.eval('orbit.yaw');
      await browser.changes('time', () => {});
      await browser.until(`orbit.yaw > ${yaw} + 0.02`);
      const colours = await browser.eval(`(() => { const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        let count = 0; for (let i = 0; i < data.length; i += 4) if (Math.max(data[i], data[i + 1], data[i + 2]) - Math.min(data[i], data[i + 1], data[i + 2]) > 60) ++count;
        return 4 * count / data.length; })()`);
      holds(`${(100 * colours).toFixed(0)} % of it are colours`, colours > 0.05);
      const covered = await browser.eval(`[...document.querySelectorAll('header, button, nav, .said')].filter((element) => element.checkVisibility() && !element.closest('nav'))
        .filter((element) => { const box = element.getBoundingClientRect(); return box.left < 0 || box.top < 0 || box.right > innerWidth + 1 || box.bottom > innerHeight + 1; })
        .map((element) => element.id || element.tagName)`);
      is('what the window does not show', covered.join(), '');
      holds('the address turns, too', (await browser.eval('location.hash')).includes('turns=1'));
      await browser.shot(path.join(work, `opening_${name}.png`));
      if (screen.mobile) {
        await browser.touch('touchStart', [{x: box.x, y: box.y, id: 1}]);
        await browser.touch('touchMove', [{x: box.x + 30, y: box.y, id: 1}]);
        await browser.touch('touchEnd', []);
      } else {
        await browser.drag('#canvas', 30, 0);
      }
      is('it turns by itself', await browser.eval('state.turns'), false);
      const still = await browser.eval('orbit.text()');
      await new Promise((done) => setTimeout(done, 200));
      is('the view', await browser.eval('orbit.text()'), still);
      await browser.close();
    });
  }
  await test('who wants less motion sees it stand still', async () => {
    const browser = await Chromium.open(url, {...SCREENS.desktop, media: [{name: 'prefers-reduced-motion', value: 'reduce'}]});
    await browser.until(`document.documentElement.dataset.ready === '1'`, 30);
    await new Promise((done) => setTimeout(done, 300));
    holds('it stands', await browser.eval('orbit.isOwn && !state.turns'));
    await browser.close();
  });
  await judgeBoards(url, thimble, work);
  await judgeModelLink(url, work);
}

// The second act: what is dropped goes onto a board.
async function judgeBoards(url, thimble, work) {
  const browser = await Chromium.open(url, SCREENS.desktop);
  await browser.until(`document.documentElement.dataset.ready === '1'`, 30);
  await test('what is dropped is looked at in the window\'s own resolution, and in full screen', async () => {
    await browser.drop([path.resolve('tools/gallery/scenes/fox.vox.gz')]);
    await browser.until(`document.getElementById('said').textContent === 'fox.vox.gz: 18,538 voxels.'`);
    is('the picture', await browser.eval('[canvas.width, canvas.height].join()'), '1280,800');
    await browser.click('#full');
    await browser.until(`document.fullscreenElement?.id === 'screen'`);
    await browser.until('viewer !== null && viewer.board.width === innerWidth && viewer.board.height === innerHeight');
    await browser.eval('document.exitFullscreen()');
    await browser.until('document.fullscreenElement === null && viewer !== null && viewer.board.height === innerHeight');
  });
  await browser.click('#act');
  await browser.until('machine !== null && machine.frames > 1', 30);
  const listed = await browser.eval(`[...document.querySelectorAll('#shelf button')].map(({id}) => id.slice(6))`);
  const there = ['pico', 'pico-lcd-2', 'pico-oled', 'microbit', 'gba'].filter((name) => fs.existsSync(`${IMAGES}/${name}-demo-plain.elf.gz`));
  await test('the boards whose programs there are stand there with picture and price', async () => {
    is('the boards', listed.join(), there.join());
    holds('each has both', await browser.eval(`[...document.querySelectorAll('#shelf button')].every((card) => card.querySelector('svg rect') && card.querySelector('small').textContent.length > 5)`));
  });
  await browser.saveIn(work);
  // The file of what is shown, saved under `title`, once the page has it; equal to that of the command.
  const saved = async (name, title, scene, ...words) => {
    const {board, ending} = await browser.eval('({board: machine.board.name, ending: machine.board.ending})');
    is('the board', board, name);
    const file = path.join(work, `${title}.${ending}`);
    fs.rmSync(file, {force: true});
    await browser.click('#download');
    for (let tries = 0; tries < 100 && !fs.existsSync(file); ++tries) await new Promise((done) => setTimeout(done, 50));
    await new Promise((done) => setTimeout(done, 300));
    const wanted = path.join(work, `wanted.${ending}`);
    const told = spawnSync(thimble, ['image', `tools/gallery/scenes/${scene}`, '--board', name, '--images', IMAGES, '-o', wanted, '--quiet', ...words], {encoding: 'utf8'});
    is('the command', told.stderr, '');
    holds('the bytes are equal', fs.readFileSync(file).equals(fs.readFileSync(wanted)));
    return file;
  };
  for (const [i, name] of listed.entries()) {
    await test(`${name}: the file is that of thimble image, byte for byte, and what to do with it stands there`, async () => {
      const before = await browser.eval('generation');
      if (i % 2 === 0) {
        await browser.click(`#shelf-${name}`);
      } else {
        await browser.eval(`document.getElementById('shelf-${name}').focus()`);
        await browser.key('Enter', 'Enter', {text: '\r'});
      }
      await browser.until(`Number(document.documentElement.dataset.ready) > ${before} && machine !== null && machine.frames > 0`, 30);
      const file = await saved(name, 'fox', 'fox.vox.gz');
      const steps = await browser.eval(`[...document.querySelectorAll('#steps li')].map(({textContent}) => textContent)`);
      holds(`${steps.join(' | ')}: three, with the file's name`, steps.length === 3 && steps.some((step) => step.includes(path.basename(file))));
      const words = await browser.eval(`[...document.querySelectorAll('main *')].filter((element) => element.children.length === 0 && element.checkVisibility() &&
        !element.closest('details') && /\\b(arena|UART|flash|hold a rate)\\b/i.test(element.textContent)).map(({textContent}) => textContent)`);
      is('words of the firmware', words.join(), '');
      await browser.shot(path.join(work, `board_${name}.png`));
      if (name === 'microbit') return;
      const shown = await emulated(name, file, 'c', /^frame (\d+) crc (\w+).*\n/gm, 3);
      if (shown === null) return console.log(`${name}: skipped: there is no emulator`);
      // What runs on the page's display, from its first frame on.
      const uart = await browser.eval(`(async () => { const twin = new Machine(await moduleOf('scene'), {board: machine.board, app: 'demo', scene: baked.baked});
        twin.type('c'); while (twin.frames < ${Math.max(...[...shown.keys()].map(Number)) + 1}) twin.step(); return twin.output; })()`);
      const here = new Map([...uart.matchAll(/^frame (\d+) crc (\w+)/gm)].map(([, frame, crc]) => [frame, crc]));
      const both = [...shown].filter(([frame]) => here.has(frame));
      holds(`frames ${[...shown.keys()]} are in both`, both.length >= 2);
      for (const [frame, crc] of both) is(`frame ${frame} of the booted file`, crc, here.get(frame));
    });
  }
  if (fs.existsSync(`${IMAGES}/gba-water-all.elf.gz`)) {
    await test('moving water: the file is that of thimble image, and shows what the page shows', async () => {
      await browser.click('#shelf-gba');
      await browser.click('#scene-water');
      await browser.until(`machine?.app === 'water' && machine.board.name === 'gba' && machine.frames > 1`, 60);
      const file = await saved('gba', 'water', 'waves.scene', '--app', 'water');
      const counters = /^frames ([1-9]\d*) .* crc (\w+) water .*\n/gm;
      const shown = await emulated('gba', file, 'i', counters, 1);
      if (shown === null) return console.log('gba: skipped: there is no emulator');
      const uart = await browser.eval(`(async () => { const twin = new Machine(await moduleOf('plane'), {board: machine.board, app: 'water', scene: baked.baked});
        while (twin.frames < 2) twin.step(); twin.type('i'); while (twin.frames < 4) twin.step(); return twin.output; })()`);
      is('the picture', [...shown.values()].join(), [...uart.matchAll(counters)].map(([, , crc]) => crc).join());
    });
    await test('a board whose RAM holds no such water has no file, and says so', async () => {
      await browser.eval(`restart({board: 'microbit'})`);
      await browser.until(`document.getElementById('said').textContent.startsWith('water: ')`, 30);
      holds('nothing is offered', await browser.eval(`document.getElementById('get').hidden && document.getElementById('none').hidden`));
      is('in words of who buys', /\barena\b/.test(await browser.text('said')), false);
    });
  }
  await browser.close();
}

async function judgeModelLink(url, work) {
  await test('a link holds a model of up to 8 KB itself; of a larger one its name', async () => {
    const file = path.resolve(work, 'small.vox');
    fs.writeFileSync(file, made.vox(16, 1));
    const browser = await Chromium.open(`${url}#scene=castle&look=1&size=320x240`);
    await browser.until(`document.documentElement.dataset.ready === '1'`, 30);
    const before = await browser.eval('generation');
    await browser.drop([file]);
    await browser.until(`Number(document.documentElement.dataset.ready) > ${before} && state.dropped !== null && document.documentElement.dataset.phase === 'finished'`, 60);
    const wanted = await browser.canvasCrc();
    await browser.click('#link');
    await browser.until(`/model=/.test(location.hash)`);
    const link = await browser.eval('location.href');
    const other = await Chromium.open(link);
    await other.until(`viewer !== null && state.dropped !== null && document.documentElement.dataset.phase === 'finished'`, 60);
    is('what is shown', await other.eval('state.dropped.title'), 'small.vox');
    is('the picture', await other.canvasCrc(), wanted);
    await other.eval(`location.hash = location.hash.replace(/model=..../, 'model=AAAA')`);
    await other.until(`document.getElementById('said').textContent.startsWith('This link shows small.vox')`);
    await other.close();
    await browser.drop([path.resolve('tools/gallery/scenes/castle.vox')]);
    await browser.until(`state.dropped?.title === 'castle.vox' && viewer !== null`);
    holds('a larger one', !(await browser.eval('fragment().toString()')).includes('model='));
    await browser.close();
  });
}

module.exports = {judgeOpening};
