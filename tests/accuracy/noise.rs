//! Noise that is the same on every run.

/// Numbers from splitmix64 (Steele, Lea, Flood 2014); Gaussian ones by the method of Box and Muller (1958).
pub struct Noise(u64);

impl Noise {
    /// Noise of a seed.
    pub fn new(seed: u64) -> Noise {
        let mut noise = Noise(seed);
        // Neighbouring seeds part after the first output.
        noise.bits();
        noise
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform from `low` to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (((self.bits() >> 11) + 1) as f64 * f64::powi(2.0, -53))
    }

    /// Gaussian with mean 0 and variance 1.
    pub fn gaussian(&mut self) -> f64 {
        let radius = (-2.0 * self.between(0.0, 1.0).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.between(0.0, 1.0)).cos()
    }
}
