//! The page's state without a document: `update(state, message)` over a table of cases, in the browser.

use anyhow::{Result, ensure};
use serde::Deserialize;

use crate::bench::in_sources;

#[derive(Deserialize)]
struct Outcome {
    cases: usize,
    failures: Vec<String>,
}

#[test]
fn every_message_leads_to_the_state_that_it_should() -> Result<()> {
    in_sources(|page| async move {
        page.open("").await?;
        let Outcome { cases, failures } = page.js(include_str!("state_cases.js"), vec![]).await?;
        ensure!(cases > 50, "only {cases} cases came back");
        ensure!(failures.is_empty(), "{}", failures.join("\n"));
        Ok(())
    })
}
