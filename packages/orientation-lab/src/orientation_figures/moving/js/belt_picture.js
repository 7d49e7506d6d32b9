// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/belt.py.
import { IDENTITY, add, dcmFromQuaternion, dot, range, scale } from './mathematics.js';
export const SIZE = 96;
export const LENGTH = 3;
export const WIDTH = 0.19;
export const PIECES = 72;
export const WALL = [0.9, 0.06, 0.9];
export const PLATE = [0.62, 0.09, 0.44];

export function fullTurns(angle) {
  const numbers = [1, 2].filter((turns) => Math.abs(angle - 2 * Math.PI * turns) < 1e-8);
  return numbers.length ? numbers[0] : 0;
}

export function quaternionAt(angle, passed, part) {
  let half, tilt, way;
  const share = Math.min(1, Math.max(0, 1.5 * part - 0.25));
  const turns = fullTurns(angle);
  if (turns === 2) {
    [tilt, way] = [passed * Math.PI / 2, 2 * Math.PI * share];
    const size = Math.cos(tilt);
    return [1 - size * size * (1 - Math.cos(way)), 0, size * Math.sin(way), size * Math.sin(tilt) * (1 - Math.cos(way))];
  }
  [tilt, half] = [turns === 1 ? passed * Math.PI : 0, angle * share / 2];
  return [Math.cos(half), 0, Math.cos(tilt) * Math.sin(half), Math.sin(tilt) * Math.sin(half)];
}

export function belt(angle, passed) {
  const frames = range(PIECES + 1).map((k) => dcmFromQuaternion(quaternionAt(angle, passed, k / PIECES)));
  const places = [[0, -LENGTH / 2, 0]];
  for (const k of range(PIECES)) {
    places.push(add(places.at(-1), scale(LENGTH / PIECES / 2, add(frames[k][1], frames[k + 1][1]))));
  }
  return [frames, places];
}

export function picture(sheet, angle, passed) {
  const [frames, places] = belt(angle, passed);
  const toward = sheet.view[2], end = frames.at(-1);
  const wall = add(places[0], [0, -0.03, 0]), plate = add(places.at(-1), scale(0.045, end[1]));
  sheet.layer = dot(wall, toward);
  sheet.box(IDENTITY, WALL, { origin: wall, colour: 'N' });
  for (const k of range(PIECES)) {
    const corners = [[0, -1], [0, 1], [1, 1], [1, -1]].map(([m, side]) => add(places[k + m], scale(side * WIDTH, frames[k + m][0])));
    sheet.layer = dot(add(...corners), toward) / 4;
    sheet.area(corners, dot(frames[k][2], toward) > 0 ? 'B' : 'D', 38, false);
  }
  sheet.layer = dot(plate, toward);
  sheet.box(end, PLATE, { origin: plate, colour: 'A' });
  sheet.triad('A', end, { origin: plate, length: 0.62, labels: ['', '', ''] });
}
