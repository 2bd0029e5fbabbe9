//! Measured responses over the predicted branches.

use super::response::{log_limits, series, shown};
use crate::compare::Overlay;
use crate::compare::prediction::{Kind, Prediction};
use crate::measure::response::Response;
use crate::report::{AxisSpec, Figure, Ink, Plot, Series, Stroke};

/// One panel a mass: branches that can be seen solid, others dashed, the motion without impacts thin; measured points on
/// top.
pub fn overlay(title: &str, overlay: &Overlay, responses: &[Response]) -> Figure {
    let mut figure = Figure::double(title).height(170.0).shared_x().caption(format!(
        "Fundamental of the displacement. Lines: closed form for a force of {:.4} N; solid: admissible and stable, dashed: not, \
         thin: without impacts (mass 2 then rests and has no line). Points: measured.",
        overlay.force
    ));
    for mass in [1, 2] {
        let measured: Vec<&Response> =
            responses.iter().filter(|r| r.mass == Some(mass) && r.quantity == "displacement").collect();
        if !measured.is_empty() {
            figure = figure.panel(panel(mass, &overlay.curve, &measured));
        }
    }
    figure
}

fn panel(mass: u8, curve: &Prediction, measured: &[&Response]) -> Plot {
    let (factor, unit) = shown("m");
    let y = AxisSpec::new(format!("Displacement of mass {mass}"), unit).log();
    // The dashed branches and the undisturbed resonance may run out of the picture: what is measured decides its size.
    let y = match log_limits(measured.iter().copied()) {
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
    for response in measured {
        plot = plot.with(series(response));
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
