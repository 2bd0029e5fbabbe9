//! ln R from ratios of successive flights where R scatters from bounce to bounce and the onsets carry noise.
//!
//! Ratios `y = ln(Δt_b/Δt_a)` have the covariance `s²·(b − a) + σ²AAᵀ`, with A the derivative of y by the onsets, s the scatter of ln R from
//! bounce to bounce and σ that of an onset. ln R follows by generalised least squares (Aitken 1935), averaged over s², or s²/σ² where σ is not
//! stated, which the restricted likelihood (Patterson and Thompson 1971) weighs with its reference prior, the root of its information (Jeffreys
//! 1946; Berger and Bernardo, *Bayesian Statistics 4*, 1992, 35): it knows that s shows in the first flights and σ in the last. Where σ is not
//! stated, scatter of R alone has a probability of one half, and the scale that the residuals give makes Student's distribution.
//!
//! Where R does not scatter at all the uncertainty is some four times what the onsets alone would make of it: they rule the last flights, and a
//! scatter that few flights hardly show rules the first.

use crate::residuals::student;
use nalgebra::{DMatrix, DVector};

/// One flight: place in the train, logarithm of its time.
#[derive(Clone, Copy)]
pub struct Flight {
    pub place: usize,
    pub log: f64,
}

/// Prior probability that R alone scatters, where nothing is stated of the onsets.
const SCATTER_ALONE: f64 = 0.5;
/// Variances of R are averaged over from where they show in ln R to where they outdo all else, and this factor beyond.
const BEYOND: f64 = 1e3;
/// Steps of the logarithm (to base 10) of a variance.
const STEP: f64 = 0.15;

/// ln R of one train and its standard uncertainty, which three degrees of freedom show; `None` without a ratio.
pub fn fit(flights: &[Flight], onset_std: Option<f64>) -> Option<(f64, Option<f64>)> {
    let ratios = Ratios::new(flights);
    let n = ratios.y.len() as f64;
    let free = ratios.y.len().checked_sub(1)?;
    let stated = onset_std.filter(|s| *s > 0.0).map(|s| s * s);
    let scaled = stated.is_none();
    let sigma2 = stated.unwrap_or_else(|| n / ratios.timing.trace());
    let scatter_alone = ratios.node(1.0, 0.0, true);
    let onsets_alone = ratios.node(0.0, sigma2, scaled)?;
    if free < 3 {
        return Some((if scaled { scatter_alone? } else { onsets_alone }.log_r, None));
    }
    let least = n / onsets_alone.information / BEYOND;
    let noisiest = sigma2 * ratios.timing.diagonal().max();
    let shown = if scaled { 0.0 } else { ratios.scatter() / free as f64 };
    let steps = ((BEYOND * noisiest.max(shown) / least).log10() / STEP).ceil().clamp(0.0, 1e3) as usize;
    let grid = (0..=steps).map(|i| {
        let s2 = least * 10f64.powf(STEP * i as f64);
        let node = ratios.node(s2, sigma2, scaled)?;
        // Even steps of the logarithm: the density of s² times s².
        Some((s2 * node.prior, node))
    });
    let mut nodes: Vec<(f64, Node)> = grid.collect::<Option<_>>()?;
    if scaled {
        let total: f64 = nodes.iter().map(|(prior, _)| prior).sum();
        nodes.push((total * SCATTER_ALONE / (1.0 - SCATTER_ALONE), scatter_alone?));
    }
    let best = nodes.iter().map(|(_, node)| node.likelihood).fold(f64::NEG_INFINITY, f64::max);
    let parts: Vec<f64> = nodes.iter().map(|(prior, node)| prior * (node.likelihood - best).exp()).collect();
    let total: f64 = parts.iter().sum();
    let over = |f: &dyn Fn(&Node) -> f64| {
        nodes.iter().zip(&parts).map(|((_, node), part)| part * f(node)).sum::<f64>() / total
    };
    let log_r = over(&|node| node.log_r);
    let variance = over(&|node| node.variance + (node.log_r - log_r).powi(2));
    Some((log_r, Some(variance.sqrt()).filter(|s| s.is_finite())))
}

/// A fit for one s² and σ².
struct Node {
    log_r: f64,
    /// Its variance, Student's where the scale is that of the residuals.
    variance: f64,
    /// `mᵀC⁻¹m`.
    information: f64,
    /// Restricted log-likelihood but for a constant.
    likelihood: f64,
    /// Root of the information on s².
    prior: f64,
}

/// Ratios of successive flights.
struct Ratios {
    /// Their logarithms.
    y: DVector<f64>,
    /// Bounces between them.
    m: DVector<f64>,
    /// `AAᵀ`, in 1/s².
    timing: DMatrix<f64>,
}

impl Ratios {
    fn new(flights: &[Flight]) -> Ratios {
        let of = |f: &dyn Fn(&Flight, &Flight) -> f64| {
            DVector::from_vec(flights.windows(2).map(|w| f(&w[0], &w[1])).collect())
        };
        let y = of(&|a, b| b.log - a.log);
        let mut by_onset = DMatrix::<f64>::zeros(y.len(), flights.last().map_or(0, |f| f.place + 2));
        for (i, pair) in flights.windows(2).enumerate() {
            // Each flight is the later onset less the earlier.
            for (flight, sign) in pair.iter().zip([-1.0, 1.0]) {
                let slope = sign * (-flight.log).exp();
                by_onset[(i, flight.place)] -= slope;
                by_onset[(i, flight.place + 1)] += slope;
            }
        }
        let timing = &by_onset * by_onset.transpose();
        Ratios { y, m: of(&|a, b| (b.place - a.place) as f64), timing }
    }

    /// Generalised least squares; with `scaled`, all variances are multiplied by what the residuals say.
    fn node(&self, s2: f64, sigma2: f64, scaled: bool) -> Option<Node> {
        let by = DMatrix::from_diagonal(&self.m);
        let cholesky = (&by * s2 + &self.timing * sigma2).cholesky()?;
        let (wm, wy) = (cholesky.solve(&self.m), cholesky.solve(&self.y));
        let (mm, my, yy) = (self.m.dot(&wm), self.m.dot(&wy), self.y.dot(&wy));
        let log_det = 2.0 * cholesky.l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let log_r = my / mm;
        // Roundings of the ratios are no scatter.
        let rest = (yy - log_r * my).max(1e-15 * yy.abs());
        let free = self.y.len() as f64 - 1.0;
        // Twice Fisher's information of the restricted likelihood on s², tr(PDPD) with P = C⁻¹ − C⁻¹mmᵀC⁻¹/mᵀC⁻¹m and D the derivative of C by
        // s² (D. Harville, J. Am. Stat. Assoc. 72 (1977) 320); with a scale of C that is not known, what that leaves of it.
        let pd = (cholesky.inverse() - &wm * wm.transpose() / mm) * by;
        let squares = pd.component_mul(&pd.transpose()).sum();
        let (scale, factor, misfit, taken) = if scaled {
            let scale = rest / free.max(1.0);
            let factor = student(self.y.len() - 1).unwrap_or(f64::NAN);
            (scale, factor, free * scale.max(f64::MIN_POSITIVE).ln(), pd.trace().powi(2) / free)
        } else {
            (1.0, 1.0, rest, 0.0)
        };
        Some(Node {
            log_r,
            variance: factor * factor * scale / mm,
            information: mm,
            likelihood: -0.5 * (log_det + mm.ln() + misfit),
            prior: (squares - taken).max(0.0).sqrt(),
        })
    }

    /// Sum of squares of the ratios about their mean, one bounce each.
    fn scatter(&self) -> f64 {
        let mean = self.y.sum() / self.m.sum();
        self.y.iter().zip(self.m.iter()).map(|(y, m)| (y - mean * m).powi(2) / m).sum()
    }
}
