//! Edges of a reference signal, below a sample.

use super::crossing;

/// Which edge of the pulse counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Edge {
    /// From low to high.
    Rising,
    /// From high to low.
    Falling,
}

/// Part of the height by which the signal must pass the middle on both sides before an edge counts: ringing of a pick-up stays below.
const HYSTERESIS: f64 = 0.2;

/// First and last crossing of the middle, and the samples around the last.
#[derive(Debug, Clone, Copy)]
struct Crossings {
    first: f64,
    last: f64,
    from: f64,
    to: f64,
}

/// Finds edges in blocks of a reference signal.
///
/// An edge is where the signal crosses the middle of its two levels; it counts once it has come from beyond a fifth of the
/// height on one side and goes beyond a fifth on the other. Noise may make it cross several times: then the mean of the
/// first and the last crossing is taken.
#[derive(Debug, Clone)]
pub(crate) struct Edges {
    sign: f64,
    middle: f64,
    margin: f64,
    /// The last four samples; the step in their middle is looked at.
    window: [f64; 4],
    seen: usize,
    armed: bool,
    crossings: Option<Crossings>,
    found: Vec<f64>,
    sharp: usize,
    slopes: f64,
}

impl Edges {
    /// Edges between two levels.
    pub fn new(low: f64, high: f64, edge: Edge) -> Edges {
        let sign = if edge == Edge::Rising { 1.0 } else { -1.0 };
        Edges {
            sign,
            middle: sign * 0.5 * (low + high),
            margin: HYSTERESIS * (high - low).abs(),
            window: [f64::NAN; 4],
            seen: 0,
            armed: false,
            crossings: None,
            found: Vec::new(),
            sharp: 0,
            slopes: 0.0,
        }
    }

    /// Takes the next samples.
    pub fn push(&mut self, block: &[f64]) {
        for v in block {
            self.next(self.sign * v);
        }
    }

    /// Takes a sample and looks at the step before the last one.
    fn next(&mut self, sample: f64) {
        let [_, from, to, last] = self.window;
        self.window = [from, to, last, sample];
        self.seen += 1;
        let [_, from, to, _] = self.window;
        if !from.is_finite() || !to.is_finite() {
            (self.armed, self.crossings) = (false, None);
            return;
        }
        if from < self.middle - self.margin {
            (self.armed, self.crossings) = (true, None);
        }
        if self.armed
            && from < self.middle
            && let Some(place) = crossing::between(&self.window, 1, self.middle)
        {
            let at = place + self.seen as f64 - 4.0;
            let first = self.crossings.map_or(at, |c| c.first);
            self.crossings = Some(Crossings { first, last: at, from, to });
        }
        if self.armed && to > self.middle + self.margin {
            if let Some(c) = self.crossings.take() {
                let margin = 1.5 * self.margin;
                self.sharp += usize::from(c.from < self.middle - margin && c.to > self.middle + margin);
                self.slopes += c.to - c.from;
                self.found.push(0.5 * (c.first + c.last));
            }
            self.armed = false;
        }
    }

    /// The edges, in samples from the first, and what is known of their times.
    pub fn finish(mut self) -> Found {
        // The last step has no sample behind it.
        self.next(f64::NAN);
        let n = self.found.len().max(1) as f64;
        Found { sharp: 2 * self.sharp > self.found.len(), slope: self.slopes / n, edges: self.found }
    }
}

/// Edges of a reference signal.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Found {
    /// Places in samples from the first.
    pub edges: Vec<f64>,
    /// Whether most edges rise within one sample, so that nothing between samples is known.
    pub sharp: bool,
    /// Mean rise a sample at the edges.
    pub slope: f64,
}

impl Found {
    /// Standard uncertainty of an edge in samples, where the reference carries noise of standard deviation `noise`.
    pub fn std(&self, noise: f64) -> f64 {
        // Two samples share the crossing; over a sample's length their mean square weight is 2/3.
        let variance = if self.slope > 0.0 { 2.0 / 3.0 * (noise / self.slope).powi(2) } else { 0.0 };
        (variance + if self.sharp { 1.0 / 12.0 } else { 0.0 }).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pulses(rate: f64, shift: f64) -> (Vec<f64>, Vec<f64>) {
        let (period, n) = (737.3 / rate, 20_000);
        let truth: Vec<f64> = (0..27).map(|k| (f64::from(k) + shift) * period * rate).collect();
        let rise = |s: f64| 0.5 + 0.5 * (s / 4.0).tanh();
        let values = (0..n)
            .map(|i| truth.iter().map(|t| rise(f64::from(i) - t) - rise(f64::from(i) - t - 60.0)).sum())
            .collect();
        (values, truth)
    }

    fn found(values: &[f64], block: usize, edge: Edge) -> Found {
        let mut edges = Edges::new(0.0, 1.0, edge);
        values.chunks(block).for_each(|b| edges.push(b));
        edges.finish()
    }

    #[test]
    fn edges_are_where_they_are_in_blocks_of_any_size() {
        let (values, truth) = pulses(102.4e3, 0.37);
        let whole = found(&values, values.len(), Edge::Rising);
        assert_eq!(whole.edges.len(), truth.len());
        for (found, truth) in whole.edges.iter().zip(&truth) {
            // The fourth derivative of tanh(s/4)/2 is at most 4.1/2/4⁴ = 0.008; a cubic through samples at a distance of 1 is
            // off by 9/16/24 of it, 2e-4, and the slope there is 1/8.
            assert!((found - truth).abs() < 1.6e-3, "{found} {truth}");
        }
        for block in [1, 2, 3, 7, 100, 4096] {
            assert_eq!(found_bits(&found(&values, block, Edge::Rising)), found_bits(&whole), "{block}");
        }
        let falling = found(&values, 999, Edge::Falling);
        for (found, truth) in falling.edges.iter().zip(&truth) {
            assert!((found - truth - 60.0).abs() < 1.6e-3);
        }
        assert!(!whole.sharp && (whole.slope - 0.125).abs() < 0.01);
    }

    fn found_bits(found: &Found) -> Vec<i64> {
        // Equal to 1e-6 of a sample: the halving stops at another place when the base is another.
        found.edges.iter().map(|e| (e * 1e6).round() as i64).collect()
    }

    #[test]
    fn chatter_missing_samples_and_half_pulses_are_no_edges() {
        let half = [0.0, 0.0, 0.6, 0.0, 0.0];
        let chatter = [0.0, 0.0, 0.55, 0.45, 0.6, 1.0, 1.0, 0.0];
        let lost = [0.0, 0.0, f64::NAN, 1.0, 1.0, 0.0];
        let mut edges = Edges::new(0.0, 1.0, Edge::Rising);
        for block in [&half[..], &chatter, &lost] {
            edges.push(block);
        }
        let found = edges.finish();
        assert_eq!(found.edges.len(), 1, "{found:?}");
        // Between the crossing in the second and the one in the fourth step of the chatter.
        assert!(found.edges[0] > 6.5 && found.edges[0] < 8.7, "{found:?}");
        let mut sharp = Edges::new(0.0, 1.0, Edge::Rising);
        sharp.push(&[0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
        let sharp = sharp.finish();
        assert!(sharp.sharp && (sharp.std(0.0) - 12f64.sqrt().recip()).abs() < 1e-12);
    }
}
