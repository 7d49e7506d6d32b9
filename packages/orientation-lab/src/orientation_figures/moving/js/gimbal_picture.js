// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/gimbal.py.
import { AXES, IDENTITY, add, cross, dot, enumerate, length, multiply, scale, simpleDcm, unit, zip } from './mathematics.js';
export const OUTER = 1.05;
export const INNER = 0.76;
export const CAMERA = [0.62, 0.44, 0.46];
export const END = 1.42;
export const SIZE = 98;
export const INSET = [1.4, 1.1];
export const SYMBOLS = ['$\\psi$', '$\\theta$', '$\\varphi$'];

export function device(angles, sequence) {
  const [B, b, c] = zip(sequence, angles).map(([axis, angle]) => simpleDcm(axis, angle));
  const C = multiply(b, B);
  const D = multiply(c, C);
  const at = [...sequence].map((axis) => AXES.indexOf(axis));
  return { B, C, D, at, axes: [IDENTITY[at[0]], B[at[1]], C[at[2]]] };
}

export function halfRing(sheet, start, middle, radius, letter, layer) {
  const normal = cross(start, middle);
  const level = unit(add(cross(normal, sheet.view[2]), scale(1e-9, middle)));
  const edge = scale(dot(level, middle) < 0 ? -1 : 1, level);
  const first = Math.atan2(dot(cross(start, edge), normal), dot(start, edge));
  for (const [begin, angle] of [[start, first], [edge, Math.PI - first]]) {
    const halfway = add(scale(Math.cos(angle / 2), begin), scale(Math.sin(angle / 2), cross(normal, begin)));
    sheet.layer = dot(halfway, sheet.view[2]) < 0 ? -layer : layer;
    sheet.turn(normal, angle, begin, { radius, colour: letter, kind: 'tube', head: false });
  }
}

export function picture(sheet, gimbal, close = false, lit = null) {
  const B = gimbal['B'], C = gimbal['C'], D = gimbal['D'], at = gimbal['at'], axes = gimbal['axes'];
  const near = (direction) => dot(direction, sheet.view[2]) < 0 ? -1 : 1;
  const down = scale(-1, axes[0]);
  sheet.layer = 6 * near(down);
  sheet.cylinder(scale(1.3, down), scale(1.86, down), 0.13, 'A');
  sheet.cylinder(scale(1.13, down), scale(1.3, down), 0.2, 'A');
  halfRing(sheet, axes[1], down, OUTER, 'B', 5);
  halfRing(sheet, axes[1], scale(-1, axes[2]), INNER, 'C', 3);
  for (const [axis, sides, radius, inner, letter, layer] of [[axes[1], [1, -1], OUTER, INNER, 'B', 4], [axes[2], [-1], INNER, 0.2, 'C', 2]]) {
    for (const out of sides.map((side) => scale(side, axis))) {
      sheet.layer = layer * near(out);
      sheet.line([scale(inner, out), scale(radius - 0.1, out)], letter, 'tube slim');
      sheet.layer = (layer + 1.5) * near(out);
      sheet.cylinder(scale(radius - 0.12, out), scale(radius + 0.12, out), 0.14, letter);
    }
  }
  sheet.layer = 0;
  sheet.box(D, CAMERA, { colour: 'D' });
  sheet.layer = 0.5 * near(D[1]);
  sheet.cylinder(scale(CAMERA[1] / 2, D[1]), scale(0.5, D[1]), 0.15, 'D');
  sheet.layer = 0.6 * near(D[1]);
  sheet.circle(D[1], { radius: 0.09, origin: scale(0.5, D[1]), colour: 'D', kind: 'fill-38' });
  const rests = [IDENTITY[at[1]], B[at[2]], C[at[1]]];
  for (const [k, axis] of enumerate(axes)) {
    const same = close && k !== 1;
    const colour = same ? 'accent' : 'ink';
    for (const arm of [axis, scale(-1, axis)]) {
      sheet.layer = 7 * near(arm);
      sheet.line([scale((k === 1 ? OUTER : INNER) + 0.1, arm), scale(END, arm)], colour, same ? 'thick' : 'guide');
    }
    const end = scale(same && dot(axis, axes[0]) < 0 ? -END : END, axis);
    sheet.layer = 7 * near(end);
    sheet.turn(axis, 4.4, rests[k], { radius: 0.16, origin: scale(0.9, end), colour });
    const place = sheet.onSheet(end);
    const out = length(place);
    const outward = out > 20 ? scale(17 / out, place) : [16, -16];
    sheet.layer = 8;
    sheet.label(end, SYMBOLS[k], colour, same && k === 2 ? add(outward, [22, 0]) : outward);
  }
  if (close) {
    sheet.line([scale(-END, axes[0]), scale(END, axes[0])], 'accent', 'guide');
  }
  sheet.label(scale(1.62, down), '$A$', 'A', [24, 4]);
  sheet.label(add(scale(-0.9, axes[0]), scale(0.9, axes[1])), '$B$', 'B');
  sheet.label(add(scale(0.4 * near(axes[1]), axes[1]), scale(-0.4, axes[2])), '$C$', 'C');
  sheet.labelBeyond(scale(0.26, D[2]), '$D$', 'D', 14);
  const corner = add(scale(INSET[0], sheet.view[0]), scale(INSET[1], sheet.view[1]));
  for (const [letter, rows, index, reach] of [['A', IDENTITY, 1, 0.54], ['D', D, 0, 0.3]]) {
    for (const [k, row] of enumerate(rows)) {
      sheet.faded = lit !== null && lit[index] !== k;
      const label = `$\\hat{${letter.toLowerCase()}}_${AXES[k]}$`;
      sheet.arrow(add(corner, scale(reach, row)), { start: corner, colour: letter, label, size: 17 });
    }
  }
  sheet.faded = false;
}
