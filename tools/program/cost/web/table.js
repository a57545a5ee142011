// Sortable tables, and the one of all rows.
(function(sb) {
'use strict';
const el = sb.element;
const choice = sb.choice;

// A table whose heads sort it; what has no value stands last. columns: [{title, note, text: left-aligned, wide: may wrap,
// value(row): number, text or null, cell(row): what is shown}]. rowNode(row, cells): the <tr>. Returns {node, refresh}.
sb.sortedTable = (columns, rows, rowNode) => {
  let by = null, ascending = true;
  const body = el('tbody');
  const order = () => {
    if (!by) return rows;
    const empty = value => value === null || value === undefined;
    return rows.slice().sort((a, b) => {
      const p = by.value(a), q = by.value(b);
      if (empty(p) || empty(q)) return empty(p) - empty(q);
      const sign = typeof p === 'string' ? p.localeCompare(q) : p - q;
      return ascending ? sign : -sign;
    });
  };
  const cell = (column, row) => el(column.text ? 'td.text' + (column.wide ? '.long' : '') : 'td', {}, column.cell(row));
  const refresh = () => body.replaceChildren(...order().map(row => rowNode(row, columns.map(column => cell(column, row)))));
  const heads = columns.map(column => {
    const head = el(column.text ? 'th.text' : 'th', {scope: 'col'});
    const sort = () => {
      ascending = by === column ? !ascending : true;
      by = column;
      heads.forEach(other => other.removeAttribute('aria-sort'));
      head.setAttribute('aria-sort', ascending ? 'ascending' : 'descending');
      refresh();
    };
    head.append(column.value ? el('button', {onclick: sort, title: column.note}, column.title) : column.title);
    return head;
  });
  refresh();
  return {node: el('table', {}, el('thead', {}, el('tr', {}, heads)), body), refresh};
};

const percent = share => sb.figure(100 * share, 2) + ' %';

// All rows with their times, errors and failures.
sb.rowsSection = () => {
  const nodes = new Map();
  const spread = ({cpu_s: cpu}) =>
      cpu && cpu.median > 0 && cpu.low !== null ? (cpu.high - cpu.low) / (2 * cpu.median) : null;
  const columns = [
    {
      title: 'series',
      text: true,
      value: row => choice.seriesTitle(row),
      cell: row => [sb.swatch(choice.seriesIndex(row), choice.kind(row)), choice.seriesTitle(row)]
    },
    {
      title: 'settings',
      text: true,
      wide: true,
      value: row => row.settings,
      cell: row =>
          [el('button.link', {onclick: () => choice.select(row)}, row.settings), row.own ? el('span.tag', {}, 'own') : null,
           row.why ? el(choice.notRun(row) ? 'span.why.pending' : 'span.why', {}, row.why) : null]
    },
    {
      title: 'end',
      text: true,
      value: row => choice.ending(row),
      cell: row => row.status === 'ok' ? 'ok' : el(choice.notRun(row) ? 'span.pending' : 'b.why', {}, choice.ending(row))
    },
    ...(choice.rows.some(row => row.rate_hz) ? [{
      title: 'output',
      value: row => row.rate_hz,
      cell: row => row.rate_hz ? sb.rateText(row.rate_hz) : sb.missing,
      note: 'rate of the fastest sensor'
    }] : []),
    {title: 'CPU / simulated s', value: row => row.cost, cell: row => sb.duration(row.cost), note: 'median'},
    {
      title: '±',
      value: spread,
      cell: row => spread(row) !== null ? percent(spread(row)) : row.cpu_s ? sb.fewRuns(row.cpu_s) : sb.missing,
      note: 'half the spread of the CPU time'
    },
    {
      title: '× real time',
      value: row => row.cost > 0 ? 1 / row.cost : null,
      cell: row => row.cost > 0 ? sb.figure(1 / row.cost) : sb.missing
    },
    ...choice.measures.map(
        measure => ({
          title: measure.title,
          note: measure.definition,
          value: row => choice.differs(row, measure) ? Infinity : choice.error(row, measure),
          cell: row =>
              [choice.errorText(row, measure),
               (row.pareto || []).includes(measure.name) ? el('span.tag', {title: 'on the Pareto front'}, 'front') : null]
        })),
    {title: '', text: true, cell: row => row.command ? sb.copyButton(row.command) : ''},
  ];
  const table = sb.sortedTable(columns, choice.rows, (row, cells) => {
    const node = el('tr', {onclick: () => choice.select(row)}, cells);
    nodes.set(row, node);
    return node;
  });
  const holder = el('div.scroll.tall.runs', {tabindex: 0, role: 'region', 'aria-label': 'All runs'}, table.node);
  const mark = () => {
    for (const [row, node] of nodes) node.classList.toggle('current', row === choice.selected);
    const node = nodes.get(choice.selected);
    // Scrolls the table alone: the reader looks at the diagram.
    if (!node) return;
    const head = 40;
    if (node.offsetTop < holder.scrollTop + head) holder.scrollTop = node.offsetTop - head;
    if (node.offsetTop + node.offsetHeight > holder.scrollTop + holder.clientHeight)
      holder.scrollTop = node.offsetTop + node.offsetHeight - holder.clientHeight;
  };
  const note = el('p.note');
  const say = () => note.textContent =
      'Errors: the ' + choice.statistic + ' of each run. A head sorts, a row shows itself in the diagram.';
  choice.on('row', mark);
  choice.on('view', () => {
    say();
    table.refresh();
    mark();
  });
  say();
  mark();
  return el('section', {}, el('h2', {}, 'All runs'), note, holder);
};
sb.percentText = percent;
})(window.slipbench);
