//! Ranges of the numbers of an impact unit.

use super::machine::{Interface, Machine};
use crate::given::leaves;
use crate::least::{NumberRange, number};
use vibro_record::{Error, Result};

/// Keys of the contacts, in the order of [`Interface::ALL`].
const CONTACTS: [&str; 4] = ["contacts.striker", "contacts.bit", "contacts.damper", "contacts.buffer"];
/// Largest ratio of two masses: impulses pass the chain by the ratios of its masses.
const MOST_RATIO: f64 = 1e6;

impl Machine {
    /// Checks that the numbers are possible.
    ///
    /// # Errors
    /// If one is not; the error names its key.
    pub fn check(&self) -> Result<()> {
        self.fault().map_or(Ok(()), |(_, error)| Err(error))
    }

    /// Unit of a key in a file; empty where it has none.
    pub fn unit_of(key: &str) -> &'static str {
        Machine::example().numbers().into_iter().find(|row| row.0 == key).map_or("", |row| row.2)
    }

    /// Unit of a key of this machine: that of a damping depends on the law of its contact.
    pub fn unit(&self, key: &str) -> &'static str {
        let damped = |name: &str| key.strip_prefix(name) == Some(".damping");
        let contact = self.contacts.iter().zip(CONTACTS).find(|(_, name)| damped(name));
        let law = contact.and_then(|(contact, _)| contact.law);
        law.map_or_else(|| Machine::unit_of(key), |law| law.form.damping_unit)
    }

    /// Value of a key in a file; `None` where that is no number.
    pub fn value(&self, key: &str) -> Option<f64> {
        let all = leaves("", toml::Table::try_from(self).ok()?);
        let (_, value) = all.into_iter().find(|(name, _)| name == key)?;
        value.as_float().or_else(|| Some(value.as_integer()? as f64))
    }

    /// Key, value, unit and range of every number that is checked by itself.
    fn numbers(&self) -> Vec<(&'static str, f64, &'static str, NumberRange)> {
        use NumberRange::{AboveZero, Any, Zero};
        let Machine { crank, cushion, flow, striker, intermediate, bit, gravity, .. } = self;
        let mut rows = vec![
            ("crank.radius", crank.radius, "m", AboveZero),
            // Infinite for a harmonic motion.
            ("crank.rod", crank.rod.min(f64::MAX), "m", AboveZero),
            ("crank.frequency", crank.frequency, "Hz", AboveZero),
            ("cushion.area", cushion.area, "m²", AboveZero),
            ("cushion.length", cushion.length, "m", AboveZero),
            ("cushion.dead_volume", cushion.dead_volume, "m³", Zero),
            ("cushion.ambient", cushion.ambient, "Pa", AboveZero),
            ("cushion.temperature", cushion.temperature, "K", AboveZero),
            ("flow.leakage", flow.leakage, "m³/(s Pa)", Zero),
            ("striker.mass", striker.mass, "kg", AboveZero),
            ("striker.friction", striker.friction, "N", Zero),
            ("striker.damping", striker.damping, "N s/m", Zero),
            ("striker.strike", striker.strike, "m", Any),
            ("intermediate.mass", intermediate.mass, "kg", AboveZero),
            ("intermediate.travel", intermediate.travel, "m", AboveZero),
            ("bit.mass", bit.mass, "kg", AboveZero),
            ("bit.length", bit.length, "m", AboveZero),
            ("bit.clearance", bit.clearance, "m", Zero),
            ("gravity", *gravity, "m/s²", Any),
        ];
        for vent in &flow.vents {
            rows.extend([("flow.vents", vent.position, "m", Any), ("flow.vents", vent.area, "m²", Zero)]);
        }
        rows
    }

    /// The first impossible number: its key in a file, with dots, and the error.
    pub(super) fn fault(&self) -> Option<(String, Error)> {
        let rows = self.numbers();
        let numbers =
            rows.into_iter().map(|(key, value, unit, range)| (key, number(key, value, unit, range)));
        let contacts = Interface::ALL.into_iter().zip(CONTACTS).map(|(interface, key)| {
            let contact = self.contacts[interface as usize];
            let restitution = number("restitution", contact.restitution, "", NumberRange::Part);
            (key, restitution.and_then(|()| contact.law.map_or(Ok(()), |law| law.check())))
        });
        let all = numbers.chain(contacts).chain(self.together());
        all.into_iter().find_map(|(key, checked)| Some((key.to_owned(), checked.err()?)))
    }

    /// Ranges that depend on other numbers.
    fn together(&self) -> [(&'static str, Result<()>); 6] {
        let Machine { crank, cushion, flow, striker, intermediate, bit, .. } = self;
        let refused = |found: String, expected: &str| Err(Error::usage(found, expected));
        let unless = |fine: bool, error: Result<()>| if fine { Ok(()) } else { error };
        let masses = [striker.mass, intermediate.mass, bit.mass];
        let (least, most) = masses.iter().fold((f64::INFINITY, 0.0f64), |(a, b), m| (a.min(*m), b.max(*m)));
        [
            (
                "crank.rod",
                unless(
                    crank.rod > crank.radius,
                    refused(
                        format!("crank.rod is {} m", crank.rod),
                        "a length above the crank radius, or inf",
                    ),
                ),
            ),
            (
                "cushion.exponent",
                unless(
                    (1.0..=1.4).contains(&cushion.exponent),
                    refused(format!("cushion.exponent is {}", cushion.exponent), "a value from 1 to 1.4"),
                ),
            ),
            (
                "flow.critical_ratio",
                unless(
                    (0.01..=0.9).contains(&flow.critical_ratio),
                    refused(
                        format!("flow.critical_ratio is {}", flow.critical_ratio),
                        "a value from 0.01 to 0.9",
                    ),
                ),
            ),
            (
                "flow.vents",
                unless(
                    flow.vents.windows(2).all(|pair| pair[0].position < pair[1].position),
                    refused(
                        "flow.vents with positions that do not rise".to_owned(),
                        "rows in the order of the striker's position",
                    ),
                ),
            ),
            (
                "striker.mass",
                unless(
                    most <= MOST_RATIO * least,
                    refused(
                        format!("masses from {least} kg to {most} kg"),
                        "masses within a factor of a million",
                    ),
                ),
            ),
            (
                "striker.strike",
                unless(
                    cushion.length + striker.strike > 0.0,
                    refused(
                        format!("striker.strike is {} m", striker.strike),
                        "a position in front of the piston at top dead centre",
                    ),
                ),
            ),
        ]
    }
}
