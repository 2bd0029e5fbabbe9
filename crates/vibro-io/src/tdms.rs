//! TDMS files of LabVIEW and NI-DAQmx.
//!
//! ```text
//! segment: TDSm, table of contents, version, length, start of its raw data; then
//!   objects: path /'group'/'channel', layout of its raw data, properties
//!   raw data: channel after channel, sample after sample of all, or DAQmx buffers
//! ```
//! Source: National Instruments, "TDMS File Format Internal Structure". Every numeric channel is a record:
//! a trace, or a spectrum if its abscissa is in Hz. The channel's scales ([`scale`]) convert raw values. A
//! channel with an unknown scale is left out, since raw values are not a measurement. The index file
//! (`_index`) is not needed.

mod axes;
mod description;
mod layout;
mod scale;
mod segment;

use super::missing;
use crate::assemble;
use crate::assemble::Spectral;
use crate::held::{Contents, Held, rises};
use crate::options::Options;
use crate::source::Source;
use axes::AbscissaChannel;
use description::Value;
use layout::RawData;
use rayon::prelude::*;
use scale::Scales;
use segment::Object;
use std::cmp::Reverse;
use std::io::{BufReader, Read, Seek};
use std::sync::Arc;
use vibro_record::lanes::Extremes;
use vibro_record::units::Unit;
use vibro_record::{Error, Finding, Meta, Result, Values};

/// Bytes that are read at a time; few in tests, so that small files have several blocks.
const BLOCK: usize = if cfg!(test) { 64 } else { 1 << 20 };
/// Values of a channel that are scaled and reduced to extremes in one step. Fewer take more time, more take
/// more memory.
const LOOK: usize = if cfg!(test) { 4 } else { 1 << 16 };

pub(super) fn sniff(head: &[u8], _: &Source) -> bool {
    head.starts_with(b"TDSm") || head.starts_with(b"TDSh")
}

/// Reads all records. A `survey` keeps only the extremes of a channel's values if these are enough.
pub(super) fn read(source: &Source, options: &Options, survey: bool) -> Result<Contents> {
    if source.head().starts_with(b"TDSh") {
        return Err(Error::usage("the index of a TDMS file", "the file with the values")
            .hint("name the file without `_index` that lies beside it"));
    }
    let mut file = BufReader::with_capacity(BLOCK, source.open()?);
    let (objects, layouts, mut findings) = segment::all(&mut file, source.len())?;
    if !survey {
        options.hold(layouts.iter().map(RawData::values).sum())?;
    }
    let mut above: Vec<&Object> = objects.iter().filter(|object| object.path.len() < 2).collect();
    above.sort_by_key(|object| Reverse(object.path.len()));
    let raw = objects.iter().map(|object| {
        // Objects of several slots keep all values, since their slots may be stored apart.
        let kept = if survey && object.slots.len() == 1 { KeptValues::Undecided } else { KeptValues::Values };
        Raw { object, scales: Scales::of(&above, object), columns: Vec::new(), kept }
    });
    let mut raw: Vec<Raw> = raw.collect();
    // Channels stored one after the other are read in parallel.
    let apart = layouts.iter().flat_map(|layout| layout.parts.iter()).all(|part| part.fields.len() <= 1);
    let each = raw.len().div_ceil(if apart { rayon::current_num_threads() } else { 1 }).max(1);
    let fill = |(i, raw): (usize, &mut [Raw])| {
        let mut file = BufReader::with_capacity(BLOCK, source.open()?);
        let mut all = layouts.iter();
        all.try_for_each(|layout| values(&mut file, layout, i * each, raw))
            .map_err(|e| Error::io("read", source.path(), e))
    };
    raw.par_chunks_mut(each).enumerate().try_for_each(fill)?;
    raw.par_iter_mut().filter(|raw| matches!(raw.kept, KeptValues::Summary(_))).for_each(|raw| raw.look(0));
    if raw.iter().any(|raw| matches!(&raw.kept, KeptValues::Summary(summary) if !summary.finite())) {
        return read(source, options, false);
    }
    let (mut channels, left) = measured(&objects, raw, &mut findings);
    let all = channels.par_iter_mut();
    let all = all.filter_map(|channel| Some((channel.name, channel.values.values_mut()?)));
    findings.extend(missing::checked(all, options.allow_missing)?);
    let several = channels.iter().any(|channel| channel.group != channels[0].group);
    axes::assign(&mut channels, options, &mut findings)?;
    let record = |mut channel: Channel| {
        let Channel { object, group, name, .. } = channel;
        let shown = if several { format!("{group}/{name}") } else { name.to_owned() };
        let mut meta = Meta::new(shown, Unit::opaque(""));
        meta.notes = notes(&above, object);
        meta.step("read", &[("file", &source.name()), ("format", &"tdms")]);
        let said = UNITS.iter().find_map(|key| object.text(key).filter(|text| !text.is_empty()));
        let factor = options.adopt(&mut meta, said);
        channel.values.scale(factor)?;
        let n = channel.values.len();
        if object.declared > n as u64 {
            meta.declared_n = usize::try_from(object.declared).ok();
            meta.found(assemble::fewer(object.declared as usize, n));
        }
        let axis = axes::of(&channel, options, &mut meta);
        channel.values.record(meta, axis, Spectral::default())
    };
    let records = channels.into_iter().map(record).collect::<Result<Vec<_>>>()?;
    if records.is_empty() {
        let found = left.unwrap_or_else(|| "no channel with numbers".to_owned());
        return Err(Error::usage(found, "at least one to make a record of")
            .hint("export scaled values as text or UFF-58 from the program that recorded them"));
    }
    Ok(Contents { records, findings })
}

/// Channels with numbers. The others give findings; the first with an unknown scale also gives the text of
/// an error.
fn measured<'a>(
    objects: &'a [Object],
    raw: Vec<Raw<'a>>,
    findings: &mut Vec<Finding>,
) -> (Vec<Channel<'a>>, Option<String>) {
    let (mut channels, mut left) = (Vec::new(), None);
    for (object, raw) in objects.iter().zip(raw) {
        let [group, name] = &object.path[..] else { continue };
        let named = |found: Finding| found.name("variable", name.as_str());
        if let Some(class) = object.unreadable {
            findings.push(named(Finding::note("variable-passed-over")).name("class", class));
        } else if raw.is_empty() {
            findings.push(named(Finding::note("variable-empty")));
        } else {
            match changed(object).map_or_else(|| raw.measured(), Err) {
                Ok(values) => channels.push(Channel { object, group, name, values, clock: None }),
                Err(scale) => {
                    findings.push(named(Finding::caution("scale-unknown")).name("scale", scale.as_str()));
                    left.get_or_insert_with(|| {
                        format!("no channel with a scale that is known: {name:?} ({scale})")
                    });
                }
            }
        }
    }
    (channels, left)
}

/// Properties that name the unit of a channel.
const UNITS: [&str; 2] = ["unit_string", "NI_UnitDescription"];

/// A channel with numbers.
struct Channel<'a> {
    object: &'a Object,
    group: &'a str,
    name: &'a str,
    values: Held,
    /// The channel of its group that is its abscissa.
    clock: Option<Arc<AbscissaChannel>>,
}

/// Text on a unit or scale that changes between the values of a channel, so that no single one applies to
/// all; else `None`.
fn changed(object: &Object) -> Option<String> {
    let text = |value: &Value| value.text().unwrap_or_default();
    let scales = |key: &str| UNITS.contains(&key) || key == "wf_xunit_string" || key.starts_with("NI_");
    let mut all = object.changes.iter().filter(|(key, _, at)| scales(key) && *at < object.declared);
    let (key, before, at) = all.find(|(_, before, _)| !text(before).is_empty())?;
    let now = object.properties.get(key).map(text).unwrap_or_default();
    Some(format!("{key} changes from {} to {now} behind value {at}", text(before)))
}

/// Whether an object's values are kept, or only their extremes.
#[derive(Clone)]
enum KeptValues {
    /// All of them.
    Values,
    /// Not decided yet: extremes are enough unless the first values rise and may therefore be an abscissa.
    Undecided,
    /// Not kept: only extremes and first values.
    Summary(Extremes),
}

/// The values of an object read so far.
struct Raw<'a> {
    object: &'a Object,
    scales: Scales<'a>,
    /// Raw values, one column for each slot.
    columns: Vec<Vec<f64>>,
    kept: KeptValues,
}

impl Raw<'_> {
    /// Reduces the values to their extremes, if these are enough, as soon as there are more than `many`
    /// values.
    fn look(&mut self, many: usize) {
        if self.columns.iter().all(|column| column.len() <= many) {
            return;
        }
        let new = matches!(self.kept, KeptValues::Undecided);
        let (mut summary, columns) = match &mut self.kept {
            KeptValues::Undecided => (Extremes::NONE, self.columns.clone()),
            KeptValues::Summary(summary) => {
                (std::mem::replace(summary, Extremes::NONE), std::mem::take(&mut self.columns))
            }
            KeptValues::Values => return,
        };
        self.kept = match self.scales.apply(&self.object.slots, columns) {
            Ok(Values::Real(mut values)) if !(new && rises(&values)) => {
                summary.take(&values);
                values.clear();
                self.columns = vec![values];
                KeptValues::Summary(summary)
            }
            _ => KeptValues::Values,
        };
    }

    fn is_empty(&self) -> bool {
        !matches!(self.kept, KeptValues::Summary(_)) && self.columns.iter().all(Vec::is_empty)
    }

    /// Measured values, or the type of an unknown scale.
    fn measured(self) -> std::result::Result<Held, String> {
        match self.kept {
            KeptValues::Summary(summary) => Ok(Held::Summary(summary)),
            _ => self.scales.apply(&self.object.slots, self.columns).map(Held::Values),
        }
    }
}

/// Appends the values in a segment to `raw`, which holds the objects from index `first` on.
fn values(
    file: &mut BufReader<impl Read + Seek>,
    layout: &RawData,
    first: usize,
    raw: &mut [Raw],
) -> std::io::Result<()> {
    let wanted = first..first + raw.len();
    segment::go(file, layout.at)?;
    let (mut left, mut block) = (layout.len, Vec::new());
    while left > 0 {
        for part in layout.parts.iter() {
            // If the file ends within a part, only its whole rows are read.
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
                    let columns = &mut raw[field.object - first].columns;
                    if columns.len() <= field.slot {
                        columns.resize(field.slot + 1, Vec::new());
                    }
                    let (width, column) = (part.width as usize, &mut columns[field.slot]);
                    field.kind.take(&block, field.offset, width, layout.big_endian, column);
                }
                for field in &part.fields {
                    raw[field.object - first].look(LOOK);
                }
            }
        }
    }
    Ok(())
}

/// Notes on a channel: the properties of file, group and channel, without those of scales and waveform.
fn notes(above: &[&Object], channel: &Object) -> Vec<(String, String)> {
    let above = above.iter().rev().copied().filter(|object| channel.path.starts_with(&object.path));
    let all = above.chain([channel]).flat_map(|object| &object.properties);
    let kept = all.filter(|(key, _)| !key.starts_with("NI_Scal") && !key.starts_with("wf_"));
    kept.filter_map(|(key, value)| Some((key.clone(), value.text()?))).collect()
}

#[cfg(test)]
mod tests;
