/** Live mode of a panel: the cursor follows the clock, and held buttons become inputs. */

/** While a button is held, its release is planned this far ahead, in s of real time. */
const AHEAD_S = 1;
/** Maximum time between two frames, in ms. */
const MAX_FRAME_MS = 100;

/**
 * @param {object} panel
 * @param {() => number} panel.hz  Cycles per second.
 * @param {() => number} panel.speed  1 is real time.
 * @param {(cycle: number) => void} panel.at  Called with the current cycle.
 * @param {(input: string, from: number, until: number, before: number | null) => boolean} panel.press  Adds a press, or moves its release from `before` to `until`. Returns whether that was possible.
 * @param {() => number} panel.shortest  Minimum cycles of a press.
 */
export function createPlayback({ hz, speed, at, press, shortest }) {
  let frame = 0;
  let last = 0;
  let cycle = 0;
  /** Buttons that are held. @type {Map<string, {from: number, until: number}>} */
  const held = new Map();

  const ahead = () => Math.max(shortest(), Math.round(AHEAD_S * speed() * hz()));

  /** @param {number} now */
  function tick(now) {
    // A hidden tab does not play, so the time since the last frame is limited.
    cycle += (Math.min(MAX_FRAME_MS, now - last) / 1000) * speed() * hz();
    last = now;
    for (const [input, heldPress] of held) {
      if (heldPress.until - cycle < ahead() / 2) {
        const until = Math.round(cycle) + ahead();
        if (press(input, heldPress.from, until, heldPress.until)) heldPress.until = until;
      }
    }
    frame = requestAnimationFrame(tick);
    at(Math.round(cycle));
  }

  /** @param {string} input */
  function up(input) {
    const heldPress = held.get(input);
    if (!heldPress) return;
    held.delete(input);
    press(input, heldPress.from, Math.max(Math.round(cycle), heldPress.from + shortest()), heldPress.until);
  }

  return {
    isOn: () => frame !== 0,
    cycle: () => Math.round(cycle),

    /** @param {number} from */
    play(from) {
      cancelAnimationFrame(frame);
      cycle = from;
      last = performance.now();
      frame = requestAnimationFrame(tick);
    },

    stop() {
      for (const input of [...held.keys()]) up(input);
      cancelAnimationFrame(frame);
      frame = 0;
    },

    /** @param {string} input */
    down(input) {
      if (held.has(input)) return;
      const from = Math.max(1, Math.round(cycle));
      const until = from + ahead();
      if (press(input, from, until, null)) held.set(input, { from, until });
    },

    up,
  };
}
