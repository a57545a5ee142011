// The work-precision diagram: error against CPU time.
const el = sb.element, mark = sb.mark, text = sb.text;
const choice = sb.choice;
const lane = 16;     // px, height of a lane of marks
const pad = 6;       // px, padding of a strip
const radius = 5.5;  // px, of a mark
const reach = 26;    // px, maximum pointer distance of a mark
const cross = d3.symbol(d3.symbolTimes, 55)();

// Distributes marks over as few lanes as possible without overlap. at: px of each, ascending.
// Returns the lane of each.
function lanes(at, gap) {
  const ends = [];
  return at.map(x => {
    let index = ends.findIndex(end => x - end >= gap);
    if (index < 0) index = ends.push(0) - 1;
    ends[index] = x;
    return index;
  });
}

const timed = row => row.cost > 0;
const byCost = (a, b) => timed(b) - timed(a) || (timed(a) ? a.cost - b.cost : 0);

// The rows of the shown series by their kind in the chosen measure, in order of cost.
function sorted() {
  const rows = choice.rows.filter(row => !choice.hidden.has(row.series)).slice().sort(byCost);
  const points = rows.filter(row => choice.placed(row));
  const none = row => choice.none(choice.error(row));
  return {
    failures: rows.filter(row => choice.failed(row)), unrun: rows.filter(row => choice.notRun(row)),
    points: points.filter(row => !none(row)), exact: points.filter(none)
  };
}

// Strips above the diagram for rows that cannot be drawn in it. Marks of timed failures stand above
// their cost; the two other strips are filled from left to right. The total height is at most
// `most` px.
function strips(rows, x, [left, end], most) {
  const costly = rows.failures.filter(timed);
  const own = lanes(costly.map(row => x(row.cost)), 24);
  const room = end - left - 10;
  const filled = (kind, held, gap) => ({kind, rows: held, gap, lanes: Math.ceil(held.length * gap / room)});
  const used = [
    filled('unrun', rows.unrun, 15), filled('failure', rows.failures.filter(row => !timed(row)), 30),
    {kind: 'failure', rows: costly, lanes: costly.length ? Math.max(...own) + 1 : 0}
  ].filter(strip => strip.rows.length);
  const height = () => d3.sum(used, strip => strip.lanes * lane + pad);
  while (height() > most && used.some(strip => strip.lanes > 1)) used.reduce((a, b) => b.lanes > a.lanes ? b : a).lanes--;
  let top = 0;
  for (const strip of used) {
    const across = Math.ceil(strip.rows.length / strip.lanes);
    const pitch = Math.min(strip.gap, room / across);
    const at = lower => top + pad / 2 + (lower + 0.5) * lane;
    strip.top = top;
    strip.height = strip.lanes * lane + pad;
    strip.marks = strip.rows.map(
        (row, i) => strip.gap ? {row, kind: strip.kind, x: left + 11 + i % across * pitch, y: at(Math.floor(i / across))} :
                                {row, kind: strip.kind, x: x(row.cost), y: at(own[i] % strip.lanes)});
    strip.tight = strip.gap && pitch < 20;  // no space for numbers
    top += strip.height;
  }
  return used;
}

// Positions of all parts [px], and the scales.
function layout(width, rows) {
  const measure = choice.measure;
  const narrow = width < 560;
  const box = {left: narrow ? 46 : 58, end: width - 14, top: narrow ? 60 : 44};
  const costs = choice.rows.filter(timed).map(row => row.cost);
  const x = d3.scaleLog(sb.logDomain(costs.length ? costs : [1e-3]), [box.left, box.end]);

  const height = narrow ? 300 : 380;
  const above = strips(rows, x, [box.left, box.end], height / 4);
  for (const strip of above) {
    strip.top += box.top;
    for (const mark of strip.marks) mark.y += box.top;
  }
  box.plot = box.top + d3.sum(above, strip => strip.height);
  box.mesh = d3.min(above.filter(strip => !strip.gap), strip => strip.top) || box.plot;
  box.foot = box.plot + height;
  const exact = lanes(rows.exact.map(row => x(row.cost)), 15);
  // Space for the note that explains exact settings.
  box.exact = rows.exact.length ? Math.min(3, Math.max(...exact) + 1) * lane + pad + 16 : 0;
  box.bottom = box.foot + box.exact;
  box.height = box.bottom + 44;

  const errors = choice.rows.filter(row => choice.placed(row) && !choice.none(choice.error(row))).map(row => choice.error(row));
  const floor = measure.floor;
  const low = errors.length ? Math.min(...errors) : 1e-3;
  // The reference's own error, if far below all errors, would only compress the axis.
  if (floor > low / 10 && !choice.none(floor)) errors.push(floor);
  const y = d3.scaleLog(sb.logDomain(errors.length ? errors : [low]), [box.foot, box.plot]);

  const marks = [
    ...above.flatMap(strip => strip.marks),
    ...rows.points.map(row => ({row, kind: 'point', x: x(row.cost), y: y(choice.error(row))})),
    ...rows.exact.map(
        (row, i) => ({row, kind: 'point', exact: true, x: x(row.cost), y: box.foot + pad / 2 + (exact[i] % 3 + 0.5) * lane}))
  ];
  marks.filter(mark => mark.kind === 'failure').forEach((mark, i) => mark.number = i + 1);
  for (const strip of above.filter(one => one.tight)) strip.marks.forEach(mark => mark.bare = true);
  return {width, narrow, box, x, y, marks, floor, strips: above};
}

const path = (kind, d, index) => mark('path.' + kind, {d, style: index === undefined ? null : 'color:' + sb.hue(index)});
const across = (kind, {left, end}, y) => path(kind, 'M' + left + ',' + y + 'H' + end);

function axes({narrow, box, x, y}) {
  const measure = choice.measure, middle = (box.left + box.end) / 2;
  const axis = (kind, scale, needed, text, ...place) => sb.axis(kind, {scale, ticks: sb.ticks(scale, needed), text}, ...place);
  const speed = d3.scaleLog(x.domain().map(cost => 1 / cost), x.range());
  const error = d3.scaleLog(y.domain().map(error => error * measure.factor), y.range());
  return [
    axis(d3.axisBottom, x, narrow ? 44 : 52, sb.tickText, 'translate(0,' + box.bottom + ')', box.bottom - box.mesh),
    axis(d3.axisTop, speed, narrow ? 56 : 62, tick => sb.tickText(tick) + ' ×', 'translate(0,' + box.top + ')', -5),
    axis(d3.axisLeft, error, 22, sb.tickText, 'translate(' + box.left + ',0)', box.end - box.left),
    text(middle, box.bottom + 36, 'middle', 'CPU seconds per simulated second', 'title'),
    text(narrow ? middle : box.end, narrow ? 30 : 13, narrow ? 'middle' : 'end', 'times real time', 'title'),
    text(0, 13, 'start', choice.statistic + ' error of ' + sb.titled(measure), 'title'), across('edge', box, box.bottom),
    across('edge', box, box.top),
    box.exact > 0 &&
        [
          across('edge', box, box.foot),
          text(box.left + 6, box.bottom - 6, 'start', 'none: below ' + sb.tickText(sb.negligible) + ' ' + measure.unit)
        ]
  ];
}

function stripMarks({box, strips: above}) {
  const name = (kind, words) => {
    const held = above.filter(strip => strip.kind === kind), last = held[held.length - 1];
    return last && text(box.left - 6, (held[0].top + last.top + last.height) / 2 + 4, 'end', words, 'strip-name.' + kind);
  };
  const timeless = above.find(({kind, gap}) => kind === 'failure' && gap);
  const roomy = timeless && box.end - d3.max(timeless.marks, ({x}) => x) > 70;
  return [
    above.map(({top, height, gap}) => [
      gap && mark('rect.aside', {x: box.left, y: top, width: box.end - box.left, height}), across('edge', box, top + height)
    ]),
    name('unrun', 'not run'), name('failure', 'failed'),
    roomy && text(box.end - 6, timeless.top + timeless.height / 2 + 4, 'end', 'no time')
  ];
}

// Errors below the reference's own are not meaningful.
function floorMarks({box, y, floor}) {
  if (!floor || floor <= y.domain()[0]) return null;
  const top = y(floor), room = box.foot - top;
  return [
    mark('rect.floor', {x: box.left, y: top, width: box.end - box.left, height: room}), across('floor-edge', box, top),
    text(box.left + 6, room > 18 ? top + 14 : top - 5, 'start', 'below the error of the reference', 'halo-text')
  ];
}

// The staircase below which no setting lies: from its cheapest point up, and to the right of its
// most exact one.
function front({box, marks}) {
  const points = marks.filter(({kind, row}) => kind === 'point' && choice.onFront(row)).sort((a, b) => a.x - b.x);
  if (!points.length || choice.statistic !== 'worst') return null;
  // Among exact settings only the cheapest counts.
  const end = points.findIndex(point => point.exact) + 1;
  const steps = points.slice(0, end || points.length).map(({x, y}) => [x, y]);
  const stairs = [[steps[0][0], box.plot], ...steps, [box.end, steps.at(-1)[1]]];
  return path('front', d3.line().curve(d3.curveStepAfter)(stairs));
}

// A thin line joins the best settings of each series, which no other of its settings beats in both
// cost and error.
const ways = ({marks}) => choice.series.map((series, index) => {
  const points =
      marks.filter(({kind, row}) => kind === 'point' && row.series === series.name).sort((a, b) => a.x - b.x || b.y - a.y);
  const best = points.filter((point, i) => points.slice(0, i).every(cheaper => !cheaper.exact && cheaper.y < point.y));
  return best.length > 1 && path('way', d3.line(({x}) => x, ({y}) => y)(best), index);
});

const intervals = ({x, marks}) => marks.map(({kind, row, y: at}) => {
  if (kind !== 'point' || !row.cpu_s || sb.fewRuns(row.cpu_s)) return null;
  const [low, high] = [row.cpu_s.low, row.cpu_s.high].map(seconds => x(seconds * row.cost / row.cpu_s.median));
  const end = place => 'M' + place + ',' + (at - 3.5) + 'v7';
  return path('interval', end(low) + end(high) + 'M' + low + ',' + at + 'H' + high, choice.seriesIndex(row));
});

const spoken = row => [choice.seriesTitle(row) + ', ' + row.settings,
                       choice.placed(row) ? choice.statistic + ' error ' + choice.errorText(row) : choice.reason(row),
                       timed(row) ? sb.duration(row.cost) + ' CPU per simulated second' : 'no time']
                          .join('; ');

// Labels of the important points, where space permits.
function names({box, marks}) {
  const taken = marks.map(({x, y}) => [x - 7, y - 7, x + 7, y + 7]);
  if (box.exact) taken.push([box.left, box.bottom - 16, box.left + 150, box.bottom]);
  const free = ([l, t, r, b]) => l >= box.left && r <= box.end && t >= box.plot && b <= box.bottom &&
      !taken.some(([left, top, right, bottom]) => l < right && r > left && t < bottom && b > top);
  const named = marks.filter(({kind, row}) => kind === 'point' && (row.own || choice.onFront(row)));
  return named.sort((a, b) => Boolean(b.row.own) - Boolean(a.row.own)).map(({row, x, y}) => {
    const words = row.label + (row.own ? ', this scene' : '');
    const width = 6.4 * words.length, off = row.own ? 13 : 9;
    const place = [[off, -6], [off, 14], [-off - width, 14], [-off - width, -6], [-width / 2, 22], [-width / 2, -13]]
                      .map(([dx, dy]) => [x + dx, y + dy - 10, x + dx + width, y + dy + 2])
                      .find(free);
    if (place) taken.push(place);
    return place && text(place[0], place[3] - 2, 'start', words, 'halo-text.name');
  });
}

function markNode({row, kind, number, bare, x, y}) {
  const index = choice.seriesIndex(row);
  const attributes = {
    transform: 'translate(' + [x, y] + ')', tabindex: -1, role: 'button', 'aria-label': spoken(row),
    style: 'color:' + (kind === 'unrun' ? 'var(--soft)' : sb.hue(index))
  };
  return mark(
      'g.point.' + kind, attributes, mark('circle.here', {r: radius + 4}), row.own && mark('circle.own', {r: radius + 4.5}),
      kind !== 'failure' ? path('mark.' + kind, sb.markPath(index, kind === 'unrun' ? 4 : radius)) :
                           [path('cross', cross), !bare && text(8, 4, 'start', number)]);
}

class Diagram {
  constructor() {
    this.host = el('div.diagram');
    this.note = el('div.note');
    this.failures = el('ul.failures');
    this.unrun = el('details.unrun');
    sb.onWidth(this.host, () => this.draw());
    choice.addEventListener('view', () => this.draw());
    choice.addEventListener('row', () => this.mark());
  }

  draw() {
    if (!choice.measure || !this.host.clientWidth) return;
    this.drawn = this.host.clientWidth;
    const focused = this.host.contains(document.activeElement);
    const rows = sorted();
    this.place = layout(this.drawn, rows);
    const {box, marks} = this.place;
    // From left to right, the order of the arrow keys.
    this.order = marks.slice().sort((a, b) => a.x - b.x || a.y - b.y);
    this.nodes = this.order.map(markNode);
    const stripes = {id: 'floor-hatch', width: 7, height: 7, patternUnits: 'userSpaceOnUse', patternTransform: 'rotate(45)'};
    const hatch = mark('pattern', stripes, mark('rect.floor-line', {width: 1.6, height: 7}));
    const attributes = {
      viewBox: [0, 0, this.drawn, box.height].join(' '),
      role: 'group',
      'aria-label': 'Work-precision diagram: ' + choice.statistic + ' error, ' + choice.measure.title +
          ', against CPU time. Arrow keys move between marks.'
    };
    const svg = mark(
        'svg', attributes, mark('defs', {}, hatch),
        [floorMarks, stripMarks, axes, front, ways, intervals].map(part => part(this.place)), this.nodes, names(this.place));
    this.host.replaceChildren(svg);
    this.listen(svg);
    this.note.replaceChildren(...this.remark(rows).map(line => el('p', {}, line)));
    this.listAside(marks);
    this.mark();
    if (focused) this.nodes[0]?.focus();
  }

  // Hovering shows a row, a click or Enter selects it; arrow keys move from mark to mark.
  listen(svg) {
    const nearest = event => {
      const [atX, atY] = d3.pointer(event, svg);
      const far = ({x, y}) => Math.hypot(x - atX, y - atY);
      const best = d3.least(this.order, far);
      return best && far(best) < reach ? best : null;
    };
    const leave = () => {
      choice.point(null);
      sb.hideTip();
    };
    svg.addEventListener('pointermove', event => {
      const mark = nearest(event);
      svg.style.cursor = mark ? 'pointer' : '';
      if (!mark) return leave();
      choice.point(mark.row);
      sb.showTip(this.lines(mark), event.clientX, event.clientY);
    });
    svg.addEventListener('pointerleave', leave);
    svg.addEventListener('focusout', leave);
    svg.addEventListener('focusin', event => {
      const mark = this.order[this.nodes.indexOf(event.target)], {right, top} = event.target.getBoundingClientRect();
      choice.point(mark.row);
      sb.showTip(this.lines(mark), right, top);
    });
    svg.addEventListener('click', event => {
      const mark = nearest(event);
      if (mark) choice.select(mark.row);
    });
    svg.addEventListener('keydown', event => {
      const at = this.nodes.indexOf(document.activeElement);
      const steps = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1, Home: -this.nodes.length, End: this.nodes.length};
      if (event.key in steps)
        this.nodes[Math.min(this.nodes.length - 1, Math.max(0, at + steps[event.key]))]?.focus();
      else if (at >= 0 && (event.key === 'Enter' || event.key === ' '))
        choice.select(this.order[at].row);
      else if (event.key === 'Escape')
        sb.hideTip();
      else
        return;
      event.preventDefault();
    });
  }

  lines({row, number}) {
    const cheapest = choice.cheapestAsExact(row);
    return [
      (number ? number + '  ' : '') + row.settings,
      choice.placed(row) ? choice.statistic + ' error: ' + choice.errorText(row) : choice.reason(row),
      row.rate_hz ? 'output at ' + sb.rateText(row.rate_hz) : '',
      timed(row) ? sb.duration(row.cost) + ' per simulated second, ' + sb.timesReal(row.cost) + ' real time' +
              (row.cpu_s && sb.fewRuns(row.cpu_s) ? ', ' + sb.fewRuns(row.cpu_s) : '') :
                   '',
      cheapest ? 'as accurate for 1/' + sb.figure(row.cost / cheapest.cost, 2) + ' of the time: ' + cheapest.settings : ''
    ].filter(text => text);
  }

  // Highlights the selected or hovered mark, and makes it the one that Tab reaches.
  mark() {
    if (!this.nodes) return;
    const rows = this.order.map(mark => mark.row);
    const stop = Math.max(0, rows.indexOf(choice.selected));
    this.nodes.forEach((node, i) => {
      node.classList.toggle('current', rows[i] === choice.shown);
      node.setAttribute('tabindex', i === stop ? 0 : -1);
    });
    for (const [row, node] of this.listed || []) node.classList.toggle('current', row === choice.shown);
  }

  // One line each: the measure's definition, its reference, and what is not drawn.
  remark(rows) {
    const measure = choice.measure;
    const drawn = d3.sum(Object.values(rows), held => held.length);
    const shown = choice.rows.filter(row => !choice.hidden.has(row.series)).length;
    const visible = measure.floor > this.place.y.domain()[0];
    const parts = [
      'Reference: ' + measure.reference + '.',
      measure.floor && 'The error of the reference is about ' + sb.measured(measure, measure.floor) +
          (visible ? '; errors in the hatched band are meaningless.' : ', below this diagram.'),
      choice.statistic !== 'worst' && 'The Pareto front is that of the worst error and is not drawn here.',
      shown > drawn && (shown - drawn) + ' of ' + shown + ' runs without a value of this measure.'
    ];
    const title = measure.title[0].toUpperCase() + measure.title.slice(1);
    return [title + ': ' + measure.definition + '.', parts.filter(part => part).join(' ')];
  }

  // Lists the rows outside the plot, grouped by reason.
  listAside(marks) {
    this.listed = [];
    const link = ({row, number}) => {
      const node = el('button.link', {onclick: () => choice.select(row)}, number ? number + ' ' : '',
                      sb.swatch(choice.seriesIndex(row), choice.kind(row)), row.settings);
      this.listed.push([row, node]);
      return node;
    };
    const reasons = kind => d3.groups(marks.filter(mark => mark.kind === kind), ({row}) => choice.reason(row));
    const entries = kind => reasons(kind).map(([reason, marks]) => el('li', {}, el('span.why', {}, reason), marks.map(link)));
    const unrun = marks.filter(mark => mark.kind === 'unrun').length;
    this.failures.replaceChildren(...entries('failure'));
    this.unrun.hidden = !unrun;
    this.unrun.replaceChildren(
        el('summary', {}, unrun + (unrun === 1 ? ' setting' : ' settings') + ' not run, because the budget was used up'),
        el('ul.failures', {}, entries('unrun')));
  }
}

// The legend, a row of switches that show or hide each series.
function legend() {
  const used = choice.series.filter(series => choice.rows.some(row => row.series === series.name));
  const toggle = (button, name) => {
    const hidden = new Set(choice.hidden);
    if (!hidden.delete(name)) hidden.add(name);
    button.setAttribute('aria-pressed', String(!hidden.has(name)));
    choice.view({hidden});
  };
  const button = series => el(
      'button.key', {'aria-pressed': 'true', title: 'show or hide', onclick: event => toggle(event.currentTarget, series.name)},
      sb.swatch(choice.series.indexOf(series)), series.title);
  const middle = {transform: 'translate(12,8)'};
  const samples = [
    [row => (row.pareto || []).length, mark('path.front', {d: 'M2,1V8H14V14H23'}), 'Pareto front'],
    [row => row.own, mark('circle.own', {...middle, r: 6.5}), 'setting of the scene'],
    [row => choice.failed(row), mark('path.cross', {...middle, d: cross}), 'failed'],
    [row => choice.notRun(row), mark('path.mark.unrun', {...middle, d: sb.markPath(0, 4)}), 'not run'],
    [() => true, mark('path.interval', {d: 'M2,4v8M22,4v8M2,8H22'}), 'spread of the CPU time']
  ];
  return el(
      'div.keys', {}, used.map(button),
      samples.filter(([there]) => choice.rows.some(there)).map(([, ...sample]) => sb.key('0 0 24 16', ...sample, 'sample')));
}

function controls() {
  const measures = choice.measures.map(measure => [measure.name, sb.titled(measure)]);
  const choose = name => choice.view({measure: choice.measures.find(measure => measure.name === name)});
  return el(
      'div.controls', {}, sb.choose('error of', measures, choice.measure.name, choose),
      sb.segments(
          'which error', [['worst', 'worst'], ['median', 'median']], choice.statistic, statistic => choice.view({statistic})));
}

// Details of one row, next to the diagram.
function detail() {
  const host = el('aside.row-detail');
  const draw = () => {
    const row = choice.shown;
    if (!row) return;
    const cpu = row.cpu_s;
    const cheapest = choice.cheapestAsExact(row);
    const statistic = name => ({title: name, cell: measure => choice.errorText(row, measure, name)});
    const columns = [
      {title: 'error of', kind: 'text.long', cell: measure => measure.title}, statistic('worst'), statistic('median')
    ];
    const shown = (measure, cells) => el(measure === choice.measure ? 'tr.current' : 'tr', {}, cells);
    const parts = [
      el('p.eyebrow', {}, sb.swatch(choice.seriesIndex(row), choice.kind(row)), choice.seriesTitle(row)),
      el('h3', {}, row.settings), row.own && el('p.tag', {}, 'setting of the scene'),
      choice.kind(row) !== 'point' && el(choice.notRun(row) ? 'p.note' : 'p.warning', {}, choice.reason(row)),
      sb.facts('facts', [
        ['output', row.rate_hz ? sb.rateText(row.rate_hz) : null],
        ['CPU time', cpu ? sb.duration(cpu.median) : 'none measured'],
        ['between', cpu && !sb.fewRuns(cpu) ? sb.duration(cpu.low) + ' and ' + sb.duration(cpu.high) : null],
        ['runs', cpu && (sb.fewRuns(cpu) || String(cpu.repeats))],
        ['per simulated second', timed(row) ? sb.duration(row.cost) : null],
        ['times real time', timed(row) ? sb.timesReal(row.cost) : null]
      ]),
      cheapest && el('p.note', {}, 'As accurate for 1/' + sb.figure(row.cost / cheapest.cost, 2) + ' of the time: ',
                     el('button.link', {onclick: () => choice.select(cheapest)}, cheapest.settings)),
      sb.sortedTable(columns, choice.measures, shown).node,
      row.command && el('div.command', {}, el('p.eyebrow', {}, 'repeat: ', sb.copyButton(row.command)),
                        el('pre.mono', {}, row.command))
    ];
    host.replaceChildren(...parts.filter(part => part));
  };
  choice.addEventListener('row', draw);
  choice.addEventListener('view', draw);
  draw();
  return host;
}

sb.diagramSection = () => {
  const diagram = new Diagram();
  return sb.section(
      'CPU time against accuracy', '', controls(), legend(),
      el('div.explorer', {}, el('div', {}, diagram.host, diagram.note, diagram.failures, diagram.unrun), detail()),
      sb.pricesTable());
};
