// The boards that a visitor may have, or buy: those of them that the table has, and whose programs lie in the page, are to be
// chosen there, in this order. Sizes are in millimetres, of the glass that shows pixels, and of pictures: [colour, left, top,
// width, height, radius]; the last shape is the glass. `price`: of all parts together, new or, of what is not made any more, used.
'use strict';

const PICO = ['#1b7a3d', 0, 0, 51, 21, 1.5];
const SHELF = {
  pico: {title: 'Pico, 1.3 inch colour', parts: 'Raspberry Pi Pico with Waveshare Pico-LCD-1.3', price: 'about 15 dollars', glass: [23.4, 23.4],
    picture: [['#14181f', 0, 0, 52, 26.5, 1.5], ['#3b4250', 3, 9, 9, 9, 4.5], ['#3b4250', 44, 3, 5, 4, 1], ['#3b4250', 44, 19, 5, 4, 1], ['#7cc4ee', 14.3, 1.6, 23.4, 23.4, 0.5]]},
  'pico-lcd-2': {title: 'Pico, 2 inch colour', parts: 'Raspberry Pi Pico with Waveshare Pico-LCD-2', price: 'about 20 dollars', glass: [40.8, 30.6],
    picture: [['#14181f', 0, 0, 58, 35, 1.5], ['#3b4250', 2, 4, 4, 6, 1], ['#3b4250', 2, 25, 4, 6, 1], ['#3b4250', 52, 4, 4, 6, 1], ['#3b4250', 52, 25, 4, 6, 1],
      ['#7cc4ee', 8.6, 2.2, 40.8, 30.6, 0.5]]},
  'pico-oled': {title: 'Pico, 0.96 inch white', parts: 'Raspberry Pi Pico and an SSD1306 OLED on two wires', price: 'about 8 dollars', glass: [21.7, 10.9],
    wires: 'Connect SDA of the display with GP4 of the Pico, SCL with GP5, VCC with 3V3, GND with GND. ',
    picture: [PICO, ['#c9ced6', -1, 7, 6, 7, 0.5], ['#12335c', 17, -3, 27, 27, 1], ['#f2f4f6', 19.6, 5, 21.7, 10.9, 0.3]]},
  microbit: {title: 'micro:bit', parts: 'BBC micro:bit, version 1', price: 'about 15 dollars, used', glass: null,
    picture: [['#14181f', 0, 0, 52, 42, 4], ['#d8b24a', 2, 37, 48, 5, 0], ['#3b4250', 3, 17, 8, 8, 1], ['#3b4250', 41, 17, 8, 8, 1], ['#c2410c', 17, 12, 18, 18, 0.5]]},
  gba: {title: 'Game Boy Advance', parts: 'Game Boy Advance, or any emulator of it', price: 'an emulator is free', glass: [61.2, 40.8],
    picture: [['#5b4b9a', 0, 0, 144, 82, 26], ['#22252c', 34, 10, 76, 58, 4], ['#22252c', 9, 28, 18, 6, 1], ['#22252c', 15, 22, 6, 18, 1], ['#22252c', 114, 34, 9, 9, 4.5],
      ['#22252c', 127, 27, 9, 9, 4.5], ['#7cc4ee', 41.4, 18, 61.2, 40.8, 1]]},
};
// What to do with a file of that ending.
const STEPS = {
  uf2: ['Hold the white button BOOTSEL while you plug the Pico into USB; then let go.', 'Drag FILE onto the drive RPI-RP2.',
    'The display shows it. MOVES'],
  hex: ['Plug the micro:bit into USB.', 'Drag FILE onto the drive MICROBIT.',
    'It has no display of its own: a terminal (115,200 baud) that sends it p gets the picture.'],
  gba: ['Open FILE in an emulator, such as mGBA,', 'or copy it to a cartridge for the console.', 'MOVES'],
};
const MOVES = {demo: 'It turns; its keys turn it, too.', water: 'Its keys turn it; a fifth, where there is one, drops a ball.'};

if (typeof module !== 'undefined') {
  module.exports = {SHELF};
}
