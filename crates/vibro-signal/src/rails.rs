//! The ends of a channel's range, and whether the signal is clipped at them.

/// Fewest equal samples in a row at an extreme that count as clipped.
const CLIPPED: usize = 3;
/// Largest fall, in steps of the converter, from a run of three or more equal samples at the crest of a sine
/// to its neighbours, if the sine is not clipped: (5/3)² for a run of three, and noise.
const ROUNDED: f64 = 8.0;
/// Fewest steps of the converter from the signal's level to its extreme, assumed where a record shows only
/// few different values.
const COARSEST: f64 = 250.0;

/// Smallest and largest value of samples that come one by one, and how steeply the signal leaves them.
///
/// A slow vibration in coarse steps rests at its extreme, too, but leaves it by a few steps. A clipped signal
/// leaves it as steeply as it came.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rails {
    /// Largest and smallest value.
    ends: [Rail; 2],
    /// The value before the present run of equal values, the value of the run, and its length in samples.
    before: f64,
    last: f64,
    run: usize,
    /// Smallest step between neighbours that differ, an estimate of the converter's step.
    step: f64,
    /// Runs of at least three equal values, at any level.
    flats: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Rail {
    value: f64,
    /// Samples at this value.
    count: usize,
    /// Largest step before or after a run of at least three of them.
    fall: f64,
    /// Number of these runs.
    flats: usize,
}

impl Default for Rails {
    fn default() -> Rails {
        let end = |value| Rail { value, count: 0, fall: 0.0, flats: 0 };
        let ends = [end(f64::NEG_INFINITY), end(f64::INFINITY)];
        Rails { ends, before: f64::NAN, last: f64::NAN, run: 0, step: f64::INFINITY, flats: 0 }
    }
}

impl Rails {
    /// Takes samples that follow the earlier ones.
    pub fn extend(&mut self, values: &[f64]) {
        for v in values {
            if *v != self.last {
                self.leave(*v);
                self.step = self.step.min((v - self.last).abs());
                (self.before, self.last, self.run) = (self.last, *v, 0);
            }
            self.run += 1;
            let [high, low] = &mut self.ends;
            if *v >= high.value {
                high.reach(*v);
            }
            if *v <= low.value {
                low.reach(*v);
            }
        }
    }

    /// Largest and smallest value.
    pub fn range(&self) -> [f64; 2] {
        self.ends.map(|end| end.value)
    }

    /// Ends of the range at which the signal is clipped, with their number of samples. A signal that has as
    /// many flat runs at other levels comes from a sample-and-hold, and is not clipped. `reach` is the
    /// largest distance of the signal from its own level if few of its values are known, else infinite.
    pub fn clipped(&self, reach: f64) -> impl Iterator<Item = (f64, usize)> {
        let mut all = *self;
        all.leave(f64::NAN);
        let step = self.step.min(reach / COARSEST).max(0.0);
        let elsewhere = all.flats.saturating_sub(all.ends.iter().map(|end| end.flats).sum());
        let rests = move |end: &Rail| end.fall > ROUNDED * step && end.flats > elsewhere;
        all.ends.into_iter().filter(rests).map(|end| (end.value, end.count))
    }

    /// Ends the present run, which `next` follows.
    fn leave(&mut self, next: f64) {
        if self.run < CLIPPED {
            return;
        }
        // NaN, before the first and after the last run, counts as no step.
        let fall = (self.before - self.last).abs().max((next - self.last).abs());
        self.flats += 1;
        for end in self.ends.iter_mut().filter(|end| end.value == self.last) {
            (end.fall, end.flats) = (end.fall.max(fall), end.flats + 1);
        }
    }
}

impl Rail {
    fn reach(&mut self, value: f64) {
        if value != self.value {
            *self = Rail { value, count: 0, fall: 0.0, flats: 0 };
        }
        self.count += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn of(values: &[f64]) -> Vec<(f64, usize)> {
        let mut rails = Rails::default();
        // The result does not depend on the length of the blocks.
        for block in values.chunks(7) {
            rails.extend(block);
        }
        let [high, low] = rails.range();
        let mut at_once = Rails::default();
        at_once.extend(values);
        // Compared as text, in which NaN equals itself.
        assert_eq!(format!("{rails:?}"), format!("{at_once:?}"));
        let known = rails.clipped(f64::INFINITY).collect();
        assert!(values.len() < 100 || rails.clipped(high.max(-low)).count() >= Vec::len(&known));
        known
    }

    #[test]
    fn a_flat_top_is_a_rail_and_a_coarse_crest_is_none() {
        let sine = |period: f64| (0..4000).map(move |i| (TAU * f64::from(i) / period).sin());
        let cut: Vec<f64> = sine(40.3).map(|v| v.min(0.7)).collect();
        assert_eq!(of(&cut), [(0.7, cut.iter().filter(|v| **v == 0.7).count())]);
        let both: Vec<f64> = sine(40.3).map(|v| v.clamp(-0.7, 0.7)).collect();
        assert_eq!(of(&both).len(), 2);
        assert!(of(&sine(40.3).collect::<Vec<f64>>()).is_empty());
        // Eight bits at 400 samples a period: a crest rests for 25 samples on its last step.
        let coarse: Vec<f64> = sine(400.0).map(|v| (127.0 * v).round()).collect();
        assert!(of(&coarse).is_empty(), "{:?}", of(&coarse));
        // The same in a sixth of the steps, and through a converter that holds its values for ten samples.
        let small: Vec<f64> = sine(400.0).map(|v| (20.0 * v).round()).collect();
        assert!(of(&small).is_empty(), "{:?}", of(&small));
        let held: Vec<f64> = (0..4000).map(|i| (TAU * f64::from(i / 10 * 10) / 403.0).sin()).collect();
        assert!(of(&held).is_empty(), "{:?}", of(&held));
        // A clipping level that is reached once, in three samples at the end.
        assert_eq!(of(&[0.0, 0.01, 0.02, 1.0, 1.0, 1.0]), [(1.0, 3)]);
        assert!(of(&[]).is_empty() && of(&[1.0; 9]).is_empty());
    }
}
