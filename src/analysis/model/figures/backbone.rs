//! Response and backbone of a mass on a curved spring.

use super::branches::Pieces;
use crate::model::{CurvePoint, CurvedResponse};
use crate::report::layout::{line, points};
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Stroke};

/// Amplitude over frequency by harmonic balance, whose points of each frequency are `columns`, with the exact
/// motions of the points `shown`. Points more than `step` (Hz) apart are not joined.
pub fn backbone(
    title: &str,
    found: &CurvedResponse,
    columns: &[&[CurvePoint]],
    shown: &[&CurvePoint],
    step: f64,
) -> Figure {
    let mut lines: [Pieces; 2] = Default::default();
    let place = |p: &CurvePoint| (p.frequency, 1e3 * p.amplitude);
    let near = |pair: &&[&[CurvePoint]]| pair[1][0].frequency - pair[0][0].frequency <= 1.001 * step;
    for pair in columns.windows(2).filter(near) {
        // The columns have one or three motions: each of the smaller number goes on to the nearest alike.
        let (few, many) = if pair[0].len() < pair[1].len() { (pair[0], pair[1]) } else { (pair[1], pair[0]) };
        for a in few {
            let alike = many.iter().filter(|b| b.stable == a.stable);
            let far = |b: &&CurvePoint| (b.amplitude - a.amplitude).abs();
            let Some(b) = alike.min_by(|b, c| far(b).total_cmp(&far(c))) else { continue };
            let (from, to) = if a.frequency < b.frequency { (a, b) } else { (b, a) };
            lines[usize::from(a.stable)].join(place(from), place(to));
        }
    }
    let [unstable, stable] = lines;
    let ends = [found.points.first(), found.points.last()].map(|p| p.map_or(f64::NAN, |p| p.frequency));
    let backbone = |i: usize| found.backbone.iter().map(move |row| (row[i], 1e3 * row[0]));
    let mut plot =
        Plot::new(AxisSpec::frequency().limits(ends[0], ends[1]), AxisSpec::new("Amplitude", "mm"));
    plot = line(plot, "backbone", backbone(1), Ink::Nth(2), Stroke::DashDot);
    plot = line(plot, "unstable", unstable.places(), Ink::Nth(0), Stroke::Dashed);
    plot = line(plot, "stable", stable.places(), Ink::Nth(0), Stroke::Solid);
    plot = points(plot, "exact backbone", backbone(2), Ink::Nth(2), Marker::Diamond);
    for (stable, name, marker) in
        [(true, "exact, stable", Marker::Circle), (false, "exact, unstable", Marker::OpenCircle)]
    {
        let exact = shown.iter().filter_map(|p| Some((p.frequency, p.exact?)));
        let of_kind = exact.filter(|(_, exact)| exact.is_stable() == stable);
        let places = of_kind.map(|(frequency, exact)| (frequency, 1e3 * exact.amplitude));
        plot = points(plot, name, places, Ink::Black, marker);
    }
    Figure::double(title).height(100.0).panel(plot).caption(
        "Half the peak-to-peak displacement. Lines: harmonic balance, stable motions solid, unstable ones dashed; dash-dotted the free \
         motion without damper. Markers: exact periodic motions and exact free motion.",
    )
}
