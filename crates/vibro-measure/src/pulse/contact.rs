//! Laws of contact: spring and damper side by side; power laws of curved bodies with losses; a yielding
//! spring.

use super::LowPass;
use super::linear::Linear;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Contact of damping ratio ξ and undamped frequency f, with approach at unit velocity and separation at
/// zero force.
///
/// With ω = 2πf, sin θ = ξ, Ω = ω cos θ and h = ωξ the deceleration is a(t) = (ω/cos θ) e^{−ht} sin(Ωt + 2θ)
/// from 0 to (π − 2θ)/Ω: it begins with a jump to 2ξω.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KelvinVoigt {
    theta: f64,
    omega: f64,
}

impl KelvinVoigt {
    /// A contact; a fit to noise may need a slightly negative ξ, so −0.5 < ξ < 1 is allowed. `None` outside,
    /// and where f is not above 0.
    pub fn new(xi: f64, frequency: f64) -> Option<KelvinVoigt> {
        let possible = xi > -0.5 && xi < 1.0 && frequency > 0.0 && frequency.is_finite();
        possible.then(|| KelvinVoigt { theta: xi.asin(), omega: TAU * frequency })
    }

    /// The contact of ξ that lasts `duration` seconds: ω = (π − 2θ)/(t cos θ).
    pub fn lasting(duration: f64, xi: f64) -> Option<KelvinVoigt> {
        let theta = xi.asin();
        KelvinVoigt::new(xi, (PI - 2.0 * theta) / (TAU * duration * theta.cos()))
    }

    /// ξ.
    pub fn xi(&self) -> f64 {
        self.theta.sin()
    }

    /// f = ω/2π in Hz.
    pub fn frequency(&self) -> f64 {
        self.omega / TAU
    }

    /// Time to zero force in s.
    pub fn duration(&self) -> f64 {
        (PI - 2.0 * self.theta) / (self.omega * self.theta.cos())
    }

    /// Time to the largest force in s; `None` for ξ ≥ 1/2, where the force is largest at the beginning.
    pub fn time_to_peak(&self) -> Option<f64> {
        let angle = PI / 2.0 - 3.0 * self.theta;
        (self.xi() < 0.5).then(|| angle / (self.omega * self.theta.cos()))
    }

    /// Largest deceleration in m/s² for each m/s of approach: that at the onset for ξ ≥ 1/2.
    pub(super) fn peak(&self) -> f64 {
        self.unbounded(self.time_to_peak().unwrap_or(0.0))
    }

    /// Velocity after over velocity before: exp(−(π − 2θ) tan θ).
    pub fn restitution(&self) -> f64 {
        (-(PI - 2.0 * self.theta) * self.theta.tan()).exp()
    }

    /// Deceleration at `t` in s, in m/s² for each m/s of approach, continued smoothly before 0 and after the
    /// duration.
    pub(crate) fn unbounded(&self, t: f64) -> f64 {
        let (h, turn) = (self.omega * self.theta.sin(), self.omega * self.theta.cos());
        self.omega / self.theta.cos() * (-h * t).exp() * (turn * t + 2.0 * self.theta).sin()
    }

    /// Deceleration at `t` in s, in m/s² for each m/s of approach, as an instrument with this low-pass shows
    /// it.
    pub fn filtered(&self, filter: &LowPass, t: f64) -> f64 {
        self.through(&filter.linear, &[t])[0]
    }

    /// Deceleration at each of the `times` in s, in m/s² for each m/s of approach, as the parts of an
    /// instrument show it.
    pub(super) fn through(&self, instrument: &Linear, times: &[f64]) -> Vec<f64> {
        let s = Complex64::new(-self.omega * self.theta.sin(), self.omega * self.theta.cos());
        let c = Complex64::cis(2.0 * self.theta) * (self.omega / self.theta.cos());
        instrument.exponential(c, s, self.duration(), times)
    }
}

/// A contact with approach at unit velocity, in units of time T and length VT in which mass and stiffness
/// are 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Rebound {
    /// −z″ at multiples of [`STEP`], up to the end of the contact.
    deceleration: Vec<f64>,
    /// −z″ within the first step, at equal parts of it, less the straight line over it: a loss that hardly
    /// depends on the indentation rises there. Empty for other losses.
    rise: Vec<f64>,
    /// Duration of the contact in units of T.
    duration: f64,
    /// Speed of separation over that of approach.
    pub restitution: f64,
}

/// Step of the integration in units of T, about 1/400 of the contact. Over the last part of a step the force
/// falls along a straight line.
const STEP: f64 = 1.0 / 128.0;

/// Parts of the first step at which the force of a fast rise is stored.
const PARTS: usize = 16;

/// Most steps of an integration, 200 T: a longer contact is given up.
const LONGEST: usize = 128 * 200;

impl Rebound {
    /// Force k δⁿ + c δˢ δ̇ that does not pull: with both exponents 3/2 that of Hunt & Crossley (1975), and
    /// without losses that of Hertz. With α the loss at unit velocity, z″ = −zⁿ − α zˢ z′, integrated by the
    /// classical Runge–Kutta formula; for exponents of 3/2 it is good to 1e-5 of the largest value. `None`
    /// for α outside −0.5…100, n outside 0.5…4, s outside 0…4, and where the contact does not end within 200
    /// T. No body is softer than n = 1, but a fit to noise may need it.
    pub fn power_law(alpha: f64, n: f64, s: f64) -> Option<Rebound> {
        let possible =
            (-0.5..=100.0).contains(&alpha) && (0.5..=4.0).contains(&n) && (0.0..=4.0).contains(&s);
        if !possible {
            return None;
        }
        let hertz = n == 1.5 && s == 1.5;
        let force = |z: f64, v: f64| {
            if hertz {
                let z = z.max(0.0);
                return z * z.sqrt() * (1.0 + alpha * v);
            }
            let exponent = z.max(f64::MIN_POSITIVE).ln();
            (n * exponent).exp() + alpha * (s * exponent).exp() * v
        };
        let (mut z, mut v, mut before) = (0.0_f64, 1.0_f64, force(0.0, 1.0));
        let mut deceleration = vec![before];
        let h = STEP;
        let mut rise = Vec::new();
        if s.min(n) < 1.0 {
            // Over the first step zˢ or zⁿ is not smooth: there z = t, and the force is integrated by terms.
            let early = |t: f64| {
                let (spring, loss) = (t.powf(n + 1.0) / (n + 1.0), alpha * t.powf(s + 1.0) / (s + 1.0));
                (t - spring * t / (n + 2.0) - loss * t / (s + 2.0), 1.0 - spring - loss)
            };
            let at = |(z, v): (f64, f64)| force(z, v);
            let end = at(early(h));
            let line = |part: f64| before + (end - before) * part;
            let parts = (0..=PARTS).map(|i| i as f64 / PARTS as f64);
            rise = parts.map(|part| at(early(part * h)) - line(part)).collect();
            ((z, v), before) = (early(h), end);
            deceleration.push(before);
        }
        for _ in 0..LONGEST {
            let a1 = -before;
            let v2 = v + h / 2.0 * a1;
            let a2 = -force(z + h / 2.0 * v, v2);
            let v3 = v + h / 2.0 * a2;
            let a3 = -force(z + h / 2.0 * v2, v3);
            let v4 = v + h * a3;
            let a4 = -force(z + h * v3, v4);
            let next = z + h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
            let faster = v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
            let after = force(next, faster);
            // The contact ends where the bodies part, or where the force would begin to pull.
            if next <= 0.0 || after <= 0.0 && faster < 0.0 {
                // Over a part of a step the force falls along a straight line.
                let part = if next <= 0.0 { z / -v } else { h * before / (before - after) };
                let duration = (deceleration.len() - 1) as f64 * h + part;
                deceleration.push(0.0);
                let restitution = 0.5 * before * part - v;
                return Some(Rebound { deceleration, rise, duration, restitution });
            }
            (z, v, before) = (next, faster, after);
            deceleration.push(after);
        }
        None
    }

    /// A spring that yields, 1/R² times as stiff on unloading (Walton & Braun 1986): its force is a quarter
    /// of a sine, then a shorter quarter of a cosine. `None` for R outside 0.05…1.05: a fit to noise may
    /// need R slightly above 1.
    pub fn yielding(restitution: f64) -> Option<Rebound> {
        if !(0.05..=1.05).contains(&restitution) {
            return None;
        }
        let (turn, duration) = (0.5 * PI, 0.5 * PI * (1.0 + restitution));
        let force = |t: f64| if t < turn { t.sin() } else { ((t - turn) / restitution).cos() };
        let steps = (duration / STEP) as usize;
        let deceleration = (0..=steps).map(|i| force(i as f64 * STEP)).chain([0.0]).collect();
        Some(Rebound { deceleration, rise: Vec::new(), duration, restitution })
    }

    /// Deceleration at each of the rising `times` in s, in m/s² for each m/s of approach, of a contact that
    /// lasts `duration` seconds; as an `instrument` shows it where there is one.
    pub(super) fn decelerations(
        &self,
        duration: f64,
        instrument: Option<&Linear>,
        times: &[f64],
    ) -> Vec<f64> {
        let scale = duration / self.duration;
        let step = STEP * scale;
        let bare = || times.iter().map(|t| self.between(t / step));
        let mut values: Vec<f64> = match instrument {
            Some(instrument) => {
                // Behind a low-pass only the impulse of the rise matters: it is given to the first value,
                // which counts for half a step.
                let mut lines = self.deceleration.clone();
                lines[0] += 2.0 * self.rise.iter().sum::<f64>() / PARTS as f64;
                let mut values = instrument.straight_lines(&lines, step, times);
                if instrument.direct != 0.0 {
                    values
                        .iter_mut()
                        .zip(bare())
                        .for_each(|(value, bare)| *value += instrument.direct * bare);
                }
                values
            }
            None => bare().collect(),
        };
        for value in &mut values {
            *value /= scale;
        }
        values
    }

    /// Largest deceleration of a contact that lasts `duration` seconds, in m/s² for each m/s of approach.
    pub(super) fn peak(&self, duration: f64) -> f64 {
        let rise = (0..self.rise.len()).map(|i| self.between(i as f64 / PARTS as f64));
        let most = self.deceleration.iter().copied().chain(rise).fold(0.0, f64::max);
        most * self.duration / duration
    }

    /// Lengths in s of the parts at the beginning and at the end of a contact that lasts `duration` seconds
    /// which are `hidden`: given are ∫a² dt and ∫a dt over the part, of the deceleration a in m/s² for each
    /// m/s of approach.
    pub(super) fn ends(&self, duration: f64, hidden: impl Fn(f64, f64) -> bool) -> [f64; 2] {
        let scale = duration / self.duration;
        let part = |values: &mut dyn Iterator<Item = &f64>| {
            let (mut squares, mut sum) = (0.0, 0.0);
            let within = values.map(|a| a / scale).take_while(|a| {
                (squares, sum) = (squares + a * a * STEP * scale, sum + a * STEP * scale);
                hidden(squares, sum)
            });
            within.count().saturating_sub(1) as f64 * STEP * scale
        };
        [part(&mut self.deceleration.iter()), part(&mut self.deceleration.iter().rev())]
    }

    fn between(&self, place: f64) -> f64 {
        let on = |values: &[f64], place: f64| {
            let at = place as usize;
            match (values.get(at), values.get(at.saturating_add(1))) {
                (Some(a), Some(b)) => a + (b - a) * (place - at as f64),
                _ => 0.0,
            }
        };
        if place <= 0.0 || place.is_nan() {
            return 0.0;
        }
        let line = on(&self.deceleration, place);
        if place < 1.0 { line + on(&self.rise, place * PARTS as f64) } else { line }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Oscillator;

    /// The free motion of mass, spring and damper at unit velocity, by the kernels of `math::Oscillator`.
    #[test]
    fn the_deceleration_is_that_of_a_free_oscillator() {
        for xi in [0.0, 0.05, 0.18, 0.5, 0.9] {
            let contact = KelvinVoigt::new(xi, 25e3).unwrap();
            let omega = TAU * 25e3;
            let oscillator = Oscillator::new(1.0, 2.0 * xi * omega, omega * omega);
            for part in 0..=10 {
                let t = contact.duration() * f64::from(part) / 10.0;
                let (x, v) = oscillator.free(0.0, 1.0, t);
                let found = contact.unbounded(t);
                // ω/cos θ times a few roundings of an angle of order 1.
                let tolerance = 64.0 * f64::EPSILON * omega / (1.0 - xi * xi);
                assert!((found + oscillator.acceleration(x, v)).abs() < tolerance, "{xi} {t}");
            }
            let (x, v) = oscillator.free(0.0, 1.0, contact.duration());
            assert!(oscillator.acceleration(x, v).abs() < 1e-13 * omega, "{xi}");
            assert!((v + contact.restitution()).abs() < 1e-13, "{xi} {v}");
        }
    }

    #[test]
    fn the_peak_is_where_the_slope_vanishes() {
        for xi in [-0.1, 0.0, 0.2, 0.49] {
            let contact = KelvinVoigt::new(xi, 1.0).unwrap();
            let t = contact.time_to_peak().unwrap();
            let h = 1e-5;
            let slope = (contact.unbounded(t + h) - contact.unbounded(t - h)) / (2.0 * h);
            // A central difference errs by h²ω⁴/6 = 3e-8 and by rounding, ωε/h.
            assert!(slope.abs() < 1e-6, "{xi} {slope}");
        }
        assert_eq!(KelvinVoigt::new(0.5, 1.0).and_then(|c| c.time_to_peak()), None);
    }

    /// A numerical convolution with the impulse response of order 2, ω√2 e^{−ωt/√2} sin(ωt/√2).
    #[test]
    fn the_filtered_pulse_is_a_convolution() {
        let contact = KelvinVoigt::new(0.2, 25e3).unwrap();
        let filter = LowPass::new(30e3, 2).unwrap();
        let omega = TAU * 30e3 / f64::sqrt(2.0);
        let n = 20_000;
        for t in [2e-6, 9e-6, 17e-6, 30e-6, 80e-6] {
            let end = contact.duration().min(t);
            let h = end / f64::from(n);
            let sum: f64 = (0..n)
                .map(|i| {
                    let tau = (f64::from(i) + 0.5) * h;
                    let ago = t - tau;
                    contact.unbounded(tau) * 2.0 * omega * (-omega * ago).exp() * (omega * ago).sin() * h
                })
                .sum();
            // The midpoint rule errs by h²/24 of the second derivative, about (3e5)² of the value: below
            // 1e-7.
            assert!((contact.filtered(&filter, t) - sum).abs() < 1e-7 * 25e3 * TAU, "{t}");
        }
    }
}

#[cfg(test)]
mod curved {
    use super::*;

    /// Hertz: deepest at (5/4)^{2/5} VT, largest force there, duration 2.9432 times that over V (Johnson
    /// 1985, 11.22 to 11.24).
    #[test]
    fn hertz_has_its_closed_form() {
        let hertz = Rebound::power_law(0.0, 1.5, 1.5).unwrap();
        let deepest = f64::powf(1.25, 0.4);
        // Sampled at h, the crest of curvature a is missed by at most a h²/8.
        let largest = hertz.deceleration.iter().copied().fold(0.0, f64::max);
        assert!((largest - deepest.powf(1.5)).abs() < STEP * STEP, "{largest}");
        // 2.94328 = (4√π/5) Γ(2/5)/Γ(9/10), to six digits.
        assert!((hertz.duration / deepest - 2.943_28).abs() < 1e-5, "{}", hertz.duration / deepest);
        // Over the last part of a step, at most h, the force left out is below h^{3/2}: h^{5/2} = 5e-6.
        assert!((hertz.restitution - 1.0).abs() < 1e-5);
    }

    /// v dv/(1 + αv) = −z^{3/2} dz: v/α − ln(1 + αv)/α² is the same before (v = 1) and after (v = −R).
    #[test]
    fn the_restitution_balances_the_energy() {
        for alpha in [0.1, 0.5, 1.0, 3.0, 20.0] {
            let contact = Rebound::power_law(alpha, 1.5, 1.5).unwrap();
            let level = |v: f64| v / alpha - (alpha * v).ln_1p() / (alpha * alpha);
            let (before, after) = (level(1.0), level(-contact.restitution));
            // Tolerance as for Hertz.
            assert!((before - after).abs() < 1e-5 * before, "{alpha} {before} {after}");
        }
        assert!(
            Rebound::power_law(101.0, 1.5, 1.5).is_none() && Rebound::power_law(f64::NAN, 1.5, 1.5).is_none()
        );
    }

    /// With equal exponents of any size the same balance holds; with those of spring and damper the contact
    /// is that of [`KelvinVoigt`]; a spring that yields keeps the part R² of its energy.
    #[test]
    fn other_exponents_and_a_yielding_spring_balance_the_energy() {
        for n in [0.8, 1.0, 2.0, 3.0] {
            let contact = Rebound::power_law(0.4, n, n).unwrap();
            let level = |v: f64| v / 0.4 - (0.4 * v).ln_1p() / 0.16;
            let (before, after) = (level(1.0), level(-contact.restitution));
            // Over the last part of a step the force is taken for a straight line: below h² of the velocity.
            // Terms that the first step leaves out, of the order α²h^(1 + n), are half of that for n = 0.8.
            assert!((before - after).abs() < STEP * STEP, "{n} {before} {after}");
        }
        for xi in [0.02, 0.2, 0.45] {
            let (found, exact) =
                (Rebound::power_law(2.0 * xi, 1.0, 0.0).unwrap(), KelvinVoigt::new(xi, 1.0 / TAU).unwrap());
            assert!((found.restitution - exact.restitution()).abs() < STEP * STEP, "{xi}");
            assert!(
                (found.duration - exact.duration()).abs() < STEP * STEP,
                "{xi} {} {}",
                found.duration,
                exact.duration()
            );
        }
        let yielding = Rebound::yielding(0.6).unwrap();
        let impulse = yielding.deceleration.iter().sum::<f64>() * STEP;
        // Steps that do not meet the end of the contact leave half a step's force out.
        assert!((impulse - 1.6).abs() < STEP, "{impulse}");
    }

    /// A loss of a small exponent rises within the first step. Reference: the semi-implicit Euler formula
    /// with 4000 steps in each of those of [`Rebound`].
    #[test]
    fn a_loss_that_rises_at_once_is_integrated() {
        for (alpha, n, s) in [(0.3, 1.5, 0.1), (0.5, 1.2, 0.3), (0.2, 2.0, 0.02)] {
            let contact = Rebound::power_law(alpha, n, s).unwrap();
            let h = STEP / 4000.0;
            let force = |z: f64, v: f64| f64::powf(z, n) + alpha * f64::powf(z, s) * v;
            let (mut z, mut v, mut t) = (0.0_f64, 1.0_f64, 0.0);
            let mut early = 0.0;
            loop {
                let now = force(z, v);
                if t > 0.0 && now <= 0.0 && v < 0.0 {
                    break;
                }
                // The force in the middle of the first step is stored there.
                if (t - 0.5 * STEP).abs() < 0.5 * h {
                    early = now;
                }
                v -= h * now;
                z += h * v;
                t += h;
            }
            // Both take the force as straight over a part of a step at the end: below h² of the velocity.
            // Where the first step is taken term by term, terms of the order α²h^(1 + s) are left out.
            let tolerance = STEP * STEP + alpha * alpha * STEP.powf(1.0 + s);
            assert!((contact.restitution + v).abs() < tolerance, "{s} {} {v}", contact.restitution);
            assert!((contact.duration - t).abs() < STEP * STEP + tolerance, "{s} {} {t}", contact.duration);
            let found = contact.between(0.5);
            assert!((found - early).abs() < tolerance + 0.01 * early, "{s} {found} {early}");
        }
    }

    /// The impulse is the change of velocity, 1 + R, with any low-pass, since its gain at 0 Hz is one.
    #[test]
    fn a_low_pass_keeps_the_impulse() {
        let contact = Rebound::power_law(0.6, 1.5, 1.5).unwrap();
        let filter = LowPass::new(30e3, 3).unwrap();
        let step = 1e-8;
        let times: Vec<f64> = (0..40_000).map(|i| f64::from(i) * step).collect();
        for filter in [None, Some(&filter)] {
            let sum: f64 =
                contact.decelerations(20e-6, filter.map(|f| &f.linear), &times).iter().sum::<f64>() * step;
            // Straight lines between the integration's steps miss h²/12 of the change of slope, and the end
            // part of a step.
            assert!((sum - 1.0 - contact.restitution).abs() < 1e-4, "{sum} {}", contact.restitution);
        }
    }
}
