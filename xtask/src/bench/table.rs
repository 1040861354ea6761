//! The results of the benchmarks and their tables.

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use serde_json::Value;

#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Report {
    name: String,
    /// Description; empty in a commit whose kernels have no description.
    #[serde(default)]
    what: String,
    unit: String,
    units: u64,
    edges: Option<u64>,
    yardstick: Option<String>,
    aim: Option<f64>,
    browser_aim: Option<f64>,
    seconds: Vec<f64>,
}

impl Report {
    pub(super) fn all_from_json(text: &str) -> Result<Vec<Self>> {
        serde_json::from_str(text).with_context(|| format!("not a report of the kernels: {text:?}"))
    }

    /// Units per second of the best call; other programs on the machine only add time.
    fn best(&self) -> f64 {
        self.units as f64 / self.seconds.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

#[derive(Serialize)]
pub(super) struct Block {
    pub(super) native: Vec<Report>,
    pub(super) browser: Vec<Report>,
}

pub(super) struct Estimate {
    median_s: f64,
    deviation_s: f64,
}

impl Estimate {
    pub(super) fn from_json(text: &str) -> Result<Self> {
        #[derive(Deserialize)]
        struct Estimates {
            median: Point,
            median_abs_dev: Point,
        }
        #[derive(Deserialize)]
        struct Point {
            point_estimate: f64,
        }
        let Estimates { median, median_abs_dev } = serde_json::from_str(text)?;
        Ok(Self { median_s: median.point_estimate * 1e-9, deviation_s: median_abs_dev.point_estimate * 1e-9 })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
struct Ratio {
    median: f64,
    deviation: f64,
}

impl Ratio {
    fn of(ratios: &[f64]) -> Self {
        let median = median(ratios.iter().copied());
        Self { median, deviation: self::median(ratios.iter().map(|ratio| (ratio - median).abs())) }
    }

    fn print(self) -> String {
        let digits = if self.median < 10.0 { 3 } else { 0 };
        format!("{:.digits$} ± {:.digits$}", self.median, self.deviation)
    }

    /// The aim, and whether this ratio meets it.
    fn compare_with(self, aim: Option<f64>) -> String {
        let met = |aim: f64| if self.median >= aim { "met" } else { "missed" };
        aim.map_or_else(String::new, |aim| format!("at least {aim:.2}: {}", met(aim)))
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    match (values.get(half), half.checked_sub(1).and_then(|below| values.get(below))) {
        (Some(&upper), Some(&lower)) if values.len().is_multiple_of(2) => (lower + upper) / 2.0,
        (Some(&middle), _) => middle,
        (None, _) => f64::NAN,
    }
}

pub(super) fn tables(blocks: &[Block], estimate: impl Fn(&str) -> Result<Estimate>) -> Result<String> {
    let first = blocks.first().context("nothing was measured")?;
    let mut native =
        vec![["kernel", "time of a call", "units", "edges of one signal", "ratio", "aim"].map(str::to_owned)];
    for kernel in &first.native {
        native.push(native_row(kernel, blocks, &estimate(&kernel.name)?)?);
    }
    let mut browser = vec![["kernel", "native, best", "browser, best", "ratio", "aim"].map(str::to_owned)];
    for kernel in &first.browser {
        browser.push(browser_row(kernel, blocks)?);
    }
    Ok(format!("native code\n{}\nbrowser\n{}", align(&native), align(&browser)))
}

/// A lower ratio is marked as slower.
const MIN_OF_BEFORE: f64 = 0.95;

pub(super) fn against(now: &[Block], before: &[Block]) -> Result<String> {
    let first = now.first().context("nothing was measured")?;
    let mut rows = vec![["kernel", "native", "", "browser", ""].map(str::to_owned)];
    for kernel in &first.native {
        let [native, browser] = ratios_to_before(now, before, &kernel.name);
        let cells = |ratio: Option<Ratio>| match ratio {
            Some(ratio) => [ratio.print(), ratio.compare_with(Some(MIN_OF_BEFORE))],
            None => ["–".to_owned(), String::new()],
        };
        let ([native, native_aim], [browser, browser_aim]) = (cells(native), cells(browser));
        rows.push([kernel.name.clone(), native, native_aim, browser, browser_aim]);
    }
    Ok(align(&rows))
}

/// Ratios of the speeds now and before, native and in the browser; `None` if the kernel was not measured in both.
fn ratios_to_before(now: &[Block], before: &[Block], kernel: &str) -> [Option<Ratio>; 2] {
    let ratio_of = |side: fn(&Block) -> &[Report]| -> Option<Ratio> {
        let pairs = now.iter().zip(before);
        let ratios = pairs.map(|(now, before)| {
            let speed = |block| find(side(block), kernel).map(Report::best).ok();
            Some(speed(now)? / speed(before)?)
        });
        Some(Ratio::of(&ratios.collect::<Option<Vec<f64>>>()?))
    };
    [ratio_of(|block| &block.native), ratio_of(|block| &block.browser)]
}

#[derive(Deserialize, Serialize)]
struct Kernel {
    name: String,
    what: String,
    unit: String,
    of_yardstick: Option<Ratio>,
    yardstick: Option<String>,
    /// `None` if the kernel is not measured in the browser.
    of_native: Option<Ratio>,
    native_of_before: Option<Ratio>,
    browser_of_before: Option<Ratio>,
}

pub(super) fn markdown(results: &str) -> Result<String> {
    #[derive(Deserialize)]
    struct Results {
        kernels: Vec<Kernel>,
    }
    let Results { kernels } = serde_json::from_str(results).context("not the results of a bench")?;
    let mut lines = vec![
        "| kernel | what it does | speed, native | in the browser, of native |".to_owned(),
        "| --- | --- | --- | --- |".to_owned(),
    ];
    let yardsticks: Vec<String> = kernels.iter().filter_map(|kernel| kernel.yardstick.clone()).collect();
    for Kernel { name, what, of_yardstick, yardstick, of_native, .. } in kernels {
        if of_yardstick.is_none() && of_native.is_none() && !yardsticks.contains(&name) {
            continue;
        }
        let native = of_yardstick.zip(yardstick);
        let native = native.map(|(ratio, yardstick)| format!("{} of `{yardstick}`", ratio.print()));
        let browser = of_native.map(Ratio::print);
        let [native, browser] = [native, browser].map(|cell| cell.unwrap_or_else(|| "–".to_owned()));
        lines.push(format!("| `{name}` | {what} | {native} | {browser} |"));
    }
    Ok(lines.join("\n") + "\n")
}

pub(super) fn json(blocks: &[Block], before: Option<&[Block]>, page: Option<Value>) -> Result<String> {
    #[derive(Serialize)]
    struct Results<'b> {
        kernels: Vec<Kernel>,
        blocks: &'b [Block],
        before: Option<&'b [Block]>,
        page: Option<Value>,
    }
    let first = blocks.first().context("nothing was measured")?;
    let kernels = first.native.iter().map(|report| {
        let Report { name, what, unit, yardstick, .. } = report;
        let of_yardstick = yardstick.as_ref().map(|yardstick| {
            ratio(blocks, |block| Ok((find(&block.native, name)?, find(&block.native, yardstick)?)))
        });
        let [native_of_before, browser_of_before] =
            before.map_or([None; 2], |before| ratios_to_before(blocks, before, name));
        Ok(Kernel {
            name: name.clone(),
            what: what.clone(),
            unit: unit.clone(),
            of_yardstick: of_yardstick.transpose()?,
            yardstick: yardstick.clone(),
            of_native: ratio(blocks, |block| Ok((find(&block.browser, name)?, find(&block.native, name)?)))
                .ok(),
            native_of_before,
            browser_of_before,
        })
    });
    let results = Results { kernels: kernels.collect::<Result<_>>()?, blocks, before, page };
    Ok(serde_json::to_string_pretty(&results)? + "\n")
}

fn native_row(kernel: &Report, blocks: &[Block], estimate: &Estimate) -> Result<[String; 6]> {
    let calls = 1.0 / estimate.median_s;
    let ratio = match &kernel.yardstick {
        Some(yardstick) => {
            let ratio = ratio(blocks, |block| {
                Ok((find(&block.native, &kernel.name)?, find(&block.native, yardstick)?))
            })?;
            Some((ratio, yardstick.as_str()))
        }
        None => None,
    };
    Ok([
        kernel.name.clone(),
        format!("{} ± {:.1} %", si(estimate.median_s, "s"), 100.0 * estimate.deviation_s / estimate.median_s),
        si(kernel.units as f64 * calls, &format!("{}/s", kernel.unit)),
        kernel.edges.map_or_else(String::new, |edges| si(edges as f64 * calls, "edges/s")),
        ratio.map_or_else(String::new, |(ratio, yardstick)| format!("{} of {yardstick}", ratio.print())),
        ratio.map_or_else(String::new, |(ratio, _)| ratio.compare_with(kernel.aim)),
    ])
}

fn browser_row(kernel: &Report, blocks: &[Block]) -> Result<[String; 5]> {
    let ratio =
        ratio(blocks, |block| Ok((find(&block.browser, &kernel.name)?, find(&block.native, &kernel.name)?)))?;
    let best = |of: fn(&Block) -> &[Report]| -> Result<String> {
        let bests = blocks.iter().map(|block| Ok(find(of(block), &kernel.name)?.best()));
        let bests: Vec<f64> = bests.collect::<Result<_>>()?;
        Ok(si(median(bests.into_iter()), &format!("{}/s", kernel.unit)))
    };
    Ok([
        kernel.name.clone(),
        best(|block| &block.native)?,
        best(|block| &block.browser)?,
        format!("{} of native", ratio.print()),
        ratio.compare_with(kernel.browser_aim),
    ])
}

fn ratio<'b>(
    blocks: &'b [Block],
    pair: impl Fn(&'b Block) -> Result<(&'b Report, &'b Report)>,
) -> Result<Ratio> {
    let ratios =
        blocks.iter().map(|block| pair(block).map(|(kernel, yardstick)| kernel.best() / yardstick.best()));
    Ok(Ratio::of(&ratios.collect::<Result<Vec<f64>>>()?))
}

fn find<'r>(reports: &'r [Report], name: &str) -> Result<&'r Report> {
    reports.iter().find(|report| report.name == name).with_context(|| format!("{name} was not measured"))
}

fn align<const N: usize>(rows: &[[String; N]]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(width);
    let line = |row: &[String; N]| {
        let cells = row.iter().zip(widths).enumerate().map(|(column, (cell, width))| {
            if column == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    rows.iter().map(line).collect()
}

fn si(value: f64, unit: &str) -> String {
    let prefixes = [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")];
    let (scale, prefix) = prefixes.into_iter().find(|(scale, _)| value >= *scale).unwrap_or((1e-9, "n"));
    let scaled = value / scale;
    let digits = if scaled >= 99.95 {
        0
    } else if scaled >= 9.995 {
        1
    } else {
        2
    };
    format!("{scaled:.digits$} {prefix}{unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(name: &str, yardstick: Option<&str>, seconds: &[f64]) -> Report {
        Report {
            name: name.to_owned(),
            what: format!("a {name}"),
            unit: "records".to_owned(),
            units: 1000,
            edges: Some(4000),
            yardstick: yardstick.map(str::to_owned),
            aim: yardstick.map(|_| 0.25),
            browser_aim: yardstick.map(|_| 0.6),
            seconds: seconds.to_vec(),
        }
    }

    #[test]
    fn a_ratio_is_the_median_of_the_ratios_of_the_best_calls_per_block() {
        // In each block the yardstick's best call takes 1 ms; a disturbed call changes nothing.
        let blocks: Vec<Block> = [[0.004, 0.9], [0.9, 0.005], [0.002, 0.004]]
            .iter()
            .map(|seconds| Block {
                native: vec![report("copy", None, &[0.9, 0.001]), report("trace", Some("copy"), seconds)],
                browser: vec![report("trace", Some("copy"), &[0.01])],
            })
            .collect();
        let estimate = |_: &str| Ok(Estimate { median_s: 0.004, deviation_s: 0.0001 });
        let tables = tables(&blocks, estimate).unwrap();
        let lines: Vec<Vec<&str>> = tables
            .lines()
            .map(|line| line.split("  ").filter(|cell| !cell.is_empty()).map(str::trim).collect())
            .collect();
        assert_eq!(lines[2], ["copy", "4.00 ms ± 2.5 %", "250 krecords/s", "1.00 Medges/s"]);
        let trace = ["trace", "4.00 ms ± 2.5 %", "250 krecords/s", "1.00 Medges/s"];
        assert_eq!(lines[3][..4], trace);
        assert_eq!(lines[3][4..], ["0.250 ± 0.050 of copy", "at least 0.25: met"]);
        assert_eq!(
            lines[7],
            ["trace", "250 krecords/s", "100 krecords/s", "0.400 ± 0.100 of native", "at least 0.60: missed"]
        );
    }

    #[test]
    fn a_comparison_with_a_commit_uses_alternating_blocks() {
        let block = |names: &[&str], seconds: f64| {
            let all: Vec<Report> = names.iter().map(|name| report(name, None, &[seconds])).collect();
            Block { native: all.clone(), browser: all }
        };
        let mut now = [block(&["trace", "added"], 0.002), block(&["trace", "added"], 0.004)];
        // Not every kernel is measured in the browser.
        now[0].browser.truncate(1);
        let before = [block(&["trace"], 0.001), block(&["trace"], 0.004)];
        let table = against(&now, &before).unwrap();
        let cells: Vec<Vec<&str>> = table.lines().map(|line| line.split_whitespace().collect()).collect();
        assert_eq!(cells[1][..4], ["trace", "0.750", "±", "0.250"], "the median of 0.5 and 1");
        assert_eq!(cells[2], ["added", "–", "–"]);
        let page = serde_json::json!({ "frames": [1] });
        let json: Value = serde_json::from_str(&json(&now, Some(&before), Some(page)).unwrap()).unwrap();
        assert_eq!(json["page"]["frames"][0], 1);
        assert_eq!(json["kernels"][0]["native_of_before"]["median"], 0.75);
        assert_eq!(json["kernels"][1]["browser_of_before"], Value::Null);
        assert_eq!(json["before"][0]["native"][0]["seconds"][0], 0.001);
    }

    #[test]
    fn the_markdown_table_has_all_kernels_of_comparisons() {
        let native = vec![
            report("copy", None, &[0.001]),
            report("trace", Some("copy"), &[0.004]),
            report("digest", Some("copy"), &[0.002]),
            report("page", None, &[0.001]),
            report("alone", None, &[0.001]),
        ];
        let browser = vec![report("trace", Some("copy"), &[0.008]), report("page", None, &[0.002])];
        let results = json(&[Block { native, browser }], None, None).unwrap();
        let table = markdown(&results).unwrap();
        let rows: Vec<&str> = table.lines().skip(2).collect();
        let expected = [
            "| `copy` | a copy | – | – |",
            "| `trace` | a trace | 0.250 ± 0.000 of `copy` | 0.500 ± 0.000 |",
            "| `digest` | a digest | 0.500 ± 0.000 of `copy` | – |",
            "| `page` | a page | – | 0.500 ± 0.000 |",
        ];
        assert_eq!(rows, expected);
        assert!(markdown("{}").is_err());
    }

    #[test]
    fn numbers_have_three_digits_and_a_prefix() {
        for (value, expected) in [
            (0.0, "0.00 ns"),
            (3.21e-9, "3.21 ns"),
            (0.000_045_67, "45.7 µs"),
            (1.0, "1.00 s"),
            (999.4, "999 s"),
            (1.5e9, "1.50 Gs"),
            (2.5e12, "2500 Gs"),
        ] {
            assert_eq!(si(value, "s"), expected);
        }
    }

    #[test]
    fn estimates_of_criterion_are_converted_to_seconds() {
        let text = r#"{"mean":{"point_estimate":9.0},"median":{"point_estimate":2000.0,"standard_error":1.0},"median_abs_dev":{"point_estimate":30.0}}"#;
        let Estimate { median_s, deviation_s } = Estimate::from_json(text).unwrap();
        assert!((median_s - 2e-6).abs() < 1e-18 && (deviation_s - 3e-8).abs() < 1e-18);
        assert!(Estimate::from_json("{}").is_err());
    }
}
