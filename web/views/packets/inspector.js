/** The inspector of the current row; loads unfolded.js on demand. */
import { byId, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { listen } from "../../shell/commands.js";
import { count } from "../../state/number.js";
import { meaningOf } from "./columns.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").PacketDetail} PacketDetail */

/** @param {import("./packets.js").Page} page */
export function createInspector(page) {
  const details = /** @type {HTMLDetailsElement} */ (byId("packet-inspector"));
  const [bytes, fields] = [byId("packet-bytes"), byId("packet-fields")];
  /** @type {ReturnType<typeof import("./unfolded.js").createUnfolded> | null} */
  let unfolded = null;
  /** @type {PacketDetail | null} */
  let row = null;
  let wanted = -1;

  for (const list of [bytes, fields]) {
    listen(list, "Bytes and fields of a packet", [
      { keys: ["ArrowLeft", "ArrowUp"], text: "previous", run: () => unfolded?.step(list, -1) },
      { keys: ["ArrowRight", "ArrowDown"], text: "next", run: () => unfolded?.step(list, 1) },
      { keys: ["Home"], text: "first", run: () => unfolded?.step(list, -Infinity) },
      { keys: ["End"], text: "last", run: () => unfolded?.step(list, Infinity) },
      { keys: ["Escape"], text: "clear the selection", run: () => unfolded?.point(list, -1) },
    ]);
  }
  details.addEventListener("toggle", () => void paint());

  /** Shows all of the row, where that is unfolded. */
  async function paint() {
    if (!details.open) return;
    try {
      const { createUnfolded } = await import("./unfolded.js");
      unfolded ??= createUnfolded(page, bytes, fields);
      unfolded.show(row);
    } catch {
      say(byId("packet-reading"), "This part of the page could not be loaded. Check the network and unfold it again.");
    }
  }

  /** Shows a row. @param {number} index */
  async function show(index) {
    if (index === wanted) return;
    wanted = index;
    const reply = await page.engine.latest("packet", "packet", index).catch(unlessDropped);
    if (!reply || index !== wanted) return;
    row = /** @type {PacketDetail} */ (reply);
    details.hidden = false;
    say(
      byId("packet-detail"),
      [`#${count(row.index)}`, meaningOf(row), row.outcome, row.why].filter(Boolean).join(" · "),
    );
    await paint();
  }

  return {
    show,
    /** Highlights the bytes and fields that something points at. @param {State} state */
    light: (state) => unfolded?.light(state),
    row: () => row,
    reset: () => {
      row = null;
      wanted = -1;
      unfolded?.show(null);
    },
  };
}
