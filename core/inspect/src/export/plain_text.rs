//! Detects unsafe characters in a name or title.
//!
//! ```
//! use stepscope_inspect::export::plain_text::is_unsafe;
//!
//! assert!("\u{1b}\u{202e}".chars().all(is_unsafe));
//! assert!(!"µs, Zähler".chars().any(is_unsafe));
//! ```

/// Whether a character can steer a terminal, break a line, or reorder text.
pub fn is_unsafe(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}
