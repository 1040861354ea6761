//! What others get who take the library crates: their metadata, what they bring with them, and that whoever reads their
//! documentation finds an example on every module. `cargo xtask test --only package` packs and builds them.

use serde_json::Value;
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};
use syn::{Attribute, Expr, Item, Lit, Meta, Visibility};

/// The library crates and their folders.
const LIBRARIES: [(&str, &str); 10] = [
    ("stepscope-registers", "core/registers"),
    ("stepscope-peripheral", "core/peripheral"),
    ("stepscope-motion", "core/motion"),
    ("stepscope-plant", "core/plant"),
    ("stepscope-controller", "core/controller"),
    ("stepscope-capture", "core/capture"),
    ("stepscope-scenario", "core/scenario"),
    ("stepscope-sim", "core/sim"),
    ("stepscope-inspect", "core/inspect"),
    ("stepscope-core", "core"),
];
const LICENCES: [&str; 2] = ["LICENSE-MIT", "LICENSE-APACHE"];

/// What runs on a microcontroller that takes `Device`: all of it.
const PERIPHERAL: [&str; 11] = [
    "byteorder",
    "cobs",
    "crc",
    "crc-catalog",
    "hash32",
    "heapless",
    "stable_deref_trait",
    "stepscope-peripheral",
    "stepscope-registers",
    "thiserror",
    "twox-hash",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// What cargo prints.
fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO")).current_dir(root()).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Names of the crates that a package brings to its target, with itself; what only runs while it is built is none of them.
fn tree(package: &str) -> BTreeSet<String> {
    let arguments =
        "tree --locked --offline --edges normal,no-proc-macro --target thumbv7m-none-eabi --prefix none";
    let mut arguments: Vec<&str> = arguments.split(' ').collect();
    arguments.extend(["--no-default-features", "--package", package]);
    cargo(&arguments).lines().filter_map(|line| Some(line.split(' ').next()?.to_owned())).collect()
}

/// The workspace's packages, as cargo knows them.
fn packages() -> Vec<Value> {
    let text = cargo(&["metadata", "--locked", "--offline", "--no-deps", "--format-version", "1"]);
    let metadata: Value = serde_json::from_str(&text).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

#[test]
fn who_takes_the_peripheral_gets_a_handful_of_crates() {
    assert_eq!(tree("stepscope-registers"), BTreeSet::from(["stepscope-registers".to_owned()]));
    assert_eq!(tree("stepscope-peripheral"), PERIPHERAL.map(str::to_owned).into());
    let motion: Vec<String> =
        tree("stepscope-motion").difference(&tree("stepscope-peripheral")).cloned().collect();
    assert_eq!(motion, ["libm", "num-bigint", "num-integer", "num-traits", "stepscope-motion"]);
    let plant: Vec<String> =
        tree("stepscope-plant").difference(&tree("stepscope-peripheral")).cloned().collect();
    assert_eq!(plant, ["stepscope-plant"], "not even libm");
    let controller: Vec<String> =
        tree("stepscope-controller").difference(&tree("stepscope-peripheral")).cloned().collect();
    assert_eq!(controller, ["stepscope-controller"], "whole numbers need no library");
}

#[test]
fn the_door_without_features_brings_no_more_than_the_peripheral() {
    let mut expected = tree("stepscope-peripheral");
    expected.insert("stepscope-core".to_owned());
    assert_eq!(tree("stepscope-core"), expected);
}

#[test]
fn each_library_says_what_it_is_and_under_which_terms() {
    let packages = packages();
    for (name, folder) in LIBRARIES {
        let package = packages.iter().find(|package| package["name"] == name).unwrap();
        for field in ["description", "license", "repository", "readme", "rust_version"] {
            assert!(package[field].as_str().is_some_and(|text| !text.is_empty()), "{name} has no {field}");
        }
        for field in ["keywords", "categories"] {
            let count = package[field].as_array().unwrap().len();
            assert!((1..=5).contains(&count), "{name} has {count} {field}; a registry takes 1 to 5");
        }
        for licence in LICENCES {
            let own = read(&root().join(folder).join(licence));
            assert_eq!(own, read(&root().join(licence)), "{folder}/{licence} is not the workspace's");
        }
        for dependency in package["dependencies"].as_array().unwrap() {
            // Without a version it cannot be packed; those for tests alone are left out of the package.
            let packed = dependency["kind"].is_null() && dependency["path"].is_string();
            let expected = format!("^{}", package["version"].as_str().unwrap());
            assert!(
                !packed || dependency["req"] == expected,
                "{name}: {} is not {expected}",
                dependency["name"]
            );
        }
    }
}

#[test]
fn every_example_of_the_door_is_run_by_the_tests() {
    let packages = packages();
    let core = packages.iter().find(|package| package["name"] == "stepscope-core").unwrap();
    let targets = core["targets"].as_array().unwrap().iter();
    let examples: Vec<&Value> = targets.filter(|target| target["kind"][0] == "example").collect();
    assert_eq!(examples.len(), 4);
    assert!(
        examples.iter().all(|example| example["test"] == true),
        "an example is built only: {examples:#?}"
    );
}

/// Whether some of the attributes' documentation is an example that is run.
fn has_example(attributes: &[Attribute], folder: &Path) -> bool {
    let text: String = attributes.iter().filter_map(|attribute| documentation(attribute, folder)).collect();
    let mut inside = false;
    text.lines().map(str::trim).filter(|line| line.starts_with("```")).any(|line| {
        inside = !inside;
        inside && matches!(line, "```" | "```rust")
    })
}

/// A line of documentation, or the file that stands for it.
fn documentation(attribute: &Attribute, folder: &Path) -> Option<String> {
    let Meta::NameValue(meta) = &attribute.meta else { return None };
    if !meta.path.is_ident("doc") {
        return None;
    }
    let text = |literal: &Lit| if let Lit::Str(text) = literal { Some(text.value()) } else { None };
    match &meta.value {
        Expr::Lit(literal) => Some(text(&literal.lit)? + "\n"),
        Expr::Macro(call) => Some(read(&folder.join(text(&call.mac.parse_body().ok()?)?))),
        _ => None,
    }
}

/// Public modules in files, from `file` on, without an example and without a unit test.
fn without_example(file: &Path, missing: &mut Vec<String>) -> usize {
    let source = syn::parse_file(&read(file)).unwrap();
    let folder = file.parent().unwrap();
    let is_crate = file.ends_with("lib.rs");
    let is_tests = |item: &Item| matches!(item, Item::Mod(module) if module.ident == "tests");
    // Within a crate, a unit test of the module is an example that runs, too.
    if !has_example(&source.attrs, folder) && (is_crate || !source.items.iter().any(is_tests)) {
        missing.push(file.strip_prefix(root()).unwrap().display().to_string());
    }
    let stem = file.file_stem().unwrap();
    let below = if stem == "lib" || stem == "mod" { folder.to_owned() } else { folder.join(stem) };
    let mut count = 1;
    for item in &source.items {
        if let Item::Mod(module) = item
            && module.content.is_none()
            && matches!(module.vis, Visibility::Public(_))
        {
            let name = module.ident.to_string();
            let files = [below.join(format!("{name}.rs")), below.join(&name).join("mod.rs")];
            count += without_example(files.iter().find(|file| file.exists()).unwrap(), missing);
        }
    }
    count
}

#[test]
fn every_public_module_has_an_example_that_is_run() {
    let (mut missing, mut count) = (Vec::new(), 0);
    for (_, folder) in LIBRARIES {
        count += without_example(&root().join(folder).join("src").join("lib.rs"), &mut missing);
    }
    assert!(count > 60, "only {count} modules were found");
    assert!(missing.is_empty(), "give these a short example at their head, or a unit test: {missing:#?}");
}
