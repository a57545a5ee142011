// Success maps with their frontiers, or a curve if one number was swept.
const el = sb.element;
const mark = sb.mark, text = sb.text;
const {quantities, medians, medianHeads, held, countOf, valueIn, rangeIn, withUnit, heldText, balancedOf, recallOf, earlyText} =
    sb.grasps;
const {label} = sb.sweptValues;

const dashes = [null, '7 3', '2 3', '9 3 2 3'];
const firstX = ['friction.scale', 'friction.static', 'detector.flip'], firstY = ['box.mass', 'motion.speed', 'grip.preset'];
const mostMaps = 36;

// State shared by the charts of one section.
class Maps {
  constructor(swept, open) {
    Object.assign(this, {swept, open, quantity: quantities[0], heading: el('h2'), note: el('p.note')});
    Object.assign(
        this, {legend: el('div.legend'), host: el('div.panels'), detail: el('div.cell-detail'), controls: el('div.controls')});
    const preferred = (list, others) => others.find(axis => list.includes(axis.path)) || others[0];
    this.x = preferred(firstX, swept.numbers);
    this.y = preferred(firstY, swept.numbers.filter(axis => axis !== this.x)) || null;
    this.section = el('section', {}, this.heading, this.note, this.controls, this.legend, this.host, this.detail);
    this.draw();
  }

  choose(name, options, value, change) {
    return sb.choose(name, options, value, key => {
      change(key);
      this.draw();
    });
  }

  draw() {
    const {numbers} = this.swept;
    const byPath = path => numbers.find(axis => axis.path === path) || null;
    const options = numbers.map(axis => [axis.path, sb.pathWord(axis.path)]);
    const ups = [['', 'the quantity: a curve'], ...options.filter(([path]) => path !== this.x.path)];
    const across = path => {
      if (this.y && path === this.y.path) this.y = this.x;
      this.x = byPath(path);
    };
    const colours = quantities.map(({key, name}) => [key, name]);
    this.controls.replaceChildren(
        this.choose('across', options, this.x.path, across),
        numbers.length > 1 ? this.choose('up', ups, this.y?.path ?? '', path => this.y = byPath(path)) : '',
        this.y ?
            this.choose('colour', colours, this.quantity.key, key => this.quantity = quantities.find(one => one.key === key)) :
            '');
    this.host.replaceChildren();
    this.detail.replaceChildren();
    this.heading.textContent = this.y ? 'Success maps' : 'Success curve';
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
        'One map for each detector and controller; a cell contains all its trials. The frontier is the contour at 50 % held, ' +
        'interpolated linearly between the centres of cells. Click a cell for its trials and the command that repeats one.' +
        (all.length > mostMaps ? ' The first ' + mostMaps + ' of ' + all.length + ' maps are shown.' : '');
    this.drawMapLegend(range, maps.some(map => map.series.control));
    for (const [, group] of d3.groups(maps, map => map.series.others)) {
      for (const map of group) this.drawMap(map, control(map.series), columns, rows, range);
      if (group.filter(map => map.frontier.length).length > 1) this.drawFrontiers(group, columns, rows);
    }
  }

  // Text of a cell: k/n of a share, else the value.
  cellText(trials) {
    if (this.quantity.good) {
      const [good, all] = countOf(this.quantity, trials);
      return all ? good + '/' + all : '–';
    }
    const value = valueIn(this.quantity, trials);
    return value === null ? '–' : sb.significant(value, value >= 100 ? 3 : 2);
  }

  // Colour and opacity of a cell: distance from half of the trials held, or size of another
  // quantity.
  paint(value, range) {
    if (value === null) return ['none', 0];
    if (this.quantity.good) return [value >= 50 ? 'var(--stick)' : 'var(--slip)', 0.66 * Math.abs(value - 50) / 50];
    const [low, high] = range;
    return ['var(--stick)', 0.04 + 0.62 * (high > low ? (value - low) / (high - low) : 1)];
  }

  drawMapLegend(range, hasControl) {
    const samples = this.quantity.good ? [0, 25, 50, 75, 100] : d3.range(5).map(i => range[0] + (range[1] - range[0]) * i / 4);
    const swatch = value => {
      const [fill, opacity] = this.paint(value, range);
      const style = 'fill:' + fill + ';fill-opacity:' + opacity + ';stroke:var(--line)';
      return sb.key('0 0 22 14', mark('rect', {width: 20, height: 13, y: 0.5, style}), withUnit(value, this.quantity.unit));
    };
    const name = this.quantity.name + (this.quantity.good ? ', k/n: k of n trials' : '') + ':';
    this.legend.replaceChildren(
        el('span', {}, name), ...(range[0] === undefined ? [] : samples.map(swatch)),
        this.lineKey('frontier, 50 % held', 'frontier'),
        hasControl ? this.lineKey('frontier of the negative control', 'frontier.control') : '');
  }

  lineKey(words, kind, style) {
    return sb.key('0 0 22 14', mark('path.' + kind, {d: 'M1,7H21', style}), words);
  }

  // Axes of a map: cells of equal size, labelled with their values.
  mapFrame(title, note, columns, rows) {
    const box = {width: 400, left: 62, right: 6, top: 6, bottom: 40};
    box.height = box.top + box.bottom + Math.min(300, Math.max(180, 34 * rows.length));
    // Positions of levels along an axis; labels that would overlap are omitted.
    const axisOf = (axis, levels, range, needed) => {
      const scale = d3.scaleLinear([-0.5, levels.length - 0.5], range), pitch = Math.abs(scale(1) - scale(0));
      const tick = ({at, text: words}) =>
          isFinite(at) ? sb.significant(sb.rounded(at, axis.unit) * sb.factor(axis.unit), 3) : words;
      return {
        title: label(axis), pitch, scale, bare: true,
        ticks: d3.range(0, levels.length, Math.ceil(needed / pitch)), text: i => tick(levels[i])
      };
    };
    const x = axisOf(this.x, columns, [box.left, box.width - box.right], 34);
    const y = axisOf(this.y, rows, [box.height - box.bottom, box.top], 15);
    // A group, since its cells are buttons.
    const svg = sb.axes(box, x, y, {class: 'map', role: 'group', 'aria-label': title + ', ' + y.title + ' against ' + x.title});
    const panel = el('div', {}, el('h3', {}, title, note && el('span.note', {}, ' · ' + note)), svg);
    this.host.append(panel);
    return {svg, x, y, panel};
  }

  drawMap(map, control, columns, rows, range) {
    const {svg, x, y, panel} = this.mapFrame(map.series.name, map.series.control && 'negative control', columns, rows);
    const {quantity} = this, {name} = map.series, width = x.pitch, height = y.pitch;
    const texts = map.cells.map(row => row.map(trials => this.cellText(trials)));
    const widest = d3.max(texts.flat(), words => words.length);
    // At 11 px a digit is 6.2 px wide; a narrow cell has a smaller font, and below 8 px only the
    // tooltip shows the value.
    const size = Math.min(11, 11 * (width - 4) / (6.2 * widest), 0.75 * height);
    const cell = (trials, r, c) => {
      const [fill, opacity] = this.paint(valueIn(quantity, trials), range);
      const place = {x: x.scale(c) - width / 2, y: y.scale(r) - height / 2, width, height};
      const rect = mark('rect', {...place, style: 'fill:' + fill + ';fill-opacity:' + opacity});
      if (!trials.length) return mark('g.map-cell', {}, rect);
      const open = () => this.showCell(map.series, columns[c], rows[r], trials);
      const where = [name, sb.pathWord(this.x.path) + ': ' + columns[c].text, sb.pathWord(this.y.path) + ': ' + rows[r].text];
      return mark('g.map-cell', {
        tabindex: 0,
        role: 'button',
        'aria-label': [...where, heldText(trials)].join(', '),
        onclick: open,
        onkeydown: event => event.key === 'Enter' && open(),
        ...sb.tipped(() => [...where, ...this.said(trials)])
      }, rect);
    };
    const number = (words, r, c) => mark('text.map-number', {
      x: x.scale(c), y: y.scale(r) + 0.36 * size, 'text-anchor': 'middle', style: 'font-size:' + size + 'px'
    }, words);
    const each = (table, draw) => table.flatMap((row, r) => row.map((held, c) => draw(held, r, c)));
    // Numbers are above the frontiers, which may cross the middle of a cell.
    svg.append(...each(map.cells, cell), ...this.contour(x, y, map.frontier, 'frontier'),
               ...control && control !== map ? this.contour(x, y, control.frontier, 'frontier.control') : [],
               ...size >= 8 ? each(texts, number) : []);
    const figure = (axis, level) => level.low === level.high && isFinite(level.at) ? level.at * sb.factor(axis.unit) : level.text;
    const counts = trials => quantity.good ? countOf(quantity, trials) : [];
    sb.saveCorner(
        panel, name + ' ' + quantity.name, () => svg,
        () => [
            [
              label(this.x), label(this.y), ...quantity.good ? ['k', 'n'] : [],
              quantity.name + (quantity.unit ? ' [' + quantity.unit + ']' : '')
            ],
            ...each(
                map.cells,
                (trials, r,
                 c) => [figure(this.x, columns[c]), figure(this.y, rows[r]), ...counts(trials), valueIn(quantity, trials)])]);
  }

  contour(x, y, lines, kind, style) {
    const d = lines.map(d3.line(([c]) => x.scale(c), ([, r]) => y.scale(r))).join('');
    return lines.length ? [mark('path.halo', {d}), mark('path.' + kind, {d, style})] : [];
  }

  // The frontiers of maps with the same axes in one chart.
  drawFrontiers(group, columns, rows) {
    const {others} = group[0].series;
    const {svg, x, y, panel} = this.mapFrame('All frontiers' + (others ? ', ' + others : ''), '', columns, rows);
    sb.saveCorner(panel, 'Frontiers', () => svg, () => [
      ['series', label(this.x) + ', place', label(this.y) + ', place', 'to', 'to'],
      ...group.flatMap(map => map.frontier.map(([a, b]) => [map.series.name, ...a, ...b]))
    ]);
    const lines = group.filter(map => map.frontier.length).map(({series, frontier}, i) => {
      const kind = series.control ? 'frontier.control' : 'frontier', dash = dashes[i % dashes.length];
      const style = series.control ? null : 'stroke:' + sb.hue(i) + (dash ? ';stroke-dasharray:' + dash : '');
      svg.append(...this.contour(x, y, frontier, kind, style));
      return this.lineKey(series.name, kind, style);
    });
    panel.append(el('div.legend', {}, lines));
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

  // The trials of a cell, with the command to replay one.
  showCell(series, column, row, trials) {
    const where = [series.name, sb.pathWord(this.x.path) + ' ' + column.text, row && sb.pathWord(this.y.path) + ' ' + row.text];
    const example = trials.find(trial => sb.isEmbedded(trial.index)) || trials.find(({grasp}) => sb.graspEnd(grasp) !== 'held') || trials[0];
    const copy = trial => el(
        'button.link', {onclick: event => sb.copy(event.target, sb.replayCommand(trial))}, 'copy the command that repeats it');
    const columns = [
      {title: 'trial', cell: trial => String(trial.index)},
      {title: 'end', kind: 'text', cell: ({grasp}) => sb.graspEnd(grasp) + (grasp.dropped ? ' at ' + sb.seconds(grasp.drop_s) : '')},
      ...medians.map((quantity, i) => ({title: medianHeads[i], cell: trial => sb.significant(quantity.one(trial), 3)})),
      {title: 'here', kind: 'text', cell: trial => sb.opener(trial, this.open, 'copy the command of its report')},
      {title: 'replay', kind: 'text', cell: copy}
    ];
    this.detail.replaceChildren(
        el('h3', {}, where.filter(words => words).join(', ')),
        el('p.note', {}, heldText(trials) + '. Trial ' + example.index + ' again, with its recording:'),
        el('pre.mono', {}, sb.replayCommand(example)),
        el('div.scroll.tall', {}, sb.sortedTable(columns, trials.slice(0, 200)).node));
    this.detail.scrollIntoView({block: 'nearest', behavior: 'smooth'});
  }

  drawCurves() {
    const levels = this.swept.levels(this.x);
    const pointsOf = ({trials}) => {
      const at = trials.map(trial => levels[this.swept.levelOf(levels, this.x, trial)]);
      return levels.map(level => ({level, trials: trials.filter((_, i) => at[i] === level)}))
          .filter(point => point.trials.length);
    };
    const all = this.swept.series([this.x]).slice(0, mostMaps).map(series => ({series, points: pointsOf(series)}));
    this.note.textContent = 'Bars: the exact 95 % interval of a share, the quartiles around a median. ' +
        'Click a point for its trials and the command that repeats one.' +
        (isFinite(levels[levels.length - 1].at) ?
             '' :
             ' ' + sb.endless(this.x.unit) + ' cannot be drawn on the axis; see the table above.');
    this.legend.replaceChildren(
        ...all.map(({series}, i) => sb.dot(sb.hue(i), i, series.name + (series.control ? ' · negative control' : ''))));
    const chart = (quantity, more) => this.drawCurve(all, {
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

  // One chart of all series. `across`: the horizontal axis; null: the detector's balanced accuracy.
  drawCurve(all, {title, across, at, value, range, percent}) {
    const there = point => at(point) !== null && isFinite(at(point)) && value(point) !== null;
    const shown = all.map(({series, points}) => ({series, points: points.filter(there)}));
    const points = shown.flatMap(one => one.points);
    if (!points.length) return;
    const box = {width: 400, height: 270, left: 58, right: 14, top: 10, bottom: 40};
    const xs = d3.extent(points, at);
    const xLog = across !== null && sb.sweptValues.wide(xs, 8, across.unit);
    const room = 0.05 * (xs[1] - xs[0]) || 0.1 * Math.abs(xs[0]) || 1;
    const x = sb.axisOf(across ? label(across) : 'balanced accuracy of the detector, %', xLog,
                        xLog ? [xs[0] / 1.15, xs[1] * 1.15] : [xs[0] - room, xs[1] + room], [box.left, box.width - box.right]);
    const ends = points.flatMap(point => [value(point), ...(range(point) || [])]);
    const domain = percent ? [-2, 102] : [Math.min(0, d3.min(ends)), d3.max(ends) || 1];
    const y = sb.axisOf(title, false, domain, [box.height - box.bottom, box.top], percent ? 0 : 5);
    const svg = sb.axes(box, {...x, bare: true}, y, {role: 'img', 'aria-label': title + ' against ' + x.title});
    const panel = el('div', {}, svg);
    this.host.append(panel);
    sb.saveCorner(panel, title.split(',')[0], () => svg, () => [
      ['series', across ? label(across) : 'balanced accuracy [%]', title, 'from', 'to', 'trials'],
      ...shown.flatMap(one => one.points.map(
          point => [one.series.name, at(point), value(point), ...(range(point) || [null, null]), point.trials.length]))
    ]);
    svg.append(...shown.flatMap(({series, points: own}, i) => {
      const shift = (i - (all.length - 1) / 2) * 3;  // px, separates overlapping intervals
      const left = point => x.scale(at(point)) + shift;
      const line = 'fill:none;stroke:' + sb.hue(i);
      const lines = point =>
          [series.name, sb.pathWord(this.x.path) + ': ' + point.level.text, ...this.said(point.trials),
           ...this.saidOfDetector(point.trials)];
      const interval = (point, [low, high]) =>
          mark('path', {d: 'M' + left(point) + ',' + y.scale(low) + 'V' + y.scale(high), style: line});
      const spot = point => mark('path.point', {
        transform: 'translate(' + left(point) + ',' + y.scale(value(point)) + ')',
        d: sb.markPath(i, 4),
        style: 'fill:' + sb.hue(i),
        onclick: () => this.showCell(series, point.level, null, point.trials),
        ...sb.tipped(() => lines(point))
      });
      return [
        own.length > 0 && mark('path', {
          d: d3.line(left, point => y.scale(value(point)))(own),
          style: line + ';stroke-width:1.6' + (series.control ? ';stroke-dasharray:5 4' : '')
        }),
        ...own.flatMap(point => [range(point) && interval(point, range(point)), spot(point)])
      ].filter(node => node);
    }));
  }
}

// The section; `swept` is of the grasps and has at least one numeric axis.
sb.successMaps = (swept, open) => new Maps(swept, open).section;
