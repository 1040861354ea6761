//! Detects the format of a file and reads it.
//!
//! ```text
//! file -> Source: lines or words of a bounded buffer -> reader of the format -> Recorder -> Capture
//! ```
//!
//! A file is read once, front to back (a sigrok session by its directory at the end). Needs memory for the changes
//! plus less than 4 MB.
//!
//! ```
//! use stepscope_capture::read::{Limits, read};
//!
//! let dump = "$timescale 1 us $end $var wire 1 ! STEP $end $enddefinitions $end #0 0! #10 1! #12 0!";
//! let capture = read(std::io::Cursor::new(dump), &Limits::default(), &mut |_| true).capture;
//! assert_eq!(capture.changes.iter().nth(1).map(|change| change.tick), Some(10));
//! ```

pub mod decimal;

mod base;
mod clock;
mod detect;
mod fields;
mod reading;
mod recorder;
mod row;
mod sample_rate;
mod selection;
mod source;
mod times;

mod annotations;
mod dump;
mod hex;
mod hex_table;
mod klipper;
mod levels;
mod log_line;
mod nearest;
mod positions;
mod saleae;
mod session;
mod sigrok;
mod stepscope;
mod vcd;

use crate::capture::{Capture, Format};
use detect::Detected;
use reading::Reader;
use recorder::Recorder;
use source::Source;
use std::io::{BufRead, Seek};

pub use base::Base;
pub use reading::{Limits, ReadError, ReadOptions, Reading};

/// Reads a file of any [`Format`]. `watch` receives the number of bytes read at intervals and cancels by returning `false`.
pub fn read<R: BufRead + Seek>(input: R, limits: &Limits, watch: &mut dyn FnMut(u64) -> bool) -> Reading {
    read_with_options(input, limits, &ReadOptions::default(), watch)
}

/// Reads a file like [`read`]; `options` selects among more than [`MAX_CHANNELS`](crate::capture::MAX_CHANNELS)
/// channels and sets the base of bytes.
///
/// ```
/// use stepscope_capture::read::{Limits, ReadOptions, read_with_options};
///
/// let dump = "$var wire 100 ! bus [99:0] $end $enddefinitions $end #0 b0 ! #1 b1 !";
/// let options = ReadOptions { channels: vec!["bus[99]".to_owned()], ..ReadOptions::default() };
/// let capture = read_with_options(std::io::Cursor::new(dump), &Limits::default(), &options, &mut |_| true).capture;
/// assert_eq!(capture.channels.last().map(|channel| channel.name.as_str()), Some("bus[99]"));
/// ```
pub fn read_with_options<R: BufRead + Seek>(
    input: R,
    limits: &Limits,
    options: &ReadOptions,
    watch: &mut dyn FnMut(u64) -> bool,
) -> Reading {
    let mut source = match Source::open(input, watch) {
        Ok(source) => source,
        Err(message) => return refusal(ReadError::of_file(message)),
    };
    let Detected { format, whole_times, table, skipped_columns } =
        match detect::detect(source.head(), options.base) {
            Ok(found) => found,
            Err(message) => return refusal(ReadError::of_file(message)),
        };
    let mut recorder = Recorder::new(format, limits.max_rows);
    (recorder.requested, recorder.base) = (options.channels.clone(), options.base);
    match format {
        Format::Vcd => {
            let mut reader = vcd::Vcd::new(recorder);
            let error = source.words(|word| reader.take(word));
            ended(reader, error, source.line())
        }
        Format::SigrokSession => session::read(source, recorder),
        Format::SigrokCsv => by_line(source, sigrok::Samples::new(recorder)),
        Format::LevelsCsv | Format::SaleaeCsv | Format::EdgesCsv => {
            by_line(source, levels::LevelsTable::new(recorder, whole_times, skipped_columns))
        }
        Format::SaleaeBytes => by_line(source, saleae::DecodedBytes::new(recorder)),
        Format::Trace => by_line(source, stepscope::TraceText::new(recorder)),
        Format::HexBytes | Format::SerialLog => by_line(source, hex::HexText::new(recorder, table)),
        Format::Annotations => by_line(source, annotations::Annotations::new(recorder)),
        Format::Klipper => by_line(source, klipper::StepCommands::new(recorder)),
        Format::HexDump => by_line(source, dump::HexDump::new(recorder)),
        Format::PositionsCsv => by_line(source, positions::Positions::new(recorder, whole_times)),
        Format::Unknown => refusal(ReadError::of_file(detect::UNKNOWN.into())),
    }
}

fn by_line<R: BufRead>(mut source: Source<'_, R>, mut reader: impl Reader) -> Reading {
    let error = source.lines(|line| reader.take(line));
    ended(reader, error, source.line())
}

/// Reports a missing end only if there was no earlier error.
fn ended(reader: impl Reader, error: Option<ReadError>, line: u64) -> Reading {
    let (capture, missing) = reader.finish();
    let error = error.or_else(|| missing.err().map(|message| ReadError { line, message }));
    Reading { capture, error }
}

const fn refusal(error: ReadError) -> Reading {
    Reading { capture: Capture::new(Format::Unknown), error: Some(error) }
}

#[cfg(test)]
mod tests {
    #[test]
    fn an_incomplete_reading_has_an_error() {
        use crate::read::{Limits, ReadError, read};

        // An incomplete reading has an error; `watch` may cancel it.
        let bytes = "55 AA\n01 xx\n";
        let reading = read(std::io::Cursor::new(bytes), &Limits::default(), &mut |_| true);
        assert_eq!((reading.capture.bytes.len(), reading.error.map(|error| error.line)), (2, Some(2)));
        let canceled = read(std::io::Cursor::new("55 AA\n"), &Limits { max_rows: 1000 }, &mut |_| false);
        assert_eq!(canceled.error.map(|error| error.message).as_deref(), Some(ReadError::CANCELED));
    }
}
