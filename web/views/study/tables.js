/** The tab Tables of the study: step tables of the selected axis or of the visible steps, with their size and error. */
import { element, fill, setText } from "../../dom.js";
import { save } from "../../shell/save.js";
import { errorMessage } from "../../state/error_message.js";
import { count, counted, plain, pretty, short, si } from "../../state/number.js";
import { createJob } from "./job.js";
import { field } from "./parts.js";
import { isAnother } from "./selected_axis.js";
import { table } from "./table.js";
import { choice, FORMS, files, tabled, tableRequest, WIDTHS } from "./table_files.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{steps: number, entries: number, bytes: number, document_bytes: number | null, largest_s: number, rms_s: number, why: string | null}} Form */

const ROWS = Object.keys(FORMS).flatMap((form) => Object.keys(WIDTHS).map((widths) => ({ form, widths })));

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createTables({ engine, now, panel }) {
  const error = field("Maximum error of the compressed list", "µs", choice.us, { min: 0, max: 1e6 }, () =>
    refresh(now()),
  );
  const job = createJob("Tables");
  const about = element("p", { class: "study-note" });
  const note = element("p", { class: "study-note" });
  const list = table("Stored forms", [
    "form",
    "entry",
    "#entries",
    "#bytes",
    "~#steps per entry",
    "#maximum error",
    "#RMS error",
    "~#steps",
  ]);
  const saves = element("p", { class: "study-bar", role: "group", "aria-label": "Save the selected table" });
  const status = element("span", { "aria-live": "polite" });
  fill(panel, element("div", { class: "study-bar" }, error.root, job.root), about, list.root, note, saves);
  /** The rows of the table; `key` identifies their subject. @type {Form[]} */
  let forms = [];
  let key = "";
  list.body.addEventListener("click", ({ target }) => {
    const row = /** @type {Element} */ (target).closest("tr");
    const pick = row?.querySelector("input");
    if (pick && !pick.disabled) choose(pick.value);
  });
  list.body.addEventListener("change", ({ target }) => choose(/** @type {HTMLInputElement} */ (target).value));

  /** @param {string} id */
  function choose(id) {
    [choice.form, choice.widths] = id.split("-");
    mark();
  }

  function mark() {
    for (const pick of list.body.querySelectorAll("input")) {
      pick.checked = pick.value === `${choice.form}-${choice.widths}`;
      pick.closest("tr")?.classList.toggle("chosen", pick.checked);
    }
    const subject = tabled(now());
    if (!subject || typeof subject === "string") return fill(saves);
    const isUnavailable =
      forms[ROWS.findIndex(({ form, widths }) => form === choice.form && widths === choice.widths)]?.why !== null;
    setText(status, "");
    fill(
      saves,
      element(
        "span",
        {},
        isUnavailable ? "" : `Save ${FORMS[choice.form].toLowerCase()} (${WIDTHS[choice.widths]}) as`,
      ),
      ...(isUnavailable
        ? []
        : files(now(), engine, subject).map(({ name, type, button, language, make }) => {
            const press = element("button", { type: "button", "data-language": language, title: name }, button);
            press.addEventListener("click", async () => {
              setText(status, `Writing ${name}…`);
              try {
                save(name, type, await make());
                setText(status, `Saved ${name}.`);
              } catch (error) {
                setText(status, `${name} cannot be written: ${errorMessage(error)}`);
              }
            });
            return press;
          })),
      status,
    );
  }

  function show() {
    const steps = forms[0].steps;
    // A form refused in all widths for one reason has one row.
    const alike = (/** @type {number} */ at) =>
      ROWS.every(
        ({ form }, other) =>
          form !== ROWS[at].form || (forms[other].why !== null && forms[other].why === forms[at].why),
      );
    const distinct = forms.map((_, at) => at).filter((at) => !alike(at) || ROWS[at].widths === "q16");
    const fewest = Math.min(...forms.filter(({ why }) => why === null).map(({ bytes }) => bytes));
    const best = forms.findIndex(({ why, bytes }) => why === null && bytes === fewest);
    list.show(
      distinct.map((at) => {
        const { entries, bytes, document_bytes, largest_s, rms_s, why } = forms[at];
        const { form, widths } = ROWS[at];
        const pick = element("input", { type: "radio", name: "study-table", value: `${form}-${widths}` });
        pick.disabled = why !== null;
        const name = element("label", { class: "check" }, pick, FORMS[form]);
        /** @type {(string | Node)[]} */
        const cells =
          why !== null
            ? [pretty(why)]
            : [
                count(entries),
                count(bytes),
                entries === 0 ? "–" : steps < 1000 * entries ? short(steps / entries, 4) : count(steps / entries),
                si(largest_s, "s"),
                si(rms_s, "s"),
                `${count(steps)}, exact`,
              ];
        if (form === "document" && document_bytes !== null && why === null) cells[1] += ` (${count(document_bytes)})`;
        if (why === null && bytes === fewest) cells[1] = element("strong", {}, cells[1]);
        return [name, alike(at) ? "all" : WIDTHS[widths], ...cells];
      }),
    );
    distinct.forEach((at, row) => {
      const cell = list.body.children[row].children[2];
      if (forms[at].why === null) return;
      cell.setAttribute("colspan", "6");
      cell.className = "why";
    });
    const hasPaper = forms.some(({ document_bytes }) => document_bytes !== null);
    setText(
      note,
      `${best < 0 ? "" : `Fewest bytes (bold): ${FORMS[ROWS[best].form].toLowerCase()} (${WIDTHS[ROWS[best].widths]}). `}The compressed list has fewer entries, within the maximum error. One interval of 4 bytes per step would take ${count(4 * steps)} bytes.${hasPaper ? " In parentheses: bytes of the table in the paper." : ""} Every list has all steps.`,
    );
    mark();
  }

  /** @param {State} state */
  function refresh(state) {
    const subject = tabled(state);
    if (subject === null) return;
    panel.classList.toggle("stale", subject === "");
    if (subject === "") return;
    if (typeof subject === "string") {
      key = "";
      setText(about, subject);
      for (const each of [list.root, note, saves]) each.hidden = true;
      return;
    }
    choice.us = error.value();
    const next = JSON.stringify([subject.json, subject.controller, subject.axis, subject.run, choice.us]);
    if (next === key) return mark();
    key = next;
    job.run(
      async (signal, report) => {
        let done = 0;
        report(0, `0 of ${ROWS.length} tables`);
        const [method, begin] = await tableRequest(engine, "step_table", subject);
        const pieces = ROWS.map(({ form, widths }) => [...begin, form, widths, choice.us]);
        return engine.distribute(method, pieces, signal, () =>
          report(++done / pieces.length, `${done} of ${pieces.length} tables`),
        );
      },
      (rows) => {
        forms = rows;
        for (const each of [list.root, note, saves]) each.hidden = false;
        const derived = now().derived?.controllers[subject.controller]?.axes[subject.axis];
        setText(
          about,
          `${subject.run === null ? "Axis" : "Channel"} ${subject.axis}: ${counted(rows[0].steps, "step")}${subject.run === null ? "" : ", as shown in the views; there is no plan"}${derived ? ` in ${si(derived.duration_s, "s")}, up to ${plain(derived.peak_speed_steps_s, "steps/s")}` : ""}.`,
        );
        show();
      },
    );
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (isAnother(state, before)) refresh(state);
  }
  return { render };
}
