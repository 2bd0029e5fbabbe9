//! Sums and ranges of long records, computed in eight lanes that a processor works on in parallel. The order
//! of the operations is fixed, so that the result does not depend on the processor.

/// Number of lanes: lane k takes the values k, k + 8, k + 16, …
const LANES: usize = 8;

/// Sum of the values. Its rounding error grows with n/8 for n values, since each lane adds an eighth of them.
pub fn sum(values: &[f64]) -> f64 {
    let (chunks, rest) = values.as_chunks::<LANES>();
    let mut lanes = [0.0; LANES];
    for chunk in chunks {
        for (lane, v) in lanes.iter_mut().zip(chunk) {
            *lane += v;
        }
    }
    lanes.iter().sum::<f64>() + rest.iter().sum::<f64>()
}

/// Range of values, and whether all are finite: the result of [`survey`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Survey {
    /// Smallest value, ignoring missing ones (NaN); ∞ if there is none.
    pub low: f64,
    /// Largest value, ignoring missing ones; −∞ if there is none.
    pub high: f64,
    /// Whether every value is a number: neither missing nor infinite.
    pub finite: bool,
}

/// Computes the survey in one pass.
pub fn survey(values: &[f64]) -> Survey {
    let (chunks, rest) = values.as_chunks::<LANES>();
    let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    let mut lanes = [0.0; LANES];
    for chunk in chunks {
        for (i, v) in chunk.iter().enumerate() {
            low[i] = if *v < low[i] { *v } else { low[i] };
            high[i] = if *v > high[i] { *v } else { high[i] };
            // Adds 0 for a number, NaN for anything else.
            lanes[i] += v * 0.0;
        }
    }
    Survey {
        low: low.iter().chain(rest).copied().fold(f64::INFINITY, f64::min),
        high: high.iter().chain(rest).copied().fold(f64::NEG_INFINITY, f64::max),
        finite: lanes.iter().all(|v| *v == 0.0) && rest.iter().all(|v| v.is_finite()),
    }
}

/// Number of values in a block of [`Extremes::take`]. The block is still in the processor's cache when the
/// position of its largest magnitude is searched.
const BLOCK: usize = 4096;

/// Largest number of first values that [`Extremes`] keep. Relations between channels, such as a magnitude and
/// its components, show in this many rows.
pub const FIRST_VALUES: usize = 1 << 14;

/// Smallest and largest value of a channel that may be read block by block, ignoring missing values (NaN),
/// and its first values.
#[derive(Debug, Clone, PartialEq)]
pub struct Extremes {
    low: f64,
    high: f64,
    /// Number of values so far.
    n: usize,
    /// Index of the first value of largest magnitude.
    at: usize,
    finite: bool,
    /// The first values, at most [`FIRST_VALUES`].
    first_values: Vec<f64>,
}

impl Extremes {
    /// The extremes of no values.
    pub const NONE: Extremes = Extremes {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
        n: 0,
        at: 0,
        finite: true,
        first_values: Vec::new(),
    };

    /// The extremes of these values.
    pub fn of(values: &[f64]) -> Extremes {
        let mut all = Extremes::NONE;
        all.take(values);
        all
    }

    /// Adds the next values.
    pub fn take(&mut self, values: &[f64]) {
        for block in values.chunks(BLOCK) {
            let Survey { low, high, finite } = survey(block);
            let size = high.max(-low);
            let at = if size > self.size() { block.iter().position(|v| v.abs() == size) } else { None };
            let (at, first_values) = (at.unwrap_or_default(), Vec::new());
            self.keep_first(block);
            self.join(&Extremes { low, high, n: block.len(), at, finite, first_values });
        }
    }

    /// Adds the extremes of the values that follow.
    pub fn join(&mut self, next: &Extremes) {
        self.keep_first(&next.first_values);
        if next.size() > self.size() {
            self.at = self.n + next.at;
        }
        self.low = self.low.min(next.low);
        self.high = self.high.max(next.high);
        self.n += next.n;
        self.finite &= next.finite;
    }

    /// Appends the next values to the first ones, up to [`FIRST_VALUES`] in all.
    fn keep_first(&mut self, next: &[f64]) {
        self.first_values.extend(next.iter().take(FIRST_VALUES - self.first_values.len()));
    }

    /// The first values, at most [`FIRST_VALUES`].
    pub fn first_values(&self) -> &[f64] {
        &self.first_values
    }

    /// Largest magnitude; −∞ if there is no value.
    fn size(&self) -> f64 {
        self.high.max(-self.low)
    }

    /// Number of values, including missing ones.
    #[allow(clippy::len_without_is_empty)] // never needed
    pub fn len(&self) -> usize {
        self.n
    }

    /// Whether every value is a number: neither missing nor infinite.
    pub fn finite(&self) -> bool {
        self.finite
    }

    /// Both extremes and the first values, to be multiplied by a factor above 0.
    pub fn values_mut(&mut self) -> [&mut [f64]; 3] {
        [std::slice::from_mut(&mut self.low), std::slice::from_mut(&mut self.high), &mut self.first_values]
    }

    /// Smallest and largest value; `None` if there is none.
    pub fn range(&self) -> Option<(f64, f64)> {
        (self.low <= self.high).then_some((self.low, self.high))
    }

    /// Index of the first value of largest magnitude, and this magnitude; `None` if there is no value.
    pub fn largest(&self) -> Option<(usize, f64)> {
        self.range().map(|_| (self.at, self.size()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_agree_with_one_value_after_the_other() {
        for n in [0, 1, 7, 8, 9, 1003] {
            let values: Vec<f64> = (0..n).map(|i: u32| f64::from((i * 7919 + 13) % 1009) - 500.0).collect();
            // Whole numbers: exact in any order.
            assert_eq!(sum(&values), values.iter().sum::<f64>());
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            assert_eq!(survey(&values), Survey { low, high, finite: true });
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                for at in [0, n as usize / 2, n as usize - usize::from(n > 0)] {
                    let mut values = values.clone();
                    if let Some(v) = values.get_mut(at) {
                        *v = bad;
                        assert!(!survey(&values).finite);
                    }
                }
            }
        }
        let values: Vec<f64> =
            (0..3 * FIRST_VALUES / 2).map(|i| ((i * 7919) % 1009) as f64 - 600.0).collect();
        let mut parts = Extremes::NONE;
        values.chunks(1000).for_each(|part| parts.take(part));
        assert_eq!(parts, Extremes::of(&values));
        assert_eq!(parts.first_values(), &values[..values.len().min(FIRST_VALUES)]);
        let (mut joined, behind) = (Extremes::of(&values[..700]), Extremes::of(&values[700..]));
        joined.join(&behind);
        assert_eq!((&joined, joined.len(), joined.finite()), (&parts, values.len(), true));
        joined.take(&[f64::NAN]);
        assert!(!joined.finite());
        let first = values.iter().position(|v| *v == -600.0).unwrap();
        assert_eq!((parts.range(), parts.largest()), (Some((-600.0, 408.0)), Some((first, 600.0))));
        assert_eq!([Extremes::of(&[f64::NAN]).range(), Extremes::NONE.range()], [None; 2]);
        assert_eq!(survey(&[1.0, f64::NAN, 3.0]), Survey { low: 1.0, high: 3.0, finite: false });
    }
}
