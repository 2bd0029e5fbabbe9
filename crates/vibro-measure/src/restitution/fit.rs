//! Restitution from a train of bounces: flight times shrink by R from bounce to bounce, `ln Δt_n = ln Δt₁ +
//! (n − 1) ln R`.
//!
//! ln R comes from ratios of successive flights, where R scatters from bounce to bounce and the onsets carry
//! noise.
//!
//! Ratios `y = ln(Δt_b/Δt_a)` have the covariance `s²·(b − a) + σ²AAᵀ`, with A the derivative of y by the
//! onsets, s the scatter of ln R from bounce to bounce and σ that of an onset. ln R follows by generalised
//! least squares (Aitken 1935), averaged over s², or s²/σ² where σ is not stated, which the restricted
//! likelihood (Patterson and Thompson 1971) weighs with its reference prior, the root of its information
//! (Jeffreys 1946; Berger and Bernardo, *Bayesian Statistics 4*, 1992, 35): it knows that s shows in the
//! first flights and σ in the last. Where σ is not stated, scatter of R alone has a probability of one half,
//! and the scale that the residuals give makes Student's distribution.
//!
//! Where R does not scatter at all the uncertainty is some four times what the onsets alone would make of it:
//! they rule the last flights, and a scatter that few flights hardly show rules the first.

use super::together;
use crate::mean::{average, mixture};
use crate::residuals::{student, widened};
use nalgebra::{DMatrix, DVector};

/// One flight: place in the train, logarithm of its time.
#[derive(Clone, Copy)]
pub(super) struct Flight {
    pub place: usize,
    pub log: f64,
}

/// How far one flight may be off: by R, which scatters from bounce to bounce, and by its two onsets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FlightNoise {
    /// Variance of ln R from bounce to bounce.
    scatter: f64,
    /// Variance of the time of an impact in s².
    onset: f64,
}

impl FlightNoise {
    /// Standard uncertainty in s of the first `flight` for what follows from all bounces.
    pub(super) fn of(&self, flight: f64) -> f64 {
        (self.scatter * flight * flight + 2.0 * self.onset).sqrt()
    }

    pub(super) fn mean(all: &[FlightNoise]) -> Option<FlightNoise> {
        let mean = |of: fn(&FlightNoise) -> f64| average(&all.iter().map(of).collect::<Vec<f64>>());
        (!all.is_empty()).then(|| FlightNoise { scatter: mean(|n| n.scatter), onset: mean(|n| n.onset) })
    }
}

/// Prior probability that R alone scatters, where nothing is stated of the onsets.
const SCATTER_ALONE: f64 = 0.5;
/// Variances of R are averaged over from where they show in ln R to where they outdo all else, and this
/// factor beyond.
const WIDE: f64 = 1e3;
/// Steps of the logarithm (to base 10) of a variance.
const STEP: f64 = 0.15;

/// What trains of one R tell together.
#[derive(Clone, Copy)]
pub(super) struct TrainFit {
    pub(super) log_r: f64,
    /// Standard uncertainty of ln R, which three degrees of freedom show.
    pub(super) std: Option<f64>,
    /// That of their flights, which one shows.
    pub(super) noise: Option<FlightNoise>,
}

/// Flights of a train, and the standard uncertainty of its onsets in s where it is known.
pub(super) type Timed = (Vec<Flight>, Option<f64>);

/// Sum over `trains` of the squared difference of their own ln R from `log`, over the variance that the
/// `noise` of flights gives it: χ² with one degree of freedom less than trains, where all have one R.
pub(super) fn misfit(trains: &[Timed], log: f64, noise: FlightNoise) -> f64 {
    let node =
        |(flights, _): &Timed| Ratios::new(&[flights], &[1.0], false).node(noise.scatter, noise.onset, false);
    trains.iter().filter_map(node).map(|own| (own.log_r - log).powi(2) / own.variance).sum()
}

/// ln R of trains and the noise of their flights; `None` without a ratio.
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
        // What R alone explains is the most that the first flights can be off.
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
        // Even steps of the logarithm: the density of s² times s².
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
    /// Its variance, Student's where the scale is that of the residuals.
    variance: f64,
    /// s² and σ², times what the residuals say and Student's factor where they give the scale.
    noise: [f64; 2],
    /// Mean square of the residuals over s² and σ², of one degree of freedom each.
    scale: f64,
    /// `mᵀC⁻¹m`.
    information: f64,
    /// Restricted log-likelihood but for a constant.
    likelihood: f64,
    /// Root of the information on s².
    prior: f64,
}

/// Ratios of successive flights, and of first flights behind the same fall.
struct Ratios {
    /// Their logarithms.
    y: DVector<f64>,
    /// Bounces between them.
    m: DVector<f64>,
    /// `BBᵀ`, with B the bounces that each has more than the other.
    scatter: DMatrix<f64>,
    /// `AAᵀ`, in 1/s².
    timing: DMatrix<f64>,
}

impl Ratios {
    /// Of trains whose onsets are off by these `parts` of σ.
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
                // A flight is the later onset less the earlier, and has R of each bounce before it.
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

    /// Generalised least squares; with `scaled`, all variances are multiplied by what the residuals say.
    fn node(&self, s2: f64, sigma2: f64, scaled: bool) -> Option<Node> {
        let cholesky = (&self.scatter * s2 + &self.timing * sigma2).cholesky()?;
        let (wm, wy) = (cholesky.solve(&self.m), cholesky.solve(&self.y));
        let (mm, my, yy) = (self.m.dot(&wm), self.m.dot(&wy), self.y.dot(&wy));
        let log_det = 2.0 * cholesky.l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let log_r = my / mm;
        // Roundings of the ratios are no scatter.
        let rest = (yy - log_r * my).max(1e-15 * yy.abs());
        let free = self.y.len() as f64 - 1.0;
        // Twice Fisher's information of the restricted likelihood on s², tr(PDPD) with P = C⁻¹ −
        // C⁻¹mmᵀC⁻¹/mᵀC⁻¹m and D the derivative of C by s² (D. Harville, J. Am. Stat. Assoc. 72
        // (1977) 320); with a scale of C that is not known, what that leaves of it.
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
