//! Lack of fit: what the parabolas beside impacts leave in the same way at each of them.
//!
//! Noise differs from impact to impact. A residual that all have in common is motion that is no parabola: ringing, a contact that lasts
//! longer than the gap between the fits, an instrument that is slow. It moves every speed by as much, and no scatter from impact to
//! impact shows it.

/// Most places of a fit at which residuals are kept; where a fit has more samples, neighbours share a place.
const PLACES: usize = 32;
/// Fewest impacts that are compared.
const FEWEST: usize = 4;
/// Standard deviations of a normal distribution beyond which a common residual is significant: by chance in one case of 4000.
const SIGNIFICANT: f64 = 3.5;

/// Residuals of one fit by their place; 0 where nothing was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shape([f32; PLACES]);

impl Shape {
    /// From residuals with the numbers of their samples among `length`.
    pub fn new(residuals: impl Iterator<Item = (usize, f64)>, length: usize) -> Shape {
        let (mut sums, mut counts) = ([0.0; PLACES], [0.0f64; PLACES]);
        for (k, residual) in residuals {
            let place = k * places(length) / length.max(1);
            if let (Some(sum), Some(count)) = (sums.get_mut(place), counts.get_mut(place)) {
                *sum += residual;
                *count += 1.0;
            }
        }
        Shape(std::array::from_fn(|k| (sums[k] / counts[k].max(1.0)) as f32))
    }
}

fn places(length: usize) -> usize {
    length.min(PLACES)
}

/// Residuals of the fits before and after impacts.
#[derive(Debug, Clone, Default)]
pub(super) struct Residuals {
    /// Of each impact, before and after it.
    pub shapes: Vec<[Shape; 2]>,
    /// Samples of a fit.
    pub length: usize,
    /// Samples from the end of a fit to the middle of the contact.
    pub gap: usize,
}

/// Motion that is no parabola.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LackOfFit {
    /// Root of the mean square of the common residual, in m/s.
    pub residual: f64,
    /// By how much it may move the speed at the impact, in m/s.
    pub bias: f64,
}

impl Residuals {
    /// Significant lack of fit before and after the impacts with these numbers.
    ///
    /// n residuals of p places have the mean m and the covariance S. n|m|²/tr S is 1 in noise, and distributed as F of f and f(n − 1)
    /// degrees of freedom, f = (tr Σ)²/tr Σ² (G. Box, Ann. Math. Stat. 25 (1954) 290), which allows for noise that depends on itself;
    /// tr Σ² as of Z. Bai and H. Saranadasa, Statistica Sinica 6 (1996) 311, and that of white noise at least. F is compared with chance
    /// by its cube root (E. Paulson, Ann. Math. Stat. 13 (1942) 233).
    ///
    /// The bias is the residual continued to the middle of the contact: the least bent curve that a parabola leaves is the third of
    /// Legendre's polynomials, √7 P₃ for a root mean square of 1.
    pub(crate) fn lack_of_fit(&self, numbers: &[usize]) -> [Option<LackOfFit>; 2] {
        [0, 1].map(|side| {
            let own: Vec<&Shape> = numbers.iter().filter_map(|i| self.shapes.get(*i)?.get(side)).collect();
            let x = 1.0 + 2.0 * self.gap as f64 / self.length.max(1) as f64;
            let residual = common(&own, places(self.length))?;
            Some(LackOfFit { residual, bias: residual * 7f64.sqrt() * 0.5 * x * (5.0 * x * x - 3.0) })
        })
    }
}

/// Root of the mean square of what residuals at so many places have in common, where it is more than chance.
fn common(shapes: &[&Shape], places: usize) -> Option<f64> {
    if shapes.len() < FEWEST {
        return None;
    }
    let n = shapes.len() as f64;
    let at = |shape: &Shape, k: usize| f64::from(shape.0[k]);
    let means: Vec<f64> = (0..places).map(|k| shapes.iter().map(|s| at(s, k)).sum::<f64>() / n).collect();
    let mut products = vec![0.0; places * places];
    for shape in shapes {
        let off: Vec<f64> = means.iter().enumerate().map(|(k, m)| at(shape, k) - m).collect();
        for (row, a) in products.chunks_mut(places).zip(&off) {
            row.iter_mut().zip(&off).for_each(|(p, b)| *p += a * b / (n - 1.0));
        }
    }
    let trace: f64 = products.iter().step_by(places + 1).sum();
    let squares: f64 = products.iter().map(|p| p * p).sum();
    let squares = (n - 1.0).powi(2) / ((n - 2.0) * (n + 1.0)) * (squares - trace * trace / (n - 1.0));
    let white = trace * trace / places as f64;
    let size: f64 = means.iter().map(|m| m * m).sum();
    let freedom = trace * trace / squares.max(white);
    let beyond = || normal(n * size / trace, freedom, freedom * (n - 1.0)) > SIGNIFICANT;
    let significant = if trace > 0.0 { beyond() } else { size > 0.0 };
    significant.then(|| ((size - trace / n).max(0.0) / places as f64).sqrt())
}

/// The number as rare in a normal distribution as `f` in an F distribution.
fn normal(f: f64, above: f64, below: f64) -> f64 {
    let (a, b, root) = (2.0 / (9.0 * above), 2.0 / (9.0 * below), f.cbrt());
    ((1.0 - b) * root - (1.0 - a)) / (b * root * root + a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::faults::State;
    use super::super::parabola::Parabola;
    use super::*;
    use crate::synthetic::Normal;

    /// Part of 1000 sets of `n` impacts whose noise depends on itself by `rho`, in which a lack of fit is significant, in %; with
    /// `ring` in each.
    fn significant(n: usize, rho: f64, ring: f64) -> f64 {
        let mut noise = Normal(17);
        let significant = (0..1000).filter(|_| {
            let one = |_| {
                let mut x = noise.next();
                let values: Vec<f64> = (0..26)
                    .map(|k| {
                        x = rho * x + (1.0 - rho * rho).sqrt() * noise.next();
                        x + ring * (f64::from(k) * 0.7).sin()
                    })
                    .collect();
                [Parabola::through(&values, &[State::Good; 26], -6.0, 0..=25).unwrap().0.shape; 2]
            };
            let residuals = Residuals { shapes: (0..n).map(one).collect(), length: 26, gap: 6 };
            residuals.lack_of_fit(&(0..n).collect::<Vec<usize>>())[1].is_some()
        });
        let part = 0.1 * significant.count() as f64;
        println!("{n} impacts, rho {rho}, ring {ring}: {part:.1} % significant");
        part
    }

    #[test]
    fn noise_is_no_lack_of_fit_and_ringing_is() {
        no_lack_of_fit(&[4, 10]);
    }

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn noise_of_any_number_of_impacts_is_no_lack_of_fit() {
        no_lack_of_fit(&[4, 6, 10, 40, 200]);
    }

    fn no_lack_of_fit(impacts: &[usize]) {
        for &n in impacts {
            for rho in [0.0, 0.5, 0.9] {
                // 0.03 % by the threshold; few impacts tell little of the noise's dependence. An uncertainty may be missing in 2 %.
                assert!(significant(n, rho, 0.0) < 2.0, "{n} {rho}");
            }
        }
        // 40 rings of the size of the noise: a quotient of 20, and 1 ± 0.3 by chance.
        assert!(significant(40, 0.0, 1.0) == 100.0);
    }

    #[test]
    fn the_residual_is_continued_to_the_contact() {
        // A cubic of Legendre on 3200 samples, 100 at a place: the residual is its own root mean square, the contact where it ends.
        let cubic = |k: usize| {
            let x = (k as f64 + 0.5) / 1600.0 - 1.0;
            0.5 * x * (5.0 * x * x - 3.0)
        };
        let shape = Shape::new((0..3200).map(|k| (k, cubic(k))), 3200);
        let residuals = Residuals { shapes: vec![[shape; 2]; 4], length: 3200, gap: 0 };
        let [before, after] = residuals.lack_of_fit(&[0, 1, 2, 3]);
        let found = before.unwrap();
        // The middles of 32 stretches of width h = 1/16 miss h²/24 · 12 of the mean square 1/7: 0.7 % of its root.
        assert!(
            (found.residual * 7f64.sqrt() - 1.0).abs() < 8e-3 && (found.bias - 1.0).abs() < 8e-3,
            "{found:?}"
        );
        assert_eq!(before, after);
        assert_eq!(residuals.lack_of_fit(&[0, 1, 2]), [None; 2]);
    }
}
