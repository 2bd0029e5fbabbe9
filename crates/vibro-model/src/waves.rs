//! Forced motion of a mass under a sum of sines.

use num_complex::Complex64;
use vibro_math::cis::sin_cos;
use vibro_math::root::Limits;

/// Most sines that can act at once.
pub(crate) const MOST_SINES: usize = 4;

/// One term Re(Xe^{iωt}) of a forced motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Wave {
    /// Re X in m.
    re: f64,
    /// Im X in m.
    im: f64,
    /// ω in rad/s.
    omega: f64,
}

/// Forced motion x(t) = Σ Re(Xe^{iωt}), with at most [`MOST_SINES`] terms.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Waves {
    terms: [Wave; MOST_SINES],
    count: usize,
    /// Σ|X| in m, a bound on |x|.
    pub amplitude: f64,
    /// Bounds Σωⁿ|X| on the derivatives of order n.
    pub limits: Limits,
}

impl Waves {
    /// Adds Re(Xe^{iωt}) with X = `start` in m and |X| = `amplitude`.
    #[inline]
    pub fn add(&mut self, start: Complex64, omega: f64, amplitude: f64) {
        let Some(free) = self.terms.get_mut(self.count) else { return };
        *free = Wave { re: start.re, im: start.im, omega };
        self.count += 1;
        let square = omega * omega;
        self.amplitude += amplitude;
        let (curvature, snap) = (amplitude * square, amplitude * square * square);
        self.limits.curvature += curvature;
        self.limits.jerk += curvature * omega;
        self.limits.snap += snap;
        self.limits.sixth += snap * square;
    }

    /// A single wave, from its complex displacement at the start.
    pub fn one(start: Complex64, omega: f64) -> Waves {
        let mut waves = Waves::default();
        waves.add(start, omega, start.norm());
        waves
    }

    /// x in m and its first five derivatives at `t` (s).
    #[inline]
    pub fn at(&self, t: f64) -> [f64; 6] {
        let mut sum = [0.0; 6];
        for wave in self.terms.iter().take(self.count) {
            let (re, im) = if t == 0.0 { (wave.re, wave.im) } else { turned(wave, t) };
            let omega = wave.omega;
            let (v, a) = (omega * im, omega * (omega * re));
            sum[0] += re;
            sum[1] -= v;
            sum[2] -= a;
            let square = omega * omega;
            sum[3] += square * v;
            sum[4] += square * a;
            sum[5] -= square * (square * v);
        }
        sum
    }

    /// Largest ω in rad/s.
    #[inline]
    pub fn fastest(&self) -> f64 {
        self.terms.iter().take(self.count).fold(0.0, |most, wave| most.max(wave.omega))
    }

    /// Adds x and its derivatives at time 0, each times its weight, to `terms`; returns a bound on the first
    /// derivative that is left out.
    #[inline]
    pub fn terms<const N: usize>(&self, weights: &[f64; N], terms: &mut [f64; N]) -> f64 {
        for wave in self.terms.iter().take(self.count) {
            let (square, mut last) = (wave.omega * wave.omega, [wave.re, -wave.omega * wave.im]);
            for (term, weight) in terms.iter_mut().zip(weights) {
                *term += last[0] * weight;
                last = [last[1], -square * last[0]];
            }
        }
        self.limits.sixth * self.fastest().powi(N as i32 - 6)
    }
}

/// Real and imaginary part of Xe^{iωt}.
#[inline]
fn turned(wave: &Wave, t: f64) -> (f64, f64) {
    let (sin, cos) = sin_cos(wave.omega * t);
    (wave.re * cos - wave.im * sin, wave.re * sin + wave.im * cos)
}
