//! Hammer drills: the average turn, a few turns as measured, motion against noise, speed over time.

use crate::measure::drill::{Corner, Drill, Impact, TurnsFrom};
use crate::record::code;
use crate::report::layout::lettered;
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Series, Stroke};
use crate::units::notation::significant;

/// Most points of a line: more are not visible in print.
const MOST_POINTS: usize = 4000;

/// Turns averaged for a point of the speed, where each turn is a whole number of samples.
const AVERAGED_TURNS: usize = 10;

/// Most markers over a line: more hide it.
const MOST_MARKERS: usize = 20;

/// Colour and marker of the velocities before and after the impacts of each group; a fifth group looks like
/// the first.
const FORMS: [[(Ink, Marker); 2]; 4] = [
    [(Ink::Nth(1), Marker::Circle), (Ink::Nth(2), Marker::Square)],
    [(Ink::Nth(3), Marker::Triangle), (Ink::Nth(4), Marker::Diamond)],
    [(Ink::Nth(5), Marker::Circle), (Ink::Nth(6), Marker::Square)],
    [(Ink::Nth(7), Marker::Triangle), (Ink::Nth(8), Marker::Diamond)],
];

/// All figures of a record, by file name.
pub fn drill(name: &str, drill: &Drill) -> Vec<(String, Figure)> {
    let mut figures = vec![
        ("drill_average".to_owned(), average(name, drill)),
        ("drill_trace".to_owned(), trace(name, drill)),
        ("drill_speed".to_owned(), speed(name, drill)),
    ];
    figures.extend(bandwidth(name, drill).map(|f| ("drill_bandwidth".to_owned(), f)));
    figures.extend(noise_floor(name, drill).map(|f| ("drill_noise".to_owned(), f)));
    figures
}

/// The average turn: velocity with its scatter and the impacts, and displacement.
fn average(name: &str, drill: &Drill) -> Figure {
    let a = &drill.average;
    // The curve is closed, since the turn ends where it begins.
    let closed = |values: Vec<f64>| -> Vec<f64> {
        let first = values.first().copied();
        values.into_iter().chain(first).collect()
    };
    let degrees: Vec<f64> = a.phase.iter().map(|p| 360.0 * p).chain([360.0]).collect();
    let edge = |sign: f64| closed(a.mean.iter().zip(&a.std).map(|(m, s)| m + sign * s).collect());
    let from = match drill.turns_from {
        TurnsFrom::Reference => "Crank angle after the pulse",
        TurnsFrom::Impacts => "Part of the turn after the impact",
    };
    let x = || AxisSpec::new(from, "°").limits(0.0, 360.0);
    let above = Plot::new(x(), AxisSpec::new("Velocity", "m/s"))
        .with(Series::band("± 1 standard deviation", degrees.clone(), edge(-1.0), edge(1.0)).ink(Ink::Nth(0)))
        .with(Series::line("mean", degrees.clone(), closed(a.mean.clone())).ink(Ink::Nth(0)));
    let (mut above, marked) = marks(above, drill, |i| 360.0 * i.phase, |_| true);
    for group in drill.groups.iter().filter(|group| group.before.value.is_nan()) {
        above = above.with(Series::vertical("impacts", 360.0 * group.phase.value));
    }
    let below = Plot::new(x(), AxisSpec::new("Displacement", "m"))
        .with(Series::line("", degrees, closed(drill.displacement.value.clone())).ink(Ink::Nth(0)));
    let smoothed = match drill.smoothing {
        Some(Corner::ZeroPhaseLowPass(f) | Corner::Exponential(f)) => {
            format!("low-pass with a corner at {f:.0} Hz")
        }
        None => "not smoothed".to_owned(),
    };
    lettered(Figure::double(format!("Average turn, {name}")).height(130.0).shared_x().panel(above).panel(below)).caption(format!(
        "Mean of {} turns at {:.2} Hz with the scatter from turn to turn; {smoothed}. Displacement by integration over whole turns. {marked} of {} impacts are marked.{}",
        drill.averaged,
        drill.speed.value,
        drill.impacts.len(),
        if drill.groups.len() > 1 { " Group 0 is the strongest, of which means are given." } else { "" }
    ))
}

/// Velocities before and after the impacts over `x`, each group with its own markers; and the number of
/// impacts marked.
fn marks(
    mut plot: Plot,
    drill: &Drill,
    x: impl Fn(&Impact) -> f64,
    shown: impl Fn(&Impact) -> bool,
) -> (Plot, usize) {
    let mut marked = 0;
    for (number, forms) in (0..drill.groups.len()).zip(FORMS.iter().cycle()) {
        let of_group: Vec<Impact> =
            drill.impacts.iter().filter(|i| i.group == number && shown(i)).copied().collect();
        let of_group = thin(&of_group, MOST_MARKERS);
        let group_name = if drill.groups.len() > 1 { format!(", group {number}") } else { String::new() };
        // Refused velocities are not drawn.
        let refused = drill.groups.get(number).is_some_and(|group| group.before.value.is_nan());
        if of_group.is_empty() || refused {
            continue;
        }
        marked += of_group.len();
        for (side, (ink, marker)) in ["before", "after"].into_iter().zip(*forms) {
            let x: Vec<f64> = of_group.iter().map(&x).collect();
            let y: Vec<f64> =
                of_group.iter().map(|i| if side == "before" { i.before } else { i.after }).collect();
            plot =
                plot.with(Series::points(format!("{side} impact{group_name}"), x, y).ink(ink).marker(marker));
        }
    }
    (plot, marked)
}

/// A few turns as measured, with the reference where there is one.
fn trace(name: &str, drill: &Drill) -> Figure {
    let (start, step) = drill.excerpt_time;
    let time = |n: usize| -> Vec<f64> { (0..n).map(|k| start + k as f64 * step).collect() };
    let n = drill.excerpt.len();
    let end = start + n as f64 * step;
    let x = || AxisSpec::new("Time", "s").limits(start, end);
    let above = Plot::new(x(), AxisSpec::new("Velocity", "m/s"))
        .with(Series::line("measured", time(n), drill.excerpt.clone()).ink(Ink::Grey).stroke(Stroke::Thin));
    let (above, _) = marks(above, drill, |i| i.time, |i| i.time >= start && i.time <= end);
    let figure = Figure::double(format!("Trace, {name}"));
    if drill.turns_from == TurnsFrom::Impacts {
        let caption = "A few turns in the middle of the record, as measured: drop-outs are not bridged here.";
        return figure.height(70.0).panel(above).caption(caption);
    }
    let reference = drill.excerpt_reference.clone();
    let mut below = Plot::new(x(), AxisSpec::new("Reference, as recorded", ""))
        .with(Series::line("", time(reference.len()), reference).ink(Ink::Black).stroke(Stroke::Thin));
    for edge in drill.times.iter().filter(|t| **t >= start - step && **t <= end) {
        below = below.with(Series::vertical("", *edge));
    }
    let caption = "A few turns in the middle of the record, as measured: drop-outs are not bridged here. Vertical lines are the edges of the reference that begin a turn.";
    lettered(figure.height(110.0).shared_x().panel(above).panel(below)).caption(caption)
}

/// Rotational speed over time.
fn speed(name: &str, drill: &Drill) -> Figure {
    let plot = Plot::new(AxisSpec::new("Time", "s"), AxisSpec::new("Speed", "Hz"));
    let sharp = drill.findings.iter().any(|found| found.code == code::DRILL_EDGES_SHARP);
    // Each turn is then a whole number of samples: single turns would only show steps of one sample.
    let (name_of, turns) = if sharp && drill.speeds.len() > AVERAGED_TURNS * AVERAGED_TURNS {
        (format!("mean of {AVERAGED_TURNS} turns"), AVERAGED_TURNS)
    } else {
        ("each turn".to_owned(), 1)
    };
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let over =
        |values: &[f64]| thin(&values.chunks_exact(turns).map(mean).collect::<Vec<f64>>(), MOST_POINTS);
    let plot = plot.with(Series::line(name_of, over(&drill.times), over(&drill.speeds)).stroke(Stroke::Thin));
    let plot = plot.with(Series::horizontal("mean", drill.speed.value));
    let step = significant(drill.speed.value.powi(2) * drill.excerpt_time.1, 2);
    let steps =
        format!(" Pulses rise within one sample, so the speed of one turn is resolved to {step} Hz only.");
    let caption = format!("Turns of the crank in a second.{}", if sharp { &steps } else { "" });
    Figure::double(format!("Speed, {name}")).height(70.0).panel(plot).caption(caption)
}

/// Envelope of the acceleration's spectrum: the largest sine of each frequency within the speed, acceleration
/// and jerk of a turn, medians over turns of their largest values; `None` where f₁ is not below f₂.
fn bandwidth(name: &str, drill: &Drill) -> Option<Figure> {
    let b = &drill.bandwidth;
    let corners = b.f1 > 0.0 && b.f2.is_finite() && b.f1 < b.f2;
    let (low, high) = corners.then_some((0.1 * b.f1, 2.0 * b.nyquist.max(b.f2)))?;
    let plot = Plot::new(
        AxisSpec::frequency().log().limits(low, high),
        AxisSpec::new("Acceleration, envelope", "m/s²").log(),
    );
    let f = [low, b.f1, b.f2, high];
    let bounds = [b.acceleration * low / b.f1, b.acceleration, b.acceleration, b.acceleration * b.f2 / high];
    let marks = [("f₁", b.f1), ("f₂", b.f2), ("half the sampling rate", b.nyquist)];
    let plot = plot.with(Series::line("", f.to_vec(), bounds.to_vec()).ink(Ink::Nth(0)));
    let plot = marks.into_iter().fold(plot, |plot, (name, at)| plot.with(Series::vertical(name, at)));
    let [v, a, j, f1, f2] = [b.speed, b.acceleration, b.jerk, b.f1, b.f2].map(|x| significant(x, 3));
    let limit = if b.sampling_limited { " ≥" } else { " =" };
    Some(Figure::double(format!("Bandwidth, {name}")).height(80.0).panel(plot).caption(format!(
        "Largest sine of each frequency within speed {v} m/s (up to f₁ = {f1} Hz), acceleration {a} m/s² and jerk {j} m/s³ (from f₂{limit} {f2} Hz), each the median over turns of the largest of a turn: a limit of the acceleration's spectrum, not the spectrum."
    )))
}

/// Spectra of motion and noise; `None` without a record of the noise.
fn noise_floor(name: &str, drill: &Drill) -> Option<Figure> {
    let floor = drill.noise_floor.as_ref()?;
    let lowest = floor.noise.iter().copied().fold(f64::INFINITY, f64::min).max(-400.0);
    let highest = floor.motion.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let y = AxisSpec::new(format!("RMS of {:.1} Hz lines, re 1 m/s", floor.line_width), "dB")
        .limits(lowest - 10.0, highest + 5.0);
    let x = AxisSpec::frequency().log();
    let mut plot = Plot::new(x, y)
        .with(Series::line("motion", floor.frequency.clone(), floor.motion.clone()).stroke(Stroke::Thin))
        .with(
            Series::line("no motion", floor.frequency.clone(), floor.noise.clone())
                .stroke(Stroke::Thin)
                .ink(Ink::Grey),
        );
    // The widest band is the one of interest: its upper end is marked.
    let widest = floor.bands.iter().max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
    if let Some(band) = widest {
        plot = plot.with(Series::vertical(format!("{} dB margin ends", floor.margin), band[1]));
    }
    Some(Figure::double(format!("Motion and noise, {name}")).panel(plot).caption(format!(
        "RMS of lines {:.1} Hz wide. Motion stands {} dB or more above the noise in {} bands.",
        floor.line_width,
        floor.margin,
        floor.bands.len()
    )))
}

/// Every n-th value, with n such that at most `most` remain.
fn thin<T: Copy>(values: &[T], most: usize) -> Vec<T> {
    values.iter().step_by(values.len().div_ceil(most).max(1)).copied().collect()
}
