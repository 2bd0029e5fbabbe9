//! Contacts of the impact unit, and how a file writes them.

use super::machine::{Interface, Machine};
use crate::law::{FORMS, Law, LawDamping};
use serde::{Deserialize, Serialize};

/// Contact of two bodies.
///
/// As TOML: `restitution`, and where a law is known its name as `law` with `stiffness`, `exponent` and
/// `damping` as in `[contact]` of a rig.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ContactKeys", into = "ContactKeys")]
pub struct Contact {
    /// Restitution R of a rigid impact.
    pub restitution: f64,
    /// Law of the contact that gives way, where it is known. The damper is one where it has a law, on every
    /// rung; the other contacts are compliant on the rung [`Rung::Compliant`](super::Rung::Compliant).
    pub law: Option<Law>,
}

impl Contact {
    /// Rigid contact with a restitution.
    pub const fn rigid(restitution: f64) -> Contact {
        Contact { restitution, law: None }
    }
}

/// Keys of a contact in a file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct ContactKeys {
    restitution: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    law: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stiffness: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    exponent: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    damping: Option<f64>,
}

impl TryFrom<ContactKeys> for Contact {
    type Error = String;

    fn try_from(keys: ContactKeys) -> Result<Contact, String> {
        let ContactKeys { restitution, law, stiffness, exponent, damping } = keys;
        let names = || FORMS.iter().map(|form| form.name).collect::<Vec<_>>().join(", ");
        let Some(name) = law else {
            let stray = [("stiffness", stiffness), ("exponent", exponent), ("damping", damping)];
            return match stray.into_iter().find(|(_, value)| value.is_some()) {
                Some((key, _)) => Err(format!("{key} without a law; add law = \"…\", one of {}", names())),
                None => Ok(Contact::rigid(restitution)),
            };
        };
        let form = FORMS.iter().find(|form| form.name == name);
        let form = form.ok_or_else(|| format!("the law \"{name}\" is not known; known are {}", names()))?;
        let stiffness = stiffness.ok_or_else(|| format!("the law \"{name}\" needs a stiffness"))?;
        let damping = match form.damping {
            LawDamping::Lossless => damping.unwrap_or(0.0),
            _ => damping.ok_or_else(|| format!("the law \"{name}\" needs a damping"))?,
        };
        let law = form.law(stiffness, exponent.unwrap_or(form.exponent), damping);
        Ok(Contact { restitution, law: Some(law) })
    }
}

impl From<Contact> for ContactKeys {
    fn from(contact: Contact) -> ContactKeys {
        let Contact { restitution, law } = contact;
        ContactKeys {
            restitution,
            law: law.map(|law| law.form.name.to_owned()),
            stiffness: law.map(|law| law.stiffness),
            exponent: law.filter(|law| law.form.any_exponent).map(|law| law.exponent),
            damping: law
                .filter(|law| !matches!(law.form.damping, LawDamping::Lossless))
                .map(|law| law.damping),
        }
    }
}

/// The contacts of a machine as a table with one key an interface.
pub(super) mod contacts {
    use super::{Contact, Deserialize, Interface, Machine, Serialize};
    use serde::{Deserializer, Serializer};

    /// Keys of the interfaces, in the order of [`Interface::ALL`].
    #[derive(Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields, expecting = "a table")]
    struct Named {
        striker: Contact,
        bit: Contact,
        damper: Contact,
        buffer: Contact,
    }

    impl Default for Named {
        fn default() -> Named {
            Named::of(Machine::example().contacts)
        }
    }

    impl Named {
        fn of([striker, bit, damper, buffer]: [Contact; Interface::ALL.len()]) -> Named {
            Named { striker, bit, damper, buffer }
        }
    }

    pub fn serialize<S: Serializer>(all: &[Contact; Interface::ALL.len()], to: S) -> Result<S::Ok, S::Error> {
        Named::of(*all).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<[Contact; Interface::ALL.len()], D::Error> {
        let Named { striker, bit, damper, buffer } = Named::deserialize(from)?;
        Ok([striker, bit, damper, buffer])
    }
}
