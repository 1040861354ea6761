//! Reads tables in C back, and compares their walk with the steps of a plan.

use super::source::{Capitals, Extremes, counted};
use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use core::str::FromStr;
use stepscope_motion::ScheduledStep;
use stepscope_motion::step_tables::{Entry, EntryFormat, TableWalk};

/// A table of a file in C, as its walker reads it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenTable {
    pub name: String,
    pub format: EntryFormat,
    pub entries: Vec<Entry>,
    /// The values of its macros.
    pub steps: u64,
    pub clock_hz: u64,
    pub max_error_cycles: u64,
    /// Minimum and maximum cycles of an event, without waits of 0.
    pub min_cycles: u64,
    pub max_cycles: u64,
}

/// The tables of a file of `stepscope tables --format c` or `--format avr`, in their order.
///
/// # Errors
/// A file without tables, or one that does not have their form: the name of the table, what is wrong, and what to use.
pub fn read_c(text: &str) -> Result<Vec<WrittenTable>, String> {
    let code = without_comments(text);
    let mut tables = Vec::new();
    for line in code.lines().map(str::trim) {
        let macros = [
            ("STEPSCOPE_TICKS_TABLE", EntryFormat::TICKS),
            ("STEPSCOPE_Q8_TABLE", EntryFormat::Q8),
            ("STEPSCOPE_Q16_TABLE", EntryFormat::Q16),
        ];
        let found = macros.into_iter().find_map(|(start, format)| {
            let rest = line.strip_prefix(start)?;
            let rest = rest.strip_prefix("_P").unwrap_or(rest);
            Some((rest.strip_prefix('(')?.split(')').next()?.trim(), format))
        });
        if let Some((name, format)) = found {
            tables.push(table(&code, name, format).map_err(|why| format!("table {name}: {why}"))?);
        }
    }
    if tables.is_empty() {
        return Err("no table; use a file of stepscope tables --format c or --format avr".into());
    }
    Ok(tables)
}

/// The axis of a file's first table, by the command in its header; 0 if there is none.
pub fn first_axis(text: &str) -> usize {
    let command = text.lines().find_map(|line| line.split_once(": stepscope tables ")).unwrap_or_default().1;
    // Options follow the paths, in a fixed order. A quoted path ends with a quote, which is no number.
    let axis = command.rsplit_once(" --form ").and_then(|(before, _)| before.rsplit_once("--axis "));
    axis.and_then(|(_, axis)| axis.parse().ok()).unwrap_or(0)
}

fn without_comments(text: &str) -> String {
    let mut code = String::new();
    let mut rest = text;
    while let Some((before, comment)) = rest.split_once("/*") {
        code.push_str(before);
        rest = comment.split_once("*/").map_or("", |(_, after)| after);
    }
    code + rest
}

fn table(code: &str, name: &str, format: EntryFormat) -> Result<WrittenTable, String> {
    let entries = entries(code, name, format)?;
    let define = |what: &str| {
        let start = format!("#define {}_{what} ", Capitals(name));
        let value = code.lines().find_map(|line| line.trim().strip_prefix(&start));
        let number = value.and_then(|value| number::<u64>(value.trim()));
        number.ok_or_else(|| format!("no {} with a number; export the table again", start.trim()))
    };
    let (count, steps) = (define("ENTRIES")?, define("STEPS")?);
    if count != entries.len() as u64 {
        let found = counted(entries.len() as u64, "entry", "entries");
        return Err(format!("{found}, and {count} by its macro; export the table again"));
    }
    let (clock_hz, max_error_cycles) = (define("CLOCK_HZ")?, define("MAX_ERROR_CYCLES")?);
    let (min_cycles, max_cycles) = (define("MIN_CYCLES")?, define("MAX_CYCLES")?);
    let name = name.to_string();
    Ok(WrittenTable { name, format, entries, steps, clock_hz, max_error_cycles, min_cycles, max_cycles })
}

/// The initializers `{interval, count, add},` of `NAME_entries[…] = { … };`
fn entries(code: &str, name: &str, format: EntryFormat) -> Result<Vec<Entry>, String> {
    let start = format!(" {name}_entries[");
    let array = code.split_once(&start).and_then(|(_, after)| after.split_once('{'));
    let body = array.and_then(|(_, after)| after.split_once("};"));
    let (body, _) = body.ok_or_else(|| format!("no array {name}_entries; export the table again"))?;
    let mut entries = Vec::new();
    for row in body.split('{').skip(1) {
        let row = row.split('}').next().unwrap_or_default();
        let mut cells = row.split(',').map(str::trim);
        let [interval, count, add] =
            [cells.next(), cells.next(), cells.next()].map(Option::unwrap_or_default);
        let mut parse = || {
            let (interval, count, add) = (number(interval)?, number(count)?, signed(add)?);
            let fits = interval <= format.max_interval()
                && count <= format.max_count()
                && (format.min_add()..=format.max_add()).contains(&add);
            (fits && cells.next().is_none()).then_some(Entry { interval, count, add })
        };
        let index = entries.len();
        let entry = parse().ok_or_else(|| {
            format!("entry {index}: {{{row}}} is no entry of format {}; export the table again", format.name)
        })?;
        entries.push(entry);
    }
    Ok(entries)
}

/// A literal with a suffix.
fn number<T: FromStr>(text: &str) -> Option<T> {
    text.trim_end_matches(['U', 'L']).parse().ok()
}

/// A literal with a sign and a suffix; the minimum of a type is `(-MAX - 1)`.
fn signed(text: &str) -> Option<i64> {
    match text.strip_prefix('(').and_then(|text| text.strip_suffix(')')) {
        None => number(text),
        Some(difference) => {
            let (from, less) = difference.split_once(" - ")?;
            number::<i64>(from)?.checked_sub(number(less)?)
        }
    }
}

impl WrittenTable {
    /// Compares the walk with the planned steps, and returns the largest timing error in cycles.
    ///
    /// # Errors
    /// The first difference: another clock, another number of steps, a step in the other direction, a step farther from
    /// its time than the table states, or events that are shorter or longer than it states.
    pub fn check(&self, due: impl IntoIterator<Item = ScheduledStep>, clock_hz: u32) -> Result<u64, String> {
        if self.clock_hz != u64::from(clock_hz) {
            return Err(format!(
                "the table counts cycles of {} Hz, the plan of {clock_hz} Hz",
                self.clock_hz
            ));
        }
        let (mut found, mut due) = (TableWalk::new(&self.entries, self.format).steps(), due.into_iter());
        let (mut steps, mut largest) = (0_u64, 0);
        loop {
            let (found, due) = match (found.next(), due.next()) {
                (None, None) => break,
                (Some(_), None) => {
                    return Err(format!(
                        "the plan ends after {}, the table does not",
                        counted(steps, "step", "steps")
                    ));
                }
                (None, Some(_)) => {
                    return Err(format!(
                        "the table ends after {}, the plan does not",
                        counted(steps, "step", "steps")
                    ));
                }
                (Some(found), Some(due)) => (found, due),
            };
            let side = |right| if right { "right" } else { "left" };
            if found.right != due.right {
                let (found, due) = (side(found.right), side(due.right));
                return Err(format!("step {steps} is to the {found} in the table, to the {due} in the plan"));
            }
            let error = found.cycle.abs_diff(due.cycle);
            if error > self.max_error_cycles {
                return Err(format!(
                    "step {steps} is in cycle {} of the table and cycle {} of the plan: {}, the table states at most {}",
                    found.cycle,
                    due.cycle,
                    counted(error, "cycle", "cycles"),
                    self.max_error_cycles
                ));
            }
            (steps, largest) = (steps + 1, largest.max(error));
        }
        if steps != self.steps {
            let steps = counted(steps, "step", "steps");
            return Err(format!("the table has {steps}, and {} by its macro", self.steps));
        }
        let extremes = Extremes::of(TableWalk::new(&self.entries, self.format));
        for (found, stated, name) in [
            (extremes.min.unwrap_or(0), self.min_cycles, "MIN_CYCLES"),
            (extremes.max, self.max_cycles, "MAX_CYCLES"),
        ] {
            if found != stated {
                return Err(format!("{name} is {stated}, and {found} by the table's walk; export it again"));
            }
        }
        Ok(largest)
    }
}
