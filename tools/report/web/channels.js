// Channels of the sensor as a whole over time, and their spectra.
const el = sb.element, mark = sb.mark;

// Colours of magnitude 0 to 1, from dark to bright, also in greyscale print.
const ramp = d3.scaleLinear([0, 0.25, 0.5, 0.75, 1], ['#0b1330', '#3b2f7f', '#a3386f', '#ee7b3c', '#fbe7a1']).clamp(true);
const decades = 2.5;  // range of the colours below the strongest value

// A spectrogram. spectrum: {bin_hz, window_s, time, columns: one per bin, unit}; each row is the
// window that ended at its time.
class Spectrogram extends sb.TimeChart {
  constructor(parent, timeline, spectrum, height) {
    const title = 'Spectrogram of ' + spectrum.name;
    super(parent, timeline, title, title + ', Hz, over time', height, 0);
    Object.assign(this, {spectrum, picture: this.paint(spectrum)});
  }

  savedRows() {
    const {time, columns, bin_hz, unit} = this.spectrum;
    const head = columns.map((_, bin) => sb.significant(bin * bin_hz, 6) + ' Hz [' + unit + ']');
    return [['t [s]', ...head], ...Array.from(time, (t, row) => [t, ...columns.map(column => column[row])])];
  }

  // One pixel per bin and row, the highest bin on top.
  paint({columns, time}) {
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
    return canvas.toDataURL();
  }

  contents() {
    const {height, picture: href, spectrum: {time, columns, bin_hz, window_s}} = this;
    const first = time[0], last = time[time.length - 1];
    // A row is centred on the middle of its window.
    const hop = time.length > 1 ? (last - first) / (time.length - 1) : window_s;
    const [x, end] = [first - 0.5 * hop, last + 0.5 * hop].map(t => this.x(t - 0.5 * window_s));
    const ticks = d3.ticks(0, (columns.length - 0.5) * bin_hz, 4);
    const middle = tick => height * (1 - (tick + 0.5 * bin_hz) / (columns.length * bin_hz));
    const within = y => Math.min(height - 2, Math.max(9, y + 4));  // keeps the label inside the picture
    return [
      ticks.map(tick => sb.text(sb.plotLeft - 5, within(middle(tick)), 'end', sb.significant(tick, 4))), this.clipped([
        mark('rect', {x: sb.plotLeft, width: this.plot, height, fill: 'var(--panel)'}),
        mark('image', {x, y: 0, width: end - x, height, href, preserveAspectRatio: 'none', style: 'image-rendering:pixelated'})
      ])
    ];
  }
}

// Groups of a channel's values, small enough for one chart: those that differ in the last part of
// their names ("T4_W", "T4_N"), or all.
function groupsOf(channel) {
  if (channel.names.length <= 4) return [{name: '', columns: d3.range(channel.names.length)}];
  const groups = d3.groups(d3.range(channel.names.length), i => channel.names[i].replace(/_[^_]*$/, ''));
  if (groups.length === 1) return channel.names.map((name, i) => ({name, columns: [i]}));
  return groups.map(([name, columns]) => ({name, columns}));
}

// Charts of one channel, with a choice if there are several groups.
function channelCharts(channel, recording, timeline) {
  const groups = groupsOf(channel), middle = Math.floor(groups.length / 2);
  const word = sb.channelWord(recording.type, channel.key), symbol = sb.symbol(channel.unit);
  const host = el('div');
  let chart = null;
  const draw = group => {
    chart?.release();
    const labels = group.columns.map(i => channel.names[i]);
    host.replaceChildren(sb.legendOf(labels.map((name, i) => ({name, colour: sb.channelColours[i]}))));
    chart = new sb.LineChart(host, timeline, {
      name: word.name + (group.name ? ' ' + group.name : ''), rows: channel.time,
      columns: group.columns.map(i => channel.columns[i]), labels, unit: channel.unit, colours: sb.channelColours,
      solid: true, step: true, height: 120, bands: recording.padRuns.strict
    });
  };
  const select = () =>
      sb.select({'aria-label': 'Values of ' + word.name}, groups.map(({name}, i) => [i, name]), middle, i => draw(groups[i]));
  return {
    node: el('div', {}, sb.chartTitle(word.name + (symbol ? ', ' + symbol : ''), word.note),
             groups.length > 1 && el('div.controls', {}, el('label', {}, 'show', select())), host),
    draw: () => draw(groups[middle])
  };
}

sb.channelColours = ['fx', 'fy', 'slip', 'fz'];
sb.legendOf = entries => el('div.legend', {}, entries.map(
    ({name, colour, dashed}) => el('span', {}, el('b', {style: 'color:var(--' + colour + ')'}, dashed ? '╍╍' : '━━'), name)));
sb.chartTitle = (name, note) => el('div.chart-title', {}, el('span', {}, el('b', {}, name), ' ', note || ''));

// Section of a sensor's channels; null if every channel is a curve of its units.
sb.channelSection = (recording, timeline) => {
  if (!recording.channels.length && !recording.spectra.length) return null;
  const section = sb.section('Readings of the sensor', '');
  const charts = recording.channels.map(channel => channelCharts(channel, recording, timeline));
  return {
    section,
    draw() {
      for (const spectrum of recording.spectra) {
        const note = 'windows of ' + sb.quantity(spectrum.window_s * 1e3, 'ms') + ', detrended, Hamming; ' +
            decades + ' decades below the maximum are dark';
        section.append(sb.chartTitle('Spectrogram of ' + spectrum.name + ', Hz', note));
        new Spectrogram(section, timeline, spectrum, 110);
      }
      for (const chart of charts) {
        section.append(chart.node);
        chart.draw();
      }
    }
  };
};
