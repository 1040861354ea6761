//! Remedies for problems of a recording; the command names options, the page fields.
//!
//! ```
//! use stepscope_inspect::recording::remedy::{Note, Remedy};
//!
//! let note = Note { text: "no bit rate fits".into(), remedy: Some(Remedy::Format("8E1".into())) };
//! assert!(note.remedy.is_some() && Note::from(note.text).remedy.is_none());
//! ```

use alloc::string::String;

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
