//! Reads scenarios from files; `stepscope open` and `stepscope presets`.

use crate::{failure::Failure, json, pipe, scenario_file, terminal, verify};
use serde_json::json;
use std::{
    io::{self, Read, Write},
    path::Path,
    rc::Rc,
};
use stepscope_core::{
    capture::samples::sample,
    scenario::{
        MAX_TEXT_BYTES, Problem, Scenario, ValueError, link,
        presets::{CONTROLLER_PLANT_PRESETS, CONTROLLER_PRESETS, PLANT_PRESETS, PRESETS, Preset},
    },
    sim::Experiment,
};

/// Checks types only; `-` is standard input.
pub(crate) fn read(path: &Path) -> Result<Scenario, Failure> {
    match Scenario::from_json_lenient(&scenario_text(path)?) {
        (scenario, problems) if problems.is_empty() => Ok(scenario),
        (_, problems) => Err(Failure::Scenario(path.to_owned(), problems)),
    }
}

/// A validated scenario and its experiment; `-` is standard input.
pub(crate) fn judged(path: &Path) -> Result<(Rc<Scenario>, Rc<Experiment>), Failure> {
    judged_after(path, |_| Ok(()))
}

/// Like [`judged`], but checks the scenario alone first: planning long motions takes time.
pub(crate) fn judged_after(
    path: &Path,
    check: impl FnOnce(&Scenario) -> Result<(), Failure>,
) -> Result<(Rc<Scenario>, Rc<Experiment>), Failure> {
    let (scenario, unread) = Scenario::from_json_lenient(&scenario_text(path)?);
    if unread.is_empty() {
        check(&scenario)?;
    }
    let experiment = Experiment::of_lenient(&scenario, unread);
    let wrong = |problems: Vec<Problem>| Failure::Scenario(path.to_owned(), problems);
    let experiment = experiment.map_err(wrong)?;
    if experiment.jogs_without_end() {
        let detail = "the run has no end, because a jog button stays pressed; give run_cycles, or release the button in inputs";
        return Err(wrong(vec![Problem::new("run_cycles", ValueError::Conflict { detail })]));
    }
    Ok((Rc::new(scenario), Rc::new(experiment)))
}

/// A file, or else a preset.
fn scenario_text(path: &Path) -> Result<String, Failure> {
    match text(path) {
        Err(Failure::File(path, error)) if error.kind() == io::ErrorKind::NotFound => {
            let named = path.to_str().and_then(|id| {
                let recorded = || sample(id).map(|sample| sample.scenario);
                preset(id).map(|preset| preset.json).or_else(recorded)
            });
            named.map(str::to_owned).ok_or(Failure::File(path, error))
        }
        read => read,
    }
}

/// Reads only as much as needed to see that the text is too long.
pub(crate) fn text(path: &Path) -> Result<String, Failure> {
    let failed = |error| Failure::File(path.to_owned(), error);
    let input: Box<dyn Read> = if path == Path::new("-") {
        Box::new(io::stdin())
    } else {
        Box::new(pipe::to_read(path).map_err(failed)?)
    };
    let mut bytes = Vec::new();
    input.take(MAX_TEXT_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() > MAX_TEXT_BYTES {
        return Err(Failure::TooLong(path.to_owned(), MAX_TEXT_BYTES as u64));
    }
    String::from_utf8(bytes).map_err(|_| Failure::NotText(path.to_owned()))
}

fn all_presets() -> impl Iterator<Item = &'static Preset> {
    PRESETS.iter().chain(PLANT_PRESETS).chain(CONTROLLER_PRESETS).chain(CONTROLLER_PLANT_PRESETS)
}

fn preset(id: &str) -> Option<&'static Preset> {
    all_presets().find(|preset| preset.id == id)
}

/// With `verify`, runs the scenario and compares it with the link's digests.
pub(crate) fn open(link: &str, verify: bool) -> Result<(), Failure> {
    let fragment = link.split_once('#').map_or(link, |(_, fragment)| fragment);
    let scenario = link::decode(fragment).map_err(Failure::Link)?;
    // Refuse what `run` refuses.
    let path = Path::new("the link");
    Experiment::new(&scenario).map_err(|problems| Failure::Scenario(path.to_owned(), problems))?;
    scenario_file::print(path, &scenario, "open the link in the page")?;
    if verify { verify::verify(&scenario, link::part(fragment, "d").as_deref()) } else { Ok(()) }
}

pub(crate) fn presets(id: Option<&str>, as_json: bool) -> Result<(), Failure> {
    if let Some(id) = id {
        let preset = preset(id).ok_or_else(|| Failure::Preset(id.to_owned()))?;
        return print(&terminal::json(preset.json.trim_end()));
    }
    if as_json {
        let row = |preset: &Preset| json!({ "id": preset.id, "title": preset.scenario().title });
        return json::Tables::of("presets").with("presets", all_presets().map(row)).print();
    }
    let line = |preset: &Preset| format!("{:28} {}", preset.id, preset.scenario().title);
    print(&all_presets().map(line).collect::<Vec<_>>().join("\n"))
}

pub(crate) fn print(text: &str) -> Result<(), Failure> {
    writeln!(terminal::out(), "{text}").map_err(Failure::output)
}
