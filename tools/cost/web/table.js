// The table of all runs, with their times, errors and failures.
const el = sb.element;
const choice = sb.choice;

const spread = ({cpu_s: cpu}) => cpu && cpu.median > 0 && cpu.low !== null ? (cpu.high - cpu.low) / (2 * cpu.median) : null;

function columns() {
  return [
    {
      title: 'series',
      kind: 'text',
      value: row => choice.seriesTitle(row),
      cell: row => [sb.swatch(choice.seriesIndex(row), choice.kind(row)), choice.seriesTitle(row)]
    },
    {
      title: 'settings',
      kind: 'text.long',
      value: row => row.settings,
      cell: row => [
        el('button.link', {onclick: () => choice.select(row)}, row.settings), row.own && el('span.tag', {}, 'own'),
        row.why && el(choice.notRun(row) ? 'span.why.pending' : 'span.why', {}, row.why)
      ]
    },
    {
      title: 'end',
      kind: 'text',
      value: row => choice.ending(row),
      cell: row => row.status === 'ok' ? 'ok' : el(choice.notRun(row) ? 'span.pending' : 'b.why', {}, choice.ending(row))
    },
    ...choice.rows.some(row => row.rate_hz) ? [{
      title: 'output',
      value: row => row.rate_hz,
      cell: row => row.rate_hz ? sb.rateText(row.rate_hz) : sb.missing,
      note: 'rate of the fastest sensor'
    }] : [],
    {title: 'CPU / simulated s', value: row => row.cost, cell: row => sb.duration(row.cost), note: 'median'},
    {
      title: '±',
      value: spread,
      cell: row => spread(row) !== null ? sb.percentText(spread(row)) : row.cpu_s ? sb.fewRuns(row.cpu_s) : sb.missing,
      note: 'half the spread of the CPU time'
    },
    {
      title: '× real time',
      value: row => row.cost > 0 ? 1 / row.cost : null,
      cell: row => row.cost > 0 ? sb.figure(1 / row.cost) : sb.missing
    },
    ...choice.measures.map(measure => ({
      title: measure.title,
      note: measure.definition,
      value: row => choice.differs(row, measure) ? Infinity : choice.error(row, measure),
      cell: row => [
        choice.errorText(row, measure), choice.onFront(row, measure) && el('span.tag', {title: 'on the Pareto front'}, 'front')
      ]
    })),
    {title: '', kind: 'text', cell: row => row.command ? sb.copyButton(row.command) : ''},
  ];
}

sb.rowsSection = () => {
  const nodes = new Map();
  const table = sb.sortedTable(columns(), choice.rows, (row, cells) => {
    nodes.set(row, el('tr', {onclick: () => choice.select(row)}, cells));
    return nodes.get(row);
  });
  const holder = el('div.scroll.tall.runs', {tabindex: 0, role: 'region', 'aria-label': 'All runs'}, table.node);
  const mark = () => {
    for (const [row, node] of nodes) node.classList.toggle('current', row === choice.selected);
    const node = nodes.get(choice.selected);
    // Scrolls the table alone, so that the diagram stays in view.
    if (!node) return;
    const head = 40;
    if (node.offsetTop < holder.scrollTop + head) holder.scrollTop = node.offsetTop - head;
    if (node.offsetTop + node.offsetHeight > holder.scrollTop + holder.clientHeight)
      holder.scrollTop = node.offsetTop + node.offsetHeight - holder.clientHeight;
  };
  const note = el('p.note');
  const view = () => {
    note.textContent = 'Errors: the ' + choice.statistic + ' of each run. Click a heading to sort, a row to show it in the diagram.';
    table.refresh();
    mark();
  };
  choice.addEventListener('row', mark);
  choice.addEventListener('view', view);
  view();
  return sb.section('All runs', '', note, holder);
};
