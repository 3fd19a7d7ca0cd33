// A camera that turns around a point: yaw, pitch, distance, in voxels. z is up, as everywhere. Its numbers have as many
// digits as a link writes, so that a link gives the same picture.
'use strict';

const DIGITS = 5;
const written = (x) => Number(x.toFixed(DIGITS));

class Orbit {
  // From the scene's own camera: eye and target in 1/256 voxel.
  constructor(eye, target, side) {
    this.own = {eye, target};
    this.side = side;
    this.reset();
  }
  reset() {
    const {eye, target} = this.own;
    this.target = target.map((x) => x / 256);
    const away = eye.map((x, i) => x / 256 - this.target[i]);
    this.distance = Math.max(Math.hypot(...away), 0.5);
    this.firstDistance = this.distance;
    this.yaw = Math.atan2(away[1], away[0]);
    this.pitch = Math.asin(away[2] / this.distance);
    this.isOwn = true;
  }
  turn(right, up) {
    this.yaw -= right;
    this.pitch = Math.max(-1.55, Math.min(1.55, this.pitch + up));
    this.changed();
  }
  approach(factor) {
    this.distance = Math.max(0.5, Math.min(3 * this.side, this.distance * factor));
    this.changed();
  }
  // Along the picture's axes, in parts of the distance.
  move(right, up) {
    const across = [-Math.sin(this.yaw), Math.cos(this.yaw), 0];
    const above = [-Math.sin(this.pitch) * Math.cos(this.yaw), -Math.sin(this.pitch) * Math.sin(this.yaw),
      Math.cos(this.pitch)];
    for (let i = 0; i < 3; ++i) {
      const moved = this.target[i] + this.distance * (right * across[i] + up * above[i]);
      this.target[i] = Math.max(-this.side, Math.min(2 * this.side, moved));
    }
    this.changed();
  }
  changed() {
    for (const name of ['yaw', 'pitch', 'distance']) this[name] = written(this[name]);
    this.target = this.target.map(written);
    this.isOwn = false;
  }
  // Whole numbers of 1/256 voxel: eye, then target, and how wide a parallel view is, in 1/256 of its own.
  camera() {
    const away = [Math.cos(this.pitch) * Math.cos(this.yaw), Math.cos(this.pitch) * Math.sin(this.yaw),
      Math.sin(this.pitch)];
    const eye = this.target.map((x, i) => Math.round(256 * (x + this.distance * away[i])));
    return {eye, target: this.target.map((x) => Math.round(256 * x)),
      zoom: Math.round(256 * this.distance / this.firstDistance), own: this.isOwn};
  }
  text() {
    return [this.yaw, this.pitch, this.distance, ...this.target].join(',');
  }
  // False, and the view as it was, for a text that is none of text()'s.
  take(text) {
    const words = text.split(',');
    const numbers = words.map(Number);
    if (words.length !== 6 || !words.every((word) => /^-?\d{1,7}(\.\d+)?$/.test(word))) return false;
    [this.yaw, this.pitch] = numbers;
    this.distance = Math.max(0.5, Math.min(3 * this.side, numbers[2]));
    this.target = numbers.slice(3).map((x) => Math.max(-this.side, Math.min(2 * this.side, x)));
    this.turn(0, 0);
    return true;
  }
}

if (typeof module !== 'undefined') {
  module.exports = {Orbit};
}
