// 3D view of a grasp's gripper, box and table at the cursor.
const el = sb.element, mark = sb.mark;
const {subtract, product, placed, inFrame, block, bar, solid, drawingOrder, facesOf, outline, Camera} = sb.space;

// Dimensions of the gripper [m] that a dataset does not contain.
const finger = {halfWidth: 0.0135, below: 0.02, above: 0.085, thick: 0.011};
const palm = {from: 0.085, to: 0.112, halfLength: 0.085, halfWidth: 0.03};
const wrist = {radius: 0.026, height: 0.035};
const table = {half: 0.115, thick: 0.006};
const layer = 0.004;  // m, of a silicone pad

// The sensor's units as bars; a slipping or detached unit is drawn in its state's style.
class PadSolids {
  constructor(recording) {
    this.recording = recording;
    const {positions} = recording, pitch = Math.min(0.02, sb.spacingOf(positions, 0.02));
    this.radius = 0.34 * pitch;
    this.length = Math.max(0.005, pitch);
    const edge = axis => d3.extent(positions, p => p[axis]);
    const [left, right] = edge(0), [low, high] = edge(1), rim = 0.75 * pitch;
    this.plate = block([left - rim, low - rim, this.length], [right + rim, high + rim, this.length + 0.003]);
    this.back = this.length + 0.003;
  }

  // `face(pose, x, y)`: height of the box above the pad's plane at that position [m], or 0.
  // `sample`: null: states are not shown.
  solids(pose, face, sample) {
    const looks = {
      detached: {colour: 'detached', alpha: 0.3, fine: true}, stick: {colour: 'stick', alpha: 1, fine: true},
      partial: {colour: 'partial', alpha: 1, dash: '3 2'}, slip: {colour: 'slip', alpha: 1, fine: true}
    };
    const {recording} = this;
    const bars = recording.positions.map(([x, y], i) => {
      const key = sample === null ? 'detached' : sb.states.unit[recording.unitStates[i][sample]].key;
      return solid(bar(x, y, this.radius, Math.min(face(pose, x, y), 0.8 * this.length), this.length), pose, looks[key]);
    });
    return [...bars, solid(this.plate, pose, {colour: 'soft', alpha: 0.12})];
  }
}

class GraspView {
  constructor(parent, grasp, recording, timeline) {
    // The sensor has one of the carrying pads or follows it.
    const own = recording.place, other = grasp.pads.find(name => name !== own);
    Object.assign(
        this, {grasp, recording, timeline, own, other, pad: new PadSolids(recording), camera: new Camera(), close: false});
    this.svg = mark('svg');
    this.node = el('div.space', {}, this.svg);
    parent.append(this.node);
    sb.saveCorner(this.node, 'Grasp', () => this.svg, () => this.savedRows());
    this.handlePointer();
    const first = grasp.poseAt(timeline.full[0]);
    this.boxSize = grasp.bodies.box.size || [0.06, 0.06, 0.1];
    this.tableHeight = first.table.position[2];
    const across = subtract(first.second_pad.position, first[grasp.pads[0]].position);
    const yaw = 0.5 * Math.atan2(across[1], across[0]);
    this.handTurn = [Math.cos(yaw), 0, 0, Math.sin(yaw)];
    this.start = first.arm;
    // The whole view includes the table and the hand at its highest position.
    const top = d3.max(grasp.bodies.arm.position[2]) + palm.to + wrist.height;
    const corners = h => [-1, 1].flatMap(x => [-1, 1].map(y => [x * h, y * h]));
    this.all = [
      ...corners(table.half).map(([x, y]) => [x, y, this.tableHeight]), ...corners(palm.halfLength).map(([x, y]) => [x, y, top])
    ];
    new ResizeObserver(() => this.draw()).observe(this.node);
  }

  // Poses of the bodies at every stored instant.
  savedRows() {
    const bodies = Object.entries(this.grasp.bodies);
    const head = bodies.flatMap(([name]) => [...['x', 'y', 'z'].map(c => name + ' ' + c + ' [m]'), ...['qw', 'qx', 'qy', 'qz'].map(c => name + ' ' + c)]);
    const row = (t, i) => [t, ...bodies.flatMap(([, {position, turn}]) => [...position, ...turn].map(column => column[i]))];
    return [['t [s]', ...head], ...Array.from(this.grasp.poseTime, row)];
  }

  handlePointer() {
    let from = null;
    const {node} = this;
    node.addEventListener('pointerdown', event => {
      if (event.target.closest('button')) return;
      from = [event.clientX, event.clientY];
      node.setPointerCapture(event.pointerId);
    });
    node.addEventListener('pointermove', event => {
      if (!from) return;
      this.camera.orbit(0.008 * (event.clientX - from[0]), 0.008 * (event.clientY - from[1]));
      from = [event.clientX, event.clientY];
      this.draw();
    });
    for (const end of ['pointerup', 'pointercancel']) node.addEventListener(end, () => from = null);
    node.addEventListener('dblclick', () => {
      this.camera.reset();
      this.draw();
    });
  }

  // `close`: the view follows the pads instead of showing the whole scene.
  zoom(close) {
    this.close = close;
    this.draw();
  }

  // Depth of the box in the pad at (x, y) of the pad's frame: along the pad's normal to the first
  // face of the box.
  faceOf(boxPose) {
    const half = this.boxSize.map(s => 0.5 * s);
    return (pose, x, y) => {
      const tip = inFrame(boxPose, placed(pose, [x, y, 0]));
      if (tip.some((c, k) => Math.abs(c) > half[k])) return 0;
      const way = subtract(inFrame(boxPose, placed(pose, [x, y, 1])), tip);
      return Math.min(...way.map((w, k) => w === 0 ? Infinity : (Math.sign(w) * half[k] - tip[k]) / w));
    };
  }

  solids(poses, sample) {
    const {pad, own, other} = this;
    const face = this.faceOf(poses.box);
    const half = this.boxSize.map(s => 0.5 * s);
    const silicone = this.grasp.bodies[other].size;
    const sensorFinger = {colour: 'faint', alpha: 0.13}, body = {colour: 'faint', alpha: 1};
    const arm = poses.arm;
    const hand = {position: arm.position, turn: product(arm.turn, this.handTurn)};
    const fingerFrom = z => block([-finger.halfWidth, -finger.below, z], [finger.halfWidth, finger.above, z + finger.thick]);
    const list = [
      solid(block(half.map(h => -h), half), poses.box, {colour: 'box', alpha: 1}),
      ...pad.solids(poses[own], face, sample),
      solid(fingerFrom(pad.back), poses[own], sensorFinger),
      solid(block([-palm.halfLength, -palm.halfWidth, palm.from], [palm.halfLength, palm.halfWidth, palm.to]), hand, body),
      solid(bar(0, 0, wrist.radius, palm.to, palm.to + wrist.height), hand, body)
    ];
    if (silicone) {
      const [w, h] = silicone;
      list.push(
          solid(block([-0.5 * w, -0.5 * h, 0], [0.5 * w, 0.5 * h, layer]), poses[other], {colour: 'soft', alpha: 1}),
          solid(fingerFrom(layer), poses[other], body));
    } else {
      list.push(...pad.solids(poses[other], face, null), solid(fingerFrom(pad.back), poses[other], body));
    }
    return list;
  }

  table() {
    const {camera, tableHeight: z} = this, {half, thick} = table;
    const slab = solid(
        block([-half, -half, -thick], [half, half, 0]), {position: [0, 0, z], turn: [1, 0, 0, 0]}, {colour: 'line', alpha: 1});
    const line = ends => mark(
        'path', {d: outline(ends.map(camera.project)), stroke: 'var(--faint)', 'stroke-opacity': 0.45, 'stroke-width': 0.7});
    const grid =
        d3.range(-0.1, 0.101, 0.05).flatMap(c => [line([[c, -half, z], [c, half, z]]), line([[-half, c, z], [half, c, z]])]);
    return [facesOf(slab, camera), grid];
  }

  // Vertical shadow, which shows the height above the table.
  shadow(box) {
    const within = c => Math.min(table.half, Math.max(-table.half, c));
    const hull = d3.polygonHull(box.points.map(([x, y]) => [within(x), within(y)]));
    return mark(
        'path', {d: outline(hull.map(([x, y]) => this.camera.project([x, y, this.tableHeight]))), fill: 'rgba(0,0,0,.22)'});
  }

  // Edges of the box at the pose without slip in the arm's frame since the lift began.
  unslipped(poses, box) {
    const {grasp, camera} = this;
    if (this.timeline.cursor < grasp.lift_s) return null;
    const held = grasp.poseAt(grasp.lift_s);
    const back = point => placed(poses.arm, inFrame(held.arm, point));
    const half = this.boxSize.map(s => 0.5 * s);
    const shape = block(half.map(h => -h), half);
    const corners = shape.points.map(point => camera.project(back(placed(held.box, point))));
    const now = box.points.map(camera.project);
    if (corners.every(([x, y], i) => Math.hypot(x - now[i][0], y - now[i][1]) < 2)) return null;
    const d = shape.faces.map(face => outline(face.map(i => corners[i])) + 'Z').join('');
    return mark(
        'path',
        {d, fill: 'none', stroke: 'var(--accent)', 'stroke-opacity': 0.9, 'stroke-width': 1.1, 'stroke-dasharray': '4 3'});
  }

  draw() {
    const {camera, timeline, node: {clientWidth: width, clientHeight: height}} = this;
    if (!width || !height) return;
    const poses = this.grasp.poseAt(timeline.cursor);
    const moved = subtract(poses.arm.position, this.start.position);
    if (this.close)
      camera.look(width, height, [moved[0], moved[1], moved[2] + 0.01], 0.075);
    else
      camera.fit(width, height, this.all);
    const solids = this.solids(poses, this.recording.sampleAt(timeline.cursor));
    const attributes = {
      viewBox: [0, 0, width, height].join(' '), role: 'img',
      'aria-label': 'Gripper, box and table at the cursor; drag to rotate, double-click to reset the view'
    };
    const svg = mark('svg', attributes, this.table(), this.shadow(solids[0]),
                     drawingOrder(solids, camera.eye).map(one => facesOf(one, camera)), this.unslipped(poses, solids[0]));
    this.svg.replaceWith(svg);
    this.svg = svg;
  }
}

sb.GraspView = GraspView;
