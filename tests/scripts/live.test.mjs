import assert from "node:assert/strict";
import { test } from "node:test";
import { controlsOf, unsettledText } from "../../web/shell/live/controls.js";
import { outcome, reportText } from "../../web/shell/live/report.js";
import { LiveSession } from "../../web/shell/live/session.js";

const PORT = {};
const role = (why = "", state = {}) => ({ why, baud: 115_200, margin_ms: 100, state: { ticks: 3, ...state } });
const facts = (more = {}) => ({ stream: role(), serve: role(), ...more });
const replied = { delay_ms: 1, model_ms: 2, reply: "ACK" };
const framed = {
  text: "",
  verified: true,
  why: null,
  stop_acknowledged: false,
  difference: null,
  lost: "",
  stopped: false,
  ms: 1000,
};

/** A dialog with a port. */
function session({ port = PORT, unsettled = null, found = facts() } = {}) {
  const made = new LiveSession({ port, unsettled });
  if (found) made.setFacts(found);
  return made;
}

/** A dialog that streams, with one reply. */
function streaming() {
  const made = session();
  made.begin("stream", false, "turn");
  made.exchanged([replied]);
  return made;
}

const controls = (of, more = {}) =>
  controlsOf(of, { role: "stream", scenario: { source: { motion: {} } }, noPort: "", isInFront: true, ...more });

test("a device that has replied is unsettled until its end is verified", () => {
  const stream = streaming();
  assert.equal(stream.device.unsettled, stream.sent);
  assert.deepEqual(stream.delays, { own: [1], model: [2] });
  stream.reported({ ...framed, verified: false, why: "no reply" });
  assert.notEqual(stream.device.unsettled, null);
  const good = streaming();
  good.reported(framed);
  assert.equal(good.device.unsettled, null);
});

test("a device that has not replied got no tick and stays settled", () => {
  const stream = session();
  stream.begin("stream", false, "");
  stream.exchanged([{ delay_ms: null, model_ms: null, reply: null }]);
  assert.equal(stream.device.unsettled, null);
});

test("STOP uses the settings of the unsettled stream, not of the experiment", () => {
  const earlier = { json: "old", title: "old", baud: 9600, raw: false, port: null };
  const next = session({ unsettled: earlier });
  next.json = "new";
  assert.deepEqual(next.pressStop(), { action: "begin", text: "" });
  next.begin("stream", true, "new");
  assert.deepEqual([next.sent.json, next.sent.baud, next.sent.port], ["old", 9600, PORT]);
});

test("a press of STOP stays pending until it has reached the device", () => {
  const stream = streaming();
  assert.equal(stream.pressStop().action, "stop");
  assert.ok(stream.stopPressed);
  // The stop was too late for this stream, which ended without a confirmation.
  stream.reported({ ...framed, verified: false, why: "lost" });
  assert.ok(stream.stopPressed);
  assert.equal(stream.closed(), false);
  const late = streaming();
  late.reported(framed);
  assert.match(late.pressStop().text, /as soon as the port is free/);
  assert.ok(late.stopPressed);
});

test("a confirmed STOP or a verified end needs no other STOP", () => {
  for (const more of [{}, { verified: false, stopped: true, stop_acknowledged: true }]) {
    const stream = streaming();
    stream.pressStop();
    stream.reported({ ...framed, ...more });
    assert.ok(!stream.stopPressed);
  }
});

test("STOP of raw packets only ends the sending", () => {
  const raw = session({ found: facts({ stream: role("", { lead: 2, lead_ms: 1 }) }) });
  raw.begin("stream", false, "");
  assert.ok(raw.sent.raw);
  assert.equal(raw.pressStop().action, "end");
  raw.reported({ raw: { sent: 1, packets: 2, stood: 0, left_ms: 5, text: "" }, lost: "", stopped: true, ms: 1 });
  assert.equal(raw.pressStop().action, "none");
  assert.ok(!raw.stopPressed);
});

test("there is nothing to stop while serving, or without a port", () => {
  const serving = session();
  serving.begin("serve", false, "");
  assert.equal(serving.pressStop().action, "none");
  assert.equal(session({ port: null }).pressStop().action, "none");
});

test("a start with an unsettled device needs a second press", () => {
  const next = session({ unsettled: { baud: 1 } });
  assert.match(next.warning(), /press STOP first/);
  assert.equal(next.warning(), "");
  next.begin("stream", false, "");
  assert.notEqual(next.warning(), "");
  assert.equal(session().warning(), "");
});

test("an impossible role is replaced only at first", () => {
  const impossible = facts({ stream: role("no line") });
  const first = session({ found: null });
  assert.equal(first.setFacts(impossible), "serve");
  assert.equal(first.setFacts(impossible), null);
  assert.equal(session({ found: null }).setFacts(facts()), null);
});

test("a failed worker leaves a streaming device unsettled", () => {
  const stream = session();
  stream.begin("stream", false, "");
  assert.match(stream.failed("out of memory"), /^The transfer failed: out of memory\. The device executes its queue/);
  assert.equal(stream.device.unsettled, stream.sent);
  assert.equal(stream.closed(), true);
  const idle = session();
  assert.equal(idle.failed("gone"), "");
  assert.match(idle.broken, /failed: gone/);
});

test("start needs a port, an experiment that can be sent and an idle dialog", () => {
  const rows = [
    [session(), {}, false, ""],
    [session({ port: null }), {}, true, "Choose a port first"],
    [session({ found: facts({ stream: role("no line") }) }), {}, true, "Not available: no line."],
    [session({ found: null }), {}, true, "Loading…"],
    [session(), { noPort: "no serial" }, true, "no serial"],
    [streaming(), {}, true, ""],
  ];
  for (const [of, more, disabled, title] of rows) {
    const { start } = controls(of, more);
    assert.deepEqual([start.disabled, start.title], [disabled, title]);
  }
});

test("STOP is available while a device may move", () => {
  const { stop, close, aside } = controls(streaming(), { isInFront: false });
  assert.deepEqual([stop.hidden, stop.disabled, close.disabled, aside.hidden], [false, false, true, false]);
  assert.match(stop.title, /\(Esc\)/);
  const unsettled = controls(session({ unsettled: { raw: false }, found: null }), { role: "serve" });
  assert.deepEqual([unsettled.stop.hidden, unsettled.stop.disabled], [false, false]);
  const serving = session();
  serving.begin("serve", false, "");
  assert.ok(controls(serving, { role: "serve" }).stop.hidden);
});

test("errors are marked once the experiment is known", () => {
  assert.equal(controls(session({ found: null })).about.isError, false);
  assert.equal(controls(session({ found: facts({ stream: role("no line") }) })).about.isError, true);
  assert.equal(controls(session()).about.isError, false);
});

test("the dialog says first that a device is unsettled", () => {
  assert.equal(unsettledText({ port: null, unsettled: null }), "");
  assert.match(
    unsettledText({ port: null, unsettled: { baud: 9600 } }),
    /choose its port, then press STOP\. STOP is sent at 9600 baud/,
  );
});

test("an outcome states only confirmed results", () => {
  const rows = [
    [framed, true, /^Verified/],
    [{ ...framed, verified: false, why: "no reply." }, false, /^Not verified: no reply\.$/],
    [{ ...framed, stopped: true }, false, /^STOP is not confirmed/],
    [{ ...framed, stopped: true, stop_acknowledged: true }, true, /^STOP is confirmed/],
    [{ ...framed, stopped: true, lost: "gone." }, false, /The port is lost: gone\.$/],
  ];
  for (const [reported, good, expected] of rows) {
    const found = outcome(reported);
    assert.equal(found.good, good);
    assert.match(found.text, expected);
  }
});

test("a report has the median and the longest of all delays", () => {
  const text = reportText("turn", "2026-01-01", framed, { own: [5, 1, 3], model: [2] });
  assert.match(text, /delay of 3 replies: median 3\.00 ms, maximum 5\.00 ms; median of the model 2\.00 ms/);
  assert.match(text, /all replies match the model/);
});
