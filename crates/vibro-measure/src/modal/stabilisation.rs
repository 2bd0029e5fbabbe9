//! Poles of models of rising order, for a stabilisation diagram: a pole of the structure stays where it is
//! as the order rises, a pole of the noise moves.

use super::Measured;
use nalgebra::DMatrix;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::sort_by_number;

/// Highest order. Each mode takes one pole; modes beyond the band and the noise take the others.
const MOST: usize = 40;
/// Fewest lines for each pole.
const LINES: usize = 6;
/// Angle in the z-plane that the band takes up, so that its ends do not meet.
const ANGLE: f64 = 0.9 * TAU;
/// Largest damping ratio of a pole that is listed.
const DAMPED: f64 = 0.3;

/// Largest change of frequency and of damping ratio from one order to the next, over their values, of a pole
/// that stays (Peeters & De Roeck 2001, 4.2).
const FREQUENCY: f64 = 0.01;
const DAMPING: f64 = 0.05;

/// A pole of a model of some order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrderedPole {
    /// Number of poles of the model.
    pub order: usize,
    /// Natural frequency in Hz.
    pub frequency: f64,
    /// Damping ratio.
    pub zeta: f64,
    /// Whether the order below has a pole of this frequency, to 1 %.
    pub frequency_stays: bool,
    /// Whether that pole has this damping ratio, too, to 5 %.
    pub damping_stays: bool,
}

/// The poles of models of order 1 to 40 within a band in Hz, or within all lines: stable ones with a damping
/// ratio up to 0.3, in the order of frequency within each. Empty without phases or for fewer than twelve
/// lines.
///
/// Each model is a rational function of z = e^(iφ), with φ proportional to the frequency over the band, in
/// least squares of its linear form (least-squares complex frequency: Guillaume, Verboven & Vanlanduit 1998;
/// Peeters et al. 2004). The coefficients are complex: the band has no negative frequencies,
/// so that a mode takes one pole. The coefficient of z⁰ is 1: poles of the noise then grow and are not
/// listed (Cauberghe et al. 2005).
pub fn stabilisation(measured: &Measured, band: Option<(f64, f64)>) -> Vec<OrderedPole> {
    let lines = band.map_or(0..measured.frequency.len(), |band| measured.within(band));
    if measured.magnitude_only || lines.len() < 2 * LINES {
        return Vec::new();
    }
    let frequency = &measured.frequency[lines.clone()];
    let (first, last) = (frequency[0], frequency[frequency.len() - 1]);
    let rate = ANGLE / (last - first);
    let most = MOST.min(lines.len() / LINES);
    let z: Vec<Complex64> = frequency.iter().map(|f| Complex64::cis(rate * (f - first))).collect();
    let highest = measured.values[lines.clone()].iter().fold(0.0, |most: f64, v| most.max(v.norm()));
    let values: Vec<Complex64> = measured.values[lines].iter().map(|v| v / highest).collect();
    let Some(normal) = normal_equations(&z, &values, most) else { return Vec::new() };
    let mut poles: Vec<OrderedPole> = Vec::new();
    let mut below = 0;
    for order in 1..=most {
        let same_order = poles.len();
        for root in roots(&normal, order) {
            // s = (ln z)/T + i·2π·first, with z = e^(sT) inside the unit circle for a pole that decays.
            let angle = root.arg().rem_euclid(TAU);
            let s = Complex64::new(root.norm().ln(), angle) * (TAU / rate) + Complex64::new(0.0, TAU * first);
            let (own, zeta) = (s.norm() / TAU, -s.re / s.norm());
            if !(0.0..DAMPED).contains(&zeta) || !(first..=last).contains(&own) {
                continue;
            }
            let near = |other: &&OrderedPole| (other.frequency / own - 1.0).abs() <= FREQUENCY;
            let same = |other: &OrderedPole| (other.zeta / zeta - 1.0).abs() <= DAMPING;
            let before = || poles[below..same_order].iter().filter(near);
            let (frequency_stays, damping_stays) = (before().next().is_some(), before().any(same));
            poles.push(OrderedPole { order, frequency: own, zeta, frequency_stays, damping_stays });
        }
        sort_by_number(&mut poles[same_order..], |a| a.frequency);
        below = same_order;
    }
    poles
}

/// Normal equations of the denominator's coefficients of z⁰ to z^`most`: those of the numerator, of the same
/// order, are eliminated. `None` where the lines do not determine them.
fn normal_equations(z: &[Complex64], values: &[Complex64], most: usize) -> Option<DMatrix<Complex64>> {
    // Sums of w·z^d over the lines, from d = −most to most, for the weights w of numerator, both and
    // denominator: the matrices of all products of powers.
    let mut sums = vec![[Complex64::ZERO; 3]; 2 * most + 1];
    for (z, v) in z.iter().zip(values) {
        let weights = [Complex64::ONE, -*v, v.norm_sqr().into()];
        let mut power = z.powi(-(most as i32));
        for sum in &mut sums {
            sum.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * power);
            power *= z;
        }
    }
    let matrix =
        |of: usize| DMatrix::from_fn(most + 1, most + 1, |row, column| sums[most + column - row][of]);
    let [numerator, both, denominator] = [0, 1, 2].map(matrix);
    let eliminated = numerator.cholesky()?.solve(&both);
    Some(denominator - both.adjoint() * eliminated)
}

/// Roots of the denominator of an order, whose coefficient of z⁰ is 1.
fn roots(normal: &DMatrix<Complex64>, order: usize) -> Vec<Complex64> {
    let part = normal.view((1, 1), (order, order)).into_owned();
    let right = -normal.view((1, 0), (order, 1)).into_owned();
    let solved = part.lu().solve(&right).filter(|solved| solved.iter().all(|v| v.is_finite()));
    let Some(solved) = solved else { return Vec::new() };
    let highest = solved[(order - 1, 0)];
    let companion = DMatrix::from_fn(order, order, |row, column| {
        let below = if row == column + 1 { Complex64::ONE } else { Complex64::ZERO };
        let coefficient = if row == 0 { Complex64::ONE } else { solved[(row - 1, 0)] };
        if column + 1 == order { below - coefficient / highest } else { below }
    });
    let Some(schur) = nalgebra::Schur::try_new(companion, f64::EPSILON, 1000) else { return Vec::new() };
    schur.eigenvalues().map_or_else(Vec::new, |all| all.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::super::Pole;
    use super::*;
    use vibro_math::Noise;
    use vibro_record::units::Quantity;

    /// Poles that have stayed in frequency and damping ratio over at least `orders` orders in turn, up to the
    /// highest one: frequency in Hz and damping ratio of each.
    fn lasting(poles: &[OrderedPole], orders: usize) -> Vec<(f64, f64)> {
        let highest = poles.iter().map(|p| p.order).max().unwrap_or(0);
        let stays = |p: &OrderedPole, order: usize| {
            poles.iter().any(|q| {
                q.order == order && q.damping_stays && (q.frequency / p.frequency - 1.0).abs() < FREQUENCY
            })
        };
        let last = poles.iter().filter(|p| p.order == highest && p.damping_stays);
        last.filter(|p| (highest + 1 - orders..=highest).all(|order| stays(p, order)))
            .map(|p| (p.frequency, p.zeta))
            .collect()
    }

    /// Receptance of modes (frequency in Hz, damping ratio, constant) from 20 to 220 Hz in steps of 0.25 Hz,
    /// with noise of this standard deviation over the highest line.
    fn measured(modes: &[(f64, f64, f64)], noise: f64) -> Measured {
        let poles: Vec<Pole> = modes
            .iter()
            .map(|(frequency, zeta, constant)| Pole {
                frequency: *frequency,
                zeta: *zeta,
                constant: (*constant).into(),
            })
            .collect();
        let frequency: Vec<f64> = (80..=880).map(|k| 0.25 * f64::from(k)).collect();
        let at = |f: &f64| poles.iter().map(|pole| pole.at(*f, 0)).sum::<Complex64>();
        let clean: Vec<Complex64> = frequency.iter().map(at).collect();
        let highest = clean.iter().fold(0.0, |most: f64, v| most.max(v.norm()));
        let mut random = Noise::new(7);
        let mut part = || noise * highest * random.normal() / 2f64.sqrt();
        let values = clean.iter().map(|v| v + Complex64::new(part(), part())).collect();
        Measured::new(frequency, values, Quantity::Receptance)
    }

    /// Three modes, the third beyond the second by one bandwidth, and one beyond the lines.
    #[test]
    fn poles_of_the_structure_stay_and_those_of_noise_do_not() {
        let modes = [(60.0, 0.01, 1.0), (140.0, 0.02, 3.0), (146.0, 0.02, -2.0), (300.0, 0.02, 8.0)];
        let poles = stabilisation(&measured(&modes, 1e-3), None);
        let lasting = lasting(&poles, 5);
        assert_eq!(lasting.len(), 3, "{lasting:?}");
        for ((f, zeta), mode) in lasting.iter().zip(&modes) {
            // Noise of 0.1 % of the highest line moves a frequency by less than 1 % of a bandwidth.
            assert!((f - mode.0).abs() < 0.02 * mode.0 * mode.1, "{f} {mode:?}");
            assert!((zeta / mode.1 - 1.0).abs() < 0.05, "{zeta} {mode:?}");
        }
        assert!(poles.iter().all(|p| (20.0..=220.0).contains(&p.frequency)));
    }

    #[test]
    fn no_poles_of_lines_that_determine_none() {
        let function = measured(&[(60.0, 0.01, 1.0)], 1e-3);
        let with = |change: &dyn Fn(&Complex64) -> Complex64| {
            let values = function.values.iter().map(change).collect();
            stabilisation(&Measured { values, ..function.clone() }, None)
        };
        assert!(with(&|_| Complex64::ZERO).is_empty());
        assert!(with(&|v| v * f64::INFINITY).is_empty());
        // The size of the values does not matter.
        assert_eq!(with(&|v| v * 2f64.powi(600)), stabilisation(&function, None));
        assert!(stabilisation(&function, Some((50.0, 52.0))).is_empty());
        assert!(stabilisation(&function, Some((500.0, 600.0))).is_empty());
    }
}
