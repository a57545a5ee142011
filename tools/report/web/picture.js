// A sensor's readings, drawn behind the units of its pad.

// Outlines of a cell's parts around its middle: the cell, or the triangles W, N, E and S.
function outlines(parts, half) {
  const corners = [[-half, half], [-half, -half], [half, -half], [half, half]];  // sw, nw, ne, se
  if (parts === 1) return ['M' + corners.join('L') + 'Z'];
  return corners.map((corner, i) => 'M0,0L' + corner + 'L' + corners[(i + 1) % 4] + 'Z');
}

// The darker a part, the larger its reading relative to rest, compared with the trial's maximum.
sb.PadPicture = class {
  // `pad`: sb.Pad, whose sensor type defines the picture. `pitch`: px.
  constructor(svg, pad, pitch) {
    const {recording} = pad, {channel, cells, width, rest, falls, note} = sb.padPicture(recording);
    const {time, unit, columns, names} = recording.emitted(channel);
    Object.assign(this, {time, note});
    const places = cells.map(cell => [pad.x, pad.y].map(along => d3.mean(cell, i => along(recording.positions[i]))));
    const paths = outlines(columns.length / cells.length, 0.5 * width * pitch);
    this.parts = columns.map((column, i) => {
      const at_rest = rest === null ? column[0] : rest;
      const title = sb.mark('title'), place = places[Math.floor(i / paths.length)];
      const path = sb.mark('path', {
        transform: 'translate(' + place + ')', d: paths[i % paths.length], stroke: 'var(--line)',
        'stroke-width': Math.min(0.8, 0.05 * pitch)
      }, title);
      svg.append(path);
      const text = value => names[i] + ': ' + sb.quantity(value, unit, 5) + ', ' + sb.quantity(value - at_rest, unit, 5) +
          (rest === null ? ' from its first reading' : ' from rest');
      return {path, title, text, column, change: row => (column[row] - at_rest) * (falls ? -1 : 1)};
    });
    this.largest = Math.max(1e-9, d3.max(this.parts, ({column, change}) => d3.max(column, (_, row) => Math.abs(change(row)))));
  }

  update(t) {
    const row = sb.rowAt(this.time, t);
    for (const {path, title, text, column, change} of this.parts) {
      path.style.fill = change(row) < 0 ? 'var(--partial)' : 'var(--accent)';
      path.style.fillOpacity = 0.75 * Math.abs(change(row)) / this.largest;
      title.textContent = text(column[row]);
    }
  }
};

// Picture behind the units of a recording: that of its type, by default with one cell per unit.
// Null if the type has none, or the channel is missing or has neither one nor four values per cell.
sb.padPicture = recording => {
  const {picture} = sb.sensorView(recording.type);
  const emitted = picture && recording.emitted(picture.channel);
  if (!emitted) return null;
  const cells = picture.cells.length ? picture.cells : d3.range(recording.units).map(unit => [unit]);
  return [1, 4].includes(emitted.columns.length / cells.length) ? {...picture, cells} : null;
};
