/** What the terms of a scenario's fields mean: written from the schema by its test, STEPSCOPE_BLESS=1. */
/** @type {{[id: string]: [string, string]}}  The card's head and its text. */
export const EXPLAINED = {
  "Analysis.axis": ["Axis", "Axis of the spectrum. Axis 0 drives channel 0."],
  "Analysis.fft_length": [
    "Samples",
    "Samples per period for the Fourier transform. They span exactly one period, so there is no leakage.",
  ],
  "Analysis.max_harmonic": ["Max harmonic", "Highest harmonic that the distortion (THD) includes."],
  "Analysis.sensor_hz": [
    "Sensor bandwidth",
    "An accelerometer is a low-pass filter: at this frequency it measures 71 % of the acceleration, |H| = 1/√(1 + (f/f_b)²). The distortion it measures therefore does not grow with the number of harmonics.",
  ],
  "Axis.input_shaper": [
    "Input shaper",
    "The sum of the curve at several delays, which cancels the vibration of a machine at one frequency. The axis ends later by the longest delay, exactly where it would end without a shaper.",
  ],
  "Axis.motor": [
    "Motor",
    "Motor data for the torque-speed curve: a two-phase hybrid motor on a driver that regulates the current. It does not affect the run. A move that needs more torque than the motor has gets a warning; Study > Torque shows both. The default is the motor of Song, Han, Lu 2021.",
  ],
  "AxisLimits.start_stop_speed": [
    "Start-stop speed",
    "A motor can start and stop at once up to this rate. A larger jump of the speed is refused.",
  ],
  "Bus.channels": ["Channel", "One motor driver with its STEP and DIR lines. All channels share EN."],
  "Bus.dir_hold_cycles": [
    "DIR hold",
    "DIR must be stable for this time after STEP falls. Data sheets count from the rise: pulse width + this time.",
  ],
  "Bus.dir_line": [
    "DIR lines",
    "One DIR line for all motors saves wires. In each slot DIR goes low and motors step left, then DIR goes high and motors step right. This takes at least five cycles.",
  ],
  "Bus.dir_setup_cycles": [
    "DIR set-up",
    "DIR must be stable for this time before STEP rises. Otherwise the driver may step in the old direction.",
  ],
  "Bus.distribution": [
    "Burst and spread",
    "Burst: the steps use the first slots of the tick, then there is a pause (RU 2704486). Spread: they are spaced evenly over the tick, so the speed is smoother.",
  ],
  "Bus.pulse_phasing": [
    "Pulses in a slot",
    "Motors that step at the same time draw their current peaks at the same time. Staggered pulses reduce the peaks of the supply current to a half or a third.",
  ],
  "Bus.pulse_width_cycles": [
    "STEP high",
    "Width of a step pulse. A driver can miss pulses that are shorter than its data sheet requires.",
  ],
  "Bus.queue_depth": [
    "Queue",
    "Ticks that wait in the controller, so motion continues while the host is busy. An empty queue during a motion is an underrun.",
  ],
  "Bus.self_test_cycles": ["Self-test", "After reset the controller tests itself and drops everything it receives."],
  "Bus.settle_cycles": [
    "Settling time (dp)",
    "Time that the supply current needs to settle after a step, Δt_p in RU 2704486. Staggered pulses are this far apart, or closer if the slot is too short.",
  ],
  "Bus.slots": ["Slot", "A tick is divided into slots. A channel makes at most one step per slot."],
  "Bus.step_period_cycles": ["Length of a slot", "Step period T_s. A channel makes at most one step per slot."],
  "ChannelSegments.segments": [
    "Segment",
    "A number of steps whose intervals change by a constant. An acceleration table with one reload per step is a list of segments of one step.",
  ],
  "ChannelSegments.start_cycle": ["Start", "First cycle, counted from reset."],
  "Constant.distance": ["Distance", "Travel of the move, rounded to whole steps."],
  "Constant.speed": ["Speed", "Step rate of the whole move."],
  "Controller.address": [
    "Address",
    "Number of a controller on a shared line. A controller accepts packets that begin with its own address or with 255.",
  ],
  "Controller.packets": [
    "Packet",
    "What the host sends for one tick: one byte per motor, with the direction in bit 7 and the number of steps in bits 6 to 0.",
  ],
  "Controller.receiver_baud": [
    "Receiver bit rate",
    "The receiver has its own clock. If its bit rate is about 5 % off, it samples the stop bit at the wrong time.",
  ],
  "Cosine.distance": ["Distance", "Travel of the move, rounded to whole steps."],
  "Cosine.duration_s": ["Duration", "Time from the start to the end of the move."],
  "Cosine.end_speed": [
    "Start and end speed",
    "Speed along the move at its start and its end, positive toward its end. A move without a start speed takes over the end speed given in the previous move, so that moves follow each other without a stop.",
  ],
  "Cosine.method": [
    "Step times",
    "A small controller evaluates the curve once per slice and rounds down to whole steps, so it makes too few steps in total. Song 2021 therefore scales the curve up and shortens the plateau, so the move ends up to 0.8 % early. Exact step times have no such error.",
  ],
  "Cosine.ramp_s": [
    "Ramp",
    "Time t_s of each ramp. Peak rate = steps / (duration − ramp): a longer ramp is gentler but has a higher peak.",
  ],
  "Cosine.slice_s": [
    "Slice",
    "Time T_S during which the rate is constant, 1 ms in Song 2021. The rate at the start of a slice determines its number of steps.",
  ],
  "Cosine.start_speed": [
    "Start and end speed",
    "Speed along the move at its start and its end, positive toward its end. A move without a start speed takes over the end speed given in the previous move, so that moves follow each other without a stop.",
  ],
  "Direct.step_mm": ["One step", "Travel of one step, measured or given."],
  "Dwell.duration_s": ["Duration", "Time from the start to the end of the move."],
  "Eeprom.hold_up_cycles": [
    "Hold-up",
    "After a power failure the motors are off, and a capacitor supplies the controller for this time. Saving the position takes 16 bytes; 17 byte write times minus one cycle are always enough.",
  ],
  "Glitch.length_cycles": ["Length", "Number of cycles with the forced level."],
  "Glitch.level": [
    "Level",
    "Forced level of the line. A long 0 is a break: the stop bit is missing, and the receiver reports a framing error.",
  ],
  "Glitch.start_cycle": ["Start", "First cycle, counted from reset."],
  "Host.max_attempts": [
    "Max attempts",
    "After this many attempts without a reply the host gives up on the controller.",
  ],
  "Host.reply_timeout_cycles": [
    "Reply timeout",
    "Without a complete reply in this time the frame is sent again with the same sequence number, so it is not executed twice.",
  ],
  "Host.ticks_per_frame": [
    "Ticks per frame",
    "More ticks per frame leave more time for the reply, but need a deeper queue.",
  ],
  "JerkLimited.distance": ["Distance", "Travel of the move, rounded to whole steps."],
  "JerkLimited.end_speed": [
    "Start and end speed",
    "Speed along the move at its start and its end, positive toward its end. A move without a start speed takes over the end speed given in the previous move, so that moves follow each other without a stop.",
  ],
  "JerkLimited.max_acceleration": ["Max acceleration", "Limit of the acceleration. Short moves do not reach it."],
  "JerkLimited.max_deceleration": [
    "Deceleration",
    "Limit while the speed falls. A motor brakes harder than it accelerates, because friction helps.",
  ],
  "JerkLimited.max_jerk": [
    "Max jerk",
    "Limit of the change of acceleration per second. An infinite jerk makes a trapezoid.",
  ],
  "JerkLimited.max_speed": ["Max speed", "Rate of the plateau. Short moves do not reach it."],
  "JerkLimited.start_speed": [
    "Start and end speed",
    "Speed along the move at its start and its end, positive toward its end. A move without a start speed takes over the end speed given in the previous move, so that moves follow each other without a stop.",
  ],
  "Line.address": [
    "Address",
    "Number of a controller on a shared line. A controller accepts packets that begin with its own address or with 255.",
  ],
  "Line.baud": ["Bit rate", "Bits per second on the line. A byte takes ten bits."],
  "Line.protocol": [
    "Protocol",
    "Raw packets have no checksum: a flipped bit moves a motor unnoticed. Frames have a CRC, are acknowledged, and are repeated until they are.",
  ],
  "Line.receiver_baud": [
    "Receiver bit rate",
    "The receiver has its own clock. If its bit rate is about 5 % off, it samples the stop bit at the wrong time.",
  ],
  "Motion.engine": [
    "Step generation",
    "Ticks: the host sends the number of steps of each tick (RU 2704486). Step table: a timer interrupt of the controller runs the move without a host, from a table of intervals (Sonobe 2011, Zhang 2012, Song 2021).",
  ],
  "Motion.groups": [
    "Group",
    "Moves of several axes that start and end at the same time. A group starts when the last axis is at rest.",
  ],
  "Motor.holding_torque_mN_m": [
    "Holding torque",
    "Torque with both phases at the rated current. One phase at its peak has 1/√2 of it. The back-EMF follows from it.",
  ],
  "Motor.inductance_mh": [
    "Inductance",
    "Inductance of one phase. At high rates the current cannot follow, so the torque falls.",
  ],
  "Motor.load_inertia_g_cm2": [
    "Load inertia",
    "Inertia of the load at the motor shaft. Behind a gear of n : 1 divide it by n².",
  ],
  "Motor.load_torque_mN_m": [
    "Load torque",
    "Torque that opposes the motion, such as friction or cutting. It helps when decelerating.",
  ],
  "Motor.peak_current_a": [
    "Peak current",
    "Amplitude of the phase currents. √2 times the rated current heats the motor as much as the rated current in both phases.",
  ],
  "Motor.rated_current_a": [
    "Rated current",
    "Current per phase for which the data sheet gives the holding torque, both phases on.",
  ],
  "Motor.resistance_ohm": ["Resistance", "Resistance of one phase. At low rates it determines the required voltage."],
  "Motor.rotor_inertia_g_cm2": [
    "Rotor inertia",
    "Torque for the acceleration = (rotor + load inertia) × acceleration.",
  ],
  "Motor.supply_v": ["Supply", "Supply voltage of the driver. A higher voltage keeps the current up to a higher rate."],
  "Motor.working_rate_hz": [
    "Working rate",
    "Highest rate known to work with the load, f_s. Song 2021 states 19200 Hz.",
  ],
  "MoveGroup.length": [
    "Length",
    "Digits of the display without the decimal point: with one decimal 305 is 30.5 units. Positions are rounded to steps from the start of the program, so errors do not add up over loops.",
  ],
  "Noise.duplicated_bytes_ppm": [
    "Bytes duplicated",
    "A byte arrives twice, for example because a converter repeats it.",
  ],
  "Noise.flipped_bits_ppm": [
    "Bits flipped",
    "A 0 is received as a 1 or vice versa, for example because of interference.",
  ],
  "Noise.glitches_ppm": [
    "Glitches",
    "Short wrong levels on the line. A glitch shorter than half a bit is not a start bit.",
  ],
  "Noise.host_crashes_ppm": [
    "Host restarts",
    "The host crashes in the middle of a frame and restarts. The incomplete frame must not damage the following ones.",
  ],
  "Noise.lost_bytes_ppm": ["Bytes lost", "A byte never arrives, for example because a buffer overflows."],
  "Noise.lost_replies_ppm": [
    "Replies lost",
    "The controller executes the frame, but the host does not receive the reply. Sequence numbers handle this case.",
  ],
  "Noise.seed": ["Seed", "Seed of the random faults. The same seed gives the same faults on every machine."],
  "Packets.packets": [
    "Packet",
    "What the host sends for one tick: one byte per motor, with the direction in bit 7 and the number of steps in bits 6 to 0.",
  ],
  "Points.interpolation": [
    "Interpolation",
    "Straight: the speed jumps at every point. Smooth: cubics (Steffen 1990) without overshoot, from rest to rest.",
  ],
  "Points.points": [
    "Points",
    "Time in s and position, one pair per line, both relative to the first point. The last position is rounded to a whole step.",
  ],
  "Points.unit": ["Unit", "Unit of the positions. Millimeters and degrees need mechanics that have them."],
  "Ramps.distance": ["Distance", "Travel of the move, rounded to whole steps."],
  "Ramps.duration_s": ["Duration", "Time from the start to the end of the move."],
  "Ramps.end_speed": [
    "Start and end speed",
    "Speed along the move at its start and its end, positive toward its end. A move without a start speed takes over the end speed given in the previous move, so that moves follow each other without a stop.",
  ],
  "Ramps.ramp_s": [
    "Ramp",
    "Time t_s of each ramp. Peak rate = steps / (duration − ramp): a longer ramp is gentler but has a higher peak.",
  ],
  "Ramps.shape": [
    "Shape",
    "Shape of the speed ramp. Straight: the lowest peak acceleration, but the acceleration jumps. Exponential: the lowest peak rate; it is steep at low speed, where a motor has the most torque. Sigmoid and Bezier: gentle at both ends, like a cosine.",
  ],
  "Ramps.sigmoid_range": [
    "Sigmoid range",
    "1/(1 + e⁻ˣ) only approaches 0 and 1, so the ramp uses x from minus this value to plus this value, stretched to full speed. With a small range the ramp is nearly straight; with a large one the acceleration peaks in the middle.",
  ],
  "Ramps.start_speed": [
    "Start and end speed",
    "Speed along the move at its start and its end, positive toward its end. A move without a start speed takes over the end speed given in the previous move, so that moves follow each other without a stop.",
  ],
  "Ramps.time_constants": [
    "Time constants",
    "Time constants of the exponential per ramp. A higher number makes the ramp steeper at the start and flatter at the end; a low number makes it nearly straight.",
  ],
  "Retarget.at_s": ["Cut at", "Time after the start of the previous move at which the new target takes over."],
  "Retarget.profile": [
    "Profile",
    "Jerk-limited: the acceleration changes gradually. Trapezoid: the acceleration jumps, so the move is shorter.",
  ],
  "Rotary.full_step_deg": ["Full step", "Angle of one full step of the motor; usually 1.8°."],
  "Rotary.microsteps": [
    "Microsteps",
    "Microsteps per full step. The driver shares the current between both windings. One STEP pulse is one microstep; 2 is half-stepping.",
  ],
  "Scenario.clock_hz": [
    "Clock",
    "Clock of the controller. One period is a cycle, and everything happens in whole cycles.",
  ],
  "Scenario.note": ["Note", "What the person who opens the link should see and try."],
  "Scenario.run_cycles": ["Run length", "When the run stops. Without it the run ends after the last change."],
  "Scenario.title": ["Name", "Name of the experiment. It is part of the link."],
  "Screw.full_step_deg": ["Full step", "Angle of one full step of the motor; usually 1.8°."],
  "Screw.lead_mm": ["Lead", "Travel of the nut per turn of the screw."],
  "Screw.microsteps": [
    "Microsteps",
    "Microsteps per full step. The driver shares the current between both windings. One STEP pulse is one microstep; 2 is half-stepping.",
  ],
  "ScriptedSend.bytes": [
    "Bytes",
    "Bytes on the line. Each has a start bit, eight data bits (lowest first) and a stop bit.",
  ],
  "ScriptedSend.frame": [
    "Frame",
    "Address, kind and body with a CRC, between two zero bytes. COBS removes the zeros from the content, so that the end of a frame is always found.",
  ],
  "ScriptedSend.start_cycle": ["Start", "First cycle, counted from reset."],
  "Sine.amplitude": ["Amplitude", "From the center of the oscillation to one end. The total travel is twice this."],
  "Sine.period_s": ["Period", "Time T_k of one oscillation; its reciprocal is the frequency."],
  "Sine.periods": ["Periods", "Number of oscillations. The spectrum uses whole periods."],
  "SineSegments.amplitude": [
    "Amplitude",
    "From the center of the oscillation to one end. The total travel is twice this.",
  ],
  "SineSegments.max_deviation": [
    "Deviation d1",
    "Maximum distance of a segment from the sine, relative to the amplitude. A smaller d1 makes more segments, but not always less distortion.",
  ],
  "SineSegments.period_s": ["Period", "Time T_k of one oscillation; its reciprocal is the frequency."],
  "SineSegments.periods": ["Periods", "Number of oscillations. The spectrum uses whole periods."],
  "Staircase.acceleration_level": ["Acceleration level", "One of five accelerations: level times 1000 steps/s²."],
  "Staircase.distance": ["Distance", "Travel of the move, rounded to whole steps."],
  "Staircase.max_speed": ["Table ends above", "The table has rates up to the first one above this value."],
  "Staircase.short_move": [
    "Short moves",
    "A move that is shorter than both ramps cannot reach its top speed. Zhang 2012 runs it at the start speed; accelerating to the highest rate that fits is faster.",
  ],
  "Staircase.start_speed": [
    "Start speed",
    "Rate of the first step, v0 or f_1. A motor can start at any rate up to its start-stop rate.",
  ],
  "Staircase.top_speed": [
    "Max speed",
    "Rate of the plateau between the ramps, f_s. Above its pull-out rate a motor loses steps.",
  ],
  "StandAlone.debounce_cycles": [
    "Debounce",
    "A contact bounces for some milliseconds. A level counts after it has been stable for this time.",
  ],
  "StandAlone.groups": [
    "Group",
    "A step of the program: a move by a length with speed, direction, acceleration and delay (Zhang 2012), or one of the additional kinds.",
  ],
  "StandAlone.pulses_per_unit": [
    "Pulses per unit",
    "Pulses per unit of length (cm in Zhang 2012). It is measured on the machine, so it includes the errors of screw and gear.",
  ],
  "StandAlone.required_position": [
    "Required position",
    "How reliable the position must be to start. Confirmed: zero was set or found. Restored: it was confirmed, but the windings have been without current since. Lost: memory did not survive a power loss, or the motor jumped beyond its start-stop rate.",
  ],
  "StandAlone.start_speed_hz": [
    "Start-stop rate",
    "The motor can start and stop at this rate without a ramp. A jump to a higher rate may lose steps, so the position is lost.",
  ],
  "TimingRules.dir_hold_ns": ["DIR hold", "From the rise of STEP to the next change of DIR."],
  "TimingRules.dir_setup_ns": ["DIR set-up", "From the last change of DIR to the rise of STEP."],
  "TimingRules.enable_wake_ns": ["EN wake-up", "From the rise of EN, or from reset, to the first step."],
  "TimingRules.step_high_ns": ["STEP high", "From the rise of STEP to its fall."],
  "TimingRules.step_low_ns": ["STEP low", "From the fall of STEP to its next rise."],
  "Trapezoid.deceleration": [
    "Deceleration",
    "Limit while the speed falls. A motor brakes harder than it accelerates, because friction helps.",
  ],
  "Trapezoid.distance": ["Distance", "Travel of the move, rounded to whole steps."],
  "Trapezoid.end_speed": [
    "Start and end speed",
    "Speed along the move at its start and its end, positive toward its end. A move without a start speed takes over the end speed given in the previous move, so that moves follow each other without a stop.",
  ],
  "Trapezoid.max_acceleration": [
    "Max acceleration",
    "Change of speed per second on the ramps. A motor reaches at most its torque minus the load torque, divided by the inertia.",
  ],
  "Trapezoid.max_speed": [
    "Max speed",
    "Rate of the plateau between the ramps, f_s. Above its pull-out rate a motor loses steps.",
  ],
  "Trapezoid.method": [
    "Step times",
    "A small controller stores one pulse rate per step and reloads a timer with clock / rate. Both are whole numbers, so each step is slightly early or late. Exact step times have no such error.",
  ],
  "Trapezoid.start_speed": [
    "Start speed",
    "Rate of the first step, v0 or f_1. A motor can start at any rate up to its start-stop rate.",
  ],
  "Trapezoid.timer_hz": [
    "Timer clock",
    "Clock of the timer that the controller reloads at every step. A slow clock makes step times coarse.",
  ],
  "Wheel.full_step_deg": ["Full step", "Angle of one full step of the motor; usually 1.8°."],
  "Wheel.microsteps": [
    "Microsteps",
    "Microsteps per full step. The driver shares the current between both windings. One STEP pulse is one microstep; 2 is half-stepping.",
  ],
  "Wheel.radius_mm": ["Radius", "Radius of the wheel, pulley or pitch circle."],
};
