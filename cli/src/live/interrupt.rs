//! Ctrl-C, and a request to end, as something that a session's loop checks.

pub(crate) use crate::interrupt::{count, watch};
