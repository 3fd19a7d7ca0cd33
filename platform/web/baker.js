// The command's readers and bake (tools/web), for files that were dropped. An instance bakes one scene and is thrown
// away: an error in a file ends it with a sentence.
'use strict';

class BakeError extends Error {}

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
    return x;
  }

  // Bakes `scene` for `board`: {bytes, level, voxels, ...}. `options`: depth, coarsen.
  bake(scene, board, options = {}) {
    const x = this.instance();
    const put = (bytes) => {
      const at = x.room(bytes.length);
      new Uint8Array(x.memory.buffer).set(bytes, at);
      return at;
    };
    const name = (text) => put(new TextEncoder().encode(text + '\0'));
    try {
      for (const file of this.files) x.add_file(name(file.name), put(file.bytes), file.bytes.length);
      const size = x.bake(name(scene), board.index, options.depth ?? 0, options.coarsen ?? false);
      const at = x.baked();
      const memory = new Uint8Array(x.memory.buffer);
      const facts = x.facts();
      const end = memory.indexOf(0, facts);
      const found = JSON.parse(new TextDecoder().decode(memory.slice(facts, end)));
      return {...found, baked: memory.slice(at, at + size)};
    } catch (error) {
      if (error instanceof BakeError) throw error;
      throw new BakeError(/memory|out of bounds/.test(error.message) ?
        'does not fit the memory that the browser gives' : `could not be read: ${error.message}`);
    }
  }

  // The greatest smaller depth that fits, as what bake() returns; null where none does.
  smaller(scene, board, depth) {
    for (let level = depth - 1; level >= 1; --level) {
      try {
        return this.bake(scene, board, {depth: level});
      } catch (error) {
        if (!(error instanceof BakeError)) throw error;
        if (!/bytes too many$/.test(error.message)) return null;
      }
    }
    return null;
  }
}

if (typeof module !== 'undefined') {
  module.exports = {Baker, BakeError};
}
