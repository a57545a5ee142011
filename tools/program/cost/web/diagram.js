// The work-precision diagram: what an error costs in CPU time.
(function(sb) {
'use strict';
const el = sb.element;
const choice = sb.choice;
const lane = 16;     // px, of a strip of marks
const pad = 6;       // px, of a strip beside its lanes
const radius = 5.5;  // px, of a mark
const reach = 26;    // px, from which a mark is still meant

// Puts marks side by side into as few lanes as hold them apart. at: px of each, ascending. Returns the lane of each.
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

// The rows of the shown series, by what they are in the chosen measure, in the order of their cost.
function sorted() {
  const rows = choice.rows.filter(row => !choice.hidden.has(row.series)).slice().sort(byCost);
  const points = rows.filter(row => choice.placed(row));
  const none = row => choice.none(choice.error(row));
  return {
    failures: rows.filter(row => choice.failed(row)),
    unrun: rows.filter(row => choice.notRun(row)),
    points: points.filter(row => !none(row)),
    exact: points.filter(none)
  };
}

// The strips above the diagram: what has no place in it. Only that of failures with a time has its marks above their cost; the
// other two are filled from left to right. All together keep within `most` px.
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
    strip.tight = strip.gap && pitch < 20;  // no room for numbers
    top += strip.height;
  }
  return used;
}

// Where everything lies [px], and the scales.
function layout(width, rows) {
  const measure = choice.measure;
  const narrow = width < 560;
  const box = {left: narrow ? 46 : 58, end: width - 14, top: narrow ? 60 : 44};
  const costs = choice.rows.filter(timed).map(row => row.cost);
  const x = d3.scale.log().domain(sb.logDomain(costs.length ? costs : [1e-3])).range([box.left, box.end]);

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
  // Below the marks it says what none is.
  box.exact = rows.exact.length ? Math.min(3, Math.max(...exact) + 1) * lane + pad + 16 : 0;
  box.bottom = box.foot + box.exact;
  box.height = box.bottom + 44;

  const errors = choice.rows.filter(row => choice.placed(row) && !choice.none(choice.error(row))).map(row => choice.error(row));
  const floor = measure.floor;
  const low = errors.length ? Math.min(...errors) : 1e-3;
  // A floor far below every error would only squeeze them together.
  if (floor > low / 10 && !choice.none(floor)) errors.push(floor);
  const domain = sb.logDomain(errors.length ? errors : [low]);
  const y = d3.scale.log().domain(domain).range([box.foot, box.plot]);

  const marks = [
    ...above.flatMap(strip => strip.marks),
    ...rows.points.map(row => ({row, kind: 'point', x: x(row.cost), y: y(choice.error(row))})),
    ...rows.exact.map(
        (row, i) => ({row, kind: 'point', exact: true, x: x(row.cost), y: box.foot + pad / 2 + (exact[i] % 3 + 0.5) * lane})),
  ];
  marks.filter(mark => mark.kind === 'failure').forEach((mark, i) => mark.number = i + 1);
  for (const strip of above.filter(one => one.tight)) strip.marks.forEach(mark => mark.bare = true);
  return {width, narrow, box, x, y, marks, floor, strips: above};
}

function axes(svg, {narrow, box, x, y}) {
  const measure = choice.measure;
  const line = (kind, x1, y1, x2, y2) => svg.append('line').attr({class: kind, x1, y1, x2, y2});
  const text = (kind, left, top, anchor, words) =>
      svg.append('text').attr({class: kind, x: left, y: top, 'text-anchor': anchor}).text(words);
  for (const tick of sb.logTicks(x.domain(), box.end - box.left, narrow ? 44 : 52)) {
    line('mesh', x(tick), box.mesh, x(tick), box.bottom);
    text('', x(tick), box.bottom + 16, 'middle', sb.tickText(tick));
  }
  const [fast, slow] = x.domain().map(cost => 1 / cost);
  for (const tick of sb.logTicks([slow, fast], box.end - box.left, narrow ? 56 : 62)) {
    line('tick', x(1 / tick), box.top - 5, x(1 / tick), box.top);
    text('', x(1 / tick), box.top - 9, 'middle', sb.tickText(tick) + ' ×');
  }
  for (const tick of sb.logTicks(y.domain().map(error => error * measure.factor), box.foot - box.plot, 22)) {
    const at = y(tick / measure.factor);
    line('mesh', box.left, at, box.end, at);
    text('', box.left - 7, at + 4, 'end', sb.tickText(tick));
  }
  text('title', (box.left + box.end) / 2, box.bottom + 36, 'middle', 'CPU seconds per simulated second');
  text('title', narrow ? (box.left + box.end) / 2 : box.end, narrow ? 30 : 13, narrow ? 'middle' : 'end', 'times real time');
  text('title', 0, 13, 'start', choice.statistic + ' error of ' + sb.titled(measure));
  line('edge', box.left, box.bottom, box.end, box.bottom);
  line('edge', box.left, box.top, box.end, box.top);
  if (box.exact) {
    line('edge', box.left, box.foot, box.end, box.foot);
    text('', box.left + 6, box.bottom - 6, 'start', 'none: below ' + sb.tickText(sb.negligible) + ' ' + measure.unit);
  }
}

function drawStrips(svg, {box, strips: above}) {
  for (const {top, height, gap} of above) {
    if (gap) svg.append('rect').attr({class: 'aside', x: box.left, y: top, width: box.end - box.left, height});
    svg.append('line').attr({class: 'edge', x1: box.left, x2: box.end, y1: top + height, y2: top + height});
  }
  for (const [kind, words] of [['unrun', 'not run'], ['failure', 'failed']]) {
    const held = above.filter(strip => strip.kind === kind);
    if (!held.length) continue;
    const middle = (held[0].top + held[held.length - 1].top + held[held.length - 1].height) / 2;
    svg.append('text').attr({class: 'strip-name ' + kind, x: box.left - 6, y: middle + 4, 'text-anchor': 'end'}).text(words);
  }
  const timeless = above.find(({kind, gap}) => kind === 'failure' && gap);
  const last = timeless && d3.max(timeless.marks, mark => mark.x);
  if (timeless && box.end - last > 70)
    svg.append('text')
        .attr({x: box.end - 6, y: timeless.top + timeless.height / 2 + 4, 'text-anchor': 'end'})
        .text('no time');
}

// Errors below the reference's own mean nothing.
function drawFloor(svg, {box, y, floor}) {
  const [low] = y.domain();
  if (!floor || floor <= low) return;
  const top = y(floor);
  svg.append('rect').attr({class: 'floor', x: box.left, y: top, width: box.end - box.left, height: box.foot - top});
  svg.append('line').attr({class: 'floor-edge', x1: box.left, x2: box.end, y1: top, y2: top});
  svg.append('text')
      .attr({class: 'halo-text', x: box.left + 6, y: box.foot - top > 18 ? top + 14 : top - 5})
      .text('below the reference’s own error');
}

// The staircase under which no setting lies: from its cheapest point up, from its most exact one on.
function drawFront(svg, {box, marks}) {
  const front = marks.filter(mark => mark.kind === 'point' && (mark.row.pareto || []).includes(choice.measure.name))
                    .sort((a, b) => a.x - b.x);
  if (!front.length || choice.statistic !== 'worst') return;
  // What has no error at all needs its cheapest setting alone.
  const end = front.findIndex(mark => mark.exact) + 1;
  const path = front.slice(0, end || front.length).map(({x, y}, i) => (i ? 'H' + x : 'M' + x + ',' + box.plot) + 'V' + y).join('') + 'H' + box.end;
  svg.append('path').attr({class: 'front', d: path});
}

// A thin line joins the best of each series: what no other of its settings undercuts in both.
function drawSeries(svg, {marks}) {
  choice.series.forEach((series, index) => {
    const points =
        marks.filter(mark => mark.kind === 'point' && mark.row.series === series.name).sort((a, b) => a.x - b.x || b.y - a.y);
    const best = points.filter((point, i) => points.slice(0, i).every(cheaper => !cheaper.exact && cheaper.y < point.y));
    if (best.length < 2) return;
    svg.append('path').attr({class: 'way', d: 'M' + best.map(({x, y}) => x + ',' + y).join('L')}).style('color', sb.hue(index));
  });
}

function drawIntervals(svg, {x, marks}) {
  for (const {row, y: at} of marks.filter(mark => mark.kind === 'point' && mark.row.cpu_s && !sb.fewRuns(mark.row.cpu_s))) {
    const scale = row.cost / row.cpu_s.median;
    const [low, high] = [x(row.cpu_s.low * scale), x(row.cpu_s.high * scale)];
    svg.append('path')
        .attr({
          class: 'interval',
          d: 'M' + low + ',' + (at - 3.5) + 'v7M' + high + ',' + (at - 3.5) + 'v7M' + low + ',' + at + 'H' + high
        })
        .style('color', sb.hue(choice.seriesIndex(row)));
  }
}

const spoken = row => [choice.seriesTitle(row) + ', ' + row.settings,
                       choice.placed(row) ? choice.statistic + ' error ' + choice.errorText(row) : choice.reason(row),
                       timed(row) ? sb.duration(row.cost) + ' CPU per simulated second' : 'no time']
                          .join('; ');

// Names at the points that matter, where there is room for them.
function drawNames(svg, {box, marks}) {
  const taken = marks.map(({x, y}) => [x - 7, y - 7, x + 7, y + 7]);
  if (box.exact) taken.push([box.left, box.bottom - 16, box.left + 150, box.bottom]);
  const free = ([l, t, r, b]) => l >= box.left && r <= box.end && t >= box.plot && b <= box.bottom &&
      !taken.some(([left, top, right, bottom]) => l < right && r > left && t < bottom && b > top);
  const weight = ({row}) => (row.own ? 0 : 1);
  const named = marks.filter(({kind, row}) => kind === 'point' && (row.own || (row.pareto || []).includes(choice.measure.name)));
  for (const {row, x, y} of named.sort((a, b) => weight(a) - weight(b))) {
    const words = row.label + (row.own ? ', this scene' : '');
    const width = 6.4 * words.length, off = row.own ? 13 : 9;
    const place = [[off, -6], [off, 14], [-off - width, 14], [-off - width, -6], [-width / 2, 22], [-width / 2, -13]]
                      .map(([dx, dy]) => [x + dx, y + dy - 10, x + dx + width, y + dy + 2])
                      .find(free);
    if (!place) continue;
    taken.push(place);
    svg.append('text').attr({class: 'halo-text name', x: place[0], y: place[3] - 2}).text(words);
  }
}

class Diagram {
  constructor() {
    this.host = el('div.diagram');
    this.note = el('div.note');
    this.failures = el('ul.failures');
    this.unrun = el('details.unrun');
    sb.onWidth(this.host, () => this.draw());
    choice.on('view', () => this.draw());
    choice.on('row', () => this.mark());
  }

  draw() {
    if (!choice.measure || !this.host.clientWidth) return;
    this.drawn = this.host.clientWidth;
    const focused = this.host.contains(document.activeElement);
    const rows = sorted();
    this.place = layout(this.drawn, rows);
    const {box, marks} = this.place;
    this.host.replaceChildren();
    const svg = d3.select(this.host).append('svg').attr({
      viewBox: [0, 0, this.drawn, box.height].join(' '),
      role: 'group',
      'aria-label': 'Work-precision diagram: ' + choice.statistic + ' error, ' + choice.measure.title +
          ', against CPU time. Arrow keys go from mark to mark.'
    });
    svg.append('defs')
        .append('pattern')
        .attr({id: 'floor-hatch', width: 7, height: 7, patternUnits: 'userSpaceOnUse', patternTransform: 'rotate(45)'})
        .append('rect')
        .attr({class: 'floor-line', width: 1.6, height: 7});
    drawFloor(svg, this.place);
    drawStrips(svg, this.place);
    axes(svg, this.place);
    drawFront(svg, this.place);
    drawSeries(svg, this.place);
    drawIntervals(svg, this.place);
    // From left to right, which is the order of the arrow keys.
    this.order = marks.slice().sort((a, b) => a.x - b.x || a.y - b.y);
    this.nodes = this.order.map(mark => this.drawMark(svg, mark));
    drawNames(svg, this.place);
    this.listen(svg.node());
    this.note.replaceChildren(...this.remark(rows).map(line => el('p', {}, line)));
    this.listAside(marks);
    this.mark();
    if (focused) this.focus(0);
  }

  drawMark(svg, {row, kind, number, bare, x, y}) {
    const index = choice.seriesIndex(row);
    const group = svg.append('g')
                      .attr({
                        class: 'point ' + kind,
                        transform: 'translate(' + [x, y] + ')',
                        tabindex: -1,
                        role: 'button',
                        'aria-label': spoken(row)
                      })
                      .style('color', kind === 'unrun' ? 'var(--soft)' : sb.hue(index));
    group.append('circle').attr({class: 'here', r: radius + 4});
    if (row.own) group.append('circle').attr({class: 'own', r: radius + 4.5});
    if (kind === 'failure') {
      group.append('path').attr({class: 'cross', d: sb.crossPath(4.5)});
      if (!bare) group.append('text').attr({x: 8, y: 4}).text(number);
    } else {
      group.append('path').attr({class: 'mark ' + kind, d: sb.markPath(index, kind === 'unrun' ? 4 : radius)});
    }
    return group.node();
  }

  // Pointing shows a row, a click or Enter selects it; arrow keys go on from mark to mark.
  listen(svg) {
    const nearest = event => {
      const scale = this.drawn / svg.getBoundingClientRect().width;
      const left = (event.clientX - svg.getBoundingClientRect().left) * scale;
      const top = (event.clientY - svg.getBoundingClientRect().top) * scale;
      const far = mark => Math.hypot(mark.x - left, mark.y - top);
      const best = this.order.slice().sort((a, b) => far(a) - far(b))[0];
      return best && far(best) < reach ? best : null;
    };
    svg.addEventListener('pointermove', event => {
      const mark = nearest(event);
      svg.style.cursor = mark ? 'pointer' : '';
      choice.point(mark && mark.row);
      if (mark)
        sb.showTip(this.lines(mark), event.clientX, event.clientY);
      else
        sb.hideTip();
    });
    svg.addEventListener('pointerleave', () => {
      choice.point(null);
      sb.hideTip();
    });
    svg.addEventListener('click', event => {
      const mark = nearest(event);
      if (mark) choice.select(mark.row);
    });
    svg.addEventListener('keydown', event => {
      const at = this.nodes.indexOf(document.activeElement);
      const steps = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1, Home: -this.nodes.length, End: this.nodes.length};
      if (event.key in steps)
        this.focus(Math.min(this.nodes.length - 1, Math.max(0, at + steps[event.key])));
      else if (at >= 0 && (event.key === 'Enter' || event.key === ' '))
        choice.select(this.order[at].row);
      else if (event.key === 'Escape')
        sb.hideTip();
      else
        return;
      event.preventDefault();
    });
    this.nodes.forEach((node, i) => {
      node.addEventListener('focus', () => {
        choice.point(this.order[i].row);
        const {right, top} = node.getBoundingClientRect();
        sb.showTip(this.lines(this.order[i]), right, top);
      });
      node.addEventListener('blur', () => {
        choice.point(null);
        sb.hideTip();
      });
    });
  }

  focus(index) {
    if (this.nodes[index]) this.nodes[index].focus();
  }

  lines({row, number}) {
    const cheapest = choice.cheapestAsExact(row);
    return [
      (number ? number + '  ' : '') + row.settings,
      choice.placed(row) ? choice.statistic + ' error: ' + choice.errorText(row) : choice.reason(row),
      row.rate_hz ? 'output at ' + sb.rateText(row.rate_hz) : '',
      timed(row) ? sb.duration(row.cost) + ' a simulated second, ' + sb.timesReal(row.cost) + ' real time' +
              (row.cpu_s && sb.fewRuns(row.cpu_s) ? ', ' + sb.fewRuns(row.cpu_s) : '') :
                   '',
      cheapest ? 'as exact for 1/' + sb.figure(row.cost / cheapest.cost, 2) + ' of that: ' + cheapest.settings : ''
    ].filter(text => text);
  }

  // Shows which mark is selected or pointed at; the tab key reaches that one.
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

  // What the measure is; what it is measured against; what is not drawn: a line each.
  remark(rows) {
    const measure = choice.measure;
    const drawn = rows.points.length + rows.exact.length + rows.failures.length + rows.unrun.length;
    const shown = choice.rows.filter(row => !choice.hidden.has(row.series)).length;
    const parts = ['Reference: ' + measure.reference + '.'];
    if (measure.floor) {
      const own = 'The reference’s own error is about ' + sb.measured(measure, measure.floor);
      parts.push(
          own +
          (measure.floor > this.place.y.domain()[0] ? ': errors in the hatched band mean nothing.' : ', below this diagram.'));
    }
    if (choice.statistic !== 'worst') parts.push('The front is that of the worst error and is not drawn here.');
    if (shown > drawn) parts.push((shown - drawn) + ' of ' + shown + ' runs have no value of this measure.');
    return [measure.title[0].toUpperCase() + measure.title.slice(1) + ': ' + measure.definition + '.', parts.join(' ')];
  }

  // What is not in the plot and why, those of one reason together.
  listAside(marks) {
    this.listed = [];
    const link = ({row, number}) => {
      const node = el('button.link', {onclick: () => choice.select(row)}, number ? number + ' ' : '',
                      sb.swatch(choice.seriesIndex(row), choice.kind(row)), row.settings);
      this.listed.push([row, node]);
      return node;
    };
    const reasons = kind => d3.nest().key(({row}) => choice.reason(row)).entries(marks.filter(mark => mark.kind === kind));
    const entries = kind => reasons(kind).map(({key, values}) => el('li', {}, el('span.why', {}, key), values.map(link)));
    const unrun = marks.filter(mark => mark.kind === 'unrun').length;
    this.failures.replaceChildren(...entries('failure'));
    this.unrun.hidden = !unrun;
    this.unrun.replaceChildren(
        el('summary', {}, unrun + (unrun === 1 ? ' setting' : ' settings') + ' not run for want of time'),
        el('ul.failures', {}, entries('unrun')));
  }
}

// Which series are drawn: the legend is a row of switches.
function legend() {
  const used = choice.series.filter(series => choice.rows.some(row => row.series === series.name));
  const buttons = used.map(
      series =>
          el('button.key', {
            'aria-pressed': 'true',
            title: 'show or hide',
            onclick: event => {
              const hidden = new Set(choice.hidden);
              if (!hidden.delete(series.name)) hidden.add(series.name);
              event.currentTarget.setAttribute('aria-pressed', String(!hidden.has(series.name)));
              choice.view({hidden});
            }
          },
             sb.swatch(choice.series.indexOf(series)), series.title));
  const sample = (kind, draw, words) => {
    const item = el('span');
    draw(d3.select(item).append('svg').attr({viewBox: '0 0 24 16', class: kind, 'aria-hidden': 'true'}));
    item.append(words);
    return item;
  };
  return el(
      'div.keys', {}, buttons,
      choice.rows.some(row => (row.pareto || []).length) ?
          sample('sample', svg => svg.append('path').attr({class: 'front', d: 'M2,1V8H14V14H23'}), 'Pareto front') :
          null,
      choice.rows.some(row => row.own) ?
          sample('sample', svg => svg.append('circle').attr({class: 'own', cx: 12, cy: 8, r: 6.5}), 'the scene’s own setting') :
          null,
      choice.rows.some(row => choice.failed(row)) ?
          sample(
              'sample', svg => svg.append('path').attr({class: 'cross', transform: 'translate(12,8)', d: sb.crossPath(4.5)}),
              'failed') :
          null,
      choice.rows.some(row => choice.notRun(row)) ?
          sample(
              'sample',
              svg => svg.append('path').attr({class: 'mark unrun', transform: 'translate(12,8)', d: sb.markPath(0, 4)}), 'not run') :
          null,
      sample('sample', svg => svg.append('path').attr({class: 'interval', d: 'M2,4v8M22,4v8M2,8H22'}), 'spread of the CPU time'));
}

function controls() {
  const options = choice.measures.map(measure => el('option', {value: measure.name}, sb.titled(measure)));
  const segment = statistic =>
      el('button', {
        'aria-pressed': String(choice.statistic === statistic),
        onclick: event => {
          for (const button of event.currentTarget.parentNode.children)
            button.setAttribute('aria-pressed', String(button === event.currentTarget));
          choice.view({statistic});
        }
      },
         statistic);
  return el(
      'div.controls', {},
      el('label', {}, 'error of',
         el('select',
            {onchange: event => choice.view({measure: choice.measures.find(measure => measure.name === event.target.value)})},
            options)),
      el('span.segments', {role: 'group', 'aria-label': 'which error'}, segment('worst'), segment('median')));
}

// Everything about one row, beside the diagram.
function detail() {
  const host = el('aside.row-detail');
  const draw = () => {
    const row = choice.shown;
    if (!row) return;
    const item = (name, ...value) => el('div', {}, el('dt', {}, name), el('dd', {}, value));
    const cpu = row.cpu_s;
    const cheapest = choice.cheapestAsExact(row);
    host.replaceChildren(
        el('p.eyebrow', {}, sb.swatch(choice.seriesIndex(row), choice.kind(row)), choice.seriesTitle(row)),
        el('h3', {}, row.settings), row.own ? el('p.tag', {}, 'the scene’s own setting') : '',
        choice.kind(row) === 'point' ? '' : el(choice.notRun(row) ? 'p.note' : 'p.warning', {}, choice.reason(row)),
        el('dl.facts', {}, row.rate_hz ? item('output', sb.rateText(row.rate_hz)) : null, item('CPU time', cpu ? sb.duration(cpu.median) : 'none measured'),
           cpu && !sb.fewRuns(cpu) ? item('between', sb.duration(cpu.low) + ' and ' + sb.duration(cpu.high)) : null,
           cpu ? item('runs', sb.fewRuns(cpu) || String(cpu.repeats)) : null,
           !timed(row) ? null :
                         [item('a simulated second', sb.duration(row.cost)), item('times real time', sb.timesReal(row.cost))]),
        cheapest ? el('p.note', {}, 'As exact for 1/' + sb.figure(row.cost / cheapest.cost, 2) + ' of the time: ',
                      el('button.link', {onclick: () => choice.select(cheapest)}, cheapest.settings)) :
                   '',
        el('table', {},
           el('thead', {}, el('tr', {}, el('th.text', {}, 'error of'), el('th', {}, 'worst'), el('th', {}, 'median'))),
           el('tbody', {},
              choice.measures.map(
                  measure =>
                      el(measure === choice.measure ? 'tr.current' : 'tr', {}, el('td.text.long', {}, measure.title),
                         ['worst', 'median'].map(statistic => el('td', {}, choice.errorText(row, measure, statistic))))))),
        ...(row.command ? [el('div.command', {}, el('p.eyebrow', {}, 'again: ', sb.copyButton(row.command)),
                              el('pre.mono', {}, row.command))] :
                          []));
  };
  choice.on('row', draw);
  choice.on('view', draw);
  draw();
  return host;
}

sb.diagramSection = () => {
  const diagram = new Diagram();
  return el(
      'section', {}, el('h2', {}, 'What accuracy costs'), controls(), legend(),
      el('div.explorer', {}, el('div', {}, diagram.host, diagram.note, diagram.failures, diagram.unrun), detail()), sb.pricesTable());
};
})(window.slipbench);
