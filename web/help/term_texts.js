/** Help texts of derived values and views. The schema has the texts of fields. */

/** @typedef {import("../form/field.js").Term} Term */

/** Of derived values. @type {{[id: string]: Term}} */
export const DERIVED = {
  duration: { name: "Duration", text: "Time from reset to the end of the run." },
  peak_rate: {
    name: "Peak rate",
    text: "Highest step rate of the motion, in steps per second (pps, Hz).",
    from: "song",
  },
  tick: {
    name: "Tick",
    text: "Control interval: each packet has the number of steps and the direction of each motor for one tick. A tick lasts slots × slot.",
    from: "patent",
  },
  limit: {
    name: "Max step rate",
    text: "Highest step rate of the bus: one step per slot.",
    from: "patent",
  },
  rate_of_packets: {
    name: "Packets",
    text: "Packets per second on the line. One packet holds one tick of one controller.",
    from: "patent",
  },
  line_load: {
    name: "Line load",
    text: "Percentage of time that the line is busy. Above 100 % the packets of a tick take longer than the tick.",
    from: "patent",
  },
  on_the_line: {
    name: "On the line",
    text: "Nothing is sent: the controller runs segments or its own program.",
    from: "sonobe",
  },
};

/** Terms of each view. @type {{[view: string]: {[id: string]: Term}}} */
export const TERMS = {
  motion: {
    ideal: { name: "Ideal", text: "The requested curve." },
    actual: { name: "Actual", text: "The motion of the STEP pulses: whole steps at whole cycles." },
    step: { name: "Step", text: "One STEP pulse moves the motor by one microstep.", from: "sonobe" },
    jerk: {
      name: "Jerk",
      text: "Change of acceleration per second. A jump of acceleration makes the machine vibrate.",
      from: "song",
    },
  },
  panel: {
    display: {
      name: "Display",
      text: "Position in units of length, six digits. Dashes if it does not fit. While you edit numbers it shows the entry.",
      from: "zhang",
    },
    led: {
      name: "LED",
      text: "On: idle with a confirmed position. Fast blinking: alarm. Slow blinking: any other state.",
      from: "zhang",
    },
    hold: {
      name: "Hold",
      text: "Length of a press at the cursor. It must be longer than the debounce time.",
      from: "own",
    },
    live: {
      name: "Live",
      text: "The cursor moves in real time, or 10 or 100 times slower, and buttons react while you hold them. Each press is saved with its cycle, so the run can be repeated exactly.",
      from: "own",
    },
    believed: {
      name: "Controller position",
      text: "Mark above the nut: the position that the controller assumes. It differs from the nut if steps were lost at a hard stop or a hand moved the axis.",
      from: "own",
    },
    ignored: {
      name: "Ignored presses",
      text: "A cross marks a press that has no effect in the current state.",
      from: "own",
    },
  },
  pulses: {
    step_dir_en: {
      name: "STEP, DIR, EN",
      text: "A rising edge of STEP is one step. DIR is the direction (high is right). EN high powers the windings.",
      from: "patent",
    },
    rx_tx_de: {
      name: "RX, TX, DE",
      text: "Received bytes, sent bytes, and driver enable of the RS-485 transceiver.",
      from: "own",
    },
    cycle: { name: "Cycle", text: "One period of the controller clock: 62.5 ns at 16 MHz.", from: "patent" },
    interval: {
      name: "Step interval",
      text: "Time from one rising edge of STEP to the next. Its reciprocal is the step rate.",
      from: "sonobe",
    },
    bit_time: {
      name: "B, bit time",
      text: "Length of one bit in whole cycles of the receiver: clock / bit rate.",
      from: "own",
    },
    digest: {
      name: "Digest",
      text: "Hash of all edges of a run (XXH64). Two runs with the same digest have every edge in the same cycle.",
      from: "own",
    },
  },
  motor: {
    following_error: {
      name: "Following error",
      text: "Distance of the rotor from its commanded position, in full steps. Beyond two full steps the motor loses steps.",
      from: "own",
    },
    slip: {
      name: "Slip",
      text: "The rotor loses synchronism and settles four full steps away. The controller cannot detect it.",
      from: "own",
    },
    start_stop: {
      name: "Start-stop rate",
      text: "Highest rate at which the motor can start and stop its load without a ramp and without losing steps.",
      from: "own",
    },
    pull_out: {
      name: "Pull-out rate",
      text: "Highest rate that the motor reaches with a ramp before it stalls.",
      from: "own",
    },
    settling_current: {
      name: "Δt_p",
      text: "Time from a step until the supply current falls to a fifth of its peak. The peaks of motors with this spacing do not add up.",
      from: "patent",
    },
  },
  packets: {
    framing: {
      name: "Framing error",
      text: "The stop bit is missing, so the byte is dropped. Raw packets are then ignored until the line is idle for 45 bit times.",
      from: "own",
    },
    gap: {
      name: "Gap",
      text: "A pause of 45 bit times separates raw packets.",
      from: "patent",
    },
    seq: {
      name: "seq",
      text: "Sequence number of a TICKS frame. A repeated frame with the same number is acknowledged but not executed again.",
      from: "own",
    },
    crc: {
      name: "CRC",
      text: "32-bit checksum of a frame (Castagnoli). It detects every single-bit error.",
      from: "own",
    },
    ack: { name: "ACK and NAK", text: "Replies of the controller: accepted, or rejected with a reason.", from: "own" },
    underrun: {
      name: "Underrun",
      text: "The queue was empty during a motion, so the motors stopped.",
      from: "own",
    },
    device: {
      name: "Device",
      text: "Sends the experiment to a real controller on a serial port, or replies to a host. The table shows each reply with its delay and the delay of the model. “Model” returns to the packets of the run.",
      from: "own",
    },
    lead: {
      name: "Lead",
      text: "Raw packets are sent 200 ms ahead because a page can be late. After a stop the controller still executes its queue.",
      from: "own",
    },
  },
  spectrum: {
    harmonic: {
      name: "Harmonic",
      text: "Component of the motion at a multiple of its fundamental frequency. A pure sine has only the first.",
      from: "sine",
    },
    thd: {
      name: "THD",
      text: "Total harmonic distortion: root of the sum of squares of harmonics 2 to the given order, divided by the fundamental.",
      from: "sine",
    },
    db: { name: "dB", text: "20 times the logarithm of the ratio: −20 dB is a tenth, −40 dB a hundredth." },
    window: { name: "Window", text: "None. The spectrum uses whole periods, so there is no leakage." },
  },
  timing: {
    least: { name: "Shortest", text: "The shortest measured time.", from: "sheets" },
    required: { name: "Required", text: "Minimum time in the data sheet.", from: "sheets" },
    slack: {
      name: "Slack",
      text: "Shortest measured time minus the required time. Below 0 the rule is violated.",
      from: "sheets",
    },
  },
  study: {
    exact_list: {
      name: "Exact list",
      text: "Every step in its exact cycle. Steps whose intervals change by a constant share an entry.",
      from: "own",
    },
    compressed: {
      name: "Compressed list",
      text: "Few entries for many steps. No step exceeds the allowed error.",
      from: "own",
    },
    ev: {
      name: "Ev",
      text: "Euclidean distance: root of the sum of squares of the differences between segments and sine, at 512 points of a quarter.",
      from: "sine",
    },
  },
};
