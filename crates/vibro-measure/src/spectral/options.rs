//! Options of spectra and frequency response functions.

use serde::Deserialize;
use vibro_record::{Error, Result, Scaling, Window};
use vibro_signal::transfer::Estimator;

/// One transform, or the average of many.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// One transform of the whole record.
    Fft,
    /// Average over segments (Welch 1967).
    #[default]
    Welch,
}

/// Options of a spectrum or a frequency response function; options not stated take their defaults.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SpectralOptions {
    /// Method. Default: Welch; one transform where tones are wanted.
    pub method: Option<Method>,
    /// Samples of a segment. Default: 8192, or the whole of a shorter record.
    pub segment: Option<usize>,
    /// Overlap of segments, over their length. Default: 0.5.
    pub overlap: Option<f64>,
    /// Whether the mean is subtracted. Default: from segments, and where integrated.
    pub detrend: Option<bool>,
    /// Window. Default: Hann.
    pub window: Option<Window>,
    /// Peak, RMS, power or density. Default: peak.
    pub scaling: Option<Scaling>,
    /// Integrations in frequency, −2 to 2.
    pub integrate: i8,
    /// Lowest frequency in Hz. Default: two lines where integrated, else 0.
    pub fmin: Option<f64>,
    /// Estimator of the frequency response function from the first channel to the second; `None` for a
    /// spectrum.
    pub estimator: Option<Estimator>,
    /// Whether the first channel is the force of a hammer: one record of `segment` samples a blow.
    pub hammer: bool,
    /// Width of the force window in s. Default: ten contact times, at least 64 samples.
    pub force_window: Option<f64>,
    /// Value of the exponential window on the response at the end of a record; it is 1 at the beginning.
    pub left_at_end: Option<f64>,
    /// Delay in s of the recorded response, such as of a vibrometer's decoder; its phase is corrected.
    pub delay: Option<f64>,
    /// Reference of levels in decibels, in the unit of the trace (of the function, with a reference
    /// channel).
    pub decibel: Option<f64>,
    /// Number of sines to fit to the whole record, 1 to 10.
    pub tones: Option<usize>,
}

impl SpectralOptions {
    /// The method, stated or by default.
    pub fn method(&self) -> Method {
        self.method.unwrap_or(if self.tones.is_some() { Method::Fft } else { Method::Welch })
    }

    /// The window, stated or by default.
    pub(super) fn window(&self) -> Window {
        self.window.unwrap_or(Window::Hann)
    }

    /// Whether the mean is subtracted. By default it is from segments, and where integration would divide it
    /// by 0 Hz.
    pub(super) fn detrended(&self) -> bool {
        self.detrend.unwrap_or(self.method() == Method::Welch || self.integrate > 0)
    }

    /// Lowest frequency in Hz for lines `step` apart. By default two lines where integrated, since
    /// integration divides noise by the frequency.
    pub(super) fn lowest(&self, step: f64) -> f64 {
        self.fmin.unwrap_or(if self.integrate > 0 { 2.0 * step } else { 0.0 })
    }

    /// Names of the options given that may contradict another one.
    fn given(&self) -> impl Iterator<Item = &'static str> {
        let all = [
            ("method", self.method.is_some()),
            ("reference", self.estimator.is_some()),
            ("segment", self.segment.is_some()),
            ("overlap", self.overlap.is_some()),
            ("window", self.window.is_some()),
            ("detrend", self.detrend.is_some()),
            ("integrate", self.integrate != 0),
            ("fmin", self.fmin.is_some()),
            ("scaling", self.scaling.is_some()),
            ("hammer", self.hammer),
            ("force_window", self.force_window.is_some()),
            ("left_at_end", self.left_at_end.is_some()),
            ("delay", self.delay.is_some()),
        ];
        all.into_iter().filter(|(_, given)| *given).map(|(name, _)| name)
    }

    /// Name of the first option given that may contradict another one.
    pub fn first(&self) -> Option<&'static str> {
        self.given().next()
    }

    /// Checks that no option contradicts another.
    ///
    /// # Errors
    /// Names the option, and what it contradicts or which values are possible.
    pub fn check(&self) -> Result<()> {
        let (tones, function) = (self.tones.is_some(), self.estimator.is_some());
        let whole = "the whole record of one channel as it is";
        let rules: [(bool, &[&str], &str, &str); 8] = [
            (tones && self.method == Some(Method::Welch), &["method"], "with tones", whole),
            (tones, &["reference", "segment", "overlap", "integrate"], "with tones", whole),
            (
                self.method() == Method::Fft,
                &["segment", "overlap", "reference"],
                "with method fft",
                "method welch, or the whole record of one channel",
            ),
            (
                self.hammer,
                &["window", "overlap", "method", "detrend"],
                "with a hammer",
                "the hammer's own windows alone",
            ),
            (!self.hammer, &["force_window", "left_at_end"], "without a hammer", "hammer = true, too"),
            (!function, &["hammer"], "without a reference", "the force channel as reference"),
            (!function, &["delay"], "without a reference", "two channels that are compared"),
            (function, &["scaling"], "with a reference", "a function has no scaling"),
        ];
        for (holds, names, with, expected) in rules {
            if let Some(name) = self.given().find(|name| holds && names.contains(name)) {
                let error = Error::usage(format!("{name} {with}"), expected).setting(name);
                return Err(if tones { error.hint(format!("leave out the {name}")) } else { error });
            }
        }
        let wrong = |v: &f64| !(v.is_finite() && *v > 0.0);
        let numbers = [
            ("delay", self.delay.filter(|v| !v.is_finite()), "seconds"),
            ("decibel", self.decibel.filter(wrong), "a reference above 0, such as 1e-6"),
            ("integrate", Some(f64::from(self.integrate)).filter(|times| times.abs() > 2.0), "-2 to 2"),
            ("fmin", self.fmin.filter(wrong), "a finite number above 0"),
        ];
        if let Some((name, Some(value), expected)) = numbers.into_iter().find(|n| n.1.is_some()) {
            return Err(Error::usage(format!("{name} = {value}"), expected).setting(name));
        }
        match self.scaling {
            None | Some(Scaling::Peak | Scaling::Rms | Scaling::Power | Scaling::Psd) => Ok(()),
            Some(other) => {
                let found = format!("scaling = {}", other.name());
                Err(Error::usage(found, "peak, rms, power or psd").setting("scaling"))
            }
        }
    }
}
