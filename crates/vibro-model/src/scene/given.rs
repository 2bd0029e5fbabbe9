//! What a scene's file says, key by key.

use crate::excitation::Part;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::de::{DeTable, DeValue};
use vibro_record::{Error, Place, Result};

/// Every key that a scene has.
pub const KEYS: [&str; 18] = [
    "m1",
    "m2",
    "k1",
    "k2",
    "c1",
    "c2",
    "gap",
    "restitution",
    "excitation.kind",
    "excitation.force",
    "excitation.impulse",
    "excitation.width",
    "excitation.frequency",
    "excitation.parts",
    "contact.stiffness",
    "contact.damping",
    "contact.exponent",
    "buffer.gap",
];

/// A number, a word, or the parts of a sum of sines.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Number(f64),
    Word(String),
    Parts(Vec<Part>),
}

/// A value, and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Given {
    pub value: Value,
    /// Where it stands in the file; `None` where it came from elsewhere.
    pub span: Option<Range<usize>>,
}

/// Keys of the file with their values.
///
/// # Errors
/// If it is no TOML, or holds a key or a value that no scene has.
pub fn parse(text: &str) -> Result<BTreeMap<String, Given>> {
    let table = DeTable::parse(text).map_err(|e| {
        Error::input(Place::default(), e.message(), "a rig as TOML, such as gap = 1e-3")
            .excerpt(text, e.span().unwrap_or(0..0))
    })?;
    let mut given = BTreeMap::new();
    walk(text, table.get_ref(), "", &mut given)?;
    Ok(given)
}

fn walk(text: &str, table: &DeTable<'_>, prefix: &str, given: &mut BTreeMap<String, Given>) -> Result<()> {
    for (name, value) in table {
        let key = format!("{prefix}{}", name.get_ref());
        let inside = format!("{key}.");
        let nested = KEYS.iter().any(|known| known.starts_with(&inside));
        if let (true, DeValue::Table(inner)) = (nested, value.get_ref()) {
            walk(text, inner, &inside, given)?;
            continue;
        }
        if !KEYS.contains(&key.as_str()) {
            let (found, expected) = if nested {
                (format!("{key} is no table"), format!("[{key}]"))
            } else {
                let known: Vec<_> = KEYS.iter().filter_map(|k| k.strip_prefix(prefix)).collect();
                (format!("unknown key `{key}`"), format!("one of {}", known.join(", ")))
            };
            return Err(Error::usage(found, expected).excerpt(text, name.span()));
        }
        let wrong = |expected: &str| {
            Error::usage(format!("{key} is {}", kind(value.get_ref())), expected).excerpt(text, value.span())
        };
        let value = match (key.as_str(), value.get_ref()) {
            ("excitation.kind", DeValue::String(word)) => Value::Word(word.to_string()),
            ("excitation.kind", _) => return Err(wrong("sine, impulse, pulse or sines between quotes")),
            ("excitation.parts", DeValue::Array(list)) => Value::Parts(
                list.iter()
                    .map(|one| part(one.get_ref()).map_err(|e| e.excerpt(text, one.span())))
                    .collect::<Result<_>>()?,
            ),
            ("excitation.parts", _) => return Err(wrong("a list such as [{ force = 0.1, frequency = 5 }]")),
            (_, other) => Value::Number(number(other).ok_or_else(|| wrong("a number"))?),
        };
        given.insert(key, Given { value, span: Some(name.span()) });
    }
    Ok(())
}

fn part(value: &DeValue<'_>) -> Result<Part> {
    let keys = ["force", "frequency", "phase"];
    let wrong = |found: String| Error::usage(found, "{ force = …, frequency = …, phase = … }");
    let DeValue::Table(table) = value else { return Err(wrong(kind(value).to_owned())) };
    let mut found = [None, None, Some(0.0)];
    for (name, value) in table {
        let name = name.get_ref().as_ref();
        let slot = keys.iter().position(|key| *key == name);
        let slot =
            slot.and_then(|i| found.get_mut(i)).ok_or_else(|| wrong(format!("unknown key `{name}`")))?;
        *slot = Some(
            number(value.get_ref()).ok_or_else(|| wrong(format!("{name} is {}", kind(value.get_ref()))))?,
        );
    }
    match found {
        [Some(force), Some(frequency), Some(phase)] => Ok(Part { force, frequency, phase }),
        _ => Err(wrong("a sine without force or frequency".to_owned())),
    }
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().replace('_', "").parse().ok(),
        DeValue::Integer(integer) => {
            i64::from_str_radix(&integer.as_str().replace('_', ""), integer.radix()).ok().map(|i| i as f64)
        }
        _ => None,
    }
}

fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
    }
}
