//! The unit of the values, from unit texts, data types and the file's unit system.

use super::codes::{self, FunctionType};
use super::heading::{AxisCharacteristics, Heading};
use crate::number;
use crate::uff::stream::Stream;
use vibro_record::code;
use vibro_record::units::{Dimension, Quantity, Unit};
use vibro_record::{Finding, Scaling};

/// Data set 164: number of the file's units of length, force and temperature in one SI unit; `None` if the
/// file does not state it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct UnitSystem(Option<[f64; 3]>);

impl UnitSystem {
    /// Reads two lines of data set 164. `None` if the second line does not hold three positive factors,
    /// format `3D25.17`.
    pub fn read(stream: &mut Stream) -> Option<UnitSystem> {
        stream.line_within()?;
        let line = stream.line_within()?;
        let factors = line.chunks(25).map_while(number::parse).filter(|f| *f > 0.0 && f.is_finite());
        Some(UnitSystem(Some(*factors.collect::<Vec<f64>>().first_chunk()?)))
    }

    /// SI units in one unit of the file, for a quantity of this dimension. Mass is force times time squared
    /// over length; time is in seconds in every system.
    fn factor(&self, dimension: Dimension) -> f64 {
        let [length, force, temperature] = self.0.unwrap_or([1.0; 3]);
        let [m, kg, _, _, kelvin, _] = dimension.0.map(|doubled| f64::from(doubled) / 2.0);
        length.powf(kg - m) * force.powf(-kg) * temperature.powf(-kelvin)
    }
}

/// Superscripts and µ, each with its garbled forms after reading in a wrong code page: UTF-8 read as code
/// page 437 and as Latin-1, then Latin-1 read as Mac Roman and as code page 437.
const MANGLED: [(&str, &str); 3] = [("²", "┬▓ Â² ≤ ▓"), ("³", "┬│ Â³ ≥ │"), ("µ", "┬╡ Âµ")];

/// Numerator or denominator of an ordinate.
#[derive(Debug, Clone)]
struct FractionTerm {
    /// Whether its unit is stated as text.
    text: bool,
    /// Name and dimension of its data type.
    data_type: Option<(&'static str, Dimension)>,
    /// `None` if the unit is unknown.
    dimension: Option<Dimension>,
    factor: f64,
}

impl FractionTerm {
    fn of(
        axis: &AxisCharacteristics,
        direction: i64,
        system: &UnitSystem,
        findings: &mut Vec<Finding>,
    ) -> FractionTerm {
        let data_type = codes::data_type(axis.data_type, direction.abs() > 3);
        if axis.unit.is_empty() {
            let dimension = data_type.map_or(Dimension::NONE, |(_, dimension)| dimension);
            let factor = system.factor(dimension);
            return FractionTerm { text: false, data_type, dimension: Some(dimension), factor };
        }
        let unit = Unit::parse(&axis.unit).or_else(|| mend(&axis.unit, findings)).unwrap_or_else(|| {
            findings.push(Finding::caution("unit-unknown").name("unit", axis.unit.as_str()));
            Unit::opaque(&axis.unit)
        });
        FractionTerm { text: true, data_type, dimension: unit.dimension(), factor: unit.factor() }
    }

    /// Whether its unit is not stated, neither by text nor by data type.
    fn unsaid(&self) -> bool {
        !self.text && self.data_type.is_none()
    }
}

/// The unit of a text whose superscripts or µ were garbled by a wrong code page.
fn mend(text: &str, findings: &mut Vec<Finding>) -> Option<Unit> {
    let all = MANGLED.iter().flat_map(|(right, wrong)| wrong.split(' ').map(move |wrong| (wrong, right)));
    let mended = all.fold(text.to_owned(), |t, (wrong, right)| t.replace(wrong, right));
    let unit = Unit::parse(&mended)?;
    findings.push(Finding::note("unit-mended").name("unit", text).name("taken", mended));
    Some(unit)
}

/// SI unit of the values of a data set, or the file's own unit if that is unknown; the factor to SI; the
/// unit as the file writes it, empty if it has none; and findings on it.
pub fn unit(heading: &Heading, system: &UnitSystem) -> (Unit, f64, String, Vec<Finding>) {
    let mut findings = Vec::new();
    let above = FractionTerm::of(&heading.ordinate, heading.response.direction, system, &mut findings);
    let mut below =
        FractionTerm::of(&heading.denominator, heading.reference.direction, system, &mut findings);
    let (numerator, denominator) = (&heading.ordinate.unit, &heading.denominator.unit);
    let mut written = numerator.clone();
    if is_whole(&above, &below) {
        below = FractionTerm { text: false, data_type: None, dimension: Some(Dimension::NONE), factor: 1.0 };
    } else if !denominator.is_empty() {
        written = format!("({numerator})/({denominator})");
    }
    let (unit, factor) = match plain(heading, &above, &below) {
        Ok((dimension, power, seconds)) => {
            let typed = |part: &FractionTerm| !part.text && part.dimension != Some(Dimension::NONE);
            if system.0.is_none() && (typed(&above) || typed(&below)) {
                let name = |part: &FractionTerm| part.data_type.map_or("a number", |(name, _)| name);
                let types = match below.data_type {
                    Some((below, _)) => format!("{} over {below}", name(&above)),
                    None => name(&above).to_owned(),
                };
                findings.push(Finding::caution("unit-by-data-type").name("type", types));
            }
            let squared = dimension.half_power(2 * power).unwrap_or(dimension);
            let dimension = squared.times(Dimension([0, 0, 2 * seconds, 0, 0, 0]));
            let factor = (above.factor / below.factor).powi(i32::from(power));
            (spelled(dimension, factor, &written), factor)
        }
        Err(why) => {
            findings.extend(why);
            (Unit::opaque(&written), 1.0)
        }
    };
    findings.extend(label_against_unit(heading, &unit, &written));
    (unit, factor, written, findings)
}

/// The SI unit of a dimension; a unit without a name keeps the spelling of the file if that is SI already.
fn spelled(dimension: Dimension, factor: f64, written: &str) -> Unit {
    let named = Quantity::of(dimension) != Quantity::Other;
    Unit::parse(written)
        .filter(|unit| !named && factor == 1.0 && unit.factor() == 1.0 && unit.dimension() == Some(dimension))
        .unwrap_or_else(|| Unit::from_dimension(dimension))
}

/// Whether the unit text of the numerator is already the unit of the whole ratio.
fn is_whole(above: &FractionTerm, below: &FractionTerm) -> bool {
    let (true, Some(written), Some(denominator)) = (above.text, above.dimension, below.dimension) else {
        return false;
    };
    match above.data_type {
        Some((_, dimension)) => dimension != written && written == dimension.times(denominator.inverse()),
        None => Quantity::of(denominator) == Quantity::Force && is_frf(Quantity::of(written)),
    }
}

/// Dimension of the ordinate; its power in the values of this function type, 2 for a squared function; and
/// the power of seconds, 1 for a PSD, 2 for an energy density. On an error, values stay in the file's unit.
fn plain(
    heading: &Heading,
    above: &FractionTerm,
    below: &FractionTerm,
) -> Result<(Dimension, i8, i8), Option<Finding>> {
    let (name, _, kind) = codes::function(heading.function);
    if kind == FunctionType::Scaled(Scaling::Coherence) && !above.text {
        return Ok((Dimension::NONE, 1, 0));
    }
    if above.unsaid() && below.unsaid() {
        return Err(Some(Finding::caution(code::UNIT_UNSAID)));
    }
    let (Some(numerator), Some(denominator)) = (above.dimension, below.dimension) else { return Err(None) };
    let dimension = numerator.times(denominator.inverse());
    let (power, seconds) = match kind {
        FunctionType::Squared => (2, 0),
        FunctionType::Scaled(Scaling::Psd) => (2, 1),
        FunctionType::Scaled(Scaling::Energy) => (2, 2),
        _ => return Ok((dimension, 1, 0)),
    };
    let signal = above.data_type.is_some_and(|(_, d)| d != Dimension::NONE && numerator == d);
    if above.text && signal {
        let found = Finding::caution("unit-of-signal").name("unit", heading.ordinate.unit.as_str());
        return Err(Some(found.name("function", name)));
    }
    if above.text {
        return Ok((dimension, 1, 0)); // the text is the unit of the lines, such as g²/Hz
    }
    if below.unsaid() {
        Ok((dimension, power, seconds))
    } else {
        Err(Some(Finding::caution(code::UNIT_UNSAID)))
    }
}

fn is_frf(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::Receptance | Quantity::Mobility | Quantity::Accelerance)
}

/// A caution if the label of the ordinate names another quantity than its unit.
fn label_against_unit(heading: &Heading, unit: &Unit, written: &str) -> Option<Finding> {
    let label = codes::quantity_of_label(&heading.ordinate.label)?;
    let quantity = Quantity::of(unit.dimension()?);
    // The label of a ratio may name its numerator, and the label of a density its signal.
    let comparable = match heading.function {
        4 => is_frf(label),
        0 | 1 | 12 => !matches!(label, Quantity::Time | Quantity::Frequency | Quantity::Ratio),
        _ => false,
    };
    // The label of a rotation names the motion without the word angular.
    let motion = match quantity {
        Quantity::Angle => Quantity::Displacement,
        Quantity::AngularVelocity => Quantity::Velocity,
        Quantity::AngularAcceleration => Quantity::Acceleration,
        other => other,
    };
    let differs = Finding::caution("unit-against-label").name("label", heading.ordinate.label.as_str());
    let shown = if written.is_empty() { unit.symbol() } else { written };
    let named = if quantity == Quantity::Other { unit.symbol() } else { quantity.name() };
    (comparable && motion != label).then(|| differs.name("unit", shown).name("quantity", named))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system(text: &str) -> Option<UnitSystem> {
        UnitSystem::read(&mut Stream::new(text.as_bytes()))
    }

    #[test]
    fn inch_and_pound_force() {
        let system = system(
            "         7Inch (pound f)               2\n  3.93700787401574814D+01  2.24808943099710489D-01  1.80000000000000000D+00\n  4.59670000000000000D+02\n",
        )
        .unwrap();
        // One inch is 0.0254 m by definition; the pound force of the file is exact to ten digits.
        for (file, si) in [
            ("m/s²", 0.0254),
            ("N", 4.448_221_615),
            ("(m/s²)/N", 0.0254 / 4.448_221_615),
            ("Pa", 4.448_221_615 / 0.0254f64.powi(2)),
            ("kg", 4.448_221_615 / 0.0254),
            ("K", 1.0 / 1.8),
            ("s", 1.0),
        ] {
            let factor = system.factor(Unit::parse(file).unwrap().dimension().unwrap());
            assert!((factor / si - 1.0).abs() < 1e-9, "{file}: {factor} against {si}");
        }
    }

    #[test]
    fn senseless_factors_are_no_system() {
        for text in
            ["", "1 SI\n", "1 SI\n1.0 1.0\n", "1 SI\n0.0 1.0 1.0\n", "1 SI\n-1.0 1.0 1.0\n", "1 SI\n    -1\n"]
        {
            if !text.is_empty() {
                assert_eq!(system(text), None, "{text:?}");
            }
        }
    }
}
