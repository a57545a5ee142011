// The pad: units coloured by state, force and slip arrows, the slip centre.
const mark = sb.mark;

// Distance of the nearest neighbours [m]; `alone` for a single unit.
sb.spacingOf = (positions, alone) => {
  const distances = ([x, y], i) => positions.slice(0, i).map(other => Math.hypot(x - other[0], y - other[1]) || Infinity);
  const nearest = d3.min(positions.flatMap(distances));
  return isFinite(nearest) ? nearest : alone;
};

// The largest 1, 2 or 5 times a power of ten that is at most `value`.
function roundDown(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  for (const factor of [5, 2])
    if (factor * power <= value) return factor * power;
  return power;
}

sb.Pad = class {
  // Sets the scale of the pad. Returns the pitch and the positions of its units [px].
  layOut(recording, picture) {
    const {positions} = recording;
    const spacing = sb.spacingOf(positions, 5e-3);
    const extent = axis => {
      const [low, high] = d3.extent(positions, p => p[axis]);
      return high - low;
    };
    const pitch = Math.min(92, 250 / Math.max(1, Math.max(extent(0), extent(1)) / spacing));  // px between neighbours
    this.scale = pitch / spacing;                                                             // px per metre
    this.view = sb.padView(recording.type);
    this.x = p => p[this.view.right] * this.scale;
    this.y = p => -p[this.view.up] * this.scale;
    const xs = positions.map(this.x), ys = positions.map(this.y);
    // The picture is scaled to its card; a pad of one unit gets a wide frame, so that its text is
    // not enlarged.
    const margin = (places, least) => Math.max(30, 0.67 * pitch, 0.5 * (least - (Math.max(...places) - Math.min(...places))));
    const beside = picture ? 18 : 0;  // px, keeps the axes' corner free
    const left = Math.min(...xs) - margin(xs, 300) - beside, right = Math.max(...xs) + margin(xs, 300);
    const top = Math.min(...ys) - margin(ys, 160), bottom = Math.max(...ys) + margin(ys, 160) + beside;
    this.box = {left, right, top, bottom};
    this.labels = recording.units <= 25;
    this.roomy = pitch >= 55;  // px, space for name and force of a unit side by side
    this.radius = (this.labels || (picture && picture.cells.length === recording.units) ? 0.27 : 0.4) * pitch;  // units must not hide their cells
    return {pitch, xs, ys};
  }

  // onPick(unit) is called for a click on a unit.
  constructor(parent, recording, onPick) {
    this.recording = recording;
    const picture = sb.padPicture(recording), {pitch, xs, ys} = this.layOut(recording, picture);
    const {left, right, top, bottom} = this.box;
    const svg = mark('svg', {
      viewBox: [left, top, right - left, bottom - top + 30].join(' '), role: 'img',
      'aria-label': 'The pad at the cursor, ' + this.view.note
    });
    parent.append(svg);
    svg.append(mark('defs', {}, this.arrowHeads(Math.min(8, 0.4 * pitch))), ...this.frame());
    this.picture = picture && new sb.PadPicture(svg, this, pitch);
    const units = d3.range(recording.units);
    this.units = units.map(i => {
      const title = mark('title'), disc = mark('circle', {r: this.radius});
      const ring = mark('circle', {r: 0.84 * this.radius, fill: 'none', stroke: 'var(--ground)', 'stroke-width': 1.5});
      const place = {transform: 'translate(' + xs[i] + ',' + ys[i] + ')', style: 'cursor:pointer', onclick: () => onPick(i)};
      svg.append(mark('g.unit', place, title, disc, ring));
      return {title, disc, ring};
    });
    const arrows = (head, colour, width, dash) => units.map(i => {
      const style = {stroke: colour, 'stroke-width': width, 'stroke-dasharray': dash, 'marker-end': 'url(#head-' + head + ')'};
      const arrow = mark('line', {x1: xs[i], y1: ys[i], ...style});
      svg.append(arrow);
      return arrow;
    });
    this.slips = arrows('slip', 'var(--slip)', Math.min(2, 0.06 * pitch), '4 2.5');
    this.forces = arrows('force', 'var(--ink)', Math.min(2.4, 0.07 * pitch));
    this.centre = mark('g', {fill: 'none', stroke: 'var(--ink)', 'stroke-width': 1.6},
                       mark('circle', {r: 6}), mark('path', {d: 'M-10,0H10M0,-10V10'}));
    svg.append(this.centre);
    for (const i of this.labels ? units : []) {
      const load = mark('tspan.dim', {dx: 5}), name = mark('tspan', {style: 'font-weight:600'}, sb.unitName(recording.type, i));
      const label = mark('text.unit-label', {y: ys[i] - this.radius - 6}, name, load);
      svg.append(label);
      Object.assign(this.units[i], {label, load});
    }
    this.forceLength = 0.5 * pitch / Math.max(1e-12, recording.largest('labels/force', 0, 2));
    const speed = sb.rounded(recording.largest('labels/slip_velocity', 0, 2), 'm/s');
    this.slipLength = speed > 0 ? 0.4 * pitch / speed : 0;
    svg.append(this.key(speed));
    sb.saveCorner(parent, 'Pad', () => svg, () => this.savedRows());
  }

  arrowHeads(size) {
    const box = {
      viewBox: '0 0 10 10', refX: 7, refY: 5, markerWidth: size, markerHeight: size, markerUnits: 'userSpaceOnUse',
      orient: 'auto'
    };
    return [['force', 'var(--ink)'], ['slip', 'var(--slip)']].map(
        ([name, fill]) => mark('marker', {id: 'head-' + name, ...box}, mark('path', {d: 'M0,0.8L10,5L0,9.2z', fill})));
  }

  frame() {
    const {left, right, top, bottom} = this.box;
    const box = {x: left + 1, y: top + 1, width: right - left - 2, height: bottom - top - 2, rx: 10};
    return [
      mark('rect', {...box, fill: 'var(--ground)', stroke: 'var(--line)'}),
      mark('g', {transform: 'translate(' + [left + 12, bottom - 12] + ')'},
           mark('path', {d: 'M0,-18V0H18', fill: 'none', stroke: 'var(--faint)'}),
           sb.text(-3, -22, 'start', 'XY'[this.view.up], 'dim'), sb.text(22, 4, 'start', 'XY'[this.view.right], 'dim'))
    ];
  }

  // Key of the arrows' lengths.
  key(speed) {
    const {left, bottom} = this.box;
    const entry = (x, scale, largest, unit, colour, dash, name) => {
      const value = roundDown(largest / scale), length = value * scale;
      const style = {stroke: colour, 'stroke-width': 2.2, 'stroke-dasharray': dash, 'marker-end': 'url(#head-' + name + ')'};
      return [mark('line', {x1: x, x2: x + length, ...style}),
              sb.text(x + length + 6, 4, 'start', name + ' ' + sb.quantity(value, unit), 'dim')];
    };
    return mark('g', {transform: 'translate(' + [left + 8, bottom + 18] + ')'},
                entry(0, this.forceLength, 32, 'N', 'var(--ink)', null, 'force'),
                speed > 0 && entry(118, this.slipLength, 26, 'm/s', 'var(--slip)', '4 2.5', 'slip'));
  }

  // The units at the cursor.
  savedRows() {
    const {recording, sample} = this;
    const vector = (key, count, unit) => d3.range(count).map(c => recording.at(key, unit, c, sample));
    return [
      ['t [s]', sb.unitWord(recording.type), 'x [m]', 'y [m]', 'state', 'fx [N]', 'fy [N]', 'fz [N]', 'slip vx [m/s]', 'slip vy [m/s]'],
      ...d3.range(recording.units).map(unit => [
        recording.time[sample], sb.unitName(recording.type, unit), ...recording.positions[unit],
        sb.states.unit[recording.unitStates[unit][sample]].name, ...vector('labels/force', 3, unit), ...vector('labels/slip_velocity', 2, unit)
      ])
    ];
  }

  update(sample) {
    this.sample = sample;
    const {recording} = this;
    this.units.forEach((unit, i) => {
      const {key} = sb.states.unit[recording.unitStates[i][sample]], apart = key === 'detached';
      const force = recording.at('labels/force', i, 2, sample), name = sb.unitName(recording.type, i);
      const look = {
        fill: apart ? 'none' : sb.stateFill(key), 'fill-opacity': {stick: 0.45, slip: 0.85}[key] || 1,
        stroke: 'var(--' + key + ')', 'stroke-width': Math.min(0.08 * this.radius, apart ? 1.2 : 2),
        'stroke-dasharray': {detached: '2 3', partial: '7 3'}[key] || 'none'
      };
      for (const [property, value] of Object.entries(look)) unit.disc.style.setProperty(property, value);
      unit.ring.style.display = key === 'slip' && this.labels ? '' : 'none';
      unit.title.textContent = name + ': ' + key + (apart ? '' : ', ' + sb.quantity(force, 'N'));
      const pull = this.point(this.forces[i], 'labels/force', this.forceLength, i);
      const slip = this.point(this.slips[i], 'labels/slip_velocity', this.slipLength, i);
      if (!this.labels) return;
      unit.load.textContent = apart || !this.roomy ? '' : sb.fixed(force, 2) + ' N';
      // Each label is above its unit, next to an arrow that points up there. Arrows are too short
      // to
      // reach a neighbour's label.
      const upward = [pull, slip].find(([up]) => up > 0.5 * this.radius);
      const side = upward ? (upward[1] >= 0 ? -1 : 1) : 0;
      unit.label.setAttribute('x', this.x(recording.positions[i]) + 4 * side);
      unit.label.setAttribute('text-anchor', ['end', 'middle', 'start'][side + 1]);
    });
    if (this.picture) this.picture.update(recording.time[sample]);
    const centre = [0, 1].map(c => recording.at('labels/slip_centre', 0, c, sample));
    const [x, y] = [this.x(centre), this.y(centre)];
    const inside = x > this.box.left && x < this.box.right && y > this.box.top && y < this.box.bottom;
    this.centre.style.display = inside ? '' : 'none';
    if (inside) this.centre.setAttribute('transform', 'translate(' + x + ',' + y + ')');
  }

  // Draws the arrow of a unit. Returns its components up and right [px].
  point(arrow, curve, length, i) {
    const [up, right] = [this.view.up, this.view.right].map(c => (this.recording.at(curve, i, c, this.sample) || 0) * length);
    arrow.setAttribute('x2', this.x(this.recording.positions[i]) + right);
    arrow.setAttribute('y2', this.y(this.recording.positions[i]) - up);
    arrow.style.display = Math.hypot(up, right) > 1.5 ? '' : 'none';
    return [up, right];
  }
};

// The hatching of partial slip, once per page.
sb.drawHatch = () => {
  const stripes = [[6, 0.5], [2.6, 1]].map(
      ([width, opacity]) => mark('rect', {width, height: 6, fill: 'var(--partial)', 'fill-opacity': opacity}));
  const attributes = {id: 'hatch', width: 6, height: 6, patternUnits: 'userSpaceOnUse', patternTransform: 'rotate(45)'};
  const hidden = {'aria-hidden': 'true', width: 0, height: 0, style: 'position:absolute'};
  document.body.append(mark('svg', hidden, mark('defs', {}, mark('pattern', attributes, stripes))));
};
