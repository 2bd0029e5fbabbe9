//! Lines of constant frequency, such as mains hum, in the spectra of a sweep. Where the excitation passes
//! such a line, the spectrum of that step alone cannot separate the two.

use crate::line::interpolate;
use crate::noise;
use vibro_record::{Window, median, sort_by_number};
use vibro_signal::window::line_shape;

/// Least height of a line over the noise of one component.
const ABOVE: f64 = 5.0;
/// Lines on either side of a step's excitation that belong to the excitation.
const OWN: f64 = 4.0;
/// Widest scatter of the positions of one steady line over the steps, in lines: three times the scatter that
/// noise gives a line of height [`ABOVE`].
const STILL: f64 = 0.5;
/// Fewest steps that show a steady line; and of the steps with the excitation elsewhere, the least fraction
/// that must show it.
const STEPS: usize = 5;
const PART: f64 = 0.5;

/// A line of constant frequency over a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SteadyLine {
    /// Position in lines.
    pub position: f64,
    /// Median amplitude over the steps whose excitation is elsewhere, in the unit of the spectra.
    pub amplitude: f64,
}

impl SteadyLine {
    /// Steady lines near the excitations of a sweep: `spectra` hold the magnitudes of each step,
    /// `excitations` its excitation in lines.
    pub fn of(spectra: &[Vec<f64>], excitations: &[f64], window: Option<Window>) -> Vec<SteadyLine> {
        let Some(window) = window else { return Vec::new() };
        let near = |k: usize| excitations.iter().any(|at| (k as f64 - at).abs() < OWN);
        let count = spectra.iter().map(Vec::len).max().unwrap_or(0);
        let candidates: Vec<usize> = (1..count.saturating_sub(1)).filter(|k| near(*k)).collect();
        // Position and amplitude of each line that stands out. Two maxima of one step have a lower line
        // between them, so a group within [`STILL`] has at most one line of each step.
        let mut seen: Vec<(f64, f64)> = Vec::new();
        for (lines, at) in spectra.iter().zip(excitations) {
            let inside = candidates.iter().filter(|k| **k + 1 < lines.len() && (**k as f64 - at).abs() > OWN);
            for &k in inside.filter(|k| lines[**k] > lines[**k - 1] && lines[**k] >= lines[**k + 1]) {
                let floor = noise::around(lines, k, noise::REACH, Some(window));
                let line = interpolate(lines, k, Some(window), floor);
                let clear = line.zip(floor).filter(|(line, floor)| line.amplitude > ABOVE * floor);
                seen.extend(clear.map(|(line, _)| (line.position, line.amplitude)));
            }
        }
        sort_by_number(&mut seen, |a| a.0);
        let elsewhere =
            |position: f64| excitations.iter().filter(|at| (*at - position).abs() > OWN + 1.0).count();
        let mut found = Vec::new();
        let mut first = 0;
        while first < seen.len() {
            let end = seen.partition_point(|line| line.0 <= seen[first].0 + STILL);
            let group = &seen[first..end];
            let position = group[group.len() / 2].0;
            if group.len() >= STEPS && group.len() as f64 >= PART * elsewhere(position) as f64 {
                found.push(SteadyLine { position, amplitude: median(group.iter().map(|line| line.1)) });
                first = end;
            } else {
                first += 1;
            }
        }
        found
    }

    /// Standard deviation of one component that this line, whose phase against the excitation is not known,
    /// adds `position` lines from 0.
    pub fn at(&self, position: f64, window: Option<Window>) -> f64 {
        let distance = position - self.position;
        let reached = window.filter(|_| distance.abs() < OWN);
        reached.map_or(0.0, |w| self.amplitude * line_shape(w, distance).abs() / 2f64.sqrt())
    }
}
