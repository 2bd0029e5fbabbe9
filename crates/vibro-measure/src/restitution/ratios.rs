//! ln R from ratios of successive flights where R scatters from bounce to bounce and from train to train, and the onsets carry noise.
//!
//! Ratios `y = ln(Δt_b/Δt_a)` of one train have the covariance `s²·(b − a) + σ²AAᵀ + τ²mmᵀ` with `m = b − a`, A the derivative of y by the onsets,
//! s the scatter of ln R from bounce to bounce, σ that of an onset, and τ that of ln R from train to train (random effects: Rao, *Linear Statistical
//! Inference*, 1973, 4g). ln R follows by generalised least squares (Aitken 1935). What scatters by how much is averaged over, weighed with the
//! restricted likelihood (Patterson and Thompson 1971): τ evenly in its logarithm, and no scatter between trains with a probability of one half; s², or
//! s²/σ² where σ is not stated, with its reference prior, the root of its information (Jeffreys 1946; Berger and Bernardo, *Bayesian Statistics 4*, 1992,
//! 35), which knows that s shows in the first flights and σ in the last. Where σ is not stated, scatter of R alone has a probability of one half.
//! A scale that the residuals give makes Student's distribution: there is a standard uncertainty from three degrees of freedom on.
//!
//! Where R does not scatter at all the uncertainty is some four times what the onsets alone would make of it: they rule the last flights, and a scatter that
//! few flights hardly show rules the first.

use super::train::{Flight, Train};
use crate::residuals::student;
use nalgebra::{DMatrix, DVector};

/// Variances between trains that are averaged over.
const STEPS: usize = 40;

/// ln R of trains of bounces.
#[derive(Debug, Clone, Copy)]
pub struct Fitted {
    pub log_r: f64,
    /// Standard uncertainty of `log_r`; NaN where the ratios do not show their scatter.
    pub std: f64,
    /// What the stated onsets alone would make of it; NaN where none are stated.
    pub onsets_alone: f64,
    /// Whether a scatter from train to train is likelier than none.
    pub trains_differ: bool,
    /// Trains behind it.
    pub trains: usize,
}

/// Prior probability that R alone scatters, where nothing is stated of the onsets.
const SCATTER_ALONE: f64 = 0.5;
/// Variances of R are averaged over from where they show in ln R to where they outdo all else, and this factor beyond.
const BEYOND: f64 = 1e3;
/// Fewer trains than this show a scatter between them without a standard uncertainty of their mean.
pub(crate) const TRAINS: usize = 6;
/// Steps of the logarithm (to base 10) of a variance.
const STEP: f64 = 0.15;

/// Generalised least squares of the flights that are kept; `None` without a ratio.
pub fn fit(flights: &[Flight], trains: &[Train]) -> Option<Fitted> {
    let blocks = blocks(flights);
    let n: usize = blocks.iter().map(|b| b.y.len()).sum();
    let timing: f64 = blocks.iter().map(|b| b.timing.diagonal().sum()).sum();
    let free = n.checked_sub(1)?;
    let unit = timing / n as f64;
    let stated: Option<Vec<f64>> = trains.iter().map(|t| t.onset_std.filter(|s| *s > 0.0)).collect();
    // Of several trains, the root mean square.
    let stated = stated.map(|s| s.iter().map(|s| s * s).sum::<f64>() / s.len() as f64);
    let trains = blocks.len();
    let few = |n: &Node| Fitted {
        log_r: n.log_r,
        std: f64::NAN,
        onsets_alone: f64::NAN,
        trains_differ: false,
        trains,
    };
    let Some(sigma2) = stated else {
        let mut nodes = Node::all(&blocks, 1.0, 0.0, true, free)?;
        if free < 3 {
            return nodes.first().map(few);
        }
        for node in &mut nodes {
            node.weight += SCATTER_ALONE.ln();
        }
        nodes.extend(over_scatter(&blocks, unit.recip(), true, free, 1.0 - SCATTER_ALONE)?);
        return average(&nodes, trains);
    };
    let alone = *Node::all(&blocks, 0.0, sigma2, false, free)?.first()?;
    let found = if free < 3 {
        few(&alone)
    } else {
        average(&over_scatter(&blocks, sigma2, false, free, 1.0)?, trains)?
    };
    Some(Fitted { onsets_alone: alone.std, ..found })
}

/// Fits for every s² beside this σ², with the reference prior of s² (of s²/σ² with `scaled`), of this probability together.
fn over_scatter(
    blocks: &[Block],
    sigma2: f64,
    scaled: bool,
    free: usize,
    probability: f64,
) -> Option<Vec<Node>> {
    let n = (free + 1) as f64;
    let alone = blocks.iter().map(|b| b.sums(0.0, sigma2)).collect::<Option<Vec<Sums>>>()?;
    let least = n / alone.iter().map(|s| s.mm).sum::<f64>() / BEYOND;
    let noisiest = blocks.iter().map(|b| sigma2 * b.timing.diagonal().max()).fold(0.0, f64::max);
    let shown = if scaled { 0.0 } else { blocks.iter().map(Block::scatter).sum::<f64>() / free as f64 };
    let steps = ((BEYOND * noisiest.max(shown) / least).log10() / STEP).ceil().clamp(0.0, 1e3) as usize;
    let mut each = Vec::new();
    for i in 0..=steps {
        let s2 = least * 10f64.powf(STEP * i as f64);
        // Even steps of the logarithm: the density of s² times s².
        let prior = s2 * information(blocks, s2, sigma2, scaled.then_some(free))?.sqrt();
        each.push((prior, Node::all(blocks, s2, sigma2, scaled, free)?));
    }
    let total: f64 = each.iter().map(|e| e.0).sum();
    let weighed = |(prior, mut nodes): (f64, Vec<Node>)| {
        for node in &mut nodes {
            node.weight += (probability * prior / total).ln();
        }
        nodes
    };
    Some(each.into_iter().flat_map(weighed).collect())
}

/// Twice Fisher's information of the restricted likelihood on s², `tr(PDPD)` with `P = C⁻¹ − C⁻¹mmᵀC⁻¹/mᵀC⁻¹m` and D the derivative of C by s²
/// (D. Harville, J. Am. Stat. Assoc. 72 (1977) 320); with the degrees of freedom of a scale of C that is not known, what that leaves of it.
fn information(blocks: &[Block], s2: f64, sigma2: f64, unscaled: Option<usize>) -> Option<f64> {
    let (mut mm, mut one, mut two, mut once, mut twice) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for block in blocks {
        let inverse = block.covariance(s2, sigma2).cholesky()?.inverse();
        let w = &inverse * &block.m;
        let by = DMatrix::from_diagonal(&block.m);
        let product = &inverse * &by;
        let dw = &by * &w;
        mm += block.m.dot(&w);
        one += product.trace();
        two += product.component_mul(&product.transpose()).sum();
        once += w.dot(&dw);
        twice += dw.dot(&(&inverse * &dw));
    }
    let trace = one - once / mm;
    let squares = two - 2.0 * twice / mm + (once / mm).powi(2);
    Some((squares - unscaled.map_or(0.0, |free| trace * trace / free as f64)).max(0.0))
}

/// Ratios of successive flights of one train.
struct Block {
    /// Their logarithms.
    y: DVector<f64>,
    /// Bounces between them.
    m: DVector<f64>,
    /// `AAᵀ`, in 1/s².
    timing: DMatrix<f64>,
}

fn blocks(flights: &[Flight]) -> Vec<Block> {
    flights
        .chunk_by(|a, b| a.train == b.train)
        .filter(|flights| flights.len() > 1)
        .map(|flights| {
            let pairs: Vec<(Flight, Flight)> = flights.windows(2).map(|w| (w[0], w[1])).collect();
            // Derivatives of each ratio by the onsets at both ends of both flights.
            let rows: Vec<[(usize, f64); 4]> = pairs
                .iter()
                .map(|(a, b)| {
                    let (da, db) = ((-a.log).exp(), (-b.log).exp());
                    [(a.place, da), (a.place + 1, -da), (b.place, -db), (b.place + 1, db)]
                })
                .collect();
            let product = |i: usize, j: usize| -> f64 {
                let pairs = rows[i].iter().flat_map(|x| rows[j].iter().map(move |y| (x, y)));
                pairs.filter(|(x, y)| x.0 == y.0).map(|(x, y)| x.1 * y.1).sum()
            };
            Block {
                y: DVector::from_iterator(pairs.len(), pairs.iter().map(|(a, b)| b.log - a.log)),
                m: DVector::from_iterator(pairs.len(), pairs.iter().map(|(a, b)| (b.place - a.place) as f64)),
                timing: DMatrix::from_fn(pairs.len(), pairs.len(), product),
            }
        })
        .collect()
}

/// Products of the ratios of one train with the inverse of their covariance C: `mᵀC⁻¹m`, `mᵀC⁻¹y`, `yᵀC⁻¹y`, ln|C|.
#[derive(Clone, Copy)]
struct Sums {
    mm: f64,
    my: f64,
    yy: f64,
    log_det: f64,
}

impl Block {
    fn covariance(&self, s2: f64, sigma2: f64) -> DMatrix<f64> {
        DMatrix::from_diagonal(&(&self.m * s2)) + &self.timing * sigma2
    }

    fn sums(&self, s2: f64, sigma2: f64) -> Option<Sums> {
        let cholesky = self.covariance(s2, sigma2).cholesky()?;
        let (wm, wy) = (cholesky.solve(&self.m), cholesky.solve(&self.y));
        Some(Sums {
            mm: self.m.dot(&wm),
            my: self.m.dot(&wy),
            yy: self.y.dot(&wy),
            log_det: 2.0 * cholesky.l().diagonal().iter().map(|d| d.ln()).sum::<f64>(),
        })
    }

    /// Sum of squares of the ratios about their mean, one bounce each.
    fn scatter(&self) -> f64 {
        let mean = self.y.sum() / self.m.sum();
        self.y.iter().zip(self.m.iter()).map(|(y, m)| (y - mean * m).powi(2) / m).sum()
    }
}

impl Sums {
    /// Those with `τ²mmᵀ` added to the covariance (Sherman and Morrison 1950).
    fn with(self, tau2: f64) -> Sums {
        let one = 1.0 + tau2 * self.mm;
        Sums {
            mm: self.mm / one,
            my: self.my / one,
            yy: self.yy - tau2 * self.my * self.my / one,
            log_det: self.log_det + one.ln(),
        }
    }
}

/// A fit for one s², σ² and τ².
#[derive(Clone, Copy)]
struct Node {
    log_r: f64,
    /// Standard uncertainty, Student's where the scale is that of the residuals.
    std: f64,
    /// τ² over the variance that ln R of one train has without it.
    ratio: f64,
    /// Logarithm of prior probability times likelihood.
    weight: f64,
}

impl Node {
    /// Fits without and, for several trains, with a scatter between them; the one without comes first. With `scaled`, all variances are
    /// multiplied by what the residuals say.
    fn all(blocks: &[Block], s2: f64, sigma2: f64, scaled: bool, free: usize) -> Option<Vec<Node>> {
        let sums: Vec<Sums> = blocks.iter().map(|b| b.sums(s2, sigma2)).collect::<Option<_>>()?;
        let of = |ratio: f64, tau2: f64, prior: f64| -> Node {
            let all = sums.iter().map(|s| s.with(tau2)).fold(
                Sums { mm: 0.0, my: 0.0, yy: 0.0, log_det: 0.0 },
                |a, b| Sums {
                    mm: a.mm + b.mm,
                    my: a.my + b.my,
                    yy: a.yy + b.yy,
                    log_det: a.log_det + b.log_det,
                },
            );
            let log_r = all.my / all.mm;
            // Roundings of the ratios are no scatter.
            let rest = (all.yy - log_r * all.my).max(1e-15 * all.yy.abs());
            let scale = if scaled { rest / free.max(1) as f64 } else { 1.0 };
            let factor = if scaled { student(free).unwrap_or(f64::NAN) } else { 1.0 };
            let misfit = if scaled { free as f64 * scale.max(f64::MIN_POSITIVE).ln() } else { rest };
            Node {
                log_r,
                std: factor * (scale / all.mm).sqrt(),
                ratio,
                weight: prior.ln() - 0.5 * (all.log_det + all.mm.ln() + misfit),
            }
        };
        if sums.len() < 2 {
            return Some(vec![of(0.0, 0.0, 1.0)]);
        }
        // τ² from a hundredth of the variance of one train on; scatter within the trains may be any part of that between them.
        let own = sums.iter().map(|s| s.mm.recip()).sum::<f64>() / sums.len() as f64;
        let mut nodes = vec![of(0.0, 0.0, 0.5)];
        nodes.extend((0..STEPS).map(|i| {
            let ratio = 10f64.powf(0.25 * i as f64 - 2.0);
            of(ratio, ratio * own, 0.5 / STEPS as f64)
        }));
        Some(nodes)
    }
}

/// Logarithm of the probability of all nodes together.
fn evidence(nodes: &[Node]) -> f64 {
    let most = nodes.iter().map(|n| n.weight).fold(f64::NEG_INFINITY, f64::max);
    most + nodes.iter().map(|n| (n.weight - most).exp()).sum::<f64>().ln()
}

/// Mean and standard uncertainty over what may scatter.
fn average(nodes: &[Node], trains: usize) -> Option<Fitted> {
    let total = evidence(nodes);
    let with: f64 = nodes.iter().filter(|n| n.ratio > 0.0).map(|n| (n.weight - total).exp()).sum();
    let trains_differ = with > 0.5;
    // Few trains that do not show a scatter between them have little of it, if any.
    let counts = |n: &&Node| trains >= TRAINS || trains_differ || n.ratio <= 1.0;
    let used: Vec<&Node> = nodes.iter().filter(counts).collect();
    let best = used.iter().map(|n| n.weight).max_by(f64::total_cmp)?;
    let parts: Vec<f64> = used.iter().map(|n| (n.weight - best).exp()).collect();
    let sum: f64 = parts.iter().sum();
    let over = |f: &dyn Fn(&Node) -> f64| used.iter().zip(&parts).map(|(n, p)| p * f(n)).sum::<f64>() / sum;
    let log_r = over(&|n| n.log_r);
    let std = over(&|n| n.std.powi(2) + (n.log_r - log_r).powi(2)).sqrt();
    let std = if trains_differ && trains < TRAINS { f64::NAN } else { std };
    Some(Fitted { log_r, std, onsets_alone: f64::NAN, trains_differ, trains })
}
