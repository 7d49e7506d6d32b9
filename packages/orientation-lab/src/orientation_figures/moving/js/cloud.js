import { degrees, length } from './mathematics.js';
import { orientations, picture, SIZE, tipsMean } from './cloud_picture.js';
import { change, choice, element, follow, liveText, onceAFrame, open, plain, Sheet, slider, stage } from './shared.js';

// Orientations with Gaussian errors; the reader chooses their size and their frame.
export function render({ model, el }) {
  const sheet = new Sheet({ bounds: [-180, -160, 180, 160], size: SIZE, changed: () => redraw(),
    name: 'The tips of two unit vectors of many orientations, on a sphere.' });
  const redraw = onceAFrame(draw);
  const deviation = (trait, name, max) => slider({ symbol: '', name, min: 0, max, step: 1, more: () => '',
    change: (value) => change(model, { [trait]: value }) });
  const named = (name, control) => element('div', { class: 'named' }, element('span', { 'aria-hidden': 'true' }, name), control.element);
  const large = deviation('large', 'Error about z', 90), small = deviation('small', 'Error about x and y', 30);
  const side = choice({ name: 'Errors about the axes of', options: [['ground', 'the ground'], ['body', 'the body']], change: (value) => change(model, { side: value }) });
  const text = liveText();
  open(el, stage(sheet, text), element('div', { class: 'controls' }, named('About z', large), named('About x, y', small), side.element));

  function draw() {
    const state = [model.get('large'), model.get('small'), model.get('side') === 'body'];
    large.show(state[0]);
    small.show(state[1]);
    side.show(model.get('side'));
    sheet.draw(() => picture(sheet, ...state));
    text.say(`The errors are ${plain(degrees(state[0]), 0)}° about z ${state[2] ? 'of the body' : 'of the ground'} and ${
      plain(degrees(state[1]), 0)}° across. The mean of the tips of $\\hat{b}_x$ is ${plain(length(tipsMean(orientations(...state), 0)))} long.`);
  }

  draw();
  return follow(model, ['large', 'small', 'side'], redraw);
}
