// Print the answers of three.js and of its readers of glTF and BVH: node answers.mjs PROGRAM < questions.json, in a
// folder whose node_modules contain three. It works like answers.py.
import { readFileSync } from 'node:fs';
import * as three from 'three';
import { BVHLoader } from 'three/examples/jsm/loaders/BVHLoader.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

const { Euler, Matrix3, Matrix4, Quaternion, Vector3 } = three;
const MATRIX = { kind: 'matrix' }, XYZW = { kind: 'quaternion', order: 'xyzw' };
const rows = ({ elements }) => [0, 1, 2].flatMap((row) => [0, 1, 2].map((column) => elements[row + 4 * column]));
const rounded = (value) => Number(value.toFixed(9)) * 180 / Math.PI;

const load = (node) => new Promise((done, failed) => new GLTFLoader().parse(JSON.stringify({ asset: { version: '2.0' }, scene: 0,
  scenes: [{ nodes: [0] }], nodes: [node] }), '', ({ scene }) => { scene.updateMatrixWorld(); done(scene.children[0]); }, failed));
const turnedBy = (quaternion) => rows(new Matrix4().makeRotationFromQuaternion(quaternion));

function moved(channels, angles) {
  const text = `HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition ${channels}\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n`
    + `MOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0 ${angles.join(' ')}\n`;
  return turnedBy(new Quaternion().fromArray(new BVHLoader().parse(text).clip.tracks.find(({ name }) => name.endsWith('quaternion')).values));
}

// Return the matrix that each makes from a line of the card, row by row.
const make = {
  'three.js': async (line) => {
    const made = new Function('three', `const { Euler, Matrix3, Quaternion } = three; return ${line};`)(three);
    if (made.isMatrix3) return [0, 1, 2].flatMap((row) => [0, 1, 2].map((column) => made.elements[row + 3 * column]));
    return turnedBy(made.isEuler ? new Quaternion().setFromEuler(made) : made);
  },
  glTF: async (line) => rows((await load(JSON.parse(`{ ${line} }`))).matrixWorld),
  BVH: async (line) => {
    const [, channels, angles] = /CHANNELS 3 (.*): (.*)/.exec(line);
    return moved(channels, angles.split(' '));
  },
};

const ask = {
  'three.js': async (axis, angle) => {
    const vector = new Vector3(...axis), turned = new Quaternion().setFromAxisAngle(vector, angle);
    return [['new Quaternion().setFromAxisAngle(axis, angle).toArray()', XYZW, turned.toArray()],
      ['new Matrix4().makeRotationAxis(axis, angle), row by row', MATRIX, rows(new Matrix4().makeRotationAxis(vector, angle))],
      ["new Euler().setFromQuaternion(q, 'XYZ')", { kind: 'Euler angles', sequence: 'xyz' }, new Euler().setFromQuaternion(turned, 'XYZ').toArray().slice(0, 3)]];
  },
  // A node's rotation, and what its reader makes of a matrix in the file, which is stored column by column.
  glTF: async (axis, angle) => {
    const vector = new Vector3(...axis), rotation = new Quaternion().setFromAxisAngle(vector, angle).toArray();
    const columns = new Matrix4().makeRotationAxis(vector, angle).elements;
    return [['"rotation": [x, y, z, w], matrixWorld', MATRIX, rows((await load({ rotation })).matrixWorld)],
      ['"matrix": [...], quaternion', XYZW, (await load({ matrix: [...columns] })).quaternion.toArray()]];
  },
  // Three channels in degrees, in the order in which the file names them, and what the reader makes of them.
  BVH: async (axis, angle) => {
    const turned = new Quaternion().setFromAxisAngle(new Vector3(...axis), angle), { x, y, z } = new Euler().setFromQuaternion(turned, 'ZXY');
    const channels = [z, x, y].map(rounded);
    return [['Zrotation Xrotation Yrotation', { kind: 'Euler angles', sequence: 'zxy' }, channels],
      ['the same, read by BVHLoader, as a matrix', MATRIX, moved('Zrotation Xrotation Yrotation', channels)]];
  },
};

const asked = new Map(), made = [], { orientations, lines } = JSON.parse(readFileSync(0, 'utf8'));
for (const line of lines) made.push(await make[process.argv[2]](line));
for (const [axis, angle] of orientations) {
  for (const [line, form, numbers] of await ask[process.argv[2]](axis, angle)) {
    if (!asked.has(line)) asked.set(line, { asked: line, form, numbers: [] });
    asked.get(line).numbers.push([...numbers]);
  }
}
const { version } = JSON.parse(readFileSync(`${process.cwd()}/node_modules/three/package.json`, 'utf8'));
console.log(JSON.stringify({ package: 'three', version, answers: [...asked.values()], made }));
