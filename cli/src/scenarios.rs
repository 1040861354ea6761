//! `stepscope open` and `stepscope presets`: scenarios from links and from the documents.

use crate::failure::Failure;
use std::{
    io::{self, Write},
    path::PathBuf,
};
use stepscope_core::scenario::{
    link,
    presets::{PRESETS, Preset},
};

/// Writes the scenario of a link, or of an address that ends with one, as JSON.
pub(crate) fn open(link: &str) -> Result<(), Failure> {
    let fragment = link.split_once('#').map_or(link, |(_, fragment)| fragment);
    print(&link::decode(fragment).map_err(Failure::Link)?.to_json())
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

fn print(text: &str) -> Result<(), Failure> {
    writeln!(io::stdout(), "{text}").map_err(|error| Failure::File(PathBuf::from("standard output"), error))
}
