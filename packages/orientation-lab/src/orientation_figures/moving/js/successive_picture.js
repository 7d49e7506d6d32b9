// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/successive.py.
import { around, chain, partly } from './common_picture.js';
import { AXES, IDENTITY, axisAngleFromDcm, enumerate, multiply, range, scale, times, transpose } from './mathematics.js';
export const REACH = 1.25;
export const BEFORE = 0.66;
export const SIZE = 96;
export const LETTERS = 'NABCD';
export const COMPARISONS = ['nothing', '1 and 2 exchanged', '2 and 3 exchanged', '3 and 4 exchanged', 'body and space fixed'];

export function secondChain(turns, kind, compare) {
  const k = COMPARISONS.indexOf(compare);
  if (k === 4) {
    return [turns, kind === 'body' ? 'space' : 'body'];
  }
  return [[...turns.slice(0, k - 1), turns[k], turns[k - 1], ...turns.slice(k + 1)], kind];
}

export function axisOf(frames, turns, kind, k) {
  return (kind === 'body' ? frames[k] : IDENTITY)[AXES.indexOf(turns[k][0])];
}

export function picture(sheet, turns, kind, share, compare, lit = false) {
  const now = partly(turns, share);
  const frames = chain(now, kind);
  const last = now.length, end = frames.at(-1);
  const compared = compare !== COMPARISONS[0];
  sheet.triad('N', IDENTITY, { length: REACH });
  sheet.faded = lit || compared;
  for (const k of range(1, last)) {
    sheet.triad(LETTERS[k], frames[k], { length: BEFORE, labels: ['', '', ''] });
  }
  if (last && !compared) {
    const axis = axisOf(frames, now, kind, last - 1);
    sheet.line([scale(-0.35, axis), scale(REACH, axis)], 'accent', 'guide');
    for (const row of frames[last - 1]) {
      around(sheet, axis, now[last - 1][1], row);
    }
  }
  sheet.faded = false;
  if (last) {
    sheet.triad(LETTERS[last], end);
  }
  const letters = [...LETTERS].slice(0, turns.length + 1);
  if (compared) {
    const [otherTurns, otherKind] = secondChain(turns, kind, compare);
    const otherNow = partly(otherTurns, share);
    const otherFrames = chain(otherNow, otherKind);
    if (last) {
      const [between, angle] = axisAngleFromDcm(multiply(otherFrames.at(-1), transpose(end)));
      if (angle > 0.02) {
        for (const row of end) {
          around(sheet, times(transpose(end), between), angle, row);
        }
      }
      sheet.triad('E', otherFrames.at(-1));
    }
    const colours = ['N', ...turns.slice(1).map((_) => 'muted'), 'E'];
    strip(sheet, otherFrames, otherNow, otherKind, colours, 195, 22);
  }
  strip(sheet, frames, now, kind, letters, compared ? 143 : 168, compared ? 22 : 27);
}

export function strip(sheet, frames, turns, kind, colours, down, radius) {
  const width = 340 / colours.length, reach = radius / SIZE;
  const at = (x, y = 0) => sheet.placed(x, down + y);
  for (const [k, dcm] of enumerate(frames)) {
    const x = (k - (colours.length - 1) / 2) * width;
    sheet.box(dcm, [1.1 * reach, 0.8 * reach, 0.28 * reach], { origin: at(x), colour: colours[k] });
    sheet.triad(colours[k], dcm, { origin: at(x), length: reach, labels: ['', '', ''] });
    if (colours[k] !== 'muted') {
      sheet.label(at(x - radius + 1, -radius + 1), `$${colours[k]}$`, colours[k], [0, 0], 16);
    }
    if (k) {
      const start = x - width + radius + 7, end = x - radius - 3;
      const short = Math.max(0, (end - start - 26) / 2);
      sheet.arrow(at(end - short, 4), { start: at(start + short, 4), colour: 'muted' });
      const letter = kind === 'space' ? 'N' : colours[k - 1], axis = turns[k - 1][0];
      const name = letter === 'muted' ? axis : `\\hat{${letter.toLowerCase()}}_${axis}`;
      sheet.label(at((start + end) / 2, -8), `$${name}$`, 'ink', [0, 0], 15);
    }
  }
}
