// Names, units and definitions that the page uses more than once.

sb.states = {
  // unit_state of the dataset
  unit: [
    {key: 'detached', name: 'detached', meaning: 'no contact'},
    {key: 'stick', name: 'stick', meaning: 'all of it sticks'},
    {key: 'slip', name: 'slip', meaning: 'all of it slips'},
    {key: 'partial', name: 'partial', meaning: 'a part of it slips'},
  ],
  // state, state_micro, state_paper of the dataset
  pad: [
    {key: 'detached', name: 'no contact'},
    {key: 'stick', name: 'non-slip'},
    {key: 'partial', name: 'incipient'},
    {key: 'slip', name: 'gross'},
  ],
};

// Presentation of a sensor type, from its entry in the catalogue (view_payload() in
// report_trial.h).
sb.sensorView = type => sb.page.sensor_types[type];
sb.unitWord = type => sb.sensorView(type).unit;
sb.unitWords = type => sb.sensorView(type).units;
sb.unitName = (type, index) => sb.sensorView(type).letter + (index + sb.sensorView(type).first);
sb.channelWord = (type, key) => sb.sensorView(type).channels[key] || {name: key, note: ''};

// Orientation of a pad's drawing: the axes that point right and up, and the viewpoint.
sb.padView = type => {
  const {from_behind, orientation} = sb.sensorView(type);
  return from_behind ? {
    right: 0,
    up: 1,
    note: ['seen through the sensor from behind', ...(orientation ? [orientation] : [])].join(', ') + '; +Z points towards the reader'
  } : {right: 1, up: 0, note: 'seen from the surface it touches; +Z points away from the reader, into the sensor'};
};

// SI symbol -> factor and displayed symbol.
const shown = {
  'm': [1e3, 'mm'],
  'm/s': [1e3, 'mm/s'],
  'm/s2': [1e3, 'mm/s²'],
  'rad': [180 / Math.PI, '°'],
  'rad/s': [180 / Math.PI, '°/s'],
  'rad/s2': [180 / Math.PI, '°/s²'],
  'N/m': [1e-3, 'N/mm'],
  'kg': [1e3, 'g'],
};
sb.factor = unit => (shown[unit] || [1, unit])[0];
sb.symbol = unit => (shown[unit] || [1, unit])[1];

// Limits up to which an SI value is rounding of sums and angles of doubles. Other units have no
// such limit.
const rounding = {s: 1e-12, m: 1e-15, 'm/s': 1e-15, rad: 1e-12, 'rad/s': 1e-12, N: 1e-12};
// An SI value; 0 if it is below the rounding limit, or below half of its quantisation step.
sb.rounded = (value, unit, half = 0) => value !== null && Math.abs(value) <= Math.max(rounding[unit] || 0, half) ? 0 : value;

// An SI value with its displayed unit: 0.004 m/s -> "4 mm/s". `half`: as in sb.rounded().
sb.quantity = (value, unit, digits, half) => {
  const held = sb.rounded(value, unit, half);
  const text = sb.significant(held === null ? null : held * sb.factor(unit), digits || 3);
  const symbol = sb.symbol(unit);
  return text === sb.missing || !symbol ? text : text + (symbol.startsWith('°') ? '' : ' ') + symbol;
};
sb.seconds = value => value === null ? 'never' : sb.fixed(value, 3) + ' s';
sb.milliseconds = value =>
    value === null ? sb.missing : (Math.abs(value) < 0.1 ? sb.fixed(value * 1e3, 1) : sb.fixed(value * 1e3, 0)) + ' ms';
sb.percent = value =>
    value === null ? sb.missing : (value > 0 && value < 0.1 ? sb.fixed(value * 100, 1) : sb.fixed(value * 100, 0)) + ' %';

// Scene paths in words: "motion.speed" -> "speed".
const pathWords = {
  'motion.speed': 'speed',
  'motion.compression': 'compression',
  'motion.direction': 'direction',
  'motion.rotation': 'rotation',
  'motion.tilt.0': 'tilt about X',
  'motion.tilt.1': 'tilt about Y',
  'motion.pivot': 'pivot',
  'motion.stop': 'stop',
  'motion.acceleration': 'acceleration',
  'motion.angular_acceleration': 'angular acceleration',
  'friction.static': 'static friction',
  'friction.kinetic': 'kinetic friction',
  'friction.scale': 'friction scale',
  'surface.material': 'material',
  'box.mass': 'mass',
  'grip.preset': 'preset force',
  'grip.protocol': 'protocol',
  'detector.type': 'detector',
  'controller.type': 'controller',
  'detector.flip': 'share of flipped classes'
};
sb.pathWord = path => pathWords[path] || path;
// Text for an infinite value.
sb.endless = unit => unit === 's' ? 'never' : 'no limit';
sb.parameter = (plain, digits) => plain === undefined ? sb.missing :
    plain.value === null                              ? sb.endless(plain.unit) :
    'value' in plain                                  ? sb.quantity(plain.value, plain.unit, digits) :
                                                        plain.text;

sb.definitions = [
  [
    'unit states',
    'Truth of the contact model, no threshold. Detached: no contact. Stick: all of the unit sticks. Partial: some of its ' +
        'friction points slip. Slip: all of them slip.'
  ],
  ['strict', 'Non-slip: no touching unit slips as a whole. Incipient: some do. Gross: all do. A sensor with a single unit slips when a part of it does.'],
  ['micro', 'The same, but a unit slips as soon as a part of it slips.'],
  [
    'paper',
    "Label by the rule of the sensor's paper, computed from the same contact. Its difference from strict " +
        "is the bias of that rule."
  ],
  [
    'onsets',
    'Resolved within the time step. First micro-slip: a part of some unit slips for the first time. First full slip: a unit ' +
        'slips as a whole for the first time. Gross: all touching units slip.'
  ],
  ['margin', '1 − f_t / (μ_s f_n) of a unit: 1 without tangential force, 0 at the onset of slip.'],
  ['stuck fraction', 'Share of the touching friction points that stick.'],
  [
    'slip speed', 'Speed of the slipping tip over the surface, mean over the step; a partially slipping unit counts by the slipping part.'
  ],
  ['slip centre', 'Point of the pad about which the slip rotates at that instant; the slip angle is the accumulated rotation.'],
  ['motion start', 'The first sample after the first touch at which a body moves sideways or turns; in a grasp the last sample before the lift.'],
];
