//! Cycles of the excitation as a reference channel shows them.

use crate::drill::{Edge, Edges, Numbered, levels};
use vibro_record::{Error, Result};

/// Relative standard uncertainty of a mean interval whose first and last edge, so many samples apart, each lie anywhere within one
/// sample: 1/√6 over that distance.
///
/// Where the interval is near a whole number of samples, all edges lie alike between theirs: the scatter of the intervals does not
/// show it, and no number of edges averages it.
pub(crate) fn quantised(samples: f64) -> f64 {
    1.0 / (6f64.sqrt() * samples)
}

/// Rising edges of a reference channel, one a cycle.
pub struct Reference {
    /// Cycle that each rising edge begins, and its place in samples; at least two.
    edges: Vec<(usize, f64)>,
    /// Edges that are not there.
    pub missing: usize,
    /// Edges that should not be there; they are passed over.
    pub extra: usize,
    /// Whether they rise within one sample, so that nothing is known of them between samples.
    sharp: bool,
}

impl Reference {
    /// Rising edges of a channel, numbered in cycles.
    ///
    /// # Errors
    /// Where there are fewer than two, or where they pause, so that cycles cannot be counted.
    pub fn new(channel: &[f64]) -> Result<Reference> {
        let refused = |why: String| {
            Err(Error::refused(why)
                .hint("name another reference channel, or state the frequency of the excitation")
                .setting("reference")
                .setting("excitation"))
        };
        let Some(levels) = levels(channel) else {
            return refused("the reference channel has one level only: it shows no cycle".to_owned());
        };
        let found = Edges::of(channel, levels, Edge::Rising);
        let Numbered { mut runs, missing, extra } = Numbered::new(&found.at);
        let edges = runs.pop().unwrap_or_default();
        let pauses = runs.len();
        if pauses > 0 {
            return refused(format!(
                "the reference channel misses more than three edges in a row, {pauses} times: cycles cannot be counted across"
            ));
        }
        if edges.len() < 2 {
            return refused(format!(
                "rising edges of the reference channel: {}, a cycle needs two",
                edges.len()
            ));
        }
        Ok(Reference { edges, missing, extra, sharp: found.sharp })
    }

    /// Position `t` in samples, counted in cycles; beyond the first and last edge by the mean cycle.
    pub fn counted(&self, t: f64) -> f64 {
        let after = self.edges.partition_point(|e| e.1 <= t);
        let before = after.checked_sub(1).and_then(|i| self.edges.get(i));
        match (before, self.edges.get(after)) {
            (Some(a), Some(b)) => a.0 as f64 + (b.0 - a.0) as f64 * (t - a.1) / (b.1 - a.1),
            (Some(e), None) | (None, Some(e)) => e.0 as f64 + (t - e.1) / self.mean_cycle(),
            (None, None) => f64::NAN,
        }
    }

    /// Relative standard uncertainty of the mean cycle from samples that stand still to it: see [`quantised`].
    pub fn std(&self) -> f64 {
        match self.edges.as_slice() {
            [first, .., last] if self.sharp => quantised(last.1 - first.1),
            _ => 0.0,
        }
    }

    /// Mean length of a cycle in samples.
    pub(crate) fn mean_cycle(&self) -> f64 {
        match self.edges.as_slice() {
            [first, .., last] => (last.1 - first.1) / (last.0 - first.0) as f64,
            _ => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn edges_of_a_noisy_sine_are_counted_once_a_cycle() {
        let sine: Vec<f64> = (0..1000)
            .map(|i| (TAU * f64::from(i) / 100.0 - 1.0).sin() + 0.05 * (f64::from(i) * 2.7).sin())
            .collect();
        let found = Reference::new(&sine).unwrap();
        assert_eq!((found.edges.len(), found.missing, found.extra), (10, 0, 0));
        // The ripple moves a crossing of slope 0.063 a sample by 0.05/0.063 = 0.8 samples at most; ten of them 1.6/9.
        assert!((found.mean_cycle() - 100.0).abs() < 0.18, "{:?}", found.edges);
        assert!((found.counted(found.edges[3].1 + 50.0) - 3.5).abs() < 0.02);
        assert!(Reference::new(&[0.0; 9]).is_err());
    }

    #[test]
    fn a_lost_pulse_and_a_glitch_leave_the_cycles_as_they_are() {
        let mut pulses: Vec<f64> = (0..15_000).map(|i| if i % 100 < 20 { 1.0 } else { 0.0 }).collect();
        pulses[5_000..5_020].fill(0.0);
        pulses[7_350] = 9.0;
        let found = Reference::new(&pulses).unwrap();
        assert_eq!((found.missing, found.extra), (1, 1));
        // All edges are between samples 99 and 100: equal but for roundings of the bisection (1e-6 of a sample).
        assert!((found.mean_cycle() - 100.0).abs() < 1e-5, "{}", found.mean_cycle());
        // The record begins high, so the first edge is at 99.5.
        assert!((found.counted(12_049.5) - 119.5).abs() < 1e-5, "{}", found.counted(12_049.5));
        pulses[5_000..6_000].fill(0.0);
        let why = Reference::new(&pulses).err().map(|e| e.to_string()).unwrap_or_default();
        assert!(why.contains("cannot be counted"), "{why}");
    }
}
