// What there is to choose: scenes, boards, and the file for a board. A part of the page, whose state and elements it uses (page.js).
'use strict';

function button(title, id, pressed, run) {
  const made = document.createElement('button');
  made.append(title);
  if (id) made.id = id;
  if (pressed !== null) made.setAttribute('aria-pressed', String(pressed));
  made.onclick = run;
  return made;
}
function pictureOf({picture}) {
  const [left, top, right, bottom] = [0, 1, 2, 3].map((i) => picture.map(([, x, y, w, h]) => [x, y, x + w, y + h][i])).map((sides, i) =>
    Math[i < 2 ? 'min' : 'max'](...sides));
  return `<svg viewBox="${left} ${top} ${right - left} ${bottom - top}" aria-hidden="true">${picture.map(([fill, x, y, width, height, rx]) =>
    `<rect fill="${fill}" x="${x}" y="${y}" width="${width}" height="${height}" rx="${rx}"/>`).join('')}</svg>`;
}
function showChoices(board) {
  const focused = document.activeElement?.id;
  document.documentElement.dataset.act = state.look ? 'look' : 'board';
  const buttons = Object.entries(SCENES).map(([name, {title}]) => button(title, `scene-${name}`,
    state.dropped === null && state.scene === name, () => restart({scene: name, dropped: null, ...AFRESH})));
  for (const [i, name] of Object.keys(SCENES).entries()) buttons[i].prepend(Object.assign(new Image(), {src: PICTURES[name], alt: ''}));
  if (state.dropped !== null) buttons.push(button(state.dropped.title, 'scene-dropped', true, () => {}));
  $('scenes').replaceChildren(...buttons);
  $('shelf').replaceChildren(...Object.entries(SHELF).filter(([name]) => boards.some((one) => one.name === name && hasPrograms(one))).map(([name, entry]) => {
    const card = button('', `shelf-${name}`, state.board === name, () => restart({board: name, ...AFRESH}));
    card.innerHTML = `${pictureOf(entry)}<span>${entry.title}</span><small>${entry.price}</small>`;
    card.title = entry.parts;
    return card;
  }));
  if (focused) $(focused)?.focus({preventScroll: true});
  $('act').textContent = state.look ? 'On a board' : 'Look around';
  $('act').disabled = current().scene === null;
  $('board').value = state.board;
  $('board').disabled = document.querySelector('[data-hold="select"]').disabled = state.look;
  $('get').hidden = $('none').hidden = true;
  const glass = state.look ? undefined : SHELF[board.name]?.glass;
  $('true').hidden = !glass;
  if (glass) {
    Object.assign($('glass'), {width: board.width, height: board.height}).style.width = `${glass[0]}mm`;
    $('size').textContent = `its true size, ${glass.map((mm) => number(mm)).join(' x ')} mm`;
  }
  showPause();
  fit();
}
// What to do with the file for the board, where there is one.
function showGet() {
  const board = shownBoard();
  const {app, state: at} = machine;
  $('get').hidden = baked?.image === undefined || !hasPrograms(board, app) || at === 'ended';
  $('none').hidden = !$('get').hidden || at === 'ended';
  $('steps').replaceChildren(...(STEPS[board.ending] ?? []).map((step, i) =>
    Object.assign(document.createElement('li'), {textContent: ((i === 0 && SHELF[board.name]?.wires) || '') + step.replace('FILE', imageName()).replace('MOVES', MOVES[app])})));
}

const imageName = () => `${(state.dropped?.title ?? state.scene).replace(/\.gz$/i, '').replace(/\.[^.]*$/, '').replace(/[^\p{L}\p{M}\p{N}._-]+/gu, '-')}.${shownBoard().ending}`;
