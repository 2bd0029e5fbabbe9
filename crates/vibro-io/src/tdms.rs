//! TDMS: what LabVIEW and NI-DAQmx write.
//!
//! ```text
//! segment: TDSm, table of contents, version, length, start of its raw data; then
//!   objects: path /'group'/'channel', layout of its raw data, properties
//!   raw data: channel after channel, sample after sample of all, or DAQmx buffers
//! ```
//! Source: National Instruments, "TDMS File Format Internal Structure". Every numeric channel is a record: a trace, or a spectrum where its
//! abscissa is in Hz. Raw values are taken through the channel's scales ([`scale`]); one whose scale is not known is left out, for its raw
//! values are no measurement. The file `_index` beside it is not needed.

mod layout;
mod scale;
mod segment;

use super::Source;
use super::format::Format;
use super::missing::{self, Missing};
use super::reader::{Options, Recording};
use crate::assemble::{self, Abscissa, Spectral, from_values, to_si};
use layout::Layout;
use rayon::prelude::*;
use scale::Scales;
use segment::{Object, Segments, Value};
use std::io::{BufReader, Read, Seek, SeekFrom};
use vibro_record::units::Unit;
use vibro_record::{Axis, AxisKind, Error, Finding, Meta, Place, Record, Result, Values};

/// Bytes that are read at a time.
const BLOCK: usize = 1 << 20;

pub(super) fn sniff(head: &[u8], _: &Source) -> bool {
    head.starts_with(b"TDSm") || head.starts_with(b"TDSh")
}

pub(super) fn read(source: &Source, options: &Options) -> Result<Recording> {
    if source.head().starts_with(b"TDSh") {
        return Err(Error::usage("the index of a TDMS file", "the file with the values")
            .hint("name the file without `_index` that lies beside it"));
    }
    let mut file = BufReader::with_capacity(BLOCK, source.open()?);
    let Segments { objects, layouts, mut findings } = segment::all(&mut file, source.len())?;
    let mut raw: Vec<Columns> = objects.iter().map(|_| Columns::new()).collect();
    // Channels that lie one after the other are read side by side.
    let apart = layouts.iter().flat_map(|layout| &layout.parts).all(|part| part.fields.len() <= 1);
    let each = raw.len().div_ceil(if apart { rayon::current_num_threads() } else { 1 }).max(1);
    let read = |(i, raw): (usize, &mut [Columns])| {
        let mut file = BufReader::with_capacity(BLOCK, source.open()?);
        let mut all = layouts.iter();
        all.try_for_each(|layout| values(&mut file, layout, i * each, raw))
            .map_err(|e| Error::io("read", source.path(), e))
    };
    raw.par_chunks_mut(each).enumerate().try_for_each(read)?;
    let mut channels = Vec::new();
    for (object, columns) in objects.iter().zip(raw) {
        let [group, name] = &object.path[..] else { continue };
        let named = |found: Finding| found.name("variable", name.as_str());
        if let Some(class) = object.unreadable {
            findings.push(named(Finding::note("variable-passed-over")).name("class", class));
        } else if columns.iter().all(Vec::is_empty) {
            findings.push(named(Finding::note("variable-empty")));
        } else {
            match Scales::of(&objects, object).apply(&object.slots, columns) {
                Ok(values) => channels.push((object, group, name, values)),
                Err(kind) => findings.push(named(Finding::caution("scale-unknown")).name("scale", kind)),
            }
        }
    }
    let mut missed = Missing::default();
    for (_, _, name, values) in &mut channels {
        for i in missing::mark(values) {
            missed.take(&Place::default(), format!("{} of {name:?}", i + 1));
        }
    }
    findings.extend(missing::kept(missed.check("value(s) are NaN or infinite:", options.allow_missing)?));
    let several = channels.iter().any(|(_, group, ..)| *group != channels[0].1);
    let axes = abscissae(&mut channels, &mut findings);
    let record = |(object, group, name, mut values): Channel| {
        let shown = if several { format!("{group}/{name}") } else { name.clone() };
        let mut meta = Meta::new(shown, Unit::opaque(""));
        meta.notes = notes(&objects, object);
        meta.step("read", &[("file", &source.name()), ("format", &"tdms")]);
        let said = ["unit_string", "NI_UnitDescription"].iter().find_map(|key| object.text(key));
        let factor = options.adopt(&mut meta, said.filter(|text| !text.is_empty()));
        to_si(&mut values, factor)?;
        let n = values.len();
        if object.declared > n as u64 {
            meta.declared_n = usize::try_from(object.declared).ok();
            meta.found(
                Finding::caution("fewer-values").number("declared", object.declared as f64).count("n", n),
            );
        }
        let own = axes.iter().find(|(of, axis)| *of == group && axis.len() == n).map(|(_, axis)| axis);
        let axis = abscissa(object, own).axis(n, options, &mut meta);
        assemble::record(meta, axis, values, Spectral::default())
    };
    let records = channels.into_iter().map(record).collect::<Result<Vec<Record>>>()?;
    if records.is_empty() {
        return Err(Error::usage("no channel with numbers", "at least one to make a record of"));
    }
    Ok(Recording { path: source.path().to_owned(), format: Format::Tdms, records, findings })
}

/// An object with its group, its name and its values.
type Channel<'a> = (&'a Object, &'a String, &'a String, Values);

/// Raw values of an object, one column a slot.
type Columns = Vec<Vec<f64>>;

/// Reads what a segment has of the objects from `first` on behind what `raw` holds of them.
fn values(
    file: &mut (impl Read + Seek),
    layout: &Layout,
    first: usize,
    raw: &mut [Columns],
) -> std::io::Result<()> {
    let wanted = first..first + raw.len();
    file.seek(SeekFrom::Start(layout.at))?;
    let (mut left, mut block) = (layout.len, Vec::new());
    while left > 0 {
        for part in &layout.parts {
            // What a file that ends early holds of a part are whole rows.
            let mut rows = part.rows.min(left / part.width.max(1));
            left = if rows < part.rows { 0 } else { left - rows * part.width };
            let most = (BLOCK as u64 / part.width.max(1)).max(1);
            while rows > 0 {
                let now = rows.min(most);
                rows -= now;
                if !part.fields.iter().any(|field| wanted.contains(&field.object)) {
                    file.seek_relative((now * part.width) as i64)?;
                    continue;
                }
                block.resize((now * part.width) as usize, 0);
                file.read_exact(&mut block)?;
                for field in &part.fields {
                    let columns = &mut raw[field.object - first];
                    if columns.len() <= field.slot {
                        columns.resize(field.slot + 1, Vec::new());
                    }
                    field.take(&block, part.width as usize, layout.big_endian, &mut columns[field.slot]);
                }
            }
        }
    }
    Ok(())
}

/// Takes the first channel of each group out that its name makes an abscissa.
fn abscissae<'a>(channels: &mut Vec<Channel<'a>>, findings: &mut Vec<Finding>) -> Vec<(&'a String, Axis)> {
    let mut axes: Vec<(&String, Axis)> = Vec::new();
    let mut at = 0;
    while let Some((object, group, name, values)) = channels.get(at) {
        let kind = crate::text::abscissa(name, object.text("unit_string"));
        let others = channels.iter().filter(|(_, of, ..)| of == group).count();
        match (kind, values) {
            (Some((kind, factor)), Values::Real(values))
                if others > 1
                    && axes.iter().all(|(of, _)| of != group)
                    && values.is_sorted_by(|a, b| a < b) =>
            {
                let values = values.iter().map(|v| v * factor).collect();
                let (axis, finding) = from_values(kind, values, 0.0, &format!("channel {name:?}"));
                findings.extend(finding);
                axes.push((group, axis));
                channels.remove(at);
            }
            _ => at += 1,
        }
    }
    axes
}

/// What the waveform properties of a channel say of its abscissa, else the channel of its group that is one.
fn abscissa(object: &Object, own: Option<&Axis>) -> Abscissa {
    let hertz = object.text("wf_xunit_string").is_some_and(|unit| unit.eq_ignore_ascii_case("hz"))
        || object.text("wf_xname").is_some_and(|name| name.to_lowercase().starts_with("freq"));
    let start = object.number("wf_start_offset").unwrap_or(0.0);
    let step = object.number("wf_increment").map(|step| (start, step));
    match own.filter(|_| step.is_none()) {
        Some(axis) => Abscissa::of(axis.clone()),
        None => Abscissa::even(if hertz { AxisKind::Frequency } else { AxisKind::Time }, step),
    }
}

/// Properties of the file, the group and the channel that no reader needs.
fn notes(objects: &[Object], channel: &Object) -> Vec<(String, String)> {
    let of = |object: &&Object| channel.path.starts_with(&object.path);
    let all = objects.iter().filter(of).flat_map(|object| &object.properties);
    let kept = all.filter(|(key, _)| !key.starts_with("NI_Scal") && !key.starts_with("wf_"));
    let text = |value: &Value| match value {
        Value::Text(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        Value::Other => None,
    };
    kept.filter_map(|(key, value)| Some((key.clone(), text(value)?))).collect()
}

#[cfg(test)]
mod tests;
