//! Settings with which an analyser stored spectra, where its files do not state them.

use crate::campaign::above_zero;
use crate::error::{Error, Result};
use crate::read::SweepReader;
use crate::record::{Kind, Scaling, Window};
use crate::units::{Quantity, Unit};

/// Quantities of a response that an analyser stores.
pub(crate) const MOTION: [Quantity; 3] = [Quantity::Displacement, Quantity::Velocity, Quantity::Acceleration];

/// Stated settings of stored responses.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct StoredResponseKeys {
    /// Unit of the stored responses [default: what the files say, else the SI unit of the quantity, m where
    /// none is stated]
    pub unit: Option<String>,
    /// Factor on the stored responses
    pub calibration: Option<f64>,
    /// Window of the analyser: hann, rectangular, hamming, blackman, blackman-harris, flat-top, unknown
    /// [default: hann, assumed]
    pub window: Option<String>,
    /// Scaling of the spectra: peak or rms [default: peak, assumed]
    #[cfg_attr(feature = "cli", arg(value_parser = stored_scaling))]
    pub scaling: Option<Scaling>,
    /// How often the analyser integrated before it stored, 0 to 2 [default: once for a displacement]
    #[cfg_attr(feature = "cli", arg(value_parser = crate::record::kind::whole::<u8, 0, 2>))]
    pub analyser_integrated: Option<u8>,
}

/// The scaling of stored lines.
fn stored_scaling(name: &str) -> std::result::Result<Scaling, Kind> {
    let known =
        crate::campaign::word(name).ok().filter(|scaling| [Scaling::Peak, Scaling::Rms].contains(scaling));
    known.ok_or(Kind::Names(&["peak", "rms"]))
}

impl StoredResponseKeys {
    /// Applies these settings to a reader.
    ///
    /// # Errors
    /// If a name is unknown, a number is impossible, or the unit does not fit the stored quantity.
    pub fn apply(&self, reader: &mut SweepReader) -> Result<()> {
        if let Some(text) = &self.unit {
            let unit = Unit::parse_or_opaque(text);
            let of = unit.quantity();
            let stated = reader.quantity.or(reader.unit.as_ref().map(Unit::quantity));
            if !MOTION.contains(&of) || stated.is_some_and(|q| q != of) {
                let expected = match stated {
                    Some(Quantity::Displacement) => "a unit of displacement, such as m, mm or µm",
                    Some(Quantity::Velocity) => "a unit of velocity, such as m/s or mm/s",
                    Some(Quantity::Acceleration) => "a unit of acceleration, such as m/s², mm/s² or g",
                    _ => "a unit of displacement, velocity or acceleration, such as mm, mm/s or g",
                };
                let known = of != Quantity::Other;
                let what = if known { format!("one of {of}") } else { "not known".to_owned() };
                let found = format!("the unit {text:?} is {what}");
                return Err(Error::usage(found, expected).setting("unit"));
            }
            reader.unit = Some(unit);
        }
        above_zero("calibration", self.calibration)?;
        reader.calibration = self.calibration.or(reader.calibration);
        if let Some(name) = &self.window {
            let window = Window::from_name(name);
            if window.is_none() && !name.eq_ignore_ascii_case("unknown") {
                let names: Vec<_> = Window::ALL.iter().map(|w| w.name()).collect();
                let expected = format!("{} or unknown", names.join(", "));
                return Err(
                    Error::usage(format!("the window {name:?} is not known"), expected).setting("window")
                );
            }
            reader.window = Some(window);
        }
        if let Some(scaling) = self.scaling {
            if !matches!(scaling, Scaling::Peak | Scaling::Rms) {
                let found = format!("scaling = {}", scaling.name());
                return Err(Error::usage(found, "peak or rms").setting("scaling"));
            }
            reader.scaling = Some(scaling);
        }
        if let Some(many) = self.analyser_integrated.filter(|n| *n > 2) {
            let found = format!("analyser_integrated = {many}");
            return Err(Error::usage(found, "0, 1 or 2").setting("analyser_integrated"));
        }
        reader.analyser_integrated = self.analyser_integrated.or(reader.analyser_integrated);
        Ok(())
    }
}
