// Paints a scene with WebGL, in hardware or in software.
import { Camera, Geometry, Mesh, Program, Renderer, Transform } from 'ogl';
import { DISTANCE, GROUND, LIGHT, RIM } from './scene.js';
import { add, scale } from '../../moving/js/mathematics.js';
import { CHANGING, surfaceOf } from './shapes.js';

const VERTEX = `
  attribute vec3 position, normal;
  uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
  varying vec3 at, facing;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    // The columns are the axes, each with its length: to divide by the squares is what normals need.
    vec3 size = vec3(dot(modelMatrix[0].xyz, modelMatrix[0].xyz), dot(modelMatrix[1].xyz, modelMatrix[1].xyz), dot(modelMatrix[2].xyz, modelMatrix[2].xyz));
    facing = mat3(modelMatrix) * (normal / size);
    at = world.xyz;
    gl_Position = projectionMatrix * viewMatrix * world;
  }`;
const FRAGMENT = `
  precision highp float;
  uniform vec3 colour, eye, light;
  uniform float alpha, plain, gloss;
  varying vec3 at, facing;
  void main() {
    vec3 n = normalize(facing), toward = normalize(eye - at);
    if (dot(n, toward) < 0.0) n = -n;
    float sun = max(0.0, dot(n, light)), sky = 0.5 + 0.5 * n.z;
    vec3 seen = colour * mix(0.36 + 0.26 * sky + 0.56 * sun, 1.0, plain);
    float shine = pow(max(0.0, dot(n, normalize(light + toward))), 42.0);
    float rim = pow(1.0 - max(0.0, dot(n, toward)), 3.0);
    seen += (gloss * 0.5 * shine + 0.10 * rim * (1.0 - plain)) * (1.0 - plain);
    gl_FragColor = vec4(seen, 1.0) * alpha;
  }`;
const SHADOW = VERTEX.replace('at = world.xyz;', `world.xyz -= light * (world.z - ${(GROUND + 0.008).toFixed(3)}) / light.z; at = world.xyz;`)
  .replace('uniform mat4', 'uniform vec3 light; uniform mat4');
const SHADE = `
  precision highp float;
  uniform vec3 colour;
  varying vec3 at;
  void main() { if (dot(at.xy, at.xy) > ${(RIM * RIM).toFixed(3)}) discard; gl_FragColor = vec4(colour, 1.0); }`;
// How flatly each colour is shaded, because lighting would make thin lines invisible.
const PLAIN = { accent: 0.5, muted: 0.8, ink: 0.7, ground: 0.72, star: 0.75, paper: 0.9, lamp: 0.5 };
const GLOSS = { graphite: 0.7, metal: 1, glass: 1.4, D: 0.55, B: 0.55, C: 0.55, A: 0.4 };

const parsed = (text) => {
  const [, digits] = /^#([0-9a-f]{3,6})$/i.exec(text.trim()) ?? [, '888888'];
  const six = digits.length === 3 ? [...digits].map((digit) => digit + digit).join('') : digits;
  return [0, 2, 4].map((k) => parseInt(six.slice(k, k + 2), 16) / 255);
};

export class Painter {
  // Throws if the browser has no WebGL.
  constructor(canvas) {
    const wanted = { alpha: true, antialias: true, premultipliedAlpha: true };
    const gl = canvas.getContext('webgl2', wanted) ?? canvas.getContext('webgl', wanted);
    if (!gl) throw new Error('WebGL');
    this.canvas = canvas;
    // Software rendering is slow, so use one pixel for each pixel of the page.
    const told = gl.getExtension('WEBGL_debug_renderer_info');
    const soft = /swiftshader|llvmpipe|software|basic render/i.test(gl.getParameter(told?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER));
    this.finest = soft ? 1 : Math.min(2, globalThis.devicePixelRatio || 1);
    this.renderer = new Renderer({ canvas, ...wanted, dpr: this.finest });   // in the same context
    gl.clearColor(0, 0, 0, 0);
    this.camera = new Camera(gl, { near: 3, far: 16 });
    this.camera.matrixAutoUpdate = false;
    this.root = new Transform();
    const uniforms = () => ({ colour: { value: [0, 0, 0] }, eye: { value: [0, 0, 0] }, light: { value: LIGHT }, alpha: { value: 1 }, plain: { value: 0 }, gloss: { value: 0 } });
    const make = (more) => new Program(gl, { vertex: VERTEX, fragment: FRAGMENT, uniforms: uniforms(), cullFace: false, ...more });
    this.programs = { solid: make({}), ghost: make({ transparent: true }), pane: make({ transparent: true, depthWrite: false }),
      shadow: new Program(gl, { vertex: SHADOW, fragment: SHADE, uniforms: uniforms(), cullFace: false }) };
    for (const program of [this.programs.ghost, this.programs.pane]) program.setBlendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    this.surfaces = new Map();   // one for each shape that keeps its form
    this.meshes = new Map();
  }

  // Colours come from the page, and change with its theme.
  recolour(style) {
    this.colours = new Proxy({}, { get: (known, name) => { known[name] ??= parsed(style.getPropertyValue(`--${name}`)); return known[name]; } });
  }

  resize(wide, high, fine = this.finest) {
    this.wide = wide;
    this.high = high;
    this.renderer.dpr = fine;
    this.renderer.setSize(wide, high);
  }

  geometry(shape, of) {
    const { position, normal, index } = surfaceOf(shape, of);
    return new Geometry(this.renderer.gl, { position: { size: 3, data: position }, normal: { size: 3, data: normal }, index: { data: index } });
  }

  // Return a mesh that is not used in this picture yet, with the surface of the item.
  mesh(item, kind) {
    const changing = CHANGING.has(item.shape);
    // Changing shapes are distinguished by their number of points, so that new ones can reuse the old buffers.
    const name = changing ? `${kind} ${item.shape} ${item.of.length}` : `${kind} ${item.shape} ${item.of}`;
    if (!this.meshes.has(name)) this.meshes.set(name, { list: [], used: 0 });
    const pool = this.meshes.get(name);
    let mesh = pool.list[pool.used];
    if (!mesh) {
      const key = `${item.shape} ${item.of}`;
      if (!changing && !this.surfaces.has(key)) this.surfaces.set(key, this.geometry(item.shape, item.of));
      mesh = new Mesh(this.renderer.gl, { geometry: changing ? this.geometry(item.shape, item.of) : this.surfaces.get(key),
        program: this.programs[kind], frustumCulled: false });
      mesh.matrixAutoUpdate = false;
      mesh.made = item.of;
      mesh.onBeforeRender(() => {
        const { uniforms } = mesh.program;
        uniforms.colour.value = mesh.colour;
        uniforms.alpha.value = mesh.alpha;
        uniforms.plain.value = mesh.plain;
        uniforms.gloss.value = mesh.gloss;
        uniforms.eye.value = this.eye;
      });
      mesh.setParent(this.root);
      pool.list.push(mesh);
    } else if (changing && mesh.made.some((entry, k) => entry !== item.of[k])) {
      const fresh = surfaceOf(item.shape, item.of);
      for (const which of ['position', 'normal']) {
        mesh.geometry.attributes[which].data = fresh[which];
        mesh.geometry.attributes[which].needsUpdate = true;
      }
      mesh.made = item.of;
    }
    pool.used += 1;
    return mesh;
  }

  paint({ items, view, target, half }) {
    const [right, up, toward] = view, { wide, high } = this;
    this.eye = add(target, scale(DISTANCE, toward));
    this.camera.perspective({ fov: 2 * Math.atan(half * Math.max(1, high / wide) / DISTANCE) * 180 / Math.PI, aspect: wide / high });
    this.camera.matrix.set(...right, 0, ...up, 0, ...toward, 0, ...this.eye, 1);
    this.camera.worldMatrixNeedsUpdate = true;
    for (const pool of this.meshes.values()) pool.used = 0;
    for (const item of items) {
      const kind = item.alpha > 0.97 ? 'solid' : item.shape === 'ribbon' ? 'pane' : 'ghost';
      for (const pass of item.casts ? [kind, 'shadow'] : [kind]) {
        const mesh = this.mesh(item, pass);
        const [u, v, w] = item.rows.map((row, k) => scale(item.size[k], row));
        mesh.matrix.set(...u, 0, ...v, 0, ...w, 0, ...item.origin, 1);
        mesh.worldMatrixNeedsUpdate = true;
        mesh.visible = true;
        mesh.colour = pass === 'shadow' ? this.colours.shade : this.colours[item.colour];
        mesh.alpha = item.alpha;
        mesh.plain = PLAIN[item.colour] ?? 0;
        mesh.gloss = GLOSS[item.colour] ?? 0.2;
      }
    }
    for (const pool of this.meshes.values()) for (const mesh of pool.list.slice(pool.used)) mesh.visible = false;
    this.renderer.render({ scene: this.root, camera: this.camera });
  }
}
