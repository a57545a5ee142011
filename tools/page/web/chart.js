// Parts of charts: marks of series, axes, keys, tips.
const el = sb.element, mark = sb.mark;

// d3's triangle, pointing down.
const triangleDown = {
  draw(path, size) {
    const mirrored = {
      moveTo: (x, y) => path.moveTo(x, -y), lineTo: (x, y) => path.lineTo(x, -y), closePath: () => path.closePath()
    };
    d3.symbolTriangle.draw(mirrored, size);
  }
};
// Each colour has its own shape, so that either one identifies the series.
const shapes = [
  d3.symbolCircle, d3.symbolSquare, d3.symbolTriangle, d3.symbolDiamond2, d3.symbolStar, triangleDown, d3.symbolCross, d3.symbolWye
];
// Mark of a series; all have the area of a circle of that radius [px].
sb.markPath = (index, radius) => d3.symbol(shapes[index % shapes.length], Math.PI * radius ** 2)();
sb.hue = index => 'var(--s' + index % shapes.length + ')';

sb.text = (x, y, anchor, words, kind) => mark('text.' + (kind || ''), {x, y, 'text-anchor': anchor}, words);
// An entry of a key: marks in a frame [px], and their name.
sb.key = (viewBox, marks, words, kind) =>
    el('span', {}, mark('svg.' + (kind || ''), {viewBox, 'aria-hidden': 'true'}, marks), words);

sb.scale = (logarithmic, domain, range) => (logarithmic ? d3.scaleLog : d3.scaleLinear)(domain, range);

// Ticks of a scale, about one per `needed` px. A logarithmic scale has the powers of ten, and 2 and
// 5 times them if they fit.
sb.ticks = (scale, needed) => {
  const [begin, end] = scale.range(), room = Math.abs(end - begin);
  if (!scale.base) return scale.ticks(Math.max(1, room / needed));
  const decades = Math.abs(Math.log10(scale.domain()[1] / scale.domain()[0]));
  const beginning = digits => scale.ticks(decades + 2).filter(tick => digits.test(tick.toExponential()));
  if (decades * 4 * needed <= room) return beginning(/^[125]/);
  const powers = beginning(/^1/), every = Math.ceil(powers.length * needed / room);
  return powers.filter((tick, i) => i % every === 0);
};

// A d3 axis at `transform`, in the page's font and without its line. Grid lines of `across` px
// start at its ticks.
sb.axis = (kind, {scale, ticks, text}, transform, across = 0) => {
  const axis = kind(scale).tickValues(ticks).tickFormat(text).tickSize(-across).offset(0).tickPadding(kind === d3.axisBottom ? 8 : 5);
  const group = d3.create('svg:g').attr('class', 'axis').attr('transform', transform).call(axis);
  group.select('.domain').remove();
  return group.attr('font-family', null).attr('font-size', null).node();
};

// An SVG with axes. box: {width, height, left, right, top, bottom}: its size and the margins of the
// plot [px]. x, y: {title, scale, ticks, text, bare: no grid lines}.
sb.axes = ({width, height, left, right, top, bottom}, x, y, attributes) => {
  const end = width - right, foot = height - bottom;
  return mark(
      'svg', {viewBox: [0, 0, width, height].join(' '), ...attributes},
      sb.axis(d3.axisBottom, x, 'translate(0,' + foot + ')', x.bare ? 0 : foot - top),
      sb.axis(d3.axisLeft, y, 'translate(' + left + ',0)', y.bare ? 0 : end - left),
      mark('rect.map-edge', {x: left, y: top, width: end - left, height: foot - top}),
      sb.text((left + end) / 2, height - 5, 'middle', x.title, 'title'),
      mark('text.title', {transform: 'translate(11,' + (top + foot) / 2 + ')rotate(-90)', 'text-anchor': 'middle'}, y.title));
};

// Draws once a node has a width, and again at each change of it.
sb.onWidth = (node, draw) => {
  let drawn = 0;
  const look = () => {
    if (!node.clientWidth || node.clientWidth === drawn) return;
    drawn = node.clientWidth;
    draw();
  };
  new ResizeObserver(() => requestAnimationFrame(look)).observe(node);
};

// Tooltip with the lines of the mark at the pointer.
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
// Event handlers of a mark whose tooltip shows lines().
sb.tipped = lines => ({onmousemove: event => sb.showTip(lines(), event.clientX, event.clientY), onmouseout: sb.hideTip});
