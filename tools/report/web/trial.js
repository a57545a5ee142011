// The page of one trial.
const el = sb.element, mark = sb.mark;

function keyFigures(trial, summary) {
  const after = value => value === null || trial.motion_start_s === null ?
      '' :
      sb.milliseconds(value - trial.motion_start_s) + ' after motion start';
  const instant = (name, key) => [name, sb.seconds(summary[key]), after(summary[key])];
  return sb.figures([
    ['First touch', sb.seconds(summary.first_touch_s)], instant('First micro-slip', 'first_micro_s'),
    instant('First full slip', 'first_full_s'), instant('Gross slip', 'gross_s'),
    ['Incipient phase', sb.milliseconds(summary.incipient_s), 'first micro-slip to gross slip'],
    ['Longest slip', sb.quantity(summary.max_slip_m, 'm'), 'slip distance of one ' + sb.unitWord(summary.type)],
    ...trial.detector ? [sb.detectionFigure(trial.detector)] : []
  ]);
}

// Slider, play button and readings below the pad.
function player(timeline) {
  const seek = event => {
    timeline.play(false);
    timeline.setCursor(timeline.time[+event.target.value]);
  };
  const slider =
      el('input', {type: 'range', min: 0, max: timeline.time.length - 1, step: 1, 'aria-label': 'Time', oninput: seek});
  const button = el('button.button', {onclick: () => timeline.play(!timeline.playing)}, 'Play');
  const shown = el('span.time');
  const rates = [[1, 'real time'], [0.25, '¼ of real time'], [0.05, '1/20 of real time']];
  const speed = sb.select({'aria-label': 'Playing speed'}, rates, timeline.rate, value => {
    timeline.rate = +value;
    timeline.tell('playing');
  });
  timeline.addEventListener('playing', () => {
    button.textContent = timeline.playing ? 'Pause' : 'Play';
    speed.value = String(timeline.rate);
  });
  const update = sample => {
    slider.value = String(sample);
    shown.textContent = sb.fixed(timeline.time[sample], 3) + ' s';
  };
  return {
    node: el('div', {}, el('div.player', {}, button, slider, shown),
             el('div.controls', {}, speed, el('span', {}, '← → one sample, ⇧ twenty samples, space: play'))),
    update
  };
}

// Values at the cursor: [name, value(...)]. Returns {node, update(...)}.
sb.readout = entries => {
  const fields = entries.map(([name, value]) => ({name, value, field: el('dd')}));
  return {
    node: el('dl.readout', {}, fields.map(({name, field}) => el('div', {}, el('dt', {}, name), field))),
    update(...at) {
      for (const {value, field} of fields) field.textContent = value(...at);
    }
  };
};

function readout(recording) {
  const label = (key, sample, component = 0) => recording.at('labels/' + key, 0, component, sample);
  // Half of the quantisation step of a curve; errors of `units` units add up in their sum.
  const half = (key, units = 1) => 0.5 * units * (recording.curves['labels/' + key].data.step || 0);
  const state = key => [key === 'seen' ? 'detected' : key, sample => sb.states.pad[recording.padStates[key][sample]].name];
  const force = (component, sample) =>
      d3.sum(d3.range(recording.units), unit => recording.at('labels/force', unit, component, sample));
  // A centre more than a metre away from a pad of centimetres means translation.
  const centre = ([x, y]) => isNaN(x) ? '–' :
      Math.hypot(x, y) > 1 ? 'none: translation' :
                             [x, y].map(value => sb.fixed(value * 1e3, 1)).join(', ') + ' mm';
  return sb.readout([
    ...[...sb.rules.map(rule => rule.key), 'seen'].filter(key => recording.padStates[key]).map(state),
    ['stuck fraction', at => sb.percent(isNaN(label('stuck_fraction', at)) ? null : label('stuck_fraction', at))],
    ['slip speed', at => sb.quantity(label('pad_speed', at, 1), 'm/s', 3, half('slip_velocity'))],
    ['slip direction', at => sb.quantity(label('slip_direction', at), 'rad', 3, half('slip_direction'))],
    ['slip angle', at => sb.quantity(label('slip_angle', at), 'rad', 3, half('slip_angle'))],
    ['slip centre', at => centre([0, 1].map(component => label('slip_centre', at, component)))],
    ['normal force', at => sb.quantity(force(2, at), 'N', 3, half('force', recording.units))],
    ['tangential force', at => sb.quantity(Math.hypot(force(0, at), force(1, at)), 'N', 3, half('force', recording.units))]
  ]);
}

// Charts of the sensor as a whole.
function wholeSensor(trial, recording, timeline) {
  const onsets_s = [...recording.micro_onset_s, ...recording.onset_s].filter(t => t !== null);
  const zoom = (text, from, to) =>
      el('button', {onclick: () => timeline.setWindow(Math.max(timeline.full[0], from), Math.min(timeline.full[1], to))}, text);
  const [first, last] = d3.extent(onsets_s);
  const gap = 0.25 * Math.max(last - first, 0.004);
  const seen = recording.padRuns.seen, word = sb.unitWord(recording.type), words = sb.unitWords(recording.type);
  const host = el('div');
  const section = sb.section(
      'The sensor as a whole', 'Hover for values, drag to zoom all charts, double-click to see the whole trial.',
      onsets_s.length > 0 &&
          el('div.controls', {},
             el('div.segments', {role: 'group', 'aria-label': 'Zoom'}, zoom('whole trial', ...timeline.full),
                zoom('onset of slip', first - gap, last + gap))),
      sb.chartTitle('State by rule', seen && 'detected: class in the loop, from the detector ' + sb.detectorName(trial.detector.type)),
      sb.stateLegend(sb.states.pad), host);
  const chart = (key, name, note, colours, range) => {
    const {columns, components: labels, unit} = recording.curves[key];
    section.append(sb.chartTitle(name, note));
    new sb.LineChart(section, timeline, {
      name: name.split(',')[0], rows: recording.curveTime, columns, labels, unit, colours, range, solid: true,
      height: 120, bands: recording.padRuns.strict
    });
  };
  const draw = () => {
    const rows = sb.rules.map(rule => ({name: rule.name, runs: recording.padRuns[rule.key], kinds: sb.states.pad}));
    new sb.StateRows(
        host, timeline, seen ? [{name: 'detected', runs: seen, kinds: sb.states.pad}, ...rows] : rows, 20, 'State by rule');
    const order = shownUnits(recording), others = recording.units - order.length;
    section.append(sb.chartTitle('State of each ' + word), sb.stateLegend(sb.states.unit));
    if (others)
      section.append(el('p.note', {}, others + ' of the ' + recording.units + ' ' + words + ' never touch and are not shown.'));
    new sb.StateRows(
        section, timeline,
        order.map(unit => ({name: sb.unitName(recording.type, unit), runs: recording.unitRuns[unit], kinds: sb.states.unit})),
        Math.max(2, Math.min(16, Math.floor(400 / Math.max(1, order.length)))), 'State of each ' + word);
    chart(
        'labels/pad_speed', 'Slip speed, mm/s', 'mean over touching ' + words + ' (dark) and the fastest (red)',
        ['slip', 'fz']);
    chart('labels/stuck_fraction', 'Stuck fraction', 'share of touching friction points that stick', ['stick'], [0, 1.05]);
  };
  return {section, draw};
}

// Units by first micro-slip, then by full slip; units without slip last, in their own order.
function onsetOrder(recording) {
  const by = onsets_s => (a, b) => d3.ascending(onsets_s[a] ?? Infinity, onsets_s[b] ?? Infinity);
  return d3.range(recording.units).sort((a, b) => by(recording.micro_onset_s)(a, b) || by(recording.onset_s)(a, b) || a - b);
}

// Units with a row of their own: all, or of more than 40 those that touch.
function shownUnits(recording) {
  const order = onsetOrder(recording);
  return recording.units > 40 ? order.filter(unit => recording.touch_s[unit] !== null) : order;
}

// The unit to show first: the first to slip, else the first to touch.
function openingUnit(recording) {
  const first = onsetOrder(recording)[0];
  if (recording.micro_onset_s[first] !== null || recording.onset_s[first] !== null) return first;
  const touched = d3.range(recording.units).filter(unit => recording.touch_s[unit] !== null);
  return touched.sort((a, b) => recording.touch_s[a] - recording.touch_s[b])[0] || 0;
}

const labelNames = {
  'labels/force': 'True force',
  'labels/slip_speed': 'Slip speed',
  'labels/slip_distance': 'Slipped distance',
  'labels/margin': 'Margin'
};
const componentColours = ['fx', 'fy', 'fz'];

// Unit indices in rows and columns as drawn on the pad; null if they do not form a small grid.
function gridOf(recording) {
  const {right, up} = sb.padView(recording.type);
  const unique = axis => [...new Set(recording.positions.map(p => Math.round(p[axis] * 1e5)))];
  const rows = unique(up).sort((a, b) => b - a), columns = unique(right).sort((a, b) => a - b);
  if (rows.length * columns.length > 20 || rows.length * columns.length > 2 * recording.units) return null;
  return {
    columns: columns.length,
    place: unit => ({
      row: rows.indexOf(Math.round(recording.positions[unit][up] * 1e5)) + 1,
      column: columns.indexOf(Math.round(recording.positions[unit][right] * 1e5)) + 1
    })
  };
}

// Curves of each unit, laid out like the pad, or of one unit.
class UnitCharts {
  constructor(recording, timeline) {
    Object.assign(this, {recording, timeline, readings: [], charts: [], legend: el('div'), host: el('div')});
    const per_unit =
        Object.keys(recording.curves).filter(key => recording.curves[key].per_unit && key !== 'labels/slip_velocity');
    // Channels of the sensor come first.
    const rank = key => Object.keys(labelNames).indexOf(key);
    this.name = key => labelNames[key] || sb.channelWord(recording.type, key.split('/')[1]).name;
    this.keys = per_unit.sort((a, b) => rank(a) - rank(b));
    this.key = this.keys[0];
    this.grid = gridOf(recording);
    this.unit = this.grid ? null : openingUnit(recording);
    const word = sb.unitWord(recording.type), words = sb.unitWords(recording.type);
    const segments = sb.segments('Quantity', this.keys.map(key => [key, this.name(key)]), this.key, key => {
      this.key = key;
      this.draw();
    });
    const units = d3.range(recording.units).map(unit => [unit, sb.unitName(recording.type, unit)]);
    const choices = this.grid ? [['', 'all, laid out like the pad'], ...units] : units;
    this.select =
        sb.select({'aria-label': 'Shown ' + words}, choices, this.unit ?? '', value => this.show(value === '' ? null : +value));
    this.section = sb.section(
        'Each ' + word,
        'Background: state of the sensor by the strict rule (blue non-slip, amber incipient, red gross). ' +
            'Strip below the curves: state of the ' + word + ' itself. All ' + words + ' share one scale.',
        el('div.controls', {}, segments, el('label', {}, 'show', this.select), this.legend), this.host);
    timeline.addEventListener('cursor', () => this.read());
  }

  show(unit) {
    this.unit = unit;
    this.select.value = unit ?? '';
    this.draw();
  }

  draw() {
    const {recording, timeline, key} = this;
    const curve = recording.curves[key], {components} = curve;
    const colours = components.length === 1 ? ['fz'] : components.map((_, i) => componentColours[i % 3]);
    const entries = components.map((name, i) => ({name, colour: colours[i], dashed: i === 1}));
    this.legend.replaceChildren(components.length > 1 ? sb.legendOf(entries) : '');
    for (const chart of this.charts) chart.release();
    this.host.replaceChildren();
    this.readings = [];
    this.charts = [];
    const range = sb.rangeOf(curve.columns, curve.unit);
    const units = this.unit === null ? d3.range(recording.units) : [this.unit];
    const grid = el(
        'div.grid', {style: this.unit === null ? 'grid-template-columns:repeat(' + this.grid.columns + ',minmax(0,1fr))' : ''});
    this.host.append(grid);
    for (const unit of units) {
      const values = el('span.values');
      const toggle = () => this.grid && this.show(this.unit === null ? unit : null);
      const name =
          el('button.link', {title: 'show only this one, or all', onclick: toggle}, sb.unitName(recording.type, unit));
      const place = this.unit === null && this.grid.place(unit);
      const style = place ? 'grid-row:' + place.row + ';grid-column:' + place.column : null;
      const cell = el('div.cell', {style}, el('header', {}, name, values));
      grid.append(cell);
      this.readings.push({unit, values, colours});
      this.charts.push(new sb.LineChart(cell, timeline, {
        name: this.name(key) + ' of ' + sb.unitName(recording.type, unit), rows: recording.curveTime,
        columns: recording.columns(key, unit), labels: curve.components, unit: curve.unit, colours, range,
        height: this.unit === null ? 150 : 340, bands: recording.padRuns.strict, strip: recording.unitRuns[unit]
      }));
    }
    this.read();
  }

  // Values at the cursor, in the colours of their curves.
  read() {
    const {recording, key, timeline} = this;
    const curve = recording.curves[key];
    const sample = recording.sampleAt(timeline.cursor);
    const factor = sb.factor(curve.unit);
    for (const {unit, values, colours} of this.readings) {
      const value = c => sb.fixed(recording.at(key, unit, c, sample) * factor, 2) + ' ';
      values.replaceChildren(
          ...curve.components.map((_, c) => el('b', {style: 'color:var(--' + colours[c] + ')'}, value(c))),
          sb.symbol(curve.unit));
    }
  }
}

// Order of the units' slip, as a table with one bar per unit.
function onsets(recording, timeline) {
  const word = sb.unitWord(recording.type);
  const times = [...recording.micro_onset_s, ...recording.onset_s].filter(t => t !== null);
  const first = Math.min(...times), last = Math.max(...times);
  const scale = d3.scaleLinear([first, Math.max(last, first + 1e-4)], [8, 152]);
  const bar = ({micro, full}) => mark(
      'svg', {
        width: 160, height: 16, role: 'img',
        'aria-label': 'First micro-slip ' + sb.seconds(micro) + ', full slip ' + sb.seconds(full)
      },
      mark('path', {d: 'M8,8H152', stroke: 'var(--grid)'}),
      micro !== null &&
          [
            mark('path', {
              d: 'M' + scale(micro) + ',8H' + (full === null ? 152 : scale(full)), stroke: 'var(--partial)',
              'stroke-width': 4
            }),
            mark('circle', {cx: scale(micro), cy: 8, r: 4, fill: 'var(--ground)', stroke: 'var(--partial)', 'stroke-width': 2})
          ],
      full !== null && mark('circle', {cx: scale(full), cy: 8, r: 4.5, fill: 'var(--slip)'}));
  const rows = shownUnits(recording).map((unit, i) => ({
                                           place: String(i + 1), unit, touch: recording.touch_s[unit],
                                           micro: recording.micro_onset_s[unit], full: recording.onset_s[unit],
                                           margin: el('td')
                                         }));
  const columns = [
    {title: '', cell: ({place}) => place}, {title: word, kind: 'text', cell: ({unit}) => sb.unitName(recording.type, unit)},
    {title: 'touch', cell: ({touch}) => sb.seconds(touch)}, {title: 'first micro-slip', cell: ({micro}) => sb.seconds(micro)},
    {title: 'full slip', cell: ({full}) => sb.seconds(full)},
    {title: 'after the first, ms', cell: ({micro}) => micro === null ? '–' : '+' + sb.fixed((micro - first) * 1e3, 1)}, {
      title: 'partial for, ms',
      cell: ({micro, full}) => micro === null || full === null ? '–' : sb.fixed((full - micro) * 1e3, 1)
    },
    {title: times.length ? sb.fixed(first, 3) + ' s to ' + sb.fixed(last, 3) + ' s' : '', kind: 'text', cell: bar},
    {title: 'margin', cell: ({margin}) => margin}
  ];
  const section = sb.section(
      'Onset order',
      times.length === 0 ? 'Nothing slips in this trial.' :
                           'From the first micro-slip of each ' + word +
              ' (hollow mark) to its full slip (filled mark). Margin: 1 − f_t / (μ_s f_n) at the cursor.',
      el('div.scroll.tall', {}, sb.sortedTable(columns, rows).node));
  const update = sample => {
    for (const {unit, margin} of rows) margin.textContent = sb.fixed(recording.at('labels/margin', unit, 0, sample), 3);
  };
  return {section, update};
}

// Share of time in each state by each rule, and differences of the rules.
function rules(summary) {
  const columns = [
    {title: 'rule', kind: 'text', cell: rule => el('b', {}, rule.name)}, {title: '', kind: 'text', cell: rule => rule.note},
    ...sb.states.pad.map((state, i) => ({title: state.name, cell: rule => sb.percent(summary.shares[rule.key][i])})),
    {title: 'differs from strict', cell: ({key}) => key === 'strict' ? '–' : sb.percent(summary.disagreement[key])}
  ];
  return sb.section(
      'Truth against other rules',
      'The rule of the paper differs from the strict truth in ' + sb.percent(summary.disagreement.paper) +
          ' of the time in contact.',
      sb.table(columns, sb.rules));
}

// The sensor to show first: the detector's, else the first in contact.
sb.openingSensor = trial => {
  const names = Object.keys(trial.sensors);
  if (trial.detector && names.includes(trial.detector.sensor)) return trial.detector.sensor;
  return names.find(name => trial.sensors[name].first_touch_s !== null) || names[0];
};

// Draws one sensor's data of a trial into `host`. Returns the timeline, for the keyboard.
sb.showTrial = async (host, index, sensorName) => {
  const trial = sb.page.trials.find(candidate => candidate.index === index);
  const recording = await sb.recording(index, sensorName);
  const summary = {type: recording.type, ...trial.sensors[recording.name]};
  const timeline = new sb.Timeline(recording.time);
  const held = trial.grasp ? await sb.graspOf(index) : null;
  const grasp = held && sb.graspSection(trial, held, recording, timeline, player);

  const charts = new UnitCharts(recording, timeline);
  const card = el('div.pad-card');
  const side = el('div.side', {}, card);
  const pad = new sb.Pad(card, recording, unit => charts.show(unit));
  const controls = player(timeline);
  const readings = readout(recording);
  const word = sb.unitWord(recording.type);
  card.append(controls.node, readings.node);
  side.append(
      sb.stateLegend(sb.states.unit),
      el('p.note', {},
         'The pad ' + sb.padView(recording.type).note + '. ' +
             (pad.labels ? 'Above each ' + word + ': its name' + (pad.roomy ? ' and normal force. ' : '; under the pointer: its normal force. ') : '') +
             (pad.picture && pad.picture.note ? pad.picture.note + ' ' : '') + 'Arrows: true tangential force of the object on the ' + word +
             ' (solid) and slip velocity of its tip (dashed). ⊕ marks the slip centre where it lies within the picture.'));
  const whole = wholeSensor(trial, recording, timeline);
  const channels = sb.channelSection(recording, timeline);
  const onset = onsets(recording, timeline);
  const skin = sb.page.skins?.[index]?.sensors.includes(recording.name) ? sb.skinSection(recording, sb.page.skins[index]) : null;
  const thinned = recording.stride === 1 ?
      null :
      el('p.note', {}, 'The curves show one sample in ' + recording.stride + '. States and onsets are complete.');
  const parts = [
    thinned, whole.section, skin?.section, channels?.section, charts.section, onset.section, rules(summary),
    recording.padRuns.seen && sb.detectorSection([trial]), grasp && sb.graspParameters()
  ];
  host.replaceChildren(
      ...grasp ? [...grasp.nodes, el('h2', {}, 'The sensor ' + recording.name)] : [], keyFigures(trial, summary),
      el('div.layout', {}, side, el('div', {}, parts)));
  const update = () => {
    const sample = recording.sampleAt(timeline.cursor);
    for (const part of [controls, readings, pad, onset, skin, grasp]) part?.update(sample);
  };
  timeline.addEventListener('cursor', update);
  // Opens at the most informative time: when half of the slipping units have slipped.
  const middle = (timeline.full[0] + timeline.full[1]) / 2;
  timeline.cursor = grasp?.opens_s ?? d3.median(recording.onset_s.filter(t => t !== null)) ?? summary.first_micro_s ?? middle;
  timeline.tell('cursor');
  // The first chart is visible while the others are drawn.
  for (const part of [grasp, whole, channels, charts]) {
    await sb.painted();
    if (!host.isConnected) break;  // another trial was opened meanwhile
    part?.draw();
  }
  return timeline;
};
