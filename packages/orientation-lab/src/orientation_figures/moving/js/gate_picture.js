// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/gate.py.
import { enumerate } from './mathematics.js';
export const FIRST = 8;
export const LAST = 45;
export const LARGEST = 60;
export const CAR = [28, 33];
export const LEFT = -132;
export const RIGHT = 168;
export const TOP = -96;
export const BOTTOM = 96;

export function across(time) {
  return LEFT + (RIGHT - LEFT) * (time - FIRST) / (LAST - FIRST);
}

export function down(error) {
  return (TOP + BOTTOM) / 2 - (BOTTOM - TOP) / 2 * Math.max(-1, Math.min(1, error / LARGEST));
}

export function picture(sheet, curves) {
  const origin = [0, 0, 0];
  const near = across(CAR[0]), far = across(CAR[1]);
  const corners = [[near, TOP], [far, TOP], [far, BOTTOM], [near, BOTTOM]];
  sheet.area(corners.map(([right, below]) => sheet.placed(right, below)), 'N', 16, false);
  sheet.label(origin, '$\\mathrm{car}$', 'muted', [(near + far) / 2, TOP + 12], 14);
  for (const [error, words] of [[-60, '$-60$'], [-30, '$-30$'], [0, '$0$'], [30, '$30$'], [60, '$60$']]) {
    sheet.path('ML', [[LEFT, down(error)], [RIGHT, down(error)]], 'faint muted');
    sheet.label(origin, words, 'muted', [LEFT - 22, down(error)], 14);
  }
  for (const [time, words] of [[10, '$10$'], [20, '$20$'], [30, '$30$'], [40, '$40$']]) {
    sheet.path('ML', [[across(time), TOP], [across(time), BOTTOM]], 'faint muted');
    sheet.label(origin, words, 'muted', [across(time), BOTTOM + 14], 14);
  }
  sheet.label(origin, '$t\\ \\mathrm{(s)}$', 'ink', [across(44), BOTTOM + 16], 16);
  sheet.label(origin, '$\\mathrm{heading\\ error\\ (degrees)}$', 'ink', [0, TOP - 16], 16);
  sheet.layer = 1;
  for (const curve of curves) {
    const points = enumerate(curve).map(([second, error]) => [across(FIRST + second), down(error)]);
    sheet.path('M' + 'L'.repeat(points.length - 1), points, 'D');
  }
}
