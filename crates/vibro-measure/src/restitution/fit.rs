//! Restitution from a train of bounces: flight times shrink by R from bounce to bounce, `ln Δt_n = ln Δt₁ +
//! (n − 1) ln R`.
//!
//! ln R comes from ratios of successive flight times, since R scatters from bounce to bounce and onsets
//! carry noise.
//!
//! Ratios `y = ln(Δt_b/Δt_a)` have the covariance `s²·(b − a) + σ²AAᵀ`, with A the derivative of y by the
//! onsets, s the scatter of ln R from bounce to bounce and σ the standard uncertainty of an onset. For given
//! s and σ, ln R follows by generalised least squares (Aitken 1935). The result is averaged over s², or over
//! s²/σ² where σ is not stated. The weight is the restricted likelihood (Patterson and Thompson 1971) times
//! its reference prior, the root of its information (Jeffreys 1946; Berger and Bernardo, *Bayesian
//! Statistics 4*, 1992, 35): s dominates the first flights and σ the last. Where σ is not stated, scatter of
//! R alone has a prior probability of one half, and the residuals give the scale, hence Student's
//! distribution.
//!
//! Where R does not scatter at all, the uncertainty is about four times that by the onsets alone. Onsets
//! dominate the last flights, but a few flights cannot exclude a scatter of R, which dominates the first.

use super::together;
use crate::mean::{average, mixture};
use crate::residuals::{student, widened};
use nalgebra::{DMatrix, DVector};

/// One flight: its index in the train, and the logarithm of its time in s.
#[derive(Clone, Copy)]
pub(super) struct Flight {
    pub place: usize,
    pub log: f64,
}

/// Noise of one flight time: the scatter of R from bounce to bounce, and the noise of its two onsets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FlightNoise {
    /// Variance of ln R from bounce to bounce.
    scatter: f64,
    /// Variance of the time of an impact in s².
    onset: f64,
}

impl FlightNoise {
    /// Standard uncertainty in s of a first flight time of `flight` seconds, against the R of all bounces.
    pub(super) fn of(&self, flight: f64) -> f64 {
        (self.scatter * flight * flight + 2.0 * self.onset).sqrt()
    }

    /// Noise with these variances of ln R from bounce to bounce and of the time of an impact, in s².
    pub(super) fn new(scatter: f64, onset: f64) -> FlightNoise {
        FlightNoise { scatter, onset }
    }

    pub(super) fn mean(all: &[FlightNoise]) -> Option<FlightNoise> {
        let mean = |of: fn(&FlightNoise) -> f64| average(&all.iter().map(of).collect::<Vec<f64>>());
        (!all.is_empty()).then(|| FlightNoise { scatter: mean(|n| n.scatter), onset: mean(|n| n.onset) })
    }
}

/// Prior probability that R alone scatters, where no uncertainty of the onsets is stated: undecided.
const SCATTER_ALONE: f64 = 0.5;
/// The average over s² runs from where s² shows in ln R to where it exceeds all other noise, and this factor
/// beyond at either end.
const WIDE: f64 = 1e3;
/// Step of that average, in decades of s².
const STEP: f64 = 0.15;

/// Joint fit of trains with one R.
#[derive(Clone, Copy)]
pub(super) struct TrainFit {
    pub(super) log_r: f64,
    /// Standard uncertainty of ln R; `None` below three degrees of freedom.
    pub(super) std: Option<f64>,
    /// Noise of the flights; `None` without a degree of freedom.
    pub(super) noise: Option<FlightNoise>,
}

/// Flights of a train, and the standard uncertainty of its onsets in s where it is known.
pub(super) type Timed = (Vec<Flight>, Option<f64>);

/// Sum over `trains` of the squared difference of each one's ln R from `log`, over its variance for this
/// `noise` of flights: χ² with one degree of freedom less than trains, where all have one R.
pub(super) fn misfit(trains: &[Timed], log: f64, noise: FlightNoise) -> f64 {
    let node =
        |(flights, _): &Timed| Ratios::new(&[flights], &[1.0], false).node(noise.scatter, noise.onset, false);
    trains.iter().filter_map(node).map(|own| (own.log_r - log).powi(2) / own.variance).sum()
}

/// ln R of trains and its variance, for known variances of ln R from bounce to bounce and of an onset. `None`
/// without a ratio.
pub(super) fn known(trains: &[Vec<Flight>], fall: bool, [scatter, onset]: [f64; 2]) -> Option<(f64, f64)> {
    let flights: Vec<&[Flight]> = trains.iter().map(Vec::as_slice).collect();
    let node = Ratios::new(&flights, &vec![1.0; flights.len()], fall).node(scatter, onset, false)?;
    Some((node.log_r, node.variance))
}

/// Fits ln R and the noise of flights to trains; `None` without a ratio. With `fall`, all trains follow the
/// same fall, and their first flights are compared, too.
pub(super) fn fit(trains: &[Timed], fall: bool) -> Option<TrainFit> {
    let onset_std = together(trains.iter().map(|(_, std)| *std)).filter(|std| *std > 0.0);
    let part = |std: Option<f64>| onset_std.map_or(1.0, |all| std.unwrap_or(all) / all);
    let parts: Vec<f64> = trains.iter().map(|(_, std)| part(*std)).collect();
    let flights: Vec<&[Flight]> = trains.iter().map(|(flights, _)| &flights[..]).collect();
    let ratios = Ratios::new(&flights, &parts, fall);
    let n = ratios.y.len() as f64;
    let free = ratios.y.len().checked_sub(1)?;
    let stated = onset_std.map(|s| s * s);
    let scaled = stated.is_none();
    let sigma2 = stated.unwrap_or_else(|| n / ratios.timing.trace());
    let scatter_alone = ratios.node(1.0, 0.0, true);
    let onsets_alone = ratios.node(0.0, sigma2, scaled)?;
    if free < 3 {
        let log_r = if scaled { scatter_alone.as_ref()?.log_r } else { onsets_alone.log_r };
        // All residuals are attributed to the scatter of R, which gives an upper limit of the noise of first
        // flights.
        let scatter = |node: Node| widened(free).powi(2) * node.scale;
        let onset = stated.unwrap_or(0.0);
        let noise =
            scatter_alone.filter(|_| free > 0).map(|node| FlightNoise { scatter: scatter(node), onset });
        return Some(TrainFit { log_r, std: None, noise });
    }
    let least = n / onsets_alone.information / WIDE;
    let noisiest = sigma2 * ratios.timing.diagonal().max();
    let shown = if scaled { 0.0 } else { scatter_alone.as_ref().map_or(0.0, |node| node.scale) };
    let steps = ((WIDE * noisiest.max(shown) / least).log10() / STEP).ceil().clamp(0.0, 1e3) as usize;
    let grid = (0..=steps).map(|i| {
        let s2 = least * 10f64.powf(STEP * i as f64);
        let node = ratios.node(s2, sigma2, scaled)?;
        // Even steps of log s²: the prior density of s² is multiplied by s².
        Some((s2 * node.prior, node))
    });
    let mut nodes: Vec<(f64, Node)> = grid.collect::<Option<_>>()?;
    if scaled {
        let total: f64 = nodes.iter().map(|(prior, _)| prior).sum();
        nodes.push((total * SCATTER_ALONE / (1.0 - SCATTER_ALONE), scatter_alone?));
    }
    let mean = |of: &dyn Fn(&Node) -> (f64, f64)| {
        let each = nodes.iter().map(|(prior, node)| (prior.ln() + node.likelihood, of(node)));
        mixture(&each.map(|(weight, (value, variance))| (weight, value, variance)).collect::<Vec<_>>())
    };
    let (log_r, variance) = mean(&|node| (node.log_r, node.variance));
    let [scatter, onset] = [0, 1].map(|k| mean(&|node| (node.noise[k], 0.0)).0);
    let std = Some(variance.sqrt()).filter(|s| s.is_finite());
    Some(TrainFit { log_r, std, noise: std.map(|_| FlightNoise { scatter, onset }) })
}

/// A fit for one s² and σ².
struct Node {
    log_r: f64,
    /// Variance of ln R, with Student's factor where the residuals give the scale.
    variance: f64,
    /// s² and σ², times the scale and the square of Student's factor where the residuals give the scale.
    noise: [f64; 2],
    /// χ² of the residuals for s² and σ², per degree of freedom.
    scale: f64,
    /// `mᵀC⁻¹m`.
    information: f64,
    /// Restricted log-likelihood, up to a constant.
    likelihood: f64,
    /// Reference prior of s²: root of the information on it, up to a factor.
    prior: f64,
}

/// Ratios of successive flights, and of first flights after the same fall.
struct Ratios {
    /// Logarithms of the ratios.
    y: DVector<f64>,
    /// Bounces between the two flights of each ratio.
    m: DVector<f64>,
    /// `BBᵀ`, with B the bounces by which the two flights of each ratio differ.
    scatter: DMatrix<f64>,
    /// `AAᵀ`, in 1/s².
    timing: DMatrix<f64>,
}

impl Ratios {
    /// Ratios of trains whose onsets have the uncertainties `parts` times σ; with `fall` also those of first
    /// flights.
    fn new(trains: &[&[Flight]], parts: &[f64], fall: bool) -> Ratios {
        let places = 2 + trains.iter().copied().flatten().map(|f| f.place).max().unwrap_or(0);
        let within = trains
            .iter()
            .enumerate()
            .flat_map(|(t, flights)| flights.windows(2).map(move |pair| [(t, pair[0]), (t, pair[1])]));
        let firsts: Vec<(usize, Flight)> = trains
            .iter()
            .enumerate()
            .filter_map(|(t, flights)| Some((t, *flights.first().filter(|first| fall && first.place == 0)?)))
            .collect();
        let pairs: Vec<[(usize, Flight); 2]> =
            within.chain(firsts.windows(2).map(|pair| [pair[0], pair[1]])).collect();
        let mut by_onset = DMatrix::<f64>::zeros(pairs.len(), trains.len() * places);
        let mut by_bounce = by_onset.clone();
        for (i, pair) in pairs.iter().enumerate() {
            for ((train, flight), sign) in pair.iter().zip([-1.0, 1.0]) {
                // A flight time is the later onset less the earlier, and contains the R of each bounce
                // before it.
                let slope = parts[*train] * sign * (-flight.log).exp();
                let first = train * places;
                by_onset[(i, first + flight.place)] -= slope;
                by_onset[(i, first + flight.place + 1)] += slope;
                by_bounce.view_mut((i, first), (1, flight.place + 1)).add_scalar_mut(sign);
            }
        }
        Ratios {
            y: DVector::from_iterator(pairs.len(), pairs.iter().map(|[a, b]| b.1.log - a.1.log)),
            m: by_bounce.column_sum(),
            scatter: &by_bounce * by_bounce.transpose(),
            timing: &by_onset * by_onset.transpose(),
        }
    }

    /// Generalised least squares for one s² and σ²; with `scaled` the residuals give their common scale.
    fn node(&self, s2: f64, sigma2: f64, scaled: bool) -> Option<Node> {
        let cholesky = (&self.scatter * s2 + &self.timing * sigma2).cholesky()?;
        let (wm, wy) = (cholesky.solve(&self.m), cholesky.solve(&self.y));
        let (mm, my, yy) = (self.m.dot(&wm), self.m.dot(&wy), self.y.dot(&wy));
        let log_det = 2.0 * cholesky.l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let log_r = my / mm;
        // At least rounding, so that exact ratios have no residual of zero.
        let rest = (yy - log_r * my).max(1e-15 * yy.abs());
        let free = self.y.len() as f64 - 1.0;
        // Twice Fisher's information of the restricted likelihood on s², tr(PDPD) with P = C⁻¹ −
        // C⁻¹mmᵀC⁻¹/mᵀC⁻¹m and D the derivative of C by s² (D. Harville, J. Am. Stat. Assoc. 72 (1977) 320).
        // Where the scale of C is not known either, the information spent on it (`taken`) is subtracted.
        let pd = (cholesky.inverse() - &wm * wm.transpose() / mm) * &self.scatter;
        let squares = pd.component_mul(&pd.transpose()).sum();
        let scale = rest / free.max(1.0);
        let (factor, misfit, taken) = if scaled {
            let factor = student(self.y.len() - 1).unwrap_or(f64::NAN);
            (factor * factor * scale, free * scale.max(f64::MIN_POSITIVE).ln(), pd.trace().powi(2) / free)
        } else {
            (1.0, rest, 0.0)
        };
        Some(Node {
            log_r,
            variance: factor / mm,
            noise: [s2, sigma2].map(|variance| factor * variance),
            scale,
            information: mm,
            likelihood: -0.5 * (log_det + mm.ln() + misfit),
            prior: (squares - taken).max(0.0).sqrt(),
        })
    }
}
