//! Runs the kernels: their experiments, and their memory.

use core::{hint::black_box, num::NonZeroU32};

use stepscope_core::{
    inspect::motion::{
        sine_optimum::{Freedom, optimum},
        sine_polyline::sweep,
    },
    motion::{
        AxisPlan, Cause, ScheduledStep,
        curves::Trapezoid,
        plan_axis,
        step_tables::{Compressed, EntryFormat, Form, Side, Stored, Tolerance, compressed_quickly, stored},
    },
    peripheral::{
        segment::PulseTimes,
        signal::{Levels, Record},
        trace::Digest,
        units::{Cycles, Instant},
    },
    plant::{Plant, parameters::CurrentControl, sincos},
    scenario::{Problems, of_motion},
    sim::{Experiment, plant_run::PlantRun},
};

use crate::{kernel::Kernel, motions, planners::Planner};

/// Steps of the planner's move: a triangle, so that every step needs its square root.
const STEPS: u32 = 1_000_000;
const START_SPEED: f64 = 250.0;
const TOP_SPEED: f64 = 1e7;
const ACCELERATION: f64 = 9000.0;
const CLOCK_HZ: u32 = 16_000_000;
/// Maximum error of a compressed table: 25 us.
const TOLERANCE: Tolerance = Tolerance::of(Cycles(400));
/// Klipper's limits: never late, and early by at most half an interval.
const KLIPPERS: Tolerance = Tolerance { interval_part: NonZeroU32::new(2), side: Side::Early, ..TOLERANCE };
const PULSE: PulseTimes = PulseTimes { width: Cycles(16), setup: Cycles(0), hold: Cycles(0) };
/// Number of short runs from event to event, so that their time can be measured.
const SHORT_RUNS: u64 = 200;
/// Highest harmonic of the distortion.
const ORDER: u16 = 399;
/// The page's range of d1, and the rows of figure 4 of the sine paper.
const SWEEP: (f64, f64) = (0.002, 0.06);
const SWEEP_ROWS: u32 = 500;

/// Motors of the plant, and motor steps per call: a second at 5 us has ten times as many.
const MOTORS: u64 = 16;
const MOTOR_STEPS: u64 = 320_000;
/// Cycles between the simultaneous steps of the motors, and of a pulse.
const STEP_CYCLES: u64 = 4000;
const PULSE_CYCLES: u64 = 160;

/// The experiments of the kernels, and the memory that they write.
pub struct Kernels {
    steady: Experiment,
    varied: Experiment,
    common_dir: Experiment,
    staggered: Experiment,
    framed: Experiment,
    segments: Experiment,
    segments_apart: Experiment,
    motors_16: Experiment,
    motors_512: Experiment,
    clock_1: Experiment,
    clock_16: Experiment,
    clock_200: Experiment,
    short: Experiment,
    plant_run: Experiment,
    ramp: Trapezoid,
    /// The move whose tables are computed, and its steps.
    move_of_tables: AxisPlan,
    due: Vec<ScheduledStep>,
    /// A move of each planner, in their order.
    plans: Vec<AxisPlan>,
    /// The trace of the constant motion.
    source: Vec<Record>,
    /// Output: space for the longest trace, with all pages already mapped.
    target: Vec<Record>,
}

/// The work of one call of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    /// Records or steps.
    pub units: u64,
    /// Single-signal edges among them: a record may contain several.
    pub edges: Option<u64>,
}

impl Kernels {
    /// Prepares all kernels.
    ///
    /// # Errors
    /// None while the rules of scenarios do not change.
    pub fn new() -> Result<Self, Problems> {
        let (steady, varied) = (motions::steady()?, motions::varied()?);
        let mut source = Vec::new();
        steady.run(&mut source);
        let move_of_tables = plan_axis(&motions::table_axis(STEPS), "axis").map_err(of_motion)?;
        let due = move_of_tables.due_steps(CLOCK_HZ).collect();
        let most = source.len().max(varied.cost().records as usize);
        Ok(Self {
            steady,
            varied,
            common_dir: motions::common_dir()?,
            staggered: motions::staggered()?,
            framed: motions::framed()?,
            segments: motions::segments()?,
            segments_apart: motions::segments_apart()?,
            motors_16: motions::motors_16()?,
            motors_512: motions::motors_512()?,
            clock_1: motions::at_clock(1_000_000)?,
            clock_16: motions::at_clock(16_000_000)?,
            clock_200: motions::at_clock(200_000_000)?,
            short: motions::short()?,
            plant_run: motions::plant_run()?,
            ramp: Trapezoid::new(i64::from(STEPS), START_SPEED, TOP_SPEED, ACCELERATION),
            move_of_tables,
            due,
            plans: Planner::ALL.into_iter().map(Planner::plan).collect::<Result<_, _>>()?,
            source,
            target: vec![Record { cycle: Instant::NEVER, levels: Levels::RESET }; most],
        })
    }

    /// Calls a kernel once; the result only prevents the call from being optimized away. Each kernel has its own function, so
    /// that the compiler optimizes it separately.
    pub fn call(&mut self, kernel: Kernel) -> u64 {
        match kernel {
            Kernel::Copy => self.copy(),
            Kernel::Write => self.write(),
            Kernel::Roots => roots(black_box(START_SPEED), black_box(ACCELERATION)).to_bits(),
            Kernel::StepTimes => step_times(black_box(self.ramp)),
            Kernel::Exact => {
                entries(stored(&self.move_of_tables, Form::Exact, EntryFormat::Q16, PULSE, CLOCK_HZ))
            }
            Kernel::Compressed => compress(black_box(&self.due), TOLERANCE, EntryFormat::Q16),
            Kernel::CompressedKlipper => compress(black_box(&self.due), KLIPPERS, EntryFormat::TICKS),
            Kernel::PlannedCompressed => self.planned(EntryFormat::Q16),
            Kernel::PlannedTicks => self.planned(EntryFormat::TICKS),
            Kernel::PlannedQ8 => self.planned(EntryFormat::Q8),
            Kernel::Document => entries(stored(
                self.plan(Planner::TrapezoidTable),
                Form::Document,
                EntryFormat::Q16,
                PULSE,
                CLOCK_HZ,
            )),
            Kernel::Plan(planner) => due_cycles(black_box(self.plan(planner))),
            Kernel::Optimum(segments) => optimum(black_box(segments.into()), Freedom::Free, ORDER)
                .map_or(0, |found| found.distortion.position.to_bits()),
            Kernel::Sweep => sweep(black_box(SWEEP.0), SWEEP.1, SWEEP_ROWS, ORDER)
                // Writes whole rows, whether used or not: otherwise an optimizer could omit a part of one kernel's work.
                .map(black_box)
                .fold(0, |sum, row| sum ^ row.distortion.position.to_bits()),
            Kernel::SineCosine => sine_cosine(black_box(0.37)).to_bits(),
            Kernel::PlantAveraged => plant(CurrentControl::Averaged),
            Kernel::PlantChopper => plant(CurrentControl::Chopper),
            Kernel::PlantRun => {
                let parts = vec![(Digest::default(), ())];
                PlantRun::new(black_box(&self.plant_run), parts).map_or(0, |mut run| {
                    run.finish();
                    run.results().first().map_or(0, |result| result.digest)
                })
            }
            Kernel::Digest => digest(&self.steady),
            Kernel::VariedDigest => digest(&self.varied),
            Kernel::Stored => store(&self.steady, &mut self.target),
            Kernel::VariedStored => store(&self.varied, &mut self.target),
            Kernel::CommonDir => store(&self.common_dir, &mut self.target),
            Kernel::Staggered => store(&self.staggered, &mut self.target),
            Kernel::Framed => store(&self.framed, &mut self.target),
            Kernel::Segments => store(&self.segments, &mut self.target),
            Kernel::SegmentsApart => store(&self.segments_apart, &mut self.target),
            Kernel::Motors16 => digest_each(&self.motors_16),
            Kernel::Motors512 => digest_each(&self.motors_512),
            Kernel::Clock1 => store(&self.clock_1, &mut self.target),
            Kernel::Clock16 => store(&self.clock_16, &mut self.target),
            Kernel::Clock200 => store(&self.clock_200, &mut self.target),
            Kernel::Fast => (0..SHORT_RUNS).map(|_| store(&self.short, &mut self.target)).sum(),
            // Called by its address: wasm-opt inlines functions with one caller, even with `inline(never)`, and a browser
            // would then compile it together with all other kernels.
            Kernel::ClockByClock => {
                let call: fn(&Experiment, &mut Vec<Record>) -> u64 = black_box(clock_by_clock);
                call(&self.short, &mut self.target)
            }
        }
    }

    /// The work of one call of a kernel.
    pub fn work(&mut self, kernel: Kernel) -> Work {
        let result = self.call(kernel);
        let stored = || Some(edges(&self.target));
        let (units, edges) = match kernel {
            Kernel::Roots
            | Kernel::StepTimes
            | Kernel::Exact
            | Kernel::Compressed
            | Kernel::CompressedKlipper
            | Kernel::PlannedCompressed
            | Kernel::PlannedTicks
            | Kernel::PlannedQ8
            | Kernel::Document
            | Kernel::Plan(_) => (u64::from(STEPS), None),
            Kernel::Optimum(_) => (1, None),
            Kernel::Sweep => (u64::from(SWEEP_ROWS), None),
            Kernel::SineCosine | Kernel::PlantAveraged | Kernel::PlantChopper => (MOTOR_STEPS, None),
            Kernel::PlantRun => (self.plant_run.cost().motor_grid_steps, None),
            Kernel::Write | Kernel::Copy => (result, None),
            Kernel::Motors16 | Kernel::Motors512 => (result, None),
            Kernel::Digest => return self.work(Kernel::Stored),
            Kernel::VariedDigest => return self.work(Kernel::VariedStored),
            Kernel::Fast => (result, stored().map(|edges| edges * SHORT_RUNS)),
            _ => (result, stored()),
        };
        Work { units, edges }
    }

    /// The move of a planner.
    fn plan(&self, planner: Planner) -> &AxisPlan {
        &self.plans[planner as usize]
    }

    /// Segments of the move, planned and compressed.
    #[inline(never)]
    fn planned(&self, format: EntryFormat) -> u64 {
        let due = black_box(&self.move_of_tables).due_steps(CLOCK_HZ);
        segments_of(compressed_quickly(due, TOLERANCE, format, PULSE))
    }

    #[inline(never)]
    fn copy(&mut self) -> u64 {
        self.target.clear();
        self.target.extend_from_slice(black_box(&self.source));
        self.target.len() as u64
    }

    #[inline(never)]
    fn write(&mut self) -> u64 {
        self.target.clear();
        let made =
            (0..self.source.len() as u64).map(|i| Record { cycle: Instant(i), levels: Levels(i & 0xffff) });
        self.target.extend(made);
        self.target.len() as u64
    }
}

#[inline(never)]
fn step_times(ramp: Trapezoid) -> u64 {
    ramp.step_times(CLOCK_HZ).fold(0, u64::wrapping_add)
}

#[inline(never)]
fn due_cycles(plan: &AxisPlan) -> u64 {
    plan.due_steps(CLOCK_HZ).fold(0, |sum: u64, step| sum.wrapping_add(step.cycle))
}

#[inline(never)]
fn compress(due: &[ScheduledStep], tolerance: Tolerance, format: EntryFormat) -> u64 {
    segments_of(compressed_quickly(due.iter().copied(), tolerance, format, PULSE))
}

/// Independent angles: no one depends on the previous result.
#[inline(never)]
fn sine_cosine(quarters: f64) -> f64 {
    (0..MOTOR_STEPS)
        .map(|step| {
            let (sine, cosine) = sincos(quarters * step as f64);
            sine + cosine
        })
        .sum()
}

/// Motors that step simultaneously, 4000 times per second.
#[inline(never)]
fn plant(regulator: CurrentControl) -> u64 {
    let Ok(mut plant) = Plant::new(black_box(&motions::plant(regulator))) else { return 0 };
    let end = MOTOR_STEPS / MOTORS * plant.step_cycles();
    let [low, high] = [Levels(Levels::EN), Levels(Levels::EN | 0xffff_ffff)];
    let mut rise = STEP_CYCLES;
    while rise < end {
        for (cycle, levels) in [(rise, high), (rise + PULSE_CYCLES, low)] {
            plant.record(Record { cycle: Instant(cycle), levels }, &mut ());
        }
        rise += STEP_CYCLES;
    }
    plant.advance(end, &mut ());
    plant.digest()
}

/// Entries of a table; none if there is no table, which the tests would detect.
fn entries(table: Result<Stored, Cause>) -> u64 {
    table.map_or(0, |table| table.entries.len() as u64)
}

fn segments_of(table: Result<Compressed, Cause>) -> u64 {
    table.map_or(0, |table| table.list.segments.len() as u64)
}

#[inline(never)]
fn store(experiment: &Experiment, target: &mut Vec<Record>) -> u64 {
    target.clear();
    black_box(experiment).run(target);
    target.len() as u64
}

#[inline(never)]
fn clock_by_clock(experiment: &Experiment, target: &mut Vec<Record>) -> u64 {
    target.clear();
    black_box(experiment).run_clock_by_clock(target);
    target.len() as u64
}

/// The records of every controller of a line, each into its own digest.
#[inline(never)]
fn digest_each(experiment: &Experiment) -> u64 {
    let mut digests = vec![Digest::default(); experiment.controllers()];
    black_box(experiment).run_each(&mut digests);
    digests.iter().map(Digest::records).sum()
}

#[inline(never)]
fn digest(experiment: &Experiment) -> u64 {
    let mut digest = Digest::default();
    black_box(experiment).run(&mut digest);
    digest.value()
}

/// The minimum work of a planner of this ramp.
#[inline(never)]
fn roots(v0: f64, a: f64) -> f64 {
    (0..STEPS).map(|k| square_root(v0 * v0 + 2.0 * a * f64::from(k))).sum()
}

/// One at a time, by the instruction that both targets have: `libm` has it for x86, but not for wasm.
fn square_root(x: f64) -> f64 {
    #[cfg(target_arch = "wasm32")]
    let root = x.sqrt();
    #[cfg(not(target_arch = "wasm32"))]
    let root = libm::sqrt(x);
    root
}

/// Single-signal edges of a trace after its first record, which is the state at reset.
fn edges(trace: &[Record]) -> u64 {
    let pairs = trace.iter().zip(trace.iter().skip(1));
    pairs.map(|(before, after)| u64::from((before.levels.0 ^ after.levels.0).count_ones())).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reference_kernel_precedes_the_kernels_it_is_compared_with() {
        for (index, kernel) in Kernel::ALL.into_iter().enumerate() {
            let before = &Kernel::ALL[..index];
            if let Some(yardstick) = kernel.facts().yardstick {
                assert!(before.contains(&yardstick), "{kernel:?}");
                assert_eq!(kernel.facts().unit, yardstick.facts().unit, "{kernel:?}");
            }
        }
    }

    #[test]
    fn sixteen_channels_make_2_records_and_32_edges_per_slot() {
        let mut kernels = Kernels::new().unwrap();
        let Work { units, edges } = kernels.work(Kernel::Digest);
        // In addition to the steps: four edges of the line per byte (0xe4), the first record, and DIR.
        let line = 10_000 * 16 * 4;
        assert_eq!((units, edges), (2_000_000 + line + 2, Some(32_000_000 + line + 16)));
        assert_eq!(kernels.work(Kernel::Copy).units, units);
        assert_eq!(kernels.work(Kernel::Write).units, units);
    }

    #[test]
    fn every_mode_makes_the_requested_steps() {
        let mut kernels = Kernels::new().unwrap();
        let modes =
            [Kernel::CommonDir, Kernel::Staggered, Kernel::Framed, Kernel::Segments, Kernel::SegmentsApart];
        let steps = [100_000, 100_000, 1_000_000, 1_000_000, 62_500];
        for (kernel, steps) in modes.into_iter().zip(steps) {
            kernels.call(kernel);
            for channel in 0..16 {
                let high = kernels.target.windows(2).filter(|pair| {
                    let rose = pair[1].levels.0 & !pair[0].levels.0;
                    rose >> channel & 1 == 1
                });
                assert_eq!(high.count(), steps, "{kernel:?} channel {channel}");
            }
        }
        let [one, all] = [Kernel::Motors16, Kernel::Motors512].map(|kernel| kernels.work(kernel));
        assert_eq!(all.units, 32 * one.units, "each receives the packets of all");
    }

    #[test]
    fn tables_are_complete_and_compressed_tables_short() {
        let mut kernels = Kernels::new().unwrap();
        let tables = [
            Kernel::Exact,
            Kernel::Compressed,
            Kernel::CompressedKlipper,
            Kernel::PlannedCompressed,
            Kernel::PlannedTicks,
            Kernel::PlannedQ8,
            Kernel::Document,
        ];
        let [exact, before, klipper, planned, ticks, q8, document] =
            tables.map(|kernel| kernels.call(kernel));
        assert!(q8 > 0 && q8 < exact && document > 0, "{q8} {document}");
        assert_eq!(before, planned);
        // Klipper's step compression makes about 1289 entries of this move; the quick search with its window, which is half as
        // wide as ours, makes a few more.
        assert!(klipper > ticks && klipper < 1320, "{klipper}");
        assert!(planned > 0 && planned < ticks && ticks < 1289 && ticks < exact, "{exact} {planned} {ticks}");
    }

    #[test]
    fn motors_of_the_plant_turn_identically_in_every_call() {
        let mut kernels = Kernels::new().unwrap();
        for kernel in [Kernel::PlantAveraged, Kernel::PlantChopper, Kernel::PlantRun] {
            let first = kernels.call(kernel);
            assert!(first != 0 && first == kernels.call(kernel), "{kernel:?}");
        }
        assert_ne!(kernels.call(Kernel::PlantAveraged), kernels.call(Kernel::PlantChopper));
        let steps = kernels.work(Kernel::PlantRun).units;
        assert!(steps.abs_diff(MOTOR_STEPS) < MOTOR_STEPS / 100, "{steps}");
    }

    #[test]
    fn every_speed_and_clock_makes_the_same_number_of_edges() {
        let mut kernels = Kernels::new().unwrap();
        let [slow, fast] = [Kernel::ClockByClock, Kernel::Fast].map(|kernel| kernels.work(kernel));
        assert_eq!(slow.units * SHORT_RUNS, fast.units);
        assert_eq!(slow.edges.map(|edges| edges * SHORT_RUNS), fast.edges);
        let clocks = [Kernel::Clock1, Kernel::Clock16, Kernel::Clock200];
        let [slowest, clock, fastest] = clocks.map(|kernel| kernels.work(kernel));
        assert_eq!((slowest.edges, fastest.edges), (clock.edges, clock.edges));
    }
}
