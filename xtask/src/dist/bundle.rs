//! Modules that load together, as one script: brotli finds what they share, and a visitor asks once.
//!
//! Each module becomes a function that is called where the module would have been evaluated, and gives what
//! the module exports:
//!
//! ```js
//! const $0 = (() => { …; return { one, two }; })();
//! const $1 = (() => { const { one: first } = $0; …; return {}; })();
//! ```
//!
//! Modules that load when something asks for them are a later bundle, which takes from the first what it has:
//!
//! ```js
//! globalThis.$modules = { 0: $0 };                              // the first
//! const $0 = (() => { const { two } = globalThis.$modules[0]; …; return { show }; })();
//! export const { show } = $0;                                   // the later
//! ```
//!
//! That is the same only where modules don't wait for each other in a circle and don't export what changes:
//! what is otherwise is refused, as is every form of import and export that the page does not use.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context, Result, bail, ensure};
use oxc_allocator::Allocator;
use oxc_ast::ast::{
    Declaration, ExportNamedDeclaration, ImportDeclaration, ImportDeclarationSpecifier, Statement,
    VariableDeclarationKind,
};
use oxc_parser::Parser;
use oxc_span::{GetSpan, SourceType};

/// Where a first bundle keeps the modules that later ones ask for.
const ASKING: &str = "globalThis.$modules";

/// A module on its way into a bundle.
pub(super) struct Module<'a> {
    pub(super) name: &'a str,
    pub(super) text: &'a str,
    /// What the bundle calls the module that a specifier in this text means.
    pub(super) imports: BTreeMap<&'a str, Origin<'a>>,
}

/// Where an import comes from.
#[derive(Clone, Copy)]
pub(super) enum Origin<'a> {
    /// The bundle's module of this number.
    Within(usize),
    /// The module of this number of the bundle that asks for this one.
    Asking(usize),
    /// A module that stays by itself, and its specifier in the bundle.
    Beside(&'a str),
}

/// Which kind of bundle it is to be.
#[derive(Clone, Copy)]
pub(super) enum Role<'a> {
    /// One that a page or a worker begins with; it exports nothing. Bundles that come later find its modules of
    /// these numbers.
    First(&'a BTreeSet<usize>),
    /// One that comes later, when the first asks for it; it exports what its last module does.
    Later,
}

/// The modules, each after all that it imports, as one module.
pub(super) fn bundled(modules: &[Module<'_>], role: Role<'_>) -> Result<String> {
    let mut beside: Vec<&str> = Vec::new();
    let mut bundle = String::new();
    let mut given = Vec::new();
    for (number, module) in modules.iter().enumerate() {
        let body;
        (body, given) = wrapped(module, number, &mut beside).with_context(|| module.name.to_owned())?;
        bundle.push_str(&format!("const ${number} = (() => {{ {body} }})();\n"));
    }
    match role {
        Role::First(asked) if asked.is_empty() => {}
        Role::First(asked) => {
            let modules: String = asked.iter().map(|number| format!("{number}: ${number}, ")).collect();
            bundle.push_str(&format!("{ASKING} = {{ {modules}}};\n"));
        }
        Role::Later => {
            let names: Vec<&str> = given.iter().filter_map(|field| field.split(": ").next()).collect();
            let last = modules.len().saturating_sub(1);
            bundle.push_str(&format!("export const {{ {} }} = ${last};\n", names.join(", ")));
        }
    }
    let imports = beside.iter().enumerate();
    let imports: String =
        imports.map(|(index, specifier)| format!("import * as $$${index} from \"{specifier}\";\n")).collect();
    Ok(imports + &bundle)
}

/// A module's text as a function's, which gives its exports; and these, as fields of an object.
fn wrapped<'a>(
    module: &Module<'a>,
    number: usize,
    beside: &mut Vec<&'a str>,
) -> Result<(String, Vec<String>)> {
    let allocator = Allocator::default();
    let parsed = Parser::new(&allocator, module.text, SourceType::mjs()).parse();
    ensure!(parsed.diagnostics.is_empty(), "is no script");
    let (mut before, mut body, mut exports) = (String::new(), String::new(), Vec::new());
    for statement in &parsed.program.body {
        let text = |start: u32, end: u32| module.text.get(start as usize..end as usize).unwrap_or_default();
        let span = statement.span();
        match statement {
            Statement::ImportDeclaration(import) => {
                let origin = module.imports.get(import.source.value.as_str());
                let from = match *origin.with_context(|| format!("imports {}", import.source.value))? {
                    Origin::Within(other) => {
                        ensure!(other < number, "waits in a circle with {}", import.source.value);
                        format!("${other}")
                    }
                    Origin::Asking(other) => format!("{ASKING}[{other}]"),
                    Origin::Beside(specifier) => {
                        let known = beside.iter().position(|other| *other == specifier);
                        let index = known.unwrap_or_else(|| {
                            beside.push(specifier);
                            beside.len() - 1
                        });
                        format!("$$${index}")
                    }
                };
                before.push_str(&taken(import, &from));
            }
            Statement::ExportNamedDeclaration(export) => {
                exports.extend(given(export)?);
                if let Some(declaration) = &export.declaration {
                    body.push_str(text(declaration.span().start, span.end));
                    body.push('\n');
                }
            }
            Statement::ExportAllDeclaration(_) | Statement::ExportDefaultDeclaration(_) => {
                bail!(
                    "exports in a way that is not bundled: {}",
                    text(span.start, span.end.min(span.start + 60))
                );
            }
            _ => {
                body.push_str(text(span.start, span.end));
                body.push('\n');
            }
        }
    }
    Ok((format!("{before}{body}return {{ {} }};", exports.join(", ")), exports))
}

/// An import as a declaration of what it takes.
fn taken(import: &ImportDeclaration<'_>, from: &str) -> String {
    let mut declarations = String::new();
    for specifier in import.specifiers.iter().flatten() {
        declarations.push_str(&match specifier {
            ImportDeclarationSpecifier::ImportSpecifier(one) => {
                format!("const {{ {}: {} }} = {from};\n", one.imported.name(), one.local.name)
            }
            ImportDeclarationSpecifier::ImportDefaultSpecifier(one) => {
                format!("const {{ default: {} }} = {from};\n", one.local.name)
            }
            ImportDeclarationSpecifier::ImportNamespaceSpecifier(all) => {
                format!("const {} = {from};\n", all.local.name)
            }
        });
    }
    declarations
}

/// What an export gives, as fields of an object.
fn given(export: &ExportNamedDeclaration<'_>) -> Result<Vec<String>> {
    ensure!(export.source.is_none(), "exports what it imports in one breath");
    let mut fields: Vec<String> = export
        .specifiers
        .iter()
        .map(|specifier| format!("{}: {}", specifier.exported.name(), specifier.local.name()))
        .collect();
    match &export.declaration {
        None => {}
        Some(Declaration::VariableDeclaration(variables)) => {
            ensure!(variables.kind == VariableDeclarationKind::Const, "exports a variable that can change");
            let names = variables.declarations.iter().flat_map(|one| one.id.get_binding_identifiers());
            fields.extend(names.map(|name| name.name.to_string()));
        }
        Some(Declaration::FunctionDeclaration(function)) => {
            fields.extend(function.id.iter().map(|name| name.name.to_string()));
        }
        Some(Declaration::ClassDeclaration(class)) => {
            fields.extend(class.id.iter().map(|name| name.name.to_string()));
        }
        Some(_) => bail!("exports a declaration that is no script's"),
    }
    Ok(fields)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn module<'a>(name: &'a str, text: &'a str, imports: &[(&'a str, Origin<'a>)]) -> Module<'a> {
        Module { name, text, imports: imports.iter().copied().collect() }
    }

    #[test]
    fn every_form_of_the_page_keeps_what_it_means() {
        let one = "export const one = 1, two = 2; export async function three() {} export class Four {} \
                   const x = 5; export { x as five };";
        let two = "import { one, two as second } from './one.js'; import * as all from './one.js'; \
                   import init, { draw } from './glue.js'; import './one.js'; init(one, second, all, draw);";
        let modules = [
            module("one.js", one, &[]),
            module(
                "two.js",
                two,
                &[("./one.js", Origin::Within(0)), ("./glue.js", Origin::Beside("./pkg/glue.js"))],
            ),
        ];
        let bundle = bundled(&modules, Role::First(&BTreeSet::from([0]))).unwrap();
        for part in [
            "import * as $$$0 from \"./pkg/glue.js\";",
            "return { one, two, three, Four, five: x };",
            "const { two: second } = $0;",
            "const all = $0;",
            "const { default: init } = $$$0;",
            "const { draw: draw } = $$$0;",
            "init(one, second, all, draw);",
            "globalThis.$modules = { 0: $0, };",
        ] {
            assert!(bundle.contains(part), "{part} in\n{bundle}");
        }
        assert!(!bundle.contains("export"), "{bundle}");
    }

    #[test]
    fn what_comes_later_takes_from_the_first_and_exports() {
        let text = "import { two } from './one.js'; const x = two; export { x as show };";
        let later = [module("three.js", text, &[("./one.js", Origin::Asking(7))])];
        let bundle = bundled(&later, Role::Later).unwrap();
        for part in ["const { two: two } = globalThis.$modules[7];", "export const { show } = $0;"] {
            assert!(bundle.contains(part), "{part} in\n{bundle}");
        }
    }

    #[test]
    fn what_would_not_mean_the_same_is_refused() {
        for (text, expected) in [
            ("export let changes = 1;", "exports a variable that can change"),
            ("export default 1;", "exports in a way that is not bundled: export default 1;"),
            ("export * from './b.js';", "exports in a way that is not bundled"),
            ("export { b } from './b.js';", "exports what it imports in one breath"),
            ("import './a.js';", "waits in a circle with ./a.js"),
            ("import './c.js';", "imports ./c.js"),
        ] {
            let modules = [module("a.js", text, &[("./a.js", Origin::Within(0))])];
            let error = bundled(&modules, Role::First(&BTreeSet::new())).unwrap_err();
            let error = format!("{error:#}");
            assert!(error.starts_with("a.js: ") && error.contains(expected), "{text}: {error}");
        }
    }
}
