// Written by `python -m orientation_figures.moving.javascript` from words.py.
import { AXES, IDENTITY, add, cross, dot, enumerate, length, range, scale, subtract, unit, zip } from './mathematics.js';
export const BARB = [[0, 0], [-13, 4.6], [-7.5, 0], [-13, -4.6]];
export const TRIANGLE = [[0, 0], [-14, 5.6], [-14, 0], [-14, -5.6]];
export const DIAMOND = [[0, 0], [-8, 5.4], [-16, 0], [-8, -5.4]];
export const HEADS = { A: TRIANGLE, B: TRIANGLE, C: DIAMOND, D: TRIANGLE, E: TRIANGLE, F: DIAMOND, Z: TRIANGLE };
export const ROUND = 0.5523;
export const STEEP = 1.6;

export function hatted(letter) {
  return AXES.map((axis) => `$\\hat{${letter}}_${axis}$`);
}

export function turned(axis, angle, vector) {
  const normal = unit(axis);
  const along = scale(dot(normal, vector), normal), beside = cross(normal, vector);
  const rest = subtract(vector, along);
  return add(along, scale(Math.cos(angle), rest), scale(Math.sin(angle), beside));
}

export function layers(kind) {
  return kind.startsWith('tube') ? [kind, `${kind} core`] : [kind];
}

export function halfRound(u, v) {
  return [u, add(u, scale(ROUND, v)), add(scale(ROUND, u), v), v, subtract(v, scale(ROUND, u)), subtract(scale(ROUND, v), u), scale(-1, u)];
}

export class Words {
  depthOf(points) {
    return dot(this.view[2], add(...points)) / points.length;
  }
  line(points, colour = 'ink', kind = '') {
    const places = points.map((point) => this.onSheet(point)), depth = this.depthOf(points);
    for (const [k, layer] of enumerate(layers(kind))) {
      this.path(`M${'L'.repeat(points.length - 1)}`, places, `${layer} ${colour}`, depth + 1e-6 * k);
    }
  }
  area(points, colour = 'ink', fill = 16, edge = true) {
    const places = points.map((point) => this.onSheet(point));
    const kind = `fill-${fill} ${edge ? '' : 'bare '}${colour}`;
    return this.path(`M${'L'.repeat(points.length - 1)}Z`, places, kind, this.depthOf(points));
  }
  ellipse(middle, u, v, kind, depth = 0) {
    const points = [...halfRound(u, v), ...halfRound(scale(-1, u), scale(-1, v)).slice(1)];
    return this.path('MCCCCZ', points.map((point) => add(middle, point)), kind, depth);
  }
  dot(point, colour = 'ink', radius = 4) {
    const depth = this.depthOf([point]);
    return this.ellipse(this.onSheet(point), [radius, 0], [0, radius], `head ${colour}`, depth);
  }
  dots(points, colour = 'ink') {
    const pairs = points.flatMap((point) => [0, 1].map((end) => this.onSheet(point)));
    return this.path('ML'.repeat(points.length), pairs, `thick ${colour}`, this.depthOf(points));
  }
  ring(point, colour = 'ink', radius = 5) {
    const depth = this.depthOf([point]) + 1e-6;
    const place = this.onSheet(point);
    return this.ellipse(place, [radius, 0], [0, radius], `paper ${colour}`, depth);
  }
  label(point, text, colour = 'ink', shift = [0, 0], size = 20) {
    return this.text(text, add(this.onSheet(point), shift), colour, size);
  }
  labelBeyond(point, text, colour = 'ink', pixels = 17) {
    return this.label(point, text, colour, scale(pixels, unit(this.onSheet(point))));
  }
  shadow(vector, direction, colour = 'accent') {
    const along = unit(direction);
    const foot = scale(dot(vector, along), along);
    const down = subtract(foot, vector);
    this.line([[0, 0, 0], foot], colour, 'shadow');
    if (length(down) > 0.02) {
      this.line([vector, foot], colour, 'guide');
      if (length(foot) > 0.1) {
        this.rightAngle(scale(-1, foot), scale(-1, down), { origin: foot, size: 0.07 });
      }
    }
  }
  arrow(end, { start = [0, 0, 0], colour = 'ink', label = '', shift = null, size = 20, kind = '' } = {}) {
    let outward;
    const reach = subtract(end, start), depth = this.depthOf([start, end]);
    const tail = this.onSheet(start), tip = this.onSheet(end);
    const across = subtract(tip, tail);
    const pixels = length(across), along = unit(across);
    outward = scale(17, along);
    if (pixels < 0.05 * this.size * length(reach)) {
      this.ellipse(tip, [9, 0], [0, 9], `paper ${colour}`, depth);
      if (dot(this.view[2], reach) > 0) {
        this.ellipse(tip, [3, 0], [0, 3], `head ${colour}`, depth + 1e-6);
      } else {
        const strokes = [[-6.4, -6.4], [6.4, 6.4], [-6.4, 6.4], [6.4, -6.4]];
        this.path('MLML', strokes.map((point) => add(tip, point)), colour, depth + 1e-6);
      }
      outward = [15, 15];
    } else {
      const part = Math.min(1, pixels / 28);
      const line = [tail, subtract(tip, scale(10 * part, along))];
      this.path('ML', line, `axis ${colour} ${kind}`, depth);
      this.head(tip, along, part, colour, depth + 1e-6);
    }
    if (label) {
      this.text(label, add(tip, shift === null ? outward : shift), colour, size);
    }
  }
  head(tip, along, size, colour, depth = 0) {
    const [right, down] = along;
    const corners = (HEADS[colour] ?? BARB).map(([x, y]) => add(tip, scale(size, [x * right - y * down, x * down + y * right])));
    return this.path('MLLLZ', corners, `head ${colour}`, depth);
  }
  triad(letter, dcm, { origin = [0, 0, 0], length = 1, labels = null, shifts = [null, null, null] } = {}) {
    const texts = labels === null ? hatted(letter.toLowerCase()) : labels;
    for (const [row, label, shift] of zip(dcm, texts, shifts)) {
      if (label !== null) {
        const end = add(origin, scale(length, row));
        this.arrow(end, { start: origin, colour: letter, label, shift });
      }
    }
  }
  turn(axis, angle, start, { radius = 0.5, label = '', origin = [0, 0, 0], colour = 'ink', shift = [0, 0], kind = '', head = true } = {}) {
    const normal = unit(axis), arm = scale(radius, unit(start));
    const swept = Math.abs(angle) * radius * this.size, pieces = Math.max(4, Math.ceil(Math.abs(angle) / STEEP));
    const size = head ? Math.min(0.8, swept / 28) : 0;
    const last = 1 - (swept ? 9 * size / swept : 0);
    const reach = 4 / 3 * Math.tan(last * angle / pieces / 4);
    const at = (part) => turned(normal, part * angle, arm);
    const place = (point) => this.onSheet(add(origin, point));
    const points = [place(arm)];
    for (const k of range(pieces)) {
      const near = at(last * k / pieces), far = at(last * (k + 1) / pieces);
      points.push(place(add(near, scale(reach, cross(normal, near)))));
      points.push(place(subtract(far, scale(reach, cross(normal, far)))));
      points.push(place(far));
    }
    const middle = place(at(0.5)), tip = place(at(1));
    const depth = this.depthOf([add(origin, at(0.5))]);
    for (const [k, layer] of enumerate(layers(kind))) {
      this.path(`M${'C'.repeat(pieces)}`, points, `${layer} ${colour}`, depth + 1e-6 * k);
    }
    if (head) {
      this.head(tip, unit(subtract(tip, place(at(last)))), size, colour, depth + 1e-6);
    }
    if (label) {
      const outward = scale(15, unit(subtract(middle, this.onSheet(origin))));
      const shown = Math.min(1, Math.abs(angle) / 0.2);
      this.text(label, add(middle, outward, shift), colour, 20, shown);
    }
  }
  arc(start, end, { radius = 0.5, label = '', origin = [0, 0, 0], colour = 'ink', shift = [0, 0], kind = '', head = true } = {}) {
    const axis = cross(start, end);
    return this.turn(axis, Math.atan2(length(axis), dot(start, end)), start, { radius, label, origin, colour, shift, kind, head });
  }
  rightAngle(first, second, { origin = [0, 0, 0], size = 0.12, colour = 'muted' } = {}) {
    const u = scale(size, unit(first)), v = scale(size, unit(second));
    return this.line([u, add(u, v), v].map((point) => add(origin, point)), colour);
  }
  circle(normal, { radius = 1, origin = [0, 0, 0], colour = 'muted', kind = 'guide', half = '' } = {}) {
    const axis = unit(normal);
    const sizes = axis.map((entry) => Math.abs(entry));
    const level = cross(axis, this.view[2]), farthestAxis = IDENTITY[sizes.indexOf(Math.min(...sizes))];
    const across = scale(radius, unit(half && length(level) > 1e-6 ? level : cross(axis, farthestAxis)));
    const u = this.onSheet(across), v = this.onSheet(cross(axis, across));
    const middle = this.onSheet(origin), depth = this.depthOf([origin]), look = `${kind} ${colour}`;
    if (!half) {
      return this.ellipse(middle, u, v, look, depth);
    }
    const points = halfRound(u, half === 'front' ? scale(-1, v) : v);
    return this.path('MCC', points.map((point) => add(middle, point)), look, depth);
  }
  box(dcm, size, { origin = [0, 0, 0], colour = 'ink' } = {}) {
    const half = enumerate(dcm).map(([k, row]) => scale(size[k] / 2, row));
    for (const [i, fill] of enumerate([26, 16, 8])) {
      const u = half[(i + 1) % 3], v = half[(i + 2) % 3];
      const corners = [add(u, v), subtract(v, u), scale(-1, add(u, v)), subtract(u, v)];
      for (const outward of [half[i], scale(-1, half[i])]) {
        const seen = dot(outward, this.view[2]) > 0 ? 1 : 0;
        const face = corners.map((corner) => add(origin, outward, scale(seen, corner)));
        this.area(face, colour, fill);
      }
    }
  }
  cylinder(start, end, radius, colour = 'ink', fill = 26) {
    const facing = dot(unit(subtract(end, start)), this.view[2]), depth = this.depthOf([start, end]);
    const near = this.onSheet(start), far = this.onSheet(end), pixels = radius * this.size;
    const along = Math.abs(facing) < 0.9999 ? unit(subtract(far, near)) : [1, 0];
    const bulge = scale(pixels * Math.abs(facing), along), side = scale(pixels, [-along[1], along[0]]);
    const front = halfRound(side, bulge).map((point) => add(far, point));
    const back = halfRound(scale(-1, side), scale(-1, bulge)).map((point) => add(near, point));
    this.path('MCCLCCZ', [...front, ...back], `fill-${fill} ${colour}`, depth);
    for (const [place, seen] of [[near, facing < 0], [far, facing > 0]]) {
      const shown = seen ? 1 : 0;
      const u = scale(shown, bulge), v = scale(shown, side);
      this.ellipse(place, u, v, `fill-8 ${colour}`, depth + 1e-6);
    }
  }
}
