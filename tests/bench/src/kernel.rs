//! The kernels: what each does, its reference kernel and its target ratio.

use crate::planners::Planner;

/// A kernel of the benchmark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// Copies the records of the constant motion: the reference of a stored trace.
    Copy,
    /// Writes the same number of records, filled from a counter: memory is written and not read.
    Write,
    /// The constant motion into a stored trace.
    Stored,
    /// The constant motion into a digest.
    Digest,
    /// The varied motion into a stored trace.
    VariedStored,
    /// The varied motion into a digest.
    VariedDigest,
    /// The constant motion at a tenth of the rate, with one DIR line for all channels.
    CommonDir,
    /// The same with staggered pulses.
    Staggered,
    /// The constant motion over the framed protocol, with a host that waits for replies.
    Framed,
    /// The constant motion by lists of segments.
    Segments,
    /// Lists of segments with one edge per record.
    SegmentsApart,
    /// One controller of 16 motors, on a line with the packets for 512, into a digest.
    Motors16,
    /// 32 such controllers on one line, each with its own digest.
    Motors512,
    /// A motion that is the same at every clock into a stored trace, at 16 MHz.
    Clock16,
    /// The same at 1 MHz.
    Clock1,
    /// The same at 200 MHz.
    Clock200,
    /// A short motion clock by clock.
    ClockByClock,
    /// A short motion from event to event.
    Fast,
    /// The sum of one square root per step: the reference of the planner.
    Roots,
    /// The sum of the cycles of a trapezoid's steps.
    StepTimes,
    /// The same number of steps up to 200 000 steps/s and down again, planned and stored as the exact list.
    Exact,
    /// The same steps, already planned, compressed to 25 us.
    Compressed,
    /// The same, in Klipper's window and widths.
    CompressedKlipper,
    /// Planned and compressed.
    PlannedCompressed,
    /// Planned and compressed into entries of whole cycles.
    PlannedTicks,
    /// Planned and compressed into short entries with fractions of eight bits.
    PlannedQ8,
    /// The paper's table of a trapezoid, and its timing error.
    Document,
    /// The sum of the due cycles of a planner's move.
    Plan(Planner),
    /// The vertices with the minimum distortion for a number of segments per quarter.
    Optimum(u8),
    /// The sweep of figure 4 of the sine paper.
    Sweep,
    /// Sine and cosine by the plant's polynomials, once per motor and step: the reference of the plant.
    SineCosine,
    /// A tenth of a second of sixteen motors at steps of 5 us, driven by edges, without measures.
    PlantAveraged,
    /// The same number of motor steps with choppers, at steps of 1 us.
    PlantChopper,
    /// The first of these with its run and all measures.
    PlantRun,
}

/// Description of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// Its name, valid as a file name.
    pub name: &'static str,
    /// What it does, for readers of the results.
    pub what: &'static str,
    /// Its unit of work.
    pub unit: &'static str,
    /// Its reference kernel.
    pub yardstick: Option<Kernel>,
    /// Minimum target of the ratio of the two speeds.
    pub aim: Option<f64>,
    /// Minimum target of the browser's speed, as a fraction of the native speed.
    pub browser_aim: Option<f64>,
}

impl Kernel {
    /// All kernels; each reference precedes the kernels that are compared with it.
    pub const ALL: [Self; 50] = [
        Self::Write,
        Self::Copy,
        Self::Stored,
        Self::Digest,
        Self::VariedStored,
        Self::VariedDigest,
        Self::CommonDir,
        Self::Staggered,
        Self::Framed,
        Self::Segments,
        Self::SegmentsApart,
        Self::Motors16,
        Self::Motors512,
        Self::Clock16,
        Self::Clock1,
        Self::Clock200,
        Self::ClockByClock,
        Self::Fast,
        Self::Roots,
        Self::StepTimes,
        Self::Exact,
        Self::Compressed,
        Self::CompressedKlipper,
        Self::PlannedCompressed,
        Self::PlannedTicks,
        Self::PlannedQ8,
        Self::Document,
        Self::Plan(Planner::TrapezoidTable),
        Self::Plan(Planner::TrapezoidExact),
        Self::Plan(Planner::Staircase),
        Self::Plan(Planner::Cosine),
        Self::Plan(Planner::Sliced),
        Self::Plan(Planner::Sigmoid),
        Self::Plan(Planner::Bezier),
        Self::Plan(Planner::Straight),
        Self::Plan(Planner::Exponential),
        Self::Plan(Planner::SineSegments),
        Self::Plan(Planner::Sine),
        Self::Plan(Planner::JerkLimited),
        Self::Plan(Planner::Points),
        Self::Plan(Planner::Constant),
        Self::Optimum(3),
        Self::Optimum(4),
        Self::Optimum(5),
        Self::Optimum(6),
        Self::Sweep,
        Self::SineCosine,
        Self::PlantAveraged,
        Self::PlantChopper,
        Self::PlantRun,
    ];

    /// Its description.
    #[must_use]
    pub const fn facts(self) -> Facts {
        let plain = Facts {
            name: "",
            what: "",
            unit: "records",
            yardstick: None,
            aim: None,
            browser_aim: Some(0.75),
        };
        let run = Facts { yardstick: Some(Self::Copy), ..plain };
        let clock = Facts { yardstick: Some(Self::Clock16), aim: Some(0.9), ..plain };
        let steps = Facts { unit: "steps", ..plain };
        let of_roots = Facts { yardstick: Some(Self::Roots), ..steps };
        // Klipper's step compression reaches 0.075 of such a loop.
        let beside_klipper = Facts { aim: Some(0.075), ..of_roots };
        let motor_steps = Facts { unit: "motor_steps", ..plain };
        let plant = Facts { yardstick: Some(Self::SineCosine), aim: Some(0.125), ..motor_steps };
        match self {
            Self::Write => Facts {
                name: "plain_write",
                what: "writes as many records as `stored_trace`, filled from a counter",
                ..plain
            },
            Self::Copy => {
                Facts { name: "plain_copy", what: "the records of `stored_trace`, copied in memory", ..plain }
            }
            Self::Stored => Facts {
                name: "stored_trace",
                what: "16 channels at 100 kHz into a stored trace, 12 edges per record",
                aim: Some(1.0 / 6.0),
                ..run
            },
            Self::Digest => Facts { name: "digest", what: "the same motion into a digest", ..run },
            Self::VariedStored => Facts {
                name: "varied_stored_trace",
                what: "different commands in every tick: into a stored trace",
                ..run
            },
            Self::VariedDigest => Facts {
                name: "varied_digest",
                what: "different commands in every tick: into a digest",
                ..run
            },
            Self::CommonDir => {
                Facts { name: "common_dir", what: "16 channels at 10 kHz with one DIR line for all", ..run }
            }
            Self::Staggered => {
                Facts { name: "staggered", what: "16 channels at 10 kHz, staggered pulses", ..run }
            }
            Self::Framed => Facts {
                name: "framed",
                what: "the framed protocol, with a host that waits for replies",
                ..run
            },
            Self::Segments => Facts {
                name: "segments",
                what: "16 lists of segments at 100 kHz, 16 edges per record",
                ..run
            },
            Self::SegmentsApart => Facts {
                name: "segments_apart",
                what: "16 lists of segments, one edge per record",
                aim: Some(0.1),
                ..run
            },
            Self::Motors16 => Facts {
                name: "motors_16",
                what: "16 motors, alone on a line with the packets for 512",
                ..run
            },
            Self::Motors512 => Facts {
                name: "motors_512",
                what: "512 motors: 32 controllers on one line",
                yardstick: Some(Self::Motors16),
                aim: Some(0.8),
                ..plain
            },
            Self::Clock16 => Facts {
                name: "clock_16_mhz",
                what: "a motion that is the same at every clock, at 16 MHz",
                ..plain
            },
            Self::Clock1 => Facts { name: "clock_1_mhz", what: "the same at 1 MHz", ..clock },
            Self::Clock200 => Facts { name: "clock_200_mhz", what: "the same at 200 MHz", ..clock },
            Self::ClockByClock => {
                Facts { name: "clock_by_clock", what: "a short motion clock by clock", ..plain }
            }
            Self::Fast => Facts {
                name: "fast_speed",
                what: "a short motion from event to event",
                yardstick: Some(Self::ClockByClock),
                ..plain
            },
            Self::Roots => Facts { name: "square_roots", what: "one square root per step", ..steps },
            Self::StepTimes => Facts {
                name: "step_times",
                what: "the cycles of a trapezoid's steps",
                aim: Some(0.5),
                ..of_roots
            },
            Self::Exact => Facts {
                name: "exact_list",
                what: "planned, and saved as the smallest list without error",
                ..of_roots
            },
            Self::Compressed => {
                Facts { name: "compressed", what: "compressed to 25 us, by the quick search", ..of_roots }
            }
            Self::CompressedKlipper => Facts {
                name: "compressed_klipper",
                what: "`compressed` in Klipper's window and widths",
                ..beside_klipper
            },
            Self::PlannedCompressed => Facts {
                name: "planned_compressed",
                what: "planned and compressed, in 1/65536 of a cycle",
                ..beside_klipper
            },
            Self::PlannedTicks => Facts {
                name: "planned_ticks",
                what: "planned and compressed, in whole cycles",
                ..beside_klipper
            },
            Self::PlannedQ8 => Facts {
                name: "planned_q8",
                what: "planned and compressed, in 1/256 of a cycle",
                ..beside_klipper
            },
            Self::Document => Facts {
                name: "document_table",
                what: "the table of the trapezoid's paper, and the error of its steps",
                ..of_roots
            },
            Self::Plan(planner) => Facts { name: planner.name(), what: planner.what(), ..of_roots },
            Self::Optimum(segments) => {
                let (name, what) = match segments {
                    3 => (
                        "optimum_3_segments",
                        "the vertices of least distortion, with three segments per quarter",
                    ),
                    4 => ("optimum_4_segments", "the same, with four segments per quarter"),
                    5 => ("optimum_5_segments", "the same, with five segments per quarter"),
                    _ => ("optimum_6_segments", "the same, with six segments per quarter"),
                };
                Facts { name, what, unit: "optima", ..plain }
            }
            Self::Sweep => Facts {
                name: "sweep_500_rows",
                what: "a sweep of d1 in 500 rows, as in figure 4 of the sine paper",
                unit: "rows",
                ..plain
            },
            Self::SineCosine => Facts {
                name: "sine_cosine",
                what: "sine and cosine by the plant's polynomials",
                ..motor_steps
            },
            Self::PlantAveraged => {
                Facts { name: "plant_averaged", what: "16 motors of a plant at steps of 5 us", ..plant }
            }
            Self::PlantChopper => Facts {
                name: "plant_chopper",
                what: "16 motors of a plant whose drivers chop, at steps of 1 us",
                ..plant
            },
            Self::PlantRun => Facts {
                name: "plant_run",
                what: "`plant_averaged` with its run and all its measures",
                aim: None,
                ..plant
            },
        }
    }
}
