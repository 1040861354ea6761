//! Scripts as they are shipped: comments, spaces and long names gone, what they do the same.

use anyhow::{Result, bail};
use oxc_allocator::Allocator;
use oxc_codegen::{Codegen, CodegenOptions, CommentOptions};
use oxc_minifier::{CompressOptions, MangleOptions, Minifier, MinifierOptions};
use oxc_parser::Parser;
use oxc_span::SourceType;

/// The shorter text of an ES module.
///
/// # Errors
/// If it is no module; `name` says which.
pub(super) fn minified(name: &str, text: &str) -> Result<String> {
    let allocator = Allocator::default();
    let parsed = Parser::new(&allocator, text, SourceType::mjs()).parse();
    if let Some(first) = parsed.diagnostics.iter().next() {
        bail!("{name} is no script: {first}");
    }
    let mut program = parsed.program;
    let options = MinifierOptions {
        mangle: Some(MangleOptions::default()),
        compress: Some(CompressOptions::smallest()),
    };
    let minified = Minifier::new(options).minify(&allocator, &mut program);
    let options = CodegenOptions { comments: CommentOptions::disabled(), ..CodegenOptions::minify() };
    Ok(Codegen::new().with_options(options).with_scoping(minified.scoping).build(&program).code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_long_names_go_and_what_others_see_stays() {
        let text = "/** @typedef {import(\"./types.js\").A} A */\nimport { one } from \"./one.js\";\n\
                    export function twice(number) { /* doubled */ return one * number * 2; }\n";
        let short = minified("a.js", text).unwrap();
        assert!(!short.contains("types.js") && !short.contains("doubled"), "{short}");
        assert!(short.contains("\"./one.js\"") && short.contains("function twice("), "{short}");
        assert!(short.len() < text.len() / 2, "{short}");
    }

    #[test]
    fn a_file_that_is_no_script_is_named() {
        let error = minified("a.js", "let let = 1 +;").unwrap_err().to_string();
        assert!(error.starts_with("a.js is no script: "), "{error}");
    }
}
