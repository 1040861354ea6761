//! `cargo xtask bench --table`: writes the table of docs/benchmarks.md from the results of the last run.

use std::path::Path;

use anyhow::{Context, Result, bail};

use super::{RESULTS, table};
use crate::root;

const BEGIN: &str = "<!-- Made by `cargo xtask bench --table`: begin. -->\n";
const END: &str = "<!-- End. -->\n";
const PAGE: &str = "docs/benchmarks.md";

pub(super) fn write() -> Result<()> {
    let results = root().join("target").join("bench").join(RESULTS);
    let text = std::fs::read_to_string(&results).with_context(|| {
        format!("{} can't be read; `cargo xtask bench` makes it, alone or with --quick", shown(&results))
    })?;
    let table =
        table::markdown(&text).with_context(|| format!("{} is not what it should be", shown(&results)))?;
    let page = root().join(PAGE);
    let before = std::fs::read_to_string(&page).with_context(|| format!("{} can't be read", shown(&page)))?;
    std::fs::write(&page, with(&before, &table)?)
        .with_context(|| format!("{} can't be written", shown(&page)))
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

fn with(text: &str, table: &str) -> Result<String> {
    let parts = text.split_once(BEGIN).and_then(|(head, rest)| Some((head, rest.split_once(END)?.1)));
    let Some((head, tail)) = parts else {
        bail!(
            "{PAGE} has no place for the table: a line {:?} and, after it, a line {:?}",
            BEGIN.trim(),
            END.trim()
        )
    };
    Ok([head, BEGIN, "\n", table, "\n", END, tail].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_takes_the_place_of_the_one_before_and_all_else_stays() {
        let text = format!("a\n{BEGIN}\n| old |\n\n{END}b\n");
        let once = with(&text, "| new |\n").unwrap();
        assert_eq!(once, format!("a\n{BEGIN}\n| new |\n\n{END}b\n"));
        assert_eq!(with(&once, "| new |\n").unwrap(), once);
        assert!(with("a\nb\n", "").is_err());
    }

    #[test]
    fn the_page_has_a_place_for_it() {
        let text = std::fs::read_to_string(root().join(PAGE)).unwrap();
        assert_eq!((text.matches(BEGIN).count(), text.matches(END).count()), (1, 1));
        assert!(with(&text, "| kernel |\n").is_ok());
    }
}
