//! Monte Carlo of an overlay: each cell is the prediction of one rig, whose parameters are drawn.

use super::modelled::{answered, overlaid, predicting, stated_rig};
use super::responses;
use crate::analysis::answer::{Answer, unwritten};
use crate::analysis::drawn::{
    Drawn, MOST_DRAWS, by_place, check_draws, coverage_interval, drawn_findings, packed,
};
use crate::analysis::open_in;
use crate::analysis::study::{Cells, Study};
use crate::campaign::Campaign;
use crate::compare::{Overlay, Pair, predicted};
use crate::error::{Error, Result};
use crate::measure::response::Response;
use crate::model::{Excitation, Rig, Sine, Uncertainty};
use crate::read::{Folder, hexadecimal};
use crate::record::shown;
use crate::report::Cell;
use crate::report::layout::table;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::path::PathBuf;
use std::sync::OnceLock;

/// Predictions of rigs with drawn parameters, at the points of the measured sweeps of a campaign.
///
/// Source: JCGM 101:2008, chapter 7.
#[derive(Debug, Serialize, Deserialize)]
pub struct PairDraws {
    draws: u64,
    /// SHA-256 of the campaign's file, of the measured amplitudes and of the predicted ones.
    measured: String,
    /// Where the campaign lies: it changes no number.
    place: CampaignPlace,
    #[serde(skip)]
    loaded: OnceLock<Box<Loaded>>,
}

/// Where a campaign lies.
#[derive(Debug, Serialize, Deserialize)]
struct CampaignPlace {
    path: PathBuf,
    allow_outside: bool,
}

/// A campaign with its responses, and the overlay of its rig.
#[derive(Debug)]
pub struct Loaded {
    campaign: Campaign,
    rig: Rig,
    uncertainty: Uncertainty,
    responses: Vec<Response>,
    overlay: Overlay,
}

/// Most draws times points: their amplitudes take 0.8 GB.
const MOST: u64 = 100_000_000;

impl PairDraws {
    /// A number of draws for a campaign.
    ///
    /// # Errors
    /// If the number is too small or too large, the campaign has no rig or no uncertainty, or its data allow
    /// no overlay.
    pub fn of(campaign: Campaign, allow_outside: bool, draws: u64) -> Result<PairDraws> {
        let path = campaign.path();
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let loaded = Loaded::of(campaign)?;
        let points = loaded.overlay.pairs.len() as u64;
        check_draws(draws, MOST, points, "points")?;
        loaded.predicted(0)?;
        let (measured, place) = (loaded.digest()?, CampaignPlace { path, allow_outside });
        Ok(PairDraws { draws, measured, place, loaded: OnceLock::from(Box::new(loaded)) })
    }

    /// Reads the campaign of a study that comes from a part.
    ///
    /// # Errors
    /// If it cannot be read, or it or its recordings changed.
    pub fn load(&self, within: &Folder) -> Result<&Loaded> {
        if let Some(loaded) = self.loaded.get() {
            return Ok(loaded);
        }
        let CampaignPlace { path, allow_outside } = &self.place;
        let loaded = Loaded::of(open_in(&within.clone().allow_outside(*allow_outside), path)?)?;
        if loaded.digest()? != self.measured {
            let found = format!("{} or its recordings changed since the parts were computed", shown(path));
            return Err(Error::usage(found, "those of the parts").hint("all parts anew, in another folder"));
        }
        Ok(self.loaded.get_or_init(|| Box::new(loaded)))
    }
}

impl Loaded {
    fn of(campaign: Campaign) -> Result<Loaded> {
        let rig = stated_rig(&campaign)?;
        let stated = campaign.uncertainty.filter(|stated| stated.all().any(|(_, std)| std > 0.0));
        let uncertainty = stated.ok_or_else(|| {
            Error::usage("no uncertainty to draw from", "a table [uncertainty] in the campaign: gap = 1e-5")
        })?;
        if campaign.excitation.and_then(|e| e.force).is_none() && uncertainty.force.is_some() {
            return Err(Error::usage(
                "an uncertainty of a force that is measured at each point",
                "a stated force: [excitation] force, or no uncertainty of it",
            ));
        }
        let responses = responses(&campaign, &())?;
        let overlay = overlaid(&campaign, &rig, &responses)?;
        Ok(Loaded { campaign, rig, uncertainty, responses, overlay })
    }

    fn digest(&self) -> Result<String> {
        let pairs = serde_json::to_vec(&self.overlay.pairs).map_err(unwritten)?;
        Ok(hexadecimal(&Sha256::new_with_prefix(self.campaign.text()).chain_update(pairs).finalize().into()))
    }

    /// Amplitudes in m at all points with the parameters of a draw; NaN where the motion cannot be followed.
    fn predicted(&self, number: u64) -> Result<Vec<f64>> {
        let force = self.campaign.excitation.and_then(|e| e.force);
        let sine = Sine { force: force.unwrap_or(1.0), frequency: 1.0 };
        let (rig, excitation) = self.uncertainty.drawn(&self.rig, &sine.into(), number)?;
        let force =
            force.map(|stated| if let Excitation::Sine(sine) = excitation { sine.force } else { stated });
        let model = (self.overlay.model, &predicting(&self.campaign));
        let amplitudes = predicted(&rig, force, model, &self.responses)?;
        Ok(amplitudes.into_iter().map(|amplitude| amplitude.unwrap_or(f64::NAN)).collect())
    }
}

impl Study for PairDraws {
    fn what(&self) -> &'static str {
        "draws"
    }

    fn cells(&self) -> u64 {
        self.draws
    }

    fn cell(&self, number: u64) -> Result<Vec<u8>> {
        Ok(packed(self.load(&Folder::default())?.predicted(number)?))
    }

    fn answer(&self, cells: &mut Cells<'_>) -> Result<Answer> {
        let Loaded { campaign, rig, uncertainty, responses, overlay } = self.load(&Folder::default())?;
        let of_pair = by_place(cells, overlay.pairs.len())?;
        let force = campaign.excitation.and_then(|e| e.force).unwrap_or(1.0);
        let drawn = Drawn::all(uncertainty, rig, &Sine { force, frequency: 1.0 }.into());
        let points = overlay.pairs.iter().zip(&of_pair).map(|(pair, values)| PairBand::of(pair, values));
        let bands = PairBands { points: points.collect(), draws: self.draws, drawn };
        answered(campaign, rig, (responses, overlay), Some(&bands))
    }
}

/// A measured point, and where 95 % of the drawn rigs lie.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairBand {
    sweep: String,
    mass: u8,
    /// Excitation frequency in Hz.
    frequency: f64,
    /// Measured amplitude in m.
    measured: f64,
    /// Part of the draws whose motion can be followed.
    share: f64,
    /// Quantiles of the predicted amplitude in m: 2.5, 50 and 97.5 %.
    predicted: [f64; 3],
    /// Whether the band and two standard uncertainties about the measured amplitude overlap.
    within: Option<bool>,
}

impl PairBand {
    fn of(pair: &Pair, amplitudes: &[f64]) -> PairBand {
        let predicted = coverage_interval(amplitudes);
        let (measured, wide) = (pair.measured.value, 2.0 * pair.measured.std.unwrap_or(0.0));
        let known = measured.is_finite() && predicted[0].is_finite() && pair.upper_limit.is_none();
        PairBand {
            sweep: pair.sweep.clone(),
            mass: pair.mass,
            frequency: pair.frequency,
            measured,
            share: amplitudes.iter().filter(|a| a.is_finite()).count() as f64 / amplitudes.len() as f64,
            predicted,
            within: known.then(|| measured + wide >= predicted[0] && measured - wide <= predicted[2]),
        }
    }
}

/// Bands of all measured points.
#[derive(Debug, Clone, PartialEq)]
pub struct PairBands {
    points: Vec<PairBand>,
    draws: u64,
    /// Names of the drawn parameters.
    drawn: Vec<Drawn>,
}

impl PairBands {
    /// Frequencies of a sweep in Hz, rising, with lower and upper end of the band in m.
    pub fn of(&self, sweep: &str) -> Option<(Vec<f64>, [Vec<f64>; 2])> {
        let mut points: Vec<&PairBand> = self.points.iter().filter(|point| point.sweep == sweep).collect();
        points.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        let end = |end: usize| points.iter().map(|point| point.predicted[end]).collect();
        let frequency = points.iter().map(|point| point.frequency).collect();
        (!points.is_empty()).then(|| (frequency, [end(0), end(2)]))
    }

    /// Adds them to an answer.
    pub(super) fn add_to(&self, answer: &mut Answer) -> Result<()> {
        answer.result.insert("draws".to_owned(), self.draws.into());
        answer.result.insert("bands".to_owned(), serde_json::to_value(&self.points).map_err(unwritten)?);
        let whole = self.points.iter().all(|point| point.share >= MOST_DRAWS);
        answer.add("", drawn_findings(self.draws, &self.drawn, whole));
        let sweeps = self.points.chunk_by(|a, b| a.sweep == b.sweep);
        let within =
            |points: &&[PairBand], wanted| points.iter().filter(|p| p.within == Some(wanted)).count();
        answer.tables.push(table(
            "Measured points: does the band of 95 % of the draws reach measured ± 2 uncertainties?",
            sweeps,
            &[
                ("sweep", "", &|points| points[0].sweep.as_str().into()),
                ("yes", "", &|points| within(points, true).into()),
                ("no", "", &|points| within(points, false).into()),
            ],
        ));
        answer.csv(
            "bands",
            &table(
                "Bands",
                &self.points,
                &[
                    ("sweep", "", &|p| p.sweep.as_str().into()),
                    ("mass", "", &|p| usize::from(p.mass).into()),
                    ("frequency", "Hz", &|p| p.frequency.into()),
                    ("measured", "m", &|p| p.measured.into()),
                    ("part of draws", "", &|p| p.share.into()),
                    ("predicted, 2.5 %", "m", &|p| p.predicted[0].into()),
                    ("predicted, median", "m", &|p| p.predicted[1].into()),
                    ("predicted, 97.5 %", "m", &|p| p.predicted[2].into()),
                    ("reaches the measured", "", &|p| p.within.map_or(Cell::Missing, Into::into)),
                ],
            ),
        );
        Ok(())
    }
}
