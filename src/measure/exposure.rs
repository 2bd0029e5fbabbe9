//! Hand-arm vibration: the weighting `W_h` of ISO 5349-1 as a digital filter, `a_hv` and A(8).

use super::Estimate;
use super::drill::Running;
use crate::error::{Error, Result};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Corners of the band limitation in Hz and their quality (ISO 5349-1:2001, table A.1, where it is
/// printed as 0.71; its table A.2 was made with 1/√2).
const BAND: [f64; 2] = [6.310, 1258.9];
const BAND_Q: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Transition from acceleration to velocity.
const TRANSITION: f64 = 15.915;
const TRANSITION_Q: f64 = 0.64;
/// Lowest sampling rate in Hz: four times the upper corner, so that the weighting has room to fall.
const LOWEST_RATE: f64 = 4.0 * 1258.9;
/// Duration in s over which the scatter of the vibration is taken.
const SPAN: f64 = 1.0;

/// The weighting at a frequency in Hz, by the formula of the standard.
pub fn weighting(frequency: f64) -> Complex64 {
    let s = Complex64::new(0.0, TAU * frequency);
    analogue().iter().map(|(b, a)| (b[0] + s * (b[1] + s * b[2])) / (a[0] + s * (a[1] + s * a[2]))).product()
}

/// Numerators and denominators in rising powers of s: high-pass, low-pass, transition.
fn analogue() -> [([f64; 3], [f64; 3]); 3] {
    let [w1, w2] = BAND.map(|f| TAU * f);
    let w3 = TAU * TRANSITION;
    [
        ([0.0, 0.0, 1.0], [w1 * w1, w1 / BAND_Q, 1.0]),
        ([w2 * w2, 0.0, 0.0], [w2 * w2, w2 / BAND_Q, 1.0]),
        ([w3 * w3, w3, 0.0], [w3 * w3, w3 / TRANSITION_Q, 1.0]),
    ]
}

/// One section of second order in z⁻¹, with its two memories.
#[derive(Debug, Clone, Copy)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
    memory: [f64; 2],
}

/// The weighting as a digital filter. Each section is transformed bilinearly so that it is exact at its own corner.
#[derive(Debug, Clone)]
pub struct Weighting {
    sections: [Section; 3],
}

impl Weighting {
    /// A filter for `rate` samples a second.
    ///
    /// # Errors
    /// If the rate is below four times the upper corner of the weighting.
    pub fn new(rate: f64) -> Result<Weighting> {
        if !(rate >= LOWEST_RATE && rate.is_finite()) {
            return Err(Error::refused(format!(
                "the weighting W_h reaches to 1259 Hz: a rate of {rate} Hz is too low, {LOWEST_RATE:.0} Hz are needed"
            )));
        }
        let corners = [BAND[0], BAND[1], TRANSITION];
        let sections = analogue();
        let section = |k: usize| {
            let (b, a) = sections[k];
            // s = c (1 − z⁻¹)/(1 + z⁻¹), c such that the corner stays where it is.
            let c = TAU * corners[k] / (PI * corners[k] / rate).tan();
            let map = |p: [f64; 3]| {
                let (p1, p2) = (p[1] * c, p[2] * c * c);
                [p[0] + p1 + p2, 2.0 * (p[0] - p2), p[0] - p1 + p2]
            };
            let (b, a) = (map(b), map(a));
            Section { b: b.map(|v| v / a[0]), a: [a[1] / a[0], a[2] / a[0]], memory: [0.0; 2] }
        };
        Ok(Weighting { sections: [section(0), section(1), section(2)] })
    }

    /// The weighted value of the next sample.
    pub fn next(&mut self, value: f64) -> f64 {
        self.sections.iter_mut().fold(value, |x, s| {
            let y = s.b[0] * x + s.memory[0];
            s.memory = [s.b[1] * x - s.a[0] * y + s.memory[1], s.b[2] * x - s.a[1] * y];
            y
        })
    }
}

/// Exposure of a hand.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Exposure {
    /// Weighted RMS acceleration of each axis.
    pub axes: Vec<Estimate>,
    /// Vibration total value: root of the sum of squares of the axes.
    pub a_hv: Estimate,
    /// Daily exposure related to eight hours; `None` where no duration was given.
    pub a8: Option<Estimate>,
    /// Duration in hours of A(8).
    pub hours: Option<f64>,
    /// Largest weighted acceleration over the weighted RMS, of the axis where that is largest.
    pub crest_factor: f64,
    /// Largest unweighted acceleration of any axis, in m/s².
    pub unweighted_peak: f64,
    /// What must be known with these numbers.
    pub warnings: Vec<String>,
}

/// Takes one axis of the acceleration of a handle, block by block.
#[derive(Debug, Clone)]
pub struct Handle {
    weighting: Weighting,
    span: usize,
    filled: usize,
    squares: f64,
    total: f64,
    samples: usize,
    spans: Running,
    peak: f64,
    raw_peak: f64,
    missing: usize,
}

impl Handle {
    /// An axis at `rate` samples a second.
    ///
    /// # Errors
    /// As [`Weighting::new`].
    pub fn new(rate: f64) -> Result<Handle> {
        Ok(Handle {
            weighting: Weighting::new(rate)?,
            span: ((SPAN * rate) as usize).max(1),
            filled: 0,
            squares: 0.0,
            total: 0.0,
            samples: 0,
            spans: Running::default(),
            peak: 0.0,
            raw_peak: 0.0,
            missing: 0,
        })
    }

    /// Takes the next accelerations in m/s². Missing ones count as 0.
    pub fn push(&mut self, block: &[f64]) {
        for &v in block {
            let v = if v.is_finite() {
                v
            } else {
                self.missing += 1;
                0.0
            };
            let weighted = self.weighting.next(v);
            self.peak = self.peak.max(weighted.abs());
            self.raw_peak = self.raw_peak.max(v.abs());
            self.squares += weighted * weighted;
            self.filled += 1;
            if self.filled == self.span {
                self.spans.push(self.squares / self.span as f64);
                self.total += self.squares;
                self.samples += self.filled;
                (self.squares, self.filled) = (0.0, 0);
            }
        }
    }

    fn mean_square(&self) -> f64 {
        (self.total + self.squares) / (self.samples + self.filled).max(1) as f64
    }

    /// Variance of the mean square, from whole seconds.
    fn variance(&self) -> f64 {
        self.spans.std().powi(2) / self.spans.n() as f64
    }
}

/// Exposure from one to three axes of a handle; `hours` of it a day.
///
/// `a_hv` = √(Σ `a_hw²`) and A(8) = `a_hv` √(T/8 h) (ISO 5349-1:2001, equations 1 and 2). Uncertainties are those of the scatter
/// from second to second; neither calibration nor mounting are in them.
///
/// # Errors
/// If there is no axis or there are more than three, a duration that is not above 0 and at most 24 h, or no vibration.
pub fn exposure(handles: &[Handle], hours: Option<f64>) -> Result<Exposure> {
    if handles.is_empty() || handles.len() > 3 {
        return Err(Error::usage(format!("{} axes of a handle", handles.len()), "one to three"));
    }
    if let Some(h) = hours.filter(|h| !(*h > 0.0 && *h <= 24.0)) {
        return Err(Error::usage(format!("an exposure of {h} hours a day"), "a number above 0, at most 24"));
    }
    let n: usize = handles.iter().map(|h| h.spans.n()).min().unwrap_or(0);
    let root = |square: f64, variance: f64, method: &str| {
        let rms = square.sqrt();
        let std = (n >= 4).then(|| variance.sqrt() / (2.0 * rms));
        Estimate::new(rms, std, "m/s²", n, method)
    };
    let axes: Vec<Estimate> = handles
        .iter()
        .map(|h| root(h.mean_square(), h.variance(), "RMS weighted by W_h, ISO 5349-1"))
        .collect();
    let total: f64 = handles.iter().map(Handle::mean_square).sum();
    if total <= 0.0 {
        return Err(Error::refused("the handle does not vibrate: its acceleration is 0"));
    }
    let a_hv =
        root(total, handles.iter().map(Handle::variance).sum(), "root of the sum of squares of the axes");
    let a8 = hours.map(|h| {
        let part = (h / 8.0).sqrt();
        Estimate::new(part * a_hv.value, a_hv.std.map(|s| part * s), "m/s²", n, "a_hv √(T/8 h)")
    });
    let crest = |h: &Handle| h.peak / h.mean_square().sqrt();
    let crest_factor = handles.iter().map(crest).filter(|c| c.is_finite()).fold(0.0, f64::max);
    let mut warnings = vec![
        "W_h understates the shocks of percussive tools: see the crest factor and the unweighted peak beside a_hv."
            .to_owned(),
    ];
    if handles.len() < 3 {
        warnings.push(format!(
            "a_hv rests on {} of three axes: the true value is larger, up to 1.7 times with one axis.",
            handles.len()
        ));
    }
    let missing: usize = handles.iter().map(|h| h.missing).sum();
    if missing > 0 {
        warnings.push(format!("{missing} missing accelerations of the handle count as 0."));
    }
    let unweighted_peak = handles.iter().map(|h| h.raw_peak).fold(0.0, f64::max);
    Ok(Exposure { axes, a_hv, a8, hours, crest_factor, unweighted_peak, warnings })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Third-octave centres and weighting factors of ISO 5349-1:2001, table A.2.
    const TABLE: [(i32, f64); 25] = [
        (6, 0.375),
        (7, 0.545),
        (8, 0.727),
        (9, 0.873),
        (10, 0.951),
        (11, 0.958),
        (12, 0.896),
        (13, 0.782),
        (14, 0.647),
        (15, 0.519),
        (16, 0.411),
        (17, 0.324),
        (18, 0.256),
        (19, 0.202),
        (20, 0.160),
        (21, 0.127),
        (22, 0.101),
        (23, 0.0799),
        (24, 0.0634),
        (25, 0.0503),
        (26, 0.0398),
        (27, 0.0314),
        (28, 0.0245),
        (29, 0.0186),
        (30, 0.0135),
    ];

    fn steady(rate: f64, f: f64) -> f64 {
        let mut weighting = Weighting::new(rate).unwrap();
        // The slowest pole settles with e^(−π·6.31/0.71·t): after 2 s nothing of it is left; whole periods follow.
        let settle = (2.0 * rate) as usize;
        let n = ((20.0 * f).round().max(20.0) / f * rate).round() as usize;
        let mut sum = 0.0;
        for i in 0..settle + n {
            let y = weighting.next((TAU * f * i as f64 / rate).sin());
            if i >= settle {
                sum += y * y;
            }
        }
        (2.0 * sum / n as f64).sqrt()
    }

    #[test]
    fn the_formula_gives_the_table_of_the_standard() {
        for (band, factor) in TABLE {
            let w = weighting(10f64.powf(f64::from(band) / 10.0)).norm();
            // The table has three digits: half of the last one is up to 0.4 %.
            assert!((w / factor - 1.0).abs() < 0.004, "{band}: {w} {factor}");
        }
    }

    #[test]
    fn the_filter_follows_the_formula_at_third_octave_centres() {
        for band in (6..=31).step_by(5) {
            let f = 10f64.powf(f64::from(band) / 10.0);
            let truth = weighting(f).norm();
            // The bilinear transform bends frequencies by (πf/rate)²/3: 0.05 % at 1 kHz, three octaves of slope at most; a
            // period that is no whole number of samples adds 1/(2n).
            assert!((steady(102_400.0, f) / truth - 1.0).abs() < 2e-3, "{f}");
        }
        // At low rates it stays within the tolerance of the standard, 11 % between 10 Hz and 500 Hz.
        assert!((steady(8_000.0, 500.0) / weighting(500.0).norm() - 1.0).abs() < 0.05);
    }

    #[test]
    fn three_axes_and_half_a_day() {
        let rate = 6_000.0;
        let axis = |amplitude: f64| {
            let mut handle = Handle::new(rate).unwrap();
            let values: Vec<f64> =
                (0..60_000).map(|i| amplitude * (TAU * 100.0 * f64::from(i) / rate).sin()).collect();
            values.chunks(777).for_each(|b| handle.push(b));
            handle
        };
        let handles = [axis(30.0), axis(40.0), axis(0.0)];
        let exposure = exposure(&handles, Some(2.0)).unwrap();
        let truth = 50.0 / 2f64.sqrt() * weighting(100.0).norm();
        // The warped formula at 100 Hz of 6 kHz, 0.1 %, and the first periods of ten seconds, which settle.
        assert!((exposure.a_hv.value / truth - 1.0).abs() < 5e-3, "{} {truth}", exposure.a_hv.value);
        assert!((exposure.a8.unwrap().value - 0.5 * exposure.a_hv.value).abs() < 1e-12);
        assert!((exposure.unweighted_peak - 40.0).abs() < 0.03);
        assert!(exposure.crest_factor > 1.41 && exposure.crest_factor < 2.5);
        assert_eq!(exposure.warnings.len(), 1);
    }

    #[test]
    fn what_cannot_be_exposed_is_refused() {
        assert!(Weighting::new(3000.0).is_err());
        let still = Handle::new(1e4).unwrap();
        assert_eq!(exposure(std::slice::from_ref(&still), None).unwrap_err().exit_code(), 1);
        assert_eq!(exposure(&[], None).unwrap_err().exit_code(), 2);
        assert_eq!(exposure(&[still], Some(30.0)).unwrap_err().exit_code(), 2);
    }
}
