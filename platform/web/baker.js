// The command's readers, bake, framing and looks (tools/web). An instance bakes a scene and knows how that looks; an error
// in a file ends it with a sentence.
'use strict';

class BakeError extends Error {}
// Keys of the named views: NamedView (tools/scene/framing.h).
const VIEWS = {1: 3, 2: 4, 3: 5, 4: 6, 5: 7, 6: 2};

// To where a module's next call takes its camera from (tools/web/look_block.h).
function writeCamera(x, {eye, target, zoom, own}) {
  new Int32Array(x.memory.buffer, x.camera(), 8).set([...eye, ...target, zoom, own ? 1 : 0]);
}

class Baker {
  // `files`: [{name, bytes}], the bytes inflated.
  constructor(module, files) {
    this.module = module;
    this.files = files;
  }

  instance() {
    const memory = () => x.memory.buffer;
    const text = (at, size) => new TextDecoder().decode(new Uint8Array(memory(), at, size));
    // What the C library would ask of a system: a clock, and nothing else.
    const system = {
      clock_time_get: (id, precision, at) => {
        new DataView(memory()).setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
        return 0;
      },
      proc_exit: () => { throw new BakeError('the reader gave up'); },
    };
    const imports = {env: {fail: (at, size) => { throw new BakeError(text(at, size)); }}};
    for (const {module, name} of WebAssembly.Module.imports(this.module)) {
      imports[module] ??= {};
      imports[module][name] ??= system[name] ?? (() => 52);  // not implemented
    }
    const x = new WebAssembly.Instance(this.module, imports).exports;
    x._initialize();
    for (const file of this.files) x.add_file(this.put(x, file.name), this.put(x, file.bytes), file.bytes.length);
    return x;
  }
  // Bytes, or a name, where the instance finds them.
  put(x, what) {
    const bytes = typeof what === 'string' ? new TextEncoder().encode(what + '\0') : what;
    const at = x.room(bytes.length);
    new Uint8Array(x.memory.buffer).set(bytes, at);
    return at;
  }

  // Bakes `scene` for `board`: {bytes, level, voxels, ...}. `options`: depth, coarsen, frame; size: to look around in,
  // in a picture of that size; programs: {demo, water}, lists of the board's, behind one of which it is to lie (then image() joins them).
  bake(scene, board, options = {}) {
    this.x = this.beside = null;  // of a scene that could not be baked there is no look
    const [x, made] = this.bakeIn(null, scene, board, options);
    this.x = x;
    return made;
  }
  // Bakes another frame beside, and says with `seen` how it looks from look()'s `view`; after turn() look() is of it.
  bakeAhead(scene, board, options, view) {
    const {beside} = this;
    this.beside = null;
    const [x, made] = this.bakeIn(beside, scene, board, options);
    this.beside = x;
    return {...made, seen: this.lookIn(x, ...view)};
  }
  turn() {
    [this.x, this.beside] = [this.beside, this.x];
  }
  // In a new instance where there is none.
  bakeIn(given, scene, board, options) {
    try {
      const x = given ?? this.instance();
      for (const [app, list] of Object.entries(options.programs ?? {})) {
        for (const program of list) x.add_program(this.put(x, program), program.length, board.index, app === 'water');
      }
      const size = x.bake(this.put(x, scene), board.index, options.depth ?? 0, options.coarsen ?? false, options.frame ?? -1,
        ...options.size ?? [0, 0]);
      const at = x.baked();
      const memory = new Uint8Array(x.memory.buffer);
      const text = (from) => new TextDecoder().decode(memory.slice(from, memory.indexOf(0, from)));
      return [x, {...JSON.parse(text(x.facts())), notes: text(x.notes()), baked: memory.slice(at, at + size)}];
    } catch (error) {
      if (error instanceof BakeError) throw error;
      throw new BakeError(/memory|out of bounds/.test(error.message) ?
        'does not fit the memory that the browser gives' : `could not be read: ${error.message}`);
    }
  }

  // How the scene that was baked looks from a camera (Orbit.camera()), for Look.take(), and whether it is stars; null
  // where there is no such camera. `exposure`: that of the last finished picture.
  look(...view) {
    return this.lookIn(this.x, ...view);
  }
  lookIn(x, camera, width, height, exposure) {
    writeCamera(x, camera);
    const at = x.look(width, height, exposure);
    if (at === 0) return null;
    return {block: new Uint8Array(x.memory.buffer).slice(at, at + x.look_bytes()), isStars: x.is_stars() !== 0};
  }
  // The finished picture of the last look, of stars.
  stars(width, height) {
    const at = this.x.stars();
    return new Uint8Array(this.x.memory.buffer).slice(at, at + 3 * width * height);
  }
  // The camera of a named view, for Orbit.show().
  frame(view, width, height) {
    const numbers = [...new Int32Array(this.x.memory.buffer, this.x.frame(VIEWS[view], width, height), 7)];
    return {eye: numbers.slice(0, 3), target: numbers.slice(3, 6), zoom: numbers[6]};
  }

  // What was baked behind its program: the file to drag onto the board.
  image(board) {
    const at = this.x.image(board.index, this.put(this.x, board.ending));
    return new Uint8Array(this.x.memory.buffer).slice(at, at + this.x.image_bytes());
  }

  // The greatest smaller depth that fits, as what bake() returns; null where none does.
  smaller(scene, board, depth, programs) {
    for (let level = depth - 1; level >= 1; --level) {
      try {
        return this.bake(scene, board, {depth: level, programs});
      } catch (error) {
        if (!(error instanceof BakeError)) throw error;
        if (!/bytes too many$/.test(error.message)) return null;
      }
    }
    return null;
  }
}

if (typeof module !== 'undefined') {
  module.exports = {Baker, BakeError, VIEWS, writeCamera};
}
