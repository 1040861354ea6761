//! Names of tables in source code.

use alloc::{format, string::String};

/// Maximum characters of a name.
const MAX_NAME: usize = 32;
/// Keywords of C (C11 6.4.1), C++ and avr-libc that a name could be.
const KEYWORDS: [&str; 85] = [
    "alignas",
    "alignof",
    "and",
    "asm",
    "auto",
    "bitand",
    "bitor",
    "bool",
    "break",
    "case",
    "catch",
    "char",
    "class",
    "cli",
    "compl",
    "const",
    "constexpr",
    "continue",
    "decltype",
    "default",
    "delete",
    "do",
    "double",
    "else",
    "enum",
    "explicit",
    "export",
    "extern",
    "false",
    "float",
    "for",
    "friend",
    "goto",
    "if",
    "inline",
    "int",
    "long",
    "main",
    "mutable",
    "namespace",
    "new",
    "noexcept",
    "not",
    "nullptr",
    "operator",
    "or",
    "private",
    "progmem",
    "protected",
    "public",
    "register",
    "restrict",
    "reti",
    "return",
    "sei",
    "short",
    "signed",
    "sizeof",
    "static",
    "struct",
    "switch",
    "template",
    "this",
    "throw",
    "true",
    "try",
    "typedef",
    "typeid",
    "typename",
    "typeof",
    "union",
    "unsigned",
    "using",
    "virtual",
    "void",
    "volatile",
    "wchar_t",
    "while",
    "xor",
    "and_eq",
    "not_eq",
    "or_eq",
    "xor_eq",
    "static_assert",
    "thread_local",
];
/// Prefix of the names in `stepscope_walk.h`.
const WALKER_PREFIX: &str = "stepscope";

/// Whether a table may have this name: up to 32 lowercase letters, digits and underscores, starting with a letter.
///
/// # Errors
/// Why not, and what to use instead. Keywords are refused although every identifier adds a suffix to the name, because
/// `name` in a comment or a variable of the firmware would be one.
pub fn check_name(name: &str) -> Result<(), String> {
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if name.len() > MAX_NAME || !name.starts_with(|c: char| c.is_ascii_lowercase()) || !name.chars().all(fits)
    {
        return Err(format!(
            "not a valid name; use up to {MAX_NAME} lower-case letters, digits and underscores after a first letter, such as my_axis"
        ));
    }
    if name.contains("__") || name.ends_with('_') {
        return Err(
            "two underscores in a row are reserved in C++; use single ones between letters, such as my_axis"
                .into(),
        );
    }
    if KEYWORDS.contains(&name) {
        return Err(format!(
            "{name:?} is a keyword of C, C++ or avr-libc; use another name, such as my_axis"
        ));
    }
    if name.starts_with(WALKER_PREFIX) {
        return Err(format!(
            "stepscope_walk.h reserves names that begin with {WALKER_PREFIX:?}; use another name, such as my_axis"
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_keywords_and_names_of_the_walker_are_refused() {
        for (name, expected) in [
            ("axis_0", ""),
            ("turn", ""),
            ("my_axis", ""),
            ("x", ""),
            ("e_1", ""),
            ("extruder", ""),
            ("tool", ""),
            ("stroke", ""),
            ("primary", ""),
            ("is_1", ""),
            ("total_1", ""),
            ("memory_1", ""),
            ("e1_x", ""),
            ("uint32_t", ""),
            ("sigma_1", ""),
            ("stepscope_ticks", "begin with \"stepscope\""),
            ("int", "\"int\" is a keyword"),
            ("sei", "\"sei\" is a keyword"),
            ("class", "\"class\" is a keyword"),
            ("", "not a valid name"),
            ("a-1", "not a valid name"),
            ("_a", "not a valid name"),
            ("Turn", "not a valid name"),
            ("a__b", "two underscores"),
            ("a_", "two underscores"),
        ] {
            let found = check_name(name);
            assert_eq!(found.is_ok(), expected.is_empty(), "{name}: {found:?}");
            assert!(found.err().unwrap_or_default().contains(expected), "{name}");
        }
        assert!(check_name(&"a".repeat(32)).is_ok() && check_name(&"a".repeat(33)).is_err());
    }
}
