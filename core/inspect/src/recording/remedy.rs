//! What would help with a recording, for the command and the page to word: one by its options, the other by its fields.
//!
//! ```
//! use stepscope_inspect::recording::remedy::{Note, Remedy};
//!
//! let note = Note { text: "no bit rate fits".into(), remedy: Some(Remedy::Format("8E1".into())) };
//! assert!(note.remedy.is_some() && Note::from(note.text).remedy.is_none());
//! ```

use alloc::string::String;

/// A way to read a recording otherwise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// Count a step on both edges of STEP.
    BothEdges {
        /// The motor.
        motor: u8,
        /// Its channel, as a map names it.
        channel: String,
    },
    /// Count steps where the other edge of STEP is.
    OtherEdge {
        /// The motor.
        motor: u8,
        /// Its channel, as a map names it.
        channel: String,
        /// Whether the channel is to be inverted; else it is no longer to be.
        inverted: bool,
    },
    /// Change the polarity of a line.
    InvertLine {
        /// RX or TX.
        line: &'static str,
        /// Whether the channel is to be inverted; else it is no longer to be.
        inverted: bool,
    },
    /// Choose the channel whose bytes are those of RX.
    ChooseLine,
    /// Decode with another format, such as `8E1`.
    Format(String),
    /// Choose one of several bit rates.
    Baud,
    /// Give the bit rate, or another format.
    BaudOrFormat,
}

/// Something to know about a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// In a sentence.
    pub text: String,
    /// What would help.
    pub remedy: Option<Remedy>,
}

impl From<String> for Note {
    fn from(text: String) -> Self {
        Self { text, remedy: None }
    }
}
