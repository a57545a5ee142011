// The overview of a dataset with several trials.
const el = sb.element, mark = sb.mark, text = sb.text;
const page = sb.page;

// Possible vertical axes: durations in seconds.
const outcomes = [
  {key: 'first_micro_s', name: 'first micro-slip', timed: true},
  {key: 'first_full_s', name: 'first full slip', timed: true},
  {key: 'gross_s', name: 'gross slip', timed: true},
  {key: 'incipient_s', name: 'incipient phase', timed: false},
];
const preferred = ['motion.speed', 'friction.static', 'friction.scale', 'motion.compression', 'motion.rotation'];
const gradient = ['#3b1c6e', '#2f5f8f', '#1f9489', '#6cbf57', '#e8c82e'];

// Derived from the drawn values: whether a trial slides, turns, or both.
const kind = {path: 'kind of motion', unit: '', numeric: false};
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
// True if positive values span enough for a logarithmic axis. Angles never do.
const wide = ([low, high], factor, unit) => unit !== 'rad' && low > 0 && high / low >= factor;
const label = axis => sb.pathWord(axis.path) + (axis.unit ? ', ' + sb.symbol(axis.unit) : '');
// An infinite value means "never" or "no limit".
const endless = (axis, trial) => axis.numeric && axis.path in trial.params && trial.params[axis.path].value === null;
const plain = (axis, value) => value === null ? '–' : axis.numeric ? sb.quantity(value, axis.unit, 3) : String(value);
const said = (axis, trial) => endless(axis, trial) ? sb.endless(axis.unit) : plain(axis, valueOf(trial, axis.path));

sb.sweptValues = {varied, valueOf, endless, label, plain, wide};

function swept() {
  const constant = page.axes.filter(axis => !axis.varied);
  const rows = varied.map(axis => {
    const values = page.trials.map(trial => valueOf(trial, axis.path)).filter(value => value !== null);
    const distinct = [...new Set(values)];
    if (axis.numeric) distinct.sort(d3.ascending);
    const ends = [distinct[0], distinct[distinct.length - 1]];
    const grid = distinct.length <= 24 && distinct.length < Math.max(3, values.length * 0.6);
    const span = axis.numeric && distinct.length && ends.map(value => plain(axis, value)).join(' to ');
    const texts = grid && distinct.length <= 8 ? distinct.map(value => plain(axis, value)) :
                                                 [(grid || !span) && distinct.length + ' values', span];
    const beyond = page.trials.some(trial => endless(axis, trial)) && sb.endless(axis.unit);
    const ticks = axis.numeric && values.length > 0 && dots(axis, values, wide(ends, 8, axis.unit));
    return [
      el('td.text', {title: axis.path}, el('b', {}, sb.pathWord(axis.path))), el('td.text', {}, grid ? 'grid' : 'drawn'),
      el('td.text', {style: 'white-space:normal'}, [...texts, beyond].filter(part => part).join(', ')), el('td.text', {}, ticks)
    ];
  });
  const same = constant.map(axis => sb.pathWord(axis.path) + ' ' + sb.parameter(page.trials[0].params[axis.path])).join(', ');
  return sb.section(
      'Swept parameters',
      [
        rows.length ? 'One tick per trial; the scale is logarithmic if the values span a factor of eight or more.' :
                      'The trials differ only in their seeds.',
        same && ' Equal in all trials: ' + same + '.'
      ],
      rows.length > 0 && el('table.swept', {}, el('tbody', {}, rows.map(cells => el('tr', {}, cells)))));
}

// One tick per value along a line.
function dots(axis, values, logarithmic) {
  const [low, high] = d3.extent(values);
  const scale = sb.scale(logarithmic, [low, high > low ? high : low + 1], [6, 154]);
  // Ticks at the same position are one mark with their combined opacity.
  const places = d3.rollups(values, same => same.length, value => scale(value).toFixed(0));
  const through = values.length > 40 ? 0.75 : 0.4;
  const said = sb.pathWord(axis.path) + ' of the trials, ' + plain(axis, low) + ' to ' + plain(axis, high);
  return mark(
      'svg', {width: 160, height: 18, role: 'img', 'aria-label': said}, mark('path', {d: 'M6,15H154', stroke: 'var(--line)'}),
      places.map(
          ([place, count]) =>
              mark('path', {d: 'M' + place + ',4V15', stroke: 'var(--accent)', 'stroke-opacity': 1 - through ** count})));
}

// Share of all samples in each state by each rule.
function balance(sensor) {
  const total = sb.rules.map(rule => [0, 1, 2, 3].map(state => {
    const weights = page.trials.map(trial => trial.samples);
    return d3.sum(page.trials, (trial, i) => trial.sensors[sensor].shares[rule.key][state] * weights[i]) / d3.sum(weights);
  }));
  const width = 640, left = 52, bar = 22, pitch = 46;
  const row = (shares, rule) => {
    const y = rule * pitch, name = {x: left - 8, y: y + bar / 2 + 4, 'text-anchor': 'end', style: 'fill:var(--ink)'};
    let end = left;
    return [mark('text', name, sb.rules[rule].name), shares.map((share, state) => {
      const {key, name: word} = sb.states.pad[state], span = Math.max(0, share * (width - left)), x = end;
      const look = {fill: sb.stateFill(key), 'fill-opacity': key === 'detached' ? 0.45 : 1, stroke: 'var(--ground)'};
      end += span;
      return [
        mark('rect', {x, y, width: span, height: bar, ...look}),
        span > 30 && text(x + span / 2, y + bar + 13, 'middle', (span > 92 ? word + ' ' : '') + sb.percent(share))
      ];
    })];
  };
  const svg = mark(
      'svg', {viewBox: [0, 0, width, sb.rules.length * pitch].join(' '), role: 'img', 'aria-label': 'Class balance by rule'},
      total.map(row));
  const host = el('div.balance', {}, svg);
  sb.saveCorner(host, 'Class balance', () => svg, () => [
    ['rule', ...sb.states.pad.map(state => state.name)], ...total.map((shares, rule) => [sb.rules[rule].name, ...shares])
  ]);
  return sb.section(
      'Class balance',
      'Share of the recorded time in each state. ' + sb.rules.map(rule => rule.name + ': ' + rule.note).join('; ') + '.',
      sb.stateLegend(sb.states.pad), el('div', {style: 'height:8px'}), host);
}

// Number of trials by the length of their incipient phase.
function durations(sensor) {
  // null: never; a phase of 0 s counts.
  const values = page.trials.map(trial => trial.sensors[sensor].incipient_s).filter(value => value !== null);
  const never = page.trials.filter(trial => trial.sensors[sensor].gross_s === null).length;
  const section = sb.section(
      'Duration of the incipient phase',
      'From the first micro-slip to gross slip. ' +
          (never ? never + ' of ' + page.trials.length + ' trials do not reach gross slip.' : 'All trials reach gross slip.'));
  if (values.length < 2) return section;
  const [low, high] = d3.extent(values).map(value => value * 1e3);
  const logarithmic = wide([low, high], 8);
  const ends = high > low ? [low * 0.98, high * 1.02] : padded([low, high], false);
  const host = el('div.panels', {style: 'display:block'});
  section.append(host);
  const box = {width: 640, height: 170, left: 40, right: 10, top: 8, bottom: 36};
  const x = axisOf('incipient phase, ms', logarithmic, ends, [box.left, box.width - box.right]);
  const count = Math.min(24, Math.max(6, Math.round(Math.sqrt(values.length) * 1.6)));
  const edges = d3.range(count + 1).map(i => x.scale.invert(box.left + (box.width - box.left - box.right) * i / count));
  const bins = d3.bin().domain(d3.extent(edges)).thresholds(edges.slice(1, -1))(values.map(value => value * 1e3));
  const most = d3.max(bins, bin => bin.length);
  const y = axisOf('trials', false, [0, most], [box.height - box.bottom, box.top], Math.min(most, 5));
  const svg = sb.axes(box, {...x, bare: true}, y, {role: 'img', 'aria-label': 'trials against incipient phase, ms'});
  svg.append(...bins.map(bin => mark('rect', {
    x: x.scale(bin.x0) + 0.5, width: Math.max(1, x.scale(bin.x1) - x.scale(bin.x0) - 1), y: y.scale(bin.length),
    height: y.scale(0) - y.scale(bin.length), fill: 'url(#hatch)'
  })));
  host.append(svg);
  sb.saveCorner(host, 'Length of the incipient phase', () => svg,
                () => [['from [ms]', 'to [ms]', 'trials'], ...bins.map(bin => [bin.x0, bin.x1, bin.length])]);
  return section;
}

// An axis of numbers for sb.axes. `round`: approximate number of ticks, with ends at ticks.
function axisOf(title, logarithmic, domain, range, round) {
  const scale = sb.scale(logarithmic, domain, range);
  if (round) scale.nice(round);
  // The tick at zero may have a rounding error.
  const text = tick => sb.significant(!logarithmic && Math.abs(tick) < 1e-9 * (domain[1] - domain[0]) ? 0 : tick, 4);
  const ticks = round ? scale.ticks(round) : sb.ticks(scale, logarithmic ? 26 : 50);
  return {title: title + (logarithmic ? ' (log)' : ''), scale, ticks, text};
}
sb.axisOf = axisOf;

// A point in a legend.
sb.dot = (fill, shape, words) =>
    sb.key('-11 -7 22 14', mark('path', {d: sb.markPath(shape, 4.4), style: 'fill:' + fill}), words);

// Colour and shape of points by one parameter, and the legend.
function encoding(path) {
  const axis = colourable.find(one => one.path === path);
  if (!axis) return {colour: () => 'var(--accent)', shape: () => 0, legend: []};
  const values = [...new Set(page.trials.map(trial => valueOf(trial, path)))].filter(value => value !== null);
  if (!axis.numeric) {
    const at = trial => Math.max(0, values.indexOf(valueOf(trial, path)));
    return {
      colour: trial => sb.hue(at(trial)),
      shape: at,
      legend: values.map((value, i) => sb.dot(sb.hue(i), i, String(value)))
    };
  }
  values.sort((a, b) => a - b);
  const range = [values[0], values[values.length - 1]];
  const position = sb.scale(wide(range, 8, axis.unit), range[0] === range[1] ? [range[0], range[0] + 1] : range, [0, 1]);
  const ramp = d3.scaleLinear(d3.range(gradient.length).map(i => i / (gradient.length - 1)), gradient);
  const colour = value => ramp(position(value));
  const samples = values.length <= 8 ? values : d3.range(5).map(i => position.invert(i / 4));
  // Infinite values are not on the colour scale; they have their own colour and shape.
  const star = 4,
        beyond = page.trials.some(trial => endless(axis, trial)) ? [sb.dot('var(--ink)', star, sb.endless(axis.unit))] : [];
  return {
    colour: trial => endless(axis, trial) ? 'var(--ink)' :
        valueOf(trial, path) === null     ? 'var(--faint)' :
                                            colour(valueOf(trial, path)),
    shape: trial => endless(axis, trial) ? star : 0,
    legend: [...samples.map(value => sb.dot(colour(value), 0, plain(axis, value))), ...beyond]
  };
}

// A range with a margin. Values that differ only by rounding are equal.
const padded = ([low, high], logarithmic) => {
  if (logarithmic) return [low / 1.25, high * 1.25];
  const apart = high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high));
  const gap = apart ? 0.06 * (high - low) : Math.abs(high) * 0.1 || 1;
  return [low - gap, high + gap];
};

// Positions of trials along an axis from `begin` to `end` [px]. Infinite values on any axis, and
// zero on a logarithmic one, have positions of their own, right and left of the others, with a
// label below.
function placesAlong(axis, happened, begin, end) {
  const shown = trial => sb.rounded(valueOf(trial, axis.path), axis.unit) * sb.factor(axis.unit);
  const finite = trials => trials.filter(trial => valueOf(trial, axis.path) !== null).map(shown);
  // If only infinite values remain, the other trials define the axis.
  const values = finite(happened).length ? finite(happened) : finite(page.trials);
  const beyond = happened.some(trial => endless(axis, trial));
  const others = values.filter(value => value !== 0);
  const zeros = others.length < values.length && wide(d3.extent(others), 8, axis.unit);
  const range = d3.extent(zeros ? others : values), logarithmic = wide(range, 8, axis.unit);
  const x = axisOf(label(axis), logarithmic, padded(range, logarithmic), [begin + (zeros ? 26 : 0), end - (beyond ? 48 : 0)]);
  const zeroAt = begin + 13, beyondAt = end - 22;
  return {
    x,
    shown: trial => endless(axis, trial) ? sb.endless(axis.unit) : shown(trial),
    place: trial => endless(axis, trial) ? beyondAt : zeros && shown(trial) === 0 ? zeroAt : x.scale(shown(trial)),
    words: [zeros && [zeroAt, '0'], beyond && [beyondAt, sb.endless(axis.unit)]].filter(word => word)
  };
}

// One chart: times(trial) [ms], called `name`, against one axis. Returns a function that draws its
// points.
function scatterPicture(host, axis, happened, {name, times, logarithmic, encoded, open}) {
  const box = {width: 400, height: 270, left: 58, right: 12, top: 10, bottom: 40}, foot = box.height - box.bottom;
  const {x, shown, place, words} = placesAlong(axis, happened, box.left, box.width - box.right);
  const y = axisOf(name + ', ms', logarithmic, padded(d3.extent(happened, times), logarithmic), [foot, box.top]);
  const svg = sb.axes(box, {...x, bare: true}, y, {role: 'img', 'aria-label': y.title + ' against ' + x.title});
  svg.append(...words.map(([at, word]) => text(at, foot + 16, 'middle', word)));
  const panel = el('div', {}, svg);
  host.append(panel);
  const drawn = happened.filter(trial => endless(axis, trial) || valueOf(trial, axis.path) !== null);
  sb.saveCorner(panel, name + ' against ' + sb.pathWord(axis.path), () => svg, () => [
    ['trial', label(axis), name + ' [ms]'], ...drawn.map(trial => [trial.index, shown(trial), times(trial)])
  ]);
  const lines = trial => [
    'trial ' + trial.index, name + ': ' + sb.fixed(times(trial), 1) + ' ms',
    ...varied.map(other => sb.pathWord(other.path) + ': ' + said(other, trial))
  ];
  const point = trial => mark('path.point', {
    transform: 'translate(' + place(trial) + ',' + y.scale(times(trial)) + ')',
    d: sb.markPath(encoded.shape(trial), 3.9),
    style: 'fill:' + encoded.colour(trial) + ';fill-opacity:.85',
    onclick: () => sb.isEmbedded(trial.index) ? open(trial.index) : sb.pointAtRow(trial.index),
    ...sb.tipped(() => lines(trial))
  });
  return () => panel.isConnected && svg.append(...drawn.map(point));
}

// Times against the swept parameters.
function scatter(sensor, open) {
  const numeric = varied.filter(axis => axis.numeric);
  const heading = el('h2', {}, 'Times of slip');
  if (!numeric.length) return el('section', {}, heading, el('p.note', {}, 'No numeric parameter was swept.'));
  const rank = axis => preferred.includes(axis.path) ? preferred.indexOf(axis.path) : preferred.length;
  const axes = numeric.slice().sort((a, b) => rank(a) - rank(b)).slice(0, 6);
  const started = page.trials.every(trial => trial.motion_start_s !== null);
  const state = {
    outcome: outcomes[1],
    relative: started,
    colour: (colourable.find(axis => !axis.numeric) || axes[1] || axes[0]).path
  };
  const choose = (name, options, value, change) => sb.choose(name, options, value, key => {
    change(key);
    draw();
  });
  const origins = [['motion', 'the start of the motion'], ['trial', 'the start of the trial']];
  const colours = [['', 'none'], ...colourable.map(axis => [axis.path, sb.pathWord(axis.path)])];
  const controls = el(
      'div.controls', {},
      choose('time of', outcomes.map(outcome => [outcome.key, outcome.name]), state.outcome.key,
             key => state.outcome = outcomes.find(outcome => outcome.key === key)),
      started && choose('counted from', origins, 'motion', key => state.relative = key === 'motion'),
      choose('colour', colours, state.colour, key => state.colour = key));
  const note = el('p.note'), legend = el('div.legend'), host = el('div.panels');
  const times = trial => {
    const time = trial.sensors[sensor][state.outcome.key];
    if (time === null) return null;
    return 1e3 * sb.rounded(state.outcome.timed && state.relative ? time - trial.motion_start_s : time, 's');
  };
  function draw() {
    const encoded = encoding(state.colour);
    legend.replaceChildren(...encoded.legend);
    const happened = page.trials.filter(trial => times(trial) !== null);
    const never = page.trials.length - happened.length;
    note.textContent = 'One point per trial. ' +
        (never ? never + ' of ' + page.trials.length + ' trials do not reach this state and are not shown. ' : '') +
        'Hover for its values, click to open it.';
    host.replaceChildren();
    if (!happened.length) return;
    const how = {name: state.outcome.name, times, logarithmic: wide(d3.extent(happened, times), 12), encoded, open};
    // Thousands of points: axes are drawn at once, the points of each chart in a frame of their
    // own.
    let waiting = Promise.resolve();
    for (const points of axes.map(axis => scatterPicture(host, axis, happened, how)))
      waiting = waiting.then(sb.painted).then(points);
  }
  draw();
  return el('section', {}, heading, note, controls, legend, host);
}

// Columns of the table of trials; number() handles missing values.
const number = (title, value, decimals, factor = 1) => {
  const scaled = trial => (value(trial) ?? null) === null ? null : factor * value(trial);
  return {title, value: scaled, cell: trial => sb.fixed(scaled(trial), decimals)};
};
const word = (title, value, cell) => ({title, kind: 'text', value, cell});
const slipColumns = sensor => {
  const of = trial => trial.sensors[sensor];
  const share = (title, value) => ({title, value, cell: trial => sb.percent(value(trial))});
  return [
    number('micro-slip, s', trial => of(trial).first_micro_s, 3), number('full slip, s', trial => of(trial).first_full_s, 3),
    number('gross slip, s', trial => of(trial).gross_s, 3), number('incipient, ms', trial => of(trial).incipient_s, 1, 1e3),
    share('gross, share', trial => of(trial).shares.strict[3]), share('paper differs', trial => of(trial).disagreement.paper)
  ];
};
const graspColumns = [
  word('grasp', ({grasp}) => grasp && sb.graspEnd(grasp), ({grasp}) => grasp ? sb.graspEnd(grasp) : '–'),
  number('slip, mm', ({grasp}) => grasp?.slip_m, 2, 1e3),
  number('rotation, °', ({grasp}) => grasp?.rotation_rad, 2, 180 / Math.PI),
  number('max. force, N', ({grasp}) => grasp?.max_force_N, 2),
  number('ideal force, N', ({grasp}) => grasp?.ideal_force_N, 2), number('reaction, ms', ({grasp}) => grasp?.reaction_s, 0, 1e3)
];
const detectorColumns = [
  word('detector', ({detector}) => detector?.detection, ({detector}) => detector ? detector.detection.replace('seen', 'detected').replace('_', ' ') : '–'),
  number('delay, ms', ({detector}) => detector?.delay_s, 1, 1e3)
];

// Table of all trials; sortable, with buttons to open them. `sensor`: undefined if only outcomes
// were recorded.
function table(sensor, open) {
  const cell = (axis, trial) => {
    const value = valueOf(trial, axis.path);
    if (endless(axis, trial)) return sb.endless(axis.unit);
    const held = sb.rounded(value, axis.unit);
    return axis.numeric && value !== null ? sb.significant(held * sb.factor(axis.unit), 3) : String(value ?? '–');
  };
  const columns = [
    {title: 'trial', value: trial => trial.index, cell: trial => String(trial.index)},
    ...varied.map(axis => ({
                    title: label(axis),
                    kind: axis.numeric ? '' : 'text',
                    value: trial => endless(axis, trial) ? Infinity : valueOf(trial, axis.path),
                    cell: trial => cell(axis, trial)
                  })),
    ...page.trials.some(trial => trial.grasp) ? graspColumns : [],
    ...page.trials.some(trial => trial.detector) ? detectorColumns : [], ...sensor ? slipColumns(sensor) : []
  ];
  // Rows are created as they scroll into view: thousands would delay the first paint.
  const step = 100;
  const rows = sb.sortedTable([{title: '', kind: 'text', cell: trial => sb.opener(trial, open, 'copy command')}, ...columns],
                              page.trials, undefined, step);
  const body = rows.node.tBodies[0];
  sb.pointAtRow = index => {
    const place = rows.order().findIndex(trial => trial.index === index);
    rows.fill(place + step);
    for (const row of body.children) row.classList.remove('current');
    body.children[place].classList.add('current');
    body.children[place].scrollIntoView({block: 'center', behavior: 'smooth'});
  };
  const more = ({target: {scrollTop, clientHeight, scrollHeight}}) => {
    if (scrollTop + 2 * clientHeight > scrollHeight) rows.fill(body.children.length + step);
  };
  const scroller = el('div.scroll.tall', {tabindex: 0, role: 'region', 'aria-label': 'All trials', onscroll: more}, rows.node);
  window.addEventListener('beforeprint', () => rows.fill(page.trials.length));
  const embedded = page.trials.filter(trial => sb.isEmbedded(trial.index)).length;
  const others = sensor ?
      [
        'This page contains the curves of ' + embedded + ' of ' + page.trials.length + ' trials; for another trial run ',
        el('code', {}, 'slipbench report ' + page.file + ' --trial K'), '.'
      ] :
      [
        'Only outcomes were recorded; ', el('code', {}, sb.replayCommand(page.trials[0])),
        ' repeats a trial with its recording.'
      ];
  const save = sb.saveButtons('Trials', null, () => [
    columns.map(({title}) => title), ...rows.order().map(trial => columns.map(({cell: shown}) => shown(trial)))
  ]);
  save.classList.add('plain');
  return sb.section(
      'Trials',
      ['Click a heading to sort. ', embedded === page.trials.length ? 'All trials can be opened here.' : others, ' ', save],
      scroller);
}

sb.reportCommand = trial => 'slipbench report ' + page.file + ' --trial ' + trial.index;
// Button that opens a trial, or copies the command of its report, or nothing.
sb.opener = (trial, open, words) => {
  if (sb.isEmbedded(trial.index)) return el('button.link', {onclick: () => open(trial.index)}, 'open');
  const command = sb.reportCommand(trial);
  return trial.samples > 0 && el('button.link', {title: command, onclick: event => sb.copy(event.target, command)}, words);
};

// `open(index)` opens an embedded trial.
sb.showDataset = (host, open) => {
  const sensors = Object.keys(page.trials[0].sensors);
  const draw = sensor => {
    const parts = [
      sensors.length > 1 && el('div.controls', {}, sb.choose('sensor', sensors.map(name => [name, name]), sensor, draw)),
      swept(), ...sb.graspSections(page.trials, open), sensor && el('div.two', {}, balance(sensor), durations(sensor)),
      ...sb.detectorSections(page.trials), sensor && scatter(sensor, open), table(sensor, open),
      page.grasp_parameters && sb.graspParameters()
    ];
    host.replaceChildren(...parts.filter(part => part));
  };
  draw(sensors[0]);
};
