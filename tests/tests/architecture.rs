//! Checks the architecture (DESIGN Part C): the order of the crates, no circular imports of files, and no access to anything
//! that would make results depend on the platform.
//!
//! The source is parsed, without unit tests. Paths are checked everywhere: in `use` lines, expressions, types and macros.
//! Re-exports are followed to the file that declares the item.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs, io,
    path::{Path, PathBuf},
};
use syn::{
    Attribute, ExprMethodCall, File, Ident, Item, ItemMod, ItemUse, Macro, Meta, UseTree, Visibility,
    ext::IdentExt,
    visit::{self, Visit},
};

/// The core's crates in the order of the data: each may use the previous ones.
const ROOMS: &[&str] =
    &["registers", "peripheral", "motion", "plant", "controller", "capture", "scenario", "sim", "inspect"];

/// Functions whose results depend on the platform's math library; `mul_add` is DESIGN A1's fused multiply-add.
const INEXACT: &[&str] = &[
    "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "cos", "cosh", "exp", "exp2",
    "exp_m1", "hypot", "ln", "ln_1p", "log", "log10", "log2", "mul_add", "powf", "powi", "sin", "sin_cos",
    "sinh", "tan", "tanh",
];
/// Exact on every platform, but only in the standard library: the core takes them from libm, too.
const EXACT: &[&str] = &["ceil", "floor", "fract", "round", "round_ties_even", "sqrt", "trunc"];
/// Types whose iteration order differs between runs.
const UNORDERED: &[&str] = &["HashMap", "HashSet", "RandomState"];
/// Clocks, threads, files and similar: none of them decides an edge.
const OUTSIDE: &[&str] = &["env", "fs", "io", "net", "process", "thread", "time"];
/// Exceptions for single files, with the reason.
const EXCEPTIONS: &[(&str, &str, &str)] = &[
    (
        "core/motion/src/lib.rs",
        "sqrt",
        "IEEE 754 leaves a square root no choice of bits, and a test compares them",
    ),
    ("core/inspect/src/export/vcd.rs", "io", "only the trait that bytes are written through"),
    ("core/capture/src/read/mod.rs", "io", "only traits for reading bytes; the caller opens the file"),
    (
        "core/capture/src/read/source.rs",
        "io",
        "only the traits that bytes are read through, and which of their errors pass",
    ),
    (
        "core/capture/src/read/session.rs",
        "io",
        "only the traits that a zip is read through, from its end and unpacked",
    ),
];

/// The modules of a crate that another one may use, if not all of them (DESIGN Part C).
const NARROW: &[(&str, &str, &[&str])] = &[
    // `parameters` is a macro for structs with defaults.
    ("motion", "peripheral", &["parameters", "segment", "units", "signal"]),
    ("plant", "peripheral", &["parameters", "signal", "units"]),
    // They do not depend on each other; the scenario uses both.
    ("plant", "motion", &[]),
];

/// The paths and methods of a file.
#[derive(Default)]
struct Seen {
    /// The module that is being visited, relative to the crate's root.
    module: Vec<String>,
    /// All complete paths; `crate` and `super` are resolved relative to the crate's root, written `crate`.
    paths: Vec<Vec<String>>,
    /// Names of called methods.
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

    /// The tokens of a macro: names, and the text between them.
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

    // The path of a visibility is no use of that module.
    fn visit_visibility(&mut self, _: &'ast Visibility) {}

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
        // Neither here.
        let text = called.tokens.to_string().replace("pub (crate)", "pub");
        let text = text.replace("::", " :: ").replace('.', " . ");
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

/// The files in a folder and its subfolders.
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

/// A module of a crate, from one of its files.
struct Module {
    /// Its file, relative to the project's root.
    file: String,
    /// Path from the crate's root; empty for lib.rs.
    path: Vec<String>,
    seen: Seen,
    /// Its re-exports: the name, and the original path from the module or from `crate`.
    doors: BTreeMap<String, Vec<String>>,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All files of a crate without its unit tests.
fn modules(source: &str) -> Vec<Module> {
    let folder = root().join(source);
    let mut paths = Vec::new();
    files(&folder, &mut paths).unwrap();
    let mut modules = Vec::new();
    for path in paths {
        let below = path.strip_prefix(&folder).unwrap().with_extension("");
        let mut module: Vec<String> = below.iter().map(|name| name.to_string_lossy().into_owned()).collect();
        if ["mod", "lib", "main"].iter().any(|own| module.last().is_some_and(|last| last == own)) {
            module.pop();
        }
        if !module.iter().any(|name| name == "tests") {
            let file: File = syn::parse_file(&fs::read_to_string(&path).unwrap()).unwrap();
            modules.push(Module {
                file: format!("{source}/{}.rs", below.display()),
                path: module.clone(),
                doors: doors(&file),
                seen: see(&file, module),
            });
        }
    }
    modules
}

/// The names that a file re-exports, and their original paths.
fn doors(file: &File) -> BTreeMap<String, Vec<String>> {
    fn tree(before: &[String], tree_: &UseTree, found: &mut BTreeMap<String, Vec<String>>) {
        let with =
            |ident: &Ident| before.iter().cloned().chain([ident.unraw().to_string()]).collect::<Vec<_>>();
        match tree_ {
            UseTree::Path(path) => tree(&with(&path.ident), &path.tree, found),
            UseTree::Name(name) => drop(found.insert(name.ident.unraw().to_string(), with(&name.ident))),
            UseTree::Rename(rename) => {
                drop(found.insert(rename.rename.unraw().to_string(), with(&rename.ident)))
            }
            UseTree::Glob(_) => {}
            UseTree::Group(group) => group.items.iter().for_each(|one| tree(before, one, found)),
        }
    }
    let mut found = BTreeMap::new();
    for item in &file.items {
        if let Item::Use(item) = item
            && !matches!(item.vis, Visibility::Inherited)
        {
            tree(&[], &item.tree, &mut found);
        }
    }
    found
}

fn see(file: &File, module: Vec<String>) -> Seen {
    let mut seen = Seen { module, ..Seen::default() };
    seen.visit_file(file);
    seen
}

/// The module that declares the item of a path in module `from`; `None` outside of the crate.
fn declared<'m>(modules: &'m [Module], from: &[String], path: &[String]) -> Option<&'m Module> {
    let at = |path: &[String]| modules.iter().find(|module| module.path == path);
    let (mut here, mut rest) = match path.split_first()? {
        (first, rest) if first == "crate" => (Vec::new(), rest),
        (first, _) => {
            let child: Vec<String> = from.iter().chain([first]).cloned().collect();
            at(&child)?;
            (from.to_vec(), path)
        }
    };
    // Each re-export leads closer to the declaration.
    for _ in 0..20 {
        let Some((name, after)) = rest.split_first() else { break };
        let child: Vec<String> = here.iter().chain([name]).cloned().collect();
        if at(&child).is_some() {
            (here, rest) = (child, after);
            continue;
        }
        let Some(door) = at(&here)?.doors.get(name) else { break };
        let door: Vec<String> = door.iter().chain(after).cloned().collect();
        return declared(modules, &here, &door);
    }
    at(&here)
}

/// Which files of a crate use which, by index; declaring a child module is no use of it.
fn uses(modules: &[Module]) -> Vec<BTreeSet<usize>> {
    let place = |module: &Module| modules.iter().position(|other| other.path == module.path).unwrap();
    modules
        .iter()
        .map(|module| {
            let opened: BTreeSet<&Vec<String>> = module.doors.values().collect();
            let paths = module.seen.paths.iter().filter(|path| !opened.contains(path));
            let used = paths.filter_map(|path| declared(modules, &module.path, path));
            used.filter(|used| used.path != module.path).map(place).collect()
        })
        .collect()
}

/// A circle through a file, if there is one: its indexes.
fn circle(uses: &[BTreeSet<usize>]) -> Option<Vec<usize>> {
    fn walk(uses: &[BTreeSet<usize>], way: &mut Vec<usize>, done: &mut BTreeSet<usize>) -> bool {
        let Some(&last) = way.last() else { return false };
        for &next in &uses[last] {
            if let Some(first) = way.iter().position(|&at| at == next) {
                way.drain(..first);
                return true;
            }
            if !done.contains(&next) {
                way.push(next);
                if walk(uses, way, done) {
                    return true;
                }
                way.pop();
            }
        }
        done.insert(last);
        false
    }
    let mut done = BTreeSet::new();
    (0..uses.len()).find_map(|start| {
        let mut way = vec![start];
        walk(uses, &mut way, &mut done).then_some(way)
    })
}

/// The crates whose files are checked.
fn sources() -> impl Iterator<Item = String> {
    ROOMS.iter().map(|room| format!("core/{room}/src"))
}

#[test]
fn files_have_no_circular_imports() {
    for source in sources().chain(
        ["bindings/c/src", "cli/src", "wasm/src", "firmware/src", "firmware/controller/src"]
            .map(str::to_owned),
    ) {
        let modules = modules(&source);
        if let Some(way) = circle(&uses(&modules)) {
            let files: Vec<&str> = way.iter().map(|&at| modules[at].file.as_str()).collect();
            panic!("{} -> {}", files.join(" -> "), files[0]);
        }
    }
}

#[test]
fn crates_use_only_crates_to_their_left() {
    for (place, room) in ROOMS.iter().enumerate() {
        let allowed = &ROOMS[..place];
        let rooms = dependencies(&format!("core/{room}")).into_iter().filter_map(|line| {
            let name = line.split(['.', ' ']).next()?.strip_prefix("stepscope-")?.to_owned();
            Some(name)
        });
        for other in rooms {
            assert!(
                allowed.contains(&other.as_str()),
                "{room} uses {other}, which does not stand to its left"
            );
        }
    }
}

#[test]
fn crates_use_only_the_allowed_modules_of_others() {
    for (room, other, allowed) in NARROW {
        for module in modules(&format!("core/{room}/src")) {
            for path in &module.seen.paths {
                if let [first, second, ..] = path.as_slice()
                    && *first == format!("stepscope_{other}")
                {
                    let name = second.as_str();
                    assert!(
                        allowed.contains(&name),
                        "{}: of {other} it may use {allowed:?}, not {name}",
                        module.file
                    );
                }
            }
        }
    }
}

#[test]
fn every_file_named_in_the_documentation_exists() {
    let root = root();
    let own = ["README.md", "CONTRIBUTING.md"].map(|name| root.join(name));
    let folders = ["docs", "docs/how-to"].map(|folder| fs::read_dir(root.join(folder)).unwrap());
    let others = folders.into_iter().flatten().map(|entry| entry.unwrap().path());
    let mut named = 0;
    for document in others.chain(own).filter(|path| path.extension().is_some_and(|found| found == "md")) {
        let text = fs::read_to_string(&document).unwrap();
        for path in text.split('`').skip(1).step_by(2).filter(|words| is_source(words)) {
            named += 1;
            assert!(root.join(path).exists(), "{} names {path}, which is not there", document.display());
        }
    }
    assert!(named > 60, "only {named} paths were found");
}

/// Whether this is the path of one source file or folder.
fn is_source(words: &str) -> bool {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/_-.".contains(&byte);
    words.bytes().all(plain)
        && words.split_once('/').is_some_and(|(first, rest)| {
            ["bindings", "core", "cli", "wasm", "web", "firmware", "tests", "xtask"].contains(&first)
                && !rest.starts_with("pkg")
        })
}

fn is_excepted(file: &str, what: &str) -> bool {
    EXCEPTIONS.iter().any(|(where_, which, _)| *where_ == file && *which == what)
}

#[test]
fn the_core_has_no_platform_floats_and_no_outside_state() {
    let mut broken = Vec::new();
    for Module { file, seen, .. } in sources().flat_map(|source| modules(&source)) {
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

/// The text between `[dependencies]` and the next section of a package's manifest.
fn dependencies(package: &str) -> Vec<String> {
    let text = fs::read_to_string(root().join(package).join("Cargo.toml")).unwrap();
    let lines = text.lines().skip_while(|line| *line != "[dependencies]").skip(1);
    let lines = lines.take_while(|line| !line.starts_with('['));
    lines.filter(|line| !line.is_empty() && !line.starts_with('#')).map(str::to_owned).collect()
}

#[test]
fn firmware_depends_only_on_registers_or_the_controller() {
    assert_eq!(dependencies("core/registers"), Vec::<String>::new());
    assert_eq!(dependencies("firmware"), ["stepscope-registers.workspace = true"]);
    let controller = ["stepscope-controller.workspace = true", "stepscope-peripheral.workspace = true"];
    assert_eq!(dependencies("firmware/controller"), controller, "no scenario, no simulation");
    for package in ["core/registers", "firmware"] {
        let text = fs::read_to_string(root().join(package).join("src/lib.rs")).unwrap();
        assert!(text.contains("#![no_std]") && !text.contains("extern crate"), "{package} needs nothing");
    }
}

#[test]
fn clippy_rejects_every_inexact_function_in_all_crates() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../clippy.toml")).unwrap();
    for function in INEXACT {
        for float in ["f32", "f64"] {
            let path = format!("{float}::{function}");
            assert!(text.contains(&format!("path = \"{path}\"")), "clippy.toml does not disallow {path}");
        }
    }
}

#[test]
fn a_circle_is_found_from_any_of_its_files() {
    let uses = |rows: &[&[usize]]| rows.iter().map(|row| row.iter().copied().collect()).collect::<Vec<_>>();
    assert_eq!(circle(&uses(&[&[1, 2], &[2], &[]])), None);
    assert_eq!(circle(&uses(&[&[1], &[2], &[1]])), Some(vec![1, 2]));
    assert_eq!(circle(&uses(&[&[], &[3], &[0], &[2, 1]])), Some(vec![1, 3]));
}

#[test]
fn a_re_export_is_followed_to_the_file_that_declares() {
    let module = |path: &[&str], text: &str| {
        let file = syn::parse_file(text).unwrap();
        let path: Vec<String> = path.iter().map(ToString::to_string).collect();
        Module { file: path.join("/"), doors: doors(&file), seen: see(&file, path.clone()), path }
    };
    let modules = [
        module(&[], "mod a; mod b; pub use a::{One, inner::Two};"),
        module(&["a"], "pub mod inner; pub struct One;"),
        module(&["a", "inner"], "pub struct Two;"),
        module(&["b"], "use crate::{One, Two as Other}; fn f(_: super::a::inner::Two) {}"),
    ];
    let found: Vec<Vec<usize>> = uses(&modules).into_iter().map(|used| used.into_iter().collect()).collect();
    assert_eq!(found, [vec![], vec![], vec![], vec![1, 2]]);
}

/// The tests above depend on these paths being found.
#[test]
fn every_path_outside_of_tests_is_found() {
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
