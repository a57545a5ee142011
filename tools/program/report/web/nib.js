// The nib pad's electrodes behind its nibs.
(function(sb) {
'use strict';

// Per taxel four triangles that meet in its middle, W, N, E and S, as dark as the electrode reads above its first image.
class NibElectrodes {
  // `pad`: sb.Pad; nib 6*row + column, taxel 3*row + column of 2x2 nibs, rows from the north, columns from the west. `pitch`: px.
  constructor(svg, pad, pitch) {
    this.channel = pad.recording.channel('si');
    this.largest = 1e-9;
    this.channel.columns.forEach(column => {
      for (const value of column) this.largest = Math.max(this.largest, Math.abs(value - column[0]));
    });
    const half = 0.94 * pitch;
    const corner = {nw: [-half, -half], ne: [half, -half], se: [half, half], sw: [-half, half]};
    const sides = [['sw', 'nw'], ['nw', 'ne'], ['ne', 'se'], ['se', 'sw']];  // of W, N, E, S
    this.sides = [];
    for (let taxel = 0; taxel < 9; ++taxel) {
      const first = 12 * Math.floor(taxel / 3) + 2 * (taxel % 3);
      const nibs = [0, 1, 6, 7].map(nib => pad.recording.positions[first + nib]);
      const place = axis => d3.mean(nibs, position => position[axis]);
      const group = svg.append('g').attr('transform', 'translate(' + pad.x([place(0), place(1)]) + ',' + pad.y([place(0), place(1)]) + ')');
      sides.forEach(([a, b], electrode) => {
        const side = group.append('path')
                         .attr('d', 'M0,0L' + corner[a] + 'L' + corner[b] + 'Z')
                         .style('stroke', 'var(--line)')
                         .attr('stroke-width', 0.8);
        this.sides.push({side, column: this.channel.columns[4 * taxel + electrode], name: this.channel.names[4 * taxel + electrode]});
        side.append('title');
      });
    }
  }

  update(time) {
    const row = sb.rowAt(this.channel.time, time);
    for (const {side, column, name} of this.sides) {
      const change = column[row] - column[0];
      side.style('fill', change < 0 ? 'var(--partial)' : 'var(--accent)').style('fill-opacity', 0.75 * Math.abs(change) / this.largest);
      side.select('title').text(name + ': ' + sb.fixed(column[row], 0) + ' counts, ' + sb.fixed(change, 0) + ' above the first image');
    }
  }
}

sb.NibElectrodes = NibElectrodes;
})(window.slipbench);
