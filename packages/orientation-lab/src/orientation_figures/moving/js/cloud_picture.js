// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/cloud.py.
import { IDENTITY, add, dcmFromRotationVector, multiply, range, scale, simpleDcm } from './mathematics.js';
export const COUNT = 200;
export const SIZE = 112;
export const STEPS = [0.6180339887498949, 0.7548776662466927, 0.5698402909980532];
export const ESTIMATE = multiply(simpleDcm('x', 0.5), multiply(simpleDcm('y', -0.5), simpleDcm('z', 0.9)));

export function between(k, step) {
  return (k * step + 0.5 / COUNT) % 1;
}

export function normals(k) {
  const first = Math.sqrt(-2 * Math.log((k + 0.5) / COUNT));
  const second = Math.sqrt(-2 * Math.log(1 - between(k, STEPS[1])));
  const turn = 2 * Math.PI * between(k, STEPS[0]);
  return [first * Math.cos(turn), first * Math.sin(turn), second * Math.cos(2 * Math.PI * between(k, STEPS[2]))];
}

export function orientations(large, small, body) {
  const errors = range(COUNT).map((k) => normals(k)).map(([x, y, z]) => dcmFromRotationVector([small * x, small * y, large * z]));
  return errors.map((error) => body ? multiply(error, ESTIMATE) : multiply(ESTIMATE, error));
}

export function tipsMean(dcms, row) {
  let total;
  total = [0, 0, 0];
  for (const dcm of dcms) {
    total = add(total, dcm[row]);
  }
  return scale(1 / COUNT, total);
}

export function picture(sheet, large, small, body) {
  const dcms = orientations(large, small, body);
  sheet.circle(sheet.view[2], { colour: 'muted', kind: 'faint' });
  sheet.circle([0, 0, 1], { half: 'front', colour: 'muted', kind: 'faint' });
  sheet.circle([0, 0, 1], { half: 'back', colour: 'muted', kind: 'guide faint' });
  sheet.triad('N', IDENTITY, { length: 1.25 });
  for (const [row, colour] of [[0, 'B'], [2, 'D']]) {
    sheet.dots(dcms.map((dcm) => dcm[row]), colour);
  }
  sheet.layer = 1;
  sheet.arrow(ESTIMATE[0], { colour: 'B', label: '$\\hat{b}_x$' });
  sheet.arrow(ESTIMATE[2], { colour: 'D', label: '$\\hat{b}_z$' });
}
