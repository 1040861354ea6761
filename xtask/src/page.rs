//! Builds the page's optimized wasm and computes the download size of each file.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::build_record::BuildRecord;
use crate::dist::Parts;
use crate::tools::{Optimize, WasmTools};
use crate::{dist, docs, files, headers, package, root, run};

/// Maximum bytes that opening the page loads, compressed by brotli as hosts do.
const OPENING_BUDGET: usize = 700_000;
/// The same for all files of the page.
const TOTAL_BUDGET: usize = 1_300_000;

const CRATE: &str = "wasm";

/// Builds the page once per process, for the steps that share it.
pub(crate) async fn built() -> Result<&'static Parts> {
    static BUILT: tokio::sync::OnceCell<Parts> = tokio::sync::OnceCell::const_new();
    BUILT.get_or_try_init(|| shipped(Optimize::Yes)).await
}

pub(crate) async fn shipped(optimize: Optimize) -> Result<Parts> {
    build(optimize).await?;
    dist::make(&root().join("web"), &dist::folder()).await
}

/// Each wasm module's folder in `web` and its feature of the crate; the second one loads in the background.
pub(crate) const MODULES: [(&str, &str); 2] = [("pkg", "simulation"), ("pkg-recordings", "recordings")];

pub(crate) async fn build(optimize: Optimize) -> Result<()> {
    let tools = WasmTools::ready(optimize).await?;
    for (folder, features) in MODULES {
        let package = root().join("web").join(folder);
        let options = ["--no-default-features", "--features", features];
        let record = build_record(&tools, &package, &options).await?;
        if !record.is_current()? {
            record.clear()?;
            build_wasm(&tools, tools.wasm_pack()?, CRATE, &package, &options).await?;
            record.save()?;
        }
    }
    Ok(())
}

pub(crate) async fn npm(package: &Path) -> Result<()> {
    let tools = WasmTools::ready(Optimize::Yes).await?;
    let record = build_record(&tools, package, &[]).await?;
    if !record.is_current()? {
        record.clear()?;
        build_wasm(&tools, tools.wasm_pack()?, CRATE, package, &[]).await?;
        package::complete(package)?;
        record.save()?;
    }
    Ok(())
}

const SOURCES: [&str; 4] = ["core", CRATE, "LICENSE-MIT", "LICENSE-APACHE"];

/// wasm-pack is slow, so builds are skipped if nothing has changed.
async fn build_record<'a>(tools: &WasmTools, package: &'a Path, options: &[&str]) -> Result<BuildRecord<'a>> {
    BuildRecord::of(package, &SOURCES, &[&tools.identity(), options].concat()).await
}

pub(crate) async fn build_wasm(
    tools: &WasmTools,
    mut command: tokio::process::Command,
    folder: &str,
    package: &Path,
    options: &[&str],
) -> Result<()> {
    command.args(["build", "--profile", "page", "--target", "web"]).args(tools.build_options());
    command.args([folder, "--out-dir"]).arg(package).args(["--", "--locked"]).args(options);
    tools.check(run::compile(command).await)
}

#[derive(Clone, Copy, Default)]
struct Sizes {
    raw: usize,
    gzip: usize,
    brotli: usize,
}

impl Sizes {
    /// Compressed like a static host at its best settings.
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

#[derive(Default)]
struct Weight {
    files: Vec<(String, Sizes)>,
}

impl Weight {
    fn sum(&self) -> Sizes {
        self.files.iter().fold(Sizes::default(), |sum, (_, sizes)| sum.plus(*sizes))
    }
}

pub(crate) struct Weights {
    opening: Weight,
    /// A file may be counted under several parts.
    later: Vec<(String, Weight)>,
    /// Files only for use without a network.
    offline: Weight,
}

impl Weights {
    fn total(&self) -> Sizes {
        let parts = self.later.iter().map(|(_, part)| part).chain([&self.opening, &self.offline]);
        let files: BTreeMap<_, _> =
            parts.flat_map(|part| &part.files).map(|(name, sizes)| (name, *sizes)).collect();
        files.into_values().fold(Sizes::default(), Sizes::plus)
    }

    /// An error if opening the page, or all of it, loads more than it may.
    pub(crate) fn within_budget(&self) -> Result<()> {
        let opening = ("the first load", self.opening.sum().brotli, OPENING_BUDGET);
        let all = ("the whole page", self.total().brotli, TOTAL_BUDGET);
        for (name, size, max) in [opening, all] {
            ensure!(size <= max, "{name} is {size} bytes compressed; the maximum is {max}");
        }
        Ok(())
    }
}

impl fmt::Display for Weights {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let later = self.later.iter().map(|(name, part)| (format!("later: {name}"), part));
        let mut parts: Vec<_> =
            std::iter::once(("the page".to_owned(), &self.opening)).chain(later).collect();
        parts.push(("other files".to_owned(), &self.offline));
        let names = parts.iter().flat_map(|(name, part)| {
            std::iter::once(name.len()).chain(part.files.iter().map(|(file, _)| file.len() + 2))
        });
        let width = names.max().unwrap_or(0);
        writeln!(out, "{:width$} {:>10} {:>10} {:>10}  bytes", "file", "raw", "gzip", "brotli")?;
        for (name, part) in parts {
            let files = part.files.iter().map(|(file, sizes)| (format!("  {file}"), *sizes));
            for (name, Sizes { raw, gzip, brotli }) in std::iter::once((name, part.sum())).chain(files) {
                writeln!(out, "{name:width$} {raw:>10} {gzip:>10} {brotli:>10}")?;
            }
        }
        let Sizes { raw, gzip, brotli } = self.total();
        writeln!(out, "{:width$} {raw:>10} {gzip:>10} {brotli:>10}", "all")?;
        Ok(())
    }
}

pub(crate) fn weigh(dist: &Path, parts: &Parts) -> Result<Weights> {
    let mut all = BTreeMap::new();
    for entry in files::below(dist)? {
        // Hosts do not send the file of their own rules, and the page never loads the documentation.
        let is_separate =
            entry.file_name() == headers::FILE || entry.path().starts_with(dist.join(docs::FOLDER));
        if !is_separate {
            let bytes = files::read_bytes(entry.path())?;
            let path = entry.path().strip_prefix(dist).unwrap_or(entry.path());
            let names: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
            all.insert(names.join("/"), Sizes::of(&bytes)?);
        }
    }
    let weight = |files: &BTreeSet<String>| -> Result<Weight> {
        let sizes = |file: &String| all.get(file).copied().with_context(|| format!("{file} does not exist"));
        let files: Result<_> = files.iter().map(|file| Ok((file.clone(), sizes(file)?))).collect();
        Ok(Weight { files: files? })
    };
    let opening = weight(&parts.opening)?;
    let later: Result<Vec<_>> =
        parts.later.iter().map(|(name, files)| Ok((name.clone(), weight(files)?))).collect();
    for file in parts.later.values().chain([&parts.opening]).flatten() {
        all.remove(file);
    }
    Ok(Weights { opening, later: later?, offline: Weight { files: all.into_iter().collect() } })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bench must measure the same build as the page.
    #[test]
    fn wasm_opt_has_the_same_options_for_the_bench_and_the_page() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let [page, bench] = [CRATE, "tests/bench"].map(|folder| {
            let manifest = std::fs::read_to_string(root.join(folder).join("Cargo.toml")).unwrap();
            manifest.lines().find(|line| line.starts_with("wasm-opt = [")).map(str::to_owned)
        });
        assert!(page.is_some());
        assert_eq!(page, bench);
    }

    #[test]
    fn a_size_above_its_budget_is_an_error_with_both_numbers() {
        for (opening, later, expected) in [
            (700_000, 600_000, None),
            (700_001, 0, Some("the first load is 700001 bytes compressed; the maximum is 700000")),
            (700_000, 600_001, Some("the whole page is 1300001 bytes compressed; the maximum is 1300000")),
        ] {
            let file = |name: &str, brotli| Weight {
                files: vec![(name.to_owned(), Sizes { brotli, ..Sizes::default() })],
            };
            // A file of several parts counts once.
            let later = ["one.js", "two.js"].map(|name| (name.to_owned(), file("shared", later)));
            let weights = Weights {
                opening: file("opening", opening),
                later: later.into(),
                offline: Weight::default(),
            };
            let error = weights.within_budget().err().map(|error| error.to_string());
            assert_eq!(error.as_deref(), expected);
        }
    }

    #[test]
    fn sizes_are_summed_for_the_opening_each_later_part_and_offline_files() {
        let dist = std::env::temp_dir().join(format!("stepscope-weigh-{}", std::process::id()));
        std::fs::create_dir_all(dist.join("assets")).unwrap();
        std::fs::create_dir_all(dist.join("docs")).unwrap();
        for name in [
            "index.html",
            "assets/a.js",
            "assets/b.js",
            "assets/c.js",
            "_headers",
            "icon.png",
            "docs/index.html",
        ] {
            std::fs::write(dist.join(name), " ".repeat(1000)).unwrap();
        }
        let set = |files: &[&str]| files.iter().map(|file| (*file).to_owned()).collect::<BTreeSet<_>>();
        let later = [("one.js", &["assets/b.js"][..]), ("two.js", &["assets/b.js", "assets/c.js"])];
        let later = later.map(|(name, files)| (name.to_owned(), set(files)));
        let parts = Parts { opening: set(&["index.html", "assets/a.js"]), later: later.into() };
        let weights = weigh(&dist, &parts).unwrap();
        assert_eq!(weights.opening.sum().raw, 2000);
        assert!(weights.opening.sum().gzip < 150 && weights.opening.sum().brotli < 150);
        assert_eq!(weights.later.iter().map(|(_, part)| part.sum().raw).collect::<Vec<_>>(), [1000, 2000]);
        assert_eq!(weights.offline.files.iter().map(|(name, _)| name).collect::<Vec<_>>(), ["icon.png"]);
        assert!(weights.to_string().contains("later: two.js "), "{weights}");
        std::fs::remove_file(dist.join("assets/c.js")).unwrap();
        assert_eq!(weigh(&dist, &parts).err().unwrap().to_string(), "assets/c.js does not exist");
        std::fs::remove_dir_all(&dist).unwrap();
    }
}
