// Success maps with their frontiers, or a curve where one number was swept.
(function(sb) {
'use strict';
const el = sb.element;
const {quantities, medians, held, countOf, valueIn, rangeIn, withUnit, heldText, balancedOf, recallOf, earlyText} = sb.grasps;

const hues = ['#2f78b7', '#d99500', '#0a7d66', '#a5559b', '#cc4b1c', '#5b6570', '#59b3d8', '#8a7a00'];
const shapes = ['circle', 'square', 'triangle-up', 'diamond', 'cross', 'triangle-down'];
const dashes = [null, '7 3', '2 3', '9 3 2 3'];
const firstX = ['friction.scale', 'friction.static', 'detector.flip'], firstY = ['box.mass', 'motion.speed', 'grip.preset'];
const mostMaps = 36;

// Everything that the pictures of one section share.
class Maps {
  constructor(swept, open) {
    this.swept = swept;
    this.open = open;
    const preferred = (list, others) => others.find(axis => list.includes(axis.path)) || others[0];
    this.x = preferred(firstX, swept.numbers);
    this.y = preferred(firstY, swept.numbers.filter(axis => axis !== this.x)) || null;
    this.quantity = quantities[0];
    this.tip = el('div.tip');
    this.legend = el('div.legend');
    this.note = el('p.note');
    this.host = el('div.panels');
    this.detail = el('div.cell-detail');
    this.controls = el('div.controls');
    this.section =
        el('section', {}, el('h2', {}, 'Success maps'), this.note, this.controls, this.legend, this.host, this.detail, this.tip);
    this.draw();
  }

  choose(name, options, value, change) {
    const select =
        el('select', {
          onchange: event => {
            change(event.target.value);
            this.draw();
          }
        },
           options.map(([key, text]) => el('option', {value: key, selected: key === value ? '' : null}, text)));
    return el('label', {}, name, select);
  }

  draw() {
    const {numbers} = this.swept;
    const byPath = path => numbers.find(axis => axis.path === path) || null;
    const options = numbers.map(axis => [axis.path, sb.pathWord(axis.path)]);
    this.controls.replaceChildren(
        this.choose(
            'across', options, this.x.path,
            path => {
              if (this.y && path === this.y.path) this.y = this.x;
              this.x = byPath(path);
            }),
        numbers.length < 2 ? '' :
                             this.choose(
                                 'up', [['', 'the quantity: a curve'], ...options.filter(([path]) => path !== this.x.path)],
                                 this.y ? this.y.path : '',
                                 path => {
                                   this.y = byPath(path);
                                 }),
        !this.y ? '' :
                  this.choose('colour', quantities.map(quantity => [quantity.key, quantity.name]), this.quantity.key, key => {
                    this.quantity = quantities.find(quantity => quantity.key === key);
                  }));
    this.host.replaceChildren();
    this.detail.replaceChildren();
    this.section.querySelector('h2').textContent = this.y ? 'Success maps' : 'Success curve';
    if (this.y)
      this.drawMaps();
    else
      this.drawCurves();
  }

  // Trials of a series by row and column.
  cells(series, columns, rows) {
    const grid = rows.map(() => columns.map(() => []));
    for (const trial of series.trials) {
      const c = this.swept.levelOf(columns, this.x, trial), r = this.swept.levelOf(rows, this.y, trial);
      if (c >= 0 && r >= 0) grid[r][c].push(trial);
    }
    return grid;
  }

  drawMaps() {
    const columns = this.swept.levels(this.x), rows = this.swept.levels(this.y);
    const all = this.swept.series([this.x, this.y]);
    const maps = all.slice(0, mostMaps).map(series => {
      const cells = this.cells(series, columns, rows);
      const shares = cells.map(row => row.map(trials => trials.length ? held(trials) / trials.length : null));
      return {series, cells, frontier: sb.contour(shares, 0.5)};
    });
    const control = series => maps.find(map => map.series.control && (map.series.others === series.others));
    const values =
        maps.flatMap(map => map.cells.flat().map(trials => valueIn(this.quantity, trials))).filter(value => value !== null);
    const range = d3.extent(values);
    this.note.textContent =
        'One map for each detector and controller; a cell is all its trials. The frontier is the contour at 50 % held, ' +
        'straight between the middles of neighbouring cells. Click a cell for its trials and the command that replays one.' +
        (all.length > mostMaps ? ' The first ' + mostMaps + ' of ' + all.length + ' maps are shown.' : '');
    this.drawMapLegend(range, maps.some(map => map.series.control));
    const groups = new Map();
    for (const map of maps) groups.set(map.series.others, [...(groups.get(map.series.others) || []), map]);
    for (const group of groups.values()) {
      for (const map of group) this.drawMap(map, control(map.series), columns, rows, range);
      if (group.filter(map => map.frontier.length).length > 1) this.drawFrontiers(group, columns, rows);
    }
  }

  // What stands in a cell: k/n of a share, else the value.
  cellText(trials) {
    if (this.quantity.good) {
      const [good, all] = countOf(this.quantity, trials);
      return all ? good + '/' + all : '–';
    }
    const value = valueIn(this.quantity, trials);
    return value === null ? '–' : sb.significant(value, value >= 100 ? 3 : 2);
  }

  // A cell's paint: how far from half of the trials held, or how much of another quantity.
  paint(value, range) {
    if (value === null) return ['none', 0];
    if (this.quantity.good) return [value >= 50 ? 'var(--stick)' : 'var(--slip)', 0.66 * Math.abs(value - 50) / 50];
    const [low, high] = range;
    return ['var(--stick)', 0.04 + 0.62 * (high > low ? (value - low) / (high - low) : 1)];
  }

  drawMapLegend(range, hasControl) {
    const samples = this.quantity.good ? [0, 25, 50, 75, 100] : d3.range(5).map(i => range[0] + (range[1] - range[0]) * i / 4);
    const swatch = value => {
      const item = el('span');
      const [fill, opacity] = this.paint(value, range);
      d3.select(item)
          .append('svg')
          .attr('aria-hidden', 'true')
          .attr('viewBox', '0 0 22 14')
          .append('rect')
          .attr('width', 20)
          .attr('height', 13)
          .attr('y', 0.5)
          .style('fill', fill)
          .style('fill-opacity', opacity)
          .style('stroke', 'var(--line)');
      item.append(withUnit(value, this.quantity.unit));
      return item;
    };
    const line = (name, control) => {
      const item = el('span');
      d3.select(item)
          .append('svg')
          .attr('aria-hidden', 'true')
          .attr('viewBox', '0 0 22 14')
          .append('path')
          .attr('class', control ? 'frontier control' : 'frontier')
          .attr('d', 'M1,7H21');
      item.append(name);
      return item;
    };
    this.legend.replaceChildren(
        el('span', {}, this.quantity.name + (this.quantity.good ? ', k/n: k of n trials' : '') + ':'), ...(range[0] === undefined ? [] : samples.map(swatch)),
        line('frontier, 50 % held', false), hasControl ? line('frontier of the negative control', true) : '');
  }

  // Axes of a map: cells of one size, named by their values.
  mapFrame(title, note, columns, rows) {
    const box = {width: 400, left: 62, right: 6, top: 6, bottom: 40};
    box.height = box.top + box.bottom + Math.min(300, Math.max(180, 34 * rows.length));
    const x = i => box.left + (i + 0.5) * (box.width - box.left - box.right) / columns.length;
    const y = i => box.height - box.bottom - (i + 0.5) * (box.height - box.top - box.bottom) / rows.length;
    const panel = el('div', {}, el('h3', {}, title, note ? el('span.note', {}, ' · ' + note) : null));
    this.host.append(panel);
    // A group: its cells are buttons.
    const svg = d3.select(panel)
                    .append('svg')
                    .attr('viewBox', '0 0 ' + box.width + ' ' + box.height)
                    .attr('class', 'map')
                    .attr('role', 'group')
                    .attr('aria-label', title + ', ' + sb.sweptValues.label(this.y) + ' against ' + sb.sweptValues.label(this.x));
    const tick = (axis, level) => isFinite(level.at) ? sb.significant(level.at * sb.factor(axis.unit), 3) : level.text;
    const stride = (count, room, needed) => Math.ceil(count * needed / room);
    const across = stride(columns.length, box.width - box.left - box.right, 34),
          up = stride(rows.length, box.height - box.top - box.bottom, 15);
    columns.forEach((level, i) => {
      if (i % across === 0)
        svg.append('text')
            .attr('x', x(i))
            .attr('y', box.height - box.bottom + 15)
            .attr('text-anchor', 'middle')
            .text(tick(this.x, level));
    });
    rows.forEach((level, i) => {
      if (i % up === 0)
        svg.append('text').attr('x', box.left - 6).attr('y', y(i) + 4).attr('text-anchor', 'end').text(tick(this.y, level));
    });
    svg.append('text')
        .attr('class', 'title')
        .attr('x', (box.left + box.width - box.right) / 2)
        .attr('y', box.height - 6)
        .attr('text-anchor', 'middle')
        .text(sb.sweptValues.label(this.x));
    svg.append('text')
        .attr('class', 'title')
        .attr('transform', 'translate(11,' + (box.top + box.height - box.bottom) / 2 + ')rotate(-90)')
        .attr('text-anchor', 'middle')
        .text(sb.sweptValues.label(this.y));
    return {svg, box, x, y, panel};
  }

  drawMap(map, control, columns, rows, range) {
    const {svg, box, x, y, panel} = this.mapFrame(map.series.name, map.series.control ? 'negative control' : '', columns, rows);
    const width = x(1) - x(0), height = y(0) - y(1);
    const texts = map.cells.map(row => row.map(trials => this.cellText(trials)));
    const widest = d3.max(texts.flat(), text => text.length);
    // At 11 px a figure takes 6.2 px; in a narrow cell it is smaller, and below 8 px it is left to the tip.
    const size = Math.min(11, 11 * (width - 4) / (6.2 * widest), 0.75 * height);
    const numbers = size >= 8;
    map.cells.forEach((row, r) => row.forEach((trials, c) => {
      const value = valueIn(this.quantity, trials);
      const [fill, opacity] = this.paint(value, range);
      const open = () => this.showCell(map.series, columns[c], rows[r], trials);
      const cell = svg.append('g').attr('class', 'map-cell');
      cell.append('rect')
          .attr('x', x(c) - width / 2)
          .attr('y', y(r) - height / 2)
          .attr('width', width)
          .attr('height', height)
          .style('fill', fill)
          .style('fill-opacity', opacity);
      if (!trials.length) return;
      const where =
          [map.series.name, sb.pathWord(this.x.path) + ': ' + columns[c].text, sb.pathWord(this.y.path) + ': ' + rows[r].text];
      cell.attr('tabindex', 0)
          .attr('role', 'button')
          .attr('aria-label', [...where, heldText(trials)].join(', '))
          .on('click', open)
          .on('keydown', () => {
            if (d3.event.key === 'Enter') open();
          });
      this.explain(cell, () => [...where, ...this.said(trials)]);
    }));
    this.drawContour(svg, x, y, map.frontier, 'frontier');
    if (control && control !== map) this.drawContour(svg, x, y, control.frontier, 'frontier control');
    if (numbers) {
      // Over the frontiers, which may go through the middle of a cell.
      map.cells.forEach((row, r) => row.forEach((trials, c) => {
        svg.append('text')
            .attr('class', 'map-number')
            .attr('x', x(c))
            .attr('y', y(r) + 0.36 * size)
            .attr('text-anchor', 'middle')
            .style('font-size', size + 'px')
            .text(texts[r][c]);
      }));
    }
    this.drawEdge(svg, box);
    const {quantity} = this;
    const figure = (axis, level) => level.low === level.high && isFinite(level.at) ? level.at * sb.factor(axis.unit) : level.text;
    sb.saveCorner(panel, svg.node(), map.series.name + ' ' + quantity.name, () => [
      [sb.sweptValues.label(this.x), sb.sweptValues.label(this.y), ...(quantity.good ? ['k', 'n'] : []), quantity.name + (quantity.unit ? ' [' + quantity.unit + ']' : '')],
      ...map.cells.flatMap((row, r) => row.map((trials, c) => [
        figure(this.x, columns[c]), figure(this.y, rows[r]), ...(quantity.good ? countOf(quantity, trials) : []), valueIn(quantity, trials)
      ]))
    ]);
  }

  drawEdge(svg, box) {
    svg.append('rect')
        .attr('class', 'map-edge')
        .attr('x', box.left)
        .attr('y', box.top)
        .attr('width', box.width - box.left - box.right)
        .attr('height', box.height - box.top - box.bottom);
  }

  drawContour(svg, x, y, lines, kind) {
    if (!lines.length) return;
    const path = lines.map(([a, b]) => 'M' + x(a[0]) + ',' + y(a[1]) + 'L' + x(b[0]) + ',' + y(b[1])).join('');
    svg.append('path').attr('class', 'halo').attr('d', path);
    return svg.append('path').attr('class', kind).attr('d', path);
  }

  // The frontiers of maps that share their axes, in one picture.
  drawFrontiers(group, columns, rows) {
    const {svg, box, x, y, panel} =
        this.mapFrame('Frontiers together' + (group[0].series.others ? ', ' + group[0].series.others : ''), '', columns, rows);
    this.drawEdge(svg, box);
    sb.saveCorner(panel, svg.node(), 'Frontiers', () => [
      ['series', sb.sweptValues.label(this.x) + ', place', sb.sweptValues.label(this.y) + ', place', 'to', 'to'],
      ...group.flatMap(map => map.frontier.map(([a, b]) => [map.series.name, ...a, ...b]))
    ]);
    const legend = el('div.legend');
    group.filter(map => map.frontier.length).forEach((map, i) => {
      const style = path => path.style('stroke', map.series.control ? null : hues[i % hues.length])
                                .style('stroke-dasharray', map.series.control ? null : dashes[i % dashes.length]);
      const kind = map.series.control ? 'frontier control' : 'frontier';
      style(this.drawContour(svg, x, y, map.frontier, kind));
      const item = el('span');
      style(d3.select(item).append('svg').attr('aria-hidden', 'true').attr('viewBox', '0 0 22 14').append('path').attr('class', kind).attr('d', 'M1,7H21'));
      item.append(map.series.name);
      legend.append(item);
    });
    this.host.lastChild.append(legend);
  }

  said(trials) {
    return [
      heldText(trials),
      ...quantities.slice(1).map(quantity => quantity.name + ': ' + withUnit(valueIn(quantity, trials), quantity.unit))
    ];
  }

  saidOfDetector(trials) {
    return balancedOf(trials) === null ? [] : [
      'recall of slip: ' + sb.percent(recallOf(trials)), 'balanced accuracy: ' + sb.percent(balancedOf(trials)),
      'early: ' + earlyText(trials)
    ];
  }

  // A tip at the pointer.
  explain(node, lines) {
    node.on('mousemove', () => {
          this.tip.style.display = 'block';
          this.tip.style.left = Math.min(d3.event.clientX + 14, window.innerWidth - 300) + 'px';
          this.tip.style.top = (d3.event.clientY + 12) + 'px';
          this.tip.textContent = lines().join('\n');
        }).on('mouseout', () => {
      this.tip.style.display = 'none';
    });
  }

  // The trials of a cell, and how to see one again.
  showCell(series, column, row, trials) {
    const where =
        [series.name, sb.pathWord(this.x.path) + ' ' + column.text, row ? sb.pathWord(this.y.path) + ' ' + row.text : ''];
    const example = trials.find(trial => sb.isEmbedded(trial.index)) || trials.find(trial => trial.grasp.dropped) || trials[0];
    const rows = trials.slice(0, 200).map(
        trial =>
            el('tr', {}, el('td', {}, String(trial.index)),
               el('td.text', {}, trial.grasp.dropped ? 'dropped at ' + sb.seconds(trial.grasp.drop_s) : 'held'),
               medians.map(quantity => el('td', {}, sb.significant(quantity.one(trial), 3))),
               el('td.text', {},
                  sb.isEmbedded(trial.index) ? el('button.link', {onclick: () => this.open(trial.index)}, 'open') :
                      trial.samples ? el('button.link', {onclick: event => sb.copy(event.target, sb.reportCommand(trial))},
                                         'copy command of its report') :
                                      ''),
               el('td.text', {},
                  el('button.link', {onclick: event => sb.copy(event.target, sb.replayCommand(trial))},
                     'copy command of its replay'))));
    const head = ['trial', 'end', 'slip, mm', 'turn, °', 'largest / ideal force', 'reaction, ms', 'delay, ms', 'here', 'replay'];
    this.detail.replaceChildren(
        el('h3', {}, where.filter(text => text).join(', ')),
        el('p.note', {}, heldText(trials) + '. Trial ' + example.index + ' again, with its recording:'),
        el('pre.mono', {}, sb.replayCommand(example)),
        el('div.scroll.tall', {},
           el('table', {},
              el('thead', {}, el('tr', {}, head.map((text, i) => el([1, 7, 8].includes(i) ? 'th.text' : 'th', {}, text)))),
              el('tbody', {}, rows))));
    this.detail.scrollIntoView({block: 'nearest', behavior: 'smooth'});
  }

  drawCurves() {
    const levels = this.swept.levels(this.x);
    const pointsOf = series =>
        levels
            .map(
                level =>
                    ({level, trials: series.trials.filter(trial => levels[this.swept.levelOf(levels, this.x, trial)] === level)}))
            .filter(point => point.trials.length);
    const all = this.swept.series([this.x]).slice(0, mostMaps).map(series => ({series, points: pointsOf(series)}));
    this.note.textContent = 'Bars: the exact 95 % interval of a share, the quartiles around a median. ' +
        'Click a point for its trials and the command that replays one.' +
        (isFinite(levels[levels.length - 1].at) ?
             '' :
             ' ' + sb.endless(this.x.unit) + ' has no place on the axis: see the table above.');
    const pick = i => ({colour: hues[i % hues.length], shape: shapes[i % shapes.length]});
    this.legend.replaceChildren(...all.map(({series}, i) => {
      const item = el('span');
      d3.select(item)
          .append('svg')
          .attr('aria-hidden', 'true')
          .attr('viewBox', '-7 -7 14 14')
          .style('width', '14px')
          .append('path')
          .attr('d', d3.svg.symbol().type(pick(i).shape).size(60)())
          .style('fill', pick(i).colour);
      item.append(series.name + (series.control ? ' · negative control' : ''));
      return item;
    }));
    const chart = (quantity, more) => this.drawCurve(all, pick, {
      title: quantity.name + (quantity.unit ? ', ' + quantity.unit : ''),
      across: this.x,
      at: point => point.level.at * sb.factor(this.x.unit),
      value: point => valueIn(quantity, point.trials),
      range: point => rangeIn(quantity, point.trials),
      percent: Boolean(quantity.good),
      ...more
    });
    const [share, ...others] = quantities;
    const balanced = point => balancedOf(point.trials) === null ? null : 100 * balancedOf(point.trials);
    chart(share);
    if (this.x.path === 'detector.flip') {
      chart(share, {title: 'balanced accuracy of the detector, %', value: balanced, range: () => null});
      chart(share, {across: null, at: balanced});
      chart(others[0], {across: null, at: balanced});
    }
    for (const quantity of others) chart(quantity);
  }

  // One chart of all series. `across`: the axis that stands below, or null where it is the detector's balanced accuracy.
  drawCurve(all, pick, {title, across, at, value, range, percent}) {
    const there = point => at(point) !== null && isFinite(at(point)) && value(point) !== null;
    const points = all.flatMap(({points}) => points.filter(there));
    if (!points.length) return;
    const box = {width: 400, height: 270, left: 50, right: 14, top: 10, bottom: 40};
    const xs = d3.extent(points, at);
    const xLog = across !== null && sb.sweptValues.wide(xs, 8, across.unit);
    const room = 0.05 * (xs[1] - xs[0]) || 0.1 * Math.abs(xs[0]) || 1;
    const x = (xLog ? d3.scale.log().domain([xs[0] / 1.15, xs[1] * 1.15]) : d3.scale.linear().domain([
                xs[0] - room, xs[1] + room
              ])).range([box.left, box.width - box.right]);
    const ends = points.flatMap(point => [value(point), ...(range(point) || [])]);
    const y = d3.scale.linear().domain(percent ? [-2, 102] : [Math.min(0, d3.min(ends)), d3.max(ends) || 1]).range([
      box.height - box.bottom, box.top
    ]);
    if (!percent) y.nice();
    const panel = el('div');
    this.host.append(panel);
    const svg = sb.frame(
        panel, box, x, y,
        across ? sb.sweptValues.label(across) + (xLog ? ' (log)' : '') : 'balanced accuracy of the detector, %', title, xLog,
        false);
    sb.saveCorner(panel, svg.node(), title.split(',')[0], () => [
      ['series', across ? sb.sweptValues.label(across) : 'balanced accuracy [%]', title, 'from', 'to', 'trials'],
      ...all.flatMap(({series, points}) => points.filter(there).map(
          point => [series.name, at(point), value(point), ...(range(point) || [null, null]), point.trials.length]))
    ]);
    all.forEach(({series, points}, i) => {
      const {colour, shape} = pick(i);
      const shift = (i - (all.length - 1) / 2) * 3;  // intervals beside each other
      const shown = points.filter(there);
      const left = point => x(at(point)) + shift;
      svg.append('path')
          .attr('d', 'M' + shown.map(point => left(point) + ',' + y(value(point))).join('L'))
          .style('fill', 'none')
          .style('stroke', colour)
          .style('stroke-width', 1.6)
          .style('stroke-dasharray', series.control ? '5 4' : null);
      for (const point of shown) {
        const span = range(point);
        if (span)
          svg.append('path')
              .attr('d', 'M' + left(point) + ',' + y(span[0]) + 'V' + y(span[1]))
              .style('stroke', colour)
              .style('stroke-width', 1.3);
        const mark = svg.append('path')
                         .attr('class', 'point')
                         .attr('transform', 'translate(' + left(point) + ',' + y(value(point)) + ')')
                         .attr('d', d3.svg.symbol().type(shape).size(52)())
                         .style('fill', colour)
                         .on('click', () => this.showCell(series, point.level, null, point.trials));
        this.explain(
            mark,
            () =>
                [series.name, sb.pathWord(this.x.path) + ': ' + point.level.text, ...this.said(point.trials),
                 ...this.saidOfDetector(point.trials)]);
      }
    });
  }
}

// The section; `swept` is of the grasps, with at least one number that can be an axis.
sb.successMaps = (swept, open) => new Maps(swept, open).section;
})(window.slipbench);
