// A camera that turns around a point: yaw, pitch, distance, in voxels. z is up, as everywhere. Its numbers have as many
// digits as a link writes, so that a link gives the same picture.
'use strict';

const DIGITS = 5;
const written = (x) => Number(x.toFixed(DIGITS));
const within = (x, low, high) => Math.max(low, Math.min(high, x));
const FLIGHT = 0.7;  // distances a second

class Orbit {
  // From the scene's own camera: eye and target in 1/256 voxel.
  constructor(eye, target, side, isParallel = false) {
    this.own = {eye, target};
    this.isParallel = isParallel;
    this.side = side;
    this.reset();
  }
  reset() {
    const [eye, target] = [this.own.eye, this.own.target].map((point) => point.map((x) => x / 256));
    this.place(eye, target);
    this.firstDistance = this.distance;
    this.isOwn = true;
  }
  place(eye, target) {
    const away = eye.map((x, i) => x - target[i]);
    this.target = target;
    this.distance = Math.max(Math.hypot(...away), 0.5);
    this.yaw = away[0] || away[1] ? Math.atan2(away[1], away[0]) : -Math.PI / 2;
    this.pitch = Math.asin(away[2] / this.distance);
  }
  // Of the picture, in the world. Straight down the picture's up is +y, so only a yaw of -90 degrees looks so.
  axes() {
    const [x, y, up] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.sin(this.pitch)];
    const flat = Math.abs(this.pitch) > 1.57 ? 0 : Math.cos(this.pitch);
    return {right: [-y, x, 0], above: [-up * x, -up * y, flat], away: [flat * x, flat * y, up]};
  }
  turn(right, up) {
    this.yaw -= right;
    this.pitch = within(this.pitch + up, -1.55, 1.55);
    this.changed();
  }
  approach(factor) {
    this.distance *= factor;
    this.changed();
  }
  // Along the picture's axes, in parts of the distance.
  move(right, up, forward = 0, by = this.distance) {
    const axes = this.axes();
    this.target = this.target.map((x, i) => x + by * (right * axes.right[i] + up * axes.above[i] - forward * axes.away[i]));
    this.changed();
  }
  // Seconds of flight.
  fly(right, up, forward) {
    this.move(right, up, forward, FLIGHT * Math.max(this.distance, 0.05 * this.side));
  }
  // Turns where it stands, so that `point` is in the middle; a parallel view goes there.
  lookAt(point) {
    const {away} = this.axes();
    if (this.isParallel) this.target = point;
    else this.place(this.target.map((x, i) => x + this.distance * away[i]), point);
    this.changed();
  }
  // A view of Baker.frame().
  show({eye, target, zoom}) {
    this.place(...[eye, target].map((point) => point.map((x) => x / 256)));
    if (this.isParallel) this.distance = this.firstDistance * zoom / 256;
    this.changed();
  }
  // Keeps the target in the world or near it, and the eye where rays may start (tools/viewer/camera_state.cpp).
  changed() {
    this.pitch = within(this.pitch, -1.5708, 1.5708);
    this.target = this.target.map((x) => within(x, -this.side, 2 * this.side));
    const reach = this.axes().away.map((a, i) => (a === 0 ? Infinity : ((a > 0 ? 4.99 : -3.99) * this.side - this.target[i]) / a));
    this.distance = within(this.distance, 0.5, Math.min(4 * this.side, ...reach));
    for (const name of ['yaw', 'pitch', 'distance']) this[name] = written(this[name]);
    this.target = this.target.map(written);
    this.isOwn = false;
  }
  // Whole numbers of 1/256 voxel: eye, then target, and how wide a parallel view is, in 1/256 of its own.
  camera() {
    const {away} = this.axes();
    // A parallel view is the same from farther away, and nothing stands behind the eye there.
    const back = this.isParallel ? Math.max(this.distance, 2 * this.side) : this.distance;
    const eye = this.target.map((x, i) => Math.round(256 * (x + back * away[i])));
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
    [this.yaw, this.pitch, this.distance] = numbers;
    this.target = numbers.slice(3);
    this.changed();
    return true;
  }
}

if (typeof module !== 'undefined') {
  module.exports = {Orbit};
}
