//! Parses the lines that operate a stand-alone controller: buttons, switches, power, a push on the axis (LIVE H2).
//!
//! ```text
//! press start 100ms     press, and release after 100 ms of session time
//! power 0 2s            no power for 2 s
//! 1: limit_max 1        an input of the second controller
//! ```

use std::{fmt, str::FromStr};
use stepscope_core::controller::input::{Change, Signal};
use stepscope_core::peripheral::units::Cycles;

pub(crate) const HELP: &str = "\
press NAME [TIME]     press a button until `release NAME`, or for a time such as 100ms, 2.5s or 200us
release NAME          release a button
NAME 0|1 [TIME]       set any input, permanently or for a time: power 0, estop 1, limit_max 1
push STEPS            move the axis by hand, such as -20, while its windings have no current
wait TIME             delay the lines that follow
1: LINE               do the same with controller 1 (default: controller 0)
help                  print this text and the names of all inputs";

const MAX_SECONDS: f64 = 2_678_400.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Line {
    Empty,
    Help,
    Wait(Span),
    /// Controller, change, and duration if it is not permanent.
    Change(usize, Change, Option<Span>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    seconds: f64,
}

impl Span {
    pub(crate) fn cycles(self, clock_hz: u32) -> Cycles {
        Cycles((self.seconds * f64::from(clock_hz)).round() as u64)
    }
}

impl FromStr for Span {
    type Err = LineError;

    fn from_str(text: &str) -> Result<Self, LineError> {
        let wrong = || LineError::Time(text.to_owned());
        let digits = text.trim_end_matches(char::is_alphabetic);
        let unit = match text.get(digits.len()..) {
            Some("us") => 1e-6,
            Some("ms") => 1e-3,
            Some("s") => 1.0,
            _ => return Err(wrong()),
        };
        let number: f64 = digits.parse().map_err(|_| wrong())?;
        let seconds = number * unit;
        (0.0..=MAX_SECONDS).contains(&seconds).then_some(Self { seconds }).ok_or_else(wrong)
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum LineError {
    Word(String),
    Input(String),
    Level(String),
    Time(String),
    Steps(String),
    /// The words, and the expected number.
    Count(String, &'static str),
}

impl fmt::Display for LineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Word(word) => write!(f, "{word}: unknown word or input; `help` lists them"),
            Self::Input(name) => write!(f, "{name}: unknown input; `help` lists them"),
            Self::Level(text) => write!(f, "{text}: not a level; use 0 or 1"),
            Self::Time(text) => write!(f, "{text}: not a time; use a time such as 100ms, 2.5s or 200us"),
            Self::Steps(text) => write!(f, "{text}: not a number of steps; use a whole number, such as -20"),
            Self::Count(word, usage) => write!(f, "{word}: wrong number of words; use `{usage}`"),
        }
    }
}

fn signal(name: &str) -> Result<Signal, LineError> {
    Signal::by_name(name).ok_or_else(|| LineError::Input(name.to_owned()))
}

fn level(text: &str) -> Result<bool, LineError> {
    match text {
        "0" => Ok(false),
        "1" => Ok(true),
        _ => Err(LineError::Level(text.to_owned())),
    }
}

fn span(text: Option<&&str>) -> Result<Option<Span>, LineError> {
    text.map(|text| text.parse()).transpose()
}

impl FromStr for Line {
    type Err = LineError;

    fn from_str(text: &str) -> Result<Self, LineError> {
        let text = text.split('#').next().unwrap_or_default().trim();
        let (controller, text) = match text.split_once(':') {
            Some((index, rest)) => match index.trim().parse() {
                Ok(index) => (index, rest),
                Err(_) => return Err(LineError::Word(format!("{}:", index.trim()))),
            },
            None => (0, text),
        };
        let words: Vec<&str> = text.split_whitespace().collect();
        let change = |signal, level, held| Self::Change(controller, Change::Level(signal, level), held);
        let count = |word: &str, usage| LineError::Count(word.to_owned(), usage);
        match words.as_slice() {
            [] => Ok(Self::Empty),
            ["help" | "?"] => Ok(Self::Help),
            ["wait", time] => Ok(Self::Wait(time.parse()?)),
            ["wait", ..] => Err(count("wait", "wait 2s")),
            ["press", name, time @ ..] if time.len() < 2 => {
                Ok(change(signal(name)?, true, span(time.first())?))
            }
            ["press", ..] => Err(count("press", "press start 100ms")),
            ["release", name] => Ok(change(signal(name)?, false, None)),
            ["release", ..] => Err(count("release", "release start")),
            ["push", steps] => {
                let steps = steps.parse().map_err(|_| LineError::Steps((*steps).to_owned()))?;
                Ok(Self::Change(controller, Change::Push(steps), None))
            }
            ["push", ..] => Err(count("push", "push -20")),
            [word, rest @ ..] => {
                let signal = Signal::by_name(word).ok_or_else(|| LineError::Word((*word).to_owned()))?;
                match rest {
                    [to] => Ok(change(signal, level(to)?, None)),
                    [to, time] => Ok(change(signal, level(to)?, Some(time.parse()?))),
                    _ => Err(count(word, "power 0` or `power 0 2s")),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level_of(controller: usize, signal: Signal, level: bool, seconds: Option<f64>) -> Line {
        Line::Change(controller, Change::Level(signal, level), seconds.map(|seconds| Span { seconds }))
    }

    #[test]
    fn parses_lines_or_explains_the_error() {
        let rows = [
            ("press start 100ms", level_of(0, Signal::Start, true, Some(0.1))),
            ("press jog_plus", level_of(0, Signal::JogPlus, true, None)),
            ("release jog_plus", level_of(0, Signal::JogPlus, false, None)),
            ("power 0", level_of(0, Signal::Power, false, None)),
            ("  power 0 2.5s # a cut", level_of(0, Signal::Power, false, Some(2.5))),
            ("3: limit_max 1", level_of(3, Signal::LimitMax, true, None)),
            ("1:push -20", Line::Change(1, Change::Push(-20), None)),
            ("wait 250us", Line::Wait(Span { seconds: 250.0 * 1e-6 })),
            ("?", Line::Help),
            ("# a comment", Line::Empty),
            ("", Line::Empty),
        ];
        for (text, line) in rows {
            assert_eq!(text.parse(), Ok(line), "{text}");
        }
        for (text, why) in [
            ("dance", "dance: unknown word or input; `help`"),
            ("press dance", "dance: unknown input"),
            ("press", "use `press start 100ms`"),
            ("press start 1ms 2ms", "use `press start 100ms`"),
            ("power 2", "2: not a level; use 0 or 1"),
            ("power", "use `power 0` or `power 0 2s`"),
            ("press start 100", "100: not a time"),
            ("press start -1s", "-1s: not a time"),
            ("press start NaNs", "NaNs: not a time"),
            ("wait", "use `wait 2s`"),
            ("push much", "much: not a number of steps"),
            ("left: push 2", "left:: unknown word"),
        ] {
            let error = text.parse::<Line>().expect_err(text).to_string();
            assert!(error.contains(why), "{text}: {error}");
        }
    }

    #[test]
    fn rounds_times_to_the_nearest_cycle() {
        for (text, cycles) in
            [("100ms", 1_600_000), ("62.5us", 1000), ("0.03us", 0), ("0s", 0), ("2s", 32_000_000)]
        {
            assert_eq!(text.parse::<Span>().expect(text).cycles(16_000_000), Cycles(cycles), "{text}");
        }
    }
}
