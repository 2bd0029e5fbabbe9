//! Local maxima of a curve, and their vertices between samples.

use super::jump::Point;
use vibro_math::border;

/// A maximum of a curve over frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Frequency of the vertex, in the unit of the points (Hz).
    pub frequency: f64,
    /// Its standard uncertainty.
    pub frequency_std: f64,
    /// Height of the vertex, in the unit of the points.
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

/// Local maxima that rise by at least the factor `ratio` above the higher of the two valleys beside them
/// (their prominence), in order. Ends are no maxima; missing values end a stretch.
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
/// Near a resonance of one mode 1/a² is a parabola in frequency, so that parabola gives the vertex. Its
/// uncertainty combines three parts: the propagated uncertainty of the heights; the distance to the vertex
/// of a parabola through ln a, for the choice of curve; and h²/f for points h apart, for terms beyond the
/// parabola. A mode itself bends it by half of that, (1 − r²)² = 4δ²(1 + δ + δ²/4) with δ = r − 1, and a
/// zero or a mode at a distance d adds h²/d. Where a neighbour is below half of the middle point, the curve
/// is not resolved: the answer is the middle point with an uncertainty of its frequency, and none (NaN) of
/// its height.
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
    // A shift of the vertex by `beyond` moves the height by that fraction of the fall over one spacing.
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

/// Where the polynomial through points (`x`, `y`) of rising `x` is lowest between `low` and `high`, and its
/// value there. `None` unless it falls at `low` and rises at `high`.
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

/// Vertex of a curve over rising frequency near its highest point `i`, from up to two points on each side.
///
/// 1/a² of a damped mode is a parabola in f² (its receptance squared); further modes and contacts bend it.
/// So the polynomial in f² through up to two points on each side is used: exact for one mode at any spacing.
/// Its uncertainty combines the propagated uncertainties of the heights with the choice of points. For the
/// latter, the largest distance to the polynomials through the highest point and its neighbours, and through
/// one point less, as far as it exceeds its noise, counts as the half-width of a rectangular distribution.
/// (Contact makes a resonance lean; higher orders then decrease slowly, and two orders may agree by
/// chance.) The answer is that of
/// [`vertex`], with the uncertainty of a lean that three points cannot show, where the points beside `i` are
/// below half of it, where there are only three, or where the polynomial has no single vertex.
pub(crate) fn apex(points: &[Point], i: usize) -> Option<Vertex> {
    let near: [Point; 3] = points.get(i.checked_sub(1)?..=i + 1)?.try_into().ok()?;
    let (f, a) = (near.map(|p| p.0), near.map(|p| p.1));
    let simple = || vertex(f, a, near.map(|p| p.2)).map(|v| leaning(v, f, a));
    if points.len() < 4 || a[0] < 0.5 * a[1] || a[2] < 0.5 * a[1] {
        return simple();
    }
    // Relative to the highest, over x = f²/f₀² − 1.
    let relative = |p: &Point| ((p.0 / f[1] - 1.0) * (p.0 / f[1] + 1.0), p.1 / a[1], p.2 / a[1]);
    let points: Vec<Point> = points.iter().map(relative).collect();
    let Some([x, height]) = fitted(&points, i) else { return simple() };
    let ratio = (1.0 + x.0).sqrt();
    Some(Vertex {
        frequency: f[1] * ratio,
        frequency_std: f[1] * x.1 / (2.0 * ratio),
        height: a[1] * height.0,
        height_std: a[1] * height.1,
    })
}

/// Standard uncertainty of the lean κ of a resonance (see [`leaning`]), which three points cannot show: up
/// to 1/2 to either side with equal chance (1/√12). From κ = 1 on a resonance overhangs and ends in a jump.
const LEAN: f64 = 0.288_675;

/// Adds the uncertainty of a lean to a vertex. A resonance that leans by κ is δ = κy ± √(y² − 1), with δ the
/// detuning in half-widths and y = 1/a relative to the top. Against flanks measured at y its top moves by
/// κ(y − 1), and its height by that times their slope.
fn leaning(vertex: Vertex, f: [f64; 3], a: [f64; 3]) -> Vertex {
    let y = vertex.height / a[0].min(a[2]);
    // κ(y − 1) half-widths, where the half-width is the distance of the flanks over √(y² − 1).
    let moved = LEAN * (f[2] - f[0]) / 2.0 * ((y - 1.0) / (y + 1.0)).sqrt();
    Vertex {
        frequency_std: vertex.frequency_std.hypot(moved),
        height_std: vertex.height_std.hypot(LEAN * (y - 1.0) * vertex.height),
        ..vertex
    }
}

/// Position and height of the vertex near point `i` with their uncertainties; `None` where the polynomial
/// through all points has no single vertex.
fn fitted(points: &[Point], i: usize) -> Option<[(f64, f64); 2]> {
    let beside = (points[i - 1].0, points[i + 1].0);
    let n = points.len();
    // All subsets keep the neighbours of the highest point: without one the polynomial would be
    // extrapolated.
    let subsets = [0..n, i - 1..i + 2, usize::from(i > 1)..n, 0..n - usize::from(i + 2 < n)];
    let vertices = |points: &[Point]| {
        let each = subsets.iter().map(|subset| extremum(&points[subset.clone()], beside));
        each.collect::<Option<Vec<[f64; 2]>>>()
    };
    let found = vertices(points)?;
    // Variance of the vertex by all points, and of the distance of each vertex to it.
    let (mut variance, mut of_distance) = ([0.0; 2], vec![[0.0; 2]; subsets.len()]);
    let mut moved = points.to_vec();
    for (k, point) in points.iter().enumerate() {
        moved[k].1 += point.2;
        let other = vertices(&moved)?;
        moved[k].1 = point.1;
        for q in 0..2 {
            let own = other[0][q] - found[0][q];
            variance[q] += own * own;
            for (sum, (other, found)) in of_distance.iter_mut().zip(other.iter().zip(&found)) {
                sum[q] += (other[q] - found[q] - own).powi(2);
            }
        }
    }
    // With four points only one order can be compared, and it may agree by chance: the whole distance
    // counts.
    let share = if n > 4 { 1.0 / 3.0 } else { 1.0 };
    for q in 0..2 {
        // The mean square of a distance is that of the choice of points, and its variance by noise.
        let choice = |(rival, noise): (&[f64; 2], &[f64; 2])| (rival[q] - found[0][q]).powi(2) - noise[q];
        variance[q] += share * found.iter().zip(&of_distance).map(choice).fold(0.0, f64::max);
    }
    variance.iter().all(|v| v.is_finite()).then(|| [0, 1].map(|q| (found[0][q], variance[q].sqrt())))
}

/// Where the polynomial through 1/height² is lowest between the points beside the highest, and the height
/// there.
fn extremum(points: &[Point], beside: (f64, f64)) -> Option<[f64; 2]> {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p.0, 1.0 / (p.1 * p.1))).unzip();
    let (place, inverse) = lowest(&x, &y, beside)?;
    (inverse > 0.0).then(|| [place, 1.0 / inverse.sqrt()])
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

    /// |1/(1 − r² + 2iζr)|, its maximum at f₀√(1−2ζ²), on grids of every offset: the stated uncertainty
    /// covers the error.
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
                    // Without noise the error is that of the parabola, and twice the stated uncertainty
                    // bounds it.
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

#[cfg(test)]
mod apices {
    use super::*;
    use num_complex::Complex64;
    use vibro_math::Noise;

    fn curve(f: &[f64], a: &[f64], std: &[f64]) -> Vec<Point> {
        f.iter().zip(a).zip(std).map(|((f, a), std)| (*f, *a, *std)).collect()
    }

    /// One or two modes with a free weight and sign of the second.
    struct Modes {
        f: [f64; 2],
        zeta: [f64; 2],
        weight: f64,
    }

    impl Modes {
        fn at(&self, f: f64) -> f64 {
            let mode = |k: usize| {
                let r = f / self.f[k];
                Complex64::new(1.0 - r * r, 2.0 * self.zeta[k] * r).inv() / self.f[k].powi(2)
            };
            (mode(0) + self.weight * mode(1)).norm()
        }
    }

    /// Maximum between two frequencies by golden section; `None` where it is at an end.
    fn highest(height: &dyn Fn(f64) -> f64, from: f64, to: f64) -> Option<(f64, f64)> {
        let (mut a, mut b) = (from, to);
        let golden = (f64::sqrt(5.0) - 1.0) / 2.0;
        while b - a > 1e-9 * b {
            let (c, d) = (b - golden * (b - a), a + golden * (b - a));
            if height(c) > height(d) { b = d } else { a = c }
        }
        let f = f64::midpoint(a, b);
        (f - from > 1e-6 && to - f > 1e-6).then(|| (f, height(f)))
    }

    #[derive(Debug, Clone, Copy, PartialEq)]
    enum Kind {
        One,
        Two,
        Leaning,
    }

    /// A random curve of this kind, and the half-power width in Hz of its resonance near 5.6 Hz.
    fn draw(kind: Kind, normal: &mut Noise) -> (Box<dyn Fn(f64) -> f64>, f64) {
        let mut between = |a: f64, b: f64| a + (b - a) * normal.uniform();
        let f0 = 5.6;
        let zeta = [(); 2].map(|()| 10f64.powf(between(-2.5, -1.0)));
        let width = 2.0 * zeta[0] * f0;
        if kind == Kind::Leaning {
            // 1/a = y with δ = κy ± √(y² − 1): a stiffness that changes as 1/a, as contact over a gap makes
            // it.
            let lean = between(-0.5, 0.5);
            let height = move |f: f64| {
                let delta = 2.0 * (f - f0) / width;
                let rest = 1.0 - lean * lean;
                rest / ((lean * lean * delta * delta + rest * (1.0 + delta * delta)).sqrt() - lean * delta)
            };
            return (Box::new(height), width);
        }
        let weight = if kind == Kind::Two { between(-2.0, 2.0) } else { 0.0 };
        let modes = Modes { f: [f0, f0 * between(1.3, 2.5)], zeta, weight };
        (Box::new(move |f| modes.at(f)), width)
    }

    /// Fractions of the answers with the frequency, and with the height, within two standard uncertainties
    /// of the truth.
    fn covered(kind: Kind, noise: f64, points: usize) -> [f64; 2] {
        let mut normal = Noise::new(0x70b);
        let (mut within, mut n) = ([0u32; 2], 0u32);
        while n < 2000 {
            let (height, width) = draw(kind, &mut normal);
            // From ten points within the half-power width to one.
            let step = width * 10f64.powf(-normal.uniform());
            let mut f = vec![5.6 - 6.0 * step + step * normal.uniform()];
            for _ in 1..13 {
                f.push(f[f.len() - 1] + step * (0.6 + 0.8 * normal.uniform()));
            }
            let clean: Vec<f64> = f.iter().map(|f| height(*f)).collect();
            let std: Vec<f64> = clean.iter().map(|a| noise * a).collect();
            let a: Vec<f64> = clean.iter().zip(&std).map(|(a, s)| a + s * normal.normal()).collect();
            let i = (0..13).max_by(|i, k| a[*i].total_cmp(&a[*k])).unwrap();
            if !(2..=10).contains(&i) || a[i - 1].min(a[i + 1]) < 0.5 * a[i] {
                continue;
            }
            let Some(truth) = highest(&*height, f[i - 2], f[i + 2]) else { continue };
            let reach = points / 2;
            let near = &curve(&f, &a, &std)[i - reach..i + points - reach];
            let Some(found) = apex(near, reach) else {
                continue;
            };
            n += 1;
            let off = [(found.frequency - truth.0).abs(), (found.height - truth.1).abs()];
            // The true maximum itself is known only to rounding, since its top is flat.
            within[0] += u32::from(off[0] <= 2.0 * found.frequency_std + 1e-7);
            within[1] += u32::from(off[1] <= 2.0 * found.height_std + 1e-9 * truth.1);
        }
        within.map(|w| f64::from(w) / f64::from(n))
    }

    #[test]
    fn stated_uncertainties_cover_the_true_maximum() {
        for kind in [Kind::One, Kind::Two, Kind::Leaning] {
            for points in [3, 4, 5] {
                for noise in [0.0, 1e-4, 1e-3, 1e-2] {
                    let [place, height] = covered(kind, noise, points);
                    println!("{kind:?}, {points} points, noise {noise}: {place:.3} {height:.3}");
                    // Two standard uncertainties are 95 % of a normal distribution. A share of 2000 scatters
                    // by 0.5 %, and first-order propagation is good to a few.
                    assert!(place >= 0.92 && height >= 0.92, "{kind:?} {points} {noise}: {place} {height}");
                }
            }
        }
    }

    #[test]
    fn one_mode_is_exact_at_any_spacing() {
        let modes = Modes { f: [5.6, 9.0], zeta: [0.02, 0.02], weight: 0.0 };
        let f = [5.40, 5.51, 5.63, 5.69, 5.80];
        let a = f.map(|f| modes.at(f));
        let found = apex(&curve(&f, &a, &[0.0; 5]), 2).unwrap();
        let truth = 5.6 * f64::sqrt(1.0 - 2.0 * 0.02f64.powi(2));
        // Rounding, divided by the fourth power of the spacing: the polynomial through five points is of
        // fourth order.
        assert!((found.frequency - truth).abs() < 1e-11, "{}", found.frequency - truth);
        assert!(found.frequency_std < 1e-11);
    }
}
