//! Impacts: the trace with its impacts marked, a histogram of the intervals, and each interval over the one
//! before.

use crate::measure::impacts::Impacts;
use crate::record::Trace;
use crate::report::layout::lettered;
use crate::report::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series, Stroke};

/// Most samples of a drawn line: print cannot show more.
const MOST_SAMPLES: usize = 4000;

/// Trace, histogram of intervals and return map.
pub fn impacts(title: &str, trace: &Trace, found: &Impacts) -> Figure {
    let intervals: Vec<f64> = found.times.windows(2).map(|w| 1e3 * (w[1] - w[0])).collect();
    let axis = |name: &str| AxisSpec::new(name, "ms");
    let (low, high) = limits(&intervals);
    let histogram = Plot::new(axis("Interval").limits(low, high), AxisSpec::new("Count", ""))
        .with(Series::histogram("", &intervals).ink(Ink::Nth(0)))
        .with(Series::vertical("mean", 1e3 * found.interval.value))
        .legend(Legend::Hidden);
    let (before, after): (Vec<f64>, Vec<f64>) = intervals.windows(2).map(|w| (w[0], w[1])).unzip();
    let map = Plot::new(axis("Interval").limits(low, high), axis("Next interval").limits(low, high))
        .with(Series::line("", [low, high], [low, high]).ink(Ink::Grey).stroke(Stroke::Thin))
        .with(Series::points("", before, after).marker(Marker::Circle).ink(Ink::Nth(0)))
        .legend(Legend::Hidden);
    // The whole record, and a stretch of it in which single impacts are visible.
    let all = (
        trace.axis.start(),
        trace.axis.start() + trace.axis.step().unwrap_or(1.0) * trace.values.len() as f64,
    );
    let middle = found.times.get(found.times.len() / 2).copied().unwrap_or(all.0);
    let half_span = 5.5 * found.median_interval;
    let near = ((middle - half_span).max(all.0), (middle + half_span).min(all.1));
    let figure = Figure::double(format!("Impacts, {title}"))
        .height(130.0)
        .columns(2)
        .panel(trace_with_impacts(trace, &found.times, all).title("whole record"))
        .panel(trace_with_impacts(trace, &found.times, near).title("about ten intervals"))
        .panel(histogram.title("intervals"))
        .panel(map.title("each interval over the one before"))
        .caption("Triangles: impacts found. (c) Vertical line: mean interval. (d) A periodic motion is one point, or a few.");
    lettered(figure)
}

/// The traces of a series of drops, each by [`drop`].
pub fn drops(name: &str, drops: Vec<Plot>) -> Figure {
    let columns = drops.len().clamp(1, 2);
    let rows = drops.len().div_ceil(columns) as f64;
    // Rows are 55 mm high, lower if there are more than four, but at least 25 mm: many drops fit a page.
    let height = if columns == 1 { 70.0 } else { rows * (220.0 / rows).clamp(25.0, 55.0) };
    let title = if name.is_empty() { "Drops".to_owned() } else { format!("Drops, {name}") };
    let figure = Figure::double(title).height(height).columns(columns).caption("Triangles: impacts found.");
    drops.into_iter().fold(figure, Figure::panel)
}

/// The trace of a drop with its impacts at `times`.
pub fn drop(file: &str, trace: &Trace, times: &[f64]) -> Plot {
    let first = times.first().copied().unwrap_or(0.0);
    let last = times.last().copied().unwrap_or(first);
    let margin = 0.15 * (last - first);
    let end = trace.axis.at(trace.values.len().saturating_sub(1));
    let (from, to) = ((first - margin).max(trace.axis.start()), (last + 2.0 * margin).min(end));
    let flight = times.get(1).map(|second| format!(", first flight {:.2} ms", 1e3 * (second - first)));
    let title = file.to_owned() + &flight.unwrap_or_default();
    trace_with_impacts(trace, times, (from, to)).title(title).legend(Legend::Hidden)
}

/// The part of a trace between two times, with its impacts marked over it.
fn trace_with_impacts(trace: &Trace, times: &[f64], (from, to): (f64, f64)) -> Plot {
    let (x, y) = outline(trace, from, to);
    let low = y.iter().copied().fold(f64::INFINITY, f64::min);
    let high = y.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let times: Vec<f64> = times.iter().copied().filter(|t| (from..=to).contains(t)).collect();
    let marker_heights = vec![high + 0.07 * (high - low); times.len()];
    let name = if trace.meta.name.is_empty() { "Trace" } else { &trace.meta.name };
    Plot::new(
        AxisSpec::new("Time", "s").limits(from, to),
        AxisSpec::new(crate::report::layout::capital(name), trace.meta.unit.symbol()),
    )
    .with(Series::line("trace", x, y).stroke(Stroke::Thin).ink(Ink::Nth(0)))
    .with(Series::points("impacts", times, marker_heights).marker(Marker::Triangle).ink(Ink::Nth(1)))
    .legend(Legend::Above)
}

/// The samples of a trace between two times; of more than print can show, the smallest and largest of each
/// stretch.
fn outline(trace: &Trace, from: f64, to: f64) -> (Vec<f64>, Vec<f64>) {
    let inside: Vec<usize> =
        (0..trace.values.len()).filter(|i| (from..=to).contains(&trace.axis.at(*i))).collect();
    let kept = inside.chunks(inside.len().div_ceil(MOST_SAMPLES / 2).max(1)).flat_map(|part| {
        let by_value = |a: &&usize, b: &&usize| trace.values[**a].total_cmp(&trace.values[**b]);
        let mut ends: Vec<usize> =
            part.iter().min_by(by_value).into_iter().chain(part.iter().max_by(by_value)).copied().collect();
        ends.sort_unstable();
        ends.dedup();
        ends
    });
    kept.map(|i| (trace.axis.at(i), trace.values[i])).unzip()
}

/// Equal limits for both axes of the return map.
fn limits(values: &[f64]) -> (f64, f64) {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let margin = (0.1 * (high - low)).max(0.01 * high.abs());
    (low - margin, high + margin)
}
