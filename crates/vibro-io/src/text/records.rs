//! Makes records from columns: applies units and joins real and imaginary parts.

use super::abscissa::CommonAxis;
use super::cautions;
use super::column::Column;
use super::decoded::Text;
use super::dialect::Dialect;
use super::header::Stated;
use super::names::{ComplexPart, NATURAL, Name};
use super::rows::Rows;
use super::unit_words::amplitude;
use crate::assemble::{self, Spectral, short};
use crate::format::Format;
use crate::held::Held;
use crate::options::Options;
use crate::{level, number};
use num_complex::Complex64;
use vibro_record::lanes::Extremes;
use vibro_record::units::Unit;
use vibro_record::units::notation::counted;
use vibro_record::{Axis, AxisKind, Error, Finding, Grid, Meta, Record, Result, Scaling, Values, Window};

/// The record of a column, and how to read its values again.
pub struct Built {
    pub record: Record,
    /// Extremes and first values of a column whose values were not kept in memory.
    pub ends: Option<Extremes>,
    /// Index of the column in a row, from 0.
    pub at: usize,
    /// Factor from the values as written to SI units.
    pub factor: f64,
}

/// Data shared by the records of one file.
pub struct RecordContext<'a> {
    pub text: &'a Text<'a>,
    pub tail: &'a [u8],
    pub dialect: &'a Dialect,
    pub is_table: bool,
    pub options: &'a Options,
    pub stated: Stated,
    /// Whether a counter has the unit N, for natural numbers. The unit N of another column then need not be
    /// newton.
    naturals: bool,
}

impl<'a> RecordContext<'a> {
    /// For a text with the last bytes `tail`, whose header states `stated`.
    pub fn new(
        text: &'a Text<'a>,
        tail: &'a [u8],
        dialect: &'a Dialect,
        options: &'a Options,
        stated: Stated,
    ) -> RecordContext<'a> {
        let is_table = dialect.format == Format::Csv;
        RecordContext { text, tail, dialect, is_table, options, stated, naturals: false }
    }

    /// One record for each column of values. Findings on the file as a whole are added to `findings`.
    ///
    /// # Errors
    /// If the columns contradict each other or the options.
    pub fn records(mut self, rows: Rows, findings: &mut Vec<Finding>) -> Result<Vec<Built>> {
        let n = rows.columns.iter().map(Held::len).max().unwrap_or(0);
        if !rows.remarks.is_empty() {
            let said = self.dialect.header.iter().chain(&rows.remarks).map(String::as_str);
            self.stated = Stated::of(said, self.stated.mark);
        }
        let mut table = self.with_values(rows, findings);
        let numbered = self.numbered(&table);
        if numbered {
            table.remove(0);
        }
        let printed = self.abscissa(&table).map(|at| table.remove(at));
        // Counters are left out, unless the table has no other columns.
        let first = if self.is_table { self.without_counters(&mut table, findings) } else { None };
        if let Some(axis) = &printed {
            self.without_copies(axis, &mut table);
        }
        let printed = printed.map(|column| self.printed(column, &table)).transpose()?;
        table.retain(|column| Some(column.at - 1) != self.dialect.clock_at());
        of_one_channel(&table)?;
        let has_axis = printed.is_some();
        if !has_axis {
            without_gaps(&table)?;
            if self.options.axis_unit.is_some() {
                return Err(Error::usage("no column of times or frequencies", "one whose unit is stated")
                    .hint("leave it out")
                    .setting("axis_unit"));
            }
        }
        let mut of_axis = Vec::new();
        if numbered && !has_axis {
            of_axis.push(Finding::caution("column-numbers-rows"));
        }
        let mut over = self.common_axis(printed, &table, n, &mut of_axis)?;
        if let (AxisKind::Index, Some(first), Grid::Even { start, .. }) =
            (&over.axis.kind, first, &mut over.axis.grid)
        {
            *start = first;
        }
        if table.is_empty() {
            return Err(Error::usage("only an abscissa", "at least one column of values"));
        }
        of_axis.extend(self.fewer_than_stated(&over, n));
        if table.len() == 2 && !has_axis && self.dialect.names.is_none() && !self.options.complex {
            of_axis.push(Finding::caution("two-channels"));
        }
        let mut table = self.joined(table, &over.axis, &mut of_axis)?;
        of_axis.extend(cautions::of(&table, &over.axis, &self.stated, self.is_table));
        let marks = table.iter_mut().filter_map(|column| column.take_marks(self.options.allow_missing));
        of_axis.extend(marks.collect::<Vec<_>>());
        let record = |(i, column)| self.record(i, column, &over);
        let mut built = table.into_iter().enumerate().map(record).collect::<Result<Vec<_>>>()?;
        if self.is_table {
            // Findings that hold for all columns of a table are reported once, for the file.
            findings.append(&mut of_axis);
        }
        for column in &mut built {
            for found in &of_axis {
                column.record.meta_mut().found(found.clone());
            }
        }
        Ok(built)
    }

    /// Columns with values. A finding lists named columns without any value.
    fn with_values(&self, rows: Rows, findings: &mut Vec<Finding>) -> Vec<Column> {
        let names = self.dialect.names.clone().unwrap_or_else(|| vec![Name::default(); self.dialect.columns]);
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
        table
    }

    /// Removes the columns that only count, unless there are no others, and returns the first value of the
    /// first counter. A finding lists them, except a counter in the first column, where it is usual.
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

    /// Removes the columns that hold the same instants as the abscissa.
    fn without_copies(&self, axis: &Column, table: &mut Vec<Column>) {
        // If every channel has a time column of its own, copies of the abscissa are left out.
        let again = |c: &Column| c.name.axis(true) == axis.name.axis(true) && c.values == axis.values;
        let plain = self.dialect.names.is_none() && table.iter().any(|c| !again(c));
        table.retain(|column| !((self.is_table || plain) && again(column)));
        table.retain(|column| !(self.is_table && column.is_clock_of(axis)));
    }

    /// Finding if the header states more spectral lines than were read, or another number of values than
    /// `n`.
    fn fewer_than_stated(&self, over: &CommonAxis, n: usize) -> Option<Finding> {
        if let Some(declared) = over.declared {
            return Some(Finding::caution("fewer-lines").count("declared", declared).count("n", n));
        }
        let of_time = |declared: &usize| *declared != n && over.axis.kind != AxisKind::Frequency;
        self.stated.values.filter(of_time).map(|declared| assemble::fewer(declared, n))
    }

    /// Joins real and imaginary parts of one quantity. Over frequency, also joins the magnitude of a
    /// frequency response function with the phase column after it. Columns over time are not joined.
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
            // A unit in the header of one part applies to both.
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
    fn record(&self, i: usize, column: Column, over: &CommonAxis) -> Result<Built> {
        let unknown = column.name.unknown_unit().map(str::to_owned);
        let head_differs = self.head_differs(&column.name).filter(|_| self.options.unit.is_none());
        let whole = || column.reals().iter().all(|v| v.fract() == 0.0);
        let against = column.name.against_unit(self.naturals, whole).filter(|_| self.options.unit.is_none());
        let differs = column.name.unit_differs(false).or_else(|| column.name.motion_differs());
        let differs = differs.filter(|_| self.options.unit.is_none());
        let Column { at, name: Name { name, unit }, mut values, sparse } = column;
        let mut meta = self.meta(i, at, name);
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
        let axis = match sparse {
            Some((first, every)) => over.axis.every(first, every),
            None => over.axis.clone(),
        };
        let (mut record, ends) = values.record(meta, axis, spectral)?;
        let meta = record.meta_mut();
        if let Some((_, every)) = sparse {
            meta.found(Finding::note("column-sparse").count("every", every));
        }
        over.state(meta);
        Ok(Built { record, ends, at: at - 1, factor })
    }

    /// Name, notes and history of the record of column `at` of the rows, which is the `i`th column with
    /// values.
    fn meta(&self, i: usize, at: usize, name: String) -> Meta {
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
        meta
    }

    /// Finding if the header states another unit of the same quantity than the column's name: `Unit: mm/s`
    /// above `v (m/s)`.
    fn head_differs(&self, name: &Name) -> Option<Finding> {
        let (head, used) = (self.stated.unit.as_deref()?, name.unit.as_deref()?);
        let (of_head, of_name) = (Unit::parse(head)?, Unit::parse(used)?);
        let same = of_head.dimension() == of_name.dimension() && of_head.factor() != of_name.factor();
        let found = Finding::doubt("unit-head-differs").name("head", head).name("used", used);
        same.then(|| found.without_estimate())
    }

    /// Scaling, window and other spectral properties that remarks and the unit of a column state.
    fn spectral(&self, name: &str, unit: Option<(&str, Option<Scaling>)>) -> Spectral {
        let (unit, scaling) = unit.unwrap_or_default();
        let by_unit = if is_density(unit) { Some(Scaling::Psd) } else { scaling };
        let own = self.remark_about("window", name).and_then(|window| Window::from_name(&window));
        Spectral {
            scaling: self.remark_about("scaling", name).and_then(|s| Scaling::from_name(&s)).or(by_unit),
            // In a file with remarks on single columns, no window applies to all columns.
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

    /// Lower-case value of the remark on this column (`key: value of name`), else of a remark on all
    /// columns, which has no `of`.
    fn remark_about(&self, key: &str, name: &str) -> Option<String> {
        let of = format!(" of {name}");
        let own = self.remarks(key).find_map(|v| v.strip_suffix(of.as_str()));
        let value = own.or_else(|| self.remarks(key).find(|v| !v.contains(" of ")))?;
        Some(value.trim().to_lowercase())
    }
}

/// `g²/Hz`, `(m/s^2)^2/Hz`: a squared unit per hertz is a power spectral density.
fn is_density(unit: &str) -> bool {
    let power = unit.trim().strip_suffix("/Hz").map(str::trim_end);
    power.is_some_and(|p| p.ends_with('²') || p.ends_with("^2") || p.ends_with(")2"))
}

/// Refuses rows of several channels or sensors below each other, which one column numbers. If all columns
/// repeat in a cycle, they are values.
fn of_one_channel(table: &[Column]) -> Result<()> {
    let turns: Vec<Option<[f64; 2]>> = table.iter().map(Column::numbers_channels).collect();
    let first = turns.iter().position(Option::is_some).filter(|_| turns.contains(&None));
    let Some((at, [one, next])) = first.and_then(|at| Some((at, turns[at]?))) else { return Ok(()) };
    let name = table[at].label();
    let found = format!("{name:?} goes from {} to {} and back", short(one), short(next));
    Err(Error::usage(found, "rows of one channel or sensor")
        .hint("keep the rows of one number in a file, those of the others each in a file of their own"))
}

/// Refuses rows without times if a counter shows that samples are missing: no sampling rate applies to
/// them.
fn without_gaps(table: &[Column]) -> Result<()> {
    let gap = table.iter().find_map(|column| Some((column.label(), column.leaves_out()?)));
    let Some((name, [last, next])) = gap else { return Ok(()) };
    let (lost, last, next) = (short(next - last - 1.0), short(last), short(next));
    let found = format!("{name:?} goes from {last} to {next}: samples are missing, {lost} there");
    Err(Error::usage(found, "all samples, for there are no times beside them")
        .hint(format!("cut the file between {last} and {next}, and read each part by itself")))
}
