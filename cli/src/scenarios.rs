//! Reads scenarios; `stepscope open` and `stepscope presets`.

use crate::options::{Json, Out};
use crate::{failure::Failure, json, output, pipe, scenario_file, suggest, terminal, verify};
use clap::Args;
use serde_json::json;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stepscope_core::capture::samples::{SAMPLES, sample};
use stepscope_core::scenario::presets::{self, Preset};
use stepscope_core::scenario::{MAX_TEXT_BYTES, Problems, Scenario, link};
use stepscope_core::sim::Experiment;

/// The name in messages if no scenario is given.
pub(crate) const DEFAULT: &str = "the default scenario";

/// Checks types only; `-` is standard input.
pub(crate) fn read(path: &Path) -> Result<Scenario, Failure> {
    match Scenario::from_json_lenient(&scenario_text(path)?) {
        (scenario, None) => Ok(scenario),
        (_, Some(problems)) => Err(Failure::Scenario(path.to_owned(), problems)),
    }
}

/// A validated scenario and its experiment; `-` is standard input.
pub(crate) fn validated(path: &Path) -> Result<(Arc<Scenario>, Arc<Experiment>), Failure> {
    validated_after(path, |_| Ok(()))
}

/// Like [`validated`], but checks the scenario alone first: planning long motions takes time.
pub(crate) fn validated_after(
    path: &Path,
    check: impl FnOnce(&Scenario) -> Result<(), Failure>,
) -> Result<(Arc<Scenario>, Arc<Experiment>), Failure> {
    let (scenario, unreadable) = Scenario::from_json_lenient(&scenario_text(path)?);
    if unreadable.is_none() {
        check(&scenario)?;
    }
    let experiment = Experiment::from_partial(&scenario, unreadable);
    let wrong = |problems: Problems| Failure::Scenario(path.to_owned(), problems);
    let experiment = experiment.map_err(wrong)?;
    experiment.check_has_end().map_err(wrong)?;
    Ok((Arc::new(scenario), Arc::new(experiment)))
}

fn scenario_text(path: &Path) -> Result<String, Failure> {
    match text(path) {
        Err(Failure::File(path, error)) if error.kind() == io::ErrorKind::NotFound => {
            let named = path.to_str().and_then(|id| {
                let recorded = || sample(id).map(|sample| sample.scenario);
                preset(id).map(|preset| preset.json).or_else(recorded)
            });
            named.map(str::to_owned).ok_or_else(|| {
                let samples = SAMPLES.iter().map(|sample| sample.id);
                let names = all_presets().map(|preset| preset.id).chain(samples);
                let hint = suggest::hint(&path.to_string_lossy(), names);
                let why = format!("no file or preset of this name{hint}; `stepscope presets` lists all");
                Failure::Unusable(path.display().to_string(), why)
            })
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
    String::from_utf8(bytes).map_err(|_| Failure::invalid(path, "not UTF-8 text; save it as UTF-8"))
}

pub(crate) fn all_presets() -> impl Iterator<Item = &'static Preset> {
    presets::all()
}

fn preset(id: &str) -> Option<&'static Preset> {
    all_presets().find(|preset| preset.id == id)
}

#[derive(Args)]
pub(crate) struct OpenArguments {
    /// Share link, or the part after its `#`
    link: String,
    /// Run the scenario and compare the run with the sender's
    ///
    /// The result goes to standard error; exit code 3 if the runs differ.
    #[arg(long)]
    verify: bool,
    #[command(flatten)]
    out: Out,
}

pub(crate) fn open(arguments: &OpenArguments) -> Result<(), Failure> {
    let OpenArguments { link, verify, out } = arguments;
    let fragment = link.split_once('#').map_or(link.as_str(), |(_, fragment)| fragment);
    let scenario = link::decode(fragment).map_err(Failure::Link)?;
    // Refuse what `run` refuses.
    let path = Path::new("the link");
    Experiment::new(&scenario).map_err(|problems| Failure::Scenario(path.to_owned(), problems))?;
    scenario_file::write(&out.out, path, &scenario, "open the link in the page")?;
    if *verify { verify::verify(&scenario, link::part(fragment, "d").as_deref()) } else { Ok(()) }
}

#[derive(Args)]
pub(crate) struct PresetsArguments {
    /// Preset to write (default: list all)
    #[arg(value_name = "PRESET", conflicts_with = "json")]
    id: Option<String>,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    out: Out,
}

pub(crate) fn presets(arguments: &PresetsArguments) -> Result<(), Failure> {
    let text = match &arguments.id {
        Some(id) => {
            let preset = preset(id).ok_or_else(|| {
                let hint = suggest::hint(id, all_presets().map(|preset| preset.id));
                let why = format!("no preset of this name{hint}; `stepscope presets` lists all");
                Failure::Invalid(PathBuf::from(id), why)
            })?;
            terminal::json(preset.json.trim_end()) + "\n"
        }
        None => {
            all_presets().map(|preset| format!("{:28} {}\n", preset.id, preset.scenario().title)).collect()
        }
    };
    output::write_new(&arguments.out.out, |out| {
        if arguments.json.json { table().write(out) } else { out.write_all(text.as_bytes()) }
    })
}

fn table() -> json::Tables {
    let row = |preset: &Preset| json!({ "id": preset.id, "title": preset.scenario().title });
    json::Tables::of("presets").with("presets", all_presets().map(row))
}
