//! Two thousand exports like those of loggers and telephones, drawn from seeds with known truth: none is
//! read wrongly without a caution.

use std::fmt::Write;
use vibro_io::{Reader, Recording};
use vibro_math::Noise;
use vibro_record::{Finding, Record, Severity, Trace};

const FILES: u64 = 2000;

/// One of several items, drawn with equal probability.
fn one<T: Copy>(noise: &mut Noise, all: &[T]) -> T {
    all[((noise.uniform() * all.len() as f64) as usize).min(all.len() - 1)]
}

fn chance(noise: &mut Noise, part: f64) -> bool {
    noise.uniform() < part
}

/// How instants are printed, or the rate stated.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stamp {
    /// Name of the column, unit as written, size of the unit in s, decimals.
    Column(&'static str, &'static str, f64, usize),
    /// `12:00:00.123`, perhaps after a date in a cell of its own.
    Clock { dated: bool, decimals: usize },
    /// Seconds or milliseconds since 1970.
    Epoch(f64),
    /// No column: a line of the header states the rate.
    Head(&'static str),
}

const COLUMNS: [Stamp; 10] = [
    Stamp::Column("Time", "s", 1.0, 3),
    Stamp::Column("time", "s", 1.0, 6),
    Stamp::Column("t", "s", 1.0, 4),
    Stamp::Column("Zeit", "s", 1.0, 4),
    Stamp::Column("Time", "ms", 1e-3, 0),
    Stamp::Column("Time", "ms", 1e-3, 3),
    Stamp::Column("Timestamp", "us", 1e-6, 0),
    Stamp::Column("Elapsed time", "s", 1.0, 9),
    Stamp::Column("Relative time", "s", 1.0, 2),
    Stamp::Column("Time", "", 1.0, 5),
];

const HEADS: [&str; 8] = [
    "Samples/Sec: {}",
    "Sample rate: {} Hz",
    "Sampling rate [Hz]: {}",
    "Abtastrate: {} Hz",
    "Sample Rate = {} S/s",
    "sampling_rate_hz: {}",
    "Sampling frequency: {} Hz",
    "fs = {} Hz",
];

/// Name, unit as written, factor to SI, and SI symbol; the last channel is a level.
const CHANNELS: [Channel; 10] = [
    ("Acceleration X", "m/s^2", 1.0, "m/s²"),
    ("ay", "g", 9.806_65, "m/s²"),
    ("Beschl. Z", "m/s²", 1.0, "m/s²"),
    ("Velocity", "mm/s", 1e-3, "m/s"),
    ("Force", "N", 1.0, "N"),
    ("Displacement", "µm", 1e-6, "m"),
    ("Mic", "Pa", 1.0, "Pa"),
    ("CH1", "V", 1.0, "V"),
    ("CH2", "mV", 1e-3, "V"),
    ("Level", "dB", 1.0, "dB"),
];

type Channel = (&'static str, &'static str, f64, &'static str);

/// Separator of cells, whether a comma is the decimal mark, and decimals of values.
struct Style {
    separator: &'static str,
    comma: bool,
    decimals: usize,
}

impl Style {
    fn number(&self, value: f64, decimals: usize) -> String {
        let text = format!("{value:.decimals$}");
        if self.comma { text.replace('.', ",") } else { text }
    }
}

/// The lines above the rows: statements, names and units.
fn head(
    noise: &mut Noise,
    stamp: Stamp,
    rate: f64,
    channels: &[Channel],
    style: &Style,
    (unit_row, quoted): (bool, bool),
) -> String {
    let mark = one(noise, &["", "", "# "]);
    let mut text = String::new();
    for line in ["Device: Logger 3000", "Serial number: 48151", "Date: 2024-03-01", "Operator: N. N."] {
        if chance(noise, 0.3) {
            writeln!(text, "{mark}{line}").unwrap();
        }
    }
    if let Stamp::Head(words) = stamp {
        writeln!(text, "{mark}{}", words.replace("{}", &style.number(rate, 2))).unwrap();
    }
    if chance(noise, 0.2) {
        text.push('\n');
    }
    let mut names: Vec<(&str, &str)> = match stamp {
        Stamp::Column(name, unit, ..) => vec![(name, unit)],
        Stamp::Clock { dated: true, .. } => vec![("Date", ""), ("Time", "")],
        Stamp::Clock { .. } => vec![("Time", "")],
        Stamp::Epoch(_) => vec![("timestamp", "")],
        Stamp::Head(_) => Vec::new(),
    };
    names.extend(channels.iter().map(|(name, unit, ..)| (*name, *unit)));
    let (quote, [open, close]) = (if quoted { "\"" } else { "" }, one(noise, &[["(", ")"], ["[", "]"]]));
    let cells = names.iter().map(|(name, unit)| match (unit_row, *unit) {
        (true, _) | (_, "") => format!("{quote}{name}{quote}"),
        _ => format!("{quote}{name} {open}{unit}{close}{quote}"),
    });
    writeln!(text, "{}", cells.collect::<Vec<_>>().join(style.separator)).unwrap();
    if unit_row {
        let units: Vec<&str> = names.iter().map(|(_, unit)| *unit).collect();
        writeln!(text, "{}", units.join(style.separator)).unwrap();
    }
    text
}

/// The cells of an instant in s, truncated or rounded to the printed digits.
fn stamped(stamp: Stamp, t: f64, floor: bool, style: &Style) -> Vec<String> {
    let rounded = |size: f64, decimals: usize| {
        let unit = 10f64.powi(decimals as i32);
        let ticks = t / size * unit;
        (if floor { ticks.floor() } else { ticks.round() }) / unit
    };
    match stamp {
        Stamp::Column(_, _, size, decimals) => vec![style.number(rounded(size, decimals), decimals)],
        Stamp::Clock { dated, decimals } => {
            let t = rounded(1.0, decimals) + 3590.0;
            let (minutes, width) = ((t / 60.0).floor(), decimals + 3);
            let (hours, seconds) = (12.0 + (minutes / 60.0).floor(), t - 60.0 * minutes);
            let clock = format!("{hours:02}:{:02}:{seconds:0width$.decimals$}", minutes % 60.0);
            if dated { vec!["2024-03-01".to_owned(), clock] } else { vec![clock] }
        }
        Stamp::Epoch(1.0) => vec![style.number(rounded(1.0, 3) + 1_709_294_400.0, 3)],
        Stamp::Epoch(size) => vec![style.number(rounded(size, 0) + 1_709_294_400_000.0, 0)],
        Stamp::Head(_) => Vec::new(),
    }
}

/// The lines below the rows: a summary, another table.
fn behind(noise: &mut Noise, channels: &[Channel], style: &Style, (summary, second): (bool, bool)) -> String {
    let mut text = String::new();
    if summary {
        let line = one(noise, &["Max", "Mean", "End of data", "# end", "EOF"]);
        let numbers =
            line.starts_with('M').then(|| channels.iter().map(|_| style.number(1.5, style.decimals)));
        let join = |row: String, cell: String| row + style.separator + &cell;
        let cells = numbers.into_iter().flatten().fold(line.to_owned(), join);
        writeln!(text, "{}{cells}", one(noise, &["", "\n"])).unwrap();
    }
    if second {
        let row = |a: &str, b: f64, c: f64| {
            [a.to_owned(), style.number(b, 2), style.number(c, 2)].join(style.separator) + "\n"
        };
        writeln!(text, "\n{}", ["Channel", "Min", "Max"].join(style.separator)).unwrap();
        text.extend(channels.iter().map(|(name, ..)| row(name, -2.0, 2.0)));
    }
    text
}

struct Drawn {
    text: String,
    rate: f64,
    channels: Vec<Channel>,
    /// Values of each channel in SI, as printed.
    values: Vec<Vec<f64>>,
    /// Largest rounding error of a printed value, in the unit as written.
    digit: f64,
    /// Unusual features of this export, named in the report of a fault.
    odd: Vec<&'static str>,
}

impl Drawn {
    fn new(seed: u64) -> Drawn {
        let mut noise = Noise::new(seed);
        let noise = &mut noise;
        let mut odd = Vec::new();
        let separator = one(noise, &[",", ";", "\t", ";", ", "]);
        let comma = !separator.contains(',') && chance(noise, 0.5);
        let decimals = one(noise, &[3, 4, 6]);
        let rate = 20.0 * 100f64.powf(noise.uniform());
        let rate =
            if chance(noise, 0.6) { one(noise, &[50.0, 100.0, 200.0, 400.0, 500.0, 1000.0]) } else { rate };
        let stamp = match noise.uniform() {
            u if u < 0.65 => one(noise, &COLUMNS),
            u if u < 0.78 => Stamp::Clock { dated: u < 0.72, decimals: one(noise, &[3, 6]) },
            u if u < 0.86 => Stamp::Epoch(one(noise, &[1.0, 1e-3])),
            _ => Stamp::Head(one(noise, &HEADS)),
        };
        let headed = matches!(stamp, Stamp::Head(_));
        let rate = if headed { (100.0 * rate).round() / 100.0 } else { rate };
        let n = noise.between(60.0, 500.0) as usize;
        let mut channels: Vec<_> = CHANNELS.to_vec();
        for _ in 0..noise.between(6.0, 9.99) as usize {
            channels.remove((noise.uniform() * channels.len() as f64) as usize);
        }
        let mut kept: Vec<usize> = (0..n).collect();
        let mut oddly = |noise: &mut Noise, part: f64, what: &'static str| {
            let is = chance(noise, part);
            if is {
                odd.push(what);
            }
            is
        };
        if !headed && oddly(noise, 0.15, "samples lost") {
            for _ in 0..noise.between(1.0, 4.0) as usize {
                kept.remove(noise.between(1.0, (kept.len() - 1) as f64) as usize);
            }
        }
        let jitter = if !headed && oddly(noise, 0.25, "jitter") { noise.between(0.001, 0.025) } else { 0.0 };
        let floor = oddly(noise, 0.4, "cut off");
        let missing = oddly(noise, 0.08, "NaN");
        let short = oddly(noise, 0.05, "short last row");
        let summary = oddly(noise, 0.1, "summary");
        let second = oddly(noise, 0.07, "two tables");
        let (unit_row, quoted) = (oddly(noise, 0.2, "row of units"), oddly(noise, 0.15, "quotes"));
        let style = Style { separator, comma, decimals };
        let mut text = head(noise, stamp, rate, &channels, &style, (unit_row, quoted));
        let frequencies: Vec<f64> = channels.iter().map(|_| noise.between(0.02, 0.2)).collect();
        let phase = noise.between(0.0, 3.0);
        let mut values = vec![Vec::new(); channels.len()];
        for (k, i) in kept.iter().enumerate() {
            let t = phase + (*i as f64 + jitter * noise.normal()) / rate;
            let mut cells = stamped(stamp, t, floor, &style);
            for (c, (_, unit, factor, _)) in channels.iter().enumerate() {
                let value = (2.0 + c as f64) * (frequencies[c] * *i as f64).sin() + 0.05 * noise.normal();
                let value = if *unit == "dB" { 60.0 + value } else { value };
                let gone = missing && chance(noise, 0.02);
                cells.push(if gone { "NaN".to_owned() } else { style.number(value, decimals) });
                let last = short && k + 1 == kept.len() && c + 1 == channels.len();
                if last && cells.len() > 1 {
                    cells.pop();
                } else {
                    values[c].push(if gone { f64::NAN } else { value * factor });
                }
            }
            writeln!(text, "{}", cells.join(separator)).unwrap();
        }
        if short {
            text.truncate(text.trim_end().len());
        } else {
            text += &behind(noise, &channels, &style, (summary, second));
        }
        Drawn { text, rate, channels, values, digit: 0.5 * 10f64.powi(-(decimals as i32)), odd }
    }

    /// Faults of a reading that no caution reports.
    fn faults(&self, read: &Recording) -> Vec<String> {
        let all = read.all_findings();
        let caution = |codes: &[&str]| {
            let said =
                |found: &&Finding| found.severity() >= Severity::Caution && codes.contains(&&*found.code);
            all.iter().any(|found| said(&found))
        };
        let traces: Vec<&Trace> = read
            .records
            .iter()
            .filter_map(|r| if let Record::Trace(t) = r { Some(t) } else { None })
            .collect();
        if traces.len() != self.channels.len() {
            let said = caution(&["columns-of-words", "columns-rise-evenly", "abscissa-unsaid"]);
            return if said { Vec::new() } else { vec![format!("{} channels", traces.len())] };
        }
        let mut faults = Vec::new();
        for ((trace, (name, _, factor, unit)), values) in traces.iter().zip(&self.channels).zip(&self.values)
        {
            let known = trace.meta.unit.symbol() == *unit;
            if trace.meta.name != *name || !(known || caution(&["unit-unsaid", "unit-unknown"])) {
                faults.push(format!("{name} is {:?} in {}", trace.meta.name, trace.meta.unit));
            }
            if *unit == "dB" && !caution(&["levels-in-decibels", "unit-unsaid"]) {
                faults.push("levels in silence".to_owned());
            }
            let factor = if known { 1.0 } else { 1.0 / factor };
            let off =
                |(a, b): (&f64, &f64)| (a - b * factor).abs() > self.digit * factor.max(1.0) * 9.81 * 1.001;
            let ends = trace.values.len() != values.len();
            let differ = trace.values.iter().zip(values).position(off);
            let short =
                caution(&["last-row-short", "row-cut-off", "last-row-cut-off", "rows-empty", "missing-kept"]);
            if (ends || differ.is_some()) && !short {
                faults.push(format!(
                    "{} values, not {}; differ at {differ:?}",
                    trace.values.len(),
                    values.len()
                ));
            }
            let uneven = ["samples-lost", "axis-uneven", "axis-backwards", "abscissa-unsaid"];
            match trace.rate() {
                Some(rate)
                    if (rate / self.rate - 1.0).abs() > 4.0 * trace.meta.clock + 1e-9
                        && !caution(&uneven) =>
                {
                    faults.push(format!("{rate} Hz ± {:.1e}, not {}", rate * trace.meta.clock, self.rate));
                }
                None if !caution(&uneven) => faults.push("uneven in silence".to_owned()),
                _ => {}
            }
        }
        faults
    }
}

#[test]
fn no_export_is_read_wrong_in_silence() {
    let reader = Reader::new().allow_missing(true);
    let (mut read, mut refused, mut wrong) = (0, Vec::new(), Vec::new());
    for seed in 1..=FILES {
        let drawn = Drawn::new(seed);
        match reader.from_reader("export.csv", drawn.text.as_bytes()) {
            Err(why) => {
                refused.push(format!("{seed} {:?}: {}", drawn.odd, why.to_string().replace('\n', " ")));
            }
            Ok(found) => {
                let faults = drawn.faults(&found);
                read += u64::from(faults.is_empty());
                if !faults.is_empty() {
                    wrong.push(format!("{seed} {:?}: {faults:?}", drawn.odd));
                }
            }
        }
    }
    println!("read {read}, refused {}, wrong {}", refused.len(), wrong.len());
    assert!(wrong.is_empty(), "{} wrong of {FILES}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(read * 100 >= 85 * FILES, "{read} of {FILES} read:\n{}", refused.join("\n"));
}
