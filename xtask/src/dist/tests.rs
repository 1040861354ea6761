//! A small site, built.

use super::*;

/// A folder with the files of a small site.
fn sources(name: &str, changed: &[(&str, &str)]) -> std::path::PathBuf {
    let web = std::env::temp_dir().join(format!("stepscope-dist-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&web);
    let files = [
        ("_headers", "# all\n/*\n  X-One: 1\n  Cache-Control: no-cache\n"),
        (
            "index.html",
            "<html data-build=\"development\"><head><link rel=\"stylesheet\" href=\"style/a.css\">\
             <link rel=\"manifest\" href=\"a.webmanifest\">\
             <script type=\"module\" src=\"main.js\"></script></head><span id=\"version\">development</span>\
             <a href=\"licenses.html\">",
        ),
        (
            "main.js",
            "import { b } from './part/b.js';\nnew Worker(new URL('./w.js', import.meta.url)); b();\nnavigator.serviceWorker.register(new URL('./sw.js', import.meta.url));",
        ),
        ("part/b.js", "import { c } from './c.js';\nexport const b = () => c('kept in b');"),
        (
            "part/c.js",
            "import { draw } from '../pkg/g.js'; // gone\nexport const c = (text) => draw(text);\nnew URL('../i.svg', import.meta.url);",
        ),
        ("pkg/g.js", "export const draw = (text) => text;"),
        (
            "w.js",
            "import * as all from './pkg/g.js';\nonmessage = () => all.draw(1);\nnew URL('x.wasm', import.meta.url);",
        ),
        ("x.wasm", "\0asm"),
        ("style/a.css", "a { background: url(../i.svg) }"),
        ("i.svg", "<svg/>"),
        ("a.webmanifest", r#"{ "start_url": "./", "icons": [{ "src": "i.svg" }] }"#),
        ("sw.js", "const build = { id: \"development\", files: [] };\nself.x = build;"),
        ("unnamed.js", "1"),
    ];
    for (path, text) in files.iter().chain(changed) {
        let file = web.join(path);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, text).unwrap();
    }
    web
}

fn built(name: &str, changed: &[(&str, &str)]) -> Result<BTreeMap<String, Vec<u8>>> {
    let web = sources(name, changed);
    let mut site = Site::read(&web)?;
    site.add("licenses.html", b"<a href=\"./\">".to_vec())?;
    site.bundle()?;
    let built = site.built("1.2.3", Some("abc"));
    std::fs::remove_dir_all(&web)?;
    built
}

fn text<'a>(built: &'a BTreeMap<String, Vec<u8>>, start: &str) -> &'a str {
    let name = name(built, start);
    std::str::from_utf8(&built[&name]).unwrap()
}

fn name(built: &BTreeMap<String, Vec<u8>>, start: &str) -> String {
    let names: Vec<_> = built.keys().filter(|name| name.starts_with(start)).collect();
    assert_eq!(names.len(), 1, "{start} in {:?}", built.keys());
    names[0].clone()
}

#[test]
fn two_builds_are_the_same_and_hold_what_is_named() {
    let one = built("one", &[]).unwrap();
    assert_eq!(one, built("two", &[]).unwrap());
    let kept: Vec<_> = one.keys().filter(|name| !name.starts_with("assets/")).collect();
    assert_eq!(kept, ["_headers", "a.webmanifest", "index.html", "licenses.html", "sw.js"]);
    assert_eq!(one.len(), kept.len() + 6, "{:?}", one.keys());

    let page = text(&one, "index.html");
    for start in ["assets/main.", "assets/g.", "assets/a.", "assets/x."] {
        assert!(page.contains(&name(&one, start)), "{start} in {page}");
    }
    assert!(!page.contains("assets/w."), "the worker's script is no module of the page: {page}");
    assert!(page.contains("data-build=\"1.2.3 (abc)\"") && page.contains(">1.2.3 (abc)</span>"), "{page}");
    let main = text(&one, "assets/main.");
    for start in ["assets/g.", "assets/w.", "assets/i."] {
        assert!(main.contains(&name(&one, start).replace("assets/", "./")), "{start} in {main}");
    }
    assert!(main.contains("kept in b") && !main.contains("gone"), "{main}");
    assert!(text(&one, "assets/w.").contains(&name(&one, "assets/g.").replace("assets/", "./")));
    assert!(main.contains("../sw.js"), "{main}");
    assert!(text(&one, "a.webmanifest").contains(&name(&one, "assets/i.")));

    let worker = text(&one, "sw.js");
    for name in one.keys().filter(|name| !["_headers", "index.html", "sw.js"].contains(&name.as_str())) {
        assert!(worker.contains(name.as_str()), "{name} in {worker}");
    }
    assert!(worker.contains("\"./\"") && !worker.contains("development"), "{worker}");
}

#[test]
fn a_change_gives_new_names_to_the_file_and_all_that_name_it_and_to_no_other() {
    let one = built("before", &[]).unwrap();
    let two = built("after", &[("part/b.js", "export const b = () => 'other';")]).unwrap();
    for (start, changes) in [
        ("assets/main.", true),
        ("assets/w.", false),
        ("assets/x.", false),
        ("assets/g.", false),
        ("assets/a.", false),
    ] {
        assert_eq!(name(&one, start) != name(&two, start), changes, "{start}");
    }
    assert_ne!(one["sw.js"], two["sw.js"]);
}

#[test]
fn what_has_a_hash_is_kept_for_ever_and_all_else_asked_for_anew() {
    let one = built("headers", &[]).unwrap();
    let headers = crate::headers::Headers::parse(text(&one, "_headers")).unwrap();
    for name in one.keys().filter(|name| *name != "_headers").map(String::as_str).chain([""]) {
        let given: Vec<_> =
            headers.of(&format!("/{name}")).map(|(_, value)| value.to_str().unwrap()).collect();
        let kept =
            if name.starts_with("assets/") { "public, max-age=31536000, immutable" } else { "no-cache" };
        assert_eq!(given, ["1", kept], "{name}");
    }
}

#[test]
fn a_site_that_does_not_hold_together_is_refused() {
    for (changed, expected) in [
        (("main.js", "import './none.js';"), "none.js is named in the page but can't be read"),
        (("index.html", "<a href=\"help.html\">"), "pages are named but not there: {\"help.html\"}"),
        (("index.html", "<html>"), "index.html must hold once: data-build=\"development\""),
        (("sw.js", "self"), "sw.js must hold once: const build"),
        (("part/c.js", "import './b.js';"), "part/c.js: waits in a circle with ./b.js"),
    ] {
        let error = format!("{:#}", built("refused", &[changed]).unwrap_err());
        assert!(error.contains(expected), "{error}");
    }
}
