// A scene to look around in, drawn by workers: the pictures of one thread, and what a change of view leaves of them.
'use strict';
const {Worker} = require('worker_threads');
const {Crew, FarBaker, workerSource} = require('../../platform/web/crew.js');
const {Look, BAND_ROWS} = require('../../platform/web/look.js');
const {Orbit} = require('../../platform/web/orbit.js');
const {test, is, holds} = require('./check.js');

// A worker of Node with the face of a browser's, running the page's own source.
function hire() {
  const worker = new Worker(`const {parentPort} = require('worker_threads');
    const self = {postMessage: (...words) => parentPort.postMessage(...words)};
    parentPort.on('message', (data) => self.onmessage({data}));\n${workerSource()}`, {eval: true});
  const face = {
    postMessage: (data) => worker.postMessage(data),
    terminate: () => worker.terminate(),
  };
  worker.on('message', (data) => face.onmessage({data}));
  worker.on('error', (error) => face.onerror(error));
  return face;
}
const differ = (a, b) => Buffer.compare(Buffer.from(a), Buffer.from(b)) !== 0;

async function crews(modules, bake, scene, files) {
  const [width, height] = [61, 39];
  const {baked, baker} = bake(scene, files);
  const facts = {module: modules.scene, scene: baked, width, height};
  const here = new Look(modules.scene, baked, width, height);
  const orbit = new Orbit(here.point(false), here.point(true), 1 << here.x.level());
  const views = [() => {}, () => orbit.turn(0.7, 0.2), () => orbit.approach(0.6)].map((move) => {
    move();
    const camera = orbit.camera();
    return {camera, ...baker.look(camera, width, height, 320), exposure: 300};
  });
  const alone = ({camera, block, exposure}, kind) => {
    here.see(camera);
    here.take(block);
    for (let row = 0; row < height; row += BAND_ROWS[kind]) here.band(kind, row, Math.min(BAND_ROWS[kind], height - row), exposure);
    return here.rows(0, height).slice();
  };
  for (const size of [1, 3]) {
    await test(`${scene} drawn by ${size} workers is the picture of one thread`, async () => {
      const picture = new Uint8Array(3 * width * height);
      let ended = () => {};
      const crew = new Crew(Array.from({length: size}, hire), facts, {
        onBand: (first, bytes) => picture.set(bytes, 3 * width * first),
        onEnd: () => ended(), onFault: () => ended(),
      });
      for (const view of views) {
        for (const kind of ['coarse', 'lit', 'fine']) {
          picture.fill(1);
          await new Promise((done) => { ended = done; crew.draw(view, kind); });
          is(`${kind}: bytes differ`, differ(picture, alone(view, kind)), false);
        }
        const exposure = await new Promise((done) => { crew.on.onExposed = done; crew.expose(view); });
        is('the exposure', exposure, here.expose());
        let rowByRow = 0;
        for (let row = 0; rowByRow === 0; ++row) rowByRow = here.expose(row, 1);
        is('row by row', rowByRow, exposure);
      }
      crew.end();
    });
  }
  await test(`${scene}: a view that is left costs the bands under way, and leaves none behind`, async () => {
    const picture = new Uint8Array(3 * width * height);
    let ended = () => {};
    let bands = 0;
    const crew = new Crew([hire(), hire()], facts, {
      onBand: (first, bytes) => { ++bands; picture.set(bytes, 3 * width * first); }, onEnd: () => ended(), onFault: () => ended(),
    });
    await new Promise((done) => { ended = done; crew.draw(views[0], 'fine'); });
    crew.draw(views[1], 'fine');
    crew.draw(views[2], 'lit');
    bands = 0;
    picture.fill(1);
    await new Promise((done) => { ended = done; });
    is('rows that are left', crew.left, 0);
    is('bytes differ', differ(picture, alone(views[2], 'lit')), false);
    is('bands', bands, Math.ceil(height / BAND_ROWS.lit));
    is('thrown away', crew.thrownAway, 2);
    crew.draw(views[0], 'lit');
    crew.stop();
    bands = 0;
    while (crew.idle.size < 2) await new Promise((done) => setTimeout(done, 5));
    is('bands after stop', bands, 0);
    crew.end();
  });
  await test('another scene in place of the one before: workers draw it from the next picture on', async () => {
    const other = bake('spheres', []);
    const picture = new Uint8Array(3 * width * height);
    let ended = () => {};
    const crew = new Crew([hire(), hire()], facts, {
      onBand: (first, bytes) => picture.set(bytes, 3 * width * first), onEnd: () => ended(), onFault: () => ended(),
    });
    const seen = {camera: views[1].camera, ...other.baker.look(views[1].camera, width, height, 320), exposure: 300};
    crew.draw(views[0], 'fine');
    for (const [scene, view] of [[other.baked, seen], [baked, views[1]]]) {
      crew.show(scene);
      await new Promise((done) => { ended = done; crew.draw(view, 'lit'); });
      here.open(scene);
      is('bytes differ', differ(picture, alone(view, 'lit')), false);
    }
    crew.end();
  });
  await test('a worker that fails is reported once, and the page draws on its own', async () => {
    let faults = 0;
    const workers = [hire(), hire()];
    await new Promise((done) => {
      const crew = new Crew(workers, {...facts, scene: Uint8Array.from([1, 2, 3])},
        {onBand() {}, onEnd() {}, onFault: () => { ++faults; done(); }});
      crew.draw(views[0], 'lit');
    });
    await new Promise((done) => setTimeout(done, 100));
    is('faults', faults, 1);
  });
  await test('bakes in a worker are those of the page, sentences too', async () => {
    const far = new FarBaker(hire(), modules.bake, []);
    const here_ = bake('spheres', [], 0);
    const there = far.bake('spheres', {index: 0});
    // Asked for while it bakes: answered one after the other.
    const [look, frame] = [far.look(views[0].camera, 64, 48, 300), far.frame(2, 64, 48)];
    is('bytes differ', differ((await there).baked, here_.baked), false);
    is('looks differ', differ((await look).block, here_.baker.look(views[0].camera, 64, 48, 300).block), false);
    is('the view', JSON.stringify(await frame), JSON.stringify(here_.baker.frame(2, 64, 48)));
    const said = await far.bake('nothing.vox', {index: 0}).catch((error) => error.message);
    let wanted = '';
    try {
      bake('nothing.vox', [], 0);
    } catch (error) {
      wanted = error.message;
    }
    is('the sentence', said, wanted);
    holds('there is one', wanted.length > 10);
    far.end();
  });
}

module.exports = {crews};
