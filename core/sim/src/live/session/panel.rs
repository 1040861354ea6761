//! Sessions of stand-alone controllers: buttons instead of a line (LIVE H1, H2, H5).
//!
//! ```text
//! behind cycle N:  enter start 1 ──> N + 1   another change of start ──> N + 2
//! for 100 ms:      …  1 at N + 1, 0 at N + 1 + 100 ms, unless start changes before
//! ```

use alloc::{collections::VecDeque, vec::Vec};
use stepscope_controller::input::{Change, Input, Signal};
use stepscope_controller::{NotEntered, Refusal, StandAlone, limits};
use stepscope_peripheral::units::Instant;
use stepscope_scenario::PanelInput;

/// Maximum recorded inputs, as in a script.
pub const MAX_RECORDED_INPUTS: usize = *limits::INPUTS.end() as usize;

/// Whether half of the groups of a run have begun; the recording ends there, because it must be runnable.
pub(super) fn begins_many(machine: &StandAlone) -> bool {
    machine.too_many_groups().is_none() && machine.groups_begun() > limits::MAX_GROUPS_BEGUN / 2
}

/// An input and the index of its controller.
type OfController = (usize, Input);

/// Inputs entered so far, and levels that end later.
#[derive(Clone, Debug, Default)]
pub(super) struct Presses {
    entered: Vec<OfController>,
    /// Invariant: one per input at most, rising in time.
    later: VecDeque<OfController>,
}

fn is_same(one: OfController, other: OfController) -> bool {
    (one.0, one.1.change.name()) == (other.0, other.1.change.name())
}

impl Presses {
    pub(super) fn due(&self, to: Instant) -> Option<Instant> {
        self.later.front().map(|(_, input)| input.cycle).filter(|&cycle| cycle <= to)
    }

    /// Whether no level ends later.
    pub(super) fn are_done(&self) -> bool {
        self.later.is_empty()
    }

    pub(super) fn has_room(&self) -> bool {
        self.entered.len() < MAX_RECORDED_INPUTS
    }

    pub(super) fn forget(&mut self) {
        self.entered = Vec::new();
    }

    pub(super) fn script(&self, index: usize, now: Instant) -> Vec<PanelInput> {
        let own =
            self.entered.iter().filter(|(controller, input)| *controller == index && input.cycle <= now);
        own.map(|(_, input)| to_panel_input(*input)).collect()
    }

    /// Enters a change in the first future cycle in which its input has none; cancels a later level of that input.
    pub(super) fn enter(
        &mut self,
        machine: &mut StandAlone,
        controller: usize,
        change: Change,
    ) -> Result<Instant, NotEntered> {
        let mut cycle = machine.now();
        while let Err(why) = machine.enter(cycle, controller, change) {
            match why {
                NotEntered::Refused(Refusal::DuplicateInput { .. }) => cycle = cycle.next(),
                other => return Err(other),
            }
        }
        let entered = (controller, Input { cycle, change });
        self.later.retain(|&other| !is_same(other, entered));
        self.entered.push(entered);
        Ok(cycle)
    }

    pub(super) fn later(&mut self, controller: usize, at: Instant, (signal, level): (Signal, bool)) {
        let input = Input { cycle: at, change: Change::Level(signal, level) };
        let index = self.later.partition_point(|(_, other)| other.cycle <= at);
        self.later.insert(index, (controller, input));
    }

    pub(super) fn take(&mut self, to: Instant) -> Option<(usize, Change)> {
        self.due(to)?;
        self.later.pop_front().map(|(controller, input)| (controller, input.change))
    }
}

fn to_panel_input(Input { cycle, change }: Input) -> PanelInput {
    let blank = PanelInput { cycle: cycle.0, ..PanelInput::default() };
    match change {
        Change::Level(signal, level) => PanelInput { input: Some(signal), level: level.into(), ..blank },
        Change::Push(steps) => PanelInput { push_steps: Some(steps.into()), ..blank },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        noise::Random,
        session::{NotTheSession, Session},
    };
    use alloc::string::ToString;
    use stepscope_controller::State;
    use stepscope_peripheral::{trace::Digest, units::Cycles};
    use stepscope_scenario::{Scenario, Source};

    /// Ready after some 25 cycles, without debouncing; a program of 100 steps, a step every 1000 cycles.
    const QUICK: &str = r#"{ "clock_hz": 1000000, "source": { "standalone": [ { "self_test_cycles": 5, "debounce_cycles": 0,
        "max_speed_hz": 1000, "groups": [ { "move": { "length": 10, "speed_hz": 1000 } } ],
        "axis": { "min_switch_at_steps": -500 }, "memory": { "byte_write_cycles": 1, "hold_up_cycles": 40 } } ] } }"#;

    fn session(json: &str) -> Session {
        Session::new(&Scenario::from_json(json).expect("reads")).expect("no problems")
    }

    fn to(session: &mut Session, cycle: u64) {
        session.advance::<Digest>(Instant(cycle), &mut []);
    }

    /// Cycle, input and level of what is recorded.
    fn recorded(session: &Session) -> Vec<(u64, &'static str, u8)> {
        let Source::StandAlone(controllers) = session.recording().scenario.source else { return Vec::new() };
        let inputs = controllers.into_iter().flat_map(|controller| controller.inputs);
        inputs.map(|input| (input.cycle, input.input.map_or("push", Signal::name), input.level)).collect()
    }

    #[test]
    fn changes_of_an_input_take_consecutive_cycles() {
        let mut session = session(QUICK);
        to(&mut session, 99);
        for (signal, level, cycle) in [
            (Signal::Start, true, 100),
            (Signal::Start, false, 101),
            (Signal::Start, true, 102),
            (Signal::Pause, true, 100),
            (Signal::Pause, false, 101),
        ] {
            let at = session.enter(0, Change::Level(signal, level));
            assert_eq!(at, Ok(Instant(cycle)), "{signal:?} {level}");
        }
        assert_eq!(recorded(&session), [], "nothing of it has come");
        to(&mut session, 101);
        let come = [(100, "start", 1), (101, "start", 0), (100, "pause", 1), (101, "pause", 0)];
        assert_eq!(recorded(&session), come);
        session.recording().verify().expect("the same");
    }

    #[test]
    fn a_timed_press_ends_in_its_cycle_unless_changed() {
        for round in [1, 7, 100_000] {
            let mut session = session(QUICK);
            to(&mut session, 99);
            let pressed = session.enter_for(0, (Signal::JogPlus, true), Cycles(3000));
            assert_eq!(pressed, Ok(Instant(100)));
            assert!(!session.is_idle(), "it is to be let go");
            while session.now() < Instant(20_000) {
                let next = session.now().0 + round;
                to(&mut session, next.min(20_000));
            }
            assert_eq!(recorded(&session), [(100, "jog_plus", 1), (3100, "jog_plus", 0)], "{round}");
            let machine = session.run().stand_alone().expect("it is");
            assert_eq!((machine.state(0), machine.position(0)), (Some(State::Ready), Some(3)), "{round}");
        }
        let mut session = session(QUICK);
        let _ = session.enter_for(0, (Signal::Start, true), Cycles(50));
        to(&mut session, 20);
        // Released by hand and pressed permanently: the pending release would come too early.
        for level in [false, true] {
            session.enter(0, Change::Level(Signal::Start, level)).expect("it is to come");
        }
        to(&mut session, 200);
        assert_eq!(recorded(&session), [(1, "start", 1), (21, "start", 0), (22, "start", 1)]);
    }

    #[test]
    fn inputs_follow_the_rules_of_scripts_and_a_line_has_no_buttons() {
        let switch = Change::Level(Signal::LimitMin, true);
        let mut driven = session(QUICK);
        let why = driven.enter(0, switch).expect_err("the axis drives it").to_string();
        assert!(why.contains("limit_min") && why.contains("axis"), "{why}");
        assert_eq!(driven.enter(1, Change::Push(2)), Err(NotEntered::NoController));
        driven.receive(&[1, 2, 3]);
        assert_eq!(driven.received(), 0, "there is no line");
        assert_eq!(session("{}").enter(0, switch), Err(NotEntered::NoController));
    }

    #[test]
    fn inputs_of_the_scenario_are_ignored() {
        let json = QUICK.replace(
            "\"debounce_cycles\": 0,",
            r#""debounce_cycles": 0, "inputs": [ { "cycle": 50, "input": "start" } ],"#,
        );
        let mut session = session(&json);
        to(&mut session, 5000);
        assert_eq!(session.run().positions()[0], 0);
        assert!(session.is_idle());
    }

    #[test]
    fn random_presses_are_replayed_exactly() {
        let mut two = Scenario::from_json(QUICK).expect("reads");
        two.bus.channels = 2;
        if let Source::StandAlone(controllers) = &mut two.source {
            controllers.push(controllers[0].clone());
            controllers[1].axis = None;
            controllers[1].debounce_cycles = 30;
        }
        let (mut moved, mut alarms) = (0, 0);
        for seed in 0..300 {
            let mut random = Random::new(seed);
            let mut session = Session::new(&two).expect("no problems");
            for _ in 0..random.below(60) {
                let signal = Signal::ALL[random.below(Signal::ALL.len() as u64) as usize];
                // Power is mostly there, and the emergency stop mostly is not.
                let level = random.below(8) != 0 && signal != Signal::Estop;
                let controller = random.below(2) as usize;
                let _ = match random.below(4) {
                    0 => session.enter(controller, Change::Push(random.below(9) as i32 - 4)),
                    1 => session.enter(controller, Change::Level(signal, level)),
                    _ => session.enter_for(controller, (signal, level), Cycles(random.below(400))),
                };
                let pause = [1, 30, 3000][random.below(3) as usize];
                let next = session.now().0 + random.below(pause);
                to(&mut session, next);
            }
            let recording = session.recording();
            assert_eq!(recording.verify(), Ok(()), "seed {seed}: {}", recording.scenario.to_json());
            let text = recording.scenario.to_json();
            assert_eq!(Scenario::from_json(&text).as_ref(), Ok(&recording.scenario), "seed {seed}");
            moved += u32::from(session.run().positions()[0] != 0);
            let machine = session.run().stand_alone().expect("it is");
            alarms += u32::from(machine.state(0) == Some(State::Alarm));
        }
        assert!(moved > 50 && alarms > 20, "{moved} {alarms}");
    }

    #[test]
    fn a_session_continues_after_its_recording_is_full() {
        let mut session = session(QUICK);
        let mut press = |count: usize| {
            for index in 0..count {
                let level = Change::Level(Signal::In0, index % 2 == 0);
                let at = session.enter(0, level).expect("it is to come");
                to(&mut session, at.0);
            }
            session.clone()
        };
        assert!(press(MAX_RECORDED_INPUTS).records_all());
        let more = press(3);
        assert!(!more.records_all());
        let recording = more.recording();
        assert_eq!(recording.scenario.run_cycles, Some(MAX_RECORDED_INPUTS as u64 + 1));
        recording.verify().expect("the same");
    }

    #[test]
    fn an_endless_program_is_recorded_up_to_the_limit_of_groups() {
        let json = QUICK.replace(
            r#"[ { "move": { "length": 10, "speed_hz": 1000 } } ]"#,
            r#"[ { "set": {} }, { "set": { "level": 0 } }, { "jump": {} } ]"#,
        );
        let mut session = session(&json);
        to(&mut session, 99);
        session.enter(0, Change::Level(Signal::Start, true)).expect("it is to come");
        for round in 1..=55 {
            to(&mut session, round * 10_000);
        }
        assert!(!session.records_all());
        session.recording().verify().expect("the same");
        to(&mut session, 1_200_000);
        assert!(session.run().stand_alone().expect("it is").too_many_groups().is_some());
        session.recording().verify().expect("the same");
    }

    #[test]
    fn a_recording_with_other_panels_fails() {
        let mut session = session(QUICK);
        to(&mut session, 99);
        let _ = session.enter(0, Change::Level(Signal::Debug, true));
        to(&mut session, 200);
        let mut recording = session.recording();
        recording.verify().expect("the same");
        // The bus shows no difference.
        let Source::StandAlone(controllers) = &mut recording.scenario.source else { panic!("it is") };
        controllers[0].inputs.clear();
        assert_eq!(recording.verify(), Err(NotTheSession::PanelsDiffer));
    }
}
