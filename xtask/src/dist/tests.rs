//! Builds a small site from output like that of esbuild.

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
    site(changed).texts_of_build(&bundles(hash), "1.2.3", Some("abc"))
}

#[test]
fn sources_are_all_files_that_pages_and_the_manifest_reference() {
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
    let unhashed = ["a.webmanifest", "help.html", "licenses.html", "./"];
    for name in bundles("M").files().chain(unhashed) {
        assert!(worker.contains(&format!("\"{name}\"")), "{name} in {worker}");
    }
    assert!(worker.ends_with("};\nself.x = build;\n"), "{worker}");
    for other in ["development", "index.html", "\"sw.js\"", "_headers", "Keeps", "Filled", "Said"] {
        assert!(!worker.contains(other), "{other} in {worker}");
    }
}

#[test]
fn the_build_id_depends_on_the_names_of_the_files() {
    let build_id = |hash: &str| built(&[], hash).unwrap()["sw.js"].split('"').nth(1).unwrap().to_owned();
    assert_eq!(build_id("M"), build_id("M"));
    assert_ne!(build_id("M"), build_id("N"));
}

#[test]
fn files_with_a_hash_are_cached_forever_and_all_others_requested_again() {
    let one = built(&[], "M").unwrap();
    let headers = headers::Headers::parse(&one[headers::FILE]).unwrap();
    let names = one.keys().filter(|name| *name != headers::FILE).map(String::as_str);
    for name in names.chain(bundles("M").files()).chain(["", "docs/index.html"]) {
        let given: Vec<_> =
            headers.of(&format!("/{name}")).map(|(_, value)| value.to_str().unwrap()).collect();
        let expected =
            if name.starts_with("assets/") { "public, max-age=31536000, immutable" } else { "no-cache" };
        assert_eq!(given, ["1", expected], "{name}");
    }
}

#[test]
fn files_that_load_later_are_listed_apart_from_the_opening() {
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
fn missing_files_and_placeholders_are_reported() {
    for (changed, expected) in [
        (("help.html", "<a href=\"none.html\">"), "help.html references none.html, which does not exist"),
        (("help.html", "<script src=\"none.js\">"), "help.html references none.js, which is not built"),
        (("index.html", "<html>"), "index.html must contain once: data-build=\"development\""),
        (("sw.js", "self"), "sw.js must contain once: const build"),
    ] {
        let error = format!("{:#}", built(&[changed], "M").unwrap_err());
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn only_an_earlier_build_is_removed() {
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
            .ends_with("is not an earlier build; remove it, or use another folder")
    );
    std::fs::remove_dir_all(&dist).unwrap();
}

#[test]
fn files_for_later_attributes_are_built_but_not_part_of_the_opening() {
    let page = "<html data-build=\"development\"><head>\
                <script type=\"module\" src=\"main.js\" data-capture-worker=\"engine/w.js\" data-recordings-core=\"pkg/x.wasm\"></script></head>\
                <span id=\"version\">development</span>";
    let site = site(&[("index.html", page)]);
    let bundles = bundles("M");
    let built = site.texts_of_build(&bundles, "1.2.3", Some("abc")).unwrap();
    assert!(
        built["index.html"]
            .contains("data-capture-worker=\"assets/w.W.js\" data-recordings-core=\"assets/x.X.wasm\"")
    );
    assert!(built["sw.js"].contains("assets/x.X.wasm"), "offline use needs it");
    let parts = site.parts(&bundles);
    assert!(!parts.opening.contains("assets/x.X.wasm") && !parts.opening.contains("assets/w.W.js"));
    let later: Vec<_> = parts.later["engine/w.js"].iter().map(String::as_str).collect();
    assert_eq!(later, ["assets/w.W.js", "assets/x.X.wasm"]);
}

#[test]
fn a_later_part_is_imported_only_by_the_script_of_the_page() {
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
