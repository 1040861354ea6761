//! A run with the edges and packets of all controllers, in portions.
//!
//! ```
//! use stepscope_inspect::trace::recorded_run::RecordedRun;
//! use stepscope_sim::ValidatedScenario;
//!
//! let validated = ValidatedScenario::from_json("{}");
//! let mut run = RecordedRun::start(&validated, true).expect("no problems");
//! while !run.advance(1000).expect("it is short") {
//!     println!("{} cycles", run.cycles().0);
//! }
//! assert_eq!(run.summary().controllers[0].positions, [3200]);
//! assert_eq!(run.recordings()[0].packets.rows().len(), 200);
//! ```

use crate::motion::{actual_motion::Pulses, spectra::Spectra};
use crate::packets::packet_table::PacketTable;
use crate::trace::stored_run::{MAX_RECORDS, StoredRun};
use alloc::{sync::Arc, vec::Vec};
use stepscope_peripheral::signal::{Event, Record, Sink};
use stepscope_peripheral::trace::steps;
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_scenario::{Problems, Scenario};
use stepscope_sim::{Experiment, Run, RunLimits, Summary, ValidatedScenario, too_many_edges};

/// A run of a scenario. Once it is done, it never changes.
#[derive(Clone)]
pub struct RecordedRun {
    scenario: Arc<Scenario>,
    experiment: Arc<Experiment>,
    run: Run,
    recordings: Vec<StoredRun>,
    stores_edges: bool,
}

/// Records one controller; without edges, only its digest.
struct Recorder<'a> {
    stored: &'a mut StoredRun,
    stores_edges: bool,
}

impl Sink for Recorder<'_> {
    fn record(&mut self, record: Record) {
        if self.stores_edges {
            self.stored.record(record);
        } else {
            self.stored.digest.record(record);
        }
    }

    fn event(&mut self, at: Instant, event: Event) {
        if self.stores_edges {
            self.stored.event(at, event);
        }
    }
}

impl RecordedRun {
    /// A run before its first cycle. Without `stores_edges` it has no edges and packets, and needs no memory for them.
    ///
    /// # Errors
    /// All problems of the scenario, a run without an end, and more steps than can be stored.
    pub fn start(validated: &ValidatedScenario, stores_edges: bool) -> Result<Self, Problems> {
        let experiment = validated.experiment().map_err(Clone::clone)?;
        experiment.check_has_end()?;
        // Segments have a known number of steps; other edges are counted during the run.
        let steps = experiment.segments().map(|segments| segments.steps());
        if stores_edges && steps.is_some_and(|steps| steps > MAX_RECORDS / 2) {
            return Err(too_many_edges());
        }
        Ok(Self {
            scenario: Arc::clone(validated.scenario()),
            run: experiment.start(),
            recordings: (0..experiment.controllers()).map(|_| StoredRun::default()).collect(),
            experiment: Arc::clone(experiment),
            stores_edges,
        })
    }

    /// Runs for about `records` more edges of a controller, or grid steps of its motors; true at the end.
    ///
    /// # Errors
    /// More than [`MAX_RECORDS`] edges of all controllers, if they are stored.
    pub fn advance(&mut self, records: u64) -> Result<bool, Problems> {
        let records = records.max(1);
        let grid = self.experiment.plants().map(|plants| {
            plants.setups.iter().map(|setup| u64::from(setup.grid_cycles())).min().unwrap_or(1)
        });
        let cycle = grid.map_or(Instant::NEVER, |grid| {
            Instant(self.run.cycles().0.saturating_add(records.saturating_mul(grid)))
        });
        let stores_edges = self.stores_edges;
        let mut recorders: Vec<_> =
            self.recordings.iter_mut().map(|stored| Recorder { stored, stores_edges }).collect();
        let is_done =
            self.run.advance_observed::<_, ()>(RunLimits { cycle, records }, &mut recorders, &mut []);
        if is_done {
            self.recordings.iter_mut().for_each(|recording| recording.packets.finish());
        } else if stores_edges && self.recorded() > MAX_RECORDS {
            return Err(too_many_edges());
        }
        Ok(is_done)
    }

    fn recorded(&self) -> u64 {
        self.recordings.iter().map(|recording| recording.trace.len() as u64).sum()
    }

    /// Cycles that were run.
    pub fn cycles(&self) -> Cycles {
        self.run.cycles()
    }

    /// Whether edges and packets are stored.
    pub const fn stores_edges(&self) -> bool {
        self.stores_edges
    }

    /// The scenario of the run.
    pub const fn scenario(&self) -> &Arc<Scenario> {
        &self.scenario
    }

    /// The experiment of the run.
    pub const fn experiment(&self) -> &Arc<Experiment> {
        &self.experiment
    }

    /// The summary that the command prints.
    pub fn summary(&self) -> Summary {
        Summary::new(&self.experiment, &self.run, self.recordings.iter().map(|recording| &recording.digest))
    }

    /// One recording per controller; at least one.
    pub fn recordings(&self) -> &[StoredRun] {
        &self.recordings
    }

    /// The packets of a controller; `None` if it does not exist.
    pub fn packets(&self, controller: usize) -> Option<PacketTable<'_>> {
        let log = &self.recordings.get(controller)?.packets;
        Some(PacketTable::new(&self.experiment, &self.run, controller, log))
    }

    /// The spectra of the axis that the scenario selects in `analysis`; empty if there is no such controller.
    pub fn spectra(&self, controller: usize) -> Spectra {
        let Some(recording) = self.recordings.get(controller) else { return Spectra::default() };
        let axis = self.scenario.analysis.axis;
        let config = self.experiment.configs().nth(controller).unwrap_or_else(|| self.experiment.config());
        let plan = self.experiment.plans_of(controller).get(usize::from(axis));
        let steps = steps(&recording.trace, axis);
        let segments = self.experiment.segments().and_then(|lists| lists.lists().get(usize::from(axis)));
        let pulses = match plan {
            Some(_) => Pulses::of_run(axis, &steps, &recording.packets, segments, config),
            None => Pulses::recorded(axis, &steps, config.clock_hz()),
        };
        Spectra::of(&self.scenario, plan, &pulses)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::stored_run::record_run;
    use alloc::string::ToString;

    fn finished(json: &str, stores_edges: bool, records: u64) -> RecordedRun {
        let mut run = RecordedRun::start(&ValidatedScenario::from_json(json), stores_edges).expect(json);
        while !run.advance(records).expect("it is short") {}
        run
    }

    #[test]
    fn portions_give_the_edges_and_packets_of_a_whole_run() {
        let framed =
            r#"{"line":{"protocol":"framed","address":1},"controllers":[{"address":2,"axes":[{}]}]}"#;
        for json in ["{}", framed, r#"{"plant":{}}"#] {
            let found = finished(json, true, 777);
            let controllers = found.recordings().len();
            let (run, mut recordings) = record_run(found.experiment(), controllers).expect("it is short");
            for (index, (recording, expected)) in found.recordings().iter().zip(&mut recordings).enumerate() {
                expected.packets.finish();
                assert!(recording.trace == expected.trace, "{json}");
                let table = PacketTable::new(found.experiment(), &run, index, &expected.packets);
                let rows = (0..table.len()).map(|row| table.row(row));
                let packets = found.packets(index).expect("it exists");
                assert!((0..packets.len()).map(|row| packets.row(row)).eq(rows), "{json}");
            }
            assert!(found.packets(controllers).is_none());
            let counted = finished(json, false, 777);
            assert_eq!(counted.summary(), found.summary(), "{json}");
            assert!(counted.recordings().iter().all(|recording| recording.trace.is_empty()));
            assert!(counted.packets(0).is_some_and(|packets| packets.is_empty()));
        }
    }

    #[test]
    fn the_spectra_are_those_of_the_selected_axis() {
        let json = r#"{"bus":{"channels":2},"source":{"motion":{"axes":[{},{"moves":[{"sine":{"periods":4}}]}]}},"analysis":{"axis":1}}"#;
        let spectra = finished(json, true, 10_000).spectra(0);
        assert!(spectra.ideal.is_some_and(|ideal| ideal.position.distortion.is_some()));
        assert!(spectra.actual.is_some_and(|actual| actual.position.distortion.is_some()));
    }

    #[test]
    fn refusals_name_what_is_wrong() {
        let start = |json: &str, stores_edges| {
            let refused = RecordedRun::start(&ValidatedScenario::from_json(json), stores_edges).err();
            refused.map(|problems| problems.to_string())
        };
        let slots = r#"{"bus":{"slots":0}}"#;
        assert_eq!(start(slots, true).as_deref(), Some("bus.slots: 0 is out of range; use 1 to 127"));
        let long = r#"{"source":{"segments":{"channels":[{"segments":[{"steps":{"count":24000001}}]}]}}}"#;
        assert_eq!(start(long, true), Some(too_many_edges().to_string()));
        assert_eq!(start(long, false), None);
    }
}
