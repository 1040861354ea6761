//! The plants attached to the controllers of a run, and their feedback (PLANT F7).
//!
//! A plant receives its controller's edges. With overload protection, the run stops after each cycle of an ADC conversion,
//! because an overload acts last in that cycle. The result of a self-test applies at the end of the boot.

use crate::controllers::{Controllers, RunLimits};
use alloc::vec::Vec;
use stepscope_peripheral::signal::{Event, Levels, Record, Sink};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::{config::Config, device::SelfTest};
use stepscope_plant::settling::{SHARE, Sample, StepResponse};
use stepscope_plant::{Observer, Plant, measures::Measures};
use stepscope_scenario::Plants;

#[derive(Clone, Debug)]
pub(crate) struct AttachedPlants {
    /// One per controller.
    pub(crate) plants: Vec<AttachedPlant>,
    tail: Cycles,
    /// When a run without a given end became idle; an overload may end this.
    idle_since: Option<Instant>,
    /// The stop that some controllers have not reached, because one paused after its maximum number of records.
    pending_stop: Option<Instant>,
    pub(crate) ended: Option<Instant>,
}

#[derive(Clone, Debug)]
pub(crate) struct AttachedPlant {
    pub(crate) plant: Plant,
    pub(crate) measures: Measures,
    feedback: Feedback,
    levels: Levels,
    last_record: Instant,
    /// The last fall of a STEP.
    last_fall: Option<Instant>,
    tests: Vec<SelfTest>,
    /// Channels (bits) that stepped and whose drivers stayed on until the end of their test.
    tested: u16,
    /// The end of a boot with a self-test, while it is in the future.
    boot_end: Option<Instant>,
    /// Settling time per channel measured by the self-test, in cycles.
    pub(crate) settling_times: Vec<Option<u64>>,
    /// Cycles between ADC conversions, with overload protection.
    conversion_period: Option<u64>,
    /// Cycle of the last overload that switched the drivers off.
    pub(crate) overload_at: Option<u64>,
}

/// Observes what a plant feeds back to its controller.
#[derive(Clone, Debug, Default)]
struct Feedback {
    /// Cycle of an overload that the controller has not received.
    overload: Option<u64>,
    /// Conversions during the self-test, up to cycle `samples_end`.
    samples: Vec<Sample>,
    samples_end: u64,
}

impl Observer for Feedback {
    fn point(&mut self, plant: &Plant) {
        let events = plant.events();
        if events.overload {
            self.overload = Some(plant.cycle());
        }
        if events.converted && plant.cycle() <= self.samples_end {
            // Integer ADC codes, so that sums are exact.
            let current = plant.current_sensor().code().into();
            self.samples.push(Sample { cycle: plant.cycle(), current });
        }
    }
}

/// Passes the records of a controller to its plant and to a sink. Pauses after `max_records`.
pub(crate) struct PlantSink<'a, S, O> {
    attached: &'a mut AttachedPlant,
    sink: Option<&'a mut S>,
    observer: Option<&'a mut O>,
    records: u64,
    max_records: u64,
}

impl<S, O: Observer> PlantSink<'_, S, O> {
    fn plant_and_observers(&mut self) -> (&mut Plant, impl Observer) {
        let AttachedPlant { plant, measures, feedback, .. } = &mut *self.attached;
        (plant, (measures, (feedback, self.observer.as_deref_mut())))
    }

    fn advance(&mut self, cycle: u64) {
        let (plant, mut observers) = self.plant_and_observers();
        plant.advance(cycle, &mut observers);
    }
}

impl<S: Sink, O: Observer> Sink for PlantSink<'_, S, O> {
    fn record(&mut self, record: Record) {
        self.attached.track(record);
        self.records += 1;
        {
            let (plant, mut observers) = self.plant_and_observers();
            plant.record(record, &mut observers);
        }
        if let Some(sink) = &mut self.sink {
            sink.record(record);
        }
    }

    fn event(&mut self, at: Instant, event: Event) {
        if let Some(sink) = &mut self.sink {
            sink.event(at, event);
        }
    }

    fn is_paused(&self) -> bool {
        self.records >= self.max_records
    }
}

impl AttachedPlant {
    /// Follows the levels and the steps of the self-test.
    fn track(&mut self, record: Record) {
        let rises = record.levels.step() & !self.levels.step();
        let switches_off = self.levels.has(Levels::EN) && !record.levels.has(Levels::EN);
        for (channel, test) in self.tests.iter().enumerate() {
            if switches_off && record.cycle <= test.rise + test.step_period {
                self.tested &= !(1 << channel);
            }
            if rises >> channel & 1 != 0 && record.cycle == test.rise {
                self.tested |= 1 << channel;
            }
        }
        if self.levels.step() & !record.levels.step() != 0 {
            self.last_fall = Some(record.cycle);
        }
        self.levels = record.levels;
        self.last_record = record.cycle;
    }

    /// The next cycle that follows a possible feedback.
    fn next_stop(&self, now: Instant) -> Instant {
        let boot_end = self.boot_end.filter(|&end| end > now).unwrap_or(Instant::NEVER);
        // Cycle 0 has no conversion.
        let conversion =
            self.conversion_period.map(|period| Instant(now.0.max(1).div_ceil(period) * period + 1));
        boot_end.min(conversion.unwrap_or(Instant::NEVER))
    }

    /// The settling time of each channel; `None` if its test was stopped or did not settle.
    fn measured_settling_times(&mut self) -> Vec<Option<u64>> {
        let samples = core::mem::take(&mut self.feedback.samples);
        let settling_time = |(channel, test): (usize, &SelfTest)| {
            let response = StepResponse::of(&samples, test.start.0, test.rise.0, test.step_period.0, SHARE)?;
            response.reached.filter(|_| self.tested >> channel & 1 != 0)
        };
        self.tests.iter().enumerate().map(settling_time).collect()
    }
}

impl AttachedPlants {
    pub(crate) fn new<'a>(plants: &Plants, configs: impl Iterator<Item = &'a Config>) -> Self {
        let tail = plants.tail;
        let plants = plants.setups.iter().zip(configs).filter_map(|(setup, config)| {
            // The setup is valid, because the scenario was validated.
            let plant = Plant::new(setup).ok()?;
            let tests: Vec<SelfTest> = (0..config.channels())
                .filter(|_| plants.self_test)
                .map(|channel| SelfTest::of(config, channel))
                .collect();
            let samples_end = tests.last().map_or(0, |test| (test.rise + test.step_period).0);
            let conversion_period = setup
                .protection
                .as_ref()
                .map(|_| u64::from(setup.current_sensor.adc_steps) * u64::from(setup.grid_cycles()));
            Some(AttachedPlant {
                measures: Measures::new(&plant),
                feedback: Feedback { samples_end, ..Feedback::default() },
                plant,
                levels: Levels::RESET,
                last_record: Instant::RESET,
                last_fall: None,
                boot_end: plants.self_test.then(|| config.boot()),
                settling_times: Vec::new(),
                tested: 0,
                tests,
                conversion_period,
                overload_at: None,
            })
        });
        Self { plants: plants.collect(), tail, idle_since: None, pending_stop: None, ended: None }
    }

    fn plant_sinks<'a, S, O>(
        &'a mut self,
        max_records: u64,
        sinks: &'a mut [S],
        observers: &'a mut [O],
    ) -> Vec<PlantSink<'a, S, O>> {
        let (mut sinks, mut observers) = (sinks.iter_mut(), observers.iter_mut());
        let attach = |attached| {
            let (sink, observer) = (sinks.next(), observers.next());
            PlantSink { attached, sink, observer, records: 0, max_records }
        };
        self.plants.iter_mut().map(attach).collect()
    }

    /// Runs to the limits or to the end; true at the end.
    pub(crate) fn advance(
        &mut self,
        run: &mut Controllers,
        limits: RunLimits,
        sinks: &mut [impl Sink],
        observers: &mut [impl Observer],
    ) -> bool {
        let mut records = 0;
        while self.ended.is_none() && run.furthest_cycle() < limits.cycle && records < limits.records {
            let stop = self.pending_stop.take().unwrap_or_else(|| self.next_stop(run)).min(limits.cycle);
            let mut plant_sinks = self.plant_sinks(limits.records - records, sinks, observers);
            run.run_to(stop, &mut plant_sinks);
            records += plant_sinks.iter().map(|sink| sink.records).max().unwrap_or(0);
            if run.all_have_reached(stop) {
                self.apply_feedback(run, None, sinks, observers);
            } else {
                self.pending_stop = Some(stop);
            }
        }
        self.ended.is_some()
    }

    fn next_stop(&self, run: &Controllers) -> Instant {
        let now = run.furthest_cycle();
        let stops = self.plants.iter().map(|attached| attached.next_stop(now)).chain(run.end);
        stops.fold(Instant(now.0.saturating_add(IDLE_CHECK_CYCLES)), Instant::min)
    }

    pub(crate) fn clock(
        &mut self,
        run: &mut Controllers,
        sinks: &mut [impl Sink],
        observers: &mut [impl Observer],
    ) {
        run.clock(&mut self.plant_sinks(u64::MAX, sinks, observers));
        self.pending_stop = None;
        let idle_since = self.idle_since.unwrap_or_else(|| run.furthest_cycle());
        self.apply_feedback(run, Some(idle_since), sinks, observers);
    }

    /// Applies the plants' feedback, and finishes at the end. `first_idle` is that of a run clock by clock.
    fn apply_feedback(
        &mut self,
        run: &mut Controllers,
        first_idle: Option<Instant>,
        sinks: &mut [impl Sink],
        observers: &mut [impl Observer],
    ) {
        let now = run.furthest_cycle();
        self.idle_since = self.find_idle(run, first_idle);
        let end = self.end(run);
        let is_past = end.is_some_and(|end| end < now);
        if !is_past {
            let plant_sinks = self.plant_sinks(u64::MAX, sinks, observers);
            for (index, mut sink) in plant_sinks.into_iter().enumerate() {
                sink.feed_back(run, index, Instant(now.0 - 1));
            }
            // The feedback may have ended the idle time.
            self.idle_since = self.find_idle(run, first_idle);
        }
        let is_end = end == Some(now) && (run.end.is_some() || self.idle_since.is_some());
        if let Some(end) = end.filter(|_| is_past || is_end) {
            self.finish_at(end, sinks, observers);
        }
    }

    fn find_idle(&self, run: &Controllers, first_idle: Option<Instant>) -> Option<Instant> {
        let last = self.plants.iter().map(|attached| attached.last_record).max().unwrap_or(Instant::RESET);
        run.idle_since(last).map(|idle_since| first_idle.unwrap_or(idle_since))
    }

    fn finish_at(&mut self, end: Instant, sinks: &mut [impl Sink], observers: &mut [impl Observer]) {
        self.plant_sinks(u64::MAX, sinks, observers).iter_mut().for_each(|sink| sink.advance(end.0));
        self.ended = Some(end);
    }

    /// The given end; otherwise the first idle cycle, but not before the end of a boot with a self-test and the tail after
    /// the last fall of STEP.
    fn end(&self, run: &Controllers) -> Option<Instant> {
        if let Some(end) = run.end {
            return Some(end);
        }
        let boot_end = self.plants.iter().filter_map(|attached| attached.boot_end).max();
        let last_fall = self.plants.iter().filter_map(|attached| attached.last_fall).max();
        let min_end = boot_end.max(last_fall.map(|fall| fall + self.tail)).unwrap_or(Instant::RESET);
        self.idle_since.map(|idle_since| idle_since.max(min_end))
    }
}

/// A run without a given end checks after this number of cycles whether it is idle.
const IDLE_CHECK_CYCLES: u64 = 1 << 24;

impl<S: Sink, O: Observer> PlantSink<'_, S, O> {
    /// Applies an overload in `cycle`, and the result of a self-test at the end of the boot.
    fn feed_back(&mut self, run: &mut Controllers, index: usize, cycle: Instant) {
        self.advance(cycle.0);
        if self.attached.feedback.overload.take() == Some(cycle.0) {
            let was_powered = self.attached.levels.has(Levels::EN);
            // If the drivers are off already, only the fault changes.
            if run.stop_on_overload(index, self) && was_powered {
                self.attached.overload_at = Some(cycle.0);
            }
        }
        if self.attached.boot_end == Some(cycle.next()) {
            self.attached.boot_end = None;
            let times = self.attached.measured_settling_times();
            let max = times.iter().copied().max().flatten();
            let have_all_settled = times.iter().all(Option::is_some);
            run.set_settling_time(index, max.filter(|_| have_all_settled).map(Cycles));
            self.attached.settling_times = times;
        }
    }
}
