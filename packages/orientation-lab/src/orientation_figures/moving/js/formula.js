import { AXES, SEQUENCES } from './mathematics.js';
import { colours, languageChoice, textBox, textOf, textsIn } from './take_away.js';
import { button, choice, element, group, liveText, onceAFrame, open } from './shared.js';

// Any formula of the module, in a language and a convention that the reader chooses, and a button for it at each
// function on the page.
export function render({ el }) {
  const wanted = { name: 'dcm_from_quaternion', language: 'C', sequence: 'zxy', axis: 'x', matrix: 'as here', scalar: 'first', unit: 'radians' };
  const redraw = onceAFrame(draw), said = liveText();
  const set = (key) => (value) => { wanted[key] = value; redraw(); };
  const lists = {
    sequence: choice({ name: 'Sequence', options: SEQUENCES.map((one) => [one, [...one].join('-')]), change: set('sequence') }),
    axis: choice({ name: 'Axis', options: AXES, change: set('axis') }),
    matrix: choice({ name: 'Matrix', options: [['as here', 'as here (passive)'], ['transposed', 'transposed (active)']], change: set('matrix') }),
    scalar: choice({ name: 'Scalar', options: ['first', 'last'], change: set('scalar') }),
    unit: choice({ name: 'Angles in', options: ['radians', 'degrees'], change: set('unit') }),
  };
  const language = languageChoice(set('language')), box = textBox((words) => said.say(words));
  const names = element('div');
  let formula;
  el.append(colours());
  open(el, element('div', { class: 'controls alone' },
    group('Formula to copy', 'row-of-controls', names, language.element, ...Object.values(lists).map((list) => list.element)),
    box.element, said.element));

  async function draw() {
    let texts;
    try { texts = await textsIn(wanted.language); } catch (error) { said.say(error.message); return; }
    if (!formula) {
      formula = choice({ name: 'Formula', options: Object.keys(texts), change: set('name') });
      names.replaceWith(formula.element);
      for (const heading of document.querySelectorAll('dt.sig[id^="orientation."]')) {
        const name = heading.id.split('.').at(-1);
        if (!texts[name]) continue;
        heading.append(button('In another language', () => {
          wanted.name = name;
          heading.parentElement.querySelector('dd').prepend(el);   // Move it to where the reader is.
          draw();
        }, { class: 'take-formula' }));
      }
    }
    formula.show(wanted.name);
    language.show(wanted.language);
    for (const [key, list] of Object.entries(lists)) {
      list.show(wanted[key]);
      list.element.hidden = !texts[wanted.name].keys.includes(key);
    }
    box.show(textOf(texts, wanted.name, wanted), wanted.name, wanted.language);
  }

  draw();
  return () => {};
}
