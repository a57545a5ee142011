// What a sensor emits as a whole: its channels over time, and spectra of them.
(function(sb) {
'use strict';
const el = sb.element;

// Colours of magnitude 0 to 1: dark is little, bright is much, in grey prints as well.
const ramp = d3.scale.linear()
                 .domain([0, 0.25, 0.5, 0.75, 1])
                 .range(['#0b1330', '#3b2f7f', '#a3386f', '#ee7b3c', '#fbe7a1'])
                 .clamp(true);
const decades = 2.5;  // from the strongest value down to what is drawn as nothing

// A spectrogram. spectrum: {bin_hz, window_s, time, columns: one a bin, unit}; each row stands for the window that ended at its time.
class Spectrogram {
  constructor(parent, timeline, spectrum, height) {
    const title = 'Spectrogram of ' + spectrum.name;
    Object.assign(this, {timeline, spectrum, height, title});
    this.node = el('div.chart');
    this.canvas = el('canvas', {style: 'display:block;width:100%;height:' + height + 'px', role: 'img', 'aria-label': title + ', Hz, over time'});
    this.node.append(this.canvas);
    parent.append(this.node);
    this.node.classList.add('saved');
    this.node.append(sb.saveButtons({title: () => title, drawing: () => this.drawing(), rows: () => this.savedRows()}));
    this.picture = this.paint();
    sb.attachTimeInput(this.node, timeline);
    sb.attachCursor(this.node, timeline, this);
    for (const what of ['window', 'theme']) timeline.on(what, () => this.draw(), this);
    new ResizeObserver(() => this.draw()).observe(this.node);
    this.draw();
  }

  savedRows() {
    const {time, columns, bin_hz, unit} = this.spectrum;
    const head = columns.map((_, bin) => sb.significant(bin * bin_hz, 6) + ' Hz [' + unit + ']');
    return [['t [s]', ...head], ...Array.from(time, (t, row) => [t, ...columns.map(column => column[row])])];
  }

  drawing() {
    const width = this.node.clientWidth, [from, to] = this.timeline.window;
    const drawing = new sb.Drawing(width, this.height + 20);
    drawing.picture(0, 0, width, this.height, this.canvas);
    for (const t of d3.scale.linear().domain([from, to]).ticks(8)) {
      const x = sb.axisWidth + (t - from) / (to - from) * (width - sb.axisWidth - sb.rightGap);
      drawing.text(x, this.height + 14, sb.significant(+t.toFixed(5), 6) + ' s', 'middle');
    }
    return drawing;
  }

  // One pixel a bin and row, the highest bin on top.
  paint() {
    const {columns, time} = this.spectrum;
    const largest = d3.max(columns, column => d3.max(column)) || 1;
    const canvas = el('canvas', {width: time.length, height: columns.length});
    const pen = canvas.getContext('2d');
    const image = pen.createImageData(time.length, columns.length);
    columns.forEach((column, bin) => {
      for (let row = 0; row < time.length; ++row) {
        const level = column[row] > 0 ? 1 + Math.log10(column[row] / largest) / decades : 0;
        const colour = d3.rgb(ramp(level));
        image.data.set([colour.r, colour.g, colour.b, 255], 4 * ((columns.length - 1 - bin) * time.length + row));
      }
    });
    pen.putImageData(image, 0, 0);
    return canvas;
  }

  draw() {
    const {time, columns, bin_hz, window_s} = this.spectrum;
    const width = this.node.clientWidth, ratio = Math.max(2, window.devicePixelRatio || 1);
    this.canvas.width = width * ratio;
    this.canvas.height = this.height * ratio;
    const pen = this.canvas.getContext('2d');
    pen.scale(ratio, ratio);
    const left = sb.axisWidth, plot = width - left - sb.rightGap;
    const [from, to] = this.timeline.window;
    const x = t => left + (t - from) / (to - from) * plot;
    pen.font = '11px system-ui, "DejaVu Sans", sans-serif';
    pen.textAlign = 'right';
    pen.textBaseline = 'middle';
    pen.fillStyle = sb.colour('soft');
    const top_hz = (columns.length - 0.5) * bin_hz;
    for (const tick of d3.scale.linear().domain([0, top_hz]).ticks(4)) {
      const middle = this.height * (1 - (tick + 0.5 * bin_hz) / (columns.length * bin_hz));
      pen.fillText(sb.significant(tick, 4), left - 5, Math.min(this.height - 6, Math.max(6, middle)));  // all of it on the picture
    }
    pen.save();
    pen.beginPath();
    pen.rect(left, 0, plot, this.height);
    pen.clip();
    pen.fillStyle = sb.colour('panel');
    pen.fillRect(left, 0, plot, this.height);
    pen.imageSmoothingEnabled = false;
    // A row is drawn around the middle of its window.
    const hop = time.length > 1 ? (time[time.length - 1] - time[0]) / (time.length - 1) : window_s;
    const middle = t => t - 0.5 * window_s;
    const start = x(middle(time[0]) - 0.5 * hop), end = x(middle(time[time.length - 1]) + 0.5 * hop);
    pen.drawImage(this.picture, start, 0, end - start, this.height);
    pen.restore();
  }
}

// Values of a channel in groups small enough for one chart: those whose names begin alike ("T4_W", "T4_N"), or all of them.
function groupsOf(channel) {
  if (channel.names.length <= 4) return [{name: '', columns: d3.range(channel.names.length)}];
  const groups = {};
  channel.names.forEach((name, i) => (groups[name.split('_')[0]] = groups[name.split('_')[0]] || []).push(i));
  return Object.entries(groups).map(([name, columns]) => ({name, columns}));
}

// Charts of one channel, with a choice of the group where there are several.
function channelCharts(channel, recording, timeline) {
  const groups = groupsOf(channel);
  const node = el('div'), host = el('div');
  let chart = null;
  const draw = group => {
    if (chart) timeline.forget([chart]);
    host.replaceChildren();
    const names = group.columns.map(i => channel.names[i]);
    host.append(sb.legendOf(names.map((name, i) => ({name, colour: sb.channelColours[i]}))));
    chart = new sb.LineChart(host, timeline, {
      name: sb.channelWord(recording.type, channel.key).name + (group.name ? ' ' + group.name : ''),
      rows: channel.time,
      columns: group.columns.map(i => channel.columns[i]),
      labels: names,
      unit: channel.unit,
      colours: sb.channelColours,
      range: d3.extent(group.columns.flatMap(i => d3.extent(channel.columns[i]))),
      solid: true,
      step: true,
      height: 120,
      bands: recording.padRuns.strict,
      strip: null
    });
  };
  const word = sb.channelWord(recording.type, channel.key);
  const unit = sb.symbol(channel.unit) ? ', ' + sb.symbol(channel.unit) : '';
  const select = groups.length > 1 && el('select', {'aria-label': 'Values of ' + word.name, onchange: event => draw(groups[+event.target.value])},
                                         groups.map((group, i) => el('option', {value: i}, group.name)));
  node.append(
      el('div.chart-title', {}, el('span', {}, el('b', {}, word.name + unit), ' ', word.note)),
      ...select ? [el('div.controls', {}, el('label', {}, 'show', select))] : [], host);
  const middle = Math.floor(groups.length / 2);
  if (select) select.value = String(middle);
  return {node, draw: () => draw(groups[middle])};
}

sb.channelColours = ['fx', 'fy', 'slip', 'fz'];
sb.legendOf = entries => el(
    'div.legend', {}, entries.map(({name, colour}) => el('span', {}, el('b', {style: 'color:var(--' + colour + ')'}, '━━'), name)));

// The section of a sensor's channels; null where every channel is one of its units' curves.
sb.channelSection = (recording, timeline) => {
  if (!recording.channels.length && !recording.spectra.length) return null;
  const section = el('section', {}, el('h2', {}, 'What the sensor emits'));
  const charts = recording.channels.map(channel => channelCharts(channel, recording, timeline));
  return {
    section,
    draw() {
      for (const spectrum of recording.spectra) {
        section.append(el(
            'div.chart-title', {},
            el('span', {}, el('b', {}, 'Spectrogram of ' + spectrum.name + ', Hz'), ' ',
               'windows of ' + sb.quantity(spectrum.window_s * 1e3, 'ms') + ', without their straight line, Hamming; ' + decades +
                   ' decades below the strongest are dark')));
        new Spectrogram(section, timeline, spectrum, 110);
      }
      for (const chart of charts) {
        section.append(chart.node);
        chart.draw();
      }
    }
  };
};
})(window.slipbench);
