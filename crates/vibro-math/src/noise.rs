//! Random numbers from a seed.

/// Random numbers that depend on the seed only and are the same on every machine. Uniform numbers are from
/// splitmix64 (Steele, Lea and Flood 2014), normal numbers from Box and Muller (1958).
///
/// ```
/// use vibro_math::Noise;
/// let mut noise = Noise::new(7);
/// let mean = (0..10_000).map(|_| noise.normal()).sum::<f64>() / 1e4;
/// assert!(mean.abs() < 0.04); // four standard deviations
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Noise(u64);

impl Noise {
    /// The sequence of this seed.
    pub fn new(seed: u64) -> Noise {
        Noise::from_state(seed.wrapping_mul(0x2545_F491_4F6C_DD1D))
    }

    /// The sequence after this state of splitmix64, which other programs call the seed. The sequences of two
    /// states overlap if the states differ by a multiple of the generator's increment.
    pub fn from_state(state: u64) -> Noise {
        Noise(state)
    }

    /// Uniform in 0 ≤ u < 1.
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Normal with mean 0 and standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}
