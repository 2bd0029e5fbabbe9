//! Measured responses over the predicted branches.

use super::response::{MARKS, log_limits, rank, series, shown};
use crate::compare::prediction::{Kind, Prediction};
use crate::compare::{Level, Overlay};
use crate::measure::response::Response;
use crate::report::notation::significant;
use crate::report::{AxisSpec, Figure, Ink, Plot, Series, Stroke};

/// Height of a panel in mm.
const PANEL: f64 = 85.0;

/// One panel a mass and level of force: branches that can be seen solid, others dashed, the motion without impacts thin;
/// measured points on top.
pub fn overlay(title: &str, overlay: &Overlay, responses: &[Response]) -> Figure {
    let force = match overlay.force {
        Some(force) => format!("a force of {force:.4} N"),
        None => "the measured force".to_owned(),
    };
    let mut figure = Figure::double(title).shared_x().caption(format!(
        "Fundamental of the displacement. Lines: closed form for {force}; solid: admissible and stable, dashed: not, \
         thin: without impacts (mass 2 then rests and has no line). Points: measured. {MARKS}"
    ));
    for level in &overlay.levels {
        for mass in [1, 2] {
            let measured: Vec<(usize, &Response)> = (0..)
                .zip(responses)
                .filter(|(_, r)| r.mass == Some(mass) && level.sweeps.contains(&r.name))
                .map(|(i, r)| (rank(responses, i), r))
                .collect();
            if !measured.is_empty() {
                let plot = panel(mass, &level.curve, &measured);
                let several = overlay.levels.len() > 1;
                figure = figure.panel(if several { plot.title(level_name(level)) } else { plot });
            }
        }
    }
    let panels = figure.panels.len().max(1) as f64;
    figure.height(PANEL * panels)
}

fn level_name(level: &Level) -> String {
    format!("Force {} N", significant(level.force, 3))
}

fn panel(mass: u8, curve: &Prediction, measured: &[(usize, &Response)]) -> Plot {
    let (factor, unit) = shown("m");
    let y = AxisSpec::new(format!("Displacement of mass {mass}"), unit).log();
    // The dashed branches and the undisturbed resonance may run out of the picture: what is measured decides its size.
    let y = match log_limits(measured.iter().map(|m| m.1)) {
        Some((low, high)) => y.limits(factor * low, factor * high),
        None => y,
    };
    let mut plot = Plot::new(AxisSpec::new("Excitation frequency", "Hz"), y);
    for (solid, name) in [(true, "one impact a cycle"), (false, "not stable or not admissible")] {
        for rank in 0..2 {
            let y: Vec<f64> = branch(curve, mass, rank, solid).iter().map(|v| factor * v).collect();
            if y.iter().any(|v| v.is_finite()) {
                let stroke = if solid { Stroke::Solid } else { Stroke::Dashed };
                // One entry in the legend for both branches.
                let name = if rank == 0 { name } else { "" };
                plot =
                    plot.with(Series::line(name, curve.frequency.clone(), y).ink(Ink::Black).stroke(stroke));
            }
        }
    }
    if mass == 1 {
        let y: Vec<f64> = curve.motions.iter().map(|m| factor * free(m, usize::from(mass) - 1)).collect();
        plot = plot.with(
            Series::line("without impacts", curve.frequency.clone(), y).ink(Ink::Grey).stroke(Stroke::Thin),
        );
    }
    for (rank, response) in measured {
        let [points, limits] = series(response, *rank);
        plot = plot.with(limits).with(points);
    }
    plot
}

fn free(motions: &[crate::compare::prediction::Motion], mass: usize) -> f64 {
    motions.iter().find(|m| m.kind == Kind::Free && m.seen).map_or(f64::NAN, |m| m.amplitude[mass])
}

/// Amplitudes of the impacting motion of this rank where it is seen (`solid`) or not, and NaN elsewhere. The dashed
/// parts reach one point into the solid ones, so that no gap opens between them.
fn branch(curve: &Prediction, mass: u8, rank: usize, solid: bool) -> Vec<f64> {
    let motion = |i: usize| curve.motions[i].iter().filter(|m| m.kind == Kind::Impacting).nth(rank);
    let seen = |i: usize| motion(i).is_some_and(|m| m.seen);
    let n = curve.frequency.len();
    (0..n)
        .map(|i| {
            let shown = if solid {
                seen(i)
            } else {
                !seen(i) || (i > 0 && !seen(i - 1)) || (i + 1 < n && !seen(i + 1))
            };
            motion(i).filter(|_| shown).map_or(f64::NAN, |m| m.amplitude[usize::from(mass) - 1])
        })
        .collect()
}
