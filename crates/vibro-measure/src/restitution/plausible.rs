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
pub const SCATTER: f64 = 0.02;
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
/// One record in five has the sound of the release that begins the fall.
const RELEASES: f64 = 0.2;
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
    /// Shortest time between two impacts, in s, where it is stated.
    pub pause: Option<f64>,
}

/// The most plausible train of bounces.
#[derive(Debug, Clone, PartialEq)]
pub struct Plausible {
    /// Its impacts, as places in the sounds.
    pub impacts: Vec<usize>,
    /// What else is as plausible.
    pub rival: Option<Rival>,
    /// When the next impact is expected, in s, where it would stand out and the record goes on.
    pub expected: Option<f64>,
    /// Sounds that are echoes or ringing of its impacts.
    pub echoes: usize,
    /// Sounds that are surely the release, one fall before the first impact, and what echoes it.
    pub release: usize,
    /// Whether its intervals do not shrink, as those of ringing, of a voice or of a machine.
    pub even: bool,
}

/// What the sounds are if they are not the bounces of the most plausible train.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rival {
    /// First two impacts of another train.
    Train(usize, usize),
    /// The release and the only impact that is heard: what lies between them is the fall.
    Fall(usize, usize),
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
            rival: found.rival.map(|rival| match rival {
                Rival::Train(i, j) => Rival::Train(order[i], order[j]),
                Rival::Fall(i, j) => Rival::Fall(order[i], order[j]),
            }),
            expected: found.expected,
            echoes: found.echoes,
            release: found.release,
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
    let explained = first.train.len() + first.echoes + first.release;
    let found = of(sounds.len().saturating_sub(explained))?;
    let release = if found.odds > ODDS { found.release } else { 0 };
    Some(BestTrain { release, ..found })
}

/// How many sounds no louder one precedes within the time of its echoes.
fn alone(sounds: &[Sound]) -> usize {
    let alone = |(i, s): &(usize, &Sound)| {
        let mut before = sounds[..*i].iter().rev().take_while(|b| b.time > s.time - SHADOW);
        before.all(|b| s.height >= QUIETER * b.height)
    };
    sounds.iter().enumerate().filter(alone).count()
}

/// Standard deviation of the logarithm of a flight behind another.
fn scatter(expected: f64) -> f64 {
    SCATTER.hypot(6f64.sqrt() * TIMING / expected)
}

/// ln(eᵃ + eᵇ).
fn added(a: f64, b: f64) -> f64 {
    let most = a.max(b);
    if most == f64::NEG_INFINITY { most } else { most + ((a - most).exp() + (b - most).exp()).ln() }
}

/// A train with its ln R, what else is as plausible, when its next impact is expected, and how many sounds
/// are its echoes or its release.
struct BestTrain {
    train: Vec<usize>,
    log_r: f64,
    rival: Option<Rival>,
    expected: Option<f64>,
    echoes: usize,
    release: usize,
    /// How much more likely it is that these are the release than that they are foreign.
    odds: f64,
}

/// What every pair of sounds is, whatever R is.
struct Pairs<'a> {
    sounds: &'a [Sound],
    heard: FallRecord,
    /// Rate of foreign sounds in 1/s.
    rate: f64,
    /// Its logarithm, over that of heights.
    foreign: f64,
    /// What an echo explains.
    echo: f64,
    logs: Vec<f64>,
    /// What a sound of the release before a first impact tells, for each sound that may be that impact.
    released: Vec<f64>,
}

impl Pairs<'_> {
    fn new(sounds: &[Sound], heard: FallRecord, rate: f64) -> Pairs<'_> {
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

    /// How much more likely it is that `i` and its echoes are the release before the first impact `j` than
    /// foreign; `None` where the height of the fall is not known.
    fn release(&self, i: usize, j: usize) -> Option<f64> {
        let fall = 0.5 * self.heard.full?;
        let echoes = self.echo * self.shadowed(i, j) as f64;
        Some(RELEASES / self.rate * (Self::timed(self.flight(i, j), fall, FALL) + echoes).exp())
    }

    /// Sounds that are likely the release before the first impact `j` and its echoes, and the odds of it.
    fn likeliest_release(&self, j: usize) -> (usize, f64) {
        let releases = (0..j).filter_map(|i| Some((i, self.release(i, j)?)));
        let likeliest = releases.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, odds)| *odds > 1.0);
        likeliest.map_or((0, 0.0), |(i, odds)| (1 + self.shadowed(i, j), odds))
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
        let trains = pairs().filter(|at| *at != most);
        let trains = trains.map(|at| (evidence(&at), Rival::Train(at / n, at % n)));
        let falls = pairs().map(|at| (self.fall(at / n, at % n), Rival::Fall(at / n, at % n)));
        let rival = trains.chain(falls).max_by(|a, b| a.0.total_cmp(&b.0));
        let rival = rival.filter(|(told, _)| *told > evidence(&most) - ODDS.ln());
        let log_r = told[most].2;
        let train = self.follow(most / n, most % n, &self.behind(log_r).1);
        let ends = train.iter().skip(1).copied().chain([n]);
        let echoes = train.iter().zip(ends).map(|(j, k)| self.shadowed(*j, k)).sum();
        let expected = match train[..] {
            [.., j, k] => Some(self.expected(j, k, log_r)).filter(|(_, stands_out)| *stands_out),
            _ => None,
        };
        let expected = expected.map(|(flight, _)| self.sounds[train[train.len() - 1]].time + flight);
        let rival = rival.map(|(_, rival)| rival);
        let (release, odds) = self.likeliest_release(train[0]);
        Some(BestTrain { train, log_r, rival, expected, echoes, release, odds })
    }

    /// The flight that is expected behind a pair of impacts, in s, and whether the impact at its end would
    /// stand out within the record.
    fn expected(&self, j: usize, k: usize, log_r: f64) -> (f64, bool) {
        let expected = self.flight(j, k) * log_r.exp();
        let latest = self.sounds[k].time + expected * (4.0 * scatter(expected)).exp();
        let loud = self.sounds[k].height * log_r.exp() > HEARD * self.heard.reach;
        (expected, loud && latest < self.heard.ends.1)
    }

    /// The evidence that `i` is the release and `j` the only impact that is heard: R is evenly likely on a
    /// logarithmic scale, and the second impact is quieter than what stands out, is heard as the end of the
    /// first, or comes behind the end of the record.
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
        timed + self.loudness(i, j, log_r) - self.foreign
            + self.echo * self.shadowed(i, j) as f64
            + self.released[i]
    }

    /// What follows each pair of impacts at its best, and the next impact, for one R.
    fn behind(&self, log_r: f64) -> (Vec<f64>, Vec<usize>) {
        let n = self.sounds.len();
        let (mut value, mut next) = (vec![0.0; n * n], vec![usize::MAX; n * n]);
        for j in (0..n).rev() {
            for k in j + 1..n {
                let (expected, stands_out) = self.expected(j, k, log_r);
                let range = (4.0 * scatter(expected)).exp();
                let (from, to) = (expected / range, expected * range);
                let time = self.sounds[k].time;
                let mut best = self.echo * self.shadowed(k, n) as f64 - if stands_out { ENDS } else { 0.0 };
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
        let heard = FallRecord { reach: 0.01, median: 0.9, ends: (0.0, 4.0), full: None, pause: None };
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
        let heard = FallRecord { reach: 0.01, median: 0.7, ends: (0.0, 3.0), full: None, pause: None };
        let of_ball = |train: &Plausible| {
            let flights: Vec<f64> =
                train.impacts.windows(2).map(|w| sounds[w[1]].time - sounds[w[0]].time).collect();
            flights[0] >= LOWEST * (flights[flights.len() - 1] / flights[0]).min(0.9)
        };
        assert!(plausible(&sounds, heard).is_none_or(|train| train.even || of_ball(&train)));
        // A record of a dozen that begins within a train.
        assert_eq!(plausible(&sounds[..12], heard).unwrap().impacts.len(), 12);
    }

    /// A fall of 0.3 s whose release is heard, an impact at 1 s, and others by time and height.
    fn fall(release: f64, others: &[(f64, f64)]) -> (Vec<Sound>, FallRecord) {
        let all = [(0.7, release), (1.0, 1.0)].into_iter().chain(others.iter().copied());
        let sounds = all.map(|(time, height)| Sound { time, height }).collect();
        let heard = FallRecord { reach: 0.01, median: 0.3, ends: (0.0, 3.0), full: Some(0.6), pause: None };
        (sounds, heard)
    }

    #[test]
    fn a_release_is_no_impact_though_the_fall_is_half_a_full_flight() {
        // R 0.25: the fall and the first flight shrink by one half, as the height says of R, too.
        let (sounds, heard) = fall(0.2, &[(1.15, 0.25), (1.1875, 0.06)]);
        let found = plausible(&sounds, heard).unwrap();
        assert_eq!((&found.impacts[..], found.rival, found.release), (&[1, 2, 3][..], None, 1), "{found:?}");
        // Of a body that does not bounce only the release and the impact are heard.
        let (sounds, heard) = fall(0.2, &[]);
        assert_eq!(plausible(&sounds, heard).unwrap().rival, Some(Rival::Fall(0, 1)));
        // A body of R 0.5 has a third impact, and more.
        let half = [(1.3, 0.5), (1.45, 0.25), (1.525, 0.125)].map(|(time, height)| Sound { time, height });
        let sounds = [&[Sound { time: 1.0, height: 1.0 }][..], &half].concat();
        let found = plausible(&sounds, heard).unwrap();
        assert_eq!((found.impacts.len(), found.rival, found.release), (4, None, 0), "{found:?}");
    }

    #[test]
    fn the_next_impact_is_expected_where_it_would_stand_out() {
        let (sounds, heard) = fall(0.2, &[(1.36, 0.6)]);
        // R 0.6: the third comes 0.36 · 0.6 s behind the second, and has 0.36 of the height.
        let found = plausible(&sounds, heard).unwrap();
        let expected = found.expected.unwrap();
        assert!((expected - 1.576).abs() < STEP * 0.216, "{expected}");
        // Where the record ends before, and where it would drown in noise, it is not.
        let short = FallRecord { ends: (0.0, 1.5), ..heard };
        assert_eq!(plausible(&sounds, short).unwrap().expected, None);
        assert_eq!(plausible(&sounds, FallRecord { reach: 0.15, ..heard }).unwrap().expected, None);
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
