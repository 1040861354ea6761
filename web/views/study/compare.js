/**
 * The tab Compare of the study: the selected move's steps in its time, with every kind of motion side by side: their curves,
 * and what each costs. What a tab is, says study.js.
 */
import { button, element, fill, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count, plain, pretty, short, si } from "../../state/number.js";
import { cleared, color, draw, watch } from "../../time/plot.js";
import { field, focusRow, table } from "./parts.js";
import { place } from "./place.js";
import { isAnother, selectedAxis } from "./selected_axis.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{is_met: boolean, least: {needed_mn_m: number, available_mn_m: number, at_s: number} | null}} Torque */
/**
 * @typedef {{name: string, move: {[kind: string]: any}, why: string | null, speed: number, jump: number, acceleration: number, jerk: number,
 *   acceleration_jump: number, time_error_s: number, last_step_s: number, torque: Torque | null, at_speed?: Float64Array,
 *   at_acceleration?: Float64Array}} Cost
 */

/** In the order of the core's rows: colour and dash, which tells them apart where colour does not. @type {[string, number][]} */
const LOOKS = [
  ["--actual", 0],
  ["--ideal", 2],
  ["--enable", 4],
  ["--wire", 7],
  ["--ink", 10],
  ["--reply", 15],
  ["--actual", 15],
  ["--ideal", 10],
  ["--enable", 0],
  ["--wire", 2],
  ["--ink", 4],
  ["--reply", 7],
];
const POINTS = 401;
const GUTTER = 68;
/** A number whose unit stands over it. @param {number} value */
const bare = (value) => plain(value, "").trim();

/** Two numbers that differ by less than this part are the same: one went through a division. */
const SAME = 1e-6;

/** Which of the rows a move of a scenario is. @param {{[kind: string]: any}} move */
function kindOf(move) {
  const [[kind, { method, shape, interpolation }]] = Object.entries(move);
  return [kind, method, shape, interpolation].filter((part) => part).join(" ");
}

/** Whether two values are the same but for last digits. @param {any} one @param {any} other @returns {boolean} */
function same(one, other) {
  if (typeof one === "number" && typeof other === "number")
    return Math.abs(one - other) <= SAME * Math.max(Math.abs(one), Math.abs(other));
  if (one === null || typeof one !== "object" || typeof other !== "object") return one === other;
  return Object.keys(one).every((key) => key === "distance" || same(one[key], other?.[key]));
}

/** The part of the motor's torque that a motion needs where most is missing. @param {Torque} torque */
function torqueCell({ is_met, least }) {
  if (!least) return "none";
  const { needed_mn_m: needed, available_mn_m: available, at_s } = least;
  const part = available > 0 ? `${short((100 * Math.abs(needed)) / available, 3)} %` : "none left";
  const title = `${short(Math.abs(needed), 4)} of ${short(available, 4)} mN·m at ${si(at_s, "s")}`;
  return element("span", { title, class: is_met ? "" : "error" }, is_met ? part : `✕ ${part}`);
}

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createCompare({ engine, dispatch, now, panel }) {
  const about = element("span", { class: "study-note" });
  const moves = element("select");
  const moveLabel = element("label", {}, "move ", moves);
  const ramp = field("Ramp", "s", 0.2, { least: 0, most: 1e6 }, () => {
    own = false;
    refresh(now());
  });
  const bar = element("div", { class: "study-bar" }, moveLabel, ramp.root, about);
  const speeds = element("canvas", {
    id: "compare-speeds",
    role: "img",
    "aria-label": "Speed of every kind of motion over time",
  });
  const list = table("Kinds of motion", [
    "motion",
    "#peak rate, steps/s",
    "#peak acceleration, steps/s²",
    "#peak jerk, steps/s³",
    "#torque",
    "#time error",
    "#last step",
    "",
  ]);
  const small = LOOKS.map(() => ({
    name: element("span"),
    canvas: element("canvas", { role: "img", "aria-label": "Acceleration" }),
    key: element("canvas", { class: "study-key", "aria-hidden": "true" }),
  }));
  const multiples = element(
    "div",
    { class: "study-multiples" },
    ...small.map(({ name, canvas, key }) =>
      element("div", {}, element("p", { class: "study-caption" }, key, name), canvas),
    ),
  );
  const all = element(
    "div",
    { class: "study-compare" },
    element("p", { class: "study-caption" }, "Speed, steps/s, over time"),
    element("div", { class: "study-speeds" }, speeds),
    list.root,
    element("p", { class: "study-caption" }, "Acceleration, steps/s², over time"),
    multiples,
  );
  fill(panel, bar, all);
  moves.addEventListener("change", () => {
    own = true;
    refresh(now());
  });
  watch(speeds, paint);
  /** @type {Cost[]} */
  let rows = [];
  let duration = 0;
  let key = "";
  /** Whether the ramp follows the move's own. */
  let own = true;
  let move = 0;
  let shown = "";
  /** What was asked last; and the axis and move of the rows, which they are put into. */
  let asking = 0;
  let rowsOf = "";

  /** @param {State} state */
  async function refresh(state) {
    const of = selectedAxis(state);
    const turn = ++asking;
    // Rows of another axis must not be put into this one.
    if (!rowsOf.startsWith(`${placeOf(state)} `)) empty();
    hold();
    if (of === null) return undefined;
    panel.classList.toggle("stale", of === "");
    if (of === "") return undefined;
    ramp.root.hidden = all.hidden = typeof of === "string";
    if (typeof of === "string") {
      moveLabel.hidden = true;
      return say(about, of);
    }
    move = Math.min(Number(moves.value || 0), of.moves.length - 1);
    if (moves.options.length !== of.moves.length)
      fill(moves, ...of.moves.map((_, at) => element("option", { value: String(at) }, String(at + 1))));
    moves.value = String(move);
    moveLabel.hidden = of.moves.length < 2;
    const asked = of.moves[move];
    const { duration_s, ramp_s } = asked.cosine ?? asked.ramps ?? {};
    const derived = state.derived?.controllers[of.controller]?.axes[of.axis]?.moves[move];
    const steps = derived?.steps ?? 0;
    duration = duration_s ?? derived?.duration_s ?? 0;
    // Another move, or an edit of this one, brings its own ramp back.
    const next = JSON.stringify([of.path, move, asked]);
    if (next !== shown) own = true;
    shown = next;
    if (own) ramp.set(ramp_s ?? Number(short(duration / 4, 4)));
    all.hidden = steps === 0;
    if (steps === 0)
      return say(
        about,
        `Move ${move + 1} of axis ${of.axis} ends where it begins: choose one that goes somewhere to compare motions for it. Sines are compared under Sine.`,
      );
    say(
      about,
      `Axis ${of.axis}, move ${move + 1}: ${count(steps)} steps in ${si(duration, "s")}${ramp_s === undefined ? "; it has no ramp of its own, so give one" : ""}.`,
    );
    const question = [of.json, of.controller, of.axis, move, ramp.value(), POINTS];
    const answer = await engine.consider("compare", "compare", ...question).catch(unlessDropped);
    if (!answer || turn !== asking) return undefined;
    rows = answer;
    key = kindOf(asked);
    rowsOf = `${placeOf(state)} ${move}`;
    // What is wrong with the ramp for every kind that takes it as it is, is said once, at its field.
    const { why } = rows[0];
    const refused =
      why !== null && rows.every(({ move, why: other }) => !("cosine" in move || "ramps" in move) || other === why);
    ramp.fail(refused ? pretty(why) : "");
    all.hidden = refused;
    if (refused) return empty();
    show(asked);
    return paint();
  }

  /** Which axis a state looks at. @param {State} state */
  function placeOf(state) {
    const { controller, path } = place(state);
    return `${controller}:${path}`;
  }

  function empty() {
    [rows, rowsOf] = [[], ""];
    list.show([]);
    for (const { canvas } of [{ canvas: speeds }, ...small]) cleared(canvas);
  }

  /** Nothing can be taken before the answer is there; the focus stays in its row. */
  function hold() {
    for (const press of list.body.querySelectorAll("button")) {
      if (press === document.activeElement) focusRow(press.closest("tr"));
      press.disabled = true;
    }
  }

  /** Puts a motion into the scenario as it is now. @param {{[kind: string]: any}} made */
  function take(made) {
    const of = selectedAxis(now());
    if (!of || typeof of === "string" || rowsOf !== `${placeOf(now())} ${move}` || !of.moves[move]) return;
    const [kind, values] = Object.entries(made)[0];
    const { distance } = /** @type {any} */ (Object.values(of.moves[move])[0]);
    const value = { [kind]: "distance" in values ? { ...values, distance: distance ?? values.distance } : values };
    // The ramp with which it was compared stays.
    shown = JSON.stringify([of.path, move, value]);
    own = false;
    dispatch({ type: "edit", path: `${of.path}.moves[${move}]`, value });
  }

  /** @param {{[kind: string]: any}} asked */
  function show(asked) {
    list.show(
      rows.map(({ name: called, move: made, why, ...cost }) => {
        const press = same(made, asked) ? "in use" : button("Use", `Use: ${called}`, () => take(made));
        const name = element(
          "span",
          { class: "study-name" },
          element("canvas", { class: "study-key", "aria-hidden": "true" }),
          called,
        );
        if (why !== null) return [name, pretty(why), "", "", "", "", "", ""];
        const jump = (/** @type {number} */ by, /** @type {string} */ unit) =>
          element("span", { class: "jump" }, `unbounded, jumps by ${plain(by, unit).replace(" ", "\u00a0")}`);
        return [
          name,
          bare(cost.speed),
          cost.jump > 0 ? jump(cost.jump, "steps/s") : bare(cost.acceleration),
          cost.jump > 0
            ? "unbounded"
            : cost.acceleration_jump > 0
              ? jump(cost.acceleration_jump, "steps/s²")
              : bare(cost.jerk),
          cost.torque ? torqueCell(cost.torque) : "no motor",
          Math.abs(cost.time_error_s) <= SAME * duration
            ? "none"
            : `${si(cost.time_error_s, "s")} (${short((100 * cost.time_error_s) / duration, 3)} %)`,
          si(cost.last_step_s, "s", 5),
          press,
        ];
      }),
    );
    rows.forEach(({ why }, at) => {
      list.body.children[at].classList.toggle("chosen", kindOf(rows[at].move) === key);
      if (why === null) return;
      const row = /** @type {HTMLTableRowElement} */ (list.body.children[at]);
      while (row.cells.length > 2) row.deleteCell(-1);
      row.cells[1].colSpan = 7;
      row.cells[1].className = "why";
    });
  }

  function paint() {
    if (rows.length === 0) return;
    const x = Float64Array.from({ length: POINTS }, (_, at) => (duration * at) / (POINTS - 1));
    const axis = { min: 0, max: duration, unit: "s", prefix: true, label_px: 20 };
    const of = (/** @type {"at_speed" | "at_acceleration"} */ what, /** @type {number[]} */ which) =>
      which.flatMap((at) => {
        const y = rows[at][what];
        return y
          ? [{ color: color(LOOKS[at][0]), opacity: 1, width: 1.8, dash: LOOKS[at][1], x, shape: { line: { y } } }]
          : [];
      });
    const every = rows.map((_, at) => at);
    const range = (/** @type {"at_speed" | "at_acceleration"} */ what, shown = rows) => {
      const values = shown.flatMap((row) => [...(row[what] ?? [])]);
      const [min, max] = [Math.min(0, ...values), Math.max(0, ...values)];
      return { min: min * 1.05, max: max * 1.05 || 1, unit: "", prefix: true, label_px: GUTTER };
    };
    draw(speeds, { x: axis, y: range("at_speed"), series: of("at_speed", every) });
    // Where the speed jumps the acceleration has no bound, and no chart.
    const isBounded = (/** @type {Cost} */ row) => row.jump === 0;
    const accelerations = { ...range("at_acceleration", rows.filter(isBounded)), label_px: 44 };
    small.forEach(({ name, canvas, key }, at) => {
      say(name, rows[at].name);
      canvas.setAttribute("aria-label", `Acceleration, ${rows[at].name}`);
      /** @type {HTMLElement} */ (canvas.parentElement).hidden = !(rows[at].at_acceleration && isBounded(rows[at]));
      draw(canvas, {
        x: axis,
        y: accelerations,
        series: of("at_acceleration", [at]).map((line) => ({ ...line, dash: 0 })),
      });
      drawKey(key, at);
    });
    for (const [at, canvas] of list.body.querySelectorAll("canvas").entries()) drawKey(canvas, at);
  }
  /** A piece of a curve's line. @param {HTMLCanvasElement} canvas @param {number} at */
  function drawKey(canvas, at) {
    const [ink, dash] = LOOKS[at];
    [canvas.width, canvas.height] = [88, 16];
    const context = canvas.getContext("2d");
    if (!context) return;
    context.strokeStyle = color(ink);
    context.lineWidth = 4;
    context.setLineDash([2 * dash, 2 * dash]);
    context.moveTo(0, 8);
    context.lineTo(88, 8);
    context.stroke();
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (isAnother(state, before)) return refresh(state);
    return undefined;
  }
  return { render };
}
