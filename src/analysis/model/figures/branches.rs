//! Response curves with all branches.

use super::super::response::{Band, BandPoint, Bands};
use crate::model::{
    Branch, ChangeKind, Loss, Orbit, Parameter, PeriodicOrbit, Response, ResponsePoint, Validity,
};
use crate::report::layout::{lettered, line, points};
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Series, Stroke};

/// How a motion is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
enum MotionLook {
    /// Stable or neutral.
    Stable,
    Unstable,
    Impossible,
}

/// How a motion with these verdicts is drawn; `None` if it does not exist.
fn look(v: &Validity) -> Option<MotionLook> {
    match (v.exists, v.admissible, v.stable) {
        (false, ..) => None,
        (_, false, _) => Some(MotionLook::Impossible),
        (.., Some(false)) => Some(MotionLook::Unstable),
        _ => Some(MotionLook::Stable),
    }
}

/// Lines that grow piece by piece.
#[derive(Default)]
pub(super) struct Pieces {
    lines: Vec<Vec<(f64, f64)>>,
}

impl Pieces {
    /// Continues the line that ends at `from`, or begins one.
    pub(super) fn join(&mut self, from: (f64, f64), to: (f64, f64)) {
        match self.lines.iter_mut().rev().find(|line| line.last() == Some(&from)) {
            Some(line) => line.push(to),
            None => self.lines.push(vec![from, to]),
        }
    }

    /// All lines as one, separated by missing values: within each line the dashes run on.
    pub(super) fn places(self) -> Vec<(f64, f64)> {
        self.lines.join(&(f64::NAN, f64::NAN))
    }
}

/// Half the peak-to-peak values of both masses over frequency: stable motions solid, unstable ones dashed,
/// those in which the masses would pass through each other thin and grey.
/// `bands` hold 95 % of rigs with drawn parameters.
pub fn branches(title: &str, response: &Response, bands: Option<&Bands>) -> Figure {
    let mut figure = Figure::double(title).height(150.0).shared_x();
    for mass in 0..2 {
        figure = figure.panel(panel(response, bands, mass));
    }
    let lines = "Half the peak-to-peak displacement. Solid: motions with one impact a period that can be and are stable; dashed: unstable; \
         thin and grey: the masses would pass through each other. Dash-dotted: free motion without losses (backbone).";
    let drawn = " Shaded: 95 % of the drawn rigs that have the motion, where at least one in twenty has it.";
    lettered(figure.caption(lines.to_owned() + if bands.is_some() { drawn } else { "" }))
}

/// Least part of the draws that have a motion whose band is drawn.
const LEAST_SHARE: f64 = 0.05;

/// The panel of a mass, its index from 0.
fn panel(response: &Response, bands: Option<&Bands>, mass: usize) -> Plot {
    let is_possible = |o: &&Orbit| look(&o.validity).is_some_and(|l| l != MotionLook::Impossible);
    let orbits = response.points.iter().flat_map(|p| p.orbits.iter().filter(is_possible));
    let free = response.points.iter().filter_map(|p| p.no_impact.filter(|n| n.possible && mass == 0));
    let heights = orbits.map(|o| o.peak_to_peak[mass] / 2.0).chain(free.map(|n| n.amplitude));
    let largest = heights.fold(0.0, f64::max);
    let (label, title) = [("Amplitude of x₁", "excited mass"), ("Amplitude of x₂", "passive mass")][mass];
    let ends = [response.points.first(), response.points.last()];
    let ends = ends.map(|p| p.map_or(f64::NAN, |p| p.frequency));
    let y = AxisSpec::new(label, "mm");
    // From a thousandth to twice the largest amplitude.
    let y = if largest > 0.0 { y.log().limits(1.0 * largest, 2.0e3 * largest) } else { y };
    let mut plot = Plot::new(AxisSpec::frequency().limits(ends[0], ends[1]), y).title(title);
    if let Some(bands) = bands {
        let frequency: Vec<f64> = bands.points.iter().map(|p| p.frequency).collect();
        let of = |band: &Band| if mass == 0 { Some(band.x1) } else { band.x2 };
        for (name, band, ink) in [
            ("95 % of draws", (|p| &p.impacting) as fn(&BandPoint) -> &Band, Ink::Nth(0)),
            ("without impacts", |p| &p.no_impact, Ink::Grey),
        ] {
            let end = |end: usize| -> Vec<f64> {
                let shown = bands.points.iter().map(|p| Some(band(p)).filter(|b| b.share >= LEAST_SHARE));
                shown.map(|b| b.and_then(of).map_or(f64::NAN, |amplitudes| 1e3 * amplitudes[end])).collect()
            };
            let (low, high) = (end(0), end(2));
            if low.iter().any(|end| end.is_finite()) {
                plot = plot.with(Series::band(name, frequency.clone(), low, high).ink(ink));
            }
        }
    }
    let mut lines: [Pieces; 3] = Default::default();
    let (mut free, mut backbone) = (Pieces::default(), Pieces::default());
    let place = |o: &Orbit| (o.frequency, 1e3 * o.peak_to_peak[mass] / 2.0);
    for pair in response.points.windows(2) {
        let [a, b] = pair else { continue };
        for orbit in &a.orbits {
            let Some(next) = orbit.continued(&b.orbits) else { continue };
            if let (Some(_), Some(look)) = (look(&orbit.validity), look(&next.validity)) {
                lines[look as usize].join(place(orbit), place(next));
            }
        }
        let without_impacts = |p: &ResponsePoint| p.no_impact.filter(|n| n.possible).map(|n| n.amplitude);
        if let Some((n, m)) = without_impacts(a).zip(without_impacts(b)) {
            let height = |amplitude: f64| if mass == 0 { 1e3 * amplitude } else { 0.0 };
            free.join((a.frequency, height(n)), (b.frequency, height(m)));
        }
        if let (Some(n), Some(m)) = (&a.backbone, &b.backbone) {
            // Near poles the backbone is too steep to be drawn.
            let (n, m) = (place(n), place(m));
            if n.1.max(m.1) < 2.0e3 * largest && n.1 < 3.0 * m.1 && m.1 < 3.0 * n.1 {
                backbone.join(n, m);
            }
        }
    }
    let [stable_lines, unstable, impossible] = lines;
    for (name, pieces, ink, stroke) in [
        ("impossible motion", impossible, Ink::Grey, Stroke::Thin),
        ("backbone", backbone, Ink::Nth(2), Stroke::DashDot),
        ("without impacts", free, Ink::Black, Stroke::Thin),
        ("unstable motion", unstable, Ink::Nth(0), Stroke::Dashed),
        ("stable motion", stable_lines, Ink::Nth(0), Stroke::Solid),
    ] {
        plot = line(plot, name, pieces.places(), ink, stroke);
    }
    for (kinds, name, marker) in [
        (&[ChangeKind::Fold][..], "fold", Marker::FilledSquare),
        (&[ChangeKind::Flip], "flip", Marker::Diamond),
        (&[ChangeKind::NeimarkSacker], "Neimark–Sacker", Marker::Triangle),
        (&[ChangeKind::Grazing, ChangeKind::SecondContact], "grazing", Marker::OpenCircle),
    ] {
        let shown = 1e-3 * largest..2.0 * largest;
        let at =
            response.changes.iter().filter(|c| kinds.contains(&c.kind) && shown.contains(&c.amplitude[mass]));
        plot = points(plot, name, at.map(|c| (c.frequency, 1e3 * c.amplitude[mass])), Ink::Nth(3), marker);
    }
    plot
}

/// Half the peak-to-peak values of both masses along branches over a parameter, with branches of one impact
/// a cycle in `beside`.
pub fn continued(over: Parameter, branches: &[Branch], beside: &[Branch]) -> Figure {
    let mut figure = Figure::double("Branches").height(150.0).shared_x();
    for (mass, label) in ["Amplitude of x₁", "Amplitude of x₂"].into_iter().enumerate() {
        let place = |o: &PeriodicOrbit| (over.of(&o.rig, &o.sine), 1e3 * o.peak_to_peak[mass] / 2.0);
        let axis = match over {
            Parameter::Frequency => AxisSpec::frequency(),
            Parameter::Restitution => AxisSpec::new("Restitution", "1"),
            Parameter::Gap => AxisSpec::new("Gap", "m"),
            _ => AxisSpec::new("Force", "N"),
        };
        let mut plot = Plot::new(axis, AxisSpec::new(label, "mm").log());
        for (all, ink, stable, unstable) in [
            (beside, Ink::Nth(1), "one impact a cycle", ""),
            (branches, Ink::Nth(0), "stable branch", "unstable branch"),
        ] {
            let mut lines: [Pieces; 3] = Default::default();
            for pair in all.iter().flat_map(|b| b.points.windows(2)) {
                if let (Some(_), Some(look)) = (look(&pair[0].validity), look(&pair[1].validity)) {
                    lines[look as usize].join(place(&pair[0]), place(&pair[1]));
                }
            }
            let [stable_lines, dashed, impossible] = lines;
            plot = line(plot, "", impossible.places(), Ink::Grey, Stroke::Thin);
            plot = line(plot, unstable, dashed.places(), ink, Stroke::Dashed);
            plot = line(plot, stable, stable_lines.places(), ink, Stroke::Solid);
        }
        for (kind, marker) in [
            (Loss::Fold, Marker::FilledSquare),
            (Loss::Flip, Marker::Diamond),
            (Loss::NeimarkSacker, Marker::Triangle),
            (Loss::Grazing, Marker::OpenCircle),
        ] {
            let marks = branches.iter().chain(beside).flat_map(|b| &b.marks).filter(|m| m.kind == kind);
            plot = points(plot, kind.name(), marks.map(|m| place(&m.orbit)), Ink::Nth(3), marker);
        }
        figure = figure.panel(plot.title(["excited mass", "passive mass"][mass]));
    }
    lettered(figure.caption(
        "Half the peak-to-peak displacement along each branch. Solid: stable; dashed: unstable; thin and grey: the masses would pass through \
         each other.",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_side_by_side_stay_whole() {
        let mut pieces = Pieces::default();
        for i in 0..3 {
            let x = f64::from(i);
            pieces.join((x, 0.0), (x + 1.0, 0.0));
            pieces.join((x, 5.0 + x), (x + 1.0, 6.0 + x));
        }
        let (x, y): (Vec<f64>, Vec<f64>) = pieces.places().into_iter().unzip();
        assert_eq!((&x[..4], &y[..4]), (&[0.0, 1.0, 2.0, 3.0][..], &[0.0; 4][..]));
        assert!(x[4].is_nan() && y[4].is_nan());
        assert_eq!((&x[5..], &y[5..]), (&[0.0, 1.0, 2.0, 3.0][..], &[5.0, 6.0, 7.0, 8.0][..]));
    }
}
