//! The rig that measurements were compared with, and the start values of its sliders in the report.

use crate::compare::{Overlay, Pair};
use crate::model::Rig;
use crate::record::Direction;
use serde::{Deserialize, Serialize};

/// A rig that measurements were compared with.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ComparedRig {
    /// The rig.
    pub rig: Rig,
    /// Start values of its sliders; `None` where the overlay has no range of frequencies.
    pub sliders: Option<Sliders>,
}

/// Start values of the sliders, and the measured points of the same plot. The script of the page reads the
/// fields by these names.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Sliders {
    rig: Rig,
    /// Force amplitude in N.
    force: f64,
    /// Contact stiffness in N/m; 0 where contacts are rigid.
    stiffness: f64,
    /// Frequency in Hz of the largest amplitude.
    frequency: f64,
    /// Lowest and highest frequency in Hz.
    from: f64,
    to: f64,
    /// Lower and upper limit of the amplitude axis in mm.
    low: f64,
    high: f64,
    /// Measured sweeps at one force level.
    measured: Vec<Points>,
}

/// A measured sweep in the plot of the sliders.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Points {
    name: String,
    mass: u8,
    /// Whether the frequency went down.
    down: bool,
    /// Frequencies in Hz.
    x: Vec<f64>,
    /// Amplitudes in mm.
    y: Vec<f64>,
}

impl Sliders {
    /// Start values from the first force level of an overlay; `None` where it has no range of frequencies.
    pub fn of(rig: &Rig, overlay: &Overlay, stiffness: Option<f64>) -> Option<Sliders> {
        let level = overlay.levels.first()?;
        let points = |name: &String| {
            let pairs: Vec<&Pair> = overlay.pairs.iter().filter(|pair| pair.sweep == *name).collect();
            let first = pairs.first()?;
            Some(Points {
                name: name.clone(),
                mass: first.mass,
                down: first.direction == Direction::Down,
                x: pairs.iter().map(|pair| pair.frequency).collect(),
                y: pairs.iter().map(|pair| 1e3 * pair.measured.value).collect(),
            })
        };
        let measured: Vec<Points> = level.sweeps.iter().filter_map(points).collect();
        let all = || measured.iter().flat_map(|sweep| sweep.x.iter().zip(&sweep.y));
        let (frequency, largest) = all().max_by(|a, b| a.1.total_cmp(b.1))?;
        let from = all().map(|(x, _)| *x).fold(f64::INFINITY, f64::min);
        let to = all().map(|(x, _)| *x).fold(0.0, f64::max);
        let (frequency, low, high) = (*frequency, largest * 1e-3, largest * 3.0);
        let (force, stiffness) = (level.force, stiffness.unwrap_or(0.0));
        (from < to).then_some(Sliders {
            rig: *rig,
            force,
            stiffness,
            frequency,
            from,
            to,
            low,
            high,
            measured,
        })
    }
}
