//! Reads sessions of sigrok and PulseView (`.sr`): a zip with metadata and samples in pieces.
//!
//! ```text
//! version      2
//! metadata     [device 1]  samplerate=24 MHz  capturefile=logic-1  unitsize=1  probe1=STEP  probe2=DIR
//! logic-1-1    samples of `unitsize` bytes, the lowest first; probe n is bit n - 1
//! logic-1-2    …
//! ```
//!
//! Samples are unpacked piece by piece and not stored: a session may unpack to a thousand times its size.

mod metadata;
mod samples;

use super::{
    reading::{ReadError, Reading},
    recorder::{Names, Recorder, grouped, quoted},
    source::Source,
};
use flate2::read::DeflateDecoder;
use metadata::Metadata;
use rawzip::{CompressionMethod, ZipArchive, ZipArchiveEntryWayfinder};
use samples::SampleStream;
use std::io::{BufRead, Read, Seek};

/// 64 channels need less than 10 kB.
const MAX_METADATA: u64 = 1 << 20;
/// A piece of samples usually has 4 MB.
const MAX_FILES: usize = 65_536;
/// 3 h of 8 channels at 24 MHz.
const MAX_UNPACKED: u64 = 1 << 38;
const LOCAL_HEADER: u64 = 30;
const BUFFER: usize = 1 << 16;

struct Packed {
    at: ZipArchiveEntryWayfinder,
    method: CompressionMethod,
}

#[derive(Default)]
struct Directory {
    metadata: Option<Packed>,
    has_version: bool,
    pieces: Vec<(String, Packed)>,
    /// The capture is Saleae Logic 2's.
    saleae: bool,
    folder: Option<String>,
    /// First byte of each file, and the earliest byte of the next.
    ranges: Vec<(u64, u64)>,
}

pub(super) fn read<R: BufRead + Seek>(source: Source<'_, R>, mut recorder: Recorder) -> Reading {
    let (input, watch) = source.into_parts();
    let error = whole(input, watch, &mut recorder).err().map(ReadError::whole);
    Reading { capture: recorder.finish(), error }
}

fn whole<R: BufRead + Seek>(
    input: R,
    watch: &mut dyn FnMut(u64) -> bool,
    recorder: &mut Recorder,
) -> Result<(), String> {
    let mut buffer = vec![0; rawzip::RECOMMENDED_BUFFER_SIZE];
    let archive = ZipArchive::from_seekable(input, &mut buffer).map_err(|error| {
        format!("the zip's directory cannot be read ({error}); the file is not whole: copy it again")
    })?;
    let directory = directory(&archive)?;
    let packed = directory.metadata.as_ref().ok_or_else(|| match &directory.folder {
        Some(folder) => format!(
            "“metadata” is in the folder {} of the zip; in a session of sigrok (.sr) it is at the top: zip the files without the folder",
            quoted(folder.as_bytes())
        ),
        None if directory.saleae => "a capture of Saleae Logic 2; export it as CSV (File, Export Data)".into(),
        None => "a zip without “metadata”; a session of sigrok (.sr) has it".into(),
    })?;
    apart(directory.ranges)?;
    let mut text = Vec::new();
    open(&archive, packed)?
        .take(MAX_METADATA)
        .read_to_end(&mut text)
        .map_err(|error| format!("“metadata” cannot be read: {error}"))?;
    let metadata = Metadata::parse(&String::from_utf8_lossy(&text))?;
    if !metadata.analog.is_empty() {
        recorder.leave_out(format!("analog channels: {}", names(&metadata.analog).to_text()));
    }
    if metadata.devices > 1 {
        recorder.leave_out("all devices but the first");
    }
    recorder.capture.timebase = metadata.timebase();
    let mut stream = SampleStream::new(&metadata, recorder, watch)?;
    let mut buffer = vec![0; BUFFER];
    let pieces = in_order(directory.pieces, &metadata.capturefile)?;
    let unpacked =
        pieces.iter().fold(0_u64, |sum, (_, packed)| sum.saturating_add(packed.at.uncompressed_size_hint()));
    if unpacked > MAX_UNPACKED {
        return Err(format!(
            "the samples unpack to {} bytes; at most {} are read: record a shorter time, or at a lower rate",
            grouped(unpacked),
            grouped(MAX_UNPACKED)
        ));
    }
    for (name, packed) in pieces {
        let mut piece = open(&archive, &packed)?;
        loop {
            let count =
                piece.read(&mut buffer).map_err(|error| format!("“{name}” cannot be unpacked: {error}"))?;
            if count == 0 {
                break;
            }
            stream.take(buffer.get(..count).unwrap_or_default())?;
        }
        stream.unpacked(packed.at.compressed_size_hint());
    }
    stream.finish()
}

fn names(list: &[String]) -> Names {
    let mut names = Names::new();
    list.iter().for_each(|name| names.add(name));
    names
}

fn directory<R: rawzip::ReaderAt>(archive: &ZipArchive<R>) -> Result<Directory, String> {
    let mut directory = Directory::default();
    let mut buffer = vec![0; rawzip::MAX_CENTRAL_DIRECTORY_RECORD_SIZE];
    let mut entries = archive.entries(&mut buffer);
    loop {
        let entry =
            entries.next_entry().map_err(|error| format!("the zip's directory cannot be read: {error}"))?;
        let Some(entry) = entry else { return Ok(directory) };
        let file_path = entry.file_path();
        let raw_name: &[u8] = file_path.as_ref();
        let name = String::from_utf8_lossy(raw_name).into_owned();
        let packed = Packed { at: entry.wayfinder(), method: entry.compression_method() };
        if directory.ranges.len() >= MAX_FILES {
            return Err(format!("more than {MAX_FILES} files in the zip; record a shorter time"));
        }
        let start = entry.local_header_offset();
        let end = start
            .checked_add(LOCAL_HEADER + raw_name.len() as u64)
            .and_then(|data| data.checked_add(entry.compressed_size_hint()));
        directory.ranges.push((start, end.ok_or("a file of the zip ends beyond any file")?));
        match name.as_str() {
            "metadata" if directory.metadata.is_some() => return Err(two(&name)),
            "version" if directory.has_version => return Err(two(&name)),
            "version" => directory.has_version = true,
            "metadata" => directory.metadata = Some(packed),
            name if name.ends_with("/metadata") => {
                directory.folder = name.strip_suffix("metadata").map(Into::into)
            }
            "meta.json" => directory.saleae = true,
            name if name.starts_with("analog-") || name.len() > 64 => {}
            _ => directory.pieces.push((name, packed)),
        }
    }
}

fn two(name: &str) -> String {
    format!("the zip has two files named “{name}”; save the session again")
}

/// Overlapping files could unpack to any size.
fn apart(mut ranges: Vec<(u64, u64)>) -> Result<(), String> {
    ranges.sort_unstable();
    if ranges.windows(2).any(|pair| matches!(pair, [(_, end), (start, _)] if start < end)) {
        return Err(
            "files of the zip overlap; it is damaged or made to fill a disk: save the session again".into()
        );
    }
    Ok(())
}

/// `logic-1-1`, `logic-1-2`, …, or `logic-1` alone.
fn in_order(pieces: Vec<(String, Packed)>, capturefile: &str) -> Result<Vec<(String, Packed)>, String> {
    let number = |name: &str| match name.strip_prefix(capturefile)? {
        "" => Some(0),
        rest => rest.strip_prefix('-').and_then(|digits| super::decimal::whole(digits.as_bytes())),
    };
    let numbered = pieces.into_iter().filter_map(|(name, packed)| number(&name).map(|at| (at, name, packed)));
    let mut numbered: Vec<(u64, String, Packed)> = numbered.collect();
    numbered.sort_by_key(|(at, ..)| *at);
    if let Some(pair) =
        numbered.windows(2).find(|pair| !matches!(pair, [(one, ..), (next, ..)] if one + 1 == *next))
        && let [(_, one, _), (_, next, _)] = pair
    {
        return Err(format!(
            "after “{one}” comes “{next}”; a piece of the samples is missing or there twice"
        ));
    }
    if numbered.is_empty() {
        return Err(format!("the session has no samples (“{capturefile}-1”); record again"));
    }
    Ok(numbered.into_iter().map(|(_, name, packed)| (name, packed)).collect())
}

/// Checks the CRC at the end of the file.
fn open<'a, R: rawzip::ReaderAt>(
    archive: &'a ZipArchive<R>,
    packed: &Packed,
) -> Result<Box<dyn Read + 'a>, String> {
    let entry = archive
        .get_entry(packed.at)
        .map_err(|error| format!("a file of the zip cannot be found: {error}"))?;
    Ok(match packed.method {
        CompressionMethod::STORE => Box::new(entry.verifying_reader(entry.reader())),
        CompressionMethod::DEFLATE => Box::new(entry.verifying_reader(DeflateDecoder::new(entry.reader()))),
        other => {
            return Err(format!(
                "a file of the zip is packed as {other}; sigrok packs by deflate: save it again"
            ));
        }
    })
}
