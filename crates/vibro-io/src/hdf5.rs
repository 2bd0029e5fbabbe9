//! HDF5: files of h5py, of loggers and oscilloscopes, and MAT-files of version 7.3.
//!
//! ```text
//! signature at byte 0, 512, 1024, 2048, …; groups of groups and datasets, named by their path:
//!   run1           attributes fs = 51200
//!   run1/velocity  dataset of n values or n × channels, attributes unit = "mm/s"
//! ```
//! The crate hdf5-reader reads the bytes. Numeric datasets are records, and so are the columns of those with two dimensions, of which the
//! longer one is the samples unless an abscissa of the group says otherwise, and the fields of tables. A dataset of a group that its name makes an
//! abscissa is that of the others of its length; else attributes ([`stated`]) of the dataset, of its group or of one above say
//! rate or step. What MATLAB writes becomes variables ([`matlab`]) as in its other MAT-files. Links to other files are not followed.

mod file;
mod lzf;
mod matlab;
mod stated;

use super::Source;
use super::format::Format;
use super::missing::{self, Missing};
use super::reader::{Options, Recording};
use crate::assemble::{self, Abscissa, Spectral, from_values, to_si};
use crate::{mat, text};
use file::{Data, File, Member};
use hdf5_reader::Datatype;
use stated::Stated;
use vibro_record::units::Unit;
use vibro_record::{Axis, AxisKind, Error, Fact, Finding, Grid, Meta, Place, Record, Result, Values};

const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";
/// More columns than this are no channels.
const MOST_COLUMNS: u64 = 1000;
/// Longest text that is kept.
const MOST_TEXT: usize = 4096;

pub(super) fn sniff(head: &[u8], _: &Source) -> bool {
    let places = std::iter::successors(Some(512), |at| Some(at * 2)).take_while(|at| *at < head.len());
    [0].into_iter().chain(places).any(|at| head[at..].starts_with(SIGNATURE))
}

pub(super) fn read(source: &Source, options: &Options) -> Result<Recording> {
    let mut file = File::open(source)?;
    let root = file.root()?;
    let members = file.members(&root, "")?;
    if matlab::is(&members) {
        let variables = matlab::variables(&mut file, members)?;
        return mat::recording(source, variables, file.close(), options);
    }
    let mut channels = Vec::new();
    let above = Stated::default().and(&root.attributes().unwrap_or_default());
    group(&mut file, members, "", &above, &mut channels)?;
    let mut findings = file.close();
    if channels.is_empty() {
        let mut found = "no numeric dataset that can be read".to_owned();
        if let Some(Fact::Name(reason)) = findings.iter().find_map(|found| found.fact("reason")) {
            found = format!("{found}: {reason}");
        }
        return Err(Error::usage(found, "at least one to make a record of")
            .hint("write its arrays as MAT (v7), CSV or WAV"));
    }
    let mut missed = Missing::default();
    for channel in &mut channels {
        for i in missing::mark(&mut channel.values) {
            missed.take(&Place::default(), format!("{} of {:?}", i + 1, channel.name));
        }
    }
    findings.extend(missing::kept(missed.check("value(s) are NaN or infinite:", options.allow_missing)?));
    let record = |Channel { name, mut values, stated, axis }: Channel| {
        let mut meta = Meta::new(name, Unit::opaque(""));
        let factor = options.adopt(&mut meta, stated.unit.as_deref());
        let abscissa = abscissa(&stated, axis.as_ref(), matches!(values, Values::Complex(_)));
        meta.notes = stated.notes;
        meta.step("read", &[("file", &source.name()), ("format", &"hdf5")]);
        to_si(&mut values, factor)?;
        let axis = abscissa.axis(values.len(), options, &mut meta);
        assemble::record(meta, axis, values, Spectral::default())
    };
    let records = channels.into_iter().map(record).collect::<Result<Vec<Record>>>()?;
    Ok(Recording { path: source.path().to_owned(), format: Format::Hdf5, records, findings })
}

/// Values with what is stated of them.
struct Channel {
    name: String,
    values: Values,
    stated: Stated,
    axis: Option<Axis>,
}

/// Adds the channels of a group and of the groups in it.
fn group(
    file: &mut File,
    members: Vec<Member>,
    path: &str,
    above: &Stated,
    all: &mut Vec<Channel>,
) -> Result<()> {
    let within = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}/{name}") };
    let (mut stated, mut arrays, mut groups) = (above.clone(), Vec::new(), Vec::new());
    for member in members {
        let (name, dataset) = match member {
            Member::Dataset(name, dataset) => (name, dataset),
            Member::Group(name, inner) => {
                groups.push((name, inner));
                continue;
            }
        };
        match file.data(&within(&name), &dataset) {
            Some(Data::Texts(texts)) if texts.iter().map(String::len).sum::<usize>() <= MOST_TEXT => {
                stated.text(&name, &texts.join(", "));
            }
            Some(Data::Numbers(Values::Real(values))) if values.len() == 1 => stated.number(&name, values[0]),
            Some(Data::Numbers(values)) if values.is_empty() => {
                file.findings.push(Finding::note("variable-empty").name("variable", within(&name)));
            }
            Some(Data::References(_)) => file.pass(&within(&name), "dataset of references"),
            Some(Data::Texts(_)) => file.pass(&within(&name), "dataset of long texts"),
            Some(data) => arrays.push((name, dataset, data)),
            None => {}
        }
    }
    let is_axis = |name: &str, unit: Option<&str>| text::abscissa(name, unit).is_some();
    let lengths: Vec<u64> = arrays
        .iter()
        .filter(|(name, dataset, _)| dataset.ndim() == 1 && is_axis(name, None))
        .map(|(_, dataset, _)| dataset.shape()[0])
        .collect();
    let mut channels = Vec::new();
    for (name, dataset, data) in arrays {
        let stated = stated.and(&dataset.attributes());
        let channel =
            |name: String, values: Values| Channel { name, values, stated: stated.clone(), axis: None };
        match data {
            Data::Numbers(mut values) => {
                stated.scale(&mut values, matches!(dataset.dtype(), Datatype::FixedPoint { .. }));
                match columns(&name, dataset.shape(), values, &lengths) {
                    Ok(columns) => {
                        channels.extend(columns.into_iter().map(|(name, values)| channel(name, values)));
                    }
                    Err(dimensions) => {
                        let found = Finding::note("variable-many-dimensions").name("variable", within(&name));
                        file.findings.push(found.count("dimensions", dimensions));
                    }
                }
            }
            Data::Table(fields) => {
                let mut columns = Vec::new();
                for (field, values) in fields {
                    match values {
                        Some(values) => {
                            columns.push(channel(format!("{name}/{field}"), Values::Real(values)));
                        }
                        None => file.pass(&format!("{}/{field}", within(&name)), "field that is no number"),
                    }
                }
                all.extend(over_axes(columns, path, &mut file.findings));
            }
            Data::Texts(_) | Data::References(_) | Data::Other(_) => {}
        }
    }
    all.extend(over_axes(channels, path, &mut file.findings));
    stated.unit = None;
    for (name, inner) in groups {
        let path = within(&name);
        let members = file.members(&inner, &path)?;
        group(file, members, &path, &stated.and(&inner.attributes().unwrap_or_default()), all)?;
    }
    Ok(())
}

/// The columns of a dataset with their names; the number of its dimensions where these are no columns.
fn columns(
    name: &str,
    shape: &[u64],
    values: Values,
    lengths: &[u64],
) -> std::result::Result<Vec<(String, Values)>, usize> {
    let long: Vec<u64> = shape.iter().copied().filter(|n| *n > 1).collect();
    let [rows, columns] = long[..] else {
        return if long.len() < 2 { Ok(vec![(name.to_owned(), values)]) } else { Err(long.len()) };
    };
    let has = |n| lengths.contains(&n);
    let lying = if has(rows) == has(columns) { columns > rows } else { has(columns) };
    if rows.min(columns) > MOST_COLUMNS {
        return Err(2);
    }
    let (many, step, n) = if lying { (rows, 1, columns) } else { (columns, columns, rows) };
    let column = |k: u64| {
        let (from, step, n) = ((if lying { k * columns } else { k }) as usize, step as usize, n as usize);
        let values = match &values {
            Values::Real(all) => Values::Real(mat::every(all, from, step, n)),
            Values::Complex(all) => Values::Complex(mat::every(all, from, step, n)),
        };
        (if lying { format!("{name}[{k},:]") } else { format!("{name}[:,{k}]") }, values)
    };
    Ok((0..many).map(column).collect())
}

/// Takes the rising channels out that their names make abscissae, and gives each to the others of its length; names then begin with `path`.
fn over_axes(channels: Vec<Channel>, path: &str, findings: &mut Vec<Finding>) -> Vec<Channel> {
    let (mut axes, mut others): (Vec<Axis>, Vec<Channel>) = (Vec::new(), Vec::new());
    let lengths: Vec<usize> = channels.iter().map(|channel| channel.values.len()).collect();
    for mut channel in channels {
        let n = channel.values.len();
        let kind = text::abscissa(
            channel.name.rsplit('/').next().unwrap_or_default(),
            channel.stated.unit.as_deref(),
        );
        let fits = lengths.iter().filter(|other| **other == n).count() > 1
            && axes.iter().all(|axis| axis.len() != n);
        match (kind, &mut channel.values) {
            (Some((kind, factor)), Values::Real(values)) if fits && values.is_sorted_by(|a, b| a < b) => {
                let values = values.iter().map(|value| value * factor).collect();
                let (axis, found) = from_values(kind, values, 0.0, &format!("dataset {:?}", channel.name));
                findings.extend(found);
                axes.push(axis);
            }
            _ => others.push(channel),
        }
    }
    for channel in &mut others {
        channel.axis = axes.iter().find(|axis| axis.len() == channel.values.len()).cloned();
        if !path.is_empty() {
            channel.name = format!("{path}/{}", channel.name);
        }
    }
    others
}

/// What is stated of the abscissa, else that of the group.
fn abscissa(stated: &Stated, own: Option<&Axis>, complex: bool) -> Abscissa {
    match own {
        Some(Axis { kind, grid: Grid::Even { start, step, .. } }) => {
            Abscissa::even(kind.clone(), Some((*start, *step)))
        }
        Some(axis) => Abscissa { stored: axis.values(), ..Abscissa::even(axis.kind.clone(), None) },
        None => {
            let stated = stated.abscissa();
            if complex && stated.kind == AxisKind::Time {
                Abscissa::even(AxisKind::Time, None)
            } else {
                stated
            }
        }
    }
}

#[cfg(test)]
mod tests;
