//! Contact pulses of random contact laws, integrated here, to check how often the stated uncertainties of
//! restitution, duration and velocity cover the truth.

use super::disturbance::{Mix, peak};
use super::record::{Answer, Kind, Record};
use super::trace;
use std::f64::consts::TAU;
use vibroimpact::measure::pulse::{Instrument, LowPass, PulseOptions, pulse};

/// The kinds of records drawn here.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "pulse, spring and damper",
        ranges: "ξ 0.01 to 0.45, 15 to 300 samples a contact; behind a stated low-pass of order 1 to 4 in a \
        third, its corner frequency × contact duration from 0.7 to 10; white noise 0.0003 to 0.03 of the peak, 1/f noise, hum and 12 bits as in decays",
        every: 1,
        draw: |mix| draw(mix, Family::SpringDamper),
    },
    Kind {
        name: "pulse, Hunt–Crossley",
        ranges: "δ^1.5, R 0.4 to 0.98; else as before",
        every: 1,
        draw: |mix| draw(mix, Family::HuntCrossley),
    },
    Kind {
        name: "pulse, ringing behind",
        ranges: "a force pulse of either law whose sensor rings: a mode with frequency × contact duration from 0.7 to 8, ζ 0.005 to \
        0.1, that takes 0.3 to 20 % of the force; no low-pass",
        every: 1,
        draw: |mix| draw(mix, Family::Ringing),
    },
    Kind {
        name: "pulse, other laws",
        ranges: "δ^1.1 to δ^2.2 with a loss δ^s δ̇, s 0 to 1.5; or a stiffness 1.05 to 3 times as high when the bodies part",
        every: 1,
        draw: |mix| draw(mix, Family::Other),
    },
];

/// Mass in kg that is stated.
const MASS: f64 = 0.5;

/// Kinds of pulses by their contact law and instrument.
#[derive(Clone, Copy, PartialEq)]
enum Family {
    SpringDamper,
    HuntCrossley,
    Ringing,
    Other,
}

/// Contact law F = δⁿ + c δˢ δ̇ of a unit mass with the compression δ. A linear spring may be stiffer while
/// it unloads than while it is compressed.
#[derive(Clone, Copy)]
struct Law {
    /// Exponent n of the spring.
    n: f64,
    /// Exponent s of the loss.
    s: f64,
    /// Coefficient c of the loss.
    loss: f64,
    /// Stiffness of unloading over stiffness of compression; 1 for equal ones.
    unloading: f64,
}

impl Law {
    /// Contact force at the compression `d` and its rate `v`; `most` is the largest compression so far.
    fn force(&self, d: f64, v: f64, most: f64) -> f64 {
        let d = d.max(0.0);
        if self.unloading > 1.0 && v < 0.0 {
            // Walton and Braun: unloading follows a straight line from the largest force, with a higher
            // stiffness.
            return most.powf(self.n) * (1.0 - self.unloading * (1.0 - d / most));
        }
        d.powf(self.n) + self.loss * d.powf(self.s) * v
    }
}

/// The contact of a unit mass that arrives with velocity 1.
struct Contact {
    /// Interval between values of the force.
    step: f64,
    force: Vec<f64>,
    duration: f64,
    /// Coefficient of restitution: separation velocity, at an approach velocity of 1.
    restitution: f64,
}

impl Contact {
    /// Integrates a contact by the Runge–Kutta method of order 4, until the force or the compression
    /// vanishes.
    fn of(law: Law) -> Contact {
        let step = 1e-3;
        let (mut d, mut v, mut most, mut force) = (0.0, 1.0, 0.0, vec![law.force(0.0, 1.0, 0.0)]);
        loop {
            let slope = |d: f64, v: f64| (v, -law.force(d, v, most));
            let a = slope(d, v);
            let b = slope(d + 0.5 * step * a.0, v + 0.5 * step * a.1);
            let c = slope(d + 0.5 * step * b.0, v + 0.5 * step * b.1);
            let e = slope(d + step * c.0, v + step * c.1);
            let next = (
                d + step / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + e.0),
                v + step / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + e.1),
            );
            most = f64::max(most, next.0);
            let (before, after) = (force[force.len() - 1], law.force(next.0, next.1, most));
            if next.1 < 0.0 && (after <= 0.0 || next.0 <= 0.0) {
                // The end of the contact is interpolated linearly between two steps, which are short against
                // the contact.
                let part = if after < 0.0 { before / (before - after) } else { d / (d - next.0).max(1e-300) };
                let duration = (force.len() as f64 - 1.0 + part.min(1.0)) * step;
                return Contact { step, force, duration, restitution: -(v + part.min(1.0) * (next.1 - v)) };
            }
            (d, v) = next;
            force.push(after);
        }
    }

    /// Force at time `t` after the first touch, by linear interpolation; 0 outside the contact.
    fn at(&self, t: f64) -> f64 {
        let place = t / self.step;
        if !(0.0..self.duration / self.step).contains(&place) {
            return 0.0;
        }
        let (i, part) = (place as usize, place.fract());
        let next = self.force.get(i + 1).copied().unwrap_or(0.0);
        self.force[i] * (1.0 - part) + next * part
    }
}

/// Draws a contact law of a family.
fn draw_law(mix: &mut Mix, family: Family) -> Law {
    match family {
        Family::SpringDamper => {
            Law { n: 1.0, s: 0.0, loss: 2.0 * mix.random.between(0.01, 0.45), unloading: 1.0 }
        }
        Family::HuntCrossley => Law { n: 1.5, s: 1.5, loss: mix.log(0.015, 1.6), unloading: 1.0 },
        Family::Ringing if mix.chance(0.5) => draw_law(mix, Family::SpringDamper),
        Family::Ringing => draw_law(mix, Family::HuntCrossley),
        Family::Other if mix.chance(0.3) => {
            let unloading = mix.random.between(1.05, 3.0);
            Law { n: 1.0, s: 0.0, loss: 0.0, unloading: mix.note("stiffer on the way back", unloading) }
        }
        Family::Other => {
            let (n, s) = (mix.random.between(1.1, 2.2), mix.random.between(0.0, 1.5));
            mix.note("exponent", n);
            Law { n, s: mix.note("exponent of the loss", s), loss: mix.log(0.02, 0.6), unloading: 1.0 }
        }
    }
}

/// Errors of a sensor and its electronics in a contact force.
struct Sensor {
    /// Corner frequency of the low-pass × contact duration; 0 without a low-pass.
    corner: f64,
    /// Order of the low-pass.
    order: usize,
    /// Share of the force that passes through the ringing mode of the sensor; 0 without ringing.
    ringing: f64,
    /// Natural angular frequency and damping ratio of the ringing mode.
    omega: f64,
    zeta: f64,
}

impl Sensor {
    /// Draws the sensor for a contact.
    fn draw(mix: &mut Mix, family: Family, contact: &Contact) -> Sensor {
        let corner =
            if family == Family::Ringing { 0.0 } else { mix.some(0.33, "low-pass by duration", 0.7, 10.0) };
        let order = mix.random.between(1.0, 5.0) as usize;
        if corner > 0.0 {
            mix.note("order", order as f64);
        }
        let ringing = if family == Family::Ringing { mix.some(1.0, "ringing", 0.003, 0.2) } else { 0.0 };
        let omega = TAU * mix.log(0.7, 8.0) / contact.duration;
        let zeta = mix.log(0.005, 0.1);
        if ringing > 0.0 {
            mix.note("ringing by duration", omega / TAU * contact.duration);
        }
        Sensor { corner, order, ringing, omega, zeta }
    }

    /// `n` samples of the force that the sensor shows, at this `interval`; the contact starts at the time
    /// `onset`.
    fn shown(&self, contact: &Contact, n: usize, interval: f64, onset: f64) -> Vec<f64> {
        // Integration steps of the sensor per sampling interval; each is no longer than a step of the
        // contact.
        let substeps = (interval / contact.step).ceil().max(4.0) as usize;
        let step = interval / substeps as f64;
        let mut sections = butterworth(self.order, TAU * self.corner / contact.duration);
        let (mut x, mut v) = (0.0, 0.0);
        let mut shown = Vec::with_capacity(n);
        for i in 0..n * substeps {
            let t = i as f64 * step - onset;
            let mut force = contact.at(t);
            if self.corner > 0.0 {
                let middle = contact.at(t - 0.5 * step);
                force = sections.iter_mut().fold(middle, |input, section| section.pass(input, step));
            } else if self.ringing > 0.0 {
                // The sensor's mode has a static gain of 1. It is integrated by half a step of x, a step of
                // v, and half a step of x.
                x += 0.5 * step * v;
                let middle = contact.at(t - 0.5 * step);
                v += step * (self.omega * self.omega * (middle - x) - 2.0 * self.zeta * self.omega * v);
                x += 0.5 * step * v;
                force += self.ringing * (x - force);
            }
            if i % substeps == 0 {
                shown.push(force);
            }
        }
        shown
    }
}

/// Draws a contact of a family as the sensor shows it, with noise, hum and rounding of the converter.
/// Compares restitution, duration, approach velocity, peak force and impulse with the truth; for spring and
/// damper also damping ratio and frequency.
fn draw(mix: &mut Mix, family: Family) -> Record {
    let law = draw_law(mix, family);
    let contact = Contact::of(law);
    mix.note("restitution", contact.restitution);
    let samples = mix.log(15.0, 300.0);
    mix.note("samples a contact", samples);
    let sensor = Sensor::draw(mix, family, &contact);
    // Lengths of record before and after the contact, in contact durations.
    let (before, after) = (mix.random.between(1.0, 4.0), mix.random.between(2.0, 8.0));
    let n = ((before + 1.0 + after) * samples) as usize;
    let onset = (before * samples + mix.random.uniform()) / samples * contact.duration;
    let mut shown = sensor.shown(&contact, n, contact.duration / samples, onset);
    // Scales from unit mass and approach velocity to a bench: velocity in m/s, contact duration in s.
    let (velocity, duration) = (mix.log(0.05, 5.0), mix.log(2e-5, 5e-3));
    let scale = velocity * contact.duration / duration;
    for a in &mut shown {
        *a *= scale;
    }
    let largest = peak(&shown);
    let rate = samples / duration;
    mix.spoil(&mut shown, rate, largest, (3e-4, 0.03));
    let instrument = match LowPass::new(sensor.corner / duration, sensor.order) {
        Ok(low_pass) if sensor.corner > 0.0 => Instrument::LowPass(low_pass),
        _ => Instrument::Flat,
    };
    let mass = Some(MASS);
    let found = pulse(&trace("m/s^2", rate, shown), &PulseOptions { instrument, mass }).ok();
    let found = found.as_ref();
    let mut record = Record::default();
    if family == Family::SpringDamper {
        let xi = 0.5 * law.loss;
        record.answers.push(Answer::new("ξ", xi, found.map(|p| &p.xi)));
        let frequency = contact.duration / TAU / duration;
        record.answers.push(Answer::new("frequency", frequency, found.map(|p| &p.frequency)));
    }
    record.answers.push(Answer::new("restitution", contact.restitution, found.map(|p| &p.restitution)));
    record.answers.push(Answer::new("duration", duration, found.map(|p| &p.duration)));
    record.answers.push(Answer::new("velocity", velocity, found.and_then(|p| p.initial_velocity.as_ref())));
    record.answers.push(Answer::new(
        "peak",
        MASS * scale * peak(&contact.force),
        found.and_then(|p| p.peak.as_ref()),
    ));
    let impulse = MASS * velocity * (1.0 + contact.restitution);
    record.answers.push(Answer::new("impulse", impulse, found.and_then(|p| p.impulse.as_ref())));
    record
}

/// A section of a low-pass with input u: of second order, x″ + 2ζω x′ + ω² x = ω² u, or of first order,
/// x′ = ω (u − x).
struct Section {
    omega: f64,
    /// Damping ratio ζ; `None` for a section of first order.
    zeta: Option<f64>,
    /// Output x and its rate.
    x: f64,
    v: f64,
}

impl Section {
    /// Advances the section by `step`, by the trapezoidal rule; `input` is u in the middle of the step.
    /// Returns the mean output over the step.
    fn pass(&mut self, input: f64, step: f64) -> f64 {
        let h = 0.5 * step * self.omega;
        let before = self.x;
        match self.zeta {
            None => self.x = ((1.0 - h) * self.x + 2.0 * h * input) / (1.0 + h),
            Some(zeta) => {
                let (v, w) = (self.v, self.omega);
                let middle = (v + h * w * (input - before)) / (1.0 + 2.0 * zeta * h + h * h);
                self.v = 2.0 * middle - v;
                self.x = before + step * middle;
            }
        }
        0.5 * (before + self.x)
    }
}

/// Sections of a Butterworth low-pass with its corner at ω.
fn butterworth(order: usize, omega: f64) -> Vec<Section> {
    // Damping ratio of pole pair number k; an odd order also has one real pole.
    let zeta = |k: usize| ((2 * k + 1) as f64 * TAU / (4.0 * order as f64)).sin();
    let pairs = (0..order / 2).map(|k| Some(zeta(k)));
    pairs
        .chain((order % 2 == 1).then_some(None))
        .map(|zeta| Section { omega, zeta, x: 0.0, v: 0.0 })
        .collect()
}
