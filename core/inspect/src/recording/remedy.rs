//! Remedies for problems of a recording; the command names options, the page fields.

use alloc::string::String;

/// A setting that may solve a problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Remedy {
    BothEdges { motor: u8, channel: String },
    OtherEdge { motor: u8, channel: String, inverted: bool },
    InvertLine { line: &'static str, inverted: bool },
    ChooseLine,
    Format(String),
    Baud,
    BaudOrFormat,
}

/// A note on a recording, with a remedy if there is one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    pub text: String,
    pub remedy: Option<Remedy>,
}

impl From<String> for Note {
    fn from(text: String) -> Self {
        Self { text, remedy: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_from_text_has_no_remedy() {
        assert_eq!(Note::from(String::from("text")).remedy, None);
    }
}
