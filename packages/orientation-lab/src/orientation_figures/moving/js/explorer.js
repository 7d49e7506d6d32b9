import { change, choice, element, follow, group, liveText, open } from './shared.js';

const SYMBOLS = ['$\\psi$', '$\\theta$', '$\\varphi$'], NAMES = ['psi', 'theta', 'phi'];

// Menus and fields. Python does the algebra and sends the formulas.
export function render({ model, el }) {
  const sequence = choice({ name: 'Sequence', options: model.get('sequences').map((one) => [one, [...one].join('-')]),
    change: (value) => change(model, { sequence: value }) });
  const fixed = choice({ name: 'Rotations are', options: [['body', 'body fixed'], ['space', 'space fixed']],
    change: (value) => change(model, { fixed: value }) });
  const fields = SYMBOLS.map((symbol, k) => {
    const field = element('input', { type: 'text', 'aria-label': `${NAMES[k]}: a symbol or radians`, spellcheck: 'false',
      autocapitalize: 'none', input() {
        change(model, { angles: model.get('angles').map((angle, j) => (j === k ? field.value : angle)) });
      } });
    return { field, element: element('label', { class: 'choice' }, element('span', { 'aria-hidden': 'true' }, symbol), field) };
  });
  const result = element('div', { class: 'formulas', tabindex: '0', role: 'group', 'aria-label': 'Factors, product, and product at gimbal lock' });
  const text = liveText();
  open(el, element('div', { class: 'controls alone' },
    group('What is turned', 'row-of-controls', sequence.element, fixed.element),
    group('Angles', 'row-of-controls', ...fields.map((field) => field.element)), result, text.element));

  function draw() {
    sequence.show(model.get('sequence'));
    fixed.show(model.get('fixed'));
    model.get('angles').forEach((angle, k) => {
      const { field } = fields[k];
      if (document.activeElement !== field && field.value !== angle) field.value = angle;
    });
    result.innerHTML = model.get('result');
    text.say(model.get('message'));
  }

  draw();
  return follow(model, ['sequence', 'fixed', 'angles', 'result', 'message'], draw);
}
