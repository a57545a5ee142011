// The pad: units coloured by state, force and slip arrows, the slip centre.
(function(sb) {
'use strict';

function spacingOf(positions) {
  let nearest = Infinity;
  for (let i = 0; i < positions.length; ++i) {
    for (let k = 0; k < i; ++k) {
      const distance = Math.hypot(positions[i][0] - positions[k][0], positions[i][1] - positions[k][1]);
      if (distance > 0 && distance < nearest) nearest = distance;
    }
  }
  return isFinite(nearest) ? nearest : 5e-3;
}

// A number of the form 1, 2 or 5 times a power of ten, at most `value`.
function roundDown(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  for (const factor of [5, 2])
    if (factor * power <= value) return factor * power;
  return power;
}

class Pad {
  // onPick(unit): a unit was clicked.
  constructor(parent, recording, onPick) {
    this.recording = recording;
    const positions = recording.positions;
    const spacing = spacingOf(positions);
    const extent = axis => {
      const [low, high] = d3.extent(positions, p => p[axis]);
      return high - low;
    };
    const pitch = Math.min(92, 250 / Math.max(1, Math.max(extent(0), extent(1)) / spacing));  // px between neighbours
    this.scale = pitch / spacing;                                                             // px a metre
    this.view = sb.padView(recording.type);
    this.x = p => p[this.view.right] * this.scale;
    this.y = p => -p[this.view.up] * this.scale;
    const xs = positions.map(this.x), ys = positions.map(this.y);
    // The picture is stretched to its card: a pad of one unit gets a wide frame, so that its text is no larger than others'.
    const margin = (places, least) => Math.max(30, 0.67 * pitch, 0.5 * (least - (Math.max(...places) - Math.min(...places))));
    const picture = sb.padPicture(recording);
    const beside = picture ? 18 : 0;  // px, so that the picture leaves the axes their corner
    const left = Math.min(...xs) - margin(xs, 300) - beside, right = Math.max(...xs) + margin(xs, 300);
    const top = Math.min(...ys) - margin(ys, 160), bottom = Math.max(...ys) + margin(ys, 160) + beside;
    this.box = {left, right, top, bottom};
    this.labels = recording.units <= 25;
    this.roomy = pitch >= 55;  // px, for the name and the force of a unit side by side
    this.radius = (this.labels || (picture && picture.cells.length === recording.units) ? 0.27 : 0.4) * pitch;  // no unit hides its cell

    const svg = d3.select(parent)
                    .append('svg')
                    .attr('viewBox', [left, top, right - left, bottom - top + 30].join(' '))
                    .attr('role', 'img')
                    .attr('aria-label', 'The pad at the cursor, ' + this.view.note);
    this.arrowHeads(svg.append('defs'), Math.min(8, 0.4 * pitch));
    this.drawFrame(svg);
    this.picture = picture && new sb.PadPicture(svg, this, pitch);
    const unit = svg.selectAll('g.unit')
                     .data(d3.range(recording.units))
                     .enter()
                     .append('g')
                     .attr('class', 'unit')
                     .attr('transform', i => 'translate(' + xs[i] + ',' + ys[i] + ')')
                     .style('cursor', 'pointer')
                     .on('click', onPick);
    unit.append('title');
    this.discs = unit.append('circle').attr('r', this.radius);
    this.rings = unit.append('circle')
                     .attr('r', 0.84 * this.radius)
                     .attr('fill', 'none')
                     .style('stroke', 'var(--ground)')
                     .attr('stroke-width', 1.5);
    this.unitNodes = unit;
    this.slips = svg.append('g')
                     .selectAll('line')
                     .data(d3.range(recording.units))
                     .enter()
                     .append('line')
                     .style('stroke', 'var(--slip)')
                     .attr('stroke-width', Math.min(2, 0.06 * pitch))
                     .attr('stroke-dasharray', '4 2.5')
                     .attr('marker-end', 'url(#head-slip)');
    this.forces = svg.append('g')
                      .selectAll('line')
                      .data(d3.range(recording.units))
                      .enter()
                      .append('line')
                      .style('stroke', 'var(--ink)')
                      .attr('stroke-width', Math.min(2.4, 0.07 * pitch))
                      .attr('marker-end', 'url(#head-force)');
    this.centre = svg.append('g');
    this.centre.append('circle').attr('r', 6).attr('fill', 'none').style('stroke', 'var(--ink)').attr('stroke-width', 1.6);
    this.centre.append('path').attr('d', 'M-10,0H10M0,-10V10').style('stroke', 'var(--ink)').attr('stroke-width', 1.6);

    if (this.labels) {
      const label = svg.append('g')
                        .selectAll('text')
                        .data(d3.range(recording.units))
                        .enter()
                        .append('text')
                        .attr('class', 'unit-label')
                        .attr('y', i => ys[i] - this.radius - 6);
      this.unitLabels = label;
      label.append('tspan').style('font-weight', 600).text(i => sb.unitName(recording.type, i));
      this.loads = label.append('tspan').attr('class', 'dim').attr('dx', 5);
    }
    this.forceLength = 0.5 * pitch / Math.max(1e-12, recording.largest('labels/force', 0, 2));
    const speed = recording.largest('labels/slip_velocity', 0, 2);
    this.slipLength = speed > 0 ? 0.4 * pitch / speed : 0;
    this.drawKey(svg, speed);
    sb.saveCorner(parent, svg.node(), 'Pad', () => this.savedRows());
  }

  arrowHeads(defs, size) {
    for (const [name, colour] of [['force', 'var(--ink)'], ['slip', 'var(--slip)']]) {
      defs.append('marker')
          .attr('id', 'head-' + name)
          .attr('viewBox', '0 0 10 10')
          .attr('refX', 7)
          .attr('refY', 5)
          .attr('markerWidth', size)
          .attr('markerHeight', size)
          .attr('markerUnits', 'userSpaceOnUse')
          .attr('orient', 'auto')
          .append('path')
          .attr('d', 'M0,0.8L10,5L0,9.2z')
          .style('fill', colour);
    }
  }

  drawFrame(svg) {
    const {left, right, top, bottom} = this.box;
    svg.append('rect')
        .attr('x', left + 1)
        .attr('y', top + 1)
        .attr('width', right - left - 2)
        .attr('height', bottom - top - 2)
        .attr('rx', 10)
        .style('fill', 'var(--ground)')
        .style('stroke', 'var(--line)');
    const axes = svg.append('g').attr('transform', 'translate(' + (left + 12) + ',' + (bottom - 12) + ')');
    axes.append('path').attr('d', 'M0,-18V0H18').attr('fill', 'none').style('stroke', 'var(--faint)');
    axes.append('text').attr('class', 'dim').attr('x', -3).attr('y', -22).text('XY'[this.view.up]);
    axes.append('text').attr('class', 'dim').attr('x', 22).attr('y', 4).text('XY'[this.view.right]);
  }

  // What the arrows' lengths mean.
  drawKey(svg, speed) {
    const {left, bottom} = this.box;
    const force = roundDown(32 / this.forceLength);
    const key = svg.append('g').attr('transform', 'translate(' + (left + 8) + ',' + (bottom + 18) + ')');
    const entry = (x, length, colour, dash, marker, text) => {
      key.append('line')
          .attr('x1', x)
          .attr('x2', x + length)
          .style('stroke', colour)
          .attr('stroke-width', 2.2)
          .attr('stroke-dasharray', dash)
          .attr('marker-end', 'url(#head-' + marker + ')');
      key.append('text').attr('class', 'dim').attr('x', x + length + 6).attr('y', 4).text(text);
    };
    entry(0, force * this.forceLength, 'var(--ink)', null, 'force', 'force ' + sb.quantity(force, 'N'));
    if (speed > 0) {
      const slip = roundDown(26 / this.slipLength);
      entry(118, slip * this.slipLength, 'var(--slip)', '4 2.5', 'slip', 'slip ' + sb.quantity(slip, 'm/s'));
    }
  }

  // The units at the cursor.
  savedRows() {
    const {recording, sample} = this;
    const vector = (key, count, unit) => d3.range(count).map(c => recording.at(key, unit, c, sample));
    return [
      ['t [s]', sb.unitWord(recording.type), 'x [m]', 'y [m]', 'state', 'fx [N]', 'fy [N]', 'fz [N]', 'slip vx [m/s]', 'slip vy [m/s]'],
      ...d3.range(recording.units).map(unit => [
        recording.time[sample], sb.unitName(recording.type, unit), ...recording.positions[unit],
        sb.states.unit[recording.unitStates[unit][sample]].name, ...vector('labels/force', 3, unit), ...vector('labels/slip_velocity', 2, unit)
      ])
    ];
  }

  update(sample) {
    this.sample = sample;
    const recording = this.recording;
    const key = i => sb.states.unit[recording.unitStates[i][sample]].key;
    this.discs.style(
                  'fill',
                  i => key(i) === 'detached' ? 'none' :
                      key(i) === 'partial'   ? 'url(#hatch)' :
                                               'var(--' + key(i) + ')')
        .style(
            'fill-opacity',
            i => key(i) === 'stick' ? 0.45 :
                key(i) === 'slip'   ? 0.85 :
                                      1)
        .style('stroke', i => 'var(--' + key(i) + ')')
        .attr('stroke-width', i => Math.min(0.08 * this.radius, key(i) === 'detached' ? 1.2 : 2))
        .attr(
            'stroke-dasharray',
            i => key(i) === 'detached' ? '2 3' :
                key(i) === 'partial'   ? '7 3' :
                                         null);
    this.rings.style('display', i => key(i) === 'slip' && this.labels ? null : 'none');
    const load = i => key(i) === 'detached' ? '' : ', ' + sb.quantity(recording.at('labels/force', i, 2, sample), 'N');
    this.unitNodes.select('title').text(i => sb.unitName(recording.type, i) + ': ' + key(i) + load(i));
    if (this.labels) {
      this.loads.text(i => key(i) === 'detached' || !this.roomy ? '' : sb.fixed(recording.at('labels/force', i, 2, sample), 2) + ' N');
    }
    if (this.picture) this.picture.update(recording.time[sample]);
    this.placeArrows(this.forces, 'labels/force', this.forceLength, sample);
    this.placeArrows(this.slips, 'labels/slip_velocity', this.slipLength, sample);
    this.placeLabels(sample);
    const centre = [0, 1].map(c => recording.at('labels/slip_centre', 0, c, sample));
    const [x, y] = [this.x(centre), this.y(centre)];
    const inside = x > this.box.left && x < this.box.right && y > this.box.top && y < this.box.bottom;
    this.centre.style('display', inside ? null : 'none').attr('transform', inside ? 'translate(' + x + ',' + y + ')' : null);
  }

  // A vector of a unit in px, upwards and to the right.
  vector(curve, length, i, sample) {
    return [this.view.up, this.view.right].map(c => (this.recording.at(curve, i, c, sample) || 0) * length);
  }

  // Each label stands above its unit, beside the arrow that points up there. Arrows are too short to reach a neighbour's.
  placeLabels(sample) {
    if (!this.labels) return;
    const side = i => {
      const arrows = [['labels/force', this.forceLength], ['labels/slip_velocity', this.slipLength]].map(
          ([curve, length]) => this.vector(curve, length, i, sample));
      const upward = arrows.find(([up]) => up > 0.5 * this.radius);
      return upward ? (upward[1] >= 0 ? -1 : 1) : 0;
    };
    const sides = d3.range(this.recording.units).map(side);
    this.unitLabels.attr('x', i => this.x(this.recording.positions[i]) + 4 * sides[i])
        .attr('text-anchor', i => ['end', 'middle', 'start'][sides[i] + 1]);
  }

  placeArrows(arrows, curve, length, sample) {
    const recording = this.recording;
    const vector = i => this.vector(curve, length, i, sample);
    arrows.attr('x1', i => this.x(recording.positions[i]))
        .attr('y1', i => this.y(recording.positions[i]))
        .attr('x2', i => this.x(recording.positions[i]) + vector(i)[1])
        .attr('y2', i => this.y(recording.positions[i]) - vector(i)[0])
        .style('display', i => Math.hypot(...vector(i)) > 1.5 ? null : 'none');
  }
}

// The hatching of partial slip, once a page.
sb.drawHatch = () => {
  const pattern = d3.select(document.body)
                      .append('svg')
                      .attr('aria-hidden', 'true')
                      .attr('width', 0)
                      .attr('height', 0)
                      .style('position', 'absolute')
                      .append('defs')
                      .append('pattern')
                      .attr('id', 'hatch')
                      .attr('width', 6)
                      .attr('height', 6)
                      .attr('patternUnits', 'userSpaceOnUse')
                      .attr('patternTransform', 'rotate(45)');
  pattern.append('rect').attr('width', 6).attr('height', 6).style('fill', 'var(--partial)').style('fill-opacity', 0.5);
  pattern.append('rect').attr('width', 2.6).attr('height', 6).style('fill', 'var(--partial)');
};

sb.Pad = Pad;
})(window.slipbench);
