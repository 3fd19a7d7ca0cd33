// The finished picture by WebGPU, also while the camera moves: scene.wasm says what there is to draw (tools/web/viewer.cpp),
// the kernels of platform/gpu draw it. Where the browser has no WebGPU, where a first small frame is not the module's own, byte
// for byte, or takes long, and after any fault the page is as without. A part of the page, whose state it uses (page.js).
'use strict';

const GPU_LIMITS = {ms: 50};  // for a frame while the camera moves, and for the first
const CHECKED_PX = 96;  // of the first frame
const FRAME_WORDS = {parameters: 1464, finish: 72};  // GpuFrame of tools/web/viewer.cpp
const PALETTE_BYTES = 1024;  // before the tree

// The page's device and its kernels; null where the browser has none.
class GpuDevice {
  static async open(kernels) {
    const adapter = await navigator.gpu?.requestAdapter({powerPreference: 'high-performance'});
    if (!adapter) return null;
    const {maxBufferSize, maxStorageBufferBindingSize} = adapter.limits;
    return new GpuDevice(await adapter.requestDevice({requiredLimits: {maxBufferSize, maxStorageBufferBindingSize}}), kernels);
  }
  constructor(device, kernels) {
    Object.assign(this, {device, kernels, pipelines: []});
  }
  pipeline(number) {
    this.pipelines[number] ??= this.device.createComputePipelineAsync({layout: 'auto',
      compute: {module: this.device.createShaderModule({code: this.kernels[number]}), entryPoint: 'main'}});
    return this.pipelines[number];
  }
  buffer(size, usage) {
    return this.device.createBuffer({size, usage});
  }
}

// A scene on it, and frames of it, one at a time; a promise that fails ends its use.
class GpuPicture {
  constructor(of, look) {
    Object.assign(this, {of, look, step: 0, late: 0, drawn: 0, busy: false, last: Promise.resolve()});
    const {x} = look;
    const tree = new Uint8Array(x.memory.buffer, x.tree(), x.tree_bytes() + 3 & ~3);
    const {UNIFORM, STORAGE, COPY_DST} = GPUBufferUsage;
    this.parameters = of.buffer(4 * FRAME_WORDS.parameters, UNIFORM | COPY_DST);
    this.finish = of.buffer(4 * FRAME_WORDS.finish, UNIFORM | COPY_DST);
    this.scene = of.buffer(PALETTE_BYTES + tree.length, STORAGE | COPY_DST);
    of.device.queue.writeBuffer(this.scene, PALETTE_BYTES, tree);
  }
  // The picture at rest from the camera that the scene has now, as Look.band() draws it, in RGB.
  draw(exposure, step) {
    this.busy = true;
    const {x} = this.look;
    x.set_exposure(exposure);
    const at = x.gpu_frame(step);
    const told = at !== 0 && new Uint32Array(x.memory.buffer, at, FRAME_WORDS.parameters + FRAME_WORDS.finish + 1).slice();
    const drawn = this.last.then(() => {
      if (!told) throw new Error('the kernels do not draw it');
      return this.run(told);
    });
    this.last = drawn.finally(() => { this.busy = false; });
    return this.last;
  }
  async run(told) {
    const {of: {device}} = this;
    const kernels = await Promise.all([this.of.pipeline(told.at(-1)), this.of.pipeline(2)]);
    const [sampleColumns, sampleRows] = told;
    const [width, height] = told.subarray(FRAME_WORDS.parameters);
    this.fit(4 * sampleColumns * sampleRows, 4 * width * height);
    const began = performance.now();
    device.queue.writeBuffer(this.parameters, 0, told, 0, FRAME_WORDS.parameters);
    device.queue.writeBuffer(this.finish, 0, told, FRAME_WORDS.parameters, FRAME_WORDS.finish);
    const commands = device.createCommandEncoder();
    const pass = commands.beginComputePass();
    const start = (kernel, buffers, columns, rows) => {
      pass.setPipeline(kernel);
      pass.setBindGroup(0, device.createBindGroup({layout: kernel.getBindGroupLayout(0),
        entries: buffers.map((buffer, binding) => ({binding, resource: {buffer}}))}));
      pass.dispatchWorkgroups(Math.ceil(columns / 8), Math.ceil(rows / 8));
    };
    start(kernels[0], [this.parameters, this.scene, this.samples], sampleColumns, sampleRows);
    start(kernels[1], [this.finish, this.samples, this.picture], width, height);
    pass.end();
    commands.copyBufferToBuffer(this.picture, 0, this.read, 0, 4 * width * height);
    device.queue.submit([commands.finish()]);
    await this.read.mapAsync(GPUMapMode.READ, 0, 4 * width * height);
    const rgb = new Uint8Array(3 * width * height);
    let to = 0;
    for (const word of new Uint32Array(this.read.getMappedRange(0, 4 * width * height))) {
      rgb[to++] = word;
      rgb[to++] = word >> 8;
      rgb[to++] = word >> 16;
    }
    this.read.unmap();
    this.took = performance.now() - began;
    ++this.drawn;
    return rgb;
  }
  fit(samples, picture) {
    const {STORAGE, COPY_SRC, COPY_DST, MAP_READ} = GPUBufferUsage;
    if (!(this.samples?.size >= samples)) {
      this.samples?.destroy();
      this.samples = this.of.buffer(samples, STORAGE);
    }
    this.picture ??= this.of.buffer(picture, STORAGE | COPY_SRC);
    this.read ??= this.of.buffer(picture, MAP_READ | COPY_DST);
  }
  // Whether a small frame is the module's own.
  async isRight(exposure) {
    const {look} = this;
    const step = Math.ceil(Math.max(look.width, look.height) / CHECKED_PX);
    look.x.set_exposure(exposure);
    look.x.draw(0, look.height, step, true);
    const wanted = crc32(look.rows(0, look.height));
    return crc32(await this.draw(exposure, step)) === wanted;
  }
  end() {
    for (const buffer of [this.parameters, this.finish, this.scene, this.samples, this.picture, this.read]) buffer?.destroy();
  }
}

let gpuDevice = null;
async function hireGpu(own) {
  const note = (word) => { document.documentElement.dataset.gpu = word; };
  note('');
  if (own.frames > 1) return;  // each frame would be a scene of its own
  const text = (name) => new TextDecoder().decode(archive('modules').get(name));
  let gpu = null;
  try {
    const device = await (gpuDevice ??= GpuDevice.open(['words.wgsl', 'pairs.wgsl', 'finish.wgsl'].map(text)));
    if (own !== viewer) return;
    if (device === null) return note('none');
    gpu = new GpuPicture(device, own.look);
    const isRight = await gpu.isRight(own.exposure);
    if (own !== viewer) return;
    note(!isRight ? 'wrong' : gpu.took > GPU_LIMITS.ms ? 'late' : 'draws');
    if (document.documentElement.dataset.gpu === 'draws') own.gpu = gpu;
  } catch (error) {
    if (own === viewer) note(error.message);
  } finally {
    if (own.gpu === null) gpu?.end();
  }
}
// As without, from the next frame on.
function dismissGpu(own, why) {
  if (own === viewer) document.documentElement.dataset.gpu = why;
  own.gpu?.end();
  own.gpu = null;
  if (own.phase !== 'finished') own.phase = 'moved';
}
// A frame to what is shown while the phase is one of `phases`. Whether it is there.
async function drawByGpu(own, step, phases) {
  const {gpu, view} = own;
  try {
    const rgb = await gpu.draw(own.exposure, step);
    if (own !== viewer || !phases.includes(own.phase) || (own.phase === 'whole' && own.view !== view)) return false;
    own.picture.bytes.set(rgb);
    own.picture.changed = [0, own.board.height];
    return true;
  } catch (error) {
    dismissGpu(own, error.message);
    return false;
  }
}
async function drawWhole(own) {
  if (await drawByGpu(own, 0, ['whole'])) nextPicture(own);
}
// While the camera moves: the next frame when the last one is there; with one sample a pixel, or no more, where they are late.
async function drawMoving(own, now) {
  const {gpu} = own;
  if (gpu.busy) return;
  own.phase = 'waits';
  own.since = now;
  if (!await drawByGpu(own, gpu.step, ['moved', 'waits', 'expose'])) return;
  $('frame').textContent = `${gpu.took.toFixed(1)} ms, GPU`;
  gpu.late = gpu.took > GPU_LIMITS.ms ? gpu.late + 1 : 0;
  if (gpu.late < 3) return;
  gpu.late = 0;
  if (gpu.step === 0) gpu.step = 1;
  else dismissGpu(own, 'late');
}
