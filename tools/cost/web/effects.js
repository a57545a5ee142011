// The price of each effect: what the scene saves without it, and what it loses.
(function(sb) {
'use strict';
const el = sb.element;
const choice = sb.choice;

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
  svg.append('path').attr(
      {class: 'spread', d: 'M' + x(effect.low) + ',5v8M' + x(effect.high) + ',5v8M' + x(effect.low) + ',9H' + x(effect.high)});
  return node;
}

// How much something changes when the effect is taken out, in the unit of the measure of that name.
function change(name, value) {
  if (value === null || value === undefined) return sb.missing;
  if (value === 0) return 'none';
  const measure = choice.measures.find(candidate => candidate.name === name);
  return measure ? sb.measured(measure, value) : sb.percentText(value);
}

sb.effectsSection = effects => {
  const ordered = effects.slice().sort((a, b) => b.share - a.share);
  const range = d3.extent([0, ...ordered.flatMap(effect => [effect.low, effect.high, effect.share])]);
  const names = [...new Set(ordered.flatMap(effect => Object.keys(effect.changes || {})))];
  const idle = ordered.filter(effect => effect.idle);
  const head = ['effect', 'share of the CPU time', ...names.map(name => 'changes ' + name), 'so'];
  const rows = ordered.map(
      effect =>
          el(effect.idle ? 'tr.idle' : 'tr', {}, el('td.text', {}, el('b', {}, effect.name), el('span.kind', {}, effect.kind)),
             el('td.text.share-cell', {}, bar(effect, range),
                el('span', {}, sb.percentText(effect.share),
                   el('small', {}, ' ' + sb.percentText(effect.low) + ' to ' + sb.percentText(effect.high)))),
             names.map(name => el('td', {'data-label': name}, change(name, (effect.changes || {})[name]))),
             el('td.text.long', {}, effect.verdict)));
  return el(
      'section', {}, el('h2', {}, 'The price of each effect'),
      el('p.note', {},
         'The scene with each effect taken out in turn: the share of its CPU time that this saves, with its interval, ' +
             'and how much it changes. ' +
             'What an effect saves beside others may differ.'),
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
