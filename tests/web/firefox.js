// Headless Firefox by its own protocol, Marionette, over a socket: no package is needed. As much of it as shows a page.
'use strict';
const {spawn, spawnSync} = require('child_process');
const fs = require('fs');
const net = require('net');
const os = require('os');
const path = require('path');
const {Chromium} = require('./chromium.js');

const NAME = ['firefox-esr', 'firefox'].find((name) => spawnSync(name, ['--version']).status === 0);
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

class Firefox {
  // A browser with one page, of `width` x `height` pixels of the page, each as large as `ratio` of the screen.
  static async open(url, {width = 1280, height = 900, ratio = 1} = {}) {
    const own = new Firefox();
    own.folder = fs.mkdtempSync(path.join(os.tmpdir(), 'thimble-web-'));
    fs.writeFileSync(path.join(own.folder, 'user.js'), 'user_pref("marionette.port", 0);\n' +
      'user_pref("datareporting.policy.dataSubmissionEnabled", false);\nuser_pref("app.update.enabled", false);\n');
    own.process = spawn(NAME, ['--headless', '--no-remote', '--marionette', '--remote-allow-system-access', '--profile', own.folder, 'about:blank'], {stdio: 'ignore'});
    const file = path.join(own.folder, 'MarionetteActivePort');
    for (let i = 0; !fs.existsSync(file) && i < 600; ++i) await pause(100);
    own.socket = net.connect(Number(fs.readFileSync(file, 'utf8')), '127.0.0.1');
    own.socket.on('data', (data) => own.take(data));
    Object.assign(own, {rest: Buffer.alloc(0), next: 0, waiting: new Map()});
    await own.send('WebDriver:NewSession');
    await own.send('WebDriver:SetWindowRect', {width: Math.max(width, 500) + 100, height: height + 300});
    await own.send('WebDriver:Navigate', {url});
    await own.inside('chrome', `const {style, browsingContext} = gBrowser.selectedBrowser;
      Object.assign(style, {minWidth: '0', width: '${width}px', maxWidth: '${width}px', height: '${height}px', maxHeight: '${height}px'});
      browsingContext.overrideDPPX = ${ratio};`);
    await own.send('WebDriver:Refresh');
    return own;
  }
  // Messages are LENGTH:JSON; after a greeting [1, id, error, result] answers [0, id, command, words].
  take(data) {
    this.rest = Buffer.concat([this.rest, data]);
    for (;;) {
      const colon = this.rest.indexOf(58);
      const end = colon + 1 + Number(this.rest.subarray(0, colon));
      if (colon < 0 || this.rest.length < end) return;
      const message = JSON.parse(this.rest.subarray(colon + 1, end));
      const [, id, error, result] = Array.isArray(message) ? message : [];
      this.rest = this.rest.subarray(end);
      const {done, fail} = this.waiting.get(id) ?? {};
      error ? fail?.(new Error(error.message)) : done?.(result);
    }
  }
  send(command, words = {}) {
    const text = JSON.stringify([0, ++this.next, command, words]);
    this.socket.write(`${Buffer.byteLength(text)}:${text}`);
    return new Promise((done, fail) => this.waiting.set(this.next, {done, fail}));
  }
  async inside(context, script) {
    await this.send('Marionette:SetContext', {value: context});
    try {
      return (await this.send('WebDriver:ExecuteScript', {script, args: [], sandbox: null, newSandbox: false})).value;
    } finally {
      await this.send('Marionette:SetContext', {value: 'content'});
    }
  }
  // Its globals are gone with it, but for those of `before`.
  eval(expression) {
    return this.inside('content', `${this.before ?? ''}; return (${expression});`);
  }
  async shot(file) {
    const {value} = await this.send('WebDriver:TakeScreenshot', {full: false});
    fs.writeFileSync(file, Buffer.from(value, 'base64'));
  }
  async close() {
    const ended = new Promise((done) => this.process.on('exit', done));
    this.send('Marionette:Quit', {flags: ['eForceQuit']}).catch(() => {});
    setTimeout(() => this.process.kill('SIGKILL'), 5000).unref();
    await ended;
    this.socket.destroy();
    fs.rmSync(this.folder, {recursive: true, force: true, maxRetries: 5});
  }
}
for (const name of ['until', 'canvasCrc', 'text']) Firefox.prototype[name] = Chromium.prototype[name];

module.exports = {Firefox, hasFirefox: NAME !== undefined};
