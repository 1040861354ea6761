//! The order of the page's folders, as listed in `web/main.js`: no file imports anything to its right.
//!
//! Types count as well, although nothing loads for them, because a file depends on the types that it names.
//! The linter detects circular imports of files in a folder (`web/biome.jsonc`).

use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// The text before a specifier, in an import or a type.
const IMPORTS: &[&str] = &["from \"", "import \"", "import(\""];
/// It imports nothing, and no file imports it.
const ALONE: &str = "sw.js";

fn web() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../web")
}

/// The folders from left to right, and single files.
fn order() -> Vec<String> {
    let text = fs::read_to_string(web().join("main.js")).unwrap();
    let line = text.lines().find(|line| line.contains(" -> ")).unwrap().trim_start_matches([' ', '*']);
    line.split(" -> ").map(str::to_owned).collect()
}

/// All scripts in `folder`, by their paths relative to `web`.
fn scripts(folder: &Path, below: &str, found: &mut Vec<(String, String)>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let path = format!("{below}{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_dir() && !path.starts_with("pkg") {
            scripts(&entry.path(), &format!("{path}/"), found)?;
        } else if path.ends_with(".js") && path != ALONE {
            found.push((path, fs::read_to_string(entry.path())?));
        }
    }
    Ok(())
}

/// The files that a script names, by their paths relative to `web`.
fn imports(path: &str, text: &str) -> Vec<String> {
    let rests = IMPORTS.iter().flat_map(|before| text.split(before).skip(1));
    let names = rests.filter_map(|rest| rest.split('"').next()).filter(|name| name.starts_with('.'));
    names.map(|name| resolved(path, name)).collect()
}

fn resolved(path: &str, name: &str) -> String {
    let mut parts: Vec<&str> = path.split('/').collect();
    parts.pop();
    for part in name.split('/') {
        match part {
            "." => {}
            ".." => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// The top folder of a file in `web`, or the file itself.
fn layer(path: &str) -> &str {
    path.split('/').next().unwrap_or(path)
}

#[test]
fn every_form_of_import_is_found() {
    let text = "import { a,\n b } from \"../dom.js\";\nimport \"./c.js\";\n/** @typedef {import(\"../../state/types.js\").State} State */\n\
                const later = () => import(\"./d.js\"); import * as e from \"../motion/e.js\"; f(\"./none.js\");";
    let mut found = imports("views/study/x.js", text);
    found.sort();
    assert_eq!(
        found,
        ["state/types.js", "views/dom.js", "views/motion/e.js", "views/study/c.js", "views/study/d.js"]
    );
}

#[test]
fn folders_are_listed_and_import_only_from_their_left() {
    let order = order();
    let place = |path: &str| order.iter().position(|each| each == layer(path));
    let mut found = Vec::new();
    scripts(&web(), "", &mut found).unwrap();
    assert!(found.len() > 50, "the scripts are elsewhere: {} in {}", found.len(), web().display());
    let mut broken = Vec::new();
    for (path, text) in &found {
        for other in imports(path, text) {
            if layer(path) != layer(&other) {
                match (place(path), place(&other)) {
                    (Some(own), Some(its)) if its < own => {}
                    (Some(_), Some(_)) => {
                        broken.push(format!("{path} names {other}, which stands to its right"))
                    }
                    _ => broken.push(format!("{path} names {other}: web/main.js does not draw both")),
                }
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
    for name in order.iter().filter(|name| !name.starts_with("pkg")) {
        assert!(found.iter().any(|(path, _)| layer(path) == name), "{name} is drawn but not there");
    }
}
