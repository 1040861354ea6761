//! Cost and summary of runs of stand-alone controllers (CONTROLLER.md).

use crate::{BUDGET_RECORDS, Cost};
use alloc::{format, vec::Vec};
use core::fmt;
use stepscope_controller::{Alarm, CheckedSetup, Press, StandAlone, State, TooManyGroups, trust_name};
use stepscope_peripheral::signal::{Record, Sink};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_scenario::{Cause, END_OF_TIME, Problem, Problems};

impl Cost {
    /// Runs the controllers up to the budget, because their cost has no closed form. Errors: too many groups begin.
    pub(crate) fn of_stand_alone(controllers: &CheckedSetup, run: Option<Cycles>) -> Result<Self, Problems> {
        let mut tried = StandAlone::new(controllers);
        let mut counted = Counted(0);
        let until = run.map_or(Instant::NEVER, |Cycles(run)| Instant(run));
        let is_short = tried.run_events(until, MAX_TRIED_EVENTS, &mut counted) && !counted.is_paused();
        if let Some(work) = tried.too_many_groups() {
            let path = format!("source.standalone[{}].groups", work.controller);
            return Err(Problem::new(path, Cause::TooManyGroups(work)).into());
        }
        // The end is unknown if the trial was aborted.
        let records = if is_short { counted.0 } else { counted.0.max(BUDGET_RECORDS + 1) };
        let end_cycle = match run {
            Some(Cycles(run)) => run,
            None if is_short => tried.now().0.min(END_OF_TIME),
            None => END_OF_TIME,
        };
        Ok(Self { records, sends: 0, bytes: 0, end_cycle, motor_grid_steps: 0 })
    }
}

/// Whether the run reaches an endless jog.
pub(crate) fn jogs_without_end(controllers: &CheckedSetup) -> bool {
    let mut tried = StandAlone::new(controllers);
    tried.run_events(Instant::NEVER, MAX_TRIED_EVENTS, &mut Counted(0));
    tried.jogs_without_end()
}

/// Maximum events of a trial.
const MAX_TRIED_EVENTS: u64 = 10_000_000;

struct Counted(u64);

impl Sink for Counted {
    fn record(&mut self, _: Record) {
        self.0 += 1;
    }

    fn is_paused(&self) -> bool {
        self.0 > BUDGET_RECORDS
    }
}

/// Results of a run of stand-alone controllers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StandAloneSummary {
    pub panels: Vec<PanelSummary>,
    pub digest: u64,
    /// Why the run ended, if too many groups began.
    pub too_many_groups: Option<TooManyGroups>,
}

/// Ignored presses listed one by one.
const MAX_LISTED: usize = 20;

/// Results of one stand-alone controller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PanelSummary {
    pub state: State,
    pub alarm: Alarm,
    /// Trust: 0 LOST, 1 HELD, 2 SURE.
    pub trust: u8,
    /// Its own position, in steps.
    pub position: i32,
    /// Distance of the axis from that position, in steps.
    pub axis_error: i64,
    pub records: usize,
    /// Writes of the most worn cell of its memory.
    pub most_writes: u32,
    /// Presses that had no effect.
    pub ignored: Vec<Press>,
}

impl StandAloneSummary {
    pub(crate) fn of(machine: &StandAlone) -> Self {
        let one = |index| {
            Some(PanelSummary {
                state: machine.state(index)?,
                alarm: machine.alarm(index)?,
                trust: machine.trust(index)?,
                position: machine.position(index)?,
                axis_error: machine.axis_error(index)?,
                records: machine.panel(index).len(),
                most_writes: machine.writes(index).iter().copied().max().unwrap_or(0),
                ignored: machine.ignored(index).to_vec(),
            })
        };
        Self {
            panels: (0..).map_while(one).collect(),
            digest: machine.panel_digest(),
            too_many_groups: machine.too_many_groups(),
        }
    }
}

impl fmt::Display for PanelSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { state, alarm, trust, position, axis_error, records, most_writes, ignored } = self;
        f.write_str(state.name())?;
        if *alarm != Alarm::None {
            write!(f, " {}", alarm.name())?;
        }
        write!(
            f,
            " trust {} position {position} axis_error {axis_error} records {records}",
            trust_name(*trust)
        )?;
        write!(f, " most_writes {most_writes} presses_without_meaning {}", ignored.len())
    }
}

impl fmt::Display for StandAloneSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, panel) in self.panels.iter().enumerate() {
            writeln!(f, "panel {index} {panel}")?;
            for Press { cycle, button, state } in panel.ignored.iter().take(MAX_LISTED) {
                writeln!(
                    f,
                    "press {index} {} in cycle {} did nothing in {}",
                    button.name(),
                    cycle.0,
                    state.name()
                )?;
            }
        }
        writeln!(f, "panels {:016x}", self.digest)?;
        self.too_many_groups
            .map_or(Ok(()), |error| writeln!(f, "ended controller {}: {error}", error.controller))
    }
}
