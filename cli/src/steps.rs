//! Reads step times for `stepscope tables --steps`.

use std::iter;
use stepscope_core::motion::ScheduledStep;

/// Possible columns of a time, with units per second; `None` for clock cycles.
const TIMES: [(&str, Option<u32>); 4] =
    [("cycle", None), ("time_s", Some(1)), ("time_ms", Some(1000)), ("time_us", Some(1_000_000))];
/// Also accepted, because an unknown column would be ignored silently.
const DIRECTION: &str = "dir";
const DIRECTION_IN_FULL: &str = "direction";
const MAX_DIGITS: usize = 12;
const MAX_CYCLE: u128 = 1 << 48;

/// Reads one step per row: time in `cycle`, `time_s`, `time_ms` or `time_us`, and direction in `dir` or `direction`
/// (1 or right, 0 or left). Times are rounded to the nearest cycle, halves up, from their decimals.
pub(crate) fn steps_of_table(text: &str, clock_hz: u32) -> Result<Vec<ScheduledStep>, String> {
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let head = reader.headers().map_err(|error| error.to_string())?.clone();
    let column = |name: &str| head.iter().position(|found| found.eq_ignore_ascii_case(name));
    if column("position").is_some() && column(DIRECTION).or_else(|| column(DIRECTION_IN_FULL)).is_none() {
        return Err("line 1: the table has positions, not step times; use stepscope points".to_owned());
    }
    let found = TIMES.iter().find_map(|(name, per_second)| Some((*name, column(name)?, *per_second)));
    let Some((name, time_at, per_second)) = found else {
        let given = head.iter().collect::<Vec<_>>().join(", ");
        return Err(format!(
            "the first line has the columns \"{given}\"; use one of cycle, time_s, time_ms and time_us, and dir for directions"
        ));
    };
    let direction_at = column(DIRECTION).or_else(|| column(DIRECTION_IN_FULL));
    let mut steps = Vec::new();
    let mut before = 0;
    for (line, row) in iter::zip(2_u64.., reader.records()) {
        let row = row.map_err(|error| error.to_string())?;
        let line = row.position().map_or(line, csv::Position::line);
        let given = row.get(time_at).unwrap_or_default();
        let cycle = cycle(given, per_second, clock_hz)
            .ok_or_else(|| format!("line {line}: {name}: \"{given}\" is out of range; use 0 to 2^48 cycles, with up to {MAX_DIGITS} decimal places"))?;
        if cycle < before {
            return Err(format!(
                "line {line}: {name}: {given} is before the line above; use times in ascending order"
            ));
        }
        let right = match direction_at.map(|at| row.get(at).unwrap_or_default()) {
            None | Some("1" | "right" | "+1") => true,
            Some("0" | "left" | "-1") => false,
            Some(other) => {
                return Err(format!(
                    "line {line}: {DIRECTION}: \"{other}\" is not a direction; use 1 or right, 0 or left"
                ));
            }
        };
        steps.push(ScheduledStep { cycle, right });
        before = cycle;
    }
    if steps.is_empty() { Err("no step; use one row per step".to_owned()) } else { Ok(steps) }
}

/// floor(time*clock + 1/2), from the decimal digits.
fn cycle(text: &str, per_second: Option<u32>, clock_hz: u32) -> Option<u64> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let is_number = |digits: &str| digits.bytes().all(|digit| digit.is_ascii_digit());
    let fits = whole.len() + fraction.len() > 0 && whole.len() <= 18 && fraction.len() <= MAX_DIGITS;
    if !fits || !is_number(whole) || !is_number(fraction) {
        return None;
    }
    let digits: u128 = format!("{whole}{fraction}").parse().ok()?;
    let (numerator, denominator) = match per_second {
        Some(per_second) => (digits.checked_mul(clock_hz.into())?, u128::from(per_second)),
        None => (digits, 1),
    };
    let denominator = denominator * 10_u128.pow(fraction.len() as u32);
    let cycle = numerator.checked_mul(2)?.checked_add(denominator)? / (2 * denominator);
    u64::try_from(cycle).ok().filter(|cycle| u128::from(*cycle) <= MAX_CYCLE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_decimal_times_half_up() {
        let rows: [(&str, Option<u32>, Option<u64>); 9] = [
            ("17", None, Some(17)),
            ("16.5", None, Some(17)),
            ("16.499999999999", None, Some(16)),
            ("0.0000005", Some(1), Some(1)),
            ("0.4999", Some(1_000_000), Some(0)),
            (".25", Some(1000), Some(250)),
            ("-1", Some(1), None),
            ("1e-3", Some(1), None),
            ("999999999999", Some(1), None),
        ];
        for (text, per_second, expected) in rows {
            assert_eq!(cycle(text, per_second, 1_000_000), expected, "{text} of {per_second:?}");
        }
        assert_eq!(cycle("170141183460469231.731687303716", Some(1), 1_000_000_000), None);
    }

    #[test]
    fn reads_a_step_per_row_or_reports_the_line() {
        let step = |cycle, right| ScheduledStep { cycle, right };
        let found = steps_of_table("# a capture\ntime_us, dir\n10,1\n20.5, left\n", 1_000_000);
        assert_eq!(found, Ok(vec![step(10, true), step(21, false)]));
        let found = steps_of_table("cycle,Direction\n10,right\n21,left\n", 1_000_000);
        assert_eq!(found, Ok(vec![step(10, true), step(21, false)]));
        let rows = [
            ("1\n2\n", "the first line has the columns \"1\""),
            ("cycle\n", "no step"),
            (
                "time_s,position\n0,0\n",
                "line 1: the table has positions, not step times; use stepscope points",
            ),
            ("cycle\n5\n4\n", "line 3: cycle: 4 is before the line above"),
            ("cycle,dir\n5,up\n", "line 2: dir: \"up\" is not a direction; use 1 or right, 0 or left"),
            ("time_s\nsoon\n", "line 2: time_s: \"soon\" is out of range; use 0 to"),
        ];
        for (text, expected) in rows {
            let found = steps_of_table(text, 1_000_000).expect_err("it is wrong");
            assert!(found.starts_with(expected), "{found}");
        }
    }
}
