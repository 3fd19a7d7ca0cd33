// What moves by itself in Look around, in Chromium: frames of an animation, rain.
'use strict';
const {spawnSync} = require('child_process');
const fs = require('fs');
const path = require('path');
const made = require('./files.js');
const {test, is, holds} = require('./check.js');

// The canvas shows what the command makes that the page says of `file`. Its options.
async function isWhatIsSaid(browser, thimble, what, file) {
  const said = await browser.text('said');
  const [, name, options] = /^It is saved; so makes the same one: thimble render (\S+) (.*) -o picture\.png$/.exec(said) ?? [];
  is('the scene of the command that is said', name, path.basename(file));
  const picture = 'build/web/tests/said.ppm';
  const told = spawnSync(thimble, ['render', file, ...options.split(' '), '-o', picture, '--quiet'], {encoding: 'utf8'});
  is('the command', told.stderr, '');
  const rgb = fs.readFileSync(picture).subarray(-3 * 640 * 480).toString('base64');
  is(`the picture ${what}`, await browser.eval(`crc32(Uint8Array.from(atob('${rgb}'), (c) => c.charCodeAt(0)))`), await browser.canvasCrc());
  return options;
}

// By what test_page.js drives the page with.
async function judgePlays(browser, thimble, {work, began, fromAfar, finish}) {
  const film = path.resolve(work, 'film.vox');
  fs.writeFileSync(film, made.vox(16, 5));
  const frame = () => browser.eval('state.frame');
  const pressed = () => browser.eval(`document.querySelector('[data-key=" "]').getAttribute('aria-pressed')`);
  const goesOn = async () => browser.until(`state.frame !== ${await frame()}`);
  await test('the frames of an animation play, and stop by space; s says the command of what is shown, a link holds it', async () => {
    await browser.drop([film]);
    await began();
    for (const each of [1, 2, 0]) await browser.until(`state.frame === ${each}`);  // by itself, round and round
    is('the button is pressed', await pressed(), 'true');
    await fromAfar();
    await browser.click('[data-key="-"]');
    is('what has the focus after a button of the mouse', await browser.eval('document.activeElement.id'), 'canvas');
    await browser.until('state.frame === 1');
    await browser.key(' ');
    is('the button is pressed', await pressed(), 'false');
    const shown = await frame();
    await finish();
    await browser.key('s');
    const options = await isWhatIsSaid(browser, thimble, 'of a frame', film);
    holds(`the command ${options} has the frame`, options.startsWith(`--frame ${shown} `));
    const wanted = await browser.canvasCrc();
    await browser.click('#link');
    await browser.until(`location.hash.includes('frame=${shown}')`);
    await browser.until(`document.getElementById('said').textContent.includes('clipboard')`);  // else it says so later
    // The link holds the file, too, since it is small.
    const before = await browser.eval('generation');
    await browser.eval(`dispatchEvent(new Event('hashchange'))`);
    await browser.until(`generation > ${before} && viewer !== null`);
    await finish();
    is('the picture of the link', await browser.canvasCrc(), wanted);
    is('its frame', await frame(), shown);
  });
  await test('a picture that is saved while frames play is finished first; then they play', async () => {
    await browser.click('[data-key=" "]');
    await goesOn();
    await browser.key('s');
    await browser.until(`document.getElementById('said').textContent.startsWith('It is saved; ')`, 60);
    await goesOn();
    is('the button is pressed', await pressed(), 'true');
  });
  await test('space presses the button that the keyboard came to; Page Up flies from there, too', async () => {
    await browser.key(' ');
    await browser.eval(`document.querySelector('[data-key="2"]').focus()`);
    await browser.key(' ');
    is('the button is pressed', await pressed(), 'false');
    await browser.until('Math.abs(orbit.yaw - Math.PI / 2) < 0.001');
    await browser.eval(`type('0')`);
    is('its own view is that of the frame', await browser.eval('orbit.camera().eye.join()'), await browser.eval('viewer.look.point(false).join()'));
    const before = await browser.eval('orbit.target[2]');
    await browser.key('PageUp');
    holds('it flies up', await browser.eval('orbit.target[2]') > before + 1);
    is('the focus', await browser.eval('document.activeElement.dataset.key'), '2');
  });
  await test('a frame that cannot be read stops them, in a sentence', async () => {
    await browser.eval(`viewer.next = null; viewer.baker.bakeAhead = async () => { throw new Error('is gone'); }; canvas.focus()`);
    await browser.key(' ');
    await browser.until(`document.getElementById('said').textContent === 'film.vox stops: is gone'`);
    is('the button is pressed', await pressed(), 'false');
  });
  await test('rain falls by space, and nothing of it is left when it stops', async () => {
    await browser.eval(`restart({scene: 'water', dropped: null, frame: null})`);
    await browser.until(`viewer?.look.x.has_water() === 1`);
    is('the button', await browser.eval(`document.querySelector('[data-key=" "]').textContent`), 'Rain');
    is('it is pressed', await pressed(), 'false');
    await fromAfar();
    await browser.eval('canvas.focus()');
    await browser.changes('rain', () => browser.key(' '));
    await browser.changes('more of it', () => {});
    await browser.eval('viewer.nextAt = Infinity');
    await new Promise((done) => setTimeout(done, 300));
    is('what a late frame finds', await browser.eval('viewer.phase'), 'waits');
    await browser.eval('viewer.nextAt = 0');
    is('the button is pressed', await pressed(), 'true');
    await browser.key('s');
    await browser.until(`document.getElementById('said').textContent.startsWith('It is saved; ')`, 60);
    await browser.changes('what plays', () => {});
    await browser.key(' ');
    await finish();
    const fast = `(viewer.look.fast(4), crc32(viewer.look.rows(0, 480)))`;
    is('what moves from there', await browser.eval(fast), await browser.eval(`viewer.look.rain(false), ${fast}`));
    await isWhatIsSaid(browser, thimble, 'of water', 'tools/gallery/scenes/waves.scene');
  });
  await test('where nothing plays there is no button, and space says so', async () => {
    await browser.eval(`restart({scene: 'castle'})`);
    await browser.until(`viewer?.look.x.has_water() === 0`);
    is('the button', await browser.eval(`document.querySelector('[data-key=" "]')`), null);
    await browser.key(' ');
    is('it is said', await browser.text('said'), 'Nothing here plays: it has neither frames nor water.');
  });
}

module.exports = {isWhatIsSaid, judgePlays};
