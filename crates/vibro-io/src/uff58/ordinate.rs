//! The unit of the values, from unit texts, data types, unit exponents and the file's unit system.

use super::codes;
use super::heading::{Axis, Heading};
use crate::uff::system::System;
use vibro_record::Finding;
use vibro_record::units::{Dimension, Quantity, Unit};

/// What one unit of the stored values is.
#[derive(Debug, Clone, PartialEq)]
pub struct Ordinate {
    /// SI unit, or the file's own where it is not understood.
    pub unit: Unit,
    /// Factor to it.
    pub factor: f64,
    /// Unit as the file has it; empty where it has none.
    pub written: String,
    /// What is to be said of it.
    pub findings: Vec<Finding>,
}

/// Characters that a superscript or µ becomes when it is read in another code page than it was written in.
const MANGLED: &[(&str, &str)] = &[
    // UTF-8 taken as code page 437 and as Latin-1
    ("┬▓", "²"),
    ("┬│", "³"),
    ("┬╡", "µ"),
    ("Â²", "²"),
    ("Â³", "³"),
    ("Âµ", "µ"),
    // Latin-1 taken as Mac Roman and as code page 437
    ("≤", "²"),
    ("≥", "³"),
    ("▓", "²"),
    ("│", "³"),
];

/// Who says what a part of the ordinate is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Said {
    Nobody,
    Text,
    DataType,
    Exponents,
}

/// Numerator or denominator of an ordinate.
#[derive(Debug, Clone)]
struct Part {
    said: Said,
    /// Name and dimension of its data type.
    data_type: Option<(&'static str, Dimension)>,
    /// `None` where the unit is not understood.
    dimension: Option<Dimension>,
    factor: f64,
}

impl Part {
    fn of(axis: &Axis, direction: i64, system: &System, findings: &mut Vec<Finding>) -> Part {
        let data_type = codes::data_type(axis.data_type, direction.abs() > 3);
        let part = |said, dimension, factor| Part { said, data_type, dimension, factor };
        if !axis.unit.is_empty() {
            let unit = Unit::parse(&axis.unit).or_else(|| mend(&axis.unit, findings)).unwrap_or_else(|| {
                findings.push(Finding::caution("unit-unknown").name("unit", axis.unit.as_str()));
                Unit::opaque(&axis.unit)
            });
            return part(Said::Text, unit.dimension(), unit.factor());
        }
        if let Some((_, dimension)) = data_type {
            return part(Said::DataType, Some(dimension), system.factor(dimension));
        }
        if axis.data_type == 1 && axis.exponents != [0; 3] {
            // Exponents of length, force and temperature leave the power of time open.
            return part(Said::Exponents, None, system.factor_of(axis.exponents));
        }
        part(Said::Nobody, Some(Dimension::NONE), 1.0)
    }

    /// Whether a text gives the dimension of the data type, and that is not a plain number.
    fn is_typed(&self) -> bool {
        self.said == Said::Text
            && self.data_type.is_some_and(|(_, d)| d != Dimension::NONE && self.dimension == Some(d))
    }
}

/// A unit whose superscript was mangled on its way through a wrong code page.
fn mend(text: &str, findings: &mut Vec<Finding>) -> Option<Unit> {
    let mended = MANGLED.iter().fold(text.to_owned(), |t, (wrong, right)| t.replace(wrong, right));
    let unit = Unit::parse(&mended)?;
    findings.push(Finding::note("unit-mended").name("unit", text).name("taken", mended));
    Some(unit)
}

impl Ordinate {
    /// The unit of the values of a data set.
    pub fn of(heading: &Heading, system: &System) -> Ordinate {
        let mut findings = Vec::new();
        let above = Part::of(&heading.ordinate, heading.response.direction, system, &mut findings);
        let mut below = Part::of(&heading.denominator, heading.reference.direction, system, &mut findings);
        let (ordinate, denominator) = (&heading.ordinate.unit, &heading.denominator.unit);
        let mut written = ordinate.clone();
        if !denominator.is_empty() {
            written = format!("({ordinate})/({denominator})");
        }
        if is_whole(&above, &below) {
            written.clone_from(ordinate);
            below = Part { said: Said::Nobody, dimension: Some(Dimension::NONE), factor: 1.0, ..below };
        }
        let (unit, factor) = match plain(heading, &above, &below) {
            Ok((dimension, power, seconds)) => {
                findings.extend(sources(heading, &above, &below, system));
                let squared = dimension.half_power(2 * power).unwrap_or(dimension);
                let dimension = squared.times(Dimension([0, 0, 2 * seconds, 0, 0, 0]));
                let factor = (above.factor / below.factor).powi(i32::from(power));
                (spelled(dimension, factor, &written), factor)
            }
            Err(why) => {
                findings.extend(why);
                let from_text = above.said == Said::Text || below.said == Said::Text;
                let factor = if from_text { 1.0 } else { above.factor / below.factor };
                (Unit::opaque(&written), factor)
            }
        };
        let mut result = Ordinate { unit, factor, written, findings };
        label_against_unit(heading, &mut result);
        result
    }
}

/// The SI unit of a dimension; one without a name keeps the spelling of the file where that is SI already.
fn spelled(dimension: Dimension, factor: f64, written: &str) -> Unit {
    let named = Quantity::of(dimension) != Quantity::Other;
    Unit::parse(written)
        .filter(|unit| !named && factor == 1.0 && unit.factor() == 1.0 && unit.dimension() == Some(dimension))
        .unwrap_or_else(|| Unit::from_dimension(dimension))
}

/// Whether the text of the numerator is the unit of the whole ratio already.
fn is_whole(above: &Part, below: &Part) -> bool {
    let (Said::Text, Some(written), Some(denominator)) = (above.said, above.dimension, below.dimension)
    else {
        return false;
    };
    let force = Quantity::of(denominator) == Quantity::Force;
    match above.data_type {
        Some((_, dimension)) if dimension == written => false,
        Some((_, dimension)) => written == dimension.times(denominator.inverse()),
        None => force && is_frf(Quantity::of(written)),
    }
}

/// Dimension of the ordinate, the power to which it stands in the lines of a spectrum of this function type, and the
/// power of seconds beside it. Without an answer the values stay as they are, for the reason given.
fn plain(heading: &Heading, above: &Part, below: &Part) -> Result<(Dimension, i8, i8), Option<Finding>> {
    let (name, _) = codes::function(heading.function);
    let coherence = matches!(heading.function, 6 | 21 | 26);
    if coherence && above.said != Said::Text {
        return Ok((Dimension::NONE, 1, 0));
    }
    if above.said == Said::Nobody && below.said == Said::Nobody {
        return Err(Some(Finding::caution("unit-unsaid")));
    }
    let (Some(numerator), Some(denominator)) = (above.dimension, below.dimension) else {
        let exponents = above.said == Said::Exponents || below.said == Said::Exponents;
        return Err(exponents.then(|| Finding::caution("unit-by-exponents")));
    };
    let dimension = numerator.times(denominator.inverse());
    let (power, seconds) = match heading.function {
        2 | 3 => (2, 0),
        9 => (2, 1),
        10 => (2, 2),
        _ => return Ok((dimension, 1, 0)),
    };
    if above.is_typed() {
        let found = Finding::caution("unit-of-signal").name("unit", heading.ordinate.unit.as_str());
        return Err(Some(found.name("function", name)));
    }
    if above.said == Said::Text {
        return Ok((dimension, 1, 0)); // the text is the unit of the lines, such as g²/Hz
    }
    if below.said != Said::Nobody {
        return Err(Some(Finding::caution("unit-unsaid-squared").name("function", name)));
    }
    Ok((dimension, power, seconds))
}

/// Doubts about where the unit comes from.
fn sources(heading: &Heading, above: &Part, below: &Part, system: &System) -> Vec<Finding> {
    let mut findings = Vec::new();
    let types = match (above.data_type, below.data_type) {
        (Some((above, _)), Some((below, _))) => format!("{above} over {below}"),
        (Some((above, _)), None) => above.to_owned(),
        (None, Some((below, _))) => format!("a number over {below}"),
        (None, None) => String::new(),
    };
    if [above, below].iter().any(|p| p.said == Said::DataType && p.dimension != Some(Dimension::NONE))
        && !system.stated
    {
        findings.push(Finding::caution("unit-by-data-type").name("type", types.as_str()));
    }
    let (Said::Text, Some(dimension)) = (above.said, above.dimension) else { return findings };
    let unit = &heading.ordinate.unit;
    let ratio = system.factor(dimension) / above.factor;
    if system.stated && (ratio - 1.0).abs() > 1e-6 {
        let differs = Finding::caution("unit-against-system").name("unit", unit.as_str());
        findings.push(differs.number("ratio", ratio));
    }
    let squared = matches!(heading.function, 2 | 3 | 9 | 10);
    let ratio = above.data_type.zip(below.data_type).map(|(a, b)| a.1.times(b.1.inverse()));
    let contradicts = above.data_type.is_some_and(|(_, d)| d != dimension) && ratio != Some(dimension);
    if contradicts && !squared {
        let differs = Finding::caution("unit-against-type").name("type", types).name("unit", unit.as_str());
        findings.push(differs.name("quantity", described(dimension)));
    }
    findings
}

fn is_frf(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::Receptance | Quantity::Mobility | Quantity::Accelerance)
}

/// `a velocity`, or the SI unit where the dimension has no name.
fn described(dimension: Dimension) -> String {
    match Quantity::of(dimension) {
        Quantity::Other => Unit::from_dimension(dimension).symbol().to_owned(),
        quantity => {
            let noun = quantity.name();
            let vowel = noun.starts_with(['a', 'e', 'i', 'o', 'u']);
            format!("{} {noun}", if vowel { "an" } else { "a" })
        }
    }
}

/// A doubt where the label of the ordinate names another quantity than its unit.
fn label_against_unit(heading: &Heading, ordinate: &mut Ordinate) {
    let (Some(label), Some(dimension)) =
        (codes::quantity_of_label(&heading.ordinate.label), ordinate.unit.dimension())
    else {
        return;
    };
    // The label of a ratio may be that of its numerator, and a density may be labelled by its signal.
    let comparable = match heading.function {
        4 => is_frf(label),
        0 | 1 | 12 => !matches!(label, Quantity::Time | Quantity::Frequency | Quantity::Ratio),
        _ => false,
    };
    // A rotation is labelled as the motion it is, without the word angular.
    let unit = match Quantity::of(dimension) {
        Quantity::Angle => Quantity::Displacement,
        Quantity::AngularVelocity => Quantity::Velocity,
        Quantity::AngularAcceleration => Quantity::Acceleration,
        other => other,
    };
    let rotation = unit != Quantity::of(dimension) && label == unit;
    if comparable && Quantity::of(dimension) != label && !rotation {
        let unit = if ordinate.written.is_empty() { ordinate.unit.symbol() } else { &ordinate.written };
        let differs = Finding::caution("unit-against-label").name("label", heading.ordinate.label.as_str());
        let differs = differs.name("unit", unit).name("quantity", described(dimension));
        ordinate.findings.push(differs);
    }
}
