import { AXES, cross, dcmFromQuaternion, degrees, dot, IDENTITY, multiply, multiplyQuaternions,
  quaternionFromAxisAngle, quaternionFromDcm, radians, scale, slerp, subtract, unit } from './mathematics.js';
import { APART, picture, SIZE } from './hands_picture.js';
import { button, change, element, follow, glide, group, liveText, numberTable, onceAFrame, open, plain, put,
  readout, Sheet, stage } from './shared.js';
import { hatted } from './words_picture.js';

const STEP = 15;
const [N, M] = ['n', 'm'].map(hatted);

// A triad, and its mirror image or a copy, which the reader rotates.
export function render({ model, el }) {
  let stop = () => {};
  const now = () => model.get('quaternion');
  const turnTo = (quaternion) => change(model, { quaternion: unit(quaternion) });
  // Rotate about an axis fixed in N, after all previous rotations.
  const turnBy = (axis, angle, from = now()) => turnTo(multiplyQuaternions(quaternionFromAxisAngle(axis, angle), from));
  const place = () => scale(model.get('together') ? 0 : APART, sheet.view[0]);

  const sheet = new Sheet({ bounds: [-190, -120, 190, 120], size: SIZE, changed: () => redraw(),
    name: 'The triad of N, and its image.',
    grab(part, at) {
      if (!part) return null;
      stop();
      const from = now();
      // Like a ball under the finger, it rotates about the axis of the screen perpendicular to the movement.
      return (to) => {
        const [right, down] = subtract(to, at), far = Math.hypot(right, down);
        if (far < 1) { turnTo(from); return; }
        const axis = [0, 1, 2].map((k) => (down * sheet.view[0][k] + right * sheet.view[1][k]) / far);
        turnBy(axis, radians(Math.round(0.9 * far)), from);
      };
    } });
  const redraw = onceAFrame(draw);

  const images = [['mirror', 'Mirror image'], ['copy', 'Copy']].map(([name, text]) => button(text, () => { stop(); change(model, { image: name }); }));
  const over = button('Lay it over $N$', () => change(model, { together: !model.get('together') }));
  const turns = AXES.map((axis, k) => group(`Turn about n ${axis}`, 'row-of-controls',
    ...[-STEP, STEP].map((step) => button(`${step < 0 ? '\u2212' : '+'}${STEP}°`, () => { stop(); turnBy(IDENTITY[k], radians(step)); },
      { 'aria-label': `turn by ${step} degrees about n ${axis}` })), element('span', {}, `about ${N[k]}`)));
  const fits = [[0, 1], [1, 2], [2, 0]].map(([i, j]) => button(`Fit ${AXES[i]} and ${AXES[j]}`, () => {
    stop();
    const signs = model.get('image') === 'mirror' ? AXES.map((_, k) => (k === 3 - i - j ? -1 : 1)) : [1, 1, 1];
    const goal = quaternionFromDcm(multiply(rowsOf(model.get('image'), IDENTITY), signs.map((sign, k) => scale(sign, IDENTITY[k]))));
    const from = now(), near = dot(from, goal) < 0 ? scale(-1, goal) : goal;
    stop = glide((part) => turnTo(slerp(from, near, part)), 1.2);
  }));
  const table = numberTable({ name: 'Angles between the arrows of the same name', columns: AXES.map((_, k) => M[k]), names: [AXES.map(
    (axis) => `angle between m ${axis} and n ${axis}`)], light: () => {} });
  const hand = element('span', { class: 'value' });
  const text = liveText();
  open(el, stage(sheet, text),
    element('div', { class: 'controls' }, group('What is turned', 'row-of-controls', ...images, over), ...turns, group('Let two arrows fit', 'row-of-controls', ...fits)),
    element('div', { class: 'readouts' }, readout(['Angle between arrows of the same name'], table.element),
      readout(['First × second · third'], hand)));

  function draw() {
    const image = model.get('image'), together = model.get('together');
    const rows = rowsOf(image, dcmFromQuaternion(now()));
    images.forEach((one, k) => put(one, 'aria-pressed', String((k === 0) === (image === 'mirror'))));
    put(over, 'aria-pressed', String(together));
    const angles = rows.map((row, k) => degrees(Math.atan2(Math.hypot(...cross(row, IDENTITY[k])), dot(row, IDENTITY[k]))));
    table.show([angles.map((angle) => `${plain(angle, 0)}°`)]);
    const triple = dot(cross(rows[0], rows[1]), rows[2]);
    hand.textContent = `of N: +1, of the image: ${triple > 0 ? '+1' : '\u22121'}`;
    sheet.draw(() => {
      picture(sheet, rows, together);
      sheet.grip(place(), 'image', 80);
    });
    text.say(sentence(image, angles));
  }

  draw();
  return follow(model, ['image', 'quaternion', 'together'], redraw);
}

// Return the unit vectors of the image; in a mirror image the second one is reversed.
const rowsOf = (image, dcm) => dcm.map((row, k) => (image === 'mirror' && k === 1 ? scale(-1, row) : row));

function sentence(image, angles) {
  const fit = angles.map((angle) => angle < 3), count = fit.filter(Boolean).length;
  if (count === 3) return 'All three arrows fit: the copy is $N$ again. Every right-handed triad can be turned onto every other.';
  if (count === 2) {
    const k = fit.indexOf(false);
    return `Two arrows fit, and ${M[k]} points the wrong way, ${plain(angles[k], 0)}° from ${N[k]}. It is the same whichever two you choose.`;
  }
  return image === 'mirror' ? 'Turn the mirror image until its arrows lie along those of $N$. How many of them can fit at once?'
    : 'The copy has been turned, not mirrored. Can you turn all three arrows back onto $N$?';
}
