// Charts over time: curves, and rows of states. All follow one Timeline.
(function(sb) {
'use strict';

const axisWidth = 44;  // px left of every plot, so that all time axes line up
const rightGap = 6;

// Mouse and touch on a picture of time: hovering moves the cursor, dragging zooms, a double click shows all.
function attachTimeInput(node, timeline) {
  const area = () => ({left: axisWidth, width: Math.max(1, node.clientWidth - axisWidth - rightGap)});
  const timeAt = event => {
    const {left, width} = area();
    const share = (event.clientX - node.getBoundingClientRect().left - left) / width;
    return timeline.window[0] + Math.min(1, Math.max(0, share)) * (timeline.window[1] - timeline.window[0]);
  };
  let start = null;
  let box = null;
  const drawBox = event => {
    const {left, width} = area();
    const span = timeline.window[1] - timeline.window[0];
    const [a, b] = [start, timeAt(event)].sort((p, q) => p - q).map(t => left + (t - timeline.window[0]) / span * width);
    if (!box) {
      box =
          sb.element('div', {style: 'position:absolute;top:0;bottom:0;background:var(--accent);opacity:.16;pointer-events:none'});
      node.append(box);
    }
    box.style.left = a + 'px';
    box.style.width = (b - a) + 'px';
  };
  node.style.touchAction = 'pan-y';
  node.addEventListener('pointerdown', event => {
    if (event.button !== 0) return;
    start = timeAt(event);
    node.setPointerCapture(event.pointerId);
  });
  node.addEventListener('pointermove', event => {
    if (start !== null)
      drawBox(event);
    else if (!timeline.playing)
      timeline.setCursor(timeAt(event));
  });
  const finish = event => {
    if (start === null) return;
    const end = timeAt(event);
    const dragged = box !== null && parseFloat(box.style.width) > 4;
    if (dragged)
      timeline.setWindow(Math.min(start, end), Math.max(start, end));
    else
      timeline.setCursor(end);
    start = null;
    if (box) box.remove();
    box = null;
  };
  node.addEventListener('pointerup', finish);
  node.addEventListener('pointercancel', finish);
  node.addEventListener('dblclick', () => timeline.setWindow(timeline.full[0], timeline.full[1]));
}

// A vertical line at the cursor over a picture of time.
function attachCursor(node, timeline, owner) {
  const line = sb.element('div.cursor');
  node.append(line);
  const place = () => {
    const share = (timeline.cursor - timeline.window[0]) / (timeline.window[1] - timeline.window[0]);
    const visible = share >= 0 && share <= 1;
    line.style.display = visible ? '' : 'none';
    if (visible) line.style.left = axisWidth + share * (node.clientWidth - axisWidth - rightGap) + 'px';
  };
  timeline.on('cursor', place, owner);
  place();
}

const stateColour = key => sb.colour(key);
// Height of a state's bar as a share of its row: states differ by more than colour.
const stateHeight = {
  detached: 0.12,
  stick: 0.42,
  partial: 0.72,
  slip: 1
};

function hatch(context, colour) {
  const tile = document.createElement('canvas');
  tile.width = tile.height = 5;
  const pen = tile.getContext('2d');
  pen.fillStyle = colour;
  pen.globalAlpha = 0.55;
  pen.fillRect(0, 0, 5, 5);
  pen.globalAlpha = 1;
  pen.strokeStyle = colour;
  pen.lineWidth = 1.6;
  pen.beginPath();
  for (const offset of [-5, 0, 5]) {
    pen.moveTo(offset - 1, 6);
    pen.lineTo(offset + 6, -1);
  }
  pen.stroke();
  return context.createPattern(tile, 'repeat');
}

// Rows of states over time. rows: [{name, runs, kinds: sb.states.unit or sb.states.pad}].
class StateRows {
  constructor(parent, timeline, rows, rowHeight, title) {
    this.title = title;
    this.timeline = timeline;
    this.rows = rows;
    this.rowHeight = rowHeight;
    this.node = sb.element('div.chart');
    this.canvas = sb.element('canvas', {
      style: 'display:block;width:100%;height:' + rows.length * rowHeight + 'px',
      role: 'img',
      'aria-label': title + ', over time, of ' + rows.map(row => row.name).join(', ')
    });
    this.node.append(this.canvas);
    parent.append(this.node);
    save(this.node, this);
    attachTimeInput(this.node, timeline);
    attachCursor(this.node, timeline, this);
    this.node.querySelector('.cursor').style.bottom = '0';
    for (const what of ['window', 'theme']) timeline.on(what, () => this.draw(), this);
    new ResizeObserver(() => this.draw()).observe(this.node);
    this.draw();
  }

  savedRows() {
    const states = row => row.runs.map(run => [row.name, row.kinds[run.state].name, run.from, run.to]);
    return [['row', 'state', 'from [s]', 'to [s]'], ...this.rows.flatMap(states)];
  }

  drawing() {
    const width = this.node.clientWidth, [from, to] = this.timeline.window;
    const drawing = new sb.Drawing(width, this.rows.length * this.rowHeight + 20);
    const plot = width - axisWidth - rightGap, x = t => axisWidth + (t - from) / (to - from) * plot;
    const bar = Math.max(1, this.rowHeight - (this.rowHeight > 8 ? 4 : 0));
    this.rows.forEach((row, index) => {
      const bottom = (index + 1) * this.rowHeight - (this.rowHeight > 8 ? 2 : 0);
      if (this.rowHeight >= 10) drawing.text(axisWidth - 6, bottom - bar / 2 + 4, row.name, 'end', sb.colour('ink'), Math.min(12, this.rowHeight - 1));
      for (const run of row.runs) {
        if (run.to < from || run.from > to) continue;
        const left = Math.max(axisWidth, x(run.from)), key = row.kinds[run.state].key;
        const size = this.rowHeight >= 10 ? bar * stateHeight[key] : bar;
        drawing.rect(left, bottom - size, Math.min(axisWidth + plot, x(run.to)) - left, size, stateColour(key));
      }
    });
    for (const t of d3.scale.linear().domain([from, to]).ticks(8))
      drawing.text(x(t), this.rows.length * this.rowHeight + 14, sb.significant(t, 6) + ' s', 'middle');
    return drawing;
  }

  draw() {
    const width = this.node.clientWidth, height = this.rows.length * this.rowHeight;
    const ratio = Math.max(2, window.devicePixelRatio || 1);
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const pen = this.canvas.getContext('2d');
    pen.scale(ratio, ratio);
    const [from, to] = this.timeline.window;
    const plot = width - axisWidth - rightGap;
    const x = t => axisWidth + (t - from) / (to - from) * plot;
    const fills = {};
    for (const key of ['detached', 'stick', 'slip']) fills[key] = stateColour(key);
    fills.partial = hatch(pen, stateColour('partial'));
    pen.font = Math.min(12, this.rowHeight - 1) + 'px system-ui, "DejaVu Sans", sans-serif';  // names of low rows must not meet
    pen.textBaseline = 'middle';
    pen.textAlign = 'right';
    const bar = Math.max(1, this.rowHeight - (this.rowHeight > 8 ? 4 : 0));
    this.rows.forEach((row, index) => {
      const bottom = (index + 1) * this.rowHeight - (this.rowHeight > 8 ? 2 : 0);
      if (this.rowHeight >= 10) {
        pen.fillStyle = sb.colour('ink');
        pen.fillText(row.name, axisWidth - 6, bottom - bar / 2);
      }
      for (const run of row.runs) {
        if (run.to < from || run.from > to) continue;
        const left = Math.max(axisWidth, x(run.from));
        const right = Math.min(axisWidth + plot, Math.max(x(run.to), left + 0.5));
        const key = row.kinds[run.state].key;
        // Rows too thin to tell heights apart are filled.
        const size = this.rowHeight >= 10 ? bar * stateHeight[key] : bar;
        pen.fillStyle = fills[key];
        pen.fillRect(left, bottom - size, right - left, size);
      }
    });
  }
}

// The buttons that save a chart over time, in its corner.
function save(node, chart) {
  node.classList.add('saved');
  node.append(sb.saveButtons({title: () => chart.title, drawing: () => chart.drawing(), rows: () => chart.savedRows()}));
}

// Curves over time on bands of the sensor's state.
// options: {name: what it shows, in words; rows: times, columns, labels, unit, colours, range: [low, high] or null, height, bands: runs, strip: runs or null,
// solid: no dashes, step: values stay until the next, and all optional: lines: [{value, text, colour}] across, marks: [{time, text, colour}]
// down, points: [{time, value, text}] on a curve; values in SI}
class LineChart {
  constructor(parent, timeline, options) {
    this.timeline = timeline;
    this.options = options;
    this.node = sb.element('div.chart');
    this.plot = sb.element('div.plot', {style: 'height:' + options.height + 'px'});
    this.node.append(this.plot);
    if (options.lines || options.marks || options.points) this.notes = sb.element('canvas.notes');
    parent.append(this.node);
    const factor = sb.factor(options.unit);
    const data = Array.from(options.rows, (t, row) => [t, ...options.columns.map(column => column[row] * factor)]);
    this.graph = new Dygraph(this.plot, data, {
      labels: ['t', ...options.labels],
      strokeWidth: 1.5,
      stepPlot: Boolean(options.step),
      // The second of several curves is dashed: it may lie on the first.
      series:
          Object.fromEntries(options.labels.map((name, i) => [name, {strokePattern: i === 1 && !options.solid ? [6, 3] : null}])),
      legend: 'never',
      interactionModel: {},
      highlightCircleSize: 0,
      animatedZooms: false,
      rightGap,
      dateWindow: timeline.window.slice(),
      valueRange: options.range ? options.range.map(value => value * factor) : null,
      includeZero: true,
      xRangePad: 0,
      ...this.colours(),
      gridLineWidth: 1,
      axes: {
        x: {drawGrid: false, pixelsPerLabel: 56, axisLabelFormatter: t => sb.significant(+t.toFixed(5), 6) + ' s'},
        y: {axisLabelWidth: axisWidth - 4, pixelsPerLabel: 24, axisLabelFormatter: value => sb.significant(+value.toFixed(9), 4)},
      },
      underlayCallback: (pen, area) => this.drawBands(pen, area),
      drawCallback: graph => this.notes && this.drawNotes(graph),
    });
    if (this.notes) this.node.append(this.notes);
    this.title = options.name;
    // One of dygraphs' canvases bears the name for all.
    this.node.querySelectorAll('canvas').forEach((canvas, i) => {
      if (i) return canvas.setAttribute('aria-hidden', 'true');
      canvas.setAttribute('role', 'img');
      canvas.setAttribute('aria-label', options.name + ', ' + sb.symbol(options.unit) + ', over time');
    });
    save(this.node, this);
    attachTimeInput(this.node, timeline);
    attachCursor(this.node, timeline, this);
    timeline.on('window', () => this.graph.updateOptions({dateWindow: timeline.window.slice()}), this);
    timeline.on('theme', () => this.graph.updateOptions(this.colours()), this);
  }

  // Colours of the current theme: a canvas does not follow style sheets by itself.
  colours() {
    return {
      colors: this.options.colours.map(name => sb.colour(name)),
      axisLineColor: sb.colour('line'),
      gridLineColor: sb.colour('grid')
    };
  }

  drawBands(pen, area) {
    const [from, to] = this.timeline.window;
    const x = t => area.x + (t - from) / (to - from) * area.w;
    const paint = (runs, top, height, colourOf) => {
      for (const run of runs) {
        const colour = colourOf(run.state);
        if (!colour || run.to < from || run.from > to) continue;
        const left = Math.max(area.x, x(run.from)), right = Math.min(area.x + area.w, x(run.to));
        pen.fillStyle = colour;
        pen.fillRect(left, top, Math.max(0.5, right - left), height);
      }
    };
    const bands = [null, 'band1', 'band2', 'band3'].map(name => name && sb.colour(name));
    paint(this.options.bands, area.y, area.h, state => bands[state]);
    if (this.options.strip) {
      paint(this.options.strip, area.y + area.h - 5, 5, state => stateColour(sb.states.unit[state].key));
    }
  }

  savedRows() {
    const {rows, columns, labels, unit} = this.options, factor = sb.factor(unit), symbol = sb.symbol(unit);
    return [
      ['t [s]', ...labels.map(label => symbol ? label + ' [' + symbol + ']' : label)],
      ...Array.from(rows, (t, row) => [t, ...columns.map(column => column[row] * factor)])
    ];
  }

  // What the page shows of it, in the time window of the page.
  drawing() {
    const {rows, columns, unit, colours, bands, strip, solid, step, height, lines = [], marks = [], points = []} = this.options;
    const width = this.node.clientWidth, [from, to] = this.timeline.window, [low, high] = this.graph.yAxisRange();
    const drawing = new sb.Drawing(width, height + 20), foot = height - 20, factor = sb.factor(unit);
    const plot = width - axisWidth - rightGap, x = t => axisWidth + (t - from) / (to - from) * plot;
    const y = value => 16 + (foot - 16) * (high - value) / (high - low);
    drawing.text(axisWidth, 11, this.title + (sb.symbol(unit) ? ', ' + sb.symbol(unit) : ''), 'start', sb.colour('ink'));
    const band = (runs, top, size, colourOf) => {
      for (const run of runs) {
        const colour = colourOf(run.state);
        if (colour && run.to > from && run.from < to)
          drawing.rect(x(Math.max(from, run.from)), top, x(Math.min(to, run.to)) - x(Math.max(from, run.from)), size, colour);
      }
    };
    band(bands, 16, foot - 16, state => state && sb.colour('band' + state));
    if (strip) band(strip, foot - 5, 5, state => stateColour(sb.states.unit[state].key));
    for (const tick of d3.scale.linear().domain([low, high]).ticks(5)) {
      drawing.line(axisWidth, y(tick), axisWidth + plot, y(tick), sb.colour('grid'));
      drawing.text(axisWidth - 6, y(tick) + 4, sb.significant(+tick.toFixed(9), 4), 'end');
    }
    for (const t of d3.scale.linear().domain([from, to]).ticks(8)) drawing.text(x(t), foot + 14, sb.significant(+t.toFixed(5), 6) + ' s', 'middle');
    let legend = width - rightGap;
    columns.forEach((column, i) => {
      const inside = (t, row) => t >= from && t <= to && isFinite(column[row]) ? [x(t), y(column[row] * factor)] : null;
      drawing.curve(Array.from(rows, inside), sb.colour(colours[i]), i === 1 && !solid ? '6 3' : null, step);
    });
    [...this.options.labels].reverse().forEach((label, i) => {
      drawing.text(legend, 11, label, 'end', sb.colour(colours[columns.length - 1 - i]));
      legend -= 7 * label.length + 10;
    });
    for (const {time, text, colour} of marks) {
      drawing.line(x(time), 16, x(time), foot, sb.colour(colour || 'soft'), '2 3');
      drawing.text(x(time) + 4, foot - 5, text, 'start', sb.colour(colour || 'soft'));  // away from the points' texts
    }
    for (const {value, text, colour} of lines) {
      drawing.line(axisWidth, y(value * factor), axisWidth + plot, y(value * factor), sb.colour(colour), '7 4');
      drawing.text(axisWidth + plot - 4, y(value * factor) + 13, text, 'end', sb.colour(colour));
    }
    for (const {time, value, text} of points) drawing.text(x(time) + 6, y(value * factor) - 5, text, 'start', sb.colour('ink'));
    return drawing;
  }

  // Lines, marks and points of the options, each with its text, over the grid.
  drawNotes(graph) {
    const {lines = [], marks = [], points = [], unit} = this.options;
    const area = graph.getArea();
    const [from, to] = this.timeline.window;
    const [low, high] = graph.yAxisRange();
    const ratio = Math.max(2, window.devicePixelRatio || 1);
    this.notes.width = this.plot.clientWidth * ratio;
    this.notes.height = this.plot.clientHeight * ratio;
    const pen = this.notes.getContext('2d');
    pen.scale(ratio, ratio);
    const x = t => area.x + (t - from) / (to - from) * area.w;
    const y = value => area.y + area.h * (high - value * sb.factor(unit)) / (high - low);
    const line = (start, end, colour, dash) => {
      pen.strokeStyle = colour;
      pen.setLineDash(dash);
      pen.lineWidth = 1.3;
      pen.beginPath();
      pen.moveTo(...start);
      pen.lineTo(...end);
      pen.stroke();
      pen.setLineDash([]);
    };
    // A text that would lie on an earlier one stands below it.
    const boxes = [];
    const write = (text, left, top, colour, align) => {
      pen.textAlign = align;
      const wide = pen.measureText(text).width, start = align === 'right' ? left - wide : left;
      const meets = box => start < box.end && box.start < start + wide && Math.abs(top - box.top) < 12;
      for (let i = 0; text && i < boxes.length && boxes.some(meets); ++i) top += 13;
      if (text) boxes.push({start, end: start + wide, top});
      pen.strokeStyle = sb.colour('ground');
      pen.lineWidth = 3;
      pen.strokeText(text, left, top);
      pen.fillStyle = colour;
      pen.fillText(text, left, top);
    };
    pen.beginPath();
    pen.rect(area.x, area.y, area.w, area.h);
    pen.clip();
    pen.font = '11px system-ui, "DejaVu Sans", sans-serif';
    for (const {time, text, colour} of marks) {
      const shade = sb.colour(colour || 'soft');
      line([x(time), area.y], [x(time), area.y + area.h], shade, [2, 3]);
      write(text, x(time) + 4, area.y + 10, shade, 'left');
    }
    for (const {value, text, colour} of lines) {
      line([area.x, y(value)], [area.x + area.w, y(value)], sb.colour(colour), [7, 4]);
      write(text, area.x + area.w - 4, y(value) + 13, sb.colour(colour), 'right');
    }
    for (const {time, value, text} of points) {
      pen.fillStyle = sb.colour('ink');
      pen.beginPath();
      pen.arc(x(time), y(value), 3, 0, 2 * Math.PI);
      pen.fill();
      const left = x(time) < area.x + 0.75 * area.w;
      write(text, x(time) + (left ? 6 : -6), y(value) - 5, sb.colour('ink'), left ? 'left' : 'right');
    }
  }
}

// Small pictures of the states, as legends use them.
sb.stateSwatch = key => {
  const ns = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(ns, 'svg');
  svg.setAttribute('viewBox', '0 0 22 14');
  svg.setAttribute('aria-hidden', 'true');  // its name stands beside it
  const rect = document.createElementNS(ns, 'rect');
  const height = 13 * stateHeight[key];
  for (const [name, value] of Object.entries({x: 1, width: 20, y: 13.5 - height, height})) rect.setAttribute(name, value);
  rect.setAttribute('fill', key === 'partial' ? 'url(#hatch)' : 'var(--' + key + ')');
  svg.append(rect);
  return svg;
};
sb.stateLegend = kinds => sb.element(
    'div.legend', {},
    ['detached', 'stick', 'partial', 'slip']
        .map(key => kinds.find(kind => kind.key === key))
        .map(
            state =>
                sb.element('span', {}, sb.stateSwatch(state.key), state.name + (state.meaning ? ': ' + state.meaning : ''))));

sb.axisWidth = axisWidth;
sb.rightGap = rightGap;
sb.attachTimeInput = attachTimeInput;
sb.attachCursor = attachCursor;
sb.StateRows = StateRows;
sb.LineChart = LineChart;
})(window.slipbench);
