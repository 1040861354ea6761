//! Work on all cores. What is made of each number comes back in the numbers' order, so that how many threads there are
//! shows in nothing but the time.

use crate::progress::Progress;
use rayon::{
    ThreadPoolBuilder,
    iter::{IntoParallelIterator, ParallelIterator},
};
use std::{
    io,
    num::NonZero,
    sync::{Mutex, PoisonError},
};

/// What `make` makes of each number below `count`, on so many threads or on as many as there are cores.
///
/// # Errors
/// The system has no threads to give.
pub(crate) fn each<R: Send>(
    count: u64,
    threads: Option<NonZero<usize>>,
    progress: Progress,
    make: impl Fn(u64) -> R + Sync,
) -> io::Result<Vec<R>> {
    let progress = Mutex::new((progress, 0));
    let pool = ThreadPoolBuilder::new()
        // As many as there are cores for 0.
        .num_threads(threads.map_or(0, NonZero::get))
        .build()
        .map_err(io::Error::other)?;
    let made = |number| {
        let made = make(number);
        let (progress, done) = &mut *progress.lock().unwrap_or_else(PoisonError::into_inner);
        *done += 1;
        progress.tell(*done, count);
        made
    };
    Ok(pool.install(|| (0..count).into_par_iter().map(made).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_that_of_the_numbers_on_any_number_of_threads() {
        for threads in [1, 2, 7] {
            let progress = Progress::new("numbers", false);
            let made = each(1000, NonZero::new(threads), progress, |number| number * number);
            let expected: Vec<u64> = (0..1000).map(|number| number * number).collect();
            assert_eq!(made.expect("there are threads"), expected, "{threads} threads");
        }
    }
}
