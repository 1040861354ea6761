//! Times all kernels in rounds, and reports the times as JSON.

use core::hint::black_box;

use serde::Serialize;

use crate::{kernel::Kernel, kernels::Kernels};

/// The times of one kernel.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The kernel.
    pub name: &'static str,
    /// What it does.
    pub what: &'static str,
    /// Its unit of work.
    pub unit: &'static str,
    /// Units per call.
    pub units: u64,
    /// Single-signal edges per call.
    pub edges: Option<u64>,
    /// Its reference kernel.
    pub yardstick: Option<&'static str>,
    /// Minimum target of the ratio of the two speeds.
    pub aim: Option<f64>,
    /// Minimum target of the browser's speed, as a fraction of the native speed.
    pub browser_aim: Option<f64>,
    /// The time of its call in each round, in s.
    pub seconds: Vec<f64>,
}

/// Calls the kernels that `chosen` accepts once each, `rounds` times; `now` is a clock in s.
pub fn measure(
    kernels: &mut Kernels,
    chosen: impl Fn(Kernel) -> bool,
    rounds: u32,
    now: impl Fn() -> f64,
) -> Vec<Report> {
    let chosen: Vec<Kernel> = Kernel::ALL.into_iter().filter(|&kernel| chosen(kernel)).collect();
    // Counting the work also warms up.
    let mut reports: Vec<Report> = chosen.iter().map(|&kernel| report(kernels, kernel)).collect();
    for _ in 0..rounds {
        for (&kernel, report) in chosen.iter().zip(&mut reports) {
            let start = now();
            black_box(kernels.call(kernel));
            report.seconds.push(now() - start);
        }
    }
    reports
}

fn report(kernels: &mut Kernels, kernel: Kernel) -> Report {
    let (work, facts) = (kernels.work(kernel), kernel.facts());
    Report {
        name: facts.name,
        what: facts.what,
        unit: facts.unit,
        units: work.units,
        edges: work.edges,
        yardstick: facts.yardstick.map(|yardstick| yardstick.facts().name),
        aim: facts.aim,
        browser_aim: facts.browser_aim,
        seconds: Vec::new(),
    }
}
