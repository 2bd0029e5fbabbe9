//! Figures of a plan.

use super::Forecast;
use super::sweep::{CoursePoint, Suggested, Suggestion};
use crate::report::layout::{lettered, line};
use crate::report::{AxisSpec, Figure, Ink, Plot, Stroke};

/// Lines that can be told apart by colour; further ones are dashed.
const COLOURS: usize = 6;

/// Uncertainty left over the factor on each key, one panel a test; `None` where nothing changes it.
pub fn courses(all: &[Forecast]) -> Option<Figure> {
    let drawn: Vec<&Forecast> = all.iter().filter(|forecast| !forecast.courses.is_empty()).collect();
    if drawn.is_empty() {
        return None;
    }
    let panel = |forecast: &&Forecast| {
        let axes = (
            AxisSpec::new("Factor on the key", "").log(),
            AxisSpec::new("Factor on the uncertainty", "").log(),
        );
        let plot = Plot::new(axes.0, axes.1).title(&forecast.title);
        forecast.courses.iter().enumerate().fold(plot, |plot, (i, course)| {
            let stroke = if i < COLOURS { Stroke::Solid } else { Stroke::Dashed };
            line(plot, course.key, course.points.iter().copied(), Ink::Nth(i % COLOURS), stroke)
        })
    };
    let height = 80.0 * drawn.len().div_ceil(2) as f64;
    let figure = Figure::double("What changes the expected uncertainties").height(height);
    let figure = drawn.iter().map(panel).fold(figure.columns(drawn.len().min(2)), Figure::panel);
    let caption = "Mean factor on the expected uncertainties of all answers, over the factor on one key of the plan, all others as planned.";
    Some(lettered(figure).caption(caption))
}

/// Uncertainty over the number of points, and what one more point is worth over frequency.
pub fn points(title: &str, suggested: &Suggested) -> Figure {
    let course = |of: fn(&CoursePoint) -> Option<f64>| {
        let known = suggested.course.iter().filter_map(|point| Some((point.n as f64, 100.0 * of(point)?)));
        known.collect::<Vec<_>>()
    };
    let above = Plot::new(AxisSpec::new("Points", ""), AxisSpec::new("Relative uncertainty", "%").log());
    let above = line(above, "even grid", course(|point| point.even), Ink::Grey, Stroke::Solid);
    let above = line(above, "suggested points", course(|point| point.suggested), Ink::Nth(0), Stroke::Solid);
    let below = Plot::new(AxisSpec::frequency(), AxisSpec::new("Gain of one more point", "%"));
    let mut forces: Vec<f64> = suggested.gains.iter().map(|gain| gain.1).collect();
    forces.dedup();
    let below = forces.iter().enumerate().fold(below, |plot, (i, force)| {
        let own = suggested.gains.iter().filter(|gain| gain.1 == *force);
        let places = own.map(|(frequency, _, gain)| (*frequency, 100.0 * gain));
        line(plot, &format!("{force} N"), places, Ink::Nth(i % COLOURS), Stroke::Solid)
    });
    let note = |plot: Plot, (i, point): (usize, &Suggestion)| {
        let same = |gain: &&(f64, f64, f64)| gain.0 == point.frequency && gain.1 == point.force;
        let gain = suggested.gains.iter().find(same).map_or(0.0, |gain| 100.0 * gain.2);
        plot.note(format!("{}", i + 1), point.frequency, gain)
    };
    let below = suggested.points.iter().enumerate().fold(below, note);
    let caption = format!(
        "(a) Relative standard uncertainty of {} over the number of points. (b) Part by which one more point lowers the uncertainty, over its frequency; numbered are the points suggested, in their order.",
        suggested.aim
    );
    lettered(Figure::double(format!("{title}: next points")).columns(2).panel(above).panel(below))
        .caption(caption)
}
