//! Physical quantities.

use super::Dimension;

/// Quantities that this toolkit knows by name, with their units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Quantity {
    /// m
    Displacement,
    /// m/s
    Velocity,
    /// m/s²
    Acceleration,
    /// m/s³
    Jerk,
    /// N
    Force,
    /// N s
    Impulse,
    /// kg
    Mass,
    /// N/m
    Stiffness,
    /// V
    Voltage,
    /// Pa
    Pressure,
    /// T
    FluxDensity,
    /// s
    Time,
    /// Hz
    Frequency,
    /// 1: ratios, coherence
    Ratio,
    /// rad
    Angle,
    /// rad/s: 2π times a frequency, never read as a frequency
    AngularVelocity,
    /// rad/s²
    AngularAcceleration,
    /// m/N
    Receptance,
    /// m/(N s)
    Mobility,
    /// 1/kg, that is (m/s²)/N
    Accelerance,
    /// Any other; see the unit.
    Other,
}

type Entry = (Quantity, &'static str, &'static str, [i8; 6]);

/// One table for names, SI spellings and dimensions (exponents of m, kg, s, A, K, rad; not doubled).
const TABLE: &[Entry] = &[
    (Quantity::Displacement, "displacement", "m", [1, 0, 0, 0, 0, 0]),
    (Quantity::Velocity, "velocity", "m/s", [1, 0, -1, 0, 0, 0]),
    (Quantity::Acceleration, "acceleration", "m/s²", [1, 0, -2, 0, 0, 0]),
    (Quantity::Jerk, "jerk", "m/s³", [1, 0, -3, 0, 0, 0]),
    (Quantity::Force, "force", "N", [1, 1, -2, 0, 0, 0]),
    (Quantity::Impulse, "impulse", "N s", [1, 1, -1, 0, 0, 0]),
    (Quantity::Mass, "mass", "kg", [0, 1, 0, 0, 0, 0]),
    (Quantity::Stiffness, "stiffness", "N/m", [0, 1, -2, 0, 0, 0]),
    (Quantity::Voltage, "voltage", "V", [2, 1, -3, -1, 0, 0]),
    (Quantity::Pressure, "pressure", "Pa", [-1, 1, -2, 0, 0, 0]),
    (Quantity::FluxDensity, "magnetic flux density", "T", [0, 1, -2, -1, 0, 0]),
    (Quantity::Time, "time", "s", [0, 0, 1, 0, 0, 0]),
    (Quantity::Frequency, "frequency", "Hz", [0, 0, -1, 0, 0, 0]),
    (Quantity::Ratio, "ratio", "1", [0, 0, 0, 0, 0, 0]),
    (Quantity::Angle, "angle", "rad", [0, 0, 0, 0, 0, 1]),
    (Quantity::AngularVelocity, "angular velocity", "rad/s", [0, 0, -1, 0, 0, 1]),
    (Quantity::AngularAcceleration, "angular acceleration", "rad/s²", [0, 0, -2, 0, 0, 1]),
    (Quantity::Receptance, "receptance", "m/N", [0, -1, 2, 0, 0, 0]),
    (Quantity::Mobility, "mobility", "(m/s)/N", [0, -1, 1, 0, 0, 0]),
    (Quantity::Accelerance, "accelerance", "(m/s²)/N", [0, -1, 0, 0, 0, 0]),
];

impl Quantity {
    /// The quantity of a dimension; [`Quantity::Other`] where the table has no such dimension.
    pub fn of(dimension: Dimension) -> Quantity {
        TABLE.iter().find(|e| doubled(e.3) == dimension).map_or(Quantity::Other, |e| e.0)
    }

    fn entry(self) -> Option<&'static Entry> {
        TABLE.iter().find(|e| e.0 == self)
    }

    /// Name, as in JSON.
    pub fn name(self) -> &'static str {
        self.entry().map_or("other", |e| e.1)
    }

    /// Symbol of the SI unit; empty where there is none.
    pub fn symbol(self) -> &'static str {
        self.entry().map_or("", |e| e.2)
    }

    /// Whether it is the quantity of a frequency response function: motion over force.
    pub fn is_function(self) -> bool {
        matches!(self, Quantity::Receptance | Quantity::Mobility | Quantity::Accelerance)
    }

    /// The quantity with this name, ignoring case and surrounding blanks.
    pub fn from_name(name: &str) -> Option<Quantity> {
        let name = name.trim().to_lowercase();
        TABLE.iter().find(|e| e.1 == name).map(|e| e.0)
    }

    pub(super) fn dimension(self) -> Option<Dimension> {
        self.entry().map(|e| doubled(e.3))
    }
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

fn doubled(exponents: [i8; 6]) -> Dimension {
    Dimension(exponents.map(|e| 2 * e))
}
