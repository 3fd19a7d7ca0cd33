// The page of one scene (`thimble render SCENE -o F.html`): its poster at once, then the same scene, turned by hand. Modules
// and scenes lie in it; share.html has the elements.
'use strict';

const FIRST_EXPOSURE = 320;
const REST_MS = 120;  // without a hand before the picture at rest begins
const FRAME_MS = 1000 / 30;
const FILM_MS = 100;
const MOST_STEP = 8;
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
    this.crew?.end();
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
    if (time > 40) this.step = Math.min(MOST_STEP, this.step * (time > 160 ? 4 : 2));
    if (time < 8 && this.step > 1) this.step /= 2;
    if (this.hasMoved || this.plays) this.put(0, this.look.rows(0, this.height));
    this.phase = 'waits';
    this.since = now;
    document.body.dataset.phase = this.phase;
  }
  // What is drawn at rest, one after the other: coarse to fine.
  next() {
    this.phase = {waits: this.view.isStars ? 'stars' : 'expose', stars: 'finished', expose: 'coarse', coarse: 'lit',
      lit: 'fine', fine: 'finished'}[this.phase];
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

function listen(share) {
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
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    wakeUp(true);
  });
  canvas.addEventListener('pointermove', (event) => {
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
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, ({pointerId}) => pointers.delete(pointerId));
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('wheel', (event) => {
    if (!awake) return;
    event.preventDefault();
    const notches = event.deltaY / [100, 3, 1][event.deltaMode];
    move(() => orbit.approach(1.1 ** Math.max(-10, Math.min(10, notches))));
  }, {passive: false});
  canvas.addEventListener('dblclick', ({offsetX, offsetY}) => {
    const scale = share.width / canvas.clientWidth;
    const hit = share.look.pick(Math.floor(offsetX * scale), Math.floor(offsetY * scale));
    if (hit !== null) move(() => orbit.lookAt(hit.point));
  });
  addEventListener('blur', () => wakeUp(false));
  const keys = {
    ArrowLeft: () => orbit.turn(-KEY_TURN, 0), ArrowRight: () => orbit.turn(KEY_TURN, 0),
    ArrowUp: () => orbit.turn(0, KEY_TURN), ArrowDown: () => orbit.turn(0, -KEY_TURN),
    '+': () => orbit.approach(1 / 1.1), '=': () => orbit.approach(1 / 1.1), '-': () => orbit.approach(1.1),
    0: () => share.fit(),
  };
  addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === 'f') fullScreen();
    else if (event.key === ' ' && share.canPlay() && event.target.tagName !== 'BUTTON') play();
    else if (keys[event.key]) move(keys[event.key]);
    else return;
    event.preventDefault();
  });
  const fullScreen = () => (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen?.());
  $('full').hidden = !document.fullscreenEnabled;
  $('full').addEventListener('click', fullScreen);
  $('play').hidden = !share.canPlay();
  $('play').addEventListener('click', play);
  $('buttons').hidden = false;
  tell();
  let timer = 0;
  addEventListener('resize', () => {
    clearTimeout(timer);
    timer = setTimeout(() => share.resize(), 150);
  });
  document.addEventListener('visibilitychange', () => share.wake());
  calm.addEventListener('change', () => share.play(false));
}

async function begin() {
  const [drawing, looking, ...scenes] = await Promise.all(
    [$('module-scene'), $('module-share'), ...document.querySelectorAll('[data-scene]')].map(unpack));
  const poster = $('poster');
  const {turn, ...wishes} = document.body.dataset;
  const share = new Share({scenes, turn, wishes, aspect: poster.naturalWidth / poster.naturalHeight,
    drawing: await WebAssembly.compile(drawing), looking: await WebAssembly.compile(looking)});
  canvas.hidden = false;
  share.drawFast(performance.now());
  listen(share);
  share.move();
  window.shared = share;
}
// The poster stays where scripts may run and WebAssembly may not.
$('poster').decode().then(begin).catch((error) => {
  $('said').textContent = `It cannot be turned here: ${error.message}`;
});
