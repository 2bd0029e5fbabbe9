//! Code numbers of data set 58: function types and specific data types.

use vibro_record::units::{Dimension, Quantity};

/// What a function type says of the record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Domain {
    /// Stands over time.
    Time,
    /// Stands over frequency.
    Frequency,
    /// Only the abscissa can tell.
    Either,
}

/// Function types of record 6 in their order, from 0.
const FUNCTIONS: &[(&str, Domain)] = &[
    ("general function", Domain::Either),
    ("time response", Domain::Time),
    ("auto spectrum", Domain::Frequency),
    ("cross spectrum", Domain::Frequency),
    ("frequency response function", Domain::Frequency),
    ("transmissibility", Domain::Frequency),
    ("coherence", Domain::Frequency),
    ("auto correlation", Domain::Time),
    ("cross correlation", Domain::Time),
    ("power spectral density", Domain::Frequency),
    ("energy spectral density", Domain::Frequency),
    ("probability density function", Domain::Either),
    ("spectrum", Domain::Frequency),
    ("cumulative frequency distribution", Domain::Either),
    ("peaks and valleys", Domain::Either),
    ("stress cycles", Domain::Either),
    ("strain cycles", Domain::Either),
    ("orbit", Domain::Either),
    ("mode indicator function", Domain::Frequency),
    ("force pattern", Domain::Frequency),
    ("partial power", Domain::Frequency),
    ("partial coherence", Domain::Frequency),
    ("eigenvalue", Domain::Either),
    ("eigenvector", Domain::Either),
    ("shock response spectrum", Domain::Frequency),
    ("finite impulse response filter", Domain::Time),
    ("multiple coherence", Domain::Frequency),
    ("order function", Domain::Either),
    ("phase compensation", Domain::Either),
];

/// A function type by its number.
pub fn function(code: i64) -> (String, Domain) {
    match usize::try_from(code).ok().and_then(|i| FUNCTIONS.get(i)) {
        Some((name, domain)) => ((*name).to_owned(), *domain),
        None => (format!("function of type {code}"), Domain::Either),
    }
}

/// Specific data types that name a physical quantity: code, name, exponents of m, kg, s, A, K, rad along an axis and about it.
const DATA_TYPES: &[(i64, &str, [i8; 6], [i8; 6])] = &[
    (2, "stress", [-1, 1, -2, 0, 0, 0], [-1, 1, -2, 0, 0, 0]),
    (3, "strain", [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]),
    (5, "temperature", [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 1, 0]),
    (8, "displacement", [1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 1]),
    (9, "reaction force", [1, 1, -2, 0, 0, 0], [2, 1, -2, 0, 0, 0]),
    (11, "velocity", [1, 0, -1, 0, 0, 0], [0, 0, -1, 0, 0, 1]),
    (12, "acceleration", [1, 0, -2, 0, 0, 0], [0, 0, -2, 0, 0, 1]),
    (13, "excitation force", [1, 1, -2, 0, 0, 0], [2, 1, -2, 0, 0, 0]),
    (15, "pressure", [-1, 1, -2, 0, 0, 0], [-1, 1, -2, 0, 0, 0]),
    (16, "mass", [0, 1, 0, 0, 0, 0], [2, 1, 0, 0, 0, 0]),
    (17, "time", [0, 0, 1, 0, 0, 0], [0, 0, 1, 0, 0, 0]),
    (18, "frequency", [0, 0, -1, 0, 0, 0], [0, 0, -1, 0, 0, 0]),
    // Behind the published list, but written by instruments.
    (21, "sound pressure", [-1, 1, -2, 0, 0, 0], [-1, 1, -2, 0, 0, 0]),
];

/// Name and dimension of a specific data type; `None` for unknown, general and unlisted ones.
pub(crate) fn data_type(code: i64, rotational: bool) -> Option<(&'static str, Dimension)> {
    let (_, name, along, about) = DATA_TYPES.iter().find(|t| t.0 == code)?;
    let exponents = if rotational { about } else { along };
    Some((name, Dimension(exponents.map(|e| 2 * e))))
}

/// Label words of frequency response functions, beside the names of [`Quantity`].
const FRF_WORDS: &[(&str, Quantity)] =
    &[("compliance", Quantity::Receptance), ("inertance", Quantity::Accelerance)];

/// The quantity an axis label names, where one of its words is the name of one.
pub(crate) fn quantity_of_label(label: &str) -> Option<Quantity> {
    label.split(|c: char| !c.is_alphabetic()).find_map(|word| {
        let word = word.to_lowercase();
        Quantity::from_name(&word).or_else(|| FRF_WORDS.iter().find(|w| w.0 == word).map(|w| w.1))
    })
}

/// Names of the data sets that stand around data set 58 in files of measurements.
const SETS: &[(u32, &str)] = &[
    (15, "nodes"),
    (18, "coordinate systems"),
    (55, "data at nodes"),
    (56, "data at element centres"),
    (57, "data at nodes of elements"),
    (58, "functions"),
    (82, "trace lines"),
    (151, "header"),
    (164, "units"),
    (217, "function usage"),
    (252, "matrices"),
    (259, "entity names"),
    (780, "elements"),
    (781, "nodes"),
    (1858, "qualifiers of data set 58"),
    (2400, "model header"),
    (2411, "nodes"),
    (2412, "elements"),
    (2414, "analysis data"),
    (2420, "coordinate systems"),
    (2429, "groups"),
    (2431, "trace lines"),
    (2435, "groups"),
    (2452, "groups"),
    (2467, "groups"),
    (2477, "groups"),
];

/// `15 nodes`: the number of a data set with its plain name, where it has one.
pub(crate) fn set_name(number: u32) -> String {
    match SETS.iter().find(|s| s.0 == number) {
        Some((_, name)) => format!("{number} {name}"),
        None => number.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_record::units::Unit;

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
