//! Cycles of the excitation as a reference channel shows them.

use crate::drill::{Edge, Edges, Numbered, Survey};
use vibro_record::{Error, Finding, Result};

/// Relative standard uncertainty of a mean interval whose first and last edge, so many samples apart, each lie anywhere within one
/// sample: 1/√6 over that distance.
///
/// Where the interval is near a whole number of samples, all edges lie alike between theirs: the scatter of the intervals does not
/// show it, and no number of edges averages it.
pub fn quantised(samples: f64) -> f64 {
    1.0 / (6f64.sqrt() * samples)
}

/// Rising edges of a reference channel, one a cycle.
pub struct Reference {
    /// Cycle that each rising edge begins, and its place in samples; at least two.
    edges: Vec<(usize, f64)>,
    /// Edges that are not there.
    missing: usize,
    /// Edges that should not be there; they are passed over.
    extra: usize,
    /// Whether they rise within one sample, so that nothing is known of them between samples.
    sharp: bool,
}

impl Reference {
    /// Rising edges of a channel, numbered in cycles.
    ///
    /// # Errors
    /// Where there are fewer than two, or where they pause, so that cycles cannot be counted.
    pub fn new(channel: &[f64]) -> Result<Reference> {
        let mut survey = Survey::default();
        survey.push(channel);
        let (low, high) = survey.levels().unwrap_or_default();
        let mut edges = Edges::new(low, high, Edge::Rising);
        edges.push(channel);
        let found = edges.finish();
        let Numbered { mut runs, missing, extra, pauses } = Numbered::new(&found.edges);
        let edges = runs.pop().unwrap_or_default();
        let why = match (pauses, edges.len()) {
            (0, 2..) => return Ok(Reference { edges, missing, extra, sharp: found.sharp }),
            (0, n) => format!("rising edges of the reference channel: {n}, a cycle needs two"),
            (n, _) => format!(
                "the reference channel misses more than three edges in a row, {n} times: cycles cannot be counted across"
            ),
        };
        Err(Error::refused(why)
            .hint("name another reference channel, or state the frequency of the excitation")
            .setting("reference")
            .setting("excitation"))
    }

    /// Edges that were missing or too many.
    pub fn finding(&self) -> Option<Finding> {
        let odd =
            Finding::caution("reference-edges").count("missing", self.missing).count("extra", self.extra);
        (self.missing + self.extra > 0).then_some(odd)
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
        if self.sharp { quantised(self.span()) } else { 0.0 }
    }

    /// Mean length of a cycle in samples.
    pub fn mean_cycle(&self) -> f64 {
        let cycles = self.edges.last().map_or(0, |e| e.0) - self.edges.first().map_or(0, |e| e.0);
        self.span() / cycles as f64
    }

    /// Samples from the first to the last edge.
    fn span(&self) -> f64 {
        self.edges.last().map_or(f64::NAN, |e| e.1) - self.edges.first().map_or(f64::NAN, |e| e.1)
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
