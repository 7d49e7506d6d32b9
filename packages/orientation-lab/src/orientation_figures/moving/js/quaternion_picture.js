// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/quaternion.py.
import { AXES, IDENTITY, axisAngleFromDcm, degrees, dot, enumerate, length, multiply, range, scale, subtract, transpose, unit, zip } from './mathematics.js';
export const SIZE = 96;
export const BALL = 104;
export const KNOB = 1.32;
export const MIDDLE = [142, 130];
export const RADIUS = 70;
export const SECONDS = 4;
export const SAMPLES = 60;
export const WAYS = ['C', 'D', 'E'];
export const LEFT = -120;
export const RIGHT = 150;
export const TOP = 144;
export const BOTTOM = 196;
export const TOPS = [30, 60, 90, 120, 180, 360, 720];

export function double(sheet, axis, angle, dcm, more) {
  const knob = scale(KNOB, axis), sizes = axis.map((entry) => Math.abs(entry));
  const far = IDENTITY[sizes.indexOf(Math.min(...sizes))];
  const arm = subtract(far, scale(dot(far, axis), axis));
  sheet.line([scale(-0.6, axis), knob], 'accent', 'guide');
  sheet.triad('N', IDENTITY, { length: 1.25 });
  sheet.triad('A', dcm);
  sheet.arrow(axis, { colour: 'accent' });
  sheet.dot(knob, 'accent', 5);
  sheet.label(knob, '$\\hat{e}$', 'accent', [17, 2]);
  const rest = angle - 2 * Math.PI;
  const second = rest > 1e-9;
  if (second) {
    sheet.turn(axis, 2 * Math.PI, arm, { radius: 0.5, colour: 'accent', head: false });
  }
  if (angle > 0) {
    const turn = second ? rest : angle, radius = second ? 0.6 : 0.5;
    sheet.turn(axis, turn, arm, { radius, label: '$\\theta$', colour: 'accent', kind: 'thick' });
  }
  const half = angle / 2;
  sheet.layer = 1;
  for (const way of [0, Math.PI / 2]) {
    sheet.line([onCircle(sheet, -RADIUS - 12, way), onCircle(sheet, RADIUS + 12, way)], 'muted', 'faint');
  }
  sheet.line(roundTo(sheet, RADIUS, 2 * Math.PI), 'muted');
  sheet.label(onCircle(sheet, RADIUS + 12, 0), '$q_0$', 'ink', [3, 13], 16);
  sheet.label(onCircle(sheet, RADIUS + 12, Math.PI / 2), '$\\hat{e}$', 'accent', [12, 2], 16);
  sheet.layer = 2;
  if (half > 1e-9) {
    sheet.line(roundTo(sheet, RADIUS, half), 'accent', 'thick');
    sheet.line(roundTo(sheet, 22, half), 'accent');
    sheet.label(onCircle(sheet, 40, half / 2), '$\\theta/2$', 'accent', [0, 0], 16);
  }
  const middle = onCircle(sheet, 0, 0);
  sheet.arrow(onCircle(sheet, RADIUS, half), { start: middle, colour: 'accent', label: '$q$' });
  if (more) {
    sheet.arrow(onCircle(sheet, -RADIUS, half), { start: middle, colour: 'muted', label: '$-q$' });
  }
}

export function onCircle(sheet, radius, angle) {
  return sheet.placed(MIDDLE[0] + radius * Math.cos(angle), MIDDLE[1] - radius * Math.sin(angle));
}

export function roundTo(sheet, radius, angle) {
  return range(49).map((k) => onCircle(sheet, radius, k / 48 * angle));
}

export function angleBetween(before, after) {
  return before === null || after === null ? NaN : axisAngleFromDcm(multiply(after, transpose(before)))[1];
}

export function ways(sheet, ends, tracks, speeds, now, raw, k, share) {
  const hats = [...'abcde'].map((letter) => `$\\hat{${letter}}_${AXES[k]}$`);
  sheet.circle(sheet.view[2], { colour: 'muted', kind: 'faint' });
  sheet.circle([0, 0, 1], { half: 'front', colour: 'muted', kind: 'faint' });
  sheet.circle([0, 0, 1], { half: 'back', colour: 'muted', kind: 'guide faint' });
  sheet.line([ends[0][k], ends[1][k]], 'E', 'guide');
  for (const [n, track] of enumerate(tracks.slice(0, 2))) {
    if (track[0] !== null) {
      sheet.line(track.map((dcm) => dcm[k]), WAYS[n], 'axis');
    }
  }
  for (const [n, dcm] of enumerate(tracks[2])) {
    if (dcm !== null && n % 3 === 0) {
      sheet.dot(dcm[k], 'E', 3);
    }
  }
  sheet.arrow(ends[0][k], { colour: 'A', label: hats[0] });
  sheet.arrow(ends[1][k], { colour: 'B', label: hats[1] });
  sheet.layer = 1;
  if (length(subtract(raw, unit(raw))) > 1e-6) {
    sheet.line([[0, 0, 0], raw], 'E');
  }
  sheet.dot(raw, 'E', 4);
  const moving = 1e-9 < share && share < 1 - 1e-9;
  for (const [n, dcm] of enumerate(now)) {
    if (dcm !== null && moving) {
      sheet.arrow(dcm[k], { colour: WAYS[n], label: hats[n + 2] });
    } else if (dcm !== null) {
      sheet.dot(dcm[k], WAYS[n], 5);
    }
  }
  plot(sheet, speeds, share);
}

export function plotted(speeds) {
  const fast = degrees(Math.max(...[0, ...speeds.flatMap((track) => track.filter((speed) => speed >= 0))]));
  const tops = TOPS.filter((top) => top >= fast);
  const highest = tops.length ? tops[0] : TOPS.at(-1), pieces = [];
  for (const track of speeds) {
    const runs = [[]];
    for (const [n, speed] of enumerate(track)) {
      if (degrees(speed) <= highest) {
        runs.at(-1).push([(n + 0.5) / SAMPLES, degrees(speed)]);
      } else if (runs.at(-1).length) {
        runs.push([]);
      }
    }
    pieces.push(runs.filter((run) => run.length > 1));
  }
  return [highest, pieces, fast > highest ? fast : 0];
}

export function plot(sheet, speeds, share) {
  const [highest, pieces, beyond] = plotted(speeds);
  const at = (part, speed) => sheet.placed(LEFT + part * (RIGHT - LEFT), BOTTOM - speed / highest * (BOTTOM - TOP));
  sheet.line([at(0, 0), at(1, 0)], 'muted');
  sheet.line([at(0, 0), at(0, highest)], 'muted');
  sheet.line([at(0, highest), at(1, highest)], 'muted', 'faint');
  sheet.label(at(0, highest), `$${highest}^\\circ/\\mathrm{s}$`, 'ink', [-30, 0], 14);
  sheet.label(at(0, 0), '$0$', 'ink', [-11, 0], 14);
  sheet.label(at(1, 0), `$${SECONDS}\\,\\mathrm{s}$`, 'ink', [0, 14], 14);
  if (beyond) {
    sheet.label(at(0.5, highest), '$\\mathrm{cut\\ off}$', 'ink', [0, -9], 14);
  }
  sheet.line([at(share, 0), at(share, highest)], 'ink', 'guide');
  for (const [letter, runs] of zip(WAYS, pieces)) {
    for (const run of runs) {
      sheet.line(run.map(([part, speed]) => at(part, speed)), letter, 'axis');
    }
  }
}
