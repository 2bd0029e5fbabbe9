//! Local maxima of a curve, and their vertices between samples.

use crate::record::Frf;

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

/// Indices of local maxima that rise by at least the factor `ratio` above the higher of the two valleys beside them
/// (their prominence), in order. Ends are no maxima; missing values end a stretch.
pub fn local_maxima(values: &[f64], ratio: f64) -> Vec<usize> {
    let n = values.len();
    (1..n.saturating_sub(1))
        .filter(|&i| {
            let v = values[i];
            if !(v > values[i - 1] && v >= values[i + 1]) {
                return false;
            }
            // Lowest value on the way to a higher one, or to the end.
            let valley = |side: &mut dyn Iterator<Item = &f64>| {
                side.take_while(|w| **w <= v).fold(f64::INFINITY, |low, w| low.min(*w))
            };
            let left = valley(&mut values[..i].iter().rev());
            let right = valley(&mut values[i + 1..].iter());
            v >= ratio * left.max(right)
        })
        .collect()
}

/// Vertex through three points `f` (rising) with heights `a` and their standard uncertainties.
///
/// Near a resonance of one mode 1/a² is a parabola in frequency, so that parabola gives the vertex. A parabola through ln a is
/// the rival: the distance between the two stands for what the choice of curve may cost, and is added to the
/// propagated uncertainty of the heights. `None` where the middle point is not the highest.
pub fn vertex(f: [f64; 3], a: [f64; 3], std: [f64; 3]) -> Option<Vertex> {
    if !(a[1] >= a[0] && a[1] >= a[2] && a[1] > 0.0 && a[0] > 0.0 && a[2] > 0.0) {
        return None;
    }
    let (frequency, inverse) = parabola(f, a.map(|v| 1.0 / (v * v)))?;
    // A sharp peak between coarse points can put the parabola below zero: the curve does not hold there.
    let rival = parabola(f, a.map(f64::ln)).map(|(f, h)| (f, h.exp()));
    let (frequency, height) = if inverse > 0.0 { (frequency, 1.0 / inverse.sqrt()) } else { rival? };
    let (rival_f, rival_h) = rival.unwrap_or((f[1], a[1]));
    let mut variance = [(frequency - rival_f).powi(2), (height - rival_h).powi(2)];
    for i in 0..3 {
        let mut moved = a;
        moved[i] += std[i];
        if let Some((f_moved, inverse)) = parabola(f, moved.map(|v| 1.0 / (v * v))).filter(|v| v.1 > 0.0) {
            variance[0] += (f_moved - frequency).powi(2);
            variance[1] += (1.0 / inverse.sqrt() - height).powi(2);
        }
    }
    Some(Vertex { frequency, frequency_std: variance[0].sqrt(), height, height_std: variance[1].sqrt() })
}

/// Peaks of the magnitude of a frequency response function that stand at least the factor `ratio` above their valleys.
///
/// Vertices are interpolated between the lines (see [`vertex`]); they are peaks of a curve, not yet modes.
pub fn frf_peaks(frf: &Frf, ratio: f64) -> Vec<Vertex> {
    let magnitude: Vec<f64> = frf.values.iter().map(|v| v.norm()).collect();
    local_maxima(&magnitude, ratio)
        .into_iter()
        .filter_map(|i| {
            let at = [i - 1, i, i + 1];
            vertex(at.map(|k| frf.axis.at(k)), at.map(|k| magnitude[k]), [0.0; 3])
        })
        .collect()
}

/// Extremum of the parabola through three points, inside their range.
fn parabola(x: [f64; 3], y: [f64; 3]) -> Option<(f64, f64)> {
    let (h0, h1) = (x[1] - x[0], x[2] - x[1]);
    let (s0, s1) = ((y[1] - y[0]) / h0, (y[2] - y[1]) / h1);
    let curvature = (s1 - s0) / (h0 + h1);
    let slope = (s0 * h1 + s1 * h0) / (h0 + h1);
    let step = -slope / (2.0 * curvature);
    let vertex = x[1] + step;
    (vertex >= x[0] && vertex <= x[2]).then(|| (vertex, y[1] + slope * step + curvature * step * step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prominence_passes_over_ripples() {
        let values = [1.0, 5.0, 4.9, 5.1, 2.0, 3.0, 1.0, 0.5];
        assert_eq!(local_maxima(&values, 1.2), [3, 5]);
        assert_eq!(local_maxima(&values, 1.01), [1, 3, 5]);
        assert!(local_maxima(&[1.0, f64::NAN, 1.0], 1.2).is_empty());
        assert!(local_maxima(&[], 1.2).is_empty());
    }

    #[test]
    fn the_vertex_of_a_damped_resonance() {
        // |1/(1 − (f/f0)² + 2iζ f/f0)| on an uneven grid; its maximum lies at f0 √(1−2ζ²).
        let (f0, zeta) = (5.6, 0.02);
        let height = |f: f64| {
            let r: f64 = f / f0;
            1.0 / (1.0 - r * r).hypot(2.0 * zeta * r)
        };
        let f = [5.53, 5.59, 5.68];
        let found = vertex(f, f.map(height), [0.0; 3]).unwrap();
        let truth = f0 * f64::sqrt(1.0 - 2.0 * zeta * zeta);
        // 1/a² is a quartic: what the parabola leaves out is of third order in (f − f0)/f0 ≈ 0.015.
        assert!((found.frequency - truth).abs() < 0.003, "{found:?}");
        assert!((found.height / height(truth) - 1.0).abs() < 0.01);
        assert!((found.frequency - truth).abs() < found.frequency_std, "{found:?}");
    }

    #[test]
    fn no_vertex_where_the_middle_is_not_highest() {
        assert_eq!(vertex([1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [0.0; 3]), None);
        assert_eq!(vertex([1.0, 2.0, 3.0], [0.0, 2.0, 1.0], [0.0; 3]), None);
    }
}
