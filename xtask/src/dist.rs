//! `cargo xtask dist`: the page as any static host can serve it.
//!
//! | in `dist/` | what it is |
//! | --- | --- |
//! | `index.html`, other pages, `manifest.webmanifest`, `sw.js` | under their own names, asked for anew at each visit |
//! | `assets/` | all else that these name, directly or not; the hash in a name changes with what the file and all that it names hold, so hosts and browsers may keep it for ever |
//! | `_headers` | `web/_headers` and the rules for keeping |
//!
//! The modules that a page or a worker begins with are one script, minified, and so are those that come later, when
//! something asks for them; what wasm-bindgen wrote stays beside, because page and worker share it. The result depends on the files and the commit alone.

mod bundle;
mod licences;
mod references;
mod script;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use twox_hash::XxHash64;
use walkdir::WalkDir;

use crate::{root, run};
use bundle::{Module, Origin, Role, bundled};
use references::{Kind, Reference, references};

/// Where what has a hash in its name lies.
const ASSETS: &str = "assets";
/// The page.
const PAGE: &str = "index.html";
/// Scripts in this folder stay by themselves.
const SHARED: &str = "pkg/";
/// The service worker, which holds the list of files.
const SERVICE_WORKER: &str = "sw.js";
/// What stands in the sources where the build writes what it is.
const UNBUILT: &str = "development";
/// The service worker's line that the build fills.
const UNLISTED: &str = "const build = { id: \"development\", files: [] };";

/// Where the page as it is shipped lies.
pub(crate) fn folder() -> PathBuf {
    root().join("dist")
}

/// Builds the folder `dist` from the built page in `web`.
pub(crate) async fn make(web: &Path, dist: &Path) -> Result<()> {
    let mut site = Site::read(web)?;
    site.add("licenses.html", licences::page().await?.into_bytes())?;
    site.bundle()?;
    let commit = commit().await;
    write(dist, &site.built(env!("CARGO_PKG_VERSION"), commit.as_deref())?)
}

/// The files of `dist` that load when the page is opened, by their paths: not what is kept beside it for other
/// pages, for installing, and for when something asks for it.
pub(crate) fn loaded(dist: &Path) -> Result<BTreeSet<String>> {
    let mut loaded = BTreeSet::from([SERVICE_WORKER.to_owned()]);
    let mut waiting = vec![PAGE.to_owned()];
    while let Some(path) = waiting.pop() {
        if (is_entry(&path) && path != PAGE) || !loaded.insert(path.clone()) {
            continue;
        }
        if Kind::of(&path) != Kind::Other {
            let file = dist.join(&path);
            let text = std::fs::read_to_string(&file)
                .with_context(|| format!("{} can't be read", file.display()))?;
            let named = references(&path, &text)?.into_iter().filter(|reference| !reference.later);
            waiting.extend(named.map(|reference| reference.file));
        }
    }
    Ok(loaded)
}

/// The commit's short name, with a `+` where files differ from it; none outside of a clone.
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

/// One file of the sources, as it will be shipped but for the names in it.
struct File {
    bytes: Vec<u8>,
    references: Vec<Reference>,
}

/// All files that the page's own pages name, directly or not.
struct Site {
    /// By path in the sources.
    files: BTreeMap<String, File>,
    /// Rules of the host.
    headers: String,
    /// Pages that are named but made later.
    awaited: BTreeSet<String>,
}

/// Whether a file keeps its name.
fn is_entry(path: &str) -> bool {
    path == SERVICE_WORKER || matches!(Kind::of(path), Kind::Page | Kind::Manifest)
}

impl Site {
    /// Reads the pages of `web`, the service worker, and whatever they name.
    fn read(web: &Path) -> Result<Self> {
        let headers = web.join("_headers");
        let headers = std::fs::read_to_string(&headers)
            .with_context(|| format!("{} can't be read", headers.display()))?;
        let mut site = Self { files: BTreeMap::new(), headers, awaited: BTreeSet::new() };
        let mut waiting: Vec<String> = Vec::new();
        for entry in WalkDir::new(web).max_depth(1).sort_by_file_name() {
            let entry = entry.with_context(|| format!("{} can't be read", web.display()))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if entry.file_type().is_file() && is_entry(&name) {
                waiting.push(name);
            }
        }
        while let Some(path) = waiting.pop() {
            if site.files.contains_key(&path) {
                continue;
            }
            let file = web.join(&path);
            if Kind::of(&path) == Kind::Page && !file.exists() {
                site.awaited.insert(path);
                continue;
            }
            let bytes = std::fs::read(&file)
                .with_context(|| format!("{} is named in the page but can't be read", file.display()))?;
            site.add(&path, bytes)?;
            waiting.extend(site.files[&path].references.iter().map(|reference| reference.file.clone()));
        }
        Ok(site)
    }

    /// Takes a file in.
    fn add(&mut self, path: &str, mut bytes: Vec<u8>) -> Result<()> {
        let mut found = Vec::new();
        if Kind::of(path) != Kind::Other {
            let mut text = String::from_utf8(bytes).with_context(|| format!("{path} is no UTF-8"))?;
            if Kind::of(path) == Kind::Script && path != SERVICE_WORKER {
                text = script::minified(path, &text)?;
            }
            found = references(path, &text)?;
            bytes = text.into_bytes();
        }
        self.awaited.remove(path);
        self.files.insert(path.to_owned(), File { bytes, references: found });
        Ok(())
    }

    /// All files that `path` leads to, itself included; only those that load before it runs, if so asked.
    fn reached(&self, path: &str, at_once: bool) -> BTreeSet<&str> {
        let mut reached = BTreeSet::new();
        let mut waiting = vec![path];
        while let Some(path) = waiting.pop() {
            if let Some((path, file)) = self.files.get_key_value(path)
                && reached.insert(path.as_str())
            {
                let wanted = file.references.iter().filter(|reference| !at_once || reference.at_once);
                waiting.extend(wanted.map(|reference| reference.file.as_str()));
            }
        }
        reached
    }

    /// Makes one script of each that a page or a worker begins with, and one of each that comes later, and leaves out
    /// what nobody names any more.
    fn bundle(&mut self) -> Result<()> {
        let named = self.files.values().flat_map(|file| &file.references).filter(|named| !named.at_once);
        let scripts: BTreeMap<&str, bool> = named
            .map(|named| (named.file.as_str(), named.later))
            .filter(|(file, _)| {
                Kind::of(file) == Kind::Script && !is_entry(file) && !file.starts_with(SHARED)
            })
            // What imports nothing is one script as it is, and may export.
            .filter(|(file, _)| self.reached(file, true).len() > 1)
            .collect();
        let (later, first): (Vec<_>, Vec<_>) = scripts.into_iter().partition(|(_, later)| *later);
        let mut bundles = Vec::new();
        let mut bundled: BTreeSet<&str> = BTreeSet::new();
        for (script, _) in first {
            let order = self.order(script);
            let named = order.iter().flat_map(|path| &self.files[*path].references);
            let asked: BTreeSet<&str> = named.filter(|it| it.later).map(|it| it.file.as_str()).collect();
            let mut shared = BTreeSet::new();
            for (script, _) in later.iter().filter(|(script, _)| asked.contains(script)) {
                ensure!(bundled.insert(script), "{script} comes later in two bundles");
                let own: Vec<&str> =
                    self.order(script).into_iter().filter(|path| !order.contains(path)).collect();
                let imports = own.iter().flat_map(|path| &self.files[*path].references);
                let taken = imports.filter(|it| it.at_once).map(|it| it.file.as_str());
                shared.extend(taken.filter_map(|file| order.iter().position(|other| *other == file)));
                bundles.push(((*script).to_owned(), self.bundle_of(script, &own, &order, Role::Later)?));
            }
            let bundle = self.bundle_of(script, &order, &[], Role::First(&shared))?;
            bundles.push((script.to_owned(), bundle));
        }
        for (path, bundle) in bundles {
            self.add(&path, bundle.into_bytes())?;
        }
        let pages = self.files.keys().filter(|path| is_entry(path));
        let reached: BTreeSet<String> =
            pages.flat_map(|path| self.reached(path, false)).map(str::to_owned).collect();
        self.files.retain(|path, _| reached.contains(path));
        Ok(())
    }

    /// `script` and all modules that it imports, in the order in which they would be evaluated.
    fn order(&self, script: &str) -> Vec<&str> {
        let mut order = Vec::new();
        self.follow(script, &mut order, &mut BTreeSet::new());
        order
    }

    /// The modules of `order` as one, which stands in the place of `script`; those of `asking` are in the bundle that
    /// asks for it.
    fn bundle_of(&self, script: &str, order: &[&str], asking: &[&str], role: Role<'_>) -> Result<String> {
        // Names mean the same from the bundle's own place as they did from the module's.
        let from_bundle = |file: &str| match script.matches('/').count() {
            0 => format!("./{file}"),
            folders => format!("{}{file}", "../".repeat(folders)),
        };
        let mut texts = Vec::new();
        for path in order {
            let file = &self.files[*path];
            let moved = |named: &Reference| (!named.at_once).then(|| from_bundle(&named.file));
            texts.push(String::from_utf8(replaced(file, moved))?);
        }
        let beside: BTreeMap<&str, String> =
            self.files.keys().map(|path| (path.as_str(), from_bundle(path))).collect();
        let mut modules = Vec::new();
        for (path, text) in order.iter().zip(&texts) {
            let file = &self.files[*path];
            let mut imports = BTreeMap::new();
            for Reference { place, file: target, .. } in file.references.iter().filter(|it| it.at_once) {
                let specifier = std::str::from_utf8(&file.bytes[place.clone()])?;
                let number = |among: &[&str]| among.iter().position(|other| other == target);
                let origin = match (number(order), number(asking)) {
                    (Some(number), _) => Origin::Within(number),
                    (None, Some(number)) => Origin::Asking(number),
                    (None, None) => Origin::Beside(&beside[target.as_str()]),
                };
                imports.insert(specifier, origin);
            }
            modules.push(Module { name: path, text, imports });
        }
        bundled(&modules, role)
    }

    /// Adds `path` to `order` after all modules that it imports, in the order in which they would be evaluated.
    fn follow<'a>(&'a self, path: &str, order: &mut Vec<&'a str>, seen: &mut BTreeSet<&'a str>) {
        let Some((path, file)) = self.files.get_key_value(path) else { return };
        if !path.starts_with(SHARED) && seen.insert(path) {
            for named in file.references.iter().filter(|named| named.at_once) {
                self.follow(&named.file, order, seen);
            }
            order.push(path);
        }
    }

    /// The path under which a file is shipped; the hash is of all files that it leads to.
    fn name(&self, path: &str) -> String {
        if is_entry(path) {
            return path.to_owned();
        }
        let mut held = Vec::new();
        for reached in self.reached(path, false) {
            for part in [reached.as_bytes(), &self.files[reached].bytes] {
                held.extend_from_slice(&part.len().to_le_bytes());
                held.extend_from_slice(part);
            }
        }
        held.extend_from_slice(path.as_bytes());
        let file = path.rsplit('/').next().unwrap_or(path);
        let (stem, ending) = file.rsplit_once('.').unwrap_or((file, "bin"));
        format!("{ASSETS}/{stem}.{:010x}.{ending}", XxHash64::oneshot(0, &held) >> 24)
    }

    /// Every file of the result by its path.
    fn built(&self, version: &str, commit: Option<&str>) -> Result<BTreeMap<String, Vec<u8>>> {
        ensure!(self.awaited.is_empty(), "pages are named but not there: {:?}", self.awaited);
        let names: BTreeMap<&str, String> =
            self.files.keys().map(|path| (path.as_str(), self.name(path))).collect();
        let mut built = BTreeMap::new();
        for (path, file) in &self.files {
            built.insert(names[path.as_str()].clone(), renamed(path, file, &names));
        }
        let page = built.remove(PAGE).with_context(|| format!("there is no {PAGE}"))?;
        let page = String::from_utf8(page)?;
        let page = page.replacen("</head>", &format!("{}</head>", self.preloads(&page, &names)), 1);
        // Without a commit the files themselves say which build this is.
        let own = format!("{:08x}", hash_of(&built) >> 32);
        let page = stamped(&page, &format!("{version} ({})", commit.unwrap_or(&own)))?;
        built.insert(PAGE.to_owned(), page.into_bytes());
        let id = format!("{:016x}", hash_of(&built));
        if let Some(worker) = built.remove(SERVICE_WORKER) {
            let files: Vec<&str> = built.keys().map(|name| if name == PAGE { "./" } else { name }).collect();
            let list =
                format!("const build = {{ id: \"{id}\", files: {} }};", serde_json::to_string(&files)?);
            let worker = String::from_utf8(worker)?;
            ensure!(worker.matches(UNLISTED).count() == 1, "{SERVICE_WORKER} must hold once: {UNLISTED}");
            built.insert(SERVICE_WORKER.to_owned(), worker.replace(UNLISTED, &list).into_bytes());
        }
        let headers = self.rules(built.keys().filter(|name| is_entry(name)));
        built.insert("_headers".to_owned(), headers.into_bytes());
        judge(&built)?;
        Ok(built)
    }

    /// Links by which the page's modules and its wasm load side by side.
    fn preloads(&self, page: &str, names: &BTreeMap<&str, String>) -> String {
        let Ok(named) = references(PAGE, page) else { return String::new() };
        // The page's references have their new names already.
        let roots = names.iter().filter(|(_, new)| named.iter().any(|reference| reference.file == **new));
        let mut links = String::new();
        for (root, _) in roots.filter(|(path, _)| Kind::of(path) == Kind::Script) {
            for module in self.reached(root, true) {
                links.push_str(&format!("<link rel=\"modulepreload\" href=\"{}\">\n", names[module]));
            }
        }
        for (_, wasm) in names.iter().filter(|(path, _)| path.ends_with(".wasm")) {
            links.push_str(&format!(
                "<link rel=\"preload\" as=\"fetch\" type=\"application/wasm\" crossorigin href=\"{wasm}\">\n"
            ));
        }
        links
    }

    /// `web/_headers` without its rules for keeping, and rules for keeping of each file.
    fn rules<'a>(&self, entries: impl Iterator<Item = &'a String>) -> String {
        let kept = self.headers.lines().filter(|line| !line.trim_start().starts_with("Cache-Control:"));
        let mut rules: String = kept.map(|line| format!("{line}\n")).collect();
        rules.push_str(&format!("/{ASSETS}/*\n  Cache-Control: public, max-age=31536000, immutable\n"));
        for entry in std::iter::once("").chain(entries.map(String::as_str)) {
            rules.push_str(&format!("/{entry}\n  Cache-Control: no-cache\n"));
        }
        rules
    }
}

/// A file's bytes with the new names of what it names.
fn renamed(path: &str, file: &File, names: &BTreeMap<&str, String>) -> Vec<u8> {
    let in_assets = !is_entry(path);
    replaced(file, |Reference { file: target, .. }| {
        let name = names.get(target.as_str())?;
        Some(match (in_assets, name.strip_prefix("assets/")) {
            (true, Some(beside)) => format!("./{beside}"),
            (true, None) => format!("../{name}"),
            (false, _) => name.to_owned(),
        })
    })
}

/// A file's bytes with other names in the places where it names files, where there is another.
fn replaced(file: &File, other: impl Fn(&Reference) -> Option<String>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut done = 0;
    for reference in &file.references {
        if let Some(name) = other(reference) {
            bytes.extend_from_slice(&file.bytes[done..reference.place.start]);
            bytes.extend_from_slice(name.as_bytes());
            done = reference.place.end;
        }
    }
    bytes.extend_from_slice(&file.bytes[done..]);
    bytes
}

/// The page with what it is written where its source says that it is under development.
fn stamped(page: &str, build: &str) -> Result<String> {
    let places = [format!("data-build=\"{UNBUILT}\""), format!("<span id=\"version\">{UNBUILT}</span>")];
    for place in &places {
        ensure!(page.matches(place.as_str()).count() == 1, "{PAGE} must hold once: {place}");
    }
    Ok(places.iter().fold(page.to_owned(), |page, place| page.replace(place, &place.replace(UNBUILT, build))))
}

fn hash_of(files: &BTreeMap<String, Vec<u8>>) -> u64 {
    let mut held = Vec::new();
    for (name, bytes) in files {
        held.extend_from_slice(name.as_bytes());
        held.extend_from_slice(&XxHash64::oneshot(0, bytes).to_le_bytes());
    }
    XxHash64::oneshot(0, &held)
}

/// An error unless every name in the result leads to a file of it, under a name that changes with it.
fn judge(built: &BTreeMap<String, Vec<u8>>) -> Result<()> {
    for (path, bytes) in built.iter().filter(|(path, _)| Kind::of(path) != Kind::Other) {
        for Reference { file, .. } in references(path, std::str::from_utf8(bytes)?)? {
            ensure!(built.contains_key(&file), "{path} names {file}, which is not there");
            ensure!(
                is_entry(&file) || file.starts_with("assets/"),
                "{path} names {file}, which has no hash in its name"
            );
        }
    }
    Ok(())
}

/// Writes the files into `dist`, in the place of whatever an earlier build left there.
fn write(dist: &Path, built: &BTreeMap<String, Vec<u8>>) -> Result<()> {
    if dist.exists() {
        ensure!(
            dist.join(PAGE).exists() || dist.read_dir().is_ok_and(|mut it| it.next().is_none()),
            "{} is no earlier build; remove it or take another folder",
            dist.display()
        );
        std::fs::remove_dir_all(dist).with_context(|| format!("{} can't be removed", dist.display()))?;
    }
    for (name, bytes) in built {
        let file = dist.join(name);
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder).with_context(|| format!("{} can't be made", folder.display()))?;
        }
        std::fs::write(&file, bytes).with_context(|| format!("{} can't be written", file.display()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
