// The surfaces of the shapes, as triangles: { position, normal, index }.
import { add, cross, dot, length, scale, subtract, unit } from '../../moving/js/mathematics.js';

const TURN = 2 * Math.PI;

class Surface {
  constructor() { this.position = []; this.normal = []; this.index = []; }

  point(place, normal) {
    this.position.push(...place);
    this.normal.push(...normal);
    return this.position.length / 3 - 1;
  }

  // Add two triangles for each cell of a net of points.
  net(rows, columns, at) {
    const first = this.position.length / 3;
    for (let i = 0; i <= rows; i += 1) for (let j = 0; j <= columns; j += 1) this.point(...at(i / rows, j / columns));
    for (let i = 0; i < rows; i += 1) {
      for (let j = 0; j < columns; j += 1) {
        const a = first + i * (columns + 1) + j, b = a + columns + 1;
        this.index.push(a, b, a + 1, b, b + 1, a + 1);
      }
    }
  }

  flat(corners) {
    const normal = unit(cross(subtract(corners[1], corners[0]), subtract(corners[2], corners[0])));
    const first = this.position.length / 3;
    for (const corner of corners) this.point(corner, normal);
    for (let k = 2; k < corners.length; k += 1) this.index.push(first, first + k - 1, first + k);
  }
}

const SHAPES = {
  arc(surface, [radius, thick, from, to]) {
    // A small or thin arc needs few faces to look round.
    surface.net(Math.ceil((to - from) / (radius > 0.5 ? 0.09 : 0.26)), thick > 0.04 ? 14 : 6, (i, j) => {
      const a = from + (to - from) * i, b = -TURN * j, out = [Math.cos(a), Math.sin(a), 0];
      const normal = add(scale(Math.cos(b), out), [0, 0, Math.sin(b)]);
      return [add(scale(radius, out), scale(thick, normal)), normal];
    });
  },
  rod(surface, [top]) {
    const slope = 1 - top;
    surface.net(1, 28, (i, j) => {
      const a = TURN * (1 - j), r = 1 + (top - 1) * i, out = [Math.cos(a), Math.sin(a)];
      return [[r * out[0], r * out[1], i], unit([out[0], out[1], 0.35 * slope])];
    });
    const ring = (r, z) => Array.from({ length: 28 }, (_, k) => [r * Math.cos(TURN * k / 28), r * Math.sin(TURN * k / 28), z]);
    surface.flat(ring(1, 0).reverse());
    if (top > 0) surface.flat(ring(top, 1));
  },
  ball(surface) {
    surface.net(10, 16, (i, j) => {
      const a = Math.PI * i, b = TURN * j, normal = [Math.sin(a) * Math.cos(b), Math.sin(a) * Math.sin(b), Math.cos(a)];
      return [normal, normal];
    });
  },
  // A box with bevelled edges and corners.
  box(surface, [x, y, z, bevel]) {
    const half = [x / 2, y / 2, z / 2];
    const corner = (signs, k) => signs.map((sign, i) => sign * (half[i] - (i === k ? 0 : bevel)));
    const outward = (corners) => {
      const middle = add(...corners), normal = cross(subtract(corners[1], corners[0]), subtract(corners[2], corners[0]));
      surface.flat(dot(middle, normal) < 0 ? [...corners].reverse() : corners);
    };
    const signs = [-1, 1];
    for (let k = 0; k < 3; k += 1) {
      const [i, j] = [(k + 1) % 3, (k + 2) % 3], put = (a, b, c) => { const s = []; s[k] = a; s[i] = b; s[j] = c; return s; };
      for (const a of signs) {
        outward([[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([b, c]) => corner(put(a, b, c), k)));
        // The edges along k, between the faces of i and of j.
        for (const b of signs) outward([corner(put(-1, a, b), i), corner(put(1, a, b), i), corner(put(1, a, b), j), corner(put(-1, a, b), j)]);
      }
    }
    for (const a of signs) for (const b of signs) for (const c of signs) outward([0, 1, 2].map((k) => corner([a, b, c], k)));
  },
  tube(surface, [radius, ...flat]) {
    const points = [], count = flat.length / 3, sides = 7;
    for (let k = 0; k < count; k += 1) points.push(flat.slice(3 * k, 3 * k + 3));
    let across = null;
    const frames = points.map((_, k) => {
      const along = subtract(points[Math.min(k + 1, count - 1)], points[Math.max(k - 1, 0)]);
      const way = length(along) > 1e-9 ? unit(along) : [0, 0, 1];
      across ??= Math.abs(way[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
      across = unit(subtract(across, scale(dot(across, way), way)));
      return [across, cross(way, across)];
    });
    surface.net(count - 1, sides, (i, j) => {
      const k = Math.round(i * (count - 1)), b = -TURN * j;
      const normal = add(scale(Math.cos(b), frames[k][0]), scale(Math.sin(b), frames[k][1]));
      return [add(points[k], scale(radius, normal)), normal];
    });
  },
  ribbon(surface, flat) {
    const count = flat.length / 6, at = (k, side) => flat.slice(6 * k + 3 * side, 6 * k + 3 * side + 3);
    surface.net(count - 1, 1, (i, j) => {
      const k = Math.round(i * (count - 1)), a = Math.max(0, k - 1), b = Math.min(count - 1, k + 1);
      const normal = cross(subtract(at(b, j), at(a, j)), subtract(at(k, 1), at(k, 0)));
      return [at(k, j), length(normal) > 1e-12 ? unit(normal) : [0, 0, 1]];
    });
  },
};

// The shapes whose points change with every picture.
export const CHANGING = new Set(['tube', 'ribbon']);

export function surfaceOf(shape, of) {
  const surface = new Surface();
  SHAPES[shape](surface, of);
  return { position: new Float32Array(surface.position), normal: new Float32Array(surface.normal), index: new Uint16Array(surface.index) };
}
