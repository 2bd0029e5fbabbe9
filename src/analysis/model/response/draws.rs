//! Monte Carlo of a response: each cell is the response of one rig, whose parameters are drawn.

use super::{Bands, Curve};
use crate::analysis::answer::Answer;
use crate::analysis::drawn::{Drawn, by_place, check_draws, packed};
use crate::analysis::study::{Cells, Study};
use crate::error::{Error, Result};
use crate::model::response::{MOST_POINTS, axis};
use crate::model::{Orbit, orbits_of};
use serde::{Deserialize, Serialize};

/// Responses of rigs with drawn parameters.
///
/// Source: JCGM 101:2008, chapter 7.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Draws {
    curve: Curve,
    draws: u64,
}

/// Most draws times frequencies: their amplitudes take 2.4 GB.
const MOST: u64 = 100_000_000;

/// Amplitudes in m at one frequency: half the peak-to-peak value of x₁ and x₂ in the stable motion with
/// impacts, and of x₁ in the motion without; NaN where there is no such motion.
pub type Amplitudes = [f64; 3];

impl Draws {
    /// A number of draws.
    ///
    /// # Errors
    /// If no uncertainty is stated, or the number is too small or too large.
    pub(super) fn of(curve: Curve, draws: u64) -> Result<Draws> {
        let uncertainty = curve.uncertainty.filter(|stated| stated.all().any(|(_, std)| std > 0.0));
        let Some(uncertainty) = uncertainty else {
            let hint = "--set uncertainty.gap=1e-5, or a table [uncertainty] in the rig's file";
            return Err(Error::usage("no uncertainty to draw from", "that of a parameter").hint(hint));
        };
        check_draws(draws, MOST, curve.points as u64, "frequencies")?;
        uncertainty.drawn(&curve.rig, &curve.excitation, 0)?;
        Ok(Draws { curve, draws })
    }

    /// Amplitudes at all frequencies with the parameters of a draw.
    fn amplitudes(&self, number: u64) -> Result<Vec<Amplitudes>> {
        let Curve { rig, excitation, from, to, points, cycles, .. } = &self.curve;
        let (rig, excitation) = self.curve.uncertainty.unwrap_or_default().drawn(rig, excitation, number)?;
        let frequency = axis(*from, *to, *points, MOST_POINTS)?;
        let at = |i: usize| {
            let Ok(found) = orbits_of(&rig, &excitation.at_frequency(frequency(i)), *cycles) else {
                return [f64::NAN; 3];
            };
            let is_stable =
                |o: &&Orbit| o.validity.exists && o.validity.admissible && o.validity.stable == Some(true);
            let impacting = found.orbits.iter().find(is_stable);
            let [x1, x2] = impacting.map_or([f64::NAN; 2], |o| o.peak_to_peak.map(|p| p / 2.0));
            let free = Some(found.no_impact).filter(|n| n.possible).map_or(f64::NAN, |n| n.amplitude);
            [x1, x2, free]
        };
        Ok((0..*points).map(at).collect())
    }
}

impl Study for Draws {
    fn what(&self) -> &'static str {
        "draws"
    }

    fn cells(&self) -> u64 {
        self.draws
    }

    fn cell(&self, number: u64) -> Result<Vec<u8>> {
        Ok(packed(self.amplitudes(number)?.into_iter().flatten()))
    }

    fn answer(&self, cells: &mut Cells<'_>) -> Result<Answer> {
        let Curve { rig, excitation, from, to, points, uncertainty, .. } = &self.curve;
        let frequency = (0..*points).map(axis(*from, *to, *points, MOST_POINTS)?).collect();
        let mut places = by_place(cells, 3 * points)?.into_iter();
        let of_frequency =
            std::iter::from_fn(|| Some([places.next()?, places.next()?, places.next()?])).collect();
        let drawn = Drawn::all(&uncertainty.unwrap_or_default(), rig, excitation);
        self.curve.answer(Some(&Bands::of(frequency, of_frequency, self.draws, drawn)))
    }
}
