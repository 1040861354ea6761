/** DOM helpers. They insert text only as text. */

/**
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {{[name: string]: string}} [attributes]
 * @param {...(Node | string)} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

/** A copy of the icon of another button. @param {string} selector */
export function iconOf(selector) {
  return /** @type {Node} */ (document.querySelector(`${selector} > .icon`)).cloneNode(true);
}

/** @param {Node | string} text @param {string} label @param {() => void} onClick @param {boolean} [disabled] */
export function button(text, label, onClick, disabled = false) {
  const node = element("button", { type: "button", "aria-label": label, title: label }, text);
  node.disabled = disabled;
  node.addEventListener("click", onClick);
  return node;
}

/** Replaces the children of an element. @param {Element} parent @param {...(Node | string)} children */
export function fill(parent, ...children) {
  parent.replaceChildren(...children);
}

/**
 * The element with an id; throws if it is missing.
 * @template {HTMLElement} [T=HTMLElement]
 * @param {string} id
 * @returns {T}
 */
export function byId(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return /** @type {T} */ (found);
}

/** Sets a text if it differs, so that screen readers announce it only once. @param {Element} node @param {string} text */
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** Draws a node unless that changes the height of what contains it. @param {HTMLElement} frame @param {Element} node @param {() => void} draw */
export function drawInPlace(frame, node, draw) {
  const { offsetHeight } = frame;
  const before = [...node.childNodes];
  draw();
  if (frame.offsetHeight !== offsetHeight) fill(node, ...before);
}

/** Flashing elements and their timers. @type {WeakMap<Element, ReturnType<typeof setTimeout>>} */
const flashes = new WeakMap();

/** Highlights a change for a moment. @param {HTMLElement} node */
export function flash(node) {
  node.classList.add("changed");
  clearTimeout(flashes.get(node));
  flashes.set(
    node,
    setTimeout(() => node.classList.remove("changed"), 900),
  );
}

/** Fills a select. @param {HTMLSelectElement} select @param {[string, string][]} options @param {string} value */
export function setOptions(select, options, value) {
  const key = JSON.stringify(options);
  if (select.dataset.options !== key) {
    select.dataset.options = key;
    fill(select, ...options.map(([name, text]) => element("option", { value: name }, text)));
  }
  if (select.value !== value) select.value = value;
}

/** Loads the style sheet of a part of the page. Without network the part has no style. @param {"study" | "panel" | "live"} part @returns {Promise<void>} */
export function loadStyle(part) {
  const href = byId("main").dataset[`${part}Style`];
  if (!href) throw new Error(`the page has no style sheet of the part ${part}`);
  const link = element("link", { rel: "stylesheet", href });
  return new Promise((resolve) => {
    for (const end of ["load", "error"]) link.addEventListener(end, () => resolve());
    document.head.append(link);
  });
}
