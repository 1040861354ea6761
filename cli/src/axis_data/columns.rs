//! Columns of equal length as CSV, as JSON, or as a structured array of NumPy.

use clap::ValueEnum;
use serde_json::Value;
use std::io::{self, Write};

/// Of a NumPy file: its magic, version and the header's length.
const BYTES_BEFORE_HEADER: usize = 10;

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Format {
    /// Table with a header
    Csv,
    /// One object with a list per column
    Json,
    /// Structured array of NumPy, with a field per column
    Npy,
}

pub(super) struct Columns {
    /// What is not a column; only JSON has it.
    pub(super) facts: Vec<(&'static str, Value)>,
    pub(super) columns: Vec<(&'static str, Values)>,
}

pub(super) enum Values {
    Cycles(Vec<u64>),
    /// +1 and -1.
    Directions(Vec<i8>),
    Numbers(Vec<f64>),
}

impl Values {
    const fn len(&self) -> usize {
        match self {
            Self::Cycles(values) => values.len(),
            Self::Directions(values) => values.len(),
            Self::Numbers(values) => values.len(),
        }
    }

    /// Empty beyond the last row, and for a number that is not finite in JSON.
    fn write_text(&self, row: usize, none: &str, out: &mut impl Write) -> io::Result<()> {
        match self {
            Self::Cycles(values) => values.get(row).map_or(Ok(()), |value| write!(out, "{value}")),
            Self::Directions(values) => values.get(row).map_or(Ok(()), |value| write!(out, "{value}")),
            Self::Numbers(values) => match values.get(row) {
                Some(value) if value.is_finite() => write!(out, "{value}"),
                _ => out.write_all(none.as_bytes()),
            },
        }
    }

    const fn numpy_type(&self) -> &'static str {
        match self {
            Self::Cycles(_) => "<i8",
            Self::Directions(_) => "|i1",
            Self::Numbers(_) => "<f8",
        }
    }

    fn write_binary(&self, row: usize, out: &mut impl Write) -> io::Result<()> {
        match self {
            Self::Cycles(values) => {
                values.get(row).map_or(Ok(()), |value| out.write_all(&value.to_le_bytes()))
            }
            Self::Directions(values) => {
                values.get(row).map_or(Ok(()), |value| out.write_all(&value.to_le_bytes()))
            }
            Self::Numbers(values) => {
                values.get(row).map_or(Ok(()), |value| out.write_all(&value.to_le_bytes()))
            }
        }
    }
}

impl Columns {
    pub(super) fn write(&self, format: Format, out: &mut impl Write) -> io::Result<()> {
        match format {
            Format::Csv => self.write_csv(out),
            Format::Json => self.write_json(out),
            Format::Npy => self.write_npy(out),
        }
    }

    fn rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, values)| values.len())
    }

    fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        let names: Vec<&str> = self.columns.iter().map(|(name, _)| *name).collect();
        writeln!(out, "{}", names.join(","))?;
        for row in 0..self.rows() {
            for (index, (_, values)) in self.columns.iter().enumerate() {
                if index > 0 {
                    out.write_all(b",")?;
                }
                values.write_text(row, "", out)?;
            }
            out.write_all(b"\n")?;
        }
        Ok(())
    }

    /// Written value by value: a tree of millions of values would need many times the memory.
    fn write_json(&self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(b"{")?;
        for (name, value) in &self.facts {
            write!(out, "\n  \"{name}\": {value},")?;
        }
        for (index, (name, values)) in self.columns.iter().enumerate() {
            write!(out, "{}\n  \"{name}\": [", if index > 0 { "," } else { "" })?;
            for row in 0..values.len() {
                if row > 0 {
                    out.write_all(b", ")?;
                }
                values.write_text(row, "null", out)?;
            }
            out.write_all(b"]")?;
        }
        out.write_all(b"\n}\n")
    }

    /// Format version 1.0 of NumPy: a header padded to a multiple of 64 bytes, then the rows.
    fn write_npy(&self, out: &mut impl Write) -> io::Result<()> {
        let fields =
            self.columns.iter().map(|(name, values)| format!("('{name}', '{}')", values.numpy_type()));
        let fields: Vec<String> = fields.collect();
        let mut header = format!(
            "{{'descr': [{}], 'fortran_order': False, 'shape': ({},), }}",
            fields.join(", "),
            self.rows()
        );
        while !(BYTES_BEFORE_HEADER + header.len() + 1).is_multiple_of(64) {
            header.push(' ');
        }
        header.push('\n');
        let length = u16::try_from(header.len()).map_err(io::Error::other)?;
        out.write_all(b"\x93NUMPY\x01\x00")?;
        out.write_all(&length.to_le_bytes())?;
        out.write_all(header.as_bytes())?;
        for row in 0..self.rows() {
            self.columns.iter().try_for_each(|(_, values)| values.write_binary(row, out))?;
        }
        Ok(())
    }
}
