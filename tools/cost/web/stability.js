// The longest stable step, measured and predicted, by stiffness, mass and damping.
const el = sb.element, mark = sb.mark;

const newton = value => {
  const [size, unit] = [[1e6, 'MN/m'], [1e3, 'kN/m'], [1, 'N/m']].find(([limit]) => value >= limit) || [1, 'N/m'];
  return sb.figure(value / size) + ' ' + unit;
};
const mass = value => value < 1 ? sb.figure(value * 1e3) + ' g' : sb.figure(value) + ' kg';
const axes = [
  {key: 'k_normal', name: 'stiffness', unit: 'N/m', text: newton},
  {key: 'mass_kg', name: 'mass', unit: 'kg', text: mass},
  {key: 'damping_s', name: 'damping', unit: 's', text: sb.duration},
];
const levels = (all, key) => [...new Set(all.map(combination => combination[key]))].sort(d3.ascending);
const found = combination => (combination.measured_s ?? null) !== null;

const lines = combination => [
  [combination.case, combination.integrator].filter(text => text).join(', '),
  axes.map(axis => axis.name + ' ' + axis.text(combination[axis.key])).join(', '),
  'longest stable step, measured: ' + sb.duration(combination.measured_s),
  'predicted: ' + sb.duration(combination.predicted_s) + ', allowed: ' + sb.duration(combination.allowed_s),
  'predicted / measured: ' + sb.significant(combination.ratio, 3)
];

// A mark with a tooltip and a text for screen readers.
const spot = (combination, index, x, y) => mark('path.mark.spot', {
  transform: 'translate(' + [x, y] + ')', d: sb.markPath(index, 4.5), role: 'img',
  'aria-label': lines(combination).join('; '), style: 'color:' + sb.hue(index),
  ...sb.tipped(() => lines(combination))
});

// A logarithmic axis; the value zero, which has no logarithm, is drawn before the others.
function levelAxis(title, values, range) {
  const positive = values.filter(value => value > 0);
  const apart = positive.length < values.length ? Math.sign(range[1] - range[0]) * 34 : 0;
  const scale = d3.scaleLog(sb.logDomain(positive.length ? positive : [1]), [range[0] + apart, range[1]]);
  return {
    title, scale, ticks: sb.ticks(scale, 44), text: sb.tickText, at: value => value > 0 ? scale(value) : range[0] + apart / 2,
    zero: apart ? range[0] + apart / 2 : null
  };
}

// One chart: steps over `across`, a line for each level of `by`.
function panel(title, combinations, across, by, xLevels, steps, byLevels) {
  const box = {width: 380, height: 300, left: 52, right: 10, top: 8, bottom: 42}, foot = box.height - box.bottom;
  const x = levelAxis(across.name + ', ' + across.unit, xLevels, [box.left, box.width - box.right]);
  const scale = d3.scaleLog(steps.map(step => step * 1e3), [foot, box.top]);
  const y = {title: 'step, ms', scale, ticks: sb.ticks(scale, 24), text: sb.tickText};
  const svg = sb.axes(box, x, y, {class: 'map', role: 'img', 'aria-label': 'Longest stable step: ' + title});
  if (x.zero !== null) svg.append(sb.text(x.zero, foot + 16, 'middle', '0'));
  byLevels.forEach((level, index) => {
    const line = combinations.filter(combination => combination[by.key] === level).sort((a, b) => a[across.key] - b[across.key]);
    const place = (combination, key) => [x.at(combination[across.key]), scale(combination[key] * 1e3)];
    for (const kind of ['predicted', 'allowed']) {
      const points =
          line.filter(combination => combination[kind + '_s'] > 0).map(combination => place(combination, kind + '_s'));
      if (points.length > 1) svg.append(mark('path.' + kind, {d: d3.line()(points), style: 'color:' + sb.hue(index)}));
    }
    svg.append(...line.filter(found).map(combination => spot(combination, index, ...place(combination, 'measured_s'))));
  });
  return el('div', {}, el('h3', {}, title), svg);
}

// The charts; the user chooses the horizontal axis, lines and charts take the two others.
function maps(combinations) {
  const host = el('div.panels');
  const key = el('div.keys');
  const varied = axes.filter(axis => levels(combinations, axis.key).length > 1);
  const steps = sb.logDomain(combinations.flatMap(({measured_s, predicted_s, allowed_s}) => [measured_s, predicted_s, allowed_s])
                                 .filter(step => step > 0));
  const lineOrder = {k_normal: ['mass_kg', 'damping_s'], mass_kg: ['k_normal', 'damping_s'], damping_s: ['mass_kg', 'k_normal']};
  const draw = across => {
    const [by, facet] = lineOrder[across.key].map(name => axes.find(axis => axis.key === name));
    const byLevels = levels(combinations, by.key), facets = levels(combinations, facet.key);
    // One chart for each case, integrator and level of the third axis.
    const groups = d3.groups(combinations, one => JSON.stringify([one.case, one.integrator]));
    const pictures = groups.flatMap(([, values]) => facets.map(level => {
      const held = values.filter(combination => combination[facet.key] === level), {case: name, integrator} = values[0];
      const title =
          [name, integrator, facets.length < 2 ? '' : facet.name + ' ' + facet.text(level)].filter(text => text).join(', ');
      return held.length ? panel(title, held, across, by, levels(combinations, across.key), steps, byLevels) : '';
    }));
    host.replaceChildren(...pictures);
    const line = (kind, words) => sb.key('0 0 24 16', mark('path.' + kind, {d: 'M1,8H23'}), words, 'sample');
    key.replaceChildren(
        el('span', {}, by.name + ':'), ...byLevels.map((level, index) => el('span', {}, sb.swatch(index), by.text(level))),
        line('predicted', 'predicted limit'), line('allowed', 'limit for scenes'), el('span', {}, 'marks: measured'));
  };
  const first = varied[0] || axes[0];
  const choose = name => draw(axes.find(axis => axis.key === name));
  draw(first);
  return [
    el('h3.sub', {}, 'Longest stable step'),
    varied.length > 1 &&
        el('div.controls', {}, sb.choose('across', varied.map(axis => [axis.key, axis.name]), first.key, choose)),
    key, host
  ];
}

// Ratio of each prediction to its measurement; above one the prediction is unsafe.
function ratios(combinations) {
  const node = el('div.ratios');
  const seen = combinations.filter(combination => found(combination) && combination.ratio !== null);
  if (!seen.length) return null;
  const kinds = levels(seen, 'integrator');
  const draw = () => {
    const box = {width: node.clientWidth, height: 190, left: 46, right: 10, top: 10, bottom: 40}, end = box.width - box.right;
    const extent = d3.extent(seen.map(combination => combination.ratio));
    const domain = [Math.min(0.75, extent[0] - 0.03), Math.max(1.05, extent[1] + 0.03)];
    const x =
        levelAxis('measured longest stable step, ms', seen.map(combination => combination.measured_s * 1e3), [box.left, end]);
    const y = d3.scaleLinear(domain, [box.height - box.bottom, box.top]);
    const ratio = {title: '', scale: y, ticks: y.ticks(5), text: tick => sb.significant(tick, 2)};
    const svg =
        sb.axes(box, x, ratio, {role: 'img', 'aria-label': 'Predicted over measured longest stable step of each combination'});
    svg.prepend(mark('rect.beyond', {x: box.left, y: box.top, width: end - box.left, height: y(1) - box.top}));
    svg.append(
        mark('path.limit', {d: 'M' + box.left + ',' + y(1) + 'H' + end}),
        sb.text(end - 5, y(1) - 5, 'end', 'above 1: predicted too long', 'halo-text'),
        ...seen.map(one => spot(one, kinds.indexOf(one.integrator), x.at(one.measured_s * 1e3), y(one.ratio))));
    node.replaceChildren(svg);
  };
  sb.onWidth(node, draw);
  return [
    el('h3.sub', {}, 'Predicted over measured'),
    kinds.length > 1 && el('div.keys', {}, kinds.map((kind, index) => el('span', {}, sb.swatch(index), kind))), node
  ];
}

function table(combinations) {
  const column = (title, key, show, kind) =>
      ({title, kind, value: combination => combination[key], cell: combination => show(combination[key])});
  const word = name => column(name, name, value => value || '', 'text');
  const columns = [
    word('case'), word('integrator'), ...axes.map(axis => column(axis.name, axis.key, axis.text)),
    column('predicted', 'predicted_s', sb.duration), column('allowed', 'allowed_s', sb.duration),
    column('measured', 'measured_s', sb.duration), column('predicted / measured', 'ratio', ratio => sb.significant(ratio, 3))
  ];
  const {node} =
      sb.sortedTable(columns, combinations, (combination, cells) => el(combination.ratio > 1 ? 'tr.above' : 'tr', {}, cells));
  return el('div.scroll.tall', {tabindex: 0, role: 'region', 'aria-label': 'All combinations'}, node);
}

sb.stabilitySection = stability => {
  const combinations = stability.combinations || [];
  return el(
      'section.stability', {}, 'slipbench_cost' in sb.data && el('h2', {}, 'Longest stable time step'),
      (stability.text || []).map(text => el('p.note', {}, text)), sb.figures([
        ['combinations', String(combinations.length), 'of stiffness, mass and damping'],
        [
          'worst prediction', sb.significant(stability.worst_ratio, 3), 'predicted / measured; wanted: at least 0.8',
          stability.worst_ratio < 0.8 && 'bad'
        ],
        ['predicted too long', String(stability.above), 'wanted: 0', stability.above !== 0 && 'bad']
      ]),
      combinations.length > 0 &&
          [...maps(combinations), ratios(combinations), el('h3.sub', {}, 'All combinations'), table(combinations)]);
};
