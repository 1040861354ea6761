//! Criterion's figure of each kernel; or, called as `kernels --rounds N [KERNEL]...`, N rounds of all
//! kernels or of the named ones, reported as JSON on standard output. Naming one is useful for
//! profilers.
#![allow(clippy::expect_used, reason = "a benchmark fails by panicking")]

use std::{env, time::Instant};

use criterion::{Criterion, SamplingMode, Throughput};
use stepscope_bench::{kernel::Kernel, kernels::Kernels, rounds};

fn main() {
    let mut kernels = Kernels::new().expect("the motions hold");
    // cargo adds --bench.
    let mut arguments = env::args().skip(1).filter(|argument| argument != "--bench").peekable();
    if arguments.next_if(|first| first == "--rounds").is_some() {
        let count = arguments.next().and_then(|count| count.parse().ok()).expect("--rounds has a number");
        report(&mut kernels, count, &arguments.collect::<Vec<_>>());
    } else {
        measure(&mut kernels, &mut Criterion::default().configure_from_args());
    }
}

fn report(kernels: &mut Kernels, count: u32, names: &[String]) {
    let start = Instant::now();
    let chosen = |kernel: Kernel| names.is_empty() || names.iter().any(|name| name == kernel.facts().name);
    let reports = rounds::measure(kernels, chosen, count, || start.elapsed().as_secs_f64());
    println!("{}", serde_json::to_string(&reports).expect("a report is JSON"));
}

fn measure(kernels: &mut Kernels, criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("kernels");
    // A call takes milliseconds: criterion's growing samples would take minutes.
    group.sampling_mode(SamplingMode::Flat);
    for kernel in Kernel::ALL {
        group.throughput(Throughput::Elements(kernels.work(kernel).units));
        group.bench_function(kernel.facts().name, |bencher| bencher.iter(|| kernels.call(kernel)));
    }
    group.finish();
}
