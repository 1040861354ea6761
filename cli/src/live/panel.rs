//! The panel of served controllers: converts lines to presses after the model's current cycle (LIVE H1, H2).

use super::buttons::{HELP, Line};
use super::status_line::StatusLine;
use std::{collections::VecDeque, fmt::Write};
use stepscope_core::controller::input::{Change, Signal};
use stepscope_core::controller::{Alarm, Press, StandAlone, trust_name};
use stepscope_core::{peripheral::units::Instant, sim::session::Session};

const MAX_LINE: usize = 200;
const MAX_LINES: usize = 256;

#[derive(Default)]
pub(crate) struct Panel {
    incomplete: Vec<u8>,
    lines: VecDeque<Vec<u8>>,
    /// A `wait` line delays the lines after it until this cycle.
    pub(crate) wait_until: Option<Instant>,
    /// Reported presses without effect, per controller.
    reported: Vec<usize>,
}

impl Panel {
    pub(crate) fn room(&self) -> usize {
        if self.lines.len() < MAX_LINES { usize::MAX } else { 0 }
    }

    pub(crate) fn receive(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            match byte {
                b'\n' | b'\r' => self.end_line(),
                // One additional byte marks the line as too long.
                _ if self.incomplete.len() <= MAX_LINE => self.incomplete.push(byte),
                _ => {}
            }
        }
    }

    /// Also called at the end of input: the last line may have no line feed.
    pub(crate) fn end_line(&mut self) {
        let line = std::mem::take(&mut self.incomplete);
        if !line.trim_ascii().is_empty() {
            self.lines.push_back(line);
        }
    }

    pub(crate) fn is_done(&self) -> bool {
        self.lines.is_empty() && self.wait_until.is_none()
    }

    pub(crate) fn execute(&mut self, session: &mut Session, status: &mut StatusLine) {
        if self.wait_until.is_some_and(|until| session.now() >= until) {
            self.wait_until = None;
        }
        while self.wait_until.is_none() {
            let Some(line) = self.lines.pop_front() else { break };
            match parse(&line) {
                Ok(line) => self.apply(line, session, status),
                Err(why) => status.note(&why),
            }
        }
        self.report_ignored(session, status);
    }

    fn apply(&mut self, line: Line, session: &mut Session, status: &mut StatusLine) {
        let clock_hz = session.experiment().config().clock_hz();
        let entered = match line {
            Line::Empty => return,
            Line::Help => return status.note(&help()),
            Line::Wait(span) => {
                self.wait_until = Some(session.now() + span.cycles(clock_hz));
                return;
            }
            Line::Change(controller, Change::Level(signal, level), Some(span)) => {
                session.enter_for(controller, (signal, level), span.cycles(clock_hz))
            }
            Line::Change(controller, change, _) => session.enter(controller, change),
        };
        if let Err(why) = entered {
            status.note(&why.to_string());
        }
    }

    /// Reports presses without effect since the last call.
    fn report_ignored(&mut self, session: &Session, status: &mut StatusLine) {
        let Some(machine) = session.run().stand_alone() else { return };
        self.reported.resize(machine.controllers(), 0);
        for (index, count) in self.reported.iter_mut().enumerate() {
            for Press { button, state, .. } in machine.ignored(index).iter().skip(*count) {
                status.note(&format!("{} has no effect in {}", button.name(), state.name()));
            }
            *count = machine.ignored(index).len();
        }
    }
}

fn help() -> String {
    let names: Vec<&str> = Signal::ALL.iter().map(|signal| signal.name()).collect();
    format!("{HELP}\nInputs: {}", names.join(" "))
}

pub(crate) fn status(machine: &StandAlone) -> String {
    let mut text = String::new();
    for index in 0..machine.controllers().min(4) {
        let (Some(state), Some(alarm), Some(trust)) =
            (machine.state(index), machine.alarm(index), machine.trust(index))
        else {
            break;
        };
        let _ = write!(text, "  {}", state.name());
        if alarm != Alarm::None {
            let _ = write!(text, " {}", alarm.name());
        }
        let position = machine.position(index).unwrap_or(0);
        let _ = write!(text, " position {position} {}", trust_name(trust));
    }
    if let Some(work) = machine.too_many_groups() {
        let _ = write!(text, "  ended: {work}");
    }
    text
}

fn parse(line: &[u8]) -> Result<Line, String> {
    if line.len() > MAX_LINE {
        return Err(format!(
            "a line of more than {MAX_LINE} bytes was ignored; use the lines that `help` lists"
        ));
    }
    String::from_utf8_lossy(line).parse().map_err(|why| format!("{why}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use stepscope_core::{peripheral::trace::Digest, scenario::Scenario};

    /// Ready after 5 cycles of 1 us, without debouncing.
    fn session() -> Session {
        let json = r#"{ "clock_hz": 1000000, "source": { "standalone": [ { "self_test_cycles": 5, "debounce_cycles": 0,
            "max_speed_hz": 1000, "groups": [ { "move": { "speed_hz": 1000 } } ] } ] } }"#;
        Session::new(&Scenario::from_json(json).expect("reads")).expect("no problems")
    }

    /// The inputs that the recording of a session with these lines contains.
    fn recorded(typed: &[u8], cycles: u64) -> Vec<(u64, String)> {
        let (mut session, mut panel, mut line) = (session(), Panel::default(), StatusLine::new(false));
        session.advance::<Digest>(Instant(9), &mut []);
        panel.receive(typed);
        panel.end_line();
        panel.execute(&mut session, &mut line);
        while let Some(until) = panel.wait_until {
            session.advance::<Digest>(until, &mut []);
            panel.execute(&mut session, &mut line);
        }
        session.advance::<Digest>(Instant(cycles), &mut []);
        let recording = session.recording();
        recording.verify().expect("the same");
        let stepscope_core::scenario::Source::StandAlone(controllers) = recording.scenario.source else {
            panic!("it is")
        };
        let name = |signal: Option<Signal>| signal.map_or("push", Signal::name);
        let inputs = controllers[0].inputs.iter();
        inputs.map(|input| (input.cycle, format!("{} {}", name(input.input), input.level))).collect()
    }

    #[test]
    fn measures_a_line_before_invalid_bytes_are_replaced() {
        let is_too_long = |line: &[u8]| parse(line).is_err_and(|why| why.contains("more than 200 bytes"));
        assert_eq!([&[0xff; 70][..], &[b'x'; 200], &[b'x'; 201]].map(is_too_long), [false, false, true]);
    }

    #[test]
    fn executes_lines_in_their_cycles_and_ignores_invalid_ones() {
        // A second change of a signal comes one cycle later. A recorded push has the default level.
        let typed = b"press start 20us\ndance\r\n\nwait 1ms\npower 0\nwait 0s\npower 1\npush -3";
        let expected =
            [(10, "start 1"), (30, "start 0"), (1010, "power 0"), (1011, "power 1"), (1010, "push 1")];
        let expected: Vec<(u64, String)> = expected.map(|(cycle, text)| (cycle, text.to_owned())).into();
        assert_eq!(recorded(typed, 2000), expected);
        let long = [&[b'x'; 5000][..], b"\npower 0"].concat();
        assert_eq!(recorded(&long, 2000), [(10, "power 0".to_owned())]);
    }
}
