//! Forced motion of a mass under a sum of sines.

use super::excitation::MOST_SINES;
use crate::math::cis::sin_cos;
use num_complex::Complex64;

/// One term Re(Xe^{iωt}).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Wave {
    /// Re X in m.
    re: f64,
    /// Im X in m.
    im: f64,
    /// ω in rad/s.
    omega: f64,
}

/// x(t) = Σ Re(Xe^{iωt}), of no more than [`MOST_SINES`] terms.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Waves {
    terms: [Wave; MOST_SINES],
    count: usize,
    /// Σ|X|, Σω²|X| and Σω³|X|.
    bounds: [f64; 3],
}

impl Waves {
    /// Adds Re(Xe^{iωt}) with X = `start` in m and |X| = `amplitude`.
    #[inline]
    pub fn add(&mut self, start: Complex64, omega: f64, amplitude: f64) {
        let Some(free) = self.terms.get_mut(self.count) else { return };
        *free = Wave { re: start.re, im: start.im, omega };
        self.count += 1;
        let square = omega * omega;
        self.bounds[0] += amplitude;
        self.bounds[1] += amplitude * square;
        self.bounds[2] += amplitude * square * omega;
    }

    /// Bounds on |x|, |ẍ| and |x⃛|.
    #[inline]
    pub fn bounds(&self) -> [f64; 3] {
        self.bounds
    }

    /// Bound on |x| in m.
    #[inline]
    pub fn amplitude(&self) -> f64 {
        self.bounds[0]
    }

    /// x and its three derivatives at time 0.
    #[inline]
    pub fn start(&self) -> [f64; 4] {
        self.sum(|wave| (wave.re, wave.im))
    }

    /// x and its three derivatives at `t`.
    #[inline]
    pub fn at(&self, t: f64) -> [f64; 4] {
        self.sum(|wave| turned(wave, t))
    }

    #[inline]
    fn sum(&self, turn: impl Fn(&Wave) -> (f64, f64)) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for wave in self.terms.iter().take(self.count) {
            let (re, im) = turn(wave);
            let omega = wave.omega;
            let (v, a) = (omega * im, omega * (omega * re));
            sum[0] += re;
            sum[1] -= v;
            sum[2] -= a;
            sum[3] += omega * (omega * v);
        }
        sum
    }

    /// The `order`-th derivative at `t`, the next one, and a bound on the one after.
    #[inline]
    pub fn derivative(&self, order: u32, t: f64) -> (f64, f64, f64) {
        let mut sum = (0.0, 0.0, 0.0);
        for wave in self.terms.iter().take(self.count) {
            let (mut re, mut im) = turned(wave, t);
            for _ in 0..order {
                (re, im) = (-wave.omega * im, wave.omega * re);
            }
            sum.0 += re;
            sum.1 -= wave.omega * im;
            sum.2 += wave.re.hypot(wave.im) * wave.omega.powi(order as i32 + 2);
        }
        sum
    }
}

/// Xe^{iωt}.
#[inline]
fn turned(wave: &Wave, t: f64) -> (f64, f64) {
    let (sin, cos) = sin_cos(wave.omega * t);
    (wave.re * cos - wave.im * sin, wave.re * sin + wave.im * cos)
}
