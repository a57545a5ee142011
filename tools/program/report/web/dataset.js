// The overview of a dataset with several trials.
(function(sb) {
'use strict';
const el = sb.element;
const page = sb.page;

// What can stand on a vertical axis: durations in seconds.
const outcomes = [
  {key: 'first_micro_s', name: 'first micro-slip', timed: true},
  {key: 'first_full_s', name: 'first full slip', timed: true},
  {key: 'gross_s', name: 'gross slip', timed: true},
  {key: 'incipient_s', name: 'incipient phase', timed: false},
];
const preferred = ['motion.speed', 'friction.static', 'friction.scale', 'motion.compression', 'motion.rotation'];
const hues = ['#2f78b7', '#d99500', '#0a7d66', '#a5559b', '#cc4b1c', '#5b6570', '#59b3d8', '#8a7a00'];
const shapes = ['circle', 'square', 'triangle-up', 'diamond', 'cross', 'triangle-down'];
const gradient = ['#3b1c6e', '#2f5f8f', '#1f9489', '#6cbf57', '#e8c82e'];

// What follows from the drawn values: whether a trial slides, turns, or both.
const kind = {
  path: 'kind of motion',
  unit: '',
  numeric: false
};
const kindOf = trial => {
  const moves = path => path in trial.params && trial.params[path].value !== 0;
  const [slides, turns] = [moves('motion.speed'), moves('motion.rotation')];
  return slides && turns ? 'both' : turns ? 'rotation' : slides ? 'translation' : 'neither';
};
const turned = page.axes.some(axis => axis.path === 'motion.rotation' && axis.varied);
const varied = page.axes.filter(axis => axis.varied);
const colourable = turned ? [kind, ...varied] : varied;

const valueOf = (trial, path) => path === kind.path ? kindOf(trial) :
    path in trial.params ? ('value' in trial.params[path] ? trial.params[path].value : trial.params[path].text) :
                           null;
const axisOf = path => colourable.find(axis => axis.path === path);
// Whether positive values span so much that a logarithmic axis shows them better. Angles never do.
const wide = ([low, high], factor, unit) => unit !== 'rad' && low > 0 && high / low >= factor;
const label = axis => sb.pathWord(axis.path) + (axis.unit ? ', ' + sb.symbol(axis.unit) : '');
// A value that is there but not finite is "never" or "no limit".
const endless = (axis, trial) => axis.numeric && axis.path in trial.params && trial.params[axis.path].value === null;
const plain = (axis, value) => value === null ? '–' : axis.numeric ? sb.quantity(value, axis.unit, 3) : String(value);
const said = (axis, trial) => endless(axis, trial) ? sb.endless(axis.unit) : plain(axis, valueOf(trial, axis.path));

sb.sweptValues = {
  varied,
  valueOf,
  endless,
  label,
  plain,
  wide
};

// Trials run with one sensor or several; the overview is of one of them.
const summaryOf = (trial, sensor) => trial.sensors[sensor];

function swept() {
  const constant = page.axes.filter(axis => !axis.varied);
  const rows = varied.map(axis => {
    const values = page.trials.map(trial => valueOf(trial, axis.path)).filter(value => value !== null);
    const distinct = [...new Set(values)];
    if (axis.numeric) distinct.sort((a, b) => a - b);
    const grid = distinct.length <= 24 && distinct.length < Math.max(3, values.length * 0.6);
    const list = grid && distinct.length <= 8;
    const span =
        axis.numeric && distinct.length ? plain(axis, distinct[0]) + ' to ' + plain(axis, distinct[distinct.length - 1]) : '';
    const text = list ? distinct.map(value => plain(axis, value)).join(', ') :
                        [grid || !span ? distinct.length + ' values' : '', span].filter(part => part).join(', ');
    const more = page.trials.some(trial => endless(axis, trial)) ? (text ? ', ' : '') + sb.endless(axis.unit) : '';
    const cell = el('td.text');
    if (axis.numeric && values.length) drawDots(cell, axis, values, wide([distinct[0], distinct[distinct.length - 1]], 8, axis.unit));
    return el(
        'tr', {}, el('td.text', {title: axis.path}, el('b', {}, sb.pathWord(axis.path))),
        el('td.text', {}, grid ? 'grid' : 'drawn'), el('td.text', {style: 'white-space:normal'}, text + more), cell);
  });
  const same = constant.map(axis => sb.pathWord(axis.path) + ' ' + sb.parameter(page.trials[0].params[axis.path])).join(', ');
  return el(
      'section', {}, el('h2', {}, 'What was swept'),
      el('p.note', {},
         rows.length ? 'One tick a trial; the scale is logarithmic where the values span a factor of eight or more.' :
                       'Nothing differs between the trials but their seeds.',
         same ? ' The same in all trials: ' + same + '.' : ''),
      rows.length ? el('table.swept', {}, el('tbody', {}, rows)) : null);
}

// One tick a value along a line.
function drawDots(parent, axis, values, logarithmic) {
  const [low, high] = d3.extent(values);
  const scale = (logarithmic ? d3.scale.log() : d3.scale.linear()).domain([low, high > low ? high : low + 1]).range([6, 154]);
  const svg = d3.select(parent).append('svg').attr('width', 160).attr('height', 18).attr('role', 'img').attr(
      'aria-label', sb.pathWord(axis.path) + ' of the trials, ' + plain(axis, low) + ' to ' + plain(axis, high));
  svg.append('line').attr('x1', 6).attr('x2', 154).attr('y1', 15).attr('y2', 15).style('stroke', 'var(--line)');
  // Ticks at one place are one mark, as dark as they are together.
  const places = d3.nest().key(value => scale(value).toFixed(0)).rollup(same => same.length).entries(values);
  const through = values.length > 40 ? 0.75 : 0.4;
  svg.selectAll('path')
      .data(places)
      .enter()
      .append('path')
      .attr('d', place => 'M' + place.key + ',4V15')
      .style('stroke', 'var(--accent)')
      .attr('stroke-opacity', place => 1 - through ** place.values);
}

// Share of all samples in each state by each rule.
function balance(sensor) {
  const total = sb.rules.map(rule => [0, 1, 2, 3].map(state => {
    const weights = page.trials.map(trial => trial.samples);
    return d3.sum(page.trials, (trial, i) => summaryOf(trial, sensor).shares[rule.key][state] * weights[i]) / d3.sum(weights);
  }));
  const host = el('div.balance');
  const width = 640, left = 52, bar = 22, gap = 12;
  const svg = d3.select(host)
                  .append('svg')
                  .attr('viewBox', '0 0 ' + width + ' ' + (sb.rules.length * (bar + gap + 12)))
                  .attr('role', 'img')
                  .attr('aria-label', 'Class balance by rule');
  sb.saveCorner(host, svg.node(), 'Class balance', () => [
    ['rule', ...sb.states.pad.map(state => state.name)], ...total.map((shares, row) => [sb.rules[row].name, ...shares])
  ]);
  total.forEach((shares, row) => {
    const y = row * (bar + gap + 12);
    svg.append('text')
        .attr('x', left - 8)
        .attr('y', y + bar / 2 + 4)
        .attr('text-anchor', 'end')
        .style('fill', 'var(--ink)')
        .text(sb.rules[row].name);
    let x = left;
    shares.forEach((share, state) => {
      const span = share * (width - left);
      const key = sb.states.pad[state].key;
      svg.append('rect')
          .attr('x', x)
          .attr('y', y)
          .attr('width', Math.max(0, span))
          .attr('height', bar)
          .style('fill', key === 'partial' ? 'url(#hatch)' : 'var(--' + key + ')')
          .style('fill-opacity', key === 'detached' ? 0.45 : 1)
          .style('stroke', 'var(--ground)');
      if (span > 30) {
        svg.append('text')
            .attr('x', x + span / 2)
            .attr('y', y + bar + 13)
            .attr('text-anchor', 'middle')
            .text((span > 92 ? sb.states.pad[state].name + ' ' : '') + sb.percent(share));
      }
      x += span;
    });
  });
  return el(
      'section', {}, el('h2', {}, 'Class balance'),
      el('p.note', {},
         'Share of the recorded time in each state. ' + sb.rules.map(rule => rule.name + ': ' + rule.note).join('; ') + '.'),
      sb.stateLegend(sb.states.pad), el('div', {style: 'height:8px'}), host);
}

// Number of trials by the length of their incipient phase.
function durations(sensor) {
  const values = page.trials.map(trial => summaryOf(trial, sensor).incipient_s).filter(value => value !== null && value > 0);
  const section =
      el('section', {}, el('h2', {}, 'How long the incipient phase lasts'),
         el('p.note', {},
            'From the first micro-slip to gross slip. ' +
                (values.length === page.trials.length ?
                     'All trials reach gross slip.' :
                     (page.trials.length - values.length) + ' of ' + page.trials.length + ' trials never reach gross slip.')));
  if (values.length < 2) return section;
  const [low, high] = d3.extent(values).map(value => value * 1e3);
  const logarithmic = wide([low, high], 8);
  const host = el('div.panels', {style: 'display:block'});
  section.append(host);
  const box = {width: 640, height: 170, left: 40, right: 10, top: 8, bottom: 36};
  const x = (logarithmic ? d3.scale.log() : d3.scale.linear()).domain([low * 0.98, high * 1.02]).range([
    box.left, box.width - box.right
  ]);
  const count = Math.min(24, Math.max(6, Math.round(Math.sqrt(values.length) * 1.6)));
  const edges = d3.range(count + 1).map(i => x.invert(box.left + (box.width - box.left - box.right) * i / count));
  const bins = d3.layout.histogram().bins(edges)(values.map(value => value * 1e3));
  const most = d3.max(bins, bin => bin.y);
  const y = d3.scale.linear().domain([0, most]).nice().range([box.height - box.bottom, box.top]);
  const svg = frame(host, box, x, y, 'incipient phase, ms' + (logarithmic ? ' (log)' : ''), 'trials', logarithmic, false, Math.min(most, 5));
  svg.selectAll('rect.bin')
      .data(bins)
      .enter()
      .append('rect')
      .attr('x', bin => x(bin.x) + 0.5)
      .attr('width', bin => Math.max(1, x(bin.x + bin.dx) - x(bin.x) - 1))
      .attr('y', bin => y(bin.y))
      .attr('height', bin => y(0) - y(bin.y))
      .style('fill', 'url(#hatch)');
  sb.saveCorner(host, svg.node(), 'Length of the incipient phase',
                () => [['from [ms]', 'to [ms]', 'trials'], ...bins.map(bin => [bin.x, bin.x + bin.dx, bin.y])]);
  return section;
}

// Ticks that a logarithmic axis can label without crowding: 1, 2 and 5 times powers of ten.
function logTicks(scale) {
  const [low, high] = scale.domain();
  const ticks = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); ++power) {
    for (const factor of [1, 2, 5]) {
      const tick = factor * 10 ** power;
      if (tick >= low && tick <= high) ticks.push(tick);
    }
  }
  return ticks;
}

// An SVG with axes and their titles.
function frame(host, box, x, y, xTitle, yTitle, xLog, yLog, yTicks = 5) {
  const svg = d3.select(host)
                  .append('svg')
                  .attr('viewBox', '0 0 ' + box.width + ' ' + box.height)
                  .attr('role', 'img')
                  .attr('aria-label', yTitle + ' against ' + xTitle);
  const format = value => sb.significant(value, 4);
  const axis = (scale, orient, log, ticks) => {
    const made = d3.svg.axis().scale(scale).orient(orient).ticks(ticks).tickFormat(format).outerTickSize(0).tickPadding(6);
    return log ? made.tickValues(logTicks(scale)) : made;
  };
  svg.append('g')
      .attr('class', 'axis')
      .attr('transform', 'translate(0,' + (box.height - box.bottom) + ')')
      .call(axis(x, 'bottom', xLog, 6).innerTickSize(4));
  svg.append('g')
      .attr('class', 'axis')
      .attr('transform', 'translate(' + box.left + ',0)')
      .call(axis(y, 'left', yLog, yTicks).innerTickSize(-(box.width - box.left - box.right)));
  svg.append('text')
      .attr('class', 'title')
      .attr('x', box.left + (box.width - box.left - box.right) / 2)
      .attr('y', box.height - 4)
      .attr('text-anchor', 'middle')
      .text(xTitle);
  svg.append('text')
      .attr('class', 'title')
      .attr('transform', 'translate(11,' + (box.top + box.height - box.bottom) / 2 + ')rotate(-90)')
      .attr('text-anchor', 'middle')
      .text(yTitle);
  return svg;
}
sb.frame = frame;

// How points are coloured and shaped by one parameter, and the legend that says so.
function encoding(path) {
  const axis = axisOf(path);
  if (!axis) return {colour: () => 'var(--accent)', shape: () => 'circle', legend: []};
  const values = [...new Set(page.trials.map(trial => valueOf(trial, path)))].filter(value => value !== null);
  const dot = (colour, shape, text) => {
    const item = el('span');
    d3.select(item)
        .append('svg')
        .attr('aria-hidden', 'true')
        .attr('viewBox', '-7 -7 14 14')
        .style('width', '14px')
        .append('path')
        .attr('d', d3.svg.symbol().type(shape).size(60)())
        .style('fill', colour);
    item.append(text);
    return item;
  };
  if (!axis.numeric) {
    const at = trial => values.indexOf(valueOf(trial, path));
    const colourAt = i => hues[Math.max(0, i) % hues.length], shapeAt = i => shapes[Math.max(0, i) % shapes.length];
    return {
      colour: trial => colourAt(at(trial)),
      shape: trial => shapeAt(at(trial)),
      legend: values.map((value, i) => dot(colourAt(i), shapeAt(i), String(value)))
    };
  }
  values.sort((a, b) => a - b);
  const range = [values[0], values[values.length - 1]];
  const position = (wide(range, 8, axis.unit) ? d3.scale.log() : d3.scale.linear())
                       .domain(range[0] === range[1] ? [range[0], range[0] + 1] : range)
                       .range([0, 1]);
  const ramp = d3.scale.linear().domain(d3.range(gradient.length).map(i => i / (gradient.length - 1))).range(gradient);
  const colour = value => ramp(position(value));
  const samples = values.length <= 8 ? values : d3.range(5).map(i => position.invert(i / 4));
  // What is endless has no place on the scale of colours: it gets a colour and a shape of its own.
  const beyond = page.trials.some(trial => endless(axis, trial)) ? [dot('var(--ink)', 'cross', sb.endless(axis.unit))] : [];
  return {
    colour: trial => endless(axis, trial) ? 'var(--ink)' :
        valueOf(trial, path) === null     ? 'var(--faint)' :
                                            colour(valueOf(trial, path)),
    shape: trial => endless(axis, trial) ? 'cross' : 'circle',
    legend: [...samples.map(value => dot(colour(value), 'circle', plain(axis, value))), ...beyond]
  };
}

// Times against what was swept.
function scatter(sensor, open) {
  const numeric = varied.filter(axis => axis.numeric);
  const section = el('section', {}, el('h2', {}, 'When units let go'));
  if (!numeric.length)
    return el('section', {}, el('h2', {}, 'When units let go'), el('p.note', {}, 'No numeric parameter was swept.'));
  const rank = axis => {
    const i = preferred.indexOf(axis.path);
    return i < 0 ? preferred.length : i;
  };
  const axes = numeric.slice().sort((a, b) => rank(a) - rank(b)).slice(0, 6);
  const started = page.trials.every(trial => trial.motion_start_s !== null);
  const state = {
    outcome: outcomes[1],
    relative: started,
    colour: (colourable.find(axis => !axis.numeric) || axes[1] || axes[0]).path
  };
  const choose = (name, options, value, change) =>
      el('label', {}, name,
         el('select', {
           onchange: event => {
             change(event.target.value);
             draw();
           }
         },
            options.map(([key, text]) => el('option', {value: key, selected: key === value ? '' : null}, text))));
  const legend = el('div.legend');
  const note = el('p.note');
  const host = el('div.panels');
  section.append(
      note,
      el('div.controls', {},
         choose(
             'time of', outcomes.map(outcome => [outcome.key, outcome.name]), state.outcome.key,
             key => {
               state.outcome = outcomes.find(outcome => outcome.key === key);
             }),
         started ? choose(
                       'counted from', [['motion', 'the start of the motion'], ['trial', 'the start of the trial']], 'motion',
                       key => {
                         state.relative = key === 'motion';
                       }) :
                   null,
         choose(
             'colour', [['', 'none'], ...colourable.map(axis => [axis.path, sb.pathWord(axis.path)])], state.colour,
             key => {
               state.colour = key;
             })),
      legend, host);
  const tip = el('div.tip');
  section.append(tip);

  const timeOf = trial => {
    const time = summaryOf(trial, sensor)[state.outcome.key];
    if (time === null) return null;
    return 1e3 * (state.outcome.timed && state.relative ? time - trial.motion_start_s : time);
  };
  function draw() {
    let waiting = Promise.resolve();
    const encoded = encoding(state.colour);
    legend.replaceChildren(...encoded.legend);
    const happened = page.trials.filter(trial => timeOf(trial) !== null);
    const never = page.trials.length - happened.length;
    note.textContent = 'One point a trial. ' +
        (never ? never + ' of ' + page.trials.length + ' trials do not get that far and are not shown. ' : '') +
        'Hover for its values, click to open it.';
    host.replaceChildren();
    if (!happened.length) return;
    const times = d3.extent(happened, timeOf);
    const yLog = wide(times, 12);
    axes.forEach(axis => {
      const box = {width: 400, height: 270, left: 58, right: 12, top: 10, bottom: 40};
      const finite = trials => trials.map(trial => valueOf(trial, axis.path))
                                   .filter(value => value !== null)
                                   .map(value => value * sb.factor(axis.unit));
      // Where only endless values are left, the others still say what the axis is.
      const values = finite(happened).length ? finite(happened) : finite(page.trials);
      // What is endless has no place on any axis, and zero none on a logarithmic one: they get one of their own, right and left of
      // the others.
      const beyond = happened.some(trial => endless(axis, trial));
      const zeros = values.includes(0) && wide(d3.extent(values.filter(value => value !== 0)), 8, axis.unit);
      const range = d3.extent(zeros ? values.filter(value => value !== 0) : values);
      const xLog = wide(range, 8, axis.unit);
      const padded = (interval, log) => {
        const [low, high] = interval;
        if (log) return [low / 1.25, high * 1.25];
        const gap = 0.06 * (high - low) || Math.abs(high) * 0.1 || 1;
        return [low - gap, high + gap];
      };
      const x = (xLog ? d3.scale.log() : d3.scale.linear()).domain(padded(range, xLog)).range([
        box.left + (zeros ? 26 : 0), box.width - box.right - (beyond ? 48 : 0)
      ]);
      const place = trial => {
        const value = valueOf(trial, axis.path) * sb.factor(axis.unit);
        return endless(axis, trial) ? box.width - box.right - 22 : value === 0 && zeros ? box.left + 13 : x(value);
      };
      const y = (yLog ? d3.scale.log() : d3.scale.linear()).domain(padded(times, yLog)).range([box.height - box.bottom, box.top]);
      const panel = el('div');
      host.append(panel);
      const svg = frame(
          panel, box, x, y, label(axis) + (xLog ? ' (log)' : ''), state.outcome.name + ', ms' + (yLog ? ' (log)' : ''), xLog,
          yLog);
      const name = (at, text) =>
          svg.append('text').attr('x', at).attr('y', box.height - box.bottom + 17).attr('text-anchor', 'middle').text(text);
      if (zeros) name(box.left + 13, '0');
      if (beyond) name(box.width - box.right - 22, sb.endless(axis.unit));
      const shown = happened.filter(trial => endless(axis, trial) || valueOf(trial, axis.path) !== null);
      sb.saveCorner(panel, svg.node(), state.outcome.name + ' against ' + sb.pathWord(axis.path), () => [
        ['trial', label(axis), state.outcome.name + ' [ms]'], ...shown.map(
            trial => [trial.index, endless(axis, trial) ? sb.endless(axis.unit) : valueOf(trial, axis.path) * sb.factor(axis.unit), timeOf(trial)])
      ]);
      // Thousands of points: each picture in a frame of its own, the axes at once.
      const draw = () => svg.selectAll('path.point')
          .data(shown)
          .enter()
          .append('path')
          .attr('class', 'point')
          .attr('transform', trial => 'translate(' + place(trial) + ',' + y(timeOf(trial)) + ')')
          .attr('d', trial => d3.svg.symbol().type(encoded.shape(trial)).size(46)())
          .style('fill', encoded.colour)
          .style('fill-opacity', 0.85)
          .on('click', trial => sb.isEmbedded(trial.index) ? open(trial.index) : sb.pointAtRow(trial.index))
          .on('mousemove',
              trial => {
                tip.style.display = 'block';
                tip.style.left = Math.min(d3.event.clientX + 14, window.innerWidth - 240) + 'px';
                tip.style.top = (d3.event.clientY + 12) + 'px';
                tip.textContent = [
                  'trial ' + trial.index, state.outcome.name + ': ' + sb.fixed(timeOf(trial), 1) + ' ms',
                  ...varied.map(other => sb.pathWord(other.path) + ': ' + said(other, trial))
                ].join('\n');
              })
          .on('mouseout', () => {
            tip.style.display = 'none';
          });
      waiting = waiting.then(sb.painted).then(() => panel.isConnected && draw());
    });
  }
  draw();
  return section;
}

// A column of the table of trials.
const number = (name, value, text) => ({name, value, text, kind: ''});
const slipColumns = sensor =>
    [...[['first_micro_s', 'micro-slip, s'], ['first_full_s', 'full slip, s'], ['gross_s', 'gross slip, s']].map(
         ([key, name]) =>
             number(name, trial => summaryOf(trial, sensor)[key], trial => sb.fixed(summaryOf(trial, sensor)[key], 3))),
     number(
         'incipient, ms', trial => summaryOf(trial, sensor).incipient_s,
         trial => sb.fixed(summaryOf(trial, sensor).incipient_s === null ? null : summaryOf(trial, sensor).incipient_s * 1e3, 1)),
     number(
         'gross, share', trial => summaryOf(trial, sensor).shares.strict[3],
         trial => sb.percent(summaryOf(trial, sensor).shares.strict[3])),
     number(
         'paper differs', trial => summaryOf(trial, sensor).disagreement.paper,
         trial => sb.percent(summaryOf(trial, sensor).disagreement.paper)),
];
const graspColumns = () => {
  const of = (name, value, digits) =>
      number(name, ({grasp}) => grasp && value(grasp), ({grasp}) => sb.fixed(grasp ? value(grasp) : null, digits));
  const scaled = (value, factor) => value === null ? null : value * factor;
  return [
    Object.assign(
        number('grasp', ({grasp}) => grasp && grasp.dropped, ({grasp}) => grasp ? (grasp.dropped ? 'dropped' : 'held') : '–'),
        {kind: 'text'}),
    of('slipped, mm', grasp => scaled(grasp.slip_m, 1e3), 2),
    of('turned, °', grasp => scaled(grasp.rotation_rad, 180 / Math.PI), 2),
    of('largest force, N', grasp => grasp.max_force_N, 2),
    of('ideal force, N', grasp => grasp.ideal_force_N, 2),
    of('reaction, ms', grasp => scaled(grasp.reaction_s, 1e3), 0),
  ];
};

const detectorColumns = [
  Object.assign(
      number('detector', ({detector}) => detector && detector.detection, ({detector}) => detector ? detector.detection.replace('_', ' ') : '–'),
      {kind: 'text'}),
  number('delay, ms', ({detector}) => detector && detector.delay_s, ({detector}) => sb.fixed(detector && detector.delay_s !== null ? 1e3 * detector.delay_s : null, 1)),
];

// All trials; sortable, and opened from here. `sensor`: none where only outcomes were recorded.
function table(sensor, open) {
  const columns = [
    number('trial', trial => trial.index, trial => String(trial.index)),
    ...varied.map(axis => ({
                    name: label(axis),
                    value: trial => endless(axis, trial) ? Infinity : valueOf(trial, axis.path),
                    text: trial => {
                      const value = valueOf(trial, axis.path);
                      return endless(axis, trial) ? sb.endless(axis.unit) :
                          value === null          ? '–' :
                          axis.numeric            ? sb.significant(value * sb.factor(axis.unit), 3) :
                                                    String(value);
                    },
                    kind: axis.numeric ? '' : 'text'
                  })),
    ...(page.trials.some(trial => trial.grasp) ? graspColumns() : []),
    ...(page.trials.some(trial => trial.detector) ? detectorColumns : []),
    ...(sensor ? slipColumns(sensor) : []),
  ];
  const rowOf = trial =>
           el('tr', {},
              el('td.text', {},
                 sb.isEmbedded(trial.index) ?
                     el('button.link', {onclick: () => open(trial.index)}, 'open') :
                     trial.samples ?
                     el('button.link',
                        {title: sb.reportCommand(trial), onclick: event => sb.copy(event.target, sb.reportCommand(trial))},
                        'copy command') :
                     null),
              columns.map(column => el('td.' + column.kind, {}, column.text(trial))));
  const body = el('tbody');
  let order = page.trials;
  // Rows are made as they come into view: thousands would keep the page's first picture waiting.
  const fill = count => {
    for (const trial of order.slice(body.children.length, count)) body.append(rowOf(trial));
  };
  const step = 100;
  const heads = columns.map(column => el('th.' + column.kind, {}, el('button', {onclick: () => sort(column)}, column.name)));
  let sorted = {column: columns[0], down: false};
  function sort(column) {
    sorted = {column, down: sorted.column === column && !sorted.down};
    heads.forEach((head, i) => {
      if (columns[i] === column)
        head.setAttribute('aria-sort', sorted.down ? 'descending' : 'ascending');
      else
        head.removeAttribute('aria-sort');
    });
    const compare = (a, b) => {
      const [p, q] = [column.value(a), column.value(b)];
      if (p === q) return a.index - b.index;
      if (p === null) return 1;  // missing values last, whichever way
      if (q === null) return -1;
      return (p < q ? -1 : 1) * (sorted.down ? -1 : 1);
    };
    order = page.trials.slice().sort(compare);
    body.replaceChildren();
    fill(step);
  }
  sb.pointAtRow = index => {
    const place = order.findIndex(trial => trial.index === index);
    fill(place + step);
    for (const row of body.children) row.classList.remove('current');
    body.children[place].classList.add('current');
    body.children[place].scrollIntoView({block: 'center', behavior: 'smooth'});
  };
  const scroller = el('div.scroll.tall', {
    tabindex: 0,
    role: 'region',
    'aria-label': 'All trials',
    onscroll: () => {
      if (scroller.scrollTop + 2 * scroller.clientHeight > scroller.scrollHeight) fill(body.children.length + step);
    }
  },
                      el('table', {}, el('thead', {}, el('tr', {}, el('th'), heads)), body));
  fill(step);
  window.addEventListener('beforeprint', () => fill(order.length));
  const embedded = page.trials.filter(trial => sb.isEmbedded(trial.index)).length;
  return el(
      'section', {}, el('h2', {}, 'Trials'),
      el('p.note', {}, 'Click a heading to sort. ',
         embedded === page.trials.length ?
             'All trials can be opened here.' :
             !sensor ?
             [
               'Only outcomes were recorded; ', el('code', {}, sb.replayCommand(page.trials[0])),
               ' runs a trial again with its recording.'
             ] :
             [
               'The curves of ' + embedded + ' of ' + page.trials.length + ' trials are in this page; for another one run ',
               el('code', {}, 'slipbench report ' + page.file + ' --trial K'), '.'
             ],
         ' ',
         Object.assign(
             sb.saveButtons({
               title: () => 'Trials',
               rows: () => [columns.map(column => column.name), ...order.map(trial => columns.map(column => column.text(trial)))]
             }),
             {className: 'save plain'})),
      scroller);
}

sb.reportCommand = trial => 'slipbench report ' + page.file + ' --trial ' + trial.index;

// `open(index)`: called to open an embedded trial.
sb.showDataset = (host, open) => {
  const sensors = Object.keys(page.trials[0].sensors);
  const draw = sensor => {
    host.replaceChildren(
        sensors.length < 2 ?
            '' :
            el('div.controls', {},
               el('label', {}, 'sensor',
                  el('select', {onchange: event => draw(event.target.value)},
                     sensors.map(name => el('option', {value: name, selected: name === sensor ? '' : null}, name))))),
        swept(), ...sb.graspSections(page.trials, open),
        ...(sensor ? [el('div.two', {}, balance(sensor), durations(sensor))] : []), ...sb.detectorSections(page.trials),
        ...(sensor ? [scatter(sensor, open)] : []), table(sensor, open),
        ...(page.grasp_parameters ? [sb.graspParameters()] : []));
  };
  draw(sensors[0]);
};
})(window.slipbench);
