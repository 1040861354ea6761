/** Requests of which only the newest matters, such as those of a moving pointer. */

/** The error of a request that was replaced by a newer one, or whose worker ended. */
export class Dropped extends Error {}

/** @typedef {{method: string, args: any[], resolve: (value: any) => void, reject: (error: Error) => void}} Waiting */

export class RequestSlots {
  /** @type {Map<string, {busy: boolean, waiting: Waiting | null}>} */
  #slots = new Map();
  #send;

  /** @param {(method: string, args: any[]) => Promise<any>} send */
  constructor(send) {
    this.#send = send;
  }

  /**
   * Sends the request when the slot is free. If a newer one arrives first, it is rejected with `Dropped`.
   * @param {string} slot @param {string} method @param {any[]} args
   * @returns {Promise<any>}
   */
  latest(slot, method, args) {
    const state = this.#slots.get(slot) ?? { busy: false, waiting: null };
    this.#slots.set(slot, state);
    return new Promise((resolve, reject) => {
      state.waiting?.reject(new Dropped(slot));
      state.waiting = { method, args, resolve, reject };
      if (!state.busy) this.#pump(slot);
    });
  }

  /** @param {string} slot */
  async #pump(slot) {
    const state = this.#slots.get(slot);
    if (!state?.waiting) return;
    const { method, args, resolve, reject } = state.waiting;
    state.waiting = null;
    state.busy = true;
    try {
      resolve(await this.#send(method, args));
    } catch (error) {
      reject(/** @type {Error} */ (error));
    }
    state.busy = false;
    this.#pump(slot);
  }
}
