//! The presets.

use crate::convert::object;
use serde::Serialize;
use stepscope_core::scenario::presets::{
    CONTROLLER_PLANT_PRESETS, CONTROLLER_PRESETS, PLANT_PRESETS, PRESETS, Preset,
};
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
struct Listed {
    id: &'static str,
    task: &'static str,
    paper: Option<&'static str>,
    view: &'static str,
    title: String,
    scenario: String,
}

/// All presets, with all fields of the scenario as JSON.
#[wasm_bindgen]
pub fn presets() -> Result<JsValue, JsError> {
    let listed = |preset: &Preset| {
        let scenario = preset.scenario();
        Listed {
            id: preset.id,
            task: preset.task.title(),
            paper: preset.paper,
            view: preset.view,
            title: scenario.title.clone(),
            scenario: scenario.to_json(),
        }
    };
    let lists = [PRESETS, PLANT_PRESETS, CONTROLLER_PRESETS, CONTROLLER_PLANT_PRESETS];
    object(&lists.into_iter().flatten().map(listed).collect::<Vec<_>>())
}
