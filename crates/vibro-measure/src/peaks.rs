//! Local maxima of a curve, and their vertices between samples.

use super::noise::border;

/// A maximum of a curve over frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Frequency of the vertex.
    pub frequency: f64,
    /// Its standard uncertainty.
    pub frequency_std: f64,
    /// Height of the vertex.
    pub height: f64,
    /// Its standard uncertainty.
    pub height_std: f64,
}

/// A local maximum and the lowest points on the way to a higher one, or to the end, on both sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Maximum {
    /// Index of the maximum.
    pub at: usize,
    /// Indices of the valleys.
    pub valleys: [usize; 2],
}

/// Local maxima that rise by at least the factor `ratio` above the higher of the two valleys beside them (their
/// prominence), in order. Ends are no maxima; missing values end a stretch.
pub fn local_maxima(values: &[f64], ratio: f64) -> Vec<Maximum> {
    let n = values.len();
    let lowest = |side: &mut dyn Iterator<Item = usize>, v: f64| {
        side.take_while(|k| values[*k] <= v).min_by(|a, b| values[*a].total_cmp(&values[*b]))
    };
    (1..n.saturating_sub(1))
        .filter_map(|i| {
            let v = values[i];
            if !(v > values[i - 1] && v >= values[i + 1]) {
                return None;
            }
            let valleys = [lowest(&mut (0..i).rev(), v)?, lowest(&mut (i + 1..n), v)?];
            let higher = values[valleys[0]].max(values[valleys[1]]);
            (v >= ratio * higher).then_some(Maximum { at: i, valleys })
        })
        .collect()
}

/// Vertex through three points `f` (rising) with heights `a` and their standard uncertainties.
///
/// Near a resonance of one mode 1/a² is a parabola in frequency, so that parabola gives the vertex. Its uncertainty is made of
/// the propagated uncertainty of the heights; the distance to the vertex of a parabola through ln a, for the choice of
/// curve; and h²/f for points h apart, the size of what a curve has beyond the parabola: a mode itself bends it by half of that,
/// (1 − r²)² = 4δ²(1 + δ + δ²/4) with δ = r − 1, and a zero or a mode at a distance d adds h²/d. Where a neighbour is below half of the middle point, the curve is not resolved: the
/// middle point is given with the uncertainty of its place, and no uncertainty (NaN) of its height.
///
/// `None` where the middle point is not the highest.
pub fn vertex(f: [f64; 3], a: [f64; 3], std: [f64; 3]) -> Option<Vertex> {
    if !(a[1] >= a[0] && a[1] >= a[2] && a[0] > 0.0 && a[2] > 0.0) {
        return None;
    }
    let spacing = (f[2] - f[0]) / 2.0;
    let unresolved = Vertex {
        frequency: f[1],
        frequency_std: (f[1] - f[0]).max(f[2] - f[1]) / f64::sqrt(3.0),
        height: a[1],
        height_std: f64::NAN,
    };
    // Relative to the top, so that no square can overflow.
    let top = a[1];
    let (a, std) = (a.map(|v| v / top), std.map(|s| s / top));
    if a[0] < 0.5 || a[2] < 0.5 {
        return Some(unresolved);
    }
    let parabola = |y: [f64; 3]| lowest(&f, &y, (f[0], f[2]));
    let place = |a: [f64; 3]| parabola(a.map(|v| 1.0 / (v * v))).filter(|v| v.1 > 0.0);
    let Some((frequency, inverse)) = place(a) else { return Some(unresolved) };
    let height = 1.0 / inverse.sqrt();
    let (rival_f, rival_h) = parabola(a.map(|v| -v.ln())).map_or((f[1], 1.0), |(f, h)| (f, (-h).exp()));
    let beyond = spacing * spacing / frequency;
    // The height moves by as much of the fall beside it.
    let fall = (1.0 / a[0].min(a[2]) - 1.0) * beyond / spacing;
    let mut variance =
        [(frequency - rival_f).powi(2) + beyond * beyond, (height - rival_h).powi(2) + fall * fall];
    for i in 0..3 {
        let mut moved = a;
        moved[i] += std[i];
        match place(moved) {
            Some((f_moved, inverse)) => {
                variance[0] += (f_moved - frequency).powi(2);
                variance[1] += (1.0 / inverse.sqrt() - height).powi(2);
            }
            None => return Some(unresolved),
        }
    }
    let [frequency_std, height_std] = variance.map(f64::sqrt);
    Some(Vertex { frequency, frequency_std, height: height * top, height_std: height_std * top })
}

/// Where the polynomial through points (`x`, `y`) of rising `x` is lowest between `low` and `high`, and its value there. `None` unless it
/// falls at the one and rises at the other.
pub(crate) fn lowest(x: &[f64], y: &[f64], (low, high): (f64, f64)) -> Option<(f64, f64)> {
    // Newton's divided differences.
    let mut c = y.to_vec();
    for order in 1..c.len() {
        for k in (order..c.len()).rev() {
            c[k] = (c[k] - c[k - 1]) / (x[k] - x[k - order]);
        }
    }
    // Value and slope, by Horner's scheme.
    let at = |t: f64| {
        c.iter().zip(x).rev().fold((0.0, 0.0), |(p, slope), (c, x)| (p * (t - x) + c, slope * (t - x) + p))
    };
    (at(low).1 < 0.0 && at(high).1 > 0.0).then(|| {
        let place = border(low, high, |t| at(t).1 < 0.0);
        (place, at(place).0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prominence_passes_over_ripples() {
        let values = [1.0, 5.0, 4.9, 5.1, 2.0, 3.0, 1.0, 0.5];
        let at = |ratio| local_maxima(&values, ratio).iter().map(|m| m.at).collect::<Vec<_>>();
        assert_eq!(at(1.2), [3, 5]);
        assert_eq!(at(1.01), [1, 3, 5]);
        assert_eq!(local_maxima(&values, 1.2)[1].valleys, [4, 7]);
        assert!(local_maxima(&[1.0, f64::NAN, 1.0], 1.2).is_empty());
        assert!(local_maxima(&[], 1.2).is_empty());
    }

    /// |1/(1 − r² + 2iζr)|, its maximum at f₀√(1−2ζ²), on grids of every offset: the stated uncertainty covers the error.
    #[test]
    fn vertices_of_damped_resonances_lie_within_their_uncertainty() {
        let f0 = 5.6;
        for zeta in [0.1, 0.025, 0.01, 0.003] {
            for step in [0.4, 0.2, 0.1, 0.03, 0.01] {
                let height = |f: f64| {
                    let r: f64 = f / f0;
                    1.0 / (1.0 - r * r).hypot(2.0 * zeta * r)
                };
                let truth = f0 * f64::sqrt(1.0 - 2.0 * zeta * zeta);
                for offset in 0..20 {
                    let middle = truth + step * (f64::from(offset) / 20.0 - 0.475);
                    let f = [middle - step, middle, middle + step];
                    let Some(found) = vertex(f, f.map(height), [0.0; 3]) else { continue };
                    let error = (found.frequency - truth).abs();
                    // No noise: the error is one of the curve, and twice the stated size bounds it.
                    assert!(
                        error <= 2.0 * found.frequency_std,
                        "ζ {zeta}, step {step}, {offset}: {error} {found:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn scale_does_not_matter() {
        let (f, a) = ([1.0, 1.1, 1.25], [0.8, 1.0, 0.7]);
        let plain = vertex(f, a, [0.01; 3]).unwrap();
        for scale in [1e-250, 1e250] {
            let scaled = vertex(f, a.map(|v| v * scale), [0.01 * scale; 3]).unwrap();
            assert!((scaled.frequency - plain.frequency).abs() < 1e-12, "{scaled:?}");
            assert!((scaled.frequency_std / plain.frequency_std - 1.0).abs() < 1e-9, "{scaled:?}");
        }
    }

    #[test]
    fn no_vertex_where_the_middle_is_not_highest() {
        assert_eq!(vertex([1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [0.0; 3]), None);
        assert_eq!(vertex([1.0, 2.0, 3.0], [0.0, 2.0, 1.0], [0.0; 3]), None);
    }
}
