//! The library crates as packages: metadata, dependencies, and examples in their documentation. `cargo xtask
//! test --only package` packs and builds them.

use serde_json::Value;
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};
use syn::{Attribute, Expr, Item, ItemUse, Lit, Meta, UseTree, Visibility};

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
const LICENSES: [&str; 2] = ["LICENSE-MIT", "LICENSE-APACHE"];

/// All crates that a microcontroller with `Device` needs.
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

/// The output of cargo.
fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO")).current_dir(root()).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Names of a package and its dependencies on the target, without build dependencies.
fn tree(package: &str) -> BTreeSet<String> {
    let arguments =
        "tree --locked --offline --edges normal,no-proc-macro --target thumbv7m-none-eabi --prefix none";
    let mut arguments: Vec<&str> = arguments.split(' ').collect();
    arguments.extend(["--no-default-features", "--package", package]);
    cargo(&arguments).lines().filter_map(|line| Some(line.split(' ').next()?.to_owned())).collect()
}

/// The packages of the workspace, from `cargo metadata`.
fn packages() -> Vec<Value> {
    let text = cargo(&["metadata", "--locked", "--offline", "--no-deps", "--format-version", "1"]);
    let metadata: Value = serde_json::from_str(&text).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

#[test]
fn small_crates_have_few_dependencies() {
    assert_eq!(tree("stepscope-registers"), BTreeSet::from(["stepscope-registers".to_owned()]));
    assert_eq!(tree("stepscope-peripheral"), PERIPHERAL.map(str::to_owned).into());
    let motion: Vec<String> =
        tree("stepscope-motion").difference(&tree("stepscope-peripheral")).cloned().collect();
    assert_eq!(motion, ["libm", "num-bigint", "num-integer", "num-traits", "stepscope-motion"]);
    let plant: Vec<String> =
        tree("stepscope-plant").difference(&tree("stepscope-peripheral")).cloned().collect();
    assert_eq!(plant, ["stepscope-plant"], "without libm");
    let controller: Vec<String> =
        tree("stepscope-controller").difference(&tree("stepscope-peripheral")).cloned().collect();
    assert_eq!(controller, ["stepscope-controller"], "without a library of numbers");
}

#[test]
fn without_features_the_facade_adds_nothing_to_the_peripheral() {
    let mut expected = tree("stepscope-peripheral");
    expected.insert("stepscope-core".to_owned());
    assert_eq!(tree("stepscope-core"), expected);
}

#[test]
fn each_library_has_its_metadata_and_licenses() {
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
        for license in LICENSES {
            let own = read(&root().join(folder).join(license));
            assert_eq!(own, read(&root().join(license)), "{folder}/{license} differs from the workspace's");
        }
        for dependency in package["dependencies"].as_array().unwrap() {
            // Packing requires versions, except for dependencies of tests.
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
fn every_example_of_the_facade_is_tested() {
    let packages = packages();
    let core = packages.iter().find(|package| package["name"] == "stepscope-core").unwrap();
    let targets = core["targets"].as_array().unwrap().iter();
    let examples: Vec<&Value> = targets.filter(|target| target["kind"][0] == "example").collect();
    assert_eq!(examples.len(), 5);
    assert!(
        examples.iter().all(|example| example["test"] == true),
        "an example is built but not run: {examples:#?}"
    );
}

/// The documentation in these attributes.
fn documentation(attributes: &[Attribute], folder: &Path) -> String {
    attributes.iter().filter_map(|attribute| documentation_of(attribute, folder)).collect()
}

/// A line of documentation, or the included file.
fn documentation_of(attribute: &Attribute, folder: &Path) -> Option<String> {
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

/// Code of the examples that `cargo test` runs, with hidden lines.
fn run_examples(documentation: &str) -> String {
    let (mut code, mut block) = (String::new(), None);
    for line in documentation.lines().map(str::trim) {
        if let Some(language) = line.strip_prefix("```") {
            block = if block.is_some() { None } else { Some(matches!(language, "" | "rust")) };
        } else if block == Some(true) {
            code.push_str(line.strip_prefix("# ").unwrap_or(line));
            code.push('\n');
        }
    }
    code
}

/// A public module: its path within the crate, and its documentation.
struct Module {
    path: String,
    documentation: String,
}

/// The public modules of a crate in files, starting with the first page, and the paths that it re-exports.
fn modules(folder: &str) -> (Vec<Module>, Vec<String>) {
    let (mut found, mut exported) = (Vec::new(), Vec::new());
    let mut queue = vec![(String::new(), root().join(folder).join("src").join("lib.rs"))];
    while let Some((path, file)) = queue.pop() {
        let source = syn::parse_file(&read(&file)).unwrap();
        let (parent, stem) = (file.parent().unwrap(), file.file_stem().unwrap());
        let below = if stem == "lib" || stem == "mod" { parent.to_owned() } else { parent.join(stem) };
        for item in &source.items {
            match item {
                Item::Mod(module) if module.content.is_none() && is_public(&module.vis) => {
                    let name = module.ident.to_string();
                    let files = [below.join(format!("{name}.rs")), below.join(&name).join("mod.rs")];
                    let file = files.into_iter().find(|file| file.exists()).unwrap();
                    queue.push((format!("{path}::{name}").trim_start_matches("::").to_owned(), file));
                }
                Item::Use(item) if path.is_empty() && is_public(&item.vis) => {
                    exported.extend(paths("", &item.tree));
                }
                _ => {}
            }
        }
        found.push(Module { path, documentation: documentation(&source.attrs, parent) });
    }
    (found, exported)
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// All paths of a `use` item.
fn paths(before: &str, tree: &UseTree) -> Vec<String> {
    match tree {
        UseTree::Path(path) => paths(&format!("{before}{}::", path.ident), &path.tree),
        UseTree::Group(group) => group.items.iter().flat_map(|tree| paths(before, tree)).collect(),
        UseTree::Name(name) => vec![format!("{before}{}", name.ident)],
        UseTree::Rename(name) => vec![format!("{before}{}", name.ident)],
        UseTree::Glob(_) => vec![before.trim_end_matches("::").to_owned()],
    }
}

/// The paths that a first page links to, or that its examples use.
fn referenced(documentation: &str) -> Vec<String> {
    let between = |begin: &str, end: &str| -> Vec<String> {
        let starts = documentation.split(begin).skip(1);
        starts.filter_map(|rest| rest.split_once(end)).map(|(path, _)| path.to_owned()).collect()
    };
    let mut found = [between("[`", "`]"), between("](", ")")].concat();
    let code = run_examples(documentation);
    for import in code.split("use ").skip(1).filter_map(|rest| rest.split_once(';')) {
        if let Ok(item) = syn::parse_str::<ItemUse>(&format!("use {};", import.0)) {
            found.extend(paths("", &item.tree));
        }
    }
    found
}

/// A library user starts on a crate's first page, and continues with the modules that it links to, re-exports, or
/// uses in its examples. The first page of `stepscope-core` leads to the modules of all crates.
#[test]
fn first_pages_and_their_modules_have_a_tested_example() {
    let (mut missing, mut required) = (Vec::new(), 0);
    let facade = modules("core").0.remove(0).documentation;
    for (name, folder) in LIBRARIES {
        let (modules, exported) = modules(folder);
        let (crate_name, room) = (name.replace('-', "_"), name.trim_start_matches("stepscope-"));
        let own = referenced(&modules[0].documentation).into_iter().map(|path| {
            let path = path.trim_start_matches("crate::");
            path.strip_prefix(&format!("{crate_name}::")).unwrap_or(path).to_owned()
        });
        let of_facade = referenced(&facade).into_iter().filter_map(|path| {
            let path = path.strip_prefix("stepscope_core::").unwrap_or(&path);
            path.strip_prefix(&format!("{room}::")).map(str::to_owned)
        });
        let paths: Vec<String> = own.chain(of_facade).chain(exported).collect();
        for module in &modules {
            let is_target = |path: &String| {
                let within =
                    |module: &Module| path == &module.path || path.starts_with(&format!("{}::", module.path));
                let innermost = modules.iter().filter(|one| within(one)).max_by_key(|one| one.path.len());
                innermost.is_some_and(|one| one.path == module.path)
            };
            if module.path.is_empty() || paths.iter().any(is_target) {
                required += 1;
                if run_examples(&module.documentation).is_empty() {
                    missing.push(format!("{name}: {}", module.path));
                }
            }
        }
    }
    assert!(required > 30, "only {required} modules are required");
    assert!(missing.is_empty(), "add a short example to the header of: {missing:#?}");
}
