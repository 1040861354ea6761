/** What the host can send, as the form says it under the choice. */

/** @typedef {import("./field.js").Term} Term */

/** @type {{[id: string]: Term}} */
export const SOURCE_TERMS = {
  motion: {
    name: "Motion of axes",
    text: "Moves in steps, mm or degrees, that the host divides into ticks or segments.",
  },
  packets_in_hex: { name: "Packets in hex", text: "The packets themselves, one a tick.", from: "patent" },
  line_script: {
    name: "Line script",
    text: "Bytes at cycles: what was recorded of a real line can be replayed.",
    from: "own",
  },
  lists_of_segments: {
    name: "Lists of segments",
    text: "Tables that a controller runs by itself; nothing is sent.",
    from: "sonobe",
  },
};
