/** When a press becomes a drag, and what a sideways drag of a label means. */

/** A press that moves less is a click or a tap, in CSS pixels. */
const [CLICK_PX, TAP_PX] = [4, 10];
/** The distance of one step, in CSS pixels. */
const STEP_PX = 4;
/** Steps with Shift. */
export const FAST = 10;

/** @typedef {{clientX: number, clientY: number, pointerType: string, shiftKey: boolean}} Pointer  The part of a pointer event that is used. */

/** Whether a press has moved far enough for a drag. @param {Pointer} from @param {Pointer} to */
export function isDrag(from, { clientX, clientY, pointerType }) {
  const px = pointerType === "touch" ? TAP_PX : CLICK_PX;
  return Math.hypot(clientX - from.clientX, clientY - from.clientY) >= px;
}

/** Counts the steps of a sideways drag. @param {Pointer} press */
export function createScrub(press) {
  let last = press.clientX;
  let [steps, isMoved, isScroll] = [0, false, false];
  return {
    isMoved: () => isMoved,
    /** The steps since the press; null if it is a click or if the finger scrolls. @param {Pointer} pointer */
    move(pointer) {
      const { clientX, clientY, pointerType, shiftKey } = pointer;
      const isTouch = pointerType === "touch";
      if (!isMoved) {
        const [across, along] = [clientX - press.clientX, clientY - press.clientY].map(Math.abs);
        if (isScroll || !isDrag(press, pointer)) return null;
        isScroll = isTouch && across <= along;
        if (isScroll || across < CLICK_PX) return null;
        isMoved = true;
        if (isTouch) last = clientX;
      }
      // Shift applies to the movement while it is pressed, not to the whole drag.
      steps += ((clientX - last) / STEP_PX) * (shiftKey ? FAST : 1);
      last = clientX;
      return Math.trunc(steps);
    },
  };
}
