// What is shown, where and on whose terms, in Chromium: every board, every zoom, the address, wheels, and where the page may not run.
'use strict';
const fs = require('fs');
const http = require('http');
const path = require('path');
const {Chromium} = require('./chromium.js');
const {test, is, holds} = require('./check.js');
const made = require('./files.js');

// By what test_page.js drives the page with.
async function judgeShown(browser, {work, began, choose, showsItsFrame, reloaded}) {
  for (const {name} of await browser.eval('boards')) {
    await test(`the canvas shows a frame of the simulator on ${name}`, async () => {
      await browser.eval(`restart({scene: 'valley', board: '${name}', paused: false})`);
      await began();
      const wrong = await browser.eval(`document.getElementById('said').classList.contains('wrong')`);
      if (wrong) return holds('it says why', (await browser.text('said')).includes('bytes'));
      await showsItsFrame('demo', name);
      holds('it shows something', await browser.eval(`new Set(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.filter((_, i) => i % 4 !== 3)).size > 1`));
    });
  }
  await test('whatever the zoom, a display is seen whole', async () => {
    for (const ratio of [0.25, 0.33, 0.5, 0.67, 0.8, 0.9, 1, 1.1, 1.5, 2, 3, 5]) {
      await browser.zoom(ratio);
      for (const [name, width, height] of [...(await browser.eval('boards')).map((board) => [board.name, board.width, board.height]), ['look', 640, 480]]) {
        await browser.eval(`restart({scene: 'castle', look: ${name === 'look'}, board: '${name === 'look' ? 'raspi0' : name}'})`);
        await began();
        const box = await browser.middle('#canvas');
        const [room, seen] = await browser.eval(`[document.getElementById('screen').clientWidth, innerHeight]`);
        holds(`${name} at ${ratio}: ${box.width} x ${box.height} in ${room} x ${seen}`, box.width > 30 && box.width <= room &&
          box.height <= Math.max(seen, 240) && Math.abs(box.width / box.height - width / height) < 0.02 * width / height);
        holds(`${name} at ${ratio} has whole pixels`, box.width < width || box.width * ratio < width || Math.abs(box.width * ratio / width - Math.round(box.width * ratio / width)) < 0.01);
      }
    }
    await browser.zoom(1);
    await browser.eval(`restart({scene: 'castle', look: false, board: 'lm3s6965evb'})`);
    await began();
  });
  await test('an application that ends in its first step says why', async () => {
    await browser.eval(`restart({scene: 'water', board: 'microbit'})`);
    await began();
    is('it has ended', await browser.eval('machine.state'), 'ended');
    const said = await browser.text('said');
    holds(`"${said}" says why`, /^water: (?!ended).{10,}\.$/.test(said) && await browser.eval(`document.getElementById('said').classList.contains('wrong')`));
    is('the offer', await browser.eval(`document.getElementById('offers').textContent`), '');
    await browser.eval(`restart({scene: 'castle', board: 'lm3s6965evb'})`);
    await began();
    await browser.eval(`machine.type('q')`);
    await browser.until(`document.getElementById('said').textContent === 'demo has ended.'`);
    is('the offer', await browser.eval(`document.getElementById('offers').textContent`), 'Start again');
    await browser.click('#offers button');
    await began();
  });
  await test('the address follows what is shown, and shows it again', async () => {
    const entries = await browser.eval('history.length');
    await browser.click('#scene-room');
    await began();
    is('the address', await browser.eval('location.hash'), '#scene=room&board=lm3s6965evb');
    await choose('mps2-an500');
    is('another board', await browser.eval('location.hash'), '#scene=room&board=mps2-an500');
    await browser.eval(`restart({scene: 'castle', look: true})`);
    await began();
    await browser.drag('#canvas', 60, 20);
    await browser.until(`location.hash.includes('look=' + encodeURIComponent(orbit.text()))`);
    is('entries of the history', await browser.eval('history.length'), entries);
    const view = await browser.eval('orbit.text()');
    await browser.send('Page.reload');
    await reloaded();
    is('the view after loading it again', await browser.eval('orbit.text()'), view);
    await browser.eval(`restart({scene: 'castle', look: false, board: 'lm3s6965evb'})`);
    await began();
  });
  await test('forced colours show what is chosen, and leave the picture', async () => {
    for (const scheme of ['light', 'dark']) {
      await browser.send('Emulation.setEmulatedMedia', {features: [{name: 'forced-colors', value: 'active'}, {name: 'prefers-color-scheme', value: scheme}]});
      const [chosen, other, gaps] = await browser.eval(`[document.querySelector('[aria-pressed="true"]'), document.querySelector('nav [aria-pressed="false"]'),
        document.getElementById('gaps')].map((element) => { const {backgroundColor, forcedColorAdjust} = getComputedStyle(element);
          return element.id === 'gaps' ? forcedColorAdjust : backgroundColor; })`);
      holds(`${scheme}: what is chosen is ${chosen}, others ${other}`, chosen !== other);
      is('gaps', gaps, 'none');
      await browser.shot(path.join(work, `forced_${scheme}.png`));
    }
    await browser.send('Emulation.setEmulatedMedia', {features: []});
  });
}
// Names of files, and what is saved of a board.
async function judgeFiles(browser, {work, began, sim, showsItsFrame}) {
  await test('glTF with its picture inside, and its numbers without their picture', async () => {
    const file = path.join(work, 'tent.glb');
    fs.writeFileSync(file, made.glb());
    await browser.eval(`restart({board: 'raspi0'})`);
    await began();
    await browser.drop([file]);
    await began();
    await showsItsFrame(file, 'raspi0');
    for (const [name, bytes] of [['alone.gltf', JSON.stringify(made.gltf())], ['tent.bin', made.NUMBERS]]) fs.writeFileSync(path.join(work, name), bytes);
    await browser.drop(['tent.bin', 'alone.gltf'].map((name) => path.join(work, name)));
    await began();
    const said = await browser.text('said');
    holds(`"${said}" notes what is missing`, /^alone\.gltf: [\d,]+ voxels .*\. Note: image 0: the file 'sub\/tent%2Epng' .* drop it together/.test(said));
    await browser.eval(`restart({scene: 'castle', dropped: null, board: 'lm3s6965evb'})`);
    await began();
  });
  await test('names keep their letters: in what is said, in the link, and of what is saved', async () => {
    const name = 'Бур\u00e4g \u5bff 1.vox';
    const file = path.join(work, name);
    fs.copyFileSync('tools/gallery/scenes/castle.vox', file);
    await browser.drop([file]);
    await began();
    holds('it is said', (await browser.text('said')).startsWith(`${name}: `));
    is('the link', await browser.eval(`new URLSearchParams(location.hash.slice(1)).get('file')`), name);
    await browser.saveIn(work);
    const saved = path.join(work, `thimble-${name.replace(/ /g, '-')}.png`);
    fs.rmSync(saved, {force: true});
    await browser.click('#save');
    for (let i = 0; i < 100 && !fs.existsSync(saved); ++i) await new Promise((done) => setTimeout(done, 50));
    holds('it is saved', fs.existsSync(saved));
  });
  await test('a scene dropped without its model names the model', async () => {
    await browser.drop([path.resolve('tools/gallery/scenes/house.scene')]);
    await began();
    is('the sentence', await browser.text('said'), 'house.scene: house.vox.gz: is not here: drop it together with the file that names it');
  });
  await test('a picture of a board that is saved in the middle of a frame is a whole one', async () => {
    await browser.eval(`restart({scene: 'room', dropped: null, board: 'mps2-an500', look: false})`);
    await began();
    await browser.until(`machine !== null && machine.state === 'band'`);
    const file = path.join(work, 'thimble-room.png');
    fs.rmSync(file, {force: true});
    const state = await browser.eval(`new Promise((done) => { const look = () => {
      if (machine.state !== 'band') return requestAnimationFrame(look);
      $('save').click(); done(machine.state); }; look(); })`);
    is('the state', state, 'band');
    await browser.until('!machine.saves');
    const frame = await browser.eval('machine.frames');
    for (let i = 0; i < 100 && !fs.existsSync(file); ++i) await new Promise((done) => setTimeout(done, 50));
    const crc = await browser.pngCrc(file);
    holds(`${crc} is a frame about the ${frame}th of the simulator`, [frame - 1, frame, frame + 1].filter((count) => count > 0)
      .some((count) => sim('tools/gallery/scenes/room.scene', 'mps2-an500', 'demo', count) === crc));
    await browser.eval(`restart({scene: 'castle', dropped: null, board: 'lm3s6965evb'})`);
    await began();
  });
}
// Wheels of every kind. `browser.wheel` is a mouse's, in pixels; others are events as a browser sends them.
async function judgeWheels(browser, {began}) {
  const tell = (deltaY, deltaMode, count = 1) => browser.eval(`(() => { let left = 0; for (let i = 0; i < ${count}; ++i) {
    const event = new WheelEvent('wheel', {deltaY: ${deltaY}, deltaMode: ${deltaMode}, bubbles: true, cancelable: true});
    canvas.dispatchEvent(event); left += event.defaultPrevented ? 0 : 1; } return left; })()`);
  await test('a wheel goes by what it turned: 40 events of a touchpad are one notch, as 3 lines are, or a page', async () => {
    await browser.eval(`restart({scene: 'castle', look: true})`);
    await began();
    const distance = () => browser.eval('orbit.distance');
    for (const [deltaY, mode, count] of [[2.5, 0, 40], [100, 0, 1], [3, 1, 1], [1, 2, 1]]) {
      await browser.eval('orbit.reset(); moved(() => {})');
      const before = await distance();
      is('events left to the page', await tell(deltaY, mode, count), 0);
      const factor = await distance() / before;
      holds(`${count} of ${deltaY} in mode ${mode}: ${factor}`, Math.abs(factor - Math.exp(0.12)) < 0.001);
    }
    await browser.eval('orbit.reset()');
    await browser.changes('a mouse', () => browser.wheel('#canvas', -120));
    await browser.eval(`restart({look: false})`);
    await began();
  });
  await test('where a wheel does nothing the page scrolls', async () => {
    for (const scene of ['castle', 'particles']) {
      await browser.eval(`restart({scene: '${scene}'})`);
      await began();
      is(`${scene}: events left to the page`, await tell(100, 0, 3), 3);
    }
  });
  await test('water takes whole notches, and a pinch', async () => {
    await browser.eval(`restart({scene: 'water', board: 'mps2-an500'})`);
    await began();
    await browser.eval(`window.typed = ''; { const type_ = machine.type.bind(machine); machine.type = (text) => { typed += text; type_(text); }; }`);
    is('events left to the page', await tell(2.5, 0, 100), 0);
    is('a touchpad, 2.5 notches away', await browser.eval('typed'), '--');
    await tell(-300, 0);
    is('and 3 back', await browser.eval('typed'), '--++');
    await browser.eval(`typed = ''; turned = 0`);
    await browser.send('Emulation.setTouchEmulationEnabled', {enabled: true, maxTouchPoints: 5});
    const {x, y} = await browser.middle('#canvas');
    const fingers = (type, apart) => browser.touch(type, apart === 0 ? [] : [{x: x - apart, y, id: 1}, {x: x + apart, y, id: 2}]);
    await browser.touch('touchStart', [{x: x - 20, y, id: 1}]);
    await fingers('touchStart', 20);
    for (const apart of [25, 30, 40, 50, 60]) await fingers('touchMove', apart);
    await browser.until(`/\\+/.test(typed)`);
    holds(`a pinch: ${await browser.eval('typed')}`, /^@\d+,\d+\.\++$/.test(await browser.eval('typed')));
    // What the last moves call for is typed a frame later.
    await browser.eval(`new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))`);
    await browser.eval(`typed = ''`);
    for (const apart of [50, 40, 30, 25, 20]) await fingers('touchMove', apart);
    await fingers('touchEnd', 0);
    holds(`and together again: ${await browser.eval('typed')}`, /^-+$/.test(await browser.eval('typed')));
    await browser.send('Emulation.setTouchEmulationEnabled', {enabled: false});
    await browser.eval(`restart({scene: 'castle', board: 'lm3s6965evb'})`);
    await began();
  });
}
// Where the page may not run, its own sentence stands there.
async function judgeRefused(page, work) {
  let browser = null;
  const sentence = async () => {
    const {root} = await browser.send('DOM.getDocument', {depth: -1});
    const {nodeId} = await browser.send('DOM.querySelector', {nodeId: root.nodeId, selector: '#said'});
    return (await browser.send('DOM.getOuterHTML', {nodeId})).outerHTML.replace(/<[^>]*>/g, '').replace(/\s+/g, ' ');
  };
  for (const [what, policy, wanted] of [['its scripts', `default-src 'none'`, /does not let it run them/],
    ['all but its style', `default-src 'none'; style-src 'unsafe-inline'`, /does not let it run them/],
    ['WebAssembly', `script-src 'unsafe-inline'; worker-src blob:`, /^This browser does not run the page: .*(Security|wasm)/i]]) {
    await test(`a server that refuses ${what}: the page says so`, async () => {
      const server = http.createServer((request, response) => {
        response.writeHead(200, {'Content-Type': 'text/html', 'Content-Security-Policy': policy});
        response.end(fs.readFileSync(page));
      });
      await new Promise((done) => server.listen(0, '127.0.0.1', done));
      browser = await Chromium.open(`http://127.0.0.1:${server.address().port}/`);
      await browser.until(`document.readyState === 'complete' && document.getElementById('said').textContent !== ''`);
      const said = await sentence();
      holds(`"${said}" says it`, wanted.test(said));
      await browser.shot(path.join(work, `refused_${what.replace(/\W+/g, '_')}.png`));
      await browser.close();
      server.close();
      server.closeAllConnections?.();
    });
  }
  await test('a browser without scripts: the page says so', async () => {
    browser = await Chromium.open(`file://${path.resolve(page)}`, {scripts: false});
    await new Promise((done) => setTimeout(done, 1000));
    holds('it says it', /does not let it run them/.test(await sentence()));
    await browser.close();
  });
}

module.exports = {judgeShown, judgeFiles, judgeWheels, judgeRefused};
