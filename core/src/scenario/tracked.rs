//! JSON as a scenario's types, with the place where it went wrong.
//!
//! A deserializer of its own, because the page carries it: `serde_path_to_error` wraps the visitor of every
//! type, and that is 14 kB more in the compressed page. For the same reason its functions stay functions: in
//! each place where a type has a field of one kind, the same code would stand again. It is also stricter than serde, which reads a
//! map's fields from a list, by their order; a scenario has names.

use alloc::{
    string::{String, ToString},
    vec::Vec,
};
use core::cell::RefCell;
use serde::{
    Deserialize, Deserializer,
    de::{
        DeserializeSeed, EnumAccess, Error as _, MapAccess, SeqAccess, Unexpected, VariantAccess, Visitor,
        value::BorrowedStrDeserializer,
    },
    forward_to_deserialize_any,
};
use serde_json::{Error, Value};

/// One step of a path into JSON.
#[derive(Clone, PartialEq)]
pub(super) enum Step {
    Key(String),
    Index(usize),
}

/// Reads a value.
///
/// # Errors
/// What is wrong with it, and the path to where.
pub(super) fn read<'de, T: Deserialize<'de>>(value: &'de Value) -> Result<T, (Vec<Step>, Error)> {
    let wrong = RefCell::new(None);
    let root = Place { outer: None, step: None, wrong: &wrong };
    T::deserialize(Tracked { value, place: &root })
        .map_err(|error| (wrong.borrow_mut().take().unwrap_or_default(), error))
}

/// A place in the JSON, known by the way to it.
struct Place<'p> {
    outer: Option<&'p Place<'p>>,
    step: Option<Step>,
    /// The innermost place that an error came from.
    wrong: &'p RefCell<Option<Vec<Step>>>,
}

impl Place<'_> {
    #[inline(never)]
    fn below(&self, step: Step) -> Place<'_> {
        Place { outer: Some(self), step: Some(step), wrong: self.wrong }
    }

    /// Notes this place, unless one within it is noted already; gives the error on.
    #[inline(never)]
    fn note(&self, error: Error) -> Error {
        let mut wrong = self.wrong.borrow_mut();
        if wrong.is_none() {
            let mut path: Vec<Step> = core::iter::successors(Some(self), |place| place.outer)
                .filter_map(|place| place.step.clone())
                .collect();
            path.reverse();
            *wrong = Some(path);
        }
        error
    }
}

/// A value at its place.
#[derive(Clone, Copy)]
struct Tracked<'de, 'p> {
    value: &'de Value,
    place: &'p Place<'p>,
}

impl<'de> Tracked<'de, '_> {
    #[inline(never)]
    fn map<V: Visitor<'de>>(
        self,
        fields: &'de serde_json::Map<String, Value>,
        visitor: V,
    ) -> Result<V::Value, Error> {
        visitor.visit_map(Fields { rest: fields.iter(), current: None, place: self.place })
    }
}

impl<'de> Deserializer<'de> for Tracked<'de, '_> {
    type Error = Error;

    #[inline(never)]
    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.value {
            Value::Null => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::String(text) => visitor.visit_borrowed_str(text),
            Value::Array(entries) => {
                visitor.visit_seq(Entries { rest: entries.iter(), index: 0, place: self.place })
            }
            Value::Object(fields) => self.map(fields, visitor),
            Value::Number(number) => match (number.as_u64(), number.as_i64(), number.as_f64()) {
                (Some(number), ..) => visitor.visit_u64(number),
                (_, Some(number), _) => visitor.visit_i64(number),
                (.., number) => visitor.visit_f64(number.unwrap_or(f64::NAN)),
            },
        }
    }

    #[inline(never)]
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.value {
            Value::Object(fields) => self.map(fields, visitor),
            Value::Array(_) => Err(Error::custom("a list, where a map of names and values belongs")),
            other => Err(Error::invalid_type(unexpected(other), &visitor)),
        }
    }

    #[inline(never)]
    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        let (name, content) = match self.value {
            Value::String(name) => (name, None),
            Value::Object(map) => match (map.iter().next(), map.len()) {
                (Some((name, content)), 1) => (name, Some(content)),
                _ => return Err(Error::invalid_value(Unexpected::Map, &"map with a single key")),
            },
            other => return Err(Error::invalid_type(unexpected(other), &"string or map")),
        };
        visitor.visit_enum(Choice { name, content, place: self.place })
    }

    #[inline(never)]
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        if self.value.is_null() { visitor.visit_none() } else { visitor.visit_some(self) }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        visitor.visit_newtype_struct(self)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf
        unit unit_struct seq tuple tuple_struct map identifier ignored_any
    }
}

/// A value in serde's words for what was not expected.
fn unexpected(value: &Value) -> Unexpected<'_> {
    match value {
        Value::Null => Unexpected::Unit,
        Value::Bool(value) => Unexpected::Bool(*value),
        Value::String(text) => Unexpected::Str(text),
        Value::Array(_) => Unexpected::Seq,
        Value::Object(_) => Unexpected::Map,
        Value::Number(number) => match (number.as_u64(), number.as_i64(), number.as_f64()) {
            (Some(number), ..) => Unexpected::Unsigned(number),
            (_, Some(number), _) => Unexpected::Signed(number),
            (.., number) => Unexpected::Float(number.unwrap_or(f64::NAN)),
        },
    }
}

struct Entries<'de, 'p> {
    rest: core::slice::Iter<'de, Value>,
    index: usize,
    place: &'p Place<'p>,
}

impl<'de> SeqAccess<'de> for Entries<'de, '_> {
    type Error = Error;

    #[inline(never)]
    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Error> {
        let Some(value) = self.rest.next() else { return Ok(None) };
        let place = self.place.below(Step::Index(self.index));
        self.index += 1;
        seed.deserialize(Tracked { value, place: &place }).map(Some).map_err(|error| place.note(error))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}

struct Fields<'de, 'p> {
    rest: serde_json::map::Iter<'de>,
    current: Option<(&'de String, &'de Value)>,
    place: &'p Place<'p>,
}

impl<'de> MapAccess<'de> for Fields<'de, '_> {
    type Error = Error;

    #[inline(never)]
    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Error> {
        self.current = self.rest.next();
        let Some((name, _)) = self.current else { return Ok(None) };
        seed.deserialize(BorrowedStrDeserializer::new(name))
            .map(Some)
            .map_err(|error| self.place.below(Step::Key(name.clone())).note(error))
    }

    #[inline(never)]
    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, Error> {
        let Some((name, value)) = self.current.take() else {
            return Err(Error::custom("a value without a name"));
        };
        let place = self.place.below(Step::Key(name.clone()));
        seed.deserialize(Tracked { value, place: &place }).map_err(|error| place.note(error))
    }
}

/// A choice: its name, alone or with what it holds.
struct Choice<'de, 'p> {
    name: &'de str,
    content: Option<&'de Value>,
    place: &'p Place<'p>,
}

impl<'de> EnumAccess<'de> for Choice<'de, '_> {
    type Error = Error;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Error> {
        Ok((seed.deserialize(BorrowedStrDeserializer::new(self.name))?, self))
    }
}

impl<'de> VariantAccess<'de> for Choice<'de, '_> {
    type Error = Error;

    fn unit_variant(self) -> Result<(), Error> {
        match self.content {
            None => Ok(()),
            Some(value) => <()>::deserialize(Tracked { value, place: self.place }),
        }
    }

    #[inline(never)]
    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Error> {
        let Some(value) = self.content else {
            return Err(Error::invalid_type(Unexpected::UnitVariant, &"newtype variant"));
        };
        let place = self.place.below(Step::Key(self.name.to_string()));
        seed.deserialize(Tracked { value, place: &place }).map_err(|error| place.note(error))
    }

    fn tuple_variant<V: Visitor<'de>>(self, _length: usize, visitor: V) -> Result<V::Value, Error> {
        Err(Error::invalid_type(Unexpected::TupleVariant, &visitor))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        Err(Error::invalid_type(Unexpected::StructVariant, &visitor))
    }
}
