//! Frequency response functions: response over excitation.

use super::{Axis, Meta};
use crate::units::Quantity;
use num_complex::Complex64;

/// What the response is, over a force; anything else is a transmissibility or has its own unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrfKind {
    /// Displacement over force, m/N.
    Receptance,
    /// Velocity over force, m/(N s).
    Mobility,
    /// Acceleration over force, 1/kg.
    Accelerance,
    /// Ratio of two equal quantities, or of anything else: see the unit.
    Other,
}

impl FrfKind {
    /// The kind that a unit's quantity implies.
    pub fn of(quantity: Quantity) -> FrfKind {
        match quantity {
            Quantity::Receptance => FrfKind::Receptance,
            Quantity::Mobility => FrfKind::Mobility,
            Quantity::Accelerance => FrfKind::Accelerance,
            _ => FrfKind::Other,
        }
    }
}

/// Frequency response function, complex, over frequency in Hz.
#[derive(Debug, Clone, PartialEq)]
pub struct Frf {
    /// Channel, unit, history.
    pub meta: Meta,
    /// Frequency in Hz.
    pub axis: Axis,
    /// Complex values in SI.
    pub values: Vec<Complex64>,
    /// Receptance, mobility, accelerance or other.
    pub kind: FrfKind,
}
