/** What the terms of a scenario's fields mean: written from the schema by its test, STEPSCOPE_BLESS=1. */
/** @type {{[id: string]: [string, string]}}  The card's head and its text. */
export const EXPLAINED = {
  "Analysis.axis": ["Axis", "Which axis the spectrum is taken of; axis 0 drives channel 0."],
  "Analysis.fft_length": [
    "Samples",
    "Points at which one period is looked at for the transform; they fill the period, so nothing leaks, whatever their number.",
  ],
  "Analysis.order": ["Order", "Up to which harmonic the distortion is summed."],
  "Analysis.sensor_hz": [
    "Sensor's bandwidth",
    "An accelerometer is a low pass: at this frequency it feels 71 % of the acceleration, |H| = 1/√(1 + (f/f_b)²). So the distortion it feels does not grow with the order.",
  ],
  "Axis.motor": [
    "Motor",
    "What its torque-speed curve follows from, by the textbooks' model of a two-phase hybrid motor on a driver that regulates the current. It changes nothing in a run: a move that asks for more torque than there is gets a warning, and the study's tab Torque shows both. It begins as the document's motor.",
  ],
  "Bus.boot_cycles": [
    "Self-test",
    "After reset the controller checks itself and is busy; what is sent meanwhile is dropped.",
  ],
  "Bus.channels": ["Channel", "One motor's driver with its STEP and DIR lines. EN is one line for all of them."],
  "Bus.dir_hold_cycles": ["DIR hold", "DIR has to stand for some time after a step, too."],
  "Bus.dir_line": [
    "DIR lines",
    "One DIR line for all motors saves wires: within each slot DIR goes low, the ones to the left step, DIR goes high, the others step. Five cycles are enough.",
  ],
  "Bus.dir_setup_cycles": [
    "DIR set-up",
    "DIR has to stand for some time before STEP rises, or the driver may step the old way.",
  ],
  "Bus.distribution": [
    "Burst and spread",
    "Burst: the steps of a tick are made in its first slots, then there is a pause, as in the patent. Spread: they are spaced evenly over the tick, which the motor feels as a smoother speed.",
  ],
  "Bus.pulse_phasing": [
    "Pulses of a slot",
    "Motors that step in the same instant all draw their peak of current at once. One after another the supply's peaks fall to a half or a third.",
  ],
  "Bus.pulse_width_cycles": [
    "STEP high",
    "How long a step pulse lasts. A driver overlooks pulses shorter than its data sheet asks for.",
  ],
  "Bus.queue_depth": [
    "Queue",
    "Ticks that wait in the controller, so that motion goes on while the host is busy. When it is empty in the middle of a motion, that is an underrun.",
  ],
  "Bus.settle_cycles": [
    "Current settles (dp)",
    "The patent's Δt_p: time that the supply current needs to settle after a step. Staggered pulses are this far apart, or as far as the slot has room for.",
  ],
  "Bus.slots": [
    "Slot",
    "A tick is divided into slots. A channel makes at most one step in each, so the number of slots limits the steps of a tick.",
  ],
  "Bus.step_period_cycles": ["Length of a slot", "Step period T_s: no channel steps faster than once in it."],
  "ChannelSegments.segments": [
    "Segment",
    "So many steps at intervals that grow by a constant. An acceleration table with one reload a step is a list of segments of one step.",
  ],
  "ChannelSegments.start_cycle": [
    "Start",
    "Cycle of the controller's clock, counted from reset, in which this begins.",
  ],
  "Constant.distance": ["Distance", "How far the move goes. It is rounded to whole steps: a motor cannot do less."],
  "Constant.speed": ["Speed", "Rate of all steps of the move."],
  "Controller.address": [
    "Address",
    "Number of a controller on a line that several share. All hear everything; each takes what begins with its own number or with 255.",
  ],
  "Controller.packets": [
    "Packet",
    "What the host sends for one tick: a byte a motor, bit 7 the direction, bits 6 to 0 the number of steps.",
  ],
  "Controller.receiver_baud": [
    "Receiver's rate",
    "Two clocks never agree. When the receiver's bits are some 5 % longer or shorter, it looks for the stop bit in the wrong place.",
  ],
  "Cosine.distance": ["Distance", "How far the move goes. It is rounded to whole steps: a motor cannot do less."],
  "Cosine.duration_s": ["Duration", "Time from the start of the move to its end."],
  "Cosine.method": [
    "Step times",
    "A small controller looks at the curve once a slice and makes whole steps in it: too few, so the document asks for more steps than there are until the sum is right, and then shortens the plateau. The move ends early by that, up to 0.8 % in the document. Exact times have no such error.",
  ],
  "Cosine.ramp_s": [
    "Ramp",
    "Time t_s in which speed rises to its peak, and again falls from it. Peak rate = steps / (duration − ramp): a longer ramp is gentler but needs a higher peak.",
  ],
  "Cosine.slice_s": [
    "Slice",
    "Time TS for which the document's controller keeps a rate, 1 ms there. Each slice has the whole steps of the rate at its start.",
  ],
  "Direct.step_mm": ["One step", "Way of one step, measured or given."],
  "Dwell.duration_s": ["Duration", "Time from the start of the move to its end."],
  "Eeprom.hold_up_cycles": [
    "Hold-up",
    "When the supply fails, the motors are switched off at once and a capacitor feeds the controller for so long. A record in memory takes 16 bytes: with 17 byte times less one cycle it is written for sure.",
  ],
  "Glitch.length_cycles": ["Length", "For how many cycles the line is forced."],
  "Glitch.level": [
    "Level",
    "The level that the line has meanwhile. A long 0 is a break: no stop bit comes, and the receiver reports a framing error.",
  ],
  "Glitch.start_cycle": ["Start", "Cycle of the controller's clock, counted from reset, in which this begins."],
  "Host.attempts": ["Attempts", "After so many without an answer the host gives the controller up."],
  "Host.reply_timeout_cycles": [
    "Reply time-out",
    "When no whole reply has come by then, the frame is sent again with the same seq, so that nothing is done twice.",
  ],
  "Host.ticks_per_frame": [
    "Ticks in a frame",
    "More ticks in a frame leave more time for its reply, and need a deeper queue.",
  ],
  "JerkLimited.distance": ["Distance", "How far the move goes. It is rounded to whole steps: a motor cannot do less."],
  "JerkLimited.max_acceleration": [
    "Greatest acceleration",
    "The acceleration never passes this; a short move may not reach it.",
  ],
  "JerkLimited.max_jerk": [
    "Greatest jerk",
    "How much the acceleration changes in a second, at most. An infinite jerk would be a trapezoid.",
  ],
  "JerkLimited.max_speed": ["Greatest speed", "Speed of the plateau, where the move is long enough to have one."],
  "Line.address": [
    "Address",
    "Number of a controller on a line that several share. All hear everything; each takes what begins with its own number or with 255.",
  ],
  "Line.baud": ["Bit rate", "Bits a second on the line; a byte takes ten of them."],
  "Line.protocol": [
    "Protocol",
    "Raw packets carry no check: one flipped bit moves a motor, and nobody notices. Frames are checked, answered and sent again until they are answered.",
  ],
  "Line.receiver_baud": [
    "Receiver's rate",
    "Two clocks never agree. When the receiver's bits are some 5 % longer or shorter, it looks for the stop bit in the wrong place.",
  ],
  "Motion.engine": [
    "Step generation",
    "With ticks the host says how many steps each tick has, as in the patent. With segments the controller runs the move alone, from a table of intervals, as in the other documents.",
  ],
  "Motor.holding_torque_mn_m": [
    "Holding torque",
    "With both phases at the rated current. One phase at its peak has 1/√2 of it. It also tells the back-EMF.",
  ],
  "Motor.inductance_mh": [
    "Inductance",
    "Of one phase. It keeps the current from following at high rates, so the torque falls there.",
  ],
  "Motor.load_inertia_g_cm2": [
    "Load inertia",
    "Of all that turns with the rotor, seen from its shaft; behind a gear of n : 1 divided by n².",
  ],
  "Motor.load_torque_mn_m": ["Load torque", "What opposes the motion: friction, cutting. It helps when slowing down."],
  "Motor.peak_current_a": [
    "Peak current",
    "Amplitude of the phase currents that the driver regulates; √2 times the rated current heats the motor as much as the rated current in both phases does.",
  ],
  "Motor.rated_current_a": [
    "Rated current",
    "Current of each phase at which the data sheet gives the holding torque, with both phases on.",
  ],
  "Motor.resistance_ohm": ["Resistance", "Of one phase. At low rates the supply has to overcome little more."],
  "Motor.rotor_inertia_g_cm2": [
    "Rotor inertia",
    "Torque for the acceleration = (rotor + load inertia) × acceleration.",
  ],
  "Motor.supply_v": [
    "Supply",
    "Voltage of the driver's supply. The higher it is, the higher the rate up to which the driver holds its current.",
  ],
  "Motor.working_rate_hz": [
    "Working rate",
    "Highest rate at which the motor is known to work with its load, f_s. The document states 19200 Hz for its motor and does not derive it.",
  ],
  "MoveGroup.length": [
    "Length",
    "As the display shows it, without its point: with one decimal 305 is 30.5 units. Steps follow by pulses a unit, rounded once from the program's start, so nothing adds up over loops.",
  ],
  "Noise.duplicated_bytes_ppm": [
    "Bytes duplicated",
    "A byte that arrives twice, as after a clumsy repetition in a converter.",
  ],
  "Noise.flipped_bits_ppm": [
    "Bits flipped",
    "A 0 is heard as a 1 or the other way round, as by a disturbance near the cable.",
  ],
  "Noise.glitches_ppm": [
    "Glitches",
    "Short wrong levels on the line. One of less than half a bit is not taken for a start bit.",
  ],
  "Noise.host_crashes_ppm": [
    "Host restarts",
    "The program that sends crashes in the middle of a frame and starts again: the next frames must not be harmed by the first half.",
  ],
  "Noise.lost_bytes_ppm": ["Bytes lost", "A byte that never arrives, as when a buffer runs over."],
  "Noise.lost_replies_ppm": [
    "Replies lost",
    "The controller has done it but the host does not hear so: the case for which frames have a seq.",
  ],
  "Noise.seed": [
    "Seed",
    "Where the random numbers of the noise begin: chance that can be repeated exactly, on any machine.",
  ],
  "Packets.packets": [
    "Packet",
    "What the host sends for one tick: a byte a motor, bit 7 the direction, bits 6 to 0 the number of steps.",
  ],
  "Points.interpolation": [
    "Between them",
    "Straight: the speed jumps at every point. Smooth: cubics (Steffen 1990) that turn only where the points turn, so nothing overshoots; they start and end at rest.",
  ],
  "Points.points": [
    "Points",
    "Times in s and positions, one pair a line. Both count from the first point, so a record may begin anywhere. The last position is rounded to a whole step.",
  ],
  "Points.unit": ["Unit", "Of the positions; millimetres and degrees need mechanics that have them."],
  "Ramps.distance": ["Distance", "How far the move goes. It is rounded to whole steps: a motor cannot do less."],
  "Ramps.duration_s": ["Duration", "Time from the start of the move to its end."],
  "Ramps.ramp_s": [
    "Ramp",
    "Time t_s in which speed rises to its peak, and again falls from it. Peak rate = steps / (duration − ramp): a longer ramp is gentler but needs a higher peak.",
  ],
  "Ramps.shape": [
    "Shape",
    "How the speed goes from nothing to its top. Straight is uniform acceleration: least peak acceleration, but it jumps. An exponential is steep at first, where a motor has most torque, and needs the lowest peak rate. Sigmoid and Bezier curves start and end gently, as a cosine does.",
  ],
  "Ramps.sigmoid_range": [
    "Sigmoid's range",
    "1/(1 + e⁻ˣ) has no end; this is where it is cut off on both sides. A cut one would never reach its full speed, which the document holds against it, so what is left is stretched to do so. A small range is nearly straight, a great one crowds all acceleration into the middle.",
  ],
  "Ramps.time_constants": [
    "Time constants",
    "How many time constants of the exponential a ramp has. More of them are steeper at the start and flatter at the top; few are nearly straight.",
  ],
  "Rotary.full_step_deg": [
    "Full step",
    "Angle by which the shaft turns when one winding takes over from the other; 1.8° in most motors.",
  ],
  "Rotary.microsteps": [
    "Microsteps",
    "Parts into which the driver divides a full step by letting part of the current flow in both windings. One STEP pulse is one microstep; half a step is the 1-2-phase sequence.",
  ],
  "Scenario.clock_hz": [
    "Clock",
    "All that the controller does happens on a beat of this clock; one beat is a cycle, and times are counted in whole cycles.",
  ],
  "Scenario.note": ["Note", "What to look at, for whom you send the link to."],
  "Scenario.run_cycles": [
    "Length of the run",
    "When to stop looking. By itself a run ends when nothing can change any more.",
  ],
  "Scenario.title": ["Name", "A name for the experiment, that travels with its link."],
  "Screw.full_step_deg": [
    "Full step",
    "Angle by which the shaft turns when one winding takes over from the other; 1.8° in most motors.",
  ],
  "Screw.lead_mm": ["Lead", "Travel of the nut in one turn of the screw."],
  "Screw.microsteps": [
    "Microsteps",
    "Parts into which the driver divides a full step by letting part of the current flow in both windings. One STEP pulse is one microstep; half a step is the 1-2-phase sequence.",
  ],
  "ScriptedSend.bytes": [
    "Bytes",
    "What goes over the line, each byte as a start bit, eight data bits with the lowest first, and a stop bit.",
  ],
  "ScriptedSend.frame": [
    "Frame",
    "Address, kind and body between two zero bytes, with a checksum. COBS takes the zeros out of the inside, so that an end can always be found again.",
  ],
  "ScriptedSend.start_cycle": ["Start", "Cycle of the controller's clock, counted from reset, in which this begins."],
  "Sine.amplitude": [
    "Amplitude",
    "From the middle of the oscillation to one end; the carriage of a calibration rig goes to and fro by twice this.",
  ],
  "Sine.period_s": ["Period", "Time T_k of once to and fro; one over it is the frequency."],
  "Sine.periods": ["Periods", "How often the oscillation is repeated. The spectrum is taken over whole periods."],
  "SineSegments.amplitude": [
    "Amplitude",
    "From the middle of the oscillation to one end; the carriage of a calibration rig goes to and fro by twice this.",
  ],
  "SineSegments.max_deviation": [
    "Deviation d1",
    "How far a segment may lie from the sine, in parts of the amplitude. A smaller d1 makes more segments; the distortion does not simply fall with it.",
  ],
  "SineSegments.period_s": ["Period", "Time T_k of once to and fro; one over it is the frequency."],
  "SineSegments.periods": [
    "Periods",
    "How often the oscillation is repeated. The spectrum is taken over whole periods.",
  ],
  "Staircase.distance": ["Distance", "How far the move goes. It is rounded to whole steps: a motor cannot do less."],
  "Staircase.level": [
    "Acceleration level",
    "One of five accelerations that the controller offers: level times 1000 steps/s².",
  ],
  "Staircase.max_speed": [
    "Table ends above",
    "The rates of the table are worked out once, up to the first one above this.",
  ],
  "Staircase.short_move": [
    "Short moves",
    "A move with less way than both ramps need never reaches its top speed. The document makes the whole of it at the start speed; reversing on the way up is quicker.",
  ],
  "Staircase.start_speed": [
    "Start speed",
    "Rate of the first step, v0 or f_1. A motor can jump to it from standing still, up to its start-stop rate.",
  ],
  "Staircase.top_speed": [
    "Top speed",
    "Rate of the plateau between the ramps, f_s. Above the pull-out rate for its load a motor loses steps.",
  ],
  "StandAlone.debounce_cycles": [
    "Debounce",
    "A contact bounces for some milliseconds. A level counts once it has stood for so long; a shorter one is not seen.",
  ],
  "StandAlone.groups": [
    "Group",
    "A step of the program: a move by a length with its speed, direction, acceleration and the pause after it, as in the document; or one of the kinds beyond it.",
  ],
  "StandAlone.least_trust": [
    "Trust",
    "How sure the controller is of its place. SURE: a zero was set or found. HELD: it was sure, but the windings were without current since. LOST: after a power loss that memory did not outlive, or a jump beyond the start-stop rate.",
  ],
  "StandAlone.pulses_per_unit": [
    "Pulses a unit",
    "How many pulses make one unit of length, centimetres in the document: measured with the table itself, so that the screw's and the gear's errors are in it.",
  ],
  "StandAlone.start_speed_hz": [
    "Start-stop rate",
    "The motor can start and stop at this rate at once. Where it has to jump beyond it, steps may be lost, so the place is not trusted any more.",
  ],
  "TimingRules.dir_hold_ns": ["DIR hold", "From the rise of STEP to the next change of DIR."],
  "TimingRules.dir_setup_ns": ["DIR set-up", "From the last change of DIR to the rise of STEP."],
  "TimingRules.enable_wake_ns": ["EN wake-up", "From the rise of EN, or reset, to the first step."],
  "TimingRules.step_high_ns": ["STEP high", "From the rise of STEP to its fall."],
  "TimingRules.step_low_ns": ["STEP low", "From the fall of STEP to its next rise."],
  "Trapezoid.acceleration": [
    "Acceleration",
    "How much the speed grows in a second. The motor's torque less the load's, divided by the inertia, is the most it can be.",
  ],
  "Trapezoid.distance": ["Distance", "How far the move goes. It is rounded to whole steps: a motor cannot do less."],
  "Trapezoid.method": [
    "Step times",
    "A small controller keeps a table of pulse rates, one entry a step, and loads a timer with clock / rate: both are whole numbers, so each step comes a little early or late. Exact times show what is lost by that.",
  ],
  "Trapezoid.start_speed": [
    "Start speed",
    "Rate of the first step, v0 or f_1. A motor can jump to it from standing still, up to its start-stop rate.",
  ],
  "Trapezoid.timer_hz": [
    "Timer clock",
    "The timer that the controller reloads for every step counts this clock. A slow one makes coarse step times.",
  ],
  "Trapezoid.top_speed": [
    "Top speed",
    "Rate of the plateau between the ramps, f_s. Above the pull-out rate for its load a motor loses steps.",
  ],
  "Wheel.full_step_deg": [
    "Full step",
    "Angle by which the shaft turns when one winding takes over from the other; 1.8° in most motors.",
  ],
  "Wheel.microsteps": [
    "Microsteps",
    "Parts into which the driver divides a full step by letting part of the current flow in both windings. One STEP pulse is one microstep; half a step is the 1-2-phase sequence.",
  ],
  "Wheel.radius_mm": ["Radius", "Of the wheel, pulley or pitch circle that turns angle into way."],
};
