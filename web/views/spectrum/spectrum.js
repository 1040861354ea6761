/** The spectrum view: harmonics of the ideal motion beside those of the pulses that make it, and the distortion. */
import { byId, element, fill, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { listen } from "../../shell/commands.js";
import { short, si } from "../../state/number.js";
import { cleared, color, draw, fit, watch } from "../../time/plot.js";
import { describe, distortion, FLOOR_DB, given, harmonics, heard, method, reference, value } from "./harmonics.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").Spectra} Spectra */
/** @typedef {import("./harmonics.js").Quantity} Quantity */

/** Width of the tick labels in CSS pixels. */
const GUTTER = 58;

/** @param {Spectra} spectra @param {Quantity} quantity @param {boolean} db @param {number} width  CSS pixels. */
export function spectrumChart(spectra, quantity, db, width) {
  const all = given(spectra);
  const order = Math.max(...all.map(([, spectrum]) => spectrum[quantity].length));
  const x = Array.from({ length: order }, (_, i) => i + 1);
  const thick = Math.max(1.5, Math.min(5, (width - GUTTER) / order / 3));
  const top = Math.max(...all.flatMap(([, spectrum]) => [...spectrum[quantity]]), 1e-12);
  return {
    x: { min: 0, max: order + 1, unit: "", prefix: false, label_px: 20 },
    y: db
      ? { min: FLOOR_DB, max: 10, unit: "dB", prefix: false, label_px: GUTTER }
      : { min: 0, max: top * 1.1, unit: "", prefix: true, label_px: GUTTER },
    series: all.map(([name, spectrum]) => ({
      color: color(name === "ideal" ? "--ideal" : "--actual"),
      opacity: 1,
      width: thick,
      x,
      shape: {
        stems: {
          shift: (name === "ideal" ? -1 : 1) * (thick / 2 + 0.5),
          y: db
            ? spectrum[quantity].map((value) => 20 * Math.log10(heard(value) / reference(spectrum, quantity)))
            : spectrum[quantity],
        },
      },
    })),
  };
}

/** What is chosen in the view's head. @returns {{quantity: Quantity, db: boolean}} */
export function chosenSpectrum() {
  const value = (/** @type {string} */ id) => /** @type {HTMLSelectElement} */ (byId(id)).value;
  return { quantity: /** @type {Quantity} */ (value("spectrum-quantity")), db: value("spectrum-scale") === "db" };
}

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} page */
export function createSpectrum({ engine, dispatch, now }) {
  const canvas = /** @type {HTMLCanvasElement} */ (byId("spectrum-chart"));
  const overlay = /** @type {HTMLCanvasElement} */ (byId("spectrum-cursor"));
  const slider = byId("spectrum-pane");
  const body = /** @type {HTMLElement} */ (byId("harmonics").querySelector("tbody"));
  /** @type {Spectra | null} */
  let spectra = null;
  /** @type {ReturnType<typeof harmonics>} */
  let rows = [];
  /** @type {import("../../state/types.js").Plot | null} */
  let plot = null;

  for (const id of ["spectrum-quantity", "spectrum-scale"]) byId(id).addEventListener("change", paint);
  watch(canvas, paint);
  const point = (/** @type {number | null} */ harmonic) => dispatch({ type: "harmonic", harmonic });
  slider.addEventListener("pointermove", (event) => {
    if (!plot || rows.length === 0) return;
    const x = event.clientX - slider.getBoundingClientRect().left;
    const n = Math.round(((x - plot.left) / (plot.right - plot.left)) * (rows.length + 1));
    if (n >= 1 && n <= rows.length) point(n);
  });
  body.addEventListener("pointerover", (event) => {
    const row = event.target instanceof Element ? event.target.closest("tr") : null;
    if (row?.dataset.n) point(Number(row.dataset.n));
  });
  const move = (/** @type {number} */ by) =>
    point(Math.min(rows.length, Math.max(1, (now().harmonic ?? (by > 0 ? 0 : 2)) + by)));
  for (const target of [slider, byId("harmonics-scroll")]) {
    listen(target, "Spectrum", [
      {
        keys: ["ArrowRight", "ArrowUp"].slice(0, target === slider ? 2 : 1),
        text: "the next harmonic",
        run: () => move(1),
      },
      {
        keys: target === slider ? ["ArrowLeft", "ArrowDown"] : ["ArrowLeft"],
        text: "the harmonic before",
        run: () => move(-1),
      },
      { keys: ["Home"], text: "the fundamental", run: () => point(1) },
      { keys: ["End"], text: "the highest harmonic", run: () => point(rows.length) },
      { keys: ["Escape"], text: "no harmonic", run: () => point(null) },
    ]);
  }

  /** @param {State} state */
  async function refresh(state) {
    if (!state.result) return;
    const answer = await engine.latest("spectrum", "spectrum").catch(unlessDropped);
    if (answer === undefined) return;
    spectra = answer;
    dispatch({ type: "bare", view: "spectrum", bare: !(answer.ideal ?? answer.pulses)?.periodic });
    paint();
  }

  function paint() {
    const { quantity, db } = chosenSpectrum();
    const some = spectra?.ideal ?? spectra?.pulses ?? null;
    say(byId("thd"), spectra && some?.periodic ? distortion(spectra, quantity) : "");
    say(byId("spectrum-note"), spectra && some ? `${method(some)} ${spectra.note}`.trim() : (spectra?.note ?? ""));
    byId("spectrum-split").hidden = !some;
    rows = spectra && some ? harmonics(spectra, quantity) : [];
    table();
    if (spectra && some) {
      plot = draw(canvas, spectrumChart(spectra, quantity, db, canvas.clientWidth));
      fit(overlay);
      canvas.setAttribute(
        "aria-label",
        `Spectrum of ${quantity}, harmonics 1 to ${rows.length} of ${si(some.fundamental_hz, "Hz")}; the table beside it has the numbers`,
      );
    }
    mark(now());
  }

  function table() {
    const names = rows[0]?.parts.map(({ name }) => name) ?? [];
    const head = [
      ["n", ""],
      ["frequency", "wide"],
      ...names.flatMap((name) => [
        [name, "amplitude"],
        [`${name} %`, ""],
      ]),
    ];
    fill(
      /** @type {Element} */ (byId("harmonics").querySelector("thead")),
      element("tr", {}, ...head.map(([text, kind]) => element("th", { scope: "col", class: `number ${kind}` }, text))),
    );
    fill(
      body,
      ...rows.map(({ n, hz, parts }) => {
        const cells = [
          [String(n), ""],
          [si(hz, "Hz"), "wide"],
          ...parts.flatMap(({ amplitude, part }) => [
            [short(amplitude, 4), "amplitude"],
            [short(100 * part, 3), ""],
          ]),
        ];
        return element(
          "tr",
          { "data-n": String(n) },
          ...cells.map(([text, kind]) => element("td", { class: `number ${kind}` }, text)),
        );
      }),
    );
  }

  /** Lights up the harmonic that is pointed at, stem and row. @param {State} state */
  function mark({ harmonic }) {
    const row = harmonic === null ? undefined : rows[harmonic - 1];
    const { quantity } = chosenSpectrum();
    const some = spectra?.ideal ?? spectra?.pulses;
    const text = row ? describe(row, quantity, some?.periodic ?? false) : "";
    const short = (/** @type {string} */ of) => {
      const part = row?.parts.find(({ name }) => name === of);
      return part ? `${of} ${value(part, quantity, chosenSpectrum().db)}` : of;
    };
    byId("spectrum-reading").hidden = rows.length === 0;
    say(byId("spectrum-at"), row ? `n ${row.n} · ${si(row.hz, "Hz", 5)}` : "");
    say(byId("spectrum-ideal"), short("ideal"));
    say(byId("spectrum-pulses"), short("pulses"));
    slider.setAttribute("aria-valuemax", String(Math.max(1, rows.length)));
    slider.setAttribute("aria-valuenow", String(row?.n ?? 1));
    slider.setAttribute("aria-valuetext", text || "no harmonic chosen");
    for (const other of body.querySelectorAll(".highlighted")) other.classList.remove("highlighted");
    const layer = cleared(overlay);
    if (!row) return;
    const line = /** @type {HTMLElement} */ (body.children[row.n - 1]);
    line.classList.add("highlighted");
    const scroll = byId("harmonics-scroll");
    // Below the head, which stays; only the table itself is moved.
    const [above, below] = [
      line.offsetTop - 24 - scroll.scrollTop,
      line.offsetTop + line.offsetHeight - scroll.scrollTop - scroll.clientHeight,
    ];
    if (above < 0) scroll.scrollTop += above;
    else if (below > 0) scroll.scrollTop += below;
    if (!layer || !plot) return;
    const x = plot.left + (row.n / (rows.length + 1)) * (plot.right - plot.left);
    const half = Math.max(4, (plot.right - plot.left) / (rows.length + 1) / 2);
    layer.context.fillStyle = color("--mark");
    layer.context.globalAlpha = 0.3;
    layer.context.fillRect(x - half, plot.top, 2 * half, plot.bottom - plot.top);
    layer.context.globalAlpha = 1;
    layer.context.strokeStyle = color("--axis");
    layer.context.strokeRect(x - half + 0.5, plot.top + 0.5, 2 * half - 1, plot.bottom - plot.top - 1);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.result !== state.result) return refresh(state);
    if (before?.view !== state.view) paint();
    else if (before?.harmonic !== state.harmonic) mark(state);
    return undefined;
  }
  return { render };
}
