/** The table of harmonics. */
import { byId, element, fill } from "../../dom.js";
import { short, si } from "../../state/number.js";
import { virtualRows } from "../virtual_rows.js";

/** @typedef {ReturnType<typeof import("./harmonics.js").harmonics>} Rows */

/** A percentage; a small one has an exponent instead of many zeros. @param {number} value */
function percent(value) {
  return value > 0 && value < 1e-3 ? value.toExponential(2).replace("-", "−") : short(value, 3);
}

/** @param {(n: number) => void} point  Called with the harmonic under the pointer. */
export function createHarmonicsTable(point) {
  const scroller = byId("harmonics-scroll");
  const table = byId("harmonics");
  const [head, body] = /** @type {HTMLElement[]} */ ([...table.children]);
  /** @type {Rows} */
  let rows = [];
  /** @type {number | null} */
  let marked = null;
  const { first, visible, scrollTo, resize } = virtualRows(scroller, byId("harmonics-space"), () => rows.length);

  scroller.addEventListener("scroll", paint);
  new ResizeObserver(paint).observe(scroller);
  // Not `pointerover`: scrolling must not select the row under a pointer that does not move.
  for (const kind of ["pointermove", "click"])
    body.addEventListener(kind, (event) => {
      const row = event.target instanceof Element ? event.target.closest("tr") : null;
      if (row?.dataset.n) point(Number(row.dataset.n));
    });

  function paint() {
    const from = first();
    fill(
      body,
      ...rows.slice(from, from + visible()).map(({ n, hz, parts }) => {
        const texts = [
          String(n),
          si(hz, "Hz"),
          ...parts.flatMap(({ amplitude, ratio }) => [short(amplitude, 4), percent(100 * ratio)]),
        ];
        const row = element("tr", { "data-n": String(n), "aria-rowindex": String(n + 1) });
        row.classList.toggle("highlighted", n === marked);
        row.append(...texts.map((text) => element("td", { class: "number" }, text)));
        return row;
      }),
    );
  }

  /** Shows other harmonics. @param {Rows} next */
  function show(next) {
    rows = next;
    const names = rows[0]?.parts.map(({ name }) => name) ?? [];
    const texts = ["n", "frequency", ...names.flatMap((name) => [name, `${name} %`])];
    fill(head, element("tr", {}, ...texts.map((text) => element("th", { scope: "col", class: "number" }, text))));
    table.setAttribute("aria-rowcount", String(rows.length + 1));
    resize();
    paint();
  }

  /** Highlights a harmonic and brings it into view. @param {number | null} n */
  function mark(n) {
    if (n === marked) return;
    marked = n;
    if (n !== null) scrollTo(n - 1);
    paint();
  }
  return { show, mark };
}
