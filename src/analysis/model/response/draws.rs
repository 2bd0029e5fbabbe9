//! Monte Carlo of a response: each cell is the response of one rig, whose parameters are drawn.

use super::{Bands, Curve};
use crate::analysis::answer::Answer;
use crate::analysis::drawn::Drawn;
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

/// Fewest draws: of 100 draws the outermost 2.5 % at each end are two or three.
const FEWEST: u64 = 100;
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
        let most = MOST / curve.points.max(1) as u64;
        if !(FEWEST..=most).contains(&draws) {
            let expected = format!("{FEWEST} to {most} draws of {} frequencies", curve.points);
            return Err(Error::usage(format!("{draws} draws"), expected));
        }
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
        let amplitudes = self.amplitudes(number)?;
        Ok(amplitudes.iter().flatten().flat_map(|amplitude| amplitude.to_le_bytes()).collect())
    }

    fn answer(&self, cells: &mut Cells<'_>) -> Result<Answer> {
        let Curve { rig, excitation, from, to, points, uncertainty, .. } = &self.curve;
        let frequency = (0..*points).map(axis(*from, *to, *points, MOST_POINTS)?).collect();
        let mut of_frequency: Vec<[Vec<f64>; 3]> = vec![Default::default(); *points];
        for cell in cells {
            let cell = cell?;
            let (numbers, rest) = cell.as_chunks::<8>();
            if numbers.len() != 3 * points || !rest.is_empty() {
                return Err(Error::refused("a cell of the part is no response"));
            }
            for (values, numbers) in of_frequency.iter_mut().zip(numbers.chunks(3)) {
                for (values, number) in values.iter_mut().zip(numbers) {
                    values.push(f64::from_le_bytes(*number));
                }
            }
        }
        let drawn = Drawn::all(&uncertainty.unwrap_or_default(), rig, excitation);
        self.curve.answer(Some(&Bands::of(frequency, of_frequency, self.draws, drawn)))
    }
}
