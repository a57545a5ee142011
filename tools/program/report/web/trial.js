// The page of one trial.
(function(sb) {
'use strict';
const el = sb.element;

function keyFigures(trial, summary) {
  const after = value => value === null || trial.motion_start_s === null ?
      '' :
      sb.milliseconds(value - trial.motion_start_s) + ' after motion start';
  const figure = (name, value, note) => el('div', {}, el('div.k', {}, name), el('div.v', {}, value), el('div.s', {}, note));
  return el(
      'div.figures', {}, figure('First touch', sb.seconds(summary.first_touch_s), ''),
      figure('First micro-slip', sb.seconds(summary.first_micro_s), after(summary.first_micro_s)),
      figure('First full slip', sb.seconds(summary.first_full_s), after(summary.first_full_s)),
      figure('Gross slip', sb.seconds(summary.gross_s), after(summary.gross_s)),
      figure('Incipient phase', sb.milliseconds(summary.incipient_s), 'first micro-slip to gross slip'),
      figure('Longest slip', sb.quantity(summary.max_slip_m, 'm'), 'path slipped by one ' + sb.unitWord(summary.type)),
      trial.detector ? figure(...sb.detectionFigure(trial.detector)) : null);
}

// Slider, play button and readings below the pad.
function player(timeline) {
  const slider = el('input', {
    type: 'range',
    min: 0,
    max: timeline.time.length - 1,
    step: 1,
    'aria-label': 'Time',
    oninput: event => {
      timeline.play(false);
      timeline.setCursor(timeline.time[+event.target.value]);
    }
  });
  const button = el('button.button', {onclick: () => timeline.play(!timeline.playing)}, 'Play');
  const shown = el('span.time');
  const speed =
      el('select', {
        'aria-label': 'Playing speed',
        onchange: event => {
          timeline.rate = +event.target.value;
          timeline.tell('playing');
        }
      },
         [[1, 'real time'], [0.25, '¼ of real time'], [0.05, '1/20 of real time']].map(
             ([value, text]) => el('option', {value}, text)));
  speed.value = String(timeline.rate);
  timeline.on('playing', () => {
    button.textContent = timeline.playing ? 'Pause' : 'Play';
    speed.value = String(timeline.rate);
  });
  const update = sample => {
    slider.value = String(sample);
    shown.textContent = sb.fixed(timeline.time[sample], 3) + ' s';
  };
  return {
    node:
        el('div', {}, el('div.player', {}, button, slider, shown),
           el('div.controls', {}, speed, el('span', {}, '← → one sample, with ⇧ twenty, space plays'))),
    update
  };
}

function readout(recording) {
  const fields = {};
  const node = el('dl.readout', {}, [
    ['strict', 'strict'], ['micro', 'micro'], ['paper', 'paper'], ...(recording.padStates.seen ? [['seen', 'seen']] : []), ['stuck', 'stuck fraction'], ['speed', 'slip speed'],
    ['direction', 'slip direction'], ['angle', 'slip angle'], ['centre', 'slip centre'], ['normal', 'normal force'],
    ['tangential', 'tangential force']
  ].map(([key, name]) => {
    fields[key] = el('dd');
    return el('div', {}, el('dt', {}, name), fields[key]);
  }));
  const update = sample => {
    const label = (key, component) => recording.at('labels/' + key, 0, component || 0, sample);
    for (const rule of sb.rules) fields[rule.key].textContent = sb.states.pad[recording.padStates[rule.key][sample]].name;
    if (fields.seen) fields.seen.textContent = sb.states.pad[recording.padStates.seen[sample]].name;
    fields.stuck.textContent = sb.percent(isNaN(label('stuck_fraction')) ? null : label('stuck_fraction'));
    fields.speed.textContent = sb.quantity(label('pad_speed', 1), 'm/s');
    fields.direction.textContent = sb.quantity(label('slip_direction'), 'rad');
    fields.angle.textContent = sb.quantity(label('slip_angle'), 'rad');
    const centre = [label('slip_centre', 0), label('slip_centre', 1)];
    // A pad of centimetres that turns about a point a metre off is dragged.
    fields.centre.textContent = isNaN(centre[0])         ? '–' :
        Math.hypot(...centre) > 1 ? 'none: translation' :
                                    centre.map(value => sb.fixed(value * 1e3, 1)).join(', ') + ' mm';
    const sum = [0, 0, 0];
    for (let unit = 0; unit < recording.units; ++unit) {
      for (let c = 0; c < 3; ++c) sum[c] += recording.at('labels/force', unit, c, sample) || 0;
    }
    fields.normal.textContent = sb.quantity(sum[2], 'N');
    fields.tangential.textContent = sb.quantity(Math.hypot(sum[0], sum[1]), 'N');
  };
  return {node, update};
}

// Sensor-wide charts.
function wholeSensor(trial, recording, timeline) {
  const onsets_s = [...recording.micro_onset_s, ...recording.onset_s].filter(t => t !== null);
  const zoom = (text, from, to) =>
      el('button', {onclick: () => timeline.setWindow(Math.max(timeline.full[0], from), Math.min(timeline.full[1], to))}, text);
  const [first, last] = d3.extent(onsets_s);
  const gap = 0.25 * Math.max(last - first, 0.004);
  const section =
      el('section', {}, el('h2', {}, 'The sensor as a whole'),
         el('p.note', {}, 'Hover to read, drag to zoom all charts together, double-click to see all of the trial.'),
         onsets_s.length ? el('div.controls', {},
                              el('div.segments', {role: 'group', 'aria-label': 'Zoom'}, zoom('whole trial', ...timeline.full),
                                 zoom('onset of slip', first - gap, last + gap))) :
                           null);
  const title = (name, note) => el('div.chart-title', {}, el('span', {}, el('b', {}, name), ' ', note || ''));
  const seen = recording.padRuns.seen;
  section.append(
      title('State by rule', seen ? 'seen: what the loop saw of the detector ' + sb.detectorName(trial.detector.type) : ''),
      sb.stateLegend(sb.states.pad));
  const host = el('div');
  section.append(host);
  return {
    section,
    draw() {
      const rows = sb.rules.map(rule => ({name: rule.name, runs: recording.padRuns[rule.key], kinds: sb.states.pad}));
      new sb.StateRows(host, timeline, seen ? [{name: 'seen', runs: seen, kinds: sb.states.pad}, ...rows] : rows, 20, 'State by rule');
      const word = sb.unitWord(recording.type);
      section.append(title('State of each ' + word, ''), sb.stateLegend(sb.states.unit));
      const order = shownUnits(recording);
      const others = recording.units - order.length;
      if (others) section.append(el('p.note', {}, others + ' of the ' + recording.units + ' ' + sb.unitWords(recording.type) + ' never touch and are not shown.'));
      new sb.StateRows(
          section, timeline,
          order.map(unit => ({name: sb.unitName(recording.type, unit), runs: recording.unitRuns[unit], kinds: sb.states.unit})),
          Math.max(2, Math.min(16, Math.floor(400 / Math.max(1, order.length)))), 'State of each ' + word);
      const chart = (key, name, note, colours, range) => {
        const curve = recording.curves[key];
        section.append(title(name, note));
        new sb.LineChart(section, timeline, {
          name: name.split(',')[0],
          rows: recording.curveTime,
          columns: curve.columns,
          labels: curve.components,
          unit: curve.unit,
          colours,
          range,
          solid: true,
          height: 120,
          bands: recording.padRuns.strict,
          strip: null
        });
      };
      chart(
          'labels/pad_speed', 'Slip speed, mm/s', 'mean over touching ' + sb.unitWords(recording.type) + ' (dark) and the fastest (red)', ['slip', 'fz'],
          null);
      chart('labels/stuck_fraction', 'Stuck fraction', 'share of touching friction points that stick', ['stick'], [0, 1.05]);
    }
  };
}

// Units by first micro-slip, then by full slip; those that never slip last, in their own order.
function onsetOrder(recording) {
  const key = unit => [recording.micro_onset_s[unit], recording.onset_s[unit]].map(t => t === null ? Infinity : t);
  return d3.range(recording.units).sort((a, b) => {
    const [p, q] = [key(a), key(b)];
    return (p[0] === q[0] ? 0 : p[0] - q[0]) || (p[1] === q[1] ? 0 : p[1] - q[1]) || a - b;
  });
}

// Those that have a row of their own: of more than 40 the ones that touch.
function shownUnits(recording) {
  const order = onsetOrder(recording);
  return recording.units > 40 ? order.filter(unit => recording.touch_s[unit] !== null) : order;
}

// The unit to look at first: it slips first, or else touches first.
function openingUnit(recording) {
  const first = onsetOrder(recording)[0];
  if (recording.micro_onset_s[first] !== null || recording.onset_s[first] !== null) return first;
  const touched = d3.range(recording.units).filter(unit => recording.touch_s[unit] !== null);
  return touched.length ? touched.sort((a, b) => recording.touch_s[a] - recording.touch_s[b])[0] : 0;
}

const labelNames = {
  'labels/force': 'True force',
  'labels/slip_speed': 'Slip speed',
  'labels/slip_distance': 'Slipped distance',
  'labels/margin': 'Margin'
};
const componentColours = ['fx', 'fy', 'fz'];

// Unit indices in rows and columns as the pad shows them; null when they do not form a small grid.
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
    this.recording = recording;
    this.timeline = timeline;
    const per_unit =
        Object.keys(recording.curves).filter(key => recording.curves[key].per_unit && key !== 'labels/slip_velocity');
    // What the sensor emits first.
    const rank = key => Object.keys(labelNames).indexOf(key);
    this.name = key => labelNames[key] || sb.channelWord(recording.type, key.split('/')[1]).name;
    this.keys = per_unit.sort((a, b) => rank(a) - rank(b));
    this.key = this.keys[0];
    this.grid = gridOf(recording);
    this.unit = this.grid ? null : openingUnit(recording);
    const word = sb.unitWord(recording.type);
    this.segments =
        el('div.segments', {role: 'group', 'aria-label': 'Quantity'},
           this.keys.map(
               key =>
                   el('button', {
                     'data-key': key,
                     onclick: () => {
                       this.key = key;
                       this.draw();
                     }
                   },
                      this.name(key))));
    this.select =
        el('select', {
          'aria-label': 'Shown ' + sb.unitWords(recording.type),
          onchange: event => {
            this.show(event.target.value === '' ? null : +event.target.value);
          }
        },
           this.grid ? el('option', {value: ''}, 'all, laid out like the pad') : null,
           d3.range(recording.units).map(unit => el('option', {value: unit}, sb.unitName(recording.type, unit))));
    this.select.value = this.unit === null ? '' : String(this.unit);
    this.legend = el('div.legend');
    this.host = el('div');
    this.section = el(
        'section', {}, el('h2', {}, 'Each ' + word),
        el('p.note', {},
           'Background: state of the sensor by the strict rule (blue non-slip, amber incipient, red gross). ' +
                'The strip below the curves: state of the ' +
               word + ' itself. All ' + sb.unitWords(recording.type) + ' share one scale.'),
        el('div.controls', {}, this.segments, el('label', {}, 'show', this.select), this.legend), this.host);
    this.readings = [];
    timeline.on('cursor', () => this.read());
  }

  show(unit) {
    this.unit = unit;
    this.select.value = unit === null ? '' : String(unit);
    this.draw();
  }

  range(curve) {
    let low = Infinity, high = -Infinity;
    for (const column of curve.columns) {
      for (const value of column) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    // Counts far from zero would be a flat line on an axis that begins there.
    const near = !(low > 0.5 * high);
    low = near ? Math.min(0, low) : low;
    high = Math.max(near ? 0 : low, high);
    const gap = 0.06 * (high - low || 1);
    return [low === 0 ? low : low - gap, high + gap];
  }

  draw() {
    const {recording, timeline, key} = this;
    const curve = recording.curves[key];
    for (const button of this.segments.children) button.setAttribute('aria-pressed', String(button.dataset.key === key));
    const colours = curve.components.length === 1 ? ['fz'] : curve.components.map((_, i) => componentColours[i % 3]);
    this.legend.replaceChildren(
        ...curve.components.length > 1 ?
            curve.components.map(
                (name, i) => el('span', {}, el('b', {style: 'color:var(--' + colours[i] + ')'}, i === 1 ? '╍╍' : '━━'), name)) :
            []);
    timeline.forget(this.charts || []);
    this.host.replaceChildren();
    this.readings = [];
    this.charts = [];
    const range = this.range(curve);
    const units = this.unit === null ? d3.range(recording.units) : [this.unit];
    const grid = el(
        'div.grid', {style: this.unit === null ? 'grid-template-columns:repeat(' + this.grid.columns + ',minmax(0,1fr))' : ''});
    this.host.append(grid);
    for (const unit of units) {
      const values = el('span.values');
      const name =
          el('button.link',
             {title: 'show this one alone, or all', onclick: () => this.grid && this.show(this.unit === null ? unit : null)},
             sb.unitName(recording.type, unit));
      const cell = el('div.cell', {}, el('header', {}, name, values));
      if (this.unit === null) {
        const place = this.grid.place(unit);
        cell.style.gridRow = place.row;
        cell.style.gridColumn = place.column;
      }
      grid.append(cell);
      this.readings.push({unit, values, colours});
      this.charts.push(new sb.LineChart(cell, timeline, {
        name: this.name(key) + ' of ' + sb.unitName(recording.type, unit),
        rows: recording.curveTime,
        columns: recording.columns(key, unit),
        labels: curve.components,
        unit: curve.unit,
        colours,
        range,
        height: this.unit === null ? 150 : 340,
        bands: recording.padRuns.strict,
        strip: recording.unitRuns[unit]
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
      values.replaceChildren(
          ...curve.components.map(
              (_, c) =>
                  el('b', {style: 'color:var(--' + colours[c] + ')'},
                     sb.fixed(recording.at(key, unit, c, sample) * factor, 2) + ' ')),
          sb.symbol(curve.unit));
    }
  }
}

// The order in which units let go, as a table with one bar a unit.
function onsets(recording, timeline) {
  const word = sb.unitWord(recording.type);
  const order = shownUnits(recording);
  const times = [...recording.micro_onset_s, ...recording.onset_s].filter(t => t !== null);
  const section =
      el('section', {}, el('h2', {}, 'Onset order'),
         el('p.note', {},
            times.length === 0 ? 'Nothing slips in this trial.' :
                                 'From the first micro-slip of each ' + word +
                    ' (hollow mark) to its full slip (filled mark). Margin: 1 − f_t / (μ_s f_n) at the cursor.'));
  const first = Math.min(...times), last = Math.max(...times);
  const scale = d3.scale.linear().domain([first, Math.max(last, first + 1e-4)]).range([8, 152]);
  const margins = [];
  const body = el('tbody', {}, order.map((unit, place) => {
    const [touch, micro, full] = [recording.touch_s[unit], recording.micro_onset_s[unit], recording.onset_s[unit]];
    const cell = el('td.text');
    const svg = d3.select(cell).append('svg').attr('width', 160).attr('height', 16).attr('role', 'img').attr(
        'aria-label', 'First micro-slip ' + sb.seconds(micro) + ', full slip ' + sb.seconds(full));
    svg.append('line').attr('x1', 8).attr('x2', 152).attr('y1', 8).attr('y2', 8).style('stroke', 'var(--grid)');
    if (micro !== null) {
      svg.append('line')
          .attr('x1', scale(micro))
          .attr('x2', full === null ? 152 : scale(full))
          .attr('y1', 8)
          .attr('y2', 8)
          .style('stroke', 'var(--partial)')
          .attr('stroke-width', 4);
      svg.append('circle')
          .attr('cx', scale(micro))
          .attr('cy', 8)
          .attr('r', 4)
          .style('fill', 'var(--ground)')
          .style('stroke', 'var(--partial)')
          .attr('stroke-width', 2);
    }
    if (full !== null) svg.append('circle').attr('cx', scale(full)).attr('cy', 8).attr('r', 4.5).style('fill', 'var(--slip)');
    const margin = el('td');
    margins.push({unit, margin});
    return el(
        'tr', {}, el('td', {}, String(place + 1)), el('td.text', {}, sb.unitName(recording.type, unit)),
        el('td', {}, sb.seconds(touch)), el('td', {}, sb.seconds(micro)), el('td', {}, sb.seconds(full)),
        el('td', {}, micro === null ? '–' : '+' + sb.fixed((micro - first) * 1e3, 1)),
        el('td', {}, micro === null || full === null ? '–' : sb.fixed((full - micro) * 1e3, 1)), cell, margin);
  }));
  const head = [
    ['', ''], [word, 'text'], ['touch', ''], ['first micro-slip', ''], ['full slip', ''], ['after the first, ms', ''],
    ['partial for, ms', ''], [times.length ? sb.fixed(first, 3) + ' s to ' + sb.fixed(last, 3) + ' s' : '', 'text'],
    ['margin', '']
  ];
  section.append(
      el('div.scroll.tall', {},
         el('table', {}, el('thead', {}, el('tr', {}, head.map(([text, kind]) => el('th.' + kind, {}, text)))), body)));
  const update = sample => {
    for (const {unit, margin} of margins) margin.textContent = sb.fixed(recording.at('labels/margin', unit, 0, sample), 3);
  };
  return {section, update};
}

// Share of time in each state by each rule, and how far the rules differ.
function rules(summary) {
  const rows = sb.rules.map(rule => {
    const differs = rule.key === 'strict' ? '–' : sb.percent(summary.disagreement[rule.key]);
    return el(
        'tr', {}, el('td.text', {}, el('b', {}, rule.name)), el('td.text', {}, rule.note),
        summary.shares[rule.key].map(share => el('td', {}, sb.percent(share))), el('td', {}, differs));
  });
  return el(
      'section', {}, el('h2', {}, 'Truth against other rules'),
      el('p.note', {},
         "The paper's rule labels this trial differently from the strict truth in " + sb.percent(summary.disagreement.paper) +
             ' of the time in contact.'),
      el('div.scroll', {},
         el('table', {},
            el('thead', {},
               el('tr', {},
                  [['rule', 'text'], ['', 'text'], ...sb.states.pad.map(state => [state.name, '']), ['differs from strict', '']]
                      .map(([text, kind]) => el('th.' + kind, {}, text)))),
            el('tbody', {}, rows))));
}

// The sensor to look at first: that of the detector, or else the first that touches.
sb.openingSensor = trial => {
  const names = Object.keys(trial.sensors);
  if (trial.detector && names.includes(trial.detector.sensor)) return trial.detector.sensor;
  return names.find(name => trial.sensors[name].first_touch_s !== null) || names[0];
};

// Draws what one sensor tells of a trial into `host`. Returns the timeline, for the keyboard.
sb.showTrial = async (host, index, sensorName) => {
  const trial = sb.page.trials.find(candidate => candidate.index === index);
  const recording = await sb.recording(index, sensorName);
  const summary = Object.assign({type: recording.type}, trial.sensors[recording.name]);
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
  const thinned = recording.stride === 1 ?
      null :
      el('p.note', {}, 'Curves show one sample in ' + recording.stride + '. States and onsets are complete.');
  host.replaceChildren(
      ...(grasp ? [...grasp.nodes, el('h2', {}, 'The sensor ' + recording.name)] : []), keyFigures(trial, summary),
      el('div.layout', {}, side, el('div', {}, thinned, whole.section, channels && channels.section, charts.section, onset.section, rules(summary),
                                              recording.padRuns.seen ? sb.detectorSection([trial]) : null,
                                              grasp ? sb.graspParameters() : null)));
  const update = () => {
    const sample = recording.sampleAt(timeline.cursor);
    for (const part of [controls, readings, pad, onset, ...(grasp ? [grasp] : [])]) part.update(sample);
  };
  timeline.on('cursor', update);
  // Opens where there is most to see: when half of the units that let go have done so.
  const onsets_s = recording.onset_s.filter(t => t !== null);
  timeline.cursor = grasp    ? grasp.opens_s :
      onsets_s.length        ? d3.median(onsets_s) :
      summary.first_micro_s !== null ? summary.first_micro_s :
                                       (timeline.full[0] + timeline.full[1]) / 2;
  timeline.tell('cursor');
  // The reader sees the first picture while the others are drawn.
  for (const draw of [() => grasp && grasp.draw(), () => whole.draw(), () => channels && channels.draw(), () => charts.draw()]) {
    await sb.painted();
    if (!host.isConnected) break;  // another trial has been opened meanwhile
    draw();
  }
  return timeline;
};
})(window.slipbench);
