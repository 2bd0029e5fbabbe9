//! Values to records: which kind they are.

use crate::Options;
use vibro_record::units::{self, Unit};
use vibro_record::{
    Axis, AxisKind, Finding, Frf, FrfKind, Meta, Record, Result, Scaling, Spectrum, Trace, Values, Window,
};

/// What a file states of a spectrum.
#[derive(Debug, Clone, Default)]
pub struct Spectral {
    /// Scaling, where it is stated.
    pub scaling: Option<Scaling>,
    pub window: Option<Window>,
    pub enbw: Option<f64>,
    /// Whether complex values are stated to be a frequency response function.
    pub frf: bool,
    /// What to say where the scaling is not known, if not that the file is silent.
    pub doubt: Option<Finding>,
}

/// The record of values in SI units: a trace unless they stand over frequency, and a frequency response function where they
/// are complex and their unit is a ratio of response to force.
pub fn record(mut meta: Meta, axis: Axis, values: Values, said: Spectral) -> Record {
    let values = match values {
        Values::Real(values) if axis.kind != AxisKind::Frequency => {
            return Record::Trace(Trace { meta, axis, values });
        }
        Values::Complex(values)
            if said.frf || (said.scaling.is_none() && FrfKind::of(meta.quantity) != FrfKind::Other) =>
        {
            let kind = FrfKind::of(meta.quantity);
            return Record::Frf(Frf { meta, axis, values, kind });
        }
        values => values,
    };
    let scaling = said.scaling.unwrap_or(Scaling::Unknown);
    if scaling == Scaling::Unknown {
        meta.found(said.doubt.unwrap_or_else(|| Finding::caution("scaling-unsaid")));
    }
    Record::Spectrum(Spectrum { meta, axis, values, scaling, window: said.window, enbw: said.enbw })
}

/// A scaling by its name.
pub fn scaling(name: &str) -> Option<Scaling> {
    use Scaling::{Coherence, Energy, Peak, Power, Psd, Rms, Unknown};
    [Peak, Rms, Power, Psd, Energy, Coherence, Unknown].into_iter().find(|s| s.name() == name)
}

/// Multiplies values by the factor of their unit.
///
/// # Errors
/// If one becomes too large for a number.
pub fn to_si(values: &mut Values, factor: f64) -> Result<()> {
    if factor == 1.0 {
        return Ok(());
    }
    match values {
        Values::Real(values) => units::scale(values, factor),
        Values::Complex(values) => {
            units::scale(values.iter_mut().flat_map(|v| [&mut v.re, &mut v.im]), factor)
        }
    }
}

impl Options {
    /// Adopts the unit of values: what a person states, else what the file says. Returns the factor to SI.
    pub(crate) fn adopt(&self, meta: &mut Meta, said: Option<&str>) -> f64 {
        // A coherence beside a function has no unit, whatever that of the function is.
        let bare = said.is_none_or(|u| matches!(u.trim(), "" | "1"));
        if self.unit.is_some() && bare && meta.name.to_lowercase().contains("coherence") {
            return meta.adopt_unit("1");
        }
        if let Some(given) = &self.unit {
            if let Some(said) = said.filter(|u| Unit::parse_or_opaque(u) != *given) {
                let differs = Finding::caution("unit-overrides-file").name("file", said);
                meta.found(differs.name("used", given.symbol()));
            }
            return meta.adopt_unit(given.symbol());
        }
        if let Some(said) = said {
            return meta.adopt_unit(said);
        }
        meta.found(Finding::caution("unit-unsaid"));
        1.0
    }
}
