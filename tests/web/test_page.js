// The page in headless Chromium, from the disk, driven with real events: test_page.js PAGE THIMBLE
'use strict';
const {spawnSync} = require('child_process');
const fs = require('fs');
const http = require('http');
const path = require('path');
const zlib = require('zlib');
const {Chromium} = require('./chromium.js');
const {test, is, holds, end} = require('./check.js');
const {judgeCases} = require('./cases.js');
const {judgeAccess} = require('./access.js');
const {isWhatIsSaid, judgePlays} = require('./play_cases.js');
const {judgeShown, judgeFiles, judgeWheels, judgeRefused} = require('./shown_cases.js');
const {judgeOpening} = require('./open_cases.js');
const made = require('./files.js');

const [, , page, thimble, only] = process.argv;
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
async function reloaded() {
  shown = 0;
  await began();
}
const text = (id) => browser.text(id);
const canvasCrc = () => browser.canvasCrc();
const changes = (what, act) => browser.changes(what, act);
// The view of Look around, and what is shown of it: a picture that is refined changes by itself.
async function moves(what, act) {
  const before = await browser.eval('orbit.text()');
  await changes(what, act);
  await browser.until(`orbit.text() !== '${before}'`, 5);
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

// Holds the board's picture, which is that of the simulator after so many frames.
async function showsItsFrame(scene, board) {
  await browser.until('machine.frames > 0');
  await browser.eval('state.paused = true');
  await browser.until(`machine.state === 'frame'`);
  const count = await browser.eval('machine.frames');
  is(`frame ${count} on the canvas`, await canvasCrc(), sim(scene, board, 'demo', count));
  await browser.eval('state.paused = false');
}

async function desktop() {
  browser = await Chromium.open(`${url}#scene=valley&board=lm3s6965evb&size=640x480`);
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
    await browser.click('#scene-castle');
    await began();
    await showsItsFrame('tools/gallery/scenes/castle.vox', 'lm3s6965evb');
  });
  await test('arrow keys and the row of buttons steer', async () => {
    await changes('an arrow key', () => browser.key('ArrowLeft'));
    await pause(300);
    await changes('a button', () => browser.click('[data-hold="right"]'));
    await changes('a drag', () => browser.drag('#canvas', 80, 0));
    await changes('a letter', () => browser.key('l', 'KeyL'));
  });
  await test('Pause holds the picture', async () => {
    await browser.click('#pause');
    await pause(200);
    const before = await canvasCrc();
    await pause(300);
    is('the canvas', await canvasCrc(), before);
    await changes('playing', () => browser.click('#pause'));
  });
  await test('another board has its own display, RAM and picture', async () => {
    await choose('mps2-an500');
    await showsItsFrame('tools/gallery/scenes/castle.vox', 'mps2-an500');
    is('width', await browser.eval('canvas.width'), 320);
    await browser.until(`/ of 4,186,112$/.test(document.getElementById('ram').textContent)`);
    await choose('lm3s6965evb');
  });
  await judgeShown(browser, {work, began, choose, showsItsFrame, reloaded});
  await judgeWheels(browser, {began});
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
    holds('it is shown', (await text('said')).startsWith('Lit room: 379,726 voxels'));
  });
  await looks();
  await drops();
  await links();
  await test('nothing was sent and nothing went wrong', () => {
    const asked = browser.events.filter((event) => event.method === 'Network.requestWillBeSent')
      .map((event) => event.params.request.url).filter((address) => !/^(file|data|blob):/.test(address));
    is('requests', asked.join(' '), '');
    const wrong = browser.events.filter((event) => event.method === 'Runtime.exceptionThrown' ||
      (event.method === 'Log.entryAdded' && event.params.entry.level === 'error'));
    is('errors', JSON.stringify(wrong.map((event) => event.params)), '[]');
  });
  await judgeAccess(browser);
  await browser.close();
}

const camera = () => browser.eval('JSON.stringify(orbit.camera())');
async function looks() {
  await test('look around: dragged, turned by the wheel, lit at rest', async () => {
    await browser.click('#scene-castle');
    await began();
    await browser.click('#act');
    await began();
    await browser.key('0', 'Digit0');  // a view from before is kept
    await browser.until(`viewer.phase === 'fine'`, 60);  // s saves the finished one below
    const own = await camera();
    const cores = await browser.eval('crewSize');
    is('workers', await browser.eval('viewer.crew?.workers.length ?? 0'), cores > 1 ? cores : 0);
    await changes('a drag', () => browser.drag('#canvas', 120, 40));
    await changes('the wheel', () => browser.wheel('#canvas', -120));
    await changes('an arrow', () => browser.key('ArrowLeft'));
    await browser.click('#link');
    const link = await browser.eval('location.hash');
    holds(`the link ${link} holds the view`, /look=[-\d.]+(%2C[-\d.]+){5}/.test(link));
    await browser.key('0', 'Digit0');
    is('back at the scene\'s own view', await camera(), own);
    await browser.click('#act');
    await began();
  });
  await hands();
  await judgePlays(browser, thimble, {work, began, fromAfar, finish});
  shown = await browser.eval('generation');
  await test('one thread and workers finish the same picture', async () => {
    const pictures = [];
    await fromAfar();
    for (const size of [1, 2, 3]) {
      await browser.eval(`crewSize = ${size}; restart({scene: 'castle', look: true})`);
      await finish();
      is('workers', await browser.eval('viewer.crew?.workers.length ?? 0'), size > 1 ? size : 0);
      pictures.push(await canvasCrc());
    }
    is('two workers', pictures[1], pictures[0]);
    is('three workers', pictures[2], pictures[0]);
  });
  await test('a hand on the picture interrupts the workers at once', async () => {
    await browser.key('ArrowRight');
    await browser.until(`document.documentElement.dataset.phase === 'fine'`, 60);
    const {x, y} = await browser.middle('#canvas');
    const at = (type, dx) => browser.send('Input.dispatchMouseEvent', {type, x: x + dx, y, button: 'left', buttons: 1, clickCount: 1});
    await browser.eval(`window.seen = []; { const job = viewer.crew.job;
      const onBand = viewer.crew.on.onBand;
      viewer.crew.on.onBand = (...words) => { seen.push(viewer.crew.job - job); onBand(...words); };
      canvas.addEventListener('pointermove', () => { seen.push(viewer.phase); }, {once: true}); }`);
    await at('mousePressed', 0);
    await at('mouseMoved', 40);
    await at('mouseReleased', 40);
    const seen = await browser.eval('seen');
    holds(`the phase after a move is moved: ${seen}`, seen.includes('moved'));
    is('bands of the old view after it', seen.slice(seen.indexOf('moved')).filter((what) => what === 0).length, 0);
    holds('no worker did more than its band', await browser.eval('viewer.crew.thrownAway') <= 3 * 3);
    await finish();
    const byWorkers = await canvasCrc();
    await browser.eval(`crewSize = 1; restart({})`);
    await finish();
    is('the same view by one thread', byWorkers, await canvasCrc());
  });
  await test('where workers do not start, or end, the page draws and bakes itself', async () => {
    const wanted = await canvasCrc();
    await browser.eval(`crewSize = 2; window.Worker_ = Worker; Worker = class { constructor() { throw new Error('none'); } };
      restart({})`);
    await finish();
    is('workers', await browser.eval('viewer.crew'), null);
    is('the picture', await canvasCrc(), wanted);
    await browser.eval(`Worker = class extends Worker_ { constructor() { super('data:text/javascript,throw 1'); } };
      cache.clear(); restart({})`);
    await finish();
    is('workers', await browser.eval('viewer.crew'), null);
    is('the picture', await canvasCrc(), wanted);
    await browser.eval(`Worker = Worker_; restart({look: false})`);
    shown = await browser.eval('Number(document.documentElement.dataset.ready)');
    browser.events = browser.events.filter((event) => !/Refused to create a worker|data:text/.test(JSON.stringify(event)));
  });
}
const key = (name, held) => browser.key(name, undefined, held && {held});
// The viewer's keys and gestures, as on the desktop.
async function hands() {
  const view = () => browser.eval('({yaw: orbit.yaw, pitch: orbit.pitch, target: orbit.target, eye: orbit.camera().eye})');
  const rests = () => browser.until(`viewer.phase !== 'moved'`);
  // What the command's ray of each pixel hits, from the scene's own view.
  const csv = path.join(work, 'hands.csv');
  spawnSync(thimble, ['render', 'tools/gallery/scenes/castle.vox', '--size', '640x480', '--effects', 'auto', '--hits', csv, '-o', path.join(work, 'hands.ppm'), '--quiet']);
  const hits = fs.readFileSync(csv, 'utf8').split('\n');
  await browser.eval(`restart({scene: 'castle', look: true})`);
  await test('keys 1 to 6 are the named views', async () => {
    for (const [name, yaw, pitch] of [['1', -90, 0], ['2', 90, 0], ['3', -180, 0], ['4', 0, 0], ['5', -90, 90], ['6', -45, 35.26]]) {
      await moves(`key ${name}`, () => key(name));
      const at = await view();
      const off = at.yaw - yaw * Math.PI / 180;
      holds(`key ${name} looks from ${at.yaw}, ${at.pitch}`, Math.hypot(Math.cos(off) - 1, Math.sin(off)) < 2e-4 && Math.abs(at.pitch * 180 / Math.PI - pitch) < 0.01);
    }
    await moves('the button of a view', () => browser.click('[data-key="1"]'));
  });
  await test('W A S D, arrows, Page Up and Page Down fly while held', async () => {
    await key('1');  // along +y
    await browser.eval('canvas.focus()');
    for (const [name, axis, sign] of [['w', 1, 1], ['s', 1, -1], ['a', 0, -1], ['D', 0, 1], ['ArrowUp', 1, 1], ['ArrowDown', 1, -1],
      ['ArrowLeft', 0, -1], ['ArrowRight', 0, 1], ['PageUp', 2, 1], ['PageDown', 2, -1]]) {
      const before = (await view()).target;
      await moves(`key ${name}`, () => key(name, name === 's' ? 500 : undefined));
      const after = (await view()).target;
      const way = after.map((x, i) => x - before[i]);
      holds(`key ${name} flies ${way}`, sign * way[axis] > 1 && way.every((x, i) => i === axis || Math.abs(x) < 0.01));
      await pause(50);
      is('where it is let go', (await view()).target.join(), after.join());
    }
    is('the page has not scrolled', await browser.eval('scrollY'), await browser.eval('canvas.scrollIntoView({block: "center"}), scrollY'));
  });
  await test('the buttons of the board fly, too, by hand and by key', async () => {
    const before = (await view()).target;
    await moves('the button', () => browser.click('[data-hold="up"]'));
    const after = (await view()).target;
    holds(`it flies ${before} to ${after}`, after[1] > before[1]);
    await browser.eval(`document.querySelector('[data-hold="left"]').focus()`);
    await moves('the button by a key', () => browser.key('Enter', 'Enter', {text: '\r'}));
    await pause(300);
    const there = (await view()).target;
    holds(`it flies ${after} to ${there}`, there[0] < after[0]);
    await pause(100);
    is('and stops', (await view()).target.join(), there.join());
    await browser.eval('canvas.focus()');
  });
  await test('s saves the picture once it is finished, and says the command that makes the same one', async () => {
    await key('0');
    await browser.saveIn(work);
    for (const what of ['from its own view', 'from elsewhere']) {
      if (what === 'from elsewhere') {
        await fromAfar();
        await browser.drag('#canvas', 70, 25);
      }
      const file = path.join(work, 'thimble-castle.png');
      fs.rmSync(file, {force: true});
      const before = (await view()).target.join();
      await key('s');
      is('the view stays', (await view()).target.join(), before);
      is('it says', await text('said'), 'It is saved once it is finished.');
      await finish();
      for (let i = 0; i < 100 && !fs.existsSync(file); ++i) await pause(50);
      holds(`${what} it is saved`, fs.existsSync(file));
      is(`what is saved ${what}`, await browser.pngCrc(file), await canvasCrc());
      await isWhatIsSaid(browser, thimble, what, 'tools/gallery/scenes/castle.vox');
    }
  });
  await test('right and Shift drags move, others turn', async () => {
    for (const hand of [{button: 'right'}, {shift: true}]) {
      await key('1');
      const before = await view();
      await moves(`a drag by ${JSON.stringify(hand)}`, () => browser.drag('#canvas', 60, 30, hand));
      const after = await view();
      is('the direction', [after.yaw, after.pitch].join(), [before.yaw, before.pitch].join());
      holds('the picture follows the pointer', after.target[0] < before.target[0] - 1 && after.target[2] > before.target[2] + 1);
    }
    const before = await view();
    await browser.drag('#canvas', 60, 30);
    const after = await view();
    is('the target of a plain drag', after.target.join(), before.target.join());
    holds('it turns', after.yaw !== before.yaw && after.pitch !== before.pitch);
  });
  await test('p names what is under the pointer, a double click looks at it', async () => {
    await key('0');
    await rests();
    const {x, y, width, height} = await browser.middle('#canvas');
    for (const [dx, dy] of [[0, 0], [0.08, 0.1], [-0.1, 0.05]]) {
      await browser.point(x + dx * width, y + dy * height);
      const [px, py] = await browser.eval('pointed');
      holds(`the pixel ${px},${py} lies there`, Math.abs(px - 320 - dx * 640) <= 1 && Math.abs(py - 240 - dy * 480) <= 1);
      await key('p');
      const [, , isHit, vx, vy, vz, , axis, ...ray] = hits[1 + py * 640 + px].split(',').map(Number);
      is('the command hits', isHit, 1);
      const faces = [['right', '+x', 'left', '-x'], ['back', '+y', 'front', '-y'], ['top', '+z', 'bottom', '-z']][axis];
      const [side, way] = ray[4 + axis] < 0 ? faces : faces.slice(2);
      const said = await text('said');
      holds(`"${said}" names it`, said.startsWith(`voxel ${vx},${vy},${vz}: its ${side} face (${way}), material `) && /material \d+, #[0-9a-f]{6}$/.test(said));
    }
    await browser.point(x - width / 2 + 3, y - height / 2 + 3);
    await key('p');
    is('the sky', await text('said'), 'There is nothing under the pointer.');
    const before = await view();
    await browser.point(x + 0.08 * width, y + 0.1 * height);
    const point = await browser.eval('viewer.look.pick(...pointed).point');
    await moves('a double click', () => browser.doubleClick(x + 0.08 * width, y + 0.1 * height));
    const after = await view();
    holds(`it looks at ${after.target}, which is ${point}`, after.target.every((at, i) => Math.abs(at - point[i]) < 0.01));
    holds('it stands where it stood', after.eye.every((at, i) => Math.abs(at - before.eye[i]) <= 2));
    await rests();
    const middle = await browser.eval('viewer.look.pick(320, 240).point');
    holds(`the middle shows ${middle}`, middle.every((at, i) => Math.abs(at - point[i]) < 1));
    await key('0');
  });
  await test('Escape and q lead back to the board', async () => {
    for (const name of ['Escape', 'q']) {
      await key(name);
      await browser.until('viewer === null && machine !== null');
      await browser.click('#act');
      await browser.until('viewer !== null');
    }
    shown = await browser.eval('generation');
  });
  await test('stars and their file are what the command draws', async () => {
    const file = path.join(work, 'stars.xyz');
    fs.writeFileSync(file, Array.from({length: 300}, (_, i) => [i * 7919 % 1009, i * 104729 % 1013, i * 1299709 % 1019].join(' ')).join('\n'));
    await browser.drop([file]);
    await began();
    await finish();
    holds('they are stars', await browser.eval('viewer.view.isStars'));
    const picture = path.join(work, 'stars.ppm');
    spawnSync(thimble, ['render', file, '--size', '640x480', '-o', picture, '--quiet']);
    const rgb = fs.readFileSync(picture).subarray(-3 * 640 * 480).toString('base64');
    is('the picture', await browser.eval(`crc32(Uint8Array.from(atob('${rgb}'), (c) => c.charCodeAt(0)))`), await canvasCrc());
    await browser.eval(`restart({scene: 'castle', dropped: null})`);
    await browser.until(`document.getElementById('said').textContent.startsWith('Castle')`);
    shown = await browser.eval('generation');
  });
  await test('the help names every key, and opens at its first', async () => {
    const named = await browser.eval(`[...document.querySelectorAll('dialog th')].map((cell) => cell.textContent).join('\\n')`);
    await browser.key('?', 'Slash');
    is('how far it is scrolled', await browser.eval(`document.getElementById('dialog').scrollTop`), 0);
    await browser.key('Escape');
    const keys = await browser.eval(`[...APP_KEYS.look.map(([key]) => key), ...Object.keys(FLIGHTS), ' ', '?', 'q', 'Esc', 's']`);
    const shown = (name) => new RegExp(`(^|\\s)${{' ': 'Space', '+': '\\+', '-': '\u2212', '?': '\\?', PageUp: 'Page Up', PageDown: 'Page Down', ArrowUp: 'arrows', ArrowDown: 'arrows', ArrowLeft: 'arrows', ArrowRight: 'arrows'}[name] ?? name}([\\s,]|$)`, 'im').test(named);
    is('keys that it lacks', keys.filter((name) => !shown(name)).join(), '');
    for (const hand of ['drag', 'right or Shift drag', 'double click', 'wheel', 'pinch', 'two fingers']) holds(hand, named.includes(hand));
  });
}
// Where most of the picture is what stands behind: its finished picture comes soon.
async function fromAfar() {
  await browser.until('viewer !== null');
  await browser.eval('orbit.reset(); orbit.approach(6); moved(() => {})');
}
// Until all samples are drawn.
async function finish() {
  await browser.until(`viewer !== null && viewer.phase === 'finished' && viewer.picture.changed[1] === 0`, 90);
}

// A link that holds the view, a picture that is saved.
async function links() {
  await test('a link opened again shows the same picture', async () => {
    await browser.click('#scene-castle');
    await began();
    await choose('mps2-an500');
    await browser.click('#act');
    await began();
    await fromAfar();
    await browser.drag('#canvas', 90, -30);
    await browser.drag('#canvas', -31, 57);
    await browser.wheel('#canvas', -120);
    await finish();
    const wanted = await canvasCrc();
    await browser.click('#link');
    await browser.until(`location.hash.includes('board=mps2-an500')`);
    is('the picture, once the link is made', await canvasCrc(), wanted);
    const link = await browser.eval('location.href');
    const other = browser;
    browser = await Chromium.open(link);
    await finish();
    is('the board', await browser.eval('state.board'), 'mps2-an500');
    is('the picture', await canvasCrc(), wanted);
    await browser.close();
    browser = other;
  });
  await test('the picture that is saved is the one that is shown', async () => {
    await browser.saveIn(work);
    const file = path.join(work, 'thimble-castle.png');
    fs.rmSync(file, {force: true});
    const wanted = await canvasCrc();
    await browser.click('#save');
    for (let i = 0; i < 100 && !fs.existsSync(file); ++i) await pause(50);
    is('its pixels', await browser.pngCrc(file), wanted);
  });
  await test('a link whose file stayed elsewhere asks for it, and then shows its view', async () => {
    const file = path.resolve('tools/gallery/scenes/fox.vox.gz');
    await browser.drop([file]);
    await began();
    await fromAfar();
    await browser.drag('#canvas', 60, 10);
    await finish();
    const wanted = await canvasCrc();
    await browser.click('#link');
    const link = await browser.eval('location.href');
    holds('the link names it', link.includes('file=fox.vox.gz'));
    const other = browser;
    browser = await Chromium.open(link);
    await browser.until(`document.documentElement.dataset.ready === '1'`, 30);
    is('it is requested', await text('said'),
      'This link shows fox.vox.gz, which stayed where it was made: drop that file here.');
    await browser.drop([file]);
    await finish();
    is('the picture', await canvasCrc(), wanted);
    await browser.close();
    browser = other;
    await browser.click('#act');
    await began();
  });
  await test('a broken link shows what of it means something', async () => {
    for (const hash of ['#', '#scene=__proto__&board=toString&look=1', '#look=NaN,1e9,,x,-,0', '#scene=castle&look=1,2,3,4,5,1e400',
      '#scene=particles&look=1', '#%E0%A4%A&board=&depth=99&merge=2', '#file=&look=', '#file=', `#file=${'x'.repeat(9000)}`]) {
      const before = await browser.eval('generation');
      await browser.eval(`location.hash = ${JSON.stringify(hash)}`);
      await browser.until(`generation !== ${before} && document.getElementById('busy').hidden && (machine !== null || viewer !== null)`, 30);
      const said = await text('said');
      holds(`${hash} asks for no file without a name: ${said}`, !/shows ,/.test(said));
      holds(`${hash}: "${said.slice(0, 80)}" is no fault`, /^(Valley|Castle|LM3S|This link shows)|Stellaris|voxels|\.$/.test(said) &&
        await browser.eval(`!document.getElementById('said').classList.contains('wrong')`));
    }
    shown = await browser.eval('Number(document.documentElement.dataset.ready)');
  });
}

async function drops() {
  await test('a dropped file is baked and shown', async () => {
    const file = path.resolve('tools/gallery/scenes/fox.vox.gz');
    await browser.drop([file]);
    await began();
    holds('it says so', (await text('said')).startsWith('fox.vox.gz: '));
    await showsItsFrame(file, 'lm3s6965evb');
  });
  await test('a scene dropped with its model, and baked bytes', async () => {
    await choose('raspi0');
    await browser.drop(['house.vox.gz', 'house.scene'].map((name) => path.resolve('tools/gallery/scenes', name)));
    await began();
    holds('the scene', /^house\.scene: [\d,]+ voxels in/.test(await text('said')));
    const oct = path.join(work, 'dropped.oct');
    spawnSync(thimble, ['bake', 'tools/gallery/scenes/castle.vox', '--board', 'raspi0', '-o', oct, '--quiet']);
    await browser.drop([oct]);
    await began();
    holds('the baked bytes', (await text('said')).startsWith('dropped.oct: 18,235 voxels in 64,588 bytes'));
    await choose('lm3s6965evb');
  });
  await judgeFiles(browser, {work, began, sim, showsItsFrame});
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
  await test('the page lives on while a large file is baked, and leaves it at once', async () => {
    const file = path.join(work, 'large.xyz');
    fs.writeFileSync(file, Array.from({length: 600000}, (_, i) =>
      `${(i * 7919) % 1009} ${(i * 104729) % 1013} ${(i * 1299709) % 1019}`).join('\n'));
    await browser.eval(`window.longest = 0; window.ticks = 0; { let last = performance.now(); const tick_ = (now) => {
      longest = Math.max(longest, now - last); last = now; if (++ticks < 1e6 && window.longest !== null) requestAnimationFrame(tick_); };
      requestAnimationFrame(tick_); }`);
    await browser.drop([file]);
    await browser.until(`farBaker !== null && state.dropped?.title === 'large.xyz'`);
    await browser.eval('longest = 0; ticks = 0');
    await browser.until('ticks > 20 || farBaker === null');
    const {longest, baking} = await browser.eval('({longest, baking: farBaker !== null})');
    holds('it still bakes', baking);
    holds(`the longest frame took ${longest.toFixed(0)} ms`, longest < 1000);
    await browser.click('#scene-castle');
    await browser.until(`document.getElementById('said').textContent.startsWith('Castle: ')`, 10);
    is('what bakes', await browser.eval('farBaker?.worker === undefined || state.dropped === null'), true);
    await pause(500);
    holds('the castle stays', (await text('said')).startsWith('Castle: '));
    await browser.eval('window.longest = null');
    shown = await browser.eval('generation');
    fs.rmSync(file);
  });
  await test('what cannot be read is said in a sentence, and the page works', async () => {
    const file = path.join(work, 'cut.vox');
    fs.writeFileSync(file, fs.readFileSync('tools/gallery/scenes/castle.vox').subarray(0, 3000));
    await browser.drop([file]);
    await began();
    const told = spawnSync(thimble, ['bake', file, '-o', path.join(work, 'never.oct'), '--quiet'], {encoding: 'utf8'});
    is('the sentence', `thimble: ${work}/${await text('said')}`, told.stderr.trim());
    const broken = path.join(work, 'broken.vox.gz');
    fs.writeFileSync(broken, zlib.gzipSync('something').subarray(0, 15));
    const says = async (files, sentence) => {
      await browser.eval(`document.getElementById('said').textContent = ''`);
      await browser.drop(files);
      await browser.until(`document.getElementById('said').textContent !== ''`);
      is('the sentence', await text('said'), sentence);
    };
    await says([broken], 'broken.vox.gz: its gzip data is damaged or truncated');
    const zeros = path.join(work, 'zeros.vox.gz');
    fs.writeFileSync(zeros, zlib.gzipSync(Buffer.alloc(2 ** 28 + 1)));
    await says([zeros], 'zeros.vox.gz: inflates to more than 268,435,456 bytes, which this page does not take');
    const huge = path.join(work, 'huge.vox');
    fs.writeFileSync(huge, '');
    fs.truncateSync(huge, 2 ** 33);
    await says([huge], 'huge.vox: has 8,589,934,592 bytes; this page takes 268,435,456');
    fs.rmSync(huge);
    const folder = path.join(work, 'folder.vox');
    fs.mkdirSync(folder, {recursive: true});
    await says([folder], 'folder.vox: cannot be read here: it is a folder, or it has changed or gone; drop files');
    fs.writeFileSync(path.join(work, 'nan.xyz'), 'nan 1 2\n');
    fs.writeFileSync(path.join(work, 'empty.vox'), '');
    fs.writeFileSync(path.join(work, 'castle.ply'), fs.readFileSync('tools/gallery/scenes/castle.vox').subarray(4));
    for (const name of ['nan.xyz', 'empty.vox', 'castle.ply']) {
      const refused = spawnSync(thimble, ['bake', path.join(work, name), '-o', path.join(work, 'never.oct'), '--quiet'], {encoding: 'utf8'});
      await says([path.join(work, name)], refused.stderr.trim().slice(`thimble: ${work}/`.length));
    }
    shown = await browser.eval('generation');
  });
  await test('files dropped together, in haste, and while a picture is refined', async () => {
    const [castle, fox] = ['castle.vox', 'fox.vox.gz'].map((name) => path.resolve(`tools/gallery/scenes/${name}`));
    await browser.drop([castle, fox]);
    await began();
    holds('the first is shown, and said', /^castle\.vox: .* Of 2 files this one is shown; drop one at a time\.$/.test(await text('said')));
    fs.writeFileSync(path.join(work, 'tent.obj'), 'mtllib tent.mtl\nv 0 0 0\nv 1 0 0\nv 0.5 1 .5\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 2 4 3\n');
    fs.writeFileSync(path.join(work, 'tent.mtl'), 'newmtl red\nKd 1 0 0\n');
    await browser.drop([path.join(work, 'tent.mtl'), path.join(work, 'tent.obj')]);
    await began();
    const told = await text('said');
    holds(`"${told}" is of the mesh, which has its materials`, /^tent\.obj: (takes|[\d,]+ voxels in)/.test(told) && !told.includes('one at a time'));
    await browser.drop([castle]);
    await browser.drop([fox]);
    await browser.until(`document.getElementById('said').textContent.startsWith('fox.vox.gz: ')`, 30);
    await pause(300);
    holds('the last one wins', (await text('said')).startsWith('fox.vox.gz: '));
    shown = await browser.eval('generation');
    await browser.click('#act');
    await began();
    await browser.until(`viewer.phase === 'lit' || viewer.phase === 'fine'`);
    await browser.drop([castle]);
    await began();
    await fromAfar();
    await finish();
    const wanted = await canvasCrc();
    await browser.eval('restart({scene: "castle", dropped: null})');
    await fromAfar();
    await finish();
    is('the picture is that of the demonstration', await canvasCrc(), wanted);
    await browser.click('#act');
    shown = await browser.eval('generation') - 1;
    await began();
    await browser.click('#scene-valley');
    await began();
    await changes('time', () => pause(200));
  });
}

// Every size is turned over while the scene is shown.
const SCREENS = [[360, 640], [412, 915], [768, 1024]].flatMap((upright) => [upright, [...upright].reverse()]);
async function telephone() {
  browser = await Chromium.open(`${url}#scene=castle&board=raspi0&look=1&size=640x480`, {width: 360, height: 640, mobile: true});
  shown = 0;
  await began();
  await fromAfar();
  await finish();
  const wanted = await canvasCrc();
  for (const [width, height] of SCREENS) {
    await test(`on a screen of ${width} x ${height}`, async () => {
      await browser.turnTo(width, height);
      is('width of the page', await browser.eval('document.documentElement.scrollWidth'), width);
      is('the picture is the same', await canvasCrc(), wanted);
      const box = await browser.middle('#canvas');
      holds(`the canvas has its proportions: ${box.width} x ${box.height}`, Math.abs(box.width / box.height - 640 / 480) < 0.01);
      holds('the canvas fits on the screen', box.width <= width && box.height <= height && box.height >= height / 4);
      await browser.eval('scrollTo(0, 0)');
      holds('all of it is on the first screen', await browser.eval(
        `(({top, bottom}) => top >= 0 && bottom <= innerHeight)(canvas.getBoundingClientRect())`));
      if (width < height) holds('it uses the width', box.width >= 0.75 * Math.min(width, 640));
      const hidden = await browser.eval(`document.getElementById('more').open = true; [...document.querySelectorAll('button, select, summary')].filter((element) => {
        if (element.closest('dialog') || element.disabled || !element.checkVisibility()) return false;
        element.scrollIntoView({block: 'center'});
        const box = element.getBoundingClientRect();
        const seen = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
        return box.width < 24 || box.height < 24 || (seen !== element && !element.contains(seen));
      }).map((element) => element.id || element.textContent)`);
      is('what a finger does not reach', hidden.join(), '');
      await browser.eval(`document.getElementById('more').open = false; scrollTo(0, 0)`);
      await browser.shot(path.join(work, `screen_${width}x${height}.png`));
    });
  }
  for (const [width, height] of SCREENS) {
    await test(`fingers on a screen of ${width} x ${height}`, async () => {
      await browser.turnTo(width, height);
      await turnsByFingers();
      await fromAfar();
    });
  }
  await test('a double tap looks at what is there, a button names it', async () => {
    await changes('its own view', () => browser.eval('orbit.reset(); moved(() => {})'));
    const {x, y, width} = await browser.middle('#canvas');
    await changes('a double tap', async () => {
      for (let tap = 0; tap < 2; ++tap) {
        await browser.touch('touchStart', [{x: x + 0.1 * width, y, id: 1}]);
        await browser.touch('touchEnd', []);
      }
    });
    await browser.until(`viewer.phase !== 'moved'`);
    const [target, middle] = await browser.eval('[orbit.target, viewer.look.pick(320, 240).point]');
    holds(`the middle ${middle} is what is turned around, ${target}`, middle.every((at, i) => Math.abs(at - target[i]) < 1));
    await browser.touch('touchStart', [{x, y, id: 1}]);
    await browser.touch('touchEnd', []);
    await browser.click('[data-key="p"]');
    holds('it is named', /^voxel \d+,\d+,\d+: its /.test(await text('said')));
    is('the page keeps its size', await browser.eval('visualViewport.scale'), 1);
  });
  await test('fingers steer a board: a swipe, its buttons, water', async () => {
    await browser.turnTo(412, 915);
    await browser.eval(`restart({scene: 'castle', board: 'mps2-an500', look: false})`);
    await browser.until(`machine !== null && machine.frames > 2`);
    const {x, y} = await browser.middle('#canvas');
    await changes('a swipe', async () => {
      await browser.touch('touchStart', [{x, y, id: 1}]);
      await browser.touch('touchMove', [{x: x + 40, y, id: 1}]);
      await pause(300);
      await browser.touch('touchEnd', []);
    });
    await browser.until('heldButtons() === 0');
    const button = await browser.middle('[data-hold="up"]');
    await changes('a button', async () => {
      await browser.touch('touchStart', [{...button, id: 1}]);
      await pause(300);
      await browser.touch('touchEnd', []);
    });
    await browser.until('heldButtons() === 0');
    await browser.eval(`restart({scene: 'water'})`);
    await browser.until(`machine?.app === 'water' && machine.frames > 2`);
    const sea = await browser.middle('#canvas');
    await changes('a finger in the water', async () => {
      await browser.touch('touchStart', [{x: sea.x, y: sea.y + 20, id: 1}]);
      await browser.touch('touchEnd', []);
    });
  });
  await test('a finger makes it rain, and lets it stop', async () => {
    await browser.eval(`restart({scene: 'water', look: true})`);
    for (const rains of [true, false]) {
      const {x, y} = await browser.middle('[data-key=" "]');
      await browser.touch('touchStart', [{x, y, id: 1}]);
      await browser.touch('touchEnd', []);
      await browser.until(`viewer.plays === ${rains}`);
    }
    await browser.eval(`restart({scene: 'castle', board: 'raspi0', look: true})`);
    await browser.until('viewer !== null');
  });
  await test('turned over with a finger on it', async () => {
    await browser.eval(`document.getElementById('more').open = false`);
    await browser.turnTo(360, 640);
    const {x, y} = await browser.middle('#canvas');
    await browser.touch('touchStart', [{x, y, id: 1}]);
    await browser.touch('touchMove', [{x: x + 30, y, id: 1}]);
    await browser.turnTo(640, 360);
    await browser.touch('touchCancel', []);
    await browser.until('pointers.size === 0');  // no finger is left
    const before = await browser.eval('orbit.text()');
    await pause(200);
    is('the view stands still', await browser.eval('orbit.text()'), before);
    await turnsByFingers();
  });
  await browser.close();
}
async function turnsByFingers() {
  const {x, y} = await browser.middle('#canvas');
  const page = await browser.eval('scrollY');
  await changes('a finger', async () => {
    await browser.touch('touchStart', [{x, y, id: 1}]);
    for (const step of [20, 40, 60]) await browser.touch('touchMove', [{x: x + step, y: y + step / 2, id: 1}]);
    await browser.touch('touchEnd', []);
  });
  const before = await browser.eval('orbit.distance');
  await browser.touch('touchStart', [{x: x - 30, y, id: 1}, {x: x + 30, y, id: 2}]);
  for (const step of [40, 60, 80]) {
    await browser.touch('touchMove', [{x: x - step, y, id: 1}, {x: x + step, y, id: 2}]);
  }
  await browser.touch('touchEnd', []);
  holds('a pinch comes nearer', await browser.eval('orbit.distance') < 0.6 * before);
  is('the page does not scroll or grow under it', await browser.eval('[scrollY, visualViewport.scale].join()'), `${page},1`);
}

// The core's own cases, and pictures whose CRCs every board has.
async function cases() {
  browser = await Chromium.open(`${url}#scene=valley&board=lm3s6965evb`);
  await browser.until(`document.documentElement.dataset.ready === '1'`, 30);
  const wasm = fs.readFileSync(path.join(path.dirname(page), 'modules/cases.wasm')).toString('base64');
  await browser.eval(`state.paused = true; (async () => {
    window.cases = await WebAssembly.compile(Uint8Array.from(atob('${wasm}'), (c) => c.charCodeAt(0))); })()`);
  await judgeCases(await browser.eval('boards'), (board, app) => browser.eval(`(() => {
    const machine = new Machine(cases, {board: boards[${board.index}], app: '${app}', connected: false});
    machine.goOn = false;
    while (machine.step() !== 'ended') {}
    return {status: machine.status, output: machine.output, ...machine.use()}; })()`));
  await browser.close();
}

// From a server, with the headers that shared memory needs and without: the page needs neither.
async function served() {
  const pictures = [];
  for (const headers of [{}, {'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp'}]) {
    const isolated = Object.keys(headers).length !== 0;
    await test(`from a server, ${isolated ? 'isolated' : 'plainly'}: workers draw the same picture`, async () => {
      const asked = [];
      const server = http.createServer((request, response) => {
        asked.push(request.url);
        response.writeHead(200, {'Content-Type': 'text/html', ...headers});
        response.end(fs.readFileSync(page));
      });
      await new Promise((done) => server.listen(0, '127.0.0.1', done));
      browser = await Chromium.open(`http://127.0.0.1:${server.address().port}/#scene=castle&size=640x480&look=-1.2,0.4,500,64,64,30`);
      await browser.until(`document.documentElement.dataset.ready === '1'`, 60);
      is('isolated', await browser.eval('crossOriginIsolated'), isolated);
      await browser.eval('crewSize = 2; restart({})');
      await finish();
      is('workers', await browser.eval('viewer.crew?.workers.length'), 2);
      pictures.push(await canvasCrc());
      is('the picture', pictures.at(-1), pictures[0]);
      is('what the server was sent', asked.join(), '/');
      await browser.close();
      server.close();
      server.closeAllConnections?.();
    });
  }
}

async function calm() {
  browser = await Chromium.open(`${url}#scene=valley&board=lm3s6965evb&size=640x480`, {media: [{name: 'prefers-reduced-motion', value: 'reduce'}]});
  shown = 0;
  await began();
  await test('who wants less motion gets none before asking', async () => {
    await pause(300);
    const before = await canvasCrc();
    await pause(400);
    is('the canvas', await canvasCrc(), before);
    for (const scene of ['water', 'particles']) {
      await browser.click(`#scene-${scene}`);
      await began();
      await pause(300);
      const still = await canvasCrc();
      await pause(300);
      is(scene, await canvasCrc(), still);
    }
    is('what moves by style', await browser.eval('document.getAnimations().length'), 0);
    await changes('who asks', () => browser.click('#pause'));
  });
  await test('who wants less motion asks for frames, too', async () => {
    const film = path.resolve(work, 'film.vox');
    fs.writeFileSync(film, made.vox(16, 3));
    await browser.click('#scene-castle');
    await began();
    await browser.click('#act');
    await began();
    await browser.drop([film]);
    await began();
    await pause(400);
    is('the frame', await browser.eval('state.frame'), null);
    await browser.click('[data-key=" "]');
    await browser.until('state.frame === 2');
  });
  await browser.close();
}

(only === undefined ? judgeOpening(url, thimble, work).then(desktop).then(telephone).then(served).then(() => judgeRefused(page, work)).then(calm).then(cases) :
  {opening: () => judgeOpening(url, thimble, work), desktop, telephone, served, refused: () => judgeRefused(page, work), calm, cases}[only]()).then(() => Chromium.quit()).then(() => end('the page in Chromium')).catch((error) => {
  console.error(`test-web: ${error.message}`);
  Chromium.kill();
  process.exit(1);
});
