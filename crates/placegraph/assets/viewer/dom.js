// Small helpers that every part of a page uses. Text enters a page as text nodes only.

export const $ = (id) => document.getElementById(id);

/** Appends an element to `parent`; children are nodes or text. */
export function element(parent, name, attributes = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (key === "style") node.style.cssText = value;
    else node.setAttribute(key, value === true ? "" : value);
  }
  node.append(...children.filter((child) => child !== undefined && child !== null));
  parent?.append(node);
  return node;
}

/** A number with `digits` after the point; nothing where there is none. */
export const number = (value, digits) => (value === null || value === undefined ? "" : value.toFixed(digits));

/** "1 place", "2 places". */
export const count = (n, one, many = `${one}s`) => `${n} ${n === 1 ? one : many}`;
