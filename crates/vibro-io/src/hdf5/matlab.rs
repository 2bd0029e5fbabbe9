//! The variables of a MAT-file of version 7.3: `MATLAB_class` names what a dataset or a group holds, dimensions are reversed, cells and fields of
//! arrays of structs are references into the group `#refs#`.

use super::file::{Data, File, Member};
use crate::mat::variable::{Array, Content};
use hdf5_reader::dataset::Dataset;
use hdf5_reader::group::Group;
use hdf5_reader::{Attribute, Datatype};
use std::collections::HashMap;
use vibro_record::{Result, Values};

type Variables = Vec<(String, Content)>;

/// Where cells and fields are, and where parts of objects are.
const REFERENCES: &str = "#refs#";
const OBJECTS: &str = "#subsystem#";

/// Whether something in a group is of a class of MATLAB.
pub fn is(members: &[Member]) -> bool {
    let of = |attributes: &[Attribute]| attributes.iter().any(|attribute| attribute.name == "MATLAB_class");
    members.iter().any(|member| match member {
        Member::Group(_, group) => group.attributes().is_ok_and(|attributes| of(&attributes)),
        Member::Dataset(_, dataset) => of(&dataset.attributes()),
    })
}

/// All variables, named as MATLAB writes them.
pub fn variables(file: &mut File, members: Vec<Member>) -> Result<Variables> {
    let mut referred = HashMap::new();
    let mut own = Vec::new();
    for member in members {
        match member {
            Member::Group(name, group) if name == REFERENCES => {
                for member in file.members(&group, "")? {
                    let address = match &member {
                        Member::Group(_, group) => group.address(),
                        Member::Dataset(_, dataset) => dataset.address(),
                    };
                    referred.insert(address, member);
                }
            }
            Member::Group(name, _) if name == OBJECTS => file.pass(&name, "object"),
            member => own.push(member),
        }
    }
    let mut walk = Walk { file, referred, variables: Vec::new() };
    for member in own {
        let name = match &member {
            Member::Group(name, _) | Member::Dataset(name, _) => name.clone(),
        };
        walk.member(&name, member)?;
    }
    Ok(walk.variables)
}

struct Walk<'a> {
    file: &'a mut File,
    /// By address; each is taken once.
    referred: HashMap<u64, Member>,
    variables: Variables,
}

impl Walk<'_> {
    fn member(&mut self, name: &str, member: Member) -> Result<()> {
        match member {
            Member::Group(_, group) => self.group(name, &group),
            Member::Dataset(_, dataset) => self.dataset(name, &dataset),
        }
    }

    /// A struct, or an array of structs, whose fields are references.
    fn group(&mut self, name: &str, group: &Group) -> Result<()> {
        let attributes = group.attributes().unwrap_or_default();
        if attributes.iter().any(|attribute| attribute.name == "MATLAB_sparse") {
            self.file.pass(name, "sparse matrix");
            return Ok(());
        }
        for member in self.file.members(group, name)? {
            match member {
                Member::Dataset(field, dataset) if class(&dataset).is_none() => {
                    self.references(&dataset, name, &|i| format!("{name}({i}).{field}"))?;
                }
                Member::Dataset(field, dataset) => self.dataset(&format!("{name}.{field}"), &dataset)?,
                Member::Group(field, inner) => self.group(&format!("{name}.{field}"), &inner)?,
            }
        }
        Ok(())
    }

    fn dataset(&mut self, name: &str, dataset: &Dataset) -> Result<()> {
        let class = class(dataset).unwrap_or_default();
        let empty = dataset.attributes().iter().any(|attribute| attribute.name == "MATLAB_empty");
        let single = matches!(dataset.dtype(), Datatype::FloatingPoint { size: 4, .. });
        let dimensions: Vec<u64> = dataset.shape().iter().rev().copied().collect();
        let content = match class.as_str() {
            "char" if empty => Content::Text(String::new()),
            _ if empty => Content::Array(Array { dimensions, values: Values::Real(Vec::new()), single }),
            "cell" => return self.references(dataset, name, &|i| format!("{name}{{{i}}}")),
            "char" if dimensions[..] != [1] && dimensions.first() != Some(&1) => {
                self.file.pass(name, "char array of several rows");
                return Ok(());
            }
            "char" | "double" | "single" | "int8" | "uint8" | "int16" | "uint16" | "int32" | "uint32"
            | "int64" | "uint64" => match self.file.data(name, dataset) {
                Some(Data::Numbers(Values::Real(values))) if class == "char" => {
                    let units: Vec<u16> = values.iter().map(|unit| *unit as u16).collect();
                    Content::Text(String::from_utf16_lossy(&units))
                }
                Some(Data::Numbers(values)) => Content::Array(Array { dimensions, values, single }),
                Some(_) => {
                    self.file.pass(name, "array of neither numbers nor text");
                    return Ok(());
                }
                None => return Ok(()),
            },
            class => {
                self.file.pass(name, if class == "logical" { "logical array" } else { "object" });
                return Ok(());
            }
        };
        self.variables.push((name.to_owned(), content));
        Ok(())
    }

    /// What the references of a dataset lead to.
    fn references(&mut self, dataset: &Dataset, name: &str, named: &dyn Fn(usize) -> String) -> Result<()> {
        let Some(Data::References(addresses)) = self.file.data(name, dataset) else {
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
