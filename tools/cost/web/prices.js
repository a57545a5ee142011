// The price of each error bound: the cheapest setting of each series within it.
const el = sb.element;
const choice = sb.choice;
const most = 8;  // rows

// Bounds in powers of ten in the measure's unit, descending: from the largest that some run exceeds
// to the smallest that some run keeps, none below the reference's own error.
function bounds(points) {
  const measure = choice.measure;
  const [exact, errors] = [true, false].map(
      none => points.map(row => choice.error(row)).filter(error => choice.none(error) === none));
  if (!errors.length) return [];
  const [low, high] = d3.extent(errors.map(error => error * measure.factor));
  const least = Math.max(low, (measure.floor || 0) * measure.factor);
  // One more if some setting is exact.
  const last = Math.ceil(Math.log10(least) - 1e-9) - (exact.length ? 1 : 0);
  const first = Math.max(last, Math.floor(Math.log10(high)));
  return d3.range(first, last - 1, -1).slice(0, most).map(power => +('1e' + power));
}

sb.pricesTable = () => {
  const host = el('div');
  const draw = () => {
    const shown = choice.rows.filter(row => !choice.hidden.has(row.series));
    const points = shown.filter(row => choice.placed(row));
    const unrun = shown.filter(row => choice.notRun(row));
    const [used, unused] = [true, false].map(
        wanted => choice.series.filter(series => points.some(row => row.series === series.name) === wanted));
    const unrunOf = series => unrun.filter(row => row.series === series.name).length;
    const unknown = unused.filter(series => unrunOf(series));
    const wanted = bounds(points);
    const bestOf = (limit, series) => {
      // A bound shown as 1 % must include 1 % despite rounding.
      const within = row => choice.error(row) * choice.measure.factor <= limit * (1 + 1e-9);
      return points.filter(row => row.series === series.name && within(row)).sort((a, b) => a.cost - b.cost)[0];
    };
    const cell = (best, cheapest, others) => {
      if (!best && others) return el('td', {}, el('span.pending', {}, 'not reached'), el('small', {}, others + ' not run'));
      if (!best) return el('td', {}, el('span.unreached', {}, '× not reached'));
      const more = best.cost === cheapest ? '' : ', ' + sb.figure(best.cost / cheapest, 2) + ' times the cheapest';
      const link = el('button.link', {title: best.settings, onclick: () => choice.select(best)}, sb.timesReal(best.cost));
      return el(more ? 'td' : 'td.cheapest', {}, link, el('small', {}, best.label, more));
    };
    const rows = wanted.map(limit => {
      const best = used.map(series => bestOf(limit, series));
      return {limit, best, cheapest: d3.min(best, row => row && row.cost)};
    });
    const columns = [
      {title: 'error', cell: ({limit}) => el('th', {scope: 'row'}, '≤ ' + sb.tickText(limit) + ' ' + choice.measure.unit)},
      ...used.map((series, i) => ({
        title: [sb.swatch(choice.series.indexOf(series)), series.title],
        cell: ({best, cheapest}) => cell(best[i], cheapest, unrunOf(series))
      }))
    ];
    host.replaceChildren(
        ...rows.length ?
            [
              el('h3.sub', {}, 'Cost of each accuracy'),
              el('p.note', {},
                 'Speed (times real time) of the cheapest setting of each series whose ' + choice.statistic + ' error in ' +
                     choice.measure.title + ' is within the bound. Bold: cheapest of all.',
                 unknown.length > 0 && ' Not run, because the budget was used up: ' + unknown.map(series => series.title).join('; ') + '.'),
              el('div.prices', {}, sb.table(columns, rows))
            ] :
            []);
  };
  choice.addEventListener('view', draw);
  draw();
  return host;
};
