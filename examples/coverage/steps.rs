//! Random stepped sines as traces of force and response, whose amplitude may grow within a step, to check how
//! often the stated uncertainties cover the truth.

use super::disturbance::{Chain, Mix};
use super::record::{Answer, Kind, Record};
use super::sweeps::{resonance_answer, sweep_up};
use super::trace;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use vibroimpact::measure::response::{ResponseOptions, ResponsePoint};
use vibroimpact::measure::stepped::stepped;
use vibroimpact::record::{Axis, StepTraces};

/// The kinds of records drawn here.
pub const KINDS: &[Kind] = &[Kind {
    name: "sweep of traces",
    ranges: "10 to 24 steps over 1 to 6 half-power bandwidths, ζ 0.005 to 0.1, 30 to 200 settled periods of 20 to 60 samples; displacement; the force grows or \
        falls by 0.1 to 3 % over a step in half; white noise of the force 0.0001 to 0.003 of it; noise of the response 0.0001 to 0.01 of the largest, \
        1/f noise, hum and 12 bits as in decays",
    every: 1,
    draw,
}];

/// Mass in kg.
const MASS: f64 = 0.2;

/// The oscillator and the records of one sweep, the same for all its steps.
struct Setup {
    /// Undamped natural frequency in Hz.
    natural_frequency: f64,
    /// Damping ratio.
    zeta: f64,
    /// Amplitude of the force in N in the middle of a step.
    force: f64,
    /// Change of the logarithm of the force over a step; 0 for none.
    growth: f64,
    /// White noise of the force, relative to its amplitude.
    force_noise: f64,
    /// Number of periods in a step.
    periods: f64,
    /// Number of samples in a period of the natural frequency.
    samples: f64,
    /// Measuring chain of the response.
    chain: Chain,
}

impl Setup {
    /// Receptance in m/N for a force e^{st}.
    fn receptance(&self, s: Complex64) -> Complex64 {
        let natural = TAU * self.natural_frequency;
        1.0 / (MASS * (s * s + 2.0 * self.zeta * natural * s + natural * natural))
    }

    /// Draws the traces of the step at `f` Hz. The noise of the measuring chain is relative to `largest`
    /// (m).
    fn step(&self, mix: &mut Mix, f: f64, largest: f64) -> StepTraces {
        let rate = self.natural_frequency * self.samples;
        let n = (self.periods / f * rate) as usize;
        let duration = n as f64 / rate;
        let s = Complex64::new(self.growth / duration, TAU * f);
        let start = Complex64::from_polar(self.force, mix.random.between(-PI, PI));
        let ratio = self.receptance(s);
        let at = |i: usize| start * (s * (i as f64 / rate - duration / 2.0)).exp();
        let mut force: Vec<f64> = (0..n).map(|i| at(i).re).collect();
        let mut response: Vec<f64> = (0..n).map(|i| (ratio * at(i)).re).collect();
        self.chain.pass(mix, &mut response, rate, largest);
        mix.add_white(&mut force, self.force_noise * self.force);
        let path = format!("{f}").into();
        StepTraces { path, force: trace("N", rate, force), response: trace("m", rate, response) }
    }
}

/// Draws a sweep and compares each step's excitation and receptance, and the resonance, with the truth.
fn draw(mix: &mut Mix) -> Record {
    let zeta = mix.log(0.005, 0.1);
    mix.note("ζ", zeta);
    let natural_frequency = mix.log(5.0, 500.0);
    mix.note("natural frequency", natural_frequency);
    let half_span = zeta * natural_frequency * mix.log(1.0, 6.0);
    let steps = mix.random.between(10.0, 25.0) as usize;
    let growth = mix.some(0.5, "growth", 1e-3, 0.03) * if mix.chance(0.5) { 1.0 } else { -1.0 };
    let setup = Setup {
        natural_frequency,
        zeta,
        force: mix.log(0.1, 10.0),
        growth,
        force_noise: mix.log(1e-4, 3e-3),
        periods: mix.log(30.0, 200.0),
        samples: mix.random.between(20.0, 60.0),
        chain: mix.chain((1e-4, 0.01)),
    };
    mix.note("periods", setup.periods);
    let receptance = |f: f64| setup.receptance(Complex64::new(0.0, TAU * f));
    let frequency =
        |k: usize| natural_frequency - half_span + 2.0 * half_span * k as f64 / (steps - 1) as f64;
    let frequencies: Vec<f64> = (0..steps).map(frequency).collect();
    let largest = frequencies.iter().map(|f| receptance(*f).norm() * setup.force).fold(0.0, f64::max);
    let traces: Vec<_> = frequencies.iter().map(|f| setup.step(mix, *f, largest)).collect();
    let traces = traces.into_iter().map(|t| (t.path.clone(), Ok(t))).collect();
    let sweep = sweep_up(Axis::index(0), Vec::new());
    let found = stepped(sweep, traces, &ResponseOptions::default()).ok().map(|(_, found)| found);
    let mut record = Record::default();
    // A step without a sine of force would be left out; no step here is.
    let points = found.iter().map(|r| &r.points).filter(|points| points.len() == steps);
    let points: Vec<&ResponsePoint> = points.flatten().collect();
    for (k, f) in frequencies.into_iter().enumerate() {
        step_answers(&mut record, f, receptance(f), points.get(k).copied());
    }
    resonance_answer(&mut record, natural_frequency, zeta, found.as_ref());
    record
}

/// The answers for the step at `f` Hz.
fn step_answers(record: &mut Record, f: f64, truth: Complex64, point: Option<&ResponsePoint>) {
    record.answers.push(Answer::of("excitation", f, point.map(|p| (p.excitation, p.excitation_std))));
    let receptance = point.filter(|p| p.upper_limit.is_none()).and_then(|p| p.receptance.as_ref());
    let ratio = receptance.map(|r| (Complex64::new(r.re, r.im), r.std));
    record.answers.push(Answer::of("receptance", truth.norm(), ratio.map(|(h, std)| (h.norm(), std))));
    // The phase is compared as a difference, which has no jump at 180°.
    let phase = ratio.map(|(h, std)| ((h / truth).arg(), std.map(|std| std / h.norm())));
    record.answers.push(Answer::of("phase", 0.0, phase));
}
