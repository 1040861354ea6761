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
    command.args(["build", "--profile", "page", "--target", "web"]).args(tools.build_options());
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

/// A table of what a host sends; `Display` prints it.
pub(crate) struct Weights {
    /// What opening the page loads.
    page: Vec<(String, Sizes)>,
    /// Other pages and what they need, icons: kept for use without a network.
    beside: Vec<(String, Sizes)>,
}

fn sum(rows: &[(String, Sizes)]) -> Sizes {
    rows.iter().fold(Sizes::default(), |sum, (_, sizes)| sum.plus(*sizes))
}

impl Weights {
    /// An error if the page weighs more than it may.
    pub(crate) fn within_budget(&self) -> Result<()> {
        let weight = sum(&self.page).brotli;
        ensure!(weight <= BUDGET, "the page weighs {weight} bytes compressed; it may weigh {BUDGET}");
        Ok(())
    }
}

impl fmt::Display for Weights {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (all, kept) = ("the page", "kept beside it");
        let names = self.page.iter().chain(&self.beside).map(|(name, _)| name.len());
        let width = names.max().unwrap_or(0).max(kept.len());
        writeln!(out, "{:width$} {:>10} {:>10} {:>10}  bytes", "file", "raw", "gzip", "brotli")?;
        for (rows, last) in [(&self.page, all), (&self.beside, kept)] {
            let rows_of = rows.iter().map(|(name, sizes)| (name.as_str(), *sizes));
            for (name, Sizes { raw, gzip, brotli }) in rows_of.chain([(last, sum(rows))]) {
                writeln!(out, "{name:width$} {raw:>10} {gzip:>10} {brotli:>10}")?;
            }
        }
        Ok(())
    }
}

/// Weighs the files of `dist`.
pub(crate) fn weigh(dist: &Path) -> Result<Weights> {
    let loaded = dist::loaded(dist)?;
    let mut weights = Weights { page: Vec::new(), beside: Vec::new() };
    for entry in WalkDir::new(dist).sort_by_file_name() {
        let entry = entry.with_context(|| format!("{} can't be read", dist.display()))?;
        // The host's own rules are not sent to anybody.
        if entry.file_type().is_file() && entry.file_name() != "_headers" {
            let bytes = std::fs::read(entry.path())
                .with_context(|| format!("{} can't be read", entry.path().display()))?;
            let path = entry.path().strip_prefix(dist).unwrap_or(entry.path());
            let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
            let name = parts.join("/");
            let rows = if loaded.contains(&name) { &mut weights.page } else { &mut weights.beside };
            rows.push((name, Sizes::of(&bytes)?));
        }
    }
    Ok(weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_beyond_its_budget_is_refused_with_both_numbers() {
        let weights = |brotli| Weights {
            page: vec![("a".to_owned(), Sizes { brotli, ..Sizes::default() })],
            beside: vec![("b".to_owned(), Sizes { brotli: 1, ..Sizes::default() })],
        };
        assert!(weights(400_000).within_budget().is_ok());
        let error = weights(400_001).within_budget().unwrap_err().to_string();
        assert_eq!(error, "the page weighs 400001 bytes compressed; it may weigh 400000");
    }

    #[test]
    fn what_opening_the_page_loads_is_summed_apart_from_what_is_kept_beside_it() {
        let dist = std::env::temp_dir().join(format!("stepscope-weigh-{}", std::process::id()));
        std::fs::create_dir_all(dist.join("assets")).unwrap();
        let space = " ".repeat(1000);
        for (name, text) in [
            ("index.html", "<a href=\"help.html\"></a><script src=\"assets/a.js\"></script>"),
            ("help.html", "<script src=\"assets/b.js\"></script>"),
            ("assets/a.js", "new URL('x.wasm',import.meta.url)"),
            ("assets/b.js", ""),
            ("assets/x.wasm", ""),
            ("sw.js", ""),
            ("_headers", ""),
        ] {
            std::fs::write(dist.join(name), format!("{text}{space}")).unwrap();
        }
        let weights = weigh(&dist).unwrap();
        let names = |rows: &[(String, Sizes)]| rows.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&weights.page), ["assets/a.js", "assets/x.wasm", "index.html", "sw.js"]);
        assert_eq!(names(&weights.beside), ["assets/b.js", "help.html"]);
        assert!(
            weights.page.iter().all(|(_, sizes)| sizes.raw >= 1000 && sizes.gzip < 150 && sizes.brotli < 150)
        );
        assert!(weights.to_string().contains("the page"), "{weights}");
        std::fs::remove_dir_all(&dist).unwrap();
    }
}
