// Headless Chromium by its own protocol over a pipe: no package is needed.
'use strict';
const {spawn} = require('child_process');
const fs = require('fs');
const os = require('os');
const path = require('path');

const codeOf = (key) => (key === ' ' ? 'Space' : key.length > 1 ? key : /\d/.test(key) ? `Digit${key}` : `Key${key.toUpperCase()}`);

// Without a GPU, or with WebGPU by a software adapter.
const GPU_WORDS = [['--disable-gpu'], ['--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader']];

// The browser, which runs until quit().
let program = null;
function start() {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'thimble-web-'));
  const child = spawn('chromium', ['--headless=new', '--no-sandbox', ...GPU_WORDS[Number(Chromium.hasGpu)], '--remote-debugging-pipe',
    `--user-data-dir=${folder}`, '--disable-dev-shm-usage', '--no-first-run', '--disable-background-networking',
    '--hide-scrollbars', 'about:blank'], {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
  const own = {folder, process: child, pages: new Map(), waiting: new Map(), next: 0};
  let rest = '';
  child.stdio[4].on('data', (data) => {
    rest += data;
    for (let end = rest.indexOf('\0'); end >= 0; end = rest.indexOf('\0')) {
      const message = JSON.parse(rest.slice(0, end));
      rest = rest.slice(end + 1);
      if (message.id !== undefined) {
        const {done, fail} = own.waiting.get(message.id);
        own.waiting.delete(message.id);
        message.error ? fail(new Error(message.error.message)) : done(message.result);
      } else {
        own.pages.get(message.sessionId)?.events.push(message);
      }
    }
  });
  return own;
}
function send(method, params = {}, sessionId = undefined) {
  const id = ++program.next;
  program.process.stdio[3].write(JSON.stringify({id, method, params, sessionId}) + '\0');
  return new Promise((done, fail) => program.waiting.set(id, {done, fail}));
}

// A page of it, which shares nothing with others, and has the focus as if it were alone.
class Chromium {
  static hasGpu = false;
  static async open(url, {width = 1280, height = 900, mobile = false, media = [], scripts = true, first = ''} = {}) {
    program ??= start();
    const browser = new Chromium();
    browser.events = [];
    browser.context = await send('Target.createBrowserContext');
    const {targetId} = await send('Target.createTarget', {url: 'about:blank', newWindow: true, ...browser.context});
    browser.session = (await send('Target.attachToTarget', {targetId, flatten: true})).sessionId;
    program.pages.set(browser.session, browser);
    for (const domain of ['Page', 'Runtime', 'Network', 'Log']) await browser.send(`${domain}.enable`);
    await browser.send('Emulation.setFocusEmulationEnabled', {enabled: true});
    await browser.send('Emulation.setDeviceMetricsOverride',
      {width, height, deviceScaleFactor: mobile ? 2 : 1, mobile});
    if (mobile) await browser.send('Emulation.setTouchEmulationEnabled', {enabled: true, maxTouchPoints: 5});
    await browser.send('Emulation.setEmulatedMedia', {features: media});
    if (!scripts) await browser.send('Emulation.setScriptExecutionDisabled', {value: true});
    await browser.send('Page.addScriptToEvaluateOnNewDocument', {source: first});
    await browser.send('Page.navigate', {url});
    return browser;
  }
  send(method, params = {}) {
    return send(method, params, this.session);
  }
  saveIn(downloadPath) {
    return send('Browser.setDownloadBehavior', {behavior: 'allow', downloadPath, ...this.context});
  }
  async eval(expression) {
    const {result, exceptionDetails} = await this.send('Runtime.evaluate',
      {expression, awaitPromise: true, returnByValue: true});
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }
  // Waits until the expression is true.
  async until(expression, seconds = 20) {
    for (const end = Date.now() + 1000 * seconds; Date.now() < end;) {
      if (await this.eval(expression).catch(() => false)) return;
      await new Promise((done) => setTimeout(done, 20));
    }
    throw new Error(`${expression} did not come true within ${seconds} s; the page says: ` +
      await this.eval('document.getElementById("said").textContent').catch(() => 'nothing'));
  }
  // What an element of the page says.
  text(id) {
    return this.eval(`document.getElementById('${id}').textContent`);
  }
  // The CRC-32 of what the canvas shows, as RGB.
  canvasCrc() {
    return this.eval(`(() => {
      const {width, height} = canvas;
      const rgba = canvas.getContext('2d').getImageData(0, 0, width, height).data;
      const rgb = new Uint8Array(3 * width * height);
      for (let from = 0, to = 0; to < rgb.length; ++from) if (from % 4 !== 3) rgb[to++] = rgba[from];
      return crc32(rgb); })()`);
  }
  // The CRC-32 of a picture that was saved, as RGB.
  pngCrc(file) {
    return this.eval(`(async () => {
      const bytes = Uint8Array.from(atob('${fs.readFileSync(file).toString('base64')}'), (c) => c.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes], {type: 'image/png'}));
      const copy = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
      copy.drawImage(bitmap, 0, 0);
      return crc32(copy.getImageData(0, 0, bitmap.width, bitmap.height).data.filter((_, i) => i % 4 !== 3)); })()`);
  }
  async changes(what, act) {
    const before = await this.canvasCrc();
    await act();
    for (let i = 0; i < 100; ++i) {
      if (await this.canvasCrc() !== before) return;
      await new Promise((done) => setTimeout(done, 20));
    }
    throw new Error(`${what} does not change the picture`);
  }
  async shot(file) {
    const {data} = await this.send('Page.captureScreenshot', {format: 'png'});
    fs.writeFileSync(file, Buffer.from(data, 'base64'));
  }
  async middle(selector) {
    return this.eval(`(() => { const element = document.querySelector(${JSON.stringify(selector)});
      element.closest('details:not([open])')?.setAttribute('open', '');  // as a person would
      element.scrollIntoView({block: 'center'}); const box = element.getBoundingClientRect();
      return {x: box.x + box.width / 2, y: box.y + box.height / 2, width: box.width, height: box.height}; })()`);
  }
  async click(selector) {
    const {x, y} = await this.middle(selector);
    for (const type of ['mouseMoved', 'mousePressed', 'mouseReleased']) {
      await this.send('Input.dispatchMouseEvent', {type, x, y, button: 'left', buttons: 1, clickCount: 1});
    }
  }
  async drag(selector, dx, dy, {button = 'left', shift = false} = {}) {
    const {x, y} = await this.middle(selector);
    const event = (type, part) => this.send('Input.dispatchMouseEvent', {type, x: x + dx * part, y: y + dy * part, button,
      buttons: button === 'right' ? 2 : 1, clickCount: 1, modifiers: shift ? 8 : 0});
    await event('mousePressed', 0);
    for (const part of [0.25, 0.5, 0.75, 1]) await event('mouseMoved', part);
    await event('mouseReleased', 1);
  }
  async point(x, y) {
    await this.send('Input.dispatchMouseEvent', {type: 'mouseMoved', x, y});
  }
  async doubleClick(x, y) {
    for (const clickCount of [1, 2]) {
      for (const type of ['mousePressed', 'mouseReleased']) {
        await this.send('Input.dispatchMouseEvent', {type, x, y, button: 'left', buttons: 1, clickCount});
      }
    }
  }
  async wheel(selector, deltaY) {
    const {x, y} = await this.middle(selector);
    await this.send('Input.dispatchMouseEvent', {type: 'mouseWheel', x, y, deltaX: 0, deltaY});
  }
  async key(key, code = codeOf(key), {held = /^(Arrow|Page|[wasd]$)/i.test(key) ? 120 : 20, text = key.length === 1 ? key : undefined} = {}) {
    const windowsVirtualKeyCode = {ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40, Escape: 27, Enter: 13, PageUp: 33, PageDown: 34}[key];
    await this.send('Input.dispatchKeyEvent', {type: 'keyDown', key, code, text, windowsVirtualKeyCode});
    await new Promise((done) => setTimeout(done, held));
    await this.send('Input.dispatchKeyEvent', {type: 'keyUp', key, code, windowsVirtualKeyCode});
  }
  async tab() {
    for (const type of ['keyDown', 'keyUp']) {
      await this.send('Input.dispatchKeyEvent', {type, key: 'Tab', code: 'Tab', windowsVirtualKeyCode: 9});
    }
  }
  async turnTo(width, height) {
    await this.send('Emulation.setDeviceMetricsOverride', {width, height, deviceScaleFactor: 2, mobile: true,
      screenOrientation: {type: width > height ? 'landscapePrimary' : 'portraitPrimary', angle: width > height ? 90 : 0}});
    await this.eval('new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))');
  }
  // As the browser's own zoom does: fewer pixels of the page, each as large as so many of the screen.
  async zoom(ratio) {
    await this.send('Emulation.setDeviceMetricsOverride',
      {width: Math.round(1280 / ratio), height: Math.round(900 / ratio), deviceScaleFactor: ratio, mobile: false});
    await this.eval('new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))');
  }
  async touch(type, points) {
    await this.send('Input.dispatchTouchEvent', {type, touchPoints: points});
  }
  // Files fall on the page, as from a file manager.
  async drop(files) {
    const {x, y} = await this.middle('#screen');
    const data = {items: [], files, dragOperationsMask: 1};
    for (const type of ['dragEnter', 'dragOver', 'drop']) await this.send('Input.dispatchDragEvent', {type, x, y, data});
  }
  async close() {
    program.pages.delete(this.session);
    await send('Target.disposeBrowserContext', this.context);
  }
  static async quit() {
    const ended = new Promise((done) => program.process.on('exit', done));
    send('Browser.close').catch(() => {});
    setTimeout(() => program.process.kill('SIGKILL'), 3000).unref();
    await ended;
    fs.rmSync(program.folder, {recursive: true, force: true, maxRetries: 5});
  }
  static kill() {
    program?.process.kill('SIGKILL');
  }
}

module.exports = {Chromium};
