//! Derives a channel's signal and motor from its name.
//!
//! ```text
//! signal   STEP STP PUL PULSE PLS PU, DIR DIRECTION DR SIGN, CW, CCW, EN ENA ENABLE, RX RXD, TX TXD, DE
//! motor    the other words: X_STEP, STEP (Y axis), stepper_z1.step_pin, motor1_step, stepgen.0.step, RA_STEP
//! neither  step_count, LED, BUSY
//! ```

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Step,
    Dir,
    Cw,
    Ccw,
    /// STEP only if there is a DIR: many clocks have this name.
    Clock,
    A,
    B,
    En,
    Rx,
    Tx,
    De,
}

/// A signal in a channel's name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SignalName {
    pub(crate) kind: Kind,
    pub(crate) inverted: bool,
    /// The negative line of a pair, as in `PUL-`.
    pub(crate) is_negative: bool,
    /// The name also contains a word for pulses, as `PUL/CW` does.
    pub(crate) is_pulse: bool,
    /// Identifies the motor: a number, a letter, a word, or nothing.
    pub(crate) axis: String,
    /// The part of the name before its last point.
    pub(crate) scope: String,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Meaning {
    Signal(SignalName),
    /// Not a signal of a motor or its line.
    Other,
    Unknown,
}

/// Words of each kind of signal.
const WORDS: [(Kind, &str); 9] = [
    (Kind::Step, "STEP STEPS STP PUL PULS PULSE PULSES PLS PU SCHRITT"),
    (Kind::Dir, "DIR DIRECTION DR SIGN RICHTUNG"),
    (Kind::Cw, "CW UP"),
    (Kind::Ccw, "CCW DOWN DN"),
    (Kind::Clock, "CLK CLOCK CP TAKT"),
    (Kind::En, "EN ENA ENABLE ENN NEN NENABLE FREIGABE"),
    (Kind::Rx, "RX RXD"),
    (Kind::Tx, "TX TXD"),
    (Kind::De, "DE TXEN"),
];
const ACTIVE_LOW: [&str; 3] = ["ENN", "NEN", "NENABLE"];
/// UP and DOWN mean CW and CCW only if all other words name an axis or are in [`NOISE`].
const UP_DOWN: [&str; 3] = ["UP", "DOWN", "DN"];
/// Words of encoder inputs, and words that mark `A` and `B` as encoder inputs.
const PHASES: [(Kind, &str); 2] = [(Kind::A, "ENCA PHA PHASEA QA"), (Kind::B, "ENCB PHB PHASEB QB")];
const ENCODER: [&str; 6] = ["ENC", "ENCODER", "QUAD", "QEI", "PHASE", "PH"];
/// Words that identify a motor only with a number: `MOTOR1`.
const NOISE: [&str; 30] = [
    "AXIS", "MOTOR", "MOT", "STEPPER", "STEPGEN", "JOINT", "DRIVER", "DRV", "EXTRUDER", "M", "J", "T", "PIN",
    "BIT", "PORT", "OUT", "OUTPUT", "SIGNAL", "SIG", "LINE", "P", "PLUS", "N", "MINUS", "O", "I", "ALL",
    "BOTH", "COMMON", "SHARED",
];

/// Finds a word in a list.
fn find(list: &[(Kind, &'static str)], wanted: &str) -> Option<(&'static str, Kind)> {
    let find =
        |(kind, words): &(Kind, &'static str)| Some((words.split(' ').find(|word| *word == wanted)?, *kind));
    list.iter().find_map(find)
}

/// Signals in names of one word: `FLSTEP`, `FLDIR`.
const JOINED: [(&str, Kind); 3] = [("STEP", Kind::Step), ("DIRECTION", Kind::Dir), ("DIR", Kind::Dir)];
/// Prefixes of pin or probe numbers.
const PINS: [&str; 16] = [
    "D", "CH", "CHANNEL", "DIO", "GPIO", "IO", "PIN", "PROBE", "PA", "PB", "PC", "PD", "PE", "PF", "PG",
    "LOGIC",
];
/// Words of names that are not signals.
const OTHERS: &str = "ACK ALARM ALM BUSY CHANGE CHANGED CNT COUNT COUNTER CS DELAY DIAG DONE END ENDSTOP ERR ERROR FAULT FLT \
    FREQ HOME IDX INDEX INT INTERVAL IRQ LAST LED LEN LENGTH LIMIT MICRO MICROSTEP MISO MODE MOSI NEXT NUM \
    PERIOD POS POSITION PREV RATE READY REQ RESET RST SCK SCL SCLK SDA SIZE SLEEP SPEED STALL STATE TOTAL \
    TRIG TRIGGER VALID WIDTH PWM";
/// Letters of axes.
pub(crate) const AXES: &str = "XYZABCUVWE";

/// A word of a name that means a signal.
struct SignalWord {
    /// The word without the axis.
    word: &'static str,
    kind: Kind,
    /// The axis in the same word, as in `XSTEP` and `STEP1`.
    axis: Option<String>,
}

/// The words of a name: those that mean signals, and the others.
#[derive(Default)]
struct Words<'w> {
    signals: Vec<(Kind, &'static str)>,
    others: Vec<&'w str>,
    axis: Option<String>,
    /// A signal's word begins with an N, as in `nSTEP`.
    has_n: bool,
}

impl<'w> Words<'w> {
    fn new(words: &'w [String]) -> Self {
        let is_encoder = words.iter().any(|word| ENCODER.contains(&without_number(word)));
        let phase = |word: &str| match word {
            "A" if is_encoder => Some(Kind::A),
            "B" if is_encoder => Some(Kind::B),
            _ => find(&PHASES, word).map(|(_, kind)| kind),
        };
        let mut found = Self::default();
        for word in words {
            if let Some(kind) = phase(without_number(word)) {
                found.add(SignalWord { word: "PHASE", kind, axis: trailing_number(word) });
            } else if let Some(signal) = signal(word) {
                found.add(signal);
            } else if let Some(signal) = word.strip_prefix('N').and_then(signal) {
                found.has_n = true;
                found.add(signal);
            } else {
                found.others.push(word.as_str());
            }
        }
        found
    }

    fn add(&mut self, SignalWord { word, kind, axis }: SignalWord) {
        self.signals.push((kind, word));
        self.axis = self.axis.take().or(axis);
    }

    fn has(&self, kind: Kind) -> bool {
        self.signals.iter().any(|(other, _)| *other == kind)
    }

    fn kind(&self) -> Option<Kind> {
        let is_bus = self.has(Kind::Dir) && self.others.iter().any(|word| ["RS485", "485"].contains(word));
        if self.has(Kind::De) || self.has(Kind::En) && self.has(Kind::Tx) || is_bus {
            return Some(Kind::De);
        }
        let is_one_way = self.has(Kind::Cw) != self.has(Kind::Ccw);
        let by_rank = [Kind::En, Kind::Dir, Kind::Cw, Kind::Ccw, Kind::Step];
        let is_kind = |kind: &Kind| self.has(*kind) && (is_one_way || !matches!(kind, Kind::Cw | Kind::Ccw));
        by_rank.into_iter().find(is_kind).or_else(|| self.signals.first().map(|(kind, _)| *kind))
    }

    fn is_inverted(&self, kind: Kind, name: &str) -> bool {
        let is_marked = self.has_n
            || name.starts_with(['/', '~', '!'])
            || name.to_ascii_uppercase().ends_with("_N")
            || name.ends_with('#');
        match kind {
            Kind::En => is_marked || self.signals.iter().any(|(_, word)| ACTIVE_LOW.contains(word)),
            Kind::Step | Kind::Cw | Kind::Ccw => is_marked,
            _ => false,
        }
    }

    /// UP and DOWN mean CW and CCW only if all other words name an axis or are in [`NOISE`].
    fn is_vague(&self) -> bool {
        self.signals.iter().all(|(_, word)| UP_DOWN.contains(word))
            && !self.others.iter().all(|word| is_noise(word) || is_axis(word))
    }
}

impl Meaning {
    /// The meaning of a name. `indexed`: a number at its beginning is only a channel index.
    pub(crate) fn from_name(name: &str, indexed: bool) -> Self {
        let name = without_index(name, indexed);
        let (scope, last) = name.rsplit_once('.').unwrap_or(("", name));
        let all = split_words(last);
        let has_word = |list: &[&str]| all.iter().any(|word| list.contains(&word.as_str()));
        let is_count = has_word(&["STEPS"]) && has_word(&["LEFT", "REMAINING", "TODO"]);
        if is_count || all.iter().any(|word| OTHERS.split(' ').any(|other| other == without_number(word))) {
            return Self::Other;
        }
        let words = Words::new(&all);
        let Some(kind) = words.kind().filter(|_| !words.is_vague()) else { return Self::Unknown };
        let is_negative = last.trim_end().trim_end_matches(')').ends_with('-')
            || last.to_ascii_uppercase().ends_with("_N")
            || has_word(&["MINUS"]);
        let inverted = words.is_inverted(kind, last);
        let is_pulse = words.has(Kind::Step) || words.has(Kind::Clock);
        let shared_axes = || (kind == Kind::Dir).then(|| axes_of(&words.others)).flatten();
        let axis = words.axis.clone().or_else(shared_axes).or_else(|| axis_of(&words.others));
        let axis = axis.or_else(|| axis_of_scope(scope)).unwrap_or_default();
        Self::Signal(SignalName { kind, inverted, is_negative, is_pulse, axis, scope: scope.to_owned() })
    }

    /// The signal in a name of one word, with the rest of the name as axis.
    pub(crate) fn from_single_word(name: &str) -> Option<SignalName> {
        let (scope, last) = name.rsplit_once('.').unwrap_or(("", name));
        let upper = last.to_ascii_uppercase();
        let (word, kind) = JOINED.into_iter().find(|(word, _)| upper.matches(word).count() == 1)?;
        let axis = upper.replacen(word, "", 1);
        let scope = scope.to_owned();
        Some(SignalName { kind, inverted: false, is_negative: false, is_pulse: false, axis, scope })
    }

    pub(crate) fn is_recognized(name: &str) -> bool {
        matches!(Self::from_name(name, false), Self::Signal(SignalName { kind, .. }) if kind != Kind::Clock)
    }
}

/// Whether each name begins with a different number, which is only a channel index.
pub(crate) fn are_indexed<'a>(names: impl Iterator<Item = &'a str>) -> bool {
    let (mut seen, mut count) = (std::collections::BTreeSet::new(), 0);
    for name in names {
        let rest = name.trim_start_matches(|c: char| c.is_ascii_digit());
        let digits = &name[..name.len() - rest.len()];
        if digits.is_empty() || !seen.insert(digits) {
            return false;
        }
        count += 1;
    }
    count > 1
}

fn without_index(name: &str, indexed: bool) -> &str {
    if let Some((index, rest)) = name.split_once(':') {
        let index = index.trim();
        let is_pin = PINS.iter().any(|pin| {
            index.to_ascii_uppercase().trim_end_matches(|c: char| c.is_ascii_digit()).trim() == *pin
        });
        let is_number = !index.is_empty() && index.bytes().all(|byte| byte.is_ascii_digit());
        if (is_pin || is_number) && !rest.trim().is_empty() {
            return rest.trim();
        }
    }
    let rest = name.trim_start_matches(|c: char| c.is_ascii_digit());
    if indexed && rest.contains(|c: char| c.is_ascii_alphabetic()) { rest } else { name }
}

/// Splits a name at punctuation, at changes of case and after digits, and returns upper-case words. A part that is a known
/// word is not split.
fn split_words(name: &str) -> Vec<String> {
    let mut all = Vec::new();
    for part in name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|part| !part.is_empty()) {
        let upper = part.to_ascii_uppercase();
        let is_low = upper.strip_prefix('N').is_some_and(|word| signal(word).is_some());
        if is_low || signal(&upper).is_some() || find(&PHASES, without_number(&upper)).is_some() {
            all.push(upper);
            continue;
        }
        let bytes = part.as_bytes();
        let mut start = 0;
        for at in 1..bytes.len() {
            let (Some(before), Some(now)) = (bytes.get(at - 1), bytes.get(at)) else { continue };
            let after = bytes.get(at + 1);
            let is_start = before.is_ascii_lowercase() && now.is_ascii_uppercase()
                || before.is_ascii_digit() && now.is_ascii_alphabetic()
                || before.is_ascii_uppercase()
                    && now.is_ascii_uppercase()
                    && after.is_some_and(u8::is_ascii_lowercase);
            if is_start {
                all.push(part.get(start..at).unwrap_or_default().to_ascii_uppercase());
                start = at;
            }
        }
        all.push(part.get(start..).unwrap_or_default().to_ascii_uppercase());
    }
    all
}

/// A word without the number at its end.
fn without_number(word: &str) -> &str {
    word.trim_end_matches(|c: char| c.is_ascii_digit())
}

/// Whether `axes`, such as `XY`, includes `axis`: several motors share that DIR.
pub(crate) fn includes_axis(axes: &str, axis: &str) -> bool {
    axes.len() > 1
        && axes.chars().all(|letter| AXES.contains(letter))
        && axis.len() == 1
        && axes.contains(axis)
}

/// Number of words that two names have in common, without pin numbers.
pub(crate) fn shared_words(name: &str, other: &str) -> usize {
    let others = split_words(other);
    let is_pin = |word: &str| PINS.contains(&without_number(word)) && trailing_number(word).is_some();
    split_words(name).iter().filter(|word| !is_pin(word) && others.contains(word)).count()
}

/// The number at the end of a word.
fn trailing_number(word: &str) -> Option<String> {
    let digits = word.get(without_number(word).len()..)?;
    (!digits.is_empty()).then(|| digits.to_owned())
}

/// The signal of a word such as `STEP`, `STEP1`, `STEPPIN`, `XYDIR` or `XSTEP`.
fn signal(given: &str) -> Option<SignalWord> {
    let text = without_number(given);
    if let Some((word, kind)) = find(&WORDS, text) {
        return Some(SignalWord { word, kind, axis: trailing_number(given) });
    }
    if ENCODER.contains(&text) {
        return None;
    }
    if let Some(signal) = text.strip_suffix("PIN").and_then(signal) {
        let axis = signal.axis.or_else(|| trailing_number(given));
        return Some(SignalWord { axis, ..signal });
    }
    let shared_axes = text
        .strip_suffix("DIR")
        .or_else(|| text.strip_prefix("DIR"))
        .filter(|axes| axes.len() > 1 && axes.bytes().all(|letter| b"XYZ".contains(&letter)));
    if let Some(axes) = shared_axes {
        return Some(SignalWord { word: "DIR", kind: Kind::Dir, axis: Some(axes.to_owned()) });
    }
    with_axis_letter(text, &trailing_number(given).unwrap_or_default())
}

/// The signal of a word with an axis letter before or after it: `XSTEP`, `DIRX`.
fn with_axis_letter(text: &str, number: &str) -> Option<SignalWord> {
    // L and R are axes only of signals that every motor has.
    let is_axis = |letter: &str| {
        letter.len() == 1
            && (AXES.contains(letter)
                || "LR".contains(letter) && (text.contains("STEP") || text.contains("DIR")))
    };
    let known = |letter, word| is_axis(letter).then(|| find(&WORDS, word)).flatten();
    let (first, rest) = text.split_at_checked(1)?;
    let (start, last) = text.split_at_checked(text.len().checked_sub(1)?)?;
    let (letter, (word, kind)) = match (known(first, rest), known(last, start)) {
        (Some(found), _) => (first, found),
        (None, Some(found)) => (last, found),
        (None, None) => return None,
    };
    let is_of_motor = matches!(kind, Kind::Step | Kind::Dir | Kind::En) && word.len() > 2 || word == "EN";
    is_of_motor.then(|| SignalWord { word, kind, axis: Some(format!("{letter}{number}")) })
}

fn is_axis(word: &str) -> bool {
    let text = without_number(word);
    text.is_empty() || text.len() == 1 && AXES.contains(text)
}

fn is_noise(word: &str) -> bool {
    NOISE.contains(&word) || ENCODER.contains(&word) || PINS.contains(&without_number(word))
}

/// Several letters of axes, as in `DIR X/Y`.
fn axes_of(words: &[&str]) -> Option<String> {
    let is_letter = |word: &&&str| word.len() == 1 && AXES.contains(**word);
    let axes: Vec<&str> = words.iter().filter(is_letter).copied().collect();
    (axes.len() > 1).then(|| axes.concat())
}

fn axis_of(words: &[&str]) -> Option<String> {
    if let Some(axis) = words.iter().find(|word| is_axis(word)) {
        return Some((*axis).to_owned());
    }
    // `MOTOR1`, `AXIS2`, `ENC1`.
    let numbered =
        |word: &&&str| NOISE.contains(&without_number(word)) || ENCODER.contains(&without_number(word));
    if let Some(number) = words.iter().filter(numbered).find_map(|word| trailing_number(word)) {
        return Some(number);
    }
    let names: Vec<&str> = words.iter().copied().filter(|word| !is_noise(word)).collect();
    (!names.is_empty()).then(|| names.join("_"))
}

fn axis_of_scope(scope: &str) -> Option<String> {
    let last = scope.rsplit('.').next().unwrap_or_default().to_ascii_uppercase();
    let last = last.rsplit(|c: char| !c.is_ascii_alphanumeric()).next().unwrap_or_default();
    if last.is_empty() {
        return None;
    }
    if is_axis(last) { Some(last.to_owned()) } else { trailing_number(last) }
}
