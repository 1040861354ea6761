//! From a scenario to its trace: the whole line in one call.

#[cfg(feature = "plant")]
use crate::plants::{Behind, PlantsBehind};
use crate::{
    Cost,
    alone::Alone,
    bus::Bus,
    controller_plan::{self, ControllerPlan},
    controllers::Controllers,
    framed_host::{Conversation, FramedHost, Progress},
};
use alloc::{boxed::Box, rc::Rc, vec::Vec};
use core::slice;
use stepscope_motion::AxisPlan;
use stepscope_peripheral::{
    config::Config,
    device::{Device, Faults, SegmentEngine},
    segment::CheckedSegments,
    signal::{Event, MAX_CHANNELS, Record, Sink, Unpaused},
    units::{Cycles, Instant},
    wire::{ForcedLevel, Line, Schedule},
};
#[cfg(feature = "plant")]
use stepscope_plant::{Observer, Plant, measures::PlantResult};
use stepscope_scenario::{Checked, END_OF_TIME, Problem, Scenario, ValueError};

/// Most bytes that a host may have to send: as many as the most ticks of 16 channels take on an addressed
/// raw line.
const MAX_LINE_BYTES: u64 = 2_000_000 * 17;

/// Most steps of the grid, of all motors together, that a run may take (PLANT F1).
const MAX_MOTOR_STEPS: u64 = 10_000_000_000;

/// A scenario that has been judged in every respect, with its motions planned and its packets made.
#[derive(Clone, Debug)]
pub struct Experiment {
    checked: Checked,
    /// What each controller is to do.
    ///
    /// Invariant: one at least, the scenario's own first.
    controllers: Vec<ControllerPlan>,
    /// What the host sends without waiting for replies.
    schedule: Rc<Schedule>,
    /// What the segment engine runs, where segments run the scenario; then nothing is sent.
    segments: Option<Rc<CheckedSegments>>,
    line_load: Option<f64>,
    cost: Cost,
}

impl Experiment {
    /// Judges a scenario and prepares its run.
    ///
    /// # Errors
    /// Every problem of the scenario, each with its path.
    pub fn new(scenario: &Scenario) -> Result<Self, Vec<Problem>> {
        let mut problems = Vec::new();
        let checked = scenario.check().map_err(|found| problems.extend(found)).ok();
        let plans = controller_plan::plans(scenario);
        // A motor's number that no plant can have was told by the plant already.
        let is_new = |problem: &Problem| problems.iter().all(|told: &Problem| told.path != problem.path);
        let plans = plans.map_err(|found| found.into_iter().filter(is_new).collect::<Vec<_>>());
        let plans = plans.map_err(|found| problems.extend(found)).ok();
        let Some(mut checked) = checked else { return Err(problems) };
        let line_load = controller_plan::line_load(&checked).map_err(|problem| problems.push(problem)).ok();
        let Some(plans) = plans else { return Err(problems) };
        let controllers = match controller_plan::controller_plans(&checked, plans) {
            Ok(controllers) if problems.is_empty() => controllers,
            judged => {
                problems.extend(judged.err().unwrap_or_default());
                return Err(problems);
            }
        };
        debug_assert!(!controllers.is_empty() && controllers.len() == checked.configs.len());
        let (schedule, forced) = controller_plan::schedule(&checked, &controllers);
        checked.forced.extend(forced);
        let segments = controller_plan::segments(&checked, &controllers)?.map(Rc::new);
        let cost = match &segments {
            Some(segments) => Cost::of_segments(segments, checked.run),
            None => Cost::of(&checked, &controllers, &schedule),
        };
        #[cfg(feature = "controller")]
        let cost = match &checked.stand_alone {
            Some(stand_alone) => Cost::of_stand_alone(stand_alone, checked.run)?,
            None => cost,
        };
        if cost.bytes > MAX_LINE_BYTES {
            let (given, most) = (cost.bytes as f64, MAX_LINE_BYTES as f64);
            let cause = ValueError::TooMuch { given, most, of: "bytes of all frames and their repetitions" };
            return Err(alloc::vec![Problem::new("source", cause)]);
        }
        #[cfg(feature = "plant")]
        let cost = cost.with_plants(&checked);
        if cost.motor_steps > MAX_MOTOR_STEPS {
            let (given, most) = (cost.motor_steps as f64, MAX_MOTOR_STEPS as f64);
            let cause = ValueError::TooMuch { given, most, of: "motor-steps of the plant" };
            return Err(alloc::vec![Problem::new("plant.step_cycles", cause)]);
        }
        if cost.end_cycle > END_OF_TIME {
            let cause =
                ValueError::TooMuch { given: cost.end_cycle as f64, most: END_OF_TIME as f64, of: "cycles" };
            return Err(alloc::vec![Problem::new("source", cause)]);
        }
        let line_load = line_load.flatten().filter(|_| controllers.iter().any(ControllerPlan::has_ticks));
        Ok(Self { checked, controllers, schedule: Rc::new(schedule), segments, line_load, cost })
    }

    /// Reads, judges and prepares a scenario.
    ///
    /// # Errors
    /// Every problem, those of types and those of numbers together.
    pub fn from_json(text: &str) -> Result<Self, Vec<Problem>> {
        let (scenario, unread) = Scenario::from_json_lenient(text);
        Self::of_lenient(&scenario, unread)
    }

    /// Judges a scenario of which some fields could not be read, `unread`: these stand at their
    /// defaults while the rest is judged, and what follows from several fields together waits until
    /// all can be read.
    ///
    /// # Errors
    /// `unread` and what else is wrong.
    pub fn of_lenient(scenario: &Scenario, unread: Vec<Problem>) -> Result<Self, Vec<Problem>> {
        let judged = Self::new(scenario);
        if unread.is_empty() {
            return judged;
        }
        let mut problems = unread.clone();
        problems.extend(judged.err().unwrap_or_default().into_iter().filter(|problem| {
            !problem.cause.joins_fields() && !unread.iter().any(|bad| problem.path.starts_with(&bad.path))
        }));
        Err(problems)
    }

    /// How many controllers are on the line, 1 to 32.
    #[must_use]
    pub fn controllers(&self) -> usize {
        self.controllers.len()
    }

    /// The configuration of the first controller: that of `bus` and `line.address`.
    #[must_use]
    pub fn config(&self) -> &Config {
        self.first().config()
    }

    /// The configuration of each controller, in the order of the scenario.
    pub fn configs(&self) -> impl ExactSizeIterator<Item = &Config> {
        self.controllers.iter().map(ControllerPlan::config)
    }

    /// The host's rate on the line.
    #[must_use]
    pub const fn baud(&self) -> u32 {
        self.checked.baud
    }

    /// The plan of each axis of the first controller; empty where the source is no motion.
    #[must_use]
    pub fn plans(&self) -> &[AxisPlan] {
        self.first().plans()
    }

    /// The plan of each axis of controller `index`.
    #[must_use]
    pub fn plans_of(&self, index: usize) -> &[AxisPlan] {
        self.controllers.get(index).map_or(&[], ControllerPlan::plans)
    }

    /// The ticks that controller `index` is ordered, a byte a channel (A5), tick after tick; empty
    /// where the source is a line script.
    #[must_use]
    pub fn ticks_of(&self, index: usize) -> &[u8] {
        self.controllers.get(index).map_or(&[], ControllerPlan::ticks)
    }

    /// How far the host of a framed line has come in `run` with controller `index`; `None` where nobody
    /// waits for replies, or that controller has nothing to do.
    #[must_use]
    pub fn host_progress(&self, run: &Run, index: usize) -> Option<Progress> {
        run.host()?.progress().nth(self.job(index)?)
    }

    /// Ticks that controller `index` has acknowledged in `run`; `None` as [`Self::host_progress`].
    #[must_use]
    pub fn host_acknowledged(&self, run: &Run, index: usize) -> Option<u32> {
        run.host()?.acknowledged().nth(self.job(index)?)
    }

    /// What a host says on a real line to have the ticks done (LIVE H3), from cycle `start` of its own clock on, an opening
    /// tick without steps first; `None` where nobody waits for replies.
    #[must_use]
    pub fn conversation(&self, start: Instant) -> Option<Conversation> {
        let bit = Config::bit_of(self.config().clock_hz(), self.baud());
        let jobs = || controller_plan::jobs(&self.controllers);
        let waits = self.checked.waits_for_replies();
        waits.then(|| Conversation::new(jobs(), &self.checked.host, bit, start).with_opening_tick())
    }

    /// Which of the host's jobs controller `index` is: it has one for each that has ticks.
    #[must_use]
    pub fn job(&self, index: usize) -> Option<usize> {
        self.controllers.get(index).filter(|plan| plan.has_ticks())?;
        Some(self.controllers.iter().take(index).filter(|plan| plan.has_ticks()).count())
    }

    fn first(&self) -> &ControllerPlan {
        // There is always a first one.
        &self.controllers[0]
    }

    /// What the host sends without waiting for replies; empty for the host of a framed line, whose
    /// sends a run tells ([`Run::schedule`]).
    #[must_use]
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// What the segment engine runs; `None` where ticks run the scenario.
    #[must_use]
    pub fn segments(&self) -> Option<&CheckedSegments> {
        self.segments.as_deref()
    }

    /// Whether a run has no end because a jog button of a stand-alone controller stays pressed: no limit is ahead, and the
    /// scenario has no `run_cycles`.
    #[cfg(feature = "controller")]
    #[must_use]
    pub fn jogs_without_end(&self) -> bool {
        let has_end = self.checked.run.is_some() || self.cost.end_cycle < END_OF_TIME;
        !has_end && self.stand_alone().is_some_and(crate::stand_alone::jogs_without_end)
    }

    /// The stand-alone controllers; `None` where a line or segments run the scenario.
    #[cfg(feature = "controller")]
    #[must_use]
    pub const fn stand_alone(&self) -> Option<&stepscope_controller::Checked> {
        self.checked.stand_alone.as_ref()
    }

    /// What runs it by itself.
    fn alone(&self) -> Option<Alone> {
        let segments =
            self.segments.clone().map(|lists| Alone::Segments(Box::new(SegmentEngine::new(lists))));
        #[cfg(feature = "controller")]
        let segments = segments.or_else(|| Some(Alone::panels(self.checked.stand_alone.as_ref()?)));
        segments
    }

    /// What the run will cost.
    #[must_use]
    pub const fn cost(&self) -> Cost {
        self.cost
    }

    /// The part of the line's time that packets, frames and replies take while all controllers move,
    /// 0..=1; `None` where nothing paced is sent.
    #[must_use]
    pub const fn line_load(&self) -> Option<f64> {
        self.line_load
    }

    /// A run before cycle 0.
    #[must_use]
    pub fn start(&self) -> Run {
        let Checked { baud, forced, run, .. } = &self.checked;
        let clock_hz = self.config().clock_hz();
        let line = Line::new(Rc::clone(&self.schedule), forced, clock_hz, *baud);
        let host = self.host();
        Run {
            controllers: Controllers {
                bus: Bus::new(line, host, self.configs().map(|config| self.device(config)).collect()),
                alone: self.alone(),
                end: run.map(|cycles| Instant(cycles.0)),
            },
            #[cfg(feature = "plant")]
            plants: self.plants().map(|plants| Box::new(PlantsBehind::new(plants, self.configs()))),
        }
    }

    #[cfg(not(feature = "plant"))]
    fn device(&self, config: &Config) -> Device {
        Device::new(config)
    }

    #[cfg(feature = "plant")]
    fn device(&self, config: &Config) -> Device {
        let tests = self.checked.plants.as_ref().is_some_and(|plants| plants.self_test);
        if tests { Device::with_self_test(config) } else { Device::new(config) }
    }

    /// The plants behind the controllers, where the scenario has them.
    #[cfg(feature = "plant")]
    #[must_use]
    pub const fn plants(&self) -> Option<&stepscope_scenario::Plants> {
        self.checked.plants.as_ref()
    }

    /// The host of a framed line, where it has ticks to send.
    fn host(&self) -> Option<FramedHost> {
        self.checked
            .waits_for_replies()
            .then(|| controller_plan::framed_host(&self.checked, &self.controllers))
    }

    /// The whole run, at the fast speed; `sink` takes what the first controller does.
    pub fn run(&self, sink: &mut impl Sink) -> Run {
        self.run_each(slice::from_mut(sink))
    }

    /// The whole run, at the fast speed, with a sink for each controller; those without one run all
    /// the same.
    pub fn run_each(&self, sinks: &mut [impl Sink]) -> Run {
        let mut run = self.start();
        let mut sinks: Vec<_> = sinks.iter_mut().map(Unpaused).collect();
        while !run.is_done() {
            run.run_to(run.controllers.end.unwrap_or(Instant::NEVER), &mut sinks);
        }
        run
    }

    /// The whole run clock by clock: slow, and the measure of the fast speed.
    pub fn run_clock_by_clock(&self, sink: &mut impl Sink) -> Run {
        self.run_each_clock_by_clock(slice::from_mut(sink))
    }

    /// As [`Self::run_each`], clock by clock.
    pub fn run_each_clock_by_clock(&self, sinks: &mut [impl Sink]) -> Run {
        let mut run = self.start();
        while !run.is_done() {
            run.clock(sinks);
        }
        run
    }
}

/// A run under way.
#[derive(Clone, Debug)]
pub struct Run {
    controllers: Controllers,
    /// What the edges drive.
    #[cfg(feature = "plant")]
    plants: Option<Box<PlantsBehind>>,
}

impl Run {
    /// The first controller as it is now; where segments run the scenario, one before cycle 0.
    #[must_use]
    pub fn device(&self) -> &Device {
        self.controllers.bus.first()
    }

    /// All controllers as they are now, in the order of the scenario.
    pub fn devices(&self) -> impl Iterator<Item = &Device> {
        self.controllers.bus.devices()
    }

    /// The host of a framed line as it is now; `None` where nobody waits for replies.
    #[must_use]
    pub const fn host(&self) -> Option<&FramedHost> {
        self.controllers.bus.host()
    }

    /// What the host has sent, and what it will send as far as that is known. Another run can take it
    /// as its source (A9).
    #[must_use]
    pub fn schedule(&self) -> &Schedule {
        self.controllers.bus.line().schedule()
    }

    /// The levels that have been forced on the line and will be as far as that is known, those of noise
    /// among them, rising in time. Together with [`Self::schedule`] they are all that is done to the line.
    #[must_use]
    pub fn forced(&self) -> &[ForcedLevel] {
        self.controllers.bus.line().forced()
    }

    /// Position counters of the first controller, or of the segment engine (DESIGN A3).
    #[must_use]
    pub fn positions(&self) -> [i32; MAX_CHANNELS] {
        self.controllers.alone.as_ref().map_or_else(|| self.device().positions(), Alone::positions)
    }

    /// The stand-alone controllers as they are now; `None` where a line or segments run the scenario.
    #[cfg(feature = "controller")]
    #[must_use]
    pub fn stand_alone(&self) -> Option<&stepscope_controller::StandAlone> {
        self.controllers.alone.as_ref()?.stand_alone()
    }

    /// The same, to be pressed.
    #[cfg(feature = "controller")]
    pub(crate) fn stand_alone_mut(&mut self) -> Option<&mut stepscope_controller::StandAlone> {
        self.controllers.alone.as_mut()?.stand_alone_mut()
    }

    /// Faults of the first controller so far, or of the segment engine.
    #[must_use]
    pub fn faults(&self) -> Faults {
        self.controllers.alone.as_ref().map_or_else(|| self.device().faults(), Alone::faults)
    }

    /// Ticks of the first controller that have ended; segments have none.
    #[must_use]
    pub fn ticks_done(&self) -> u32 {
        self.device().ticks_done()
    }

    /// Cycles that have been run.
    #[must_use]
    pub fn cycles(&self) -> Cycles {
        #[cfg(feature = "plant")]
        if let Some(ended) = self.plants.as_ref().and_then(|plants| plants.ended) {
            return Cycles(ended.0);
        }
        Cycles(self.controllers.reached().0)
    }

    /// Whether the run is over.
    #[must_use]
    #[inline]
    pub fn is_done(&self) -> bool {
        #[cfg(feature = "plant")]
        if let Some(plants) = &self.plants {
            return plants.ended.is_some();
        }
        self.controllers.are_done()
    }

    /// Goes on until the first controller has made `records` more (a few more may come) or to the
    /// end; true at the end.
    pub fn advance(&mut self, records: u64, sink: &mut impl Sink) -> bool {
        self.advance_each(records, slice::from_mut(sink))
    }

    /// Goes on until one controller has made `records` more, with a sink for each; true at the end.
    pub fn advance_each(&mut self, records: u64, sinks: &mut [impl Sink]) -> bool {
        #[cfg(feature = "plant")]
        if self.plants.is_some() {
            return self.advance_observed::<_, ()>((Instant::NEVER, records), sinks, &mut []);
        }
        let mut slices: Vec<_> = sinks.iter_mut().map(|sink| Slice { sink, left: records }).collect();
        let end = self.controllers.end.unwrap_or(Instant::NEVER);
        self.controllers.run_to(end, &mut slices);
        self.is_done()
    }

    /// Leaves the end open: it goes on as far as it is asked to, also where nothing can change any more.
    pub(crate) const fn without_end(&mut self) {
        self.controllers.end = Some(Instant(END_OF_TIME));
    }

    /// Goes on to cycle `end`, the first that is not run, with a sink for each controller.
    pub(crate) fn run_to(&mut self, end: Instant, sinks: &mut [impl Sink]) {
        #[cfg(feature = "plant")]
        if self.plants.is_some() {
            self.advance_observed::<_, ()>((end, u64::MAX), sinks, &mut []);
            return;
        }
        self.controllers.run_to(end, sinks);
    }

    /// All controllers of the line, and what is done to it.
    pub(crate) const fn bus_mut(&mut self) -> &mut Bus {
        &mut self.controllers.bus
    }

    /// Whether nothing changes any more unless something is sent or pressed.
    pub(crate) fn is_at_rest(&self) -> bool {
        self.controllers.alone.as_ref().map_or_else(|| self.controllers.bus.is_over(), Alone::at_rest)
    }

    /// Goes on to a cycle, or until a controller has made so many records more, with a sink and an observer of its plant for
    /// each; true at the end. A run without plants stands still.
    #[cfg(feature = "plant")]
    pub fn advance_observed<S: Sink, O: Observer>(
        &mut self,
        until: (Instant, u64),
        sinks: &mut [S],
        observers: &mut [O],
    ) -> bool {
        let Self { controllers, plants } = self;
        plants.as_mut().is_none_or(|plants| plants.advance(controllers, until, sinks, observers))
    }

    /// One cycle, with a sink and an observer for each controller.
    #[cfg(feature = "plant")]
    pub(crate) fn clock_observed<S: Sink, O: Observer>(&mut self, sinks: &mut [S], observers: &mut [O]) {
        if let Some(plants) = &mut self.plants {
            plants.clock(&mut self.controllers, sinks, observers);
        }
    }

    #[cfg(feature = "plant")]
    fn behind(&self, controller: usize) -> Option<&Behind> {
        self.plants.as_ref()?.behind.get(controller)
    }

    /// The plant behind a controller.
    #[cfg(feature = "plant")]
    #[must_use]
    pub fn plant(&self, controller: usize) -> Option<&Plant> {
        self.behind(controller).map(|behind| &behind.plant)
    }

    /// What the self-test found on each channel of a controller, in cycles; empty before the end of its boot.
    #[cfg(feature = "plant")]
    #[must_use]
    pub fn self_test(&self, controller: usize) -> &[Option<u64>] {
        self.behind(controller).map_or(&[], |behind| &behind.found)
    }

    /// Cycle of the last overload of a controller.
    #[cfg(feature = "plant")]
    #[must_use]
    pub fn overload(&self, controller: usize) -> Option<u64> {
        self.behind(controller)?.overload_at
    }

    /// What each plant has done so far.
    #[cfg(feature = "plant")]
    #[must_use]
    pub fn results(&self) -> Vec<PlantResult> {
        let all = (0..).map_while(|index| self.behind(index));
        all.map(|behind| behind.measures.result(&behind.plant)).collect()
    }

    /// One cycle, with a sink for each controller.
    pub fn clock(&mut self, sinks: &mut [impl Sink]) {
        #[cfg(feature = "plant")]
        if self.plants.is_some() {
            return self.clock_observed::<_, ()>(sinks, &mut []);
        }
        self.controllers.clock(sinks);
    }
}

/// A sink that asks for a pause after so many records.
struct Slice<'a, S> {
    sink: &'a mut S,
    left: u64,
}

impl<S: Sink> Sink for Slice<'_, S> {
    #[inline(always)]
    fn record(&mut self, record: Record) {
        self.left = self.left.saturating_sub(1);
        self.sink.record(record);
    }

    #[inline(always)]
    fn record_all(&mut self, records: impl ExactSizeIterator<Item = Record> + Clone) {
        self.left = self.left.saturating_sub(records.len() as u64);
        self.sink.record_all(records);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.sink.event(at, event);
    }

    fn paused(&self) -> bool {
        self.left == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::String;

    fn paths(json: &str) -> Vec<String> {
        Experiment::from_json(json)
            .err()
            .unwrap_or_default()
            .into_iter()
            .map(|problem| problem.path)
            .collect()
    }

    #[test]
    fn problems_of_types_and_numbers_come_together_and_none_is_invented() {
        let rows: &[(&str, &[&str])] = &[
            ("{}", &[]),
            // Too slow a line does not hide too fast a motion.
            (
                r#"{"line":{"baud":1200},"source":{"motion":{"axes":[{"moves":[{"constant":{"speed":{"steps_s":100000}}}]}]}}}"#,
                &["line.baud", "source.motion.axes[0]"],
            ),
            // Packets of two bytes are not judged by the default of a field that cannot be read.
            (
                r#"{"bus":{"channels":"2"},"source":{"packets":{"packets":["8001","0180"]}}}"#,
                &["bus.channels"],
            ),
            // Entries that cannot be read do not move the others.
            (
                r#"{"source":{"motion":{"axes":[{"moves":["bad",{"dwell":{"duration_s":-1}}]}]}}}"#,
                &["source.motion.axes[0].moves[0]", "source.motion.axes[0].moves[1].dwell.duration_s"],
            ),
            (r#"{"bus":{"slots":200},"title":5,"clock_hz":3}"#, &["title", "clock_hz", "bus.slots"]),
        ];
        for (json, expected) in rows {
            assert_eq!(paths(json), *expected, "{json}");
        }
    }

    #[test]
    fn many_entries_of_the_wrong_type_are_judged_in_few_readings() {
        let json = alloc::format!(
            r#"{{"source":{{"motion":{{"axes":[{{"moves":[{}5]}}]}}}}}}"#,
            "{},".repeat(11_000)
        );
        assert!(paths(&json).len() <= 101);
        let json =
            alloc::format!(r#"{{"source":{{"packets":{{"packets":[{}""]}}}}}}"#, "\"\",".repeat(20_000));
        assert!(paths(&json).len() <= 101);
    }

    #[test]
    fn a_whole_run_goes_to_its_end_whatever_its_sink_asks_for() {
        #[derive(Default)]
        struct Pausing(Vec<Record>);

        impl Sink for Pausing {
            fn record(&mut self, record: Record) {
                self.0.push(record);
            }

            fn paused(&self) -> bool {
                self.0.len() >= 50
            }
        }

        let experiment = Experiment::from_json("{}").expect("no problems");
        let (mut pausing, mut all) = (Pausing::default(), Vec::new());
        assert_eq!(experiment.run(&mut pausing).cycles(), experiment.run(&mut all).cycles());
        assert!(pausing.0 == all && all.len() > 50, "{} records", all.len());
    }

    #[test]
    fn a_scripted_runs_end_counts_the_ticks_that_wait() {
        let json = r#"{"source":{"line":{"sends":[{"bytes":"0505050505050505"}]}},"bus":{"boot_cycles":0}}"#;
        let experiment = Experiment::from_json(json).expect("no problems");
        let run = experiment.run(&mut Vec::new());
        assert!(run.cycles().0 > 8 * 32_000);
        assert!(run.cycles().0 <= experiment.cost().end_cycle);
    }
}
