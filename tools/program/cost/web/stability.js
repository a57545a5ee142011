// The longest stable step, measured and predicted, over stiffness, mass and damping.
(function(sb) {
'use strict';
const el = sb.element;

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
const found = combination => combination.measured_s !== null && combination.measured_s !== undefined;

const lines = combination => [
    [combination.case, combination.integrator].filter(text => text).join(', '),
    axes.map(axis => axis.name + ' ' + axis.text(combination[axis.key])).join(', '),
    'longest stable step, measured: ' + sb.duration(combination.measured_s),
    'predicted: ' + sb.duration(combination.predicted_s) + ', allowed: ' + sb.duration(combination.allowed_s),
    'predicted / measured: ' + sb.significant(combination.ratio, 3),
];

// A mark with its tip, for the pointer and for readers of screens.
function mark(svg, combination, index, x, y) {
  svg.append('path')
      .attr({
        class: 'mark spot',
        transform: 'translate(' + [x, y] + ')',
        d: sb.markPath(index, 4.5),
        role: 'img',
        'aria-label': lines(combination).join('; ')
      })
      .style('color', sb.hue(index))
      .on('mousemove', () => sb.showTip(lines(combination), d3.event.clientX, d3.event.clientY))
      .on('mouseout', sb.hideTip);
}

// A scale over levels: logarithmic; zero, which has no logarithm, gets a place of its own before the others.
function scaleOf(values, range) {
  const positive = values.filter(value => value > 0);
  const apart = positive.length < values.length ? Math.sign(range[1] - range[0]) * 34 : 0;
  const scale = d3.scale.log().domain(sb.logDomain(positive.length ? positive : [1])).range([range[0] + apart, range[1]]);
  const at = value => value > 0 ? scale(value) : range[0] + apart / 2;
  at.ticks = sb.logTicks(scale.domain(), Math.abs(range[1] - range[0] - apart), 44);
  if (apart) at.ticks.unshift(0);
  return at;
}

// One picture: steps over `across`, a line for each level of `by`.
function panel(title, combinations, across, by, xLevels, steps, byLevels) {
  const box = {width: 380, height: 300, left: 52, right: 10, top: 8, bottom: 42};
  const node = el('div', {}, el('h3', {}, title));
  const svg = d3.select(node).append('svg').attr(
      {viewBox: '0 0 ' + box.width + ' ' + box.height, class: 'map', role: 'img', 'aria-label': 'Longest stable step: ' + title});
  const x = scaleOf(xLevels, [box.left, box.width - box.right]);
  const y = d3.scale.log().domain(steps).range([box.height - box.bottom, box.top]);
  for (const tick of x.ticks) {
    svg.append('line').attr({class: 'mesh', x1: x(tick), x2: x(tick), y1: box.top, y2: box.height - box.bottom});
    svg.append('text')
        .attr({x: x(tick), y: box.height - box.bottom + 15, 'text-anchor': 'middle'})
        .text(tick ? sb.tickText(tick) : '0');
  }
  for (const tick of sb.logTicks(steps.map(step => step * 1e3), box.height - box.bottom - box.top, 24)) {
    svg.append('line').attr({class: 'mesh', x1: box.left, x2: box.width - box.right, y1: y(tick / 1e3), y2: y(tick / 1e3)});
    svg.append('text').attr({x: box.left - 6, y: y(tick / 1e3) + 4, 'text-anchor': 'end'}).text(sb.tickText(tick));
  }
  svg.append('rect').attr({
    class: 'map-edge',
    x: box.left,
    y: box.top,
    width: box.width - box.left - box.right,
    height: box.height - box.top - box.bottom
  });
  svg.append('text')
      .attr({class: 'title', x: (box.left + box.width - box.right) / 2, y: box.height - 6, 'text-anchor': 'middle'})
      .text(across.name + ', ' + across.unit);
  svg.append('text')
      .attr({
        class: 'title',
        transform: 'translate(11,' + (box.top + box.height - box.bottom) / 2 + ')rotate(-90)',
        'text-anchor': 'middle'
      })
      .text('step, ms');
  byLevels.forEach((level, index) => {
    const line = combinations.filter(combination => combination[by.key] === level).sort((a, b) => a[across.key] - b[across.key]);
    for (const [kind, key] of [['predicted', 'predicted_s'], ['allowed', 'allowed_s']]) {
      const points = line.filter(combination => combination[key] > 0)
                         .map(combination => x(combination[across.key]) + ',' + y(combination[key]));
      if (points.length > 1) svg.append('path').attr({class: kind, d: 'M' + points.join('L')}).style('color', sb.hue(index));
    }
    for (const combination of line.filter(found))
      mark(svg, combination, index, x(combination[across.key]), y(combination.measured_s));
  });
  return node;
}

// The maps, with what stands across chosen by the reader; lines and pictures take the other two.
function maps(combinations) {
  const host = el('div.panels');
  const key = el('div.keys');
  const varied = axes.filter(axis => levels(combinations, axis.key).length > 1);
  const steps = sb.logDomain(combinations.flatMap(({measured_s, predicted_s, allowed_s}) => [measured_s, predicted_s, allowed_s])
                                 .filter(step => step > 0));
  const lineOrder = {k_normal: ['mass_kg', 'damping_s'], mass_kg: ['k_normal', 'damping_s'], damping_s: ['mass_kg', 'k_normal']};
  const draw = across => {
    const [by, facet] = lineOrder[across.key].map(name => axes.find(axis => axis.key === name));
    const byLevels = levels(combinations, by.key);
    const groups = d3.nest()
                       .key(combination => combination.case)
                       .key(combination => combination.integrator)
                       .key(combination => combination[facet.key])
                       .entries(combinations);
    const single = levels(combinations, facet.key).length < 2;
    const pictures = groups.flatMap(
        one => one.values.flatMap(
            two => two.values.slice()
                       .sort((a, b) => a.key - b.key)
                       .map(
                           three => panel(
                               [one.key, two.key, single ? '' : facet.name + ' ' + facet.text(+three.key)]
                                   .filter(text => text)
                                   .join(', '),
                               three.values, across, by, levels(combinations, across.key), steps, byLevels))));
    host.replaceChildren(...pictures);
    const line = (kind, words) => {
      const item = el('span');
      d3.select(item).append('svg').attr({viewBox: '0 0 24 16', class: 'sample', 'aria-hidden': 'true'}).append('path').attr({
        class: kind,
        d: 'M1,8H23'
      });
      item.append(words);
      return item;
    };
    key.replaceChildren(
        el('span', {}, by.name + ':'), ...byLevels.map((level, index) => el('span', {}, sb.swatch(index), by.text(level))),
        line('predicted', 'predicted limit'), line('allowed', 'what a scene may use'), el('span', {}, 'marks: measured'));
  };
  const chooser =
      el('select', {onchange: event => draw(axes.find(axis => axis.key === event.target.value))},
         varied.map(axis => el('option', {value: axis.key}, axis.name)));
  draw(varied[0] || axes[0]);
  return [
    el('h3.sub', {}, 'Longest stable step'),
    varied.length > 1 ? el('div.controls', {}, el('label', {}, 'across', chooser)) : null, key, host
  ];
}

// How far each prediction is from what was measured; above one it would promise too much.
function ratios(combinations) {
  const node = el('div.ratios');
  const box = {height: 190, left: 46, right: 10, top: 10, bottom: 40};
  const seen = combinations.filter(combination => found(combination) && combination.ratio !== null);
  if (!seen.length) return null;
  const draw = () => {
    const width = node.clientWidth;
    const extent = d3.extent(seen.map(combination => combination.ratio));
    const domain = [Math.min(0.75, extent[0] - 0.03), Math.max(1.05, extent[1] + 0.03)];
    const x = scaleOf(seen.map(combination => combination.measured_s * 1e3), [box.left, width - box.right]);
    const y = d3.scale.linear().domain(domain).range([box.height - box.bottom, box.top]);
    node.replaceChildren();
    const svg = d3.select(node).append('svg').attr({
      viewBox: [0, 0, width, box.height].join(' '),
      role: 'img',
      'aria-label': 'Predicted over measured longest stable step of each combination'
    });
    svg.append('rect').attr(
        {class: 'beyond', x: box.left, y: box.top, width: width - box.left - box.right, height: y(1) - box.top});
    for (const tick of x.ticks) {
      svg.append('line').attr({class: 'mesh', x1: x(tick), x2: x(tick), y1: box.top, y2: box.height - box.bottom});
      svg.append('text').attr({x: x(tick), y: box.height - box.bottom + 15, 'text-anchor': 'middle'}).text(sb.tickText(tick));
    }
    for (const tick of y.ticks(5)) {
      svg.append('line').attr({class: 'mesh', x1: box.left, x2: width - box.right, y1: y(tick), y2: y(tick)});
      svg.append('text').attr({x: box.left - 6, y: y(tick) + 4, 'text-anchor': 'end'}).text(sb.significant(tick, 2));
    }
    svg.append('line').attr({class: 'limit', x1: box.left, x2: width - box.right, y1: y(1), y2: y(1)});
    svg.append('text')
        .attr({class: 'halo-text', x: width - box.right - 5, y: y(1) - 5, 'text-anchor': 'end'})
        .text('above 1: promises too much');
    svg.append('text')
        .attr({class: 'title', x: (box.left + width - box.right) / 2, y: box.height - 6, 'text-anchor': 'middle'})
        .text('measured longest stable step, ms');
    const kinds = levels(seen, 'integrator');
    for (const combination of seen)
      mark(svg, combination, kinds.indexOf(combination.integrator), x(combination.measured_s * 1e3), y(combination.ratio));
  };
  sb.onWidth(node, draw);
  const kinds = levels(seen, 'integrator');
  return [
    el('h3.sub', {}, 'Predicted over measured'),
    kinds.length > 1 ? el('div.keys', {}, kinds.map((kind, index) => el('span', {}, sb.swatch(index), kind))) : null, node
  ];
}

function table(combinations) {
  const number = (title, key, show) =>
      ({title, value: combination => combination[key], cell: combination => show(combination[key])});
  const word = (title, key) =>
      ({title, text: true, value: combination => combination[key], cell: combination => combination[key] || ''});
  const columns = [
    word('case', 'case'), word('integrator', 'integrator'), ...axes.map(axis => number(axis.name, axis.key, axis.text)),
    number('predicted', 'predicted_s', sb.duration), number('allowed', 'allowed_s', sb.duration),
    number('measured', 'measured_s', sb.duration), number('predicted / measured', 'ratio', ratio => sb.significant(ratio, 3))
  ];
  const {node} =
      sb.sortedTable(columns, combinations, (combination, cells) => el(combination.ratio > 1 ? 'tr.above' : 'tr', {}, cells));
  return el('div.scroll.tall', {tabindex: 0, role: 'region', 'aria-label': 'All combinations'}, node);
}

sb.stabilitySection = stability => {
  const combinations = stability.combinations || [];
  const figure = (name, value, note, good) =>
      el('div', {}, el('div.k', {}, name), el(good === false ? 'div.v.bad' : 'div.v', {}, value), el('div.s', {}, note));
  return el(
      'section.stability', {}, 'slipbench_cost' in sb.data ? el('h2', {}, 'How long a step stays stable') : null,
      (stability.text || []).map(text => el('p.note', {}, text)),
      el('div.figures', {}, figure('combinations', String(combinations.length), 'of stiffness, mass and damping'),
         figure(
             'worst prediction', sb.significant(stability.worst_ratio, 3), 'predicted / measured; wanted: at least 0.8',
             !(stability.worst_ratio < 0.8)),
         figure('predicted too long', String(stability.above), 'wanted: 0', stability.above === 0)),
      combinations.length ?
          [...maps(combinations), ratios(combinations), el('h3.sub', {}, 'All combinations'), table(combinations)] :
          null);
};
})(window.slipbench);
