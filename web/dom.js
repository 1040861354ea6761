/** DOM helpers. They insert text only as text. */

/**
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {{[name: string]: string}} [attributes]
 * @param {...(Node | string)} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** @param {string} text @param {string} label @param {() => void} press @param {boolean} [disabled] */
export function button(text, label, press, disabled = false) {
  const made = element("button", { type: "button", "aria-label": label, title: label }, text);
  made.disabled = disabled;
  made.addEventListener("click", press);
  return made;
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

/** Sets a text only if it changed, so that live regions speak once. @param {Element} node @param {string} text */
export function say(node, text) {
  if (node.textContent !== text) node.textContent = text;
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
export function options(select, options, value) {
  const key = JSON.stringify(options);
  if (select.dataset.options !== key) {
    select.dataset.options = key;
    fill(select, ...options.map(([name, text]) => element("option", { value: name }, text)));
  }
  if (select.value !== value) select.value = value;
}

/** Loads the style of a part of the page; errors are ignored. @param {"study" | "panel" | "live"} part @returns {Promise<void>} */
export function style(part) {
  const link = element("link", { rel: "stylesheet", href: byId("main").dataset[`${part}Style`] ?? "" });
  return new Promise((resolve) => {
    for (const end of ["load", "error"]) link.addEventListener(end, () => resolve());
    document.head.append(link);
  });
}
