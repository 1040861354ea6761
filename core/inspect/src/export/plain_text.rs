//! Detects unsafe characters in a name or title.

/// Whether a character can steer a terminal, break a line, or reorder text.
pub fn is_unsafe(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}

#[cfg(test)]
mod tests {
    #[test]
    fn controls_and_direction_marks_are_unsafe() {
        use super::is_unsafe;

        assert!("\u{1b}\u{202e}".chars().all(is_unsafe));
        assert!(!"µs, Zähler".chars().any(is_unsafe));
    }
}
