//! Draft of a scene: keys from a file and from a command line, read in the same way.

use super::{Buffer, ContactKeys, Scene, Springs};
use crate::excitation::{Excitation, Part};
use crate::given::{Given, leaves};
use crate::least::{NumberRange, number};
use crate::parameter::Parameter;
use crate::rig::Rig;
use crate::uncertainty::Uncertainty;
use serde::Deserialize;
use std::path::Path;
use toml::de::DeTable;
use toml::{Table, Value};
use vibro_record::{Error, Result, Written, nearest};

/// Kinds of excitation, each with its keys.
const KINDS: [(&str, &[&str]); 4] = [
    ("sine", &["force", "frequency"]),
    ("impulse", &["impulse", "frequency"]),
    ("pulse", &["force", "width", "frequency"]),
    ("sines", &["parts", "frequency"]),
];

/// The tables of a file, beside the rig's own keys.
#[derive(Deserialize)]
#[expect(dead_code, reason = "deserialised only to check names and types; the excitation is built later")]
struct Sections {
    excitation: Option<ExcitationKeys>,
    contact: Option<ContactKeys>,
    buffer: Option<Buffer>,
    springs: Option<Springs>,
    uncertainty: Option<Uncertainty>,
}

/// Keys of all kinds of excitation.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
#[expect(dead_code, reason = "deserialised only to check names and types; the excitation is built later")]
struct ExcitationKeys {
    kind: Option<String>,
    force: Option<f64>,
    impulse: Option<f64>,
    width: Option<f64>,
    frequency: Option<f64>,
    parts: Option<Vec<Part>>,
}

/// Keys of a scene and their values; a value set later replaces an earlier one.
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
    given: Given,
}

impl Draft {
    /// Reads a TOML file.
    ///
    /// # Errors
    /// If it cannot be read, is not TOML, or holds an unknown key or a value of the wrong kind.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Draft> {
        let path = path.as_ref();
        let text = Given::read(path, "a rig as TOML text")?;
        let table = table(&text).map_err(|e| other_file(path, &text).unwrap_or(e).in_file(path))?;
        Ok(Draft { given: Given::new(Some(path.to_owned()), text, table) })
    }

    /// Reads TOML text.
    ///
    /// # Errors
    /// If it is not TOML, or holds an unknown key or a value of the wrong kind.
    pub fn from_toml(text: &str) -> Result<Draft> {
        Ok(Draft { given: Given::new(None, text.to_owned(), table(text)?) })
    }

    /// Sets one key by the text `key=value`, as it is typed; keys of a table have a dot:
    /// `excitation.force=0.5`. Words need no quotes. [`Draft::put`] takes a TOML value and does not check it.
    ///
    /// # Errors
    /// If the key is unknown or the value of the wrong kind.
    pub fn set(&mut self, assignment: &str) -> Result<()> {
        let mut later = Given::default();
        later.set(assignment, "", table)?;
        for (key, value) in leaves("", later.table) {
            self.put(&key, value);
        }
        Ok(())
    }

    /// Sets a key to a value, unchecked; keys of a table have a dot. A new kind of excitation drops the
    /// keys that do not belong to it. [`Draft::set`] checks, and takes text.
    pub fn put(&mut self, key: &str, value: impl Into<Value>) {
        let value = value.into();
        if let Some((_, belonging)) =
            KINDS.iter().find(|k| key == "excitation.kind" && value.as_str() == Some(k.0))
            && let Some(Value::Table(section)) = self.given.table.get_mut("excitation")
        {
            section.retain(|key, _| belonging.contains(&key));
        }
        self.given.put(key, value);
    }

    /// Whether a key was given.
    pub fn has(&self, key: &str) -> bool {
        self.given.get(key).is_some()
    }

    /// Keys of the rig that were not given and take the values of [`Rig::thesis`].
    pub fn left_out(&self) -> Vec<&'static str> {
        Parameter::of_rig().map(Parameter::name).filter(|key| !self.has(key)).collect()
    }

    /// The scene, checked.
    ///
    /// # Errors
    /// If a value is impossible, or a key of the excitation is missing or belongs to another kind; the error
    /// shows the line in the file.
    pub fn scene(&self) -> Result<Scene> {
        let (sections, rig_keys): (Table, Table) =
            self.given.table.clone().into_iter().partition(|(key, _)| Scene::TABLES.contains(&key.as_str()));
        let rig = Rig::deserialize(rig_keys).map_err(|e| unread(&e))?;
        let keys = Sections::deserialize(sections).map_err(|e| unread(&e))?;
        if let Some((key, error)) = rig.fault() {
            return Err(self.given.at(key, error));
        }
        let contact = keys.contact.unwrap_or_default();
        for (key, value, unit, least) in [
            ("contact.stiffness", contact.stiffness, "N/m", NumberRange::AboveZero),
            ("contact.damping", contact.damping, "N s/m", NumberRange::Zero),
            ("contact.exponent", contact.exponent, "", NumberRange::AboveZero),
            ("buffer.gap", keys.buffer.map(|b| b.gap), "m", NumberRange::Zero),
            ("springs.cubic1", keys.springs.map(|s| s.cubic1), "N/m³", NumberRange::Any),
            ("springs.cubic2", keys.springs.map(|s| s.cubic2), "N/m³", NumberRange::Any),
        ] {
            let checked = value.map_or(Ok(()), |value| number(key, value, unit, least));
            checked.map_err(|error| self.given.at(key, error))?;
        }
        let contact = contact.resolved().map_err(|(key, e)| self.given.at(&format!("contact.{key}"), e))?;
        let excitation_keys = self.given.table.get("excitation").and_then(Value::as_table);
        let excitation = excitation_keys.map(|section| self.excitation(section.clone())).transpose()?;
        let contact = Some(contact).filter(|c| *c != ContactKeys::default());
        let springs = keys.springs.filter(|s| *s != Springs::default());
        for (parameter, std) in keys.uncertainty.iter().flat_map(Uncertainty::all) {
            let key = format!("uncertainty.{}", parameter.name());
            number(&key, std, parameter.unit(), NumberRange::Zero)
                .map_err(|error| self.given.at(&key, error))?;
        }
        let (buffer, uncertainty) = (keys.buffer, keys.uncertainty);
        Ok(Scene { rig, excitation, contact, buffer, springs, uncertainty })
    }

    /// The excitation of the table `[excitation]`, checked.
    fn excitation(&self, mut section: Table) -> Result<Excitation> {
        // Each kind except a sine has a key of its own.
        let inferred = [("impulse", "impulse"), ("width", "pulse"), ("parts", "sines")];
        let inferred = inferred.into_iter().find(|(key, _)| section.contains_key(*key));
        let kind = section.get("kind").and_then(Value::as_str);
        let kind = kind.unwrap_or(inferred.map_or("sine", |(_, kind)| kind)).to_owned();
        let Some((_, belonging)) = KINDS.iter().find(|k| k.0 == kind) else {
            let found = format!("the excitation {kind:?} is not known");
            return Err(self
                .given
                .at("excitation.kind", Error::usage(found, "sine, impulse, pulse or sines")));
        };
        if let Some(stray) = section.keys().find(|key| *key != "kind" && !belonging.contains(&key.as_ref())) {
            let found = format!("excitation.{stray} does not belong to the excitation {kind:?}");
            let expected = format!("its keys: {}", belonging.join(", "));
            return Err(self.given.at(&format!("excitation.{stray}"), Error::usage(found, expected)));
        }
        // Several sines have their own frequencies; `frequency` scales all of them, with their ratios kept.
        let common_frequency = if kind == "sines" { section.remove("frequency") } else { None };
        let common_frequency = common_frequency.and_then(|hz| f64::deserialize(hz).ok());
        let optional = if kind == "sines" { "frequency" } else { "" };
        let missing = |key: &&&str| **key != optional && !section.contains_key(**key);
        if let Some(key) = belonging.iter().find(missing) {
            let found = format!("the excitation {kind:?} has no {key}");
            let error = Error::usage(found, format!("excitation.{key}")).setting(key);
            let error = self.given.at("excitation.kind", error);
            return Err(error.hint(format!("state {key}, in [excitation] of a rig's file")));
        }
        section.insert("kind".to_owned(), Value::String(kind));
        let excitation = Excitation::deserialize(section).map_err(|e| unread(&e))?;
        let excitation =
            common_frequency.map_or_else(|| excitation.clone(), |hz| excitation.at_frequency(hz));
        excitation.check().map_err(|error| {
            let key = error.settings().next().unwrap_or("kind");
            self.given.at(&format!("excitation.{key}"), error)
        })?;
        Ok(excitation)
    }
}

/// Parses a text, and checks that each key is known and each value of the right type.
fn table(text: &str) -> Result<Table> {
    let written = Written { text, ..Written::default() };
    let all = written.parse()?;
    let (sections, rig_keys): (DeTable<'_>, DeTable<'_>) =
        all.into_iter().partition(|(key, _)| Scene::TABLES.contains(&key.get_ref().as_ref()));
    if let Some((key, _)) = rig_keys.iter().find(|(key, _)| !Parameter::is_of_rig(key.get_ref())) {
        let known = Parameter::of_rig().map(Parameter::name).chain(Scene::TABLES).collect::<Vec<_>>();
        let found = format!("unknown key `{}`", key.get_ref());
        let error = match nearest(key.get_ref(), known.iter().copied()) {
            Some(near) => Error::usage(found, "").hint(format!("did you mean `{near}`?")),
            None => Error::usage(found, known.join(", ")),
        };
        return Err(error.excerpt(text, key.span()));
    }
    written.read::<Rig>(&rig_keys, 0..0)?;
    written.read::<Sections>(&sections, 0..0)?;
    written.read(&written.parse()?, 0..0)
}

/// Error for keys of the right type that do not form a valid value together.
fn unread(error: &toml::de::Error) -> Error {
    Error::usage(error.message(), "")
}

/// Error for a campaign or a hammer drill in place of a rig file; a campaign has the rig in a table, or lists
/// of tables.
fn other_file(path: &Path, text: &str) -> Option<Error> {
    let table: Table = toml::from_str(text).ok()?;
    if table.get("drill").is_some_and(Value::is_table) {
        let found = "[drill]: this is the impact unit of a hammer drill, not a rig";
        let hint = format!("vibro model drill {}", path.display());
        return Some(Error::usage(found, "the keys of a rig at the top").hint(hint));
    }
    let (key, _) = table.iter().find(|(key, value)| *key == "rig" || value.is_array())?;
    let expected =
        "the keys of a rig at the top, and [excitation], [contact], [buffer], [springs], [uncertainty]";
    Some(Error::usage(format!("[{key}]: this is a campaign, not a rig"), expected).hint(format!(
        "put what stands under [rig] into a file of its own; `vibro run {}` does what the campaign asks for",
        path.display()
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::{Impulses, Pulses, Sine, Sines};

    #[test]
    fn a_scene_of_every_part() {
        let text = "m1 = 1\nrestitution = 0.2\n[excitation]\nkind = \"pulse\"\nforce = 0.5\nwidth = 0.01\nfrequency = 5\n\
                    [contact]\nstiffness = 1e5\ndamping = 0\n[buffer]\ngap = 2e-3\ndamper_always = true\n\
                    [springs]\ncubic1 = -1e6\n";
        let scene = Scene::from_toml(text).unwrap();
        assert_eq!(scene.rig, Rig { m1: 1.0, restitution: 0.2, ..Rig::thesis() });
        assert_eq!(
            scene.excitation,
            Some(Excitation::Pulse(Pulses { force: 0.5, width: 0.01, frequency: 5.0 }))
        );
        let contact = ContactKeys { stiffness: Some(1e5), damping: Some(0.0), ..ContactKeys::default() };
        assert_eq!(
            (scene.contact, scene.buffer),
            (Some(contact), Some(Buffer { gap: 2e-3, damper_always: true }))
        );
        assert_eq!(scene.springs, Some(Springs { cubic1: -1e6, cubic2: 0.0 }));
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
            ("[excitation]\nforce = 1\nphase = 0", "line 3", "unknown key `phase`"),
            ("[excitation]\nkind = \"sine\"\nwidth = 1", "line 3", "excitation.width does not belong"),
            ("[excitation]\nforce = -1\nfrequency = 5", "line 2", "force is -1 N"),
            ("[excitation]\nkind = \"sine\"\nforce = 1", "line 2", "has no frequency"),
            ("m1 = -1", "line 1", "m1 is -1 kg"),
            ("m1 = \"heavy\"", "line 1", "m1 = \"heavy\"; expected a number"),
            ("gap = 1\ngap = 2", "line 2", "every key once"),
            ("excitation = 3", "line 1", "excitation = 3; expected a table"),
            ("[contact]\nstiffness = 0", "line 2", "contact.stiffness is 0 N/m"),
            ("[springs]\ncubic2 = inf", "line 2", "springs.cubic2 is inf N/m³"),
            ("[uncertainty]\ngap = -1e-6", "line 2", "uncertainty.gap is -0.000001 m"),
            ("[uncertainty]\ngapp = 1e-6", "line 2", "unknown key `gapp`"),
            ("[excitation]\nparts = [{force = 1}]", "line 2", "the key `frequency` is missing"),
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
        // Another kind drops the keys that do not belong to it.
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
