//! Reads `web/_headers`, which sets the headers per path.
//!
//! The format is that of static hosts: a path, its headers indented below it, `#` for comments. Only exact paths and
//! a `*` at the end are accepted: other patterns might mean different things on different hosts.

use anyhow::{Context, Result, bail};
use axum::http::{HeaderName, HeaderValue};

pub(crate) const FILE: &str = "_headers";

#[derive(Debug, Default)]
pub(crate) struct Headers {
    rules: Vec<Rule>,
}

#[derive(Debug)]
struct Rule {
    path: String,
    headers: Vec<(HeaderName, HeaderValue)>,
}

impl Rule {
    fn covers(&self, path: &str) -> bool {
        match self.path.strip_suffix('*') {
            Some(prefix) => path.starts_with(prefix),
            None => path == self.path,
        }
    }
}

impl Headers {
    pub(crate) fn parse(text: &str) -> Result<Self> {
        let mut rules: Vec<Rule> = Vec::new();
        for (index, line) in text.lines().enumerate() {
            let content = line.trim();
            if content.is_empty() || content.starts_with('#') {
                continue;
            }
            let at = || format!("_headers, line {}: {content}", index + 1);
            if !line.starts_with(char::is_whitespace) {
                let prefix = content.strip_suffix('*').unwrap_or(content);
                if !content.starts_with('/') || prefix.contains(['*', ':', ' ']) {
                    bail!("{}: not a path; use one such as /pkg/app.js, or a prefix such as /pkg/*", at());
                }
                rules.push(Rule { path: content.to_owned(), headers: Vec::new() });
                continue;
            }
            let rule = rules.last_mut().with_context(|| format!("{}: a header before any path", at()))?;
            let (name, value) = content
                .split_once(':')
                .with_context(|| format!("{}: not a header; use `Name: value`", at()))?;
            rule.headers
                .push((name.trim().parse().with_context(at)?, value.trim().parse().with_context(at)?));
        }
        Ok(Self { rules })
    }

    /// The headers of a reply for `path`, from earlier rules first.
    pub(crate) fn of(&self, path: &str) -> impl Iterator<Item = (&HeaderName, &HeaderValue)> {
        let covering = self.rules.iter().filter(move |rule| rule.covers(path));
        covering.flat_map(|rule| rule.headers.iter().map(|(name, value)| (name, value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, path: &str, expected: &[&str]) {
        let headers = Headers::parse(text).unwrap();
        let given: Vec<String> =
            headers.of(path).map(|(name, value)| format!("{name}: {}", value.to_str().unwrap())).collect();
        assert_eq!(given, expected, "{path} under\n{text}");
    }

    #[test]
    fn a_rule_covers_its_path_or_its_prefix() {
        let text = "# all\n/*\n  X-One: a; b:c\n\n/pkg/*\n\tX-Two: 2\n/a.js\n  X-Three: 3\n";
        check(text, "/", &["x-one: a; b:c"]);
        check(text, "/pkg/a.js", &["x-one: a; b:c", "x-two: 2"]);
        check(text, "/a.js", &["x-one: a; b:c", "x-three: 3"]);
        check("", "/", &[]);
    }

    #[test]
    fn ambiguous_lines_are_refused_with_their_number() {
        for (text, expected) in [
            ("  X: 1", "line 1: X: 1: a header before any path"),
            ("/*\n  no colon", "line 2: no colon: not a header; use `Name: value`"),
            ("/*\n  ! X", "line 2: ! X: not a header; use `Name: value`"),
            ("/*\n  A b: 1", "line 2: A b: 1"),
            ("/a/*/b\n", "line 1: /a/*/b: not a path; use"),
            ("/:page\n", "line 1: /:page: not a path; use"),
            ("example/*\n", "line 1: example/*: not a path; use"),
        ] {
            let error = format!("{:#}", Headers::parse(text).unwrap_err());
            assert!(error.contains(expected), "{text:?} gave {error:?}, not {expected:?}");
        }
    }

    fn own(name: &str) -> String {
        let text = std::fs::read_to_string(crate::root().join("web/_headers")).unwrap();
        let headers = Headers::parse(&text).unwrap();
        let values: Vec<_> = headers.of("/").filter(|(given, _)| given.as_str() == name).collect();
        assert_eq!(values.len(), 1, "{name} must be in web/_headers exactly once");
        values[0].1.to_str().unwrap().to_owned()
    }

    #[test]
    fn the_headers_of_the_page_have_the_required_values() {
        let policy = own("content-security-policy");
        assert!(policy.starts_with("default-src 'none'; "), "{policy}");
        assert!(policy.contains("; script-src 'self' 'wasm-unsafe-eval'; "), "{policy}");
        assert!(policy.ends_with("; frame-ancestors 'none'"), "{policy}");
        assert_eq!(own("permissions-policy"), "serial=(self)");
        assert_eq!(own("referrer-policy"), "no-referrer");
        assert_eq!(own("x-content-type-options"), "nosniff");
    }

    #[test]
    fn the_page_and_the_headers_state_one_policy() {
        let Ok(page) = std::fs::read_to_string(crate::root().join("web/index.html")) else {
            return;
        };
        // Browsers ignore frame-ancestors in a meta tag and warn about it.
        let policy = own("content-security-policy").replace("; frame-ancestors 'none'", "");
        let tag = format!("<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\"");
        let page = page.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(page.contains(&tag), "web/index.html must contain the policy of web/_headers:\n{tag}>");
    }
}
