//! DESIGN Part C, held: the order of the core's modules as its own `lib.rs` draws it, and what never gets into the core.
//!
//! The core's source is parsed, without what is compiled for its unit tests; paths are looked at wherever they stand, in
//! `use` lines, in expressions and types, and in macros.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "what cannot be read fails the test")]

use std::{
    fs, io,
    path::{Path, PathBuf},
};
use syn::{
    Attribute, ExprMethodCall, File, Ident, Item, ItemMod, ItemUse, Macro, Meta, UseTree,
    ext::IdentExt,
    visit::{self, Visit},
};

/// Functions whose bits depend on the platform's mathematics library; `mul_add` is DESIGN A1's fused multiply-add.
const INEXACT: &[&str] = &[
    "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "cos", "cosh", "exp", "exp2",
    "exp_m1", "hypot", "ln", "ln_1p", "log", "log10", "log2", "mul_add", "powf", "powi", "sin", "sin_cos",
    "sinh", "tan", "tanh",
];
/// Exact on every platform, but only there with the standard library: the core takes them from libm, too.
const EXACT: &[&str] = &["ceil", "floor", "fract", "round", "round_ties_even", "sqrt", "trunc"];
/// Their iteration order differs from run to run.
const UNORDERED: &[&str] = &["HashMap", "HashSet", "RandomState"];
/// Clocks, threads, files and their like: nothing of them decides an edge.
const OUTSIDE: &[&str] = &["env", "fs", "io", "net", "process", "thread", "time"];
/// What one file may all the same, each with its reason.
const EXCEPTIONS: &[(&str, &str, &str)] = &[
    (
        "core/src/motion/mod.rs",
        "sqrt",
        "IEEE 754 leaves a square root no choice of bits, and a test compares them",
    ),
    ("core/src/trace/vcd.rs", "io", "only the trait that bytes are written through"),
];

/// Who never learns of whom, also where the order would let him.
const STRANGERS: &[(&str, &str)] =
    &[("device", "motion"), ("device", "quantise"), ("wire", "motion"), ("wire", "quantise")];

/// What a file says, as far as it is looked at here.
#[derive(Default)]
struct Seen {
    /// The module that is being visited, from the crate's root.
    module: Vec<String>,
    /// All paths, each from its first name on; `crate` and `super` are resolved to the crate's root, written `crate`.
    paths: Vec<Vec<String>>,
    /// Names of methods that are called.
    methods: Vec<String>,
}

impl Seen {
    fn path(&mut self, names: Vec<String>) {
        let above = names.iter().take_while(|name| *name == "super").count();
        let resolved = match names.first().map(String::as_str) {
            Some("super") if above <= self.module.len() => {
                let kept = self.module.iter().take(self.module.len() - above);
                let rest = names.iter().skip(above);
                ["crate".to_owned()].into_iter().chain(kept.cloned()).chain(rest.cloned()).collect()
            }
            _ => names,
        };
        self.paths.push(resolved);
    }

    fn tree(&mut self, before: &[String], tree: &UseTree) {
        let with =
            |ident: &Ident| before.iter().cloned().chain([ident.unraw().to_string()]).collect::<Vec<_>>();
        match tree {
            UseTree::Path(path) => self.tree(&with(&path.ident), &path.tree),
            UseTree::Name(name) => self.path(with(&name.ident)),
            UseTree::Rename(rename) => self.path(with(&rename.ident)),
            UseTree::Glob(_) => self.path(before.to_vec()),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.tree(before, tree)),
        }
    }

    /// The tokens of a macro, as words: a name, or what stands between names.
    fn words(&mut self, text: &str) {
        let words: Vec<&str> =
            text.split(|c: char| c.is_whitespace()).filter(|word| !word.is_empty()).collect();
        let is_name = |word: &str| word.chars().all(|c| c.is_alphanumeric() || c == '_');
        for (index, word) in words.iter().enumerate().filter(|(_, word)| is_name(word)) {
            let before = index.checked_sub(1).and_then(|before| words.get(before));
            if before == Some(&".") {
                self.methods.push((*word).to_owned());
            } else if before != Some(&"::") {
                let mut path = vec![(*word).to_owned()];
                let mut rest = words.get(index + 1..).unwrap_or_default();
                while let ["::", next, ..] = rest
                    && is_name(next)
                {
                    path.push((*next).to_owned());
                    rest = rest.get(2..).unwrap_or_default();
                }
                self.path(path);
            }
        }
    }
}

fn for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) => list.path.is_ident("cfg") && list.tokens.to_string().trim() == "test",
        _ => false,
    })
}

impl<'ast> Visit<'ast> for Seen {
    fn visit_item(&mut self, item: &'ast Item) {
        let attributes = match item {
            Item::Const(item) => &item.attrs,
            Item::Fn(item) => &item.attrs,
            Item::Impl(item) => &item.attrs,
            Item::Mod(item) => &item.attrs,
            Item::Static(item) => &item.attrs,
            Item::Use(item) => &item.attrs,
            _ => return visit::visit_item(self, item),
        };
        if !for_tests(attributes) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        self.module.push(item.ident.to_string());
        visit::visit_item_mod(self, item);
        self.module.pop();
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        self.tree(&[], &item.tree);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.path(path.segments.iter().map(|segment| segment.ident.unraw().to_string()).collect());
        visit::visit_path(self, path);
    }

    fn visit_expr_method_call(&mut self, call: &'ast ExprMethodCall) {
        self.methods.push(call.method.to_string());
        visit::visit_expr_method_call(self, call);
    }

    fn visit_macro(&mut self, called: &'ast Macro) {
        let text = called.tokens.to_string().replace("::", " :: ").replace('.', " . ");
        let spaced: String = text
            .chars()
            .flat_map(|c| {
                let part = c.is_alphanumeric() || matches!(c, '_' | ':' | '.' | ' ');
                if part { vec![c] } else { vec![' ', c, ' '] }
            })
            .collect();
        self.words(&spaced);
        visit::visit_macro(self, called);
    }
}

/// The files below a folder.
fn files(folder: &Path, found: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files(&path, found)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    Ok(())
}

/// All of the core's files but those of its unit tests: name, module, and what it says.
fn core() -> Vec<(String, Vec<String>, Seen)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/src");
    let mut paths = Vec::new();
    files(&root, &mut paths).unwrap();
    let mut core = Vec::new();
    for path in paths {
        let below = path.strip_prefix(&root).unwrap().with_extension("");
        let mut module: Vec<String> = below.iter().map(|name| name.to_string_lossy().into_owned()).collect();
        if ["mod", "lib"].iter().any(|own| module.last().is_some_and(|last| last == own)) {
            module.pop();
        }
        if !module.iter().any(|name| name == "tests") {
            let file: File = syn::parse_file(&fs::read_to_string(&path).unwrap()).unwrap();
            core.push((format!("core/src/{}.rs", below.display()), module.clone(), see(&file, module)));
        }
    }
    core
}

fn see(file: &File, module: Vec<String>) -> Seen {
    let mut seen = Seen { module, ..Seen::default() };
    seen.visit_file(file);
    seen
}

/// The order that lib.rs draws: from left to right, and what lies below all of it.
fn order() -> (Vec<String>, Vec<String>) {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/src/lib.rs")).unwrap();
    let drawn =
        |mark: &str| text.lines().find(|line| line.starts_with("//!") && line.contains(mark)).unwrap();
    let names = |list: &str, between: &str| list.split(between).map(|name| name.trim().to_owned()).collect();
    let line = drawn(" -> ").trim_start_matches("//!");
    let (_, below) = drawn("below: ").split_once("below: ").unwrap();
    (names(line, "->"), names(below, ","))
}

/// Why a module of layer `from` may not use one of layer `to`.
fn refusal(from: &str, to: &str) -> Option<&'static str> {
    let (line, below) = order();
    let place = |name| line.iter().position(|each| each == name);
    if from == to {
        None
    } else if STRANGERS.contains(&(from, to)) {
        Some("they are never to know each other")
    } else if below.iter().any(|each| each == to) {
        // Of what lies below, the later may use the earlier: signal uses units.
        (from == "units").then_some("units lies below all")
    } else {
        match (place(from), place(to)) {
            (Some(from), Some(to)) if to < from => None,
            (Some(_), Some(_)) => Some("it stands to its right"),
            (None, Some(_)) => Some("it stands above it"),
            _ => Some("lib.rs does not draw both"),
        }
    }
}

#[test]
fn every_module_is_drawn_and_the_line_is_the_designs() {
    let (line, below) = order();
    assert_eq!(
        line,
        ["scenario", "motion", "quantise", "wire", "device", "trace", "analysis", "run"],
        "DESIGN Part C, with `run`, the front, at the end"
    );
    let mut drawn: Vec<String> = line.into_iter().chain(below).collect();
    let mut there: Vec<String> =
        core().into_iter().filter_map(|(_, module, _)| module.first().cloned()).collect();
    drawn.sort();
    there.sort();
    there.dedup();
    assert_eq!(there, drawn);
}

#[test]
fn modules_use_what_stands_to_their_left_and_below() {
    let mut broken = Vec::new();
    for (file, module, seen) in core() {
        let Some(from) = module.first() else { continue };
        for path in &seen.paths {
            if let [root, to, ..] = path.as_slice()
                && root == "crate"
                && to.starts_with(|c: char| c.is_lowercase())
                && let Some(why) = refusal(from, to)
            {
                broken.push(format!("{file}: {from} uses {to}: {why}"));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

fn is_excepted(file: &str, what: &str) -> bool {
    EXCEPTIONS.iter().any(|(where_, which, _)| *where_ == file && *which == what)
}

#[test]
fn no_float_function_of_the_platform_and_nothing_from_outside_is_in_the_core() {
    let mut broken = Vec::new();
    for (file, _, seen) in core() {
        for method in seen.methods {
            let barred = INEXACT.contains(&method.as_str()) || EXACT.contains(&method.as_str());
            if barred && !is_excepted(&file, &method) {
                broken.push(format!("{file}: .{method}(): use libm::{method}"));
            }
        }
        for path in seen.paths {
            let text = path.join("::");
            let names: Vec<&str> = path.iter().map(String::as_str).collect();
            match names.as_slice() {
                ["f32" | "f64", function, ..] if INEXACT.contains(function) || EXACT.contains(function) => {
                    broken.push(format!("{file}: {text}: use libm"));
                }
                ["std", module, ..] if OUTSIDE.contains(module) && !is_excepted(&file, module) => {
                    broken.push(format!("{file}: {text}: the core has no such thing"));
                }
                names if names.iter().any(|name| UNORDERED.contains(name)) => {
                    broken.push(format!("{file}: {text}: its order differs from run to run; use a BTreeMap"));
                }
                _ => {}
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

/// What a package's manifest has between `[dependencies]` and the next section.
fn dependencies(package: &str) -> Vec<String> {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(package).join("Cargo.toml");
    let text = fs::read_to_string(manifest).unwrap();
    let lines = text.lines().skip_while(|line| *line != "[dependencies]").skip(1);
    let lines = lines.take_while(|line| !line.starts_with('['));
    lines.filter(|line| !line.is_empty()).map(str::to_owned).collect()
}

#[test]
fn firmware_knows_the_registers_alone_and_they_know_nothing() {
    assert_eq!(dependencies("registers"), Vec::<String>::new());
    assert_eq!(dependencies("firmware"), ["stepscope-registers.workspace = true"]);
    for package in ["registers", "firmware"] {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(package).join("src/lib.rs");
        let text = fs::read_to_string(root).unwrap();
        assert!(text.contains("#![no_std]") && !text.contains("extern crate"), "{package} needs nothing");
    }
}

#[test]
fn clippy_refuses_every_inexact_function_in_all_crates() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../clippy.toml")).unwrap();
    for function in INEXACT {
        for float in ["f32", "f64"] {
            let path = format!("{float}::{function}");
            assert!(text.contains(&format!("path = \"{path}\"")), "clippy.toml does not disallow {path}");
        }
    }
}

#[test]
fn the_order_refuses_what_stands_to_the_right_and_who_must_not_meet() {
    let rows = [
        ("motion", "scenario", None),
        ("device", "units", None),
        ("run", "analysis", None),
        ("signal", "units", None),
        ("motion", "device", Some("it stands to its right")),
        ("device", "motion", Some("they are never to know each other")),
        ("signal", "trace", Some("it stands above it")),
        ("units", "signal", Some("units lies below all")),
        ("device", "plant", Some("lib.rs does not draw both")),
    ];
    for (from, to, expected) in rows {
        assert_eq!(refusal(from, to), expected, "{from} uses {to}");
    }
}

/// The tests above are only as good as what they see.
#[test]
fn a_path_is_seen_wherever_it_stands_outside_of_tests() {
    let file = syn::parse_file(
        r#"
        use crate::{a::{b, c as d}, e};
        use super::super::f::g;
        fn one() -> crate::h::I { crate::j::k(1.0_f64.sin()) }
        macro_rules! two { ($x:expr) => { $crate::l::m($x.cos()) }; }
        fn three() { assert!(crate::n::o().tan() > super::p::q()); }
        mod inner { use super::super::super::r::s; }
        #[cfg(test)] mod tests { use crate::t; }
        #[cfg(test)] fn four() { crate::u::v(); }
        #[cfg(not(test))] use crate::w::x;
        "#,
    );
    let seen = see(&file.unwrap(), vec!["device".into(), "plan".into()]);
    let mut found: Vec<String> = seen
        .paths
        .iter()
        .filter(|path| path[0] == "crate" && path.len() > 1)
        .map(|path| path[1..].join("::"))
        .collect();
    found.sort();
    let expected =
        ["a::b", "a::c", "device::p::q", "e", "f::g", "h::I", "j::k", "l::m", "n::o", "r::s", "w::x"];
    assert_eq!(found, expected);
    assert_eq!(seen.methods, ["sin", "cos", "tan"]);
}
