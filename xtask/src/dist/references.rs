//! Where one file of the page names another: the places that are rewritten when names change.

use std::ops::Range;
use std::sync::LazyLock;

use anyhow::{Result, bail};
use regex::Regex;

/// The kinds of text that name other files.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Kind {
    Page,
    Script,
    Style,
    Manifest,
    /// Names no other file.
    Other,
}

impl Kind {
    /// By the ending of the file's name.
    pub(super) fn of(path: &str) -> Self {
        match path.rsplit_once('.').map(|(_, ending)| ending) {
            Some("html") => Self::Page,
            Some("js") => Self::Script,
            Some("css") => Self::Style,
            Some("webmanifest") => Self::Manifest,
            _ => Self::Other,
        }
    }
}

/// One place in a text where another file is named.
#[derive(Debug, PartialEq)]
pub(super) struct Reference {
    /// Bytes of the name in the text.
    pub(super) place: Range<usize>,
    /// The file from the folder of the page on, such as `state/state.js`.
    pub(super) file: String,
    /// A module that is loaded before the naming one runs.
    pub(super) at_once: bool,
    /// A module that loads only when something asks for it.
    pub(super) later: bool,
}

fn pattern(kind: Kind) -> Option<&'static Regex> {
    // Constant patterns: the tests of this file compile them all.
    fn compiled(text: &str) -> Option<Regex> {
        Regex::new(text).ok()
    }
    // An attribute that is an address of this site: no scheme, and more than a place in the page.
    static PAGE: LazyLock<Option<Regex>> =
        LazyLock::new(|| compiled(r##"\s(?:href|src)="(?<name>[^":#?]+)["#?]"##));
    // Minified scripts: imports, and new URL(…, import.meta.url).
    static SCRIPT: LazyLock<Option<Regex>> = LazyLock::new(|| {
        compiled(
            r#"(?<static>\bfrom|\bimport)["'`](?<name>\.{1,2}/[^"'`]+)["'`]|\bimport\(["'`](?<later>[^"'`]+)["'`]\)|new URL\(["'`](?<url>[^"'`]+)["'`],import\.meta\.url\)"#,
        )
    });
    static STYLE: LazyLock<Option<Regex>> =
        LazyLock::new(|| compiled(r#"url\(["']?(?<name>[^"'):#]+)["')#]"#));
    static MANIFEST: LazyLock<Option<Regex>> =
        LazyLock::new(|| compiled(r##""(?:src|url|start_url|scope|id)":\s*"(?<name>[^":#?]+)["#?]"##));
    match kind {
        Kind::Page => PAGE.as_ref(),
        Kind::Script => SCRIPT.as_ref(),
        Kind::Style => STYLE.as_ref(),
        Kind::Manifest => MANIFEST.as_ref(),
        Kind::Other => None,
    }
}

/// Every place in `text`, the file at `path`, where another file of the page is named, in their order.
/// The page itself, `./`, is none.
///
/// # Errors
/// If a name leads out of the page's folder, a style sheet imports another, or a module comes later without a name.
pub(super) fn references(path: &str, text: &str) -> Result<Vec<Reference>> {
    let kind = Kind::of(path);
    if kind == Kind::Style && text.contains("@import") {
        bail!(
            "{path} has an @import; link the style sheet in the page, so that it does not wait for this one"
        );
    }
    let mut found = Vec::new();
    for captures in pattern(kind).into_iter().flat_map(|pattern| pattern.captures_iter(text)) {
        let named = ["name", "later", "url"].iter().find_map(|group| captures.name(group));
        let Some(name) = named.filter(|name| name.as_str() != "./") else { continue };
        let file = resolve(path, name.as_str())?;
        let [at_once, later] = ["static", "later"].map(|group| captures.name(group).is_some());
        found.push(Reference { place: name.range(), file, at_once, later });
    }
    if kind == Kind::Script && text.matches("import(").count() > found.iter().filter(|it| it.later).count() {
        bail!("{path} imports a module by import(…) without naming it there");
    }
    Ok(found)
}

/// `name` as the file at `path` means it, from the page's folder on.
fn resolve(path: &str, name: &str) -> Result<String> {
    let mut folders: Vec<&str> = path.split('/').collect();
    folders.pop();
    for part in name.split('/') {
        match part {
            "." | "" => {}
            ".." => {
                if folders.pop().is_none() {
                    bail!("{path} names {name}, which lies outside of the page's folder");
                }
            }
            part => folders.push(part),
        }
    }
    Ok(folders.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(path: &str, text: &str, expected: &[(&str, &str, bool)]) {
        let found = references(path, text).unwrap();
        let found: Vec<_> =
            found.iter().map(|it| (&text[it.place.clone()], it.file.as_str(), it.at_once)).collect();
        assert_eq!(found, expected, "{path}: {text}");
    }

    #[test]
    fn every_way_of_naming_a_file_is_seen() {
        check(
            "views/a.js",
            "import\"../dom.js\";import{a as b}from'./b/c.js';export*from`./d.js`;\
             new Worker(new URL(\"../engine/w.js\",import.meta.url));new URL(`x.wasm`,import.meta.url);import(\"./e.js\");f(\"./g.js\")",
            &[
                ("../dom.js", "dom.js", true),
                ("./b/c.js", "views/b/c.js", true),
                ("./d.js", "views/d.js", true),
                ("../engine/w.js", "engine/w.js", false),
                ("x.wasm", "views/x.wasm", false),
                ("./e.js", "views/e.js", false),
            ],
        );
        check(
            "index.html",
            "<link rel=\"icon\" href=\"data:image/svg+xml,x\"><a href=\"#views\"></a><a href=\"help.html#keys\"></a>\
             <a href=\"./\"></a><a href=\"https://example.org/\"></a><script src=\"main.js\"></script>",
            &[("help.html", "help.html", false), ("main.js", "main.js", false)],
        );
        check("style/a.css", "a{b:url(../i.svg)}c{d:url(\"data:x\")}", &[("../i.svg", "i.svg", false)]);
        check(
            "a.webmanifest",
            r#"{"start_url": "./", "icons": [{"src": "icons/a.png", "type": "image/png"}]}"#,
            &[("icons/a.png", "icons/a.png", false)],
        );
        check("a.png", "from\"./a.js\"", &[]);
    }

    #[test]
    fn what_cannot_be_followed_is_refused() {
        let error = references("a.js", "import\"../b.js\"").unwrap_err().to_string();
        assert_eq!(error, "a.js names ../b.js, which lies outside of the page's folder");
        let error = references("a.css", "@import 'b.css';").unwrap_err().to_string();
        assert!(error.starts_with("a.css has an @import"), "{error}");
        let error = references("a.js", "import(b)").unwrap_err().to_string();
        assert!(error.starts_with("a.js imports a module by import(…)"), "{error}");
    }
}
