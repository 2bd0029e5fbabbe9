//! Restitution from a train of bounces: flight times shrink by R from bounce to bounce, `ln Δt_n = ln Δt₁ + (n − 1) ln R`.
//!
//! Two things disturb the logarithms: R that scatters from bounce to bounce (standard deviation s of ln R) makes them a random walk, and noise σ
//! of the onsets, which neighbouring flights share, weighs the more the shorter the flight. Ratios of successive flights, `y = ln(Δt_b/Δt_a)`, then have
//! the covariance `s²·(b − a) + σ²AAᵀ` with A the derivative of y by the onsets; ln R follows by generalised least squares, the restricted likelihood
//! (Patterson and Thompson 1971) says what of both is at work. For s = 0 that is the weighted straight line through `(n, ln Δt_n)`.

use super::{Shares, Way, above_zero, not_negative};
use crate::error::{Error, Result};
use crate::measure::Estimate;
use crate::measure::residuals::student;
use crate::units::notation::quantity;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Flight times of one train of bounces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Train {
    /// Times between successive impacts, in s.
    pub intervals: Vec<f64>,
    /// Standard uncertainty of one impact's time, in s, where it is known.
    pub onset_std: Option<f64>,
    /// How long the record goes on after the last impact, in s.
    pub after: Option<f64>,
}

/// A flight time that does not fit the train.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Outlier {
    /// Train, counted from 1.
    pub train: usize,
    /// Flight, counted from 1.
    pub flight: usize,
    /// Its time in s.
    pub interval: f64,
    /// What the others say it should be, in s.
    pub expected: f64,
}

/// More flights than this are no train of bounces.
const MOST: usize = 300;

/// One flight: train, place in the train, logarithm.
#[derive(Clone, Copy)]
struct Flight {
    train: usize,
    place: usize,
    log: f64,
}

pub(super) fn answer(
    trains: &[Train],
    outliers: &mut Vec<Outlier>,
    warnings: &mut Vec<String>,
) -> Result<Option<Way>> {
    let mut flights = Vec::new();
    for (train, t) in trains.iter().enumerate() {
        not_negative("an uncertainty of the time of an impact", t.onset_std)?;
        for interval in &t.intervals {
            above_zero("a flight time", *interval)?;
        }
        // A train of one flight has no ratio.
        if t.intervals.len() > 1 {
            flights.extend(t.intervals.iter().enumerate().map(|(place, d)| Flight {
                train,
                place,
                log: d.ln(),
            }));
        }
    }
    if flights.is_empty() {
        return Ok(None);
    }
    if flights.len() > MOST {
        return Err(Error::refused(format!(
            "{} flight times: a train of bounces has fewer than {MOST}",
            flights.len()
        ))
        .hint("`vibro impacts` takes the intervals of long records"));
    }
    while let Some((worst, expected)) = worst(&flights) {
        let bad = flights.remove(worst);
        outliers.push(Outlier {
            train: bad.train + 1,
            flight: bad.place + 1,
            interval: bad.log.exp(),
            expected,
        });
    }
    outliers.sort_by_key(|o| (o.train, o.flight));
    for o in outliers.iter() {
        warnings.push(format!(
            "Flight {} of train {}, {}, does not fit the others, which expect {}: it was left out.",
            o.flight,
            o.train,
            quantity(o.interval, "s", 4),
            quantity(o.expected, "s", 4)
        ));
    }
    let Some(fit) = fit(&flights, trains) else {
        return Err(Error::refused("flight times from which no ratio follows"));
    };
    let value = fit.log_r.exp();
    if value >= 1.0 {
        return Err(Error::refused(format!(
            "flight times grow, by {value:.4} from bounce to bounce: R would not be below 1"
        ))
        .hint("are the intervals in the order of the bounces, and all of one train?"));
    }
    let std = Some(value * fit.std).filter(|s| s.is_finite());
    let method = match std {
        None if flights.len() == 2 => "ratio of two flight times".to_owned(),
        None => {
            format!("log-linear fit of {} flight times, too few for a standard uncertainty", flights.len())
        }
        Some(_) => format!(
            "log-linear fit of {} flight times: ln R scatters by {} from bounce to bounce, onsets by {}",
            flights.len(),
            quantity(fit.scatter, "1", 2),
            quantity(fit.onset, "s", 2)
        ),
    };
    bend(&flights, warnings);
    ends(trains, value, warnings);
    warnings.push("Flight times need neither height nor g; they assume that each impact is short beside its flight and that R is the same at every speed. Drag of the air makes R too low.".to_owned());
    Ok(Some(Way {
        method: "flight times",
        restitution: Estimate::new(value, std, "1", flights.len(), method),
        shares: Shares::Flights,
    }))
}

/// Ratios of successive flights of one train.
struct Ratios {
    /// Their logarithms.
    y: DVector<f64>,
    /// Bounces between them.
    m: DVector<f64>,
    /// `AAᵀ`, in 1/s².
    timing: DMatrix<f64>,
}

fn ratios(flights: &[Flight]) -> Option<Ratios> {
    let pairs: Vec<(Flight, Flight)> =
        flights.windows(2).map(|w| (w[0], w[1])).filter(|(a, b)| a.train == b.train).collect();
    if pairs.is_empty() {
        return None;
    }
    // Derivatives of each ratio by the onsets at both ends of both flights, as (train, onset, value).
    let rows: Vec<[(usize, usize, f64); 4]> = pairs
        .iter()
        .map(|(a, b)| {
            let (da, db) = ((-a.log).exp(), (-b.log).exp());
            [
                (a.train, a.place, da),
                (a.train, a.place + 1, -da),
                (b.train, b.place, -db),
                (b.train, b.place + 1, db),
            ]
        })
        .collect();
    let product = |i: usize, j: usize| -> f64 {
        let pairs = rows[i].iter().flat_map(|x| rows[j].iter().map(move |y| (x, y)));
        pairs.filter(|(x, y)| (x.0, x.1) == (y.0, y.1)).map(|(x, y)| x.2 * y.2).sum()
    };
    Some(Ratios {
        y: DVector::from_iterator(pairs.len(), pairs.iter().map(|(a, b)| b.log - a.log)),
        m: DVector::from_iterator(pairs.len(), pairs.iter().map(|(a, b)| (b.place - a.place) as f64)),
        timing: DMatrix::from_fn(pairs.len(), pairs.len(), product),
    })
}

#[derive(Clone, Copy)]
struct Fitted {
    log_r: f64,
    std: f64,
    scatter: f64,
    onset: f64,
    likelihood: f64,
    /// Weighted sum of squared residuals.
    rest: f64,
}

impl Ratios {
    /// Generalised least squares for given s² and σ²; with `scaled`, both are multiplied by what the residuals say.
    fn gls(&self, s2: f64, sigma2: f64, scaled: bool) -> Option<Fitted> {
        let covariance = DMatrix::from_diagonal(&(&self.m * s2)) + &self.timing * sigma2;
        let cholesky = covariance.cholesky()?;
        let (wm, wy) = (cholesky.solve(&self.m), cholesky.solve(&self.y));
        let mm = self.m.dot(&wm);
        let log_r = self.m.dot(&wy) / mm;
        let rest = (self.y.dot(&wy) - log_r * log_r * mm).max(0.0);
        let free = self.y.len() as f64 - 1.0;
        let scale = if scaled { rest / free } else { 1.0 };
        let log_det = 2.0 * cholesky.l().diagonal().iter().map(|d| d.ln()).sum::<f64>() + mm.ln();
        let misfit = if scaled { free * scale.max(f64::MIN_POSITIVE).ln() } else { rest };
        Some(Fitted {
            log_r,
            std: (scale / mm).sqrt(),
            scatter: (scale * s2).sqrt(),
            onset: (scale * sigma2).sqrt(),
            likelihood: -0.5 * (log_det + misfit),
            rest,
        })
    }
}

/// Scatter of R is believed unless the onsets explain the ratios better by this log-likelihood: it errs to the safe side.
const SCATTER: f64 = 2.0;

fn fit(flights: &[Flight], trains: &[Train]) -> Option<Fitted> {
    let ratios = ratios(flights)?;
    let unit = ratios.timing.diagonal().mean();
    let free = ratios.y.len() - 1;
    // Stated noise of the onsets is believed; of several trains, its root mean square.
    let stated: Option<Vec<f64>> = trains.iter().map(|t| t.onset_std.filter(|s| *s > 0.0)).collect();
    let Some(stated) = stated else {
        if free == 0 {
            return ratios.gls(1.0, 0.0, false).map(|f| Fitted { std: f64::NAN, ..f });
        }
        let (scatter, onsets) = (ratios.gls(1.0, 0.0, true)?, ratios.gls(0.0, unit.recip(), true)?);
        let best = if onsets.likelihood > scatter.likelihood + SCATTER { onsets } else { scatter };
        // The residuals give the scale: Student's distribution, which has no variance up to two degrees of freedom.
        let factor = student(free).unwrap_or(f64::NAN);
        return Some(Fitted { std: factor * best.std, ..best });
    };
    let sigma2 = stated.iter().map(|s| s * s).sum::<f64>() / stated.len() as f64;
    let alone = ratios.gls(0.0, sigma2, false)?;
    if alone.rest <= free as f64 {
        return Some(alone);
    }
    // More scatter than the onsets have: an average over what R may add, with the likelihood as weight.
    let unit = sigma2 * unit;
    let fits: Vec<Fitted> = (0..=40)
        .filter_map(|i| ratios.gls(unit * 10f64.powf(-3.0 + 0.15 * f64::from(i)), sigma2, false))
        .collect();
    let best = *fits.iter().max_by(|a, b| a.likelihood.total_cmp(&b.likelihood))?;
    let weights: Vec<f64> = fits.iter().map(|f| (f.likelihood - best.likelihood).exp()).collect();
    let total: f64 = weights.iter().sum();
    let over =
        |f: &dyn Fn(&Fitted) -> f64| fits.iter().zip(&weights).map(|(g, w)| w * f(g)).sum::<f64>() / total;
    let log_r = over(&|g| g.log_r);
    let variance = over(&|g| g.std.powi(2) + (g.log_r - log_r).powi(2));
    Some(Fitted { log_r, std: variance.sqrt(), ..best })
}

/// Offset of each train, slope, residuals and degrees of freedom of the plain straight line through the logarithms.
fn line(flights: &[Flight]) -> (f64, Vec<f64>, usize) {
    let trains = flights.iter().map(|f| f.train + 1).max().unwrap_or(0);
    let mut means = vec![(0.0, 0.0, 0.0); trains];
    for f in flights {
        let m = &mut means[f.train];
        *m = (m.0 + 1.0, m.1 + f.place as f64, m.2 + f.log);
    }
    let centred = |f: &Flight| {
        (f.place as f64 - means[f.train].1 / means[f.train].0, f.log - means[f.train].2 / means[f.train].0)
    };
    let (sxx, sxy) = flights.iter().map(centred).fold((0.0, 0.0), |(a, b), (x, y)| (a + x * x, b + x * y));
    let slope = sxy / sxx;
    let residuals = flights.iter().map(centred).map(|(x, y)| y - slope * x).collect();
    let used = means.iter().filter(|m| m.0 > 0.0).count();
    (slope, residuals, flights.len().saturating_sub(used + 1))
}

/// Quantile 0.9995 of Student's t from 2 degrees of freedom on: what lies beyond is an outlier.
const OUTSIDE: [f64; 9] = [31.6, 12.92, 8.61, 6.87, 5.96, 5.41, 5.04, 4.78, 4.59];

/// The flight that fits the others worst, where it is an outlier, and what they expect of it.
fn worst(flights: &[Flight]) -> Option<(usize, f64)> {
    let mut found: Option<(usize, f64, f64)> = None;
    for i in 0..flights.len() {
        let mut others = flights.to_vec();
        let one = others.remove(i);
        let same: Vec<&Flight> = others.iter().filter(|f| f.train == one.train).collect();
        let (slope, residuals, free) = line(&others);
        if same.len() < 2 || free < 2 {
            continue;
        }
        let n = same.len() as f64;
        let x = one.place as f64 - same.iter().map(|f| f.place as f64).sum::<f64>() / n;
        let expected = same.iter().map(|f| f.log).sum::<f64>() / n + slope * x;
        let sxx: f64 = others
            .iter()
            .map(|f| {
                (f.place as f64 - others.iter().map(|o| o.place as f64).sum::<f64>() / others.len() as f64)
                    .powi(2)
            })
            .sum();
        let s2 = residuals.iter().map(|r| r * r).sum::<f64>() / free as f64;
        // Numbers that were typed have three digits at least: half a unit of the last is 1e-3 of a flight.
        let off = (one.log - expected).abs() / (s2 * (1.0 + 1.0 / n + x * x / sxx)).max(1e-6).sqrt();
        let score = off / OUTSIDE[(free - 2).min(OUTSIDE.len() - 1)];
        if found.is_none_or(|f| score > f.1) {
            found = Some((i, score, expected.exp()));
        }
    }
    found.filter(|f| f.1 > 1.0).map(|f| (f.0, f.2))
}

/// Says where residuals bend: R changes with the speed, or impacts are not short beside the last flights.
fn bend(flights: &[Flight], warnings: &mut Vec<String>) {
    let (_, residuals, free) = line(flights);
    if free < 3 {
        return;
    }
    let middle = 0.5 * flights.iter().map(|f| f.place).max().unwrap_or(0) as f64;
    let square = |f: &Flight| Flight { log: (f.place as f64 - middle).powi(2), ..*f };
    let (_, curve, _) = line(&flights.iter().map(square).collect::<Vec<_>>());
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let size = product(&curve, &curve);
    let c = product(&curve, &residuals) / size;
    let rest = (product(&residuals, &residuals) - c * c * size).max(0.0) / (free - 1) as f64;
    let t = c.abs() / (rest / size).sqrt();
    // As for outliers; and no bend where it changes no flight by half a per cent.
    if t > OUTSIDE[(free - 2).min(OUTSIDE.len() - 1)] && c.abs() * middle * middle > 5e-3 {
        warnings.push(format!(
            "Flight times do not shrink evenly: R {} from bounce to bounce. It changes with the speed of impact, or the last impacts are not short beside their flights; the uncertainty does not cover that.",
            if c > 0.0 { "grows" } else { "falls" }
        ));
    }
}

/// Says where a record ends before the bounce that should follow.
fn ends(trains: &[Train], value: f64, warnings: &mut Vec<String>) {
    for (i, train) in trains.iter().enumerate() {
        let (Some(after), Some(last)) = (train.after, train.intervals.last()) else { continue };
        let (next, still) = (last * value, last * value / (1.0 - value));
        let missing = after < next;
        let [after, next, still] = [after, next, still].map(|t| quantity(t, "s", 3));
        warnings.push(if missing {
            format!(
                "Train {}: the record ends {after} after the last impact, before the next is due at {next}: the last bounces are not in it. The body would come to rest {still} after that impact.",
                i + 1
            )
        } else {
            format!(
                "Train {}: the bounce due {next} after the last impact is not in the record, which goes on for {after}: the last bounces are lost in noise or in the ringing of the one before.",
                i + 1
            )
        });
    }
}
