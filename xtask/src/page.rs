//! The page's wasm, optimised, and what each file of the page weighs on the way to a visitor.

use std::fmt;
use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use flate2::Compression;
use flate2::write::GzEncoder;
use walkdir::WalkDir;

use crate::tools::{Optimise, WasmTools};
use crate::{dist, root, run};

/// What all files together may weigh, in bytes, compressed by brotli as hosts do.
const BUDGET: usize = 400_000;

/// The page as it is shipped, but made once only in this program's life: for steps that use the same page.
pub(crate) async fn built() -> Result<()> {
    static BUILT: tokio::sync::OnceCell<()> = tokio::sync::OnceCell::const_new();
    BUILT.get_or_try_init(|| shipped(Optimise::Yes)).await.copied()
}

/// Builds the page into `dist`.
pub(crate) async fn shipped(optimise: Optimise) -> Result<()> {
    build(optimise).await?;
    dist::make(&root().join("web"), &dist::folder()).await
}

/// Builds the wasm crate into `web/pkg`, installing the tools first if they are missing.
pub(crate) async fn build(optimise: Optimise) -> Result<()> {
    let tools = WasmTools::ready(optimise).await?;
    wasm(&tools, "wasm", &root().join("web").join("pkg")).await
}

/// Builds the crate in `folder` of the workspace for the browser into `package`.
pub(crate) async fn wasm(tools: &WasmTools, folder: &str, package: &Path) -> Result<()> {
    let mut command = tools.wasm_pack()?;
    command.args(["build", "--target", "web"]).args(tools.build_options());
    command.args([folder, "--out-dir"]).arg(package).args(["--", "--locked"]);
    tools.judge(run::to_end(command, run::LIMIT).await)
}

/// The sizes of one file, in bytes.
#[derive(Clone, Copy, Default)]
struct Sizes {
    raw: usize,
    gzip: usize,
    brotli: usize,
}

impl Sizes {
    /// As a static host would send it at its best settings.
    fn of(bytes: &[u8]) -> Result<Self> {
        let mut gzip = GzEncoder::new(Vec::new(), Compression::best());
        gzip.write_all(bytes)?;
        let mut brotli = Vec::new();
        brotli::BrotliCompress(&mut &*bytes, &mut brotli, &brotli::enc::BrotliEncoderParams::default())?;
        Ok(Self { raw: bytes.len(), gzip: gzip.finish()?.len(), brotli: brotli.len() })
    }

    fn plus(self, other: Self) -> Self {
        Self { raw: self.raw + other.raw, gzip: self.gzip + other.gzip, brotli: self.brotli + other.brotli }
    }
}

/// A table of all files that the page loads, with their sum; `Display` prints it.
pub(crate) struct Weights(Vec<(String, Sizes)>);

impl Weights {
    fn sum(&self) -> Sizes {
        self.0.iter().fold(Sizes::default(), |sum, (_, sizes)| sum.plus(*sizes))
    }

    /// An error if the page weighs more than it may.
    pub(crate) fn within_budget(&self) -> Result<()> {
        let weight = self.sum().brotli;
        ensure!(weight <= BUDGET, "the page weighs {weight} bytes compressed; it may weigh {BUDGET}");
        Ok(())
    }
}

impl fmt::Display for Weights {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.0.iter().map(|(name, _)| name.len()).max().unwrap_or(0).max("all files".len());
        writeln!(out, "{:width$} {:>10} {:>10} {:>10}  bytes", "file", "raw", "gzip", "brotli")?;
        let rows = self.0.iter().map(|(name, sizes)| (name.as_str(), *sizes));
        for (name, Sizes { raw, gzip, brotli }) in rows.chain([("all files", self.sum())]) {
            writeln!(out, "{name:width$} {raw:>10} {gzip:>10} {brotli:>10}")?;
        }
        Ok(())
    }
}

/// Weighs every file of `dist`.
pub(crate) fn weigh(dist: &Path) -> Result<Weights> {
    let mut rows = Vec::new();
    for entry in WalkDir::new(dist).sort_by_file_name() {
        let entry = entry.with_context(|| format!("{} can't be read", dist.display()))?;
        // The host's own rules are not sent to anybody.
        if entry.file_type().is_file() && entry.file_name() != "_headers" {
            let bytes = std::fs::read(entry.path())
                .with_context(|| format!("{} can't be read", entry.path().display()))?;
            let name = entry.path().strip_prefix(dist).unwrap_or(entry.path()).display().to_string();
            rows.push((name, Sizes::of(&bytes)?));
        }
    }
    Ok(Weights(rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_beyond_its_budget_is_refused_with_both_numbers() {
        let weights = |brotli| Weights(vec![("a".to_owned(), Sizes { brotli, ..Sizes::default() })]);
        assert!(weights(400_000).within_budget().is_ok());
        let error = weights(400_001).within_budget().unwrap_err().to_string();
        assert_eq!(error, "the page weighs 400001 bytes compressed; it may weigh 400000");
    }

    #[test]
    fn every_file_that_a_browser_can_load_is_weighed_and_summed() {
        let web = std::env::temp_dir().join(format!("stepscope-weigh-{}", std::process::id()));
        std::fs::create_dir_all(web.join("pkg")).unwrap();
        for name in ["index.html", "_headers", "pkg/a.js"] {
            std::fs::write(web.join(name), "a".repeat(1000)).unwrap();
        }
        let weights = weigh(&web).unwrap();
        let names: Vec<_> = weights.0.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["index.html", "pkg/a.js"]);
        assert!(
            weights.0.iter().all(|(_, sizes)| sizes.raw == 1000 && sizes.gzip < 100 && sizes.brotli < 100)
        );
        assert!(weights.to_string().contains("all files        2000"), "{weights}");
        std::fs::remove_dir_all(&web).unwrap();
    }
}
