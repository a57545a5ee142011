// Results of a sweep of grasps: shares with their intervals, medians, grouped by the swept
// parameters.
const el = sb.element;
const page = sb.page;

const negative = 'hold_preset';  // the controller that never tightens

// The exact 95 % interval of k of n (Clopper and Pearson), as in
// tools/statistics/descriptive.cc.
function upperTail(k, n, p) {
  let log = k * Math.log(p) + (n - k) * Math.log1p(-p);
  for (let i = 1; i <= k; ++i) log += Math.log((n - k + i) / i);
  let term = Math.exp(log), sum = 0;
  for (let i = k; i <= n && term > 1e-16 * sum; ++i) {
    sum += term;
    term *= (n - i) / (i + 1) * p / (1 - p);
  }
  return sum;
}
function lowerBound(k, n) {
  if (k === 0) return 0;
  if (k === n) return 0.025 ** (1 / n);
  let [low, high] = [0, k / n];
  for (let i = 0; i < 50; ++i) {
    const middle = (low + high) / 2;
    if (upperTail(k, n, middle) < 0.025)
      low = middle;
    else
      high = middle;
  }
  return low;
}
const interval = (k, n) => [lowerBound(k, n), 1 - lowerBound(n - k, n)];

const known = (trials, value) => trials.map(value).filter(found => found !== null && found !== undefined);
const ratioOf = ({grasp}) => grasp.ideal_force_N === null ? null : grasp.max_force_N / grasp.ideal_force_N;
const gentle = 2;  // limit of the largest grip force over the ideal one
const times = (value, factor) => value === null ? null : factor * value;
const slips = ['seen', 'early', 'missed'];
// A quantity of a set of trials: the share for which `good` is true (null: unknown), or the median
// of `one`.
const share = (key, name, good) => ({key, name, unit: '%', good});
const median = (key, name, unit, one) => ({key, name: 'median ' + name, unit, one});
const quantities = [
  share('held', 'share held', ({grasp}) => sb.graspEnd(grasp) === 'held'),
  share(
      'gentle', 'share held, force ≤ ' + gentle + ' × ideal',
      trial => ratioOf(trial) === null ? null : sb.graspEnd(trial.grasp) === 'held' && ratioOf(trial) <= gentle),
  median('slip', 'slip of held boxes', 'mm', ({grasp}) => times(grasp.slip_m, 1e3)),
  median('turn', 'rotation of held boxes', '°', ({grasp}) => times(grasp.rotation_rad, 180 / Math.PI)),
  median('ratio', 'of maximum/ideal force', '', ratioOf),
  median('reaction', 'reaction time', 'ms', ({grasp}) => times(grasp.reaction_s, 1e3)),
  median(
      'delay', 'delay of the detector', 'ms', ({detector}) => detector?.detection === 'seen' ? 1e3 * detector.delay_s : null),
  share(
      'seen', 'share of slips detected without an early alarm',
      ({detector}) => slips.includes(detector?.detection) ? detector.detection === 'seen' : null)
];
// Outcome of a box: held, dropped, or not lifted, which is neither.
sb.graspEnd = grasp => grasp.dropped ? 'dropped' : grasp.not_lifted ? 'not lifted' : 'held';
const ended = (trials, end) => trials.filter(({grasp}) => sb.graspEnd(grasp) === end).length;
const held = trials => ended(trials, 'held');
const medians = quantities.filter(quantity => quantity.one);
const medianHeads = ['slip, mm', 'turn, °', 'max./ideal force', 'reaction, ms', 'delay, ms'];
// Number of good trials, and of trials with a known result.
const countOf = (quantity, trials) => {
  const judged = known(trials, quantity.good);
  return [judged.filter(good => good).length, judged.length];
};
const valueIn = (quantity, trials) => {
  if (!quantity.good) return d3.median(known(trials, quantity.one)) ?? null;
  const [good, all] = countOf(quantity, trials);
  return all ? 100 * good / all : null;
};
// The interval of a share, or the quartiles around a median.
const rangeIn = (quantity, trials) => {
  if (quantity.good) return interval(...countOf(quantity, trials)).map(share => 100 * share);
  const values = known(trials, quantity.one).sort(d3.ascending);
  return [0.25, 0.75].map(share => d3.quantile(values, share));
};
const withUnit = (value, unit) => sb.significant(value, 3) + (value === null || !unit ? '' : unit === '°' ? '°' : ' ' + unit);
const heldText = trials => {
  const [low, high] = interval(held(trials), trials.length).map(share => sb.fixed(100 * share, 1));
  const others = ['dropped', 'not lifted'].filter(end => ended(trials, end)).map(end => ', ' + end + ' ' + ended(trials, end)).join('');
  return 'held ' + held(trials) + ' of ' + trials.length + ' (95 %: ' + low + ' to ' + high + ' %)' + others;
};
// Pooled counts of the trials with a detector; null without any.
const countsOf = trials => {
  const judged = trials.filter(trial => trial.detector);
  return judged.length ? sb.scores.pooled(judged) : null;
};
const balancedOf = trials => countsOf(trials) && sb.scores.balancedAccuracy(countsOf(trials));
const recallOf = trials => countsOf(trials) && sb.scores.recallOfSlip(countsOf(trials));
const earlyText = trials => {
  const {early, slipping} = sb.detections(trials);
  return slipping ? early + ' of ' + slipping : sb.missing;
};

// Parameters that distinguish the grasps: numbers that can be an axis, and names of the maps.
class Swept {
  constructor(grasps) {
    this.grasps = grasps;
    const {varied} = sb.sweptValues;
    // A parameter of some detectors or controllers only is part of their name.
    this.folded = varied.filter(
        axis => /^(detector|controller)\./.test(axis.path) &&
            (axis.path.endsWith('.type') || !axis.numeric || grasps.some(trial => !(axis.path in trial.params))));
    const free = varied.filter(axis => !this.folded.includes(axis));
    this.numbers = free.filter(axis => axis.numeric && this.levels(axis).length > 1);
    this.names = free.filter(axis => !axis.numeric);
    this.parts = ['detector', 'controller'].filter(part => new Set(grasps.map(trial => this.part(trial, part))).size > 1);
  }

  part(trial, part) {
    const type =
        part === 'detector' ? (trial.detector ? sb.detectorName(trial.detector.type) : 'no detector') : trial.controller || 'no controller';
    const values =
        this.folded.filter(axis => axis.path.startsWith(part + '.') && !axis.path.endsWith('.type') && axis.path in trial.params)
            .map(axis => axis.path.slice(part.length + 1) + ' ' + sb.parameter(trial.params[axis.path], 3));
    return type + (values.length ? ' (' + values.join(', ') + ')' : '');
  }

  // The values of a grid, or six ranges of drawn values: [{low, high, text, at}]; infinite values
  // come last.
  levels(axis) {
    const {endless} = sb.sweptValues;
    const beyond = {low: Infinity, high: Infinity, text: sb.endless(axis.unit), at: Infinity};
    return [...this.finiteLevels(axis), ...(this.grasps.some(trial => endless(axis, trial)) ? [beyond] : [])];
  }

  finiteLevels(axis) {
    const {valueOf, wide, plain} = sb.sweptValues;
    const values = [...new Set(known(this.grasps, trial => valueOf(trial, axis.path)))].sort(d3.ascending);
    if (this.isGrid(values)) return values.map(value => ({low: value, high: value, text: plain(axis, value), at: value}));
    const scale = sb.scale(wide(d3.extent(values), 8, axis.unit), d3.extent(values), [0, 6]);
    return d3.range(6).map(i => {
      const low = i === 0 ? values[0] : scale.invert(i), high = i === 5 ? values[values.length - 1] : scale.invert(i + 1);
      return {low, high, text: plain(axis, low) + ' to ' + plain(axis, high), at: scale.invert(i + 0.5)};
    });
  }

  // True if few distinct values cover all trials.
  isGrid(values) {
    return values.length <= 40 && values.length <= Math.max(3, 0.5 * this.grasps.length);
  }

  levelOf(levels, axis, trial) {
    const value = sb.sweptValues.endless(axis, trial) ? Infinity : sb.sweptValues.valueOf(trial, axis.path);
    return value === null ? -1 : levels.findIndex(level => value >= level.low && value <= level.high);
  }

  // Series of trials by everything that is not an axis, in order of their first trial; the negative
  // control ignores the detector.
  series(axes) {
    const grids = this.numbers.filter(axis => {
      const values = new Set(known(this.grasps, trial => sb.sweptValues.valueOf(trial, axis.path)));
      return !axes.includes(axis) && this.isGrid([...values]);
    });
    const found = new Map();
    for (const trial of this.grasps) {
      const control = trial.controller === negative;
      const parts = this.parts.filter(part => !(control && part === 'detector')).map(part => this.part(trial, part));
      const said = axis => axis.path in trial.params ? sb.parameter(trial.params[axis.path], 3) : '–';
      const told = [...this.names, ...grids].filter(axis => !(control && axis.path.startsWith('detector.')));
      const others = told.map(axis => sb.pathWord(axis.path) + ' ' + said(axis));
      const key = JSON.stringify([parts, others]);
      const name = [...(parts.length ? parts : [trial.controller || 'all']), ...others].join(', ');
      if (!found.has(key)) found.set(key, {name, others: others.join(', '), control, trials: []});
      found.get(key).trials.push(trial);
    }
    return [...found.values()];
  }
}

// The contour at `level` of values on a grid, [row][column], linear between the centres of
// neighbouring cells; null: no value. Returns lines of two points [column, row]. Cells at the
// boundary extend to its edge.
sb.contour = (grid, level) => {
  const rows = grid.length, columns = grid[0].length;
  const clamp = (i, count) => Math.min(count - 1, Math.max(0, i));
  const value = (c, r) => grid[clamp(r, rows)][clamp(c, columns)];
  const place = (i, count) => Math.min(count - 0.5, Math.max(-0.5, i));
  const lines = [];
  for (let r = -1; r < rows; ++r) {
    for (let c = -1; c < columns; ++c) {
      const corners = [[c, r], [c + 1, r], [c + 1, r + 1], [c, r + 1]];
      const values = corners.map(([i, j]) => value(i, j));
      if (values.includes(null)) continue;
      const points = corners.map(([i, j]) => [place(i, columns), place(j, rows)]);
      const crossings = [];
      for (let side = 0; side < 4; ++side) {
        const next = (side + 1) % 4;
        if ((values[side] >= level) === (values[next] >= level)) continue;
        const share = (level - values[side]) / (values[next] - values[side]);
        crossings.push([0, 1].map(k => points[side][k] + share * (points[next][k] - points[side][k])));
      }
      // At a saddle the value in the middle decides which corners are connected.
      if (crossings.length === 4 && (d3.mean(values) >= level) !== (values[0] >= level)) crossings.push(crossings.shift());
      for (let i = 0; i + 1 < crossings.length; i += 2) lines.push([crossings[i], crossings[i + 1]]);
    }
  }
  return lines;
};

// The scene with its values in Python, from the command of the dataset.
const pythonScene = more => {
  const word = /^slipbench \S+ ('(?:[^']|'\\'')*'|\S+)/.exec(page.command)[1];
  const path = word.startsWith("'") ? word.slice(1, -1).replaceAll("'\\''", "'") : word;
  const values = {...page.overrides, ...more};
  const set = Object.keys(values).length ? '.set(' + JSON.stringify(values) + ')' : '';
  return 'slipbench.Scene.load(' + JSON.stringify(path) + ')' + set;
};
const drawsOf = () => / --trials (\d+)/.exec(page.command)?.[1];
// The line of Python that writes the dataset again, if no command line can read the scene.
sb.pythonCommand = () => {
  const draws = drawsOf() ? 'draws=' + drawsOf() + ', ' : '';
  return pythonScene({}) + '.write(' + JSON.stringify(page.file) + ', ' + draws + 'seed=' + page.seed + ')';
};

// The command that runs one trial again, from the command of the dataset: a command line, or a line
// of Python.
sb.replayCommand = trial => {
  if (page.no_replay) {
    const draws = drawsOf() ? {'sweep.trials': drawsOf()} : {};
    return pythonScene(draws) + '.run(' + trial.index + ', seed=' + page.seed + ')';
  }
  const recorded = page.command.replace(/ --record outcome$/, '');
  const one = recorded.replace(/^slipbench sweep /, 'slipbench run ');
  const same = one === recorded ? one : one.replace(/ --trials (\d+)$/, ' --set sweep.trials=$1');
  const input = /^slipbench \S+ -( |$)/.test(page.command) ? ' < SCENE.yaml' : '';  // the scene was read from standard input
  return same + ' --trial ' + trial.index + ' -o trial-' + trial.index + '.h5' + input;
};

// Table of the outcomes of each series.
function overview(swept) {
  const detected = (title, text) => ({title, cell: ({trials, control}) => control ? '–' : text(trials)});
  const bounds = trials => interval(held(trials), trials.length).map(bound => sb.fixed(100 * bound, 1)).join(' to ') + ' %';
  const columns = [
    {title: '', kind: 'text', cell: ({name, control}) => [el('b', {}, name), control && ' · negative control']},
    {title: 'held', cell: ({trials}) => held(trials) + ' of ' + trials.length},
    {title: 'share', cell: ({trials}) => sb.fixed(100 * held(trials) / trials.length, 0) + ' %'},
    {title: '95 % interval', cell: ({trials}) => bounds(trials)},
    ...medians.map(
        (quantity, i) => ({title: medianHeads[i], cell: ({trials}) => sb.significant(valueIn(quantity, trials), 3)})),
    detected('early', earlyText), detected('recall of slip', trials => sb.percent(recallOf(trials))),
    detected('balanced accuracy', trials => sb.percent(balancedOf(trials)))
  ];
  return sb.section(
      'Outcome of the grasps',
      'Medians: slip and rotation of the held boxes, force ratio of all trials. ' +
          'Reaction and delay (of the detector) do not include trials with an alarm before the slip (early). Intervals are exact (Clopper and Pearson).',
      el('div.scroll.tall', {}, sb.sortedTable(columns, swept.series(swept.numbers).slice(0, 200)).node));
}

sb.grasps = {
  quantities, medians, medianHeads, held, countOf, valueIn, rangeIn, withUnit, heldText, balancedOf, recallOf,
  earlyText
};

// Sections of a dataset of grasps; empty for other datasets.
sb.graspSections = (trials, open) => {
  const grasps = trials.filter(trial => trial.grasp);
  if (!grasps.length) return [];
  const swept = new Swept(grasps);
  return [overview(swept), ...(swept.numbers.length ? [sb.successMaps(swept, open)] : [])];
};

// Parameters of the grasp, with assumed values marked.
sb.graspParameters = () => {
  const rows = page.grasp_parameters;
  const assumed = rows.filter(row => row.assumed).length;
  const origin = {scene: 'scene', sweep: 'varies between trials', protocol: 'protocol', default: 'default'};
  const source = row => [row.assumed && el('span.assumed', {}, 'assumed'), row.source.replace(/^assumed[:;]? ?/, ' ')];
  const columns = [
    {title: 'parameter', kind: 'text', cell: row => el('b', {}, row.path)},
    {title: 'value', kind: 'text', cell: row => row.value || '–'},
    {title: 'set by', kind: 'text', cell: row => origin[row.by]},
    {title: 'meaning', kind: 'text.long', cell: row => row.doc}, {title: 'source', kind: 'text.long', cell: source}
  ];
  return sb.section(
      'Parameters of the grasp',
      assumed + ' of ' + rows.length + ' parameters are assumed: neither measured nor published.',
      el('details.parameters', {}, el('summary', {}, 'All parameters'), sb.table(columns, rows)));
};
