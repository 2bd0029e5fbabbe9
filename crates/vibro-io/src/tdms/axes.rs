//! The abscissa of a channel: its waveform properties, or a channel of its group whose name means time or
//! frequency.

use super::Channel;
use super::description::{Slot, Value};
use super::segment::Object;
use crate::assemble::{Abscissa, JudgedAxis, domain, drift, epoch, from_values, kind_of, short};
use crate::options::Options;
use crate::text::names::Name;
use std::collections::BTreeMap;
use std::sync::Arc;
use vibro_record::units::Unit;
use vibro_record::{Axis, AxisKind, Error, Finding, Meta, Result};

/// A channel that is the abscissa of others.
pub struct AbscissaChannel {
    name: String,
    axis: Axis,
    /// Relative standard uncertainty of its step.
    relative: f64,
    findings: Vec<Finding>,
}

impl AbscissaChannel {
    fn of(channel: &Channel, resampled: bool, findings: &mut Vec<Finding>) -> Option<AbscissaChannel> {
        // The unit `h` of a time means hours.
        let unit = channel.object.text("unit_string").map(|unit| if unit == "h" { "hour" } else { unit });
        let Name { name, unit } = Name::with_unit_row(channel.name, unit.unwrap_or_default());
        let whole = name.trim_end_matches(|c: char| c.is_ascii_digit() || c == '_' || c == ' ');
        let kind = |name: &str, unit: Option<String>| {
            Name { name: name.to_owned(), unit }.axis(name.len() == 1).filter(|_| name != "x" && name != "X")
        };
        let named = |name: &str| kind(name, None).filter(|of| kind(name, unit.clone()).as_ref() == Some(of));
        // A name that only begins like a time counts as a clock only if the values rise evenly:
        // `Zeit_langsam` may be a clock, a measured `time of flight` is not.
        let first = whole.split(['_', ' ']).next().filter(|word| word.len() > 1);
        let first = || named(first?).filter(|kind| *kind == AxisKind::Time);
        let (kind, sure) = named(whole).map(|kind| (kind, true)).or_else(|| Some((first()?, false)))?;
        let Some(values) = channel.values.rising() else {
            if sure && channel.values.len() > 1 && !channel.values.is_complex() {
                findings.push(Finding::caution("abscissa-not-rising").name("variable", channel.name));
            }
            return None;
        };
        let label = format!("channel {:?}", channel.name);
        let instants = channel.object.slots == [Slot::Instant];
        let epoch = epoch(values[0]).filter(|_| unit.is_none() && !instants && kind == AxisKind::Time);
        let read = Name { name, unit: unit.clone() }.to_axis(&kind).ok();
        let (factor, assumed) = match (epoch, read) {
            _ if instants => (1.0, Some(Finding::note("axis-clock"))),
            (Some((unit, factor)), _) => (factor, Some(Finding::caution("axis-epoch").name("unit", unit))),
            (_, Some(read)) => read,
            (_, None) => {
                let found = Finding::caution("axis-unit-unknown").name("said", unit.unwrap_or_default());
                (1.0, Some(found.name("unit", domain(&kind).1)))
            }
        };
        let from = if instants || epoch.is_some() { values[0] } else { 0.0 };
        let resolution = drift(values, values.iter().all(|v| f64::from(*v as f32) == *v));
        let values = values.iter().map(|v| (v - from) * factor).collect();
        let JudgedAxis { axis, step_relative_std, found } =
            from_values(kind, values, resolution * factor, &label, resampled);
        let findings = assumed.map(|found| found.name("column", label.as_str())).into_iter().chain(found);
        let clock = AbscissaChannel {
            name: channel.name.to_owned(),
            findings: findings.collect(),
            axis,
            relative: step_relative_std,
        };
        (sure || clock.axis.step().is_some()).then_some(clock)
    }
}

/// Removes the clocks (abscissa channels) and assigns each to the channels of its group and length. If
/// there are several clocks, each applies to the channels that follow it.
///
/// # Errors
/// If it is ambiguous which channels belong to which clock.
pub fn assign(channels: &mut Vec<Channel>, options: &Options, findings: &mut Vec<Finding>) -> Result<()> {
    let mut sets: BTreeMap<(&str, usize), Vec<usize>> = BTreeMap::new();
    for (i, channel) in channels.iter().enumerate() {
        sets.entry((channel.group, channel.values.len())).or_default().push(i);
    }
    let resampled = options.resample.is_some();
    let clocks =
        channels.iter().map(|channel| AbscissaChannel::of(channel, resampled, findings).map(Arc::new));
    let mut clocks: Vec<Option<Arc<AbscissaChannel>>> = clocks.collect();
    for (_, set) in sets {
        let timed = set.iter().any(|i| {
            let (kind, step, _) = stated(channels[*i].object);
            let by_step = kind == AxisKind::Time && step.is_some_and(|(_, step)| step != 1.0);
            by_step || clocks[*i].as_ref().is_some_and(|clock| clock.axis.kind == AxisKind::Time)
        });
        // Among channels over time, a rising frequency is a measured run-up, not an abscissa.
        for i in set.iter().filter(|_| timed) {
            clocks[*i].take_if(|clock| clock.axis.kind != AxisKind::Time);
        }
        let own: Vec<&Arc<AbscissaChannel>> = set.iter().filter_map(|i| clocks[*i].as_ref()).collect();
        let Some(first) = own.first().copied().cloned() else { continue };
        if own.len() == set.len() {
            for i in set {
                let found = Finding::caution("abscissa-of-other-length");
                findings.push(found.name("variable", channels[i].name));
                clocks[i] = None;
            }
            continue;
        }
        let other = own.iter().find(|clock| clock.axis != first.axis).copied();
        let is = |i: usize| clocks[i].is_some();
        let follow = is(set[0]) && !is(set[set.len() - 1]) && !set.windows(2).any(|w| is(w[0]) && is(w[1]));
        if let Some(other) = other.filter(|_| !follow) {
            let span = |axis: &Axis| short(axis.at(axis.len() - 1) - axis.start());
            let (a, b) = (span(&first.axis), span(&other.axis));
            let found = format!("{:?} and {:?} run over {a} and {b}", first.name, other.name);
            let hint = "write each of them with its channels to a group of its own";
            return Err(Error::usage(found, "one clock for all channels of a group").hint(hint));
        }
        let said = if other.is_some() { own.len() } else { 1 };
        findings.extend(own.iter().take(said).flat_map(|clock| clock.findings.iter().cloned()));
        let mut now = &first;
        for i in set {
            match &clocks[i] {
                Some(clock) => now = clock,
                None => channels[i].clock = Some(Arc::clone(now)),
            }
        }
    }
    let mut clocks = clocks.iter();
    channels.retain(|_| clocks.next().is_some_and(Option::is_none));
    Ok(())
}

/// The abscissa that the waveform properties state: kind, start and step in s or Hz, and a finding on an
/// assumed unit.
fn stated(object: &Object) -> (AxisKind, Option<(f64, f64)>, Option<Finding>) {
    let name = object.text("wf_xname").unwrap_or_default();
    let lines = name.to_lowercase().starts_with("freq");
    let kind = if lines { AxisKind::Frequency } else { AxisKind::Time };
    let said = object.text("wf_xunit_string").map(str::trim).filter(|unit| !unit.is_empty());
    let said = said.map(|unit| if unit.eq_ignore_ascii_case("hz") { "Hz" } else { unit });
    let (kind, factor, found) = match (said, said.and_then(Unit::parse)) {
        (Some(said), Some(unit)) => {
            let name = if name.is_empty() { "abscissa" } else { name };
            let other = || (AxisKind::Other(format!("{name} [{said}]")), 1.0);
            let (kind, factor) = kind_of(&unit).map_or_else(other, |kind| (kind, unit.factor()));
            (kind, factor, None)
        }
        (Some(said), None) => {
            let found = Finding::caution("axis-unit-unknown").name("said", said).name("column", "abscissa");
            let unit = domain(&kind).1;
            (kind, 1.0, Some(found.name("unit", unit)))
        }
        (None, _) => (kind, 1.0, None),
    };
    let start = object.number("wf_start_offset").unwrap_or(0.0);
    (kind, object.number("wf_increment").map(|step| (start * factor, step * factor)), found)
}

/// The axis of a channel: its clock, with the stated step if both agree, since the stated step has more
/// digits. Without a clock, the axis that the properties state.
pub fn of(channel: &Channel, options: &Options, meta: &mut Meta) -> Axis {
    let (object, n) = (channel.object, channel.values.len());
    let (kind, step, found) = stated(object);
    let free = options.rate.is_none() && options.base_band.is_none();
    let Some(clock) = &channel.clock else {
        meta.findings.extend(found);
        if free && let Some((_, step)) = step {
            meta.findings.extend(changes(object, step));
        }
        return Abscissa::even(kind, step).axis(n, options, meta);
    };
    let AbscissaChannel { name, axis, relative, .. } = &**clock;
    meta.clock = *relative;
    let own = axis.step().unwrap_or(f64::NAN);
    let abscissa = match step.filter(|(_, step)| *step > 0.0) {
        Some((_, step)) if kind == axis.kind && (own / step - 1.0).abs() <= 1e-4 => {
            Abscissa::even(kind, Some((axis.start(), step)))
        }
        Some((_, step)) if options.rate.is_none() && kind == AxisKind::Time => {
            let found = Finding::caution("vector-against-rate").name("variable", name.as_str());
            meta.found(found.name("used", "vector").number("rate", 1.0 / step));
            Abscissa::of(axis.clone())
        }
        _ => Abscissa::of(axis.clone()),
    };
    // The findings of the file already contain the one on an uneven clock.
    if free && abscissa.even.is_none() { axis.clone() } else { abscissa.axis(n, options, meta) }
}

/// Findings on segments that contradict one even `step` in s: by another step, or by a gap between start
/// times.
fn changes(object: &Object, step: f64) -> Vec<Finding> {
    let of = |key: &str| {
        let all = object.changes.iter().filter(move |(of, _, at)| of == key && *at < object.declared);
        let all = all
            .filter_map(|(_, before, at)| if let Value::Number(x) = before { Some((*x, *at)) } else { None });
        all.collect::<Vec<(f64, u64)>>()
    };
    let mut found = Vec::new();
    if let (Some((before, at)), Some(now)) = (of("wf_increment").first(), object.number("wf_increment")) {
        let changed = Finding::doubt("step-changed").number("before", *before).number("step", now);
        found.push(changed.number("n", *at as f64).without_estimate());
    }
    let starts = of("wf_start_time");
    let behind = starts.iter().skip(1).map(|(time, _)| *time).chain(object.number("wf_start_time"));
    let gaps = starts.iter().zip(behind).map(|((_, at), now)| (now - starts[0].0 - *at as f64 * step, *at));
    if let Some((gap, at)) = gaps.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
        && gap.abs() > step.max(1e-3)
    {
        found.push(Finding::caution("start-changed").number("gap", gap).number("n", at as f64));
    }
    found
}
