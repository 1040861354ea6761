//! Finds a dump's variables by code and applies values to their channels.

use std::collections::BTreeMap;

/// Codes of one or two of the 94 allowed characters have a lookup table.
const SHORT_CODES: usize = 94 * 95;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Value {
    Low,
    High,
    /// x or z, or one of VHDL's.
    Unknown,
}

impl Value {
    pub(super) const fn parse(letter: u8) -> Option<Self> {
        Some(match letter {
            b'0' | b'l' | b'L' => Self::Low,
            b'1' | b'h' | b'H' => Self::High,
            b'x' | b'X' | b'z' | b'Z' | b'u' | b'U' | b'w' | b'W' | b'-' => Self::Unknown,
            _ => return None,
        })
    }
}

#[derive(Default)]
pub(super) struct Variable {
    bits: Vec<(u32, u8)>,
    pub(super) first_bit: u64,
    pub(super) all_bits: u64,
}

pub(super) struct Variables {
    list: Vec<Variable>,
    /// Index + 1; 0 for none.
    short: Vec<u8>,
    long: BTreeMap<Box<[u8]>, u8>,
    value: Vec<Value>,
}

impl Variables {
    pub(super) fn new() -> Self {
        Self { list: Vec::new(), short: vec![0; SHORT_CODES], long: BTreeMap::new(), value: Vec::new() }
    }

    pub(super) fn add(&mut self, code: &[u8], bit: u32, channel: u8) {
        let next = u8::try_from(self.list.len() + 1).unwrap_or(0);
        let entry = match short(code).and_then(|at| self.short.get_mut(at)) {
            Some(entry) => entry,
            None => self.long.entry(code.into()).or_insert(0),
        };
        if *entry == 0 {
            *entry = next;
            self.list.push(Variable::default());
        }
        if let Some(variable) = self.list.get_mut(usize::from(*entry).wrapping_sub(1)) {
            variable.bits.push((bit, channel));
            variable.all_bits |= 1 << channel;
            if bit == 0 {
                variable.first_bit |= 1 << channel;
            }
        }
    }

    pub(super) fn find(&self, code: &[u8]) -> Option<&Variable> {
        let entry = match short(code).and_then(|at| self.short.get(at)) {
            Some(entry) => *entry,
            None => *self.long.get(code)?,
        };
        self.list.get(usize::from(entry).wrapping_sub(1))
    }

    /// The highest bit comes first; the error is an invalid letter.
    pub(super) fn set_value(&mut self, letters: &[u8]) -> Result<(), char> {
        self.value.clear();
        for &letter in letters.iter().rev() {
            self.value.push(Value::parse(letter).ok_or(char::from(letter))?);
        }
        Ok(())
    }

    /// Levels, mask of channels, number of unknown bits.
    pub(super) fn vector(&self, code: &[u8]) -> Option<(u64, u64, u64)> {
        let variable = self.find(code)?;
        // A short value is extended by zeros, or by its highest bit if that is x or z.
        let beyond = match self.value.last() {
            Some(Value::Unknown) | None => Value::Unknown,
            _ => Value::Low,
        };
        let (mut levels, mut unknown) = (0, 0);
        for &(bit, channel) in &variable.bits {
            match self.value.get(bit as usize).unwrap_or(&beyond) {
                Value::High => levels |= 1 << channel,
                Value::Low => {}
                Value::Unknown => unknown += 1,
            }
        }
        Some((levels, variable.all_bits, unknown))
    }
}

fn short(code: &[u8]) -> Option<usize> {
    let digit = |byte: u8| byte.checked_sub(b'!').filter(|digit| *digit < 94).map(usize::from);
    match *code {
        [first] => digit(first),
        [first, second] => Some(94 * (digit(second)? + 1) + digit(first)?),
        _ => None,
    }
}
