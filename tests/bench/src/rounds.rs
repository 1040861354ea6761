//! All kernels in turn, over and over, each timed; and the report of it, as JSON.

use core::hint::black_box;

use serde::Serialize;

use crate::{kernel::Kernel, kernels::Kernels};

/// One kernel's times.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The kernel.
    pub name: &'static str,
    /// What it does.
    pub what: &'static str,
    /// What it makes.
    pub unit: &'static str,
    /// How many a call.
    pub units: u64,
    /// Single-signal edges a call.
    pub edges: Option<u64>,
    /// What its speed is compared with.
    pub yardstick: Option<&'static str>,
    /// Which ratio of the two speeds is aimed at, at least.
    pub aim: Option<f64>,
    /// Which part of the native speed is aimed at in the browser, at least.
    pub browser_aim: Option<f64>,
    /// The time of its call in each round, in s.
    pub seconds: Vec<f64>,
}

/// Calls the kernels that `chosen` takes once each, `rounds` times; `now` is a clock in s.
pub fn measure(
    kernels: &mut Kernels,
    chosen: impl Fn(Kernel) -> bool,
    rounds: u32,
    now: impl Fn() -> f64,
) -> Vec<Report> {
    let chosen: Vec<Kernel> = Kernel::ALL.into_iter().filter(|&kernel| chosen(kernel)).collect();
    // Counting the work is also the call that warms up.
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
