/** The inspector of the current row; loads its content (packet_details.js) on demand. */
import { byId, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { registerCommands } from "../../shell/commands.js";
import { count } from "../../state/number.js";
import { meaningOf } from "./columns.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").PacketDetail} PacketDetail */

/** @param {import("./packets.js").Page} page */
export function createInspector(page) {
  const details = /** @type {HTMLDetailsElement} */ (byId("packet-inspector"));
  const [bytes, fields] = [byId("packet-bytes"), byId("packet-fields")];
  /** @type {ReturnType<typeof import("./packet_details.js").createPacketDetails> | null} */
  let content = null;
  /** @type {PacketDetail | null} */
  let row = null;
  let wanted = -1;

  for (const list of [bytes, fields]) {
    registerCommands(list, "Bytes and fields of a packet", [
      { keys: ["ArrowLeft", "ArrowUp"], text: "previous", run: () => content?.step(list, -1) },
      { keys: ["ArrowRight", "ArrowDown"], text: "next", run: () => content?.step(list, 1) },
      { keys: ["Home"], text: "first", run: () => content?.step(list, -Infinity) },
      { keys: ["End"], text: "last", run: () => content?.step(list, Infinity) },
      { keys: ["Escape"], text: "select none", run: () => content?.point(list, -1) },
    ]);
  }
  details.addEventListener("toggle", () => void paint());

  /** Shows the row if the inspector is open. */
  async function paint() {
    if (!details.open) return;
    try {
      const { createPacketDetails } = await import("./packet_details.js");
      content ??= createPacketDetails(page, bytes, fields);
      content.show(row);
    } catch {
      setText(
        byId("packet-reading"),
        "This part of the page could not be loaded. Check the network and unfold it again.",
      );
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
    setText(
      byId("packet-detail"),
      [`#${count(row.index)}`, meaningOf(row), row.outcome, row.why].filter(Boolean).join(" · "),
    );
    await paint();
  }

  return {
    show,
    /** Updates the highlighted bytes and fields. @param {State} state */
    highlight: (state) => content?.highlight(state),
    row: () => row,
    reset: () => {
      row = null;
      wanted = -1;
      content?.show(null);
    },
  };
}
