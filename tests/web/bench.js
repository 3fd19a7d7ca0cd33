// Median of drawing a frame and putting it on the canvas, in headless Chromium: bench.js [PAGE]
'use strict';
const path = require('path');
const {Chromium} = require('./chromium.js');

const page = path.resolve(process.argv[2] ?? 'build/web/thimble.html');
const FRAMES = 128;  // once round

async function main() {
  const browser = await Chromium.open(`file://${page}`);
  await browser.until(`document.documentElement.dataset.ready === '1'`);
  console.log('board,width_px,height_px,median_ms,slowest_ms');
  for (const name of ['lm3s6965evb', 'mps2-an500', 'raspi0']) {
    const row = await browser.eval(`(async () => {
      state.paused = true;
      await restart({board: '${name}'});
      const times = [];
      for (let i = 0; i < ${FRAMES}; ++i) {
        const began = performance.now();
        while (machine.step() === 'band') present(false);
        present(true);
        times.push(performance.now() - began);
        await new Promise(requestAnimationFrame);
      }
      times.sort((a, b) => a - b);
      return ['${name}', canvas.width, canvas.height, times[times.length >> 1].toFixed(1), times.at(-1).toFixed(1)].join();
    })()`);
    console.log(row);
  }
  await browser.close();
}
main();
