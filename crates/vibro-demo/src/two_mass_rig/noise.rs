//! Noise that is the same on every run.

use std::f64::consts::TAU;

/// Gaussian numbers from splitmix64 (Steele, Lea, Flood 2014) by the method of Box and Muller (1958).
pub struct GaussianNoise {
    state: u64,
    spare: Option<f64>,
}

impl GaussianNoise {
    /// Noise of one channel at one point; each has its own, so that any point can be made without the others.
    /// `draw` 0 is that of the files of the example; others are as if all were measured again.
    pub fn new(draw: u64, direction: u64, point: u64, channel: u64) -> GaussianNoise {
        let state = (draw << 40) | (direction << 32) | (point << 8) | channel;
        let mut noise = GaussianNoise { state, spare: None };
        // Neighbouring seeds part after the first output.
        noise.bits();
        noise
    }

    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in 0 < u ≤ 1.
    pub fn uniform(&mut self) -> f64 {
        ((self.bits() >> 11) + 1) as f64 * f64::powi(2.0, -53)
    }

    /// Gaussian with mean 0 and variance 1.
    pub fn gaussian(&mut self) -> f64 {
        if let Some(value) = self.spare.take() {
            return value;
        }
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        let (sin, cos) = (TAU * self.uniform()).sin_cos();
        self.spare = Some(radius * sin);
        radius * cos
    }
}
