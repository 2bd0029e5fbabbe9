//! Code numbers of data set 58: function types and specific data types.

use vibro_record::units::{Dimension, Quantity, Unit};
use vibro_record::{AxisKind, Scaling};

/// Kind of record that a function type means over frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FunctionType {
    /// A ratio such as response over force: a frequency response function if complex, else a spectrum of
    /// unknown scaling.
    Ratio,
    /// A spectrum of this scaling.
    Scaled(Scaling),
    /// A spectrum of squares, peak or RMS.
    Squared,
    /// A spectrum of amplitudes, peak or RMS.
    Amplitude,
    /// None of these.
    Other,
}

use AxisKind::{Frequency, Time};
use FunctionType::{Amplitude, Other, Ratio, Scaled, Squared};

/// Function types of record 6 in their order, from 0: name, abscissa if only one is possible, and kind over
/// frequency.
const FUNCTIONS: &[(&str, Option<AxisKind>, FunctionType)] = &[
    ("general function", None, Other),
    ("time response", Some(Time), Other),
    ("auto spectrum", Some(Frequency), Squared),
    ("cross spectrum", Some(Frequency), Squared),
    ("frequency response function", Some(Frequency), Ratio),
    ("transmissibility", Some(Frequency), Ratio),
    ("coherence", Some(Frequency), Scaled(Scaling::Coherence)),
    ("auto correlation", Some(Time), Other),
    ("cross correlation", Some(Time), Other),
    ("power spectral density", Some(Frequency), Scaled(Scaling::Psd)),
    ("energy spectral density", Some(Frequency), Scaled(Scaling::Energy)),
    ("probability density function", None, Other),
    ("spectrum", Some(Frequency), Amplitude),
    ("cumulative frequency distribution", None, Other),
    ("peaks and valleys", None, Other),
    ("stress cycles", None, Other),
    ("strain cycles", None, Other),
    ("orbit", None, Other),
    ("mode indicator function", Some(Frequency), Other),
    ("force pattern", Some(Frequency), Other),
    ("partial power", Some(Frequency), Other),
    ("partial coherence", Some(Frequency), Scaled(Scaling::Coherence)),
    ("eigenvalue", None, Other),
    ("eigenvector", None, Other),
    ("shock response spectrum", Some(Frequency), Other),
    ("finite impulse response filter", Some(Time), Other),
    ("multiple coherence", Some(Frequency), Scaled(Scaling::Coherence)),
    ("order function", None, Other),
    ("phase compensation", None, Other),
];

/// Name, abscissa and kind of a function type.
pub fn function(code: i64) -> (String, Option<AxisKind>, FunctionType) {
    match usize::try_from(code).ok().and_then(|i| FUNCTIONS.get(i)) {
        Some((name, axis, kind)) => ((*name).to_owned(), axis.clone(), *kind),
        None => (format!("function of type {code}"), None, Other),
    }
}

/// Specific data types that name a physical quantity: code, name, SI unit of a translation and of a rotation.
const DATA_TYPES: &[(i64, &str, &str, &str)] = &[
    (2, "stress", "Pa", "Pa"),
    (3, "strain", "1", "1"),
    (5, "temperature", "K", "K"),
    (8, "displacement", "m", "rad"),
    (9, "reaction force", "N", "N*m"),
    (11, "velocity", "m/s", "rad/s"),
    (12, "acceleration", "m/s^2", "rad/s^2"),
    (13, "excitation force", "N", "N*m"),
    (15, "pressure", "Pa", "Pa"),
    (16, "mass", "kg", "kg*m^2"),
    (17, "time", "s", "s"),
    (18, "frequency", "Hz", "Hz"),
    // Not in the published list, but used by instruments.
    (21, "sound pressure", "Pa", "Pa"),
];

/// Name and dimension of a specific data type; `None` for unknown, general and unlisted ones.
pub fn data_type(code: i64, rotational: bool) -> Option<(&'static str, Dimension)> {
    let (_, name, along, about) = DATA_TYPES.iter().find(|t| t.0 == code)?;
    let unit = Unit::parse(if rotational { about } else { along })?;
    Some((name, unit.dimension()?))
}

/// The quantity that an axis label names, if one of its words is the name of a quantity.
pub fn quantity_of_label(label: &str) -> Option<Quantity> {
    label.split(|c: char| !c.is_alphabetic()).find_map(|word| match word.to_lowercase().as_str() {
        "compliance" => Some(Quantity::Receptance),
        "inertance" => Some(Quantity::Accelerance),
        word => Quantity::from_name(word),
    })
}

/// Names of the data sets that accompany data set 58 in files of measurements.
const SETS: &[(u32, &str)] = &[
    (15, "nodes"),
    (18, "coordinate systems"),
    (55, "data at nodes"),
    (82, "trace lines"),
    (151, "header"),
    (164, "units"),
    (1858, "qualifiers of data set 58"),
    (2411, "nodes"),
    (2412, "elements"),
    (2414, "analysis data"),
    (2420, "coordinate systems"),
    (2467, "groups"),
];

/// Count, number and, if known, name of data sets: `3 × 15 nodes`.
pub fn set_names((number, count): (u32, usize)) -> String {
    let times = if count > 1 { format!("{count} × ") } else { String::new() };
    let name = SETS.iter().find(|s| s.0 == number).map_or(String::new(), |s| format!(" {}", s.1));
    let used = if number == 164 { " (factors used)" } else { "" };
    format!("{times}{number}{name}{used}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn function_types_have_their_standard_numbers() {
        for (code, name) in [
            (0, "general function"),
            (1, "time response"),
            (4, "frequency response function"),
            (6, "coherence"),
            (9, "power spectral density"),
            (12, "spectrum"),
            (18, "mode indicator function"),
            (24, "shock response spectrum"),
            (27, "order function"),
            (99, "function of type 99"),
            (-1, "function of type -1"),
        ] {
            assert_eq!(function(code).0, name);
        }
    }

    #[test]
    fn data_types_have_the_dimensions_of_their_units() {
        for (code, along, about) in [
            (8, "m", "rad"),
            (11, "m/s", "rad/s"),
            (12, "m/s²", "rad/s²"),
            (13, "N", "N*m"),
            (15, "Pa", "Pa"),
            (16, "kg", "kg*m^2"),
            (17, "s", "s"),
            (18, "Hz", "Hz"),
        ] {
            for (unit, rotational) in [(along, false), (about, true)] {
                let dimension = Unit::parse(unit).unwrap().dimension().unwrap();
                assert_eq!(data_type(code, rotational).unwrap().1, dimension, "{code} {unit}");
            }
        }
        assert_eq!(data_type(0, false), None);
        assert_eq!(data_type(1, false), None);
    }

    #[test]
    fn labels_name_quantities_by_their_words() {
        assert_eq!(quantity_of_label("Vib  Displacement"), Some(Quantity::Displacement));
        assert_eq!(quantity_of_label("acc (g)"), None);
        assert_eq!(quantity_of_label("Dynamic Compliance"), Some(Quantity::Receptance));
    }
}
