// Small files of formats that readers inflate, made here.
'use strict';
const zlib = require('zlib');
const {crc32} = require('../../platform/web/machine.js');

const u32be = (value) => { const bytes = Buffer.alloc(4); bytes.writeUInt32BE(value); return bytes; };
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

// Twice as wide as high, of colours that are others everywhere; each row begins with a byte that names no filter.
function png(width) {
  const chunk = (kind, bytes) => {
    const named = Buffer.concat([Buffer.from(kind), bytes]);
    return Buffer.concat([u32be(bytes.length), named, u32be(parseInt(crc32(named), 16))]);
  };
  const row = (y) => [0, ...Array.from({length: width}, (_, x) => [255 - 8 * x, 16 * y, 8 * (x ^ y)]).flat()];
  return Buffer.concat([Buffer.from('\x89PNG\r\n\x1a\n', 'latin1'), chunk('IHDR', Buffer.concat([u32be(width), u32be(width / 2),
    Buffer.from([8, 2, 0, 0, 0])])), chunk('IDAT', zlib.deflateSync(Buffer.from(Array.from({length: width / 2}, (_, y) => row(y)).flat()))),
  chunk('IEND', Buffer.alloc(0))]);
}
// glTF: a tent of four triangles with a picture on it. Its numbers and its picture are `tent.bin` and `tent.png`, or inside.
const TENT = [[0, 0, 0], [4, 0, 0], [4, 0, 0.5], [0, 0, 0.5], [2, 0.5, 0.25]];
const NUMBERS = Buffer.concat([Buffer.from(new Float32Array([...TENT.flat(), ...TENT.flatMap(([x, , z]) => [x / 4, 2 * z])]).buffer),
  Buffer.from(new Uint16Array([0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4]).buffer)]);
const PICTURE = png(32);
function gltf(more = {}) {
  const parts = [[0, 60], [60, 40], [100, 24], [124, PICTURE.length]];
  return {asset: {version: '2.0'}, nodes: [{mesh: 0}], meshes: [{primitives: [{attributes: {POSITION: 0, TEXCOORD_0: 1}, indices: 2, material: 0}]}],
    materials: [{pbrMetallicRoughness: {baseColorTexture: {index: 0}}}], textures: [{source: 0}], images: [{uri: 'sub/tent%2Epng'}],
    buffers: [{uri: 'tent.bin', byteLength: NUMBERS.length}],
    bufferViews: parts.map(([byteOffset, byteLength]) => ({buffer: 0, byteOffset, byteLength})),
    accessors: [['VEC3', 5126, 5], ['VEC2', 5126, 5], ['SCALAR', 5123, 12]]
      .map(([type, componentType, count], bufferView) => ({bufferView, type, componentType, count})), ...more};
}
function glb() {
  const content = gltf({images: [{bufferView: 3, mimeType: 'image/png'}], buffers: [{byteLength: NUMBERS.length + PICTURE.length}]});
  const chunk = (kind, bytes) => Buffer.concat([u32(bytes.length), Buffer.from(kind), bytes]);
  const text = JSON.stringify(content);
  const chunks = Buffer.concat([chunk('JSON', Buffer.from(text.padEnd(text.length + (-text.length & 3)))),
    chunk('BIN\0', Buffer.concat([NUMBERS, PICTURE]))]);
  return Buffer.concat([Buffer.from('glTF'), u32(2), u32(12 + chunks.length), chunks]);
}

module.exports = {npy, npz, mts, schematic, vox, glb, gltf, NUMBERS, PICTURE};
