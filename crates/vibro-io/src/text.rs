//! Reads text of analysers, loggers and spreadsheets: dialect → rows → records.
//!
//! A [`dialect`] is data that describes the names, the units, the abscissa and how a row is cut. It is
//! detected from the first bytes: [`table`] detects tables with names above their columns or after the keys
//! of a [`preamble`], [`numbers`] detects plain columns of numbers. Both recognise a [`clock`]. Another
//! instrument needs one more function beside these two. Clean rows are read in parallel ([`fast`]), all
//! others one by one ([`rows`]), so that an error names line and column. Columns become records in
//! [`records`].

mod abscissa;
mod axis;
mod cautions;
mod clock;
mod column;
pub(crate) mod decoded;
mod dialect;
pub(crate) mod encoding;
mod fast;
mod head_number;
mod header;
mod headings;
mod lines;
mod name_line;
pub(crate) mod names;
mod near_number;
mod numbers;
mod preamble;
mod records;
mod row_names;
mod rows;
mod runs;
mod stated_scale;
mod stream;
mod table;
mod tables;
mod tail;
mod two_parts;
pub(crate) mod unit_words;
mod word_columns;
mod wrapped;

use crate::format::Format;
use crate::held::{Contents, Held};
use crate::limit::Limit;
use crate::options::Options;
use crate::source::Source;
use crate::{level, magnitude, missing, number};
pub(crate) use abscissa::axis_unit;
use decoded::{Text, with_text};
use dialect::Dialect;
use fast::RowShape;
use header::Stated;
use names::Name;
use records::RecordContext;
use rows::Rows;
pub(crate) use tables::{LONGER, rows as count_rows};
pub(crate) use tail::Digits;
use vibro_record::{AxisKind, Error, Finding, Record, Result, Trace, Values, code};
use word_columns::LeftOut;

/// Whether a text begins with a table that has names above its columns.
pub(crate) fn is_table(head: &[u8], source: &Source) -> bool {
    // Names have a letter that no number contains. Most files of numbers have no such letter and are not
    // examined further.
    let letter = |b: &u8| !b.is_ascii() || b.is_ascii_alphabetic() && !b"eEdDqQijIJ".contains(b);
    let words = head[..head.len().min(encoding::LOOK)].iter().any(letter);
    let found = || with_text(source, Limit::default(), |text| Ok(table::detect(text, &Options::default())));
    words && encoding::is_text(head) && found().is_ok_and(|found| found.is_some())
}

pub(crate) fn read_table(source: &Source, options: &Options, survey: bool) -> Result<Contents> {
    let without_names = || {
        Error::usage(
            "no row of numbers with names of columns right above it",
            "e.g. `time [s],velocity [mm/s]`, then rows of numbers",
        )
        .hint("read numbers without names as the format ascii")
        .setting("format")
    };
    with_text(source, options.limit, |text| {
        if let Some(plain) = row_names::without(text)? {
            return read_table(&plain, options, survey);
        }
        match table::detect(text, options) {
            Some(dialect) if !runs::others_of(&dialect).is_empty() => {
                read_runs(text, &dialect, options, survey)
            }
            Some(dialect) if let Some(joined) = two_parts::joined(text, &dialect)? => {
                read_table(&joined, options, survey)
            }
            Some(dialect) => read(text, &dialect, options, survey)
                .or_else(|why| one_table(text, options, why))
                .or_else(|why| without_words(text, options, why)),
            None => without_words(text, options, without_names()),
        }
    })
}

/// Reads runs that are side by side in a text, one after the other.
fn read_runs(text: &Text, dialect: &Dialect, options: &Options, survey: bool) -> Result<Contents> {
    let mut all = Contents::default();
    for others in runs::others_of(dialect) {
        let run = read_table(&runs::alone(text, dialect, &others)?, options, survey)?;
        all.records.extend(run.records);
        // Equal findings of several runs are reported once.
        all.findings.extend(
            run.findings.into_iter().filter(|found| !all.findings.contains(found)).collect::<Vec<_>>(),
        );
    }
    Ok(all)
}

pub(crate) fn read_numbers(source: &Source, options: &Options, survey: bool) -> Result<Contents> {
    with_text(source, options.limit, |text| {
        if let Some(plain) = row_names::without(text)? {
            return read_table(&plain, options, survey);
        }
        match numbers::detect(text, options) {
            Ok(dialect) => read(text, &dialect, options, survey).or_else(|why| one_table(text, options, why)),
            Err(why) => without_words(text, options, why),
        }
    })
}

/// Reads a text without its columns of words; returns the earlier error `why` if it has no such columns.
fn without_words(text: &Text, options: &Options, why: Error) -> Result<Contents> {
    let Some(LeftOut { source, found, changes }) = word_columns::left_out(text)? else { return Err(why) };
    let contents = without((source, found), options)?;
    let of_records = contents.records.iter().flat_map(|(record, _)| &record.meta().findings);
    let findings: Vec<&Finding> = contents.findings.iter().chain(of_records).collect();
    let is_said = |code: &str| findings.iter().any(|found| found.code == code);
    let timed = contents.records.iter().all(|(record, _)| record.axis().kind == AxisKind::Time);
    let rises = timed && !is_said(code::AXIS_BACKWARDS);
    // Rows of several channels below each other may still rise in time if the times follow from a rate.
    // Only printed times that rise exclude several channels.
    let by_rate = options.rate.is_some() || is_said(code::RATE_FROM_HEAD);
    if changes && (!rises || by_rate) { Err(why) } else { Ok(contents) }
}

/// Reads the longer of two tables; returns the earlier error `why` if neither is much longer.
fn one_table(text: &Text, options: &Options, why: Error) -> Result<Contents> {
    let Some(line) = why.line().filter(|_| why.advice() == rows::TABLES) else { return Err(why) };
    let Some(left) = tables::longest(text, line)? else { return Err(why) };
    let (source, found) = left;
    without((source, vec![found]), options).map_err(|_| why)
}

/// Reads the rest of a text of which parts were left out, and adds the findings on these parts.
fn without((source, found): (Source, Vec<Finding>), options: &Options) -> Result<Contents> {
    let read = if is_table(source.head(), &source) { read_table } else { read_numbers };
    let mut contents = read(&source, options, false)?;
    contents.findings.extend(found);
    Ok(contents)
}

/// Memory to test whether a rising column is an even axis, in addition to the column itself, as a multiple
/// of its size.
const ABSCISSA: f64 = 1.5;

/// Columns of a text as records, and findings on the text.
struct Read {
    columns: Vec<records::Built>,
    findings: Vec<Finding>,
    /// Shape of the rows and the byte offset after the last one, if all rows are clean.
    clean: Option<(RowShape, u64)>,
}

fn read(text: &Text, dialect: &Dialect, options: &Options, survey: bool) -> Result<Contents> {
    let Read { columns, findings, .. } = read_rows(text, dialect, options, survey)?;
    let records = columns.into_iter().map(|column| (column.record, column.ends)).collect();
    Ok(Contents { records, findings })
}

/// A text whose values are read block by block.
pub(crate) struct Streamed {
    /// The traces without their values.
    pub traces: Vec<Trace>,
    /// Findings on the text as a whole.
    pub findings: Vec<Finding>,
    /// Reader of the values.
    pub columns: stream::Columns,
}

/// The traces of a text without their values, which are read again block by block, and the findings. `None`
/// for a text that must be held in memory: it is in memory already, has rows that are not clean, or has
/// records that are not traces.
///
/// # Errors
/// As reading the text.
pub(crate) fn stream(source: &Source, options: &Options, format: Format) -> Result<Option<Streamed>> {
    with_text(source, options.limit, |text| {
        let dialect = match format {
            Format::Csv => table::detect(text, options),
            Format::Ascii => numbers::detect(text, options).ok(),
            _ => None,
        };
        let of_one_run = |d: &Dialect| runs::others_of(d).is_empty();
        let Some(dialect) = dialect.filter(|d| format == Format::Ascii || of_one_run(d)) else {
            return Ok(None);
        };
        let Read { columns, findings, clean } = read_rows(text, &dialect, options, true)?;
        let Some((shape, end)) = clean.filter(|_| text.source.in_memory().is_none()) else { return Ok(None) };
        let handed = columns.iter().map(|column| (column.at, column.factor)).collect();
        let records = columns.into_iter().map(|column| (column.record, column.ends)).collect();
        let mut contents = Contents { records, findings };
        magnitude::mark(&mut contents);
        let Contents { records, findings } = level::levels_to_amplitudes(contents, format, options)?;
        let trace = |(record, _)| if let Record::Trace(trace) = record { Some(trace) } else { None };
        let traces: Option<Vec<Trace>> = records.into_iter().map(trace).collect();
        let Some(traces) = traces else { return Ok(None) };
        let columns = stream::Columns::open(source, shape, end, handed)?;
        Ok(Some(Streamed { traces, findings, columns }))
    })
}

fn read_rows(text: &Text, dialect: &Dialect, options: &Options, survey: bool) -> Result<Read> {
    let stated = Stated::of(dialect.header.iter().map(String::as_str), dialect.shown_mark(&text.head));
    let kept = kept(dialect, options, &stated, survey);
    // Number of rows, estimated from the length of the first lines.
    let lines = text.head.lines().count() as f64 / text.head.len().max(1) as f64;
    let bytes = text.source.len() as f64;
    // The number of rows is bounded, since a value and its separator take at least two bytes.
    let rows = (bytes * lines).min(bytes / (2.0 * dialect.columns as f64));
    let held = kept.iter().filter(|kept| **kept).count() as f64;
    options.hold(rows * (held + if dialect.columns > 1 { ABSCISSA } else { 0.0 }))?;
    let tail = tail::of(text.source)?;
    let plain = dialect.columns > 1 && dialect.names.is_none() && !dialect.complex;
    let declared = stated.values;
    if plain && (options.wrapped == Some(true) || options.wrapped.is_none() && declared.is_some()) {
        let values = wrapped::flat(text, dialect)?;
        if let Some(values) = values.filter(|v| options.wrapped.is_some() || declared == Some(v.len())) {
            let rows = Rows { columns: vec![Values::Real(values).into()], ..Rows::default() };
            let dialect = Dialect { columns: 1, ..dialect.clone() };
            return records_of(RecordContext::new(text, &tail, &dialect, options, stated), rows);
        }
    }
    let shape = RowShape::of(dialect, text.source.head());
    let end = text.source.len() - (tail.len() - tail.trim_ascii_end().len()) as u64;
    let one_step = plain && options.wrapped.is_none() && dialect.clock.is_none() && stated.of_one_series;
    let clean = shape.map(|shape| fast::read(text.source, &shape, end, &kept)).transpose()?.flatten();
    let (rows, clean) = match clean {
        Some(columns) => (Rows { columns, ..Rows::default() }, shape.map(|shape| (shape, end))),
        None => (
            carefully(text, dialect, options).map_err(|why| {
                // In a series printed over several columns, the last line is often shorter.
                let short = plain && options.wrapped.is_none() && wrapped::ends_short(text, dialect);
                if one_step && dialect.columns > 2 || short {
                    wrapped::question(dialect.columns)
                } else {
                    why
                }
            })?,
            None,
        ),
    };
    let n = rows.columns.first().map_or(0, Held::len);
    let series = || one_step && declared != Some(n) || declared.is_some_and(|declared| declared > n);
    if plain
        && options.wrapped.is_none()
        && (wrapped::continues(&rows.columns) || series() && wrapped::no_abscissa(&rows.columns))
    {
        return Err(wrapped::question(dialect.columns));
    }
    let read = records_of(RecordContext::new(text, &tail, dialect, options, stated), rows)?;
    Ok(Read { clean, ..read })
}

/// Which columns are held in memory: all of them, or, for a `survey`, which needs only extremes, those that
/// may be an abscissa or a counter.
fn kept(dialect: &Dialect, options: &Options, stated: &Stated, survey: bool) -> Vec<bool> {
    let names = dialect.names.iter().flatten();
    let complex = options.complex
        || stated.complex
        || names.clone().any(|name| name.part().is_some() || name.phase().is_some());
    // Columns without names may continue each other; only the values show that.
    let plain = dialect.names.is_none() && dialect.columns > 2;
    let all = !survey || complex || plain;
    // Only the values show whether a column is a counter or repeats the times.
    let told = |name: &Name| name.may_count() || name.seconds().is_some();
    let told = |i: usize| dialect.names.as_ref().is_some_and(|names| told(&names[i]));
    let abscissa = |i: usize| dialect.named_abscissa() == Some(i) || told(i) || i == 0 && dialect.columns > 1;
    (0..dialect.columns).map(|i| all || abscissa(i)).collect()
}

fn records_of(context: RecordContext, rows: Rows) -> Result<Read> {
    let RecordContext { text, tail, dialect, .. } = context;
    let mut findings: Vec<Finding> =
        tail::cut_off(tail, dialect.separator, dialect.decimal).into_iter().collect();
    findings.extend(missing::kept(rows.missing));
    let counted = |code, n: usize| (n > 0).then(|| Finding::caution(code).count("n", n));
    findings.extend(counted("rows-empty", rows.empty));
    findings.extend(counted("blank-lines-between-blocks", rows.separators));
    findings.extend(counted("rows-in-head", rows_in(&dialect.header)));
    if dialect.decimal == b',' && dialect.columns == 1 && dialect.format == Format::Csv {
        findings.push(Finding::caution("decimal-comma-assumed"));
    }
    findings.extend(table::grouped(text, dialect)?);
    let columns = context.records(rows, &mut findings)?;
    Ok(Read { columns, findings, clean: None })
}

/// Number of header lines that are rows of another table: numbers only, as many as in a neighbouring line.
fn rows_in(head: &[String]) -> usize {
    let numbers = |line: &String| {
        let cells = line.split([',', ';', '\t', ' ']).filter(|cell| !cell.is_empty());
        let all = cells.clone().all(|cell| number::either(cell.as_bytes()).is_some());
        cells.count() * usize::from(all)
    };
    let widths: Vec<usize> = head.iter().map(numbers).collect();
    widths.chunk_by(|a, b| a == b).filter(|rows| rows[0] > 1 && rows.len() > 1).map(<[usize]>::len).sum()
}

/// Reads row by row, so that an error names line and column.
fn carefully(text: &Text, dialect: &Dialect, options: &Options) -> Result<Rows> {
    let bytes = text.source.all()?;
    let bytes =
        if encoding::lone_cr(&bytes, false) { encoding::with_lf(bytes.into_owned()).into() } else { bytes };
    let whole = encoding::decode(&bytes);
    rows::read(whole.trim_end_matches('\u{1a}'), dialect, options.allow_missing)
}

#[cfg(test)]
mod tests;
