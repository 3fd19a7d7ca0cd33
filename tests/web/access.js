// Who uses a keyboard, a screen reader, or less than perfect eyes: judged on the page as the browser tells it to them.
'use strict';
const {test, is, holds} = require('./check.js');

// Runs in the page: the least contrast of any text, and of the ring around what has the focus.
function leastContrast() {
  const channels = (text) => text.match(/[\d.]+/g).map(Number);
  const light = ([r, g, b]) => {
    const [x, y, z] = [r, g, b].map((v) => (v / 255 <= 0.03928 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * x + 0.7152 * y + 0.0722 * z;
  };
  // Layers that let something through are laid over what is behind them.
  const behind = (element) => {
    const layers = [];
    for (let e = element; e; e = e.parentElement) layers.push(channels(getComputedStyle(e).backgroundColor));
    let color = [255, 255, 255];
    for (const [r, g, b, a = 1] of layers.reverse()) color = [r, g, b].map((v, i) => v * a + color[i] * (1 - a));
    return color;
  };
  const ratio = (a, b) => (Math.max(light(a), light(b)) + 0.05) / (Math.min(light(a), light(b)) + 0.05);
  const found = [];
  for (const element of document.querySelectorAll('button, select, p, dt, dd, summary, h1, h2, th, td, code, label, pre')) {
    if (element.offsetParent === null || element.disabled) continue;
    // What the system paints behind a color() of its own is left to it.
    if (!/^rgb/.test(getComputedStyle(element).backgroundColor)) continue;
    found.push([ratio(channels(getComputedStyle(element).color), behind(element)), element.outerHTML.slice(0, 60)]);
  }
  found.sort((a, b) => a[0] - b[0]);
  const button = document.getElementById('open');
  button.focus({focusVisible: true});
  const ring = getComputedStyle(button);
  return {count: found.length, least: found[0][0], of: found[0][1], width: parseFloat(ring.outlineWidth),
    ring: ratio(channels(ring.outlineColor), behind(button.parentElement))};
}

async function judgeAccess(browser) {
  await browser.eval(`document.getElementById('more').open = true`);
  for (const scheme of ['light', 'dark']) {
    await test(`contrast, ${scheme}: text at least 4.5, the ring of the focus at least 3`, async () => {
      await browser.send('Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value: scheme}]});
      for (const state of ['', `document.getElementById('dialog').showModal();`,
        `document.getElementById('busy').hidden = false; document.getElementById('said').classList.add('wrong');`]) {
        await browser.eval(state);
        const {count, least, of, ring, width} = await browser.eval(`(${leastContrast})()`);
        holds(`${count} texts are judged`, count > 20);
        holds(`the contrast ${least.toFixed(2)} of ${of} is at least 4.5`, least >= 4.5);
        holds(`the ring's ${ring.toFixed(2)} is at least 3, its width ${width} at least 2`, ring >= 3 && width >= 2);
        await browser.eval(`document.getElementById('dialog').close(); document.getElementById('busy').hidden = true;
          document.getElementById('said').classList.remove('wrong')`);
      }
    });
  }
  await browser.send('Emulation.setEmulatedMedia', {features: []});

  await test('the accessibility tree names everything that can be used, each by a name of its own', async () => {
    await browser.send('Accessibility.enable');
    const {nodes} = await browser.send('Accessibility.getFullAXTree');
    await browser.send('Accessibility.disable');
    const seen = nodes.filter((node) => !node.ignored).map((node) => ({
      role: node.role?.value, name: node.name?.value ?? '',
      focusable: (node.properties ?? []).some(({name, value}) => name === 'focusable' && value.value),
    }));
    const used = seen.filter(({role, focusable}) => focusable && !/WebArea/.test(role));
    is('without a name', used.filter(({name}) => name.trim() === '').map(({role}) => role).join(), '');
    const buttons = used.filter(({role}) => role === 'button').map(({name}) => name);
    holds(`there are ${buttons.length} buttons`, buttons.length >= 15);
    is('named twice', buttons.filter((name, i) => buttons.indexOf(name) !== i).join(), '');
    const has = (role, name) => seen.some((node) => node.role === role && name.test(node.name));
    for (const [role, name] of [['main', /^/], ['banner', /^/], ['navigation', /^Scene$/], ['heading', /^Thimble$/],
      ['combobox', /^Board$/], ['button', /^left$/], ['status', /^/], ['meter', /^Flash used$/]]) {
      holds(`there is a ${role} ${name}`, has(role, name));
    }
    holds('the canvas says what it shows', used.some(({name}) => /on a display of \d+ by \d+ pixels$/.test(name)));
  });

  await test('Tab visits all of it in the order in which it stands, and shows where it is', async () => {
    const order = await browser.eval(`[...document.querySelectorAll('button, select, canvas, summary, pre[tabindex]')].filter(
      (element) => !element.disabled && element.checkVisibility() && element.tabIndex >= 0).map((element) =>
      element.id || element.getAttribute('aria-label') || element.textContent)`);
    const visited = [];
    await browser.eval(`document.getElementById('canvas').focus({focusVisible: true})`);
    for (let i = 0; i < order.length; ++i) {
      if (i !== 0) await browser.tab();
      visited.push(await browser.eval(`(() => { const e = document.activeElement, box = e.getBoundingClientRect();
        const style = getComputedStyle(e);
        const isShown = box.bottom > 0 && box.top < innerHeight && style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) >= 2;
        return (e.id || e.getAttribute('aria-label') || e.textContent.slice(0, 60)) + (isShown ? '' : ' (not seen)'); })()`));
    }
    is('order', visited.join(' | '), order.join(' | '));
  });

  await test('the help opens with the focus in it and gives it back', async () => {
    await browser.eval(`document.getElementById('help').focus()`);
    await browser.key('Enter', 'Enter', {text: '\r'});
    is('focus', await browser.eval('document.activeElement.closest("dialog")?.id'), 'dialog');
    await browser.key('Escape');
    is('focus after it', await browser.eval('document.activeElement.id'), 'help');
  });

  await test('buttons of the board work by Enter and Space', async () => {
    for (const [key, code, text] of [['Enter', 'Enter', '\r'], [' ', 'Space', ' ']]) {
      await browser.eval(`document.querySelector('[data-hold="left"]').focus(); tapped = 0; held.clear();
        window.pressed = 0; { const old = held.set.bind(held); held.set = (by, bit) => { pressed |= bit; return old(by, bit); }; }`);
      await browser.key(key, code, {text});
      is(`${code} presses left`, await browser.eval('pressed'), 4);
      await browser.eval('delete held.set');
    }
  });
}

module.exports = {judgeAccess};
