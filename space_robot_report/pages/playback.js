// Plays a run: shapes of the robot, placed at every time; see scene.py for what is in SCENE.
"use strict";
const SCENE = JSON.parse(document.getElementById("scene").textContent);
const ARRAYS = {f4: Float32Array, f8: Float64Array, u2: Uint16Array, u4: Uint32Array};

function unpack(array) {
  const text = atob(array.bdata);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return new ARRAYS[array.dtype](bytes.buffer);
}

const time = unpack(SCENE.time), poses = unpack(SCENE.poses), ghost = unpack(SCENE.ghost), trail = unpack(SCENE.trail);
const torque = unpack(SCENE.torque), efforts = unpack(SCENE.efforts), axes = unpack(SCENE.axes);
const bodies = SCENE.bodies, joints = axes.length / 3, frames = time.length;
const byId = (id) => document.getElementById(id);

// Vectors and 4 x 4 matrices in the order of WebGL, column by column.
const sub = (a, b) => a.map((x, i) => x - b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (a, s) => a.map((x) => x * s);
const unit = (a) => scaled(a, 1 / (Math.hypot(...a) || 1));

function multiply(a, b) {
  const out = new Float32Array(16);
  for (let c = 0; c < 4; c++)
    for (let r = 0; r < 4; r++)
      for (let k = 0; k < 4; k++) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
  return out;
}

function placement([px, py, pz, x, y, z, w]) {
  return new Float32Array([
    1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0,
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0,
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0, px, py, pz, 1,
  ]);
}

const rotated = (m, v) => [0, 1, 2].map((r) => m[r] * v[0] + m[4 + r] * v[1] + m[8 + r] * v[2]);

function along(origin, vector) {
  // x of the shape lies along the vector, and its length is the scale.
  const size = Math.hypot(...vector), x = unit(vector);
  const y = unit(cross(Math.abs(x[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], x)), z = cross(x, y);
  return new Float32Array([...scaled(x, size), 0, ...scaled(y, size), 0, ...scaled(z, size), 0, ...origin, 1]);
}

function camera(eye, target, aspect, near, far) {
  const z = unit(sub(eye, target)), x = unit(cross([0, 0, 1], z)), y = cross(z, x), f = 1 / Math.tan(0.35);
  const view = new Float32Array([
    x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1]);
  const lens = new Float32Array([
    f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (near + far) / (near - far), -1, 0, 0, (2 * near * far) / (near - far), 0]);
  return multiply(lens, view);
}

function blended(array, width, row, share) {
  const out = Array.from(array.subarray(row * width, (row + 1) * width));
  if (share > 0) for (let i = 0; i < width; i++) out[i] += share * (array[(row + 1) * width + i] - out[i]);
  return out;
}

function pose(array, body, row, share) {
  const a = array.subarray((row * bodies + body) * 7, (row * bodies + body) * 7 + 7);
  if (share <= 0) return placement(a);
  const b = array.subarray(((row + 1) * bodies + body) * 7, ((row + 1) * bodies + body) * 7 + 7);
  // q and -q are one rotation: the short way between them.
  const sign = a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6] < 0 ? -1 : 1;
  const out = Array.from(a, (x, i) => x + share * ((i < 3 ? b[i] : sign * b[i]) - x));
  const norm = Math.hypot(out[3], out[4], out[5], out[6]);
  return placement(out.map((x, i) => (i < 3 ? x : x / norm)));
}

const canvas = byId("view");
const gl = canvas.getContext("webgl2", {alpha: false, antialias: true, preserveDrawingBuffer: true});
if (!gl) {
  byId("stage").outerHTML = '<p class="soft">This browser has no WebGL: the playback cannot be shown.</p>';
  throw new Error("no WebGL 2");
}

const VERTEX = `#version 300 es
in vec3 position; uniform mat4 eye, model; out vec3 world;
void main() { vec4 p = model * vec4(position, 1.0); world = p.xyz; gl_Position = eye * p; gl_PointSize = 3.0; }`;
const FRAGMENT = `#version 300 es
precision highp float; in vec3 world; uniform vec4 color; uniform vec3 viewer; uniform bool lit; out vec4 shown;
void main() {
  float light = 1.0;
  if (lit) {
    vec3 n = normalize(cross(dFdx(world), dFdy(world)));
    n = dot(n, viewer - world) < 0.0 ? -n : n;
    light = 0.45 + 0.45 * max(dot(n, normalize(vec3(0.4, 0.3, 0.85))), 0.0) + 0.2 * max(dot(n, normalize(viewer - world)), 0.0);
  }
  shown = vec4(color.rgb * light, color.a);
}`;

function compile(kind, text) {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, text);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  return shader;
}

const program = gl.createProgram();
gl.attachShader(program, compile(gl.VERTEX_SHADER, VERTEX));
gl.attachShader(program, compile(gl.FRAGMENT_SHADER, FRAGMENT));
gl.linkProgram(program);
gl.useProgram(program);
const at = Object.fromEntries(["eye", "model", "color", "viewer", "lit"].map((n) => [n, gl.getUniformLocation(program, n)]));

function shape(vertices, faces) {
  const vao = gl.createVertexArray();
  gl.bindVertexArray(vao);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, vertices, gl.STATIC_DRAW);
  const place = gl.getAttribLocation(program, "position");
  gl.enableVertexAttribArray(place);
  gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
  if (faces) {
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
  }
  return {vao, count: faces ? faces.length : vertices.length / 3};
}

function arrowShape() {
  const sides = 12, points = [], faces = [];
  for (const [x, radius] of [[0, 0.025], [0.78, 0.025], [0.78, 0.07], [1, 0]])
    for (let i = 0; i < sides; i++) {
      const angle = (2 * Math.PI * i) / sides;
      points.push(x, radius * Math.cos(angle), radius * Math.sin(angle));
    }
  for (let ring = 0; ring < 3; ring++)
    for (let i = 0; i < sides; i++) {
      const a = ring * sides + i, b = ring * sides + ((i + 1) % sides);
      faces.push(a, b, b + sides, a, b + sides, a + sides);
    }
  return shape(new Float32Array(points), new Uint32Array(faces));
}

function gridShape(half, step) {
  const points = [];
  for (let i = -half; i <= half; i += 1) points.push(i * step, -half * step, 0, i * step, half * step, 0, -half * step, i * step, 0, half * step, i * step, 0);
  return shape(new Float32Array(points));
}

const parts = SCENE.parts.map((part) => ({...part, ...shape(unpack(part.vertices), new Uint32Array(unpack(part.faces)))}));
const IDENTITY = placement([0, 0, 0, 0, 0, 0, 1]);

function reach() {
  // How far the robot extends from its base at the start: what the camera has to see.
  let far = 0.1;
  const base = poses.subarray(0, 3);
  for (const part of SCENE.parts) {
    const model = placement(poses.subarray(part.body * 7, part.body * 7 + 7)), vertices = unpack(part.vertices);
    for (let i = 0; i < vertices.length; i += 3) {
      const p = rotated(model, vertices.subarray(i, i + 3));
      far = Math.max(far, Math.hypot(p[0] + model[12] - base[0], p[1] + model[13] - base[1], p[2] + model[14] - base[2]));
    }
  }
  return far;
}

const size = reach(), arrow = arrowShape(), grid = gridShape(10, size / 2), way = shape(trail);
const start = Array.from(poses.subarray(0, 3));
const eye = {azimuth: -0.9, height: 0.45, distance: 3.0 * size};

function paint(item, model, color, mode = gl.TRIANGLES, lit = true) {
  gl.bindVertexArray(item.vao);
  gl.uniformMatrix4fv(at.model, false, model);
  gl.uniform4fv(at.color, color);
  gl.uniform1i(at.lit, lit);
  if (mode === gl.TRIANGLES) gl.drawElements(mode, item.count, gl.UNSIGNED_INT, 0);
  else gl.drawArrays(mode, 0, item.count);
}

function paintArrows(row, share) {
  const base = pose(poses, 0, row, share), origin = [base[12], base[13], base[14]];
  if (byId("show-axes").checked)
    for (const [axis, color] of [[0, [0.75, 0.22, 0.17, 1]], [1, [0.18, 0.55, 0.34, 1]], [2, [0.17, 0.37, 0.72, 1]]])
      paint(arrow, along(origin, scaled(Array.from(base.subarray(4 * axis, 4 * axis + 3)), 0.75 * size)), color);
  if (!byId("show-torque").checked) return;
  const orange = [0.84, 0.37, 0.0, 1], push = blended(torque, 3, row, 0);
  if (Math.hypot(...push) > 0.02) paint(arrow, along(origin, scaled(rotated(base, push), 1.1 * size)), orange);
  const effort = blended(efforts, joints, row, 0);
  for (let joint = 0; joint < joints; joint++) {
    if (Math.abs(effort[joint]) < 0.02) continue;
    const body = pose(poses, joint + 1, row, share), axis = rotated(body, axes.subarray(3 * joint, 3 * joint + 3));
    paint(arrow, along([body[12], body[13], body[14]], scaled(axis, 0.6 * size * effort[joint])), orange);
  }
}

function render(now) {
  const row = Math.min(rowAt(now), frames - 1), last = row === frames - 1;
  const share = last ? 0 : (now - time[row]) / (time[row + 1] - time[row]);
  const width = canvas.clientWidth * devicePixelRatio, height = canvas.clientHeight * devicePixelRatio;
  if (canvas.width !== Math.round(width) || canvas.height !== Math.round(height)) {
    canvas.width = Math.round(width);
    canvas.height = Math.round(height);
  }
  gl.viewport(0, 0, canvas.width, canvas.height);
  gl.clearColor(0.93, 0.945, 0.957, 1);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);
  gl.disable(gl.BLEND);
  const target = byId("follow").checked ? blended(poses, bodies * 7, row, share).slice(0, 3) : start;
  const flat = Math.cos(eye.height) * eye.distance;
  const viewer = [target[0] + flat * Math.cos(eye.azimuth), target[1] + flat * Math.sin(eye.azimuth), target[2] + Math.sin(eye.height) * eye.distance];
  gl.uniformMatrix4fv(at.eye, false, camera(viewer, target, canvas.width / canvas.height, 0.02 * size, 60 * size));
  gl.uniform3fv(at.viewer, viewer);
  paint(grid, placement([start[0], start[1], start[2] - 1.3 * size, 0, 0, 0, 1]), [0.8, 0.83, 0.86, 1], gl.LINES, false);
  for (const part of parts) paint(part, pose(poses, part.body, row, share), part.color);
  paintArrows(row, share);
  if (byId("show-trail").checked)
    for (const mode of [gl.LINE_STRIP, gl.POINTS]) paint(way, IDENTITY, [0.8, 0.47, 0.65, 1], mode, false);
  if (!byId("show-ghost").checked) return;
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  gl.depthMask(false);
  // Where both are at one place, the robot is seen.
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(2, 2);
  for (const part of parts) paint(part, pose(ghost, part.body, row, share), [0.0, 0.45, 0.7, 0.16]);
  gl.disable(gl.POLYGON_OFFSET_FILL);
  gl.depthMask(true);
}

function rowAt(now) {
  let low = 0, high = frames - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (time[middle] <= now) low = middle;
    else high = middle - 1;
  }
  return low;
}

const slider = byId("slider"), play = byId("play");
const first = time[0], end = time[frames - 1];
let now = first, playing = false, before = 0;
slider.min = first;
slider.max = end;

function show() {
  slider.value = now;
  byId("clock").textContent = `${now.toFixed(2)} s of ${end.toFixed(2)} s`;
  render(now);
  markTime(now);
}

function seek(to) {
  now = Math.min(Math.max(to, first), end);
  show();
}

function go(on) {
  playing = on;
  play.textContent = on ? "Pause" : "Play";
  before = performance.now();
  if (on && now >= end) now = first;
  if (on) requestAnimationFrame(step);
}

function step(stamp) {
  if (!playing) return;
  now = Math.min(now + (Math.max(stamp - before, 0) / 1000) * Number(byId("speed").value), end);
  before = stamp;
  show();
  if (now >= end) go(false);
  else requestAnimationFrame(step);
}

play.addEventListener("click", () => go(!playing));
slider.addEventListener("input", () => seek(Number(slider.value)));
document.addEventListener("seek", (event) => seek(event.detail));
for (const id of ["show-ghost", "show-trail", "show-torque", "show-axes", "follow"]) byId(id).addEventListener("change", show);
canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
canvas.addEventListener("pointermove", (event) => {
  if (!event.buttons) return;
  eye.azimuth -= event.movementX * 0.008;
  eye.height = Math.min(Math.max(eye.height + event.movementY * 0.008, -1.5), 1.5);
  show();
});
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  eye.distance = Math.min(Math.max(eye.distance * Math.exp(event.deltaY * 0.001), 0.5 * size), 40 * size);
  show();
}, {passive: false});
new ResizeObserver(show).observe(canvas);
show();
