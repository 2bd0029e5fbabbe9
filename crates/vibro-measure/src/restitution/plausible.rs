//! The most plausible train of bounces among sounds: flights that shrink by a common ratio, and impacts that
//! grow quieter with them.
//!
//! Every pair of sounds may be the first two impacts. The evidence for a pair is the likelihood of the best
//! train that begins with it, over the one that all sounds are foreign and come at random, averaged over ln
//! R; the train follows by dynamic programming over pairs of sounds. A sound that follows an impact soon and
//! is quieter is its echo or ringing.

use crate::impacts::{QUIETER, Sound};

/// Sounds that are looked at: the loudest. Trains take the square of their number.
const MOST: usize = 128;
/// Steps of ln R, and least R.
const STEP: f64 = 0.015;
const LEAST: f64 = 0.03;
/// Largest R of a bounce: a superball returns with 0.92, steel on an anvil with 0.97. Sounds whose intervals
/// shrink less are evenly spaced.
const LARGEST: f64 = 0.985;
/// Even trains beside which bounces are sought: a record of more is one of a voice or a machine.
const EVEN: usize = 4;
/// Steps of ln R above 0 that are looked at: intervals of a voice or a machine grow, too.
const GROWS: usize = 2;
/// Standard deviation of ln R from bounce to bounce.
const SCATTER: f64 = 0.02;
/// Standard deviation of the time of an impact in s: what of a contact is loudest differs.
const TIMING: f64 = 3e-4;
/// Standard deviation of the logarithm of loudness over speed of an impact.
const LOUDNESS: f64 = 0.5;
/// Standard deviation of ln R by the stated height: 6 % of the height.
const FALL: f64 = 0.03;
/// A deviation of loudness, or from the stated height, costs no more: contacts may switch, and heights be in
/// mm.
const CAP: f64 = 4.0;
/// Within this time in s echoes of a room and ringing follow an impact, so many a second.
pub const SHADOW: f64 = 0.06;
const ECHOES: f64 = 50.0;
/// Foreign sounds of a record in which none is heard: one in five has a hand, a latch or a voice.
const UNHEARD: f64 = 0.2;
/// First flights in s, evenly likely on a logarithmic scale.
const FLIGHTS: [f64; 2] = [5e-3, 2.0];
/// The flight in s behind a fall of 5 mm, if R were 1: 2√(2h/g). What is dropped falls further; the pitch of
/// a voice, 2 to 13 ms, and its multiples hold trains of such falls.
const LOWEST: f64 = 0.064;
/// Sounds of a record that may begin within a train: a ball is heard a dozen times.
const CLEAN: usize = 16;
/// Cost of an end while the next impact is expected to exceed the noise limit by [`HEARD`]: one in ten balls
/// rolls off.
const ENDS: f64 = 2.3;
const HEARD: f64 = 3.0;
/// Trains whose evidence is less than one in so many of the best one's are ruled out.
const ODDS: f64 = 20.0;

/// The record of a fall.
#[derive(Debug, Clone, Copy)]
pub struct FallRecord {
    /// Noise limit of the sounds.
    pub reach: f64,
    /// Median height, of which a threshold is a part.
    pub median: f64,
    /// Begin and end of the record in s.
    pub ends: (f64, f64),
    /// The flight in s that would follow if R were 1, where the height is stated.
    pub full: Option<f64>,
}

/// The most plausible train of bounces.
#[derive(Debug, Clone, PartialEq)]
pub struct Plausible {
    /// Its impacts, as places in the sounds.
    pub impacts: Vec<usize>,
    /// First two impacts of another train that is as plausible.
    pub rival: Option<(usize, usize)>,
    /// Sounds that are echoes or ringing of its impacts.
    pub echoes: usize,
    /// Whether its intervals do not shrink, as those of ringing, of a voice or of a machine.
    pub even: bool,
}

/// The most plausible train of two impacts or more; `None` of fewer than two sounds.
pub fn plausible(sounds: &[Sound], heard: FallRecord) -> Option<Plausible> {
    let mut order: Vec<usize> = (0..sounds.len()).collect();
    order.sort_by(|a, b| sounds[*b].height.total_cmp(&sounds[*a].height));
    order.truncate(MOST);
    order.sort_unstable();
    // What follows evenly is a voice, a machine or ringing: bounces are sought among the rest.
    let mut even = None;
    for _ in 0..EVEN {
        let own: Vec<Sound> = order.iter().map(|i| sounds[*i]).collect();
        let Some(found) = best(&own, heard) else { break };
        // The grid of R ends, and trains may lie between its lines.
        let evenly = found.log_r.max(shrinks(&own, &found.train)) > LARGEST.ln();
        let train = Plausible {
            impacts: found.train.iter().map(|i| order[*i]).collect(),
            rival: found.rival.map(|(i, j)| (order[i], order[j])),
            echoes: found.echoes,
            even: evenly,
        };
        if !evenly {
            return Some(train);
        }
        order.retain(|i| !train.impacts.contains(i));
        even = even.or(Some(train));
    }
    even
}

/// Logarithm of the ratio by which the intervals of a train shrink from one to the next, of four impacts or
/// more.
fn shrinks(sounds: &[Sound], train: &[usize]) -> f64 {
    let interval = |pair: &[usize]| sounds[pair[1]].time - sounds[pair[0]].time;
    match train {
        [_, _, _, _, ..] => {
            let last = interval(&train[train.len() - 2..]);
            (last / interval(train)).ln() / (train.len() - 2) as f64
        }
        _ => f64::NEG_INFINITY,
    }
}

/// The best train; foreign sounds are at first all that are no echoes of louder ones, then those that no
/// impact of the train explains.
fn best(sounds: &[Sound], heard: FallRecord) -> Option<BestTrain> {
    let length = heard.ends.1 - heard.ends.0;
    let of = |count: usize| Pairs::new(sounds, heard, (count as f64 + UNHEARD) / length).best();
    let first = of(alone(sounds))?;
    of(sounds.len().saturating_sub(first.train.len() + first.echoes))
}

/// How many sounds no louder one precedes within the time of its echoes.
fn alone(sounds: &[Sound]) -> usize {
    let alone = |(i, s): &(usize, &Sound)| {
        let mut before = sounds[..*i].iter().rev().take_while(|b| b.time > s.time - SHADOW);
        before.all(|b| s.height >= QUIETER * b.height)
    };
    sounds.iter().enumerate().filter(alone).count()
}

/// ln(eᵃ + eᵇ).
fn added(a: f64, b: f64) -> f64 {
    let most = a.max(b);
    if most == f64::NEG_INFINITY { most } else { most + ((a - most).exp() + (b - most).exp()).ln() }
}

/// A train with its ln R, the first two impacts of one that is as plausible, and how many sounds are its
/// echoes.
struct BestTrain {
    train: Vec<usize>,
    log_r: f64,
    rival: Option<(usize, usize)>,
    echoes: usize,
}

/// What every pair of sounds is, whatever R is.
struct Pairs<'a> {
    sounds: &'a [Sound],
    heard: FallRecord,
    /// Logarithm of the rate of foreign sounds in 1/s over that of heights.
    foreign: f64,
    /// What an echo explains.
    echo: f64,
    logs: Vec<f64>,
}

impl Pairs<'_> {
    fn new(sounds: &[Sound], heard: FallRecord, rate: f64) -> Pairs<'_> {
        let highest = sounds.iter().fold(heard.reach, |h, s| h.max(s.height));
        let heights = (highest / heard.reach).ln().max(1.0);
        Pairs {
            sounds,
            heard,
            foreign: (rate / heights).ln(),
            echo: (ECHOES / rate).ln().max(0.0),
            logs: sounds.iter().map(|s| s.height.ln()).collect(),
        }
    }

    /// The train with the most evidence; `None` of fewer than two sounds.
    fn best(&self) -> Option<BestTrain> {
        let n = self.sounds.len();
        // Of each pair the evidence, and its best score with that ln R.
        let mut told = vec![(f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0); n * n];
        for step in 0..=((1.0 / LEAST).ln() / STEP) as usize + GROWS {
            let log_r = STEP * (GROWS as f64 - step as f64);
            let (value, _) = self.behind(log_r);
            for (i, j) in (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))) {
                let score = self.begin(i, j, log_r) + value[i * n + j];
                let (evidence, best, _) = told[i * n + j];
                let (best, at) = if score > best { (score, log_r) } else { (best, told[i * n + j].2) };
                told[i * n + j] = (added(evidence, score), best, at);
            }
        }
        let pairs = || (0..n * n).filter(|at| at / n < at % n);
        let evidence = |at: &usize| told[*at].0;
        let most = pairs().max_by(|a, b| evidence(a).total_cmp(&evidence(b)));
        let most = most.filter(|at| evidence(at).is_finite())?;
        let rival = pairs().filter(|at| *at != most).max_by(|a, b| evidence(a).total_cmp(&evidence(b)));
        let rival = rival.filter(|at| evidence(at) > evidence(&most) - ODDS.ln());
        let log_r = told[most].2;
        let train = self.follow(most / n, most % n, &self.behind(log_r).1);
        let ends = train.iter().skip(1).copied().chain([n]);
        let echoes = train.iter().zip(ends).map(|(j, k)| self.shadowed(*j, k)).sum();
        Some(BestTrain { train, log_r, rival: rival.map(|at| (at / n, at % n)), echoes })
    }

    /// Sounds between two impacts that are echoes or ringing of the first.
    fn shadowed(&self, j: usize, k: usize) -> usize {
        let impact = self.sounds[j];
        let near = self.sounds[j + 1..k].iter().take_while(|s| s.time < impact.time + SHADOW);
        near.filter(|s| s.height < QUIETER * impact.height).count()
    }

    fn flight(&self, j: usize, k: usize) -> f64 {
        self.sounds[k].time - self.sounds[j].time
    }

    /// What the loudness of impact `k` behind `j` tells.
    fn loudness(&self, j: usize, k: usize, log_r: f64) -> f64 {
        let z = (self.logs[k] - self.logs[j] - log_r) / LOUDNESS;
        -(0.5 * z * z).min(CAP) - (TURN * LOUDNESS).ln()
    }

    /// What a flight tells that should last `expected`.
    fn timed(flight: f64, expected: f64, scatter: f64) -> f64 {
        let std = scatter.hypot(6f64.sqrt() * TIMING / expected);
        let z = (flight / expected).ln() / std;
        -0.5 * z * z - (TURN * std * flight).ln()
    }

    /// What the first two impacts tell.
    fn begin(&self, i: usize, j: usize, log_r: f64) -> f64 {
        let flight = self.flight(i, j);
        // What follows evenly is found as such, however short its intervals are.
        let shrinks = log_r <= LARGEST.ln();
        if shrinks && self.sounds.len() > CLEAN && flight < LOWEST * log_r.exp() {
            return f64::NEG_INFINITY;
        }
        let any = -((FLIGHTS[1] / FLIGHTS[0]).ln() * flight).ln();
        let timed = match self.heard.full {
            Some(full) => Self::timed(flight, full * log_r.exp(), FALL).max(any - CAP),
            None => any,
        };
        timed + self.loudness(i, j, log_r) - self.foreign + self.echo * self.shadowed(i, j) as f64
    }

    /// What follows each pair of impacts at its best, and the next impact, for one R.
    fn behind(&self, log_r: f64) -> (Vec<f64>, Vec<usize>) {
        let n = self.sounds.len();
        let (mut value, mut next) = (vec![0.0; n * n], vec![usize::MAX; n * n]);
        for j in (0..n).rev() {
            for k in j + 1..n {
                let expected = self.flight(j, k) * log_r.exp();
                let std = SCATTER.hypot(6f64.sqrt() * TIMING / expected);
                let (from, to) = (expected * (-4.0 * std).exp(), (expected * (4.0 * std).exp()));
                let time = self.sounds[k].time;
                let heard = self.sounds[k].height * log_r.exp() > HEARD * self.heard.reach
                    && time + to < self.heard.ends.1;
                let mut best = self.echo * self.shadowed(k, n) as f64 - if heard { ENDS } else { 0.0 };
                let mut last = usize::MAX;
                for l in k + 1 + self.sounds[k + 1..].partition_point(|s| s.time < time + from)..n {
                    let flight = self.flight(k, l);
                    if flight > to {
                        break;
                    }
                    let told =
                        Self::timed(flight, expected, SCATTER) + self.loudness(k, l, log_r) - self.foreign;
                    let score = told + self.echo * self.shadowed(k, l) as f64 + value[k * n + l];
                    if score > best {
                        (best, last) = (score, l);
                    }
                }
                (value[j * n + k], next[j * n + k]) = (best, last);
            }
        }
        (value, next)
    }

    /// The train from its first two impacts on.
    fn follow(&self, i: usize, j: usize, next: &[usize]) -> Vec<usize> {
        let mut train = vec![i, j];
        while let [.., a, b] = train[..] {
            let c = next[a * self.sounds.len() + b];
            if c == usize::MAX {
                break;
            }
            train.push(c);
        }
        train
    }
}

/// √(2π).
const TURN: f64 = 2.506_628_274_631_000_5;

#[cfg(test)]
mod tests {
    use super::*;

    /// Three bounces of R 0.8 from 0.5 m, and behind them the pitch of a voice, 7.7 ms apart, whose intervals
    /// shrink by 0.2 % each.
    #[test]
    fn a_voice_is_no_train_whatever_its_intervals_do() {
        let mut sounds: Vec<Sound> =
            [1.0, 1.511, 1.920].iter().map(|time| Sound { time: *time, height: 0.3 }).collect();
        let mut time = 2.6;
        for k in 0..40 {
            sounds.push(Sound { time, height: 0.9 + 0.01 * f64::from(k % 3) });
            time += 7.7e-3 * 0.998f64.powi(k);
        }
        let heard = FallRecord { reach: 0.01, median: 0.9, ends: (0.0, 4.0), full: None };
        let voice = sounds[3..].to_vec();
        // Its pulses hold trains, and each of them has a rival.
        let refused = |train: Plausible| train.even || train.rival.is_some() || train.impacts.len() == 2;
        assert!(plausible(&voice, heard).is_none_or(refused));
        let found = plausible(&sounds, heard).unwrap();
        assert_eq!(found.impacts, [0, 1, 2], "{found:?}");
    }

    /// A voice that falls: 24 sounds whose intervals shrink from 9 ms by 0.96 each, as behind a fall of a
    /// tenth of a millimetre.
    #[test]
    fn no_ball_falls_from_a_tenth_of_a_millimetre() {
        let mut sounds = vec![Sound { time: 1.0, height: 1.0 }];
        for k in 0..23 {
            let time = sounds[sounds.len() - 1].time + 9e-3 * 0.96f64.powi(k);
            sounds.push(Sound { time, height: 0.96f64.powi(k + 1) });
        }
        let heard = FallRecord { reach: 0.01, median: 0.7, ends: (0.0, 3.0), full: None };
        let of_ball = |train: &Plausible| {
            let flights: Vec<f64> =
                train.impacts.windows(2).map(|w| sounds[w[1]].time - sounds[w[0]].time).collect();
            flights[0] >= LOWEST * (flights[flights.len() - 1] / flights[0]).min(0.9)
        };
        assert!(plausible(&sounds, heard).is_none_or(|train| train.even || of_ball(&train)));
        // A record of a dozen that begins within a train.
        assert_eq!(plausible(&sounds[..12], heard).unwrap().impacts.len(), 12);
    }

    #[test]
    fn intervals_of_a_train_shrink_by_its_ratio() {
        let mut times = vec![0.0, 1.0];
        for k in 1..5 {
            times.push(times[times.len() - 1] + 0.7f64.powi(k));
        }
        let sounds: Vec<Sound> = times.iter().map(|time| Sound { time: *time, height: 1.0 }).collect();
        let all: Vec<usize> = (0..sounds.len()).collect();
        assert!((shrinks(&sounds, &all) - 0.7f64.ln()).abs() < 1e-12);
        assert_eq!(shrinks(&sounds, &all[..3]), f64::NEG_INFINITY);
    }
}
