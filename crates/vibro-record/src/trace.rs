//! Samples over time.

use super::{Axis, Grid, Meta};
use crate::resample::evened;
use crate::units::{self, Unit};
use crate::{Error, Result};

/// Samples over time, or over their index where the file does not state its sampling.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Trace {
    /// Channel, unit, history.
    pub meta: Meta,
    /// Time in s, or an index.
    pub axis: Axis,
    /// Values in SI units; a missing sample is NaN, which occurs only where missing samples were allowed.
    pub values: Vec<f64>,
}

impl Trace {
    /// Sampling rate in Hz; `None` if the axis is uneven or not time.
    pub fn rate(&self) -> Option<f64> {
        matches!(self.axis.kind, super::AxisKind::Time).then(|| self.axis.step().map(|dt| 1.0 / dt)).flatten()
    }

    /// The sampling rate in Hz, for measurements that need one.
    ///
    /// # Errors
    /// If samples are uneven in time, or no rate is known.
    pub fn sampling_rate(&self) -> Result<f64> {
        self.rate().filter(|r| r.is_finite() && *r > 0.0).ok_or_else(|| {
            let name = &self.meta.name;
            let of = if name.is_empty() { String::new() } else { format!(" of channel {name:?}") };
            if let Grid::Uneven(instants) = &self.axis.grid {
                let found = format!("the samples{of} are unevenly spaced: they have no sampling rate");
                return evened(Error::refused(found), instants, self.meta.resolution);
            }
            Error::usage(format!("the sampling rate{of} is not known"), "")
                .hint("state the samples per second, or the base band of an analyser")
                .setting("rate")
                .setting("base_band")
        })
    }

    /// Code of the finding that the values are fractions of a recorder's full scale.
    pub const UNCALIBRATED: &str = "uncalibrated";

    /// Applies a calibration: a value v becomes `factor`·v in `unit`, stored in SI.
    ///
    /// The finding that no calibration is known is removed; all others, notes and steps stay, and a step
    /// `calibrate` is added. A negative factor inverts the signal.
    ///
    /// ```
    /// use vibro_record::{Axis, Meta, Trace};
    /// use vibro_record::units::Unit;
    /// let (meta, axis) = (Meta::new("laser", Unit::parse("V").unwrap()), Axis::time(0.0, 1e-3, 2));
    /// let mut trace = Trace { meta, axis, values: vec![0.0, 2.0] };
    /// trace.calibrate(125.0, &Unit::parse("mm/s").unwrap())?; // 125 mm/s a volt
    /// assert_eq!(trace.values[1], 0.25);
    /// assert_eq!(trace.meta.unit.symbol(), "m/s");
    /// # Ok::<(), vibro_record::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the factor is 0 or not finite, or makes a value too large for a double; earlier values have been
    /// multiplied by then.
    pub fn calibrate(&mut self, factor: f64, unit: &Unit) -> Result<()> {
        let to_si = factor * unit.factor();
        if to_si == 0.0 || !to_si.is_finite() {
            return Err(Error::usage(
                format!("a calibration factor of {factor} {unit}"),
                "a number that is not 0",
            ));
        }
        units::scale(&mut self.values, to_si)?;
        let from = std::mem::replace(&mut self.meta.unit, unit.si());
        self.meta.quantity = self.meta.unit.quantity();
        self.meta.findings.retain(|found| found.code != Trace::UNCALIBRATED);
        self.meta.step("calibrate", &[("factor", &factor), ("unit", unit), ("from", &from)]);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Finding;
    use crate::units::Quantity;

    fn trace() -> Trace {
        let mut meta = Meta::new("a", Unit::opaque("FS"));
        meta.found(Finding::caution("uncalibrated"));
        meta.found(Finding::caution("x"));
        meta.step("read", &[]);
        Trace { meta, axis: Axis::time(0.0, 0.1, 2), values: vec![0.5, f64::NAN] }
    }

    #[test]
    fn a_calibration_leaves_its_step_and_takes_only_its_doubt() {
        let mut t = trace();
        t.calibrate(-40.0, &Unit::parse("mm/s").unwrap()).unwrap();
        // 0.5 · 40 mm/s = 20 mm/s; the product has two rounding errors.
        assert!((t.values[0] + 0.02).abs() < 1e-17);
        assert!(t.values[1].is_nan());
        assert_eq!((t.meta.quantity, t.meta.unit.symbol()), (Quantity::Velocity, "m/s"));
        assert_eq!(t.meta.findings, [Finding::caution("x")]);
        assert_eq!(t.meta.history.len(), 2);
        assert_eq!(t.meta.history[1].arguments[1], ("unit".to_owned(), "mm/s".to_owned()));
    }

    #[test]
    fn a_factor_that_loses_the_signal_is_refused() {
        for factor in [0.0, f64::NAN, f64::INFINITY] {
            let mut t = trace();
            assert!(t.calibrate(factor, &Unit::opaque("FS")).is_err());
            assert_eq!(t.values[0], 0.5);
        }
        // First the factor alone is too large for a double, then only the product.
        assert!(trace().calibrate(1e306, &Unit::parse("km").unwrap()).is_err());
        let mut t = trace();
        t.values[0] = 1e10;
        let error = t.calibrate(1e300, &Unit::parse("m").unwrap()).unwrap_err().to_string();
        assert!(error.contains("the value 1e10"), "{error}");
    }
}
