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

    /// Whether the mean is taken out: that of segments, and what would be divided by nothing, unless stated otherwise.
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
        let (fft, tones) = (self.method() == Method::Fft, self.tones.is_some());
        let (hammer, reference) = (self.hammer, self.estimator.is_some());
        let of_tones = "tones of the whole record of one channel as it is";
        let of_fft = "method welch, or the whole record of one channel";
        let of_hammer = "the hammer's own windows alone";
        let rules = [
            (tones && self.method == Some(Method::Welch), "method welch with tones", of_tones),
            (tones && reference, "reference with tones", of_tones),
            (tones && self.segment.is_some(), "segment with tones", of_tones),
            (tones && self.overlap.is_some(), "overlap with tones", of_tones),
            (tones && self.integrate != 0, "integrate with tones", of_tones),
            (fft && self.segment.is_some(), "segment with method fft", of_fft),
            (fft && self.overlap.is_some(), "overlap with method fft", of_fft),
            (fft && reference, "reference with method fft", of_fft),
            (hammer && self.window.is_some(), "window with a hammer", of_hammer),
            (hammer && self.overlap.is_some(), "overlap with a hammer", of_hammer),
            (hammer && self.method.is_some(), "method with a hammer", of_hammer),
            (hammer && self.detrend.is_some(), "detrend with a hammer", of_hammer),
            (!hammer && self.force_window.is_some(), "force_window without a hammer", "hammer = true, too"),
            (!hammer && self.left_at_end.is_some(), "left_at_end without a hammer", "hammer = true, too"),
            (hammer && !reference, "a hammer without a reference", "the force channel as reference"),
            (
                reference && self.scaling.is_some(),
                "scaling with a reference",
                "no scaling: a function has none",
            ),
            (!reference && self.delay.is_some(), "delay without a reference", "two channels to compare"),
        ];
        if let Some((_, found, expected)) = rules.iter().find(|rule| rule.0) {
            return Err(Error::usage(*found, *expected));
        }
        let known = [Scaling::Peak, Scaling::Rms, Scaling::Power, Scaling::Psd];
        let above_zero = |v: f64| v.is_finite() && v > 0.0;
        let wrong = |name: &str, value: Option<f64>, expected: &str| {
            value.map(|v| Error::usage(format!("{name} = {v}"), expected))
        };
        let integrate = Some(f64::from(self.integrate)).filter(|_| !(-2..=2).contains(&self.integrate));
        let faults = [
            wrong("delay", self.delay.filter(|d| !d.is_finite()), "seconds"),
            wrong("decibel", self.decibel.filter(|re| !above_zero(*re)), "a reference above 0, such as 1e-6"),
            wrong("integrate", integrate, "-2 to 2"),
            wrong("fmin", self.fmin.filter(|f| !above_zero(*f)), "a finite number above 0"),
            self.scaling
                .filter(|s| !known.contains(s))
                .map(|s| Error::usage(format!("scaling {}", s.name()), "peak, rms, power or psd")),
        ];
        faults.into_iter().flatten().next().map_or(Ok(()), Err)
    }
}
