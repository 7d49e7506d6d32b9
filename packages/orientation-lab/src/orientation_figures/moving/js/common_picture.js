// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/common.py.
import { dot, length, multiply, scale, simpleDcm, subtract } from './mathematics.js';

export function around(sheet, axis, angle, start, { colour = 'muted', head = false, kind = '' } = {}) {
  const foot = scale(dot(start, axis), axis);
  const arm = subtract(start, foot);
  if (length(arm) > 1e-6) {
    sheet.turn(axis, angle, arm, { radius: length(arm), origin: foot, colour, head, kind });
  }
}

export function chain(turns, kind = 'body', start = simpleDcm('z', 0)) {
  const frames = [start];
  for (const [axis, angle] of turns) {
    const turn = simpleDcm(axis, angle);
    frames.push(kind === 'body' ? multiply(turn, frames.at(-1)) : multiply(frames.at(-1), turn));
  }
  return frames;
}

export function partly(turns, share) {
  const done = share * turns.length;
  const whole = Math.min(Math.floor(done + 1e-9), turns.length);
  const rest = Math.max(0, done - whole);
  if (rest > 1e-9) {
    const [axis, angle] = turns[whole];
    return [...turns.slice(0, whole), [axis, rest * rest * (3 - 2 * rest) * angle]];
  }
  return turns.slice(0, whole);
}
