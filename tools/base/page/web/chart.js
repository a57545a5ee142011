// What charts are made of: marks of series, scales with their ticks, axes, keys, tips.
const el = sb.element, mark = sb.mark;

// A shape for each colour, so that neither is needed to tell two series apart. Corners of polygons; the first is a circle.
const polygon = (corners, turn, inner) => d3.range(inner ? 2 * corners : corners).map(i => {
  const angle = turn + i * 2 * Math.PI / (inner ? 2 * corners : corners);
  const radius = inner && i % 2 ? inner : 1;
  return [radius * Math.sin(angle), -radius * Math.cos(angle)];
});
const shapes = [
  null, polygon(4, Math.PI / 4), polygon(3, 0), polygon(4, 0), polygon(5, 0, 0.45), polygon(3, Math.PI), polygon(6, 0),
  polygon(4, 0, 0.35)
];
const sizes = [1, 1.2, 1.3, 1.25, 1.45, 1.3, 1.1, 1.5];  // of equal weight to the eye
sb.markPath = (index, radius) => {
  const shape = shapes[index % shapes.length];
  const r = radius * sizes[index % shapes.length];
  if (!shape) return 'M' + r + ',0A' + [r, r, 0, 1, 1, -r, 0] + 'A' + [r, r, 0, 1, 1, r, 0] + 'Z';
  return 'M' + shape.map(([x, y]) => (r * x).toFixed(2) + ',' + (r * y).toFixed(2)).join('L') + 'Z';
};
sb.crossPath = radius => 'M' + [-radius, -radius] + 'L' + [radius, radius] + 'M' + [-radius, radius] + 'L' + [radius, -radius];
sb.hue = index => 'var(--s' + index % shapes.length + ')';

sb.text = (x, y, anchor, words, kind) => mark('text.' + (kind || ''), {x, y, 'text-anchor': anchor}, words);
// What a key says: marks in a frame of px, and their name.
sb.key = (viewBox, marks, words, kind) =>
    el('span', {}, mark('svg.' + (kind || ''), {viewBox, 'aria-hidden': 'true'}, marks), words);

sb.scale = (logarithmic, domain, range) => (logarithmic ? d3.scaleLog() : d3.scaleLinear()).domain(domain).range(range);
// Ticks of a logarithmic axis of `room` px, of which each needs some.
sb.logTicks = ([low, high], room, needed) => {
  const decade = room / Math.log10(high / low);
  const factors = decade > 4 * needed ? [1, 2, 5] : [1];
  const stride = Math.max(1, Math.ceil(needed / decade));
  return d3.range(Math.floor(Math.log10(low)), Math.ceil(Math.log10(high)) + 1)
      .filter(power => power % stride === 0)
      .flatMap(power => factors.map(factor => +(factor + 'e' + power)))
      .filter(tick => tick >= low && tick <= high);
};

// An SVG with axes. box: {width, height, left, right, top, bottom}: its size, and what is beside the plot [px]. x, y: {title,
// ticks, at(tick): where it stands [px], text(tick), bare: no lines}.
sb.axes = ({width, height, left, right, top, bottom}, x, y, attributes) => {
  const end = width - right, foot = height - bottom;
  return mark(
      'svg', {viewBox: [0, 0, width, height].join(' '), ...attributes},
      !x.bare && x.ticks.map(tick => mark('path.mesh', {d: 'M' + x.at(tick) + ',' + top + 'V' + foot})),
      !y.bare && y.ticks.map(tick => mark('path.mesh', {d: 'M' + left + ',' + y.at(tick) + 'H' + end})),
      x.ticks.map(tick => sb.text(x.at(tick), foot + 16, 'middle', x.text(tick))),
      y.ticks.map(tick => sb.text(left - 6, y.at(tick) + 4, 'end', y.text(tick))),
      mark('rect.map-edge', {x: left, y: top, width: end - left, height: foot - top}),
      sb.text((left + end) / 2, height - 5, 'middle', x.title, 'title'),
      mark('text.title', {transform: 'translate(11,' + (top + foot) / 2 + ')rotate(-90)', 'text-anchor': 'middle'}, y.title));
};

// Draws when a node has got a width, and again at each other one.
sb.onWidth = (node, draw) => {
  let drawn = 0;
  const look = () => {
    if (!node.clientWidth || node.clientWidth === drawn) return;
    drawn = node.clientWidth;
    draw();
  };
  new ResizeObserver(() => requestAnimationFrame(look)).observe(node);
};

// Lines at the pointer, of whatever is pointed at.
const tip = el('div.tip');
document.body.append(tip);
sb.showTip = (lines, x, y) => {
  tip.textContent = lines.join('\n');
  tip.style.display = 'block';
  tip.style.left = Math.max(4, Math.min(x + 14, window.innerWidth - tip.offsetWidth - 4)) + 'px';
  tip.style.top = Math.max(4, y + 16 + tip.offsetHeight > window.innerHeight ? y - tip.offsetHeight - 10 : y + 16) + 'px';
};
sb.hideTip = () => {
  tip.style.display = 'none';
};
// What a mark listens to that says lines() to the pointer.
sb.tipped = lines => ({onmousemove: event => sb.showTip(lines(), event.clientX, event.clientY), onmouseout: sb.hideTip});
