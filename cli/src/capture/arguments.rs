//! The arguments of `stepscope capture`.

use super::advice;
use crate::options::{Json, ShowProgress};
use crate::quantity::{ExactMicroseconds, Microseconds, parsed, whole};
use crate::{failure::Failure, motors::NamedMotor, terminal::Escaped, timing};
use clap::{ArgGroup, Args};
use std::path::{Path, PathBuf};
use stepscope_core::capture::{read::Base, uart};
use stepscope_core::inspect::export::vcd::Timescale;
use stepscope_core::inspect::recording::open_options::{OpenError, OpenOptions};

#[derive(Args)]
#[command(group(ArgGroup::new("of_channel").args(["against", "steps"]).multiple(true)))]
pub(crate) struct Arguments {
    /// Recording; `-` reads standard input
    ///
    /// Reads value change dumps; sigrok and PulseView sessions, tables and UART annotations; tables of levels (Saleae,
    /// DSView, WaveForms, Kingst, your own); decoded bytes; hex dumps (hexdump -C, xxd, od); serial logs with times;
    /// Klipper's step commands; tables of times and positions. The command includes two recordings:
    /// recorded-step-table and recorded-late-packet.
    #[arg(value_name = "RECORDING")]
    pub(super) file: PathBuf,
    /// Assign channels to signals, such as STEP0=CH1,DIR0=CH2,EN=!nEN
    ///
    /// `!` inverts a channel; `#0` is the first one. Motors can share a DIR channel (DIR0=DIR,DIR1=DIR). Instead of
    /// STEP0, use DEDGE0 for a driver that steps on both edges, CW0 and CCW0 for one pulse input per direction, or A0
    /// and B0 for a quadrature encoder. By default, a map is proposed from names and behavior, and printed.
    #[arg(long, value_name = "MAP")]
    pub(super) map: Option<String>,
    /// Count steps on both edges of STEP, like DEDGE in a map
    #[arg(long)]
    pub(super) both_edges: bool,
    /// Clock for the conversion of times to cycles, in Hz (default: the file's own)
    #[arg(long, value_name = "HZ", value_parser = whole::<u32>(11..=1_000_000_000))]
    pub(super) clock: Option<u32>,
    /// Sample rate, in Hz, if the file does not contain it
    #[arg(long, value_name = "HZ", value_parser = whole::<u64>(1..=1_000_000_000_000))]
    pub(super) sample_rate: Option<u64>,
    /// Bit rate of RX and TX (default: measured from their pulses)
    #[arg(long, value_name = "BAUD", value_parser = whole::<u32>(1..=1_000_000_000))]
    pub(super) baud: Option<u32>,
    /// Data bits, parity and stop bits of RX and TX, such as 7E1 (default: 8N1)
    #[arg(long, value_name = "FORMAT", value_parser = parsed::<uart::Format>)]
    pub(super) uart: Option<uart::Format>,
    /// Base of decoded bytes: hex, dec, oct or bin (default: detected from the digits)
    #[arg(long, value_name = "BASE", value_parser = parsed::<Base>)]
    pub(super) base: Option<Base>,
    /// Compare with the run of this scenario: a JSON file or a preset's name
    ///
    /// Reports missing, extra and late steps, with exit code 3 if there are any. If no channel has steps, bytes are
    /// compared.
    #[arg(long, value_name = "SCENARIO")]
    pub(super) against: Option<PathBuf>,
    /// Channel to compare, or to write with --steps
    #[arg(long, value_name = "K", default_value_t = 0, requires = "of_channel", value_parser = whole::<u8>(0..=15))]
    pub(super) channel: u8,
    /// Step of the run, from 0, that meets the recording (default: the first common step)
    #[arg(long, value_name = "STEP", requires = "against", value_parser = whole::<usize>(0..=u64::MAX))]
    pub(super) align: Option<usize>,
    /// Maximum error of a step or byte, in us (default: one cycle of the slower clock)
    #[arg(long, value_name = "US", requires = "against")]
    pub(super) within_us: Option<ExactMicroseconds>,
    /// Write the delay of each step or byte (CSV)
    ///
    /// Missing and extra steps or bytes also have rows.
    #[arg(long, value_name = "FILE", requires = "against")]
    pub(super) late: Option<PathBuf>,
    /// Write a scenario that reproduces the recording
    ///
    /// If RX has bytes, the scenario sends them to the controllers of --against. Otherwise it reproduces the steps.
    #[arg(short = 'o', long, alias = "scenario", value_name = "FILE")]
    pub(super) write_scenario: Option<PathBuf>,
    /// Make the scenario from steps even if RX has bytes
    #[arg(long, requires = "write_scenario")]
    pub(super) of_steps: bool,
    /// Maximum error of the scenario's steps, in us; larger errors need fewer segments
    #[arg(long, value_name = "US", requires = "write_scenario")]
    pub(super) error_us: Option<Microseconds>,
    /// Write the step times of a channel (CSV) for `stepscope tables --steps`
    #[arg(long, value_name = "FILE")]
    pub(super) steps: Option<PathBuf>,
    /// Write the bytes of RX and TX (CSV)
    #[arg(long, value_name = "FILE")]
    pub(super) bytes: Option<PathBuf>,
    /// Write the packets of RX and TX with their CRC status and meaning (CSV)
    ///
    /// `stepscope capture` can read the table again.
    #[arg(long, value_name = "FILE")]
    pub(super) packets: Option<PathBuf>,
    /// Write the trace: cycle and levels in hexadecimal, one record per line
    #[arg(long, value_name = "FILE")]
    pub(super) trace: Option<PathBuf>,
    /// Write a value change dump with the names of the signals
    #[arg(long, value_name = "FILE")]
    pub(super) vcd: Option<PathBuf>,
    /// Time unit of the dump: 1, 10 or 100 of s, ms, us, ns, ps or fs
    #[arg(long, value_name = "TIME", default_value = "1ns", requires = "vcd", value_parser = parsed::<Timescale>)]
    pub(super) vcd_timescale: Timescale,
    /// Write a table of the signals (CSV): cycle, time in s, one level per signal
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    #[command(flatten)]
    pub(super) json: Json,
    #[command(flatten)]
    pub(super) show: ShowProgress,
    #[command(flatten)]
    pub(super) named: NamedMotor,
    #[command(flatten)]
    pub(super) timing: timing::Options,
}

impl Arguments {
    pub(super) fn outputs(&self) -> impl Iterator<Item = &Path> {
        [
            &self.late,
            &self.write_scenario,
            &self.steps,
            &self.bytes,
            &self.packets,
            &self.trace,
            &self.vcd,
            &self.csv,
            &self.timing.violations,
        ]
        .into_iter()
        .flatten()
        .map(PathBuf::as_path)
    }

    pub(super) fn open_options(&self) -> OpenOptions {
        OpenOptions {
            map: self.map.clone(),
            clock_hz: self.clock,
            sample_rate_hz: self.sample_rate,
            baud: self.baud,
            both_edges: self.both_edges,
            uart: self.uart.map(|uart| uart.to_string()),
        }
    }

    pub(super) fn name(&self) -> String {
        self.file.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    }

    pub(super) fn open_failure(&self, error: &OpenError) -> Failure {
        let option = match error {
            OpenError::Map(error) => {
                return Failure::Option(format!("--map: {}", Escaped(error.to_string())));
            }
            OpenError::NoSampleRate(_) => " (--sample-rate HZ)".to_owned(),
            OpenError::NoBaud => " (--baud BAUD)".to_owned(),
            OpenError::NoMap { names, example } => {
                format!("; the channels are {}; use a map, such as --map {example}", names.join(", "))
            }
            OpenError::NoRate(_, remedies) => remedies.iter().map(advice::option).collect(),
            _ => String::new(),
        };
        self.invalid(format!("{error}{option}"))
    }

    pub(super) fn invalid(&self, why: impl ToString) -> Failure {
        Failure::Invalid(self.file.clone(), why.to_string())
    }
}
