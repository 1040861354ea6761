/** A small chart of the speed that stays visible while the form scrolls on a narrow screen. */
import { byId } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { short } from "../../state/number.js";
import { shown } from "../../state/time_window.js";
import { draw, watch } from "../../time/plot.js";
import { chartOf } from "./bands.js";
import { requestColumns } from "./request_columns.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} page */
export function createMini({ engine, now }) {
  const canvas = /** @type {HTMLCanvasElement} */ (byId("mini"));
  watch(canvas, () => refresh(now()));

  /** @param {State} state */
  async function refresh(state) {
    if (!state.result || !canvas.checkVisibility()) return;
    const own = { ...state, baseline: null };
    const data = await requestColumns(engine, own, shown(state), canvas.clientWidth, "mini").catch(unlessDropped);
    if (!data) return;
    const { chart, range, unit } = chartOf(own, data, "speed");
    draw(canvas, chart);
    canvas.setAttribute("aria-label", `Speed over time: from ${short(range.low)} to ${short(range.high)} ${unit}`);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    const isSame = (/** @type {(keyof State)[]} */ keys) => keys.every((key) => before?.[key] === state[key]);
    return isSame(["result", "axis", "unit", "hiddenAxes", "window"]) ? undefined : refresh(state);
  }
  return { render };
}
