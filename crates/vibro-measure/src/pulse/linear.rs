//! A linear instrument, applied to a model in closed form.

use super::LowPass;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Response of a linear instrument to an impulse, as what passes directly and a sum of first-order parts:
/// h(t) = d δ(t) + Σ rₖ e^{pₖt}.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Linear {
    /// d.
    pub direct: f64,
    /// Poles pₖ in 1/s and residues rₖ in 1/s; with each pole its conjugate.
    pub parts: Vec<(Complex64, Complex64)>,
}

/// Damping ratios of a mode that a fit may try: noise may make the best one slightly negative.
const DAMPING: std::ops::Range<f64> = -0.05..0.7;

impl Linear {
    /// A sensor that has one mode, behind it the `filter`. The share a of the signal passes through the mode
    /// of the frequency f = ω/2π with the damping ratio ζ, whose static gain is one:
    /// H(s) = 1 − a + aω²/(s² + 2ζωs + ω²). `None` for a frequency not above 0 and for a ζ that is no mode's.
    pub fn sensor([share, frequency, zeta]: [f64; 3], filter: Option<&LowPass>) -> Option<Linear> {
        if !(frequency > 0.0 && DAMPING.contains(&zeta) && share.is_finite()) {
            return None;
        }
        let omega = TAU * frequency;
        let pole = omega * Complex64::new(-zeta, (1.0 - zeta * zeta).sqrt());
        let residue = share * omega * omega / (pole - pole.conj());
        let mode = [(pole, residue), (pole.conj(), residue.conj())];
        let Some(filter) = filter else { return Some(Linear { direct: 1.0 - share, parts: mode.to_vec() }) };
        // Partial fractions of the product: each pole has its residue times the other factor there.
        let at = |parts: &[(Complex64, Complex64)], s: Complex64| {
            parts.iter().map(|(p, r)| r / (s - p)).sum::<Complex64>()
        };
        let filter = &filter.linear.parts;
        let first = filter.iter().map(|(p, r)| (*p, r * (1.0 - share + at(&mode, *p))));
        let second = mode.iter().map(|(p, r)| (*p, r * at(filter, *p)));
        Some(Linear { direct: 0.0, parts: first.chain(second).collect() })
    }

    /// Response of the parts at each of the `times` in s to the imaginary part of c e^{st} from 0 to `length`
    /// in s, and to 0 elsewhere.
    pub fn exponential(&self, c: Complex64, s: Complex64, length: f64, times: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; times.len()];
        // (e^{st} − e^{pt})/(s − p); the difference loses digits where the exponents are near each other.
        let sum = |p: Complex64, t: f64, driven: Complex64, free: Complex64| {
            let z = (s - p) * t;
            if z.norm() < 1e-2 { free * t * mean_exponentials(z).0 } else { (driven - free) / (s - p) }
        };
        let end = (s * length).exp();
        let inside = |t: f64| t > 0.0 && t <= length;
        let driven: Vec<Complex64> =
            times.iter().map(|t| if inside(*t) { (s * t).exp() } else { Complex64::ZERO }).collect();
        for (p, r) in self.distinct() {
            // The imaginary part of the response to the input is the response to its imaginary part: that of
            // the pole, and that of its conjugate, whose exponentials are conjugates, too.
            let last = (p * length).exp();
            let pair = |t: f64, driven: Complex64, free: Complex64| {
                (r * c * sum(p, t, driven, free), r.conj() * c * sum(p.conj(), t, driven, free.conj()))
            };
            let (left, conjugate) = pair(length, end, last);
            for ((t, driven), out) in times.iter().zip(&driven).zip(&mut out) {
                let (own, other) = if inside(*t) {
                    pair(*t, *driven, (p * t).exp())
                } else if *t > length {
                    let decay = (p * (t - length)).exp();
                    (left * decay, conjugate * decay.conj())
                } else {
                    continue;
                };
                *out += if p.im == 0.0 { own.im } else { own.im + other.im };
            }
        }
        out
    }

    /// Response of the parts at each of the rising `times` to values at 0, `step`, 2·`step`, … joined by
    /// straight lines, 0 elsewhere; exact for such an input.
    pub fn straight_lines(&self, input: &[f64], step: f64, times: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; times.len()];
        let pieces = input.len().saturating_sub(1);
        for (p, r) in self.distinct() {
            let whole = Advance::over(p, step);
            let mut state = Complex64::ZERO;
            let mut done = 0;
            // A pole and its conjugate have conjugate responses.
            let twice = if p.im == 0.0 { 1.0 } else { 2.0 };
            for (t, out) in times.iter().zip(&mut out) {
                if *t <= 0.0 {
                    continue;
                }
                let piece = ((t / step) as usize).min(pieces);
                while done < piece {
                    state = whole.apply(state, input[done], input[done + 1]);
                    done += 1;
                }
                let rest = t - done as f64 * step;
                let now = if done == pieces {
                    state * (p * rest).exp()
                } else {
                    let end = input[done] + (input[done + 1] - input[done]) * rest / step;
                    Advance::over(p, rest).apply(state, input[done], end)
                };
                *out += twice * (r * now).re;
            }
        }
        out
    }

    /// The parts with real poles, and one of each two with conjugate poles.
    fn distinct(&self) -> impl Iterator<Item = (Complex64, Complex64)> {
        self.parts.iter().copied().filter(|(p, _)| p.im >= 0.0)
    }
}

/// One step of y′ = py + u for u on a straight line.
struct Advance {
    decay: Complex64,
    first: Complex64,
    second: Complex64,
}

impl Advance {
    fn over(p: Complex64, h: f64) -> Advance {
        let z = p * h;
        let (first, second) = mean_exponentials(z);
        Advance { decay: z.exp(), first: h * (first - second), second: h * second }
    }

    fn apply(&self, state: Complex64, from: f64, to: f64) -> Complex64 {
        self.decay * state + self.first * from + self.second * to
    }
}

/// (e^z − 1)/z and (e^z − 1 − z)/z², by their series for small z, where the differences lose digits.
fn mean_exponentials(z: Complex64) -> (Complex64, Complex64) {
    if z.norm() < 0.1 {
        let second =
            0.5 + z * (1.0 / 6.0 + z * (1.0 / 24.0 + z * (1.0 / 120.0 + z * (1.0 / 720.0 + z / 5040.0))));
        (1.0 + z * second, second)
    } else {
        let first = (z.exp() - 1.0) / z;
        (first, (first - 1.0) / z)
    }
}
