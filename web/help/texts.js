/**
 * What the terms mean that no field of the scenario has: of what follows from it, and of the views. Nothing but text,
 * that loads when the first card of one of them is opened. All other terms stand with their fields in the schema.
 */

/** @typedef {import("../form/field.js").Term} Term */

/** Of what follows from the scenario. @type {{[id: string]: Term}} */
export const DERIVED = {
  duration: { name: "Duration", text: "From reset to the end of the run." },
  peak_rate: {
    name: "Peak rate",
    text: "The highest rate that a motion asks for: steps in a second, in the documents also pps or Hz.",
    from: "song",
  },
  tick: {
    name: "Tick",
    text: "The beat of the patent's control: every tick each motor is told how many steps to make in it, and which way. It lasts slots × slot.",
    from: "patent",
  },
  limit: {
    name: "Limit of the bus",
    text: "One step in every slot: faster the controller cannot make them.",
    from: "patent",
  },
  rate_of_packets: {
    name: "Packets",
    text: "Packets a second on the line; one packet orders one tick of one controller.",
    from: "patent",
  },
  line_load: {
    name: "Line load",
    text: "Part of the time that the line is busy. Above 100 % the packets of a tick take longer than the tick.",
    from: "patent",
  },
  on_the_line: {
    name: "On the line",
    text: "A controller that runs segments, or a program of its own, needs nobody: nothing is sent.",
    from: "sonobe",
  },
};

/** What the words of each view mean. @type {{[view: string]: {[id: string]: Term}}} */
export const TERMS = {
  motion: {
    ideal: { name: "Ideal", text: "The curve that was asked for." },
    made: {
      name: "From pulses",
      text: "What the STEP pulses really make of it: whole steps, at whole cycles.",
    },
    step: { name: "Step", text: "The least move of a motor: one STEP pulse, one microstep.", from: "sonobe" },
    jerk: {
      name: "Jerk",
      text: "How fast acceleration changes. A jump of it shakes the machine; S-curves have none.",
      from: "song",
    },
  },
  panel: {
    display: {
      name: "Display",
      text: "The position in units of length, six digits; dashes where they do not hold it. While numbers are changed it shows the entry, or the value.",
      from: "zhang",
    },
    led: {
      name: "LED",
      text: "It is on where the controller rests and is sure of its place, blinks quickly in an alarm, and slowly else.",
      from: "zhang",
    },
    hold: {
      name: "Hold",
      text: "How long a press at the cursor lasts. It has to stand through the debouncing, or it is not seen.",
      from: "own",
    },
    live: {
      name: "Live",
      text: "The cursor goes on with the clock, or ten or a hundred times slower, and a button is pressed as long as it is held. Each press is kept with its cycle: the run is the same whenever it is made again.",
      from: "own",
    },
    believed: {
      name: "Believed place",
      text: "The mark over the nut: where the controller takes it to be since zero was set. Apart from the nut, steps were lost at an end, or a hand moved the axis.",
      from: "own",
    },
    ignored: {
      name: "Presses that meant nothing",
      text: "A button that has no meaning in a state does nothing there. The cross on its row says where.",
      from: "own",
    },
  },
  pulses: {
    step_dir_en: {
      name: "STEP, DIR, EN",
      text: "A rise of STEP is one step; DIR says which way (high is right); EN high powers the windings.",
      from: "patent",
    },
    rx_tx_de: {
      name: "RX, TX, DE",
      text: "What the controller hears, what it answers, and when its RS-485 transceiver drives the line.",
      from: "own",
    },
    cycle: { name: "Cycle", text: "One beat of the controller's clock: 62.5 ns at 16 MHz.", from: "patent" },
    interval: {
      name: "Step interval",
      text: "Time from one rise of STEP to the next; one over it is the rate.",
      from: "sonobe",
    },
    bit_time: {
      name: "B, bit time",
      text: "Length of one bit in whole cycles, as the receiver counts it: clock / bit rate.",
      from: "own",
    },
    digest: {
      name: "Digest",
      text: "A fingerprint of all edges of a run (XXH64). Two runs with the same digest have every edge in the same cycle, whoever computed them.",
      from: "own",
    },
  },
  motor: {
    following_error: {
      name: "Following error",
      text: "How far the rotor is behind what it is told, in full steps. Beyond two of them the field pulls it to another place.",
      from: "own",
    },
    slip: {
      name: "Slip",
      text: "The rotor falls out of step and catches again four full steps away: those are lost, and nothing tells the controller.",
      from: "own",
    },
    start_stop: {
      name: "Start-stop rate",
      text: "The highest rate at which the motor starts and stops at once, with its load, without losing a step.",
      from: "own",
    },
    pull_out: {
      name: "Pull-out rate",
      text: "The highest rate to which a ramp brings the motor before it falls out of step.",
      from: "own",
    },
    settling_current: {
      name: "Δt_p",
      text: "How long the supply current takes after a step until it has fallen to a fifth of its peak: motors that step so far apart do not add up.",
      from: "patent",
    },
  },
  packets: {
    framing: {
      name: "Framing error",
      text: "No stop bit where one is due: the byte is dropped. Raw packets are then ignored until the line has been quiet for 45 bit times.",
      from: "own",
    },
    gap: {
      name: "Gap",
      text: "Raw packets are told apart by pauses: after 45 bit times of silence the next byte begins a packet.",
      from: "patent",
    },
    seq: {
      name: "seq",
      text: "Number of a TICKS frame. One that comes again with the same number is acknowledged and not done twice.",
      from: "own",
    },
    crc: {
      name: "CRC",
      text: "Checksum of a frame, 32 bits (Castagnoli): a frame with any one bit wrong is never taken.",
      from: "own",
    },
    ack: { name: "ACK and NAK", text: "The controller's answers: done, or refused and why.", from: "own" },
    underrun: {
      name: "Underrun",
      text: "The queue was empty although the last tick had steps: the motors stood still in the middle of a motion.",
      from: "own",
    },
    device: {
      name: "Device",
      text: "The experiment goes to a real controller on a serial port, or the page is one for a host. Its replies stand here as they come, each with its delay beside the model's; “Model” shows the run's packets again.",
      from: "own",
    },
    lead: {
      name: "Lead",
      text: "Packets that nobody answers are sent 200 ms ahead, for a page is late at times: the queue keeps them. After a stop the controller still does what is in it.",
      from: "own",
    },
  },
  spectrum: {
    harmonic: {
      name: "Harmonic",
      text: "Part of the motion at a whole multiple of its own frequency, the fundamental. A pure sine has none but the first.",
      from: "sine",
    },
    thd: {
      name: "THD",
      text: "Total harmonic distortion: root of the sum of squares of harmonics 2 to the order given, divided by the fundamental.",
      from: "sine",
    },
    db: { name: "dB", text: "20 times the logarithm of the part: −20 dB is a tenth, −40 dB a hundredth." },
    window: { name: "Window", text: "None: whole periods are taken, so every line falls on its own place." },
  },
  timing: {
    least: { name: "Least", text: "The shortest time that was found.", from: "sheets" },
    required: { name: "Required", text: "The least that the data sheet asks for.", from: "sheets" },
    slack: {
      name: "Slack",
      text: "By how much the shortest time is longer than required; below 0 the rule is broken.",
      from: "sheets",
    },
  },
  study: {
    exact_list: {
      name: "Exact list",
      text: "Every step in its cycle. Steps whose intervals differ by a constant share an entry.",
      from: "own",
    },
    compressed: {
      name: "Compressed list",
      text: "Few entries, each for many steps, none of which is off by more than the error that is allowed.",
      from: "own",
    },
    ev: {
      name: "Ev",
      text: "Euclidean distance: root of the sum of squares of what lies between the segments and the sine, over a quarter's 512 points.",
      from: "sine",
    },
  },
};
