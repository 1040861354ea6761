//! The timing check of `stepscope run --timing`, and `stepscope drivers`.

use crate::failure::{Failure, plural, with_hint};
use crate::{json::Tables, output::Out, scenarios, suggest, terminal};
use clap::Args;
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use stepscope_core::capture::timebase::Timebase;
use stepscope_core::inspect::trace::drivers::{self, DRIVERS, DataSheet};
use stepscope_core::inspect::trace::timing::{Rule, RuleResult, TimingCheck};
use stepscope_core::peripheral::units::{Cycles, Instant};
use stepscope_core::scenario::{Scenario, TimingRules};

const MAX_SHOWN: usize = 20;
const MAX_WRITTEN: usize = 1_000_000;

#[derive(Args)]
pub(crate) struct Options {
    /// Check STEP, DIR and EN against the scenario's driver
    ///
    /// Prints the shortest times, their slack and the first violations.
    #[arg(long)]
    timing: bool,
    /// Check STEP, DIR and EN against this driver's timing
    ///
    /// Use a driver from `stepscope drivers`, your own limits such as custom:step_high_ns=1000,dir_setup_ns=200, or a
    /// JSON file with limits. Replaces the scenario's driver.
    #[arg(long, value_name = "DRIVER")]
    driver: Option<PathBuf>,
    /// Write the violations (CSV), at most a million
    #[arg(long, value_name = "FILE")]
    pub(crate) violations: Option<PathBuf>,
    /// End with exit code 3 if the timing check finds a violation
    #[arg(long)]
    strict: bool,
}

const CUSTOM: &str = "custom:";

/// A listed driver, `custom:field=ns,...`, or a JSON file.
fn parse_driver(path: &Path) -> Result<TimingRules, String> {
    let text = path.to_str().unwrap_or_default();
    if let Some(sheet) = DRIVERS.into_iter().find(|sheet| sheet.id == text) {
        return Ok(sheet.rules.clone());
    }
    if let Some(fields) = text.strip_prefix(CUSTOM) {
        return parse_limits(fields);
    }
    let read = scenarios::text(path).map_err(|error| match error {
        Failure::File(_, error) if error.kind() == io::ErrorKind::NotFound => {
            let ids = DRIVERS.map(|sheet| sheet.id).join(", ");
            let hint = suggest::hint(text, DRIVERS.iter().map(|sheet| sheet.id));
            format!("no driver or file of this name; use one of {ids}, limits such as custom:step_high_ns=1000, or a JSON file{hint}")
        }
        Failure::File(_, error) => error.to_string(),
        error => error.to_string(),
    })?;
    parse_rules(
        serde_json::from_str(&read).map_err(|error| format!("not JSON: {error}; {}", allowed_limits()))?,
    )
}

fn parse_limits(fields: &str) -> Result<TimingRules, String> {
    let mut rules = serde_json::Map::new();
    for field in fields.split(',') {
        let (name, ns) =
            field.split_once('=').ok_or_else(|| format!("{field:?}: no \"=\"; {}", allowed_limits()))?;
        let (name, ns) = (name.trim(), ns.trim());
        let names = Rule::ALL.map(|rule| format!("{}_ns", rule.name()));
        if names.iter().all(|known| known != name) {
            let hint = suggest::hint(name, names.iter().map(String::as_str));
            return Err(format!("unknown limit {name}{hint}; {}", allowed_limits()));
        }
        let value: u64 = ns
            .parse()
            .map_err(|_| format!("{name}: {ns:?} is not a whole number of ns; {}", allowed_limits()))?;
        if rules.insert(name.to_owned(), value.into()).is_some() {
            return Err(format!("{name} is given twice; use it once"));
        }
    }
    parse_rules(Value::Object(rules))
}

/// Accepts a scenario's `driver_timing`, with or without that name and `rules` around the limits.
fn parse_rules(found: Value) -> Result<TimingRules, String> {
    let inner = found.get("driver_timing").cloned().unwrap_or(found);
    let is_whole = inner.get("rules").is_some() || inner.get("preset").is_some();
    let timing = if is_whole { inner } else { json!({ "rules": inner }) };
    let (scenario, unreadable) = Scenario::from_json_lenient(&json!({ "driver_timing": timing }).to_string());
    let problems: Vec<_> = unreadable.into_iter().chain(scenario.check().err()).flatten().collect();
    match scenario.driver_timing.as_ref().filter(|_| problems.is_empty()) {
        Some(driver) => Ok(drivers::rules(driver)),
        None => {
            let problems: Vec<String> = problems.iter().map(with_hint).collect();
            if problems.is_empty() {
                return Err(format!("no limits; {}", allowed_limits()));
            }
            Err(problems.join("; ").replace("driver_timing.rules.", ""))
        }
    }
}

fn allowed_limits() -> String {
    let fields = Rule::ALL.map(|rule| format!("{}_ns", rule.name())).join(", ");
    format!("use {fields}, each 0 to 1000000000 ns")
}

impl Options {
    pub(crate) const fn is_wanted(&self) -> bool {
        self.timing || self.driver.is_some() || self.violations.is_some() || self.strict
    }

    pub(crate) fn rules(&self, path: &Path, scenario: &Scenario) -> Result<Option<TimingRules>, Failure> {
        if !self.is_wanted() {
            return Ok(None);
        }
        let own = || scenario.driver_timing.as_ref().map(drivers::rules);
        let wrong = |given: &Path, why| Failure::Option(format!("--driver: {}: {why}", given.display()));
        let named = self.driver.as_deref().map(|given| parse_driver(given).map_err(|why| wrong(given, why)));
        let rules = named.transpose()?.or_else(own);
        rules.map(Some).ok_or_else(|| {
            let why = "the scenario has no driver; use --driver (`stepscope drivers` lists the drivers)";
            Failure::invalid(path, why)
        })
    }

    pub(crate) const fn max_violations(&self) -> usize {
        if self.violations.is_some() { MAX_WRITTEN } else { MAX_SHOWN }
    }

    pub(crate) fn check(&self, path: &Path, scenario: &Scenario) -> Result<Option<TimingCheck>, Failure> {
        let rules = self.rules(path, scenario)?;
        Ok(rules.map(|rules| TimingCheck::new(&rules, scenario.clock_hz, self.max_violations())))
    }

    pub(crate) fn report(&self, check: &TimingCheck, unit: TimeUnit) -> Result<(), Failure> {
        // Text must not be mixed with a table on standard output.
        if self.violations.is_none() || self.timing {
            print(check, unit).map_err(Failure::output)?;
        }
        Ok(())
    }

    pub(crate) fn needs_steps(&self, has_steps: bool) -> Result<(), Failure> {
        if has_steps || !self.strict {
            return Ok(());
        }
        let why =
            "--strict: the recording has no steps to check; map a channel to STEP0, such as --map STEP0=CH1";
        Err(Failure::Check(why.to_owned()))
    }

    pub(crate) fn result(&self, check: &TimingCheck) -> Result<(), Failure> {
        let count = check.total();
        if count == 0 || !self.strict {
            return Ok(());
        }
        let s = plural(count);
        Err(Failure::Check(format!("--strict: {count} violation{s} of the driver's timing")))
    }
}

pub(crate) fn tables(tables: Tables, check: &TimingCheck, unit: TimeUnit) -> Tables {
    let rule = |result: &RuleResult| {
        let least = result.shortest.as_ref();
        let required = (result.nanos > 0).then_some(result.nanos);
        let spare = required.and_then(|required| Some(unit.slack(least?.measured, required).nanos()));
        json!({
            "rule": result.rule.name(),
            "required_ns": required,
            "least_ns": least.map(|least| unit.slack(least.measured, 0).nanos()),
            "spare_ns": spare,
            "at_cycle": least.map(|least| unit.cycle(least.at)),
            "channel": least.map(|least| least.channel),
            "violations": result.total(),
        })
    };
    let violations = check.violations().iter().map(|found| -> Value {
        json!({
            "cycle": unit.cycle(found.at),
            "channel": found.channel,
            "rule": found.rule.name(),
            "measured_cycles": unit.cycles(found.measured),
            "required_cycles": unit.cycles_up(found.required),
        })
    });
    tables.with("timing", check.results().iter().map(rule)).with("violations", violations)
}

pub(crate) fn drivers(as_json: bool) -> Result<(), Failure> {
    if as_json {
        let figure = |sheet: &'static DataSheet| {
            Rule::ALL.iter().filter(|rule| rule.nanos(&sheet.rules) > 0).map(|rule| {
                json!({ "driver": sheet.id, "rule": rule.name(), "required_ns": rule.nanos(&sheet.rules) })
            })
        };
        let driver =
            |sheet: &'static DataSheet| json!({ "id": sheet.id, "name": sheet.name, "source": sheet.source });
        let tables = Tables::of("drivers").with("drivers", DRIVERS.into_iter().map(driver));
        return tables.with("rules", DRIVERS.into_iter().flat_map(figure)).print();
    }
    let list = |out: &mut dyn Write| {
        DRIVERS.iter().try_for_each(|sheet| {
            writeln!(out, "{:14} {}", sheet.id, sheet.name)?;
            writeln!(out, "{:14} {}", "", figures(&sheet.rules))?;
            writeln!(out, "{:14} {}", "", sheet.source)
        })?;
        writeln!(out, "{:14} your own limits in ns: --driver {}", "custom", example())?;
        writeln!(out, "{:14} or a JSON file: {{\"step_high_ns\": 1000, \"dir_setup_ns\": 200}}", "")
    };
    list(&mut terminal::out()).map_err(Failure::output)
}

fn example() -> String {
    let fields = Rule::ALL.map(|rule| format!("{}_ns={}", rule.name(), rule.nanos(&drivers::DRV8825.rules)));
    format!("{CUSTOM}{}", fields.join(","))
}

fn figures(rules: &TimingRules) -> String {
    let limits = Rule::ALL.iter().filter(|rule| rule.nanos(rules) > 0);
    limits.map(|rule| format!("{} {} ns", rule.name(), rule.nanos(rules))).collect::<Vec<_>>().join(", ")
}

pub(crate) fn write_violations(mut out: Out, check: &TimingCheck, unit: TimeUnit) -> io::Result<()> {
    writeln!(out, "cycle,time_s,channel,rule,measured_cycles,required_cycles,measured_ns,required_ns")?;
    for found in check.violations() {
        let cycle = unit.cycle(found.at);
        let time = Instant(cycle).seconds(unit.clock_hz);
        let (channel, rule) = (found.channel, found.rule.name());
        let (measured, required) = (unit.cycles(found.measured), unit.cycles_up(found.required));
        let required_ns = check.results().get(found.rule as usize).map_or(0, |result| result.nanos);
        let nanos = unit.slack(found.measured, 0);
        writeln!(out, "{cycle},{time},{channel},{rule},{measured},{required},{nanos},{required_ns}")?;
    }
    out.flush()
}

/// `-` without a limit or a measurement.
fn cell(value: Option<impl std::fmt::Display>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| value.to_string())
}

fn print(check: &TimingCheck, unit: TimeUnit) -> io::Result<()> {
    let mut out = terminal::out();
    writeln!(out, "rule         required_ns     least_ns     spare_ns        at_cycle  channel  violations")?;
    for result in check.results() {
        let (name, total) = (result.rule.name(), result.total());
        let (limit, least) = ((result.nanos > 0).then_some(result.nanos), result.shortest);
        let required = cell(limit);
        let measured = cell(least.map(|least| unit.slack(least.measured, 0)));
        let spare = cell(limit.zip(least).map(|(limit, least)| unit.slack(least.measured, limit)));
        let at = cell(least.map(|least| unit.cycle(least.at)));
        let channel = cell(least.map(|least| least.channel));
        writeln!(
            out,
            "{name:12} {required:>11} {measured:>12} {spare:>12} {at:>15} {channel:>8} {total:>11}"
        )?;
    }
    writeln!(out, "violations {}", check.total())?;
    for found in check.violations().iter().take(MAX_SHOWN) {
        let (cycle, channel, rule) = (unit.cycle(found.at), found.channel, found.rule.name());
        let (measured, required) = (unit.cycles(found.measured), unit.cycles_up(found.required));
        writeln!(
            out,
            "cycle {cycle} channel {channel} {rule}: {measured} cycles, at least {required} required"
        )?;
    }
    match check.total().saturating_sub(MAX_SHOWN as u64) {
        0 => Ok(()),
        more => writeln!(out, "and {more} more"),
    }
}

/// Printed in ns with three decimal places. Rounded down, so that sums agree and negative slack stays negative.
struct Picoseconds(i128);

/// The unit of measured times: a cycle, or a tick of a recording if no clock has whole cycles.
#[derive(Clone, Copy)]
pub(crate) struct TimeUnit {
    base: Timebase,
    clock_hz: u32,
}

impl TimeUnit {
    pub(crate) fn of_cycles(clock_hz: u32) -> Self {
        Self { base: Timebase::new(1, clock_hz.into()).unwrap_or(Timebase::SECOND), clock_hz }
    }

    pub(crate) const fn of_ticks(base: Timebase, clock_hz: u32) -> Self {
        Self { base, clock_hz }
    }

    /// `measured` minus `nanos`, a limit in ns.
    fn slack(self, measured: Cycles, nanos: u32) -> Picoseconds {
        let (numerator, denominator) = self.base.parts();
        let scale = u128::from(numerator).saturating_mul(1_000_000_000_000);
        let whole = u128::from(measured.0).saturating_mul(scale) / u128::from(denominator);
        Picoseconds(i128::try_from(whole).unwrap_or(i128::MAX).saturating_sub(i128::from(nanos) * 1000))
    }

    fn cycle(self, at: Instant) -> u64 {
        self.base.cycle(at.0, self.clock_hz).unwrap_or(u64::MAX)
    }

    fn cycles(self, time: Cycles) -> u64 {
        let (scaled, denominator) = self.scaled(time);
        u64::try_from(scaled / denominator).unwrap_or(u64::MAX)
    }

    /// Rounded up: a violation is then shorter in cycles, too.
    fn cycles_up(self, time: Cycles) -> u64 {
        let (scaled, denominator) = self.scaled(time);
        u64::try_from(scaled.div_ceil(denominator)).unwrap_or(u64::MAX)
    }

    fn scaled(self, time: Cycles) -> (u128, u128) {
        let (numerator, denominator) = self.base.parts();
        let scale = u128::from(numerator) * u128::from(self.clock_hz);
        (u128::from(time.0).saturating_mul(scale), denominator.into())
    }
}

impl Picoseconds {
    fn nanos(&self) -> f64 {
        self.0 as f64 / 1000.0
    }
}

impl std::fmt::Display for Picoseconds {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (sign, size) = (if self.0 < 0 { "-" } else { "" }, self.0.unsigned_abs());
        let digits = format!("{}.{:03}", size / 1000, size % 1000);
        write!(f, "{sign}{}", digits.trim_end_matches('0').trim_end_matches('.'))
    }
}
