//! Reads JSON values as slices of the text.
//!
//! This needs no memory besides the text and shows duplicate names. Each level of nesting is scanned again, but a
//! scenario has only nine.

use alloc::{borrow::Cow, borrow::ToOwned, vec::Vec};
use core::fmt;
use serde::{
    Deserialize, Deserializer as _,
    de::{Error, MapAccess, SeqAccess, Visitor},
};
use serde_json::{Deserializer, value::RawValue};

/// Up to here, whole numbers are exact even with a point or an exponent.
const MAX_EXACT: f64 = 9_007_199_254_740_992.0;

/// A value in a JSON text.
#[derive(Clone, Copy, Debug)]
pub struct Json<'t>(&'t RawValue);

impl<'t> Json<'t> {
    pub(crate) fn parse(text: &'t str) -> Result<Self, serde_json::Error> {
        serde_json::from_str(text).map(Self)
    }

    pub(crate) fn raw(self) -> &'t str {
        self.0.get()
    }

    fn begins_with(self, mark: char) -> bool {
        self.raw().starts_with(mark)
    }

    pub(crate) fn is_null(self) -> bool {
        self.begins_with('n')
    }

    pub(crate) fn is_map(self) -> bool {
        self.begins_with('{')
    }

    pub(crate) fn is_list(self) -> bool {
        self.begins_with('[')
    }

    /// `None` for half of a surrogate pair.
    pub(crate) fn text(self) -> Option<Cow<'t, str>> {
        let text = self.begins_with('"').then(|| serde_json::from_str::<Text<'_>>(self.raw()));
        text?.ok().map(|Text(text)| text)
    }

    /// Also if it is too large for an `f64`.
    pub(crate) fn is_number(self) -> bool {
        self.raw().starts_with(|first: char| first == '-' || first.is_ascii_digit())
    }

    /// Also if it is too large for a `u64`.
    pub(crate) fn is_whole_number(self) -> bool {
        self.whole().is_some() || self.number().is_some_and(|number| number.abs() > MAX_EXACT)
    }

    /// `None` for infinity.
    pub(crate) fn number(self) -> Option<f64> {
        serde_json::from_str(self.raw()).ok()
    }

    /// Sign and magnitude of a whole number, `16000000.0` and `16e6` included.
    pub(crate) fn whole(self) -> Option<(bool, u64)> {
        let raw = self.raw();
        let magnitude = raw.strip_prefix('-').unwrap_or(raw);
        let is_negative = magnitude.len() < raw.len();
        if let Ok(magnitude) = magnitude.parse::<u64>() {
            return Some((is_negative && magnitude > 0, magnitude));
        }
        let number = self.number()?;
        let magnitude = number.abs() as u64;
        (number.abs() <= MAX_EXACT && magnitude as f64 == number.abs()).then_some((number < 0.0, magnitude))
    }

    /// False if it is no map or a name is no text.
    pub(crate) fn members(self, each: &mut dyn FnMut(&str, Json<'t>)) -> bool {
        Deserializer::from_str(self.raw()).deserialize_map(Members(each)).is_ok()
    }

    /// False if it is no list.
    pub(crate) fn entries(self, each: &mut dyn FnMut(Json<'t>)) -> bool {
        self.is_list() && Deserializer::from_str(self.raw()).deserialize_seq(Entries(each)).is_ok()
    }

    pub(crate) fn list(self) -> Option<Vec<Json<'t>>> {
        let mut list = Vec::new();
        self.entries(&mut |entry| list.push(entry)).then_some(list)
    }
}

/// Borrowed, or owned if it was written with escapes.
struct Text<'t>(Cow<'t, str>);

impl<'t> Deserialize<'t> for Text<'t> {
    fn deserialize<D: serde::Deserializer<'t>>(deserializer: D) -> Result<Self, D::Error> {
        struct Borrowing;

        impl<'t> Visitor<'t> for Borrowing {
            type Value = Text<'t>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a text")
            }

            fn visit_borrowed_str<E: Error>(self, text: &'t str) -> Result<Text<'t>, E> {
                Ok(Text(Cow::Borrowed(text)))
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Text<'t>, E> {
                Ok(Text(Cow::Owned(text.to_owned())))
            }
        }

        deserializer.deserialize_str(Borrowing)
    }
}

struct Members<'f, 't>(&'f mut dyn FnMut(&str, Json<'t>));

impl<'t> Visitor<'t> for Members<'_, 't> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a map")
    }

    fn visit_map<A: MapAccess<'t>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some((Text(name), value)) = map.next_entry()? {
            (self.0)(&name, Json(value));
        }
        Ok(())
    }
}

struct Entries<'f, 't>(&'f mut dyn FnMut(Json<'t>));

impl<'t> Visitor<'t> for Entries<'_, 't> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'t>>(self, mut list: A) -> Result<(), A::Error> {
        while let Some(entry) = list.next_element()? {
            (self.0)(Json(entry));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{format, string::String};

    #[test]
    fn a_whole_number_may_be_written_with_a_point_or_a_power() {
        for (given, expected) in [
            ("16000000", Some((false, 16_000_000))),
            ("16000000.0", Some((false, 16_000_000))),
            ("16e6", Some((false, 16_000_000))),
            ("-3.0", Some((true, 3))),
            ("-0", Some((false, 0))),
            ("18446744073709551615", Some((false, u64::MAX))),
            ("9007199254740992.0", Some((false, 1 << 53))),
            // No longer exact with a point.
            ("9007199254740994.0", None),
            ("18446744073709551616", None),
            ("1.5", None),
            ("1e999", None),
            ("\"1\"", None),
            ("true", None),
        ] {
            assert_eq!(Json::parse(given).expect(given).whole(), expected, "{given}");
        }
    }

    #[test]
    fn names_are_read_in_order_including_duplicates() {
        let json = Json::parse(r#" { "b": [1, {"x": "]"}], "a" : null, "b": "\u0041\"" } "#).expect("JSON");
        let mut seen = String::new();
        assert!(json.members(&mut |name, value| seen += &format!("{name}={};", value.raw())));
        assert_eq!(seen, r#"b=[1, {"x": "]"}];a=null;b="\u0041\"";"#);
        assert!(!Json::parse("[]").expect("JSON").members(&mut |_, _| {}));
        assert!(!Json::parse("{}").expect("JSON").entries(&mut |_| {}));
        assert_eq!(Json::parse("[1, [2]]").expect("JSON").list().map(|list| list.len()), Some(2));
    }

    #[test]
    fn half_a_surrogate_pair_has_no_text() {
        assert_eq!(Json::parse(r#""\u00fc""#).expect("JSON").text().as_deref(), Some("\u{fc}"));
        assert_eq!(Json::parse(r#""\ud800""#).expect("JSON").text(), None);
        assert!(!Json::parse(r#"{"\ud800": 1}"#).expect("JSON").members(&mut |_, _| {}));
    }
}
