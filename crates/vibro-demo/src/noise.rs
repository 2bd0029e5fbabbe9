//! Noise of the recordings. Each example keeps the generator with which it was first made, since documents
//! and tests quote numbers from these files.

use std::f64::consts::TAU;
use vibro_math::Noise;

/// Step of uniform numbers with 53 binary digits.
const DIGIT: f64 = 1.0 / (1u64 << 53) as f64;

/// A sum of twelve uniform numbers less six: nearly normal, of variance 1, and without a function of a
/// mathematics library, so the same on every machine.
pub fn near_normal(noise: &mut Noise) -> f64 {
    (0..12).map(|_| noise.uniform()).sum::<f64>() - 6.0
}

/// Normal numbers, made in pairs (Box and Muller 1958).
pub struct PairedNoise {
    uniform: Noise,
    spare: Option<f64>,
}

impl PairedNoise {
    /// Noise of one channel at one point. Each has its own, so that any point can be made without the others.
    /// `draw` 0 gives the files of the example, other draws repeat the measurement.
    pub fn new(draw: u64, direction: u64, point: u64, channel: u64) -> PairedNoise {
        let state = (draw << 40) | (direction << 32) | (point << 8) | channel;
        let mut noise = PairedNoise { uniform: Noise::from_state(state), spare: None };
        // The first output of neighbouring states is similar; it is skipped.
        noise.uniform();
        noise
    }

    /// Uniform in 0 < u ≤ 1.
    pub fn uniform(&mut self) -> f64 {
        self.uniform.uniform() + DIGIT
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

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// Uniform in 0 ≤ u < 1.
    pub fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 * DIGIT
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
        2.0 * ((self.0 >> 11) as f64 * DIGIT) - 1.0
    }
}
