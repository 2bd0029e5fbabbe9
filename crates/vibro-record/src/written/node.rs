//! TOML values with their places, read as the types that are expected.

use crate::kind::Kind;
use serde::de::value::{MapAccessDeserializer, MapDeserializer, SeqDeserializer, StrDeserializer};
use serde::de::{self, DeserializeOwned, Deserializer, Expected, IntoDeserializer, Unexpected, Visitor};
use serde::forward_to_deserialize_any;
use std::fmt;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// An error in a TOML value, and its place.
#[derive(Debug)]
pub struct Fault {
    pub what: What,
    /// Bytes in the text, where known.
    pub span: Option<Range<usize>>,
}

#[derive(Debug)]
pub enum What {
    /// An unknown key, with the known ones.
    UnknownKey(String, &'static [&'static str]),
    /// A key that should be the name of a quantity but is not a known one.
    UnknownName(String, Kind),
    MissingKey(&'static str),
    /// A key that is given under two of its names.
    Twice(&'static str),
    /// A value of another kind.
    Value(Kind),
    /// Any other error, in the words of the type.
    Other(String),
}

impl From<What> for Fault {
    fn from(what: What) -> Fault {
        Fault { what, span: None }
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
        What::Other(words.to_string()).into()
    }

    fn invalid_type(_: Unexpected<'_>, expected: &dyn Expected) -> Fault {
        What::Value(Kind::Other(expected.to_string())).into()
    }

    fn invalid_value(found: Unexpected<'_>, expected: &dyn Expected) -> Fault {
        Fault::invalid_type(found, expected)
    }

    fn invalid_length(_: usize, expected: &dyn Expected) -> Fault {
        Fault::invalid_type(Unexpected::Seq, expected)
    }

    fn unknown_variant(_: &str, names: &'static [&'static str]) -> Fault {
        What::Value(Kind::Names(names)).into()
    }

    fn unknown_field(key: &str, known: &'static [&'static str]) -> Fault {
        What::UnknownKey(key.to_owned(), known).into()
    }

    fn missing_field(key: &'static str) -> Fault {
        What::MissingKey(key).into()
    }

    fn duplicate_field(key: &'static str) -> Fault {
        What::Twice(key).into()
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

    /// Reads the node as the expected type. An error of the value itself gets its place and this kind.
    fn read<V: Visitor<'de>>(self, kind: Option<Kind>, visitor: V) -> Result<V::Value, Fault> {
        let span = self.span.clone();
        let name = self.value.as_str().filter(|_| self.is_key).map(str::to_owned);
        self.visit(visitor).map_err(|mut fault| {
            if fault.span.is_none() {
                fault.span = Some(span);
                fault.what = match (fault.what, kind, name) {
                    (What::Value(of_type), kind, Some(name)) => {
                        What::UnknownName(name, kind.unwrap_or(of_type))
                    }
                    (What::Value(_), Some(kind), None) => What::Value(kind),
                    (what, ..) => what,
                };
            }
            fault
        })
    }

    fn visit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.value {
            DeValue::String(text) => visitor.visit_str(&text),
            DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
                Ok(number) => visitor.visit_i64(number),
                // Too large for a whole number; read as a number it fails the range of its key.
                Err(_) => visitor.visit_f64(number.as_str().parse().unwrap_or(f64::INFINITY)),
            },
            DeValue::Float(number) => match number.as_str().parse() {
                Ok(number) => visitor.visit_f64(number),
                Err(_) => Err(de::Error::invalid_type(Unexpected::Other(number.as_str()), &visitor)),
            },
            DeValue::Boolean(truth) => visitor.visit_bool(truth),
            DeValue::Datetime(_) => Err(de::Error::invalid_type(Unexpected::Other("a date"), &visitor)),
            DeValue::Array(all) => {
                let mut all = SeqDeserializer::new(all.into_iter().map(Node::of));
                let read = visitor.visit_seq(&mut all)?;
                all.end().map(|()| read)
            }
            DeValue::Table(rows) => {
                let mut rows = rows_of(rows);
                let read = visitor.visit_map(&mut rows)?;
                rows.end().map(|()| read)
            }
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

/// Methods that expect a value of one kind.
macro_rules! asks {
    ($($name:ident: $kind:expr),*) => {
        $(fn $name<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
            self.read(Some($kind), visitor)
        })*
    };
}

impl<'de> Deserializer<'de> for Node<'de> {
    type Error = Fault;

    asks! {
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
            // A list would be accepted as the fields of a struct in their order.
            DeValue::Table(_) => self.read(Some(Kind::Table), visitor),
            _ => Err(Fault { what: What::Value(Kind::Table), span: Some(self.span) }),
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

/// A value by its name.
///
/// # Errors
/// The names that are known.
pub fn named<T: DeserializeOwned>(name: &str) -> Result<T, Kind> {
    T::deserialize(StrDeserializer::<Fault>::new(name)).map_err(|fault| match fault.what {
        What::Value(kind) => kind,
        other => Kind::Other(format!("{other:?}")),
    })
}
