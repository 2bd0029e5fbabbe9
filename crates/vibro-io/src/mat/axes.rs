//! Abscissae of the vectors of a MAT-file, as the names of other variables say them.
//!
//! What stands in a struct speaks of the vectors of that struct, however deep. Where the struct has none, it speaks of those beside it:
//! `File_Header.SampleFrequency` of `Channel_1_Data`, `Signal.x_values.increment` of `Signal.y_values.values`.

use super::variable::Array;
use crate::assemble::{from_values, short};
use crate::reader::{Options, POSSIBLE};
use crate::{number, text};
use std::cmp::Reverse;
use std::collections::HashMap;
use vibro_record::units::{Quantity, Unit};
use vibro_record::{Axis, AxisKind, Error, Finding, Meta, Result, Values};

/// What a scalar says of an abscissa.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Meaning {
    /// Sampling rate in Hz.
    Rate,
    /// Step of time in s.
    Step,
    /// Step of time or of frequency.
    Increment,
    /// First value.
    Start,
}

/// Whether a name means one thing only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Trust {
    /// It does.
    Sure,
    /// It does as a rule: taken, with a caution.
    Likely,
    /// `rate` may be that of a shaft: taken from 1 kHz on, where nothing better is said.
    Vague,
    /// Never taken, but named to the person.
    Offered,
}

use Meaning::{Increment, Rate, Start, Step};
use Trust::{Likely, Offered, Sure, Vague};

/// Names in lower case without underscores, what they mean, and whether they mean nothing else.
const NAMES: &[(&[&str], Meaning, Trust)] = &[
    (&["fs", "samplerate", "samplingrate", "samplefrequency", "samplingfrequency"], Rate, Sure),
    (&["dt", "ts", "sampletime", "samplinginterval", "sampleinterval", "tinterval"], Step, Sure),
    (&["increment", "xincrement"], Increment, Likely),
    (&["tstart", "startvalue", "xstart"], Start, Sure),
    (&["sr"], Rate, Likely),
    (&["rate"], Rate, Vague),
];
/// Parts of such names.
const PARTS: &[(&[&str], Trust)] = &[
    (&["samplerate", "samplingrate", "samplefreq", "samplingfreq"], Likely),
    (&["sampl", "rate", "freq"], Offered),
];
/// Names of what a struct is about: the struct's own name says what it is.
const CONTENTS: [&str; 3] = ["data", "values", "value"];
/// A shaft turns slower than this, in Hz.
const SHAFT: f64 = 1000.0;

/// The struct in which a variable stands, with its last dot; empty for variables of their own.
pub fn container(name: &str) -> &str {
    name.rfind('.').map_or("", |dot| &name[..=dot])
}

/// The last part of a name that is more than `Data`; of `X(1).Data` it is `X`.
fn key(name: &str) -> &str {
    let (container, last) = name.split_at(container(name).len());
    match container.strip_suffix('.') {
        Some(outer) if CONTENTS.contains(&last.to_lowercase().as_str()) => {
            let index = outer.rfind(['(', '{']).filter(|_| outer.ends_with([')', '}']));
            key(&outer[..index.unwrap_or(outer.len())])
        }
        _ => last,
    }
}

/// The structs in which a variable stands, the innermost first; at last the file, whose name is empty.
fn structs(name: &str) -> impl Iterator<Item = &str> {
    std::iter::successors(Some(container(name)), |inner| inner.strip_suffix('.').map(container))
}

/// The struct of whose vectors a variable speaks. `vectors` are sorted.
pub fn scope<'n>(name: &'n str, vectors: &[&str]) -> &'n str {
    let has = |inside: &&str| {
        let behind = vectors.partition_point(|vector| vector < inside);
        vectors.get(behind).is_some_and(|vector| vector.starts_with(inside))
    };
    structs(name).find(has).unwrap_or_default()
}

/// What speaks of vectors, by their struct.
pub struct Scoped<T>(HashMap<String, Vec<T>>);

impl<T> Scoped<T> {
    pub fn of<'n>(things: impl Iterator<Item = (&'n str, T)>) -> Scoped<T> {
        let mut all: HashMap<String, Vec<T>> = HashMap::new();
        things.for_each(|(scope, thing)| all.entry(scope.to_owned()).or_default().push(thing));
        Scoped(all)
    }

    /// What speaks of a vector, the nearest first, with its struct.
    pub fn over<'a>(&'a self, name: &'a str) -> impl Iterator<Item = (&'a str, &'a T)> {
        let all = structs(name).filter_map(|scope| Some((scope, self.0.get(scope)?)));
        all.flat_map(|(scope, all)| all.iter().map(move |thing| (scope, thing)))
    }
}

/// The kind of abscissa that a vector of this name holds, and its factor to s or Hz.
fn kind(name: &str, unit: Option<&str>) -> Option<(AxisKind, f64)> {
    // Recorders of control systems write `X.Data` and `Y.Data`.
    let is_x = key(name) == "X" && !name.ends_with('X');
    text::abscissa(if is_x || key(name) == "tout" { "time" } else { key(name) }, unit)
}

fn rises(values: &Values) -> Option<&[f64]> {
    match values {
        Values::Real(values) if values.len() > 1 && values.is_sorted_by(|a, b| a < b) => Some(values),
        _ => None,
    }
}

/// A scalar that says something of the abscissa of vectors.
struct Scalar {
    name: String,
    meaning: Meaning,
    trust: Trust,
    /// Of a step that may be one of frequency: what its unit says.
    kind: Option<AxisKind>,
    /// In s or Hz; the step of a rate.
    value: f64,
}

impl Scalar {
    fn of(name: &str, said: &str, notes: &[(String, String)]) -> Option<Scalar> {
        let word = key(name).replace('_', "").to_lowercase();
        let named = NAMES.iter().find(|(names, ..)| names.contains(&word.as_str()));
        let part = || PARTS.iter().find(|(parts, _)| parts.iter().any(|part| word.contains(part)));
        let (meaning, mut trust) =
            named.map(|n| (n.1, n.2)).or_else(|| part().map(|(_, trust)| (Rate, *trust)))?;
        let value = number::parse(said.as_bytes()).or_else(|| {
            trust = trust.max(Likely);
            number::parse_with(said.as_bytes(), b',')
        })?;
        let mut scalar = Scalar {
            name: name.to_owned(),
            meaning,
            trust,
            kind: Some(AxisKind::Time),
            value: if meaning == Rate { 1.0 / value } else { value },
        };
        if matches!(meaning, Increment | Start) {
            let inside = container(name);
            let labels = notes.iter().filter(|(label, _)| {
                label.starts_with(inside) && (is_unit(key(label)) || key(label) == "label")
            });
            let mut labels = labels.filter(|_| !inside.is_empty());
            scalar.kind = None;
            if let Some(unit) = labels.find_map(|(_, text)| Unit::parse(text)) {
                scalar.kind = Some(match unit.quantity() {
                    Quantity::Time => AxisKind::Time,
                    Quantity::Frequency if unit.symbol().ends_with("Hz") => AxisKind::Frequency,
                    _ => return None,
                });
                scalar.value *= unit.factor();
                scalar.trust = Sure;
            }
        }
        (meaning == Start || POSSIBLE.contains(&(1.0 / scalar.value))).then_some(scalar)
    }
}

/// What the file and the person say of abscissae.
pub struct Axes<'a> {
    options: &'a Options,
    /// With their names, times before frequencies.
    vectors: Scoped<(String, Axis)>,
    scalars: Scoped<Scalar>,
    /// Vectors that rise evenly and are not known as abscissae: name, length and step.
    even: Vec<(String, usize, f64)>,
}

impl<'a> Axes<'a> {
    /// Takes the rising vectors named as abscissae out of `arrays` where another array has their length. `notes` are the scalars and texts.
    pub fn find<'n>(
        arrays: &mut Vec<(String, Array)>,
        notes: &'n [(String, String)],
        options: &'a Options,
        findings: &mut Vec<Finding>,
    ) -> Axes<'a> {
        let stated = units(notes, arrays);
        let unit = |name: &str| stated.get(container(name)).copied();
        let kinds: Vec<_> = arrays.iter().map(|(name, _)| kind(name, unit(name))).collect();
        let values = arrays.iter().zip(&kinds);
        let values = values.filter(|((_, array), kind)| kind.is_none() || rises(&array.values).is_none());
        let mut values: Vec<&str> = values.map(|((name, _), _)| name.as_str()).collect();
        values.sort_unstable();
        let scalar =
            |(name, said): &'n (String, String)| Some((scope(name, &values), Scalar::of(name, said, notes)?));
        let scalars = Scoped::of(notes.iter().filter_map(scalar));
        let mut axes = Axes { options, vectors: Scoped(HashMap::new()), scalars, even: Vec::new() };
        let mut taken = vec![false; arrays.len()];
        let kinds = kinds.into_iter().enumerate().filter_map(|(at, kind)| Some((at, kind?)));
        let (mut kinds, lines): (Vec<_>, Vec<_>) = kinds.partition(|(_, (kind, _))| *kind == AxisKind::Time);
        kinds.extend(lines);
        for (at, (kind, factor)) in kinds {
            let (name, Array { dimensions, values: vector, single }) = &arrays[at];
            let (n, scope) = (vector.len() as u64, scope(name, &values));
            let others = arrays.iter().enumerate().filter(|(i, _)| *i != at && !taken[*i]);
            let mut others = others.filter(|(_, (of, _))| of.starts_with(scope));
            let fits = dimensions.contains(&n) && others.any(|(_, (_, other))| other.dimensions.contains(&n));
            let Some(vector) = rises(vector).filter(|_| fits) else {
                let rises = rises(vector).is_some();
                let code = if rises { "abscissa-of-other-length" } else { "abscissa-not-rising" };
                findings.push(Finding::caution(code).name("variable", name.as_str()));
                continue;
            };
            if key(name) == "X" && unit(name).is_none() {
                findings.push(Finding::caution("axis-by-name").name("variable", name.as_str()));
            }
            let vector: Vec<f64> = vector.iter().map(|v| v * factor).collect();
            let drift = drift(&vector, *single);
            let (axis, finding) = from_values(kind, vector, drift, &format!("vector {name:?}"));
            findings.extend(finding);
            let said = axes.chosen(name, false).into_iter();
            let mut said = said.filter(|(of, s)| s.kind == Some(AxisKind::Time) && *of == scope);
            let said = options.rate.or_else(|| Some(1.0 / said.next()?.1.value));
            if let Some(rate) = said.filter(|_| axis.kind == AxisKind::Time)
                && axis.step().is_none_or(|dt| (dt * rate - 1.0).abs() > 1e-6)
            {
                let used = if options.rate.is_some() { "rate" } else { "vector" };
                let found = Finding::caution("vector-against-rate").name("variable", name.as_str());
                findings.push(found.name("used", used).number("rate", rate));
            }
            taken[at] = true;
            axes.vectors.0.entry(scope.to_owned()).or_default().push((name.clone(), axis));
        }
        let mut taken = taken.into_iter();
        arrays.retain(|_| !taken.next().unwrap_or(false));
        axes
    }

    /// Remembers what among the records may be an abscissa.
    pub fn offer<'r>(&mut self, records: impl Iterator<Item = (&'r String, &'r Values)>) {
        let even = records.filter_map(|(name, values)| {
            let rising = rises(values)?;
            let step = Axis::from_values(AxisKind::Index, rising.to_vec(), drift(rising, false)).step()?;
            // Numbers from 1 on only count.
            (step != 1.0).then(|| (name.clone(), values.len(), step))
        });
        self.even = even.collect();
    }

    /// The scalars that say the step of a vector, the most certain first; none where that is not certain enough.
    fn chosen<'s>(&'s self, name: &'s str, complex: bool) -> Vec<(&'s str, &'s Scalar)> {
        let says = |s: &Scalar| {
            s.meaning != Start && s.trust != Offered && !(complex && s.kind == Some(AxisKind::Time))
        };
        let mut all: Vec<_> = self.scalars.over(name).filter(|(_, s)| says(s)).collect();
        all.sort_by_key(|(scope, s)| (s.trust == Vague, Reverse(scope.len()), s.trust));
        let doubtful = all.first().is_some_and(|(_, s)| s.trust == Vague && s.value * SHAFT > 1.0);
        if doubtful { Vec::new() } else { all }
    }

    /// The axis of a record.
    pub fn of(&self, values: &Values, meta: &mut Meta, findings: &mut Vec<Finding>) -> Result<Axis> {
        let (n, complex, name) = (values.len(), matches!(values, Values::Complex(_)), meta.name.clone());
        let fits = |axis: &Axis| axis.len() == n && !(complex && axis.kind == AxisKind::Time);
        let mut fitting = self.vectors.over(&name).filter(|(_, (_, axis))| fits(axis));
        let said = self.chosen(&name, complex);
        // What stands nearer is meant.
        let nearest = said.first().map_or(0, |(scope, _)| scope.len());
        let first = fitting.next().filter(|(scope, _)| scope.len() >= nearest);
        let vector = first.map(|(_, (_, axis))| axis);
        match (self.options.rate, self.options.base_band) {
            (Some(rate), _) if !complex => {
                let step = said.first().map_or(1.0 / rate, |(_, scalar)| scalar.value);
                if vector.is_none() && (step * rate - 1.0).abs() > 1e-5 {
                    let found = Finding::caution("rate-overrides-step").number("step", step);
                    meta.found(found.number("rate", rate));
                }
                let time = vector.filter(|axis| axis.kind == AxisKind::Time);
                return Ok(Axis::time(time.map_or(0.0, Axis::start), 1.0 / rate, n));
            }
            (None, Some(band)) => {
                return Ok(Axis::frequency(0.0, band / n.saturating_sub(1).max(1) as f64, n));
            }
            _ => {}
        }
        if let Some((scope, (used, axis))) = first {
            if let Some((_, (other, _))) = fitting.find(|(of, (_, other))| *of == scope && other != axis) {
                let found = Finding::caution("time-or-frequency").name("variable", name.as_str());
                findings.push(found.name("used", used).name("other", other));
            }
            return Ok(axis.clone());
        }
        let Some((scope, scalar)) = said.first() else {
            meta.found(self.unsaid(&name, n));
            return Ok(Axis::index(n));
        };
        let differs = |other: &&Scalar| (other.value / scalar.value - 1.0).abs() > 1e-6;
        let rival = said.iter().filter(|(of, _)| of == scope).map(|(_, other)| *other).find(differs);
        if let Some(other) = rival.filter(|other| other.trust == scalar.trust) {
            let hertz = |of: &Scalar| format!("{} Hz", short(1.0 / of.value));
            let (a, b) = (hertz(scalar), hertz(other));
            let found = format!("{:?} says a sampling rate of {a}, {:?} {b}", scalar.name, other.name);
            let error = Error::usage(found, "one sampling rate");
            return Err(error.hint("state the sampling rate").setting("rate"));
        }
        let over_frequency = scalar.kind.as_ref().map_or(complex, |kind| *kind == AxisKind::Frequency);
        if scalar.trust != Sure {
            let step = scalar.value;
            let (fact, value) = if over_frequency { ("step", step) } else { ("rate", 1.0 / step) };
            let found = Finding::caution("step-by-name").name("variable", &scalar.name).number(fact, value);
            meta.found(if let Some(other) = rival { found.name("other", &other.name) } else { found });
        }
        let beside = |s: &&Scalar| s.meaning == Start && container(&s.name) == container(&scalar.name);
        let start = self.scalars.over(&name).map(|(_, s)| s).find(beside).map_or(0.0, |s| s.value);
        let axis = if over_frequency { Axis::frequency } else { Axis::time };
        Ok(axis(start, scalar.value, n))
    }

    /// What to say of `n` values without an abscissa: which variables may hold it.
    fn unsaid(&self, name: &str, n: usize) -> Finding {
        let mut found = Finding::caution("abscissa-unsaid");
        let offered = self.scalars.over(name).map(|(_, s)| s).filter(|s| s.trust >= Vague);
        if let Some(scalar) = offered.min_by_key(|s| !s.name.contains("ampl")) {
            found = found.name("variable", scalar.name.as_str()).number("rate", 1.0 / scalar.value);
        }
        if let Some((vector, _, step)) = self.even.iter().find(|(of, len, _)| *len == n && of != name) {
            found = found.name("vector", vector).number("rises", 1.0 / step);
        }
        found
    }

    /// Whether an abscissa of `n` values is known for an array.
    pub fn has(&self, name: &str, n: u64) -> bool {
        self.vectors.over(name).any(|(_, (_, axis))| axis.len() as u64 == n)
    }
}

fn is_unit(key: &str) -> bool {
    matches!(key, "Unit" | "unit" | "Units" | "units")
}

/// The units that structs state of their only vector.
pub fn units<'n>(notes: &'n [(String, String)], arrays: &[(String, Array)]) -> HashMap<&'n str, &'n str> {
    let mut vectors: HashMap<&str, usize> = HashMap::new();
    for (name, _) in arrays {
        *vectors.entry(container(name)).or_default() += 1;
    }
    let stated = notes.iter().map(|(name, text)| (name.split_at(container(name).len()), text.as_str()));
    let stated = stated.filter(|((inside, word), text)| {
        !inside.is_empty() && vectors.get(inside) == Some(&1) && is_unit(word) && Unit::parse(text).is_some()
    });
    stated.map(|((inside, _), text)| (inside, text)).collect()
}

/// Sums of steps drift by rounding: a millionth of a step is no unevenness. Floats of 32 bits round to 2⁻²⁴.
fn drift(values: &[f64], single: bool) -> f64 {
    let (first, last) = (values[0], values[values.len() - 1]);
    let drift = 0.5e-6 * (last - first) / (values.len() - 1).max(1) as f64;
    if single { drift.max(first.abs().max(last.abs()) * f64::from(f32::EPSILON) / 2.0) } else { drift }
}
