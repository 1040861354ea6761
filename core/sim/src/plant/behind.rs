//! The plants behind the controllers of a run, and their feedback (PLANT F7).
//!
//! A plant follows its controller's edges. With a protection, the run stops after each cycle of a conversion, so that an
//! overload acts last in that cycle; the result of a self-test applies at the end of the boot.

use crate::controllers::Controllers;
use alloc::vec::Vec;
use stepscope_peripheral::{
    config::Config,
    device::SelfTest,
    signal::{Event, Levels, Record, Sink},
    units::{Cycles, Instant},
};
use stepscope_plant::{
    Observer, Plant,
    measures::Measures,
    settling::{SHARE, Sample, StepResponse},
};
use stepscope_scenario::Plants;

#[derive(Clone, Debug)]
pub(crate) struct PlantsBehind {
    pub(crate) behind: Vec<Behind>,
    tail: Cycles,
    /// When a run without a given end became idle; an overload may wake it.
    idle_from: Option<Instant>,
    pub(crate) ended: Option<Instant>,
}

/// A plant behind its controller.
#[derive(Clone, Debug)]
pub(crate) struct Behind {
    pub(crate) plant: Plant,
    pub(crate) measures: Measures,
    watch: Watch,
    levels: Levels,
    /// The last record, and the last fall of a STEP.
    last: Instant,
    last_fall: Option<Instant>,
    tests: Vec<SelfTest>,
    /// Channels that stepped with the drivers on until the end of their part.
    tested: u16,
    /// The end of a boot with a self-test, until it has come.
    boot: Option<Instant>,
    /// What the self-test found on each channel.
    pub(crate) found: Vec<Option<u64>>,
    /// Cycles between conversions of a protection.
    conversion: Option<u64>,
    /// Cycle of the last overload that switched the drivers off.
    pub(crate) overload_at: Option<u64>,
}

/// Collects feedback to the controller.
#[derive(Clone, Debug, Default)]
struct Watch {
    overload: Option<u64>,
    /// Conversions in the self-test.
    samples: Vec<Sample>,
    until: u64,
}

impl Observer for Watch {
    fn point(&mut self, plant: &Plant) {
        let events = plant.events();
        if events.overload {
            self.overload = Some(plant.cycle());
        }
        if events.converted && plant.cycle() <= self.until {
            // Whole codes, whose sum has no rounding.
            let current = plant.current_sensor().code().into();
            self.samples.push(Sample { cycle: plant.cycle(), current });
        }
    }
}

/// Passes records to the plant and on to the sink.
pub(crate) struct Wired<'a, S, O> {
    behind: &'a mut Behind,
    sink: Option<&'a mut S>,
    observer: Option<&'a mut O>,
    records: u64,
}

impl<S, O: Observer> Wired<'_, S, O> {
    fn advance(&mut self, cycle: u64) {
        let Behind { plant, measures, watch, .. } = &mut *self.behind;
        plant.advance(cycle, &mut (measures, (watch, self.observer.as_deref_mut())));
    }
}

impl<S: Sink, O: Observer> Sink for Wired<'_, S, O> {
    fn record(&mut self, record: Record) {
        let Behind { plant, measures, watch, .. } = &mut *self.behind;
        plant.record(record, &mut (measures, (watch, self.observer.as_deref_mut())));
        self.behind.follow(record);
        self.records += 1;
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
        false
    }
}

impl Behind {
    fn follow(&mut self, record: Record) {
        let rises = record.levels.step() & !self.levels.step();
        let is_off = self.levels.has(Levels::EN) && !record.levels.has(Levels::EN);
        for (channel, test) in self.tests.iter().enumerate() {
            if is_off && record.cycle <= test.rise + test.step {
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
        self.last = record.cycle;
    }

    /// The first cycle after one in which the plant may act.
    fn next_stop(&self, now: Instant) -> Instant {
        let boot = self.boot.filter(|&boot| boot > now).unwrap_or(Instant::NEVER);
        // Cycle 0 has no conversion.
        let conversion = self.conversion.map(|cycles| Instant(now.0.max(1).div_ceil(cycles) * cycles + 1));
        boot.min(conversion.unwrap_or(Instant::NEVER))
    }

    /// The settling time of each channel.
    fn measured(&mut self) -> Vec<Option<u64>> {
        let samples = core::mem::take(&mut self.watch.samples);
        let part = |(channel, test): (usize, &SelfTest)| {
            // A part that was stopped has none.
            let response = StepResponse::of(&samples, test.start.0, test.rise.0, test.step.0, SHARE)?;
            response.reached.filter(|_| self.tested >> channel & 1 != 0)
        };
        self.tests.iter().enumerate().map(part).collect()
    }
}

impl PlantsBehind {
    pub(crate) fn new<'a>(plants: &Plants, configs: impl Iterator<Item = &'a Config>) -> Self {
        let behind = plants.setups.iter().zip(configs).filter_map(|(setup, config)| {
            // It was validated with the scenario.
            let plant = Plant::new(setup).ok()?;
            let tests: Vec<SelfTest> = (0..config.channels())
                .filter(|_| plants.self_test)
                .map(|channel| SelfTest::of(config, channel))
                .collect();
            let until = tests.last().map_or(0, |test| (test.rise + test.step).0);
            let conversion = setup
                .protection
                .as_ref()
                .map(|_| u64::from(setup.current_sensor.adc_steps) * u64::from(setup.grid_cycles()));
            Some(Behind {
                measures: Measures::new(&plant),
                watch: Watch { until, ..Watch::default() },
                plant,
                levels: Levels::RESET,
                last: Instant::RESET,
                last_fall: None,
                boot: plants.self_test.then(|| config.boot()),
                found: Vec::new(),
                tested: 0,
                tests,
                conversion,
                overload_at: None,
            })
        });
        Self { behind: behind.collect(), tail: plants.tail, idle_from: None, ended: None }
    }

    fn wired<'a, S, O>(&'a mut self, sinks: &'a mut [S], observers: &'a mut [O]) -> Vec<Wired<'a, S, O>> {
        let (mut sinks, mut observers) = (sinks.iter_mut(), observers.iter_mut());
        let wire = |behind| Wired { behind, sink: sinks.next(), observer: observers.next(), records: 0 };
        self.behind.iter_mut().map(wire).collect()
    }

    /// Runs to `target`, to the end, or until a controller has made `records` more. True at the end.
    pub(crate) fn advance(
        &mut self,
        run: &mut Controllers,
        (target, records): (Instant, u64),
        sinks: &mut [impl Sink],
        observers: &mut [impl Observer],
    ) -> bool {
        let mut made = 0;
        while self.ended.is_none() && run.reached() < target && made < records {
            let now = run.reached();
            // A run without a given end checks now and then whether it is idle.
            let portion = target.min(Instant(now.0.saturating_add(PORTION)));
            let stops = self.behind.iter().map(|behind| behind.next_stop(now));
            let stop = stops.chain(run.end).fold(portion, Instant::min);
            let mut wired = self.wired(sinks, observers);
            run.run_to(stop, &mut wired);
            made += wired.iter().map(|wired| wired.records).max().unwrap_or(0);
            self.after(run, None, sinks, observers);
        }
        self.ended.is_some()
    }

    pub(crate) fn clock(
        &mut self,
        run: &mut Controllers,
        sinks: &mut [impl Sink],
        observers: &mut [impl Observer],
    ) {
        let mut wired = self.wired(sinks, observers);
        run.clock(&mut wired);
        let idle_from = self.idle_from.unwrap_or_else(|| run.reached());
        self.after(run, Some(idle_from), sinks, observers);
    }

    /// Lets the plants act last in the cycle just run, and finds the end. `seen`: clock by clock, the first idle cycle.
    fn after(
        &mut self,
        run: &mut Controllers,
        seen: Option<Instant>,
        sinks: &mut [impl Sink],
        observers: &mut [impl Observer],
    ) {
        let now = run.reached();
        let idle = |this: &Self, run: &Controllers| {
            let last = this.behind.iter().map(|behind| behind.last).max().unwrap_or(Instant::RESET);
            let idle_from = run.idle_from(last);
            if seen.is_some() { idle_from.and(seen) } else { idle_from }
        };
        self.idle_from = idle(self, run);
        let end = self.end(run);
        // More cycles were run than needed.
        let is_past = end.is_some_and(|end| end < now);
        if !is_past {
            for (index, mut wired) in self.wired(sinks, observers).into_iter().enumerate() {
                wired.act(run, index, Instant(now.0 - 1));
            }
            self.idle_from = idle(self, run);
        }
        let is_end = end == Some(now) && (run.end.is_some() || idle(self, run).is_some());
        if let Some(end) = end.filter(|_| is_past || is_end) {
            self.wired(sinks, observers).iter_mut().for_each(|wired| wired.advance(end.0));
            self.ended = Some(end);
        }
    }

    /// The given end; otherwise the idle cycle, but not before the end of a boot with a self-test and the tail after the
    /// last fall of STEP.
    fn end(&self, run: &Controllers) -> Option<Instant> {
        if let Some(end) = run.end {
            return Some(end);
        }
        let boot = self.behind.iter().filter_map(|behind| behind.boot).max();
        let fall = self.behind.iter().filter_map(|behind| behind.last_fall).max();
        let after = [boot, fall.map(|fall| fall + self.tail)].into_iter().flatten().max();
        self.idle_from.map(|own| after.map_or(own, |after| own.max(after)))
    }
}

const PORTION: u64 = 1 << 24;

impl<S: Sink, O: Observer> Wired<'_, S, O> {
    fn act(&mut self, run: &mut Controllers, index: usize, cycle: Instant) {
        self.advance(cycle.0);
        if self.behind.watch.overload.take() == Some(cycle.0) {
            let was_powered = self.behind.levels.has(Levels::EN);
            // If the drivers are off already, only the fault changes.
            if run.overload(index, self) && was_powered {
                self.behind.overload_at = Some(cycle.0);
            }
        }
        if self.behind.boot == Some(cycle.next()) {
            self.behind.boot = None;
            self.behind.found = self.behind.measured();
            let greatest = self.behind.found.iter().copied().max().flatten();
            let all = self.behind.found.iter().all(Option::is_some);
            run.settles_in(index, greatest.filter(|_| all).map(Cycles));
        }
    }
}
