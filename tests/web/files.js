// Small files of formats that readers inflate, made here.
'use strict';
const zlib = require('zlib');

const u16be = (value) => Buffer.from([value >> 8, value & 255]);
const u32 = (value) => { const bytes = Buffer.alloc(4); bytes.writeUInt32LE(value); return bytes; };
const u16 = (value) => Buffer.from([value & 255, value >> 8]);
const inBall = (side) => (x, y, z) => (x - side / 2) ** 2 + (y - side / 2) ** 2 + (z - side / 2) ** 2 < side ** 2 / 5;
function cells(side, value) {
  const is = inBall(side);
  return Array.from({length: side ** 3}, (_, i) => value(is(i % side, Math.floor(i / side) % side, Math.floor(i / side / side))));
}

// A ball of `side` voxels: NumPy array.
function npy(side) {
  const text = `{'descr': '|u1', 'fortran_order': False, 'shape': (${side}, ${side}, ${side}), }`.padEnd(117) + '\n';
  return Buffer.concat([Buffer.from([0x93]), Buffer.from('NUMPY'), Buffer.from([1, 0]), u16(text.length), Buffer.from(text),
    Buffer.from(cells(side, (solid) => (solid ? 1 : 0)))]);
}
// The same in a zip with one member.
function npz(side) {
  const bytes = npy(side);
  const packed = zlib.deflateRawSync(bytes);
  const name = Buffer.from('ball.npy');
  const facts = Buffer.concat([u16(20), u16(0), u16(8), u32(0), u32(zlib.crc32?.(bytes) ?? 0), u32(packed.length),
    u32(bytes.length), u16(name.length), u16(0)]);
  const local = Buffer.concat([Buffer.from('PK\x03\x04'), facts, name, packed]);
  const entry = Buffer.concat([Buffer.from('PK\x01\x02'), u16(20), facts, u16(0), u16(0), u16(0), u32(0), u32(0), name]);
  return Buffer.concat([local, entry, Buffer.from('PK\x05\x06'), u16(0), u16(0), u16(1), u16(1), u32(entry.length),
    u32(local.length), u16(0)]);
}
// MagicaVoxel: a ball that comes nearer from frame to frame, over a floor.
function vox(side, frames) {
  const chunk = (id, bytes, children = Buffer.alloc(0)) => Buffer.concat([Buffer.from(id), u32(bytes.length), u32(children.length), bytes, children]);
  const is = inBall(side);
  const models = Array.from({length: frames}, (_, frame) => {
    const voxels = [];
    for (let i = 0; i < side ** 3; ++i) {
      const [x, y, z] = [i % side, Math.floor(i / side) % side, Math.floor(i / side / side)];
      if (z === 0 || is(x, y + frame * side / 8, z)) voxels.push(x, y, z, z === 0 ? 97 : 21);
    }
    return [chunk('SIZE', Buffer.concat([u32(side), u32(side), u32(side)])),
      chunk('XYZI', Buffer.concat([u32(voxels.length / 4), Buffer.from(voxels)]))];
  });
  return Buffer.concat([Buffer.from('VOX '), u32(150), chunk('MAIN', Buffer.alloc(0), Buffer.concat(models.flat()))]);
}
// Minetest: numbers, chances, turns of all nodes.
function mts(side) {
  const names = ['air', 'default:stone'].map((name) => Buffer.concat([u16be(name.length), Buffer.from(name)]));
  const numbers = Buffer.concat(cells(side, (solid) => u16be(solid ? 1 : 0)));
  const nodes = Buffer.concat([numbers, Buffer.alloc(side ** 3, 0x7f), Buffer.alloc(side ** 3)]);
  return Buffer.concat([Buffer.from('MTSM'), u16be(4), u16be(side), u16be(side), u16be(side), Buffer.alloc(side, 0x7f),
    u16be(2), ...names, zlib.deflateSync(nodes)]);
}
// Minecraft: named tags in a compound, as gzip.
function schematic(side) {
  const named = (kind, name, bytes) => Buffer.concat([Buffer.from([kind]), u16be(name.length), Buffer.from(name), bytes]);
  const array = (bytes) => Buffer.concat([u16be(bytes.length >> 16), u16be(bytes.length & 65535), Buffer.from(bytes)]);
  const blocks = cells(side, (solid) => (solid ? 1 : 0));
  return zlib.gzipSync(Buffer.concat([named(10, 'Schematic', Buffer.concat([named(2, 'Width', u16be(side)),
    named(2, 'Height', u16be(side)), named(2, 'Length', u16be(side)), named(7, 'Blocks', array(blocks)),
    named(7, 'Data', array(blocks.map(() => 0))), Buffer.from([0])]))]));
}

module.exports = {npy, npz, mts, schematic, vox};
