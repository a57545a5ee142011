// Pressure, traction and stick zone of a pad that is one elastic body, at the cursor, and the closed form of a sphere beside them.
const el = sb.element, mark = sb.mark;
const size = 250, gap = 26;  // px, of a map and between maps

// The closed form at normal force N and tangential force T: Hertz, Cattaneo and Mindlin. Lengths in m, forces in N, pressures in Pa.
function closedForm({shear_modulus: g, sphere_radius: radius, friction}, normal, tangential) {
  const a = Math.cbrt(3 * normal * radius / (16 * g)), peak = 3 * normal / (2 * Math.PI * a * a);
  const c = a * Math.cbrt(Math.max(0, 1 - tangential / (friction * normal)));
  const dome = (r, edge) => Math.sqrt(Math.max(0, 1 - (r / edge) ** 2));
  return {
    a, c, pressure: r => peak * dome(r, a),
    traction: r => friction * peak * (dome(r, a) - (c > 0 ? c / a * dome(r, c) : 0))
  };
}

// The fields of a recording, its `skin` as sb.page.skins has it; null where the pad is no full grid.
sb.skinSection = (recording, skin) => {
  const {right, up} = sb.padView(recording.type), {positions, units} = recording;
  const levels = axis => [...new Set(positions.map(p => p[axis].toFixed(7)))].map(Number).sort(d3.ascending);
  const xs = levels(right), ys = levels(up);
  if (xs.length < 2 || ys.length < 2 || xs.length * ys.length !== units) return null;
  const pitchX = xs[1] - xs[0], pitchY = ys[1] - ys[0], scale = size / Math.max(xs.length * pitchX, ys.length * pitchY);  // px/m
  const width = pitchX * scale, height = pitchY * scale, high = ys.length * height;
  const px = x => (x - xs[0]) * scale + width / 2, py = y => high - (y - ys[0]) * scale - height / 2;
  const forces = sample => d3.range(units).map(unit => {
    const [x, y, z] = [right, up, 2].map(c => (recording.at('labels/force', unit, c, sample) || 0) / (pitchX * pitchY));
    return {x, y, z, size: Math.hypot(x, y)};
  });
  const pull = fields => Math.hypot(d3.sum(fields, f => f.x), d3.sum(fields, f => f.y));
  const map = index => {
    const cells = positions.map(p => mark('rect', {x: px(p[right]) - width / 2, y: py(p[up]) - height / 2, width, height, stroke: 'var(--line)', 'stroke-width': 0.4}));
    const rings = ['none', '5 3'].map(dash => mark('circle', {fill: 'none', stroke: 'var(--ink)', 'stroke-width': 1.4, 'stroke-dasharray': dash}));
    const title = sb.text(0, -6, 'start', ''), arrows = index === 1 ? positions.map(() => mark('path', {stroke: 'var(--ink)', 'stroke-width': 1})) : [];
    return {cells, rings, title, arrows, node: mark('g', {transform: 'translate(' + index * (size + gap) + ',20)'}, cells, rings, arrows, title)};
  };
  const maps = [0, 1, 2].map(map);
  const svg = mark('svg', {class: 'plot', viewBox: [-2, 0, 3 * size + 2 * gap + 4, high + 24].join(' '), role: 'img', 'aria-label': 'Pressure, traction and stick zone at the cursor'},
                   maps.map(({node}) => node));
  const profile = el('div'), note = el('p.note'), host = el('div', {}, el('div', {}, svg), profile);
  const section = sb.section('Fields of the soft skin', 'At the cursor.', host, note);
  sb.saveCorner(host, 'Fields of the soft skin', () => svg, () => [
    ['x [m]', 'y [m]', 'pressure [Pa]', 'traction x [Pa]', 'traction y [Pa]', 'state'],
    ...forces(shown).map((f, unit) => [...positions[unit], f.z, ...right ? [f.y, f.x] : [f.x, f.y], sb.states.unit[recording.unitStates[unit][shown]].name])
  ]);
  let shown = 0;
  // From which sample on it is no push that grows for the first time: it has fallen by more than a thousandth of what friction holds, or pulls several ways.
  const firstPush = () => {
    let most = 0;
    for (let row = 0; row < recording.time.length; row += recording.stride) {
      const fields = forces(row), now = pull(fields), little = 1e-3 * skin.friction * d3.sum(fields, f => f.z);
      if (now < most - little || d3.sum(fields, f => f.size) > 1.01 * now + little) return row;
      most = Math.max(most, now);
    }
    return Infinity;
  };
  let pushEnds;
  const drawProfile = (fields, centre, form, first) => {
    const box = {width: 3 * size + 2 * gap, height: 230, left: 58, right: 8, top: 8, bottom: 36};
    const half = 0.5 * xs.length * pitchX, top = Math.max(1e-9, d3.max(fields, f => Math.max(f.z, f.size)), form ? form.pressure(0) : 0);
    const across = sb.scale(false, [-half, half], [box.left, box.width - box.right]), along = sb.scale(false, [0, 1.05 * top], [box.height - box.bottom, box.top]);
    const row = d3.min(ys, y => Math.abs(y - centre.y)), kPa = value => sb.significant(value / 1e3, 3);
    const chart = sb.axes(box, {title: 'distance from the middle of the contact, mm', ticks: across.ticks(8), at: across, text: x => sb.significant(x * 1e3, 3)},
                          {title: 'kPa', ticks: along.ticks(5), at: along, text: kPa}, {class: 'plot', role: 'img', 'aria-label': 'Pressure and traction along the row through the middle'});
    const line = (of, colour) => mark('path.curve', {
      d: 'M' + d3.range(201).map(i => (i / 100 - 1) * half).map(x => across(x) + ',' + along(of(Math.hypot(x, row)))).join('L'), style: 'stroke:var(--' + colour + ')'
    });
    if (form) chart.append(line(form.pressure, 'stick'));
    if (form && first) chart.append(line(form.traction, 'slip'));
    positions.forEach((p, unit) => {
      if (Math.abs(Math.abs(p[up] - centre.y) - row) > 0.01 * pitchY) return;
      for (const [value, colour] of [[fields[unit].z, 'stick'], [fields[unit].size, 'slip']])
        if (Math.abs(p[right] - centre.x) < half) chart.append(mark('circle', {cx: across(p[right] - centre.x), cy: along(value), r: 2.8, style: 'fill:var(--' + colour + ')'}));
    });
    profile.replaceChildren(el('div.chart-title', {}, el('span', {}, el('b', {}, 'Along the row through the middle'), ': pressure (blue), traction (red)' + (form ? '; lines: closed form' : ''))), chart);
  };
  const update = sample => {
    shown = sample;
    const fields = forces(sample), most = key => Math.max(1e-9, d3.max(fields, f => f[key]));
    const total = d3.sum(fields, f => f.z), largest = most('size'), peak = most('z'), area = pitchX * pitchY;
    const middle = axis => total > 0 ? d3.sum(fields, (f, unit) => f.z * positions[unit][axis]) / total : 0;
    const centre = {x: middle(right), y: middle(up)};
    const whole = skin.sphere_radius && total > 0 ? closedForm(skin, total * area, pull(fields) * area) : null;
    // It is that of a contact with pad all around it.
    const within = (at, places, pitch) => Math.abs(at - d3.mean(places)) + whole.a <= 0.5 * places.length * pitch;
    const form = whole && within(centre.x, xs, pitchX) && within(centre.y, ys, pitchY) ? whole : null, first = form && sample < (pushEnds ??= firstPush());
    const looks = [f => ['var(--stick)', f.z / peak], f => ['var(--slip)', 0.8 * f.size / largest], (f, unit) => {
      const {key} = sb.states.unit[recording.unitStates[unit][sample]];
      return key === 'detached' ? ['none', 0] : [sb.stateFill(key), 0.75];
    }];
    const words = ['pressure, up to ' + sb.significant(peak / 1e3, 3) + ' kPa', 'traction, up to ' + sb.significant(largest / 1e3, 3) + ' kPa', 'stick (blue) and slip (red)'];
    maps.forEach(({cells, rings, title, arrows}, index) => {
      cells.forEach((cell, unit) => {
        const [fill, opacity] = looks[index](fields[unit], unit);
        cell.style.fill = fill;
        cell.style.fillOpacity = opacity;
      });
      rings.forEach((ring, k) => {
        const radius = form && (k === 0 || first) ? (k ? form.c : form.a) * scale : 0;
        for (const [name, value] of [['cx', px(centre.x)], ['cy', py(centre.y)], ['r', radius]]) ring.setAttribute(name, value);
      });
      arrows.forEach((arrow, unit) => {
        const [x, y] = [px(positions[unit][right]), py(positions[unit][up])], reach = 0.9 * Math.min(width, height) / largest;
        arrow.setAttribute('d', 'M' + [x, y] + 'l' + [fields[unit].x * reach, -fields[unit].y * reach]);
      });
      title.textContent = words[index];
    });
    drawProfile(fields, centre, form, first);
    note.textContent = !form ? '' : 'Circles: contact (solid) and stick zone (dashed) of the closed form. It is that of Hertz' + (first ? ', Cattaneo and Mindlin.' : '. That of the traction is for a push that grows for the first time.');
  };
  return {section, update};
};
