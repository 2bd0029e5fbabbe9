//! Physical units: the spelling that an instrument wrote, and the factor that converts it to SI.
//!
//! Records hold SI values only. A reader parses the instrument's unit text with [`Unit::parse`], multiplies
//! by [`Unit::factor`] and stores [`Unit::si`]. A text that is not understood is kept as an opaque unit with
//! factor 1 and a doubt in the record; it is never guessed.
//!
//! In this field `g` is the standard acceleration of gravity, never the gram.

pub mod notation;
mod parse;
mod quantity;

use crate::{Error, Result};
pub use parse::spelled;
pub use quantity::Quantity;

/// Exponents of m, kg, s, A, K and rad, doubled so that `√Hz` is a whole number.
///
/// The angle is a base unit here, though SI counts it as a number: else rad/s would be Hz, wrong by 2π.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
pub struct Dimension(pub [i8; 6]);

impl Dimension {
    /// No dimension: ratios, coherence.
    pub const NONE: Dimension = Dimension([0; 6]);

    /// Product of two quantities' dimensions.
    pub fn times(self, other: Dimension) -> Dimension {
        Dimension(std::array::from_fn(|i| self.0[i].saturating_add(other.0[i])))
    }

    /// Reciprocal.
    pub fn inverse(self) -> Dimension {
        Dimension(self.0.map(i8::saturating_neg))
    }

    /// Dimension to the power `halves / 2`; `None` where an exponent would not be a multiple of one half.
    pub fn half_power(self, halves: i8) -> Option<Dimension> {
        let mut out = [0; 6];
        for (o, e) in out.iter_mut().zip(self.0) {
            let product = i16::from(e) * i16::from(halves);
            *o = i8::try_from(product / 2).ok().filter(|_| product % 2 == 0)?;
        }
        Some(Dimension(out))
    }
}

/// A unit: spelling, dimension and factor to SI.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Unit {
    symbol: String,
    dimension: Option<Dimension>,
    factor: f64,
}

/// Whether a word is a unit of levels in decibels, such as `dBV` or `decibel`.
pub fn is_level(word: &str) -> bool {
    let word = word.trim().to_lowercase();
    word.starts_with("db") || word.starts_with("decibel")
}

impl Unit {
    /// The dimensionless unit 1.
    pub fn none() -> Unit {
        Unit { symbol: "1".into(), dimension: Some(Dimension::NONE), factor: 1.0 }
    }

    /// The SI unit of a quantity; [`Quantity::Other`] gives an opaque empty unit.
    pub fn of(quantity: Quantity) -> Unit {
        quantity.dimension().map_or_else(|| Unit::opaque(""), Unit::from_dimension)
    }

    /// A unit that is not understood: kept as written, factor 1, quantity [`Quantity::Other`].
    pub fn opaque(symbol: &str) -> Unit {
        Unit { symbol: symbol.trim().into(), dimension: None, factor: 1.0 }
    }

    /// Reads a unit such as `mm/s`, `m/s²`, `(m/s^2)/N`, `g²/Hz`, `m/s/√Hz`, `[µm]`.
    ///
    /// Returns `None` where any part of the text is not known.
    ///
    /// ```
    /// use vibro_record::units::{Quantity, Unit};
    /// let unit = Unit::parse("[mm/s]").unwrap();
    /// assert_eq!(unit.factor(), 1e-3);
    /// assert_eq!(unit.quantity(), Quantity::Velocity);
    /// assert_eq!(unit.si().symbol(), "m/s");
    /// assert!(Unit::parse("furlong").is_none());
    /// ```
    pub fn parse(text: &str) -> Option<Unit> {
        let (dimension, factor) = parse::parse(text)?;
        Some(Unit { symbol: text.trim().trim_matches(['[', ']']).into(), dimension: Some(dimension), factor })
    }

    /// Reads a unit; one that is not understood is kept as opaque.
    pub fn parse_or_opaque(text: &str) -> Unit {
        Unit::parse(text).unwrap_or_else(|| Unit::opaque(text))
    }

    /// Reads a unit, or a unit of levels whose reference is a unit, such as `dB re 1 g`.
    pub fn parse_or_level(text: &str) -> Option<Unit> {
        Unit::parse(text).or_else(|| Some(Unit::opaque(text)).filter(|unit| unit.reference().is_some()))
    }

    /// Value at 0 dB of a unit of levels that states this reference, if it is an amplitude or a power
    /// density; else `None`.
    ///
    /// ```
    /// use vibro_record::units::Unit;
    /// let reference = |text| Unit::parse_or_opaque(text).reference().map(|unit| unit.factor());
    /// assert_eq!(reference("dB re 1e-6 m/s²"), Some(1e-6));
    /// assert_eq!(reference("dB re g"), Some(9.80665));
    /// assert_eq!(reference("dB re 1 pW"), None);
    /// assert_eq!(reference("dB"), None);
    /// ```
    pub fn reference(&self) -> Option<Unit> {
        let (_, reference) = self.symbol.split_once(" re ").filter(|_| self.is_level())?;
        let unit = Unit::parse(reference).or_else(|| Unit::parse(&format!("1 {reference}")))?;
        // For a watt, a square or another product it is unknown whether 10 dB or 20 dB are a factor of ten.
        (unit.quantity() != Quantity::Other || unit.symbol().ends_with("/Hz")).then_some(unit)
    }

    /// Text of the unit.
    pub fn symbol(&self) -> &str {
        &self.symbol
    }

    /// Factor that converts a value in this unit to SI.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Whether the unit was understood.
    pub fn is_known(&self) -> bool {
        self.dimension.is_some()
    }

    /// Whether it is a unit of levels, such as `dB re 1 m/s²`: values in it are not amplitudes.
    pub fn is_level(&self) -> bool {
        !self.is_known() && is_level(self.symbol())
    }

    /// Dimension; `None` for an opaque unit.
    pub fn dimension(&self) -> Option<Dimension> {
        self.dimension
    }

    /// Factor that converts a value in this unit to Hz. For an angular velocity it includes 1/(2π); `None`
    /// for quantities other than frequency and angular velocity.
    ///
    /// ```
    /// use vibro_record::units::Unit;
    /// assert_eq!(Unit::parse("kHz").unwrap().hertz(), Some(1e3));
    /// assert_eq!(Unit::parse("rad/s").unwrap().hertz(), Some(0.5 / std::f64::consts::PI));
    /// assert_eq!(Unit::parse("s").unwrap().hertz(), None);
    /// ```
    pub fn hertz(&self) -> Option<f64> {
        match self.quantity() {
            Quantity::Frequency => Some(self.factor),
            Quantity::AngularVelocity => Some(self.factor / std::f64::consts::TAU),
            _ => None,
        }
    }

    /// Quantity that this unit measures.
    pub fn quantity(&self) -> Quantity {
        self.dimension.map_or(Quantity::Other, Quantity::of)
    }

    /// The SI unit of the same dimension, in the spelling usual for its quantity.
    pub fn si(&self) -> Unit {
        let Some(dimension) = self.dimension else { return self.clone() };
        let symbol = match Quantity::of(dimension) {
            Quantity::Other => parse::spell(dimension),
            named => named.symbol().to_owned(),
        };
        Unit { symbol, dimension: self.dimension, factor: 1.0 }
    }

    /// SI unit from a dimension, for results of multiplication and division.
    pub fn from_dimension(dimension: Dimension) -> Unit {
        Unit { symbol: String::new(), dimension: Some(dimension), factor: 1.0 }.si()
    }

    /// SI unit of this unit multiplied by `s^power` (integration in time is `power = 1`).
    pub fn times_seconds(&self, power: i8) -> Unit {
        match self.dimension {
            Some(d) => Unit::from_dimension(d.times(Dimension([0, 0, power.saturating_mul(2), 0, 0, 0]))),
            None => Unit::opaque(&format!("{}·s^{power}", self.symbol)),
        }
    }
}

impl std::fmt::Display for Unit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(&self.symbol)
    }
}

/// Multiplies values by a factor to SI; missing values (NaN) stay missing.
///
/// # Errors
/// If a product is too large for a double; the values before it have been multiplied by then.
pub fn scale<'a>(values: impl IntoIterator<Item = &'a mut f64>, factor: f64) -> Result<()> {
    for value in values {
        let product = *value * factor;
        if product.is_infinite() {
            let found =
                format!("the value {value:e} is beyond all numbers when it is multiplied by {factor:e}");
            return Err(Error::usage(found, "values that a number can hold in SI units")
                .hint("check the unit and the exponent of this value"));
        }
        *value = product;
    }
    Ok(())
}

/// Level in decibels of an amplitude against a reference amplitude of the same unit: 20 lg(value/reference).
///
/// A value of zero gives −∞; callers limit it when they draw.
pub fn decibel(value: f64, reference: f64) -> f64 {
    20.0 * (value / reference).abs().log10()
}
