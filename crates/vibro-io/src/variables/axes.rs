//! Abscissae and units of vectors, found by the names of other variables.

use super::Array;
use super::names::Meaning::{Increment, Rate, Start};
use super::names::Trust::{Likely, Offered, Sure, Vague};
use super::names::{Dialect, Meaning, Scoped, Trust, UNIT, X_UNIT};
use crate::assemble::{DAY, JudgedAxis, drift, epoch, from_values, kind_of, short};
use crate::held::Held;
use crate::number;
use crate::options::{Options, POSSIBLE};
use crate::text::names::Name;
use std::cmp::Reverse;
use std::collections::HashMap;
use vibro_record::code;
use vibro_record::units::{Quantity, Unit};
use vibro_record::{Axis, AxisKind, Error, Finding, Grid, Meta, Result};

/// Fastest shaft in Hz: a `rate` below it may be a speed of rotation.
const SHAFT: f64 = 1000.0;

/// Days since the year 0, as MATLAB counts them, of dates from 2001 to 2096.
const DATENUM: std::ops::Range<f64> = 730_852.0..765_700.0;
/// Mean step from which times without a unit count as clock ticks and give no axis. A smaller limit would
/// refuse slow records in s; a larger one would read ticks as seconds.
const TICKS: f64 = 1000.0;
/// Magnitude of a start in s from which times are counted from their first value before scaling: larger
/// starts leave a double too few digits for the steps.
const FAR: f64 = 1e6;

/// Kind of abscissa that a vector of this name holds, its origin in the stored unit and its factor to s or
/// Hz, and a finding on an assumed unit. `None` if the vector is not an abscissa.
fn kind(
    dialect: &Dialect,
    name: &str,
    unit: Option<&str>,
    values: &Held,
) -> Option<(AxisKind, [f64; 2], Option<Finding>)> {
    // Recorders of control systems write `X.Data` and `Y.Data`.
    let key = dialect.key(name);
    let seconds = key == "tout" || key == "X" && !name.ends_with('X');
    let mut said = Name::parse(if seconds { "time" } else { key });
    said.unit = unit.filter(|unit| !unit.is_empty()).map(str::to_owned).or(said.unit);
    // A channel with the unit s or Hz need not be the abscissa of other channels.
    let by_unit = Name { name: String::new(), ..said.clone() }.axis(true).is_some();
    let by_name = Name { unit: None, ..said.clone() }.axis(true).is_some();
    let kind = said.axis(true).filter(|_| !said.is_vague() && (by_name || !by_unit))?;
    let (factor, assumed) = said.to_axis(&kind).ok()?;
    match values.rising() {
        Some(values) if said.unit.is_none() && kind == AxisKind::Time => {
            let (first, last) = (values[0], values[values.len() - 1]);
            let step = (last - first) / (values.len() - 1) as f64;
            let days = !dialect.attributes && DATENUM.contains(&first) && step < 1.0;
            let days = days.then_some((code::AXIS_UNIT_ASSUMED, "d", DAY));
            let dated = epoch(first).map(|(unit, factor)| ("axis-epoch", unit, factor)).or(days);
            if let Some((code, unit, factor)) = dated {
                return Some((kind, [first, factor], Some(Finding::caution(code).name("unit", unit))));
            }
            // Formats without attributes get one finding on units for the whole file.
            (step < TICKS).then_some((kind, [0.0, 1.0], assumed.filter(|_| !seconds && dialect.attributes)))
        }
        _ => Some((kind, [0.0, factor], assumed)),
    }
}

/// A scalar that describes the abscissa of vectors.
struct Scalar {
    name: String,
    meaning: Meaning,
    trust: Trust,
    /// Kind of abscissa; `None` for an increment or a start whose unit does not state it.
    kind: Option<AxisKind>,
    /// Value in s or Hz; for a sampling rate, the step in s.
    value: f64,
}

impl Scalar {
    /// The statement of a scalar about the struct or vector `scope`; `None` if its name has no known
    /// meaning or its value is impossible.
    fn of(
        dialect: &Dialect,
        (name, said): &(String, String),
        scope: &str,
        notes: &[(String, String)],
    ) -> Option<Scalar> {
        let own = Name::parse(dialect.key(name));
        let (meaning, mut trust) = dialect.meaning(&own.name)?;
        let value = number::parse(said.as_bytes()).or_else(|| {
            trust = trust.max(Likely);
            number::parse_with(said.as_bytes(), b',')
        })?;
        let mut scalar = Scalar {
            name: name.clone(),
            meaning,
            trust,
            kind: Some(AxisKind::Time),
            value: if meaning == Rate { 1.0 / value } else { value },
        };
        let (inside, word) = (dialect.container(name), dialect.word(&own.name));
        let its_own = |label: &str| {
            let own = dialect.word(label);
            let unit = own.strip_prefix(&word).is_some_and(|rest| matches!(rest, "unit" | "units"));
            unit && dialect.container(label) == inside
        };
        let labelled = notes.iter().find(|(label, _)| its_own(label)).map(|(_, text)| text.clone());
        if matches!(meaning, Increment | Start) {
            // A unit beside vectors is the unit of the vectors.
            let apart = dialect.bare(inside) != dialect.bare(scope);
            let says = |label: &str| {
                let (word, beside) = (dialect.word(label), dialect.container(label) == inside);
                let word = word.as_str();
                beside && X_UNIT.contains(&word) || apart && (UNIT.contains(&word) || word == "label")
            };
            let mut labels = notes.iter().filter(|(label, _)| label.starts_with(inside) && says(label));
            scalar.kind = None;
            let label = labels.find_map(|(_, text)| Unit::parse(text));
            if let Some(unit) = labelled.or(own.unit).and_then(|text| Unit::parse(&text)).or(label) {
                scalar.kind = Some(kind_of(&unit)?);
                scalar.value *= unit.factor();
                scalar.trust = Sure;
            }
        } else if let Some(text) = labelled.or(own.unit) {
            let quantity = if meaning == Rate { Quantity::Frequency } else { Quantity::Time };
            match Unit::parse(&text).filter(|unit| unit.quantity() == quantity) {
                Some(unit) if meaning == Rate => scalar.value /= unit.hertz().unwrap_or(unit.factor()),
                Some(unit) => scalar.value *= unit.factor(),
                None => scalar.trust = Offered,
            }
        }
        (meaning == Start || POSSIBLE.contains(&(1.0 / scalar.value))).then_some(scalar)
    }
}

/// Abscissae that the file or the user states.
pub struct Axes<'a> {
    pub dialect: &'static Dialect,
    options: &'a Options,
    /// Vectors that are abscissae, times before frequencies: name, axis and relative standard uncertainty
    /// of the step.
    vectors: Scoped<(String, Axis, f64)>,
    scalars: Scoped<Scalar>,
    /// For each struct: depth of the outermost arrays in it, and their largest dimension.
    outer: HashMap<String, (Reverse<usize>, Option<u64>)>,
    /// Vectors that rise evenly but are not used as abscissae: name, length and step.
    even: Vec<(String, usize, f64)>,
}

/// For each struct: depth of the outermost arrays in it, and their largest dimension.
fn outermost(
    dialect: &Dialect,
    arrays: &[(String, Array)],
) -> HashMap<String, (Reverse<usize>, Option<u64>)> {
    let mut all = HashMap::new();
    for (name, array) in arrays {
        let at = (Reverse(dialect.structs(name).count()), array.dimensions.iter().copied().max());
        for scope in dialect.structs(name) {
            let outer = all.entry(scope.to_owned()).or_insert(at);
            *outer = at.max(*outer);
        }
    }
    all
}

impl<'a> Axes<'a> {
    /// Removes the rising vectors named as abscissae from `arrays` if another array has their length.
    /// `notes` are the scalars and texts.
    pub fn find<'n>(
        dialect: &'static Dialect,
        arrays: &mut Vec<(String, Array)>,
        notes: &'n [(String, String)],
        options: &'a Options,
        findings: &mut Vec<Finding>,
    ) -> Axes<'a> {
        let stated = units(dialect, notes, arrays);
        let own = |name| if dialect.attributes { name } else { dialect.bare(dialect.container(name)) };
        let unit = |name| stated.get(own(name)).copied();
        let kinds: Vec<_> =
            arrays.iter().map(|(name, array)| kind(dialect, name, unit(name), &array.values)).collect();
        let values = arrays.iter().zip(&kinds);
        let values = values.filter(|((_, array), kind)| kind.is_none() || array.values.rising().is_none());
        let mut values: Vec<&str> = values.map(|((name, _), _)| name.as_str()).collect();
        values.sort_unstable();
        let scalar = |note: &'n (String, String)| {
            let scope = dialect.scope(&note.0, &values);
            Some((scope, Scalar::of(dialect, note, scope, notes)?))
        };
        let scalars = Scoped::of(dialect, notes.iter().filter_map(scalar));
        let vectors = Scoped::of(dialect, std::iter::empty());
        let outer = outermost(dialect, arrays);
        let mut axes = Axes { dialect, options, vectors, scalars, outer, even: Vec::new() };
        let mut taken = vec![false; arrays.len()];
        let kinds = kinds.into_iter().enumerate().filter_map(|(at, kind)| Some((at, kind?)));
        let mut kinds: Vec<_> = kinds.collect();
        kinds.sort_by_key(|(_, (kind, ..))| *kind != AxisKind::Time);
        for (at, (kind, [from, factor], assumed)) in kinds {
            let (name, Array { dimensions, values: vector, single }) = &arrays[at];
            let (n, scope) = (vector.len() as u64, dialect.scope(name, &values));
            let others = arrays.iter().enumerate().filter(|(i, _)| *i != at && !taken[*i]);
            let mut others = others.filter(|(_, (of, _))| of.starts_with(scope));
            let fits = dimensions.contains(&n) && others.any(|(_, (_, other))| other.dimensions.contains(&n));
            let Some(vector) = vector.rising().filter(|_| fits) else {
                let rises = vector.rising().is_some();
                let code = if rises { "abscissa-of-other-length" } else { "abscissa-not-rising" };
                findings.push(Finding::caution(code).name("variable", name.as_str()));
                continue;
            };
            if dialect.key(name) == "X" && unit(name).is_none() {
                findings.push(Finding::caution("axis-by-name").name("variable", name.as_str()));
            }
            let label = format!("vector {name:?}");
            let drift = drift(vector, *single) * factor;
            // Seconds since 1970 as doubles leave too few digits for the steps.
            let first = if (vector[0] * factor).abs() >= FAR { vector[0] } else { from };
            let vector = vector.iter().map(|v| (v - first) * factor).collect();
            let JudgedAxis { mut axis, step_relative_std: clock, found } =
                from_values(kind, vector, drift, &label, options.resample.is_some());
            match &mut axis.grid {
                Grid::Even { start, .. } => *start += (first - from) * factor,
                Grid::Uneven(values) => values.iter_mut().for_each(|v| *v += (first - from) * factor),
            }
            findings.extend(assumed.map(|found| found.name("column", label)).into_iter().chain(found));
            findings.extend(axes.against_rate(name, scope, &axis));
            taken[at] = true;
            axes.vectors.add(scope, (name.clone(), axis, clock));
        }
        let mut taken = taken.into_iter();
        arrays.retain(|_| !taken.next().unwrap_or(false));
        axes
    }

    /// Finding that times in the vector `name` have another rate than the user or their struct states.
    fn against_rate(&self, name: &str, scope: &str, axis: &Axis) -> Option<Finding> {
        let said = self.chosen(name, axis.len(), false).into_iter();
        let mut said = said.filter(|(of, s)| s.kind == Some(AxisKind::Time) && *of == scope);
        let said = self.options.rate.or_else(|| Some(1.0 / said.next()?.1.value));
        let differs = |rate: &f64| {
            axis.kind == AxisKind::Time && axis.step().is_none_or(|dt| (dt * rate - 1.0).abs() > 1e-6)
        };
        let rate = said.filter(differs)?;
        let used = if self.options.rate.is_some() { "rate" } else { "vector" };
        let found = Finding::caution("vector-against-rate").name("variable", name);
        Some(found.name("used", used).number("rate", rate))
    }

    /// Remembers records that rise evenly: a finding may suggest one as abscissa.
    pub fn offer<'r>(&mut self, records: impl Iterator<Item = (&'r String, &'r Held)>) {
        let even = records.filter_map(|(name, values)| {
            let rising = values.rising()?;
            let step = Axis::from_values(AxisKind::Index, rising.to_vec(), drift(rising, false)).step()?;
            // Steps of exactly 1 are sample numbers.
            (step != 1.0).then(|| (name.clone(), values.len(), step))
        });
        self.even = even.collect();
    }

    /// Scalars that state the step of a vector of `n` values: the nearest first, at equal distance the
    /// surest first, vague ones last. Empty if all are vague and the first states a rate below [`SHAFT`].
    fn chosen<'s>(&'s self, name: &'s str, n: usize, complex: bool) -> Vec<(&'s str, &'s Scalar)> {
        // A vector nested deeper than others of the struct, and at most half as long, was usually computed
        // from them and has another rate.
        let depth = self.dialect.structs(name).count();
        let shorter = |(d, long): &(Reverse<usize>, Option<u64>)| d.0 < depth && Some(2 * n as u64) <= *long;
        let made = |scope: &str| self.outer.get(scope).is_some_and(shorter);
        let says = |s: &Scalar| {
            s.meaning != Start && s.trust != Offered && !(complex && s.kind == Some(AxisKind::Time))
        };
        let mut all: Vec<_> = self.scalars.over(name).filter(|(of, s)| says(s) && !made(of)).collect();
        all.sort_by_key(|(scope, s)| (s.trust == Vague, Reverse(scope.len()), s.trust));
        let doubtful = all.first().is_some_and(|(_, s)| s.trust == Vague && s.value * SHAFT > 1.0);
        if doubtful { Vec::new() } else { all }
    }

    /// The axis of a record of the vector or matrix `name`.
    pub fn of(
        &self,
        name: &str,
        values: &Held,
        meta: &mut Meta,
        findings: &mut Vec<Finding>,
    ) -> Result<Axis> {
        let (n, complex) = (values.len(), values.is_complex());
        let fits = |axis: &Axis| axis.len() == n && !(complex && axis.kind == AxisKind::Time);
        let mut fitting = self.vectors.over(name).filter(|(_, (_, axis, _))| fits(axis));
        let said = self.chosen(name, n, complex);
        // The nearer statement is used; a vector beside the values takes precedence over an attribute.
        let beside = self.dialect.container(name).len();
        let nearest = said.first().map_or(0, |(scope, _)| scope.len().min(beside));
        let first = fitting.next().filter(|(scope, _)| scope.len() >= nearest);
        let vector = first.map(|(_, (_, axis, _))| axis);
        let step = said.first().map(|(_, scalar)| scalar.value);
        if let Some(axis) = self.stated(values, vector, step, meta) {
            return Ok(axis);
        }
        if let Some((scope, (used, axis, clock))) = first {
            if let Some((_, (other, ..))) = fitting.find(|(of, (_, other, _))| *of == scope && other != axis)
            {
                let found = Finding::caution("time-or-frequency").name("variable", meta.name.as_str());
                findings.push(found.name("used", used).name("other", other));
            }
            meta.clock = *clock;
            return Ok(axis.clone());
        }
        if said.is_empty() {
            meta.found(self.unsaid(name, values, &meta.name));
            return Ok(Axis::index(n));
        }
        self.by_scalar(name, values, &said, meta)
    }

    /// The axis that the user states, by a sampling rate or a base band. A finding reports a different
    /// `step` of the file, unless there is a `vector` beside the values.
    fn stated(
        &self,
        values: &Held,
        vector: Option<&Axis>,
        step: Option<f64>,
        meta: &mut Meta,
    ) -> Option<Axis> {
        let (n, complex) = (values.len(), values.is_complex());
        match (self.options.rate, self.options.base_band) {
            (Some(rate), _) if !complex => {
                let step = step.unwrap_or(1.0 / rate);
                if vector.is_none() && (step * rate - 1.0).abs() > 1e-5 {
                    let found = Finding::caution("rate-overrides-step").number("step", step);
                    meta.found(found.number("rate", rate));
                }
                let time = vector.filter(|axis| axis.kind == AxisKind::Time);
                Some(Axis::time(time.map_or(0.0, Axis::start), 1.0 / rate, n))
            }
            (None, Some(band)) => Some(Axis::frequency(0.0, band / n.saturating_sub(1).max(1) as f64, n)),
            _ => None,
        }
    }

    /// The axis by the first of the scalars `said`, which state a step.
    fn by_scalar(
        &self,
        name: &str,
        values: &Held,
        said: &[(&str, &Scalar)],
        meta: &mut Meta,
    ) -> Result<Axis> {
        let (n, complex) = (values.len(), values.is_complex());
        let (scope, scalar) = said[0];
        let differs = |other: &&Scalar| (other.value / scalar.value - 1.0).abs() > 1e-6;
        let rival = said.iter().filter(|(of, _)| *of == scope).map(|(_, other)| *other).find(differs);
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
        let starts = |(scope, s): &(&str, &Scalar)| {
            let inside = self.dialect.container(&s.name);
            let near = inside == self.dialect.container(&scalar.name)
                || self.dialect.bare(inside) == self.dialect.bare(scope);
            near && s.meaning == Start && (s.trust == Sure || scalar.meaning == Increment)
        };
        let start = self.scalars.over(name).find(starts).map_or(0.0, |(_, s)| s.value);
        let axis = if over_frequency { Axis::frequency } else { Axis::time };
        Ok(axis(start, scalar.value, n))
    }

    /// Finding on values without an abscissa: it suggests variables that may hold it.
    fn unsaid(&self, name: &str, values: &Held, record: &str) -> Finding {
        let (n, complex) = (values.len(), values.is_complex());
        let mut found = Finding::caution(code::ABSCISSA_UNSAID);
        let offered = self
            .scalars
            .over(name)
            .map(|(_, s)| s)
            .filter(|s| s.trust >= Vague || s.meaning != Start && !complex);
        if let Some(scalar) = offered.min_by_key(|s| !s.name.contains("ampl")) {
            found = found.name("variable", scalar.name.as_str()).number("rate", 1.0 / scalar.value);
        }
        if let Some((vector, _, step)) = self.even.iter().find(|(of, len, _)| *len == n && of != record) {
            found = found.name("vector", vector).number("rises", 1.0 / step);
        }
        found
    }

    /// Whether an abscissa of `n` values is known for an array.
    pub fn has(&self, name: &str, n: u64) -> bool {
        self.vectors.over(name).any(|(_, (_, axis, _))| axis.len() as u64 == n)
    }
}

/// Units, keyed by the vector that has the unit as attribute, or by the struct that states it: for its only
/// vector or, in formats with attributes, for all its vectors.
pub fn units<'n>(
    dialect: &Dialect,
    notes: &'n [(String, String)],
    arrays: &[(String, Array)],
) -> HashMap<&'n str, &'n str> {
    let mut vectors: HashMap<&str, usize> = HashMap::new();
    for (name, _) in arrays {
        *vectors.entry(dialect.container(name)).or_default() += 1;
    }
    let stated = notes.iter().map(|(name, text)| (dialect.container(name), name, text.trim()));
    let stated = stated.filter(|(inside, name, text)| {
        let only = !inside.is_empty() && vectors.get(inside) == Some(&1) && Unit::parse(text).is_some();
        (only || dialect.attributes) && !text.is_empty() && UNIT.contains(&dialect.word(name).as_str())
    });
    stated.map(|(inside, _, text)| (dialect.bare(inside), text)).collect()
}
