// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/graph.py.
import { AXES, add, enumerate, length, scale, subtract } from './mathematics.js';
export const SIZE = 96;
export const REACH = 0.5;
export const ACROSS = 100;
export const DOWN = 100;
export const LEFT = -130;
export const SHORT = 14;
export const CORNERS = [[-19, 18], [-19, -18], [19, 18], [19, -18]];

export function places(edges) {
  const children = { N: [] }, depth = { N: 0 }, line = {  }, leaves = [];
  const names = ['N', ...edges.map((edge) => edge[0])];
  for (const edge of edges) {
    const [frame, reference] = edge.slice(0, 2);
    children[reference].push(frame);
    children[frame] = [];
    depth[frame] = depth[reference] + 1;
  }
  const walk = (frame) => {
    for (const child of children[frame]) {
      walk(child);
    }
    if (children[frame].length) {
      line[frame] = (line[children[frame][0]] + line[children[frame].at(-1)]) / 2;
    } else {
      line[frame] = leaves.length;
      leaves.push(frame);
    }
  };
  walk('N');
  const across = Math.min(ACROSS, 280 / Math.max(...[1, ...names.map((name) => depth[name])]));
  const down = Math.min(DOWN, 190 / leaves.length);
  return Object.fromEntries(names.map((name) => [name, [LEFT + across * depth[name], down * (line[name] - (leaves.length - 1) / 2)]]));
}

export function picture(sheet, edges, dcms, path) {
  let best, most;
  const spots = places(edges);
  const names = ['N', ...edges.map((edge) => edge[0])];
  for (const edge of edges) {
    const [frame, reference] = edge.slice(0, 2);
    const on = path.includes(frame) && path.includes(reference);
    const ends = [sheet.placed(...spots[reference]), sheet.placed(...spots[frame])];
    sheet.line(ends, on ? 'accent' : 'muted', on ? 'thick' : 'guide');
  }
  sheet.layer = 1;
  const near = enumerate(names).flatMap(([k, name]) => names.slice(k + 1).map((later) => length(subtract(spots[name], spots[later]))));
  const reach = Math.min(REACH, 0.44 * Math.min(...near) / SIZE);
  for (const name of names) {
    const place = sheet.placed(...spots[name]);
    sheet.triad(name, dcms[name], { origin: place, length: reach, labels: ['', '', ''] });
    const tips = dcms[name].map((row) => sheet.onSheet(scale(reach, row)));
    for (const [k, row] of enumerate(dcms[name])) {
      if (length(tips[k]) > SHORT) {
        sheet.label(add(place, scale(reach + 0.1, row)), `$${AXES[k]}$`, name, [0, 0], 14);
      }
    }
    [best, most] = [CORNERS[0], 0];
    for (const corner of CORNERS) {
      const free = Math.min(...tips.map((tip) => length(subtract(tip, corner))));
      if (free > most + 1e-6) {
        best = corner;
        most = free;
      }
    }
    sheet.label(place, `$${name}$`, name, best);
  }
}
