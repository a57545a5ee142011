// Builds the page: header, sentences, sections, footer.
const el = sb.element;
const data = sb.data;
const explored = 'slipbench_cost' in data;
const stability = explored ? data.stability : data;

function header() {
  const time = data.elapsed_s === undefined ?
      null :
      sb.duration(data.elapsed_s) + (data.budget_s ? ' of ' + sb.duration(data.budget_s) : '');
  return el(
      'header', {}, el('p.eyebrow', {}, explored ? 'slipbench cost' : 'slipbench cost --stability'),
      el('h1', {}, explored ? data.description || data.scene : 'Longest stable time step'), sb.facts('meta', [
        ['scene', data.scene], ['simulated', data.simulated_s ? sb.duration(data.simulated_s) : null], ['seed', data.seed],
        ['measured for', time]
      ]),
      data.command && el('p.commandline', {}, el('code', {}, data.command), ' ', sb.copyButton(data.command)));
}

const sentences = () => el('ul.sentences', {}, (data.sentences || []).map(text => el('li', {}, text)));

const interrupted = () => el(
    'p.warning', {}, el('b', {}, 'The timing ended early: '),
    'it was interrupted. The results are incomplete: figures of few runs scatter more, and settings that are missing may be cheaper.');

function reference() {
  const reference = data.reference;
  return el(
      reference.converged ? 'p.note' : 'p.warning', {},
      !reference.converged && el('b', {}, 'The reference has not converged. '), reference.text,
      ' ', sb.copyButton(reference.command));
}

const remarks = texts => texts.length ? sb.section('Remarks', '', el('ul', {}, texts.map(text => el('li', {}, text)))) : null;

const words = {
  cpu: 'CPU', os: 'system', build_type: 'build', mujoco: 'MuJoCo', load: 'system load at the start'
};
const environment = entries => el('dl', {}, Object.entries(entries).map(([name, value]) => [
  el('dt', {}, words[name] || name), el('dd', {}, value === null || value === '' ? sb.missing : String(value))
]));

function footer() {
  const beside = location.pathname.split('/').pop().replace(/\.html$/, '.json');
  return el(
      'footer', {}, el('h2', {}, 'Measured on'), environment(data.environment || {}),
      beside.endsWith('.json') &&
          el('p', {}, 'All figures as JSON: ', el('a', {href: beside}, decodeURIComponent(beside)), ' next to this page.'),
      el('details', {}, el('summary', {}, 'Licence of the library in this page'),
         el('pre', {}, document.getElementById('licences').textContent.trim())));
}

const page = document.getElementById('page');
const parts = [header()];
if (explored) {
  const drawn = sb.choice.rows.length > 0 && sb.choice.measures.length > 0;
  // The diagram comes first, preceded only by what the reader must know to understand it.
  const doubtful = !data.reference.converged;
  parts.push(
      data.interrupted ? interrupted() : null, doubtful ? reference() : null, drawn ? sb.diagramSection() : null, sentences(),
      doubtful ? null : reference());
  if (drawn) parts.push(sb.rowsSection());
  if ((data.effects || []).length) parts.push(sb.effectsSection(data.effects));
}
if (stability) parts.push(sb.stabilitySection(stability));
parts.push(remarks([...(data.remarks || []), ...(explored && stability && stability.remarks || [])]), footer());
page.replaceChildren(...parts.filter(part => part));
