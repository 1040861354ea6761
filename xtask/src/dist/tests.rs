//! A small site, as esbuild hands it over.

use super::*;

fn site(changed: &[(&str, &str)]) -> Site {
    let texts = [
        (
            "index.html",
            "<html data-build=\"development\"><head><link rel=\"stylesheet\" href=\"style/a.css\">\
             <link rel=\"manifest\" href=\"a.webmanifest\"><link rel=\"icon\" href=\"data:,x\">\
             <link rel=\"preload\" href=\"pkg/x.wasm\">\
             <script type=\"module\" src=\"main.js\" data-worker=\"engine/w.js\"></script></head>\
             <span id=\"version\">development</span><a href=\"#views\"></a><a href=\"./\"></a>\
             <a href=\"licenses.html\"></a><a href=\"help.html#keys\"></a><a href=\"docs/\"></a>",
        ),
        (
            "help.html",
            "<head><link rel=\"stylesheet\" href=\"style/a.css\"><script src=\"help/page.js\"></script></head>",
        ),
        ("licenses.html", "<a href=\"./\">"),
        ("a.webmanifest", r#"{ "start_url": "./", "icons": [{ "src": "icons/i.svg" }] }"#),
        (
            "sw.js",
            "/**\n * Keeps it.\n */\n// Filled.\nconst build = { id: \"development\", files: [] };\n  // Said.\nself.x = build;",
        ),
    ];
    let texts = texts.iter().chain(changed).map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
    let headers = "# all\n/*\n  X-One: 1\n  Cache-Control: no-cache\n".to_owned();
    Site { texts: texts.collect(), headers }
}

/// esbuild's result: `main.js` shares one file with the worker and another with the later part of the help page.
fn bundles(hash: &str) -> Bundles {
    let import =
        |path: &str, kind: &str| format!("{{\"path\": \"../dist/assets/{path}\", \"kind\": \"{kind}\"}}");
    let now = |path: &str| import(path, "import-statement");
    let later = |path: &str| import(path, "dynamic-import");
    let outputs = [
        (
            format!("main.{hash}.js"),
            "main.js",
            vec![now("chunk.G.js"), now("chunk.T.js"), later("tabs.Q.js")],
        ),
        ("w.W.js".to_owned(), "engine/w.js", vec![now("chunk.G.js")]),
        ("page.P.js".to_owned(), "help/page.js", vec![now("chunk.T.js"), now("chunk.U.js")]),
        (
            "tabs.Q.js".to_owned(),
            "views/tabs.js",
            vec![now("chunk.T.js"), now("chunk.U.js"), later("file.F.js")],
        ),
        ("file.F.js".to_owned(), "views/file.js", vec![now("chunk.V.js"), later("tabs.Q.js")]),
        ("chunk.G.js".to_owned(), "", vec![]),
        ("chunk.T.js".to_owned(), "", vec![]),
        ("chunk.U.js".to_owned(), "", vec![]),
        ("chunk.V.js".to_owned(), "", vec![]),
        ("x.X.wasm".to_owned(), "pkg/x.wasm", vec![]),
        ("a.A.css".to_owned(), "style/a.css", vec![]),
        ("i.I.svg".to_owned(), "icons/i.svg", vec![]),
    ];
    let outputs = outputs.map(|(name, entry, imports)| {
        let entry = if entry.is_empty() { String::new() } else { format!(", \"entryPoint\": \"{entry}\"") };
        format!("\"../dist/assets/{name}\": {{\"bytes\": 1, \"imports\": [{}]{entry}}}", imports.join(", "))
    });
    Bundles::parse(&format!("{{\"inputs\": {{}}, \"outputs\": {{{}}}}}", outputs.join(", "))).unwrap()
}

fn built(changed: &[(&str, &str)], hash: &str) -> Result<BTreeMap<String, String>> {
    site(changed).built(&bundles(hash), "1.2.3", Some("abc"))
}

#[test]
fn all_that_pages_and_the_manifest_name_becomes_a_file_with_a_hash() {
    let sources: Vec<_> = site(&[]).sources().into_iter().map(str::to_owned).collect();
    assert_eq!(
        sources,
        ["engine/w.js", "help/page.js", "icons/i.svg", "main.js", "pkg/x.wasm", "style/a.css"]
    );
}

#[test]
fn pages_and_manifest_have_the_new_names_and_the_service_worker_lists_all_files() {
    let built = built(&[], "M").unwrap();
    let names: Vec<&str> = built.keys().map(String::as_str).collect();
    assert_eq!(names, ["_headers", "a.webmanifest", "help.html", "index.html", "licenses.html", "sw.js"]);
    let page = &built["index.html"];
    for part in [
        "href=\"assets/a.A.css\"",
        "href=\"a.webmanifest\"",
        "href=\"data:,x\"",
        "href=\"assets/x.X.wasm\"",
        "src=\"assets/main.M.js\" data-worker=\"assets/w.W.js\"",
        "data-build=\"1.2.3 (abc)\"",
        ">1.2.3 (abc)</span>",
        "<a href=\"./\">",
        "href=\"help.html#keys\"",
        "<link rel=\"modulepreload\" href=\"assets/chunk.G.js\">\n<link rel=\"modulepreload\" href=\"assets/chunk.T.js\">\n</head>",
    ] {
        assert!(page.contains(part), "{part} in {page}");
    }
    assert!(built["help.html"].contains("src=\"assets/page.P.js\""), "{}", built["help.html"]);
    assert!(built["a.webmanifest"].contains("\"src\": \"assets/i.I.svg\""), "{}", built["a.webmanifest"]);

    let worker = &built["sw.js"];
    let kept = ["a.webmanifest", "help.html", "licenses.html", "./"];
    for name in bundles("M").files().chain(kept) {
        assert!(worker.contains(&format!("\"{name}\"")), "{name} in {worker}");
    }
    assert!(worker.ends_with("};\nself.x = build;\n"), "{worker}");
    for other in ["development", "index.html", "\"sw.js\"", "_headers", "Keeps", "Filled", "Said"] {
        assert!(!worker.contains(other), "{other} in {worker}");
    }
}

#[test]
fn another_name_of_a_file_gives_the_build_another_number() {
    let number = |hash: &str| built(&[], hash).unwrap()["sw.js"].split('"').nth(1).unwrap().to_owned();
    assert_eq!(number("M"), number("M"));
    assert_ne!(number("M"), number("N"));
}

#[test]
fn what_has_a_hash_is_kept_for_ever_and_all_else_asked_for_anew() {
    let one = built(&[], "M").unwrap();
    let headers = headers::Headers::parse(&one[headers::FILE]).unwrap();
    let names = one.keys().filter(|name| *name != headers::FILE).map(String::as_str);
    for name in names.chain(bundles("M").files()).chain(["", "docs/index.html"]) {
        let given: Vec<_> =
            headers.of(&format!("/{name}")).map(|(_, value)| value.to_str().unwrap()).collect();
        let kept =
            if name.starts_with("assets/") { "public, max-age=31536000, immutable" } else { "no-cache" };
        assert_eq!(given, ["1", kept], "{name}");
    }
}

#[test]
fn what_loads_later_is_told_from_what_opening_the_page_loads() {
    let Parts { opening, later } = site(&[]).parts(&bundles("M"));
    let assets = ["a.A.css", "chunk.G.js", "chunk.T.js", "main.M.js", "w.W.js", "x.X.wasm"];
    let assets = assets.map(|name| format!("assets/{name}"));
    let expected = assets.into_iter().chain(["index.html", "sw.js"].map(str::to_owned));
    assert_eq!(opening, expected.collect());
    let later: Vec<_> = later.iter().map(|(name, files)| format!("{name}: {files:?}")).collect();
    assert_eq!(
        later,
        [
            r#"help.html: {"assets/chunk.U.js", "assets/page.P.js", "help.html"}"#,
            r#"licenses.html: {"licenses.html"}"#,
            r#"views/file.js: {"assets/chunk.V.js", "assets/file.F.js"}"#,
            r#"views/tabs.js: {"assets/chunk.U.js", "assets/tabs.Q.js"}"#,
        ]
    );
}

#[test]
fn a_site_that_does_not_hold_together_is_refused() {
    for (changed, expected) in [
        (("help.html", "<a href=\"none.html\">"), "help.html names none.html, which is not there"),
        (("help.html", "<script src=\"none.js\">"), "help.html names none.js, which is not made"),
        (("index.html", "<html>"), "index.html must hold once: data-build=\"development\""),
        (("sw.js", "self"), "sw.js must hold once: const build"),
    ] {
        let error = format!("{:#}", built(&[changed], "M").unwrap_err());
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn only_an_earlier_build_is_cleared_away() {
    let dist = std::env::temp_dir().join(format!("stepscope-dist-{}", std::process::id()));
    std::fs::create_dir_all(dist.join(ASSETS)).unwrap();
    clear(&dist).unwrap();
    assert!(!dist.exists());
    clear(&dist).unwrap();
    std::fs::create_dir_all(dist.join("work")).unwrap();
    assert!(
        clear(&dist)
            .unwrap_err()
            .to_string()
            .ends_with("is no earlier build; remove it or take another folder")
    );
    std::fs::remove_dir_all(&dist).unwrap();
}

#[test]
fn what_a_page_names_for_later_is_made_and_listed_but_not_among_what_opening_it_loads() {
    let page = "<html data-build=\"development\"><head>\
                <script type=\"module\" src=\"main.js\" data-study-worker=\"engine/w.js\" data-tools-core=\"pkg/x.wasm\"></script></head>\
                <span id=\"version\">development</span>";
    let site = site(&[("index.html", page)]);
    let made = bundles("M");
    let built = site.built(&made, "1.2.3", Some("abc")).unwrap();
    assert!(
        built["index.html"]
            .contains("data-study-worker=\"assets/w.W.js\" data-tools-core=\"assets/x.X.wasm\"")
    );
    assert!(built["sw.js"].contains("assets/x.X.wasm"), "it is kept for use without a network");
    let parts = site.parts(&made);
    assert!(!parts.opening.contains("assets/x.X.wasm") && !parts.opening.contains("assets/w.W.js"));
    let later: Vec<_> = parts.later["engine/w.js"].iter().map(String::as_str).collect();
    assert_eq!(later, ["assets/w.W.js", "assets/x.X.wasm"]);
}

#[test]
fn a_later_part_is_what_the_script_of_the_page_alone_asks_for() {
    let source = |name: &str, now: &[&str], later: &[&str]| {
        let import = |path: &&str, kind: &str| format!("{{\"path\": \"{path}\", \"kind\": \"{kind}\"}}");
        let now = now.iter().map(|path| import(path, "import-statement"));
        let later = later.iter().map(|path| import(path, "dynamic-import"));
        let imports: Vec<_> = now.chain(later).collect();
        format!("\"{name}\": {{\"bytes\": 1, \"imports\": [{}]}}", imports.join(", "))
    };
    let inputs = [
        source("main.js", &["dom.js", "help/card.js"], &["views/tabs.js"]),
        source("views/tabs.js", &["dom.js"], &["views/file.js"]),
        source("views/file.js", &[], &["views/tabs.js"]),
        source("help/card.js", &[], &["help/texts.js"]),
        source("help/texts.js", &[], &[]),
        source("help/page.js", &["help/texts.js"], &[]),
        source("engine/w.js", &["dom.js"], &["pkg/x.js"]),
        source("dom.js", &[], &[]),
    ];
    let note = format!("{{\"inputs\": {{{}}}}}", inputs.join(", "));
    let sources = BTreeSet::from(["main.js", "help/page.js", "engine/w.js", "style/a.css"]);
    let parts = esbuild::later_parts(&note, &sources, "main.js").unwrap();
    assert_eq!(parts.into_iter().collect::<Vec<_>>(), ["views/file.js", "views/tabs.js"]);
}
