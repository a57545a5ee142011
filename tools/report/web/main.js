// Builds the page: header, views, footer.
const el = sb.element;
const page = sb.page;
let timeline = null;  // of the trial on the page
let view = null;      // {trial: index or null, sensor: name}

// Number of trials in the file, and number on this page.
function trialsText() {
  const [held, here] = [page.trials_in_file, page.trials.length].map(count => count.toLocaleString('en'));
  return held === here ? held : held + ', ' + here + ' of them on this page';
}

// Digests of the files; folded if there are several.
function digests() {
  const known = page.content_sha256.filter(text => text);
  const lines = known.map(text => el('p', {}, 'Content SHA-256 ', el('code', {}, text)));
  return known.length < 2 ? lines : el('details', {}, el('summary', {}, 'Content SHA-256 of the ' + known.length + ' files'), lines);
}

function header() {
  const overrides = Object.entries(page.overrides).map(
      ([path, value]) => ['set', el('code', {}, path + ' = ' + (typeof value === 'string' ? value : JSON.stringify(value)))]);
  return el(
      'header', {}, el('p.eyebrow', {}, 'slipbench report'), el('h1', {}, page.description || page.file),
      !page.complete &&
          el('p.warning', {}, 'The run that wrote this file was interrupted; the file contains the finished trials.'),
      page.no_replay &&
          el('p.warning', {},
             'These trials cannot be repeated from the command line (' + page.no_replay +
                 '). Repeat them in the Python program that defines that part.'),
      page.failed.length > 0 && failures(), (page.warnings || []).map(({text}) => el('p.warning', {}, 'Warning: ' + text)),
      sb.facts(
          'meta',
          [
            ['file', page.file], ['trials', trialsText()], ['seed', page.seed], ['slipbench', page.version],
            page.no_replay ? ['in Python', el('code', {}, sb.pythonCommand())] : ['command', el('code', {}, page.command)],
            ...overrides
          ]),
      el('details.scene', {}, el('summary', {}, 'Scene file'), el('pre.mono', {}, page.scene)));
}

// Failed trials, which the file does not contain.
function failures() {
  const again = trial => page.no_replay ? sb.replayCommand({index: trial.trial}) : trial.command;
  const planned = page.trials.length + page.failed.length;
  return el(
      'details.warning', {}, el('summary', {}, page.failed.length + ' of ' + planned + ' trials failed and are not in this file'),
      el('ul', {}, page.failed.map(trial => el('li', {}, trial.message, ' ', el('code', {}, again(trial))))));
}

function footer() {
  return el(
      'footer', {}, el('h2', {}, 'Definitions of the labels'),
      el('dl', {}, sb.definitions.map(([name, text]) => [el('dt', {}, name), el('dd', {}, text)])),
      el('p', {}, 'This page stores curves with a resolution of 16 bits; ', el('code', {}, page.file),
         ' contains them with full resolution.'),
      digests(),
      el('details', {}, el('summary', {}, 'Licence of the library in this page'),
         el('pre', {}, document.getElementById('licences').textContent.trim())));
}

// Parameters of one trial on a line.
const drawn = trial => sb.facts('meta', [
  ['trial', String(trial.index)], ['seed', trial.seed], ['samples', String(trial.samples)],
  ...Object.entries(trial.params).map(([path, value]) => [sb.pathWord(path), sb.parameter(value, 4)])
]);

// Sensors with values beyond their range, and how often.
function saturation(trials) {
  const by_sensor = {};
  for (const {saturated} of trials) {
    for (const [name, samples] of Object.entries(saturated || {})) {
      const held = by_sensor[name] = by_sensor[name] || {samples: 0, trials: 0};
      held.samples += samples;
      ++held.trials;
    }
  }
  return Object.entries(by_sensor).map(
      ([name, held]) => el('p.warning', {}, 'Sensor ' + name + ' has values beyond its range in ' + held.samples + ' samples' +
                           (trials.length > 1 ? ' of ' + held.trials + ' trials' : '') + '. A converter clips them; the part valid_range only counts them.'));
}

function navigation() {
  const several = page.trials.length > 1;
  const embedded = page.trials.filter(trial => sb.isEmbedded(trial.index));
  const tab = (text, trial) => el('button', {'aria-current': String(view.trial === trial), onclick: () => show({trial})}, text);
  // Too many trials for buttons side by side.
  const many = embedded.length > 12;
  const place = embedded.findIndex(trial => trial.index === view.trial);
  const beside = (text, title, at) =>
      el('button', {title, disabled: embedded[at] ? null : '', onclick: () => show({trial: embedded[at].index})}, text);
  const outcome = ({grasp}) => grasp ? ': ' + sb.graspEnd(grasp) : '';
  const unknown = place < 0 && el('option', {value: '', selected: '', disabled: ''}, 'a trial …');
  const options = embedded.map(trial => [trial.index, 'Trial ' + trial.index + outcome(trial)]);
  const picker = () => {
    const select = sb.select({'aria-label': 'Trial'}, options, view.trial, index => show({trial: +index}));
    if (unknown) select.prepend(unknown);
    return [
      beside('‹', 'Previous trial', place < 0 ? -1 : place - 1), select, beside('›', 'Next trial', place + 1)
    ];
  };
  const sensors = view.trial === null ? [] : Object.keys(page.trials.find(trial => trial.index === view.trial).sensors);
  if (!several && sensors.length < 2) return null;
  const names = sensors.map(name => [name, name]);
  return el(
      'nav.views', {},
      several && [tab('All trials', null), many ? picker() : embedded.map(trial => tab('Trial ' + trial.index, trial.index))],
      el('span.gap'),
      sensors.length > 1 &&
          sb.select({'aria-label': 'Sensor'}, names, view.sensor, sensor => show({trial: view.trial, sensor})));
}

// Shows the overview (trial null) or a trial.
async function show(next) {
  view = next;
  if (timeline) timeline.play(false);
  timeline = null;
  const host = el('main');
  const trial = page.trials.find(candidate => candidate.index === view.trial);
  if (trial && !view.sensor) view.sensor = sb.openingSensor(trial);
  const nodes = [header(), navigation(), trial ? drawn(trial) : null, ...saturation(trial ? [trial] : page.trials), host, footer()];
  document.getElementById('page').replaceChildren(...nodes.filter(node => node));
  const address = view.trial === null ? '#all' : '#trial-' + view.trial;
  if (location.hash !== address) history.replaceState(null, '', address);
  if (trial)
    timeline = await sb.showTrial(host, view.trial, view.sensor);
  else
    sb.showDataset(host, index => {
      show({trial: index});
      window.scrollTo(0, 0);
    });
}

// The view in the address, else the default of the report.
function firstView() {
  const match = /^#trial-(\d+)$/.exec(location.hash);
  if (match && sb.isEmbedded(+match[1])) return {trial: +match[1]};
  if (location.hash === '#all' && page.trials.length > 1) return {trial: null};
  if (page.open !== null) return {trial: page.open};
  return {trial: page.trials.length === 1 && sb.isEmbedded(page.trials[0].index) ? page.trials[0].index : null};
}

document.addEventListener('keydown', event => {
  const typing =
      ['INPUT', 'SELECT', 'BUTTON', 'TEXTAREA', 'SUMMARY'].includes(event.target.tagName) && event.target.type !== 'range';
  if (timeline && !typing && !event.ctrlKey && !event.metaKey && !event.altKey) timeline.key(event);
});

const problem = text => document.getElementById('page').replaceChildren(el('p.wait', {}, text));
sb.drawHatch();
if (typeof DecompressionStream === 'undefined') {
  problem('This browser is too old for this page. Use Chrome or Edge 80, Firefox 113, Safari 16.4, or newer.');
} else {
  show(firstView()).catch(error => {
    problem('The report could not be drawn: ' + error.message);
    throw error;
  });
}
