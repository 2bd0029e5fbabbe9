//! Makes records from columns: finds the abscissa, applies units, joins complex parts.

use super::axis::{PrintedAbscissa, choose};
use super::cautions;
use super::column::Column;
use super::decoded::Text;
use super::dialect::Dialect;
use super::header::Stated;
use super::names::{ComplexPart, NATURAL, Name};
use super::rows::Rows;
use super::tail;
use super::unit_words::amplitude;
use crate::assemble::{self, JudgedAxis, NOMINAL, Spectral, domain, from_values, short};
use crate::format::Format;
use crate::held::Held;
use crate::options::Options;
use crate::{level, number};
use num_complex::Complex64;
use std::borrow::Cow;
use vibro_record::code;
use vibro_record::lanes::Extremes;
use vibro_record::units::notation::counted;
use vibro_record::units::{Unit, is_level};
use vibro_record::{Axis, AxisKind, Error, Finding, Grid, Meta, Record, Result, Scaling, Values, Window};

/// One record for each column of values. Findings on the file as a whole are added to `findings`.
///
/// # Errors
/// If the columns contradict each other or what was stated.
pub fn build(
    text: &Text,
    tail: &[u8],
    dialect: &Dialect,
    rows: Rows,
    options: &Options,
    findings: &mut Vec<Finding>,
) -> Result<Vec<Built>> {
    let n = rows.columns.iter().map(Held::len).max().unwrap_or(0);
    let said = dialect.header.iter().chain(&rows.remarks).map(String::as_str);
    let stated = Stated::of(said, dialect.shown_mark(&text.head));
    let is_table = dialect.format == Format::Csv;
    let mut made = RecordContext { text, tail, dialect, is_table, options, stated, naturals: false };
    let mut of_axis = Vec::new();
    let names = dialect.names.clone().unwrap_or_else(|| vec![Name::default(); dialect.columns]);
    let sparse = rows.sparse.into_iter().chain(std::iter::repeat(None));
    let columns = rows.columns.into_iter().zip(names).zip(sparse).enumerate();
    let column = |(i, ((values, name), sparse))| Column { at: i + 1, name, values, sparse };
    let mut table: Vec<Column> = columns.map(column).collect();
    let empty = |column: &Column| rows.without_values.get(column.at - 1) == Some(&true);
    let unused: Vec<String> =
        table.iter().filter(|c| empty(c) && !c.name.name.is_empty()).map(Column::label).collect();
    if !unused.is_empty() {
        findings.push(Finding::note("columns-empty").name("columns", unused.join(", ")));
    }
    table.retain(|column| !empty(column));
    let numbered = made.numbered(&table);
    if numbered {
        table.remove(0);
    }
    let printed = made.abscissa(&table).map(|at| table.remove(at));
    // Counters are left out, unless the table holds nothing else.
    let first = if is_table { made.without_counters(&mut table, findings) } else { None };
    // Where every channel has its own time column, copies of the abscissa are left out.
    let again =
        |c: &Column, axis: &Column| c.name.axis(true) == axis.name.axis(true) && c.values == axis.values;
    let plain = dialect.names.is_none();
    let plain = plain && printed.as_ref().is_some_and(|axis| table.iter().any(|c| !again(c, axis)));
    table.retain(|column| !printed.as_ref().is_some_and(|axis| (is_table || plain) && again(column, axis)));
    table.retain(|column| !printed.as_ref().is_some_and(|axis| is_table && column.is_clock_of(axis)));
    let printed = printed.map(|column| made.printed(column, &table)).transpose()?;
    table.retain(|column| Some(column.at - 1) != dialect.clock_at());
    of_one_channel(&table)?;
    let has_axis = printed.is_some();
    if !has_axis {
        without_gaps(&table)?;
    }
    if numbered && !has_axis {
        of_axis.push(Finding::caution("column-numbers-rows"));
    }
    let (resolution, origin) =
        printed.as_ref().map_or((0.0, 0.0), |printed| (printed.resolution, printed.origin));
    let band = options.rate_of_band.filter(|_| !has_axis && made.holds_lines(&table, n));
    let of_lines = band.map(|band| Options { rate: None, base_band: Some(band), ..options.clone() });
    of_axis.extend(band.map(|band| Finding::caution("values-are-lines").count("n", n).number("band", band)));
    let stated = of_lines.as_ref().unwrap_or(options);
    let (clock, mut axis) = choose(printed, n, &made.stated, stated, &mut of_axis)?;
    if let (AxisKind::Index, Some(first), Grid::Even { start, .. }) = (&axis.kind, first, &mut axis.grid) {
        *start = first;
    }
    if table.is_empty() {
        return Err(Error::usage("only an abscissa", "at least one column of values"));
    }
    let lines = made.stated.lines.filter(|_| axis.kind == AxisKind::Frequency && !has_axis);
    let declared = lines.map(|lines| lines as usize + 1).filter(|all| n != *all && n + 1 != *all);
    if let Some(declared) = declared {
        of_axis.push(Finding::caution("fewer-lines").count("declared", declared).count("n", n));
    }
    if let Some(declared) =
        made.stated.values.filter(|declared| *declared != n && axis.kind != AxisKind::Frequency)
    {
        of_axis.push(assemble::fewer(declared, n));
    }
    if table.len() == 2 && !has_axis && dialect.names.is_none() && !options.complex {
        of_axis.push(Finding::caution("two-channels"));
    }
    let mut built = Vec::new();
    let table = made.joined(table, &axis, &mut of_axis)?;
    of_axis.extend(cautions::of(&table, &axis, &made.stated, is_table));
    for (i, column) in table.into_iter().enumerate() {
        let sparse = column.sparse;
        let mut column = match sparse {
            Some((first, every)) => made.record(i, column, &axis.every(first, every))?,
            None => made.record(i, column, &axis)?,
        };
        let record = &mut column.record;
        if let Some((_, every)) = sparse {
            record.meta_mut().found(Finding::note("column-sparse").count("every", every));
        }
        let meta = record.meta_mut();
        meta.declared_n = declared;
        if axis.kind == AxisKind::Time {
            (meta.clock, meta.resolution, meta.origin) = (clock, resolution, origin);
        }
        if !is_table {
            for found in &of_axis {
                record.meta_mut().found(found.clone());
            }
        }
        built.push(column);
    }
    if is_table {
        // Findings that hold for all columns of a table are reported once, for the file.
        findings.append(&mut of_axis);
    }
    Ok(built)
}

/// Numbers of spectral lines that analysers offer, not counting 0 Hz.
const LINES: [usize; 10] = [100, 200, 400, 800, 1600, 3200, 6400, 12800, 25600, 51200];

/// Refuses rows of several channels or sensors below each other, which a column numbers. Where all columns
/// go in turns, they are values.
fn of_one_channel(table: &[Column]) -> Result<()> {
    let turns: Vec<Option<[f64; 2]>> = table.iter().map(Column::numbers_channels).collect();
    let first = turns.iter().position(Option::is_some).filter(|_| turns.contains(&None));
    let Some((at, [one, next])) = first.and_then(|at| Some((at, turns[at]?))) else { return Ok(()) };
    let name = table[at].label();
    let found = format!("{name:?} goes from {} to {} and back", short(one), short(next));
    Err(Error::usage(found, "rows of one channel or sensor")
        .hint("keep the rows of one number in a file, those of the others each in a file of their own"))
}

/// Refuses rows without times where a counter shows that samples are missing: no sampling rate holds for
/// them.
fn without_gaps(table: &[Column]) -> Result<()> {
    let gap = table.iter().find_map(|column| Some((column.label(), column.leaves_out()?)));
    let Some((name, [last, next])) = gap else { return Ok(()) };
    let (lost, last, next) = (short(next - last - 1.0), short(last), short(next));
    let found = format!("{name:?} goes from {last} to {next}: samples are missing, {lost} there");
    Err(Error::usage(found, "all samples, for there are no times beside them")
        .hint(format!("cut the file between {last} and {next}, and read each part by itself")))
}

/// The record of a column, and how to read its values again.
pub struct Built {
    pub record: Record,
    /// Extremes and first values of a column whose values were not kept in memory.
    pub ends: Option<Extremes>,
    /// Place of the column in a row, counted from 0.
    pub at: usize,
    /// Factor from the values as written to SI units.
    pub factor: f64,
}

/// What the records of one file have in common.
struct RecordContext<'a> {
    text: &'a Text<'a>,
    tail: &'a [u8],
    dialect: &'a Dialect,
    is_table: bool,
    options: &'a Options,
    stated: Stated,
    /// Whether a counter has the unit N, for natural numbers: N of another column may then not be newton.
    naturals: bool,
}

impl RecordContext<'_> {
    /// Whether the first column of a file without names only numbers its rows: the axis is the next column or
    /// in the header.
    fn numbered(&self, table: &[Column]) -> bool {
        let beside = || table.len() > 2 && table[1].rises();
        let headed = self.stated.rate.is_some() || self.stated.line_width.is_some();
        let counts = table.len() > 1 && table[0].values.len() > 2 && table[0].name.name.is_empty();
        !self.is_table && counts && table[0].counts() && (headed || beside())
    }

    /// Whether `n` values without an axis are the lines of a spectrum: an analyser's number of them, and all
    /// of one sign or levels in dB.
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

    /// Takes out the columns that only count, unless there are no others; gives the first value of the first.
    /// Of the first column everyone expects it, any other is named.
    fn without_counters(&mut self, table: &mut Vec<Column>, findings: &mut Vec<Finding>) -> Option<f64> {
        let counter =
            |(at, column): (usize, &Column)| column.counts() && (at == 0 || !column.name.name.is_empty());
        let counters: Vec<bool> = table.iter().enumerate().map(counter).collect();
        let natural = |column: &Column| column.name.unit.as_deref() == Some(NATURAL);
        self.naturals = table.iter().zip(&counters).any(|(column, counts)| *counts && natural(column));
        let at = counters.iter().position(|counts| *counts).filter(|_| counters.contains(&false))?;
        let first = table[at].reals().first().copied();
        let (left_out, kept): (Vec<_>, Vec<_>) =
            table.drain(..).zip(counters).partition(|(_, counts)| *counts);
        table.extend(kept.into_iter().map(|(column, _)| column));
        let named = left_out.iter().filter(|(column, _)| column.at > 1).map(|(column, _)| column.label());
        let named: Vec<String> = named.collect();
        if !named.is_empty() {
            findings.push(Finding::note("columns-count").name("columns", named.join(", ")));
        }
        first
    }

    /// Place of the abscissa in `table`. A clear name is enough. Any other column must rise, since one with a
    /// unit of time may hold intervals.
    fn abscissa(&self, table: &[Column]) -> Option<usize> {
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
            // Columns without any value were removed, so that places differ from those in the row.
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

    /// The axis from its `column`, in s or Hz where its kind is known, with its findings.
    fn printed(&self, column: Column, others: &[Column]) -> Result<PrintedAbscissa> {
        let at = format!("column {}", column.at);
        let (name, label) = match column.name.name.as_str() {
            "" if column.at == 1 => ("first column", "first column".to_owned()),
            "" => (at.as_str(), at.clone()),
            name => (name, format!("column {name:?}")),
        };
        let clock = self.dialect.clock_at() == Some(column.at - 1);
        let by_name = if clock { Some(AxisKind::Time) } else { column.name.axis(column.at == 1) };
        let values = column.reals();
        let (kind, factor, assumed) = match (&by_name, self.domain(values.len())) {
            (Some(kind), _) => {
                let (factor, assumed) = column.name.to_axis(kind)?;
                (kind.clone(), factor, assumed)
            }
            (None, Some(kind)) => {
                let (unit, factor) = self.unit_by_rate(&values).unwrap_or((domain(&kind).1, 1.0));
                (kind, factor, Some(Finding::caution(code::AXIS_UNIT_ASSUMED).name("unit", unit)))
            }
            (None, None) => {
                (AxisKind::Other(name.to_owned()), 1.0, Some(Finding::caution("axis-kind-unsaid")))
            }
        };
        let epoch = values.first().filter(|_| !clock && kind == AxisKind::Time);
        let unsaid = column.name.unit.is_none();
        let epoch = epoch.and_then(|first| assemble::epoch(*first)).filter(|(_, f)| unsaid || *f == factor);
        let since = epoch.map_or(0.0, |(_, factor)| values[0] * factor);
        let (from, factor) = epoch.map_or((0.0, factor), |(_, factor)| (values[0], factor));
        let serial = unsaid && !clock && kind == AxisKind::Time && assemble::is_serial(&values);
        let (from, factor) = if serial { (values[0], assemble::DAY) } else { (from, factor) };
        let assumed = match epoch {
            _ if serial => Some(Finding::caution("axis-serial-days")),
            Some((unit, _)) if unsaid => Some(Finding::caution("axis-epoch").name("unit", unit)),
            None if clock && self.minutes() => Some(Finding::caution("axis-clock-minutes")),
            _ if clock || epoch.is_some() => Some(Finding::note("axis-clock")),
            _ => assumed,
        };
        // Some instruments print times of single precision with more digits than it has. Steps that are all
        // finer than its last digit show double precision.
        let largest = values.iter().fold(0.0, |max: f64, x| max.max(x.abs()));
        let single = largest * f64::from(f32::EPSILON) / 2.0;
        let finer = values.windows(2).all(|w| (w[1] - w[0]).abs() < single);
        let own = tail::resolution(self.text, self.tail, self.dialect, column.at - 1);
        let own = own.max(if finer { largest * f64::EPSILON } else { single });
        self.one_clock(&kind, &column, (factor, own), others)?;
        // Converted in place: memory may hold one column of times of a long record, not two.
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
        let findings = column.name.unit_differs().into_iter().chain(assumed).chain(found).collect();
        let resolution = own * factor;
        Ok(PrintedAbscissa {
            axis,
            label,
            resolution,
            assumed: by_name.is_none() && !self.over_hertz(),
            origin: since,
            clock,
            findings,
        })
    }

    /// Unit of an unnamed time column (s, ms or µs) and its factor to s with which the mean step agrees with
    /// the stated rate.
    fn unit_by_rate(&self, values: &[f64]) -> Option<(&'static str, f64)> {
        let step = (values.last()? - values[0]) / values.len().saturating_sub(1).max(1) as f64;
        // Steps of 1 from 0 or 1 number the values: no unit.
        if step == 1.0 && matches!(values[0], 0.0 | 1.0) {
            return None;
        }
        let agrees = |(_, factor): &(&str, f64)| {
            self.options.rate.is_some_and(|rate| (step * factor * rate - 1.0).abs() <= NOMINAL)
        };
        [("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)].into_iter().find(agrees)
    }

    /// Refuses a second column of the same kind as the abscissa with another span: which values belong to
    /// which is unknown.
    fn one_clock(
        &self,
        kind: &AxisKind,
        axis: &Column,
        (factor, resolution): (f64, f64),
        others: &[Column],
    ) -> Result<()> {
        let own = |column: &Column| tail::resolution(self.text, self.tail, self.dialect, column.at - 1);
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
                && (b - a).abs() > 4.0 * (resolution * factor).max(own(other) * theirs) + 1e-6 * a.abs()
            {
                let (one, two) = (axis.label(), other.label());
                let found = format!("{one:?} and {two:?} run over {} and {}", short(a), short(b));
                let hint = "take out the one that is wrong, or write each of them with its channels to a file of its own";
                return Err(Error::usage(found, "one clock for all columns").hint(hint));
            }
        }
        Ok(())
    }

    /// Whether a clock has two numbers and no date: hours and minutes, or minutes and seconds.
    fn minutes(&self) -> bool {
        let first = self.dialect.rows(&self.text.head).next().and_then(|line| self.dialect.cut(&line).ok());
        let cell = self.dialect.clock_at().and_then(|at| first.as_ref()?.get(at));
        let colons =
            |(_, cell): &(usize, Cow<str>)| cell.split(|c: char| c.is_ascii_digit()).collect::<String>();
        cell.map(colons).as_deref() == Some(":")
    }

    /// Whether the header states that the abscissa is a frequency and gives no step of one series.
    fn over_hertz(&self) -> bool {
        self.stated.lines_apart && !self.stated.of_one_series
    }

    /// Domain of `n` values, time or frequency, from the options or the header; `None` where neither tells.
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

    /// Joins real and imaginary parts of one quantity, and over frequency a response function's magnitude
    /// with the phase column behind it. Columns over time are not joined.
    fn joined(&self, table: Vec<Column>, axis: &Axis, found: &mut Vec<Finding>) -> Result<Vec<Column>> {
        let parts = !self.dialect.complex && axis.kind != AxisKind::Time;
        let unnamed = self.dialect.names.is_none() && axis.kind == AxisKind::Frequency;
        let (n, stated) =
            (table.len(), self.options.complex || self.stated.complex && unnamed && table.len() == 2);
        let mut out: Vec<Column> = Vec::new();
        for column in table {
            if let Some(magnitude) = out.last_mut().filter(|_| parts && axis.kind == AxisKind::Frequency)
                && magnitude.take_phase(&column)
            {
                let name = format!("{}, {}", magnitude.label(), column.label());
                found.push(Finding::note("magnitude-and-phase").name("columns", name));
                continue;
            }
            let partner = match column.name.part() {
                _ if !parts => None,
                Some((ComplexPart::Imaginary, whole)) => {
                    out.iter_mut().find(|real| real.name.part() == Some((ComplexPart::Real, whole.clone())))
                }
                None if stated && n == 2 => out.first_mut(),
                _ => None,
            };
            let Some(real) = partner else {
                out.push(column);
                continue;
            };
            // A unit in the header of one part holds for both.
            if real.name.unit.is_some() && column.name.unit.is_some() && real.name.unit != column.name.unit {
                let found = format!("{:?} and {:?} have different units", real.label(), column.label());
                return Err(Error::usage(found, "one unit for real and imaginary part"));
            }
            let (re, im) = (real.reals(), column.reals());
            let both = re.iter().zip(im.iter()).map(|(re, im)| Complex64::new(*re, *im)).collect();
            real.values = Values::Complex(both).into();
            real.name.unit = real.name.unit.take().or(column.name.unit);
            if let Some((_, whole)) = real.name.part() {
                real.name.name = whole;
            }
        }
        if stated && out.iter().all(|column| !column.values.is_complex()) {
            let over = if axis.kind == AxisKind::Time { " over time" } else { " of values" };
            let found = counted(out.len(), "column") + over + ", where complex values were stated";
            return Err(Error::usage(found, "two columns over frequency, real and imaginary part")
                .hint("leave out that values are complex, or state the base band")
                .setting("complex")
                .setting("base_band"));
        }
        Ok(out)
    }

    /// The record of one column.
    fn record(&self, i: usize, column: Column, axis: &Axis) -> Result<Built> {
        let unknown = column.name.unknown_unit().map(str::to_owned);
        let head_differs = self.head_differs(&column.name).filter(|_| self.options.unit.is_none());
        let whole = || column.reals().iter().all(|v| v.fract() == 0.0);
        let against = column.name.against_unit(self.naturals, whole).filter(|_| self.options.unit.is_none());
        let differs = column.name.unit_differs().filter(|_| self.options.unit.is_none());
        let Column { at, name: Name { name, unit }, mut values, .. } = column;
        let title = self.stated.name.as_deref().unwrap_or_default();
        let name = match (self.dialect.columns, self.is_table) {
            (1, false) if !title.is_empty() => title.to_owned(),
            (1, false) => name,
            _ if !name.is_empty() => name,
            (2, true) if !title.is_empty() => title.to_owned(),
            (_, true) => format!("column {at}"),
            _ if title.is_empty() => format!("column {}", i + 1),
            _ if i == 0 => title.to_owned(),
            _ => format!("{title} {}", i + 1),
        };
        let mut meta = Meta::new(name, Unit::opaque(""));
        meta.notes.clone_from(&self.stated.notes);
        let (file, format) = (self.text.source.name(), self.dialect.format.name());
        let mut how: Vec<(&str, &dyn std::fmt::Display)> = vec![("file", &file), ("format", &format)];
        if self.dialect.columns > 1 {
            how.push(("column", &at));
        }
        if let Some(name) = &self.text.encoding {
            how.push(("encoding", name));
        }
        if self.dialect.decimal == b',' {
            how.push(("decimal mark", &"comma"));
        }
        meta.step("read", &how);
        let unit = unit.as_deref().or(self.stated.unit.as_deref()).map(amplitude);
        let level = || level::decibels(&meta).filter(|_| self.options.unit.is_none()).map(|_| "dB");
        let said = unit.map(|(unit, _)| unit).or(unknown.as_deref()).or_else(level);
        let factor = if let Some(word) = against {
            let found = Finding::caution("unit-against-name").name("unit", said.unwrap_or_default());
            meta.found(found.name("word", word));
            1.0
        } else {
            self.options.adopt(&mut meta, said)
        };
        meta.findings.extend(differs.or(head_differs));
        values.scale(factor)?;
        let spectral = self.spectral(&meta.name, unit);
        let (record, ends) = values.record(meta, axis.clone(), spectral)?;
        Ok(Built { record, ends, at: at - 1, factor })
    }

    /// Says that the head holds another unit of the same quantity than the name: `Unit: mm/s` over `v (m/s)`.
    fn head_differs(&self, name: &Name) -> Option<Finding> {
        let (head, used) = (self.stated.unit.as_deref()?, name.unit.as_deref()?);
        let (of_head, of_name) = (Unit::parse(head)?, Unit::parse(used)?);
        let same = of_head.dimension() == of_name.dimension() && of_head.factor() != of_name.factor();
        same.then(|| Finding::caution("unit-head-differs").name("head", head).name("used", used))
    }

    /// What remarks and the unit of a column say of its spectrum.
    fn spectral(&self, name: &str, unit: Option<(&str, Option<Scaling>)>) -> Spectral {
        let (unit, scaling) = unit.unwrap_or_default();
        let by_unit = if is_density(unit) { Some(Scaling::Psd) } else { scaling };
        let own = self.remark_about("window", name).and_then(|window| Window::from_name(&window));
        Spectral {
            scaling: self.remark_about("scaling", name).and_then(|s| Scaling::from_name(&s)).or(by_unit),
            // A file with remarks on single columns has no window for all.
            window: own
                .or(self.stated.window.filter(|_| !self.remarks("window").any(|v| v.contains(" of ")))),
            enbw: self.remark_about("enbw", name).and_then(|e| number::parse(e.as_bytes())),
            frf: self.remark_about("kind", name).is_some_and(|k| k == "frf"),
            doubt: None,
        }
    }

    fn remarks(&self, key: &str) -> impl Iterator<Item = &str> {
        self.stated.notes.iter().filter(move |(k, _)| k.eq_ignore_ascii_case(key)).map(|(_, v)| v.as_str())
    }

    /// Lower-case value of the remark on this column (`key: value of name`), else of one on all columns
    /// without `of`.
    fn remark_about(&self, key: &str, name: &str) -> Option<String> {
        let of = format!(" of {name}");
        let own = self.remarks(key).find_map(|v| v.strip_suffix(of.as_str()));
        let value = own.or_else(|| self.remarks(key).find(|v| !v.contains(" of ")))?;
        Some(value.trim().to_lowercase())
    }
}

/// `g²/Hz`, `(m/s^2)^2/Hz`: a square over hertz is a power spectral density.
fn is_density(unit: &str) -> bool {
    let power = unit.trim().strip_suffix("/Hz").map(str::trim_end);
    power.is_some_and(|p| p.ends_with('²') || p.ends_with("^2") || p.ends_with(")2"))
}
