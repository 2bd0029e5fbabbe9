//! What spoils a record: noise, hum, the converter, the end of the range.

use std::f64::consts::TAU;
use vibroimpact::math::Noise;

/// Random numbers of one record, and what they decided.
pub struct Mix {
    pub random: Noise,
    /// Disturbances by name, with their size; those that the record has not are absent.
    pub named: Vec<(&'static str, f64)>,
}

impl Mix {
    pub fn new(seed: u64) -> Mix {
        Mix { random: Noise::new(seed), named: Vec::new() }
    }

    /// Between two numbers, evenly on a logarithmic scale.
    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.random.uniform())
    }

    /// True in this share of the records.
    pub fn chance(&mut self, share: f64) -> bool {
        self.random.uniform() < share
    }

    /// A property of the record that a person who debugs wants to know.
    pub fn note(&mut self, name: &'static str, size: f64) -> f64 {
        self.named.push((name, size));
        size
    }

    /// A disturbance that this share of the records has, of a size between two numbers on a logarithmic
    /// scale; 0 in the others.
    pub fn some(&mut self, share: f64, name: &'static str, low: f64, high: f64) -> f64 {
        if self.chance(share) {
            let size = self.log(low, high);
            self.note(name, size)
        } else {
            0.0
        }
    }

    /// Draws a chain: white noise of a root mean square between two parts of the peak, and in half of the
    /// records each 1/f noise up to ten times as strong, hum of 50 or 60 Hz up to 2 %, and a converter of
    /// 12 bits whose range is 1.05 to 4 times the peak.
    pub fn chain(&mut self, (low, high): (f64, f64)) -> Chain {
        let white = self.log(low, high);
        self.note("white noise", white);
        let pink = white * self.some(0.5, "1/f noise to white", 0.3, 10.0);
        let hum = self.some(0.5, "hum", 1e-4, 0.02);
        let range = self.some(0.5, "12-bit range", 1.05, 4.0);
        let mains = if self.chance(0.5) { 50.0 } else { 60.0 } + self.random.between(-0.05, 0.05);
        Chain { white, pink, hum, mains, range }
    }

    /// Passes a record through a chain of its own.
    pub fn spoil(&mut self, values: &mut [f64], rate: f64, peak: f64, noise: (f64, f64)) {
        self.chain(noise).pass(self, values, rate, peak);
    }

    pub fn add_white(&mut self, values: &mut [f64], rms: f64) {
        for v in values {
            *v += rms * self.random.normal();
        }
    }

    /// Noise of a power density that falls as 1/f from the length of the record to a third of the sampling
    /// rate: first-order processes an octave apart.
    pub fn add_pink(&mut self, values: &mut [f64], rms: f64) {
        let octaves = (values.len() as f64).log2().ceil() as i32;
        let keep: Vec<f64> = (0..octaves).map(|k| (-2.0 * 2f64.powi(-k)).exp()).collect();
        let mut states: Vec<f64> = keep.iter().map(|_| self.random.normal()).collect();
        let scale = rms / f64::from(octaves).sqrt();
        for v in values {
            for (state, keep) in states.iter_mut().zip(&keep) {
                *state = keep * *state + (1.0 - keep * keep).sqrt() * self.random.normal();
            }
            *v += scale * states.iter().sum::<f64>();
        }
    }
}

/// What stands between a motion and its record; sizes as parts of the peak, 0 for what is absent.
pub struct Chain {
    pub white: f64,
    pink: f64,
    hum: f64,
    mains: f64,
    range: f64,
}

impl Chain {
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

/// A converter of so many bits between plus and minus `range`.
pub fn convert(values: &mut [f64], range: f64, bits: i32) {
    let step = range * 2f64.powi(1 - bits);
    for v in values {
        *v = ((*v / step).round() * step).clamp(-range, range);
    }
}

/// Cuts off what is beyond plus and minus `level`.
pub fn clip(values: &mut [f64], level: f64) {
    for v in values {
        *v = v.clamp(-level, level);
    }
}

/// The largest magnitude.
pub fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, v| v.abs().max(most))
}
