// The price of each effect: the CPU time saved without it, and the resulting change.
const el = sb.element, mark = sb.mark;
const choice = sb.choice;

const priced = effect => effect.share !== null && effect.share !== undefined;
// Prices from too few runs have no quartiles.
const spread = effect => priced(effect) && effect.low !== null && effect.high !== null;

// A share of the CPU time as a bar from zero, with its interval.
function bar(effect, range) {
  const width = 220, height = 18;
  const x = d3.scaleLinear(range, [1, width - 1]), [from, to] = [0, effect.share].map(x).sort(d3.ascending);
  const [low, high] = [effect.low, effect.high].map(x);
  return el(
      'span.bar-holder', {},
      mark('svg', {viewBox: '0 0 ' + width + ' ' + height, 'aria-hidden': 'true'},
           mark(effect.idle ? 'rect.share.idle' : 'rect.share', {x: from, y: 3, width: to - from, height: height - 6}),
           mark('path.edge', {d: 'M' + x(0) + ',0V' + height}),
           spread(effect) && mark('path.spread', {d: 'M' + low + ',5v8M' + high + ',5v8M' + low + ',9H' + high})));
}

const measureOf = name => choice.measures.find(measure => measure.name === name);
const titleOf = name => measureOf(name)?.title ?? name;
const other = (effect, name) => (effect.different || []).includes(name);

// Change of a measure without the effect, in the measure's unit.
function changed(effect, name) {
  const change = effect.changes?.[name];
  if (other(effect, name)) return 'other';
  if (!change) return sb.missing;
  if (change.worst === 0) return 'none';
  return measureOf(name) ? sb.measured(measureOf(name), change.worst) : sb.percentText(change.worst);
}

function shareCell(effect, range) {
  if (!priced(effect)) return el('td.text.pending', {}, effect.status || 'not timed');
  return el(
      'td.text.share-cell', {}, bar(effect, range),
      el('span', {}, sb.percentText(effect.share),
         spread(effect) && el('small', {}, ' ' + sb.percentText(effect.low) + ' to ' + sb.percentText(effect.high))));
}

// The verdict, and the reason for a missing price unless the verdict includes it.
const conclusion = effect =>
    [effect.verdict, effect.why && !effect.verdict.includes(effect.why) ? effect.why : ''].filter(text => text).join(': ');

sb.effectsSection = effects => {
  const ordered = effects.slice().sort((a, b) => priced(b) - priced(a) || b.share - a.share);
  const range = d3.extent([0, ...ordered.filter(priced).flatMap(effect => [effect.low, effect.high, effect.share])]);
  // Measures that no effect changes get no column.
  const names = [...new Set(ordered.flatMap(effect => Object.keys(effect.changes || {})))];
  const changes = name => effect => other(effect, name) || effect.changes?.[name]?.worst > 0;
  const [moved, still] = [true, false].map(wanted => names.filter(name => ordered.some(changes(name)) === wanted));
  const idle = ordered.filter(effect => effect.idle);
  const columns = [
    {title: 'effect', kind: 'text', cell: effect => [el('b', {}, effect.name), el('span.kind', {}, effect.kind)]},
    {title: 'share of the CPU time', kind: 'text', cell: effect => shareCell(effect, range)},
    ...moved.map(name => ({
      title: 'changes ' + titleOf(name),
      cell: effect => el('td', {'data-label': titleOf(name)}, changed(effect, name))
    })),
    {title: 'so', kind: 'text.long', cell: conclusion}
  ];
  return sb.section(
      'Cost of each effect',
      [
        'Each effect is removed in turn: share of the CPU time that this saves, with its interval, ' +
            'and largest change of the results. Without other effects, the saving may differ.',
        ordered.some(effect => moved.some(name => other(effect, name))) &&
            ' Other: an event occurs only with the effect or only without it.',
        still.length > 0 && ' Without influence on: ' + still.map(titleOf).join(', ') + '.'
      ],
      idle.length > 0 &&
          el('p.warning', {}, el('b', {}, idle.map(effect => effect.name).join(', ')),
             (idle.length > 1 ? ' cost time and change' : ' costs time and changes') + ' no measured quantity.'),
      el('div.effects', {}, sb.table(columns, ordered, (effect, cells) => el(effect.idle ? 'tr.idle' : 'tr', {}, cells))));
};
