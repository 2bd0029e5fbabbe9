//! The response curve of a sweep.

use crate::Estimate;
use crate::jump::Jump;
use crate::resonance::Resonance;
use serde::Serialize;
use vibro_record::{Direction, Finding, Step, Uncertain, uncertain};

/// A line at a whole multiple or a fraction of the excitation frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Harmonic {
    /// `2`, `3`, … or `1/2`, `1/3`, …
    pub order: String,
    /// Frequency in Hz.
    pub frequency: f64,
    /// Amplitude; NaN where the frequency lies outside the lines or below the cut-off. Where noise may hide
    /// it, that of the nearest line, noise included.
    pub amplitude: Estimate,
    /// 95 % upper limit of the true amplitude, where noise may hide it (Read 2002).
    pub upper_limit: Option<f64>,
}

/// One step of the response curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResponsePoint {
    /// Excitation frequency in Hz.
    pub excitation: f64,
    /// Its standard uncertainty in Hz.
    pub excitation_std: Option<f64>,
    /// Force amplitude in N, where there is a force spectrum.
    pub force: Option<f64>,
    /// Its standard uncertainty in N.
    pub force_std: Option<f64>,
    /// Frequency of the response peak in Hz.
    pub frequency: f64,
    /// Its standard uncertainty in Hz.
    pub frequency_std: Option<f64>,
    /// Peak amplitude at the excitation. Where noise may hide the response, that of the line nearest to the
    /// excitation, noise included: such an amplitude is biased high.
    pub amplitude: Estimate,
    /// 95 % upper limit of the true amplitude, where noise may hide it (Read 2002).
    pub upper_limit: Option<f64>,
    /// Orders 2 to 5.
    pub harmonics: Vec<Harmonic>,
    /// Orders 1/2, 1/3, 1/4.
    pub subharmonics: Vec<Harmonic>,
    /// Phase of the response against the force in rad, where it is known.
    pub phase: Option<Estimate>,
    /// Displacement over force, where its phase is known.
    pub receptance: Option<Receptance>,
    /// Whether the largest line of the spectrum is not at the excitation.
    pub largest_elsewhere: bool,
    /// Frequency of the largest line in Hz.
    pub largest_at: f64,
}

/// Displacement over force at one frequency, in m/N.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Receptance {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
    /// Standard uncertainty of each part.
    pub std: Option<f64>,
}

uncertain!(Harmonic: ; scaled: amplitude);
uncertain!(Receptance: ; scaled: std);
// Phase and receptance are ratios of two lines of one window, on which they do not depend.
uncertain!(ResponsePoint: excitation_std, frequency_std; scaled: force_std, amplitude, harmonics, subharmonics);

impl Uncertain for Response {
    fn doubt(&mut self) {
        self.points.doubt();
        self.resonances.doubt();
        self.jumps.doubt();
    }

    fn doubt_all(&mut self) {
        self.doubt();
        for point in &mut self.points {
            point.of_response().doubt();
        }
        self.jumps.iter_mut().for_each(|jump| jump.frequency_std = f64::NAN);
    }

    fn doubt_scale(&mut self) {
        self.points.doubt_scale();
        self.points.iter_mut().for_each(|point| point.receptance.doubt());
        self.resonances.doubt_scale();
        self.jumps.doubt_scale();
    }
}

impl ResponsePoint {
    /// Standard uncertainty of the amplitude for a known force: how far it may be off the curve of its
    /// neighbours. What the force adds by its drift within a step, it adds to all steps alike.
    pub(crate) fn off_curve(&self) -> Option<f64> {
        let per_newton = self.receptance.and_then(|r| Some(self.amplitude.value * r.std? / r.re.hypot(r.im)));
        Some(self.amplitude.std?.min(per_newton.unwrap_or(f64::INFINITY)))
    }

    /// Relative standard uncertainty of the amplitude that neighbours share.
    pub(crate) fn with_curve(&self) -> f64 {
        let shared =
            self.amplitude.std.zip(self.off_curve()).map(|(all, own)| (all * all - own * own).sqrt());
        shared.unwrap_or(0.0) / self.amplitude.value
    }

    /// The numbers of the response: all but its frequency and the force.
    pub(crate) fn of_response(&mut self) -> [&mut dyn Uncertain; 5] {
        let ResponsePoint { amplitude, harmonics, subharmonics, phase, receptance, .. } = self;
        [amplitude, harmonics, subharmonics, phase, receptance]
    }
}

/// A response curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Response {
    /// Name of the sweep.
    pub name: String,
    /// Direction of the sweep, stated or found from the excitation frequencies.
    pub direction: Option<Direction>,
    /// Mass (1 excited, 2 passive), where stated.
    pub mass: Option<u8>,
    /// Quantity of the amplitudes.
    pub quantity: &'static str,
    /// Unit of the amplitudes.
    pub unit: &'static str,
    /// Cut-off in Hz: lines below were left out.
    pub fmin: f64,
    /// Steps, in the order in which they were taken.
    pub points: Vec<ResponsePoint>,
    /// Maxima and minima of the curve.
    pub resonances: Vec<Resonance>,
    /// Jumps of the curve.
    pub jumps: Vec<Jump>,
    /// Findings that limit the curve.
    pub findings: Vec<Finding>,
    /// Processing steps from file to curve.
    pub history: Vec<Step>,
}
