//! The most plausible train of bounces among sounds: flights that shrink by a common ratio, and impacts that
//! grow quieter with them.
//!
//! Every pair of sounds may be the first two impacts. The evidence for a pair is a likelihood ratio, averaged
//! over ln R: the best train that begins with the pair, against foreign sounds at random times only. Dynamic
//! programming over pairs of sounds finds the train. A quieter sound soon after an impact is its echo or
//! ringing. All log-likelihoods are natural logarithms.

use crate::impacts::{QUIETER, Sound};

/// Step of the grid of ln R.
pub const STEP: f64 = 0.015;
/// Smallest R of the grid.
pub const LEAST: f64 = 0.03;
/// Largest R of a bounce: a superball has 0.92, steel on an anvil 0.97. Sounds whose intervals shrink less
/// count as evenly spaced.
pub const LARGEST: f64 = 0.985;
/// Steps of the grid above ln R = 0: intervals of a voice or a machine may grow.
const GROWS: usize = 2;
/// Standard deviation of ln R from bounce to bounce.
pub const SCATTER: f64 = 0.02;
/// Standard deviation of the time of an impact in s: the loudest instant of a contact varies.
const TIMING: f64 = 3e-4;
/// Standard deviation of ln(loudness/speed) of an impact.
const LOUDNESS: f64 = 0.5;
/// Standard deviation of ln R from the stated height, whose error is taken as 6 %.
const FALL: f64 = 0.03;
/// Largest cost of a deviation, in log-likelihood: an electrical contact only switches, whatever the speed,
/// and a height may be typed in mm.
const CAP: f64 = 4.0;
/// Time in s after an impact within which echoes of the room and ringing follow.
pub const SHADOW: f64 = 0.06;
/// Rate of echoes and ringing within that time, in 1/s.
const ECHOES: f64 = 50.0;
/// Probability that the release that begins the fall is heard: one record in five.
const RELEASES: f64 = 0.2;
/// Shortest and longest first flight in s; all between are equally likely on a logarithmic scale.
const FLIGHTS: [f64; 2] = [5e-3, 2.0];
/// Shortest first flight in s for R = 1, 2√(2h/g) after a fall of h = 5 mm. Bodies are dropped from higher;
/// the pitch period of a voice, 2 to 13 ms, and its multiples would pass for trains of lower falls.
pub const LOWEST: f64 = 0.064;
/// A record with at most this many sounds may begin within a train, with a first flight below [`LOWEST`]: a
/// ball is heard about a dozen times.
const CLEAN: usize = 16;
/// Cost, in log-likelihood, of a train that ends although its next impact should be heard: one ball in ten
/// rolls off.
const ENDS: f64 = 2.3;
/// Expected height over the noise limit from which the next impact should be heard.
const HEARD: f64 = 3.0;
/// Smallest ratio of the best evidence to that of a rival at which the rival is ruled out.
pub const ODDS: f64 = 20.0;

/// The record of a fall.
#[derive(Debug, Clone, Copy)]
pub struct FallRecord {
    /// Noise limit of the sounds.
    pub reach: f64,
    /// Median height of the sounds; a threshold is stated relative to it.
    pub median: f64,
    /// Beginning and end of the record in s.
    pub ends: (f64, f64),
    /// The flight in s that would follow if R were 1, where the height is stated.
    pub full: Option<f64>,
    /// Shortest time between two impacts, in s, where it is stated.
    pub pause: Option<f64>,
}

/// Another explanation of the sounds than the most plausible train.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rival {
    /// First two impacts of another train.
    Train(usize, usize),
    /// The release and the only impact that is heard: the time between them is the fall.
    Fall(usize, usize),
}

/// √(2π).
const TURN: f64 = 2.506_628_274_631_000_5;

/// Standard deviation of ln(flight) for a flight that should last `expected` (s). `scatter` is the part from
/// R or the height. The times of three impacts, with weights of 1, −2 and 1 at most, add 6 TIMING².
fn spread(expected: f64, scatter: f64) -> f64 {
    (scatter * scatter + 6.0 * TIMING * TIMING / (expected * expected)).sqrt()
}

/// Evidence for a pair as the first two impacts, summed over ln R.
#[derive(Clone, Copy)]
struct Evidence {
    /// Largest log-likelihood.
    best: f64,
    /// ln R of the largest log-likelihood.
    log_r: f64,
    /// Sum of all likelihoods over the largest.
    sum: f64,
}

/// Difference of log-likelihoods below which the smaller adds nothing to a sum of doubles: e^−39 = 1e-17.
const NOTHING: f64 = -39.0;

impl Evidence {
    const NONE: Evidence = Evidence { best: f64::NEG_INFINITY, log_r: 0.0, sum: 0.0 };

    /// Adds a log-likelihood.
    fn add(&mut self, score: f64, log_r: f64) {
        let below = score - self.best;
        if below > 0.0 {
            self.sum = 1.0 + if below < -NOTHING { self.sum * (-below).exp() } else { 0.0 };
            (self.best, self.log_r) = (score, log_r);
        } else if below > NOTHING {
            self.sum += below.exp();
        }
    }

    /// Logarithm of the sum of all likelihoods.
    fn all(&self) -> f64 {
        self.best + self.sum.ln()
    }
}

/// The train with the most evidence.
pub struct BestTrain {
    /// Its impacts, as indices of sounds.
    pub train: Vec<usize>,
    /// Its ln R.
    pub log_r: f64,
    /// Another explanation that is not ruled out.
    pub rival: Option<Rival>,
    /// Time of the next impact in s, where that should be heard.
    pub expected: Option<f64>,
    /// Number of sounds that are echoes or ringing of its impacts.
    pub echoes: usize,
    /// Number of sounds that are the release and its echoes.
    pub release: usize,
    /// Odds that these are the release and not foreign sounds.
    pub odds: f64,
}

/// The next impact as predicted from a pair of impacts.
struct Next {
    /// The flight to it in s.
    flight: f64,
    /// Factor by which the flight may be longer or shorter.
    range: f64,
    /// Whether it should be heard: loud enough, and within the record.
    stands_out: bool,
}

/// Terms of all pairs of sounds that do not depend on R.
pub struct Pairs<'a> {
    sounds: &'a [Sound],
    heard: FallRecord,
    /// Rate of foreign sounds in 1/s.
    rate: f64,
    /// Log-likelihood of a foreign sound: ln of their rate over the range of ln(height).
    foreign: f64,
    /// Gain in log-likelihood of a sound that is an echo and not foreign.
    echo: f64,
    /// ln(height) of each sound.
    logs: Vec<f64>,
    /// Gain in log-likelihood by a release before the first impact, for each sound as that impact.
    released: Vec<f64>,
}

impl Pairs<'_> {
    pub fn new(sounds: &[Sound], heard: FallRecord, rate: f64) -> Pairs<'_> {
        let highest = sounds.iter().fold(heard.reach, |h, s| h.max(s.height));
        let heights = (highest / heard.reach).ln().max(1.0);
        let mut pairs = Pairs {
            sounds,
            heard,
            rate,
            foreign: (rate / heights).ln(),
            echo: (ECHOES / rate).ln().max(0.0),
            logs: sounds.iter().map(|s| s.height.ln()).collect(),
            released: Vec::new(),
        };
        let released = |j: usize| {
            let releases = (0..j).filter_map(|i| pairs.release(i, j));
            (1.0 - RELEASES + releases.sum::<f64>()).ln()
        };
        pairs.released = (0..sounds.len()).map(released).collect();
        pairs
    }

    /// Odds that `i` and its echoes are the release before the first impact `j` and not foreign sounds;
    /// `None` where the height of the fall is not stated.
    fn release(&self, i: usize, j: usize) -> Option<f64> {
        let fall = 0.5 * self.heard.full?;
        let echoes = self.echo * self.shadowed(i, j) as f64;
        Some(RELEASES / self.rate * (Self::timed(self.flight(i, j), fall, FALL) + echoes).exp())
    }

    /// Number of sounds that are likely the release before the first impact `j` and its echoes, and the odds.
    fn likeliest_release(&self, j: usize) -> (usize, f64) {
        let releases = (0..j).filter_map(|i| Some((i, self.release(i, j)?)));
        let likeliest = releases.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, odds)| *odds > 1.0);
        likeliest.map_or((0, 0.0), |(i, odds)| (1 + self.shadowed(i, j), odds))
    }

    /// The train with the most evidence; `None` for fewer than two sounds.
    pub fn best(&self) -> Option<BestTrain> {
        let n = self.sounds.len();
        let all = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
        let first: Vec<_> = all.map(|(i, j)| ((i, j), self.first(i, j))).collect();
        let mut table = vec![Evidence::NONE; n * n];
        for step in 0..=((1.0 / LEAST).ln() / STEP) as usize + GROWS {
            let log_r = STEP * (GROWS as f64 - step as f64);
            let (r, (value, _)) = (log_r.exp(), self.behind(log_r));
            for (pair, first) in &first {
                let at = pair.0 * n + pair.1;
                table[at].add(self.begin(*pair, *first, log_r, r) + value[at], log_r);
            }
        }
        let pairs = || (0..n * n).filter(|at| at / n < at % n);
        let evidence = |at: &usize| table[*at].all();
        let most = pairs().max_by(|a, b| evidence(a).total_cmp(&evidence(b)));
        let most = most.filter(|at| evidence(at).is_finite())?;
        // Trains that begin with different sounds of one impact are the same train.
        let same = |at: usize| {
            let apart = |i: usize, j: usize| (self.sounds[i].time - self.sounds[j].time).abs();
            let flights = (self.flight(at / n, at % n) - self.flight(most / n, most % n)).abs();
            apart(at / n, most / n) < SHADOW && flights < 6.0 * TIMING
        };
        let trains = pairs().filter(|at| *at != most && !same(*at));
        let trains = trains.map(|at| (evidence(&at), Rival::Train(at / n, at % n)));
        let falls = pairs().map(|at| (self.fall(at / n, at % n), Rival::Fall(at / n, at % n)));
        let rival = trains.chain(falls).max_by(|a, b| a.0.total_cmp(&b.0));
        let rival = rival.filter(|(score, _)| *score > evidence(&most) - ODDS.ln());
        let log_r = table[most].log_r;
        let train = self.follow(most / n, most % n, &self.behind(log_r).1);
        let ends = train.iter().skip(1).copied().chain([n]);
        let echoes = train.iter().zip(ends).map(|(j, k)| self.shadowed(*j, k)).sum();
        let expected = match train[..] {
            [.., j, k] => Some(self.next(j, k, log_r.exp()))
                .filter(|next| next.stands_out)
                .map(|next| self.sounds[k].time + next.flight),
            _ => None,
        };
        let rival = rival.map(|(_, rival)| rival);
        let (release, odds) = self.likeliest_release(train[0]);
        Some(BestTrain { train, log_r, rival, expected, echoes, release, odds })
    }

    /// The next impact as predicted from the pair `j`, `k` with the restitution `r`.
    fn next(&self, j: usize, k: usize, r: f64) -> Next {
        let flight = self.flight(j, k) * r;
        let range = (4.0 * spread(flight, SCATTER)).exp();
        let loud = self.sounds[k].height * r > HEARD * self.heard.reach;
        let within = self.sounds[k].time + flight * range < self.heard.ends.1;
        Next { flight, range, stands_out: loud && within }
    }

    /// Log-likelihood that `i` is the release and `j` the only impact that is heard. All R are equally likely
    /// on a logarithmic scale. The second impact is too quiet, merges with the first, or lies after the end
    /// of the record.
    fn fall(&self, i: usize, j: usize) -> f64 {
        let (Some(full), Some(release)) = (self.heard.full, self.release(i, j)) else {
            return f64::NEG_INFINITY;
        };
        let impact = self.sounds[j];
        let part = |r: f64| (r.clamp(LEAST, 1.0) / LEAST).ln() / (1.0 / LEAST).ln();
        let hidden = self.heard.pause.unwrap_or(SHADOW).max(SHADOW) / full;
        let low = part((HEARD * self.heard.reach / impact.height).max(hidden));
        let late = 1.0 - part((self.heard.ends.1 - impact.time) / full);
        let unheard = (low + late).min(1.0);
        let unheard = unheard + (1.0 - unheard) * (-ENDS).exp();
        let echoes = self.echo * self.shadowed(j, self.sounds.len()) as f64;
        release.ln() + unheard.ln() + echoes
    }

    /// Number of sounds between the impacts `j` and `k` that are echoes or ringing of `j`.
    fn shadowed(&self, j: usize, k: usize) -> usize {
        let impact = self.sounds[j];
        let near = self.sounds[j + 1..k].iter().take_while(|s| s.time < impact.time + SHADOW);
        near.filter(|s| s.height < QUIETER * impact.height).count()
    }

    fn flight(&self, j: usize, k: usize) -> f64 {
        self.sounds[k].time - self.sounds[j].time
    }

    /// Log-likelihood of the loudness of impact `k` after `j`.
    fn loudness(&self, j: usize, k: usize, log_r: f64) -> f64 {
        let z = (self.logs[k] - self.logs[j] - log_r) / LOUDNESS;
        -(0.5 * z * z).min(CAP) - (TURN * LOUDNESS).ln()
    }

    /// Log-likelihood of a flight that should last `expected`, both in s.
    fn timed(flight: f64, expected: f64, scatter: f64) -> f64 {
        let std = spread(expected, scatter);
        let z = (flight / expected).ln() / std;
        -0.5 * z * z - (TURN * std * flight).ln()
    }

    /// Terms of the first two impacts that do not depend on R: the log-likelihood of an arbitrary flight, and
    /// the sum of the others.
    fn first(&self, i: usize, j: usize) -> (f64, f64) {
        let any = -((FLIGHTS[1] / FLIGHTS[0]).ln() * self.flight(i, j)).ln();
        (any, self.released[i] - self.foreign + self.echo * self.shadowed(i, j) as f64)
    }

    /// Log-likelihood of the first two impacts with the restitution `r`.
    fn begin(&self, (i, j): (usize, usize), (any, rest): (f64, f64), log_r: f64, r: f64) -> f64 {
        let flight = self.flight(i, j);
        // This limit does not hold for evenly spaced sounds: they must be found, so that they do not pass
        // for bounces.
        let shrinks = log_r <= LARGEST.ln();
        if shrinks && self.sounds.len() > CLEAN && flight < LOWEST * r {
            return f64::NEG_INFINITY;
        }
        let timed = match self.heard.full {
            Some(full) => Self::timed(flight, full * r, FALL).max(any - CAP),
            None => any,
        };
        timed + self.loudness(i, j, log_r) + rest
    }

    /// For one R and each pair of impacts: the largest log-likelihood of the sounds after it, and the next
    /// impact, `usize::MAX` for none.
    fn behind(&self, log_r: f64) -> (Vec<f64>, Vec<usize>) {
        let n = self.sounds.len();
        let (mut value, mut next) = (vec![0.0; n * n], vec![usize::MAX; n * n]);
        let r = log_r.exp();
        let ends: Vec<f64> = (0..n).map(|k| self.echo * self.shadowed(k, n) as f64).collect();
        for j in (0..n).rev() {
            for k in j + 1..n {
                let Next { flight: expected, range, stands_out } = self.next(j, k, r);
                let begins = self.sounds[k].time + expected / range;
                let mut best = ends[k] - if stands_out { ENDS } else { 0.0 };
                let mut last = usize::MAX;
                for l in k + 1 + self.sounds[k + 1..].partition_point(|s| s.time < begins)..n {
                    let flight = self.flight(k, l);
                    if flight > expected * range {
                        break;
                    }
                    let gain =
                        Self::timed(flight, expected, SCATTER) + self.loudness(k, l, log_r) - self.foreign;
                    let score = gain + self.echo * self.shadowed(k, l) as f64 + value[k * n + l];
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
