// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/motion.py.
import { AXES, IDENTITY, add, cross, dot, enumerate, length, range, scale, subtract, sum, times, transpose } from './mathematics.js';
export const MOMENTS = { racket: [1.2, 16, 17], book: [6.9, 13.3, 19.7] };
export const SECONDS = 20;
export const SAMPLE = 0.1;
export const ROUNDING = 1e-15;
export const SIZE = 118;
export const LONGEST = 1.25;
export const COLOURS = { matrix: 'A', quaternion: 'D', angles: 'C' };
export const LEFT = -128;
export const RIGHT = 168;
export const FAULT = [24, 124, -16, 2];
export const ERROR = [156, 256, -12, 1];
export const MARGIN = [288, 324, 0, 90];
export const HEAD = range(29).map((k) => [0.45 + 0.47 * Math.cos(Math.PI * k / 14), 0.36 * Math.sin(Math.PI * k / 14), 0]);
export const STRINGS = [...[0.12, 0.285, 0.45, 0.615, 0.78].flatMap((x) => [-1, 1].map((side) => [x, side * 0.36 * Math.sqrt(1 - ((x - 0.45) / 0.47) ** 2), 0])), ...[-0.2, 0, 0.2].flatMap((y) => [-1, 1].map((side) => [0.45 + side * 0.47 * Math.sqrt(1 - (y / 0.36) ** 2), y, 0]))];
export const THROAT = [[0.065, 0.206, 0], [-0.24, 0, 0], [0.065, -0.206, 0]];
export const HANDLE = [[-0.24, 0, 0], [-0.85, 0, 0]];
export const COVER = [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]];
export const LONGEST_EDGE = 1.4;

export function bodyOf(moments) {
  const names = ['racket', 'book'].filter((name) => length(subtract(MOMENTS[name], moments)) === 0);
  return names.length ? names[0] : 'block';
}

export function edgesOf(moments) {
  const edges = moments.map((moment) => Math.sqrt(Math.max(sum(moments) / 2 - moment, 0)));
  return scale(LONGEST_EDGE / Math.max(...edges), edges);
}

export function outlinesOf(moments) {
  if (bodyOf(moments) === 'racket') {
    return [HEAD, THROAT, HANDLE];
  }
  const edges = edgesOf(moments);
  const thin = edges.indexOf(Math.min(...edges));
  return [COVER.map(([u, v]) => enumerate(edges).map(([k, edge]) => [0, u, v][(k - thin + 3) % 3] * edge / 2))];
}

export function placed(points, dcm) {
  const columns = transpose(dcm);
  return points.map((point) => times(columns, point));
}

export function picture(sheet, moments, dcm, reference, momentum) {
  sheet.triad('N', IDENTITY, { origin: sheet.placed(-136, 108), length: 0.28 });
  sheet.layer = 1;
  sheet.arrow(scale(1.4, momentum), { colour: 'accent', label: '$\\mathbf{H}$' });
  sheet.size = SIZE * Math.min(1, LONGEST / Math.max(...dcm.map((row) => length(row))));
  if (bodyOf(moments) === 'racket') {
    racket(sheet, dcm);
  } else {
    block(sheet, dcm, edgesOf(moments));
  }
  for (const [k, row] of enumerate(dcm)) {
    sheet.layer = k === 2 && dot(row, sheet.view[2]) <= 0 ? 1.5 : 5;
    sheet.arrow(row, { colour: 'A', label: `$\\hat{a}_${AXES[k]}$` });
  }
  sheet.layer = 6;
  for (const outline of outlinesOf(moments)) {
    sheet.line(placed(outline, reference), 'muted', 'guide');
  }
}

export function racket(sheet, dcm) {
  sheet.layer = dot(dcm[0], sheet.view[2]) > 0 ? 2 : 4;
  sheet.line(placed(THROAT, dcm), 'A', 'thick');
  sheet.line(placed(HANDLE, dcm), 'A', 'tube');
  sheet.layer = 3;
  sheet.area(placed(HEAD.slice(0, -1), dcm), 'A', dot(dcm[2], sheet.view[2]) > 0 ? 8 : 38, false);
  sheet.layer = 3.1;
  sheet.path('MLMLMLMLMLMLMLML', placed(STRINGS, dcm).map((point) => sheet.onSheet(point)), 'faint A');
  sheet.layer = 3.2;
  sheet.line(placed(HEAD, dcm), 'A', 'thick');
}

export function block(sheet, dcm, edges) {
  const half = enumerate(dcm).map(([k, row]) => scale(edges[k] / 2, row));
  sheet.layer = 3;
  for (const [k, fill] of enumerate([26, 26, 8])) {
    const u = half[(k + 1) % 3], v = half[(k + 2) % 3];
    for (const side of [-1, 1]) {
      if (side * dot(cross(u, v), sheet.view[2]) > 0) {
        const corners = [add(u, v), subtract(v, u), scale(-1, add(u, v)), subtract(u, v)];
        const faces = corners.map((corner) => add(scale(side, half[k]), corner));
        sheet.area(faces, 'A', k === 2 && side < 0 ? 38 : fill);
      }
    }
  }
}

export function across(time) {
  return LEFT + (RIGHT - LEFT) * time / SECONDS;
}

export function down(part, value) {
  const [top, bottom, least, most] = part;
  return bottom - (bottom - top) * (Math.max(least, Math.min(most, value)) - least) / (most - least);
}

export function axes(sheet) {
  const origin = [0, 0, 0];
  for (const [part, title, marks] of [[FAULT, '$\\mathrm{departure\\ from\\ orthogonality}$', [[-15, '$10^{-15}$'], [-10, '$10^{-10}$'], [-5, '$10^{-5}$'], [0, '$1$']]], [ERROR, '$\\mathrm{error\\ (rad)}$', [[-10, '$10^{-10}$'], [-5, '$10^{-5}$'], [0, '$1$']]], [MARGIN, '$\\mathrm{margin\\ to\\ gimbal\\ lock\\ (degrees)}$', [[0, '$0$'], [90, '$90$']]]]) {
    const [top, bottom] = part.slice(0, 2);
    sheet.label(origin, title, 'ink', [(LEFT + RIGHT) / 2, top - 13], 16);
    for (const second of [0, 5, 10, 15, 20]) {
      sheet.path('ML', [[across(second), top], [across(second), bottom]], 'faint muted');
    }
    for (const [value, words] of marks) {
      sheet.path('ML', [[LEFT, down(part, value)], [RIGHT, down(part, value)]], 'faint muted');
      sheet.label(origin, words, 'muted', [LEFT - 26, down(part, value)], 14);
    }
  }
  for (const second of [0, 5, 10, 15, 20]) {
    sheet.label(origin, `$${second}$`, 'muted', [across(second), MARGIN[1] + 13], 14);
  }
  sheet.label(origin, '$t\\ \\mathrm{(s)}$', 'ink', [across(17.5), MARGIN[1] + 15], 16);
}
