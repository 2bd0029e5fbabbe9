//! Records 1 to 11 of data set 58: identification, degrees of freedom, data form, axis characteristics.

use super::codes;
use super::layout::{KINDS, Layout};
use crate::number;
use crate::text::encoding;
use crate::uff::stream::Stream;
use vibro_record::{Error, Place, Result};

/// Lines before the values.
pub const LINES: usize = 11;

/// The header of a data set 58.
#[derive(Debug, Clone, PartialEq)]
pub struct Heading {
    /// Identification lines 1 to 5.
    pub id: [String; 5],
    /// Record 6 as written in the file.
    pub record6: String,
    /// Function type, record 6.
    pub function: i64,
    /// Point of the response.
    pub response: DegreeOfFreedom,
    /// Point of the excitation or reference.
    pub reference: DegreeOfFreedom,
    /// Storage of the values, record 7.
    pub layout: Layout,
    /// Number of points: values, or pairs of abscissa and value.
    pub n: usize,
    /// First abscissa value of even spacing, in the unit of record 8.
    pub start: f64,
    /// Abscissa increment of even spacing, in the unit of record 8.
    pub step: f64,
    /// Abscissa, record 8.
    pub abscissa: AxisCharacteristics,
    /// Ordinate or its numerator, record 9.
    pub ordinate: AxisCharacteristics,
    /// Denominator of the ordinate, record 10.
    pub denominator: AxisCharacteristics,
    /// Place of record 7, for errors about what it declares.
    pub place: Place,
}

/// A degree of freedom: entity, node, direction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DegreeOfFreedom {
    /// Name of the component; empty if unused.
    pub entity: String,
    /// Node number; 0 if unused.
    pub node: i64,
    /// 0 scalar, ±1 to ±3 translation along ±X to ±Z, ±4 to ±6 rotation about them.
    pub direction: i64,
}

impl DegreeOfFreedom {
    /// Name such as `PWL Mic 1+X`: entity, node and direction, if given; the entity alone if it already
    /// contains the others.
    pub fn name(&self) -> String {
        const AXES: [&str; 7] = ["", "X", "Y", "Z", "RX", "RY", "RZ"];
        let axis = AXES.get(self.direction.unsigned_abs() as usize).copied().unwrap_or_default();
        let sign = if self.direction < 0 { "-" } else { "+" };
        let node = if self.node == 0 { String::new() } else { self.node.to_string() };
        let place = if axis.is_empty() { node } else { format!("{node}{sign}{axis}") };
        if self.entity.contains(&place) {
            self.entity.clone()
        } else {
            format!("{} {place}", self.entity).trim_start().to_owned()
        }
    }
}

/// Characteristics of an axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AxisCharacteristics {
    /// Specific data type.
    pub data_type: i64,
    /// Label; empty if it is `NONE`.
    pub label: String,
    /// Unit; empty if it is `NONE`.
    pub unit: String,
}

impl AxisCharacteristics {
    /// Label, or else the name of the data type, and unit: `speed [rpm]`.
    pub fn described(&self) -> String {
        let data_type = codes::data_type(self.data_type, false).map_or("", |t| t.0);
        let name = if self.label.is_empty() { data_type } else { &self.label };
        let unit = if self.unit.is_empty() { String::new() } else { format!(" [{}]", self.unit) };
        format!("{name}{unit}").trim_start().to_owned()
    }
}

impl Heading {
    /// Reads the eleven lines that follow the number of the set. Returns the number of lines found, as inner
    /// `Err`, if the set or the file ends before the eleventh; the closing delimiter then stays in the
    /// stream.
    pub fn read(stream: &mut Stream) -> Result<std::result::Result<Heading, usize>> {
        let mut lines = Vec::with_capacity(LINES);
        while lines.len() < LINES {
            let Some(line) = stream.line_within() else { return Ok(Err(lines.len())) };
            lines.push((encoding::decode(line), stream.place()));
        }
        let (function, response, reference) = dof(&lines[5].0).map_err(|e| e.at(&lines[5].1))?;
        let (layout, n, start, step) = form(&lines[6].0).map_err(|e| e.at(&lines[6].1))?;
        Ok(Ok(Heading {
            id: std::array::from_fn(|i| given(&lines[i].0)),
            record6: lines[5].0.trim_end().to_owned(),
            function,
            response,
            reference,
            layout,
            n,
            start,
            step,
            abscissa: axis(&lines[7].0),
            ordinate: axis(&lines[8].0),
            denominator: axis(&lines[9].0),
            place: lines.swap_remove(6).1,
        }))
    }

    /// A short name: the response point, for a ratio also the reference point. Without a response point,
    /// the first identification line.
    pub fn name(&self) -> String {
        let response = self.response.name();
        let ratio = matches!(self.function, 3..=6 | 8);
        let reference = if ratio { self.reference.name() } else { String::new() };
        match (response.is_empty(), reference.is_empty()) {
            (true, _) => self.id[0].clone(),
            (false, true) => response,
            (false, false) => format!("{response} / {reference}"),
        }
    }
}

/// Text without surrounding blanks; empty for `NONE`, which marks an unused field.
fn given(text: &str) -> String {
    let text = text.trim();
    if text.eq_ignore_ascii_case("none") { String::new() } else { text.to_owned() }
}

/// Splits a line into fields of these widths in characters, trimmed; empty beyond the end of the line.
fn cut<const N: usize>(line: &str, widths: [usize; N]) -> [String; N] {
    let mut rest = line.chars();
    widths.map(|width| rest.by_ref().take(width).collect::<String>().trim().to_owned())
}

/// A whole number; a blank field is 0, as in Fortran.
fn whole(field: &str) -> Option<i64> {
    if field.is_empty() { Some(0) } else { field.parse().ok() }
}

fn real(field: &str) -> Option<f64> {
    if field.is_empty() { Some(0.0) } else { number::parse(field.as_bytes()) }
}

/// Record 6, format `2(I5,I10),2(1X,A10,I10,I4)`: function type, response and reference point.
fn dof(text: &str) -> Result<(i64, DegreeOfFreedom, DegreeOfFreedom)> {
    let [function, _, _, _, _, response, node, direction, _, reference, of, along] =
        cut(text, [5, 10, 5, 10, 1, 10, 10, 4, 1, 10, 10, 4]);
    let point = |entity: &str, node: &str, direction: &str| {
        Some(DegreeOfFreedom { entity: given(entity), node: whole(node)?, direction: whole(direction)? })
    };
    let function = whole(&function).filter(|f| (0..100).contains(f));
    let points = || Some((point(&response, &node, &direction)?, point(&reference, &of, &along)?));
    let Some((function, (response, reference))) = function.zip(points()) else {
        let expected = "a function type from 0 to 99, identification numbers, response and reference point";
        return Err(Error::usage(format!("record 6 of data set 58 is {:?}", text.trim_end()), expected)
            .hint("the header has 11 lines behind the line with 58: five of text, then this one"));
    };
    Ok((function, response, reference))
}

/// Reads record 7, format `3I10,3E13.5` or numbers between blanks: storage, number of values, start and step.
fn form(text: &str) -> Result<(Layout, usize, f64, f64)> {
    let columns = cut(text.trim_end(), [10, 10, 10, 13, 13]);
    let words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
    let numbers = |cells: &[String]| {
        let [kind, n, spacing, start, step] = cells.first_chunk()?;
        Some((whole(kind)?, whole(n)?, whole(spacing)?, real(start)?, real(step)?))
    };
    let refuse = |found: String, expected: &str| {
        Err(Error::usage(found, expected)
            .hint("the sizes of a data set 58 stand here: it cannot be read without them"))
    };
    let fixed = numbers(&columns).filter(|form| form.0 != 0 && text.trim_end().chars().count() > 20);
    let Some((kind, n, spacing, start, step)) = fixed.or_else(|| numbers(&words)) else {
        return refuse(
            format!("record 7 of data set 58 is {:?}", text.trim_end()),
            "ordinate type, number of values, spacing, abscissa start and increment",
        );
    };
    let Some((_, complex, double)) = KINDS.into_iter().find(|(code, ..)| *code == kind) else {
        let expected = "2 (real single), 4 (real double), 5 (complex single) or 6 (complex double)";
        return refuse(format!("ordinate data type {kind}"), expected);
    };
    if !matches!(spacing, 0 | 1) {
        return refuse(format!("abscissa spacing {spacing}"), "0 (uneven) or 1 (even)");
    }
    let Ok(n) = usize::try_from(n) else {
        return refuse(format!("{n} values declared"), "a number of values that is not negative");
    };
    Ok((Layout { complex, double, even: spacing == 1 }, n, start, step))
}

/// Reads one of the records 8 to 11, format `I10,3I5,2(1X,A20)`.
fn axis(text: &str) -> AxisCharacteristics {
    let text = text.trim_end();
    let [data_type, _, _, _, before, label, between, unit] = cut(text, [10, 5, 5, 5, 1, 20, 1, usize::MAX]);
    // Some writers count the bytes of UTF-8, some its characters; the column between the two fields shows
    // which.
    let (label, unit) = if before.is_empty() && between.is_empty() {
        (label, unit)
    } else if text.is_char_boundary(46) {
        (text[..46].chars().skip(25).collect(), text[46..].to_owned())
    } else {
        (text.chars().skip(25).collect(), String::new())
    };
    AxisCharacteristics {
        data_type: whole(&data_type).unwrap_or(0),
        label: given(&label),
        unit: given(&unit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heading(text: &str) -> Result<std::result::Result<Heading, usize>> {
        Heading::read(&mut Stream::new(text.as_bytes()))
    }

    fn header(record6: &str, record7: &str, record9: &str) -> String {
        format!(
            "Run -1\nNONE\n18-Apr-16 13:49:58\n\n    -1 of 3\n{record6}\n{record7}\n        17    0    0    0 time                 s\n{record9}\n         0    0    0    0 NONE                 NONE\n         0    0    0    0 NONE                 NONE\n"
        )
    }

    const RECORD6: &str = "    4         1    1         0 PWL Mic            7  -3 NONE              22   1";
    const RECORD7: &str = "         5       801         1  0.00000E+00  2.50000E-01  0.00000E+00";
    const RECORD9: &str = "        12    0    0    0 Acceleration         m/s2";

    #[test]
    fn fields_in_their_columns() {
        let h = heading(&header(RECORD6, RECORD7, RECORD9)).unwrap().unwrap();
        assert_eq!(h.id, ["Run -1", "", "18-Apr-16 13:49:58", "", "-1 of 3"]);
        assert_eq!(h.function, 4);
        assert_eq!(h.response, DegreeOfFreedom { entity: "PWL Mic".into(), node: 7, direction: -3 });
        assert_eq!(h.reference, DegreeOfFreedom { entity: String::new(), node: 22, direction: 1 });
        assert_eq!(h.layout, Layout { complex: true, double: false, even: true });
        assert_eq!((h.n, h.start, h.step), (801, 0.0, 0.25));
        assert_eq!((h.ordinate.data_type, h.ordinate.unit.as_str()), (12, "m/s2"));
    }

    #[test]
    fn sizes_between_blanks() {
        let h = heading(&header(RECORD6, "5 801 1 0.0 .25 0.0", RECORD9)).unwrap().unwrap();
        assert_eq!((h.n, h.step), (801, 0.25));
    }

    #[test]
    fn units_behind_two_byte_characters_are_found_by_character_and_by_byte() {
        for padding in [16, 15] {
            let record9 = format!("        12    0    0    0 Weg µ{:padding$}µm", "");
            let h = heading(&header(RECORD6, RECORD7, &record9)).unwrap().unwrap();
            assert_eq!(h.ordinate.unit, "µm", "{padding} blanks");
        }
    }

    #[test]
    fn a_header_cut_short_says_how_many_lines_it_has() {
        let whole = header(RECORD6, RECORD7, RECORD9);
        for kept in 0..LINES {
            let cut: String = whole.split_inclusive('\n').take(kept).collect();
            let closed = format!("{cut}    -1\n");
            assert_eq!(heading(&closed).unwrap().unwrap_err(), kept);
        }
    }

    #[test]
    fn garbage_in_record_7_is_refused_with_its_line() {
        for (record7, found) in [
            ("garbage", "garbage"),
            ("         3       801         1  0.00000E+00  2.50000E-01", "ordinate data type 3"),
            ("         2       801         7  0.00000E+00  2.50000E-01", "spacing 7"),
            ("         2      -801         1  0.00000E+00  2.50000E-01", "-801 values"),
            ("         2       801         1  0.00000E+00  2.5000x-01", "record 7"),
            ("", "record 7"),
        ] {
            let message = heading(&header(RECORD6, record7, RECORD9)).unwrap_err().to_string();
            assert!(message.contains("line 7") && message.contains(found), "{message}");
        }
    }
}
