//! Where two response curves cross.

use super::jump::{Jump, Point, known};
use std::collections::BTreeMap;
use vibro_record::sort_by_number;

/// Two points of a curve, and their weights in its interpolated logarithm.
type Between = [(usize, f64); 2];

/// The points between which `f` lies in a rising curve; `None` outside.
fn between(curve: &[Point], f: f64) -> Option<Between> {
    let i = curve.partition_point(|p| p.0 < f);
    let b = curve.get(i)?;
    if b.0 == f {
        return Some([(i, 1.0), (i, 0.0)]);
    }
    let a = curve.get(i.checked_sub(1)?)?;
    let t = (f - a.0) / (b.0 - a.0);
    Some([(i - 1, 1.0 - t), (i, t)])
}

/// A curve between its points, linear in the logarithm; `None` outside.
pub(super) fn at(curve: &[Point], f: f64) -> Option<f64> {
    Some(between(curve, f)?.iter().map(|(i, weight)| weight * curve[*i].1.ln()).sum::<f64>().exp())
}

/// Where two curves cross.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Standard uncertainty of the frequency in Hz; `None` where that of an amplitude is not known.
    pub frequency_std: Option<f64>,
    /// Whether the second curve is the larger one above this frequency.
    pub second_above: bool,
}

/// Crossings of two curves over frequency. Each curve is given by its points in any order. Between them its
/// logarithm is interpolated linearly, except across a jump of its own.
///
/// The uncertainty is propagated from the amplitudes through the interpolation. Where the curves cross by a
/// jump of one of them, the crossing is that jump: it lies anywhere between the two points of the jump with
/// equal probability.
pub fn crossings(mut first: Vec<Point>, mut second: Vec<Point>, jumps: &[Jump]) -> Vec<Crossing> {
    sort_by_number(&mut first, |a| a.0);
    sort_by_number(&mut second, |a| a.0);
    let curves = [&first, &second];
    let mut frequencies: Vec<f64> = curves.iter().flat_map(|c| c.iter().map(|p| p.0)).collect();
    frequencies.sort_by(f64::total_cmp);
    frequencies.dedup();

    // The points of both curves around a frequency. Within a jump of its own a curve has no value.
    let places = |f: f64| -> Option<[Between; 2]> {
        let places = [between(&first, f)?, between(&second, f)?];
        let within = |(curve, [a, b]): (&&Vec<Point>, &Between)| {
            jumps.iter().any(|j| j.span() == (curve[a.0].0, curve[b.0].0))
        };
        (!curves.iter().zip(&places).any(within)).then_some(places)
    };
    // Frequency, logarithm of second over first curve, and the points of both.
    let ratios: Vec<_> = frequencies
        .into_iter()
        .filter_map(|f| Some((f, (at(&second, f)? / at(&first, f)?).ln(), places(f)?)))
        .filter(|r| r.1.is_finite())
        .collect();
    ratios
        .windows(2)
        .filter(|w| (w[0].1 > 0.0) != (w[1].1 > 0.0))
        .map(|w| {
            let (low, high) = (&w[0], &w[1]);
            let (width, turn) = (high.0 - low.0, low.1 - high.1);
            let second_above = high.1 > 0.0;
            // A jump counts for the interval that holds more than half of its width: the two curves seldom
            // have points at exactly the same frequencies.
            let spans = jumps.iter().map(Jump::span);
            let own = spans.filter(|j| j.1.min(high.0) - j.0.max(low.0) > 0.5 * (j.1 - j.0));
            if let Some(jump) = own.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) {
                let frequency_std = Some((jump.1 - jump.0) / f64::sqrt(12.0));
                return Crossing { frequency: f64::midpoint(jump.0, jump.1), frequency_std, second_above };
            }
            // Derivatives of the crossing's frequency with respect to the log ratios at both ends.
            let slopes = [-width * high.1 / (turn * turn), width * low.1 / (turn * turn)];
            let mut variance = 0.0;
            for (which, curve) in curves.iter().enumerate() {
                // One point may enter both ends: its parts add up before they are squared.
                let mut parts = BTreeMap::new();
                for (slope, points) in [(slopes[0], low.2[which]), (slopes[1], high.2[which])] {
                    for (i, weight) in points.into_iter().filter(|p| p.1 != 0.0) {
                        *parts.entry(i).or_insert(0.0) += slope * weight;
                    }
                }
                let square = |(i, part): (&usize, &f64)| (part * curve[*i].2 / curve[*i].1).powi(2);
                variance += parts.iter().map(square).sum::<f64>();
            }
            Crossing {
                frequency: low.0 + width * low.1 / turn,
                frequency_std: known(variance.sqrt()),
                second_above,
            }
        })
        .collect()
}
