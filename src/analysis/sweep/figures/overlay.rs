//! Measured responses over the predicted branches.

use super::response::{MARKS, log_limits, rank, series, shown};
use crate::analysis::sweep::draws::PairBands;
use crate::compare::{Motion, MotionKind, Overlay, Pair, Prediction, Verdict};
use crate::measure::response::Response;
use crate::model::ladder::Model;
use crate::report::layout::{lettered, line, points};
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Series, Stroke};
use crate::units::notation::significant;

/// Height of a panel in mm.
const PANEL_HEIGHT: f64 = 85.0;

/// One panel for each mass and level of force. Observable branches are solid, unstable ones dashed, neutral
/// ones dash-dotted, the motion without impacts thin; measured points are on top. Branches on which the
/// masses would pass through each other are left out.
pub fn overlay(title: &str, overlay: &Overlay, responses: &[Response], bands: Option<&PairBands>) -> Figure {
    let force = match overlay.force {
        Some(force) => format!("a force of {force:.4} N"),
        None => "the measured force".to_owned(),
    };
    let drawn = if bands.is_some() { " Shaded: 95 % of the rigs with drawn parameters." } else { "" };
    let mut figure = Figure::double(format!("Measurement and model, {title}")).shared_x().caption(format!(
        "Fundamental of the displacement under {force}. Circles and squares: measured. Lines: motions with one impact a cycle, in closed form. \
         Crosses: other motions, and contacts that last, from a simulated sweep at the measured frequencies. Not drawn: impossible motions, mass 2 at rest.{drawn} {MARKS}"
    ));
    for level in &overlay.levels {
        for mass in [1, 2] {
            let measured: Vec<(usize, &Response)> = (0..)
                .zip(responses)
                .filter(|(_, r)| r.mass == Some(mass) && level.sweeps.contains(&r.name))
                .map(|(i, r)| (rank(responses, i), r))
                .collect();
            if !measured.is_empty() {
                let mut plot = panel(mass, &level.curve, &overlay.pairs, (&measured, bands));
                if overlay.levels.len() > 1 {
                    plot = plot.title(format!("Force {} N", significant(level.force, 3)));
                }
                figure = figure.panel(plot);
            }
        }
    }
    let panels = figure.panels.len().max(1) as f64;
    lettered(figure.height(PANEL_HEIGHT * panels))
}

/// The panel of a mass at one level of force.
fn panel(
    mass: u8,
    curve: &Prediction,
    pairs: &[Pair],
    (measured, bands): (&[(usize, &Response)], Option<&PairBands>),
) -> Plot {
    let (factor, unit) = shown("m");
    let y = AxisSpec::new(format!("Displacement of mass {mass}"), unit).log();
    // The measured points set the limits: branches may run out of the picture.
    let limits = log_limits(measured.iter().map(|m| m.1)).map(|(low, high)| (factor * low, factor * high));
    let y = limits.map_or(y.clone(), |(low, high)| y.limits(low, high));
    let mut plot = Plot::new(AxisSpec::new("Excitation frequency", "Hz"), y);
    for (_, response) in measured {
        let Some((frequency, ends)) = bands.and_then(|bands| bands.of(&response.name)) else { continue };
        let [low, high] = ends.map(|end| end.iter().map(|amplitude| factor * amplitude).collect::<Vec<_>>());
        plot = plot.with(Series::band("95 % of draws", frequency, low, high).ink(Ink::Grey));
    }
    let of_panel = |p: &&Pair| p.mass == mass && measured.iter().any(|(_, r)| r.name == p.sweep);
    let soft_models = [Model::KelvinVoigt, Model::HuntCrossley];
    let is_soft = pairs.iter().filter(of_panel).any(|p| soft_models.contains(&p.model));
    let (closed_form, other) = if is_soft {
        ("one impact a cycle, rigid contact", "predicted with the contact stiffness")
    } else {
        ("one impact a cycle", "another motion, simulated")
    };
    let add = |plot: Plot, name: &str, heights: Vec<f64>, ink: Ink, stroke: Stroke| {
        let y: Vec<f64> = heights.iter().map(|v| factor * v).collect();
        let places = curve.frequency.iter().copied().zip(y.iter().copied());
        if is_within(&y, limits) { line(plot, name, places, ink, stroke) } else { plot }
    };
    for (verdict, name, stroke) in [
        (Verdict::Seen, closed_form, Stroke::Solid),
        (Verdict::Unstable, "unstable motion", Stroke::Dashed),
        (Verdict::Neutral, "neutral motion", Stroke::DashDot),
    ] {
        // Both branches have one entry in the legend.
        for rank in 0..2 {
            plot = add(plot, name, branch(curve, mass, rank, verdict), Ink::Black, stroke);
        }
    }
    if mass == 1 {
        let free = curve.motions.iter().map(|m| free(m)).collect();
        plot = add(plot, "without impacts", free, Ink::Grey, Stroke::Thin);
    }
    for (rank, response) in measured {
        let [points, faint] = series(response, *rank, &[], limits);
        plot = plot.with(faint).with(points);
    }
    let others = pairs.iter().filter(of_panel).filter(|p| p.model != Model::ClosedForm);
    let places = others.filter_map(|p| Some((p.frequency, factor * p.predicted?)));
    points(plot, other, places, Ink::Black, Marker::Cross)
}

/// Whether a part of a line is visible between these limits.
fn is_within(y: &[f64], limits: Option<(f64, f64)>) -> bool {
    let (low, high) = limits.unwrap_or((f64::MIN, f64::MAX));
    y.windows(2).any(|part| {
        part.iter().all(|v| v.is_finite()) && part[0].max(part[1]) >= low && part[0].min(part[1]) <= high
    })
}

/// Amplitude of the excited mass without impacts.
fn free(motions: &[Motion]) -> f64 {
    motions.iter().find(|m| m.kind == MotionKind::Free && m.is_seen()).map_or(f64::NAN, |m| m.amplitude[0])
}

/// Amplitudes in m of the impacting motion of this rank where it has this verdict, NaN elsewhere.
/// Unobservable parts extend one point into observable ones, so that no gap opens between them.
fn branch(curve: &Prediction, mass: u8, rank: usize, verdict: Verdict) -> Vec<f64> {
    let motion = |i: usize| curve.motions[i].iter().filter(|m| m.kind == MotionKind::Impacting).nth(rank);
    let has_verdict = |i: usize| i < curve.motions.len() && motion(i).is_some_and(|m| m.verdict == verdict);
    let is_at_border =
        |i: usize| verdict != Verdict::Seen && (has_verdict(i + 1) || i > 0 && has_verdict(i - 1));
    (0..curve.frequency.len())
        .map(|i| {
            let shown = motion(i).filter(|m| has_verdict(i) || m.is_seen() && is_at_border(i));
            shown.map_or(f64::NAN, |m| m.amplitude[usize::from(mass) - 1])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_beyond_the_limits_is_not_within() {
        let limits = Some((1.0, 10.0));
        for (y, seen) in [
            (&[0.1, 0.5, 0.2][..], false),
            (&[20.0, 50.0], false),
            (&[0.5, 2.0], true),
            // The line crosses the range between two points.
            (&[0.5, 20.0], true),
            // A single point gives no line.
            (&[f64::NAN, 2.0, f64::NAN], false),
            (&[2.0], false),
        ] {
            assert_eq!(is_within(y, limits), seen, "{y:?}");
        }
        assert!(is_within(&[1e-9, 1e9], None) && !is_within(&[f64::NAN, f64::NAN], None));
    }
}
