/** The table of replies of a device in the packets view (LIVE H4). */
import { byId, element, fill } from "../../dom.js";
import { count } from "../../state/number.js";

/** @typedef {import("../../engine/live.js").Exchange} Exchange */

/** Rows of replies that stay visible. */
const MAX_ROWS = 300;
const COLUMNS = ["time", "to", "frame", "reply", "state", "ticks done", "delay", "model delay", "difference"];
/** Columns with numbers. */
const NUMBERS = [0, 1, 5, 6, 7];

/** @type {ReturnType<typeof create> | null} */
let deviceTable = null;

/** The table, which is created once. */
export function deviceRows() {
  deviceTable ??= create();
  return deviceTable;
}

function create() {
  const view = byId("view-packets");
  const head = COLUMNS.map((name, index) =>
    element("th", { scope: "col", ...(NUMBERS.includes(index) ? { class: "number" } : {}) }, name),
  );
  const body = element("tbody");
  const table = element(
    "table",
    { "aria-label": "Replies of the device, newest first" },
    element("thead", {}, element("tr", {}, ...head)),
    body,
  );
  const rows = element(
    "div",
    { class: "scroll live-replies", tabindex: "0", role: "group", "aria-label": "Replies of the device" },
    table,
  );
  const sides = [false, true].map((device) => {
    const side = element(
      "button",
      { type: "button", id: device ? "packets-of-device" : "packets-of-model" },
      device ? "Device" : "Model",
    );
    side.title = device ? "Replies of the device, newest first" : "Packets of the simulated run";
    side.addEventListener("click", () => show(device));
    return side;
  });
  byId("device").after(
    element("span", { class: "group live-sides", role: "group", "aria-label": "Packets of" }, ...sides),
  );
  const noReplies = element("p", { class: "note" }, "Raw packets get no reply.");
  noReplies.hidden = true;
  rows.append(noReplies);
  view.append(rows);

  /** @param {boolean} device  Whether to show the replies of the device, or the packets of the model. */
  function show(device) {
    view.classList.toggle("of-device", device);
    for (const [index, side] of sides.entries()) side.setAttribute("aria-pressed", String(device === (index === 1)));
  }

  return {
    /** Clears the table for a new stream. @param {boolean} raw  Whether the line has no replies. */
    begin(raw) {
      fill(body);
      table.hidden = raw;
      noReplies.hidden = !raw;
      show(!raw);
      view.scrollIntoView({ block: "nearest" });
    },
    /** @param {Exchange[]} exchanges */
    add(exchanges) {
      body.prepend(...exchanges.slice(-MAX_ROWS).reverse().map(rowOf));
      while (body.rows.length > MAX_ROWS) body.lastElementChild?.remove();
    },
  };
}

/** @param {number | null} value */
const ms = (value) => (value === null ? "–" : `${value.toFixed(2)} ms`);

/** @param {Exchange} exchange */
function rowOf({ at_ms, controller, kind, reply, state, ticks_done, delay_ms, model_ms, difference }) {
  const texts = [
    `${(at_ms / 1000).toFixed(3)} s`,
    String(controller),
    kind,
    reply?.split(":")[0] ?? "no reply",
    state ?? "–",
    ticks_done === null ? "–" : count(ticks_done),
    ms(delay_ms),
    ms(model_ms),
    difference ?? "",
  ];
  const cells = texts.map((text, index) =>
    element(
      "td",
      NUMBERS.includes(index) ? { class: "number" } : index === texts.length - 1 ? { class: "differs-by" } : {},
      text,
    ),
  );
  return element("tr", difference || reply === null ? { class: "differs" } : {}, ...cells);
}
