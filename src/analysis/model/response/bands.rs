//! Bands of a response: where 95 % of the drawn rigs lie.

use crate::analysis::answer::{Answer, unwritten};
use crate::analysis::drawn::{Drawn, MOST_DRAWS, coverage_interval, drawn_findings};
use crate::error::Result;
use crate::report::layout::table;
use serde::Serialize;

/// Amplitudes of one kind of motion at one frequency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Band {
    /// Part of the draws that have this motion.
    pub share: f64,
    /// Half the peak-to-peak value of x₁ in m of the draws that have it: lower end, median and upper end of
    /// the 95 % coverage interval.
    pub x1: [f64; 3],
    /// The same of x₂; without impacts it rests.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x2: Option<[f64; 3]>,
}

/// Bands at one frequency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BandPoint {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Stable motion with one impact a period.
    pub impacting: Band,
    /// Motion without impacts.
    pub no_impact: Band,
}

/// Bands over frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Bands {
    /// Frequency by frequency.
    pub points: Vec<BandPoint>,
    draws: u64,
    /// Names of the drawn parameters.
    drawn: Vec<Drawn>,
}

impl Bands {
    /// Bands of the amplitudes of all draws: for each frequency those of x₁ and x₂ with impacts and of x₁
    /// without.
    pub(super) fn of(
        frequency: Vec<f64>,
        amplitudes: Vec<[Vec<f64>; 3]>,
        draws: u64,
        drawn: Vec<Drawn>,
    ) -> Bands {
        let band = |x1: &[f64], x2: Option<&[f64]>| Band {
            share: x1.iter().filter(|amplitude| amplitude.is_finite()).count() as f64 / draws as f64,
            x1: coverage_interval(x1),
            x2: x2.map(coverage_interval),
        };
        let points = frequency.into_iter().zip(amplitudes).map(|(frequency, [x1, x2, free])| BandPoint {
            frequency,
            impacting: band(&x1, Some(&x2)),
            no_impact: band(&free, None),
        });
        Bands { points: points.collect(), draws, drawn }
    }

    /// Adds them to an answer.
    pub(super) fn add_to(&self, answer: &mut Answer) -> Result<()> {
        let bands = serde_json::to_value(&self.points).map_err(unwritten)?;
        answer.result.insert("draws".to_owned(), self.draws.into());
        answer.result.insert("bands".to_owned(), bands);
        let whole = self.points.iter().all(|p| p.impacting.share == 0.0 || p.impacting.share >= MOST_DRAWS);
        answer.add("", drawn_findings(self.draws, &self.drawn, whole));
        let table = table(
            "Bands",
            &self.points,
            &[
                ("frequency", "Hz", &|p| p.frequency.into()),
                ("impacting, part of draws", "", &|p| p.impacting.share.into()),
                ("impacting x1 half p-p, 2.5 %", "m", &|p| p.impacting.x1[0].into()),
                ("impacting x1 half p-p, median", "m", &|p| p.impacting.x1[1].into()),
                ("impacting x1 half p-p, 97.5 %", "m", &|p| p.impacting.x1[2].into()),
                ("impacting x2 half p-p, 2.5 %", "m", &|p| p.impacting.x2.map(|x| x[0]).into()),
                ("impacting x2 half p-p, median", "m", &|p| p.impacting.x2.map(|x| x[1]).into()),
                ("impacting x2 half p-p, 97.5 %", "m", &|p| p.impacting.x2.map(|x| x[2]).into()),
                ("no impact, part of draws", "", &|p| p.no_impact.share.into()),
                ("no impact x1 half p-p, 2.5 %", "m", &|p| p.no_impact.x1[0].into()),
                ("no impact x1 half p-p, median", "m", &|p| p.no_impact.x1[1].into()),
                ("no impact x1 half p-p, 97.5 %", "m", &|p| p.no_impact.x1[2].into()),
            ],
        );
        answer.csv("bands", &table);
        Ok(())
    }
}
