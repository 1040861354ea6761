/**
 * Types that modules of the page share. `core/scenario/src/schema` defines scenarios.
 *
 * @typedef {{[key: string]: any}} Scenario  The JSON of an experiment, with all fields.
 * @typedef {{path: string, message: string}} Problem
 * @typedef {{start_s: number, duration_s: number, steps: number, detail: string, warning: string}} DerivedMove
 * @typedef {{steps: number, duration_s: number, peak_speed_steps_s: number, peak_acceleration_steps_s2: number,
 *   step_mm: number | null, step_deg: number | null, unit: "steps" | "mm" | "deg", moves: DerivedMove[]}} DerivedAxis
 * @typedef {{tick_s: number, limit_steps_s: number, ticks: number, axes: DerivedAxis[]}} DerivedController
 * @typedef {{ticks: number, sends: number, line_load: number | null, duration_s: number,
 *   controllers: DerivedController[]}} Derived  Controllers in the order of the scenario, the first one at 0.
 * @typedef {{edges: number, packets: number, bytes: number, over_budget: boolean, message: string}} Cost
 * @typedef {{problems: Problem[], warnings: {path: string, message: string}[], scenario: string, derived: Derived | null, cost: Cost | null}} Validation
 * @typedef {{id: string, task: string, paper: string | null, view: string, title: string, scenario: string}} Preset  `view` is part `v` of a link.
 * @typedef {{id: string, name: string, source: string, rules: {[rule: string]: number}}} DriverSheet
 *
 * @typedef {{address: number | null, digest: string, records: number, edges: number, channels: number, positions: number[],
 *   faults: {bits: number, names: string[]}, ticks_done: number, state: string | null, changing: number[],
 *   violations: number | null, violated: string[]}} ControllerSummary  `violated`: rules of the driver timing.
 * @typedef {{controller: number, ticks: number, acknowledged: number, why: string | null,
 *   progress: "opening" | "locating" | "filling" | "confirming" | "verifying" | "done" |
 *   "counted" | "stopping" | "given_up"}} Job
 * @typedef {{frames: number, repeated: number, replies: number, rejected: number, refused: number, crashes: number, jobs: Job[]}} Host
 * @typedef {{recorded: boolean, framed: boolean, end_cycle: number, end_s: number, clock_hz: number, line_load: number | null,
 *   host: Host | null, controllers: ControllerSummary[]}} Summary
 * @typedef {{done: boolean, cycle: number, end_cycle: number, records: number}} Progress
 * @typedef {{x: Float64Array, has_ideal: boolean, has_acceleration: boolean,
 *   position_min: Float64Array, position_max: Float64Array, speed_min: Float64Array, speed_max: Float64Array,
 *   acceleration_min: Float64Array, acceleration_max: Float64Array,
 *   actual_position_min: Float64Array, actual_position_max: Float64Array,
 *   actual_speed_min: Float64Array, actual_speed_max: Float64Array, actual_acceleration_min?: Float64Array, actual_acceleration_max?: Float64Array,
 *   line_time_s: Float64Array, line_position: Float64Array, line_speed: Float64Array, line_acceleration: Float64Array}} MotionColumns
 * @typedef {{time_s: Float64Array, has_acceleration?: boolean, position?: Float64Array, speed?: Float64Array, acceleration?: Float64Array,
 *   position_min?: Float64Array, position_max?: Float64Array, speed_min?: Float64Array, speed_max?: Float64Array}} Outline  Lines of a planned axis, else minimum and maximum of its pulses.
 * @typedef {{high: Uint32Array, low: Uint32Array, last: Uint32Array}} PulseColumns
 * @typedef {{start: number, end: number, texts: string[], bad: boolean, packet: number | null, sample: number | null}} LineSpan
 * @typedef {{bits: LineSpan[], bytes: LineSpan[], fields: LineSpan[]}} Lane
 * @typedef {{rx: Lane, tx: Lane, more: boolean}} Decoded
 * @typedef {{high: boolean, begin: number | null, end: number | null, next: number | null}} Pulse  A level, its first and last edge, and the next edge, in cycles.
 * @typedef {{cycle: number, bit: number, high: boolean}} EdgeRow
 * @typedef {{index: number, kind: "packet" | "frame" | "reply" | "collision", start_cycle: number, end_cycle: number,
 *   line_end_cycle: number, start: string, gap: string, hex: string, fields: string, outcome: string, short: string, why: string,
 *   mark: "good" | "foreign" | "repeated" | "bad", tick_start_cycle: number | null, tick_end_cycle: number | null,
 *   position: number, rank: number | null}} PacketRow  `position`: among the visible rows; `rank`: among the matches of the search.
 * @typedef {{high: number, low: number, levels: string, name: string, value: string}} BitGroup  Bits `high` to `low` of a field.
 * @typedef {{name: string, from: number, until: number, value: string, bits: BitGroup[]}} PacketField
 * @typedef {PacketRow & {layout: PacketField[],
 *   check: "none" | "missing" | "holds" | "fails", check_found: string | null, check_expected: string | null,
 *   byte_cycles: number[], byte_length: number, gap_cycles: number | null, drive_cycles: number | null,
 *   turnaround_cycles: number | null, answers: number | null}} PacketDetail  `layout`: the fields, each with its range of bytes `from..until`.
 * @typedef {{start_cycle: number, end_cycle: number, row: number | null, fields: string}} TickRow
 * @typedef {{total: number, shown: number, matches: number, unit: string, rows: PacketRow[]}} PacketPage
 * @typedef {{cycle: number, channel: number, rule: string, measured_cycles: number, required_cycles: number}} Violation
 * @typedef {{rule: string, required_ns: number, required_cycles: number, violations: number, by_channel: number[],
 *   shortest: {measured_cycles: number, cycle: number, channel: number} | null}} RuleResult
 * @typedef {{driver: string | null, total: number, rules: RuleResult[], violations: Violation[]}} Timing
 * @typedef {{fundamental_hz: number, periods: number, order: number, periodic: boolean,
 *   position: Float64Array, speed: Float64Array, acceleration: Float64Array, acceleration_filtered?: Float64Array,
 *   thd_position: number | null, thd_speed: number | null, thd_acceleration: number | null, thd_acceleration_filtered: number | null}} Spectrum
 * @typedef {{axis: number, ideal: Spectrum | null, pulses: Spectrum | null, note: string}} Spectra
 *
 * @typedef {{at_a: number[], at_b: number[], mean: number[], rms: number[]}} Readings  Position, speed, acceleration. Pulses have an acceleration only without a plan; NaN where it is undefined.
 * @typedef {{ideal: Readings | null, actual: Readings}} Between
 * @typedef {{common_s: number, largest: number, at_s: number, rms: number}} Deviation  From the baseline.
 * @typedef {{name: string, unit: "seconds" | "length" | "speed" | "acceleration" | "ratio" | "full_steps", before: number | null, after: number | null, change: number | null}} ComparedFigure
 * @typedef {{title: string, revision: number, summary: Summary, controller: number, derived: DerivedController | null}} Baseline
 *
 * @typedef {{start: number, end: number}} Span  Cycles, start < end.
 * @typedef {{left: number, top: number, right: number, bottom: number}} Plot  CSS pixels in a canvas.
 * @typedef {"own" | "shared" | `preset:${string}`} Origin  Where the visible scenario comes from.
 * @typedef {{title: boolean, note: boolean}} Borrowed  Whether name and note are still unchanged from the preset, link or file.
 * @typedef {{scenario: Scenario, origin: Origin, borrowed: Borrowed, drafts: State["drafts"]}} Moment  One step of the history.
 * @typedef {{revision: number, summary: Summary, ms: number, controller: number, derived: Derived | null}} Result  The result of a run, with the visible controller and the derived values of its scenario.
 * @typedef {{phase: "idle" | "waiting" | "running" | "done" | "failed", progress: Progress | null, message: string}} Run
 *
 * @typedef {{form: number | null, rows: number[] | null, columns: number[] | null, folded: string[], open: string[],
 *   largest: string | null, pulses: import("./row_choices.js").RowChoices}} Panes
 *   `form`: its width in CSS pixels, 0 if folded. `rows` and `columns`: relative heights and widths of the views. null is the
 *   default. `folded` views; views `open` although they are empty; the `largest` view; and the rows of the pulses.
 * @typedef {{start: number, end: number, controller: number, cycle: number}} TraceLocation  The window and the cycle that a message links to, in cycles.
 * @typedef {{edge: number, cycle: number}} Mark  An edge by its number, and its cycle.
 * @typedef {{error: string | null, same: boolean, edges: number, version: string | null, own_version: string, controller: number,
 *   after: Mark | null, until: Mark | null, shorter: "this" | "other" | null}} SenderComparison  Comparison of a run with the run of the link's sender.
 * @typedef {{window?: Span, controller?: number, axis?: number, a?: number, b?: number, view?: string, sides?: {[area: string]: string},
 *   unit?: "steps" | "mm" | "deg", study?: StudyName, quantities?: string[]}} ViewPart  The view in a link; missing parts have their defaults.
 *
 * @typedef {"compare" | "measures" | "tables" | "sine" | "torque" | "motor"} StudyName  Tabs of the study.
 *
 * @typedef {object} State
 * @property {Scenario} scenario
 * @property {Origin} origin
 * @property {Borrowed} borrowed
 * @property {number} revision      Counts the changes of the scenario.
 * @property {number} opened        Counts the scenarios that replaced another as a whole.
 * @property {string | null} edited Path of the last edit, while more edits of it join the same step of undo.
 * @property {Moment[]} past
 * @property {Moment[]} future
 * @property {{[path: string]: {text: string, message: string}}} drafts  Invalid texts of fields, by path.
 * @property {Validation | null} validation  Validation of the revision `validated`.
 * @property {number} validated        Revision of `validation`.
 * @property {Derived | null} derived  Derived values of the last valid scenario.
 * @property {number} approved      Revision that the user allowed to run although it exceeds the budget.
 * @property {Run} run
 * @property {Result | null} result The last valid result.
 * @property {number} controller    Selected controller, if it exists.
 * @property {Span | null} window   Shown part of the time axis; null shows the whole run.
 * @property {(Span | null)[]} zooms  Previous windows, the latest last.
 * @property {string | null} gesture  The gesture that moves the window; all its movements are one step of `zooms`.
 * @property {boolean} box          Whether dragging on the time axis draws a zoom box.
 * @property {Span | null} picked   The current zoom box.
 * @property {Baseline | null} baseline  The run that others are compared with.
 * @property {number | null} harmonic  Number of the selected harmonic.
 * @property {boolean} difference   Whether the position chart shows the difference from the baseline.
 * @property {ViewPart | null} pendingView  The view of a link, until there is a result.
 * @property {{text: string, comparison: SenderComparison | null} | null} sender  The digests of the sender's run (part `d` of the link), and the comparison with them.
 * @property {number} axis          Axis of the motion view.
 * @property {"steps" | "mm" | "deg" | null} unit  Unit of the motion view; null is the unit in which the motion was typed.
 * @property {number[]} hiddenAxes  Axes that the motion view does not draw.
 * @property {string[] | null} quantities  Quantities of the motor view; null is the default.
 * @property {number | null} hover  Cycle under the pointer.
 * @property {{start: number, end: number, from: string, packet: number | null, bit: number | null} | null} highlighted  A packet, a part of it, an edge or a bit of the line, in cycles, which all views highlight. `from` is the view under the pointer.
 * @property {(number | null)[]} markers  Cycles of the markers 0 to 9.
 * @property {{a: number | null, b: number | null}} cursors  Cycles.
 * @property {number} row           Bit of the selected signal.
 * @property {{[channel: number]: boolean}} folds  Whether the user folded a channel, or, by bit, the decoders of RX or TX.
 * @property {boolean} allSignals   Whether signals that never change are shown, too.
 * @property {number | null} packet Selected packet.
 * @property {{text: string, kind: string, address: number | null, outcome: string, only: boolean}} filter  Search text and filters of the packets; `only` hides rows without a match.
 * @property {string} view          Tab on a narrow screen; "study" replaces all views, also on a wide one.
 * @property {StudyName} study      Open tab of the study.
 * @property {Panes} panes          Layout of the views, saved on this device.
 * @property {string[]} emptyViews  Views without content for this run.
 * @property {{[area: string]: string}} sides  The selected view of each shared area of a wide screen.
 * @property {{text: string, kind: "info" | "error", location?: TraceLocation | null, offer?: {label: string, scenario: Scenario}} | null} notice  About links, files and the engine.
 *
 * @typedef {{dispatch: (message: import("./message.js").Message) => void, now: () => State}} Page  The state and how to change it.
 */
export {};
