// Write the scene of each stop at the moment that represents it on paper, for `python -m tools.rotations`.
import { COURSE, CROOKED, EYES, GENERIC, REST, DISTANCE, GROUND, LIGHT, RIM, placed, project, sceneOf } from './scene.js';
import { AXES } from '../../moving/js/mathematics.js';
import { LABELS } from '../../moving/js/glyphs.js';
import { STOPS } from './stops.js';

const SIZE = 440;
const round = (value) => (Array.isArray(value) ? value.map(round) : typeof value === 'number' ? Math.round(value * 1e4) / 1e4 + 0 : value);
const sizeOf = ({ text }) => {
  if (!LABELS[text]) return [9 * text.length, 14];
  const [left, top, right, bottom] = LABELS[text].ink;
  return [(right - left) * 0.02 + 4, (bottom - top) * 0.02 + 4];
};

// Return the state of a stop at a moment, if it was entered in the pose `start`.
export function stateAt(stop, t, start = stop.id === 'one-turn' ? CROOKED : GENERIC) {
  return { ...REST, eye: EYES[stop.id] ?? REST.eye, stop: stop.id, t, start, ...COURSE[stop.id](t, start) };
}

const stills = STOPS.map((stop) => {
  const state = stateAt(stop, stop.still), picture = sceneOf(state), { items, labels, view, target, half, frames } = picture;
  const places = placed(picture, SIZE / 2, labels.map(sizeOf), [SIZE, SIZE]);
  return { id: stop.id, before: stop.before, after: stop.after, angles: round(state.angles), frames: round(Object.values(frames)), view: round(view), target: round(target), half: round(half),
    items: items.map(({ shape, of, rows, origin, size, colour, alpha, casts }) => [shape, round(of), round(rows), round(origin), round(size), colour, round(alpha), casts ? 1 : 0]),
    labels: labels.map(({ at, text, colour }, k) => [text, LABELS[text] && colour !== 'muted' ? 1 : 0, colour, places[k].map((value) => Math.round(10 * value) / 10), round(at)]) };
});
// Two moments of each, with the camera's frames then: tests compare them with the book's Python.
const tried = STOPS.flatMap((stop) => [0.37, 0.97].map((t) => {
  const state = stateAt(stop, t), { frames, items } = sceneOf(state);
  return { id: stop.id, t, state: { ...state, shown: undefined }, frames, panes: items.filter(({ shape }) => shape === 'ribbon').map(({ of }) => of) };
}));
const seen = [[0.3, -0.4, 0.9], [1, 0.2, -1.1]].map((point) => [point, project(stills[0], point)]);
process.stdout.write(JSON.stringify({ size: SIZE, distance: DISTANCE, ground: GROUND, rim: RIM, light: LIGHT, axes: AXES, stills, ...(process.argv.includes('--tried') && { tried, seen }) }));
