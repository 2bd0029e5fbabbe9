//! The oblique projection of a waterfall, with hidden lines.

use super::axis::Axis;
use super::horizon::Horizon;
use super::path::{Point, thinned};
use super::ticks::Ticks;

/// A waterfall in the unit cube: frequency to the right, excitation to the back, magnitude up.
#[derive(Debug, Clone)]
pub(super) struct Cube {
    pub x: Axis,
    pub depth: Axis,
    pub up: Axis,
    /// Depth of each spectrum, from front to back, and its line; NaN where it is missing.
    pub spectra: Vec<(f64, Vec<Point>)>,
    /// Depth of each peak, and its place over the front edge.
    pub peaks: Vec<(f64, Point)>,
}

/// How the cube is seen: sizes in points, y up from the lower left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    /// Width of a spectrum.
    pub along: f64,
    /// Way of the back edge to the right and up.
    pub back: Point,
    /// Height of the amplitude axis.
    pub rise: f64,
}

/// What is seen of a cube.
#[derive(Debug, Clone, Default)]
pub(super) struct Scene {
    /// Seen parts of each spectrum.
    pub spectra: Vec<Vec<Vec<Point>>>,
    /// Seen parts of the lines that lead over the floor from the ticks to the back.
    pub floor: Vec<Vec<Point>>,
    /// Peaks that are not hidden.
    pub peaks: Vec<Point>,
}

impl View {
    pub(super) fn at(self, x: f64, depth: f64, up: f64) -> Point {
        (x * self.along + depth * self.back.0, depth * self.back.1 + up * self.rise)
    }
}

impl Cube {
    /// The view that fills a room: where no spectrum reaches the top, all is drawn that much higher.
    pub(super) fn view(&self, width: f64, height: f64) -> View {
        let view = View { along: 0.78 * width, back: (0.22 * width, 0.58 * height), rise: 0.42 * height };
        let tops =
            self.spectra.iter().flat_map(|(depth, line)| line.iter().map(|p| view.at(p.0, *depth, p.1).1));
        let stretch = (height / tops.fold(view.back.1, f64::max)).clamp(1.0, 1.6);
        View { back: (view.back.0, view.back.1 * stretch), rise: view.rise * stretch, ..view }
    }

    /// Goes from front to back: the floor up to the next spectrum, with lines from these ticks, then the
    /// spectrum, then its peaks.
    pub(super) fn seen(&self, view: View, ticks: &Ticks) -> Scene {
        let mut scene = Scene::default();
        let mut horizon = Horizon::default();
        let across: Vec<f64> = ticks.major.iter().map(|t| self.x.at_scaled(t.at)).chain([0.0, 1.0]).collect();
        let mut front = 0.0;
        let back_edge = (1.0, Vec::new());
        for (depth, line) in self.spectra.iter().chain([&back_edge]) {
            for &x in &across {
                scene.floor.extend(horizon.seen(&[view.at(x, front, 0.0), view.at(x, *depth, 0.0)]));
            }
            front = *depth;
            let mut parts = Vec::new();
            for run in line.split(|p| p.1.is_nan()) {
                let run: Vec<Point> = run.iter().map(|p| view.at(p.0, *depth, p.1)).collect();
                parts.extend(horizon.raise(&thinned(&run, TOLERANCE)));
            }
            scene.spectra.push(parts);
            let here = self.peaks.iter().filter(|p| (p.0 - depth).abs() < 1e-9 && !line.is_empty());
            scene.peaks.extend(here.map(|(_, (x, up))| (x, view.at(*x, *depth, *up))).filter_map(
                |(x, at)| {
                    // A peak that was read from its spectrum lies on it, or within the tolerance below it.
                    let free = horizon.shows((at.0, at.1 + 2.0 * TOLERANCE));
                    ((0.0..=1.0).contains(x) && free).then_some(at)
                },
            ));
        }
        scene
    }
}

/// How far a spectrum may be moved to have fewer points: a sixth of a dot at 300 dots per inch.
const TOLERANCE: f64 = 0.04;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AxisSpec, Peak, Waterfall};
    use ndarray::Array2;

    fn scene(waterfall: &Waterfall, width: f64, height: f64) -> (Scene, View) {
        let cube = waterfall.cube().unwrap();
        let view = cube.view(width, height);
        (cube.seen(view, &cube.x.ticks(5)), view)
    }

    #[test]
    fn everything_lies_in_the_room() {
        let frequency: Vec<f64> = (0..30).map(f64::from).collect();
        let excitation: Vec<f64> = (0..9).map(|i| 4.0 + f64::from(i)).collect();
        let magnitude = Array2::from_shape_fn((9, 30), |(r, c)| ((r * 7 + c * 3) % 11) as f64);
        let waterfall = Waterfall::new(&frequency, &excitation, &magnitude, AxisSpec::new("a", "m")).unwrap();
        let (scene, _) = scene(&waterfall, 300.0, 200.0);
        assert_eq!(scene.spectra.len(), 10);
        for (x, y) in scene.spectra.iter().flatten().chain(&scene.floor).flatten() {
            assert!((-1e-9..=300.0 + 1e-9).contains(x) && (-1e-9..=200.0 + 1e-9).contains(y), "{x} {y}");
        }
    }

    #[test]
    fn a_missing_line_leaves_a_gap_and_a_hidden_peak_no_mark() {
        let frequency: Vec<f64> = (0..=100).map(f64::from).collect();
        let peak = |excitation, magnitude| Peak { frequency: 50.0, excitation, magnitude };
        let of = |magnitude: &Array2<f64>| {
            let picture =
                Waterfall::new(&frequency, &[4.0, 4.1, 5.0], magnitude, AxisSpec::new("a", "m")).unwrap();
            scene(&picture.peak(peak(4.0, 2.0)).peak(peak(4.1, 0.5)), 100.0, 100.0)
        };
        let mut magnitude = Array2::zeros((3, 101));
        magnitude[[0, 50]] = 2.0;
        magnitude[[1, 50]] = 0.5;
        magnitude[[2, 20]] = f64::NAN;
        // A tenth of the depth back is 2.2 to the right and 5.8 up: beside the narrow peak in front, not
        // behind it.
        let (free, view) = of(&magnitude);
        assert_eq!(free.peaks.len(), 2);
        let gap = view.at(0.2, 1.0, 0.0).0;
        assert_eq!(free.spectra[2].len(), 2);
        assert!(free.spectra[2].iter().all(|part| part[part.len() - 1].0 < gap || part[0].0 > gap));
        // A plateau in front, 42 high, hides all of the second spectrum behind it.
        for column in 40..=100 {
            magnitude[[0, column]] = 2.0;
        }
        assert_eq!(of(&magnitude).0.peaks.len(), 1);
    }
}
