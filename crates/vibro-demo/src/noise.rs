//! Noise of the recordings. Documents and tests quote numbers from the files of the examples, so each example
//! stays with the generator of its first version.

use std::f64::consts::TAU;
use vibro_math::Noise;

/// Step between uniform numbers of 53 binary digits.
const UNIFORM_STEP: f64 = 1.0 / (1u64 << 53) as f64;

/// A nearly normal number of variance 1: the sum of twelve uniform numbers, minus six. It uses no function of
/// a mathematics library, so it is the same on every machine.
pub fn near_normal(noise: &mut Noise) -> f64 {
    (0..12).map(|_| noise.uniform()).sum::<f64>() - 6.0
}

/// Normal numbers, made in pairs (Box and Muller 1958).
pub struct PairedNoise {
    uniform: Noise,
    /// Second number of a pair, for the next call.
    spare: Option<f64>,
}

impl PairedNoise {
    /// Noise of one channel at one point of a sweep. Each point and channel has its own seed, so that any
    /// point can be made without the others. `draw` 0 gives the files of the example; other draws repeat the
    /// measurement with other noise.
    pub fn new(draw: u64, direction: u64, point: u64, channel: u64) -> PairedNoise {
        let state = (draw << 40) | (direction << 32) | (point << 8) | channel;
        let mut noise = PairedNoise { uniform: Noise::from_state(state), spare: None };
        // The first numbers from neighbouring seeds are similar: they are skipped.
        noise.uniform();
        noise
    }

    /// Uniform in 0 < u ≤ 1.
    pub fn uniform(&mut self) -> f64 {
        self.uniform.uniform() + UNIFORM_STEP
    }

    /// Normal with mean 0 and variance 1.
    pub fn normal(&mut self) -> f64 {
        if let Some(value) = self.spare.take() {
            return value;
        }
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        let (sin, cos) = (TAU * self.uniform()).sin_cos();
        self.spare = Some(radius * sin);
        radius * cos
    }
}

/// Marsaglia's xorshift followed by a multiplication (S. Vigna, ACM Trans. Math. Softw. 42 (2016) 30).
#[derive(Debug, Clone)]
pub struct ShiftedNoise(u64);

impl ShiftedNoise {
    /// The numbers of a seed.
    pub fn new(seed: u64) -> ShiftedNoise {
        let mut noise = ShiftedNoise(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        for _ in 0..8 {
            noise.next();
        }
        noise
    }

    /// The next 64 random bits.
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// Uniform in 0 ≤ u < 1.
    pub fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 * UNIFORM_STEP
    }

    /// Normal distribution of unit variance (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }
}

/// Linear congruential generator with the constants of Knuth's MMIX.
pub struct LinearNoise(pub u64);

impl LinearNoise {
    /// Uniform between −1 and 1.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        2.0 * ((self.0 >> 11) as f64 * UNIFORM_STEP) - 1.0
    }
}
