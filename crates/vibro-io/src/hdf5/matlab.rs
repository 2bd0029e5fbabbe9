//! The variables of a MAT-file of version 7.3. `MATLAB_class` states the content of a dataset or a group.
//! Dimensions are reversed. Cells and fields of arrays of structs are references into the group `#refs#`.

use super::file::{Data, File, MOST_PATH, Member};
use crate::held::Held;
use crate::variables::{Array, Content};
use hdf5_reader::dataset::Dataset;
use hdf5_reader::{Attribute, Datatype};
use std::collections::HashMap;
use vibro_record::{Result, Values};

/// Classes of numbers.
const NUMBERS: &[&str] =
    &["double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"];

type Variables = Vec<(String, Content)>;

/// Group that holds cells and fields, and group that holds parts of objects.
const REFERENCES: &str = "#refs#";
const OBJECTS: &str = "#subsystem#";

/// Whether a member of a group has a MATLAB class.
pub fn is(members: &[(String, Member)]) -> bool {
    members.iter().any(|(_, member)| has(&member.attributes(), "MATLAB_class"))
}

fn has(attributes: &[Attribute], name: &str) -> bool {
    attributes.iter().any(|attribute| attribute.name == name)
}

/// All variables, named as MATLAB writes them.
pub fn variables(file: &mut File, mut members: Vec<(String, Member)>, survey: bool) -> Result<Variables> {
    let mut referred = HashMap::new();
    if let Some(at) = members.iter().position(|(name, _)| name == REFERENCES)
        && let Member::Group(group) = members.remove(at).1
    {
        let found = file.members(&group, "")?.into_iter();
        referred = found.map(|(_, member)| (member.address(), member)).collect();
    }
    let mut walk = VariableWalk { file, survey, referred, variables: Vec::new() };
    for (name, member) in members {
        if name == OBJECTS { walk.file.pass(&name, "object") } else { walk.member(&name, member)? }
    }
    Ok(walk.variables)
}

struct VariableWalk<'a> {
    file: &'a mut File,
    /// Whether extremes are enough instead of all values.
    survey: bool,
    /// Targets of references by address; each is used once.
    referred: HashMap<u64, Member>,
    variables: Variables,
}

impl VariableWalk<'_> {
    fn member(&mut self, name: &str, member: Member) -> Result<()> {
        let group = match member {
            Member::Dataset(dataset) => return self.dataset(name, &dataset),
            Member::Group(group) => group,
        };
        if has(&group.attributes().unwrap_or_default(), "MATLAB_sparse") {
            self.file.pass(name, "sparse matrix");
            return Ok(());
        }
        for (field, member) in self.file.members(&group, name)? {
            match member {
                // A field of an array of structs.
                Member::Dataset(dataset) if class(&dataset).is_none() => {
                    self.references(&dataset, name, &|i| format!("{name}({i}).{field}"))?;
                }
                member => self.member(&format!("{name}.{field}"), member)?,
            }
        }
        Ok(())
    }

    fn dataset(&mut self, name: &str, dataset: &Dataset) -> Result<()> {
        let class = class(dataset).unwrap_or_default();
        let empty = has(&dataset.attributes(), "MATLAB_empty");
        let single = matches!(dataset.dtype(), Datatype::FloatingPoint { size: 4, .. });
        let dimensions: Vec<u64> = dataset.shape().iter().rev().copied().collect();
        if class == "cell" && !empty {
            return self.references(dataset, name, &|i| format!("{name}{{{i}}}"));
        }
        let data = match class.as_str() {
            _ if empty => Some(Data::Numbers(Values::Real(Vec::new()).into())),
            "char" if dimensions.first() == Some(&1) => self.file.data(name, dataset, false),
            // A matrix is split into columns, which needs all its values.
            class if NUMBERS.contains(&class) => {
                let vector = dimensions.iter().filter(|n| **n > 1).count() == 1;
                self.file.data(name, dataset, self.survey && vector)
            }
            "char" => Some(Data::Other("char array of several rows")),
            "logical" => Some(Data::Other("logical array")),
            _ => Some(Data::Other("object")),
        };
        let content = match data {
            Some(Data::Numbers(Held::Values(Values::Real(values)))) if class == "char" => {
                let units: Vec<u16> = values.iter().map(|unit| *unit as u16).collect();
                Content::Text(String::from_utf16_lossy(&units))
            }
            Some(Data::Numbers(values)) => Content::Array(Array { dimensions, values, single }),
            Some(Data::Other(class)) => Content::Other(class),
            Some(_) => Content::Other("array of neither numbers nor text"),
            None => return Ok(()),
        };
        self.variables.push((name.to_owned(), content));
        Ok(())
    }

    /// Adds the targets of the references of a dataset.
    fn references(&mut self, dataset: &Dataset, name: &str, named: &dyn Fn(usize) -> String) -> Result<()> {
        if name.len() > MOST_PATH {
            self.file.pass(name, "cell array too deep in others");
            return Ok(());
        }
        let Some(Data::References(addresses)) = self.file.data(name, dataset, false) else {
            return Ok(());
        };
        for (i, address) in addresses.iter().enumerate() {
            if let Some(member) = self.referred.remove(address) {
                self.member(&named(i + 1), member)?;
            }
        }
        Ok(())
    }
}

fn class(dataset: &Dataset) -> Option<String> {
    dataset.attribute("MATLAB_class").and_then(|class| class.read_string()).ok()
}
