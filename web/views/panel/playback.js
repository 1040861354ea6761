/** Live mode of a panel: the cursor follows the clock, and held buttons become inputs. */

/** A release that is to come stands so far ahead, in s of a person's time. */
const AHEAD_S = 1;

/**
 * @param {object} given
 * @param {() => number} given.hz  Cycles a second.
 * @param {() => number} given.speed  1 is real time.
 * @param {(cycle: number) => void} given.at  Hears where it is.
 * @param {(input: string, from: number, until: number, before: number | null) => boolean} given.press  Puts a press, or moves the release of one that was put; whether it could.
 * @param {() => number} given.shortest  Cycles that a press lasts at least.
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
    // A tab that was away has not been played.
    cycle += (Math.min(100, now - last) / 1000) * speed() * hz();
    last = now;
    for (const [input, one] of held) {
      if (one.until - cycle < ahead() / 2) {
        const until = Math.round(cycle) + ahead();
        if (press(input, one.from, until, one.until)) one.until = until;
      }
    }
    frame = requestAnimationFrame(tick);
    at(Math.round(cycle));
  }

  /** @param {string} input */
  function up(input) {
    const one = held.get(input);
    if (!one) return;
    held.delete(input);
    press(input, one.from, Math.max(Math.round(cycle), one.from + shortest()), one.until);
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
