//! Whether the residuals of a fit are white noise, and the uncertainties where they are not.

use crate::chance::{chi_squared_above, normal_at, student_at};
use num_complex::Complex64;
use std::cell::OnceCell;
use vibro_math::Fit;
use vibro_record::Finding;
use vibro_signal::fft::Transform;

/// Serial correlation of the residuals of a model, and its effect on uncertainties.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Whiteness {
    /// Probability that white noise shows as much serial correlation (Ljung & Box 1978); `None` for fewer
    /// than 12 residuals.
    pub p_value: Option<f64>,
    /// Factor by which standard uncertainties that assume white noise are to be multiplied; 1 where it is
    /// not rejected.
    pub inflation: f64,
}

/// Below this probability residuals count as correlated, as one white record in a hundred does.
const REJECTED: f64 = 0.01;

impl Whiteness {
    /// Tests sequences of residuals together, such as real and imaginary parts over frequency.
    ///
    /// Q = N(N + 2) Σ ρₖ²/(N − k) over ten lags (four below 40 residuals) is χ² distributed. A parameter on
    /// which the model depends smoothly sees the noise density at low frequency, which is 1 + 2Σρₖ times
    /// that of white noise of the same variance; the sum ends at the first lag that is not positive
    /// (Geyer 1992, initial positive sequence).
    pub fn of(sequences: &[&[f64]]) -> Whiteness {
        Whiteness::tested(sequences, &[])
    }

    /// As [`Whiteness::of`], for the residuals of a fit in sequences of `length`.
    ///
    /// The parameters follow a part of the noise. With H = J(JᵀJ)⁻¹Jᵀ, white noise of variance σ² leaves
    /// residuals with E Σ rᵢrᵢ₊ₖ = −σ² Σ hᵢ,ᵢ₊ₖ, a negative correlation at the lags of a smooth model. The
    /// test is of the excess over it: two modes on 80 lines would be rejected in one of seven records.
    pub fn of_fit(fit: &Fit, length: usize) -> Whiteness {
        let sequences: Vec<&[f64]> = fit.residuals.chunks(length).collect();
        let Some(root) = fit.cofactor.clone().cholesky() else { return Whiteness::of(&sequences) };
        // σ²H = WWᵀ.
        let w = &fit.jacobian * (root.l() * fit.variance().sqrt());
        let taken = w.as_slice().chunks(w.nrows()).flat_map(|column| column.chunks(length));
        Whiteness::tested(&sequences, &taken.collect::<Vec<_>>())
    }

    /// Tests sequences of residuals. The noise `taken` by parameters lowers their sums of products by its
    /// own.
    fn tested(sequences: &[&[f64]], taken: &[&[f64]]) -> Whiteness {
        let n: usize = sequences.iter().map(|s| s.len()).sum();
        let squares: f64 = sequences.iter().flat_map(|s| s.iter()).map(|r| r * r).sum();
        if n < 12 || squares <= 0.0 || !squares.is_finite() {
            return Whiteness { p_value: None, inflation: 1.0 };
        }
        let longest = sequences.iter().map(|s| s.len()).max().unwrap_or(0) / 4;
        let all = Products { sequences: [sequences, taken].concat(), longest, far: OnceCell::new() };
        let correlation = |lag: usize| all.at(lag) / squares;
        let lags = if n < 40 { 4 } else { 10 };
        let total = n as f64;
        let sum: f64 = (1..=lags).map(|k| correlation(k).powi(2) / (total - k as f64)).sum();
        let p = chi_squared_above(total * (total + 2.0) * sum, lags);
        let inflation = if p < REJECTED {
            let positive = (1..=longest).map(correlation).take_while(|r| *r > 0.0);
            (1.0 + 2.0 * positive.sum::<f64>()).sqrt()
        } else {
            1.0
        };
        Whiteness { p_value: Some(p), inflation }
    }

    /// Whether white noise is rejected.
    pub fn rejected(&self) -> bool {
        self.rejected_among(1)
    }

    /// Whether white noise is rejected for one of `many` fits tested and neighbouring residuals are alike, as
    /// where a model lacks a part.
    pub fn alike_among(&self, many: usize) -> bool {
        self.rejected_among(many) && self.inflation > 1.0
    }

    /// Whether white noise is rejected for one of `many` records tested. Each may be rejected by chance, so
    /// the level is divided by their number (Bonferroni).
    pub fn rejected_among(&self, many: usize) -> bool {
        self.p_value.is_some_and(|p| p * (many as f64) < REJECTED)
    }

    /// Caution that the residuals are not white, with the factor on uncertainties unless that is 1.00.
    pub fn coloured(&self, code: &'static str) -> Finding {
        let found = Finding::caution(code);
        if self.inflation < 1.005 { found } else { found.number("factor", self.inflation) }
    }
}

/// Sums of products of values some lag apart within each of the sequences, up to the lag `longest`.
struct Products<'a> {
    sequences: Vec<&'a [f64]>,
    longest: usize,
    /// The sums at all lags, once one beyond [`NEAR`] is needed.
    far: OnceCell<Vec<f64>>,
}

/// Lags up to which products are summed one by one. A pattern of many lines has thousands of lags, whose sums
/// the power spectrum gives at once.
const NEAR: usize = 32;

impl Products<'_> {
    fn at(&self, lag: usize) -> f64 {
        if lag > NEAR {
            return self.far.get_or_init(|| self.by_spectrum())[lag];
        }
        let each = self.sequences.iter().flat_map(|s| s.iter().zip(s.iter().skip(lag)));
        each.map(|(a, b)| a * b).sum()
    }

    /// The sums at all lags (Wiener–Khinchin), with zeros behind the sequences against wrapping around.
    fn by_spectrum(&self) -> Vec<f64> {
        let most = self.sequences.iter().map(|s| s.len()).max().unwrap_or(0);
        let transform = Transform::new((most + self.longest + 1).next_power_of_two());
        let mut power = vec![Complex64::ZERO; transform.lines()];
        for sequence in &self.sequences {
            let lines = transform.forward(sequence);
            power.iter_mut().zip(lines).for_each(|(sum, line)| *sum += line.norm_sqr());
        }
        transform.inverse(&power)
    }
}

/// Factor on a standard uncertainty from an estimated variance with `free` degrees of freedom: the standard
/// deviation of Student's distribution, √(ν/(ν − 2)) (JCGM 101:2008, 6.4.9.2). `None` up to two degrees of
/// freedom, where it has none.
pub fn student(free: usize) -> Option<f64> {
    (free > 2).then(|| (free as f64 / (free as f64 - 2.0)).sqrt())
}

/// Factor on a standard uncertainty with `free` degrees of freedom: the standard deviation of Student's
/// distribution where it has one, otherwise its quantile of 97.5 % over that of the normal one.
pub fn widened(free: usize) -> f64 {
    student(free).unwrap_or_else(|| student_at(0.975, free.max(1)) / normal_at(0.975))
}

/// Corrected Akaike criterion (`AICc`) of a fit to `n` values, with the variance of the noise as one
/// parameter more than `parameters` (Hurvich & Tsai 1989); NaN where there are too few values.
pub fn aicc(sum_of_squares: f64, n: usize, parameters: f64) -> f64 {
    let (n, k) = (n as f64, parameters + 1.0);
    if n - k - 1.0 <= 0.0 {
        return f64::NAN;
    }
    n * (sum_of_squares / n).ln() + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0)
}

/// Difference of two `AICc` of fits to the same `n` values, where the variance of the residuals of the first
/// is `ratio` times that of the second and noise has `dispersion` times the density of white noise of the
/// same variance: the dispersion divides the likelihood and leaves the price of parameters (`QAICc`, Burnham
/// & Anderson 2002, 2.5).
pub fn quasi(difference: f64, n: usize, ratio: f64, dispersion: f64) -> f64 {
    difference - n as f64 * ratio.ln() * (1.0 - 1.0 / dispersion)
}

/// A difference of Akaike's criterion that leaves no support for the worse model (Burnham & Anderson, Model
/// Selection and Multimodel Inference, 2002, section 2.6).
pub const NO_SUPPORT: f64 = 10.0;

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn student_has_a_standard_deviation_from_three_degrees_of_freedom_on() {
        assert_eq!([0, 1, 2].map(student), [None; 3]);
        // Variance 3 at ν = 3 and 2 at ν = 4.
        assert_eq!([3, 4].map(student), [Some(3f64.sqrt()), Some(2f64.sqrt())]);
    }

    /// A dispersion of 4 leaves a fourth of the likelihood. Parameters keep their price, 2 each but for the
    /// correction of few values, 2(k + 1)(k + 2)/(n − k − 2), below 0.1 for 1000 values.
    #[test]
    fn colour_divides_the_likelihood_and_not_the_price_of_parameters() {
        let (few, more) = (aicc(1.1, 1000, 3.0), aicc(1.0, 1000, 5.0));
        let gained = 1000.0 * 1.1_f64.ln();
        assert!((quasi(few - more, 1000, 1.1, 1.0) - (gained - 4.0)).abs() < 0.1);
        assert!((quasi(few - more, 1000, 1.1, 4.0) - (gained / 4.0 - 4.0)).abs() < 0.1);
    }

    #[test]
    fn white_noise_is_rejected_as_often_as_stated() {
        let mut noise = Noise::new(11);
        let trials = 2000;
        let rejected = (0..trials)
            .filter(|_| {
                let r: Vec<f64> = (0..100).map(|_| noise.normal()).collect();
                Whiteness::of(&[&r]).rejected()
            })
            .count();
        // 1 % of 2000 with a standard deviation of 4.4, and Q has a slightly heavier tail than χ² at 100
        // values.
        assert!((5..=55).contains(&rejected), "{rejected}");
    }

    #[test]
    fn sums_of_products_by_the_spectrum_are_those_one_by_one() {
        let mut noise = Noise::new(3);
        let [one, other] = [300, 170].map(|n| (0..n).map(|_| noise.normal()).collect::<Vec<f64>>());
        let all = Products { sequences: vec![&one, &other], longest: 75, far: OnceCell::new() };
        let direct =
            |s: &[f64], lag: usize| s.iter().zip(s.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>();
        for lag in [0, 1, NEAR, NEAR + 1, 75] {
            let expected = direct(&one, lag) + direct(&other, lag);
            // Rounding of sums of 470 squares of about 1.
            assert!((all.at(lag) - expected).abs() < 1e-10, "{lag}");
            assert!((all.by_spectrum()[lag] - expected).abs() < 1e-10, "{lag}");
        }
    }

    /// A polynomial of degree 11 takes twelve of 80 values. Without their share a tenth is rejected.
    #[test]
    fn white_noise_beside_a_fit_of_many_parameters_is_rejected_as_often_as_stated() {
        let mut noise = Noise::new(12);
        let x: Vec<f64> = (0..80).map(|i| f64::from(i) / 40.0 - 1.0).collect();
        // Chebyshev polynomials, which are well conditioned.
        let model = |p: &[f64], x: f64| {
            let terms = p.iter().enumerate().map(|(k, p)| p * (k as f64 * x.acos()).cos());
            terms.sum::<f64>()
        };
        let (mut plain, mut corrected) = (0, 0);
        for _ in 0..300 {
            let y: Vec<f64> = x.iter().map(|_| noise.normal()).collect();
            let left = |p: &[f64], out: &mut [f64]| {
                out.iter_mut().zip(x.iter().zip(&y)).for_each(|(out, (x, y))| *out = y - model(p, *x));
            };
            let fit = vibro_math::least_squares(left, 80, &[0.0; 12], &[1.0; 12]).unwrap();
            plain += i32::from(Whiteness::of(&[&fit.residuals]).rejected());
            corrected += i32::from(Whiteness::of_fit(&fit, 80).rejected());
        }
        // 1 % of 300 with a standard deviation of 1.7; a binomial count exceeds 12 in one of 10⁴ cases.
        assert!(corrected <= 12 && plain > 12, "{corrected} {plain}");
    }

    /// y(i) = φ y(i−1) + e has a density at zero frequency of (1 + φ)/(1 − φ) that of white noise of its
    /// variance.
    #[test]
    fn the_inflation_of_a_first_order_process_is_found() {
        let mut noise = Noise::new(5);
        let phi = 0.7;
        let mut y = 0.0;
        let r: Vec<f64> = (0..20_000)
            .map(|_| {
                y = phi * y + noise.normal();
                y
            })
            .collect();
        let w = Whiteness::of(&[&r]);
        let expected = f64::sqrt((1.0 + phi) / (1.0 - phi));
        // The sum runs over about ten lags of correlations, each good to 1/√20000.
        assert!(w.rejected() && (w.inflation / expected - 1.0).abs() < 0.1, "{w:?} {expected}");
    }
}
