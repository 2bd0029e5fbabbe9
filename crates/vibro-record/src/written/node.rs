//! TOML values with their places, read as the types that are expected.

use crate::kind::Kind;
use serde::de::value::{MapAccessDeserializer, MapDeserializer, SeqDeserializer, StrDeserializer};
use serde::de::{self, DeserializeOwned, Deserializer, Expected, IntoDeserializer, Unexpected, Visitor};
use serde::forward_to_deserialize_any;
use std::borrow::Cow;
use std::fmt;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// An error in a TOML value, and its place.
#[derive(Debug)]
pub struct Fault {
    pub what: FaultKind,
    /// Bytes in the text, where known.
    pub span: Option<Range<usize>>,
}

/// Kinds of errors in a TOML value.
#[derive(Debug)]
pub enum FaultKind {
    /// An unknown key, and the known keys of the type.
    UnknownKey(String, &'static [&'static str]),
    /// A key that must be one of the known names (as the name of a quantity) and is not; the kind describes
    /// the known names.
    UnknownName(String, Kind),
    /// A key that is required and missing.
    MissingKey(&'static str),
    /// A key that occurs twice, under two of its names.
    Twice(&'static str),
    /// A value that is not of this kind.
    WrongValue(Kind),
    /// Any other error, in the words of the type.
    Other(String),
}

impl From<FaultKind> for Fault {
    fn from(what: FaultKind) -> Fault {
        Fault { what, span: None }
    }
}

impl Fault {
    /// An error without a place is one of the node that is read, not of a value nested in it: it gets the
    /// place of the node, and `kind` as the expected kind. `key` is the node's text if it is a key.
    fn at(mut self, span: Range<usize>, kind: Option<Kind>, key: Option<String>) -> Fault {
        if self.span.is_none() {
            self.span = Some(span);
            self.what = match (self.what, kind, key) {
                (FaultKind::WrongValue(of_type), kind, Some(name)) => {
                    FaultKind::UnknownName(name, kind.unwrap_or(of_type))
                }
                (FaultKind::WrongValue(_), Some(kind), None) => FaultKind::WrongValue(kind),
                (what, ..) => what,
            };
        }
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.what)
    }
}

impl std::error::Error for Fault {}

impl de::Error for Fault {
    fn custom<T: fmt::Display>(words: T) -> Fault {
        FaultKind::Other(words.to_string()).into()
    }

    fn invalid_type(_: Unexpected<'_>, expected: &dyn Expected) -> Fault {
        FaultKind::WrongValue(Kind::Other(expected.to_string())).into()
    }

    fn invalid_value(found: Unexpected<'_>, expected: &dyn Expected) -> Fault {
        Fault::invalid_type(found, expected)
    }

    fn invalid_length(_: usize, expected: &dyn Expected) -> Fault {
        Fault::invalid_type(Unexpected::Seq, expected)
    }

    fn unknown_variant(_: &str, names: &'static [&'static str]) -> Fault {
        FaultKind::WrongValue(Kind::Names(names)).into()
    }

    fn unknown_field(key: &str, known: &'static [&'static str]) -> Fault {
        FaultKind::UnknownKey(key.to_owned(), known).into()
    }

    fn missing_field(key: &'static str) -> Fault {
        FaultKind::MissingKey(key).into()
    }

    fn duplicate_field(key: &'static str) -> Fault {
        FaultKind::Twice(key).into()
    }
}

/// A key or a value with its place.
pub struct Node<'de> {
    value: DeValue<'de>,
    span: Range<usize>,
    is_key: bool,
}

impl<'de> Node<'de> {
    fn of(value: Spanned<DeValue<'de>>) -> Node<'de> {
        Node { span: value.span(), value: value.into_inner(), is_key: false }
    }

    /// A table with its place.
    pub fn table(rows: DeTable<'de>, span: &Range<usize>) -> Node<'de> {
        Node { value: DeValue::Table(rows), span: span.clone(), is_key: false }
    }

    /// Reads the node with a visitor of the expected type; errors get its place.
    fn read<V: Visitor<'de>>(self, kind: Option<Kind>, visitor: V) -> Result<V::Value, Fault> {
        let key = if self.is_key { self.value.as_str().map(str::to_owned) } else { None };
        Plain::of(self.value).visit(visitor).map_err(|fault| fault.at(self.span, kind, key))
    }
}

/// A value without its place.
enum Plain<'de> {
    Text(Cow<'de, str>),
    Whole(i64),
    Number(f64),
    Truth(bool),
    List(Vec<Node<'de>>),
    Table(DeTable<'de>),
    /// A date: no key expects one.
    Other,
}

impl<'de> Plain<'de> {
    fn of(value: DeValue<'de>) -> Plain<'de> {
        match value {
            DeValue::String(text) => Plain::Text(text),
            DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
                Ok(number) => Plain::Whole(number),
                // Too large for 64 bits: read as a float, it fails the range check of its key.
                Err(_) => Plain::Number(number.as_str().parse().unwrap_or(f64::INFINITY)),
            },
            DeValue::Float(number) => number.as_str().parse().map_or(Plain::Other, Plain::Number),
            DeValue::Boolean(truth) => Plain::Truth(truth),
            DeValue::Datetime(_) => Plain::Other,
            DeValue::Array(all) => Plain::List(all.into_iter().map(Node::of).collect()),
            DeValue::Table(rows) => Plain::Table(rows),
        }
    }

    fn visit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self {
            Plain::Text(text) => visitor.visit_str(&text),
            Plain::Whole(number) => visitor.visit_i64(number),
            Plain::Number(number) => visitor.visit_f64(number),
            Plain::Truth(truth) => visitor.visit_bool(truth),
            Plain::List(all) => {
                let mut all = SeqDeserializer::new(all.into_iter());
                let read = visitor.visit_seq(&mut all)?;
                all.end().map(|()| read)
            }
            Plain::Table(rows) => {
                let mut rows = rows_of(rows);
                let read = visitor.visit_map(&mut rows)?;
                rows.end().map(|()| read)
            }
            Plain::Other => Err(de::Error::invalid_type(Unexpected::Other("a date"), &visitor)),
        }
    }
}

type Rows<'de, I> = MapDeserializer<'de, I, Fault>;

/// Keys and values of a table in their order.
fn rows_of(rows: DeTable<'_>) -> Rows<'_, impl Iterator<Item = (Node<'_>, Node<'_>)>> {
    let key =
        |key: Spanned<_>| Node { span: key.span(), value: DeValue::String(key.into_inner()), is_key: true };
    MapDeserializer::new(rows.into_iter().map(move |(name, value)| (key(name), Node::of(value))))
}

impl<'de> IntoDeserializer<'de, Fault> for Node<'de> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

/// Deserializer methods, each for a value of one kind.
macro_rules! deserialize_kinds {
    ($($name:ident: $kind:expr),*) => {
        $(fn $name<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
            self.read(Some($kind), visitor)
        })*
    };
}

impl<'de> Deserializer<'de> for Node<'de> {
    type Error = Fault;

    deserialize_kinds! {
        deserialize_f32: Kind::Number, deserialize_f64: Kind::Number,
        deserialize_i8: Kind::Whole(i8::MIN.into(), i8::MAX.into()),
        deserialize_i16: Kind::Whole(i16::MIN.into(), i16::MAX.into()),
        deserialize_i32: Kind::Whole(i32::MIN.into(), i32::MAX.into()),
        deserialize_i64: Kind::Whole(i64::MIN, i64::MAX),
        deserialize_u8: Kind::Whole(0, u8::MAX.into()), deserialize_u16: Kind::Whole(0, u16::MAX.into()),
        deserialize_u32: Kind::Whole(0, u32::MAX.into()), deserialize_u64: Kind::Whole(0, i64::MAX),
        deserialize_bool: Kind::Truth, deserialize_str: Kind::Text, deserialize_string: Kind::Text,
        deserialize_seq: Kind::List
    }

    forward_to_deserialize_any! {
        char bytes byte_buf unit unit_struct identifier ignored_any
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.read(None, visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, n: usize, visitor: V) -> Result<V::Value, Fault> {
        self.read(Some(Kind::Values(n)), visitor)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        n: usize,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        self.deserialize_tuple(n, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.value {
            // Refuses a list: serde would read its values as the fields of a struct in their order.
            DeValue::Table(_) => self.read(Some(Kind::Table), visitor),
            _ => Err(Fault { what: FaultKind::WrongValue(Kind::Table), span: Some(self.span) }),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        self.deserialize_map(visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        struct Named<V>(V);
        impl<'de, V: Visitor<'de>> Visitor<'de> for Named<V> {
            type Value = V::Value;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.expecting(f)
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<V::Value, E> {
                self.0.visit_enum(StrDeserializer::new(name))
            }

            fn visit_map<A: de::MapAccess<'de>>(self, rows: A) -> Result<V::Value, A::Error> {
                self.0.visit_enum(MapAccessDeserializer::new(rows))
            }
        }
        self.read(Some(Kind::Names(names)), Named(visitor))
    }
}

/// Reads a name as the value of an enumeration.
///
/// # Errors
/// With the names that are known, if this is none of them.
pub fn named<T: DeserializeOwned>(name: &str) -> Result<T, Kind> {
    T::deserialize(StrDeserializer::<Fault>::new(name)).map_err(|fault| match fault.what {
        FaultKind::WrongValue(kind) => kind,
        other => Kind::Other(format!("{other:?}")),
    })
}
