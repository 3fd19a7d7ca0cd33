// A scene to look around in (tools/web/viewer.cpp): an instance of scene.wasm with bytes of its own, in the page and in each of
// its workers.
'use strict';

const FIRST_EXPOSURE = 320;
const FRAME_MS = 1000 / 30;
const FILM_MS = 100;
const REST_MS = 120;  // without a hand before the picture at rest begins
// What is drawn at rest, one after the other: coarse to fine.
const phaseAfter = (phase, isStars, byGpu = false) => ({waits: isStars ? 'stars' : 'expose', stars: 'finished',
  expose: byGpu ? 'whole' : 'coarse', coarse: 'lit', lit: 'fine', fine: 'finished', whole: 'finished'})[phase];
// Every which pixel a frame that moves draws, by the time that the last one took.
const stepAfter = (step, ms) => (ms > 40 ? Math.min(8, step * (ms > 160 ? 4 : 2)) : ms < 10 && step > 1 ? step / 2 : step);

// Rows of a band: what a worker draws before it hears that the view has moved. `coarse` has every fourth pixel.
const BAND_ROWS = {coarse: 8, lit: 4, fine: 1};
const COARSE = 4;

class Look {
  constructor(module, baked, width, height) {
    this.x = new WebAssembly.Instance(module, {env: {
      flush() {}, running: () => 0, buttons: () => 0, read: () => -1, write() {}, microseconds: () => 0,
    }}).exports;
    Object.assign(this, {width, height, stride: 3 * width});
    this.open(baked);
  }
  // Another scene in place of the one before; it needs a look of its own.
  open(baked) {
    const at = this.x.room(baked.length, this.width, this.height);
    if (at === 0) throw new Error('there is no memory for it here');
    new Uint8Array(this.x.memory.buffer).set(baked, at);
    const wrong = this.x.open();
    if (wrong !== 0) {
      const memory = new Uint8Array(this.x.memory.buffer);
      throw new Error(new TextDecoder().decode(memory.slice(wrong, memory.indexOf(0, wrong))));
    }
  }
  // The scene's own eye or target, in 1/256 voxel.
  point(ofTarget) {
    return [0, 1, 2].map((axis) => this.x.own_camera(ofTarget, axis));
  }
  isParallel() {
    return this.x.is_parallel() !== 0;
  }
  // As options of `thimble render`; `zoom`: Orbit.camera().
  lens(zoom) {
    const raw = this.x.lens();
    return this.isParallel() ? `--projection orthographic --span ${Math.floor(raw * zoom / 256) / 16384}` : `--fov ${raw / 65536}`;
  }
  // What a pixel of the picture shows, `point` in voxels; null for nothing.
  pick(x, y) {
    const at = this.x.pick(x, y);
    if (at === 0) return null;
    const numbers = [...new Int32Array(this.x.memory.buffer, at, 10)];
    const [face, material, color, kind] = numbers.slice(6);
    return {point: numbers.slice(0, 3).map((q8) => q8 / 256), voxel: numbers.slice(3, 6), face, material, color, kind};
  }
  // False, and the view as it was, where there is no such camera (Orbit.camera()).
  see(camera) {
    writeCamera(this.x, camera);
    return this.x.see() !== 0;
  }
  // How it looks from there: a block of Baker.look(). `movedOn`: of an earlier view.
  take(block, movedOn = false) {
    const at = this.x.look_room(block.length);
    if (at === 0) throw new Error('there is no memory for its lights here');
    new Uint8Array(this.x.memory.buffer).set(block, at);
    if (this.x.take_look(movedOn) === 0) throw new Error('its lights are damaged');
  }
  // Sees the exposure of the picture at rest from rows of it: 0 while there are more.
  expose(first = 0, rows = this.height) {
    return this.x.expose(first, rows);
  }
  // The next frame of rain, for fast(); `falls` false: the scene's own water again.
  rain(falls) {
    return this.x.rain(falls) !== 0;
  }
  // Every `step`-th pixel of the whole picture, as bright as its last exposure.
  fast(step) {
    this.x.draw(0, this.height, step, false);
  }
  // A band with all of the light and that exposure, 'fine' with all samples.
  band(kind, first, rows, exposure) {
    this.x.set_exposure(exposure);
    if (kind !== 'fine') this.x.draw(first, rows, kind === 'lit' ? 1 : COARSE, true);
    else for (let row = first; row < first + rows; ++row) this.x.draw_fine(row);
  }
  // Rows of the picture where they lie; the next call may move them.
  rows(first, end) {
    return new Uint8Array(this.x.memory.buffer, this.x.picture() + first * this.stride, (end - first) * this.stride);
  }
}

// In the words of the viewer on the desktop (tools/viewer/open_scene.cpp).
const FACES = ['left face (-x)', 'right face (+x)', 'front face (-y)', 'back face (+y)', 'bottom face (-z)', 'top face (+z)'];
const KINDS = ['', ' metal', ' glass', ' that glows', ' cloud'];
function nameOf({voxel, face, material, color, kind}) {
  return `voxel ${voxel}: ${face < 0 ? 'the eye is in it' : `its ${FACES[face]}`}, material ${material}, ` +
    `#${color.toString(16).padStart(6, '0')}${KINDS[kind]}`;
}

if (typeof module !== 'undefined') {
  var {writeCamera} = require('./baker.js');
  module.exports = {Look, BAND_ROWS, COARSE, nameOf};
}
