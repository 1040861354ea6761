//! `cargo xtask bench --table`: writes the table of docs/benchmarks.md from the results of the last run.

use std::path::Path;

use anyhow::{Context, Result, bail};

use super::{RESULTS, table};
use crate::{files, root};

const BEGIN: &str = "<!-- Made by `cargo xtask bench --table`: begin. -->\n";
const END: &str = "<!-- End. -->\n";
const PAGE: &str = "docs/benchmarks.md";

pub(super) fn write() -> Result<()> {
    let results = root().join("target").join("bench").join(RESULTS);
    let text = std::fs::read_to_string(&results).with_context(|| {
        format!("{} can't be read; run `cargo xtask bench`, with or without --quick", shown(&results))
    })?;
    let table = table::markdown(&text).with_context(|| format!("{} is invalid", shown(&results)))?;
    let page = root().join(PAGE);
    files::write(&page, with_table(&files::read(&page)?, &table)?)
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

fn with_table(text: &str, table: &str) -> Result<String> {
    let parts = text.split_once(BEGIN).and_then(|(head, rest)| Some((head, rest.split_once(END)?.1)));
    let Some((head, tail)) = parts else {
        bail!("{PAGE} needs a line {:?} before the table and a line {:?} after it", BEGIN.trim(), END.trim())
    };
    Ok([head, BEGIN, "\n", table, "\n", END, tail].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_old_table_is_replaced() {
        let text = format!("a\n{BEGIN}\n| old |\n\n{END}b\n");
        let once = with_table(&text, "| new |\n").unwrap();
        assert_eq!(once, format!("a\n{BEGIN}\n| new |\n\n{END}b\n"));
        assert_eq!(with_table(&once, "| new |\n").unwrap(), once);
        assert!(with_table("a\nb\n", "").is_err());
    }

    #[test]
    fn the_page_has_the_marks() {
        let text = std::fs::read_to_string(root().join(PAGE)).unwrap();
        assert_eq!((text.matches(BEGIN).count(), text.matches(END).count()), (1, 1));
        assert!(with_table(&text, "| kernel |\n").is_ok());
    }
}
