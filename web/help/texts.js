/**
 * What the terms mean, and which document each comes from: nothing but text, that loads when the first card is opened.
 * Every term that a field of the form or a view uses stands here; the terms that only one kind of move has stand with
 * that kind in `form/moves/`.
 */

/** @typedef {import("../form/field.js").Term} Term */

/** Where terms come from. @type {{[id: string]: {short: string, title: string}}} */
export const DOCUMENTS = {
  patent: {
    short: "patent RU 2704486, 2019",
    title: "Patent RU 2704486 C1, 2019: tick-by-tick control of several stepper motors over USB (Russian)",
  },
  sonobe: {
    short: "Sonobe 2011",
    title:
      "Y. Sonobe, University of Electro-Communications, 2011: speed control of stepper motors, trapezoidal acceleration by table (slides, Japanese)",
  },
  song: {
    short: "Song, Han, Lu 2021",
    title:
      "Song, Han, Lu: exact S-curve control of a stepper motor. Electric Machines & Control Application 48 (11), 2021, page 27 (Chinese)",
  },
  sine: {
    short: "SWorldJournal, issue 11",
    title:
      "SWorldJournal, issue 11, part 1: sinusoidal motion of a vibration-calibration carriage as a sum of segments of fixed speed (Ukrainian)",
  },
  zhang: {
    short: "Zhang 2012",
    title: "Zhang, 2012: design of a single-axis fixed-length controller for a stepper motor on an ATmega128 (Chinese)",
  },
  sheets: {
    short: "drivers' data sheets",
    title:
      "Data sheets of the drivers: Allegro A4988 (4988-DS), Texas Instruments DRV8825 (SLVSA73), Trinamic TMC2209 (rev. 1.09) and their like",
  },
  own: {
    short: "Stepscope's own",
    title:
      "Stepscope's own: the framed protocol, the line model and the bit-exact link, described in docs/ of the source",
  },
};

/** All but those that stand with the form. @type {{[id: string]: Term}} */
export const COMMON = {
  // An axis and its moves.
  full_step_deg: {
    name: "Full step",
    text: "Angle by which the shaft turns when one winding takes over from the other; 1.8° in most motors.",
    from: "sonobe",
  },
  microsteps: {
    name: "Microsteps",
    text: "Parts into which the driver divides a full step by letting part of the current flow in both windings. One STEP pulse is one microstep; half a step is the 1-2-phase sequence.",
    from: "sonobe",
  },
  radius_mm: {
    name: "Radius",
    text: "Of the wheel, pulley or pitch circle that turns angle into way.",
    from: "sonobe",
  },
  lead_mm: { name: "Lead", text: "Way of the nut in one turn of the screw.", from: "zhang" },
  step_mm: { name: "One step", text: "Way of one step, measured or given.", from: "zhang" },
  motor: {
    name: "Motor",
    text: "What its torque over the rate follows from, by the textbooks' model of a two-phase hybrid motor on a driver that regulates the current. It changes nothing in a run: a move that asks for more torque than there is gets a warning, and the study's tab Torque shows both. It begins as the document's motor.",
    from: "song",
  },
  rated_current_a: {
    name: "Rated current",
    text: "Current of each phase at which the data sheet gives the holding torque, with both phases on.",
    from: "song",
  },
  resistance_ohm: {
    name: "Resistance",
    text: "Of one phase. At low rates the supply has to overcome little more.",
    from: "song",
  },
  inductance_mh: {
    name: "Inductance",
    text: "Of one phase. It keeps the current from following at high rates, so the torque falls there.",
    from: "song",
  },
  holding_torque_mn_m: {
    name: "Holding torque",
    text: "With both phases at the rated current. One phase at its peak has 1/√2 of it. It also tells the back-EMF.",
    from: "song",
  },
  rotor_inertia_g_cm2: {
    name: "Rotor inertia",
    text: "Torque for the acceleration = (rotor + load inertia) × acceleration.",
    from: "song",
  },
  supply_v: {
    name: "Supply",
    text: "Voltage of the driver's supply. The higher it is, the higher the rate up to which the driver holds its current.",
    from: "own",
  },
  peak_current_a: {
    name: "Peak current",
    text: "Amplitude of the phase currents that the driver regulates; √2 times the rated current heats the motor as much as the rated current in both phases does.",
    from: "own",
  },
  load_inertia_g_cm2: {
    name: "Load inertia",
    text: "Of all that turns with the rotor, seen from its shaft; behind a gear of n : 1 divided by n².",
    from: "own",
  },
  load_torque_mn_m: {
    name: "Load torque",
    text: "What opposes the motion: friction, cutting. It helps when slowing down.",
    from: "own",
  },
  working_rate_hz: {
    name: "Working rate",
    text: "Highest rate at which the motor is known to work with its load, f_s. The document states 19200 Hz for its motor and does not derive it.",
    from: "song",
  },
  distance: { name: "Distance", text: "How far the move goes. It is rounded to whole steps: a motor cannot do less." },
  duration_s: { name: "Duration", text: "Time from the start of the move to its end." },
  start_speed: {
    name: "Start speed",
    text: "Rate of the first step, v0 or f_1. A motor can jump to it from standing still, up to its start-stop rate.",
    from: "sonobe",
  },
  top_speed: {
    name: "Top speed",
    text: "Rate of the plateau between the ramps, f_s. Above the pull-out rate for its load a motor loses steps.",
    from: "zhang",
  },
  acceleration: {
    name: "Acceleration",
    text: "How much the speed grows in a second. The motor's torque less the load's, divided by the inertia, is the most it can be.",
    from: "sonobe",
  },
  engine: {
    name: "Steps made by",
    text: "With ticks the host says how many steps each tick has, as in the patent. With segments the controller runs the move alone, from a table of intervals, as in the other documents.",
    from: "patent",
  },
  // What is sent.
  packets: {
    name: "Packet",
    text: "What the host sends for one tick: a byte a motor, bit 7 the direction, bits 6 to 0 the number of steps.",
    from: "patent",
  },
  start_cycle: { name: "Start", text: "Cycle of the controller's clock, counted from reset, in which this begins." },
  bytes: {
    name: "Bytes",
    text: "What goes over the line, each byte as a start bit, eight data bits with the lowest first, and a stop bit.",
  },
  frame: {
    name: "Frame",
    text: "Address, kind and body between two zero bytes, with a checksum. COBS takes the zeros out of the inside, so that an end can always be found again.",
    from: "own",
  },
  segments: {
    name: "Segment",
    text: "So many steps at intervals that grow by a constant. An acceleration table with one reload a step is a list of segments of one step.",
    from: "sonobe",
  },
  // The line.
  baud: { name: "Bit rate", text: "Bits a second on the line; a byte takes ten of them.", from: "patent" },
  receiver_baud: {
    name: "Receiver's rate",
    text: "Two clocks never agree. When the receiver's bits are some 5 % longer or shorter, it looks for the stop bit in the wrong place.",
    from: "own",
  },
  protocol: {
    name: "Protocol",
    text: "Raw packets carry no check: one flipped bit moves a motor, and nobody notices. Frames are checked, answered and sent again until they are answered.",
    from: "patent",
  },
  address: {
    name: "Address",
    text: "Number of a controller on a line that several share. All hear everything; each takes what begins with its own number or with 255.",
    from: "patent",
  },
  ticks_per_frame: {
    name: "Ticks in a frame",
    text: "More ticks in a frame leave more time for its reply, and need a deeper queue.",
    from: "own",
  },
  reply_timeout_cycles: {
    name: "Reply time-out",
    text: "When no whole reply has come by then, the frame is sent again with the same seq, so that nothing is done twice.",
    from: "own",
  },
  attempts: {
    name: "Attempts",
    text: "After so many without an answer the host gives the controller up.",
    from: "own",
  },
  seed: {
    name: "Seed",
    text: "Where the random numbers of the noise begin: chance that can be repeated exactly, on any machine.",
    from: "own",
  },
  flipped_bits_ppm: {
    name: "Bits flipped",
    text: "A 0 is heard as a 1 or the other way round, as by a disturbance near the cable.",
    from: "own",
  },
  lost_bytes_ppm: { name: "Bytes lost", text: "A byte that never arrives, as when a buffer runs over.", from: "own" },
  duplicated_bytes_ppm: {
    name: "Bytes duplicated",
    text: "A byte that arrives twice, as after a clumsy repetition in a converter.",
    from: "own",
  },
  glitches_ppm: {
    name: "Glitches",
    text: "Short wrong levels on the line. One of less than half a bit is not taken for a start bit.",
    from: "own",
  },
  lost_replies_ppm: {
    name: "Replies lost",
    text: "The controller has done it but the host does not hear so: the case for which frames have a seq.",
    from: "own",
  },
  host_crashes_ppm: {
    name: "Host crashes",
    text: "The program that sends crashes in the middle of a frame and starts again: the next frames must not be harmed by the first half.",
    from: "own",
  },
  length_cycles: { name: "Length", text: "For how many cycles the line is forced.", from: "own" },
  forced_level: {
    name: "Level",
    text: "The level that the line has meanwhile. A long 0 is a break: no stop bit comes, and the receiver reports a framing error.",
    from: "own",
  },
  // The bus.
  channels: {
    name: "Channel",
    text: "One motor's driver with its STEP and DIR lines. EN is one line for all of them.",
    from: "patent",
  },
  slots: {
    name: "Slot",
    text: "A tick is divided into slots. A channel makes at most one step in each, so the number of slots limits the steps of a tick.",
    from: "patent",
  },
  step_period_cycles: {
    name: "Length of a slot",
    text: "Step period T_s: no channel steps faster than once in it.",
    from: "patent",
  },
  pulse_width_cycles: {
    name: "STEP high",
    text: "How long a step pulse lasts. A driver overlooks pulses shorter than its data sheet asks for.",
    from: "sheets",
  },
  dir_setup_cycles: {
    name: "DIR set-up",
    text: "DIR has to stand for some time before STEP rises, or the driver may step the old way.",
    from: "sheets",
  },
  dir_hold_cycles: { name: "DIR hold", text: "DIR has to stand for some time after a step, too.", from: "sheets" },
  distribution: {
    name: "Burst and spread",
    text: "Burst: the steps of a tick are made in its first slots, then there is a pause, as in the patent. Spread: they are spaced evenly over the tick, which the motor feels as a smoother speed.",
    from: "patent",
  },
  dir_line: {
    name: "DIR lines",
    text: "One DIR line for all motors saves wires: within each slot DIR goes low, the ones to the left step, DIR goes high, the others step. Five cycles are enough.",
    from: "patent",
  },
  pulse_phasing: {
    name: "Pulses of a slot",
    text: "Motors that step in the same instant all draw their peak of current at once. One after another the supply's peaks fall to a half or a third.",
    from: "patent",
  },
  settle_cycles: {
    name: "Current settles (dp)",
    text: "The patent's Δt_p: time that the supply current needs to settle after a step. Staggered pulses are this far apart, or as far as the slot has room for.",
    from: "patent",
  },
  queue_depth: {
    name: "Queue",
    text: "Ticks that wait in the controller, so that motion goes on while the host is busy. When it is empty in the middle of a motion, that is an underrun.",
    from: "patent",
  },
  boot_cycles: {
    name: "Self-test",
    text: "After reset the controller checks itself and is busy; what is sent meanwhile is dropped.",
    from: "patent",
  },
  // Rules of a driver.
  step_high_ns: { name: "STEP high", text: "From the rise of STEP to its fall.", from: "sheets" },
  step_low_ns: { name: "STEP low", text: "From the fall of STEP to its next rise.", from: "sheets" },
  dir_setup_ns: { name: "DIR set-up", text: "From the last change of DIR to the rise of STEP.", from: "sheets" },
  dir_hold_ns: { name: "DIR hold", text: "From the rise of STEP to the next change of DIR.", from: "sheets" },
  enable_wake_ns: { name: "EN wake-up", text: "From the rise of EN, or reset, to the first step.", from: "sheets" },
  // What is looked at.
  axis: { name: "Axis", text: "Which axis the spectrum is taken of; axis 0 drives channel 0." },
  order: { name: "Order", text: "Up to which harmonic the distortion is summed.", from: "sine" },
  fft_length: {
    name: "Samples",
    text: "Points at which one period is looked at for the transform; they fill the period, so nothing leaks, whatever their number.",
    from: "sine",
  },
  sensor_hz: {
    name: "Sensor's bandwidth",
    text: "An accelerometer is a low pass: at this frequency it feels 71 % of the acceleration, |H| = 1/√(1 + (f/f_b)²). So the distortion it feels does not grow with the order.",
    from: "own",
  },
  clock_hz: {
    name: "Clock",
    text: "All that the controller does happens on a beat of this clock; one beat is a cycle, and times are counted in whole cycles.",
    from: "patent",
  },
  run_cycles: {
    name: "Length of the run",
    text: "When to stop looking. By itself a run ends when nothing can change any more.",
  },
  title: { name: "Name", text: "A name for the experiment, that travels with its link." },
  note: { name: "Note", text: "What to look at, for whom you send the link to." },
  // What follows from the scenario.
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
    text: "Segments are run by the controller itself: nothing is sent.",
    from: "sonobe",
  },
};

/**
 * What each view uses, explained behind its heading.
 * @type {{[view: string]: {about: string, terms: {[id: string]: Term}}}}
 */
export const VIEWS = {
  motion: {
    about: "Position, speed and acceleration of one axis.",
    terms: {
      ideal: { name: "Ideal", text: "The curve that was asked for." },
      made: {
        name: "Made by the pulses",
        text: "What the STEP pulses really make of it: whole steps, at whole cycles.",
      },
      step: { name: "Step", text: "The least move of a motor: one STEP pulse, one microstep.", from: "sonobe" },
      jerk: {
        name: "Jerk",
        text: "How fast acceleration changes. A jump of it shakes the machine; S-curves have none.",
        from: "song",
      },
    },
  },
  pulses: {
    about: "All signals between controller, drivers and line, exact to the cycle.",
    terms: {
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
  },
  packets: {
    about: "What went over the line, and what the controller did with it.",
    terms: {
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
    },
  },
  spectrum: {
    about: "Which frequencies the motion is made of.",
    terms: {
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
  },
  timing: {
    about: "Could the driver have followed? Each rule of its data sheet against the pulses.",
    terms: {
      least: { name: "Least", text: "The shortest time that was found.", from: "sheets" },
      required: { name: "Required", text: "The least that the data sheet asks for.", from: "sheets" },
      slack: {
        name: "Slack",
        text: "By how much the shortest time is longer than required; below 0 the rule is broken.",
        from: "sheets",
      },
    },
  },
  study: {
    about:
      "Which profile, stored how, for this motor? The questions that a design begins with, for the looked-at axis.",
    terms: {
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
  },
};
