// Pressure, traction and stick zone of a pad that is one elastic body, at the cursor, with the
// closed form of a sphere.
const el = sb.element, mark = sb.mark;
const size = 250, gap = 26;  // px, of a map and between maps

// The closed form at normal force N and tangential force T: Hertz, Cattaneo and Mindlin. Lengths in
// m, forces in N, pressures in Pa.
function closedForm({shear_modulus: g, sphere_radius: radius, friction}, normal, tangential) {
  const a = Math.cbrt(3 * normal * radius / (16 * g)), peak = 3 * normal / (2 * Math.PI * a * a);
  const c = a * Math.cbrt(Math.max(0, 1 - tangential / (friction * normal)));
  const dome = (r, edge) => Math.sqrt(Math.max(0, 1 - (r / edge) ** 2));
  return {
    a, c, pressure: r => peak * dome(r, a),
    traction: r => friction * peak * (dome(r, a) - (c > 0 ? c / a * dome(r, c) : 0))
  };
}

const pull = fields => Math.hypot(d3.sum(fields, f => f.x), d3.sum(fields, f => f.y));

// Pressure, traction and stick zone of a recording as maps, and along one row; `skin`: as in
// sb.page.skins.
class SkinFields {
  // `xs`, `ys`: positions of the pad's columns and rows [m].
  constructor(recording, skin, xs, ys) {
    const {right, up} = sb.padView(recording.type);
    Object.assign(this, {recording, skin, xs, ys, right, up, shown: 0});
    this.pitchX = xs[1] - xs[0];
    this.pitchY = ys[1] - ys[0];
    this.scale = size / Math.max(xs.length * this.pitchX, ys.length * this.pitchY);  // px per metre
    this.width = this.pitchX * this.scale;
    this.height = this.pitchY * this.scale;
    const high = ys.length * this.height;
    this.x = x => (x - xs[0]) * this.scale + this.width / 2;
    this.y = y => high - (y - ys[0]) * this.scale - this.height / 2;
    this.maps = [0, 1, 2].map(index => this.map(index));
    const svg = mark('svg', {
      class: 'plot', viewBox: [-2, 0, 3 * size + 2 * gap + 4, high + 24].join(' '), role: 'img',
      'aria-label': 'Pressure, traction and stick zone at the cursor'
    }, this.maps.map(({node}) => node));
    this.profile = el('div');
    this.note = el('p.note');
    const host = el('div', {}, el('div', {}, svg), this.profile);
    this.section = sb.section('Fields of the soft skin', 'At the cursor.', host, this.note);
    sb.saveCorner(host, 'Fields of the soft skin', () => svg, () => this.savedRows());
  }

  // An empty map: cells, the circles of the closed form, and arrows on the traction map.
  map(index) {
    const {recording: {positions}, right, up, width, height} = this;
    const cells = positions.map(p => mark('rect', {
      x: this.x(p[right]) - width / 2, y: this.y(p[up]) - height / 2, width, height, stroke: 'var(--line)', 'stroke-width': 0.4
    }));
    const rings = ['none', '5 3'].map(
        dash => mark('circle', {style: 'fill:none', stroke: 'var(--ink)', 'stroke-width': 1.4, 'stroke-dasharray': dash}));
    const arrows = index === 1 ? positions.map(() => mark('path', {stroke: 'var(--ink)', 'stroke-width': 1})) : [];
    const title = sb.text(0, -6, 'start', '');
    const place = {transform: 'translate(' + index * (size + gap) + ',20)'};
    return {cells, rings, title, arrows, node: mark('g', place, cells, rings, arrows, title)};
  }

  // Per unit [Pa]: along the map's axes, into the pad, and magnitude of the traction.
  fields(sample) {
    const area = this.pitchX * this.pitchY;
    return d3.range(this.recording.units).map(unit => {
      const [x, y, z] =
          [this.right, this.up, 2].map(c => (this.recording.at('labels/force', unit, c, sample) || 0) / area);
      return {x, y, z, size: Math.hypot(x, y)};
    });
  }

  savedRows() {
    const {recording, right, shown} = this;
    return [
      ['x [m]', 'y [m]', 'pressure [Pa]', 'traction x [Pa]', 'traction y [Pa]', 'state'],
      ...this.fields(shown).map((f, unit) => [
        ...recording.positions[unit], f.z, ...right ? [f.y, f.x] : [f.x, f.y],
        sb.states.unit[recording.unitStates[unit][shown]].name
      ])
    ];
  }

  // First sample that is no longer a monotonic first push: the force has fallen by more than a
  // thousandth of the friction limit, or its parts point in several directions.
  firstPush() {
    const {recording, skin} = this;
    let most = 0;
    for (let row = 0; row < recording.time.length; row += recording.stride) {
      const fields = this.fields(row), now = pull(fields), little = 1e-3 * skin.friction * d3.sum(fields, f => f.z);
      if (now < most - little || d3.sum(fields, f => f.size) > 1.01 * now + little) return row;
      most = Math.max(most, now);
    }
    return Infinity;
  }

  // The closed form, if the contact is surrounded by pad, and the contact's middle [m].
  formOf(fields) {
    const {skin, recording: {positions}, xs, ys, right, up, pitchX, pitchY} = this;
    const total = d3.sum(fields, f => f.z), area = pitchX * pitchY;
    const middle = axis => total > 0 ? d3.sum(fields, (f, unit) => f.z * positions[unit][axis]) / total : 0;
    const centre = {x: middle(right), y: middle(up)};
    const whole = skin.sphere_radius && total > 0 ? closedForm(skin, total * area, pull(fields) * area) : null;
    const within = (at, places, pitch) => Math.abs(at - d3.mean(places)) + whole.a <= 0.5 * places.length * pitch;
    const form = whole && within(centre.x, xs, pitchX) && within(centre.y, ys, pitchY) ? whole : null;
    return {centre, form};
  }

  drawMaps(fields, centre, form, first) {
    const {recording: {positions, unitStates}, right, up, width, height, shown} = this;
    const most = key => Math.max(1e-9, d3.max(fields, f => f[key])), largest = most('size'), peak = most('z');
    const kPa = value => sb.significant(value / 1e3, 3) + ' kPa';
    const state = unit => sb.states.unit[unitStates[unit][shown]].key;
    const looks = [
      f => ['var(--stick)', f.z / peak], f => ['var(--slip)', 0.8 * f.size / largest],
      (_, unit) => state(unit) === 'detached' ? ['none', 0] : [sb.stateFill(state(unit)), 0.75]
    ];
    const words = ['pressure, up to ' + kPa(peak), 'traction, up to ' + kPa(largest), 'stick (blue) and slip (red)'];
    this.maps.forEach(({cells, rings, title, arrows}, index) => {
      cells.forEach((cell, unit) => [cell.style.fill, cell.style.fillOpacity] = looks[index](fields[unit], unit));
      rings.forEach((ring, k) => {
        const r = form && (k === 0 || first) ? (k ? form.c : form.a) * this.scale : 0;
        for (const [name, value] of Object.entries({cx: this.x(centre.x), cy: this.y(centre.y), r})) ring.setAttribute(name, value);
      });
      arrows.forEach((arrow, unit) => {
        const place = [this.x(positions[unit][right]), this.y(positions[unit][up])], reach = 0.9 * Math.min(width, height) / largest;
        arrow.setAttribute('d', 'M' + place + 'l' + [fields[unit].x * reach, -fields[unit].y * reach]);
      });
      title.textContent = words[index];
    });
  }

  drawProfile(fields, centre, form, first) {
    const {recording: {positions}, xs, ys, right, up, pitchX, pitchY} = this;
    const box = {width: 3 * size + 2 * gap, height: 230, left: 58, right: 8, top: 8, bottom: 36};
    const half = 0.5 * xs.length * pitchX;
    const top = Math.max(1e-9, d3.max(fields, f => Math.max(f.z, f.size)), form ? form.pressure(0) : 0);
    const across = d3.scaleLinear([-half, half], [box.left, box.width - box.right]);
    const along = d3.scaleLinear([0, 1.05 * top], [box.height - box.bottom, box.top]);
    const row = d3.min(ys, y => Math.abs(y - centre.y));
    const axis = (title, scale, count, factor) => ({title, scale, ticks: scale.ticks(count), text: value => sb.significant(value * factor, 3)});
    const chart = sb.axes(box, axis('distance from the middle of the contact, mm', across, 8, 1e3), axis('kPa', along, 5, 1e-3), {
      class: 'plot', role: 'img', 'aria-label': 'Pressure and traction along the row through the middle'
    });
    const line = (of, colour) => {
      const places = d3.range(201).map(i => (i / 100 - 1) * half), curve = d3.line(across, x => along(of(Math.hypot(x, row))));
      chart.append(mark('path.curve', {d: curve(places), style: 'stroke:var(--' + colour + ')'}));
    };
    if (form) line(form.pressure, 'stick');
    if (form && first) line(form.traction, 'slip');
    positions.forEach((p, unit) => {
      const x = p[right] - centre.x;
      if (Math.abs(Math.abs(p[up] - centre.y) - row) > 0.01 * pitchY || Math.abs(x) >= half) return;
      for (const [value, colour] of [[fields[unit].z, 'stick'], [fields[unit].size, 'slip']])
        chart.append(mark('circle', {cx: across(x), cy: along(value), r: 2.8, style: 'fill:var(--' + colour + ')'}));
    });
    const legend = ': pressure (blue), traction (red)' + (form ? '; lines: closed form' : '');
    const title = el('span', {}, el('b', {}, 'Along the row through the middle'), legend);
    this.profile.replaceChildren(el('div.chart-title', {}, title), chart);
  }

  update(sample) {
    this.shown = sample;
    const fields = this.fields(sample), {centre, form} = this.formOf(fields);
    const first = form && sample < (this.pushEnds ??= this.firstPush());
    this.drawMaps(fields, centre, form, first);
    this.drawProfile(fields, centre, form, first);
    this.note.textContent = form ?
        'Circles: contact (solid) and stick zone (dashed) of the closed form. It is the solution of Hertz' +
            (first ? ', Cattaneo and Mindlin.' : '. The solution of the traction holds for a first, growing push.') :
        '';
  }
}

// The fields of a recording; null if the pad is not a full grid.
sb.skinSection = (recording, skin) => {
  const {right, up} = sb.padView(recording.type);
  const levels = axis => [...new Set(recording.positions.map(p => p[axis].toFixed(7)))].map(Number).sort(d3.ascending);
  const xs = levels(right), ys = levels(up);
  if (xs.length < 2 || ys.length < 2 || xs.length * ys.length !== recording.units) return null;
  return new SkinFields(recording, skin, xs, ys);
};
