//! A stepped-sine sweep: one force spectrum and one response spectrum per step.

use super::{Axis, Finding, Spectrum, Step, Trace, Values};
use crate::units::Unit;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Direction in which a sweep was run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// Rising frequency.
    Up,
    /// Falling frequency.
    Down,
}

impl Direction {
    /// `up` or `down`.
    pub fn name(self) -> &'static str {
        if self == Direction::Up { "up" } else { "down" }
    }
}

/// One step of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPoint {
    /// Force file; `None` where the excitation frequency is given instead.
    pub force_path: Option<PathBuf>,
    /// Response file.
    pub response_path: PathBuf,
    /// Peak amplitude of the force at each spectral line; empty without a force file.
    pub force: Values,
    /// Excitation frequency in Hz, where a hand-over file states it.
    pub given: Option<f64>,
    /// Response as peak values; complex where its phase relative to the force is known.
    pub response: Spectrum,
}

impl SweepPoint {
    /// Name of the force file, without its folder; of the response file where there is none.
    pub fn name(&self) -> String {
        let path = self.force_path.as_ref().unwrap_or(&self.response_path);
        path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
    }
}

/// Traces of force and response of one step, sampled together.
#[derive(Debug, Clone, PartialEq)]
pub struct StepTraces {
    /// File that holds both traces.
    pub path: PathBuf,
    /// Force in N.
    pub force: Trace,
    /// Response: displacement, velocity or acceleration in SI units.
    pub response: Trace,
}

/// A sweep: all steps in the order in which they were taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Name, for figures and messages.
    pub name: String,
    /// Direction, where it was stated.
    pub direction: Option<Direction>,
    /// Mass whose response was measured, where stated: 1 excited mass, 2 passive mass.
    pub mass: Option<u8>,
    /// Frequencies of the spectral lines in Hz, the same for all spectra.
    pub axis: Axis,
    /// Number of integrations over time that the analyser did in the frequency domain before it stored the
    /// response.
    pub analyser_integrated: u8,
    /// The steps in the order of the measurement.
    pub points: Vec<SweepPoint>,
    /// Findings about the sweep as a whole.
    pub findings: Vec<Finding>,
}

impl Sweep {
    /// Processing steps that led to the responses, as recorded at the first point.
    pub fn history(&self) -> &[Step] {
        self.points.first().map_or(&[], |p| &p.response.meta.history)
    }

    /// SI unit of the responses.
    pub fn unit(&self) -> Unit {
        self.points.first().map_or_else(Unit::none, |p| p.response.meta.unit.clone())
    }

    /// Distance of the spectral lines in Hz; `None` if uneven.
    pub fn line_width(&self) -> Option<f64> {
        self.axis.step()
    }
}
