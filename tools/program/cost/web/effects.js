// The price of each effect: what the scene saves without it, and what it loses.
(function(sb) {
'use strict';
const el = sb.element;
const choice = sb.choice;

const priced = effect => effect.share !== null && effect.share !== undefined;
// Too few runs have no quartiles.
const spread = effect => priced(effect) && effect.low !== null && effect.high !== null;

// A share of the CPU time as a bar from zero, with its interval.
function bar(effect, [low, high]) {
  const width = 220, height = 18;
  const x = d3.scale.linear().domain([low, high]).range([1, width - 1]);
  const node = el('span.bar-holder');
  const svg = d3.select(node).append('svg').attr({viewBox: '0 0 ' + width + ' ' + height, 'aria-hidden': 'true'});
  svg.append('rect').attr({
    class: effect.idle ? 'share idle' : 'share',
    x: Math.min(x(0), x(effect.share)),
    y: 3,
    width: Math.abs(x(effect.share) - x(0)),
    height: height - 6
  });
  svg.append('line').attr({class: 'edge', x1: x(0), x2: x(0), y1: 0, y2: height});
  if (spread(effect))
    svg.append('path').attr(
        {class: 'spread', d: 'M' + x(effect.low) + ',5v8M' + x(effect.high) + ',5v8M' + x(effect.low) + ',9H' + x(effect.high)});
  return node;
}

const measureOf = name => choice.measures.find(measure => measure.name === name);
const titleOf = name => (measureOf(name) || {title: name}).title;
const other = (effect, name) => (effect.different || []).includes(name);

// How much something changes when the effect is taken out, in the unit of the measure of that name.
function changed(effect, name) {
  const change = (effect.changes || {})[name];
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
         spread(effect) ? el('small', {}, ' ' + sb.percentText(effect.low) + ' to ' + sb.percentText(effect.high)) : null));
}

// What follows, and why there is no price where that does not say it.
const conclusion = effect =>
    [effect.verdict, effect.why && !effect.verdict.includes(effect.why) ? effect.why : ''].filter(text => text).join(': ');

sb.effectsSection = effects => {
  const ordered = effects.slice().sort((a, b) => priced(b) - priced(a) || b.share - a.share);
  const range = d3.extent([0, ...ordered.filter(priced).flatMap(effect => [effect.low, effect.high, effect.share])]);
  // A measure that no effect changes needs no column.
  const names = [...new Set(ordered.flatMap(effect => Object.keys(effect.changes || {})))];
  const [moved, still] = [true, false].map(
      wanted => names.filter(
          name => ordered.some(effect => other(effect, name) || ((effect.changes || {})[name] || {worst: 0}).worst > 0) === wanted));
  const idle = ordered.filter(effect => effect.idle);
  const head = ['effect', 'share of the CPU time', ...moved.map(name => 'changes ' + titleOf(name)), 'so'];
  const rows = ordered.map(
      effect =>
          el(effect.idle ? 'tr.idle' : 'tr', {}, el('td.text', {}, el('b', {}, effect.name), el('span.kind', {}, effect.kind)),
             shareCell(effect, range), moved.map(name => el('td', {'data-label': titleOf(name)}, changed(effect, name))),
             el('td.text.long', {}, conclusion(effect))));
  return el(
      'section', {}, el('h2', {}, 'The price of each effect'),
      el('p.note', {},
         'The scene with each effect taken out in turn: the share of its CPU time that this saves, with its interval, ' +
             'and how much it changes at worst. ' +
             'What an effect saves beside others may differ.',
         ordered.some(effect => moved.some(name => other(effect, name))) ?
             ' Other: something happens with it and not without, or the other way round.' :
             null,
         still.length ? ' None of them changes: ' + still.map(titleOf).join(', ') + '.' : null),
      idle.length ?
          el('p.warning', {}, el('b', {}, idle.map(effect => effect.name).join(', ')),
             (idle.length > 1 ? ' cost time here and change' : ' costs time here and changes') + ' nothing that was measured.') :
          null,
      el('div.scroll', {},
         el('table.effects', {},
            el('thead', {},
               el('tr', {}, head.map((text, i) => el(i < 2 || i === head.length - 1 ? 'th.text' : 'th', {scope: 'col'}, text)))),
            el('tbody', {}, rows))));
};
})(window.slipbench);
