//! The model over the joined turn: tables and figure.

use super::joined::closed;
use crate::analysis::answer::Answer;
use crate::compare::{Difference, DrillComparison, DrillFit, Unidentified};
use crate::error::Result;
use crate::measure::chain::{Body, Chain};
use crate::report::layout::{lettered, table};
use crate::report::{AxisSpec, Cell, Figure, Ink, Legend, Plot, Series, Stroke, Table};

/// The answer of a comparison: a doubt about the model is none about what was measured.
///
/// # Errors
/// If the numbers cannot be written as JSON.
pub(super) fn answer(bodies: &[&Body], chain: &Chain, found: &DrillComparison) -> Result<Answer> {
    let mut answer = Answer::of(found)?;
    answer.add("", &found.findings);
    answer.table("drill_model", differences(&found.differences));
    if let Some(fit) = &found.fit {
        answer.table("drill_fit", keys(fit));
    }
    answer.figure("drill_model", figure(bodies, chain, found));
    Ok(answer)
}

/// Numbers of the blows, measured and of the model.
fn differences(all: &[Difference]) -> Table {
    table(
        "Model over measurement",
        all,
        &[
            ("quantity", "", &|d| d.quantity.as_str().into()),
            ("unit", "", &|d| d.measured.unit.into()),
            ("measured", "", &|d| Cell::from(&d.measured)),
            ("model", "", &|d| d.model.value.into()),
            ("difference in standard uncertainties", "", &|d| d.deviations.into()),
        ],
    )
    .note("The model runs at the measured speed. Differences in standard uncertainties of the measurement; the model's own uncertainty is not in them.")
}

/// Fitted keys.
fn keys(fit: &DrillFit) -> Table {
    let reason = |reason: Option<Unidentified>| match reason {
        None => "",
        Some(Unidentified::Combination) => "only in combination",
        Some(Unidentified::InDoubt) => "the fit is in doubt",
        Some(_) => "the turn leaves it open",
    };
    table(
        "Fitted drill",
        &fit.keys,
        &[
            ("key", "", &|k| k.key.as_str().into()),
            ("unit", "", &|k| k.estimate.unit.into()),
            ("value", "", &|k| Cell::from(&k.estimate)),
            ("stated", "", &|k| k.start.into()),
            ("", "", &|k| reason(k.reason).into()),
        ],
    )
}

/// Measured velocity of each body with its scatter, and the model's.
fn figure(bodies: &[&Body], chain: &Chain, found: &DrillComparison) -> Figure {
    let sign = chain.direction;
    let mut figure = Figure::double(format!("Model over measurement at {:.4} Hz", chain.speed)).shared_x();
    let panels = found
        .bodies
        .iter()
        .filter_map(|shown| Some((bodies.iter().find(|body| body.name == shown.name)?, shown)));
    let mut height = 20.0;
    for (i, (body, shown)) in panels.enumerate() {
        let degrees: Vec<f64> = body.phase.iter().map(|p| 360.0 * p).chain([360.0]).collect();
        let edge = |by: f64| closed(body.mean.iter().zip(&body.std).map(|(m, s)| sign * m + by * s));
        let x = AxisSpec::new("Crank angle after the pulse", "°").limits(0.0, 360.0);
        let legend = if i == 0 { Legend::Above } else { Legend::Hidden };
        let mean = closed(body.mean.iter().map(|m| sign * m));
        let plot = Plot::new(x, AxisSpec::new("Velocity", "m/s"))
            .title(&*body.name)
            .legend(legend)
            .with(
                Series::band("± 1 standard deviation", degrees.clone(), edge(-1.0), edge(1.0))
                    .ink(Ink::Nth(0)),
            )
            .with(Series::line("measured", degrees.clone(), mean).ink(Ink::Nth(0)))
            .with(
                Series::line("model", degrees, closed(shown.velocity.iter().copied()))
                    .ink(Ink::Nth(1))
                    .stroke(Stroke::Dashed),
            );
        figure = figure.panel(plot);
        height += 50.0;
    }
    let fitted = match &found.fit {
        Some(fit) => {
            let keys: Vec<&str> = fit.keys.iter().map(|key| &*key.key).collect();
            format!(" with the fitted {}", keys.join(", "))
        }
        None => String::new(),
    };
    lettered(figure.height(height).caption(format!(
        "Mean turn of each body with its scatter from turn to turn, and model {}{fitted} at the same speed: {}. The model is sampled, smoothed and averaged like the records; impacts scatter in it as measured. The pulse comes {:.1}° after top dead centre.",
        found.rung.name(),
        found.regime.name(),
        found.pulse_angle.value,
    )))
}
