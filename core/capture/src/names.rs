//! Derives signal and motor from a channel's name.
//!
//! ```text
//! signal   STEP STP PUL PULSE PLS PU, DIR DIRECTION DR SIGN, CW, CCW, EN ENA ENABLE, RX RXD, TX TXD, DE
//! motor    what is left of the name: X_STEP, STEP (Y axis), stepper_z1.step_pin, motor1_step, stepgen.0.step, RA_STEP
//! other    step_count, LED, BUSY: neither
//! ```

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Step,
    Dir,
    Cw,
    Ccw,
    /// STEP only next to a DIR: many clocks have this name.
    Clock,
    A,
    B,
    En,
    Rx,
    Tx,
    De,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Named {
    pub(crate) kind: Kind,
    pub(crate) inverted: bool,
    /// The negative line of a pair, as in `PUL-`.
    pub(crate) negative: bool,
    /// Also called a pulse, as in `PUL/CW`.
    pub(crate) pulse: bool,
    /// Identifies the motor: a number, a letter, a word, or nothing.
    pub(crate) axis: String,
    pub(crate) scope: String,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Meaning {
    Signal(Named),
    /// Not a signal of a motor or its line.
    Other,
    Unknown,
}

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
/// Pulses only if the opposite word is present, too.
const UP_DOWN: [&str; 3] = ["UP", "DOWN", "DN"];
const PHASES: [(Kind, &str); 2] = [(Kind::A, "ENCA PHA PHASEA QA"), (Kind::B, "ENCB PHB PHASEB QB")];
const ENCODER: [&str; 6] = ["ENC", "ENCODER", "QUAD", "QEI", "PHASE", "PH"];
/// Do not identify a motor, except with a number: `MOTOR1`.
const NOISE: [&str; 30] = [
    "AXIS", "MOTOR", "MOT", "STEPPER", "STEPGEN", "JOINT", "DRIVER", "DRV", "EXTRUDER", "M", "J", "T", "PIN",
    "BIT", "PORT", "OUT", "OUTPUT", "SIGNAL", "SIG", "LINE", "P", "PLUS", "N", "MINUS", "O", "I", "ALL",
    "BOTH", "COMMON", "SHARED",
];
/// The word and its kind.
fn find(words: &[(Kind, &'static str)], wanted: &str) -> Option<(&'static str, Kind)> {
    let find =
        |(kind, words): &(Kind, &'static str)| Some((words.split(' ').find(|word| *word == wanted)?, *kind));
    words.iter().find_map(find)
}

/// Names in one word: `FLSTEP`, `FLDIR`.
const JOINED: [(&str, Kind); 3] = [("STEP", Kind::Step), ("DIRECTION", Kind::Dir), ("DIR", Kind::Dir)];
/// Prefixes of pin or probe numbers.
const PINS: [&str; 16] = [
    "D", "CH", "CHANNEL", "DIO", "GPIO", "IO", "PIN", "PROBE", "PA", "PB", "PC", "PD", "PE", "PF", "PG",
    "LOGIC",
];
/// Never signals, whatever the other words are.
const OTHERS: &str = "ACK ALARM ALM BUSY CHANGE CHANGED CNT COUNT COUNTER CS DELAY DIAG DONE END ENDSTOP ERR ERROR FAULT FLT \
    FREQ HOME IDX INDEX INT INTERVAL IRQ LAST LED LEN LENGTH LIMIT MICRO MICROSTEP MISO MODE MOSI NEXT NUM \
    PERIOD POS POSITION PREV RATE READY REQ RESET RST SCK SCL SCLK SDA SIZE SLEEP SPEED STALL STATE TOTAL \
    TRIG TRIGGER VALID WIDTH PWM";
pub(crate) const AXES: &str = "XYZABCUVWE";

impl Meaning {
    /// `indexed`: the leading number only counts the file's channels.
    pub(crate) fn of(name: &str, indexed: bool) -> Self {
        let name = without_index(name, indexed);
        let (scope, last) = name.rsplit_once('.').unwrap_or(("", name));
        let words = words(last);
        let has_word = |all: &[&str]| words.iter().any(|word| all.contains(&word.as_str()));
        let is_rest = has_word(&["STEPS"]) && has_word(&["LEFT", "REMAINING", "TODO"]);
        if is_rest || words.iter().any(|word| OTHERS.split(' ').any(|other| other == letters(word))) {
            return Self::Other;
        }
        let mut kinds: Vec<(Kind, &str)> = Vec::new();
        let (mut axis, mut rest) = (None::<String>, Vec::new());
        let is_encoder = words.iter().any(|word| ENCODER.contains(&letters(word)));
        let mut low = false;
        for word in &words {
            let phase = |word: &str| match word {
                "A" if is_encoder => Some(Kind::A),
                "B" if is_encoder => Some(Kind::B),
                _ => find(&PHASES, word).map(|(_, kind)| kind),
            };
            if let Some(kind) = phase(letters(word)) {
                kinds.push((kind, "PHASE"));
                axis = axis.or_else(|| digits(word));
            } else if let Some((known, kind, own)) = signal(word) {
                kinds.push((kind, known));
                axis = axis.or(own);
            } else if let Some((known, kind, own)) = word.strip_prefix('N').and_then(signal) {
                low = true;
                kinds.push((kind, known));
                axis = axis.or(own);
            } else {
                rest.push(word.as_str());
            }
        }
        let has = |kind: Kind| kinds.iter().any(|(one, _)| *one == kind);
        let is_bus = has(Kind::Dir) && words.iter().any(|word| word == "RS485" || word == "485");
        let kind = match () {
            () if has(Kind::De) || has(Kind::En) && has(Kind::Tx) || is_bus => Kind::De,
            () if has(Kind::En) => Kind::En,
            () if has(Kind::Dir) => Kind::Dir,
            () if has(Kind::Cw) && !has(Kind::Ccw) => Kind::Cw,
            () if has(Kind::Ccw) && !has(Kind::Cw) => Kind::Ccw,
            () if has(Kind::Step) => Kind::Step,
            () => match kinds.first() {
                Some((kind, _)) => *kind,
                None => return Self::Unknown,
            },
        };
        let marked = low
            || last.starts_with(['/', '~', '!'])
            || last.to_ascii_uppercase().ends_with("_N")
            || last.ends_with('#');
        let inverted = match kind {
            Kind::En => marked || kinds.iter().any(|(_, word)| ACTIVE_LOW.contains(word)),
            Kind::Step | Kind::Cw | Kind::Ccw => marked,
            _ => false,
        };
        let negative = last.trim_end().trim_end_matches(')').ends_with('-')
            || last.to_ascii_uppercase().ends_with("_N")
            || words.iter().any(|word| word == "MINUS");
        let several = || (kind == Kind::Dir).then(|| axes_of(&rest)).flatten();
        let axis = axis
            .or_else(several)
            .or_else(|| axis_of(&rest))
            .or_else(|| axis_of_scope(scope))
            .unwrap_or_default();
        let weak = kinds.iter().all(|(_, word)| UP_DOWN.contains(word));
        let pulse = has(Kind::Step) || has(Kind::Clock);
        // UP and DOWN are pulses only if no other word is in the name.
        if weak && !rest.iter().all(|word| is_noise(word) || is_axis(word)) {
            return Self::Unknown;
        }
        Self::Signal(Named { kind, inverted, negative, pulse, axis, scope: scope.to_owned() })
    }

    /// The signal in a name of one word, and the rest of the name.
    pub(crate) fn joined(name: &str) -> Option<Named> {
        let (scope, last) = name.rsplit_once('.').unwrap_or(("", name));
        let upper = last.to_ascii_uppercase();
        let (word, kind) = JOINED.into_iter().find(|(word, _)| upper.matches(word).count() == 1)?;
        let axis = upper.replacen(word, "", 1);
        let scope = scope.to_owned();
        Some(Named { kind, inverted: false, negative: false, pulse: false, axis, scope })
    }

    pub(crate) fn is_recognized(name: &str) -> bool {
        matches!(Self::of(name, false), Self::Signal(Named { kind, .. }) if kind != Kind::Clock)
    }
}

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

/// Splits a name at marks, before a capital after small letters, and before a letter after digits unless the word is
/// known.
fn words(name: &str) -> Vec<String> {
    let mut all = Vec::new();
    for part in name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|part| !part.is_empty()) {
        let upper = part.to_ascii_uppercase();
        let is_low = upper.strip_prefix('N').is_some_and(|word| signal(word).is_some());
        if is_low || signal(&upper).is_some() || find(&PHASES, letters(&upper)).is_some() {
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

fn letters(word: &str) -> &str {
    word.trim_end_matches(|c: char| c.is_ascii_digit())
}

/// Whether `axes`, such as `XY`, includes `axis`: several motors share that DIR.
pub(crate) fn is_of_several(axes: &str, axis: &str) -> bool {
    axes.len() > 1
        && axes.chars().all(|letter| AXES.contains(letter))
        && axis.len() == 1
        && axes.contains(axis)
}

pub(crate) fn shared_words(one: &str, other: &str) -> usize {
    let others = words(other);
    let is_pin = |word: &str| PINS.contains(&letters(word)) && digits(word).is_some();
    words(one).iter().filter(|word| !is_pin(word) && others.contains(word)).count()
}

fn digits(word: &str) -> Option<String> {
    let digits = word.get(letters(word).len()..)?;
    (!digits.is_empty()).then(|| digits.to_owned())
}

fn signal(given: &str) -> Option<(&'static str, Kind, Option<String>)> {
    let text = letters(given);
    let known = |text: &str| find(&WORDS, text);
    if let Some((known, kind)) = known(text) {
        return Some((known, kind, digits(given)));
    }
    if ENCODER.contains(&text) {
        return None;
    }
    if let Some((word, kind, axis)) = text.strip_suffix("PIN").and_then(signal) {
        return Some((word, kind, axis.or_else(|| digits(given))));
    }
    let several = text
        .strip_suffix("DIR")
        .or_else(|| text.strip_prefix("DIR"))
        .filter(|axes| axes.len() > 1 && axes.bytes().all(|letter| b"XYZ".contains(&letter)));
    if let Some(axes) = several {
        return Some(("DIR", Kind::Dir, Some(axes.to_owned())));
    }
    // L and R are axes only of signals that every motor has.
    let axis = |letter: &str| {
        letter.len() == 1
            && (AXES.contains(letter)
                || "LR".contains(letter) && (text.contains("STEP") || text.contains("DIR")))
    };
    let (first, rest) = text.split_at_checked(1)?;
    let (start, end) = text.split_at_checked(text.len().checked_sub(1)?)?;
    let (letter, found) =
        match (axis(first).then(|| known(rest)).flatten(), axis(end).then(|| known(start)).flatten()) {
            (Some(found), _) => (first, found),
            (None, Some(found)) => (end, found),
            (None, None) => return None,
        };
    let is_motor =
        matches!(found.1, Kind::Step | Kind::Dir | Kind::En) && found.0.len() > 2 || found.0 == "EN";
    is_motor.then(|| (found.0, found.1, Some(format!("{letter}{}", digits(given).unwrap_or_default()))))
}

fn is_axis(word: &str) -> bool {
    let text = letters(word);
    text.is_empty() || text.len() == 1 && AXES.contains(text)
}

fn is_noise(word: &str) -> bool {
    NOISE.contains(&word) || ENCODER.contains(&word) || PINS.contains(&letters(word))
}

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
    let numbered = |word: &&&str| NOISE.contains(&letters(word)) || ENCODER.contains(&letters(word));
    if let Some(number) = words.iter().filter(numbered).find_map(|word| digits(word)) {
        return Some(number);
    }
    let left: Vec<&str> = words.iter().copied().filter(|word| !is_noise(word)).collect();
    (!left.is_empty()).then(|| left.join("_"))
}

fn axis_of_scope(scope: &str) -> Option<String> {
    let last = scope.rsplit('.').next().unwrap_or_default().to_ascii_uppercase();
    let last = last.rsplit(|c: char| !c.is_ascii_alphanumeric()).next().unwrap_or_default();
    if last.is_empty() {
        return None;
    }
    if is_axis(last) { Some(last.to_owned()) } else { digits(last) }
}
