// A scene to look around in: fast while it moves, then lit, coarse to fine, then with all samples a pixel. A part of the
// page, whose state and elements it uses (page.js).
'use strict';

async function openViewer(own, made, board) {
  const code = await moduleOf('scene');
  if (own !== generation) return;
  const look = new Look(code, made.baked, board.width, board.height);
  const side = 1 << look.x.level();
  const view = orbit?.of === current() && orbit.side === side ? !orbit.isOwn && orbit.text() : state.view;
  orbit = new Orbit(look.point(false), look.point(true), side, look.isParallel());
  orbit.of = current();
  if (view) orbit.take(view);
  state.view = null;
  const picture = new Display(board);
  const camera = orbit.camera();
  const seen = await made.baker.look(camera, board.width, board.height, FIRST_EXPOSURE);
  if (own !== generation) return;
  if (seen === null) throw new Error('there is no such view of it');
  look.take(seen.block);
  viewer = {look, board, picture, baker: made.baker, step: look.x.has_map() && board.width * board.height <= 2 ** 20 ? 1 : 4, phase: 'moved', row: 0, crew: null, gpu: null,
    flown: 0, camera, view: {camera, ...seen}, exposure: FIRST_EXPOSURE, asks: false, saves: false,
    frames: made.frames, next: null, nextAt: 0, plays: made.frames > 1 && state.frame === null && !calm};
  hireGpu(viewer);
  hireCrew(viewer, {module: code, scene: made.baked, width: board.width, height: board.height});
  pointed = null;
  prepareCanvas(board);
  if (isFilm()) state.turns = false;
  showPause();
  showKeys('look', isFilm() ? [[' ', 'Play']] : look.x.has_water() ? [[' ', 'Rain']] : []);
  showPlays();
  $('uart').textContent = '';
}
// Workers for what is drawn at rest; where there is one core, or no worker, the page draws it.
function hireCrew(own, scene) {
  const workers = Array.from({length: crewSize > 1 ? crewSize : 0}, startWorker);
  if (workers.length === 0 || workers.includes(null)) return;
  own.crew = new Crew(workers, scene, {
    onBand: (first, bytes) => {
      own.picture.bytes.set(bytes, first * own.picture.stride);
      const [from, end] = own.picture.changed;
      own.picture.changed = [Math.min(from, first), Math.max(end, first + bytes.length / own.picture.stride)];
      own.row += bytes.length / own.picture.stride;
    },
    onEnd: () => nextPicture(own),
    onExposed: (exposure) => exposed(own, exposure),
    onFault: () => {
      own.crew = null;
      if (own.phase !== 'finished') own.phase = 'moved';
    },
  });
}

// How the scene looks from the camera, which the sun follows: one question at a time, the last camera's in the end.
async function askLook(own) {
  const {camera, board} = own;
  const {frame} = state;
  own.asks = true;
  try {
    const seen = await own.baker.look(camera, board.width, board.height, own.exposure);
    if (own !== viewer || seen === null) return;
    own.asks = false;
    if (frame !== state.frame) return;
    own.look.take(seen.block, camera !== own.camera);
    own.view = {camera, ...seen};
  } catch (error) {  // then the picture stays the fast one
    if (own === viewer) say(`${current().title}: ${error.message}`, true);
  }
}
async function askStars(own) {
  const {view, board} = own;
  const bytes = await own.baker.stars(board.width, board.height);
  if (own !== viewer || own.phase !== 'stars' || own.view !== view) return;
  own.picture.bytes.set(bytes);
  own.picture.changed = [0, board.height];
  nextPicture(own);
}
function lookOn(now) {
  const {look, board, crew} = viewer;
  // A frame that took long does not throw the camera across the scene.
  const seconds = Math.min(now - viewer.flown, 100) / 1000;
  viewer.flown = now;
  for (const [by, flight] of flying) {
    if (flight.name === 's' && now - tappedS <= TAP_MS) continue;
    moved(() => orbit.fly(...FLIGHTS[flight.name].map((way) => way * seconds)));
    flight.flown = true;
    if (flight.ends) flying.delete(by);
  }
  if (state.turns && !isFilm()) moved(() => orbit.turn(-TURN * seconds, 0));
  const hasPlayed = isPlaying() && play(now);
  const asks = !viewer.asks && !(isPlaying() && isFilm());  // each frame brings its own look
  if (viewer.phase === 'moved') {
    const camera = orbit.camera();
    if (!look.see(camera)) return;
    viewer.camera = camera;
    if (asks) askLook(viewer);
    if (viewer.gpu === null) drawFast(now);
    else drawMoving(viewer, now);
  } else if (hasPlayed) {
    drawFast(now);
  } else if (viewer.phase === 'waits' && viewer.view.camera !== viewer.camera) {
    if (asks) askLook(viewer);
  } else if (viewer.phase === 'waits' && !isPlaying() && now - viewer.since > REST_MS) {
    follow();
    nextPicture(viewer);
  } else if (crew === null && viewer.phase in PHASES) {
    const first = viewer.row;
    const began = performance.now();
    while (viewer.row < board.height && performance.now() - began < SLICE_MS) {
      if (viewer.phase === 'expose') {
        const exposure = look.expose(viewer.row++, 1);
        if (exposure !== 0) exposed(viewer, exposure);
        continue;
      }
      const rows = Math.min(BAND_ROWS[viewer.phase], board.height - viewer.row);
      look.band(viewer.phase, viewer.row, rows, viewer.exposure);
      viewer.row += rows;
    }
    if (viewer.phase !== 'expose' && viewer.row > first) takeRows(first, viewer.row);
    if (viewer.row === board.height) nextPicture(viewer);
  }
  showViewer();
}
function drawFast(now) {
  const began = performance.now();
  viewer.look.fast(viewer.step);
  const time = performance.now() - began;
  viewer.step = stepAfter(viewer.step, time);
  viewer.phase = 'waits';
  viewer.since = now;
  takeRows(0, viewer.board.height);
  $('frame').textContent = `${time.toFixed(1)} ms${viewer.step > 1 ? `, 1:${viewer.step}` : ''}`;
}

// ---- what moves by itself (tools/viewer/viewer.cpp): frames of an animation, rain

const isFilm = () => viewer.frames > 1;
const isPlaying = () => viewer.plays && !viewer.saves;  // a picture that is to be saved is finished first
function playOrStop() {
  if (!isFilm() && !viewer.look.x.has_water()) {
    say('Nothing here plays: it has neither frames nor water.');
    return;
  }
  viewer.plays = !viewer.plays;
  viewer.nextAt = 0;
  if (!viewer.plays) viewer.look.rain(false);
  moved(() => {});
  showPlays();
}
function showPlays() {
  $('keys').querySelector('[data-key=" "]')?.setAttribute('aria-pressed', String(viewer.plays));
}
// The next frame, where it is time for it. One of an animation is read while the one before is shown.
function play(now) {
  if (isFilm() && viewer.next === null) readFrame(viewer);
  if (now < viewer.nextAt || (isFilm() && !viewer.next?.made)) return false;
  viewer.nextAt = Math.max(viewer.nextAt + (isFilm() ? FILM_MS : FRAME_MS), now);
  if (!isFilm()) return viewer.look.rain(true);
  try {
    showFrame(viewer.next);
  } catch (error) {
    stopFilm(error);
  }
  return false;
}
async function readFrame(own) {
  const {board, exposure} = own;
  const next = own.next = {frame: ((state.frame ?? 0) + 1) % own.frames, camera: orbit.camera(), made: null};
  const {depth, coarsen} = state;
  try {
    next.made = await own.baker.bakeAhead(current().scene, board, {depth, coarsen, frame: next.frame, look: true},
      [next.camera, board.width, board.height, exposure]);
  } catch (error) {
    if (own === viewer) stopFilm(error);
  }
}
function showFrame({frame, camera, made: {seen, ...made}}) {
  viewer.next = null;
  viewer.baker.turn();
  viewer.look.open(made.baked);
  viewer.look.take(seen.block, true);
  viewer.crew?.show(made.baked);
  viewer.view = {camera, ...seen};
  baked = made;
  state.frame = frame;
  orbit.changed();  // its camera stays that of the frame before
  orbit.own = {eye: viewer.look.point(false), target: viewer.look.point(true)};
  moved(() => {});
}
function stopFilm(error) {
  viewer.next = null;
  viewer.plays = false;
  say(`${current().title} stops: ${error.message}`, true);
  showPlays();
}

// What is said while that is drawn.
const PHASES = {expose: 'measures its light', coarse: 'coarse', lit: 'lit', fine: 'all samples'};
function nextPicture(own) {
  own.phase = phaseAfter(own.phase, own.view.isStars, own.gpu !== null);
  own.row = 0;
  if (own.phase === 'stars') askStars(own);
  else if (own.phase === 'whole') drawWhole(own);
  else if (own.phase in PHASES) own.crew?.draw({...own.view, exposure: own.exposure}, own.phase);
  else if (own.saves) savePicture();
}
function exposed(own, exposure) {
  own.exposure = exposure;
  nextPicture(own);
}
// From the instance that draws here.
function takeRows(first, end) {
  const {look, picture} = viewer;
  picture.bytes.set(look.rows(first, end), first * picture.stride);
  picture.changed = [Math.min(picture.changed[0], first), Math.max(picture.changed[1], end)];
}
function showViewer() {
  const {look, board, picture, phase, row} = viewer;
  const [first, end] = picture.changed;
  if (end > first) {
    put(picture, first, end);
    picture.changed = [board.height, 0];
    $('ram').textContent = `${number(look.x.memory.buffer.byteLength)} bytes`;
    share('flash-meter', 'flash', baked.bytes + baked.code, board.flash);
  }
  if (phase in PHASES) $('frame').textContent = `${PHASES[phase]} ${Math.floor(100 * row / board.height)} %`;
  if (phase === 'finished') $('frame').textContent = 'finished';
  document.documentElement.dataset.phase = phase;
}
function moved(change) {
  change();
  if (viewer === null) return;
  viewer.phase = 'moved';
  viewer.crew?.stop();  // what its workers are at is thrown away
}
async function showView(own, name) {
  const view = await own.baker.frame(name, own.board.width, own.board.height);
  if (own === viewer) moved(() => orbit.show(view));
}
// What makes the picture again, but where blocks were merged to fit.
function renderCommand() {
  const {board, look, camera} = viewer;
  const word = (text) => (/^[\w.,:/=-]+$/.test(text) ? text : `'${text.replace(/'/g, `'\\''`)}'`);
  const point = (q8) => q8.map((x) => x / 256).join();
  const own = camera.own ? '' : ` --eye ${point(camera.eye)} --target ${point(camera.target)} ${look.lens(camera.zoom)}`;
  return `thimble render ${word(state.dropped?.title ?? current().scene)}${state.depth ? ` --depth ${state.depth}` : ''}` +
    `${state.frame === null ? '' : ` --frame ${state.frame}`}` +
    ` --size ${board.width}x${board.height}${own} -o picture.png`;
}
