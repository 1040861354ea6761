/**
 * The messages that change the state. Types only.
 *
 * @typedef {import("./types.js").State} State
 * @typedef {{type: "edit", path: string, value: any, joins?: boolean, moved?: import("./paths.js").Moved}
 *   | {type: "draft", path: string, text: string, message: string}
 *   | {type: "committed"} | {type: "canceled", future: State["future"]}
 *   | {type: "replace", scenario: import("./types.js").Scenario, origin: import("./types.js").Origin}
 *   | {type: "undo"} | {type: "redo"}
 *   | {type: "validated", revision: number, validation: import("./types.js").Validation}
 *   | {type: "approve"}
 *   | {type: "running"} | {type: "progress", progress: import("./types.js").Progress}
 *   | {type: "done", revision: number, summary: import("./types.js").Summary, ms: number}
 *   | {type: "failed", message: string}
 *   | {type: "window", window: import("./types.js").Span | null, joins?: string} | {type: "back"}
 *   | {type: "box", on: boolean} | {type: "pick", picked: import("./types.js").Span | null}
 *   | {type: "baseline", baseline: State["baseline"]} | {type: "difference", on: boolean}
 *   | {type: "harmonic", harmonic: number | null}
 *   | {type: "open", view: import("./types.js").ViewPart}
 *   | {type: "sender", text: string} | {type: "compared", text: string, comparison: import("./types.js").SenderComparison}
 *   | {type: "hover", cycle: number | null}
 *   | {type: "highlight", highlighted: State["highlighted"]}
 *   | {type: "marker", digit: number, cycle: number | null}
 *   | {type: "cursor", which: "a" | "b", cycle: number | null}
 *   | {type: "row", row: number} | {type: "packet", packet: number | null}
 *   | {type: "filter", filter: Partial<State["filter"]>}
 *   | {type: "fold", channel: number, folded: boolean} | {type: "fold-all", folded: boolean}
 *   | {type: "all-signals", on: boolean}
 *   | {type: "controller", controller: number} | {type: "side", area: string, side: string}
 *   | {type: "quantities", names: string[]}
 *   | {type: "axis", axis: number} | {type: "unit", unit: State["unit"]} | {type: "axes", hidden: number[]}
 *   | {type: "pane", panes: Partial<import("./types.js").Panes>} | {type: "empty", view: string, isEmpty: boolean}
 *   | {type: "rows", rows: Partial<import("./row_choices.js").RowChoices>}
 *   | {type: "view", view: string} | {type: "study", study: import("./types.js").StudyName}
 *   | {type: "notice", notice: State["notice"]}} Message
 */
export {};
