//! Detects characters of a name or title that output must escape.

/// Whether a character can steer a terminal, break a line, or reorder text.
pub fn needs_escape(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}

#[cfg(test)]
mod tests {
    #[test]
    fn controls_and_direction_marks_need_an_escape() {
        use super::needs_escape;

        assert!("\u{1b}\u{202e}".chars().all(needs_escape));
        assert!(!"µs, Zähler".chars().any(needs_escape));
    }
}
