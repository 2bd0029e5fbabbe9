//! Disturbances of simulated records: noise, mains hum, the steps of a converter, clipping.

use std::f64::consts::TAU;
use vibroimpact::math::Noise;

/// Random numbers of one record, and a log of the properties and disturbances drawn with them.
pub struct Mix {
    pub random: Noise,
    /// Names and sizes of the noted properties and of the disturbances that the record has.
    pub named: Vec<(&'static str, f64)>,
}

impl Mix {
    /// The random numbers of a seed.
    pub fn new(seed: u64) -> Mix {
        Mix { random: Noise::new(seed), named: Vec::new() }
    }

    /// A random number between two limits, evenly distributed on a logarithmic scale.
    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.random.uniform())
    }

    /// True with this probability.
    pub fn chance(&mut self, share: f64) -> bool {
        self.random.uniform() < share
    }

    /// Logs a property of the record for the list of the worst records. Returns its size.
    pub fn note(&mut self, name: &'static str, size: f64) -> f64 {
        self.named.push((name, size));
        size
    }

    /// With the probability `share`, draws and logs a disturbance whose size is uniform in the logarithm
    /// between two limits; otherwise 0.
    pub fn some(&mut self, share: f64, name: &'static str, low: f64, high: f64) -> f64 {
        if self.chance(share) {
            let size = self.log(low, high);
            self.note(name, size)
        } else {
            0.0
        }
    }

    /// Draws a measuring chain. White noise has a root mean square between `low` and `high` times the peak.
    /// Each of the following is in half of the records: 1/f noise of 0.3 to 10 times the white noise, hum at
    /// 50 or 60 Hz of up to 2 % of the peak, and a 12-bit converter with a range of 1.05 to 4 times the
    /// peak.
    pub fn chain(&mut self, (low, high): (f64, f64)) -> Chain {
        let white = self.log(low, high);
        self.note("white noise", white);
        let pink = white * self.some(0.5, "1/f noise to white", 0.3, 10.0);
        let hum = self.some(0.5, "hum", 1e-4, 0.02);
        let range = self.some(0.5, "12-bit range", 1.05, 4.0);
        let mains = if self.chance(0.5) { 50.0 } else { 60.0 } + self.random.between(-0.05, 0.05);
        Chain { white, pink, hum, mains, range }
    }

    /// Draws a measuring chain and passes a record with this peak through it.
    pub fn spoil(&mut self, values: &mut [f64], rate: f64, peak: f64, noise: (f64, f64)) {
        self.chain(noise).pass(self, values, rate, peak);
    }

    /// Adds white noise.
    pub fn add_white(&mut self, values: &mut [f64], rms: f64) {
        for v in values {
            *v += rms * self.random.normal();
        }
    }

    /// Adds noise whose power density falls as 1/f, from one over the length of the record to a third of the
    /// sampling rate: a sum of first-order processes whose corners are an octave apart.
    pub fn add_pink(&mut self, values: &mut [f64], rms: f64) {
        let processes = (values.len() as f64).log2().ceil() as i32;
        let keep: Vec<f64> = (0..processes).map(|k| (-2.0 * 2f64.powi(-k)).exp()).collect();
        let mut states: Vec<f64> = keep.iter().map(|_| self.random.normal()).collect();
        let scale = rms / f64::from(processes).sqrt();
        for v in values {
            for (state, keep) in states.iter_mut().zip(&keep) {
                *state = keep * *state + (1.0 - keep * keep).sqrt() * self.random.normal();
            }
            *v += scale * states.iter().sum::<f64>();
        }
    }
}

/// A measuring chain: it adds noise and hum to a motion and converts it. Sizes are relative to the peak; 0
/// for none.
pub struct Chain {
    /// Root mean square of the white noise.
    pub white: f64,
    /// Root mean square of the 1/f noise.
    pink: f64,
    /// Amplitude of the mains hum.
    hum: f64,
    /// Mains frequency in Hz.
    mains: f64,
    /// Range of the 12-bit converter.
    range: f64,
}

impl Chain {
    /// Passes a record through the chain; `rate` in Hz.
    pub fn pass(&self, mix: &mut Mix, values: &mut [f64], rate: f64, peak: f64) {
        mix.add_white(values, self.white * peak);
        if self.pink > 0.0 {
            mix.add_pink(values, self.pink * peak);
        }
        let phase = mix.random.between(0.0, TAU);
        for (i, v) in values.iter_mut().enumerate() {
            *v += self.hum * peak * (TAU * self.mains * i as f64 / rate + phase).cos();
        }
        if self.range > 0.0 {
            convert(values, self.range * peak, 12);
        }
    }
}

/// Rounds to the steps of a converter with this number of bits between −`range` and `range`, and clips there.
pub fn convert(values: &mut [f64], range: f64, bits: i32) {
    let step = range * 2f64.powi(1 - bits);
    for v in values {
        *v = ((*v / step).round() * step).clamp(-range, range);
    }
}

/// Clips at −`level` and `level`.
pub fn clip(values: &mut [f64], level: f64) {
    for v in values {
        *v = v.clamp(-level, level);
    }
}

/// The largest magnitude.
pub fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, v| v.abs().max(most))
}
