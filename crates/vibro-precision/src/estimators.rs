//! Estimators of measured quantities, on records with a known truth.
//!
//! Common hand-written methods are compared with the toolkit's own, over the same random records of fixed
//! seeds. Errors are root mean squares, so that they compare with the Cramér–Rao bound of the standard
//! deviation.

mod damping;
mod decay;
mod impacts;
mod integration;
mod pulse;
mod records;
mod rivals;
mod shaker;
mod sine;
mod trial;

use super::failure::BorderQuestion;
use super::{BenchmarkScene, FailureMap, Family, Measurement};
use nalgebra::DMatrix;
pub use records::write_records;
use trial::{Ensemble, EstimationMethod, Record, Settings, Trials};
use vibro_record::{Spectrum, Sweep, SweepPoint, Values};

/// Every scene of the estimators, still to be measured; `quick` takes fewer records.
pub(crate) fn scenes(quick: bool) -> Vec<Measurement> {
    let measured = |scene: EstimatorScene| -> Measurement { Box::new(move || Ok(scene.measured(quick))) };
    all_scenes().into_iter().map(measured).collect()
}

/// Every scene of the estimators, not measured yet.
fn all_scenes() -> Vec<EstimatorScene> {
    let parts = [
        sine::scenes,
        integration::scenes,
        damping::scenes,
        decay::scenes,
        shaker::scenes,
        impacts::scenes,
        pulse::scenes,
    ];
    parts.iter().flat_map(|scenes| scenes()).collect()
}

/// The outcome of each estimator at each border; `quick` takes fewer records.
///
/// An answer with an uncertainty is right within three of its standard uncertainties. One without is right
/// within a limit that is the same for all methods of a border: half a line for a frequency, 5 % for an
/// amplitude, 10 % for a damping ratio, 1 % for an impact frequency, 0.02 for ξ. An answer counts as refused
/// if it is withheld, if it has no uncertainty because of a doubt, or if its uncertainty exceeds the limit. A
/// doubt does not excuse an answer whose uncertainty is stated. A method is wrong if more than 3 of 40
/// answers lie outside, or one by more than 5.2 standard uncertainties: methods with correct uncertainties
/// exceed these limits in fewer than one of a hundred full maps.
pub fn failures(quick: bool) -> FailureMap {
    FailureMap::answered(Family::Estimators, questions(quick))
}

/// All questions of the map.
fn questions(quick: bool) -> Vec<BorderQuestion> {
    let parts: [fn(bool) -> Vec<BorderQuestion>; 5] =
        [sine::borders, integration::borders, damping::borders, impacts::borders, pulse::borders];
    parts.iter().flat_map(|part| part(quick)).collect()
}

/// A scene of estimators: its texts, its Cramér–Rao bound, and its methods with their records.
struct EstimatorScene {
    texts: [&'static str; 4],
    bound: f64,
    trials: Box<dyn Trials>,
}

impl EstimatorScene {
    /// The scene with the results of its methods.
    fn measured(&self, quick: bool) -> BenchmarkScene {
        let methods = self.trials.measured(quick);
        BenchmarkScene {
            bound: Some(self.bound),
            methods,
            ..BenchmarkScene::new(Family::Estimators, self.texts)
        }
    }
}

/// A scene from its texts, its bound, its methods and the kinds of records that they get.
fn scene<D: Record>(
    texts: [&'static str; 4],
    bound: f64,
    methods: &'static [EstimationMethod<D>],
    settings: impl IntoIterator<Item = Ensemble<D>>,
) -> EstimatorScene {
    let settings = settings.into_iter().collect();
    EstimatorScene { texts, bound, trials: Box::new(Settings { methods, settings }) }
}

/// Cramér–Rao bounds: the least standard deviations of unbiased estimates of the parameters `p`, from
/// values of `model` with independent normal noise of standard deviation `noise`. They are the roots of the
/// diagonal of the inverse of Fisher's information (Kay 1993, eq. 3.33), with slopes by central differences
/// of `steps`. NaN where the information is singular.
fn bounds(p: &[f64], steps: &[f64], noise: f64, model: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let slopes: Vec<Vec<f64>> = (0..p.len())
        .map(|i| {
            let shifted_model = |by: f64| {
                let mut shifted = p.to_vec();
                shifted[i] += by;
                model(&shifted)
            };
            shifted_model(steps[i])
                .iter()
                .zip(shifted_model(-steps[i]))
                .map(|(a, b)| (a - b) / (2.0 * steps[i] * noise))
                .collect()
        })
        .collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Columns of length 1, so that units do not spoil the inversion.
    let size: Vec<f64> = slopes.iter().map(|s| dot(s, s).sqrt()).collect();
    let information =
        DMatrix::from_fn(p.len(), p.len(), |i, j| dot(&slopes[i], &slopes[j]) / (size[i] * size[j]));
    let inverse = information.cholesky().map(|c| c.inverse());
    (0..p.len()).map(|i| inverse.as_ref().map_or(f64::NAN, |m| m[(i, i)].sqrt() / size[i])).collect()
}

/// A sweep of one point, with the magnitudes of its force's spectral lines if measured, or with a known
/// frequency in Hz.
fn one_point(response: Spectrum, force: Option<Vec<f64>>, given: Option<f64>) -> Sweep {
    Sweep {
        name: String::new(),
        direction: None,
        mass: None,
        axis: response.axis.clone(),
        analyser_integrated: 0,
        points: vec![SweepPoint {
            force_path: force.as_ref().map(|_| "force".into()),
            response_path: "response".into(),
            force: Values::Real(force.unwrap_or_default()),
            given,
            response,
        }],
        findings: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BorderCell, Outcome};
    use std::f64::consts::TAU;

    #[test]
    fn the_limits_of_the_map_are_made_for_as_many_cells_as_it_has() {
        let cells = questions(false).len();
        assert!(cells <= 500 && 2 * cells > 500, "{cells}");
    }

    /// The whole map takes long: the borders of one quantity are tested in its place.
    #[test]
    fn displacements_are_right_or_refused_at_their_borders() {
        let map = FailureMap::answered(Family::Estimators, integration::borders(true));
        assert_eq!(map.broken().collect::<Vec<_>>(), Vec::<&BorderCell>::new());
        // Some answers must be right, and some methods must fail the check.
        let count =
            |ours, outcome| map.cells.iter().filter(|c| c.ours == ours && c.outcome == outcome).count();
        assert!(count(true, Outcome::Right) > 10, "{map:?}");
        assert!(count(false, Outcome::Wrong) > 0);
    }

    #[test]
    fn a_scene_is_measured_with_its_bound() {
        for scene in integration::scenes().iter().map(|scene| scene.measured(true)) {
            assert!(scene.bound.is_some_and(|b| b > 0.0), "{}", scene.name);
            assert!(scene.methods.iter().all(|m| m.time_ns > 0.0 && m.error.is_some() != m.failed));
            assert!(scene.methods.iter().any(|m| m.ours && !m.failed));
        }
    }

    /// A real sine of unknown amplitude, frequency and phase: Kay 1993, eq. 3.41.
    #[test]
    fn the_bound_of_a_sine_is_that_of_the_textbook() {
        let (n, sigma) = (1000, 0.1);
        let model = |p: &[f64]| (0..n).map(|i| p[0] * (TAU * p[1] * f64::from(i) + p[2]).cos()).collect();
        let found = bounds(&[1.0, 0.1234, 0.5], &[1e-4, 1e-8, 1e-4], sigma, model);
        let (eta, n) = (0.5 / (sigma * sigma), f64::from(n));
        // The textbook neglects the sums at twice the frequency, of the order 1/n.
        let expected = (12.0 / (eta * n * (n * n - 1.0))).sqrt() / TAU;
        assert!((found[1] / expected - 1.0).abs() < 5.0 / n, "{found:?} {expected}");
        assert!((found[0] / (1.0 / (n * eta).sqrt()) - 1.0).abs() < 5.0 / n);
    }
}
