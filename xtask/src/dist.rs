//! `cargo xtask dist`: the page for any static host.
//!
//! | in `dist/` | contents |
//! | --- | --- |
//! | `index.html`, other pages, `manifest.webmanifest`, `sw.js` | under their own names, requested again at each visit |
//! | `assets/` | all other files, made by esbuild; a name contains the hash of the file and its imports, so it may be cached forever |
//! | `docs/` | the documentation, as a site of its own |
//! | `_headers` | `web/_headers` and the rules for caching |
//!
//! Only pages and the manifest reference files that no script imports, so the new names are written only there. The result
//! depends only on the files and the commit.

mod esbuild;
pub(crate) mod licenses;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use twox_hash::XxHash64;
use walkdir::WalkDir;

use crate::{docs, files, headers, root, run};
use esbuild::Bundles;

const ASSETS: &str = "assets";
const PAGE: &str = "index.html";
/// Contains the list of files.
const SERVICE_WORKER: &str = "sw.js";
const LICENSES: &str = "licenses.html";
/// Placeholders in the sources that the build replaces: its name, and the list in the service worker.
const BUILD_PLACEHOLDER: &str = "development";
const LIST_PLACEHOLDER: &str = "const build = { id: \"development\", files: [] };";

pub(crate) fn folder() -> PathBuf {
    root().join("dist")
}

#[derive(Debug, Default)]
pub(crate) struct Parts {
    /// Files that load when the page opens.
    pub(crate) opening: BTreeSet<String>,
    /// Files that load later, by the page or source that needs them.
    pub(crate) later: BTreeMap<String, BTreeSet<String>>,
}

/// Builds the page of the folder `web` into the folder `dist`.
pub(crate) async fn make(web: &Path, dist: &Path) -> Result<Parts> {
    let mut site = Site::read(web)?;
    site.texts.insert(LICENSES.to_owned(), licenses::page().await?);
    let sources = site.sources();
    clear(dist)?;
    let bundles = Bundles::make(web, &sources, site.script()?, dist).await?;
    let commit = commit().await;
    for (name, text) in site.texts_of_build(&bundles, env!("CARGO_PKG_VERSION"), commit.as_deref())? {
        let file = dist.join(name);
        files::write(&file, text)?;
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

fn is_page(file: &str) -> bool {
    file.ends_with(".html") || file.ends_with(".webmanifest")
}

/// Attributes with files that load with the page or the manifest.
const IMMEDIATE: [&str; 4] = ["href=\"", "src=\"", "data-worker=\"", "\"src\": \""];
/// Attributes with files that scripts of the page request later; the files of one row load together.
const LATER: [&[&str]; 4] = [
    &["data-study-worker=\"", "data-study-style=\""],
    &["data-capture-worker=\"", "data-recordings-core=\""],
    &["data-panel-style=\""],
    &["data-live-worker=\"", "data-live-style=\""],
];

fn references(text: &str) -> impl Iterator<Item = &str> {
    references_in(text, &IMMEDIATE).chain(LATER.iter().flat_map(move |row| references_in(text, row)))
}

/// The files in these attributes, except `./`, the page itself, and the documentation.
fn references_in<'a>(text: &'a str, attributes: &'a [&str]) -> impl Iterator<Item = &'a str> {
    let values = attributes.iter().flat_map(|attribute| text.split(attribute).skip(1));
    let addresses = values.filter_map(|rest| rest.split('"').next()).filter(|address| !address.contains(':'));
    addresses
        .filter_map(|address| address.split(['#', '?']).next())
        .filter(|file| !["", "./", docs::LINK].contains(file))
}

impl Site {
    fn read(web: &Path) -> Result<Self> {
        let read = |name: &str| {
            let file = web.join(name);
            files::read(&file)
        };
        let mut texts = BTreeMap::new();
        for entry in WalkDir::new(web).max_depth(1) {
            let entry = entry.with_context(|| format!("{} can't be read", web.display()))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if entry.file_type().is_file() && (is_page(&name) || name == SERVICE_WORKER) {
                let text = read(&name)?;
                texts.insert(name, text);
            }
        }
        Ok(Self { texts, headers: read(headers::FILE)? })
    }

    fn pages(&self) -> impl Iterator<Item = (&str, &str)> {
        let texts = self.texts.iter().filter(|(name, _)| is_page(name));
        texts.map(|(name, text)| (name.as_str(), text.as_str()))
    }

    fn sources(&self) -> BTreeSet<&str> {
        self.pages().flat_map(|(_, text)| references(text)).filter(|file| !is_page(file)).collect()
    }

    fn script(&self) -> Result<&str> {
        let page = self.texts.get(PAGE).map_or("", String::as_str);
        references_in(page, &["src=\""]).next().with_context(|| format!("{PAGE} references no script"))
    }

    /// The built files for these attributes of a page.
    fn bundles_in<'a>(&self, name: &str, attributes: &[&str], bundles: &'a Bundles) -> BTreeSet<&'a str> {
        let text = self.texts.get(name).map_or("", String::as_str);
        references_in(text, attributes).filter_map(|source| bundles.file_of(source)).collect()
    }

    fn texts_of_build(
        &self,
        bundles: &Bundles,
        version: &str,
        commit: Option<&str>,
    ) -> Result<BTreeMap<String, String>> {
        let mut built = self.texts.clone();
        for (name, text) in self.pages() {
            built.insert(name.to_owned(), self.with_new_names(name, text, bundles)?);
        }
        // Without a commit the hash of the files identifies the build.
        let short_hash = format!("{:08x}", content_hash(&built) >> 32);
        let page = built.get_mut(PAGE).with_context(|| format!("there is no {PAGE}"))?;
        *page = without_indentation(&with_build_name(
            page,
            &format!("{version} ({})", commit.unwrap_or(&short_hash)),
        )?);
        let build_id = format!("{:016x}", content_hash(&built));
        let entries = built.keys().map(|name| if name == PAGE { "./" } else { name });
        let files: Vec<&str> =
            bundles.files().chain(entries.filter(|name| *name != SERVICE_WORKER)).collect();
        let list =
            format!("const build = {{ id: \"{build_id}\", files: {} }};", serde_json::to_string(&files)?);
        let headers = self.headers_of_build(built.keys().map(String::as_str));
        if let Some(worker) = built.get_mut(SERVICE_WORKER) {
            ensure!(
                worker.matches(LIST_PLACEHOLDER).count() == 1,
                "{SERVICE_WORKER} must contain once: {LIST_PLACEHOLDER}"
            );
            *worker = without_comments(worker).replace(LIST_PLACEHOLDER, &list);
        }
        built.insert(headers::FILE.to_owned(), headers);
        Ok(built)
    }

    /// A page with the new names of files, and with links that load its modules in parallel.
    fn with_new_names(&self, name: &str, text: &str, bundles: &Bundles) -> Result<String> {
        let mut renamed = text.to_owned();
        for file in references(text).collect::<BTreeSet<_>>() {
            if is_page(file) {
                ensure!(self.texts.contains_key(file), "{name} references {file}, which does not exist");
            } else {
                let made = bundles
                    .file_of(file)
                    .with_context(|| format!("{name} references {file}, which is not built"))?;
                renamed = renamed.replace(&format!("\"{file}\""), &format!("\"{made}\""));
            }
        }
        let modules: BTreeSet<&str> = references_in(text, &IMMEDIATE)
            .filter(|file| file.ends_with(".js"))
            .filter_map(|source| bundles.file_of(source))
            .flat_map(|file| bundles.with_imports(file))
            .filter(|file| !renamed.contains(file))
            .collect();
        let links: String =
            modules.iter().map(|file| format!("<link rel=\"modulepreload\" href=\"{file}\">\n")).collect();
        Ok(renamed.replacen("</head>", &format!("{links}</head>"), 1))
    }

    fn parts(&self, bundles: &Bundles) -> Parts {
        let with_imports = |files: BTreeSet<&str>| -> BTreeSet<String> {
            files.into_iter().flat_map(|file| bundles.with_imports(file)).map(str::to_owned).collect()
        };
        let mut opening = with_imports(self.bundles_in(PAGE, &IMMEDIATE, bundles));
        opening.extend([PAGE.to_owned(), SERVICE_WORKER.to_owned()]);
        let mut later = BTreeMap::new();
        let page = self.texts.get(PAGE).map_or("", String::as_str);
        for row in LATER {
            if let Some(first) = references_in(page, row).next() {
                later.insert(first.to_owned(), with_imports(self.bundles_in(PAGE, row, bundles)));
            }
        }
        for page in self.texts.keys().filter(|name| name.ends_with(".html") && *name != PAGE) {
            let mut files = with_imports(self.bundles_in(page, &IMMEDIATE, bundles));
            files.insert(page.clone());
            later.insert(page.clone(), files);
        }
        let mut queue = vec![opening.clone()];
        while let Some(importing) = queue.pop() {
            for (source, file) in bundles.dynamic_imports(&importing.iter().map(String::as_str).collect()) {
                if !later.contains_key(source) {
                    let files = with_imports(BTreeSet::from([file]));
                    queue.push(files.clone());
                    later.insert(source.to_owned(), files);
                }
            }
        }
        for files in later.values_mut() {
            files.retain(|file| !opening.contains(file));
        }
        Parts { opening, later }
    }

    /// `web/_headers` with the rules for caching of the build.
    fn headers_of_build<'a>(&self, entries: impl Iterator<Item = &'a str>) -> String {
        let others = self.headers.lines().filter(|line| !line.trim_start().starts_with("Cache-Control:"));
        let mut rules: String = others.map(|line| format!("{line}\n")).collect();
        rules.push_str(&format!("/{ASSETS}/*\n  Cache-Control: public, max-age=31536000, immutable\n"));
        // The last one is the documentation.
        for entry in entries.chain(["", "docs/*"]) {
            rules.push_str(&format!("/{entry}\n  Cache-Control: no-cache\n"));
        }
        rules
    }
}

fn with_build_name(page: &str, build: &str) -> Result<String> {
    let places = [
        format!("data-build=\"{BUILD_PLACEHOLDER}\""),
        format!("<span id=\"version\">{BUILD_PLACEHOLDER}</span>"),
    ];
    for place in &places {
        ensure!(page.matches(place.as_str()).count() == 1, "{PAGE} must contain once: {place}");
    }
    Ok(places
        .iter()
        .fold(page.to_owned(), |page, place| page.replace(place, &place.replace(BUILD_PLACEHOLDER, build))))
}

fn without_comments(script: &str) -> String {
    let lines = script.lines().filter(|line| {
        let text = line.trim_start();
        !["//", "/*", "*"].iter().any(|mark| text.starts_with(mark))
    });
    lines.map(|line| format!("{line}\n")).collect()
}

fn without_indentation(page: &str) -> String {
    page.lines().map(|line| format!("{}\n", line.trim_start())).collect()
}

/// Covers the whole build: the texts contain the names of all other files, which contain their hashes.
fn content_hash(texts: &BTreeMap<String, String>) -> u64 {
    let mut bytes = Vec::new();
    for (name, text) in texts {
        bytes.extend_from_slice(name.as_bytes());
        bytes.extend_from_slice(&XxHash64::oneshot(0, text.as_bytes()).to_le_bytes());
    }
    XxHash64::oneshot(0, &bytes)
}

/// Removes an earlier build, but no other folder.
fn clear(dist: &Path) -> Result<()> {
    if dist.exists() {
        ensure!(
            [dist.join(ASSETS), dist.join(docs::FOLDER).join("index.html")].iter().any(|part| part.exists())
                || dist.read_dir().is_ok_and(|mut entries| entries.next().is_none()),
            "{} is not an earlier build; remove it, or use another folder",
            dist.display()
        );
        files::remove_folder(dist)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
