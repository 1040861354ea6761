/** Small helpers over the DOM. Text goes in as text only. */

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

/** Replaces what an element holds. @param {Element} parent @param {...(Node | string)} children */
export function fill(parent, ...children) {
  parent.replaceChildren(...children);
}

/**
 * The element with an id; the page is wrong without it.
 * @template {HTMLElement} [T=HTMLElement]
 * @param {string} id
 * @returns {T}
 */
export function byId(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return /** @type {T} */ (found);
}

/** Sets a text only where it changed, so that live regions speak once. @param {Element} node @param {string} text */
export function say(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** What stands out now, and the timer that ends it. @type {WeakMap<Element, ReturnType<typeof setTimeout>>} */
const flashes = new WeakMap();

/** Lets a change stand out for a moment. Fading would draw the whole page anew in every frame. @param {HTMLElement} node */
export function flash(node) {
  node.classList.add("changed");
  clearTimeout(flashes.get(node));
  flashes.set(
    node,
    setTimeout(() => node.classList.remove("changed"), 900),
  );
}

/** Fills a select; keeps its value where that is still there. @param {HTMLSelectElement} select @param {[string, string][]} options @param {string} value */
export function options(select, options, value) {
  const key = JSON.stringify(options);
  if (select.dataset.options !== key) {
    select.dataset.options = key;
    fill(select, ...options.map(([name, text]) => element("option", { value: name }, text)));
  }
  if (select.value !== value) select.value = value;
}

/** Loads the style of a part that the page begins without; where it does not come, the part can be used all the same. @param {"study" | "panel" | "live"} part @returns {Promise<void>} */
export function style(part) {
  const link = element("link", { rel: "stylesheet", href: byId("main").dataset[`${part}Style`] ?? "" });
  return new Promise((resolve) => {
    for (const end of ["load", "error"]) link.addEventListener(end, () => resolve());
    document.head.append(link);
  });
}
