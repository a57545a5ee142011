// Charts as files: a picture (SVG, PNG) of each, and its figures (CSV).
(function(sb) {
'use strict';
const el = sb.element;

const font = 'system-ui, -apple-system, "Segoe UI", "Helvetica Neue", Arial, "DejaVu Sans", sans-serif';
const named = {'&': '&amp;', '<': '&lt;', '>': '&gt;', '\u0022': '&quot;'};
const escaped = text => String(text).replace(/[&<>\u0022]/g, c => named[c]);
// Places to 0.1 px.
const px = value => +value.toFixed(1);
// A mark as text; `content`: text, made safe. What has no value is left out.
const mark = (name, attributes, content) => {
  const known = Object.entries(attributes).filter(([, value]) => value !== null && value !== undefined);
  const head = '<' + name + known.map(([key, value]) => ' ' + key + '="' + escaped(value) + '"').join('');
  return content === undefined ? head + '/>' : head + '>' + escaped(content) + '</' + name + '>';
};

// An SVG made mark by mark, for what the page draws on a canvas.
class Drawing {
  constructor(width, height) {
    Object.assign(this, {width, height, marks: []});
    this.rect(0, 0, width, height, sb.colour('ground'));
  }
  rect(x, y, width, height, fill) {
    this.marks.push(mark('rect', {x: px(x), y: px(y), width: px(width), height: px(height), fill}));
  }
  line(x1, y1, x2, y2, stroke, dash) {
    this.marks.push(mark('path', {d: 'M' + [x1, y1].map(px) + 'L' + [x2, y2].map(px), stroke, 'stroke-dasharray': dash}));
  }
  // Points [x, y]; null: a gap. `steps`: a value stays until the next.
  curve(points, stroke, dash, steps) {
    let d = '', last = null;
    for (const point of points) {
      const [x, y] = (point || []).map(px);
      if (point) d += !last ? 'M' + x + ',' + y : steps ? 'H' + x + 'V' + y : 'L' + x + ',' + y;
      last = point;
    }
    this.marks.push(mark('path', {d, fill: 'none', stroke, 'stroke-width': 1.5, 'stroke-dasharray': dash}));
  }
  text(x, y, text, anchor, fill, size) {
    this.marks.push(
        mark('text', {x: px(x), y: px(y), 'text-anchor': anchor, fill: fill || sb.colour('soft'), 'font-size': size || 11}, text));
  }
  picture(x, y, width, height, canvas) {
    this.marks.push(mark(
        'image', {x: px(x), y: px(y), width: px(width), height: px(height), preserveAspectRatio: 'none', href: canvas.toDataURL()}));
  }
  file(title) {
    const {width, height} = this;
    const head = mark(
        'svg', {xmlns: 'http://www.w3.org/2000/svg', width, height, viewBox: [0, 0, width, height].join(' '), 'font-family': font});
    return head.replace('/>', '>') + [mark('title', {}, title), ...this.marks].join('\n') + '</svg>\n';
  }
}

// What a style sheet says of a mark, and its file has to say itself.
const styles = ['fill', 'fill-opacity', 'stroke', 'stroke-opacity', 'stroke-width', 'stroke-dasharray', 'stroke-linecap', 'opacity', 'display',
                'font-size', 'font-weight', 'text-anchor', 'paint-order'];
function withStyles(node) {
  const copy = node.cloneNode(true);
  const copies = [copy, ...copy.querySelectorAll('*')];
  [node, ...node.querySelectorAll('*')].forEach((original, i) => {
    const found = getComputedStyle(original);
    for (const name of styles) copies[i].style[name] = found.getPropertyValue(name);
    for (const name of ['class', 'tabindex', 'role']) copies[i].removeAttribute(name);
  });
  return copy;
}

// An SVG of the page as a file of its own, on the page's ground.
function fileOf(svg, title) {
  const copy = withStyles(svg);
  const {x, y, width, height} = svg.viewBox.baseVal;
  const set = (node, values) => {
    for (const [name, value] of Object.entries(values)) node.setAttribute(name, value);
    return node;
  };
  const make = name => document.createElementNS('http://www.w3.org/2000/svg', name);
  set(copy, {xmlns: 'http://www.w3.org/2000/svg', width, height, 'font-family': font});
  copy.removeAttribute('aria-label');
  const heading = make('title');
  heading.textContent = title;
  copy.prepend(
      heading, withStyles(document.getElementById('hatch').parentNode), set(make('rect'), {x, y, width, height, fill: sb.colour('ground')}));
  return new XMLSerializer().serializeToString(copy);
}

// A picture of an SVG file, twice as fine.
async function pngOf(file) {
  const image = new Image();
  image.src = 'data:image/svg+xml;charset=utf-8,' + encodeURIComponent(file);
  await image.decode();
  const canvas = el('canvas', {width: 2 * image.naturalWidth, height: 2 * image.naturalHeight});
  canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise(done => canvas.toBlob(done));
}

// Six digits, as many as the page's curves have; what is no number is empty.
const cell = value => typeof value === 'string' ? (/[\u0022,\n]/.test(value) ? '"' + value.replace(/\u0022/g, '""') + '"' : value) :
    typeof value === 'number' && isFinite(value) ? String(+value.toPrecision(6)) : '';
const csvOf = rows => rows.map(row => row.map(cell).join(',')).join('\n') + '\n';

// "hexapod-trial-3-slip-speed": the page, the trial, the chart.
function fileName(title) {
  const page = decodeURIComponent(location.pathname.split('/').pop()).replace(/\.html$/, '');
  const trial = location.hash.startsWith('#trial-') ? location.hash.slice(1) : '';
  return [page, trial, title].filter(part => part).join('-').toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '');
}

function download(blob, name) {
  const link = el('a', {href: URL.createObjectURL(blob), download: name});
  document.body.append(link);  // Firefox follows no other
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

// Buttons that save a chart. title(): its name; drawing(): an SVG of the page or a Drawing, absent where there is only figures; rows(): arrays, the
// head first.
sb.saveButtons = ({title, drawing, rows}) => {
  const file = () => {
    const drawn = drawing();
    return drawn instanceof Drawing ? drawn.file(title()) : fileOf(drawn, title());
  };
  const kinds = {
    PNG: drawing && (async () => pngOf(file())),
    SVG: drawing && (() => new Blob([file()], {type: 'image/svg+xml'})),
    CSV: () => new Blob([csvOf(rows())], {type: 'text/csv'})
  };
  return el(
      'span.save', {role: 'group', 'aria-label': 'Save ' + title()},
      Object.entries(kinds).filter(([, make]) => make).map(
          ([kind, make]) => el('button.link', {
            'aria-label': 'Save ' + title() + ' as ' + kind,
            onclick: async () => download(await make(), fileName(title()) + '.' + kind.toLowerCase())
          },
                               kind)));
};
// Those of an SVG, in the corner of the node that it fills.
sb.saveCorner = (host, svg, title, rows) => {
  host.classList.add('saved');
  host.append(sb.saveButtons({title: () => title, drawing: () => svg, rows}));
};

sb.Drawing = Drawing;
})(window.slipbench);
