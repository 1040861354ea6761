//! The oracle against the text's own numbers, against itself, and what its random cases reach.

mod reach;
mod same;
mod worked;
