//! HDF5: files of h5py, of loggers and oscilloscopes, and MAT-files of version 7.3.
//!
//! ```text
//! signature at byte 0, 512, 1024, 2048, …; groups of groups and datasets, named by their path:
//!   run1           attributes fs = 51200
//!   run1/velocity  dataset of n values or n × channels, attributes unit = "mm/s"
//! ```
//! The crate hdf5-reader reads the bytes. Datasets, the fields of tables and attributes become [`variables`].
//! A numeric dataset is a record. A dataset of two dimensions is a record for each channel, with its
//! samples along the longer dimension unless an abscissa shows otherwise. MATLAB's files are read like its
//! other MAT-files ([`matlab`]). Links to other files are not followed.

mod file;
mod lzf;
mod matlab;

use super::format::Format;
use crate::held::{Contents, Held};
use crate::options::Options;
use crate::source::Source;
use crate::variables::matlab::MATLAB;
use crate::variables::names::Dialect;
use crate::variables::{self, Array, Content, MOST_TEXT};
use file::{Data, File, Member};
use hdf5_reader::{Attribute, Dataset, Datatype};
use vibro_record::{Finding, Result, Values};

const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Attributes of HDF5 dimension scales (CLASS, NAME, `DIMENSION_LIST` …), which are not data; spelled as by
/// [`Dialect::word`], in lower case with letters and digits only.
const INTERNAL: &[&str] = &["class", "name", "dimensionlist", "dimensionlabels", "referencelist"];
/// Attributes by which stored numbers are converted: ((stored − reference) · factor + offset) · scale +
/// add, in the order factor, offset, reference, scale, add. The first three come from an oscilloscope and
/// apply to integers only. The sixth marks a missing value.
const SCALE: [&[&str]; 6] = [
    &["yinc", "yincrement"],
    &["yorg", "yorigin"],
    &["yref", "yreference"],
    &["scalefactor"],
    &["addoffset"],
    &["fillvalue", "missingvalue"],
];
type Scale = [f64; SCALE.len()];
/// Scale of numbers that are stored as the values themselves.
const AS_STORED: Scale = [1.0, 0.0, 0.0, 1.0, 0.0, f64::NAN];
/// Attributes of integers that do not state what they convert, or whether to multiply or to divide. If the
/// value is not 1, the dataset is left out.
const FACTORS: [&str; 3] = ["scale", "gain", "conversion"];

static DIALECT: Dialect = Dialect {
    format: Format::Hdf5,
    separator: '/',
    brackets: ['[', ']'],
    first: 0,
    by_rows: true,
    wide: 0,
    attributes: true,
};

pub(super) fn sniff(head: &[u8], _: &Source) -> bool {
    let places = std::iter::successors(Some(512), |at| Some(at * 2)).take_while(|at| *at < head.len());
    [0].into_iter().chain(places).any(|at| head[at..].starts_with(SIGNATURE))
}

/// All records; for a `survey`, only the extremes of their values if these are enough.
pub(super) fn read(source: &Source, options: &Options, survey: bool) -> Result<Contents> {
    let mut file = File::open(source, options)?;
    let root = file.root()?;
    let members = file.members(&root, "")?;
    let (dialect, variables) = if matlab::is(&members) {
        (&MATLAB, matlab::variables(&mut file, members, survey)?)
    } else {
        let mut walk = GroupWalk { file: &mut file, survey, variables: Vec::new() };
        let scale = walk.stated("", &root.attributes().unwrap_or_default(), AS_STORED);
        walk.group("", members, scale)?;
        (&DIALECT, walk.variables)
    };
    if let Some(error) = file.refused.take() {
        return Err(error);
    }
    variables::contents(source, dialect, variables, file.close(), options)
}

struct GroupWalk<'a> {
    file: &'a mut File,
    survey: bool,
    variables: Vec<(String, Content)>,
}

impl GroupWalk<'_> {
    /// Adds the members of a group, whose path ends with `/`.
    fn group(&mut self, path: &str, members: Vec<(String, Member)>, scale: Scale) -> Result<()> {
        for (name, member) in members {
            let name = format!("{path}{name}");
            match &member {
                Member::Dataset(inner) => self.dataset(&name, inner, scale),
                Member::Group(inner) => {
                    let members = self.file.members(inner, &name)?;
                    let path = format!("{name}/");
                    let scale = self.stated(&path, &member.attributes(), scale);
                    self.group(&path, members, scale)?;
                }
            }
        }
        Ok(())
    }

    /// Adds a dataset or its fields, and the attributes of vectors and matrices.
    fn dataset(&mut self, name: &str, dataset: &Dataset, mut scale: Scale) {
        let long = dataset.shape().iter().filter(|n| **n > 1).count();
        let attributes = dataset.attributes();
        if matches!(dataset.dtype(), Datatype::Compound { .. }) || (1..=2).contains(&long) {
            scale = self.stated(&format!("{name}/"), &attributes, scale);
        }
        let as_stored = scale[..5] == AS_STORED[..5] && scale[5].is_nan();
        let summary = self.survey && as_stored && long == 1;
        let Some(mut data) = self.file.data(name, dataset, summary) else { return };
        if let Data::Numbers(values) = &mut data {
            let counts = matches!(dataset.dtype(), Datatype::FixedPoint { .. });
            let doubtful = |of: &&Attribute| {
                FACTORS.contains(&DIALECT.word(&of.name).as_str())
                    && matches!(file::attribute(of), Some(Data::Numbers(by)) if by != Values::Real(vec![1.0]).into())
            };
            if counts
                && long > 0
                && let Some(of) = attributes.iter().find(doubtful)
            {
                let found = Finding::caution("scale-unknown").name("variable", name);
                return self.file.findings.push(found.name("scale", of.name.as_str()));
            }
            let [factor, offset, reference, scale, add, missing] = scale;
            let measured = |stored: f64| {
                let raw = if counts { (stored - reference) * factor + offset } else { stored };
                if stored == missing { f64::NAN } else { raw * scale + add }
            };
            if let (Some(Values::Real(values)), false) = (values.values_mut(), as_stored) {
                for value in values {
                    *value = measured(*value);
                }
            }
        }
        let single = matches!(dataset.dtype(), Datatype::FloatingPoint { size: 4, .. });
        let array = |dimensions, values| Content::Array(Array { dimensions, values, single });
        let content = match data {
            Data::Texts(texts) if texts.iter().map(String::len).sum::<usize>() <= MOST_TEXT => {
                Content::Text(texts.join(", "))
            }
            Data::Numbers(values) if dataset.ndim() == 1 => array(vec![values.len() as u64], values),
            Data::Numbers(values) => array(dataset.shape().to_vec(), values),
            Data::Table(fields) => {
                let vector = |values: Vec<f64>| array(vec![values.len() as u64], Values::Real(values).into());
                return self.variables.extend(fields.into_iter().map(|(field, values)| {
                    let content = values.map_or(Content::Other("field that is no number"), vector);
                    (format!("{name}/{field}"), content)
                }));
            }
            _ => Content::Other("dataset of references or of long texts"),
        };
        self.variables.push((name.to_owned(), content));
    }

    /// Adds the texts and numbers among attributes. Returns the scale that they state, else the one
    /// inherited from the parent group.
    fn stated(&mut self, path: &str, attributes: &[Attribute], mut scale: Scale) -> Scale {
        for attribute in attributes {
            let word = DIALECT.word(&attribute.name);
            let text = match file::attribute(attribute) {
                _ if INTERNAL.contains(&word.as_str()) => continue,
                Some(Data::Texts(texts)) => texts.join(", "),
                Some(Data::Numbers(Held::Values(Values::Real(values)))) if values.len() == 1 => {
                    for (names, scale) in SCALE.iter().zip(&mut scale) {
                        *scale = if names.contains(&word.as_str()) { values[0] } else { *scale };
                    }
                    values[0].to_string()
                }
                _ => continue,
            };
            if !attribute.name.starts_with('_') {
                self.variables.push((format!("{path}{}", attribute.name), Content::Text(text)));
            }
        }
        scale
    }
}

#[cfg(test)]
mod tests;
