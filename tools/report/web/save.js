// Saves charts as files: picture (SVG, PNG) and figures (CSV).
const el = sb.element;

const font = 'system-ui, -apple-system, "Segoe UI", "Helvetica Neue", Arial, "DejaVu Sans", sans-serif';

// Styles from style sheets that a file must contain itself.
const styles = ['fill', 'fill-opacity', 'stroke', 'stroke-opacity', 'stroke-width', 'stroke-dasharray', 'stroke-linecap', 'opacity', 'display',
                'font-size', 'font-weight', 'text-anchor', 'paint-order', 'image-rendering'];
function withStyles(node) {
  const copy = node.cloneNode(true);
  const copies = [copy, ...copy.querySelectorAll('*')];
  [node, ...node.querySelectorAll('*')].forEach((original, i) => {
    const found = getComputedStyle(original);
    for (const name of styles) copies[i].style[name] = found.getPropertyValue(name);
    for (const name of [...styles, 'class', 'tabindex', 'role']) copies[i].removeAttribute(name);
  });
  return copy;
}

// An SVG as a separate file, with the page's background. A detached SVG is added to the page
// temporarily for its styles.
function fileOf(svg, title) {
  const loose = !svg.isConnected;
  if (loose) document.body.append(svg);
  const copy = withStyles(svg);
  if (loose) svg.remove();
  const {x, y, width, height} = svg.viewBox.baseVal;
  for (const [name, value] of Object.entries({xmlns: 'http://www.w3.org/2000/svg', width, height, 'font-family': font}))
    copy.setAttribute(name, value);
  copy.removeAttribute('aria-label');
  copy.prepend(sb.mark('title', {}, title), withStyles(document.getElementById('hatch').parentNode),
               sb.mark('rect', {x, y, width, height, fill: sb.colour('ground')}));
  return new XMLSerializer().serializeToString(copy);
}

// PNG of an SVG file at twice the resolution.
async function pngOf(file) {
  const image = new Image();
  image.src = 'data:image/svg+xml;charset=utf-8,' + encodeURIComponent(file);
  await image.decode();
  const canvas = el('canvas', {width: 2 * image.naturalWidth, height: 2 * image.naturalHeight});
  canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise(done => canvas.toBlob(done));
}

// Six digits, the precision of the page's curves; NaN becomes empty.
const cell = value => typeof value !== 'number' ? value : isFinite(value) ? +value.toPrecision(6) : null;
const csvOf = rows => d3.csvFormatRows(rows.map(row => row.map(cell))) + '\n';

// "hexapod-trial-3-slip-speed": page, trial, chart.
function fileName(title) {
  const page = decodeURIComponent(location.pathname.split('/').pop()).replace(/\.html$/, '');
  const trial = location.hash.startsWith('#trial-') ? location.hash.slice(1) : '';
  return [page, trial, title].filter(part => part).join('-').toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '');
}

function download(blob, name) {
  const link = el('a', {href: URL.createObjectURL(blob), download: name});
  document.body.append(link);  // Firefox follows only links in the page
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

// Buttons that save a chart. drawing(): an SVG, null if there are only figures; rows(): arrays, the
// head first.
sb.saveButtons = (title, drawing, rows) => {
  const kinds = {
    PNG: () => pngOf(fileOf(drawing(), title)),
    SVG: () => new Blob([fileOf(drawing(), title)], {type: 'image/svg+xml'}),
    CSV: () => new Blob([csvOf(rows())], {type: 'text/csv'})
  };
  const save = async kind => download(await kinds[kind](), fileName(title) + '.' + kind.toLowerCase());
  return el(
      'span.save', {role: 'group', 'aria-label': 'Save ' + title},
      Object.keys(kinds).filter(kind => drawing || kind === 'CSV').map(
          kind => el('button.link', {'aria-label': 'Save ' + title + ' as ' + kind, onclick: () => save(kind)}, kind)));
};
// Save buttons in the corner of a chart's node.
sb.saveCorner = (host, ...chart) => {
  host.classList.add('saved');
  host.append(sb.saveButtons(...chart));
};
