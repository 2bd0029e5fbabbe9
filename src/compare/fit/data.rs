//! The measured points of a fit, both masses of one step together.

use super::super::forcing::{Forcing, median};
use crate::error::{Error, Result};
use crate::measure::response::{Response, ResponsePoint};
use crate::record::Direction;

/// The amplitude of one mass at one step.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    /// Index of the sweep.
    pub sweep: usize,
    /// Amplitude in m; above 0.
    pub amplitude: f64,
    /// Standard uncertainty in m.
    pub std: f64,
    /// What the true amplitude stays below, where it does not stand out of the noise.
    pub limit: Option<f64>,
    /// What the compliance of the contact has made of the amplitude; amplitude and uncertainty are those divided by it.
    pub soft: f64,
    /// Part of the amplitude by which that may be off; it is in the uncertainty.
    pub left: f64,
}

/// One step of a sweep: both masses where they were measured under the very same force.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Excitation frequency in Hz.
    pub frequency: f64,
    /// Its standard uncertainty in Hz; 0 where it is not known.
    pub frequency_std: f64,
    /// Force in N at the reference of [`Data::force`].
    pub force: f64,
    /// Its standard uncertainty in N; 0 where it is not known.
    pub force_std: f64,
    /// Mass 1 and mass 2.
    pub seen: [Option<Seen>; 2],
}

impl Step {
    /// Amplitudes that stand out of the noise, with the index of their mass.
    pub fn clear(&self) -> impl Iterator<Item = (usize, &Seen)> {
        (0..2).filter_map(|mass| Some((mass, self.seen[mass].as_ref()?))).filter(|(_, s)| s.limit.is_none())
    }
}

/// All points.
#[derive(Debug, Clone, PartialEq)]
pub struct Data {
    /// Names and directions of the sweeps.
    pub sweeps: Vec<(String, Direction)>,
    /// Steps of all sequences.
    pub steps: Vec<Step>,
    /// Steps that were passed one after another, in the order of their measurement.
    pub sequences: Vec<Vec<usize>>,
    /// Reference of the forces in N: the stated one, or the median of the measured ones.
    pub force: f64,
    /// Whether standard uncertainties are relative guesses: the residuals then tell their size.
    pub guessed: bool,
    /// Points that do not stand out of the noise.
    pub faint: usize,
    /// Relative standard uncertainty that all amplitudes of a mass share.
    pub calibration: f64,
    /// What was assumed.
    pub warnings: Vec<String>,
}

/// Part of an amplitude that stands for its uncertainty where none is known; the residuals scale it.
pub const GUESS: f64 = 1e-2;

impl Data {
    /// Whether a contact's compliance was taken out of amplitudes.
    pub fn corrected(&self) -> bool {
        self.steps.iter().flat_map(|step| step.seen.iter().flatten()).any(|seen| seen.soft != 1.0)
    }

    /// The points of displacement responses that name their mass and direction. `force` in N is the stated one.
    ///
    /// # Errors
    /// If there is no such response, or no force is known.
    pub fn new(force: Option<f64>, responses: &[Response]) -> Result<Data> {
        let usable: Vec<(&Response, u8, Direction)> = responses
            .iter()
            .filter(|r| r.quantity == "displacement")
            .filter_map(|r| Some((r, r.mass?, r.direction?)))
            .filter(|(_, mass, _)| matches!(mass, 1 | 2))
            .collect();
        if usable.is_empty() {
            return Err(Error::refused("no response can be fitted")
                .hint("give `mass = 1` or `2` for each sweep, and three or more points in one direction"));
        }
        let mut warnings = Vec::new();
        // What is assumed of the force, the overlay of the same responses says.
        let forcings =
            Forcing::of_all(force, &usable.iter().map(|u| u.0).collect::<Vec<_>>(), &mut Vec::new())?;
        let mut medians: Vec<f64> = forcings.iter().map(Forcing::median).collect();
        medians.sort_by(f64::total_cmp);
        let mut data = Data {
            sweeps: Vec::new(),
            steps: Vec::new(),
            sequences: Vec::new(),
            force: force.or(median(&medians)).unwrap_or(f64::NAN),
            guessed: false,
            faint: 0,
            calibration: 0.0,
            warnings: Vec::new(),
        };
        let known = relative(usable.iter().flat_map(|u| &u.0.points));
        for ((response, mass, direction), forcing) in usable.into_iter().zip(&forcings) {
            data.add(response, usize::from(mass) - 1, direction, forcing, known);
        }
        let clear = data.steps.iter().flat_map(Step::clear).count();
        let all = responses.iter().flat_map(|r| &r.points).filter(|p| p.amplitude.std.is_none()).count();
        data.guessed = known.is_none();
        if data.guessed {
            warnings.push("No amplitude has a standard uncertainty: all are taken for equal parts of the amplitude, and the residuals say how large.".to_owned());
        } else if all > 0 {
            warnings.push(format!("{all} amplitude(s) have no standard uncertainty: they take the median relative one of the others."));
        }
        data.faint = data.steps.iter().flat_map(|s| s.seen.iter().flatten()).count() - clear;
        data.warnings = warnings;
        Ok(data)
    }

    /// Amplitudes stray by this part of each, beside what is known of them; with it none is guessed.
    pub fn scattered(&mut self, part: f64) {
        if part == 0.0 {
            return;
        }
        for seen in self.steps.iter_mut().flat_map(|s| s.seen.iter_mut().flatten()) {
            let known = if self.guessed { 0.0 } else { seen.std };
            seen.std = known.hypot(part * seen.amplitude);
        }
        if std::mem::take(&mut self.guessed) {
            self.warnings.clear();
        }
    }

    /// Adds a sweep: beside the other mass, where that passed the very same steps.
    fn add(
        &mut self,
        response: &Response,
        mass: usize,
        direction: Direction,
        forcing: &Forcing,
        known: Option<f64>,
    ) {
        let sweep = self.sweeps.len();
        self.sweeps.push((response.name.clone(), direction));
        let mut points: Vec<&ResponsePoint> = response.points.iter().collect();
        points.sort_by(|a, b| a.excitation.total_cmp(&b.excitation));
        if direction == Direction::Down {
            points.reverse();
        }
        let step = |p: &&ResponsePoint| Step {
            frequency: p.excitation,
            frequency_std: p.excitation_std.unwrap_or(0.0),
            force: forcing.of(p),
            force_std: forcing.std_of(p),
            seen: [None, None],
        };
        let new: Vec<Step> = points.iter().map(step).collect();
        let beside = |sequence: &&Vec<usize>| {
            sequence.len() == new.len()
                && sequence.iter().zip(&new).all(|(i, n)| {
                    let s = &self.steps[*i];
                    s.seen[mass].is_none() && (s.frequency, s.force) == (n.frequency, n.force)
                })
        };
        let places = if let Some(places) = self.sequences.iter().find(beside) {
            places.clone()
        } else {
            let places: Vec<usize> = (self.steps.len()..self.steps.len() + new.len()).collect();
            self.steps.extend(new);
            self.sequences.push(places.clone());
            places
        };
        for (place, point) in places.into_iter().zip(points) {
            let amplitude = point.amplitude.value;
            if !(amplitude.is_finite() && amplitude > 0.0) {
                continue;
            }
            let std = point.amplitude.std.filter(|s| *s > 0.0).unwrap_or(known.unwrap_or(GUESS) * amplitude);
            self.steps[place].seen[mass] =
                Some(Seen { sweep, amplitude, std, limit: point.upper_limit, soft: 1.0, left: 0.0 });
        }
    }
}

/// Median relative uncertainty of the points that have one and stand out of the noise.
fn relative<'a>(points: impl Iterator<Item = &'a ResponsePoint>) -> Option<f64> {
    let mut known: Vec<f64> = points
        .filter(|p| p.upper_limit.is_none() && p.amplitude.value > 0.0)
        .filter_map(|p| Some(p.amplitude.std.filter(|s| *s > 0.0)? / p.amplitude.value))
        .collect();
    known.sort_by(f64::total_cmp);
    median(&known)
}
