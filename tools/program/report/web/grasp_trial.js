// What the page of a trial shows of a grasp: how it ended, the view in space, force, position, height and slip over time.
(function(sb) {
'use strict';
const el = sb.element;

// Curves and poses of a grasp, unpacked.
class GraspRecording {
  static async load(payload) {
    const grasp = new GraspRecording();
    Object.assign(grasp, payload);
    grasp.time = (await sb.unpack(payload.time))[0];
    grasp.curveTime = grasp.time.filter((_, i) => i % payload.stride === 0);
    grasp.poseTime = grasp.time.filter((_, i) => i % payload.poses.stride === 0);
    for (const curve of Object.values(payload.curves)) curve.columns = await sb.unpack(curve.data);
    grasp.bodies = {};
    for (const body of payload.poses.bodies) {
      grasp.bodies[body.name] = {size: body.size, position: await sb.unpack(body.position), turn: await sb.unpack(body.turn)};
    }
    // The pads that carry: the sensor's, then that of the other finger.
    const others = ['arm', 'table', 'box', 'second_pad'];
    grasp.pads = [...Object.keys(grasp.bodies).filter(name => !others.includes(name)), 'second_pad'];
    return grasp;
  }

  size(name) {
    return this.bodies[name].size;
  }
  highest(name) {
    return d3.max(this.bodies[name].position[2]);
  }
  // Of a curve at or just before a time.
  valueAt(key, t, component) {
    const curve = this.curves[key];
    return curve && curve.columns[component || 0][Math.max(0, d3.bisectRight(this.curveTime, t + 1e-9) - 1)];
  }
  // Poses of all bodies {name: {position, turn}} at a time, between two that are stored in a straight line.
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
// The grasp of a trial; null where it is none.
sb.graspOf = async index => {
  const {grasp} = await sb.recorded(index);
  if (!grasp) return null;
  loaded[index] = loaded[index] || GraspRecording.load(grasp);
  return loaded[index];
};

// How the grasp ended, in figures.
function outcomeFigures(trial, grasp, recording) {
  const {grasp: ended} = trial;
  const figure = (name, value, note, kind) =>
      el('div', {}, el('div.k', {}, name), el('div.v' + (kind ? '.' + kind : ''), {}, value), el('div.s', {}, note || ''));
  const states = recording.padStates.strict;
  const slip_s = recording.time.find((t, sample) => t >= grasp.lift_s && states[sample] > 1);
  const early = trial.detector && trial.detector.detection === 'early';
  const reaction = ended.reaction_s === null ? (early ? 'does not apply: alarm before the slip' : slip_s === undefined ? 'no slip in the lift' : 'it slips, and the drive does not close') :
      ended.dropped && slip_s + ended.reaction_s >= ended.drop_s ? 'true slip to the drive’s closing: after the drop' :
                                                                   'true slip to the drive’s closing';
  const ratio = force => ended.ideal_force_N === null ? '' : sb.fixed(force / ended.ideal_force_N, 2) + ' × ideal';
  return el(
      'div.figures', {},
      ended.dropped ? figure('Outcome', 'dropped', 'at ' + sb.seconds(ended.drop_s), 'bad') :
                      figure('Outcome', 'held', 'to the trial’s end', 'good'),
      figure('Slip of the box', sb.quantity(ended.slip_m, 'm'), ended.dropped ? 'does not apply: dropped' : 'in the arm’s frame, since the lift began'),
      figure('Turn of the box', sb.quantity(ended.rotation_rad, 'rad'), ended.dropped ? 'does not apply: dropped' : 'likewise'),
      figure('Largest grip force', sb.quantity(ended.max_force_N, 'N'), ratio(ended.max_force_N)),
      figure('Final grip force', sb.quantity(ended.final_force_N, 'N'), ended.dropped ? '' : ratio(ended.final_force_N)),
      figure('Ideal grip force', ended.ideal_force_N === null ? 'none holds' : sb.quantity(ended.ideal_force_N, 'N'), 'm g / (2 μ_s), the least that holds'),
      figure('Reaction', sb.milliseconds(ended.reaction_s), reaction),
      figure('Controller', grasp.controller || 'none', 'on ' + (grasp.detector ? sb.detectorName(grasp.detector) : 'no detector'), 'name'));
}

// Numbers at the cursor.
function readings(trial, grasp) {
  const fields = {};
  const node = el('dl.readout', {}, [
    ['phase', 'phase'], ['force', 'grip force'], ['height', 'height'], ['share', 'force / ideal'], ['slip', 'slip'], ['position', 'position'],
    ['turn', 'turn'], ['command', 'commanded']
  ].map(([key, name]) => {
    fields[key] = el('dd');
    return el('div', {}, el('dt', {}, name), fields[key]);
  }));
  const {ideal_force_N: ideal, dropped, drop_s} = trial.grasp;
  const update = t => {
    const force = grasp.valueAt('grip_force', t), at = (key, component) => grasp.valueAt(key, t, component);
    fields.phase.textContent = dropped && t >= drop_s ? 'dropped' : t < grasp.lift_s ? 'taking the box' : 'lifting, holding';
    fields.force.textContent = sb.quantity(force, 'N');
    fields.share.textContent = ideal === null ? sb.quantity(null) : sb.fixed(force / ideal, 2);
    fields.height.textContent = sb.fixed(1e3 * at('height'), 1) + ' mm';
    fields.slip.textContent = isNaN(at('slip')) ? '–' : sb.fixed(1e3 * at('slip'), 2) + ' mm';
    fields.turn.textContent = isNaN(at('rotation')) ? '–' : sb.fixed(180 / Math.PI * at('rotation'), 2) + '°';
    fields.command.textContent = sb.fixed(at('position', 0), 0);
    fields.position.textContent = sb.fixed(at('position', 1), 0) + ' counts';
  };
  return {node, update};
}

function charts(trial, grasp, recording, timeline) {
  const {ideal_force_N: ideal, max_force_N: most, dropped, drop_s} = trial.grasp;
  const marks = [{time: grasp.lift_s, text: 'lift begins'}];
  if (dropped) marks.push({time: drop_s, text: 'dropped', colour: 'slip'});
  // With room above the highest value.
  const rangeOf = curve => {
    const [low, high] = d3.extent(curve.columns.flatMap(column => Array.from(column).filter(isFinite)));
    return [Math.min(0, 1.1 * low), 1.1 * Math.max(high, 1e-4)];
  };
  const host = el('div');
  const draw = () => {
    const title = (name, note) => el('div.chart-title', {}, el('span', {}, el('b', {}, name), ' ', note || ''));
    const chart = (key, name, note, colours, options) => {
      const curve = grasp.curves[key];
      if (!curve) return;
      host.append(title(name, note));
      new sb.LineChart(host, timeline, Object.assign({
        name: name.split(',')[0],
        rows: grasp.curveTime,
        columns: curve.columns,
        labels: curve.components,
        unit: curve.unit,
        colours,
        range: rangeOf(curve),
        height: 112,
        bands: recording.padRuns.strict,
        strip: null,
        marks: host.querySelector('.chart') ? marks.map(mark => ({...mark, text: ''})) : marks
      },
                                                     options));
    };
    if (grasp.curves.grip_force) {
      const force = grasp.curves.grip_force.columns[0];
      const peak = grasp.curveTime[force.indexOf(d3.max(force))];
      chart(
          'grip_force', 'Grip force, N', 'true mean of both pads; dashed: the ideal force, m g / (2 μ_s)', ['fz'], {
            range: [0, 1.15 * Math.max(most, ideal || 0)],
            height: 150,
            lines: ideal === null ? [] : [{value: ideal, text: 'ideal ' + sb.quantity(ideal, 'N'), colour: 'accent'}],
            points: [{time: peak, value: d3.max(force), text: 'max ' + sb.quantity(most, 'N')}]
          });
      const [commanded, measured] = grasp.curves.position.columns;
      const span = d3.extent([...commanded, ...measured]);
      chart('position', 'Position register, counts', 'measured (solid) and commanded (dashed); more is closer', ['fz', 'accent'], {
        columns: [measured, commanded],
        labels: ['measured', 'commanded'],
        range: [span[0] - 2, span[1] + 2],
        step: true
      });
    }
    chart('height', 'Height of the box, mm', 'its middle, over where it stood (solid), and of the arm (dashed)', ['fx', 'soft'], {});
    chart('slip', 'Slip of the box, mm', 'its middle in the arm’s frame since the lift began, give of pads and fingers included', ['slip'], {});
    chart('rotation', 'Turn of the box, °', 'likewise', ['fy'], {height: 80});
    const seen = recording.padRuns.seen;
    host.append(
        title('State of the contact', seen && grasp.detector ? 'seen: what the loop saw of the detector ' + sb.detectorName(grasp.detector) : ''),
        sb.stateLegend(sb.states.pad));
    const rows = [{name: 'truth', runs: recording.padRuns.strict, kinds: sb.states.pad}];
    if (seen && grasp.detector) rows.unshift({name: 'seen', runs: seen, kinds: sb.states.pad});
    new sb.StateRows(host, timeline, rows, 20, 'State of the contact');
  };
  return {node: host, draw};
}

// The section of a grasp: {nodes, draw(), update(sample)}, and where the page opens [s]. `player`: of the trial's page.
sb.graspSection = (trial, grasp, recording, timeline, player) => {
  timeline.rate = 1;
  const card = el('div.pad-card');
  const view = new sb.GraspView(card, grasp, recording, timeline);
  const controls = player(timeline);
  const numbers = readings(trial, grasp);
  const zoom = el('div.segments', {role: 'group', 'aria-label': 'Picture'}, [['whole', false], ['pads', true]].map(
      ([text, close]) => el('button', {
        'aria-pressed': String(!close),
        onclick: event => {
          view.zoom(close);
          for (const button of zoom.children) button.setAttribute('aria-pressed', String(button === event.target));
        }
      }, text)));
  card.append(el('div.controls', {}, zoom, el('span', {}, 'drag to turn it')), controls.node, numbers.node);
  const pictures = charts(trial, grasp, recording, timeline);
  const section = el(
      'section', {}, el('h2', {}, 'The grasp'),
      el('div.layout.grasp', {},
         el('div.side', {}, card, sb.stateLegend(sb.states.unit),
            el('p.note', {},
               'Colours: state of the sensor’s ' + sb.unitWords(recording.type) + ', behind the finger that is drawn clear. Dashed blue: where the ' +
                   'box would be if it had not slipped since the lift began. Grid of the table: 50 mm. Only the pads’ and the box’s places and sizes are ' +
                   'the model’s; fingers and palm are drawn for the eye.')),
         pictures.node));
  return {
    nodes: [outcomeFigures(trial, grasp, recording), section],
    draw: pictures.draw,
    opens_s: trial.grasp.dropped ? trial.grasp.drop_s : 0.5 * (grasp.lift_s + timeline.full[1]),
    update(sample) {
      controls.update(sample);
      numbers.update(timeline.cursor);
      view.draw();
    }
  };
};
})(window.slipbench);
