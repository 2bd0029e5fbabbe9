//! A scene in the making: keys from a file and from a command line, each with the line it stands on.

use super::given::{Given, KEYS, Value, parse};
use super::{Buffer, ContactKeys, Scene};
use crate::Rig;
use crate::excitation::{Excitation, Impulses, Pulses, Sine, Sines};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::de::DeTable;
use vibro_record::{Error, Place, Result};

/// Kinds of excitation, each with the keys that belong to it.
const KINDS: [(&str, &[&str]); 4] = [
    ("sine", &["force", "frequency"]),
    ("impulse", &["impulse", "frequency"]),
    ("pulse", &["force", "width", "frequency"]),
    ("sines", &["parts", "frequency"]),
];

/// Tables that only a campaign has.
const CAMPAIGN: [&str; 11] =
    ["rig", "sweep", "spectrum", "frf", "impacts", "drop", "pulse", "drill", "model", "fit", "compute"];

/// The complaint about a campaign where a rig file should stand.
fn campaign(path: &Path, text: &str) -> Option<Error> {
    let table = DeTable::parse(text).ok()?;
    let own = |key: &&str| table.get_ref().keys().any(|name| name.get_ref() == *key);
    let key = CAMPAIGN.iter().find(|key| own(key))?;
    let expected = "the keys of a rig at the top, and [excitation], [contact], [buffer]";
    if let Some(of_rig) = Rig::KEYS.iter().find(|key| own(key)) {
        let found = format!("[{key}] beside `{of_rig}` at the top: half a campaign, half a rig");
        return Some(
            Error::usage(found, expected)
                .hint(format!("take [{key}] out for a rig; in a campaign the rig's keys stand under [rig]")),
        );
    }
    let found = format!("[{key}]: this is a campaign, not a rig");
    Some(Error::usage(found, expected).hint(format!(
        "put what stands under [rig] into a file of its own; `vibro run {}` does what the campaign asks for",
        path.display()
    )))
}

/// Keys of a scene, of which later ones replace earlier ones.
///
/// ```
/// use vibro_model::Draft;
/// let mut draft = Draft::default();
/// draft.set("gap=0.5e-3")?;
/// draft.set("excitation.force = 0.5")?;
/// draft.put("excitation.frequency", 11.0);
/// assert_eq!(draft.scene()?.rig.gap, 0.5e-3);
/// # Ok::<(), vibro_record::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Draft {
    path: Option<PathBuf>,
    text: String,
    given: BTreeMap<String, Given>,
}

impl Draft {
    /// Reads a TOML file.
    ///
    /// # Errors
    /// If it cannot be read, is not TOML, or holds an unknown key or a value of the wrong kind.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Draft> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|e| Error::io("open", path, e))?;
        let text = String::from_utf8(bytes).map_err(|e| {
            let place = Place::byte(path, e.utf8_error().valid_up_to() as u64);
            Error::input(place, "bytes that are not UTF-8", "a rig as TOML text")
        })?;
        let mut draft = Draft { path: Some(path.to_owned()), text, given: BTreeMap::new() };
        draft.given =
            parse(&draft.text).map_err(|e| campaign(path, &draft.text).unwrap_or(e).in_file(path))?;
        Ok(draft)
    }

    /// Reads TOML text.
    ///
    /// # Errors
    /// If it is not TOML, or holds an unknown key or a value of the wrong kind.
    pub fn from_toml(text: &str) -> Result<Draft> {
        Ok(Draft { path: None, text: text.to_owned(), given: parse(text)? })
    }

    /// Sets one key as `key=value`, tables with a dot: `excitation.force=0.5`. Words need no quotes.
    ///
    /// # Errors
    /// If the key is unknown or the value of the wrong kind.
    pub fn set(&mut self, assignment: &str) -> Result<()> {
        let wrong = || {
            Error::usage(
                format!("{assignment:?} sets no key"),
                "KEY=VALUE, such as gap=0.5e-3 or excitation.force=0.5",
            )
        };
        let (key, value) = assignment.split_once('=').ok_or_else(wrong)?;
        let (key, value) = (key.trim(), value.trim());
        if key.is_empty() || value.is_empty() || value.contains('\n') {
            return Err(wrong());
        }
        // TOML knows no `.3` and no `5.`, people do.
        let number = value.parse::<f64>().ok().map(|v| format!("{key} = {v:?}"));
        let plain = format!("{key} = {value}");
        let text = if DeTable::parse(&plain).is_ok() {
            plain
        } else {
            number.unwrap_or_else(|| format!("{key} = {value:?}"))
        };
        let given = parse(&text).map_err(|e| {
            let e = e.aside(format!("in the assignment {assignment}"));
            match value.replacen(',', ".", 1) {
                point if point != value && point.parse::<f64>().is_ok() => {
                    e.hint(format!("a decimal point: {key}={point}"))
                }
                _ => e,
            }
        })?;
        for (key, one) in given {
            self.insert(&key, one.value);
        }
        Ok(())
    }

    /// Sets a key to a number; a table's key with a dot.
    pub fn put(&mut self, key: &str, value: f64) {
        self.insert(key, Value::Number(value));
    }

    /// Sets the kind of the excitation; keys that do not belong to it are dropped.
    pub fn drive(&mut self, kind: &str) {
        self.insert("excitation.kind", Value::Word(kind.to_owned()));
    }

    fn insert(&mut self, key: &str, value: Value) {
        if let (true, Value::Word(kind)) = (key == "excitation.kind", &value)
            && let Some((_, keys)) = KINDS.iter().find(|k| k.0 == kind.as_str())
        {
            self.given
                .retain(|name, _| name.strip_prefix("excitation.").is_none_or(|key| keys.contains(&key)));
        }
        self.given.insert(key.to_owned(), Given { value, span: None });
    }

    /// Whether a key was given.
    pub fn has(&self, key: &str) -> bool {
        self.given.contains_key(key)
    }

    /// Keys of the rig that were not given and take the values of [`Rig::thesis`].
    pub fn left_out(&self) -> Vec<&'static str> {
        Rig::KEYS.into_iter().filter(|key| !self.has(key)).collect()
    }

    /// The scene, checked.
    ///
    /// # Errors
    /// If a value is impossible, or a key of the excitation is missing or belongs to another kind; the complaint points at its line
    /// where it stands in the file.
    pub fn scene(&self) -> Result<Scene> {
        let mut rig = Rig::thesis();
        let slots = [
            &mut rig.m1,
            &mut rig.m2,
            &mut rig.k1,
            &mut rig.k2,
            &mut rig.c1,
            &mut rig.c2,
            &mut rig.gap,
            &mut rig.restitution,
        ];
        for (key, slot) in Rig::KEYS.into_iter().zip(slots) {
            *slot = self.number(key).unwrap_or(*slot);
        }
        if let Some((key, error)) = rig.fault() {
            return Err(self.at(key, error));
        }
        let contact = ContactKeys {
            stiffness: self.positive("contact.stiffness", "N/m", false)?,
            damping: self.positive("contact.damping", "N s/m", true)?,
            exponent: self.positive("contact.exponent", "", false)?,
        };
        let buffer = self.positive("buffer.gap", "m", true)?.map(|gap| Buffer { gap });
        let contact = (contact != ContactKeys::default()).then_some(contact);
        Ok(Scene { rig, excitation: self.excitation()?, contact, buffer })
    }

    fn number(&self, key: &str) -> Option<f64> {
        match self.given.get(key)?.value {
            Value::Number(value) => Some(value),
            _ => None,
        }
    }

    fn positive(&self, key: &str, unit: &str, zero: bool) -> Result<Option<f64>> {
        let Some(value) = self.number(key) else { return Ok(None) };
        if value.is_finite() && (value > 0.0 || (zero && value == 0.0)) {
            return Ok(Some(value));
        }
        let expected = if zero { "a finite value of 0 or more" } else { "a finite value above 0" };
        Err(self.at(key, Error::usage(format!("{key} is {value} {unit}").trim_end().to_owned(), expected)))
    }

    fn excitation(&self) -> Result<Option<Excitation>> {
        let has = |key: &str| self.has(&format!("excitation.{key}"));
        let keys = KEYS.iter().filter_map(|key| key.strip_prefix("excitation."));
        if !keys.clone().any(has) {
            return Ok(None);
        }
        let inferred = match (has("impulse"), has("width"), has("parts")) {
            (true, ..) => "impulse",
            (_, true, _) => "pulse",
            (.., true) => "sines",
            _ => "sine",
        };
        let kind = match self.given.get("excitation.kind").map(|g| &g.value) {
            Some(Value::Word(kind)) => kind.as_str(),
            _ => inferred,
        };
        let Some((_, belonging)) = KINDS.iter().find(|k| k.0 == kind) else {
            let error = Error::usage(
                format!("the excitation {kind:?} is not known"),
                "sine, impulse, pulse or sines",
            );
            return Err(self.at("excitation.kind", error));
        };
        if let Some(stray) = keys.clone().find(|key| *key != "kind" && has(key) && !belonging.contains(key)) {
            let error = Error::usage(
                format!("excitation.{stray} does not belong to the excitation {kind:?}"),
                format!("its keys: {}", belonging.join(", ")),
            );
            return Err(self.at(&format!("excitation.{stray}"), error));
        }
        let need = |key: &'static str| {
            self.number(&format!("excitation.{key}")).ok_or_else(|| {
                let error = Error::usage(
                    format!("the excitation {kind:?} has no {key}"),
                    format!("excitation.{key}"),
                );
                self.at("excitation.kind", error)
                    .hint(format!("state {key}, in [excitation] of a rig's file"))
                    .setting(key)
            })
        };
        let excitation = match kind {
            "sine" => Excitation::Sine(Sine { force: need("force")?, frequency: need("frequency")? }),
            "impulse" => {
                Excitation::Impulse(Impulses { impulse: need("impulse")?, frequency: need("frequency")? })
            }
            "pulse" => Excitation::Pulse(Pulses {
                force: need("force")?,
                width: need("width")?,
                frequency: need("frequency")?,
            }),
            _ => {
                let parts = match self.given.get("excitation.parts").map(|g| &g.value) {
                    Some(Value::Parts(parts)) => parts.clone(),
                    _ => Vec::new(),
                };
                let sines = Excitation::Sines(Sines { parts });
                match self.number("excitation.frequency") {
                    Some(frequency) => sines.at_frequency(frequency),
                    None => sines,
                }
            }
        };
        excitation.check().map_err(|error| {
            let text = error.to_string();
            let key = belonging.iter().find(|key| text.starts_with(*key)).unwrap_or(&"kind");
            self.at(&format!("excitation.{key}"), error)
        })?;
        Ok(Some(excitation))
    }

    /// Points an error at the line of a key.
    fn at(&self, key: &str, error: Error) -> Error {
        match self.given.get(key).and_then(|g| g.span.clone()) {
            Some(span) => {
                let error = error.excerpt(&self.text, span);
                self.path.iter().fold(error, Error::in_file)
            }
            None => error,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::Part;

    #[test]
    fn a_scene_of_every_part() {
        let text = "m1 = 1\nrestitution = 0.2\n[excitation]\nkind = \"pulse\"\nforce = 0.5\nwidth = 0.01\nfrequency = 5\n\
                    [contact]\nstiffness = 1e5\ndamping = 0\n[buffer]\ngap = 2e-3\n";
        let scene = Scene::from_toml(text).unwrap();
        assert_eq!(scene.rig, Rig { m1: 1.0, restitution: 0.2, ..Rig::thesis() });
        assert_eq!(
            scene.excitation,
            Some(Excitation::Pulse(Pulses { force: 0.5, width: 0.01, frequency: 5.0 }))
        );
        let contact = ContactKeys { stiffness: Some(1e5), damping: Some(0.0), exponent: None };
        assert_eq!((scene.contact, scene.buffer), (Some(contact), Some(Buffer { gap: 2e-3 })));
        assert_eq!(Draft::from_toml(text).unwrap().left_out(), ["m2", "k1", "k2", "c1", "c2", "gap"]);
        let json = serde_json::to_value(&scene).unwrap();
        assert_eq!((&json["m1"], &json["excitation"]["kind"]), (&1.0.into(), &"pulse".into()));
        let several =
            "[excitation]\nparts = [{force = 0.1, frequency = 4}, {force = 0.2, frequency = 6.0, phase = 1}]";
        let parts = vec![
            Part { force: 0.1, frequency: 4.0, phase: 0.0 },
            Part { force: 0.2, frequency: 6.0, phase: 1.0 },
        ];
        assert_eq!(Scene::from_toml(several).unwrap().excitation, Some(Excitation::Sines(Sines { parts })));
        assert_eq!(Scene::from_toml("").unwrap(), Scene::thesis());
    }

    #[test]
    fn mistakes_point_at_their_line() {
        for (text, line, words) in [
            ("gap = 1e-3\nmass1 = 1", "line 2", "unknown key `mass1`"),
            ("\n[excitation]\nkind = \"saw\"", "line 3", "the excitation \"saw\" is not known"),
            ("[excitation]\nforce = 1\nphase = 0", "line 3", "unknown key `excitation.phase`"),
            ("[excitation]\nkind = \"sine\"\nwidth = 1", "line 3", "excitation.width does not belong"),
            ("[excitation]\nforce = -1\nfrequency = 5", "line 2", "force is -1 N"),
            ("[excitation]\nkind = \"sine\"\nforce = 1", "line 2", "has no frequency"),
            ("m1 = -1", "line 1", "m1 is -1 kg"),
            ("m1 = \"heavy\"", "line 1", "m1 is text; expected a number"),
            ("gap = 1\ngap = 2", "line 2", "duplicate key"),
            ("excitation = 3", "line 1", "excitation is no table"),
            ("[contact]\nstiffness = 0", "line 2", "contact.stiffness is 0 N/m"),
            ("[excitation]\nparts = [{force = 1}]", "line 2", "without force or frequency"),
            ("restitution = nan", "line 1", "restitution is NaN"),
            ("m1 =", "line 1", ""),
        ] {
            let error = Scene::from_toml(text).unwrap_err().to_string();
            assert!(error.contains(line) && error.contains(words), "{text}: {error}");
        }
    }

    #[test]
    fn settings_replace_keys_of_the_file() {
        let text = "gap = 2e-3\n[excitation]\nkind = \"sine\"\nforce = 0.5\nfrequency = 5";
        let mut draft = Draft::from_toml(text).unwrap();
        draft.set("gap=1e-4").unwrap();
        draft.put("excitation.frequency", 7.0);
        let scene = draft.scene().unwrap();
        assert_eq!(scene.rig.gap, 1e-4);
        assert_eq!(scene.excitation, Some(Excitation::Sine(Sine { force: 0.5, frequency: 7.0 })));
        // Another kind drops what does not belong to it.
        draft.set("excitation.kind=impulse").unwrap();
        draft.set("excitation.impulse=9e-3").unwrap();
        let impulses = Impulses { impulse: 9e-3, frequency: 7.0 };
        assert_eq!(draft.scene().unwrap().excitation, Some(Excitation::Impulse(impulses)));
        for wrong in ["gap", "=3", "gap=", "gap=wide", "gapp=1", "a b=1", "gap=1\nm1=2"] {
            let error = draft.clone().set(wrong).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{wrong}: {error}");
        }
        draft.set("m2 = inf").unwrap();
        assert!(draft.scene().unwrap().rig.has_wall());
        draft.set("m1 = inf").unwrap();
        assert!(draft.scene().is_err());
    }
}
