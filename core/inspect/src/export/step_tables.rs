//! Step times of an axis or a run as firmware tables, with their cost and source code (DESIGN B8).

use crate::export::source_code::{Language, NamedTable, Origin, Request, Source};
use alloc::string::{String, ToString};
use alloc::{format, vec::Vec};
use serde::Serialize;
use stepscope_motion::step_tables::{EntryFormat, Form, Stored, Tolerance, stored, stored_steps};
use stepscope_motion::{AxisPlan, ScheduledStep};
use stepscope_peripheral::config::{Bus, Config};
use stepscope_peripheral::{segment::PulseTimes, trace::Step, units::Cycles};
use stepscope_scenario::{Problems, Scenario, of_config};
use stepscope_sim::SelectedAxis;

/// Step tables of one axis, in every form and entry format.
#[derive(Clone, Debug)]
pub struct StepTables<'a> {
    scenario: &'a Scenario,
    steps: Steps<'a>,
    pulse: PulseTimes,
}

#[derive(Clone, Debug)]
enum Steps<'a> {
    Planned(&'a AxisPlan),
    Actual(Vec<ScheduledStep>),
}

/// Steps of a trace, from cycle 1 on.
pub fn scheduled(steps: &[Step]) -> Vec<ScheduledStep> {
    let scheduled = |(index, step): (usize, &Step)| ScheduledStep {
        cycle: step.cycle.saturating_sub(1),
        right: Step::direction(steps, index) > 0,
    };
    steps.iter().enumerate().map(scheduled).collect()
}

/// What a table costs and how accurate it is. Errors are in s.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TableCost {
    pub steps: u64,
    pub entries: usize,
    pub bytes: u64,
    /// Bytes in the format of the motion's paper, if it has one.
    pub document_bytes: Option<u64>,
    pub largest_s: f64,
    pub rms_s: f64,
    pub why: Option<String>,
}

/// An error in us as cycles, rounded down.
pub fn tolerance_cycles(error_us: f64, clock_hz: u32) -> Cycles {
    // One division, so that 25 us at 16 MHz are 400 cycles and not 399.
    Cycles((error_us * f64::from(clock_hz) / 1e6) as u64)
}

impl<'a> StepTables<'a> {
    /// Fails if the bus cannot run segments.
    pub fn new(selected: SelectedAxis<'a>) -> Result<Self, Problems> {
        Self::with(selected.scenario, selected.bus, Steps::Planned(selected.plan))
    }

    /// Steps without a plan, in cycles of the scenario's clock; fails if the bus cannot run segments.
    pub fn of_steps(scenario: &'a Scenario, bus: &Bus, steps: &[Step]) -> Result<Self, Problems> {
        Self::with(scenario, bus, Steps::Actual(scheduled(steps)))
    }

    fn with(scenario: &'a Scenario, bus: &Bus, steps: Steps<'a>) -> Result<Self, Problems> {
        let config = Config::of_segments(scenario.clock_hz, bus, &scenario.line.serial());
        Ok(Self { pulse: PulseTimes::from(&config.map_err(of_config)?), scenario, steps })
    }

    /// A table; `form` is `exact`, `document`, or `compressed` with no step off by more than `error_us`. `widths`
    /// names an [`EntryFormat`]. The compression is fast rather than minimal, because it runs on every keystroke.
    pub fn stored(&self, form: &str, widths: &str, error_us: f64) -> Result<Stored, String> {
        let clock_hz = self.scenario.clock_hz;
        let form = match form {
            "exact" => Form::Exact,
            "document" => Form::Document,
            _ => Form::Quick(Tolerance::of(tolerance_cycles(error_us, clock_hz))),
        };
        let format = EntryFormat::ALL.into_iter().find(|format| format.name == widths);
        let format = format.unwrap_or(EntryFormat::Q16);
        let stored = match &self.steps {
            Steps::Planned(plan) => stored(plan, form, format, self.pulse, clock_hz),
            Steps::Actual(steps) => stored_steps(steps, form, format, self.pulse),
        };
        stored.map_err(|cause| cause.to_string())
    }

    /// What [`Self::stored`] costs; [`TableCost::why`] has its error.
    pub fn cost(&self, form: &str, widths: &str, error_us: f64) -> TableCost {
        let seconds = |cycles: f64| cycles / f64::from(self.scenario.clock_hz);
        match self.stored(form, widths, error_us) {
            Ok(table) => TableCost {
                steps: table.error.steps,
                entries: table.entries.len(),
                bytes: table.bytes(),
                document_bytes: table.document_bytes,
                largest_s: seconds(table.error.max_cycles as f64),
                rms_s: seconds(table.error.rms()),
                why: None,
            },
            Err(why) => {
                let steps = match &self.steps {
                    Steps::Planned(plan) => plan.step_count(),
                    Steps::Actual(steps) => steps.len() as u64,
                };
                TableCost { steps, why: Some(why), ..TableCost::default() }
            }
        }
    }

    /// A table (form, entry format, error in us) as source code; `language` is `c`, `avr`, `rust` or `csv`.
    pub fn source(
        &self,
        subject: &Subject<'_>,
        (form, widths, error_us): (&str, &str, f64),
        language: &str,
    ) -> Result<String, String> {
        let table = self.stored(form, widths, error_us)?;
        let all = [Language::C, Language::Avr, Language::Rust, Language::Csv];
        let language = all.into_iter().find(|known| known.name() == language).unwrap_or(Language::C);
        let Subject { file, controller, axis } = *subject;
        let (name, number) = (format!("axis_{axis}"), format!("{axis}"));
        let request = Request {
            scenario: Some(file.as_bytes()),
            steps: None,
            axis: (axis > 0).then_some(number.as_str()),
            form,
            error_us,
            interval_part: None,
            is_early: false,
            is_quick: true,
            entries: table.format.name,
            language: language.name(),
            name: &name,
        };
        let origin = match self.steps {
            Steps::Planned(_) if controller == 0 => Origin::new(&request, self.scenario, None),
            Steps::Planned(_) => {
                Origin::of_page(&request, &format!("Axis {axis} of controller {}", controller + 1))
            }
            Steps::Actual(_) => Origin::of_page(&request, &format!("The steps of channel {axis}")),
        };
        let tables = [NamedTable { name: name.clone(), table: &table }];
        let source =
            Source { name: &name, tables: &tables, clock_hz: self.scenario.clock_hz, origin: &origin };
        let mut text = String::new();
        source.write(language, &mut text).map_err(|error| error.to_string())?;
        Ok(text)
    }
}

/// What a table of the page is of.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'s> {
    /// Name of the scenario's file, as the page saves it.
    pub file: &'s str,
    pub controller: usize,
    /// Axis, or channel without a plan.
    pub axis: usize,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::stored_run::StoredRun;
    use stepscope_peripheral::trace::steps;
    use stepscope_sim::ValidatedScenario;

    #[test]
    fn steps_of_a_run_have_the_tables_of_their_plan_but_no_paper_format() {
        let validated =
            ValidatedScenario::from_json(r#"{"source":{"motion":{"engine":"segments","axes":[{}]}}}"#);
        let experiment = validated.experiment().expect("no problems");
        let mut recording = StoredRun::default();
        experiment.run(&mut recording);
        let actual = steps(&recording.trace, 0);
        let scenario = validated.scenario();
        let of_run = StepTables::of_steps(scenario, &scenario.bus, &actual).expect("its pulses fit");
        let of_plan = StepTables::new(validated.axis(0, 0).expect("one axis")).expect("its pulses fit");
        for (form, widths) in [("exact", "ticks"), ("compressed", "q16")] {
            let [run, plan] = [&of_run, &of_plan].map(|tables| tables.cost(form, widths, 25.0));
            assert_eq!((run.steps, run.why.as_deref()), (3200, None), "{form}");
            // They come some cycles later, so an entry more or less may be needed.
            assert!(run.entries.abs_diff(plan.entries) <= plan.entries / 20, "{form}: {run:?} {plan:?}");
        }
        let none = of_run.cost("document", "q16", 25.0);
        assert!(none.steps == 3200 && none.why.is_some_and(|why| why.contains("has no table")));
        let subject = Subject { file: "turn.json", controller: 0, axis: 0 };
        let source = |tables: &StepTables<'_>, subject| {
            tables.source(&subject, ("compressed", "q16", 25.0), "c").expect("a table")
        };
        let of_steps = source(&of_run, subject);
        assert!(of_steps.contains(": the page, form compressed, error 25 us, entries q16"), "{of_steps}");
        assert!(of_steps.contains("The steps of channel 0."), "{of_steps}");
        let of_axis = source(&of_plan, subject);
        let command = ": stepscope tables turn.json --form compressed --error-us 25 --search quick --entries q16 --format c --name axis_0\n";
        assert!(of_axis.contains(command), "{of_axis}");
        let second = source(&of_plan, Subject { controller: 1, ..subject });
        assert!(second.contains("Axis 0 of controller 2."), "{second}");
    }

    #[test]
    fn a_table_costs_bytes_and_has_an_error() {
        use crate::export::step_tables::StepTables;
        use stepscope_sim::ValidatedScenario;

        let validated = ValidatedScenario::from_json("{}");
        let tables = StepTables::new(validated.axis(0, 0).expect("one axis")).expect("its pulses fit");
        let (exact, compressed) = (tables.cost("exact", "q16", 0.0), tables.cost("compressed", "q16", 25.0));
        assert_eq!((exact.steps, compressed.steps), (3200, 3200));
        assert!(compressed.bytes < exact.bytes / 4);
    }
}
