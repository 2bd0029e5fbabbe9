//! Measured points of a fit, with both masses of a step together.

use super::{MotionKind, Pace, Setting, Swept};
use crate::error::Result;
use crate::measure::response::{Response, ResponsePoint};
use crate::record::{Direction, median};

/// The amplitude of one mass at one step.
#[derive(Debug, Clone, PartialEq)]
pub struct StepAmplitude {
    /// Index of the sweep.
    pub sweep: usize,
    /// Amplitude in m; above 0.
    pub amplitude: f64,
    /// Standard uncertainty in m.
    pub std: f64,
    /// Upper limit of an amplitude below the noise floor, in m.
    pub upper_limit: Option<f64>,
    /// Factor by which the contact's compliance changed the amplitude. Amplitude and uncertainty are
    /// divided by it.
    pub compliance: f64,
}

impl StepAmplitude {
    /// ln (measured/predicted), limited to ±20: 20 for a motion that has no amplitude or does not exist.
    pub fn log_ratio(&self, predicted: f64) -> f64 {
        const FARTHEST: f64 = 20.0;
        let ratio = (self.amplitude / predicted).ln();
        if ratio.is_finite() { ratio.clamp(-FARTHEST, FARTHEST) } else { FARTHEST }
    }
}

/// One step of a sweep, with both masses where they were measured at exactly the same force.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepStep {
    /// Excitation frequency in Hz.
    pub frequency: f64,
    /// Its standard uncertainty in Hz; 0 where it is not known.
    pub frequency_std: f64,
    /// Force in N if the force of the setting is [`Data::force`]; else it scales with that of the setting.
    pub force: f64,
    /// Its standard uncertainty in N; 0 where it is not known.
    pub force_std: f64,
    /// Amplitudes of mass 1 and mass 2.
    pub readings: [Option<StepAmplitude>; 2],
}

impl SweepStep {
    /// Amplitudes above the noise floor, with the index of their mass.
    pub fn clear(&self) -> impl Iterator<Item = (usize, &StepAmplitude)> {
        let readings = (0..2).filter_map(|mass| Some((mass, self.readings[mass].as_ref()?)));
        readings.filter(|(_, reading)| reading.upper_limit.is_none())
    }

    /// Upper limits in m of amplitudes below the noise floor, with the index of their mass.
    pub fn faint(&self) -> impl Iterator<Item = (usize, f64)> {
        (0..2).filter_map(|mass| Some((mass, self.readings[mass].as_ref()?.upper_limit?)))
    }
}

/// All measured points of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Data {
    /// Names and directions of the sweeps.
    pub sweeps: Vec<(String, Direction)>,
    /// Steps of all sequences.
    pub steps: Vec<SweepStep>,
    /// Steps that were passed one after another, in the order of their measurement.
    pub sequences: Vec<Vec<usize>>,
    /// Reference of the forces in N: the stated one, or the median of the measured ones.
    pub force: f64,
    /// Relative standard uncertainty of the calibration that all amplitudes of a mass share.
    pub calibration: f64,
    /// Number of amplitudes without a standard uncertainty of their own.
    pub without_std: usize,
    /// Whether no amplitude has one: it is then estimated from the residuals.
    pub guessed: bool,
    /// Cycles of the simulated rig at each step.
    pub pace: Pace,
}

/// Relative standard uncertainty where none is known. It is only a weight: the residuals scale it.
pub(crate) const GUESS: f64 = 1e-2;

impl Data {
    /// Points of displacement responses that state mass and direction; their calibration is taken as exact.
    /// `force` is the stated one in N.
    ///
    /// # Errors
    /// If there is no such response, or no force is known.
    pub fn new(force: Option<f64>, responses: &[Response], pace: Pace) -> Result<Data> {
        // The overlay of the same responses already reports the findings on the force.
        let (swept, _) = Swept::all(force, responses)?;
        let points = || swept.iter().flat_map(|s| &s.response.points);
        let clear = points().filter(|p| p.upper_limit.is_none() && p.amplitude.value > 0.0);
        let relative = |p: &ResponsePoint| Some(p.amplitude.std.filter(|s| *s > 0.0)? / p.amplitude.value);
        let known = Some(median(clear.filter_map(relative))).filter(|part| part.is_finite());
        let mut data = Data {
            sweeps: Vec::new(),
            steps: Vec::new(),
            sequences: Vec::new(),
            force: force.unwrap_or_else(|| median(swept.iter().map(|s| s.forcing.median()))),
            calibration: 0.0,
            without_std: points().filter(|p| p.amplitude.std.is_none()).count(),
            guessed: known.is_none(),
            pace,
        };
        for sweep in &swept {
            data.add(sweep, known.unwrap_or(GUESS));
        }
        Ok(data)
    }

    /// Adds the relative standard uncertainty `part` to each amplitude; the uncertainties then count as
    /// stated.
    pub fn scattered(&mut self, part: f64) {
        if part == 0.0 {
            return;
        }
        for reading in self.steps.iter_mut().flat_map(|s| s.readings.iter_mut().flatten()) {
            let known = if self.guessed { 0.0 } else { reading.std };
            reading.std = known.hypot(part * reading.amplitude);
        }
        if std::mem::take(&mut self.guessed) {
            self.without_std = 0;
        }
    }

    /// Force in N at a step in this setting.
    pub fn force_at(&self, setting: &Setting, step: &SweepStep) -> f64 {
        step.force * setting.force / self.force
    }

    /// Amplitudes of both masses in m that a spectrum shows at a step, in the motion of this kind.
    pub fn shows(&self, setting: &Setting, kind: MotionKind, step: &SweepStep) -> [f64; 2] {
        setting.shows(kind, self.force_at(setting, step), step.frequency)
    }

    /// Number of amplitudes above the noise floor.
    pub fn clear(&self) -> usize {
        self.steps.iter().flat_map(SweepStep::clear).count()
    }

    /// Adds a sweep; it shares the steps of the other mass where both passed exactly the same steps.
    /// `relative` is the relative standard uncertainty of amplitudes without one.
    fn add(&mut self, swept: &Swept<'_>, relative: f64) {
        let (sweep, mass, points) = (self.sweeps.len(), usize::from(swept.mass) - 1, swept.points());
        self.sweeps.push((swept.response.name.clone(), swept.direction));
        let step = |p: &&ResponsePoint| {
            let (frequency, (force, force_std)) = (p.excitation, swept.forcing.of(p));
            let frequency_std = p.excitation_std.unwrap_or(0.0);
            SweepStep { frequency, frequency_std, force, force_std, readings: [None, None] }
        };
        let new: Vec<SweepStep> = points.iter().map(step).collect();
        let same = |(i, n): (&usize, &SweepStep)| {
            let s = &self.steps[*i];
            s.readings[mass].is_none() && (s.frequency, s.force) == (n.frequency, n.force)
        };
        let beside = |s: &&Vec<usize>| s.len() == new.len() && s.iter().zip(&new).all(same);
        let places = if let Some(places) = self.sequences.iter().find(beside) {
            places.clone()
        } else {
            let places: Vec<usize> = (self.steps.len()..).take(new.len()).collect();
            self.steps.extend(new);
            self.sequences.push(places.clone());
            places
        };
        for (place, point) in places.into_iter().zip(points) {
            let amplitude = point.amplitude.value;
            if amplitude.is_finite() && amplitude > 0.0 {
                let std = point.amplitude.std.filter(|s| *s > 0.0).unwrap_or(relative * amplitude);
                let upper_limit = point.upper_limit;
                self.steps[place].readings[mass] =
                    Some(StepAmplitude { sweep, amplitude, std, upper_limit, compliance: 1.0 });
            }
        }
    }
}
