//! The presets of the page's menu.

use crate::convert::object;
use serde::Serialize;
use stepscope_core::scenario::presets::{
    CONTROLLER_PLANT_TITLES, CONTROLLER_TITLES, Named, PLANT_PRESETS, PRESETS, Preset,
};
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
struct Listed {
    id: &'static str,
    document: &'static str,
    title: String,
    scenario: Option<String>,
}

/// All presets: `{id, document, title, scenario}`, the scenario as JSON with every field written; null where stand-alone
/// controllers run it, which are in another module (`panel_preset`).
///
/// # Errors
/// Never in practice: the presets are tested.
#[wasm_bindgen]
pub fn presets() -> Result<JsValue, JsError> {
    let own = |preset: &Preset| {
        let scenario = preset.scenario();
        let (id, document, title) = (preset.id, preset.document, scenario.title.clone());
        Listed { id, document, title, scenario: Some(scenario.to_json()) }
    };
    let named = |&Named { id, document, title }: &Named| Listed {
        id,
        document,
        title: title.to_owned(),
        scenario: None,
    };
    let all = PRESETS.iter().chain(PLANT_PRESETS).map(own);
    let elsewhere = CONTROLLER_TITLES.iter().chain(CONTROLLER_PLANT_TITLES).map(named);
    object(&all.chain(elsewhere).collect::<Vec<_>>())
}
