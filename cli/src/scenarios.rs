//! Scenarios from files; `stepscope open` and `stepscope presets`: from links and from the documents.

use crate::{failure::Failure, verify};
use std::{
    fs,
    io::{self, Read, Write},
    path::Path,
    rc::Rc,
};
use stepscope_core::{
    scenario::{
        Problem, Scenario, link,
        presets::{PRESETS, Preset},
    },
    sim::{Experiment, Judged},
};

/// Reads a scenario of the right types; `-` is standard input.
pub(crate) fn read(path: &Path) -> Result<Scenario, Failure> {
    match Scenario::from_json_lenient(&text(path)?) {
        (scenario, problems) if problems.is_empty() => Ok(scenario),
        (_, problems) => Err(Failure::Scenario(path.to_owned(), problems)),
    }
}

/// A scenario that was judged, and its experiment; `-` is standard input.
pub(crate) fn judged(path: &Path) -> Result<(Rc<Scenario>, Rc<Experiment>), Failure> {
    let judged = Judged::from_json(&text(path)?);
    let experiment = judged.experiment().cloned();
    let wrong = |problems: &[Problem]| Failure::Scenario(path.to_owned(), problems.to_vec());
    Ok((Rc::clone(judged.scenario()), experiment.map_err(wrong)?))
}

/// The text of a scenario's file; `-` is standard input.
pub(crate) fn text(path: &Path) -> Result<String, Failure> {
    let bytes = if path == Path::new("-") {
        let mut bytes = Vec::new();
        io::stdin().read_to_end(&mut bytes).map(|_| bytes)
    } else {
        fs::read(path)
    };
    let bytes = bytes.map_err(|error| Failure::File(path.to_owned(), error))?;
    String::from_utf8(bytes).map_err(|_| Failure::NotText(path.to_owned()))
}

/// Writes the scenario of a link, or of an address that ends with one, as JSON; with `verify` it is also
/// run and held against what the link's sender saw.
pub(crate) fn open(link: &str, verify: bool) -> Result<(), Failure> {
    let fragment = link.split_once('#').map_or(link, |(_, fragment)| fragment);
    let scenario = link::decode(fragment).map_err(Failure::Link)?;
    print(&scenario.to_json())?;
    if verify { verify::verify(&scenario, link::part(fragment, "d").as_deref()) } else { Ok(()) }
}

/// Lists the presets, or writes the one that is asked for as JSON.
pub(crate) fn presets(id: Option<&str>) -> Result<(), Failure> {
    let Some(id) = id else {
        let line = |preset: &Preset| format!("{:28} {}", preset.id, preset.scenario().title);
        return print(&PRESETS.iter().map(line).collect::<Vec<_>>().join("\n"));
    };
    let preset = PRESETS.iter().find(|preset| preset.id == id);
    print(preset.ok_or_else(|| Failure::Preset(id.to_owned()))?.json.trim_end())
}

/// Writes a text to standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    writeln!(io::stdout(), "{text}").map_err(Failure::output)
}
