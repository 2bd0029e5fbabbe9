//! The classical methods: half-power bandwidth, and circle in the Nyquist plane.

use super::{Measured, Pole};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use std::ops::Range;
use vibro_math::least_squares;
use vibro_record::Finding;

/// Frequency in Hz of the peak at line `at`, and damping ratio from its half-power points, interpolated
/// between lines on |H|². `None` where the response does not fall to half its power on both sides inside
/// `part`.
pub(super) fn half_power(measured: &Measured, at: usize, part: &Range<usize>) -> Option<(f64, f64)> {
    let power = |i: usize| measured.values[i].norm_sqr();
    let half = power(at) / 2.0;
    let cross = |a: usize, b: usize| {
        let (pa, pb) = (power(a), power(b));
        let share = (half - pa) / (pb - pa);
        measured.frequency[a] + share * (measured.frequency[b] - measured.frequency[a])
    };
    let left = (part.start..at).rev().find(|i| power(*i) < half)?;
    let right = (at + 1..part.end).find(|i| power(*i) < half)?;
    let (low, high) = (cross(left, left + 1), cross(right - 1, right));
    let f = measured.frequency[at];
    Some((f, (high - low) / (2.0 * f)))
}

/// Fewest points of a circle fit: twice the three parameters of a circle.
const POINTS: usize = 6;

/// Largest deviation of points that still count as a circle, root mean square over its radius.
const ROUND: f64 = 0.1;

/// Half bandwidths on either side of a mode with the lines of its circle: 270° of it.
pub(super) const CIRCLE: f64 = 2.4;

/// Fits a circle to the mobility at the lines within 2.4 half bandwidths of the mode (270° of the circle),
/// by the method of Pratt (1987). Natural frequency and damping then follow from the angles on the circle:
/// tan(θ/2) = (ωᵣ² − ω²)/(2ζωᵣω) from the resonance.
///
/// Returns the mode and the number of lines.
///
/// # Errors
/// If there are fewer than six such lines, or they lie on no circle.
pub(super) fn circle(
    measured: &Measured,
    near: &Pole,
    part: &Range<usize>,
) -> Result<(Pole, usize), Finding> {
    let reach = CIRCLE * near.zeta * near.frequency;
    let points: Vec<(f64, Complex64)> = part
        .clone()
        .filter(|i| (measured.frequency[*i] - near.frequency).abs() <= reach)
        .map(|i| {
            let f = measured.frequency[i];
            (f, measured.values[i] * Complex64::new(0.0, TAU * f).powi(1 - measured.power()))
        })
        .collect();
    if points.len() < POINTS {
        return Err(Finding::caution("circle-few-lines").count("n", points.len()).count("needed", POINTS));
    }
    on_circle(&points, near).ok_or_else(|| Finding::caution("circle-not-round"))
}

fn on_circle(points: &[(f64, Complex64)], near: &Pole) -> Option<(Pole, usize)> {
    let (centre, radius) = pratt(&points.iter().map(|p| p.1).collect::<Vec<_>>())?;
    let off: f64 = points.iter().map(|p| ((p.1 - centre).norm() - radius).powi(2)).sum();
    if (off / points.len() as f64).sqrt() > ROUND * radius {
        return None;
    }
    let angles: Vec<f64> = points.iter().map(|p| (p.1 - centre).arg()).collect();
    let away = |i: &usize| (points[*i].0 - near.frequency).abs();
    let at = angles[(0..points.len()).min_by(|a, b| away(a).total_cmp(&away(b)))?];
    let unit = near.zeta * near.frequency;
    let residuals = |p: &[f64], out: &mut [f64]| {
        let (own, zeta, turn) = (near.frequency + p[0] * unit, near.zeta * p[1], at + p[2]);
        for (out, ((f, _), angle)) in out.iter_mut().zip(points.iter().zip(&angles)) {
            let expected = turn + 2.0 * ((own * own - f * f) / (2.0 * zeta * own * f)).atan();
            *out = (angle - expected + PI).rem_euclid(TAU) - PI;
        }
    };
    let fit = least_squares(residuals, points.len(), &[0.0, 1.0, 0.0], &[1.0, 1.0, 1.0]).ok()?;
    let (frequency, zeta) = (near.frequency + fit.parameters[0] * unit, near.zeta * fit.parameters[1]);
    // The mobility at resonance is A/(2ζωᵣ), a diameter.
    let constant = Complex64::cis(at + fit.parameters[2]) * (2.0 * radius * 2.0 * zeta * TAU * frequency);
    let pole = Pole { frequency, zeta, constant };
    (fit.converged && zeta > 0.0).then_some((pole, points.len()))
}

/// Circle through points by Pratt's algebraic fit: Σ(A|z|² + Bx + Cy + D)² is least under B² + C² − 4AD = 1,
/// here by Newton's method on the characteristic polynomial (Chernov 2010, 5.9).
fn pratt(points: &[Complex64]) -> Option<(Complex64, f64)> {
    let n = points.len() as f64;
    let mean = points.iter().sum::<Complex64>() / n;
    let moment = |of: fn(f64, f64, f64) -> f64| {
        let centred = points.iter().map(|p| p - mean);
        centred.map(|p| of(p.re, p.im, p.norm_sqr())).sum::<f64>() / n
    };
    let (xx, yy, xy) = (moment(|x, _, _| x * x), moment(|_, y, _| y * y), moment(|x, y, _| x * y));
    let (xz, yz, zz) = (moment(|x, _, z| x * z), moment(|_, y, z| y * z), moment(|_, _, z| z * z));
    let sum = xx + yy;
    let area = xx * yy - xy * xy;
    let a2 = 4.0 * area - 3.0 * sum * sum - zz;
    let spread = zz - sum * sum;
    let a1 = spread * sum + 4.0 * area * sum - xz * xz - yz * yz;
    let a0 = xz * (xz * yy - yz * xy) + yz * (yz * xx - xz * xy) - spread * area;
    // From 0 Newton's method climbs to the smallest root without passing it.
    let mut root = 0.0_f64;
    for _ in 0..60 {
        let value = a0 + root * (a1 + root * (a2 + 4.0 * root * root));
        let slope = a1 + root * (2.0 * a2 + 16.0 * root * root);
        let next = root - value / slope;
        if !next.is_finite() || (next - root).abs() <= 1e-14 * next.abs() {
            break;
        }
        root = next;
    }
    let determinant = root * root - root * sum + area;
    let x = (xz * (yy - root) - yz * xy) / determinant / 2.0;
    let y = (yz * (xx - root) - xz * xy) / determinant / 2.0;
    let radius = (x * x + y * y + sum + 2.0 * root).sqrt();
    radius.is_finite().then(|| (mean + Complex64::new(x, y), radius))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_a_circle_give_it_exactly() {
        let (centre, radius) = (Complex64::new(3.0, -2.0), 0.7);
        let points: Vec<Complex64> =
            (0..7).map(|i| centre + Complex64::from_polar(radius, 0.3 + 0.4 * f64::from(i))).collect();
        let (c, r) = pratt(&points).unwrap();
        // The moments cancel to squares of the radius; an arc of 2.4 rad is well conditioned.
        assert!((c - centre).norm() < 1e-10 && (r - radius).abs() < 1e-10, "{c} {r}");
        assert!(pratt(&[centre; 6]).is_none_or(|(_, r)| r.abs() < 1e-6));
    }
}
