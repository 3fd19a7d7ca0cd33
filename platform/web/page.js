// The page: a scene to look around in, in the whole window; or a board with one of its applications.
'use strict';

const SCENES = {
  valley: {title: 'Valley', app: 'demo', scene: 'demo', files: []},
  castle: {title: 'Castle', app: 'demo', scene: 'castle.vox', files: ['castle.vox']},
  room: {title: 'Lit room', app: 'demo', scene: 'room.scene', files: ['room.scene']},
  water: {title: 'Water', app: 'water', scene: 'waves.scene', files: ['waves.scene']},
  particles: {title: 'Particles', app: 'particles', scene: null, files: []},
};
// Keys over the UART, a button each.
const APP_KEYS = {
  demo: [['t', 'Turn'], ['l', 'Light'], ['b', 'Build on the chip'], ['s', 'Scene'], ['h', 'Hold a rate']],
  water: [['m', 'Rain'], ['b', 'Drop'], ['t', 'Turn'], ['+', 'Nearer'], ['-', 'Farther'], ['k', 'Calm']],
  particles: [['0', 'No gravity'], ['r', 'Again']],
  look: [['+', 'Nearer'], ['-', 'Farther'], ['0', 'Own view'], ['1', 'Front'], ['2', 'Back'], ['3', 'Left side'],
    ['4', 'Right side'], ['5', 'Top'], ['6', 'Iso'], ['p', 'Name voxel']],
};
const MODULE_OF = {demo: 'scene', water: 'plane', particles: 'plane'};
const MOST_PIXELS = 2 ** 23;  // of the picture in the window
const LINK_BYTES = 8192;  // of a packed model that a link holds
const TURN = 0.15;  // of the first picture, a second
const SLICE_MS = 12;
const RGB888 = 4;  // picture/pixel.h
const TAP_MS = 300;  // shorter `s` saves
// To the right, up, forward, while held.
const FLIGHTS = {w: [0, 0, 1], a: [-1, 0, 0], s: [0, 0, -1], d: [1, 0, 0], PageUp: [0, 1, 0], PageDown: [0, -1, 0],
  ArrowUp: [0, 0, 1], ArrowLeft: [-1, 0, 0], ArrowDown: [0, 0, -1], ArrowRight: [1, 0, 0]};
const $ = (id) => document.getElementById(id);
const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;

const state = {
  scene: 'castle', look: true, board: 'pico', paused: calm, depth: 0, coarsen: false,
  turns: false,  // the camera of Look around, by itself
  size: null,  // of its picture; null: the window's
  frame: null,  // of an animation, in Look around; null: from the first on
  dropped: null,  // {title, scene, files: [{name, bytes}]}
  wanted: null,  // what a link asks for whose file stayed elsewhere
};
let machine = null;  // of the application that runs
let viewer = null;
let orbit = null;
let baked = null;
let table = null;
let boards = [];
let generation = 0;  // of what is shown: what belongs to an older one ends
let nextFrame = 0;
let farBaker = null;  // while it bakes, and says how a scene looks
let crewSize = Math.min(8, navigator.hardwareConcurrency || 1);  // workers, where more than one
const modules = {};
const cache = new Map();

// ---- what lies in the page

// Null where it would have more than `most` bytes.
async function inflate(bytes, most = Infinity) {
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip')).getReader();
  const parts = [];
  let size = 0;
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    parts.push(part.value);
    size += part.value.length;
    if (size > most) {
      reader.cancel();
      return null;
    }
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}
// What bundle.js wrote, unpacked: four bytes in five characters, base 85, whose digits begin at `(`; `}` stands for `<`.
const archives = {};
function archive(id) {
  if (archives[id]) return archives[id];
  const {textContent: text, dataset} = $(id);
  const words = new DataView(new ArrayBuffer(text.length / 5 * 4));
  for (let at = 0; at < text.length; at += 5) {
    let word = 0;
    for (let digit = at; digit < at + 5; ++digit) {
      const code = text.charCodeAt(digit);
      word = word * 85 + (code === 125 ? 60 : code) - 40;
    }
    words.setUint32(at / 5 * 4, word);
  }
  const bytes = unlzma(new Uint8Array(words.buffer));
  let from = 0;
  return archives[id] = new Map(dataset.ends.split(',').map((entry) => {
    const [name, end] = entry.split(':');
    return [name, bytes.subarray(from, from = Number(end))];
  }));
}
async function moduleOf(name) {
  modules[name] ??= WebAssembly.compile(archive('modules').get(`${name}.wasm`));
  return modules[name];
}
// Those of a board, for what is downloaded.
const hasPrograms = (board, app = 'demo') => $('programs').dataset.ends.includes(`${board.name}-${app}-`);
const programsOf = (board) => Object.fromEntries(['demo', 'water'].filter((app) => hasPrograms(board, app)).map((app) =>
  [app, ['plain', 'sun', 'all'].map((set) => archive('programs').get(`${board.name}-${app}-${set}`)).filter((program) => program !== undefined)]));

// ---- what is said

const number = (value) => value.toLocaleString('en');
function say(sentence, wrong = false) {
  $('said').textContent = sentence;
  $('said').classList.toggle('wrong', wrong);
}
function busy(sentence) {
  $('busy').textContent = sentence ?? '';
  $('busy').hidden = sentence === null;
  return new Promise((done) => setTimeout(done, sentence === null ? 0 : 30));
}
function offer(offers) {
  $('offers').replaceChildren(...offers.map(([title, run]) => {
    const button = document.createElement('button');
    button.textContent = title;
    button.onclick = run;
    return button;
  }));
  $('offers').hidden = offers.length === 0;
}
function share(meter, text, used, of) {
  $(text).textContent = `${number(used)} of ${number(of)}`;
  $(meter).value = of === 0 ? 0 : used / of;
}

// ---- from a scene to something that runs

const current = () => state.dropped ?? SCENES[state.scene];
// Of Look around a display as large as the window, in its own pixels.
function shownBoard() {
  if (!state.look) return boards.find((board) => board.name === state.board);
  const ratio = Math.min(devicePixelRatio, Math.sqrt(MOST_PIXELS / (innerWidth * innerHeight)));
  const [width, height] = state.size ?? [innerWidth, innerHeight].map((side) => Math.max(16, Math.round(side * ratio)));
  return {...boards.find(({format}) => format === RGB888), width, height, row_bytes: 3 * width};
}

async function bakeCurrent(board) {
  const own = generation;
  const entry = current();
  if (entry.scene === null) return null;
  const key = [entry.scene, board.name, state.depth, state.coarsen, state.look].join('|');
  if (!state.look && state.dropped === null && cache.has(key)) return cache.get(key);
  await busy(state.look ? `Reading ${entry.title} ...` : `Fitting ${entry.title} onto the board ...`);
  const files = state.dropped?.files ?? entry.files.map((name) => ({name, bytes: archive('modules').get(name)}));
  const programs = state.look ? {} : programsOf(board);
  const code = await moduleOf('bake');
  if (own !== generation) return null;
  const worker = startWorker();
  const baker = worker === null ? new Baker(code, files) : farBaker = new FarBaker(worker, code, files);
  let stays = false;
  try {
    const made = await baker.bake(entry.scene, board, {depth: state.depth, coarsen: state.coarsen, frame: state.frame,
      size: state.look ? [board.width, board.height] : undefined, programs});
    if (programs.demo) Object.assign(made, {image: await baker.image(board), code: board.flash - made.room});
    if (state.dropped === null) cache.set(key, made);
    stays = state.look;
    return {...made, baker};
  } catch (error) {
    if (/bytes too many$/.test(error.message) && !state.coarsen) await offerSmaller(baker, entry, board, error, programs);
    throw error;
  } finally {
    if (!stays) baker.end?.();
  }
}
async function offerSmaller(baker, entry, board, error, programs) {
  const depth = Number(/at depth (\d+)/.exec(error.message)?.[1] ?? 0);
  await busy('Trying smaller depths ...');
  const smaller = await baker.smaller(entry.scene, board, depth, programs);
  const offers = [['Merge voxels until it fits', () => restart({coarsen: true})]];
  if (smaller !== null) {
    error.message += `. Depth ${smaller.level} fits with ${number(smaller.bytes)} bytes.`;
    offers.unshift([`Show it coarser, at depth ${smaller.level}`, () => restart({depth: smaller.level})]);
  }
  error.offers = offers;
}

const AFRESH = {depth: 0, coarsen: false, frame: null};
function restart(changes) {
  Object.assign(state, changes);
  return start();
}

async function start() {
  const own = ++generation;
  closeAll();
  offer([]);
  if (state.look && current().scene === null) state.look = false;
  const board = shownBoard();
  showChoices(board);
  try {
    const made = await bakeCurrent(board);
    if (own !== generation) return;
    baked = made;
    if (state.look) {
      await openViewer(own, made, board);
    } else {
      await openMachine(own, made, board);
    }
    if (own !== generation) return;
    if (!state.look) showGet();
    follow();
    if (machine?.state === 'ended') tellEnd();
    else if (state.wanted === null) say(sentenceOf(made, board));
    else say(`This link shows ${state.wanted.file}, which stayed where it was made: drop that file here.`);
  } catch (error) {
    if (own !== generation) return;
    // Of a board to buy in words for who buys it.
    say(`${current().title}: ${error.message.replace(/^takes ([\d,]+) bytes at depth \d+, \S+ has ([\d,]+) bytes of flash for a scene behind the image: [\d,]+ bytes too many/,
      'takes $1 bytes, and this board has room for $2')}`, true);
    offer(error.offers ?? []);
    prepareCanvas(board);
  } finally {
    if (own === generation) await busy(null);
  }
  document.documentElement.dataset.ready = String(own);
}

function sentenceOf(made, board) {
  if (made === null) return `${board.title}.`;
  const others = state.dropped === null || /\.scene(\.gz)?$/i.test(state.dropped.title) ? 0 :
    state.dropped.files.filter((file) => !BESIDE.test(file.name)).length - 1;
  let text = `${current().title}: ${number(made.voxels)} voxels`;
  if (!state.look) text += ` in ${number(made.bytes)} bytes, depth ${made.level}`;
  if (made.added !== 0) text += `; ${number(made.added)} voxels of solid volume added by merging`;
  if (made.notes !== '') text += `. Note: ${made.notes.replaceAll(`${current().scene}: `, '')}`;
  return `${text}.${state.look ? '' : ` ${board.title}.`}${others > 0 ? ` Of ${others + 1} files this one is shown; drop one at a time.` : ''}`;
}

async function openMachine(own, made, board) {
  const entry = current();
  const app = made?.water && made.kind !== 'generator water' ? 'water' : entry.app ?? 'demo';
  const code = await moduleOf(MODULE_OF[app]);
  if (own !== generation) return;
  machine = new Machine(code, {
    board, app, scene: made?.baked, connected: true, slice_ms: SLICE_MS,
  });
  nextFrame = 0;
  prepareCanvas(board);
  showKeys(app);
  $('uart').textContent = '';
  if (app === 'demo' && calm) machine.type('t');
  machine.step();
  present(true);
}

function closeAll() {
  viewer?.crew?.end();
  viewer?.gpu?.end();
  farBaker?.end();
  flying.clear();
  machine = viewer = farBaker = null;
}

// ---- the canvas

let image = null;
function prepareCanvas(board) {
  const canvas = $('canvas');
  canvas.width = board.width;
  canvas.height = board.height;
  canvas.setAttribute('aria-label', `${current().title} on a display of ${board.width} by ${board.height} pixels`);
  image = canvas.getContext('2d').createImageData(board.width, board.height);
  $('ram').textContent = $('flash').textContent = $('frame').textContent = '–';
  $('ram-meter').value = $('flash-meter').value = 0;
  $('ram-meter').hidden = state.look;
  fit();
}
// Look around: as large as the window. A display: magnified by a whole number where there is room for it.
function fit() {
  const canvas = $('canvas');
  const style = getComputedStyle($('screen'));
  const room = $('screen').clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
  const high = state.look ? innerHeight : Math.max(200, Math.min(innerHeight * 0.66, innerHeight - canvas.parentElement.getBoundingClientRect().top - scrollY -
    parseFloat(style.paddingTop) - parseFloat(style.paddingBottom) - 10));
  let scale = Math.min(room / canvas.width, high / canvas.height);
  const whole = Math.floor(scale * devicePixelRatio);
  if (scale >= 1 && whole >= 1) scale = whole / devicePixelRatio;
  canvas.style.width = `${canvas.width * scale}px`;
  canvas.style.height = `${canvas.height * scale}px`;
  const gaps = $('gaps');
  const board = shownBoard();
  gaps.hidden = state.look || board?.screen !== 1 || scale < 3;  // an OLED shows its pixels
  if (!gaps.hidden) {
    const line = `transparent 0 ${scale - Math.max(1, scale / 6)}px, #0007 0 ${scale}px`;
    Object.assign(gaps.style, {
      width: canvas.style.width, height: canvas.style.height, left: `${canvas.offsetLeft}px`, top: `${canvas.offsetTop}px`,
    });
    gaps.style.background = `repeating-linear-gradient(90deg, ${line}), repeating-linear-gradient(180deg, ${line})`;
    gaps.style.backgroundColor = '#e2f2ff';
  }
}
function put(display, first, end) {
  table.expand(display, first, end, image.data);
  $('canvas').getContext('2d').putImageData(image, 0, 0, 0, first, image.width, end - first);
  if (!$('true').hidden) $('glass').getContext('2d').drawImage($('canvas'), 0, 0);
}
// What the machine has drawn since.
function present(all) {
  const {display} = machine;
  const [first, end] = display.changed;
  if (end > first) {
    put(display, first, end);
    display.changed = [machine.board.height, 0];
  }
  if (machine.output !== '') {
    const uart = $('uart');
    uart.textContent = (uart.textContent + machine.output).slice(-8000);
    machine.output = '';
  }
  if (all) showUse();
  if (machine.state === 'ended') tellEnd();
}
function tellEnd() {
  const why = /error: (.*)/.exec($('uart').textContent)?.[1] ?? `ended with status ${machine.status}`;
  const isLarge = /arena/.test(why);  // a word of the board's
  say(machine.fault !== undefined ? `${machine.app} was stopped: ${machine.fault}.` :
    machine.status === 0 ? `${machine.app} has ended.` :
      `${machine.app}: ${isLarge ? 'needs more memory than this board has; choose another board' : why}.`,
  machine.status !== 0);
  if (!isLarge) offer([['Start again', () => restart({})]]);
}
let lastUse = 0;
function showUse() {
  if (machine.display.pictures !== machine.told) {  // a frame in which nothing changes is not drawn
    machine.told = machine.display.pictures;
    $('frame').textContent = `${machine.frameTime.toFixed(1)} ms`;
  }
  const now = performance.now();
  if (now - lastUse < 500 && $('ram-meter').value !== 0) return;
  lastUse = now;
  const use = machine.use();
  share('ram-meter', 'ram', use.ram, use.ramLimit);
  share('flash-meter', 'flash', baked === null ? 0 : baked.bytes + baked.code, machine.board.flash);
  if (baked === null) $('flash').textContent = 'no scene';
}

function tick(now) {
  requestAnimationFrame(tick);
  if (viewer !== null) {
    lookOn(now);
    return;
  }
  if (machine === null || machine.state === 'ended') return;
  if (machine.state === 'frame') {
    if (machine.saves) savePicture();
    if (now < nextFrame || (state.paused && !machine.wanted)) return;
    machine.wanted = false;
    nextFrame = Math.max(nextFrame + FRAME_MS, now);
  }
  // A tap shorter than a frame counts for one.
  const asks = machine.state === 'frame';
  machine.buttons = heldButtons() | (asks ? tapped : 0);
  if (asks) tapped = 0;
  machine.step();
  present(machine.state === 'frame');
}

// ---- hands

const held = new Map();  // what holds it: the button's bit
let tapped = 0;  // buttons that went down since the last frame
const flying = new Map();  // what holds it: {name} in FLIGHTS
let tappedS = -Infinity;  // when `s` went down alone
let pointed = null;  // the pixel where the pointer was last
const heldButtons = () => [...held.values()].reduce((all, bit) => all | bit, 0);
function hold(by, name) {
  if (viewer !== null) {
    const flight = `Arrow${name[0].toUpperCase()}${name.slice(1)}`;
    stopTurning();
    if (flight in FLIGHTS) flying.set(by, {name: flight, flown: false});
    return;
  }
  held.set(by, BUTTONS[name]);
  tapped |= BUTTONS[name];
  if (machine !== null) machine.wanted = true;
}
// A hand on the picture has it.
function stopTurning() {
  if (!state.turns) return;
  state.turns = false;
  showPause();
}
function letGo(by) {
  held.delete(by);
  // A tap shorter than a frame counts for one.
  const flight = flying.get(by);
  if (flight?.flown === false) flight.ends = true;
  else flying.delete(by);
}
function type(text) {
  if (viewer !== null) {
    if (text === 'q') restart({look: false, frame: null});
    if (text === ' ') playOrStop();
    if (text === '+') moved(() => orbit.approach(0.85));
    if (text === '-') moved(() => orbit.approach(1 / 0.85));
    if (text === '0') moved(() => orbit.reset());
    if (text in VIEWS) showView(viewer, text);
    if ('+-0123456'.includes(text)) stopTurning();
    if (text === 'p') {
      const picked = viewer.look.pick(...pointed ?? [canvas.width >> 1, canvas.height >> 1]);
      say(picked === null ? 'There is nothing under the pointer.' : nameOf(picked));
    }
  } else if (machine !== null) {
    machine.type(text);
    machine.wanted = true;
  }
}

// The key's name in FLIGHTS, whether Shift is held or not.
function flightOf({key}) {
  const name = key.length === 1 ? key.toLowerCase() : key;
  return viewer !== null && Object.hasOwn(FLIGHTS, name) ? name : undefined;
}
const KEY_BUTTONS = {ArrowUp: 'up', ArrowDown: 'down', ArrowLeft: 'left', ArrowRight: 'right', Enter: 'select', ' ': 'select'};
addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || $('dialog').open) return;
  if (event.key === '?') {
    $('dialog').showModal();
    return;
  }
  // What has the focus keeps the keys that it needs itself.
  const own = event.target.closest?.('button, select, summary, input, pre');
  const name = KEY_BUTTONS[event.key];
  const flight = flightOf(event);
  if (flight !== undefined && !own?.matches(flight.length === 1 ? 'select' : 'select, pre')) {
    event.preventDefault();
    stopTurning();
    if (!event.repeat) tappedS = flight === 's' && flying.size === 0 ? event.timeStamp : -Infinity;
    if (!flying.has(flight)) flying.set(flight, {name: flight, flown: flight === 's'});
  } else if (name !== undefined) {
    if (own && (name === 'select' || own.matches('select, pre'))) return;
    event.preventDefault();
    if (viewer === null || event.key !== ' ') hold(event.key, name);
    else if (!event.repeat) type(' ');
  } else if (event.key === 'Escape' && viewer !== null) {
    type('q');
  } else if (event.key.length === 1 && !(own && own.matches('select'))) {
    type(event.key);
  }
});
// Who looks around by a mouse has pressed a button with it, and means the picture by the next key.
addEventListener('click', ({pointerType, target}) => {
  if (state.look && pointerType === 'mouse' && target.closest?.('button')) canvas.focus({preventScroll: true});
});
addEventListener('keyup', ({key, timeStamp}) => {
  const name = key.length === 1 ? key.toLowerCase() : key;
  if (name === 's' && timeStamp - tappedS <= TAP_MS && flying.has(name)) savePicture();
  letGo(key);
  letGo(name);
});
addEventListener('blur', () => {
  held.clear();
  flying.clear();
});

for (const button of document.querySelectorAll('[data-hold]')) {
  const name = button.dataset.hold;
  button.addEventListener('pointerdown', (event) => {
    button.setPointerCapture(event.pointerId);
    hold(button, name);
  });
  for (const end of ['pointerup', 'pointercancel']) button.addEventListener(end, () => letGo(button));
  // Pressed by a key: for a moment.
  button.addEventListener('click', (event) => {
    if (event.detail !== 0) return;
    hold(button, name);
    setTimeout(() => letGo(button), 150);
  });
}

const NOTCH = [100, 3, 1];  // of a wheel, in the units of WheelEvent.deltaMode: pixels, lines, pages
const NOTCH_FACTOR = 0.12;
let turned = 0;  // parts of a notch that water has not taken yet
const pointers = new Map();
const canvas = $('canvas');
function pixelAt(event) {
  const box = canvas.getBoundingClientRect();
  return [Math.floor((event.clientX - box.left) / box.width * canvas.width),
    Math.floor((event.clientY - box.top) / box.height * canvas.height)];
}
canvas.addEventListener('contextmenu', (event) => event.preventDefault());
canvas.addEventListener('pointerdown', (event) => {
  canvas.setPointerCapture(event.pointerId);
  pointed = pixelAt(event);
  stopTurning();
  pointers.set(event.pointerId, {x: event.clientX, y: event.clientY, from: [event.clientX, event.clientY]});
  if (machine?.app === 'water' && pointers.size === 1) type(`${event.button === 0 ? '@' : '!'}${pixelAt(event)}.`);
});
canvas.addEventListener('pointermove', (event) => {
  const pointer = pointers.get(event.pointerId);
  pointed = pixelAt(event);
  if (pointer === undefined) return;
  const [dx, dy] = [event.clientX - pointer.x, event.clientY - pointer.y];
  const before = spread();
  Object.assign(pointer, {x: event.clientX, y: event.clientY});
  if (viewer !== null && pointers.size === 2) {
    moved(() => {
      orbit.approach(before / Math.max(1, spread()));
      orbit.move(-dx / canvas.clientHeight / 3, dy / canvas.clientHeight / 3);
    });
  } else if (viewer !== null && (event.buttons & 6 || event.shiftKey)) {
    moved(() => orbit.move(-dx / canvas.clientHeight / 1.6, dy / canvas.clientHeight / 1.6));
  } else if (viewer !== null) {
    moved(() => orbit.turn(5 * dx / canvas.clientWidth, 4 * dy / canvas.clientWidth));
  } else if (machine?.app === 'water' && pointers.size === 2) {
    goFarther(Math.log(before / Math.max(1, spread())) / NOTCH_FACTOR / 2);
  } else if (machine?.app === 'water') {
    if (event.buttons & 1) type(`@${pixelAt(event)}.`);
  } else {
    steerBy(event.clientX - pointer.from[0], event.clientY - pointer.from[1]);
  }
});
for (const end of ['pointerup', 'pointercancel']) {
  canvas.addEventListener(end, (event) => {
    pointers.delete(event.pointerId);
    held.delete('drag x');
    held.delete('drag y');
  });
}
canvas.addEventListener('dblclick', () => {
  const picked = viewer?.look.pick(...pointed);
  if (picked && picked.face >= 0) moved(() => orbit.lookAt(picked.point));
});
function spread() {
  const [a, b] = [...pointers.values()];
  return b === undefined ? 1 : Math.hypot(a.x - b.x, a.y - b.y);
}
// A drag holds the arrow that it goes along.
function steerBy(dx, dy) {
  const least = 12;
  const set = (by, distance, less, more) => {
    if (Math.abs(distance) < least) held.delete(by);
    else hold(by, distance < 0 ? less : more);
  };
  set('drag x', dx, 'left', 'right');
  set('drag y', dy, 'up', 'down');
}
// A wheel where it does something; elsewhere the page scrolls.
canvas.addEventListener('wheel', (event) => {
  if (viewer === null && machine?.app !== 'water') return;
  event.preventDefault();
  stopTurning();
  goFarther(event.deltaY / NOTCH[event.deltaMode]);
}, {passive: false});
// By notches of a wheel; water takes whole ones.
function goFarther(notches) {
  if (viewer !== null) {
    moved(() => orbit.approach(Math.exp(notches * NOTCH_FACTOR)));
    return;
  }
  turned += notches;
  for (; turned >= 1; --turned) type('-');
  for (; turned <= -1; ++turned) type('+');
}

// ---- files

const MOST_BYTES = 256 * 2 ** 20;  // of a file, inflated
const BESIDE = /\.(mtl|png|jpe?g|webp|ktx2?|tga|bmp|bin)$/i;  // what another file names
let takes = 0;  // what was dropped since wins

// The bytes of a file, inflated; an Error with a sentence where they cannot be had.
async function bytesOf(file) {
  if (file.size > MOST_BYTES) throw new Error(`has ${number(file.size)} bytes; this page takes ${number(MOST_BYTES)}`);
  const bytes = await file.arrayBuffer().then((buffer) => new Uint8Array(buffer), () => {
    throw new Error('cannot be read here: it is a folder, or it has changed or gone; drop files');
  });
  if (bytes[0] !== 0x1f || bytes[1] !== 0x8b) return bytes;
  const inflated = await inflate(bytes, MOST_BYTES).catch(() => {
    throw new Error('its gzip data is damaged or truncated');
  });
  if (inflated === null) throw new Error(`inflates to more than ${number(MOST_BYTES)} bytes, which this page does not take`);
  return inflated;
}
// A small file as a link holds it: gzip, base 64; null where there is more.
async function packedForLink(files) {
  if (files.length > 1 || files[0].bytes.length > 2 ** 20) return null;
  const stream = new Blob([files[0].bytes]).stream().pipeThrough(new CompressionStream('gzip'));
  const packed = new Uint8Array(await new Response(stream).arrayBuffer());
  return packed.length > LINK_BYTES ? null : btoa(String.fromCharCode(...packed)).replace(/\+/g, '-').replace(/\//g, '_').replace(/=/g, '');
}
async function take(list) {
  const own = ++takes;
  const files = [];
  if (list.length === 0) {
    say('No file was dropped: drop one from a folder of yours, or choose Open a file.', true);
    return;
  }
  for (const file of list) {
    try {
      files.push({name: file.name, bytes: await bytesOf(file)});
    } catch (error) {
      if (own === takes) say(`${file.name}: ${error.message}`, true);
      return;
    }
    if (own !== takes) return;
  }
  // A scene comes with its models, a mesh with its materials, pictures and numbers.
  const main = files.find((file) => /\.scene(\.gz)?$/i.test(file.name)) ??
    files.find((file) => !BESIDE.test(file.name)) ?? files[0];
  // `./`: a file, whatever generator has that name.
  Object.assign(state, {dropped: {title: main.name, scene: `./${main.name}`, files, packed: await packedForLink(files)}, ...AFRESH});
  if (own !== takes) return;
  if (state.wanted?.file === main.name) grant(state.wanted);
  state.wanted = null;
  await start();
}
addEventListener('dragover', (event) => {
  event.preventDefault();
  document.body.classList.add('dropping');
});
addEventListener('dragleave', (event) => {
  if (event.relatedTarget === null) document.body.classList.remove('dropping');
});
addEventListener('drop', (event) => {
  event.preventDefault();
  document.body.classList.remove('dropping');
  take([...event.dataTransfer.files]);
});
$('open').onclick = () => $('file').click();
$('file').onchange = () => {
  const files = [...$('file').files];
  $('file').value = '';
  if (files.length !== 0) take(files);
};

// ---- the page's own buttons

function saveAs(name, blob) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
// Of Look around once it is finished, and with the command that makes the same one.
function savePicture() {
  stopTurning();
  if (viewer !== null) {
    viewer.saves = viewer.phase !== 'finished';
    say(viewer.saves ? 'It is saved once it is finished.' : `It is saved; so makes the same one: ${renderCommand()}`);
    if (viewer.saves) return;
    showViewer();  // its last rows may not be on the canvas yet
  } else if (machine !== null) {
    machine.saves = machine.state === 'band';  // of two frames none
    if (machine.saves) return;
  }
  canvas.toBlob((blob) => {
    saveAs(`thimble-${(state.dropped?.title ?? state.scene).replace(/[^\p{L}\p{M}\p{N}._-]+/gu, '-')}.png`, blob);
  });
}
$('save').onclick = savePicture;
$('link').onclick = async () => {
  // Not by location.hash: whoever presses the button sees this view already.
  history.replaceState(null, '', `#${fragment()}`);
  try {
    await navigator.clipboard.writeText(location.href);
    say(state.dropped === null ? 'The link is on the clipboard.' : state.dropped.packed ? `The link is on the clipboard. It holds ${state.dropped.title} itself.` :
      `The link is on the clipboard. ${state.dropped.title} stays here: whoever opens the link drops it there.`);
  } catch {
    say('The link stands in the address bar.');
  }
};
$('help').onclick = () => $('dialog').showModal();
$('pause').onclick = () => {
  if (state.look) state.turns = !state.turns;
  else state.paused = !state.paused;
  showPause();
};
function showPause() {
  $('pause').textContent = !state.look ? 'Pause' : state.turns ? 'Stop' : 'Turn';
  if (state.look) $('pause').removeAttribute('aria-pressed');
  else $('pause').setAttribute('aria-pressed', String(state.paused));
}
$('act').onclick = () => restart({look: !state.look, ...AFRESH});
$('full').onclick = () => $('screen').requestFullscreen();
$('full').hidden = !document.fullscreenEnabled;
$('download').onclick = () => saveAs(imageName(), new Blob([baked.image]));
$('board').onchange = () => restart({board: $('board').value, ...AFRESH});

function showKeys(app, more = []) {
  $('keys').replaceChildren(...[...more, ...APP_KEYS[app]].map(([key, title]) => {
    const button = document.createElement('button');
    button.textContent = title;
    button.dataset.key = key;
    button.title = `key ${key === ' ' ? 'space' : key}`;
    button.onclick = () => type(key);
    return button;
  }));
}
let resized = 0;
addEventListener('resize', () => {
  fit();
  clearTimeout(resized);
  resized = setTimeout(() => {
    const board = viewer === null ? null : shownBoard();
    if (board && (board.width !== viewer.board.width || board.height !== viewer.board.height)) restart({});
  }, 250);
});

// What a link holds: what is shown, and from where.
function fragment() {
  const view = new URLSearchParams(state.dropped === null ? {scene: state.scene} : {file: state.dropped.title});
  if (state.dropped?.packed) view.set('model', state.dropped.packed);
  view.set('board', state.board);
  if (state.depth !== 0) view.set('depth', state.depth);
  if (state.coarsen) view.set('merge', '1');
  if (viewer !== null && isFilm()) view.set('frame', state.frame ?? 0);
  if (state.look) view.set('look', orbit === null || orbit.isOwn || state.turns ? '1' : orbit.text());
  if (state.look && state.turns) view.set('turns', '1');
  if (state.look && state.size !== null) view.set('size', state.size.join('x'));
  return view;
}
// The address shows what the page shows, so that it can be kept and loaded again.
function follow() {
  if (state.wanted !== null) return;  // the file that the address asks for
  const view = fragment();
  if (viewer?.plays) view.delete('frame');
  if (`#${view}` !== location.hash) history.replaceState(null, '', `#${view}`);
}
// Whatever of it means something here.
function readFragment() {
  const view = new URLSearchParams(location.hash.slice(1) || 'look=1&turns=1');
  if (Object.hasOwn(SCENES, view.get('scene') ?? '')) state.scene = view.get('scene');
  if (boards.some((board) => board.name === view.get('board'))) state.board = view.get('board');
  const wishes = {look: null, ...AFRESH, coarsen: view.get('merge') === '1'};
  if (/^([1-9]|1[0-2])$/.test(view.get('depth') ?? '')) wishes.depth = Number(view.get('depth'));
  if (/^\d{1,9}$/.test(view.get('frame') ?? '')) wishes.frame = Number(view.get('frame'));
  wishes.look = view.get('look');
  const size = /^(\d{2,4})x(\d{2,4})$/.exec(view.get('size') ?? '');
  Object.assign(state, {turns: view.get('turns') === '1' && !calm, size: size && size.slice(1).map(Number)});
  state.wanted = view.get('file') ? {...wishes, file: view.get('file').slice(0, 255), model: view.get('model')} : null;
  Object.assign(state, {dropped: null, ...AFRESH, look: false, view: null});
  if (state.wanted === null) grant(wishes);
}
function grant({look, depth, coarsen, frame}) {
  const isLook = look !== null && current().scene !== null;
  Object.assign(state, {depth, coarsen, look: isLook, view: look, frame: isLook && state.dropped !== null ? frame : null});
}
// What the address asks for, and the model that it holds.
async function openAddress() {
  readFragment();
  orbit = null;
  const {model, file} = state.wanted ?? {};
  const packed = /^[\w-]+$/.test(model ?? '') ? Uint8Array.from(atob(model.replace(/-/g, '+').replace(/_/g, '/')), (c) => c.charCodeAt(0)) : [];
  const bytes = await inflate(packed, MOST_BYTES).catch(() => null);
  await (bytes === null ? start() : take([new File([bytes], file)]));
}
addEventListener('hashchange', openAddress);

async function main() {
  table = new Table(await moduleOf('plane'));
  ({boards} = table);
  if (!boards.some(({name}) => name === state.board)) state.board = boards[0].name;
  $('board').replaceChildren(...boards.map((board) => {
    const option = document.createElement('option');
    option.value = board.name;
    option.textContent = `${board.title}: ${board.width} x ${board.height}, RAM ${number(board.ram / 1024)} KiB, ` +
      `flash ${number(board.flash / 1024)} KiB`;
    return option;
  }));
  await openAddress();
  requestAnimationFrame(tick);
}
say('');  // what the page says where no script runs
main().catch((error) => say(`This browser does not run the page: ${error.message}`, true));
