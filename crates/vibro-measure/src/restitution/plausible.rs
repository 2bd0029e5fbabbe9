//! The most plausible train of bounces among sounds, and other explanations of the sounds.

use super::pairs::{BestTrain, FallRecord, LARGEST, ODDS, Pairs, Rival, SHADOW};
use crate::impacts::{QUIETER, Sound};
use vibro_record::sort_by_number;

/// Most sounds that are used, the loudest: the effort for trains grows as the square of their number.
const MOST: usize = 128;
/// Most even trains that are removed in the search for bounces: a record with more is that of a voice or a
/// machine.
const EVEN: usize = 4;
/// Foreign sounds expected beyond those counted: one record in five has a hand, a latch or a voice.
const UNHEARD: f64 = 0.2;

/// The most plausible train of bounces.
#[derive(Debug, Clone, PartialEq)]
pub struct Plausible {
    /// Its impacts, as indices of the sounds.
    pub impacts: Vec<usize>,
    /// Another explanation that is as plausible.
    pub rival: Option<Rival>,
    /// Time in s of the next impact, where it should be heard and the record goes on.
    pub expected: Option<f64>,
    /// Number of sounds that are echoes or ringing of its impacts.
    pub echoes: usize,
    /// Number of sounds that are surely the release, one fall before the first impact, or its echoes.
    pub release: usize,
    /// Whether its intervals do not shrink, as those of ringing, of a voice or of a machine.
    pub even: bool,
}

/// The most plausible train of two impacts or more; `None` for fewer than two sounds.
pub fn plausible(sounds: &[Sound], heard: FallRecord) -> Option<Plausible> {
    let mut order: Vec<usize> = (0..sounds.len()).collect();
    sort_by_number(&mut order, |a| -sounds[*a].height);
    order.truncate(MOST);
    order.sort_unstable();
    // Sounds at even intervals are a voice, a machine or ringing: bounces are sought among the rest.
    let mut even = None;
    for _ in 0..EVEN {
        let own: Vec<Sound> = order.iter().map(|i| sounds[*i]).collect();
        let Some(found) = best(&own, heard) else { break };
        // The intervals are checked, too: the grid of R ends, and trains may lie between its points.
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

/// Mean logarithm of the ratio of successive intervals of a train of four impacts or more; −∞ for fewer.
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

/// The best train, in two passes. Foreign sounds are first all that are no echoes of louder ones, then those
/// that no impact of the first train explains.
fn best(sounds: &[Sound], heard: FallRecord) -> Option<BestTrain> {
    let length = heard.ends.1 - heard.ends.0;
    let of = |count: usize| Pairs::new(sounds, heard, (count as f64 + UNHEARD) / length).best();
    let first = of(alone(sounds))?;
    let explained = first.train.len() + first.echoes + first.release;
    let found = of(sounds.len().saturating_sub(explained))?;
    let release = if found.odds > ODDS { found.release } else { 0 };
    Some(BestTrain { release, ..found })
}

/// Number of sounds that are not echoes: no louder sound precedes them within [`SHADOW`].
pub(super) fn alone(sounds: &[Sound]) -> usize {
    let alone = |(i, s): &(usize, &Sound)| {
        let mut before = sounds[..*i].iter().rev().take_while(|b| b.time > s.time - SHADOW);
        before.all(|b| s.height >= QUIETER * b.height)
    };
    sounds.iter().enumerate().filter(alone).count()
}

#[cfg(test)]
mod tests {
    use super::super::pairs::{LOWEST, STEP};
    use super::*;

    /// Three bounces of R 0.8 from 0.5 m, and after them the pitch of a voice, 7.7 ms apart, whose intervals
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
        // The pulses of the voice contain trains, and each of them has a rival.
        let refused = |train: Plausible| train.even || train.rival.is_some() || train.impacts.len() == 2;
        assert!(plausible(&voice, heard).is_none_or(refused));
        let found = plausible(&sounds, heard).unwrap();
        assert_eq!(found.impacts, [0, 1, 2], "{found:?}");
    }

    /// A voice of falling pitch: 24 sounds whose intervals shrink from 9 ms by 0.96 each, as after a fall of
    /// 0.1 mm.
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
        // A record of twelve sounds may begin within a train.
        assert_eq!(plausible(&sounds[..12], heard).unwrap().impacts.len(), 12);
    }

    /// Sounds of a fall of 0.3 s: the release with this height, an impact at 1 s, and others by time in s
    /// and height.
    fn fall(release: f64, others: &[(f64, f64)]) -> (Vec<Sound>, FallRecord) {
        let all = [(0.7, release), (1.0, 1.0)].into_iter().chain(others.iter().copied());
        let sounds = all.map(|(time, height)| Sound { time, height }).collect();
        let heard = FallRecord { reach: 0.01, median: 0.3, ends: (0.0, 3.0), full: Some(0.6), pause: None };
        (sounds, heard)
    }

    #[test]
    fn a_release_is_no_impact_though_the_fall_is_half_a_full_flight() {
        // R 0.25, but the fall looks like a flight of R 0.5: it is half of the full flight, and the first
        // flight half of it.
        let (sounds, heard) = fall(0.2, &[(1.15, 0.25), (1.1875, 0.06)]);
        let found = plausible(&sounds, heard).unwrap();
        assert_eq!((&found.impacts[..], found.rival, found.release), (&[1, 2, 3][..], None, 1), "{found:?}");
        // With a body that does not bounce only the release and the impact are heard.
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
        // R 0.6: the third impact comes 0.36 · 0.6 s after the second, and has 0.36 of the height.
        let found = plausible(&sounds, heard).unwrap();
        let expected = found.expected.unwrap();
        assert!((expected - 1.576).abs() < STEP * 0.216, "{expected}");
        // No impact is expected where the record ends before it, or where noise would hide it.
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
