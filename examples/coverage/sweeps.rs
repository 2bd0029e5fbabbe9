//! Random stepped-sine sweeps of a mass on a spring, without impacts, to check how often the stated
//! uncertainties of excitation frequency, force, amplitude and resonance cover the truth.

use super::disturbance::{Chain, Mix};
use super::record::{Answer, Kind, Record};
use super::trace;
use std::f64::consts::{PI, TAU};
use vibroimpact::measure::resonance::Resonance;
use vibroimpact::measure::response::{Response, ResponseOptions, response};
use vibroimpact::record::{Axis, Direction, Scaling, Spectrum, Sweep, SweepPoint, Values, Window};
use vibroimpact::signal::fft::Transform;

/// The kinds of records drawn here.
pub const KINDS: &[Kind] = &[Kind {
    name: "sweep",
    ranges: "12 to 30 steps over 1 to 6 half-power bandwidths, ζ 0.005 to 0.1, 512 or 1024 samples a spectrum, Hann window, resonance at 12 to 60 lines; \
        displacement from velocity; white noise 0.0001 to 0.01 of the largest response, 1/f noise, hum and 12 bits as in decays; frequency that drifts by \
        0.01 to 0.2 lines a spectrum, amplitude modulated by 0.1 to 2 % at 0.5 to 20 lines, each in a third; the truth is the mean over the spectrum under its window",
    every: 1,
    draw,
}];

/// Distance between the lines of a spectrum in Hz.
const LINE_SPACING: f64 = 0.0625;
/// Mass in kg.
const MASS: f64 = 0.2;

/// Peak-amplitude line spectrum with a Hann window, up to 1/2.56 of the sampling rate.
fn peak_spectrum(transform: &Transform, values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let hann = |i: usize| 1.0 - (TAU * i as f64 / n as f64).cos();
    let windowed: Vec<f64> = values.iter().enumerate().map(|(i, v)| v * hann(i)).collect();
    let mut lines: Vec<f64> =
        transform.forward(&windowed).iter().map(|line| line.norm() * 2.0 / n as f64).collect();
    lines.truncate((n as f64 / 2.56) as usize + 1);
    lines
}

/// Mean over a record of 1 + `modulation` cos(2πwu + `phase`) under a Hann window, with the place u in the
/// record from 0 to 1 and w = `modulation_lines`.
fn windowed_mean(modulation: f64, modulation_lines: f64, phase: f64) -> f64 {
    let mean_cosine = |w: f64| ((TAU * w + phase).sin() - phase.sin()) / (TAU * w);
    let w = modulation_lines;
    // The window 1 − cos 2πu moves half of the cosine to w ± 1.
    1.0 + modulation * (mean_cosine(w) - 0.5 * (mean_cosine(w + 1.0) + mean_cosine(w - 1.0)))
}

/// The oscillator and the excitation of one sweep, the same for all its steps.
struct Setup {
    /// Samples of a record.
    samples: usize,
    /// Undamped natural frequency in Hz.
    natural_frequency: f64,
    /// Damping ratio.
    zeta: f64,
    /// Amplitude of the force in N.
    force: f64,
    /// Change of the excitation frequency over a record, in lines; 0 for none.
    drift: f64,
    /// Relative amplitude modulation; 0 for none.
    modulation: f64,
    /// Frequency of the modulation in lines.
    modulation_lines: f64,
    /// Measuring chain of the response.
    chain: Chain,
}

/// True values of a step: excitation frequency in Hz, force amplitude in N, displacement amplitude in m.
struct Truth {
    excitation: f64,
    force: f64,
    amplitude: f64,
}

impl Setup {
    /// Magnitude of the receptance in m/N at `f` Hz.
    fn receptance(&self, f: f64) -> f64 {
        let (natural, zeta) = (self.natural_frequency, self.zeta);
        1.0 / (MASS * TAU * TAU * (natural * natural - f * f).hypot(2.0 * zeta * natural * f))
    }

    /// Velocity amplitude in m/s at `f` Hz.
    fn velocity(&self, f: f64) -> f64 {
        TAU * f * self.receptance(f) * self.force
    }

    /// Draws the records of force and velocity at `f` Hz and computes their spectra. Noise, hum and range of
    /// the measuring chain are relative to `largest`, the largest velocity of the sweep in m/s.
    fn step(&self, mix: &mut Mix, f: f64, number: usize, largest: f64) -> (SweepPoint, Truth) {
        let n = self.samples;
        let rate = LINE_SPACING * n as f64;
        let (phase, response_phase, modulation_phase) =
            (mix.random.between(-PI, PI), mix.random.between(-PI, PI), mix.random.between(-PI, PI));
        // Phase and relative amplitude at the place u of the record, 0 to 1.
        let phase_at = |u: f64| TAU * (f / LINE_SPACING * u + 0.5 * self.drift * u * (u - 1.0)) + phase;
        let envelope =
            |u: f64| 1.0 + self.modulation * (TAU * self.modulation_lines * u + modulation_phase).cos();
        let record = |amplitude: f64, lag: f64| -> Vec<f64> {
            let places = (0..n).map(|i| i as f64 / n as f64);
            places.map(|u| amplitude * envelope(u) * (phase_at(u) + lag).cos()).collect()
        };
        let mut force_record = record(self.force, 0.0);
        let mut velocity_record = record(self.velocity(f), response_phase);
        self.chain.pass(mix, &mut velocity_record, rate, largest);
        mix.add_white(&mut force_record, 0.3 * self.chain.white * self.force);
        let transform = Transform::new(n);
        let values = Values::Real(peak_spectrum(&transform, &velocity_record));
        let response = Spectrum {
            meta: trace("m/s", rate, Vec::new()).meta,
            axis: Axis::frequency(0.0, LINE_SPACING, values.len()),
            values,
            scaling: Scaling::Peak,
            window: Some(Window::Hann),
            enbw: Some(1.5),
        };
        let point = SweepPoint {
            force_path: None,
            response_path: format!("{number}").into(),
            force: Values::Real(peak_spectrum(&transform, &force_record)),
            given: None,
            response,
        };
        let mean = windowed_mean(self.modulation, self.modulation_lines, modulation_phase);
        let force = self.force * mean;
        (point, Truth { excitation: f, force, amplitude: self.receptance(f) * self.force * mean })
    }
}

/// Draws a sweep: each step a sine with frequency drift and amplitude modulation, passed through the
/// measuring chain; compares excitation, force, amplitude and resonance with the truth.
fn draw(mix: &mut Mix) -> Record {
    let samples = if mix.chance(0.5) { 512 } else { 1024 };
    let zeta = mix.log(0.005, 0.1);
    mix.note("ζ", zeta);
    let natural_frequency = LINE_SPACING * mix.log(12.0, 60.0);
    mix.note("resonance in lines", natural_frequency / LINE_SPACING);
    // Frequency range on either side of the resonance in Hz.
    let half_span = zeta * natural_frequency * mix.log(1.0, 6.0);
    let steps = mix.random.between(12.0, 31.0) as usize;
    let force = mix.log(0.1, 10.0);
    let drift = mix.some(0.33, "drift in lines", 0.01, 0.2);
    let modulation = mix.some(0.33, "modulation", 1e-3, 0.02);
    let modulation_lines = mix.log(0.5, 20.0);
    if modulation > 0.0 {
        mix.note("modulation at lines", modulation_lines);
    }
    let chain = mix.chain((1e-4, 0.01));
    let setup = Setup { samples, natural_frequency, zeta, force, drift, modulation, modulation_lines, chain };
    let across = |k: i32| natural_frequency + half_span * (f64::from(k) / 50.0 - 1.0);
    let largest = (0..=100).map(|k| setup.velocity(across(k))).fold(0.0, f64::max);
    let frequency =
        |k: usize| natural_frequency - half_span + 2.0 * half_span * k as f64 / (steps - 1) as f64;
    // The lowest excitation frequency of a step: six lines.
    let lowest = 6.0 * LINE_SPACING;
    let (points, truths): (Vec<SweepPoint>, Vec<Truth>) =
        (0..steps).map(|k| setup.step(mix, frequency(k).max(lowest), k, largest)).unzip();
    let sweep = sweep_up(points[0].response.axis.clone(), points);
    let found = response(&sweep, &ResponseOptions::default()).ok();
    sweep_answers(&setup, truths, found.as_ref())
}

/// A sweep of the excited mass with rising frequency.
pub fn sweep_up(axis: Axis, points: Vec<SweepPoint>) -> Sweep {
    let (name, direction) = ("sweep".into(), Some(Direction::Up));
    Sweep { name, direction, mass: Some(1), axis, analyser_integrated: 0, points, findings: Vec::new() }
}

/// Adds the answer for the resonance of the displacement in Hz, which lies below the undamped natural
/// frequency. Returns the true resonance and the found one nearest to it.
pub fn resonance_answer<'a>(
    record: &mut Record,
    natural_frequency: f64,
    zeta: f64,
    found: Option<&'a Response>,
) -> (f64, Option<&'a Resonance>) {
    let truth = natural_frequency * (1.0 - 2.0 * zeta * zeta).sqrt();
    let distance = |f: f64| (f - truth).abs();
    let resonances = found.into_iter().flat_map(|r| &r.resonances);
    let nearest = resonances.min_by(|a, b| distance(a.frequency).total_cmp(&distance(b.frequency)));
    record.answers.push(Answer::of("resonance", truth, nearest.map(|r| (r.frequency, r.frequency_std))));
    (truth, nearest)
}

/// The answers for every step, and for the resonance nearest to the true one.
fn sweep_answers(setup: &Setup, truths: Vec<Truth>, found: Option<&Response>) -> Record {
    let mut record = Record::default();
    for (k, truth) in truths.into_iter().enumerate() {
        let point = found.map(|r| &r.points[k]);
        let excitation = point.map(|p| (p.excitation, p.excitation_std));
        record.answers.push(Answer::of("excitation", truth.excitation, excitation));
        let force = point.and_then(|p| Some((p.force?, p.force_std)));
        record.answers.push(Answer::of("force", truth.force, force));
        let amplitude = point.filter(|p| p.upper_limit.is_none()).map(|p| &p.amplitude);
        record.answers.push(Answer::new("amplitude", truth.amplitude, amplitude));
    }
    let (resonance, nearest) = resonance_answer(&mut record, setup.natural_frequency, setup.zeta, found);
    // With modulation each step has its own mean force. The steps then do not lie on one resonance curve, so
    // the height of the resonance is not compared.
    if setup.modulation == 0.0 {
        let height = nearest.map(|r| (r.amplitude, r.amplitude_std));
        let truth = setup.receptance(resonance) * setup.force;
        record.answers.push(Answer::of("height of resonance", truth, height));
    }
    record
}
