// Charts over time: curves, and rows of states. All follow one Timeline.
const el = sb.element, mark = sb.mark, text = sb.text;

const left = 44, right = 6;  // px, margins of every plot; equal, so that all time axes align
const times = 20;            // px below a plot, for the names of instants
const px = value => +value.toFixed(1);

// Common behaviour of charts over time: they are drawn at their width for the window of the
// timeline, hovering moves its cursor, dragging zooms, a double click shows everything, and they
// are saved as shown, with their heading. A chart implements contents() and savedRows(). `height`
// [px]: height of its plot; `foot` [px]: space below the plot.
sb.TimeChart = class {
  constructor(parent, timeline, title, label, height, foot) {
    Object.assign(this, {timeline, title, label, height, foot});
    this.cursor = el('div.cursor', {style: 'bottom:' + foot + 'px'});
    this.box = el('div.window');
    this.svg = mark('svg');
    this.node = el('div.chart', {style: 'height:' + (height + foot) + 'px'}, this.svg, this.cursor, this.box);
    parent.append(this.node);
    sb.saveCorner(this.node, title, () => this.drawing(true), () => this.savedRows());
    this.listen();
    this.listening = new AbortController();
    const {signal} = this.listening;
    timeline.addEventListener('window', () => this.draw(), {signal});
    timeline.addEventListener('cursor', () => this.placeCursor(), {signal});
    sb.onWidth(this.node, () => this.draw());
  }
  // Disconnects the chart from the timeline before it leaves the page.
  release() {
    this.listening.abort();
  }

  get width() {
    return this.node.clientWidth;
  }
  get plot() {
    return Math.max(1, this.width - left - right);
  }
  // Position of an instant [px], and instant at a position.
  get x() {
    return d3.scaleLinear(this.timeline.window, [left, left + this.plot]);
  }
  timeAt(event) {
    return this.x.clamp(true).invert(d3.pointer(event, this.node)[0]);
  }

  listen() {
    const {node, box, timeline} = this;
    let start = null;
    const span = event => [start, this.timeAt(event)].sort(d3.ascending);
    const finish = event => {
      if (start === null) return;
      const [from, to] = span(event);
      if (this.x(to) - this.x(from) > 4)
        timeline.setWindow(from, to);
      else
        timeline.setCursor(this.timeAt(event));
      start = null;
      box.style.width = 0;
    };
    node.addEventListener('pointerdown', event => {
      if (event.button !== 0 || event.target.closest('button')) return;
      start = this.timeAt(event);
      node.setPointerCapture(event.pointerId);
    });
    node.addEventListener('pointermove', event => {
      if (start === null) {
        if (!timeline.playing) timeline.setCursor(this.timeAt(event));
        return;
      }
      const [from, to] = span(event).map(t => this.x(t));
      box.style.left = from + 'px';
      box.style.width = (to - from) + 'px';
    });
    node.addEventListener('pointerup', finish);
    node.addEventListener('pointercancel', finish);
    node.addEventListener('dblclick', () => timeline.setWindow(...timeline.full));
  }

  placeCursor() {
    const {cursor: t, window: [from, to]} = this.timeline;
    this.cursor.hidden = t < from || t > to;
    this.cursor.style.left = this.x(t) + 'px';
  }

  draw() {
    if (!this.width) return;
    const svg = this.drawing(false);
    this.svg.replaceWith(svg);
    this.svg = svg;
    this.placeCursor();
  }

  // The chart as shown on the page, or as saved: with its heading above and the times below.
  drawing(saved) {
    const {width, height} = this, view = saved ? [0, -18, width, height + 18 + times] : [0, 0, width, height + this.foot];
    return mark('svg.plot', {viewBox: view.join(' '), role: 'img', 'aria-label': this.label},
                this.contents(), this.instants(), saved && this.heading());
  }

  // The axis below the plot.
  instants() {
    const {x: scale, width, height} = this, words = t => sb.significant(+t.toFixed(5), 6) + ' s';
    const axis = sb.axis(d3.axisBottom, {scale, ticks: sb.ticks(scale, 80), text: words}, 'translate(0,' + height + ')');
    // Text that would leave the picture is right-aligned.
    d3.select(axis).selectAll('text').filter(t => scale(t) + 3.2 * words(t).length > width).attr('text-anchor', 'end').attr('x', t => width - scale(t));
    return axis;
  }

  heading() {
    return text(left, -6, 'start', this.title, 'name');
  }

  // Marks clipped to the plot.
  clipped(marks) {
    const {plot, height} = this;
    const frame = {x: left, y: 0, width: plot, height, viewBox: [left, 0, plot, height].join(' '), 'aria-hidden': 'true'};
    return mark('svg', frame, mark('rect', {x: left, width: plot, height, fill: 'none'}), marks);
  }

  // Runs of states as bars. fill(state): null for no bar; size(state): share of the height.
  bars(runs, bottom, height, fill, size = () => 1) {
    const {x, timeline: {window: [from, to]}} = this;
    return runs.filter(run => run.to >= from && run.from <= to && fill(run.state)).map(run => {
      const begin = Math.max(left, x(run.from)), tall = height * size(run.state);
      const width = Math.max(0.5, Math.min(left + this.plot, x(run.to)) - begin);
      return mark('rect', {x: px(begin), y: px(bottom - tall), width: px(width), height: px(tall), fill: fill(run.state)});
    });
  }
};

const stateFill = key => key === 'partial' ? 'url(#hatch)' : 'var(--' + key + ')';
// Height of a state's bar as a share of its row, so that states do not differ in colour only.
const stateHeight = {detached: 0.12, stick: 0.42, partial: 0.72, slip: 1};

// Rows of states over time. rows: [{name, runs, kinds: sb.states.unit or sb.states.pad}].
sb.StateRows = class extends sb.TimeChart {
  constructor(parent, timeline, rows, rowHeight, title) {
    const label = title + ', over time, of ' + rows.map(row => row.name).join(', ');
    super(parent, timeline, title, label, rows.length * rowHeight, 0);
    Object.assign(this, {rows, rowHeight});
  }

  savedRows() {
    const states = row => row.runs.map(run => [row.name, row.kinds[run.state].name, run.from, run.to]);
    return [['row', 'state', 'from [s]', 'to [s]'], ...this.rows.flatMap(states)];
  }

  contents() {
    const {rows, rowHeight} = this, gap = rowHeight > 8 ? 2 : 0, bar = Math.max(1, rowHeight - 2 * gap);
    // Rows too thin for different heights are filled, and have no space for a name.
    const roomy = rowHeight >= 10, size = Math.min(12, rowHeight - 1);
    return rows.map(({name, runs, kinds}, i) => {
      const bottom = (i + 1) * rowHeight - gap, key = state => kinds[state].key;
      const words = {x: left - 6, y: bottom - bar / 2 + 4, 'text-anchor': 'end', style: 'font-size:' + size + 'px'};
      return [
        roomy && mark('text.name', words, name),
        this.bars(runs, bottom, bar, state => stateFill(key(state)), state => roomy ? stateHeight[key(state)] : 1)
      ];
    });
  }
};

// An axis that covers all values of `unit`, with a margin beyond the largest, and starts at zero.
// Counts far from zero would be a flat line then, so their axis does not.
sb.rangeOf = (columns, unit) => {
  const [least, most] = [d3.min, d3.max].map(of => sb.rounded(of(columns, column => of(column)) || 0, unit));
  const near = !(least > 0.5 * most);
  const low = near ? Math.min(0, least) : least, high = near ? Math.max(0, most) : most;
  const gap = 0.06 * (high - low || 1);
  return [low === 0 ? low : low - gap, high + gap];
};

// Rows between `begin` and `end` that represent a curve: all, or the lowest and the highest per
// pixel.
function telling(column, begin, end, pixels) {
  const each = Math.ceil((end - begin) / pixels);
  if (each <= 2) return d3.range(begin, end + 1);
  return d3.range(begin, end + 1, each).flatMap(first => {
    let low = first, high = first;
    for (let row = first; row < Math.min(first + each, end + 1); ++row) {
      if (column[row] < column[low]) low = row;
      if (column[row] > column[high]) high = row;
    }
    return low === high ? [low] : [low, high].sort(d3.ascending);
  });
}

// Curves over time on bands of the sensor's state.
// options: {name: title in words; rows: times, columns, labels, unit, colours, height, bands: runs,
// and all optional: range: [low, high] or sb.rangeOf, strip: runs below the curves, solid: no
// dashes, step: values hold until the next, lines: horizontal [{value, text, colour}], marks:
// vertical [{time, text, colour}], points: [{time, value, text}] on a curve; values in SI}
sb.LineChart = class extends sb.TimeChart {
  constructor(parent, timeline, options) {
    const {name, unit, range, columns} = options, symbol = sb.symbol(unit), height = options.height - times;
    super(parent, timeline, name, [name, symbol, 'over time'].filter(part => part).join(', '), height, times);
    Object.assign(this, options, {height, symbol, factor: sb.factor(unit), range: range || sb.rangeOf(columns, unit)});
  }

  savedRows() {
    const {rows, columns, labels, factor, symbol} = this;
    return [
      ['t [s]', ...labels.map(label => symbol ? label + ' [' + symbol + ']' : label)],
      ...Array.from(rows, (t, row) => [t, ...columns.map(column => column[row] * factor)])
    ];
  }

  heading() {
    const {width, title, symbol, labels, colours} = this;
    let end = width - right;
    const names = labels.map((label, i) => [label, colours[i]]).reverse().map(([label, colour]) => {
      const name = mark('text', {x: end, y: -6, 'text-anchor': 'end', style: 'fill:var(--' + colour + ')'}, label);
      end -= 7 * label.length + 10;
      return name;
    });
    return [text(left, -6, 'start', title + (symbol ? ', ' + symbol : ''), 'name'), names];
  }

  // Position of a value [px].
  get y() {
    return d3.scaleLinear(this.range, [this.height, 0]);
  }

  curve(column, i) {
    const {rows, colours, solid, step, x, y} = this, [from, to] = this.timeline.window;
    const begin = Math.max(0, d3.bisectLeft(rows, from) - 1), end = Math.min(rows.length - 1, d3.bisectRight(rows, to));
    const line = d3.line(row => x(rows[row]), row => y(column[row])).defined(row => !isNaN(column[row])).digits(1);
    if (step) line.curve(d3.curveStepAfter);
    const d = line(telling(column, begin, end, this.plot));
    // The second of several curves is dashed, since it may coincide with the first.
    return mark(
        'path.curve', {d, style: 'stroke:var(--' + colours[i] + ')', 'stroke-dasharray': i === 1 && !solid ? '6 3' : null});
  }

  // Lines, marks and points, each with its text; a text that would overlap an earlier one is moved
  // down.
  notes() {
    const {height, lines = [], marks = [], points = []} = this, end = left + this.plot, boxes = [];
    const write = (x, y, anchor, words, colour) => {
      const wide = 6.2 * words.length, start = anchor === 'end' ? x - wide : x;
      const meets = box => start < box.end && box.start < start + wide && Math.abs(y - box.y) < 12;
      for (let i = 0; i < boxes.length && boxes.some(meets); ++i) y += 13;
      boxes.push({start, end: start + wide, y});
      return mark('text.halo-text', {x, y, 'text-anchor': anchor, style: 'fill:var(--' + colour + ')'}, words);
    };
    const line = (d, colour, dash) =>
        mark('path.note-line', {d, style: 'stroke:var(--' + colour + ')', 'stroke-dasharray': dash});
    return [
      marks.map(({time, text: words, colour = 'soft'}) => [
        line('M' + this.x(time) + ',0V' + height, colour, '2 3'), words && write(this.x(time) + 4, 10, 'start', words, colour)
      ]),
      lines.map(({value, text: words, colour}) => {
        const y = this.y(value);
        return [line('M' + left + ',' + y + 'H' + end, colour, '7 4'), write(end - 4, y + 13, 'end', words, colour)];
      }),
      points.map(({time, value, text: words}) => {
        const x = this.x(time), y = this.y(value), first = x < left + 0.75 * this.plot;
        return [
          mark('circle', {cx: x, cy: y, r: 3}), write(x + (first ? 6 : -6), y - 5, first ? 'start' : 'end', words, 'ink')
        ];
      })
    ];
  }

  contents() {
    const {height, bands, strip, columns, factor, plot} = this;
    const scale = d3.scaleLinear(this.range.map(value => value * factor), [height, 0]);
    const ticks = {scale, ticks: scale.ticks(Math.max(2, height / 32)), text: tick => sb.significant(+tick.toFixed(9), 4)};
    const axis = sb.axis(d3.axisLeft, ticks, 'translate(' + left + ',0)', plot);
    // Keeps the labels inside the picture.
    d3.select(axis).selectAll('text').attr('dy', null).attr('y', tick => Math.max(9, Math.min(height, scale(tick) + 4)) - scale(tick));
    return [
      this.bars(bands, height, height, state => state && 'var(--band' + state + ')'),
      strip && this.bars(strip, height, 5, state => stateFill(sb.states.unit[state].key)),
      axis, this.clipped([columns.map((column, i) => this.curve(column, i)), this.notes()])
    ];
  }
};

// Legend of the states.
sb.stateLegend = kinds => el('div.legend', {}, Object.entries(stateHeight).map(([key, share]) => {
  const {name, meaning} = kinds.find(kind => kind.key === key), height = 13 * share;
  return sb.key('0 0 22 14', mark('rect', {x: 1, width: 20, y: 13.5 - height, height, fill: stateFill(key)}),
                name + (meaning ? ': ' + meaning : ''));
}));

sb.plotLeft = left;
sb.stateFill = stateFill;
