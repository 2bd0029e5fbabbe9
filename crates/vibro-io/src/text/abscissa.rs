//! Finds the abscissa among the columns of a text, by its name or because it rises. Its unit comes from its
//! name, the header or its first value.

use super::axis::{PrintedAbscissa, choose};
use super::column::Column;
use super::names::Name;
use super::records::RecordContext;
use super::tail;
use super::unit_words::symbol;
use crate::assemble::{self, JudgedAxis, NOMINAL, domain, from_values, short};
use crate::held::Held;
use crate::options::Options;
use std::borrow::Cow;
use vibro_record::code;
use vibro_record::units::is_level;
use vibro_record::{Axis, AxisKind, Error, Finding, Meta, Result, Values};

/// The axis of all records of a text, and what its column and the header state about it.
pub struct CommonAxis {
    pub axis: Axis,
    /// Relative standard uncertainty of the step; 0 if no column is used.
    clock: f64,
    /// Half a unit in the last digit of the printed values, in s or Hz; 0 if no column is used.
    resolution: f64,
    /// Time of its 0 in s since 1970, if the column counts from then; else 0.
    origin: f64,
    /// Number of values expected from the spectral lines that the header states, if it differs from the
    /// number read.
    pub declared: Option<usize>,
}

/// The symbol of a unit of times or frequencies.
///
/// # Errors
/// If the text is none.
pub fn axis_unit(text: &str) -> Result<String> {
    let unit = symbol(text.trim()).to_owned();
    let name = Name { unit: Some(unit.clone()), ..Name::default() };
    let is_axis = matches!(name.axis(true), Some(AxisKind::Time | AxisKind::Frequency));
    let expected = "a unit of time or frequency: s, ms, µs, min, h, Hz, kHz, …";
    let none = || Error::usage(format!("the unit {text:?} of times"), expected).setting("axis_unit");
    if is_axis { Ok(unit) } else { Err(none()) }
}

impl CommonAxis {
    /// Stores clock, resolution, origin and declared number of values in a record's metadata.
    pub fn state(&self, meta: &mut Meta) {
        meta.declared_n = self.declared;
        if self.axis.kind == AxisKind::Time {
            (meta.clock, meta.resolution, meta.origin) = (self.clock, self.resolution, self.origin);
        }
    }
}

/// How the printed values of an abscissa become s or Hz.
struct AxisScale {
    kind: AxisKind,
    /// The value that becomes 0.
    from: f64,
    /// Factor to s or Hz.
    factor: f64,
    /// Time of the value `from` in s since 1970, if the column counts from then; else 0.
    origin: f64,
    /// Finding on an assumed unit, kind or origin.
    assumed: Option<Finding>,
}

/// Numbers of spectral lines that analysers offer, not counting 0 Hz.
const LINES: [usize; 10] = [100, 200, 400, 800, 1600, 3200, 6400, 12800, 25600, 51200];

impl RecordContext<'_> {
    /// Whether the first column of a file without names only counts its rows. The axis is then the next
    /// column or from the header.
    pub fn numbered(&self, table: &[Column]) -> bool {
        let beside = || table.len() > 2 && table[1].rises();
        let headed = self.stated.rate.is_some() || self.stated.line_width.is_some();
        let counts = table.len() > 1 && table[0].values.len() > 2 && table[0].name.name.is_empty();
        !self.is_table && counts && table[0].counts() && (headed || beside())
    }

    /// Whether `n` values without an axis are the lines of a spectrum: `n` is a number of lines that
    /// analysers use, and all values are of one sign or are levels in dB.
    fn holds_lines(&self, table: &[Column], n: usize) -> bool {
        let is_level = |column: &Column| {
            column.name.unit.as_deref().or(self.stated.unit.as_deref()).is_some_and(is_level)
        };
        let is_one_sided = |column: &Column| {
            let values = column.reals();
            let one_sign = values.iter().all(|v| *v >= 0.0) || values.iter().all(|v| *v <= 0.0);
            !values.is_empty() && (one_sign || is_level(column))
        };
        LINES.into_iter().any(|lines| n == lines || n == lines + 1) && table.iter().all(is_one_sided)
    }

    /// Index of the abscissa in `table`. A clear name is enough. Any other column must rise, since a column
    /// with a unit of time may hold intervals.
    pub fn abscissa(&self, table: &[Column]) -> Option<usize> {
        let by_name = |column: &Column| {
            !column.name.is_vague()
                && Name { unit: None, ..column.name.clone() }.axis(column.at == 1).is_some()
                && column.reals().iter().all(|v| v.is_finite())
        };
        if self.is_table {
            let named = self.dialect.named_abscissa()?;
            let is = |at: &usize| {
                by_name(&table[*at]) || table[*at].rises() || self.dialect.clock_at() == Some(named)
            };
            // Columns without any value were removed, so an index differs from the column's number in the
            // row.
            return table.iter().position(|column| column.at - 1 == named).filter(is);
        }
        let pair = self.options.complex && table.len() == 2 && !self.dialect.complex;
        let clock = table.iter().position(|column| Some(column.at - 1) == self.dialect.clock_at());
        if clock.is_some() {
            return clock;
        }
        let first = &table[0];
        let is = by_name(first) || (!pair && first.values.len() > 2 && first.rises());
        (table.len() > 1 && is).then_some(0)
    }

    /// Chooses the axis of `n` values: from the options, the printed column or the header.
    pub fn common_axis(
        &self,
        printed: Option<PrintedAbscissa>,
        table: &[Column],
        n: usize,
        findings: &mut Vec<Finding>,
    ) -> Result<CommonAxis> {
        let has_axis = printed.is_some();
        let (resolution, origin) =
            printed.as_ref().map_or((0.0, 0.0), |printed| (printed.resolution, printed.origin));
        let band = self.options.rate_of_band.filter(|_| !has_axis && self.holds_lines(table, n));
        let of_lines = band.map(|band| Options { rate: None, base_band: Some(band), ..self.options.clone() });
        findings
            .extend(band.map(|band| Finding::caution("values-are-lines").count("n", n).number("band", band)));
        let stated = of_lines.as_ref().unwrap_or(self.options);
        let (clock, axis) = choose(printed, n, &self.stated, stated, findings)?;
        let lines = self.stated.lines.filter(|_| axis.kind == AxisKind::Frequency && !has_axis);
        let declared = lines.map(|lines| lines as usize + 1).filter(|all| n != *all && n + 1 != *all);
        Ok(CommonAxis { axis, clock, resolution, origin, declared })
    }

    /// The axis from its `column`, in s or Hz if its kind is known, with the findings on it.
    pub fn printed(&self, column: Column, others: &[Column]) -> Result<PrintedAbscissa> {
        let column = self.with_stated_unit(column)?;
        let name = &column.name.name;
        let label = if name.is_empty() { place(&column) } else { format!("column {name:?}") };
        let values = column.reals();
        let AxisScale { kind, from, factor, origin, assumed } = self.scale(&column, &values)?;
        let own = self.resolution(&column, &values);
        let by_name = self.is_clock(&column) || column.name.axis(column.at == 1).is_some();
        self.one_clock(&kind, &column, (factor, own), others)?;
        // Converted in place, so that a long record needs memory for one column of times, not two.
        let mut values = match column.values {
            Held::Values(Values::Real(values)) => values,
            _ => values.into_owned(),
        };
        for v in &mut values {
            *v = (*v - from) * factor;
        }
        let head = if kind == AxisKind::Frequency { "frequency (kHz)" } else { "time (ms)" };
        let resampled = self.options.resample.is_some();
        let JudgedAxis { axis, step_relative_std: clock, found } =
            from_values(kind, values, own * factor, &label, resampled);
        let assumed = assumed.map(|found| found.name("column", label.as_str()));
        let assumed =
            assumed.map(
                |found| if found.code == code::AXIS_UNIT_ASSUMED { found.name("head", head) } else { found },
            );
        let findings = column.name.unit_differs(true).into_iter().chain(assumed).chain(found).collect();
        Ok(PrintedAbscissa {
            axis,
            label,
            resolution: own * factor,
            assumed: !by_name && !self.over_hertz(),
            origin,
            clock,
            findings,
        })
    }

    /// The column with the unit that the user states, where it names none.
    ///
    /// # Errors
    /// If the column names another.
    fn with_stated_unit(&self, mut column: Column) -> Result<Column> {
        let Some(stated) = self.options.axis_unit.as_deref() else { return Ok(column) };
        match column.name.unit.replace(stated.to_owned()) {
            Some(own) if own != stated => {
                let found = format!("the column names the unit {own}, and {stated} was stated");
                Err(Error::usage(found, "one unit").hint("leave it out").setting("axis_unit"))
            }
            _ => Ok(column),
        }
    }

    /// Whether the column holds date and time.
    fn is_clock(&self, column: &Column) -> bool {
        self.dialect.clock_at() == Some(column.at - 1)
    }

    /// The scale of an abscissa by its name, the header or the options; of times also by their first value.
    fn scale(&self, column: &Column, values: &[f64]) -> Result<AxisScale> {
        let scale = self.stated_scale(column, values)?;
        Ok(if scale.kind == AxisKind::Time { self.counted_from(scale, column, values) } else { scale })
    }

    /// The scale of an abscissa by its name, else by the header or the options.
    fn stated_scale(&self, column: &Column, values: &[f64]) -> Result<AxisScale> {
        let by_name =
            if self.is_clock(column) { Some(AxisKind::Time) } else { column.name.axis(column.at == 1) };
        let (kind, factor, assumed) = match (by_name, self.domain(values.len())) {
            (Some(kind), _) => {
                let unsaid = column.name.unit.is_none() && kind == AxisKind::Time && !self.is_clock(column);
                if let Some((unit, factor)) = self.unit_by_rate(values).filter(|_| unsaid) {
                    (kind, factor, Some(Finding::note("axis-unit-by-rate").name("unit", unit)))
                } else {
                    let (factor, assumed) = column.name.to_axis(&kind)?;
                    (kind, factor, assumed)
                }
            }
            (None, Some(kind)) => {
                // Steps of 1 from 0 or 1 are a count of the values, without a unit.
                let counts = matches!(values, [first @ (0.0 | 1.0), second, ..] if second - first == 1.0);
                let unit = self.unit_by_rate(values).filter(|_| !counts);
                let (unit, factor) = unit.unwrap_or((domain(&kind).1, 1.0));
                (kind, factor, Some(Finding::caution(code::AXIS_UNIT_ASSUMED).name("unit", unit)))
            }
            (None, None) => {
                let name = if column.name.name.is_empty() { place(column) } else { column.name.name.clone() };
                (AxisKind::Other(name), 1.0, Some(Finding::caution("axis-kind-unsaid")))
            }
        };
        Ok(AxisScale { kind, from: 0.0, factor, origin: 0.0, assumed })
    }

    /// The scale of times that count from 1970, or in days as in spreadsheets; the first value shows which.
    fn counted_from(&self, scale: AxisScale, column: &Column, values: &[f64]) -> AxisScale {
        if self.is_clock(column) {
            let minutes = || Finding::doubt("axis-clock-minutes").without_estimate();
            let found = if self.minutes() { minutes() } else { Finding::note("axis-clock") };
            return AxisScale { assumed: Some(found), ..scale };
        }
        let unsaid = column.name.unit.is_none();
        if unsaid && assemble::is_serial(values) {
            let assumed = Some(Finding::caution("axis-serial-days"));
            return AxisScale { from: values[0], factor: assemble::DAY, assumed, ..scale };
        }
        let epoch = values.first().and_then(|first| assemble::epoch(*first));
        let Some((unit, factor)) = epoch.filter(|(_, factor)| unsaid || *factor == scale.factor) else {
            return scale;
        };
        let found = if unsaid {
            Finding::caution("axis-epoch").name("unit", unit)
        } else {
            Finding::note("axis-clock")
        };
        AxisScale { from: values[0], factor, origin: values[0] * factor, assumed: Some(found), ..scale }
    }

    /// Half a unit in the last digit of the printed values, in their unit; at least the rounding of the
    /// floating-point format.
    fn resolution(&self, column: &Column, values: &[f64]) -> f64 {
        // Some instruments print times of single precision with more digits than they carry. Double
        // precision is assumed only if all steps are finer than the rounding of single precision.
        let largest = values.iter().fold(0.0, |max: f64, x| max.max(x.abs()));
        let single = largest * f64::from(f32::EPSILON) / 2.0;
        let finer = values.windows(2).all(|w| (w[1] - w[0]).abs() < single);
        self.last_digit(column).max(if finer { largest * f64::EPSILON } else { single })
    }

    /// Half a unit in the last digit of a column, as printed.
    fn last_digit(&self, column: &Column) -> f64 {
        tail::resolution(self.text, self.tail, self.dialect, column.at - 1)
    }

    /// Unit (s, ms or µs) of a time column without a unit, with its factor to s: the one whose mean step
    /// agrees with the rate that the user or the head states.
    fn unit_by_rate(&self, values: &[f64]) -> Option<(&'static str, f64)> {
        let step = (values.last()? - values[0]) / values.len().saturating_sub(1).max(1) as f64;
        let rate = self.options.rate.or(self.stated.rate);
        let agrees = |(_, factor): &(&str, f64)| {
            rate.is_some_and(|rate| (step * factor * rate - 1.0).abs() <= NOMINAL)
        };
        [("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)].into_iter().find(agrees)
    }

    /// Refuses a second column of the same kind as the abscissa but with another span: it is unknown which
    /// values belong to which.
    fn one_clock(
        &self,
        kind: &AxisKind,
        axis: &Column,
        (factor, resolution): (f64, f64),
        others: &[Column],
    ) -> Result<()> {
        let span = |column: &Column, factor: f64, n: usize| {
            let values = &column.reals()[..n];
            let rises = n > 1 && values.is_sorted_by(|a, b| a < b);
            rises.then(|| factor * (values[n - 1] - values[0]))
        };
        let same = |c: &&Column| c.sparse.is_none() && c.name.axis(true).as_ref() == Some(kind);
        for other in others.iter().filter(same) {
            if let Ok((theirs, _)) = other.name.to_axis(kind)
                // The columns of a channel with fewer values end in blanks.
                && let n = other.reals().iter().take_while(|v| v.is_finite()).count()
                && let (Some(a), Some(b)) = (span(axis, factor, n), span(other, theirs, n))
                && (b - a).abs() > 4.0 * (resolution * factor).max(self.last_digit(other) * theirs) + 1e-6 * a.abs()
            {
                let (one, two) = (axis.label(), other.label());
                let found = format!("{one:?} and {two:?} run over {} and {}", short(a), short(b));
                let hint = "take out the one that is wrong, or write each of them with its channels to a file of its own";
                return Err(Error::usage(found, "one clock for all columns").hint(hint));
            }
        }
        Ok(())
    }

    /// Whether a clock has two numbers and no date, such as 12:05: hours and minutes, or minutes and
    /// seconds.
    fn minutes(&self) -> bool {
        let first = self.dialect.rows(&self.text.head).next().and_then(|line| self.dialect.cut(&line).ok());
        let cell = self.dialect.clock_at().and_then(|at| first.as_ref()?.get(at));
        let colons =
            |(_, cell): &(usize, Cow<str>)| cell.split(|c: char| c.is_ascii_digit()).collect::<String>();
        cell.map(colons).as_deref() == Some(":")
    }

    /// Whether the header states that the abscissa is a frequency and states no step of a series.
    fn over_hertz(&self) -> bool {
        self.stated.lines_apart && !self.stated.of_one_series
    }

    /// Kind of the axis of `n` values, time or frequency, from the options or the header; `None` if neither
    /// states it.
    fn domain(&self, n: usize) -> Option<AxisKind> {
        let (options, stated) = (self.options, &self.stated);
        if self.over_hertz() {
            return Some(AxisKind::Frequency);
        }
        let spectrum = options.base_band.is_some() || stated.all_lines(n);
        if options.rate.is_some() || (!spectrum && stated.rate.is_some()) {
            return Some(AxisKind::Time);
        }
        let spectrum = spectrum || stated.spacing(n).is_some() || self.dialect.complex;
        spectrum.then_some(AxisKind::Frequency)
    }
}

/// Text that names a column without a name by its place.
fn place(column: &Column) -> String {
    if column.at == 1 { "first column".to_owned() } else { format!("column {}", column.at) }
}
