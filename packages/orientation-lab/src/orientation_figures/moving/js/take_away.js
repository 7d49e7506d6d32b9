import { button, choice, element, group, write } from './shared.js';

// The formulas of the module in other languages, written when the pages were built: one script for each language, which
// is loaded when the reader chooses it.
const ENDINGS = { C: 'c', 'C++': 'cpp', Rust: 'rs', Julia: 'jl', Octave: 'm', JavaScript: 'js', GLSL: 'glsl' };
export const LANGUAGES = Object.keys(ENDINGS);
// The folder of the figures' scripts. A notebook has none, but there Python writes the formulas itself.
const PLACE = globalThis.document?.currentScript?.src ?? '';
const asked = new Map();

const beside = (name) => new URL(name, PLACE).href;
export const canTakeAway = () => Boolean(PLACE);

// Return the texts of a language, by formula, sequence or axis, matrix, scalar and unit.
export function textsIn(language) {
  if (!asked.has(language)) {
    const script = element('script', { src: beside(`formulas-${language.toLowerCase().replace('++', 'pp')}.js`) });
    asked.set(language, new Promise((resolve, reject) => {
      script.addEventListener('load', () => resolve(globalThis.orientationFormulas[language]));
      script.addEventListener('error', () => reject(new Error('The formulas could not be loaded.')));
      document.head.append(script);
    }).then(async (packed) => {
      const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
      return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).json();
    }));
    asked.get(language).catch(() => asked.delete(language));
  }
  return asked.get(language);
}

// The colours of drawings, for a page without drawings.
export const colours = () => element('link', { rel: 'stylesheet', href: beside('drawing.css') });

// Return the text of a formula, ignoring choices that do not matter to it.
export function textOf(texts, name, wanted) {
  const { keys, ...given } = texts[name], parts = keys.map((key) => wanted[key]);
  return given.texts[parts.join(' ')];
}

// A box for the text with its buttons: `show(text, file name)`.
export function textBox(say) {
  let name = '';
  const text = element('output', { class: 'result code', 'aria-label': 'Formula', tabindex: '0' });
  const copy = button('Copy the formula', async () => {
    await navigator.clipboard.writeText(`${text.textContent}\n`);
    say('Formula copied.');
  });
  const save = button('Save as a file', () => {
    const address = URL.createObjectURL(new Blob([`${text.textContent}\n`], { type: 'text/plain' }));
    element('a', { href: address, download: name }).click();
    URL.revokeObjectURL(address);
  });
  return { element: group('Formula', 'taken', text, element('div', { class: 'row-of-controls' }, copy, save)),
    show(shown, file, language) {
      name = `${file}.${ENDINGS[language]}`;
      write(text, shown || '\u2013');
      copy.disabled = save.disabled = !shown;
    } };
}

export const languageChoice = (change, first = []) => choice({ name: 'Language', options: [...first, ...LANGUAGES], change });
