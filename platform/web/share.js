// The page of one scene (`thimble render SCENE -o F.html`): its poster at once, then the same scene, turned by hand; or of a
// sheet (`thimble sheet FOLDER -o F.html`), whose pictures open so. Modules and scenes lie in it; share.html has the elements.
'use strict';

const KEY_TURN = Math.PI / 36;
const $ = (id) => document.getElementById(id);
const canvas = $('canvas');
const calm = matchMedia('(prefers-reduced-motion: reduce)');
const embedded = window.self !== window.top;

async function unpack(element) {
  const packed = Uint8Array.from(atob(element.textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// How the scene looks from a camera, by the module that knows the looks alone.
class Looks extends Baker {
  constructor(module, scene, {background, ground}) {
    super(module, []);
    this.x = this.instance();
    this.x.open(this.put(this.x, scene), scene.length, Number(background), Number(ground));
  }
}

class Share {
  constructor({drawing, looking, scenes, turn, wishes, aspect}) {
    Object.assign(this, {drawing, looking, scenes, wishes, aspect, frame: 0, looks: [], exposure: FIRST_EXPOSURE, crew: null});
    this.turns = Number(turn) || 0;  // seconds for one turn
    this.plays = !calm.matches && (this.turns > 0 || scenes.length > 1);
    this.open();
    this.orbit = new Orbit(this.look.point(false), this.look.point(true), 1 << this.look.x.level(), this.look.isParallel());
    this.fit();
  }
  canPlay() {
    return this.turns > 0 || this.scenes.length > 1 || this.look.x.has_water();
  }
  // For the window as it is now, in its own pixels.
  open() {
    this.end();
    const scale = devicePixelRatio || 1;
    const [width, height] = [innerWidth, innerHeight].map((size) => Math.max(1, Math.min(8192, Math.round(size * scale))));
    Object.assign(this, {width, height, step: 1});
    const scene = this.scenes[this.frame];
    this.look = new Look(this.drawing, scene, width, height);
    this.image = new ImageData(width, height);
    this.words = new Uint32Array(this.image.data.buffer);
    Object.assign(canvas, {width, height});
    const count = Math.max(1, Math.min(8, navigator.hardwareConcurrency || 1));
    const workers = Array.from({length: count}, startWorker);
    this.crew = workers.includes(null) ? null : new Crew(workers, {module: this.drawing, scene, width, height}, {
      onBand: (first, bytes) => this.put(first, bytes),
      onEnd: () => this.next(),
      onExposed: (exposure) => this.expose(exposure),
      onFault: () => {
        this.crew = null;
        this.move();
      },
    });
    this.phase = 'moved';
  }
  end() {
    this.crew?.end();
    cancelAnimationFrame(this.asked);
    this.asked = null;
    this.phase = 'ended';
  }
  // Where the window is narrower than the poster its camera stands farther away, so that all of the picture stays in it.
  fit() {
    const times = this.aspect * this.height / this.width;
    this.orbit.reset();
    if (times > 1) this.orbit.approach(times);
    this.fitted = this.orbit.text();
  }
  resize() {
    const untouched = this.orbit.text() === this.fitted;
    this.open();
    if (untouched) this.fit();
    this.move();
  }
  looksOfFrame() {
    return this.looks[this.frame] ??= new Looks(this.looking, this.scenes[this.frame], this.wishes);
  }
  show(frame) {
    this.frame = frame;
    this.look.open(this.scenes[frame]);
    this.crew?.show(this.scenes[frame]);
  }
  // After `change` it looks from elsewhere: what is drawn at rest begins anew.
  move(change = () => {}) {
    change();
    this.crew?.stop();
    this.phase = 'moved';
    this.wake();
  }
  play(plays = !this.plays) {
    this.plays = plays;
    if (!plays) this.look.rain(false);
    this.move();
  }
  wake() {
    this.asked ??= requestAnimationFrame((now) => {
      this.asked = null;
      this.draw(now);
    });
  }
  // What moves by itself: the next frame, rain, a part of a turn. False where it is not time yet.
  advance(now) {
    if (now < (this.nextAt ?? 0)) return false;
    const seconds = Math.min(now - (this.before ?? now), 100) / 1000;
    this.before = now;
    this.nextAt = now + (this.scenes.length > 1 && this.turns === 0 ? FILM_MS : this.turns > 0 ? 0 : FRAME_MS);
    if (this.scenes.length > 1 && now >= (this.filmAt ?? 0)) {
      this.filmAt = now + FILM_MS;
      this.show((this.frame + 1) % this.scenes.length);
    }
    if (this.turns > 0) this.orbit.turn(2 * Math.PI * seconds / this.turns, 0);
    if (this.look.x.has_water()) this.look.rain(true);
    return true;
  }
  draw(now) {
    const moves = this.plays && document.visibilityState === 'visible' && this.advance(now);
    if (this.phase === 'moved' || moves) this.drawFast(now);
    else if (this.phase === 'waits' && !this.plays && now - this.since > REST_MS) this.next();
    if (this.plays || this.phase === 'waits') this.wake();
  }
  drawFast(now) {
    const camera = this.orbit.camera();
    const seen = this.looksOfFrame().look(camera, this.width, this.height, this.exposure);
    if (seen === null || !this.look.see(camera)) return;
    this.look.take(seen.block);
    this.view = {camera, ...seen};
    const began = performance.now();
    this.look.fast(this.step);
    const time = performance.now() - began;
    this.step = stepAfter(this.step, time);
    if (this.hasMoved || this.plays) this.put(0, this.look.rows(0, this.height));
    this.phase = 'waits';
    this.since = now;
    document.body.dataset.phase = this.phase;
  }
  next() {
    this.phase = phaseAfter(this.phase, this.view.isStars);
    document.body.dataset.phase = this.phase;
    if (this.phase === 'finished') return;
    const view = {...this.view, exposure: this.exposure};
    if (this.phase === 'stars') {
      this.put(0, this.looksOfFrame().stars(this.width, this.height));
      this.next();
    } else if (this.crew !== null) {
      this.crew.draw(view, this.phase);
    } else {
      this.drawHere(this.phase, this.view);
    }
  }
  expose(exposure) {
    this.exposure = exposure;
    this.next();
  }
  // Where no worker draws: a few rows at a time.
  async drawHere(phase, view) {
    for (let first = 0, exposure = 0; first < this.height;) {
      await new Promise((done) => setTimeout(done));
      if (this.phase !== phase || this.view !== view) return;
      if (phase === 'expose') {
        exposure = this.look.expose(first++, 1);
        if (exposure !== 0) this.exposure = exposure;
        continue;
      }
      const rows = Math.min(BAND_ROWS[phase], this.height - first);
      this.look.band(phase, first, rows, this.exposure);
      this.put(first, this.look.rows(first, first + rows));
      first += rows;
    }
    this.next();
  }
  // Rows of RGB onto the canvas. Before a hand moved it the poster stays until the last picture is whole.
  put(first, bytes) {
    const from = first * this.width;
    const count = bytes.length / 3;
    for (let i = 0, at = 0; i < count; ++i, at += 3) {
      this.words[from + i] = 0xFF000000 | bytes[at + 2] << 16 | bytes[at + 1] << 8 | bytes[at];
    }
    const rows = count / this.width;
    canvas.getContext('2d').putImageData(this.image, 0, 0, 0, first, this.width, rows);
    const isFinal = this.phase === 'stars' || (this.phase === 'fine' && first + rows === this.height);
    if (this.hasMoved || this.plays || isFinal) document.body.dataset.picture = '';
  }
}

// ---- hands

function listen(share, signal) {
  const on = (target, name, does, options) => target.addEventListener(name, does, {signal, ...options});
  const pointers = new Map();
  let awake = !embedded;  // in somebody's page the wheel is that page's until the picture is clicked
  const wakeUp = (is) => {
    awake = is || !embedded;
    document.body.classList.toggle('asleep', !awake);
  };
  wakeUp(false);
  const move = (change) => {
    share.hasMoved = true;
    share.turns > 0 && (share.plays = share.plays && share.scenes.length > 1);
    share.move(change);
    tell();
  };
  const tell = () => $('play').setAttribute('aria-pressed', String(share.plays));
  const play = () => {
    share.hasMoved = true;
    share.play();
    tell();
  };
  const {orbit} = share;
  on(canvas, 'pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    wakeUp(true);
  });
  on(canvas, 'pointermove', (event) => {
    const pointer = pointers.get(event.pointerId);
    if (pointer === undefined) return;
    const [dx, dy] = [event.clientX - pointer.x, event.clientY - pointer.y];
    const spread = () => {
      const [a, b] = [...pointers.values()];
      return Math.hypot(a.x - b.x, a.y - b.y);
    };
    const before = pointers.size === 2 ? spread() : 0;
    Object.assign(pointer, {x: event.clientX, y: event.clientY});
    const side = Math.min(canvas.clientWidth, canvas.clientHeight);
    move(() => {
      if (pointers.size === 2) {
        orbit.approach(before / Math.max(1, spread()));
        orbit.move(-dx / 2 / side, dy / 2 / side);
      } else if (event.shiftKey || event.buttons > 1) {
        orbit.move(-dx / side, dy / side);
      } else {
        orbit.turn(4 * dx / side, 4 * dy / side);
      }
    });
  });
  for (const end of ['pointerup', 'pointercancel']) on(canvas, end, ({pointerId}) => pointers.delete(pointerId));
  on(canvas, 'contextmenu', (event) => event.preventDefault());
  on(canvas, 'wheel', (event) => {
    if (!awake) return;
    event.preventDefault();
    const notches = event.deltaY / [100, 3, 1][event.deltaMode];
    move(() => orbit.approach(1.1 ** Math.max(-10, Math.min(10, notches))));
  }, {passive: false});
  on(canvas, 'dblclick', ({offsetX, offsetY}) => {
    const scale = share.width / canvas.clientWidth;
    const hit = share.look.pick(Math.floor(offsetX * scale), Math.floor(offsetY * scale));
    if (hit !== null) move(() => orbit.lookAt(hit.point));
  });
  on(window, 'blur', () => wakeUp(false));
  const keys = {
    ArrowLeft: () => orbit.turn(-KEY_TURN, 0), ArrowRight: () => orbit.turn(KEY_TURN, 0),
    ArrowUp: () => orbit.turn(0, KEY_TURN), ArrowDown: () => orbit.turn(0, -KEY_TURN),
    '+': () => orbit.approach(1 / 1.1), '=': () => orbit.approach(1 / 1.1), '-': () => orbit.approach(1.1),
    0: () => share.fit(),
  };
  on(window, 'keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === 'f') fullScreen();
    else if (event.key === ' ' && share.canPlay() && event.target.tagName !== 'BUTTON') play();
    else if (keys[event.key]) move(keys[event.key]);
    else return;
    event.preventDefault();
  });
  const fullScreen = () => (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen?.());
  $('full').hidden = !document.fullscreenEnabled;
  on($('full'), 'click', fullScreen);
  $('play').hidden = !share.canPlay();
  on($('play'), 'click', play);
  $('buttons').hidden = false;
  tell();
  let timer = 0;
  on(window, 'resize', () => {
    clearTimeout(timer);
    timer = setTimeout(() => signal.aborted || share.resize(), 150);
  });
  on(document, 'visibilitychange', () => share.wake());
  on(calm, 'change', () => share.play(false));
}

// ---- one scene, or a sheet whose address says which of its pictures is open

const poster = $('poster');
const figures = [...document.querySelectorAll('figure[data-name]')];
const {title} = document;
let modules = null;
let gone = new AbortController();  // of what is open

async function open(name, packed) {
  const {signal} = gone;
  try {
    modules ??= Promise.all(['look', 'share'].map((module) => unpack($(`module-${module}`)).then(WebAssembly.compile)));
    const [[drawing, looking], ...scenes] = await Promise.all([modules, ...[...packed].map(unpack), poster.decode()]);
    if (signal.aborted) return;
    const {turn, ...wishes} = document.body.dataset;
    const share = new Share({scenes: scenes.slice(0, -1), turn, wishes, drawing, looking,
      aspect: poster.naturalWidth / poster.naturalHeight});
    canvas.hidden = false;
    canvas.setAttribute('aria-label',
      `${name}. Arrows turn it, plus and minus come nearer and go away, 0 is the first view, F the full screen.`);
    share.drawFast(performance.now());
    listen(share, signal);
    share.move();
    window.shared = share;
  } catch (error) {  // the poster stays where scripts may run and WebAssembly may not
    if (!signal.aborted) $('said').textContent = `It cannot be turned here: ${error.message}`;
  }
}
function close() {
  gone.abort();
  gone = new AbortController();
  window.shared?.end();
  for (const hidden of [poster, canvas, $('buttons')]) hidden.hidden = true;
  for (const name of ['phase', 'picture']) delete document.body.dataset[name];
  $('said').textContent = '';
}
function turnTo() {
  const before = document.title;
  const figure = figures.find(({dataset}) => `#${encodeURIComponent(dataset.name)}` === location.hash);
  close();
  document.title = figure?.dataset.name ?? title;
  document.body.classList.toggle('open', figure !== undefined);
  document.body.style.background = figure ? `linear-gradient(${figure.dataset.colors})` : '';
  if (figure === undefined) {
    figures.find(({dataset}) => dataset.name === before)?.querySelector('a').focus();
    return;
  }
  Object.assign(poster, {hidden: false, src: figure.querySelector('img').src, alt: document.title});
  $('close').hidden = false;
  open(document.title, figure.querySelectorAll('script'));
}
if (document.querySelector('main') === null) {
  open(title, document.querySelectorAll('[data-scene]'));
} else {
  for (const {dataset, firstChild} of figures) firstChild.href = `#${encodeURIComponent(dataset.name)}`;
  const leave = () => (location.hash = '');
  $('close').addEventListener('click', leave);
  addEventListener('keydown', ({key}) => key === 'Escape' && leave());
  addEventListener('hashchange', turnTo);
  turnTo();
}
