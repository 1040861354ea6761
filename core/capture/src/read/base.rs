//! Numeral bases of bytes in text, and the detection of a file's base.

use core::str::FromStr;

/// Numeral base of bytes in text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    Binary,
    Octal,
    Decimal,
    Hexadecimal,
}

impl FromStr for Base {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "bin" => Ok(Self::Binary),
            "oct" => Ok(Self::Octal),
            "dec" => Ok(Self::Decimal),
            "hex" => Ok(Self::Hexadecimal),
            _ => Err("use hex, dec, oct or bin"),
        }
    }
}

impl Base {
    const fn radix(self) -> u32 {
        match self {
            Self::Binary => 2,
            Self::Octal => 8,
            Self::Decimal => 10,
            Self::Hexadecimal => 16,
        }
    }

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Binary => "binary",
            Self::Octal => "octal",
            Self::Decimal => "decimal",
            Self::Hexadecimal => "hexadecimal",
        }
    }

    /// `None` if the digits do not fit or the value is above 255.
    pub(super) fn byte(self, digits: &[u8]) -> Option<u8> {
        if digits.is_empty() || digits.len() > 8 {
            return None;
        }
        let value = digits.iter().try_fold(0_u64, |value, digit| {
            Some(value * u64::from(self.radix()) + u64::from(char::from(*digit).to_digit(self.radix())?))
        });
        value.and_then(|value| u8::try_from(value).ok())
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Guess {
    Certain(Base),
    Ambiguous(Base, Base),
    Unknown,
}

/// sigrok pads all bases but the decimal one with zeros to equal lengths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Digits {
    lengths: u16,
    any: Bases,
    is_padded: bool,
    has_prefix: bool,
}

#[derive(Clone, Copy, Debug)]
struct Bases {
    binary: bool,
    octal: bool,
    decimal: bool,
    hexadecimal: bool,
}

impl Digits {
    pub(super) const fn new() -> Self {
        let any = Bases { binary: true, octal: true, decimal: true, hexadecimal: true };
        Self { lengths: 0, any, is_padded: false, has_prefix: false }
    }

    pub(super) fn take(&mut self, word: &[u8]) {
        let digits = match word {
            [b'0', b'x' | b'X', digits @ ..] => {
                self.has_prefix = true;
                digits
            }
            word => word,
        };
        self.lengths |= 1 << digits.len().min(15);
        self.is_padded |= digits.len() > 1 && digits.starts_with(b"0");
        self.any.binary &= Base::Binary.byte(digits).is_some();
        self.any.octal &= Base::Octal.byte(digits).is_some();
        self.any.decimal &= Base::Decimal.byte(digits).is_some();
        self.any.hexadecimal &= Base::Hexadecimal.byte(digits).is_some();
    }

    /// Each word is 0 or 1, so the column may hold levels.
    pub(super) const fn are_single_bits(&self) -> bool {
        self.lengths == 0b10 && self.any.binary
    }

    pub(super) const fn are_pairs(&self) -> bool {
        self.lengths == 0b100 && self.any.hexadecimal
    }

    pub(super) fn guess(&self) -> Guess {
        let may_be_decimal = self.any.decimal && !self.is_padded && !self.has_prefix;
        let padded = match self.lengths {
            _ if self.has_prefix => Some(Base::Hexadecimal),
            0b100 => Some(Base::Hexadecimal).filter(|_| self.any.hexadecimal),
            0b1000 => Some(Base::Octal).filter(|_| self.any.octal),
            0b1_0000_0000 => Some(Base::Binary).filter(|_| self.any.binary),
            _ => None,
        };
        match padded {
            Some(base) if may_be_decimal => Guess::Ambiguous(base, Base::Decimal),
            Some(base) => Guess::Certain(base),
            None if may_be_decimal && self.lengths != 0 => Guess::Certain(Base::Decimal),
            None => Guess::Unknown,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_determine_the_base_or_are_ambiguous() {
        let hex_or_decimal = Guess::Ambiguous(Base::Hexadecimal, Base::Decimal);
        for (words, expected) in [
            ("55 AA 01", Guess::Certain(Base::Hexadecimal)),
            ("41 05", Guess::Certain(Base::Hexadecimal)),
            ("0x41 10", Guess::Certain(Base::Hexadecimal)),
            ("41 42", hex_or_decimal),
            ("65 173 7", Guess::Certain(Base::Decimal)),
            ("180 190", Guess::Certain(Base::Decimal)),
            ("0 1", Guess::Certain(Base::Decimal)),
            ("101 102", Guess::Ambiguous(Base::Octal, Base::Decimal)),
            ("101 002", Guess::Certain(Base::Octal)),
            ("301 377", Guess::Certain(Base::Octal)),
            ("01000001 00000000", Guess::Certain(Base::Binary)),
            ("300 480", Guess::Unknown),
            ("A 10", Guess::Unknown),
            ("007 65", Guess::Unknown),
            ("", Guess::Unknown),
        ] {
            let mut digits = Digits::new();
            words.split_ascii_whitespace().for_each(|word| digits.take(word.as_bytes()));
            assert_eq!(digits.guess(), expected, "{words}");
        }
    }
}
