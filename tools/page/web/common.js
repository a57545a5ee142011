// Helpers of all pages: number formats, nodes, choices, tables, copying.

sb.missing = '–';
// Formats a finite number by d3's `format`.
const formatted = (value, format) => Number.isFinite(value) ? d3.format(format)(value) : sb.missing;
// A number with `digits` significant digits, in plain notation where that is readable.
sb.significant = (value, digits) => {
  const size = Math.abs(value), plain = value === 0 || (size >= 1e-4 && size < 1e5);
  return formatted(value, plain ? '.' + digits + '~r' : '.' + (digits - 1) + 'e');
};
sb.fixed = (value, decimals) => formatted(value, '.' + decimals + 'f');
// Creates nodes in one expression: element('p.note', {title: 'x'}, 'text', child). Text is never
// parsed as HTML; null, undefined and false are omitted.
const made = create => (selector, attributes, ...children) => {
  const [tag, ...classes] = selector.split('.').filter(part => part);
  const node = create(tag);
  if (classes.length) node.setAttribute('class', classes.join(' '));
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name.startsWith('on'))
      node.addEventListener(name.slice(2), value);
    else if (value !== undefined && value !== null)
      node.setAttribute(name, value);
  }
  node.append(...children.flat(Infinity).filter(child => child !== null && child !== undefined && child !== false));
  return node;
};
const el = sb.element = made(tag => document.createElement(tag));
// The same for SVG: mark('circle.own', {r: 4}).
sb.mark = made(tag => document.createElementNS('http://www.w3.org/2000/svg', tag));
sb.colour = name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();

// Resolves after the next frame; after 200 ms if no frame is drawn, as in a background tab.
sb.painted = () => new Promise(done => {
  requestAnimationFrame(() => setTimeout(done));
  setTimeout(done, 200);
});

// Copies a text to the clipboard and confirms it on the button.
sb.copy = async (button, text) => {
  const before = button.textContent;
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = 'copied';
  } catch (error) {
    button.textContent = text;  // a page opened from a file may not write to the clipboard
    return;
  }
  setTimeout(() => {
    button.textContent = before;
  }, 1500);
};

// A drop-down list; options: [[value, text], ...]; calls change(value).
sb.select = (attributes, options, value, change) => el(
    'select', {...attributes, onchange: event => change(event.target.value)},
    options.map(([key, text]) => el('option', {value: key, selected: key === value ? '' : null}, text)));
sb.choose = (name, ...choice) => el('label', {}, name, sb.select({}, ...choice));
// Buttons, of which the last one clicked stays pressed.
sb.segments = (name, options, value, change) => {
  const press =
      key => [...node.children].forEach((button, i) => button.setAttribute('aria-pressed', String(options[i][0] === key)));
  const choose = key => {
    press(key);
    change(key);
  };
  const node = el('div.segments', {role: 'group', 'aria-label': name},
                  options.map(([key, text]) => el('button', {onclick: () => choose(key)}, text)));
  press(value);
  return node;
};

// A section with its title; note: texts, "" for none.
sb.section = (title, note, ...content) =>
    el('section', {}, el('h2', {}, title), note.length > 0 && el('p.note', {}, note), content);

// Figures side by side: [name, value, note, class of the value].
sb.figures = entries => el(
    'div.figures', {},
    entries.map(([name, value, note, kind]) => el('div', {}, el('div.k', {}, name), el('div.v.' + (kind || ''), {}, value),
                                                  el('div.s', {}, note || ''))));
// Names and values: [name, value]; entries without a value are omitted.
sb.facts = (kind, entries) => el(
    'dl.' + kind, {},
    entries.filter(([, value]) => value !== null && value !== undefined)
        .map(([name, value]) => el('div', {}, el('dt', {}, name), el('dd', {}, value))));

// A sortable table. columns: [{title, note, kind: 'text' is left-aligned, 'text.long' may wrap,
// cell(row): content or the cell itself, value(row): sort key: a number, a text, or null, which
// sorts last}]. rowNode(row, cells): the <tr>. `step`: number of rows shown at once; the rest on
// request. Returns {node, refresh, fill(count), order()}.
sb.sortedTable = (columns, rows, rowNode = (row, cells) => el('tr', {}, cells), step = rows.length) => {
  let order = rows, by = null, ascending = true;
  const body = el('tbody');
  const cellOf = (kind, shown) => shown instanceof HTMLTableCellElement ? shown : el('td.' + (kind || ''), {}, shown);
  const rowOf = row => rowNode(row, columns.map(({kind, cell}) => cellOf(kind, cell(row))));
  const fill = count => body.append(...order.slice(body.children.length, count).map(rowOf));
  const compare = (a, b) => {
    const [p, q] = [a, b].map(row => by.value(row) ?? null);
    if (p === q) return 0;
    if (p === null || q === null) return p === null ? 1 : -1;
    return (typeof p === 'string' ? p.localeCompare(q) : p - q) * (ascending ? 1 : -1);
  };
  const refresh = () => {
    order = by ? rows.slice().sort(compare) : rows;
    body.replaceChildren();
    fill(step);
  };
  const sort = column => {
    ascending = by !== column || !ascending;
    by = column;
    heads.forEach(head => head.removeAttribute('aria-sort'));
    heads[columns.indexOf(column)].setAttribute('aria-sort', ascending ? 'ascending' : 'descending');
    refresh();
  };
  const heads = columns.map(column => el(
      'th.' + (column.kind ? 'text' : ''), {scope: 'col'},
      column.value ? el('button', {onclick: () => sort(column), title: column.note}, column.title) : column.title));
  refresh();
  return {node: el('table', {}, el('thead', {}, el('tr', {}, heads)), body), refresh, fill, order: () => order};
};
sb.table = (columns, rows, rowNode) => el('div.scroll', {}, sb.sortedTable(columns, rows, rowNode).node);
