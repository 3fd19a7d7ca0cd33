// Workers. None shares a byte with the page: each has its own instance of a module and its own copy of the bytes, so
// they need no headers of a server and work from the disk too.
'use strict';

// What a worker runs: it draws bands of a scene, or bakes one and says how it looks.
function serve(self) {
  let look = null;
  let baker = null;
  let job = -1;
  self.onmessage = ({data}) => {
    if (data.scene) {
      if (look === null) look = new Look(data.module, data.scene, data.width, data.height);
      else look.open(data.scene);
    } else if (data.files) {
      baker = new Baker(data.module, data.files);
    } else if (data.call) {
      let answer;
      try {
        answer = {made: baker[data.call](...data.words)};
      } catch (error) {
        answer = {sentence: error.message};
      }
      self.postMessage(answer);
    } else {
      if (job !== data.job) {
        look.see(data.view.camera);
        look.take(data.view.block);
      }
      job = data.job;
      if (data.kind === 'expose') {
        self.postMessage({job, exposure: look.expose()});
        return;
      }
      look.band(data.kind, data.first, data.rows, data.view.exposure);
      const bytes = look.rows(data.first, data.first + data.rows).slice();
      self.postMessage({job, first: data.first, bytes}, [bytes.buffer]);
    }
  };
}
function workerSource() {
  return `'use strict';\nconst COARSE = ${COARSE};\nconst VIEWS = ${JSON.stringify(VIEWS)};\n` +
    `${[writeCamera, Look, BakeError, Baker].join('\n')}\n(${serve})(self);`;
}
// Null where the browser gives none.
function startWorker() {
  const address = URL.createObjectURL(new Blob([workerSource()], {type: 'text/javascript'}));
  try {
    return new Worker(address);
  } catch {
    return null;
  } finally {
    setTimeout(() => URL.revokeObjectURL(address), 10000);
  }
}

// Draws pictures by bands, each worker one band at a time: a picture that nobody wants any more costs what is under
// way, and its bands are thrown away.
class Crew {
  // `onBand(first, bytes)` for each band, `onEnd()` after the last one, `onExposed(exposure)` after expose(),
  // `onFault()` once where workers do not work.
  constructor(workers, {module, scene, width, height}, {onBand, onEnd, onExposed, onFault}) {
    this.height = height;
    this.scene = scene;
    this.on = {onBand, onEnd, onExposed};
    this.job = 0;
    this.next = this.left = 0;
    this.thrownAway = 0;
    this.ended = false;
    this.workers = workers;
    this.idle = new Set(workers);
    for (const worker of workers) {
      worker.onmessage = ({data}) => this.take(worker, data);
      worker.onerror = worker.onmessageerror = (event) => {
        event.preventDefault?.();
        if (this.ended) return;
        this.end();
        onFault();
      };
      worker.postMessage({module, scene, width, height});
      worker.has = scene;
    }
  }
  // `view`: {camera, block, exposure}, what Orbit.camera(), Baker.look() and Look.expose() gave.
  draw(view, kind) {
    ++this.job;
    Object.assign(this, {view, kind, next: 0, left: this.height});
    for (const worker of [...this.idle]) this.give(worker);
  }
  expose(view) {
    this.draw(view, 'expose');
  }
  stop() {
    ++this.job;
    this.next = this.left = 0;
  }
  // Another scene from the next picture on.
  show(scene) {
    this.stop();
    this.scene = scene;
  }
  give(worker) {
    if (this.left === 0 || this.next === this.height) return;
    if (worker.has !== this.scene) worker.postMessage({scene: worker.has = this.scene});
    const rows = Math.min(BAND_ROWS[this.kind] ?? this.height, this.height - this.next);
    worker.postMessage({job: this.job, view: this.view, kind: this.kind, first: this.next, rows});
    this.next += rows;
    this.idle.delete(worker);
  }
  take(worker, {job, first, bytes, exposure}) {
    this.idle.add(worker);
    if (job === this.job && exposure !== undefined) {
      this.left = 0;
      this.on.onExposed(exposure);
    } else if (job === this.job) {
      const rows = Math.min(BAND_ROWS[this.kind], this.height - first);
      this.left -= rows;
      this.on.onBand(first, bytes);
      if (this.left === 0) this.on.onEnd();
    } else {
      ++this.thrownAway;
    }
    if (this.idle.has(worker)) this.give(worker);
  }
  end() {
    this.stop();
    this.ended = true;
    for (const worker of this.workers) worker.terminate();
    this.idle.clear();
  }
}

// A Baker in a worker, so that the page lives on while a large file is read; end() stops it at once. Calls are answered
// one after the other.
class FarBaker {
  constructor(worker, module, files) {
    this.worker = worker;
    this.here = null;  // a Baker of the page's own, where workers do not work
    this.last = Promise.resolve();
    worker.postMessage({module, files});
    this.hire = () => (this.here ??= new Baker(module, files));
    for (const call of ['bake', 'bakeAhead', 'turn', 'smaller', 'look', 'stars', 'frame', 'image']) {
      this[call] = (...words) => {
        const answer = this.last.then(() => this.ask(call, words));
        this.last = answer.catch(() => {});
        return answer;
      };
    }
  }
  ask(call, words) {
    if (this.here !== null) return this.here[call](...words);
    return new Promise((done, fail) => {
      const {worker} = this;
      worker.onmessage = ({data}) => (data.sentence === undefined ? done(data.made) : fail(new BakeError(data.sentence)));
      worker.onerror = worker.onmessageerror = () => new Promise(() => done(this.hire()[call](...words))).catch(fail);
      worker.postMessage({call, words});
    });
  }
  end() {
    this.worker.terminate();
  }
}

if (typeof module !== 'undefined') {
  var {Look, BAND_ROWS, COARSE} = require('./look.js');
  var {Baker, BakeError, VIEWS, writeCamera} = require('./baker.js');
  module.exports = {Crew, FarBaker, workerSource};
}
