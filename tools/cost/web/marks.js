// Data of the page and shared helpers: marks, number formats, selection.
const el = sb.element;

sb.data = JSON.parse(document.getElementById('slipbench-data').textContent);

// Mark of a series in legends and tables. `kind`: of choice.kind().
sb.swatch = (index, kind) => el(
    'span.swatch', {},
    sb.mark('svg', {viewBox: '-8 -8 16 16', 'aria-hidden': 'true'}, sb.mark('path.mark.' + (kind || ''), {
      d: sb.markPath(index, 5),
      style: 'color:' + (kind === 'unrun' ? 'var(--soft)' : sb.hue(index))
    })));

const superscript = number => String(number).replace(/[-0-9]/g, c => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]);
// A number with `digits` significant digits, as a power of ten if small or large.
sb.figure = (value, digits = 3) => {
  if (Math.abs(value) >= 1e-4 && Math.abs(value) < 1e7) return d3.format(',.' + digits + '~r')(value);
  return sb.significant(value, digits)
      .replace(/^1e([+-]\d+)$/, (_, power) => '10' + superscript(+power))
      .replace(/e([+-]\d+)$/, (_, power) => ' × 10' + superscript(+power));
};
const units = [[1, 's'], [1e-3, 'ms'], [1e-6, 'µs'], [1e-9, 'ns']];
sb.duration = seconds => {
  if (seconds === null || seconds === undefined) return sb.missing;
  const [size, unit] = units.find(([limit]) => Math.abs(seconds) >= limit) || (seconds === 0 ? units[0] : units[3]);
  return sb.figure(seconds / size) + ' ' + unit;
};
// Speed as a multiple of real time. `cost`: CPU seconds per simulated second.
sb.timesReal = cost => cost > 0 ? sb.figure(1 / cost) + ' ×' : sb.missing;

sb.rateText = rate => sb.figure(rate) + ' Hz';
// Number of runs, for a CPU time that has too few for quartiles.
sb.fewRuns = cpu => cpu.low === null ? (cpu.repeats === 1 ? 'one run' : cpu.repeats === 2 ? 'two runs' : cpu.repeats + ' runs') : '';

// Errors below this, in the measure's unit, count as none: they are rounding and would only stretch
// the axis.
sb.negligible = 1e-6;

// A measure's title with its unit, and a value of it in that unit.
sb.titled = measure => measure.title + (measure.unit ? ', ' + measure.unit : '');
sb.measured = (measure, value) => (sb.figure(value * measure.factor, 2) + ' ' + measure.unit).trim();

// Logarithmic axes: a domain with some margin around the values, at least a decade wide; the text
// of a tick.
sb.logDomain = values => {
  const [low, high] = d3.extent(values).map(Math.log10);
  const air = Math.max(0.12, (1 - (high - low)) / 2, 0.05 * (high - low));
  return [10 ** (low - air), 10 ** (high + air)];
};
sb.tickText = value => {
  if (value >= 1e-3 && value < 1e7) return d3.format(',.1~r')(value);
  const power = Math.floor(Math.log10(value) + 1e-9);
  const factor = Math.round(value / Math.pow(10, power));
  return (factor === 1 ? '' : factor + '×') + '10' + superscript(power);
};

sb.copyButton = command => {
  const copy = event => {
    event.stopPropagation();
    sb.copy(event.currentTarget, command);
  };
  return el('button.link.copy', {title: command, 'aria-label': 'copy command: ' + command, onclick: copy}, 'copy');
};
sb.percentText = share => sb.figure(100 * share, 2) + ' %';

// The user's selection. Events: 'view' if the drawn content changes, 'row' if another row is shown.
class Choice extends EventTarget {
  constructor(data) {
    super();
    const {measures = [], series = [], rows = []} = data;
    Object.assign(this, {measures, series, rows, measure: measures[0] || null, statistic: 'worst', hidden: new Set()});
    this.selected = rows.find(row => row.own) || rows[0] || null;
    this.pointed = null;
  }

  view(change) {
    Object.assign(this, change);
    this.dispatchEvent(new Event('view'));
  }

  select(row) {
    this.selected = row;
    this.dispatchEvent(new Event('row'));
  }

  point(row) {
    if (row === this.pointed) return;
    this.pointed = row;
    this.dispatchEvent(new Event('row'));
  }

  // The row shown: the hovered one, else the selected one.
  get shown() {
    return this.pointed || this.selected;
  }

  seriesIndex(row) {
    return Math.max(0, this.series.findIndex(series => series.name === row.series));
  }

  seriesTitle(row) {
    return this.series.find(series => series.name === row.series)?.title ?? row.series;
  }

  // True if the row is on the front of the chosen measure.
  onFront(row, measure = this.measure) {
    return (row.pareto || []).includes(measure.name);
  }

  // Error of a row, null if it has none.
  error(row, measure = this.measure, statistic = this.statistic) {
    return (measure && row.errors?.[measure.name]?.[statistic]) ?? null;
  }

  differs(row, measure = this.measure) {
    return Boolean(measure) && (row.different || []).includes(measure.name);
  }

  // True if skipped for lack of time, which is no statement about the setting.
  notRun(row) {
    return row.status === 'over budget';
  }

  failed(row) {
    return !this.notRun(row) && (row.status !== 'ok' || this.differs(row));
  }

  kind(row) {
    return this.notRun(row) ? 'unrun' : this.failed(row) ? 'failure' : 'point';
  }

  // Status in the page's words. Errors without a timing come from a single run.
  ending(row) {
    return !this.notRun(row) ? row.status : Object.keys(row.errors || {}).length ? 'not timed' : 'not run';
  }

  // True if the row can be drawn in the diagram: it has a time and an error.
  placed(row) {
    return this.kind(row) === 'point' && row.cost > 0 && this.error(row) !== null;
  }

  // True if an error is negligible.
  none(error, measure = this.measure) {
    return error * measure.factor < sb.negligible;
  }

  errorText(row, measure = this.measure, statistic = this.statistic) {
    if (this.differs(row, measure)) return 'no error';
    const error = this.error(row, measure, statistic);
    return error === 0 ? 'none' : error === null ? sb.missing : sb.measured(measure, error);
  }

  // The cheapest row of the front whose worst error is at most this one's; null if that is this
  // row, or without such a row.
  cheapestAsExact(row) {
    const worst = other => {
      const error = this.error(other, this.measure, 'worst');
      return error !== null && this.none(error) ? 0 : error;
    };
    if (!this.placed(row) || worst(row) === null) return null;
    const front = this.rows.filter(other => this.onFront(other) && worst(other) <= worst(row));
    const [best] = front.sort((a, b) => a.cost - b.cost);
    return best && best.cost < row.cost ? best : null;
  }

  // Reason why a row is not a point of the diagram.
  reason(row) {
    const parts = row.status === 'ok' ? [] : [this.ending(row)];
    if (row.why) parts.push(row.why);
    if (this.failed(row) && this.differs(row)) parts.push('no error: the event occurs only in this run or only in the reference');
    return parts.join(': ');
  }
}
sb.choice = new Choice(sb.data);
