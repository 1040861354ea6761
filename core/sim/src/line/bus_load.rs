//! Checks that the line can carry the bytes of a tick (DESIGN A9).

use stepscope_peripheral::config::max_baud;
use stepscope_scenario::Cause;

/// Checks that a tick's bytes, `bits` bit times at `baud`, fit in its cycles. Errors: the required rate.
pub(crate) fn carries(
    packet_cycles: u128,
    bits: u128,
    tick_cycles: u64,
    clock_hz: u32,
    baud: u32,
) -> Result<(), Cause> {
    let tick = u128::from(tick_cycles.max(1));
    if packet_cycles <= tick {
        return Ok(());
    }
    // A saturated number exceeds every line, so the message need not be exact.
    let saturated = |value: u128| u64::try_from(value).unwrap_or(u64::MAX);
    let (packet_cycles, needed_baud) =
        (saturated(packet_cycles), saturated((bits * u128::from(clock_hz)).div_ceil(tick)));
    let max_baud = u64::from(max_baud(clock_hz));
    Err(Cause::LineTooSlow { packet_cycles, tick_cycles, baud, needed_baud, max_baud })
}
