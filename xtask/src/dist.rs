//! `cargo xtask dist`: the page for any static host.
//!
//! | in `dist/` | contents |
//! | --- | --- |
//! | `index.html`, other pages, `manifest.webmanifest`, `sw.js` | under their own names, requested again at each visit |
//! | `assets/` | all other files, made by esbuild; a name contains the hash of the file and its imports, so it may be cached forever |
//! | `docs/` | the documentation, as a site of its own |
//! | `_headers` | `web/_headers` and the rules for caching |
//!
//! Only pages and the manifest name files that no script imports, so new names are written there alone. The result
//! depends only on the files and the commit.

mod esbuild;
mod licences;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use twox_hash::XxHash64;
use walkdir::WalkDir;

use crate::{docs, headers, root, run};
use esbuild::Bundles;

const ASSETS: &str = "assets";
const PAGE: &str = "index.html";
/// The service worker holds the list of files.
const SERVICE_WORKER: &str = "sw.js";
const LICENCES: &str = "licenses.html";
/// The placeholder in the sources that the build replaces.
const UNBUILT: &str = "development";
const UNLISTED: &str = "const build = { id: \"development\", files: [] };";

pub(crate) fn folder() -> PathBuf {
    root().join("dist")
}

#[derive(Debug, Default)]
pub(crate) struct Parts {
    pub(crate) opening: BTreeSet<String>,
    /// What loads later, by the page or the source that needs it.
    pub(crate) later: BTreeMap<String, BTreeSet<String>>,
}

pub(crate) async fn make(web: &Path, dist: &Path) -> Result<Parts> {
    let mut site = Site::read(web)?;
    site.texts.insert(LICENCES.to_owned(), licences::page().await?);
    let sources = site.sources();
    clear(dist)?;
    let bundles = Bundles::make(web, &sources, site.script()?, dist).await?;
    let commit = commit().await;
    for (name, text) in site.built(&bundles, env!("CARGO_PKG_VERSION"), commit.as_deref())? {
        let file = dist.join(name);
        std::fs::write(&file, text).with_context(|| format!("{} can't be written", file.display()))?;
    }
    docs::build(&dist.join(docs::FOLDER))?;
    Ok(site.parts(&bundles))
}

/// The commit's short name, with a `+` if files differ from it; `None` outside a clone.
async fn commit() -> Option<String> {
    let git = |arguments: &[&str]| {
        let mut command = tokio::process::Command::new("git");
        command.current_dir(root()).args(arguments);
        run::output(command)
    };
    let name = git(&["rev-parse", "--short=8", "HEAD"]).await?;
    let changes = git(&["status", "--porcelain", "--untracked-files=no"]).await?;
    Some(format!("{}{}", name.trim(), if changes.is_empty() { "" } else { "+" }))
}

struct Site {
    texts: BTreeMap<String, String>,
    headers: String,
}

fn names_others(file: &str) -> bool {
    file.ends_with(".html") || file.ends_with(".webmanifest")
}

/// Where a page or the manifest names a file that loads with it.
const AT_ONCE: [&str; 4] = ["href=\"", "src=\"", "data-worker=\"", "\"src\": \""];
/// Where a page names a file that its scripts request later; the files of one row load together.
const LATER: [&[&str]; 4] = [
    &["data-study-worker=\"", "data-tools-core=\"", "data-study-style=\""],
    &["data-capture-worker=\"", "data-tools-core=\""],
    &["data-panel-style=\""],
    &["data-live-worker=\"", "data-tools-core=\"", "data-live-style=\""],
];

fn named(text: &str) -> impl Iterator<Item = &str> {
    files_at(text, &AT_ONCE).chain(LATER.iter().flat_map(move |places| files_at(text, places)))
}

/// `./`, the page's own address, and the documentation are skipped.
fn files_at<'a>(text: &'a str, places: &'a [&str]) -> impl Iterator<Item = &'a str> {
    let values = places.iter().flat_map(|place| text.split(place).skip(1));
    let addresses = values.filter_map(|rest| rest.split('"').next()).filter(|address| !address.contains(':'));
    addresses
        .filter_map(|address| address.split(['#', '?']).next())
        .filter(|file| !["", "./", docs::LINK].contains(file))
}

impl Site {
    fn read(web: &Path) -> Result<Self> {
        let read = |name: &str| {
            let file = web.join(name);
            std::fs::read_to_string(&file).with_context(|| format!("{} can't be read", file.display()))
        };
        let mut texts = BTreeMap::new();
        for entry in WalkDir::new(web).max_depth(1) {
            let entry = entry.with_context(|| format!("{} can't be read", web.display()))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if entry.file_type().is_file() && (names_others(&name) || name == SERVICE_WORKER) {
                let text = read(&name)?;
                texts.insert(name, text);
            }
        }
        Ok(Self { texts, headers: read(headers::FILE)? })
    }

    fn naming(&self) -> impl Iterator<Item = (&str, &str)> {
        let texts = self.texts.iter().filter(|(name, _)| names_others(name));
        texts.map(|(name, text)| (name.as_str(), text.as_str()))
    }

    fn sources(&self) -> BTreeSet<&str> {
        self.naming().flat_map(|(_, text)| named(text)).filter(|file| !names_others(file)).collect()
    }

    fn script(&self) -> Result<&str> {
        let page = self.texts.get(PAGE).map_or("", String::as_str);
        files_at(page, &["src=\""]).next().with_context(|| format!("{PAGE} names no script"))
    }

    fn wanted<'a>(&self, name: &str, places: &[&str], bundles: &'a Bundles) -> BTreeSet<&'a str> {
        let text = self.texts.get(name).map_or("", String::as_str);
        files_at(text, places).filter_map(|source| bundles.of(source)).collect()
    }

    fn built(
        &self,
        bundles: &Bundles,
        version: &str,
        commit: Option<&str>,
    ) -> Result<BTreeMap<String, String>> {
        let mut built = self.texts.clone();
        for (name, text) in self.naming() {
            built.insert(name.to_owned(), self.renamed(name, text, bundles)?);
        }
        // Without a commit the hash of the files identifies the build.
        let own = format!("{:08x}", hash_of(&built) >> 32);
        let page = built.get_mut(PAGE).with_context(|| format!("there is no {PAGE}"))?;
        *page = unindented(&stamped(page, &format!("{version} ({})", commit.unwrap_or(&own)))?);
        let id = format!("{:016x}", hash_of(&built));
        let entries = built.keys().map(|name| if name == PAGE { "./" } else { name });
        let files: Vec<&str> =
            bundles.files().chain(entries.filter(|name| *name != SERVICE_WORKER)).collect();
        let list = format!("const build = {{ id: \"{id}\", files: {} }};", serde_json::to_string(&files)?);
        let headers = self.rules(built.keys().map(String::as_str));
        if let Some(worker) = built.get_mut(SERVICE_WORKER) {
            ensure!(worker.matches(UNLISTED).count() == 1, "{SERVICE_WORKER} must hold once: {UNLISTED}");
            *worker = without_comments(worker).replace(UNLISTED, &list);
        }
        built.insert(headers::FILE.to_owned(), headers);
        Ok(built)
    }

    /// Puts in the new names, and links by which the browser loads a page's modules in parallel.
    fn renamed(&self, name: &str, text: &str, bundles: &Bundles) -> Result<String> {
        let mut renamed = text.to_owned();
        for file in named(text).collect::<BTreeSet<_>>() {
            if names_others(file) {
                ensure!(self.texts.contains_key(file), "{name} names {file}, which is not there");
            } else {
                let made =
                    bundles.of(file).with_context(|| format!("{name} names {file}, which is not made"))?;
                renamed = renamed.replace(&format!("\"{file}\""), &format!("\"{made}\""));
            }
        }
        let modules: BTreeSet<&str> = files_at(text, &AT_ONCE)
            .filter(|file| file.ends_with(".js"))
            .filter_map(|source| bundles.of(source))
            .flat_map(|file| bundles.at_once(file))
            .filter(|file| !renamed.contains(file))
            .collect();
        let links: String =
            modules.iter().map(|file| format!("<link rel=\"modulepreload\" href=\"{file}\">\n")).collect();
        Ok(renamed.replacen("</head>", &format!("{links}</head>"), 1))
    }

    fn parts(&self, bundles: &Bundles) -> Parts {
        let with = |files: BTreeSet<&str>| -> BTreeSet<String> {
            files.into_iter().flat_map(|file| bundles.at_once(file)).map(str::to_owned).collect()
        };
        let mut opening = with(self.wanted(PAGE, &AT_ONCE, bundles));
        opening.extend([PAGE.to_owned(), SERVICE_WORKER.to_owned()]);
        let mut later = BTreeMap::new();
        let page = self.texts.get(PAGE).map_or("", String::as_str);
        for places in LATER {
            if let Some(first) = files_at(page, places).next() {
                later.insert(first.to_owned(), with(self.wanted(PAGE, places, bundles)));
            }
        }
        for page in self.texts.keys().filter(|name| name.ends_with(".html") && *name != PAGE) {
            let mut files = with(self.wanted(page, &AT_ONCE, bundles));
            files.insert(page.clone());
            later.insert(page.clone(), files);
        }
        let mut waiting = vec![opening.clone()];
        while let Some(asking) = waiting.pop() {
            for (source, file) in bundles.later(&asking.iter().map(String::as_str).collect()) {
                if !later.contains_key(source) {
                    let files = with(BTreeSet::from([file]));
                    waiting.push(files.clone());
                    later.insert(source.to_owned(), files);
                }
            }
        }
        for files in later.values_mut() {
            files.retain(|file| !opening.contains(file));
        }
        Parts { opening, later }
    }

    /// Replaces the rules for caching in `web/_headers`.
    fn rules<'a>(&self, entries: impl Iterator<Item = &'a str>) -> String {
        let kept = self.headers.lines().filter(|line| !line.trim_start().starts_with("Cache-Control:"));
        let mut rules: String = kept.map(|line| format!("{line}\n")).collect();
        rules.push_str(&format!("/{ASSETS}/*\n  Cache-Control: public, max-age=31536000, immutable\n"));
        // The last one is the documentation.
        for entry in entries.chain(["", "docs/*"]) {
            rules.push_str(&format!("/{entry}\n  Cache-Control: no-cache\n"));
        }
        rules
    }
}

fn stamped(page: &str, build: &str) -> Result<String> {
    let places = [format!("data-build=\"{UNBUILT}\""), format!("<span id=\"version\">{UNBUILT}</span>")];
    for place in &places {
        ensure!(page.matches(place.as_str()).count() == 1, "{PAGE} must hold once: {place}");
    }
    Ok(places.iter().fold(page.to_owned(), |page, place| page.replace(place, &place.replace(UNBUILT, build))))
}

fn without_comments(script: &str) -> String {
    let lines = script.lines().filter(|line| {
        let text = line.trim_start();
        !["//", "/*", "*"].iter().any(|mark| text.starts_with(mark))
    });
    lines.map(|line| format!("{line}\n")).collect()
}

fn unindented(page: &str) -> String {
    page.lines().map(|line| format!("{}\n", line.trim_start())).collect()
}

/// The texts name all other files, whose names contain their hashes; so this covers the whole build.
fn hash_of(texts: &BTreeMap<String, String>) -> u64 {
    let mut held = Vec::new();
    for (name, text) in texts {
        held.extend_from_slice(name.as_bytes());
        held.extend_from_slice(&XxHash64::oneshot(0, text.as_bytes()).to_le_bytes());
    }
    XxHash64::oneshot(0, &held)
}

fn clear(dist: &Path) -> Result<()> {
    if dist.exists() {
        ensure!(
            [dist.join(ASSETS), dist.join(docs::FOLDER).join("index.html")].iter().any(|it| it.exists())
                || dist.read_dir().is_ok_and(|mut it| it.next().is_none()),
            "{} is no earlier build; remove it or take another folder",
            dist.display()
        );
        std::fs::remove_dir_all(dist).with_context(|| format!("{} can't be removed", dist.display()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
