/** The ports of the device dialog: selected, allowed earlier, or stuck. */
import { element, fill } from "../../dom.js";
import { serial } from "../../engine/live.js";
import { errorMessage } from "../../state/error_message.js";
import { usbOf } from "./roles.js";

/** Error for a port that the browser does not release. */
export const STUCK = "The port could not be closed: reload this page before you use it again.";

/** @type {WeakSet<any>} */
const stuck = new WeakSet();

/**
 * @param {import("./session.js").Device} device @param {HTMLElement} allowed  Element for the buttons of ports that were allowed before.
 * @param {{report: (text: string, isError?: boolean) => void, onSelect: () => void, focus: () => void}} dialog
 */
export function createPorts(device, allowed, { report, onSelect, focus }) {
  /** @param {any} port */
  function select(port) {
    if (stuck.has(port)) return report(STUCK, true);
    device.port = port;
    report(`Port selected${usbOf(port)}. It is not open yet.`);
    onSelect();
    return focus();
  }

  async function choose() {
    try {
      select(await serial().requestPort());
    } catch (error) {
      // The user closed the list of ports, or the browser denies access.
      const isNone = error instanceof DOMException && error.name === "NotFoundError";
      report(isNone ? "No port was selected." : `No port: ${errorMessage(error)}.`, !isNone);
      if (device.port) focus();
    }
  }

  /** Offers ports that were allowed before, so that the user needs no list of ports. Opens none. */
  async function offer() {
    /** @type {any[]} */
    const ports =
      (await serial()
        ?.getPorts()
        .catch(() => [])) ?? [];
    const offers = ports
      .filter((each) => !stuck.has(each))
      .map((each, index) => {
        const name = `${ports.length > 1 ? `Port ${index + 1}` : "Port"} allowed before${usbOf(each)}`;
        const press = element("button", { type: "button", title: "Use it without the port list of the browser" }, name);
        press.addEventListener("click", () => select(each));
        return press;
      });
    fill(allowed, ...offers);
  }

  /** Excludes a port that the browser does not release. @param {any} port */
  function exclude(port) {
    stuck.add(port);
    if (device.port === port) device.port = null;
    void offer();
  }
  return { choose, offer, exclude };
}
