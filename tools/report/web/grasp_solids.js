// Convex solids in perspective as SVG, far ones first. A few dozen solids need neither a library
// nor a graphics card, can be printed, and use the page's colours.

// Vectors and quaternions (w, x, y, z) are plain arrays.
const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const unit = a => scaled(a, 1 / (Math.hypot(...a) || 1));

function turned([w, x, y, z], v) {
  const t = scaled(cross([x, y, z], v), 2);
  const c = cross([x, y, z], t);
  return [v[0] + w * t[0] + c[0], v[1] + w * t[1] + c[1], v[2] + w * t[2] + c[2]];
}
const product = ([w, x, y, z], [p, q, r, s]) => [
  w * p - x * q - y * r - z * s, w * q + x * p + y * s - z * r, w * r - x * s + y * p + z * q, w * s + x * r - y * q + z * p
];
// A pose is {position, turn}.
function placed(pose, point) {
  const p = turned(pose.turn, point);
  return [p[0] + pose.position[0], p[1] + pose.position[1], p[2] + pose.position[2]];
}
const inFrame = (pose, point) => {
  const [w, x, y, z] = pose.turn;
  return turned([w, -x, -y, -z], subtract(point, pose.position));
};

// The block between two corners.
function block(low, high) {
  const points = [];
  for (let i = 0; i < 8; ++i) points.push([0, 1, 2].map(k => (i >> k & 1 ? high : low)[k]));
  return {points, faces: [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]};
}
// A round bar along z.
function bar(x, y, radius, from, to) {
  const sides = 10, points = [];
  for (const z of [from, to]) {
    for (let i = 0; i < sides; ++i) {
      const angle = 2 * Math.PI * i / sides;
      points.push([x + radius * Math.cos(angle), y + radius * Math.sin(angle), z]);
    }
  }
  const ring = d3.range(sides);
  const faces = ring.map(i => [i, (i + 1) % sides, sides + (i + 1) % sides, sides + i]);
  return {points, faces: [ring.slice().reverse(), ring.map(i => sides + i), ...faces]};
}

// A solid in the world, ready to be sorted and drawn. `look`: {colour: name, alpha, dash of its
// edges, fine: edges dark in both themes}.
function solid(shape, pose, look) {
  const points = shape.points.map(point => placed(pose, point));
  const faces = shape.faces.map(corners => {
    const [a, b, c] = corners.map(i => points[i]);
    const normal = unit(cross(subtract(b, a), subtract(c, a)));
    return {corners: corners.map(i => points[i]), normal, offset: dot(normal, a)};
  });
  const centre = scaled(points.reduce((sum, p) => [sum[0] + p[0], sum[1] + p[1], sum[2] + p[2]]), 1 / points.length);
  return {points, faces, centre, look};
}

const touching = 4e-4;  // m: solids that overlap by less count as separate
// 1: `a` may hide `b`; -1: `b` may hide `a`; 0: no face separates them.
function hides(a, b, eye) {
  const behind = (p, q) => {
    for (const {normal, offset} of p.faces) {
      if (q.points.every(point => dot(normal, point) > offset - touching)) return dot(normal, eye) > offset ? -1 : 1;
    }
    return 0;
  };
  return behind(a, b) || -behind(b, a);
}

// Far solids first: a solid is drawn when no remaining one must precede it.
function drawingOrder(solids, eye) {
  const near = solid => Math.hypot(...subtract(solid.centre, eye));
  const left = solids.slice().sort((a, b) => near(b) - near(a));
  const order = [];
  while (left.length) {
    const free = left.findIndex(a => left.every(b => b === a || hides(a, b, eye) <= 0));
    order.push(...left.splice(Math.max(0, free), 1));
  }
  return order;
}

class Camera {
  constructor() {
    this.reset();
  }
  // Seen from the sensor's side, at a small angle.
  reset() {
    this.azimuth = -2.25;
    this.elevation = 0.32;
  }
  orbit(dx, dy) {
    this.azimuth -= dx;
    this.elevation = Math.min(1.45, Math.max(0.03, this.elevation + dy));
  }
  // A view of `radius` [m] around `target`.
  look(width, height, target, radius) {
    const {azimuth, elevation} = this;
    const back = [Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation)];
    const right = [-Math.sin(azimuth), Math.cos(azimuth), 0];
    const up = cross(back, right);
    const distance = 5 * radius;
    this.eye = [0, 1, 2].map(k => target[k] + distance * back[k]);
    const focal = distance * 0.5 * Math.min(width, height) / radius;
    this.project = point => {
      const v = subtract(point, this.eye);
      const depth = -dot(v, back);
      return [0.5 * width + focal * dot(v, right) / depth, 0.5 * height - focal * dot(v, up) / depth];
    };
  }
  // A view that just contains `points`.
  fit(width, height, points) {
    let radius = 0.2, target = [0, 0, d3.mean(points, point => point[2])];
    for (let pass = 0; pass < 4; ++pass) {
      this.look(width, height, target, radius);
      const seen = points.map(this.project);
      const [left, right] = d3.extent(seen, p => p[0]), [top, bottom] = d3.extent(seen, p => p[1]);
      // Vertical centring suffices: horizontally the scene is around the vertical axis.
      const metres = 2 * radius / Math.min(width, height);
      target = [0, 0, target[2] - (0.5 * (top + bottom) - 0.5 * height) * metres / Math.cos(this.elevation)];
      radius *= 1.04 * Math.max((right - left) / width, (bottom - top) / height);
    }
    this.look(width, height, target, radius);
  }
}

const sun = unit([-0.45, -0.6, 0.85]);
const outline = points => 'M' + points.map(([x, y]) => x.toFixed(1) + ',' + y.toFixed(1)).join('L');

// The visible faces of a solid, lit by the sun: its colour, covered with some black or white.
function facesOf({faces, look: {colour, alpha, dash, fine}}, camera) {
  const edge = fine ? {stroke: '#000', 'stroke-opacity': 0.3} : {stroke: 'var(--ink)', 'stroke-opacity': dash ? 0.9 : 0.45};
  const line = {...edge, 'stroke-width': dash ? 1.6 : 0.8, 'stroke-dasharray': dash, 'stroke-linejoin': 'round'};
  return faces.filter(({normal, offset}) => dot(normal, camera.eye) > offset).map(({corners, normal}) => {
    const d = outline(corners.map(camera.project)) + 'Z', light = 0.36 * Math.max(0, dot(normal, sun)) - 0.28;
    const shade = {fill: light < 0 ? '#000' : '#fff', 'fill-opacity': Math.abs(light) * alpha};
    const ground = {fill: 'var(--' + colour + ')', 'fill-opacity': alpha};
    return [sb.mark('path', {d, ...ground}), sb.mark('path', {d, ...shade, ...line})];
  });
}

sb.space = {subtract, product, placed, inFrame, block, bar, solid, drawingOrder, facesOf, outline, Camera};
