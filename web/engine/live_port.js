/** A serial port in the worker: reads, writes and closes its streams. */
import { errorMessage } from "../state/error_message.js";

/** Maximum time of a write beyond the line time, in ms. */
const WRITE_MS = 2000;
/** Bits of a byte on the line. */
const BYTE_BITS = 10;

/**
 * The streams of a port.
 * @param {{readable: ReadableStream<Uint8Array>, writable: WritableStream<Uint8Array>}} streams
 * @param {(bytes: Uint8Array) => void | Promise<void>} receive  Called with received bytes; reading continues when its promise resolves.
 * @param {() => void} onChange  Called after received bytes and after the loss of the port.
 */
export function openPort({ readable, writable }, receive, onChange) {
  const reader = readable.getReader();
  const writer = writable.getWriter();
  const port = {
    /** Why the port is lost; empty if it is not. */
    lost: "",
    /** @param {unknown} error */
    lose(error) {
      port.lost ||= errorMessage(error) || "the port is lost";
      onChange();
    },
    /** Bytes to be written. */
    waiting: 0,
    /** @param {Uint8Array} bytes */
    write(bytes) {
      port.waiting += bytes.length;
      const written = writer.write(bytes);
      written.then(() => {
        port.waiting -= bytes.length;
      }, port.lose);
      return written;
    },
    /** Writes, and resolves when the system has accepted it. @param {Uint8Array} bytes @param {number} baud */
    async send(bytes, baud) {
      const timeout = WRITE_MS + (1000 * BYTE_BITS * bytes.length) / baud;
      let timer = 0;
      const late = new Promise((_, reject) => {
        timer = setTimeout(() => reject(new Error("the port accepts no bytes")), timeout);
      });
      await Promise.race([port.write(bytes), late]).catch(port.lose);
      clearTimeout(timer);
    },
    /** Closes the port after the work, even after an error. @param {() => Promise<void>} work */
    async use(work) {
      try {
        await work();
      } finally {
        await port.close();
      }
    },
    async close() {
      const closing = port.lost ? writer.abort() : writer.close();
      const late = new Promise((resolve) => setTimeout(resolve, WRITE_MS));
      await Promise.race([Promise.allSettled([reader.cancel(), closing]), late]);
    },
  };
  const read = async () => {
    for (;;) {
      const { value, done } = await reader.read();
      if (done) throw new Error("the other end closed the port");
      const accepted = receive(value);
      onChange();
      await accepted;
    }
  };
  read().catch(port.lose);
  return port;
}
