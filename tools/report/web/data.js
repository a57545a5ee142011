// Data of the page: unpacked arrays with named access.

async function inflate(base64) {
  const bytes = Uint8Array.from(atob(base64), c => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Inverse of tools/page/page.cc: columns as arrays.
sb.unpack = async packed => {
  const bytes = await inflate(packed.data);
  const {rows, columns} = packed;
  const count = rows * columns;
  if (packed.codec === 'bytes') {
    return Array.from({length: columns}, (_, c) => bytes.subarray(c * rows, (c + 1) * rows));
  }
  const values = packed.codec === 'delta32' ? new Float64Array(count) : new Float32Array(count);
  for (let c = 0; c < columns; ++c) {
    let code = 0;
    for (let i = c * rows; i < (c + 1) * rows; ++i) {
      if (packed.codec === 'delta32') {
        code = (code + (bytes[i] | bytes[count + i] << 8 | bytes[2 * count + i] << 16 | bytes[3 * count + i] << 24)) | 0;
      } else {
        code = ((code + (bytes[i] | bytes[count + i] << 8)) << 16) >> 16;
      }
      values[i] = packed.codec === 'delta16' && code === -32768 ? NaN : code * packed.step;
    }
  }
  return Array.from({length: columns}, (_, c) => values.subarray(c * rows, (c + 1) * rows));
};

// Runs of equal states: [{state, from, to}] in seconds; `to` is the time of the first sample of the
// next run.
function runsOf(states, time) {
  const runs = [];
  let start = 0;
  for (let i = 1; i <= states.length; ++i) {
    if (i < states.length && states[i] === states[start]) continue;
    runs.push({state: states[start], from: time[start], to: time[Math.min(i, states.length - 1)]});
    start = i;
  }
  return runs;
}

// Row at or just before t of ascending times; 0 if all are later.
sb.rowAt = (time, t) => Math.max(0, d3.bisectRight(time, t + 1e-9) - 1);

// One sensor of one trial.
class Recording {
  static async load(trial, payload) {
    const {unpack} = sb;
    const [time] = await unpack(payload.time);
    const recording = Object.assign(new Recording(), payload, {trial, time, units: payload.positions.length});
    recording.curveTime = recording.time.filter((_, i) => i % payload.stride === 0);
    recording.curves = {};
    for (const curve of payload.curves) {
      recording.curves[curve.origin + '/' + curve.key] = {...curve, columns: await unpack(curve.data)};
    }
    const rows = async held => ({...held, time: (await unpack(held.time))[0], columns: await unpack(held.data)});
    recording.channels = await Promise.all(payload.channels.map(rows));
    recording.spectra = await Promise.all(payload.spectra.map(rows));
    recording.unitStates = await unpack(payload.states.unit);
    recording.unitRuns = recording.unitStates.map(states => runsOf(states, recording.time));
    recording.padStates = {};
    recording.padRuns = {};
    // By each rule, and from the detector if there is one.
    for (const key of [...sb.rules.map(rule => rule.key), 'seen'].filter(name => payload.states[name])) {
      recording.padStates[key] = (await unpack(payload.states[key]))[0];
      recording.padRuns[key] = runsOf(recording.padStates[key], time);
    }
    recording.addSlipSpeed();
    return recording;
  }

  // Columns of one unit of a curve, one per component.
  columns(key, unit) {
    const curve = this.curves[key];
    const count = curve.components.length;
    return curve.columns.slice(unit * count, (unit + 1) * count);
  }

  // Value of a component of a unit (or of the sensor, unit 0) at a sample.
  at(key, unit, component, sample) {
    const curve = this.curves[key];
    return curve.columns[unit * curve.components.length + component][Math.floor(sample / this.stride)];
  }

  // Sample at or just before a time.
  sampleAt(t) {
    return sb.rowAt(this.time, t);
  }

  // A channel of the sensor by its key, {time, unit, columns, names}; undefined if there is none.
  emitted(key) {
    const curve = this.curves['sensor/' + key];
    if (!curve) return this.channels.find(channel => channel.key === key);
    const {unit, columns, components} = curve, each = components.length;
    const name = (_, i) => sb.unitName(this.type, Math.floor(i / each)) + (each > 1 ? ' ' + components[i % each] : '');
    return {time: this.curveTime, unit, columns, names: columns.map(name)};
  }

  // Largest magnitude of the components from `from` to `to`.
  largest(key, from, to) {
    const size = parts => d3.max(d3.range(this.curveTime.length), row => Math.hypot(...parts.map(column => column[row])));
    return d3.max(d3.range(this.units), unit => size(this.columns(key, unit).slice(from, to))) || 0;
  }

  // Derived: speed of each unit, and mean and largest over the touching units.
  addSlipSpeed() {
    const velocity = this.curves['labels/slip_velocity'];
    const rows = d3.range(this.curveTime.length);
    const columns = d3.range(this.units).map(unit => {
      const [x, y] = velocity.columns.slice(2 * unit);
      return Float32Array.from(rows, row => Math.hypot(x[row], y[row]));
    });
    const touching = row =>
        columns.filter((_, unit) => this.unitStates[unit][row * this.stride] !== 0).map(column => column[row]);
    const mean = Float32Array.from(rows, row => d3.mean(touching(row)) ?? NaN);
    const top = Float32Array.from(rows, row => d3.max(touching(row)) ?? 0);
    this.curves['labels/slip_speed'] = {unit: 'm/s', components: ['speed'], per_unit: true, columns};
    this.curves['labels/pad_speed'] = {unit: 'm/s', components: ['largest', 'mean'], per_unit: false, columns: [top, mean]};
  }
}

sb.page = JSON.parse(document.getElementById('slipbench-data').textContent);
sb.rules = sb.page.rules;
const recorded = new Set(sb.page.recorded);
sb.isEmbedded = index => recorded.has(index);

// Recordings are after the scripts, so that the overview is drawn before they are parsed.
const whole = new Promise(done => document.readyState === 'loading' ? document.addEventListener('DOMContentLoaded', done) : done());
const parsed = {};
// Embedded data of a trial: {sensors, grasp}.
sb.recorded = async index => {
  await whole;
  parsed[index] = parsed[index] || JSON.parse(document.getElementById('recording-' + index).textContent);
  return parsed[index];
};
const loaded = {};
// The recording of one sensor of a trial.
sb.recording = async (index, sensor) => {
  const {sensors} = await sb.recorded(index);
  const key = index + ' ' + sensor;
  loaded[key] = loaded[key] || Recording.load(index, sensors.find(({name}) => name === sensor));
  return loaded[key];
};
