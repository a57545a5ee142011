// What all pages of the program share: numbers as text, nodes, copying, light and dark.
(function(sb) {
'use strict';

sb.missing = '–';
// A number with `digits` significant digits, plain notation where that is readable.
sb.significant = (value, digits) => {
  if (value === null || value === undefined || !isFinite(value)) return sb.missing;
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-4) return value.toExponential(digits - 1);
  return String(+value.toPrecision(digits)).replace('-', '−');
};
sb.fixed = (value, decimals) => {
  if (value === null || value === undefined || !isFinite(value)) return sb.missing;
  const text = value.toFixed(decimals);
  return (Number(text) === 0 ? text.replace('-', '') : text).replace('-', '−');
};
// DOM in one expression: element('p.note', {title: 'x'}, 'text', child). Text is never parsed as HTML.
sb.element = (selector, attributes, ...children) => {
  const [tag, ...classes] = selector.split('.');
  const node = document.createElement(tag || 'div');
  if (classes.length) node.className = classes.join(' ');
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name.startsWith('on'))
      node.addEventListener(name.slice(2), value);
    else if (value !== undefined && value !== null)
      node.setAttribute(name, value);
  }
  for (const child of children.flat(Infinity)) {
    if (child !== null && child !== undefined) node.append(child);
  }
  return node;
};
sb.colour = name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();

// After the next frame has been shown; where none is, as in a tab behind others, soon.
sb.painted = () => new Promise(done => {
  requestAnimationFrame(() => setTimeout(done));
  setTimeout(done, 200);
});

// Puts a text on the clipboard and says so on the button.
sb.copy = async (button, text) => {
  const before = button.textContent;
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = 'copied';
  } catch (error) {
    button.textContent = text;  // a page opened from a file may not write to the clipboard
    return;
  }
  setTimeout(() => {
    button.textContent = before;
  }, 1500);
};

// Follows the reader's light or dark setting; printing is light. `changed`, if there, is told after each change.
sb.followTheme = changed => {
  const dark = window.matchMedia('(prefers-color-scheme: dark)');
  const set = name => {
    document.documentElement.dataset.theme = name;
    if (changed) changed();
  };
  const follow = () => set(dark.matches ? 'dark' : 'light');
  follow();
  dark.addEventListener('change', follow);
  window.addEventListener('beforeprint', () => set('light'));
  window.addEventListener('afterprint', follow);
};
})(window.slipbench = window.slipbench || {});
