//! Tests of the model: the text's numbers, agreement with itself, and the coverage of its random cases.

mod reach;
mod same;
mod worked;
