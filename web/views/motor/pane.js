/** The pane of the motor: asks what its plant did while it is on show. What draws it (motor.js) loads when it is first opened. */
import { byId, say } from "../../dom.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} Page */

/** @param {Page} page */
export function createMotorPane(page) {
  const view = byId("view-motor");
  const note = byId("motor-note");
  /** @type {ReturnType<typeof import("./motor.js").createMotor> | null} */
  let made = null;
  /** What it has drawn. @type {State | undefined} */
  let drawn;
  let placed = false;
  const observer = new ResizeObserver(() => void refresh());

  async function refresh() {
    if (!view.checkVisibility()) return;
    try {
      const { createMotor } = await import("./motor.js");
      made ??= createMotor(page);
    } catch {
      return say(note, "This view could not be loaded; fold and unfold it when the network is there.");
    }
    if (drawn === page.now()) return;
    const before = drawn;
    drawn = page.now();
    await made.render(drawn, before);
  }

  return {
    render() {
      // Before the first state has given each view its place, all of them may stand there for a moment.
      if (!placed) observer.observe(view);
      placed = true;
      return refresh();
    },
  };
}
