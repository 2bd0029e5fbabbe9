//! Contacts of other laws than spring and damper: power laws of curved bodies with losses, and a yielding
//! spring.

use super::linear::Linear;
use std::f64::consts::PI;
use std::sync::OnceLock;
use vibro_math::root::bracketed;

/// A contact with approach at unit velocity, in units of time T and length VT in which mass and stiffness
/// are 1. Its force is a smooth function of time and of the numbers of its law, so that a fit has a gradient.
#[derive(Debug, Clone, PartialEq)]
pub struct Rebound {
    law: Law,
    lines: OnceLock<Vec<f64>>,
    /// Duration of the contact in units of T.
    duration: f64,
    /// Speed of separation over that of approach.
    pub restitution: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Law {
    Power(Power, Vec<State>),
    /// Restitution.
    Yielding(f64),
}

/// Force zⁿ + α zˢ z′, with its motion as z′ = w − α zˢ⁺¹/(s + 1), w′ = −zⁿ: neither side jumps where zˢ
/// does.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Power {
    alpha: f64,
    n: f64,
    s: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct State {
    z: f64,
    w: f64,
    /// z′.
    v: f64,
    /// −w′ = zⁿ.
    spring: f64,
    /// α zˢ⁺¹.
    loss: f64,
}

/// Longest step of the integration in units of T, about 1/200 of the contact.
const STEP: f64 = 1.0 / 64.0;

/// Most steps of an integration, 200 T: a longer contact is given up.
const LONGEST: usize = 64 * 200;

/// Straight lines over a contact: they miss π²/12 of the squared part of one, 5e-6 of the largest value.
const LINES: usize = 400;

impl Power {
    /// zⁿ and α zˢ⁺¹.
    fn powers(self, z: f64) -> (f64, f64) {
        let z = z.max(0.0);
        if self.n == 1.5 && self.s == 1.5 {
            let spring = z * z.sqrt();
            return (spring, self.alpha * spring * z);
        }
        let exponent = z.max(f64::MIN_POSITIVE).ln();
        ((self.n * exponent).exp(), self.alpha * ((self.s + 1.0) * exponent).exp())
    }

    fn state(self, z: f64, w: f64) -> State {
        let (spring, loss) = self.powers(z);
        State { z, w, v: w - loss / (self.s + 1.0), spring, loss }
    }

    /// A step of the classical Runge–Kutta formula.
    fn step(self, from: State, h: f64) -> State {
        let at = |by: f64, of: State| self.state(from.z + by * of.v, from.w - by * of.spring);
        let second = at(h / 2.0, from);
        let third = at(h / 2.0, second);
        let fourth = at(h, third);
        let mean =
            |of: fn(&State) -> f64| (of(&from) + 2.0 * of(&second) + 2.0 * of(&third) + of(&fourth)) / 6.0;
        self.state(from.z + h * mean(|s| s.v), from.w - h * mean(|s| s.spring))
    }

    /// What falls below zero where the bodies part, and its rate: the force over that of the spring where a
    /// loss of the smaller exponent would pull, else z.
    fn pressed(self, State { z, v, spring, loss, .. }: State) -> (f64, f64) {
        if self.alpha <= 0.0 || self.s >= self.n {
            return (z, v);
        }
        if spring == 0.0 {
            return (-1.0, 0.0);
        }
        let lost = loss / (spring * z);
        (1.0 + lost * v, lost * ((self.s - self.n) * v * v / z - spring - loss / z * v))
    }
}

impl State {
    /// −z″.
    fn force(self) -> f64 {
        self.spring + self.loss / self.z.max(f64::MIN_POSITIVE) * self.v
    }
}

impl Rebound {
    /// Force k δⁿ + c δˢ δ̇ that does not pull: with both exponents 3/2 that of Hunt & Crossley (1975), and
    /// without losses that of Hertz. α is the loss at unit velocity. `None` for α outside −0.5…100, n outside
    /// 0.5…4, s outside −0.5…4 or below 0 with α above 10, and where the contact does not end within 200 T.
    /// No body is softer than n = 1, and no loss falls with the indentation, but a fit to noise may need it.
    pub fn power_law(alpha: f64, n: f64, s: f64) -> Option<Rebound> {
        let most = if s < 0.0 { 10.0 } else { 100.0 };
        let possible =
            (-0.5..=most).contains(&alpha) && (0.5..=4.0).contains(&n) && (-0.5..=4.0).contains(&s);
        if !possible {
            return None;
        }
        let law = Power { alpha, n, s };
        let mut states = vec![law.state(0.0, 1.0)];
        // The bodies part where the force would begin to pull.
        let last = (0..LONGEST).find_map(|_| {
            let last = states[states.len() - 1];
            let next = law.step(last, STEP);
            let ended = next.v < 0.0 && law.pressed(next).0 <= 0.0;
            if !ended {
                states.push(next);
            }
            ended.then_some(last)
        })?;
        let part = bracketed(0.0, STEP, |part| law.pressed(law.step(last, part)));
        let duration = (states.len() - 1) as f64 * STEP + part;
        let parted = law.step(last, part);
        states.push(parted);
        let (law, lines) = (Law::Power(law, states), OnceLock::new());
        Some(Rebound { law, lines, duration, restitution: -parted.v })
    }

    /// A spring that yields, 1/R² times as stiff on unloading (Walton & Braun 1986): its force is a quarter
    /// of a sine, then a shorter quarter of a cosine. `None` for R outside 0.05…1.05: a fit to noise may
    /// need R slightly above 1.
    pub fn yielding(restitution: f64) -> Option<Rebound> {
        if !(0.05..=1.05).contains(&restitution) {
            return None;
        }
        let (law, lines) = (Law::Yielding(restitution), OnceLock::new());
        Some(Rebound { law, lines, duration: 0.5 * PI * (1.0 + restitution), restitution })
    }

    /// Values of the deceleration at the ends of equal parts of the contact, joined by straight lines.
    fn lines(&self) -> &[f64] {
        self.lines.get_or_init(|| {
            let part = self.duration / LINES as f64;
            let mut lines: Vec<f64> = (0..LINES).map(|i| self.at(i as f64 * part)).collect();
            lines.push(0.0);
            if let Some(state) = self.motion(part) {
                // The force of a loss that hardly depends on the indentation rises within the first line,
                // which has its impulse.
                lines[0] = 2.0 * (1.0 - state.v) / part - lines[1];
            }
            lines
        })
    }

    /// Motion of a power law within the contact, by the cubics through the states at both ends of a step and
    /// their slopes.
    fn motion(&self, t: f64) -> Option<State> {
        let Law::Power(law, states) = &self.law else { return None };
        let last = states.len() - 2;
        let i = ((t / STEP) as usize).min(last);
        let h = if i == last { self.duration - last as f64 * STEP } else { STEP };
        let (a, b, x) = (states[i], states[i + 1], (t - i as f64 * STEP) / h);
        let cubic = |from: f64, to: f64, before: f64, after: f64| {
            let (y, d) = (1.0 - x, to - from);
            from + x * (d + y * (y * (h * before - d) - x * (h * after - d)))
        };
        let z = cubic(a.z, b.z, a.v, b.v);
        Some(law.state(z, cubic(a.w, b.w, -a.spring, -b.spring)))
    }

    /// −z″ at `t` in units of T, 0 outside of the contact.
    fn at(&self, t: f64) -> f64 {
        if !(t > 0.0 && t < self.duration) {
            return 0.0;
        }
        match self.law {
            Law::Power(..) => self.motion(t).map_or(f64::NAN, State::force),
            Law::Yielding(_) if t < 0.5 * PI => t.sin(),
            Law::Yielding(restitution) => ((t - 0.5 * PI) / restitution).cos(),
        }
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
        let bare = || times.iter().map(|t| self.at(t / scale));
        let mut values: Vec<f64> = match instrument {
            Some(instrument) => {
                let mut values = instrument.straight_lines(self.lines(), duration / LINES as f64, times);
                if instrument.direct != 0.0 {
                    let through = values.iter_mut().zip(bare());
                    through.for_each(|(value, bare)| *value += instrument.direct * bare);
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

    /// Largest deceleration of a contact that lasts `duration` seconds, in m/s² for each m/s of approach, by
    /// the parabola through the largest values. A rise within the first line counts by its impulse.
    pub(super) fn peak(&self, duration: f64) -> f64 {
        let lines = self.lines();
        let top = (0..LINES).fold(0, |top, i| if lines[i] > lines[top] { i } else { top });
        let crest = || {
            let (before, after) = (lines[top - 1] - lines[top], lines[top + 1] - lines[top]);
            // Of equal values there is no parabola.
            let bend = (before + after).min(-f64::MIN_POSITIVE);
            lines[top] - (after - before).powi(2) / (8.0 * bend)
        };
        let most = if top == 0 { lines[0] } else { crest() };
        most * self.duration / duration
    }

    /// Lengths in s of the parts at the beginning and at the end of a contact that lasts `duration` seconds
    /// which are `hidden`: given are ∫a² dt and ∫a dt over the part, of the deceleration a in m/s² for each
    /// m/s of approach.
    pub(super) fn ends(&self, duration: f64, hidden: impl Fn(f64, f64) -> bool) -> [f64; 2] {
        let (scale, step) = (duration / self.duration, duration / LINES as f64);
        let part = |values: &mut dyn Iterator<Item = &f64>| {
            let (mut squares, mut sum) = (0.0, 0.0);
            let within = values.map(|a| a / scale).take_while(|a| {
                (squares, sum) = (squares + a * a * step, sum + a * step);
                hidden(squares, sum)
            });
            within.count().saturating_sub(1) as f64 * step
        };
        [part(&mut self.lines().iter()), part(&mut self.lines().iter().rev())]
    }
}

#[cfg(test)]
mod tests {
    use super::super::{KelvinVoigt, LowPass};
    use super::*;
    use std::f64::consts::TAU;

    /// Error of the integration: a few h⁴, of a solution whose derivatives are about one.
    const ERROR: f64 = 4.0 * STEP * STEP * STEP * STEP;

    /// Hertz: deepest at (5/4)^{2/5} VT, largest force there, duration 2.9432 times that over V (Johnson
    /// 1985, 11.22 to 11.24).
    #[test]
    fn hertz_has_its_closed_form() {
        let hertz = Rebound::power_law(0.0, 1.5, 1.5).unwrap();
        let deepest = f64::powf(1.25, 0.4);
        // Runge–Kutta errs by the order of h⁴; the parabola through values 1/400 apart by less.
        let largest = hertz.peak(hertz.duration);
        assert!((largest - deepest.powf(1.5)).abs() < ERROR, "{largest} {}", deepest.powf(1.5));
        // 2.94328 = (4√π/5) Γ(2/5)/Γ(9/10), to six digits.
        assert!((hertz.duration / deepest - 2.943_28).abs() < 1e-5, "{}", hertz.duration / deepest);
        assert!((hertz.restitution - 1.0).abs() < ERROR);
    }

    /// v dv/(1 + αv) = −z^{3/2} dz: v/α − ln(1 + αv)/α² is the same before (v = 1) and after (v = −R).
    #[test]
    fn the_restitution_balances_the_energy() {
        for alpha in [0.1, 0.5, 1.0, 3.0, 20.0] {
            let contact = Rebound::power_law(alpha, 1.5, 1.5).unwrap();
            let level = |v: f64| v / alpha - (alpha * v).ln_1p() / (alpha * alpha);
            let (before, after) = (level(1.0), level(-contact.restitution));
            // Of R: near 1/α the balance hardly depends on the speed.
            let error = (before - after).abs() * (1.0 - alpha * contact.restitution) / contact.restitution;
            // A loss acts at the rate α z^1.5, where z^2.5 is below 2.5/α: h is multiplied by it.
            let rate = f64::max(1.0, alpha * f64::powf(2.5 / alpha, 0.6));
            assert!(error < ERROR * rate.powi(4), "{alpha} {before} {after} {error}");
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
            // In the first step zⁿ is not smooth: h^(n + 1), of which Runge–Kutta errs by a few per cent.
            let tolerance = 0.05 * STEP.powf(n + 1.0) + ERROR;
            assert!((before - after).abs() < tolerance, "{n} {before} {after}");
        }
        for xi in [0.02, 0.2, 0.45] {
            let (found, exact) =
                (Rebound::power_law(2.0 * xi, 1.0, 0.0).unwrap(), KelvinVoigt::new(xi, 1.0 / TAU).unwrap());
            assert!((found.restitution - exact.restitution()).abs() < ERROR, "{xi}");
            assert!((found.duration - exact.duration()).abs() < ERROR, "{xi}");
            for part in [0.001, 0.3, 0.71, 0.999] {
                let t = part * exact.duration();
                assert!((found.at(t) - exact.unbounded(t)).abs() < ERROR, "{xi} {part}");
            }
        }
        let yielding = Rebound::yielding(0.6).unwrap();
        let impulse = yielding.lines().iter().sum::<f64>() * yielding.duration / LINES as f64;
        // The trapezoidal rule: h²/12 of the change of slope, 1 + 1/R.
        assert!((impulse - 1.6).abs() < 2e-5, "{impulse}");
    }

    /// A loss of a small exponent rises within the first step, one of a negative exponent begins without a
    /// bound. Reference: the semi-implicit Euler formula with steps of 2e-6, which errs by about as much, and
    /// by h^(1 + s) where the force begins without a bound.
    #[test]
    fn a_loss_that_rises_at_once_is_integrated() {
        for (alpha, n, s) in [(0.3, 1.5, 0.1), (0.5, 1.2, 0.3), (0.2, 2.0, 0.02), (0.4, 1.0, -0.2)] {
            let contact = Rebound::power_law(alpha, n, s).unwrap();
            let h = 2e-6;
            let tolerance = 2.0 * f64::max(h, alpha * f64::powf(h, 1.0 + s.min(0.0)));
            let force = |z: f64, v: f64| f64::powf(z, n) + alpha * f64::powf(z, s) * v;
            // The first step is along z = t.
            let (mut z, mut v, mut t) = (h, 1.0 - alpha * f64::powf(h, s + 1.0) / (s + 1.0), h);
            let mut steps = 1;
            loop {
                let now = force(z, v);
                if now <= 0.0 && v < 0.0 {
                    break;
                }
                if [1000, 3000, 500_000].contains(&steps) {
                    let found = contact.at(t);
                    // Runge–Kutta errs by a per mille of the first step's h^(2 + s) over its time.
                    assert!((found - now).abs() < 10.0 * tolerance + 1e-4 * now, "{s} {t} {found} {now}");
                }
                v -= h * now;
                z += h * v;
                t += h;
                steps += 1;
            }
            assert!((contact.restitution + v).abs() < tolerance, "{s} {} {v}", contact.restitution);
            assert!((contact.duration - t).abs() < tolerance, "{s} {} {t}", contact.duration);
        }
    }

    /// The force has no corner where the number of steps of the integration changes: a fit has a gradient
    /// everywhere. Second differences over 1e-4 are those of a smooth function, 1e-8 times its curvature.
    #[test]
    fn the_force_depends_smoothly_on_the_law() {
        for s in [-0.1, 0.0, 0.4] {
            let of = |k: i32| {
                let loss = 0.4 + 1e-4 * f64::from(k);
                let contact = Rebound::power_law(loss, 1.1, s).unwrap();
                let times = [0.02, 0.5, 0.9, 0.99];
                let mut all = contact.decelerations(1.0, None, &times);
                let filter = LowPass::new(2.0, 2).unwrap();
                all.extend(contact.decelerations(1.0, Some(&filter.linear), &times));
                all.extend([contact.duration, contact.restitution, contact.peak(1.0)]);
                all
            };
            let all: Vec<Vec<f64>> = (0..400).map(of).collect();
            for (k, three) in all.windows(3).enumerate() {
                for (i, value) in three[1].iter().enumerate() {
                    let bend = three[0][i] + three[2][i] - 2.0 * value;
                    assert!(bend.abs() < 1e-8 * 20.0, "{s} {k} {i} {bend}");
                }
            }
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
