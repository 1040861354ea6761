//! Reads the result of a libFuzzer run from its output.

use std::fmt;

#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Report {
    executions: u64,
    executions_per_second: u64,
    /// Coverage counters reached and in total. The total includes everything that is linked, so it is never reached.
    covered: u64,
    counters: u64,
    /// Inputs that reached something new.
    new_inputs: u64,
    slowest_s: u64,
    memory_mb: u64,
    pub(crate) finding: Option<String>,
    error: Vec<String>,
}

const MAX_LINES: usize = 6;
/// Characters per line: a panic may contain a whole scenario.
const MAX_CHARACTERS: usize = 200;

impl Report {
    pub(crate) fn of(log: &str) -> Self {
        let mut report = Self::default();
        let number = |text: &str| text.trim().parse().unwrap_or(0);
        for line in log.lines() {
            if let Some((name, value)) =
                line.strip_prefix("stat::").and_then(|statistic| statistic.split_once(':'))
            {
                match name {
                    "number_of_executed_units" => report.executions = number(value),
                    "average_exec_per_sec" => report.executions_per_second = number(value),
                    "new_units_added" => report.new_inputs = number(value),
                    "slowest_unit_time_sec" => report.slowest_s = number(value),
                    "peak_rss_mb" => report.memory_mb = number(value),
                    _ => {}
                }
            } else if let Some(rest) = line.strip_prefix("INFO: Loaded 1 modules") {
                let digits =
                    rest.split(['(', ' ']).find(|word| word.starts_with(|c: char| c.is_ascii_digit()));
                report.counters = digits.map_or(0, number);
            } else if line.starts_with('#')
                && let Some((_, rest)) = line.split_once(" cov: ")
            {
                report.covered = rest.split(' ').next().map_or(0, number);
            } else if let Some((_, file)) = line.split_once("Test unit written to ") {
                report.finding = Some(file.trim().to_owned());
            }
        }
        if report.finding.is_some() {
            report.error = error(log);
        }
        report
    }
}

/// The panic without its consequences, or libFuzzer's own error.
fn error(log: &str) -> Vec<String> {
    let from = |mark: &str| log.lines().skip_while(|line| !line.contains(mark)).collect::<Vec<_>>();
    let panic = from("panicked at ");
    let error = if panic.is_empty() { from("ERROR: libFuzzer: ") } else { panic };
    let is_end = |line: &&str| line.starts_with("stack backtrace") || line.starts_with("note: ");
    let shown = error.into_iter().take_while(|line| !is_end(line)).take(MAX_LINES);
    shown.map(|line| line.chars().take(MAX_CHARACTERS).collect()).collect()
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} executions ({}/s), {} of {} edges covered, {} inputs that reached something new; slowest input {}, {} MB",
            self.executions,
            self.executions_per_second,
            self.covered,
            self.counters,
            self.new_inputs,
            if self.slowest_s == 0 { "under 1 s".to_owned() } else { format!("{} s", self.slowest_s) },
            self.memory_mb
        )?;
        if self.finding.is_some() {
            f.write_str("\nFOUND")?;
        }
        self.error.iter().try_for_each(|line| write!(f, "\n  {line}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_without_findings_is_reported_with_its_numbers() {
        let log = "INFO: Loaded 1 modules   (3717 inline 8-bit counters): 3717 [0x1, 0x2), \n\
                   #12\tINITED cov: 700 ft: 1204 corp: 11/3213b exec/s: 0 rss: 28Mb\n\
                   #188337\tDONE   cov: 935 ft: 3243 corp: 468/50Kb lim: 544 exec/s: 3087 rss: 29Mb\n\
                   Done 188337 runs in 61 second(s)\n\
                   stat::number_of_executed_units: 188337\n\
                   stat::average_exec_per_sec:     3087\n\
                   stat::new_units_added:          1744\n\
                   stat::slowest_unit_time_sec:    0\n\
                   stat::peak_rss_mb:              29\n";
        let report = Report::of(log);
        assert_eq!(report.finding, None);
        assert_eq!(
            report.to_string(),
            "188337 executions (3087/s), 935 of 3717 edges covered, 1744 inputs that reached something new; \
             slowest input under 1 s, 29 MB"
        );
    }

    #[test]
    fn a_finding_is_reported_with_its_panic_and_file() {
        let log = "#5\tNEW    cov: 7 ft: 8\n\n\
                   thread '<unnamed>' (2453) panicked at tests/src/fuzzing/link.rs:61:21:\n\
                   assertion `left == right` failed\n\
                   stack backtrace:\n   0: __rustc::rust_begin_unwind\n\
                   ==21917== ERROR: libFuzzer: deadly signal\n\
                   artifact_prefix='findings/'; Test unit written to findings/crash-5f\n";
        let report = Report::of(log);
        assert_eq!(report.finding.as_deref(), Some("findings/crash-5f"));
        let text = report.to_string();
        let expected = "\nFOUND\n  thread '<unnamed>' (2453) panicked at tests/src/fuzzing/link.rs:61:21:\n  \
                    assertion `left == right` failed";
        assert!(text.ends_with(expected), "{text}");
    }

    #[test]
    fn without_a_panic_the_error_of_libfuzzer_is_reported() {
        let log = "==7== ERROR: libFuzzer: timeout after 10 seconds\n\
                   artifact_prefix='findings/'; Test unit written to findings/timeout-5f\n";
        assert!(
            Report::of(log).to_string().contains("FOUND\n  ==7== ERROR: libFuzzer: timeout after 10 seconds")
        );
    }
}
