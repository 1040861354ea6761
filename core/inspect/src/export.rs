//! ```
//! use stepscope_inspect::export::source_code::is_name;
//!
//! assert!(is_name("step_times") && !is_name("2 times"));
//! ```

pub mod panel;
pub mod plain_text;
pub mod source_code;
pub mod step_tables;
pub mod tables;
#[cfg(feature = "std")]
pub mod vcd;
