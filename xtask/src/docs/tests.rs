use super::*;

fn book(name: &str, files: &[(&str, &str)]) -> Result<BTreeMap<String, Vec<u8>>> {
    let root = std::env::temp_dir().join(format!("stepscope-docs-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&root);
    let summary = (
        "docs/SUMMARY.md",
        "# Summary\n\n[Start](README.md)\n\n# How-to\n\n- [One](how/one.md)\n- [Own](../OWN.md)\n",
    );
    let readme = ("docs/README.md", "# Start\n");
    let one = ("docs/how/one.md", "# One & all\n");
    let own = ("OWN.md", "# Own\n");
    let defaults = [summary, readme, one, own, ("docs/a.png", "picture"), ("src.rs", "")];
    for (file, text) in defaults.iter().chain(files) {
        let path = root.join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    let found = Book::read(&root).and_then(|book| book.files());
    std::fs::remove_dir_all(&root).unwrap();
    found
}

fn text(files: &BTreeMap<String, Vec<u8>>, name: &str) -> String {
    String::from_utf8(files[name].clone()).unwrap()
}

#[test]
fn pages_link_to_each_other_and_to_the_contents() {
    let one = "# One & all\n\n## A `code` word\n\n## A `code` word\n\n[start](../README.md), [own](../../OWN.md#own), \
               [here](#a-code-word-1), [source](../../src.rs), [out](https://a.b/), ![p](../a.png)\n";
    let files = book("links", &[("docs/how/one.md", one)]).unwrap();
    assert_eq!(
        files.keys().collect::<Vec<_>>(),
        ["OWN.html", "a.png", "how/one.html", "index.html", "site.css"]
    );
    let page = text(&files, "how/one.html");
    for part in [
        "<title>One – Stepscope</title>",
        "<a href=\"../index.html\">start</a>",
        "<a href=\"../OWN.html#own\">own</a>",
        "<a href=\"../how/one.html#a-code-word-1\">here</a>",
        ", source, ",
        "<a href=\"https://a.b/\">out</a>",
        "<img src=\"../a.png\"",
        "<h2 id=\"a-code-word-1\">",
        "<h2>How-to</h2>",
        "<a aria-current=\"page\" href=\"../how/one.html\">One</a>",
        "Previous: <a href=\"../index.html\">Start</a>",
        "Next: <a href=\"../OWN.html\">Own</a>",
        "href=\"../site.css\"",
    ] {
        assert!(page.contains(part), "{part} in\n{page}");
    }
}

#[test]
fn broken_links_and_unlisted_pages_are_reported() {
    for (name, file, page, expected) in [
        ("none", "docs/README.md", "[a](none.md)", "docs/README.md links to none.md, which does not exist"),
        (
            "id",
            "docs/README.md",
            "[a](../OWN.md#none)",
            "docs/README.md links to #none, which OWN.html does not have",
        ),
        ("listed", "docs/two.md", "# Two\n", "docs/SUMMARY.md does not list docs/two.md"),
        ("outside", "docs/README.md", "[a](../../../a.md)", "leaves the repository"),
        ("summary", "docs/SUMMARY.md", "[a](none.md)", "docs/none.md can't be read"),
    ] {
        let error = format!("{:#}", book(name, &[(file, page)]).unwrap_err());
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn the_site_has_no_inline_scripts_or_styles() {
    let files = Book::read(root()).unwrap().files().unwrap();
    assert!(files.len() > 30, "{:?}", files.keys());
    for (name, bytes) in files.iter().filter(|(name, _)| name.ends_with(".html")) {
        let page = String::from_utf8(bytes.clone()).unwrap();
        assert!(!page.contains("<script") && !page.contains(" style="), "{name}");
        assert_eq!(page.matches("<h1").count(), 1, "{name}");
    }
}

/// Long pages are references; all others stay short enough to be read.
#[test]
fn pages_that_are_no_references_have_at_most_8_kb() {
    let book = Book::read(root()).unwrap();
    let references = ["docs/decisions.md", "docs/contract.md"];
    for chapter in book.chapters.iter().filter(|chapter| chapter.part != "Reference") {
        let name = chapter.source.to_string_lossy();
        assert!(
            chapter.text.len() <= 8_192 || references.contains(&name.as_ref()),
            "{name} has {} bytes",
            chapter.text.len()
        );
    }
    let readme = read(root(), Path::new("README.md")).unwrap();
    assert!(readme.len() <= 6_000, "README.md has {} bytes", readme.len());
}

#[test]
fn links_of_the_readme_exist() {
    let readme = read(root(), Path::new("README.md")).unwrap();
    for event in Parser::new(&readme) {
        if let Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) = event
            && !dest_url.contains(':')
        {
            assert!(root().join(dest_url.as_ref()).exists(), "{dest_url}");
        }
    }
}
