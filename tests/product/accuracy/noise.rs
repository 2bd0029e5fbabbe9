//! Random numbers with a seed, the same on every machine.

pub use vibroimpact::math::Noise;
