//! Free decays: the record with its modes, and damping over amplitude.

use crate::measure::decay::DecayResult;
use crate::record::Meta;
use crate::report::layout::{lettered, value_axis};
use crate::report::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series, Stroke};
use std::fmt::Write as _;

/// Most samples of a drawn line: print cannot show more.
const SHOWN: usize = 4000;

/// The fitted part with the sum of its modes, the residuals, and the damping ratio of the strongest mode
/// over its amplitude.
pub fn decay(title: &str, meta: &Meta, found: &DecayResult) -> Figure {
    let [times, record, modes] = &found.curves;
    let unit = meta.unit.symbol();
    let shown = times.len().min(SHOWN);
    let (from, to) = (times[0], times[shown - 1]);
    let x = || AxisSpec::new("Time", "s").limits(from, to);
    let left: Vec<f64> = record.iter().zip(modes).map(|(v, modes)| v - modes).collect();
    let offset = left.iter().sum::<f64>() / left.len().max(1) as f64;
    let left: Vec<f64> = left.into_iter().map(|v| v - offset).collect();
    let modes: Vec<f64> = modes.iter().map(|v| v + offset).collect();
    let above = Plot::new(x(), value_axis(meta.quantity.name(), unit))
        .with(Series::line("record", &times[..shown], &record[..shown]).ink(Ink::Grey).stroke(Stroke::Solid))
        .with(
            Series::line("modes", &times[..shown], &modes[..shown]).ink(Ink::Nth(0)).stroke(Stroke::Dashed),
        );
    let below = Plot::new(x(), AxisSpec::new("Residual", unit))
        .with(Series::line("", &times[..shown], &left[..shown]).ink(Ink::Nth(0)).stroke(Stroke::Thin))
        .legend(Legend::Hidden);
    let mut figure = Figure::double(format!("Decay, {title}")).height(110.0).panel(above).panel(below);
    let mut caption =
        "(a) The part of the record that was used, and the sum of its modes with an offset. (b) Residual: record minus modes.".to_owned();
    if shown < times.len() {
        let _ = write!(
            caption,
            " Drawn are the first {:.3} of {:.3} s.",
            to - from,
            times[times.len() - 1] - from
        );
    }
    if !found.levels.is_empty() {
        let levels = found.levels.iter().map(|level| (level.mode.amplitude.value, level.mode.zeta.value));
        let (amplitude, zeta): (Vec<f64>, Vec<f64>) = levels.unzip();
        let std = found.levels.iter().map(|level| level.mode.zeta.std.unwrap_or(f64::NAN));
        let damping = Plot::new(AxisSpec::new("Amplitude", unit).log(), AxisSpec::new("Damping ratio", ""))
            .with(
                Series::points("", amplitude, zeta)
                    .y_error(std.collect::<Vec<f64>>())
                    .marker(Marker::Circle)
                    .ink(Ink::Nth(0)),
            )
            .legend(Legend::Hidden);
        figure = figure.height(150.0).panel(damping);
        caption += " (c) Damping ratio of the strongest mode in stretches of falling amplitude.";
    }
    lettered(figure).caption(caption)
}
