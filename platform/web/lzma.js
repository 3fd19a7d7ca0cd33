// Unpacks what `xz --format=lzma` packs (LZMA specification, Igor Pavlov, 2015): a quarter less of the page than gzip, since
// its window holds all modules, or all programs for boards, at once.
'use strict';

function unlzma(packed) {
  const header = new DataView(packed.buffer, packed.byteOffset, 13);
  const kind = header.getUint8(0);
  const [lc, lp, pb] = [kind % 9, Math.floor(kind / 9) % 5, Math.floor(kind / 45)];
  const out = new Uint8Array(header.getUint32(5, true));
  let at = 13 + 5;
  let range = 2 ** 32 - 1;
  let code = new DataView(packed.buffer, packed.byteOffset + 14, 4).getUint32(0);
  const models = (count) => new Uint16Array(count).fill(1024);

  function bit(probs, index) {
    if (range < 2 ** 24) {
      range = range << 8 >>> 0;
      code = (code << 8 | packed[at++]) >>> 0;
    }
    const prob = probs[index];
    const bound = (range >>> 11) * prob;
    if (code < bound) {
      range = bound;
      probs[index] = prob + (2048 - prob >> 5);
      return 0;
    }
    range -= bound;
    code -= bound;
    probs[index] = prob - (prob >> 5);
    return 1;
  }
  function tree(probs, first, bits) {
    let symbol = 1;
    for (let i = 0; i < bits; ++i) symbol = symbol << 1 | bit(probs, first + symbol);
    return symbol - (1 << bits);
  }
  function reversed(probs, first, bits) {
    let [symbol, value] = [1, 0];
    for (let i = 0; i < bits; ++i) {
      const one = bit(probs, first + symbol);
      symbol = symbol << 1 | one;
      value |= one << i;
    }
    return value;
  }
  function plain(bits) {
    let value = 0;
    for (let i = 0; i < bits; ++i) {
      if (range < 2 ** 24) {
        range = range << 8 >>> 0;
        code = (code << 8 | packed[at++]) >>> 0;
      }
      range >>>= 1;
      const one = code >= range ? 1 : 0;
      if (one) code -= range;
      value = value << 1 | one;
    }
    return value >>> 0;
  }
  const lengths = () => ({choice: models(2), low: models(128), middle: models(128), high: models(256)});
  function length({choice, low, middle, high}, place) {
    if (!bit(choice, 0)) return tree(low, place << 3, 3);
    if (!bit(choice, 1)) return 8 + tree(middle, place << 3, 3);
    return 16 + tree(high, 0, 8);
  }

  const literals = models(0x300 << lc + lp);
  const [isMatch, isRep, isRep0, isRep1, isRep2, isLong] = [models(192), models(12), models(12), models(12), models(12), models(192)];
  const [slots, specials, align] = [models(256), models(128), models(16)];
  const [ofMatch, ofRep] = [lengths(), lengths()];
  let [rep0, rep1, rep2, rep3, state] = [0, 0, 0, 0, 0];
  for (let to = 0; to < out.length;) {
    const place = to & (1 << pb) - 1;
    if (!bit(isMatch, state << 4 | place)) {
      const before = to === 0 ? 0 : out[to - 1];
      const first = 0x300 * (((to & (1 << lp) - 1) << lc) + (before >> 8 - lc));
      let symbol = 1;
      let match = state >= 7 ? out[to - rep0 - 1] : -1;
      while (symbol < 256) {
        if (match < 0) {
          symbol = symbol << 1 | bit(literals, first + symbol);
          continue;
        }
        const wanted = match >> 7 & 1;
        match = match << 1 & 255;
        const one = bit(literals, first + (1 + wanted << 8) + symbol);
        symbol = symbol << 1 | one;
        if (one !== wanted) match = -1;
      }
      out[to++] = symbol;
      state = state < 4 ? 0 : state < 10 ? state - 3 : state - 6;
      continue;
    }
    let size = 0;
    if (!bit(isRep, state)) {
      [rep1, rep2, rep3] = [rep0, rep1, rep2];
      size = length(ofMatch, place);
      state = state < 7 ? 7 : 10;
      const slot = tree(slots, Math.min(size, 3) << 6, 6);
      rep0 = slot;
      if (slot >= 4) {
        const bits = (slot >> 1) - 1;
        rep0 = (2 | slot & 1) << bits >>> 0;
        rep0 += slot < 14 ? reversed(specials, rep0 - slot, bits) : plain(bits - 4) * 16 + reversed(align, 0, 4);
      }
    } else {
      if (bit(isRep0, state)) {
        if (!bit(isRep1, state)) [rep0, rep1] = [rep1, rep0];
        else if (!bit(isRep2, state)) [rep0, rep1, rep2] = [rep2, rep0, rep1];
        else [rep0, rep1, rep2, rep3] = [rep3, rep0, rep1, rep2];
      } else if (!bit(isLong, state << 4 | place)) {
        state = state < 7 ? 9 : 11;
        out[to] = out[to - rep0 - 1];
        ++to;
        continue;
      }
      size = length(ofRep, place);
      state = state < 7 ? 8 : 11;
    }
    for (let left = size + 2; left > 0 && to < out.length; --left, ++to) out[to] = out[to - rep0 - 1];
  }
  return out;
}

if (typeof module !== 'undefined') {
  module.exports = {unlzma};
}
