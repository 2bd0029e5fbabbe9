//! Draft of an impact unit: the table `[drill]` of a file, and keys from a command line.

use super::machine::Machine;
use crate::given::{Given, leaves};
use serde::Deserialize;
use std::fmt::Write as _;
use std::path::Path;
use toml::{Table, Value};
use vibro_record::{Error, Result, Written};

/// Name of the table, with the dot before its keys.
const DRILL: &str = "drill.";

/// File of an impact unit.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
#[expect(dead_code, reason = "deserialised only to check names and types")]
struct DrillFile {
    drill: Machine,
}

/// Keys of an impact unit and their values; a value set later replaces an earlier one, and what is left out
/// is that of [`Machine::example`].
///
/// ```
/// use vibro_model::drill::MachineDraft;
/// let mut draft = MachineDraft::from_toml("[drill.striker]\nmass = 0.2")?;
/// draft.set("crank.frequency=30")?;
/// let machine = draft.machine()?;
/// assert_eq!((machine.striker.mass, machine.crank.frequency), (0.2, 30.0));
/// assert!(draft.left_out().contains(&"bit.mass".to_owned()));
/// # Ok::<(), vibro_record::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct MachineDraft {
    given: Given,
}

impl MachineDraft {
    /// Reads a TOML file with a table `[drill]`.
    ///
    /// # Errors
    /// If it cannot be read, is not TOML, or holds an unknown key or a value of the wrong kind.
    pub fn from_path(path: impl AsRef<Path>) -> Result<MachineDraft> {
        let path = path.as_ref();
        let text = Given::read(path, "a hammer drill as TOML text")?;
        let table = table(&text).map_err(|e| other_file(&text).unwrap_or(e).in_file(path))?;
        Ok(MachineDraft { given: Given::new(Some(path.to_owned()), text, table) })
    }

    /// Reads TOML text.
    ///
    /// # Errors
    /// If it is not TOML, or holds an unknown key or a value of the wrong kind.
    pub fn from_toml(text: &str) -> Result<MachineDraft> {
        Ok(MachineDraft { given: Given::new(None, text.to_owned(), table(text)?) })
    }

    /// Sets one key by the text `key=value`, as it is typed: `cushion.length=0.02`.
    ///
    /// # Errors
    /// If the key is unknown or the value of the wrong kind.
    pub fn set(&mut self, assignment: &str) -> Result<()> {
        self.given.set(assignment, DRILL, assigned)
    }

    /// Sets a key to a number, such as `cushion.length`.
    ///
    /// # Errors
    /// If there is no such key, or it takes no number.
    pub fn put(&mut self, key: &str, value: f64) -> Result<()> {
        self.set(&format!("{key} = {value:?}"))
    }

    /// Keys that were not given, with dots.
    pub fn left_out(&self) -> Vec<String> {
        let all = Table::try_from(Machine::example()).unwrap_or_default();
        let contact = |key: &str| {
            let mut parts = key.split('.');
            parts.next() == Some("contacts") && parts.nth(1).is_some_and(|key| key != "restitution")
        };
        let keys = leaves("", all).into_iter().map(|(key, _)| key);
        // A contact without a law is a complete one.
        keys.filter(|key| !contact(key) && self.given.get(&format!("{DRILL}{key}")).is_none()).collect()
    }

    /// The machine, checked.
    ///
    /// # Errors
    /// If a value is impossible; the error shows the line in the file.
    pub fn machine(&self) -> Result<Machine> {
        let mut drill = self.given.table.get("drill").cloned().unwrap_or_else(|| Value::Table(Table::new()));
        complete_contacts(&mut drill);
        let machine = Machine::deserialize(drill).map_err(|e| Error::usage(e.message(), ""))?;
        match machine.fault() {
            Some((key, error)) => Err(self.given.at(&format!("{DRILL}{key}"), error)),
            None => Ok(machine),
        }
    }
}

/// Parses a text, and checks that each key is known and each value of the right type.
fn table(text: &str) -> Result<Table> {
    let written = Written { text, ..Written::default() };
    let all = written.parse()?;
    written.read::<DrillFile>(&all, 0..0)?;
    written.read(&all, 0..0)
}

/// Parses an assignment. A key of a contact is checked within a complete contact: the other keys are those of
/// the file.
fn assigned(text: &str) -> Result<Table> {
    let key = text.split('=').next().unwrap_or_default().trim();
    let contact = key.rsplit_once('.').filter(|(contact, _)| contact.starts_with("drill.contacts."));
    let Some((contact, own)) = contact else { return table(text) };
    let all =
        [("restitution", "0.5"), ("law", "\"hunt-crossley\""), ("stiffness", "1.0"), ("damping", "0.0")];
    let mut whole = text.to_owned();
    for (name, value) in all.iter().filter(|(name, _)| *name != own) {
        let _ = write!(whole, "\n{contact}.{name} = {value}");
    }
    table(&whole)?;
    toml::from_str(text).map_err(|e| Error::usage(e.message(), ""))
}

/// Completes contacts of which only single keys are set, with those of the example.
fn complete_contacts(drill: &mut Value) {
    let Some(contacts) = drill.get_mut("contacts").and_then(Value::as_table_mut) else { return };
    let example = Table::try_from(Machine::example()).unwrap_or_default();
    for (name, contact) in contacts.iter_mut() {
        let own = contact.as_table_mut().filter(|own| !own.contains_key("restitution"));
        let known = example.get("contacts").and_then(|all| all.get(name)).and_then(Value::as_table);
        for (own, known) in own.into_iter().zip(known) {
            for (key, value) in known {
                own.entry(key).or_insert_with(|| value.clone());
            }
        }
    }
}

/// Error for a file without a table `[drill]`.
fn other_file(text: &str) -> Option<Error> {
    let table: Table = toml::from_str(text).ok()?;
    let expected = "a table [drill] with the impact unit";
    let hint = "the keys of a hammer drill stand under [drill], [drill.crank], [drill.cushion]";
    match table.get("drill") {
        Some(Value::Array(_)) => Some(Error::usage("[[drill]]: this is a campaign", expected).hint(hint)),
        Some(_) => None,
        None => Some(Error::usage("no table [drill]", expected).hint(hint)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drill::{Contact, Interface};

    #[test]
    fn a_machine_is_written_and_read_back() {
        let mut machine = Machine::example().at_speed(30.0);
        machine.contacts[Interface::Buffer as usize] = Contact::rigid(0.7);
        let mut file = Table::new();
        file.insert("drill".to_owned(), Value::try_from(&machine).unwrap());
        let draft = MachineDraft { given: Given::new(None, String::new(), file) };
        assert_eq!((draft.machine().unwrap(), draft.left_out()), (machine, Vec::new()));
        assert_eq!(MachineDraft::from_toml("[drill]").unwrap().machine().unwrap(), Machine::example());
    }

    #[test]
    fn the_file_of_the_example_is_the_example() {
        let text = include_str!("../../../../examples/hammer_drill/drill.toml");
        let draft = MachineDraft::from_toml(text).unwrap();
        assert_eq!((draft.machine().unwrap(), draft.left_out()), (Machine::example(), Vec::new()));
    }

    #[test]
    fn one_number_of_a_contact_can_be_set() {
        let mut expected = Machine::example();
        let law = expected.contacts[Interface::Striker as usize].law.as_mut().unwrap();
        (law.damping, law.stiffness) = (0.05, 1e10);
        let own = "[drill.contacts.striker]\nrestitution = 0.8\nlaw = \"hunt-crossley\"\nstiffness = 1e9\n\
                   exponent = 1.5\ndamping = 1";
        for file in ["[drill]", own] {
            let mut draft = MachineDraft::from_toml(file).unwrap();
            draft.set("contacts.striker.damping=0.05").unwrap();
            draft.put("contacts.striker.stiffness", 1e10).unwrap();
            assert_eq!(draft.machine().unwrap(), expected, "{file}");
            assert_eq!(expected.unit("contacts.striker.damping"), "s/m");
            assert_eq!(expected.unit("contacts.damper.damping"), "N s/m");
        }
    }

    #[test]
    fn mistakes_point_at_their_line() {
        for (text, line, words) in [
            ("[drill]\n[drill.crank]\nradius = -0.01", "line 3", "crank.radius is -0.01 m"),
            ("[drill]\ngravity = 9.81\nspeed = 3", "line 3", "unknown key `speed`"),
            ("[drill.cushion]\nlenght = 0.02", "line 2", "did you mean `length`"),
            ("[drill.striker]\nmass = \"140 g\"", "line 2", "expected a number"),
            ("[drill.cushion]\nexponent = 1.67", "line 2", "a value from 1 to 1.4"),
            ("[drill.flow]\nvents = [{position = 0.01}]", "line 2", "the key `area` is missing"),
            ("[drill.contacts.bit]\nrestitution = 1.2", "line 1", "restitution is 1.2"),
            ("[drill.contacts.bit]\nrestitution = 0.8\nstiffness = 1e9", "line 1", "stiffness without a law"),
            (
                "[drill.contacts.bit]\nrestitution = 0.8\nlaw = \"glue\"",
                "line 1",
                "known are kelvin-voigt, hertz",
            ),
            ("[rig]\nm1 = 1", "", "unknown table `rig`"),
        ] {
            let error =
                MachineDraft::from_toml(text).and_then(|draft| draft.machine()).unwrap_err().to_string();
            assert!(error.contains(line) && error.contains(words), "{text}: {error}");
        }
        let mut draft = MachineDraft::from_toml("[drill.contacts.bit]\nrestitution = 0.8").unwrap();
        draft.put("contacts.bit.damping", 0.1).unwrap();
        assert!(draft.machine().unwrap_err().to_string().contains("damping without a law"));
        let error = draft.put("contacts.striker.damp", 0.1).unwrap_err().to_string();
        assert!(error.contains("unknown key `damp`"), "{error}");
        let mut draft = MachineDraft::from_toml("[drill]").unwrap();
        draft.put("flow.leakage", -1.0).unwrap();
        assert!(draft.machine().unwrap_err().to_string().contains("flow.leakage is -1"));
        assert!(draft.set("cushion.lenght=1").unwrap_err().to_string().contains("did you mean"));
        assert!(draft.put("cushion", 1.0).is_err());
    }
}
