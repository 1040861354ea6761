/** Requests to a worker that wait for their replies. */

export class PendingRequests {
  #next = 0;
  /** @type {Map<number, {resolve: (value: any) => void, reject: (error: Error) => void}>} */
  #requests = new Map();

  /** Sends a request with a new number; the promise has its reply. @param {(id: number) => void} send @returns {Promise<any>} */
  add(send) {
    const id = this.#next++;
    return new Promise((resolve, reject) => {
      this.#requests.set(id, { resolve, reject });
      send(id);
    });
  }

  /** Resolves or rejects the request of a reply: `{id, value}` or `{id, error}`, with further properties of the error. @param {any} reply */
  settle({ id, value, error, ...properties }) {
    const request = this.#requests.get(id);
    this.#requests.delete(id);
    if (error === undefined) request?.resolve(value);
    else request?.reject(Object.assign(new Error(error), properties));
  }

  /** Rejects all requests. @param {Error} error */
  rejectAll(error) {
    const requests = [...this.#requests.values()];
    this.#requests.clear();
    for (const { reject } of requests) reject(error);
  }
}
