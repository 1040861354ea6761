/** The packets of a recording in its dialog. */
import { button, element, fill } from "../../dom.js";
import { save } from "../save.js";
import { MAX_PACKETS, packetCells, packetsFile, packetsText } from "./texts.js";

/**
 * @param {string} file  Its name.
 * @param {(maxRows: number) => Promise<{packets: import("../../engine/capture.js").LinePackets, clock_hz: number} | null>} load
 * @param {(error: unknown) => void} showError
 */
export function createPacketList(file, load, showError) {
  const node = element("details", { class: "packet-list" });
  node.hidden = true;
  node.addEventListener("toggle", () => {
    if (node.open) void list().catch(showError);
  });

  async function list() {
    const found = await load(MAX_PACKETS);
    if (!found || !node.open) return;
    const { packets, clock_hz } = found;
    const name = packetsFile(file);
    const saveAll = button("Save all (CSV)", `Save all packets: ${name}`, () => save(name, "text/csv", [packets.csv]));
    fill(
      node,
      element("summary", {}, "Packets"),
      element("p", {}, packetsText(packets), saveAll),
      grid(
        ["Line", "from", "bytes", "meaning"],
        packets.rows.map((row) => packetCells(row, clock_hz)),
      ),
    );
  }

  return {
    node,
    hide() {
      node.hidden = true;
    },
    /** @param {boolean} hasPackets */
    reset(hasPackets) {
      node.hidden = !hasPackets;
      node.open = false;
      fill(node, element("summary", {}, "Packets"));
    },
  };
}

/** @param {string[]} head @param {string[][]} rows */
function grid(head, rows) {
  const row = (/** @type {string[]} */ cells) => element("tr", {}, ...cells.map((text) => element("td", {}, text)));
  const names = head.map((text) => element("th", { scope: "col" }, text));
  return element(
    "table",
    { class: "channels" },
    element("thead", {}, element("tr", {}, ...names)),
    element("tbody", {}, ...rows.map(row)),
  );
}
