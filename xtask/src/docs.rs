//! `cargo xtask docs`: the pages that docs/SUMMARY.md lists, as a site without scripts in `dist/docs`.
//!
//! mdBook cannot be used: its pages need inline scripts, which the page's security headers forbid.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd, html};

use crate::{files, root};

pub(crate) const FOLDER: &str = "docs";
pub(crate) const LINK: &str = "docs/";
const SUMMARY: &str = "docs/SUMMARY.md";
const STYLE: &str = include_str!("docs/site.css");
const TEMPLATE: &str = include_str!("docs/site.html");

/// Writes the site; an error if the target of a link does not exist, or a page of `docs/` is not listed.
pub(crate) fn build(site: &Path) -> Result<()> {
    let book = Book::read(root())?;
    files::remove_folder(site)?;
    for (name, bytes) in book.files()? {
        let file = site.join(name);
        files::create_folder(file.parent().unwrap_or(site))?;
        files::write(&file, bytes)?;
    }
    Ok(())
}

#[derive(Debug)]
struct Chapter {
    /// Heading above it in the summary.
    part: String,
    title: String,
    /// From the workspace's root.
    source: PathBuf,
    output: String,
    text: String,
}

struct Book {
    root: PathBuf,
    chapters: Vec<Chapter>,
}

struct Page {
    body: String,
    ids: BTreeSet<String>,
    /// Links to pages: output and id.
    links: Vec<(String, String)>,
    /// Other files of `docs/` that it references.
    files: BTreeSet<PathBuf>,
}

enum Target {
    External,
    Page(String),
    /// A file of `docs/`, copied.
    Copy(PathBuf),
    /// A file of the repository that the site does not contain.
    Source,
}

impl Book {
    fn read(root: &Path) -> Result<Self> {
        let summary = read(root, Path::new(SUMMARY))?;
        let mut chapters: Vec<Chapter> = Vec::new();
        let (mut part, mut text, mut address) = (String::new(), String::new(), None);
        for event in Parser::new(&summary) {
            match event {
                Event::Start(Tag::Heading { .. } | Tag::Link { .. }) => {
                    text.clear();
                    if let Event::Start(Tag::Link { dest_url, .. }) = event {
                        address = Some(dest_url.into_string());
                    }
                }
                Event::Text(more) => text.push_str(&more),
                Event::End(TagEnd::Heading(_)) => {
                    part = if chapters.is_empty() { String::new() } else { std::mem::take(&mut text) };
                }
                Event::End(TagEnd::Link) => {
                    let source = joined(Path::new(SUMMARY), &address.take().unwrap_or_default())?;
                    chapters.push(Chapter {
                        part: part.clone(),
                        title: std::mem::take(&mut text),
                        text: read(root, &source)?,
                        output: output_of(&source),
                        source,
                    });
                }
                _ => {}
            }
        }
        Ok(Self { root: root.to_owned(), chapters })
    }

    fn files(&self) -> Result<BTreeMap<String, Vec<u8>>> {
        self.check_all_listed()?;
        let pages: Result<Vec<Page>> = self.chapters.iter().map(|chapter| self.page(chapter)).collect();
        let pages = pages?;
        let ids: BTreeMap<&str, &BTreeSet<String>> = self
            .chapters
            .iter()
            .zip(&pages)
            .map(|(chapter, page)| (chapter.output.as_str(), &page.ids))
            .collect();
        let mut files = BTreeMap::from([("site.css".to_owned(), STYLE.as_bytes().to_vec())]);
        for (index, (chapter, page)) in self.chapters.iter().zip(&pages).enumerate() {
            for (output, id) in page.links.iter().filter(|(_, id)| !id.is_empty()) {
                ensure!(
                    ids.get(output.as_str()).is_some_and(|ids| ids.contains(id)),
                    "{} links to #{id}, which {output} does not have",
                    chapter.source.display()
                );
            }
            for file in &page.files {
                let name = file.strip_prefix("docs").unwrap_or(file).to_string_lossy().into_owned();
                let path = self.root.join(file);
                files.insert(name, files::read_bytes(&path)?);
            }
            files.insert(chapter.output.clone(), self.html(index, page).into_bytes());
        }
        Ok(files)
    }

    /// An error if a page of `docs/` is missing in the summary.
    fn check_all_listed(&self) -> Result<()> {
        for entry in files::below(&self.root.join("docs"))? {
            let file = entry.path().strip_prefix(&self.root).unwrap_or(entry.path());
            let is_listed =
                || file == Path::new(SUMMARY) || self.chapters.iter().any(|chapter| chapter.source == file);
            let is_page = file.extension().is_some_and(|extension| extension == "md");
            ensure!(!is_page || is_listed(), "{SUMMARY} does not list {}", file.display());
        }
        Ok(())
    }

    fn target(&self, chapter: &Chapter, address: &str) -> Result<Target> {
        if address.contains(':') {
            return Ok(Target::External);
        }
        if address.is_empty() {
            return Ok(Target::Page(chapter.output.clone()));
        }
        let file = joined(&chapter.source, address)?;
        ensure!(
            self.root.join(&file).exists(),
            "{} links to {address}, which does not exist",
            chapter.source.display()
        );
        Ok(match self.chapters.iter().find(|other| other.source == file) {
            Some(other) => Target::Page(other.output.clone()),
            None if file.starts_with("docs") && self.root.join(&file).is_file() => Target::Copy(file),
            None => Target::Source,
        })
    }

    fn page(&self, chapter: &Chapter) -> Result<Page> {
        let events: Vec<Event> = Parser::new_ext(&chapter.text, Options::ENABLE_TABLES).collect();
        let mut page =
            Page { body: String::new(), ids: BTreeSet::new(), links: Vec::new(), files: BTreeSet::new() };
        let mut written = Vec::with_capacity(events.len());
        // For each open link, whether its tags are omitted.
        let mut omitted = Vec::new();
        for (index, event) in events.iter().enumerate() {
            match event {
                Event::Start(Tag::Heading { level, .. }) => {
                    let id = new_id(&heading_text(events.get(index + 1..).unwrap_or_default()), &page.ids);
                    page.ids.insert(id.clone());
                    let (id, classes, attrs) = (Some(CowStr::from(id)), Vec::new(), Vec::new());
                    written.push(Event::Start(Tag::Heading { level: *level, id, classes, attrs }));
                }
                Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
                    let (file, fragment) = dest_url.split_once('#').unwrap_or((dest_url.as_ref(), ""));
                    let address = match self.target(chapter, file)? {
                        Target::External => Some(dest_url.to_string()),
                        Target::Page(output) => {
                            page.links.push((output.clone(), fragment.to_owned()));
                            let mark =
                                if fragment.is_empty() { String::new() } else { format!("#{fragment}") };
                            Some(up(&chapter.output) + &output + &mark)
                        }
                        Target::Copy(file) => {
                            let name =
                                file.strip_prefix("docs").unwrap_or(&file).to_string_lossy().into_owned();
                            page.files.insert(file);
                            Some(up(&chapter.output) + &name)
                        }
                        Target::Source => None,
                    };
                    omitted.push(address.is_none());
                    if let Some(address) = address {
                        let (link_type, title, id) = (*link_type, title.clone(), id.clone());
                        written.push(Event::Start(Tag::Link {
                            link_type,
                            dest_url: address.into(),
                            title,
                            id,
                        }));
                    }
                }
                Event::End(TagEnd::Link) => {
                    if !omitted.pop().unwrap_or(false) {
                        written.push(event.clone());
                    }
                }
                Event::Start(Tag::Image { dest_url, .. }) => {
                    let Target::Copy(file) = self.target(chapter, dest_url)? else {
                        bail!("{}: the picture {dest_url} must be in docs/", chapter.source.display());
                    };
                    page.files.insert(file);
                    written.push(event.clone());
                }
                _ => written.push(event.clone()),
            }
        }
        html::push_html(&mut page.body, written.into_iter());
        Ok(page)
    }

    /// The whole page with contents and neighbors.
    fn html(&self, index: usize, page: &Page) -> String {
        let Some(chapter) = self.chapters.get(index) else { return String::new() };
        let to_root = up(&chapter.output);
        let link =
            |other: &Chapter| format!("<a href=\"{to_root}{}\">{}</a>", other.output, escaped(&other.title));
        let mut contents = String::new();
        let mut part = None;
        for other in &self.chapters {
            if part != Some(&other.part) {
                contents.push_str(if part.is_some() { "</ul>\n" } else { "" });
                if !other.part.is_empty() {
                    contents.push_str(&format!("<h2>{}</h2>\n", escaped(&other.part)));
                }
                contents.push_str("<ul>\n");
                part = Some(&other.part);
            }
            let current = if other.output == chapter.output { " aria-current=\"page\"" } else { "" };
            contents
                .push_str(&format!("<li>{}</li>\n", link(other).replacen("<a", &format!("<a{current}"), 1)));
        }
        contents.push_str("</ul>\n");
        let neighbor = |at: Option<usize>, label: &str| {
            let other = at.and_then(|at| self.chapters.get(at));
            other.map_or(String::new(), |other| format!("<span>{label} {}</span>", link(other)))
        };
        let previous = neighbor(index.checked_sub(1), "Previous:");
        let next = neighbor(Some(index + 1), "Next:");
        // The body last, because it may contain the marks of the others.
        [
            ("TITLE", escaped(&chapter.title)),
            ("ROOT", to_root),
            ("CONTENTS", contents),
            ("NEIGHBORS", previous + &next),
        ]
        .iter()
        .fold(TEMPLATE.to_owned(), |html, (mark, text)| html.replace(&format!("{{{mark}}}"), text))
        .replace("{BODY}", &page.body)
    }
}

fn read(root: &Path, file: &Path) -> Result<String> {
    std::fs::read_to_string(root.join(file)).with_context(|| format!("{} can't be read", file.display()))
}

/// The file at an address in `page`, from the workspace's root.
fn joined(page: &Path, address: &str) -> Result<PathBuf> {
    let mut file = page.parent().unwrap_or(Path::new("")).to_owned();
    for part in Path::new(address).components() {
        match part {
            Component::ParentDir => {
                ensure!(file.pop(), "{address} in {} leaves the repository", page.display())
            }
            Component::CurDir => {}
            Component::Normal(name) => file.push(name),
            _ => bail!("{address} in {} must be relative", page.display()),
        }
    }
    Ok(file)
}

fn output_of(source: &Path) -> String {
    let file = source.strip_prefix("docs").unwrap_or(source);
    let file = if file.ends_with("README.md") {
        file.with_file_name("index.html")
    } else {
        file.with_extension("html")
    };
    file.to_string_lossy().replace('\\', "/")
}

fn up(output: &str) -> String {
    "../".repeat(output.matches('/').count())
}

fn heading_text(events: &[Event]) -> String {
    let inside = events.iter().take_while(|event| !matches!(event, Event::End(TagEnd::Heading(_))));
    inside
        .filter_map(|event| match event {
            Event::Text(text) | Event::Code(text) => Some(text.as_ref()),
            _ => None,
        })
        .collect()
}

/// As GitHub forms them, so that links work in both places.
fn new_id(heading: &str, used: &BTreeSet<String>) -> String {
    let allowed = heading.chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
    let id: String = allowed.map(|c| if c == ' ' { '-' } else { c }).flat_map(char::to_lowercase).collect();
    let others = (1..).map(|number| format!("{id}-{number}"));
    std::iter::once(id.clone()).chain(others).find(|id| !used.contains(id)).unwrap_or(id)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests;
