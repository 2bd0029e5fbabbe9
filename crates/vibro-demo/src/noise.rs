//! Noise of the recordings. Each example keeps the generator with which it was first made: documents and
//! tests hold numbers of these very files.

use std::f64::consts::TAU;
use vibro_math::Noise;

/// One over the number of uniform values of 53 binary digits.
const DIGIT: f64 = 1.0 / (1u64 << 53) as f64;

/// A sum of twelve uniform numbers less six, which is close to normal, of variance 1, and needs no function
/// of a mathematics library.
pub fn near_normal(noise: &mut Noise) -> f64 {
    (0..12).map(|_| noise.uniform()).sum::<f64>() - 6.0
}

/// Normal numbers in pairs (Box and Muller 1958).
pub struct PairedNoise {
    uniform: Noise,
    spare: Option<f64>,
}

impl PairedNoise {
    /// Noise of one channel at one point; each has its own, so that any point can be made without the others.
    /// `draw` 0 is that of the files of the example; others are as if all were measured again.
    pub fn new(draw: u64, direction: u64, point: u64, channel: u64) -> PairedNoise {
        let state = (draw << 40) | (direction << 32) | (point << 8) | channel;
        let mut noise = PairedNoise { uniform: Noise::from_state(state), spare: None };
        // Neighbouring states part after the first output.
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

/// Marsaglia's xorshift with a multiplication (S. Vigna, ACM Trans. Math. Softw. 42 (2016) 30).
#[derive(Debug, Clone)]
pub struct ShiftedNoise(u64);

impl ShiftedNoise {
    /// Numbers that belong to a seed.
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

    /// From 0 to 1.
    pub fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 * DIGIT
    }

    /// Normal distribution of unit variance (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }
}

/// Knuth's linear congruence of the MMIX.
pub struct LinearNoise(pub u64);

impl LinearNoise {
    /// Uniform between −1 and 1.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        2.0 * ((self.0 >> 11) as f64 * DIGIT) - 1.0
    }
}
