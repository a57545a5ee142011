// The image of a Myrmex array behind its taxels.
(function(sb) {
'use strict';

const rest = 4095;  // counts

// A square a taxel, as dark as counts are missing: fully where most are missing in the trial.
class TaxelImage {
  // `pad`: sb.Pad; the channel's values in the order of the units. `pitch`: px.
  constructor(svg, pad, pitch) {
    this.channel = pad.recording.channel('taxels');
    this.most = 1;
    this.channel.columns.forEach(column => {
      for (const value of column) this.most = Math.max(this.most, rest - value);
    });
    const side = 0.98 * pitch;
    this.squares = svg.append('g')
                       .selectAll('rect')
                       .data(pad.recording.positions)
                       .enter()
                       .append('rect')
                       .attr('x', p => pad.x(p) - 0.5 * side)
                       .attr('y', p => pad.y(p) - 0.5 * side)
                       .attr('width', side)
                       .attr('height', side)
                       .style('stroke', 'var(--line)')
                       .attr('stroke-width', 0.4)
                       .style('fill', 'var(--accent)');
    this.titles = this.squares.append('title');
  }

  update(time) {
    const row = sb.rowAt(this.channel.time, time);
    const missing = unit => rest - this.channel.columns[unit][row];
    this.squares.style('fill-opacity', (p, unit) => 0.85 * Math.max(0, missing(unit)) / this.most);
    this.titles.text((p, unit) => this.channel.names[unit] + ': ' + sb.fixed(rest - missing(unit), 0) + ' counts');
  }
}

sb.TaxelImage = TaxelImage;
})(window.slipbench);
