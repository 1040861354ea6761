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

use super::reading::{ReadError, Reading};
use super::recorder::{Names, Recorder, grouped, quoted};
use super::source::Source;
use flate2::read::DeflateDecoder;
use metadata::Metadata;
use rawzip::{CompressionMethod, ZipArchive, ZipArchiveEntryWayfinder};
use samples::SampleStream;
use std::io::{BufRead, Read, Seek};

/// Maximum bytes of metadata; 64 channels need less than 10 kB.
const MAX_METADATA: u64 = 1 << 20;
/// Maximum number of files; each usually has 4 MB of samples.
const MAX_FILES: usize = 65_536;
/// Maximum bytes of unpacked samples: 3 h of 8 channels at 24 MHz.
const MAX_UNPACKED: u64 = 1 << 38;
/// Bytes of the local header of a zip entry, without its name.
const LOCAL_HEADER: u64 = 30;
const BUFFER: usize = 1 << 16;

struct PackedFile {
    at: ZipArchiveEntryWayfinder,
    method: CompressionMethod,
}

#[derive(Default)]
struct Directory {
    metadata: Option<PackedFile>,
    has_version: bool,
    pieces: Vec<(String, PackedFile)>,
    /// The capture is Saleae Logic 2's.
    is_saleae: bool,
    folder: Option<String>,
    /// First byte of each file, and the earliest byte of the next.
    ranges: Vec<(u64, u64)>,
}

pub(super) fn read<R: BufRead + Seek>(source: Source<'_, R>, mut recorder: Recorder) -> Reading {
    let (input, watch) = source.into_parts();
    let error = read_session(input, watch, &mut recorder).err().map(ReadError::of_file);
    Reading { capture: recorder.finish(), error }
}

fn read_session<R: BufRead + Seek>(
    input: R,
    watch: &mut dyn FnMut(u64) -> bool,
    recorder: &mut Recorder,
) -> Result<(), String> {
    let mut buffer = vec![0; rawzip::RECOMMENDED_BUFFER_SIZE];
    let archive = ZipArchive::from_seekable(input, &mut buffer).map_err(|error| {
        format!("the zip's directory cannot be read ({error}); the file is incomplete: copy it again")
    })?;
    let directory = directory(&archive)?;
    let packed = directory.metadata.as_ref().ok_or_else(|| match &directory.folder {
        Some(folder) => format!(
            "“metadata” is in the folder {} of the zip; zip the files of the session (.sr) without the folder",
            quoted(folder.as_bytes())
        ),
        None if directory.is_saleae => "captures of Saleae Logic 2 cannot be read; export the data as CSV (File, Export Data)".into(),
        None => "the zip has no “metadata”; use a session of sigrok (.sr)".into(),
    })?;
    check_ranges(directory.ranges)?;
    let metadata = read_metadata(&archive, packed)?;
    let mut analog = Names::default();
    metadata.analog.iter().for_each(|name| analog.add(name));
    recorder.note_skipped("analog channels", &analog);
    if metadata.devices > 1 {
        recorder.note("skipped devices: all except the first");
    }
    recorder.capture.timebase = metadata.timebase();
    let mut stream = SampleStream::new(&metadata, recorder, watch)?;
    let mut buffer = vec![0; BUFFER];
    let pieces = ordered_pieces(directory.pieces, &metadata.capturefile)?;
    let unpacked =
        pieces.iter().fold(0_u64, |sum, (_, packed)| sum.saturating_add(packed.at.uncompressed_size_hint()));
    if unpacked > MAX_UNPACKED {
        return Err(format!(
            "the samples unpack to {} bytes, more than the maximum of {}; record a shorter time or at a lower rate",
            grouped(unpacked),
            grouped(MAX_UNPACKED)
        ));
    }
    for (name, packed) in pieces {
        let mut piece = open_file(&archive, &packed)?;
        loop {
            let count =
                piece.read(&mut buffer).map_err(|error| format!("“{name}” cannot be unpacked: {error}"))?;
            if count == 0 {
                break;
            }
            stream.feed(buffer.get(..count).unwrap_or_default())?;
        }
        stream.add_packed(packed.at.compressed_size_hint());
    }
    stream.finish()
}

fn read_metadata<R: rawzip::ReaderAt>(
    archive: &ZipArchive<R>,
    file: &PackedFile,
) -> Result<Metadata, String> {
    let mut text = Vec::new();
    open_file(archive, file)?
        .take(MAX_METADATA + 1)
        .read_to_end(&mut text)
        .map_err(|error| format!("“metadata” cannot be read: {error}; save the session again"))?;
    if text.len() as u64 > MAX_METADATA {
        return Err(format!("“metadata” has more than {MAX_METADATA} bytes; save the session again"));
    }
    Metadata::parse(&String::from_utf8_lossy(&text))
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
        let packed = PackedFile { at: entry.wayfinder(), method: entry.compression_method() };
        if directory.ranges.len() >= MAX_FILES {
            return Err(format!("more than {MAX_FILES} files in the zip; record a shorter time"));
        }
        let start = entry.local_header_offset();
        let end = start
            .checked_add(LOCAL_HEADER + raw_name.len() as u64)
            .and_then(|data| data.checked_add(entry.compressed_size_hint()));
        directory.ranges.push((start, end.ok_or("the zip's directory is damaged; save the session again")?));
        match name.as_str() {
            "metadata" if directory.metadata.is_some() => return Err(duplicate_file(&name)),
            "version" if directory.has_version => return Err(duplicate_file(&name)),
            "version" => directory.has_version = true,
            "metadata" => directory.metadata = Some(packed),
            name if name.ends_with("/metadata") => {
                directory.folder = name.strip_suffix("metadata").map(Into::into)
            }
            "meta.json" => directory.is_saleae = true,
            // No piece has such a long name; this limits the memory.
            name if name.starts_with("analog-") || name.len() > 64 => {}
            _ => directory.pieces.push((name, packed)),
        }
    }
}

fn duplicate_file(name: &str) -> String {
    format!("the zip has two files named “{name}”; save the session again")
}

/// Overlapping files could unpack to any size.
fn check_ranges(mut ranges: Vec<(u64, u64)>) -> Result<(), String> {
    ranges.sort_unstable();
    if ranges.windows(2).any(|pair| matches!(pair, [(_, end), (start, _)] if start < end)) {
        return Err("files of the zip overlap; it is damaged or malicious: save the session again".into());
    }
    Ok(())
}

/// `logic-1-1`, `logic-1-2`, …, or `logic-1` alone, which is number 0.
fn ordered_pieces(
    pieces: Vec<(String, PackedFile)>,
    capturefile: &str,
) -> Result<Vec<(String, PackedFile)>, String> {
    let number = |name: &str| match name.strip_prefix(capturefile)? {
        "" => Some(0),
        rest => rest.strip_prefix('-').and_then(|digits| super::decimal::whole(digits.as_bytes())),
    };
    let numbered = pieces.into_iter().filter_map(|(name, packed)| number(&name).map(|at| (at, name, packed)));
    let mut numbered: Vec<(u64, String, PackedFile)> = numbered.collect();
    numbered.sort_by_key(|(at, ..)| *at);
    match numbered.first() {
        None => return Err(format!("the session has no samples (“{capturefile}-1”); record again")),
        Some((2.., first, _)) => {
            return Err(format!(
                "the session begins with “{first}”, so samples are missing; save the session again"
            ));
        }
        Some(_) => {}
    }
    let is_next = |one: u64, next: u64| one > 0 && one.checked_add(1) == Some(next);
    for pair in numbered.windows(2) {
        if let [(at, one, _), (next_at, next, _)] = pair
            && !is_next(*at, *next_at)
        {
            return Err(format!(
                "“{next}” follows “{one}”, so samples are missing or duplicated; save the session again"
            ));
        }
    }
    Ok(numbered.into_iter().map(|(_, name, packed)| (name, packed)).collect())
}

/// Checks the CRC at the end of the file.
fn open_file<'a, R: rawzip::ReaderAt>(
    archive: &'a ZipArchive<R>,
    packed: &PackedFile,
) -> Result<Box<dyn Read + 'a>, String> {
    let entry = archive
        .get_entry(packed.at)
        .map_err(|error| format!("a file of the zip cannot be read: {error}; save the session again"))?;
    Ok(match packed.method {
        CompressionMethod::STORE => Box::new(entry.verifying_reader(entry.reader())),
        CompressionMethod::DEFLATE => Box::new(entry.verifying_reader(DeflateDecoder::new(entry.reader()))),
        other => {
            return Err(format!(
                "a file of the zip is packed as {other}; use deflate: save the session again with sigrok"
            ));
        }
    })
}
