// Grasp section of a trial's page: outcome, 3D view, force, position, height and slip over time.
const el = sb.element;

// Curves and poses of a grasp, unpacked.
class GraspRecording {
  static async load(payload) {
    const [time] = await sb.unpack(payload.time);
    const grasp = Object.assign(new GraspRecording(), payload, {time});
    grasp.curveTime = time.filter((_, i) => i % payload.stride === 0);
    grasp.poseTime = time.filter((_, i) => i % payload.poses.stride === 0);
    for (const curve of Object.values(payload.curves)) curve.columns = await sb.unpack(curve.data);
    grasp.bodies = {};
    for (const body of payload.poses.bodies) {
      grasp.bodies[body.name] = {size: body.size, position: await sb.unpack(body.position), turn: await sb.unpack(body.turn)};
    }
    // The pads that carry the box: the sensor's, then the other finger's.
    const others = ['arm', 'table', 'box', 'second_pad'];
    grasp.pads = [...Object.keys(grasp.bodies).filter(name => !others.includes(name)), 'second_pad'];
    return grasp;
  }

  // Value of a curve at or just before a time.
  valueAt(key, t, component = 0) {
    return this.curves[key]?.columns[component][sb.rowAt(this.curveTime, t)];
  }
  // Poses of all bodies {name: {position, turn}} at a time, linearly interpolated.
  poseAt(t) {
    const times = this.poseTime;
    const next = Math.min(times.length - 1, Math.max(1, d3.bisectRight(times, t)));
    const last = Math.max(0, next - 1);
    const share = next === last ? 0 : Math.min(1, Math.max(0, (t - times[last]) / (times[next] - times[last])));
    const poses = {};
    for (const [name, {position, turn}] of Object.entries(this.bodies)) {
      const between = columns => columns.map(column => column[last] + share * (column[next] - column[last]));
      const q = between(turn);
      poses[name] = {position: between(position), turn: q.map(c => c / Math.hypot(...q))};
    }
    return poses;
  }
}

const loaded = {};
// The grasp of a trial; null if it is not a grasp.
sb.graspOf = async index => {
  const {grasp} = await sb.recorded(index);
  if (!grasp) return null;
  return loaded[index] = loaded[index] || GraspRecording.load(grasp);
};

// Figures of the grasp's outcome.
function outcomeFigures(trial, grasp, recording) {
  const {grasp: ended} = trial;
  const states = recording.padStates.strict;
  const slip_s = recording.time.find((t, sample) => t >= grasp.lift_s && states[sample] > 1);
  const early = trial.detector?.detection === 'early';
  const closing = 'from true slip to closing of the fingers';
  const reaction = ended.reaction_s !== null ?
      closing + (ended.dropped && slip_s + ended.reaction_s >= ended.drop_s ? ': after the drop' : '') :
      early                ? 'not applicable: alarm before the slip' :
      slip_s === undefined ? 'no slip in the lift' :
                             'the fingers do not close on the slip';
  const ratio = force => ended.ideal_force_N === null ? '' : sb.fixed(force / ended.ideal_force_N, 2) + ' × ideal';
  const ideal = ended.ideal_force_N === null ? 'no force holds' : sb.quantity(ended.ideal_force_N, 'N');
  const end = sb.graspEnd(ended);
  const ifHeld = text => end === 'held' ? text : 'not applicable: ' + end;
  return sb.figures([
    end === 'dropped'    ? ['Outcome', end, 'at ' + sb.seconds(ended.drop_s), 'bad'] :
    end === 'not lifted' ? ['Outcome', end, 'the box stays on the table', 'bad'] :
                           ['Outcome', end, 'until the end of the trial', 'good'],
    ['Slip of the box', sb.quantity(ended.slip_m, 'm'), ifHeld('in the arm’s frame, since the lift began')],
    ['Rotation of the box', sb.quantity(ended.rotation_rad, 'rad'), ifHeld('in the arm’s frame, since the lift began')],
    ['Maximum grip force', sb.quantity(ended.max_force_N, 'N'), ratio(ended.max_force_N)],
    ['Final grip force', sb.quantity(ended.final_force_N, 'N'), end === 'held' ? ratio(ended.final_force_N) : ''],
    ['Ideal grip force', ideal, 'm g / (2 μ_s), the least force that holds'],
    ['Reaction', sb.milliseconds(ended.reaction_s), reaction],
    [
      'Controller', grasp.controller || 'none', 'on ' + (grasp.detector ? sb.detectorName(grasp.detector) : 'no detector'),
      'name'
    ]
  ]);
}

// Values at the cursor.
function readings(trial, grasp) {
  const {ideal_force_N: ideal, dropped, drop_s} = trial.grasp;
  const at = (key, t, component) => grasp.valueAt(key, t, component), force = t => at('grip_force', t);
  const known = (value, decimals, unit) => isNaN(value) ? sb.missing : sb.fixed(value, decimals) + unit;
  return sb.readout([
    ['phase', t => dropped && t >= drop_s ? 'dropped' : t < grasp.lift_s ? 'gripping the box' : 'lifting, holding'],
    ['grip force', t => sb.quantity(force(t), 'N')], ['height', t => sb.fixed(1e3 * at('height', t), 1) + ' mm'],
    ['force / ideal', t => ideal === null ? sb.missing : sb.fixed(force(t) / ideal, 2)],
    ['slip', t => known(1e3 * at('slip', t), 2, ' mm')], ['position', t => sb.fixed(at('position', t, 1), 0) + ' counts'],
    ['rotation', t => known(180 / Math.PI * at('rotation', t), 2, '°')], ['commanded', t => sb.fixed(at('position', t, 0), 0)]
  ]);
}

function charts(trial, grasp, recording, timeline) {
  const {ideal_force_N: ideal, max_force_N: most, dropped, drop_s} = trial.grasp;
  const marks = [{time: grasp.lift_s, text: 'lift begins'}];
  if (dropped) marks.push({time: drop_s, text: 'dropped', colour: 'slip'});
  const bands = recording.padRuns.strict, seen = grasp.detector && recording.padRuns.seen;
  const host = el('div');
  const chart = (key, name, note, colours, options) => {
    const curve = grasp.curves[key];
    if (!curve) return;
    const first = !host.querySelector('.chart');
    host.append(sb.chartTitle(name, note));
    new sb.LineChart(host, timeline, {
      name: name.split(',')[0], rows: grasp.curveTime, columns: curve.columns, labels: curve.components,
      unit: curve.unit, colours, height: 112, bands,
      marks: first ? marks : marks.map(mark => ({...mark, text: ''})), ...options
    });
  };
  const draw = () => {
    if (grasp.curves.grip_force) {
      const [force] = grasp.curves.grip_force.columns, largest = d3.max(force);
      chart('grip_force', 'Grip force, N', 'true mean of both pads; dashed: the ideal force, m g / (2 μ_s)', ['fz'], {
        range: [0, 1.15 * Math.max(most, ideal || 0)], height: 150,
        lines: ideal === null ? [] : [{value: ideal, text: 'ideal ' + sb.quantity(ideal, 'N'), colour: 'accent'}],
        points: [{time: grasp.curveTime[force.indexOf(largest)], value: largest, text: 'max ' + sb.quantity(most, 'N')}]
      });
      const [commanded, measured] = grasp.curves.position.columns;
      const span = d3.extent([...commanded, ...measured]);
      chart('position', 'Position register, counts', 'measured (solid) and commanded (dashed); higher is more closed', ['fz', 'accent'], {
        columns: [measured, commanded], labels: ['measured', 'commanded'], range: [span[0] - 2, span[1] + 2],
        step: true
      });
    }
    chart(
        'height', 'Height of the box, mm', 'middle of the box above its start (solid), and of the arm (dashed)', ['fx', 'soft']);
    const slip = 'middle of the box in the arm’s frame since the lift began, including the compliance of pads and fingers';
    chart('slip', 'Slip of the box, mm', slip, ['slip']);
    chart('rotation', 'Rotation of the box, °', 'in the arm’s frame since the lift began', ['fy'], {height: 80});
    const note = seen && 'detected: class in the loop, from the detector ' + sb.detectorName(grasp.detector);
    host.append(sb.chartTitle('State of the contact', note), sb.stateLegend(sb.states.pad));
    const rows =
        [...seen ? [['detected', seen]] : [], ['truth', bands]].map(([name, runs]) => ({name, runs, kinds: sb.states.pad}));
    new sb.StateRows(host, timeline, rows, 20, 'State of the contact');
  };
  return {node: host, draw};
}

// The section of a grasp: {nodes, draw(), update(sample)}, and the opening time [s]. `player`: of
// the trial's page.
sb.graspSection = (trial, grasp, recording, timeline, player) => {
  timeline.rate = 1;
  const card = el('div.pad-card');
  const view = new sb.GraspView(card, grasp, recording, timeline);
  const controls = player(timeline);
  const numbers = readings(trial, grasp);
  const zoom = sb.segments('Picture', [[false, 'whole'], [true, 'pads']], false, close => view.zoom(close));
  card.append(el('div.controls', {}, zoom, el('span', {}, 'drag to rotate')), controls.node, numbers.node);
  const pictures = charts(trial, grasp, recording, timeline);
  const section = sb.section(
      'The grasp', '',
      el('div.layout.grasp', {},
         el('div.side', {}, card, sb.stateLegend(sb.states.unit),
            el('p.note', {},
               'Colours: state of the sensor’s ' + sb.unitWords(recording.type) +
                   ', behind the transparent finger. Dashed blue: position of the ' +
                   'box if it had not slipped since the lift began. Grid of the table: 50 mm. Pads and box are drawn as simulated; ' +
                   'fingers and palm are only illustrations.')),
         pictures.node));
  const update = sample => {
    controls.update(sample);
    numbers.update(timeline.cursor);
    view.draw();
  };
  const opens_s = trial.grasp.dropped ? trial.grasp.drop_s : 0.5 * (grasp.lift_s + timeline.full[1]);
  return {nodes: [outcomeFigures(trial, grasp, recording), section], draw: pictures.draw, opens_s, update};
};
