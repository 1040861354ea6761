//! Runs work on all cores and returns results in order, whatever the number of threads.

use crate::{progress::Progress, terminal};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::io::{self, Write};
use std::sync::{Mutex, Once, PoisonError};
use std::{num::NonZero, thread::available_parallelism};

/// More threads cost memory and gain nothing.
const MAX_THREADS_PER_CORE: usize = 4;

/// One per core by default, at most four per core. Reports on standard error if the number is reduced.
fn threads(requested: Option<NonZero<usize>>) -> usize {
    let cores = available_parallelism().map_or(1, NonZero::get);
    let max = MAX_THREADS_PER_CORE * cores;
    let requested = requested.map_or(cores, NonZero::get);
    if requested > max {
        static ONCE: Once = Once::new();
        ONCE.call_once(|| {
            let _ = writeln!(
                terminal::err(),
                "--threads: {requested} is more than {MAX_THREADS_PER_CORE} per core; {max} are used, with the same result"
            );
        });
    }
    requested.min(max)
}

/// Runs `make` for each number below `count`; the results are in order.
pub(crate) fn each<R: Send>(
    count: u64,
    threads: Option<NonZero<usize>>,
    progress: &mut Progress,
    make: impl Fn(u64) -> R + Sync,
) -> io::Result<Vec<R>> {
    let job = with_progress(count, progress, make);
    Ok(pool(threads)?.install(|| (0..count).into_par_iter().map(&job).collect()))
}

/// Adds up results without storing them. `add` must not depend on the order.
pub(crate) fn sum<R: Default + Send, E: Send>(
    count: u64,
    threads: Option<NonZero<usize>>,
    progress: &mut Progress,
    make: impl Fn(u64) -> Result<R, E> + Sync,
    add: impl Fn(Result<R, E>, Result<R, E>) -> Result<R, E> + Sync,
) -> io::Result<Result<R, E>> {
    let job = with_progress(count, progress, make);
    let pool = pool(threads)?;
    Ok(pool.install(|| (0..count).into_par_iter().map(&job).reduce(|| Ok(R::default()), &add)))
}

fn pool(requested: Option<NonZero<usize>>) -> io::Result<ThreadPool> {
    ThreadPoolBuilder::new().num_threads(threads(requested)).build().map_err(io::Error::other)
}

fn with_progress<R>(
    count: u64,
    progress: &mut Progress,
    make: impl Fn(u64) -> R + Sync,
) -> impl Fn(u64) -> R + Sync {
    let progress = Mutex::new((progress, 0));
    move |number| {
        let result = make(number);
        let (progress, done) = &mut *progress.lock().unwrap_or_else(PoisonError::into_inner);
        *done += 1;
        progress.update(*done, count);
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uses_at_most_four_threads_per_core() {
        let cores = available_parallelism().map_or(1, NonZero::get);
        assert_eq!(threads(None), cores);
        assert_eq!(threads(NonZero::new(1)), 1);
        assert_eq!(threads(NonZero::new(4 * cores)), 4 * cores);
        assert_eq!(threads(NonZero::new(100_000_000)), 4 * cores);
    }

    #[test]
    fn returns_results_in_order_on_any_number_of_threads() {
        for threads in [1, 2, 7] {
            let mut progress = Progress::new("numbers", false);
            let results = each(1000, NonZero::new(threads), &mut progress, |number| number * number);
            let expected: Vec<u64> = (0..1000).map(|number| number * number).collect();
            assert_eq!(results.expect("there are threads"), expected, "{threads} threads");
        }
    }
}
