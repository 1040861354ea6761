//! Whole numbers: I(r), the table of G3, P(x), the display.

/// I(r) = floor(65536*f/r).
pub(super) fn interval(clock_hz: u64, rate_hz: i64) -> u128 {
    65536 * u128::from(clock_hz) / rate_hz as u128
}

/// floor(sqrt(x)).
pub(super) fn square_root(x: u128) -> u128 {
    let (mut low, mut high) = (0u128, 1u128 << 63);
    while low + 1 < high {
        let middle = low + (high - low) / 2;
        if middle * middle <= x { low = middle } else { high = middle }
    }
    low
}

/// round_half_up(sqrt(x)): the root is n + 1/2 or more where x >= n^2 + n + 1/4.
pub(super) fn rounded_root(x: u128) -> u128 {
    let n = square_root(x);
    if x > n * n + n { n + 1 } else { n }
}

/// G3's table at one acceleration: of each row the steps before it and its rate.
#[derive(Debug, Clone)]
pub(super) struct Table {
    rows: Vec<(i128, i64)>,
}

impl Table {
    /// Rows up to the first above `max_speed_hz`.
    pub(super) fn new(start_speed_hz: i64, acceleration: i64, max_speed_hz: i64) -> Self {
        let mut rows = Vec::new();
        let mut before: i128 = 0;
        for row in 0.. {
            let f1 = start_speed_hz as u128;
            let rate = rounded_root(f1 * f1 + 2 * acceleration as u128 * before as u128) as i64;
            rows.push((before, rate));
            if rate > max_speed_hz {
                break;
            }
            // dS starts at 30 and grows by 30 after every five rows (B3).
            before += 30 * (row / 5 + 1);
        }
        Self { rows }
    }

    /// S(r): steps of the rows before the first one of rate >= r.
    pub(super) fn steps_to(&self, rate_hz: i64) -> i128 {
        let row = self.rows.partition_point(|(_, rate)| *rate < rate_hz);
        self.rows[row].0
    }

    /// R(k): rate of the row of ramp step k, from 1.
    pub(super) fn rate_of_step(&self, k: i128) -> i64 {
        let after = self.rows.partition_point(|(before, _)| *before < k);
        self.rows[after - 1].1
    }
}

/// 10^d.
pub(super) fn ten_to(decimals: i64) -> i128 {
    10i128.pow(decimals as u32)
}

/// P(x) = floor((2*x*N + 10^d)/(2*10^d)) steps.
pub(super) fn steps_of_length(x: i128, pulses_per_unit: i64, decimals: i64) -> i128 {
    let scale = ten_to(decimals);
    (2 * x * i128::from(pulses_per_unit) + scale).div_euclid(2 * scale)
}

/// sign*floor((2*|position|*10^d + N)/(2*N)).
pub(super) fn display_of_position(position: i32, pulses_per_unit: i64, decimals: i64) -> i64 {
    let n = i128::from(pulses_per_unit);
    let size = (2 * i128::from(position).abs() * ten_to(decimals) + n) / (2 * n);
    let display = if position < 0 { -size } else { size };
    display as i64
}

/// floor(ms*f/1000) cycles.
pub(super) fn cycles_of_ms(ms: i64, clock_hz: u64) -> u64 {
    (ms as u128 * u128::from(clock_hz) / 1000) as u64
}
