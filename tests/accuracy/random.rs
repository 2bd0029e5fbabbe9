//! Random numbers that are the same on every machine.

/// A linear congruential generator (Knuth's MMIX constants); its upper 53 bits are used.
pub struct Random(pub u64);

impl Random {
    /// Uniform between `low` and `high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// Normal with mean 0 and standard deviation 1 (Box & Muller).
    pub fn normal(&mut self) -> f64 {
        let (a, b) = (self.uniform(0.0, 1.0), self.uniform(0.0, 1.0));
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }
}
