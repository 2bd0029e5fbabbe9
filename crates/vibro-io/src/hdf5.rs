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
use hdf5_reader::{Dataset, Datatype};
use stated::Stated;
use vibro_record::units::Unit;
use vibro_record::{Axis, AxisKind, Error, Fact, Finding, Meta, Place, Record, Result, Values};

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
        let stated_abscissa = || stated.abscissa(matches!(values, Values::Complex(_)));
        let abscissa = axis.map_or_else(stated_abscissa, Abscissa::of);
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
    members: Vec<(String, Member)>,
    path: &str,
    above: &Stated,
    all: &mut Vec<Channel>,
) -> Result<()> {
    let within = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}/{name}") };
    let (mut stated, mut arrays, mut groups) = (above.clone(), Vec::new(), Vec::new());
    for (name, member) in members {
        let dataset = match member {
            Member::Dataset(dataset) => dataset,
            Member::Group(inner) => {
                groups.push((within(&name), inner));
                continue;
            }
        };
        let path = within(&name);
        match file.data(&path, &dataset) {
            Some(Data::Texts(texts)) if texts.iter().map(String::len).sum::<usize>() <= MOST_TEXT => {
                stated.text(&name, &texts.join(", "));
            }
            Some(Data::Numbers(Values::Real(values))) if values.len() == 1 => stated.number(&name, values[0]),
            Some(Data::Numbers(values)) if values.is_empty() => {
                file.findings.push(Finding::note("variable-empty").name("variable", path));
            }
            Some(data @ (Data::Numbers(_) | Data::Table(_))) => arrays.push((path, name, dataset, data)),
            Some(_) => file.pass(&path, "dataset of references or of long texts"),
            None => {}
        }
    }
    let is_axis = |(_, name, dataset, _): &&(_, String, Box<Dataset>, _)| {
        dataset.ndim() == 1 && text::abscissa(name, None).is_some()
    };
    let lengths: Vec<u64> = arrays.iter().filter(is_axis).map(|(_, _, axis, _)| axis.shape()[0]).collect();
    let mut channels = Vec::new();
    for (path, _, dataset, data) in arrays {
        let stated = stated.and(&dataset.attributes());
        let columns = match data {
            Data::Numbers(mut values) => {
                if matches!(dataset.dtype(), Datatype::FixedPoint { .. }) {
                    stated.scale(&mut values);
                }
                columns(&path, dataset.shape(), values, &lengths, &mut file.findings)
            }
            Data::Table(fields) => {
                let named = fields.into_iter().map(|(field, values)| (format!("{path}/{field}"), values));
                let (numbers, others): (Vec<_>, Vec<_>) = named.partition(|(_, values)| values.is_some());
                for (name, _) in others {
                    file.pass(&name, "field that is no number");
                }
                let real = |(name, values): (_, Option<_>)| (name, Values::Real(values.unwrap_or_default()));
                numbers.into_iter().map(real).collect()
            }
            _ => Vec::new(),
        };
        let channel = |(name, values)| Channel { name, values, stated: stated.clone(), axis: None };
        channels.extend(columns.into_iter().map(channel));
    }
    all.extend(over_axes(channels, &mut file.findings));
    stated.unit = None;
    for (path, inner) in groups {
        let members = file.members(&inner, &path)?;
        group(file, members, &path, &stated.and(&inner.attributes().unwrap_or_default()), all)?;
    }
    Ok(())
}

/// The columns of a dataset with their names; none where it has more dimensions.
fn columns(
    name: &str,
    shape: &[u64],
    values: Values,
    lengths: &[u64],
    findings: &mut Vec<Finding>,
) -> Vec<(String, Values)> {
    let long: Vec<u64> = shape.iter().copied().filter(|n| *n > 1).collect();
    let (rows, columns) = match long[..] {
        [] | [_] => return vec![(name.to_owned(), values)],
        [rows, columns] if rows.min(columns) <= MOST_COLUMNS => (rows, columns),
        _ => {
            let found = Finding::note("variable-many-dimensions").name("variable", name);
            findings.push(found.count("dimensions", long.len()));
            return Vec::new();
        }
    };
    let has = |n| lengths.contains(&n);
    let lying = if has(rows) == has(columns) { columns > rows } else { has(columns) };
    let (rows, columns) = (rows as usize, columns as usize);
    let (many, first, step, n) =
        if lying { (rows, columns, 1, columns) } else { (columns, 1, columns, rows) };
    let column = |k: usize| {
        let values = match &values {
            Values::Real(all) => Values::Real(mat::every(all, k * first, step, n)),
            Values::Complex(all) => Values::Complex(mat::every(all, k * first, step, n)),
        };
        (if lying { format!("{name}[{k},:]") } else { format!("{name}[:,{k}]") }, values)
    };
    (0..many).map(column).collect()
}

/// Takes the rising channels out that their names make abscissae, and gives each to those of its length beside it.
fn over_axes(channels: Vec<Channel>, findings: &mut Vec<Finding>) -> Vec<Channel> {
    fn place(channel: &Channel) -> (&str, usize) {
        (channel.name.rsplit_once('/').map_or("", |(group, _)| group), channel.values.len())
    }
    let many = |channel| channels.iter().filter(|other| place(other) == place(channel)).count() > 1;
    let mut axes: Vec<(usize, Axis)> = Vec::new();
    for (i, channel) in channels.iter().enumerate() {
        let name = channel.name.rsplit('/').next().unwrap_or_default();
        let known = |(i, _): &(usize, Axis)| place(&channels[*i]) == place(channel);
        if let Values::Real(values) = &channel.values
            && let Some((kind, factor)) = text::abscissa(name, channel.stated.unit.as_deref())
            && values.is_sorted_by(|a, b| a < b)
            && many(channel)
            && !axes.iter().any(known)
        {
            let values = values.iter().map(|value| value * factor).collect();
            let (axis, found) = from_values(kind, values, 0.0, &format!("dataset {:?}", channel.name));
            findings.extend(found);
            axes.push((i, axis));
        }
    }
    let over = |channel: &Channel| {
        let timed = matches!(channel.values, Values::Real(_));
        let fits = |(i, axis): &&(usize, Axis)| {
            place(&channels[*i]) == place(channel) && (timed || axis.kind != AxisKind::Time)
        };
        axes.iter().find(fits).map(|(_, axis)| axis.clone())
    };
    let found: Vec<Option<Axis>> = channels.iter().map(over).collect();
    let kept = channels.into_iter().zip(found).enumerate().filter(|(k, _)| axes.iter().all(|(i, _)| i != k));
    kept.map(|(_, (channel, axis))| Channel { axis, ..channel }).collect()
}

#[cfg(test)]
mod tests;
