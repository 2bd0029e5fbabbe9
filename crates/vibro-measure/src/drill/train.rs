//! The turns of a machine without a reference: a train of impacts, one in each period of their pattern.

use super::Impact;
use vibro_record::{Error, Result, median};

/// Fewest impacts that show a period: four turns, the fewest that have an uncertainty.
const FEWEST: usize = 5;
/// Most impacts of one direction in a period of the pattern.
const PATTERN: f64 = 8.0;
/// Largest strength of an impact in the search, over the median strength: the strongest may be a fault of the
/// instrument.
const OUTLIER: f64 = 2.0;
/// An impact repeats if another comes one period later, within this fraction of the period.
const NEAR: f64 = 0.1;
/// The repeated impact must also come within this fraction of the median interval.
const BETWEEN: f64 = 0.25;
/// Standard deviations of chance that are subtracted from an agreement, because many lags are tried.
const CHANCE: f64 = 2.0;
/// Least agreement of a common period: one in a hundred trains at random reaches it.
const COMMON: f64 = 0.4;
/// The period is the first lag with this fraction of the best agreement: multiples of the period agree as
/// well.
const FIRST: f64 = 0.9;
/// Neighbours in a train are whole periods apart, within this fraction of a period.
const UNEVEN: f64 = 0.2;
/// Neighbours more than this many periods apart lie before and after a pause of the machine.
const PAUSE: f64 = 4.0;

/// The impacts that begin the turns, in samples.
pub(super) struct TurnImpacts {
    pub at: Vec<f64>,
    /// Root mean square of the standard uncertainties of their instants, in samples.
    pub std: f64,
    /// Further impacts of the same direction, which begin no turn.
    pub others: usize,
}

impl TurnImpacts {
    /// Selects, from all impacts of a record sampled `rate` times a second, those of the stronger direction
    /// that follow each other at multiples of their period.
    ///
    /// # Errors
    /// If there are too few, or they have no common period.
    pub fn of(impacts: &[Impact], rate: f64) -> Result<TurnImpacts> {
        let refused = |why: String| {
            let hint =
                "name the channel of a crank pulse; or check the velocity channel and the longest contact";
            let error = Error::refused(why).hint(hint);
            Err(["reference", "velocity", "contact"].into_iter().fold(error, Error::setting))
        };
        let jump = |i: &Impact| i.after - i.before;
        let up = impacts.iter().map(|i| jump(i) * jump(i).abs()).sum::<f64>() > 0.0;
        let own: Vec<&Impact> = impacts.iter().filter(|i| (jump(i) > 0.0) == up).collect();
        if own.len() < FEWEST {
            let found = format!(
                "{} impacts of one direction: too few to tell the turns without a reference",
                own.len()
            );
            return refused(found);
        }
        let most = OUTLIER * median(own.iter().map(|i| jump(i).abs()));
        let events: Vec<(f64, f64)> = own.iter().map(|i| (i.time * rate, jump(i).abs().min(most))).collect();
        let chosen = period(&events).map(|period| chain(&events, period)).unwrap_or_default();
        if chosen.len() < FEWEST {
            return refused(format!("{} impacts have no common period: there are no turns", own.len()));
        }
        let squares: f64 =
            chosen.iter().filter_map(|k| own[*k].time_std).map(|std| (std * rate).powi(2)).sum();
        Ok(TurnImpacts {
            at: chosen.iter().map(|k| events[*k].0).collect(),
            std: (squares / chosen.len() as f64).sqrt(),
            others: own.len() - chosen.len(),
        })
    }
}

/// Share of the strength of the events (instant in samples, strength) that repeats one `lag` in samples
/// later, beyond the share expected at random: near 1 if all of many events repeat; chance may give less
/// than 0. The second value is the median time in samples from an event to its repetition.
fn agreement(events: &[(f64, f64)], lag: f64) -> (f64, f64) {
    let (first, last) = (events[0].0, events[events.len() - 1].0);
    let reach = (NEAR * lag).min(BETWEEN * median(events.windows(2).map(|e| e[1].0 - e[0].0)));
    let starts = || events.iter().take_while(|e| e.0 + lag - reach < last);
    let (mut again, mut all, mut times) = (0.0, 0.0, Vec::new());
    for (at, strength) in starts() {
        let behind = events.partition_point(|e| e.0 < at + lag);
        let near = [behind.wrapping_sub(1), behind].into_iter().filter_map(|k| events.get(k));
        let nearest = near.min_by(|a, b| (a.0 - at - lag).abs().total_cmp(&(b.0 - at - lag).abs()));
        all += strength;
        if let Some(next) = nearest.filter(|e| (e.0 - at - lag).abs() < reach) {
            again += strength.min(next.1);
            times.push(next.0 - at);
        }
    }
    let chance = 1.0 - (-2.0 * reach * (events.len() - 1) as f64 / (last - first)).exp();
    let scatter = (chance * (1.0 - chance) / starts().count() as f64).sqrt();
    ((again / all - chance - CHANCE * scatter) / (1.0 - chance), median(times))
}

/// The shortest time in samples after which the pattern of events repeats; `None` if none repeats.
fn period(events: &[(f64, f64)]) -> Option<f64> {
    let steps = || events.windows(2).map(|e| e[1].0 - e[0].0).filter(|step| *step > 0.0);
    let shortest = steps().fold(f64::INFINITY, f64::min);
    // The mean interval is used: for impacts in bursts, the median would be the interval within a burst.
    let mean = (events[events.len() - 1].0 - events[0].0) / (events.len() - 1) as f64;
    let longest = (PATTERN * mean).min(0.5 * (events[events.len() - 1].0 - events[0].0));
    let grid = std::iter::successors(Some(shortest), |lag| Some(lag * (1.0 + 0.5 * NEAR)));
    let tried: Vec<(f64, f64)> =
        grid.take_while(|lag| *lag < longest * (1.0 + NEAR)).map(|lag| agreement(events, lag)).collect();
    let best = tried.iter().fold(0.0f64, |best, lag| best.max(lag.0));
    let first = tried.into_iter().find(|lag| lag.0 >= FIRST * best)?;
    // Compute the agreement again at the median time between repeated events.
    let (agreed, period) = agreement(events, first.1);
    (agreed > COMMON).then_some(period)
}

/// Indices of the strongest chain of events that are whole periods apart, or separated by a pause. The
/// farther an event is from a whole number of periods, the less it counts.
fn chain(events: &[(f64, f64)], period: f64) -> Vec<usize> {
    // For each event the strength of the best chain that ends with it, and the event before.
    let mut best: Vec<(f64, Option<usize>)> = Vec::with_capacity(events.len());
    let better = |a: (f64, Option<usize>), b: (f64, Option<usize>)| if b.0 > a.0 { b } else { a };
    // The best chain before a pause, and the first event after it.
    let (mut paused, mut recent) = ((0.0, None), 0);
    for (at, strength) in events {
        let steps = |k: usize| (at - events[k].0) / period;
        while steps(recent) > PAUSE {
            paused = better(paused, (best[recent].0, Some(recent)));
            recent += 1;
        }
        let even = |k: usize| 1.0 - ((steps(k) - steps(k).round().max(1.0)) / UNEVEN).powi(2);
        let follows = (recent..best.len()).filter(|k| even(*k) > 0.0);
        let follows = follows.map(|k| (best[k].0 + even(k) * strength, Some(k)));
        best.push(follows.fold((paused.0 + strength, paused.1), better));
    }
    let ends = best.iter().enumerate().map(|(k, end)| (end.0, Some(k)));
    let last = ends.fold((0.0, None), better).1;
    let mut chosen: Vec<usize> = std::iter::successors(last, |k| best[*k].1).collect();
    chosen.reverse();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;
    use vibro_record::sort_by_number;

    /// Impacts from (instant, jump) at one sample a second.
    fn train(mut of: Vec<(f64, f64)>) -> Result<TurnImpacts> {
        sort_by_number(&mut of, |a| a.0);
        let impact = |(time, after): (f64, f64)| Impact {
            cycle: 0,
            group: 0,
            time,
            time_std: Some(0.5),
            phase: 0.0,
            phase_std: Some(0.0),
            first_contact: 0.0,
            first_contact_std: Some(0.0),
            before: 0.0,
            before_std: Some(0.0),
            after,
            after_std: Some(0.0),
            clipped: false,
        };
        TurnImpacts::of(&of.into_iter().map(impact).collect::<Vec<_>>(), 1.0)
    }

    /// Impacts of −7 ± 0.3 in 60 turns; the first turn takes 1000 samples, the last 6 % more, each ± 1 %.
    fn slowing(noise: &mut Noise) -> Vec<(f64, f64)> {
        let mut at = 300.0;
        let mut next = |k: u32| {
            at += 1000.0 + f64::from(k) + 10.0 * noise.normal();
            (at, -7.0 + 0.3 * noise.normal())
        };
        (0..60).map(&mut next).collect()
    }

    #[test]
    fn missing_and_false_impacts_and_others_of_a_pattern_move_no_turn() {
        let mut noise = Noise::new(5);
        for _ in 0..40 {
            let whole = slowing(&mut noise);
            let kept: Vec<(f64, f64)> = (0..60).filter(|k| k % 9 != 4).map(|k| whole[k]).collect();
            let truth: Vec<f64> = kept.iter().map(|e| e.0).collect();
            // False impacts at any time: of any strength up to that of the others, and one ten times
            // stronger.
            let wrong = |k| (61_000.0 * noise.uniform(), if k == 0 { -70.0 } else { -7.0 * noise.uniform() });
            let with: Vec<(f64, f64)> = (0..8).map(wrong).chain(kept.iter().copied()).collect();
            let found = train(with).unwrap();
            let same = found.at.iter().filter(|at| truth.contains(at)).count();
            // A false impact may replace a missing one, and the strong one its neighbour.
            assert!(same + 1 >= truth.len() && found.at.len() <= same + 2 && found.std == 0.5);
            // A catch at the rear, in the other direction; a second impact a turn as strong; one half a turn
            // later and weaker.
            for (part, jump) in [(0.5, 6.0), (0.3, -7.0), (0.5, -4.5)] {
                let second = whole.iter().map(|e| (e.0 + 1000.0 * part, jump));
                let found = train(whole.iter().copied().chain(second).collect()).unwrap();
                let steps: Vec<f64> = found.at.windows(2).map(|e| e[1] - e[0]).collect();
                assert!(steps.len() == 59 && steps.iter().all(|s| (s / 1030.0 - 1.0).abs() < 0.1), "{part}");
                assert_eq!(found.others, if jump < 0.0 { 60 } else { 0 });
            }
        }
    }

    #[test]
    fn impacts_at_random_have_no_period() {
        let mut noise = Noise::new(6);
        for n in [6, 10, 20, 60, 200] {
            let random = (0..400).filter(|_| {
                let one = |_| (1e4 * noise.uniform(), -7.0 + 0.5 * noise.normal());
                train((0..n).map(one).collect()).is_ok()
            });
            let share = random.count() as f64 / 400.0;
            println!("{n} impacts at random: {:.1} % have a period", 100.0 * share);
            assert!(share < 0.03, "{n}: {share}");
        }
        assert!(
            train(vec![(0.0, -7.0), (1000.0, -7.0), (2000.0, -7.0), (3000.0, -7.0)]).is_err()
                && train(Vec::new()).is_err()
        );
    }
}
