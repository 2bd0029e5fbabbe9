//! The eleven header lines of a record.

use super::{Layout, field};
use crate::uff::set58::KINDS;
use vibro_record::units::{Quantity, Unit};
use vibro_record::{ADDED_DECAY, AVERAGED_WITH, Axis, AxisKind, FROM_BLOWS, Meta, Record, Scaling, Spectrum};

/// Record 6 after its function type, for a record without a degree of freedom.
const NOWHERE: &str = "         0    0         0 NONE               0   0 NONE               0   0";

/// Delimiter, number line and header; `bytes` is the size of binary values, `start` and `step` are the texts
/// of record 7.
pub fn text(record: &Record, layout: Layout, bytes: Option<usize>, [start, step]: &[String; 2]) -> String {
    let meta = record.meta();
    let note = |key: &str| meta.notes.iter().find(|(k, _)| k == key).map(|(_, text)| text.as_str());
    // Record 6 as read is kept, unless the record was renamed.
    let point = note("record 6").filter(|line| line.is_ascii() && line.len() > 5).filter(|_| {
        // Reading adds a number to repeated names: `name #2`.
        let first = meta.name.rsplit_once(" #").map(|(name, _)| name);
        note("point").is_some_and(|point| point == meta.name || Some(point) == first)
    });
    let mut id: [String; 5] =
        std::array::from_fn(|i| note(&format!("id line {}", i + 1)).unwrap_or_default().to_owned());
    if point.is_none() {
        id[0].clone_from(&meta.name);
    }
    if id[4].starts_with("scaling ") {
        id[4].clear(); // scaling of the file that the record was read from
    }
    match record {
        Record::Spectrum(spectrum) => {
            if let Some(line) = scaling_line(spectrum) {
                id[4] = line;
            }
        }
        Record::Frf(_) => {
            if let Some(decay) = meta.added_decay() {
                id[4] = format!("{ADDED_DECAY}{decay}");
            }
            if meta.from_blows() {
                FROM_BLOWS.clone_into(&mut id[3]);
            }
            if let Some(window) = meta.averaged_with() {
                id[3] = format!("{AVERAGED_WITH}{}", window.name());
            }
        }
        Record::Trace(_) => {}
    }
    let function = function(record, point.and_then(|line| line[..5].trim().parse().ok()));
    let kind =
        KINDS.iter().find(|(_, complex, double)| (*complex, *double) == (layout.complex, layout.double));
    let (kind, even) = (kind.map_or(0, |(code, ..)| *code), u8::from(layout.even));
    let number = bytes.map_or_else(
        || "    58".to_owned(),
        |bytes| format!("    58b{:6}{:6}{:12}{bytes:12}{:6}{:6}{:12}{:12}", 1, 2, 11, 0, 0, 0, 0),
    );
    let [above, below] = ordinate(meta);
    let ends = [
        format!("{function:5}{}", point.map_or(NOWHERE, |line| &line[5..])),
        format!("{kind:10}{:10}{even:10}{start}{step}{}", record.len(), field(0.0, 13, 6)),
        abscissa(record.axis()),
        above,
        below,
        characteristics(0, "", ""),
    ];
    let id = id.iter().map(|line| plain(line, 80));
    let lines = ["    -1".to_owned(), number].into_iter().chain(id).chain(ends);
    lines.map(|line| format!("{line:80}")).collect::<Vec<_>>().join("\n") + "\n"
}

/// Function type of record 6. `before`, the type in the file that the record was read from, is kept if it
/// still fits the record.
fn function(record: &Record, before: Option<u8>) -> u8 {
    let keep = |same: fn(u8) -> bool, otherwise: u8| before.filter(|code| same(*code)).unwrap_or(otherwise);
    match record {
        Record::Trace(_) => keep(|code| matches!(code, 0 | 1 | 7 | 8 | 11 | 13..=17 | 25), 1),
        Record::Frf(_) => keep(|code| matches!(code, 4 | 5), 4),
        Record::Spectrum(spectrum) => match spectrum.scaling {
            Scaling::Psd => 9,
            Scaling::Energy => 10,
            Scaling::Coherence => keep(|code| matches!(code, 6 | 21 | 26), 6),
            Scaling::Power => keep(|code| matches!(code, 2 | 3), 2),
            Scaling::Peak | Scaling::Rms => 12,
            Scaling::Unknown => keep(|code| !matches!(code, 1 | 6..=10 | 21 | 25 | 26), 12),
        },
    }
}

/// Fifth identification line: scaling, window and noise bandwidth that the function type cannot express.
fn scaling_line(Spectrum { scaling, window, enbw, .. }: &Spectrum) -> Option<String> {
    let by_type = matches!(scaling, Scaling::Psd | Scaling::Energy | Scaling::Coherence | Scaling::Unknown);
    let window = window.map(|window| format!("; window {}", window.name()));
    let enbw = enbw.map(|enbw| format!("; enbw {enbw}"));
    let needed = !by_type || window.is_some() || enbw.is_some();
    let [window, enbw] = [window, enbw].map(Option::unwrap_or_default);
    needed.then(|| format!("scaling {}{window}{enbw}", scaling.name()))
}

/// One of the records 8 to 11.
fn characteristics(data_type: u8, label: &str, unit: &str) -> String {
    format!("{data_type:10}{:5}{:5}{:5} {:20} {:20}", 0, 0, 0, plain(label, 20), plain(unit, 20))
}

fn abscissa(axis: &Axis) -> String {
    match &axis.kind {
        AxisKind::Time => characteristics(17, "time", "s"),
        AxisKind::Frequency => characteristics(18, "frequency", "Hz"),
        AxisKind::Index => characteristics(0, "index", ""),
        AxisKind::Other(name) => characteristics(0, name, ""),
    }
}

/// Records 9 and 10: the ordinate, or its numerator and denominator.
fn ordinate(meta: &Meta) -> [String; 2] {
    let of = |quantity: Quantity| {
        let data_type = match quantity {
            Quantity::Displacement => 8,
            Quantity::Velocity => 11,
            Quantity::Acceleration => 12,
            Quantity::Force => 13,
            Quantity::Pressure => 15,
            Quantity::Mass => 16,
            _ => 0,
        };
        characteristics(data_type, quantity.name(), &unit_text(&Unit::of(quantity)))
    };
    match meta.unit.quantity() {
        Quantity::Receptance => [of(Quantity::Displacement), of(Quantity::Force)],
        Quantity::Mobility => [of(Quantity::Velocity), of(Quantity::Force)],
        Quantity::Accelerance => [of(Quantity::Acceleration), of(Quantity::Force)],
        Quantity::Other => [characteristics(0, "", &unit_text(&meta.unit)), characteristics(0, "", "")],
        named => [of(named), characteristics(0, "", "")],
    }
}

/// A unit in ASCII if that is equivalent, since other programs count bytes instead of characters; empty if
/// it needs more than 20 characters.
fn unit_text(unit: &Unit) -> String {
    const PLAIN: [(&str, &str); 8] = [
        ("²", "^2"),
        ("³", "^3"),
        ("⁴", "^4"),
        ("·", "*"),
        ("µ", "u"),
        ("μ", "u"),
        ("°", "deg"),
        ("⁻¹", "^-1"),
    ];
    let symbol = unit.symbol();
    let plain = PLAIN.iter().fold(symbol.to_owned(), |text, (from, to)| text.replace(from, to));
    let same = Unit::parse(&plain).is_some_and(|p| unit.is_known() && p.dimension() == unit.dimension());
    let chosen = if same { plain } else { symbol.to_owned() };
    // A unit cut short would be another unit.
    if unit.is_known() && chosen.chars().count() > 20 { String::new() } else { chosen }
}

/// Text of at most `width` characters on one line; `NONE` for an empty text, `(-1)` instead of a line that
/// would end the data set.
fn plain(text: &str, width: usize) -> String {
    let line: String = text.trim().replace(char::is_control, " ").chars().take(width).collect();
    match line.trim() {
        "" => "NONE".to_owned(),
        "-1" => "(-1)".to_owned(),
        line => line.to_owned(),
    }
}
