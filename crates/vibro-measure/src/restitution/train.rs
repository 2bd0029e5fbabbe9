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

use super::plausible::{Heard, Plausible, SHADOW, plausible};
use super::{Way, above_zero, not_negative, repeated, together};
use crate::Estimate;
use crate::impacts::{Choose, Detected, ImpactsOptions, Sound, chosen, detect_among, octaves};
use crate::mean::{average, mixture};
use crate::residuals::{student, widened};
use nalgebra::{DMatrix, DVector};
use std::cell::Cell;
use vibro_record::units::notation::{counted, quantity};
use vibro_record::{Error, Finding, Result, Trace};

/// Flight times of one train of bounces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Train {
    /// Times between successive impacts, in s.
    pub intervals: Vec<f64>,
    /// Standard uncertainty of one impact's time, in s, where it is known.
    pub onset_std: Option<f64>,
    /// How long an impact lasts, in s, where the record shows it.
    pub contact: Option<Estimate>,
    /// Relative standard uncertainty of the sampling rate: all intervals are longer or shorter by it.
    pub clock: f64,
}

impl Train {
    /// Lowest bounce as a part of the median one.
    pub const THRESHOLD: f64 = 0.02;

    /// The bounces of a falling body, with its impacts: the most plausible train among what is heard. `full`
    /// is the flight in s that would follow the fall if R were 1, where the height is known.
    ///
    /// # Errors
    /// As those of [`crate::impacts::impacts`]; also where no train of two impacts is more plausible than all
    /// others.
    pub fn of(trace: &Trace, options: &ImpactsOptions, full: Option<f64>) -> Result<(Train, Detected)> {
        let (start, rate) = (trace.axis.start(), trace.sampling_rate()?);
        let ends = (start, start + trace.values.len() as f64 / rate);
        // A record that rings is refused before anything is chosen.
        let heard = Cell::new(usize::MAX);
        let choose = |sounds: &[Sound], reach: f64, median: f64| {
            heard.set(sounds.len());
            choose(sounds, Heard { reach, median, ends, full })
        };
        let mut found = detect_among(trace, options, Some(&choose));
        // Below the impacts may lie hum or slow levels that hide them.
        if found.is_err() && heard.get() < 2 && options.band.is_none() {
            found = found.or_else(|error| above_hum(trace, options, &choose).ok_or(error));
        }
        let found = found?;
        if found.times.len() < 2 {
            let few = Error::refused("one impact found: restitution from a drop needs two");
            let few = few.hint("a lower threshold, or a shorter pause between impacts");
            return Err(few.setting("threshold").setting("refractory"));
        }
        let intervals = found.times.windows(2).map(|w| w[1] - w[0]).collect();
        let (onset_std, contact, clock) = (found.onset_std, found.contact.clone(), trace.meta.clock);
        Ok((Train { intervals, onset_std, contact, clock }, found))
    }
}

/// The train of three impacts or more above the corner that shows most of them, the highest of these: it
/// times them best.
fn above_hum(trace: &Trace, options: &ImpactsOptions, choose: Choose<'_>) -> Option<Detected> {
    let octaves: Vec<(f64, f64)> = octaves(trace.sampling_rate().ok()?).collect();
    let high = octaves.first()?.1;
    let above = |(low, _): (f64, f64)| {
        let band = (low, high);
        let own = ImpactsOptions { band: Some(band), ..options.clone() };
        // In a band of steady noise sounds have no end.
        let few = |sounds: &[Sound], reach: f64, median: f64| {
            if sounds.len() > FEW {
                Err(Error::refused("too many sounds"))
            } else {
                choose(sounds, reach, median)
            }
        };
        let mut found = detect_among(trace, &own, Some(&few)).ok().filter(|found| found.times.len() > 2)?;
        found.findings.push(chosen(band));
        Some(found)
    };
    octaves.into_iter().rev().filter_map(above).max_by_key(|found| found.times.len())
}

/// The impacts among sounds, and what the others are.
fn choose(sounds: &[Sound], heard: Heard) -> Result<(Vec<usize>, Vec<Finding>)> {
    let n = sounds.len();
    let Some(train) = plausible(sounds, heard) else {
        let impacts = counted(n, "impact");
        let why = format!("{impacts} found, a drop has two or more: each rises at once and decays");
        let hint = "`vibro decay` measures a ringing, `vibro pulse` the force of one contact";
        return Err(Error::refused(why).hint(hint));
    };
    if train.even {
        let n = train.impacts.len();
        let why = format!("{n} sounds follow each other evenly: the flights of bounces shrink");
        // Who states a height has a fall, and a voice over it.
        if heard.full.is_some() {
            return Err(alone(Error::refused(why), sounds, heard));
        }
        let hint = "`vibro impacts` for a machine; for a drop among voices the height of its fall";
        return Err(Error::refused(why).hint(hint).setting("height"));
    }
    if let Some((i, j)) = train.rival {
        let time = |i: usize| sounds[i].time;
        let (a, b) = (train.impacts[0], train.impacts[1]);
        let [first, other] = apart([time(b) - time(a), time(j) - time(i)]);
        let [begin, later] = apart([time(a), time(i)]);
        let why = format!(
            "{n} sounds, and two trains of bounces among them are as likely: first flight {first} from {begin} on, or {other} from {later} on"
        );
        let refused = Error::refused(why);
        let delay = if ((time(b) - time(a)) / (time(j) - time(i)) - 1.0).abs() < SAME {
            (time(i) - time(a)).abs()
        } else {
            (time(b) - time(a)).min(time(j) - time(i))
        };
        if let Some(threshold) = cure(sounds, heard, &train) {
            return Err(refused
                .hint("a threshold that leaves one of them, if what is quieter is no bounce")
                .set("threshold", format!("{threshold:.2}")));
        }
        if let Some(pause) = pause(sounds, heard, delay) {
            return Err(refused
                .hint("a pause that leaves one of them, if what follows an impact within it is its echo")
                .set("refractory", format!("{pause:.2}")));
        }
        return Err(alone(refused, sounds, heard));
    }
    let before = train.impacts[0];
    let other = n - train.impacts.len() - before - train.echoes;
    if train.impacts.len() == 2 && before + other > 0 {
        let others = counted(before + other, "other sound");
        let why = format!("one flight beside {others}: no second flight shows that it is that of a bounce");
        return Err(alone(Error::refused(why), sounds, heard));
    }
    let of = |code, n: usize| (n > 0).then(|| Finding::note(code).count("n", n));
    let echoes = of("echoes-ignored", train.echoes).map(|found| found.number("delay", SHADOW));
    let findings = [of("handling-ignored", before), echoes, of("sounds-ignored", other)];
    Ok((train.impacts, findings.into_iter().flatten().collect()))
}

/// Two times in s with as many digits, three at least, as show that they differ.
pub(super) fn apart(times: [f64; 2]) -> [String; 2] {
    let shown = |digits| times.map(|time| quantity(time, "s", digits));
    (3..9).map(shown).find(|[a, b]| a != b).unwrap_or_else(|| shown(3))
}

/// The lowest threshold in hundredths from which on one train of three impacts or more is left, all of them
/// impacts of the most plausible `train` of all sounds: what is found only without the quieter ones may be an
/// echo.
fn cure(sounds: &[Sound], heard: Heard, train: &Plausible) -> Option<f64> {
    let thresholds = (1..100).rev().map(|hundredths| 0.01 * f64::from(hundredths));
    let above = |threshold: f64| {
        let high = sounds.iter().copied().filter(|s| s.height > threshold * heard.median);
        (threshold, high.collect::<Vec<Sound>>())
    };
    let cures = |high: &[Sound]| {
        let known = |i: &usize| train.impacts.iter().any(|k| sounds[*k] == high[*i]);
        plausible(high, heard).is_some_and(|left| {
            !left.even && left.rival.is_none() && left.impacts.len() > 2 && left.impacts.iter().all(known)
        })
    };
    let few = thresholds.map(above).take_while(|(_, high)| high.len() < sounds.len().min(FEW));
    let mut lowest = None;
    for (threshold, high) in few {
        match (cures(&high), lowest) {
            (true, _) => lowest = Some(threshold),
            (false, Some(_)) => break,
            (false, None) => {}
        }
    }
    lowest
}

/// What to try where sounds alone do not tell which are the bounces.
fn alone(refused: Error, sounds: &[Sound], heard: Heard) -> Error {
    let first = (1..sounds.len().min(CLAPS)).find(|first| are_told(&sounds[*first..], heard));
    if let Some(first) = first {
        let from = f64::midpoint(sounds[first - 1].time, sounds[first].time);
        return refused
            .hint("the part behind what is heard first, if that is a hand or a clap")
            .set("span", format!("[{from:.2}, {:.2}]", heard.ends.1));
    }
    let cut = "cut the record to the bounces, or record again in quiet";
    match heard.full {
        None => refused
            .hint("state the height of the fall, which tells them apart; or ".to_owned() + cut)
            .setting("height"),
        Some(_) => refused.hint(cut),
    }
}

/// Whether one train of three impacts or more is told among sounds, or of two where the height is known,
/// which holds their flight to be that of a bounce.
fn are_told(sounds: &[Sound], heard: Heard) -> bool {
    let enough = if heard.full.is_some() { 2 } else { 3 };
    plausible(sounds, heard)
        .is_some_and(|train| !train.even && train.rival.is_none() && train.impacts.len() >= enough)
}

/// Sounds before a fall that a part of the record may leave out.
const CLAPS: usize = 4;

/// Difference of first flights, as a part of them, that is none: a train with the echo of its first impact in
/// place of it.
const SAME: f64 = 0.05;

/// A pause in s behind each impact, a half more than the `delay` of what follows it, that leaves one train of
/// three impacts or more, or of two behind a fall from a known height.
fn pause(sounds: &[Sound], heard: Heard, delay: f64) -> Option<f64> {
    let pause = (150.0 * delay).ceil() / 100.0;
    let mut kept: Vec<Sound> = Vec::new();
    for sound in sounds {
        if kept.last().is_none_or(|last| sound.time >= last.time + pause) {
            kept.push(*sound);
        }
    }
    (kept.len() < sounds.len() && are_told(&kept, heard)).then_some(pause)
}

/// Sounds among which a threshold is sought: what is as quiet as so many others is no bounce that stands out.
const FEW: usize = 32;

/// A flight this much longer than the first is no bounce of the same fall.
const LONGER: f64 = 1.2;
/// So many of them are more than what is heard of a hand before and behind a fall.
const HANDLED: usize = 2;

/// How many flights among the others are longer than the first, where they are too many for one fall: voices
/// or ringing count as impacts.
pub(super) fn longer(train: &Train) -> Option<usize> {
    let (first, rest) = train.intervals.split_first()?;
    let long = |flight: &&f64| **flight > LONGER * first;
    // What is heard behind the last bounce is another matter.
    let behind = rest.iter().rev().take_while(long).count();
    let n = rest[..rest.len() - behind].iter().filter(long).count();
    (n > HANDLED).then_some(n)
}

/// How far one flight may be off: by R, which scatters from bounce to bounce, and by its two onsets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Noise {
    /// Variance of ln R from bounce to bounce.
    scatter: f64,
    /// Variance of the time of an impact in s².
    onset: f64,
}

impl Noise {
    /// Standard uncertainty in s of the first `flight` for what follows from all bounces.
    pub(super) fn of(&self, flight: f64) -> f64 {
        (self.scatter * flight * flight + 2.0 * self.onset).sqrt()
    }

    fn mean(all: &[Noise]) -> Option<Noise> {
        let mean = |of: fn(&Noise) -> f64| average(&all.iter().map(of).collect::<Vec<f64>>());
        (!all.is_empty()).then(|| Noise { scatter: mean(|n| n.scatter), onset: mean(|n| n.onset) })
    }
}

/// Trains from which on their scatter shows all that is uncertain in each.
const MANY: usize = 4;

/// R of trains of bounces, `None` where no train has two flights; and the noise of their flights, where it
/// shows. Up to three trains share R and noise, and where all begin with the same `fall`, the first flight;
/// of more R is the mean of their ln R.
pub(super) fn answer(
    trains: &[Train],
    fall: bool,
    findings: &mut Vec<Finding>,
) -> Result<(Option<Way>, Option<Noise>)> {
    let (mut all, mut fits) = (Vec::new(), Vec::new());
    for (train, t) in trains.iter().enumerate().map(|(i, t)| (i + 1, t)) {
        not_negative("an uncertainty of the time of an impact", t.onset_std)?;
        t.intervals.iter().try_for_each(|interval| above_zero("a flight time", *interval))?;
        if let Some(n) = longer(t) {
            let why = format!(
                "{n} flights of train {train} are longer than the first: other sounds count as impacts"
            );
            let hint = "cut the record to the bounces, or raise the threshold; else intervals in the order of the bounces";
            return Err(Error::refused(why).hint(hint).setting("threshold").setting("refractory"));
        }
        let mut flights: Vec<Flight> =
            t.intervals.iter().enumerate().map(|(place, d)| Flight { place, log: d.ln() }).collect();
        while let Some((worst, expected)) = worst(&flights) {
            let bad = flights.remove(worst);
            findings.push(
                Finding::caution("flight-outlier")
                    .count("flight", bad.place + 1)
                    .count("train", train)
                    .number("interval", bad.log.exp())
                    .number("expected", expected),
            );
        }
        // A train of one flight has no ratio.
        if flights.len() > 1 {
            let fit = fit(&[(flights.clone(), t.onset_std)], false)
                .ok_or_else(|| Error::refused("flight times from which no ratio follows"))?;
            let noise = t.onset_std.unwrap_or(0.0);
            if let Some(flight) = grown(&flights, noise).or(flights.last().filter(|_| fit.log_r >= 0.0)) {
                let flight = flight.place + 1;
                let why =
                    format!("the flight times grow, at flight {flight} of train {train}: R would be above 1");
                let hint = "a longer pause where ringing or echoes count as impacts; else intervals in the order of the bounces";
                return Err(Error::refused(why).hint(hint).setting("refractory"));
            }
            fits.push(fit);
        }
        all.push((flights, t.onset_std));
    }
    if fits.is_empty() {
        return Ok((None, None));
    }
    let joint = (all.len() < MANY).then(|| fit(&all, fall)).flatten();
    let (log, std, noise) = if let Some(fit) = joint {
        (fit.log_r, fit.std, fit.noise)
    } else {
        let logs: Vec<f64> = fits.iter().map(|fit| fit.log_r).collect();
        let stated = together(fits.iter().map(|fit| fit.std)).filter(|_| logs.len() < MANY);
        let (log, std) = repeated(&logs, stated);
        (log, std, Noise::mean(&fits.iter().filter_map(|fit| fit.noise).collect::<Vec<_>>()))
    };
    let n = all.iter().map(|(flights, _)| flights.len()).filter(|n| *n > 1).sum();
    let value = log.exp();
    let few = Finding::caution("too-few-flights").count("n", n).count("trains", fits.len());
    findings.extend(std.is_none().then_some(few));
    let method = format!("log-linear fit of {n} flight times");
    let restitution = Estimate::new(value, std.map(|s| value * s), "1", n, method);
    Ok((Some(Way { method: "flight times", restitution }), noise))
}

/// Growth beyond this many standard deviations of the onset noise is none of it.
const BEYOND: f64 = 4.0;

/// A flight that is longer than the one before it, which the noise of the onsets does not explain.
fn grown(flights: &[Flight], onset_std: f64) -> Option<&Flight> {
    let grows = |pair: &&[Flight]| {
        let (before, after) = (pair[0].log.exp(), pair[1].log.exp());
        // Two neighbours have the variance 6σ²: they share an onset.
        after - before > (BEYOND * onset_std * 6f64.sqrt()).max(1e-3 * before)
    };
    flights.windows(2).find(grows).map(|pair| &pair[1])
}

/// Quantile 0.9995 of Student's t from 2 degrees of freedom on: what lies beyond is an outlier.
const OUTSIDE: [f64; 9] = [31.6, 12.92, 8.61, 6.87, 5.96, 5.41, 5.04, 4.78, 4.59];

/// How far the flight `one` is from what the `others` expect, in parts of the quantile, and that logarithm:
/// by the straight line through the logarithms, where the variance of a logarithm goes as Δt to −`power`.
fn off(one: &Flight, others: &[Flight], power: f64) -> Option<(f64, f64)> {
    let free = others.len().checked_sub(4)?;
    let weight = |log: f64| (power * log).exp();
    let sum =
        |f: &dyn Fn(&Flight) -> f64| others.iter().map(|other| weight(other.log) * f(other)).sum::<f64>();
    let total = sum(&|_| 1.0);
    let (place, log) = (sum(&|f| f.place as f64) / total, sum(&|f| f.log) / total);
    let x = |f: &Flight| f.place as f64 - place;
    let sxx = sum(&|f| x(f) * x(f));
    let slope = sum(&|f| x(f) * (f.log - log)) / sxx;
    let residual = |f: &Flight| f.log - log - slope * x(f);
    let expected = one.log - residual(one);
    let leverage = weight(expected).recip() + total.recip() + x(one) * x(one) / sxx;
    let variance = sum(&|f| residual(f).powi(2)) / (free + 2) as f64 * leverage;
    // Numbers that were typed have three digits at least: half a unit of the last is 1e-3 of a flight.
    let score = residual(one).abs() / variance.max(1e-6).sqrt();
    Some((score / OUTSIDE[free.min(OUTSIDE.len() - 1)], expected))
}

/// The flight that fits the others worst, where it is an outlier, and the time that they expect of it: one
/// whether R scatters, which makes the variances of logarithms alike, or the onsets do, which makes them go
/// as 1/Δt².
fn worst(flights: &[Flight]) -> Option<(usize, f64)> {
    let scored = |i: usize| {
        let mut others = flights.to_vec();
        let one = others.remove(i);
        let (alike, timed) = (off(&one, &others, 0.0)?, off(&one, &others, 2.0)?);
        let (score, expected) = if timed.0 < alike.0 { timed } else { alike };
        Some((i, score, expected.exp()))
    };
    let worst = (0..flights.len()).filter_map(scored).max_by(|a, b| a.1.total_cmp(&b.1))?;
    (worst.1 > 1.0).then_some((worst.0, worst.2))
}

/// One flight: place in the train, logarithm of its time.
#[derive(Clone, Copy)]
pub struct Flight {
    pub place: usize,
    pub log: f64,
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
pub struct Fit {
    log_r: f64,
    /// Standard uncertainty of ln R, which three degrees of freedom show.
    std: Option<f64>,
    /// That of their flights, which one shows.
    noise: Option<Noise>,
}

/// Flights of a train, and the standard uncertainty of its onsets in s where it is known.
type Timed = (Vec<Flight>, Option<f64>);

/// ln R of trains and the noise of their flights; `None` without a ratio.
fn fit(trains: &[Timed], fall: bool) -> Option<Fit> {
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
        let noise = scatter_alone.filter(|_| free > 0).map(|node| Noise { scatter: scatter(node), onset });
        return Some(Fit { log_r, std: None, noise });
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
    Some(Fit { log_r, std, noise: std.map(|_| Noise { scatter, onset }) })
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
