/** The ports of the device dialog: selected, allowed earlier, or stuck. */
import { element, fill } from "../../dom.js";
import { serial } from "../../engine/live.js";
import { message } from "../link.js";
import { usbOf } from "./roles.js";

/** Of a port that the browser does not give back. */
export const STUCK = "The port could not be closed: reload this page before you use it again.";

/** @type {WeakSet<any>} */
const stuck = new WeakSet();

/**
 * @param {import("./session.js").Device} device @param {HTMLElement} allowed  Filled with the ports that were allowed before.
 * @param {{report: (text: string, isError?: boolean) => void, onSelect: () => void, focus: () => void}} dialog
 */
export function createPorts(device, allowed, { report, onSelect, focus }) {
  /** @param {any} port */
  function take(port) {
    if (stuck.has(port)) return report(STUCK, true);
    device.port = port;
    report(`Port selected${usbOf(port)}. It is not open yet.`);
    onSelect();
    return focus();
  }

  async function choose() {
    try {
      take(await serial().requestPort());
    } catch (error) {
      // No port was selected, or this page may have none.
      const isNone = error instanceof DOMException && error.name === "NotFoundError";
      report(isNone ? "No port was selected." : `No port: ${message(error)}.`, !isNone);
      if (device.port) focus();
    }
  }

  /** Ports that the user, or the browser's policy, allowed before need no chooser. None is opened. */
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
        press.addEventListener("click", () => take(each));
        return press;
      });
    fill(allowed, ...offers);
  }

  /** Gives up a port that the browser does not give back. @param {any} port */
  function giveUp(port) {
    stuck.add(port);
    if (device.port === port) device.port = null;
    void offer();
  }
  return { choose, offer, giveUp };
}
