import assert from "node:assert/strict";
import { test } from "node:test";
import { bandsOf } from "../../web/shell/grid.js";
import * as layout from "../../web/shell/pane_layout.js";
import { initial } from "../../web/state/initial.js";
import { update } from "../../web/state/update.js";

const start = initial({ source: {} });
const edge = (pane) => layout.EDGES.find((each) => each.pane === pane);
const bands = bandsOf(layout.shownViews(start));
const sizes = { before: 400, after: 600, heights: [400, 250, 200], bands, total: 850 + 16 };

test("there is a line for every pair of neighbors", () => {
  assert.deepEqual(
    layout.EDGES.map(({ pane, upright }) => [pane, upright]),
    [
      ["form", true],
      ["motion", false],
      ["pulses", false],
      ["packets", true],
    ],
  );
});

test("an edge moves between the minimum sizes of its panes", () => {
  const form = edge("form");
  assert.deepEqual(layout.resized(form, 450.4, sizes), { form: 450 });
  assert.deepEqual(layout.resized(form, 0, sizes), { form: 270 });
  assert.deepEqual(layout.resized(form, 1e6, sizes), { form: 520 });
  const { columns } = layout.resized(edge("packets"), 250, sizes);
  assert.deepEqual(columns, [0.25, 0.75]);
});

test("a moved height leaves the other bands as they are", () => {
  const { rows } = layout.resized(edge("motion"), 300, { ...sizes, before: 400, after: 250 });
  assert.deepEqual(
    rows.map((part) => Math.round(part * 850)),
    [300, 350, 200],
  );
  assert.deepEqual(layout.unsized(edge("motion")), { rows: null });
  assert.deepEqual(layout.unsized(edge("packets")), { columns: null });
  assert.deepEqual(layout.unsized(edge("form")), { form: null });
});

const apply = (state, panes) => update(state, { type: "pane", panes });

test("a view folds and unfolds", () => {
  const folded = apply(start, layout.folded(start, "pulses"));
  assert.ok(layout.isSmall(folded, "pulses"));
  assert.ok(!layout.isSmall(apply(folded, layout.folded(folded, "pulses")), "pulses"));
});

test("an empty view is small until it is expanded", () => {
  const bare = update(start, { type: "empty", view: "packets", isEmpty: true });
  assert.ok(layout.isSmall(bare, "packets"));
  const open = apply(bare, layout.folded(bare, "packets"));
  assert.ok(!layout.isSmall(open, "packets"));
  assert.ok(layout.isSmall(apply(open, layout.folded(open, "packets")), "packets"));
});

test("one view fills the screen, and then no view is small", () => {
  const folded = apply(start, layout.folded(start, "pulses"));
  const most = apply(folded, layout.maximized(folded, "motion"));
  assert.equal(layout.largestOf(most), "motion");
  assert.ok(!layout.isSmall(most, "pulses"));
  assert.equal(layout.largestOf(apply(most, layout.maximized(most, "motion"))), null);
  assert.equal(layout.largestOf(update(start, { type: "view", view: "study" })), "study");
});

test("an empty maximized view is restored", () => {
  const most = apply(start, layout.maximized(start, "packets"));
  assert.equal(layout.largestOf(update(most, { type: "empty", view: "packets", isEmpty: true })), null);
  const bare = update(start, { type: "empty", view: "packets", isEmpty: true });
  assert.equal(layout.largestOf(apply(bare, layout.maximized(bare, "packets"))), "packets");
});

test("saved panes are read as far as they fit this page", () => {
  assert.equal(layout.readPanes(null), null);
  assert.equal(layout.readPanes("broken"), null);
  const read = (panes) => layout.readPanes(JSON.stringify(panes));
  const rows = [
    [{ form: 300, rows: [1, 1, 1], columns: [0.5, 0.5], folded: ["pulses", "gone"] }, 300, [1, 1, 1], ["pulses"]],
    [{ form: 0, rows: [1, 1] }, 0, null, []],
    [{ form: 5, rows: [0, 1, 1], folded: "pulses" }, null, null, []],
  ];
  for (const [panes, form, heights, folded] of rows) {
    const found = read(panes);
    assert.deepEqual([found.form, found.rows, found.folded], [form, heights, folded]);
  }
});
