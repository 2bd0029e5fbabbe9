//! How the velocity is smoothed before it is averaged and integrated.

use vibro_record::Result;
use vibro_signal::filter::Filter;

/// Harmonics of the speed that the low-pass chosen from the data lets through at least, however few phases the average has:
/// at the tenth, (10/50)⁴ = 0.2 % of the amplitude are missing then, of a stroke still less.
const HARMONICS: f64 = 50.0;
/// Largest corner as a part of the sampling rate: from there on differences of samples show too little:
/// at a quarter of it a central difference gives 2/π of a slope.
const HIGHEST: f64 = 0.25;

/// How the velocity is smoothed before it is averaged and integrated. Impacts and bandwidth are always taken from the
/// velocity as it was measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Smoothing {
    /// A zero-phase low-pass as in [`Smoothing::LowPass`] whose corner comes from the data: half as many times the speed as
    /// the average has phases, the highest frequency that these can show (50 times at least), and at most a quarter of the
    /// sampling rate.
    #[default]
    Phases,
    /// None.
    Off,
    /// Butterworth low-pass of second order, forward and backward: no delay. Corner in Hz, at half the amplitude.
    LowPass(f64),
    /// Exponential smoothing with this time constant in s: delays by it.
    Exponential(f64),
}

impl Smoothing {
    /// Corner in Hz, for an average at `points` phases of turns of `turn` seconds, `rate` samples a second; `None` where
    /// nothing is smoothed.
    ///
    /// ```
    /// use vibro_measure::drill::Smoothing;
    /// assert_eq!(Smoothing::Phases.corner(720, 0.02, 102_400.0), Some(18_000.0));
    /// assert_eq!(Smoothing::Phases.corner(720, 0.02, 20_000.0), Some(5_000.0));
    /// ```
    pub fn corner(self, points: usize, turn: f64, rate: f64) -> Option<f64> {
        match self {
            Smoothing::Phases => Some(((0.5 * points as f64).max(HARMONICS) / turn).min(HIGHEST * rate)),
            Smoothing::Off => None,
            Smoothing::LowPass(corner) => Some(corner),
            Smoothing::Exponential(time) => Some(1.0 / (std::f64::consts::TAU * time)),
        }
    }

    /// The filter, and whether it runs forward and backward.
    pub(super) fn filter(self, corner: f64, rate: f64) -> Result<(Filter, bool)> {
        Ok(match self {
            Smoothing::Exponential(_) => (Filter::smoothing(corner, rate)?, false),
            _ => (Filter::low_pass(corner, 2, rate)?, true),
        })
    }

    /// What was done, for the result.
    pub(super) fn stated(self, corner: f64, rate: f64) -> Corner {
        let kind = match self {
            Smoothing::Exponential(_) => SmoothingKind::Exponential,
            _ => SmoothingKind::ZeroPhaseLowPass,
        };
        let reason = match self {
            Smoothing::Phases if corner < HIGHEST * rate => CornerReason::Phases,
            Smoothing::Phases => CornerReason::SamplingRate,
            _ => CornerReason::Stated,
        };
        Corner { kind, corner, reason }
    }
}

/// A smoothing and its corner.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Corner {
    /// Kind of smoothing.
    pub kind: SmoothingKind,
    /// Corner in Hz: half the amplitude of the zero-phase low-pass, 1/√2 of exponential smoothing.
    pub corner: f64,
    /// Why there.
    pub reason: CornerReason,
}

/// Kind of a smoothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SmoothingKind {
    /// Butterworth low-pass of second order, forward and backward.
    ZeroPhaseLowPass,
    /// First-order low-pass, forward only.
    Exponential,
}

/// Why a corner is where it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CornerReason {
    /// It was stated.
    Stated,
    /// The highest frequency that the phases of the average show.
    Phases,
    /// A quarter of the sampling rate.
    SamplingRate,
}
