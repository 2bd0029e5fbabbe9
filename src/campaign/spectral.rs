//! Spectra and functions of two channels of a campaign: from keys to options.

use super::{Detrend, FrfEntry, SpectrumEntry};
use crate::measure::spectral::SpectralOptions;
use crate::record::Window;
use crate::signal::transfer::Estimator;

fn mean(detrend: Detrend) -> bool {
    detrend == Detrend::Mean
}

/// The window of a name, or a sentence.
fn window(name: Option<&str>) -> Result<Option<Window>, String> {
    let known = |name: &str| {
        let names = || Window::ALL.iter().map(|w| w.name()).collect::<Vec<_>>().join(", ");
        Window::from_name(name).ok_or_else(|| format!("window = {name:?} is not one of {}", names()))
    };
    name.map(known).transpose()
}

impl SpectrumEntry {
    /// How the spectrum is taken, or what cannot be.
    ///
    /// # Errors
    /// A sentence on keys that contradict each other or cannot be.
    pub fn options(&self) -> Result<SpectralOptions, String> {
        if self.estimator.is_some() && self.reference.is_none() {
            return Err("estimator without a reference".to_owned());
        }
        let options = SpectralOptions {
            method: self.method,
            segment: self.segment,
            overlap: self.overlap,
            detrend: self.detrend.map(mean),
            window: window(self.window.as_deref())?,
            scaling: self.scaling,
            integrate: self.integrate.unwrap_or(0),
            fmin: self.fmin,
            estimator: self.reference.as_ref().map(|_| self.estimator.unwrap_or(Estimator::H1)),
            hammer: self.hammer,
            force_window: self.force_window,
            left_at_end: self.left_at_end,
            delay: self.delay,
            decibel: self.decibel,
            tones: self.tones,
        };
        options.check().map_err(|e| e.to_string())?;
        Ok(options)
    }
}

impl FrfEntry {
    /// How the function is taken from two channels; `None` where the file holds the function.
    ///
    /// # Errors
    /// A sentence on keys that contradict each other or cannot be.
    pub fn options(&self) -> Result<Option<SpectralOptions>, String> {
        if self.reference.is_none() {
            let given = [
                ("estimator", self.estimator.is_some()),
                ("segment", self.segment.is_some()),
                ("overlap", self.overlap.is_some()),
                ("detrend", self.detrend.is_some()),
                ("window", self.window.is_some()),
                ("integrate", self.integrate.is_some()),
                ("fmin", self.fmin.is_some()),
                ("hammer", self.hammer),
                ("force_window", self.force_window.is_some()),
                ("left_at_end", self.left_at_end.is_some()),
                ("delay", self.delay.is_some()),
            ];
            return match given.iter().find(|(_, given)| *given) {
                Some((key, _)) => Err(format!(
                    "{key} without a reference: [[frf]] takes the function from two channels only where reference names that of the excitation"
                )),
                None => Ok(None),
            };
        }
        if self.coherence.is_some() {
            return Err("coherence beside a reference, from which it follows".to_owned());
        }
        let options = SpectralOptions {
            segment: self.segment,
            overlap: self.overlap,
            detrend: self.detrend.map(mean),
            window: window(self.window.as_deref())?,
            integrate: self.integrate.unwrap_or(0),
            fmin: self.fmin,
            estimator: Some(self.estimator.unwrap_or(Estimator::H1)),
            hammer: self.hammer,
            force_window: self.force_window,
            left_at_end: self.left_at_end,
            delay: self.delay,
            ..SpectralOptions::default()
        };
        options.check().map_err(|e| e.to_string())?;
        Ok(Some(options))
    }
}
