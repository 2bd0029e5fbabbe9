//! How a spectrum or a frequency response function is taken.

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

/// What is left open takes its default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SpectralOptions {
    /// Default: Welch; one transform where tones are wanted.
    pub method: Option<Method>,
    /// Samples of a segment. Default: 8192, or the whole of a shorter record.
    pub segment: Option<usize>,
    /// Part of a segment that it shares with the next. Default: 0.5.
    pub overlap: Option<f64>,
    /// Whether the mean is taken out. Default: of segments, and where integrated.
    pub detrend: Option<bool>,
    /// Default: Hann.
    pub window: Option<Window>,
    /// Peak, RMS, power or density. Default: peak.
    pub scaling: Option<Scaling>,
    /// Integrations in frequency, −2 to 2.
    pub integrate: i8,
    /// Lowest frequency in Hz. Default: two lines where integrated, else 0.
    pub fmin: Option<f64>,
    /// The function from the first channel to the second, by this estimator; `None` for a spectrum.
    pub estimator: Option<Estimator>,
    /// Whether the first channel is the force of a hammer: one record of `segment` samples a blow.
    pub hammer: bool,
    /// Width of the force window in s.
    pub force_window: Option<f64>,
    /// What an exponential window leaves of the response at the end of a record.
    pub left_at_end: Option<f64>,
    /// Time in s by which the response was recorded late, as the decoder of a vibrometer does: its phase is corrected.
    pub delay: Option<f64>,
    /// Reference of levels in decibels, in the unit of the trace (of the function, with a reference channel).
    pub decibel: Option<f64>,
    /// Sines to be fitted to the whole record, 1 to 10.
    pub tones: Option<usize>,
}

impl SpectralOptions {
    /// The method that is meant.
    pub fn method(&self) -> Method {
        self.method.unwrap_or(if self.tones.is_some() { Method::Fft } else { Method::Welch })
    }

    /// The window that is meant.
    pub(super) fn window(&self) -> Window {
        self.window.unwrap_or(Window::Hann)
    }

    /// Whether the mean is taken out: that of segments, and what would be divided by nothing, unless told otherwise.
    pub(super) fn detrended(&self) -> bool {
        self.detrend.unwrap_or(self.method() == Method::Welch || self.integrate > 0)
    }

    /// The lowest frequency: two lines where an integral divides noise by the frequency.
    pub(super) fn lowest(&self, step: f64) -> f64 {
        self.fmin.unwrap_or(if self.integrate > 0 { 2.0 * step } else { 0.0 })
    }

    /// Checks that no option contradicts another.
    ///
    /// # Errors
    /// It names the two that do.
    pub fn check(&self) -> Result<()> {
        let (given, fft) = (|o: bool, name| o.then_some(name), self.method() == Method::Fft);
        let first = |names: &[Option<&'static str>]| names.iter().flatten().next().copied();
        let averaged = [
            given(self.segment.is_some(), "segment"),
            given(self.overlap.is_some(), "overlap"),
            given(self.estimator.is_some(), "reference"),
        ];
        let own = [
            given(self.window.is_some(), "window"),
            given(self.overlap.is_some(), "overlap"),
            given(self.method.is_some(), "method"),
            given(self.detrend.is_some(), "detrend"),
        ];
        let of_hammer = [
            given(self.force_window.is_some(), "force_window"),
            given(self.left_at_end.is_some(), "left_at_end"),
        ];
        let of_tones = [
            given(self.method == Some(Method::Welch), "method"),
            given(self.estimator.is_some(), "reference"),
            given(self.segment.is_some(), "segment"),
            given(self.overlap.is_some(), "overlap"),
            given(self.integrate != 0, "integrate"),
        ];
        let rules = [
            (
                self.tones.is_some(),
                first(&of_tones),
                "with tones",
                "tones of the whole record of one channel as it is",
            ),
            (fft, first(&averaged), "with method fft", "method welch, or the whole record of one channel"),
            (self.hammer, first(&own), "with a hammer", "the hammer's own windows alone"),
            (!self.hammer, first(&of_hammer), "without a hammer", "hammer = true, too"),
            (
                self.hammer,
                given(self.estimator.is_none(), "hammer"),
                "without a reference",
                "the force channel as reference",
            ),
            (
                self.estimator.is_some(),
                given(self.scaling.is_some(), "scaling"),
                "with a reference",
                "a function has no scaling",
            ),
        ];
        for (holds, name, with, expected) in rules {
            if let Some(name) = name.filter(|_| holds) {
                return Err(Error::usage(format!("{name} {with}"), expected).setting(name));
            }
        }
        if let Some(delay) = self.delay {
            if self.estimator.is_none() {
                return Err(Error::usage("delay without a reference", "two channels that are compared")
                    .setting("delay"));
            }
            if !delay.is_finite() {
                return Err(Error::usage(format!("delay = {delay}"), "seconds").setting("delay"));
            }
        }
        if let Some(re) = self.decibel.filter(|r| !(r.is_finite() && *r > 0.0)) {
            return Err(Error::usage(format!("decibel = {re}"), "a reference above 0, such as 1e-6")
                .setting("decibel"));
        }
        if !(-2..=2).contains(&self.integrate) {
            return Err(
                Error::usage(format!("integrate = {}", self.integrate), "-2 to 2").setting("integrate")
            );
        }
        if let Some(fmin) = self.fmin.filter(|f| !(f.is_finite() && *f > 0.0)) {
            return Err(Error::usage(format!("fmin = {fmin}"), "a finite number above 0").setting("fmin"));
        }
        let known = [Scaling::Peak, Scaling::Rms, Scaling::Power, Scaling::Psd];
        if let Some(scaling) = self.scaling.filter(|s| !known.contains(s)) {
            return Err(Error::usage(format!("scaling {}", scaling.name()), "peak, rms, power or psd")
                .setting("scaling"));
        }
        Ok(())
    }
}
