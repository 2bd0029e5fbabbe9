//! Measuring methods: how long an answer takes, and which are on the front.

use std::hint::black_box;
use std::time::Instant;

use super::{Family, Measured};

/// Shortest time worth reading from the clock, in ns: short answers are repeated until they fill it.
const READABLE: f64 = 20_000.0;
/// Most time spent on one method of one scene, in ns: in full, and quick.
const SPENT: [f64; 2] = [400e6, 30e6];
/// Runs from which quartiles are told.
const FEW: usize = 3;

/// Runs `f` up to `repeats` times: its answer, the median time of one run in ns, and the quartiles.
///
/// A run shorter than what the clock can tell is measured several at a time. A slow one is repeated less often: from the fourth run on
/// no more than 0.4 s are spent on it, 0.03 s where `quick`. One that takes longer than that by itself is run once, and has no quartiles.
pub fn timed<T>(repeats: usize, quick: bool, mut f: impl FnMut() -> T) -> (T, f64, Option<[f64; 2]>) {
    let mut clock = |runs: usize| {
        let start = Instant::now();
        for _ in 1..runs {
            black_box(f());
        }
        let answer = black_box(f());
        (answer, start.elapsed().as_secs_f64() * 1e9 / runs as f64)
    };
    // The first run also warms the caches; it counts only where it is the only one.
    let (mut answer, first) = clock(1);
    let runs = (READABLE / first.max(1.0)).ceil() as usize;
    let mut left = SPENT[usize::from(quick)] - first;
    let mut times = Vec::with_capacity(repeats);
    if left > 0.0 {
        while times.len() < repeats && (times.len() < FEW || left > first * runs as f64) {
            let (again, time) = clock(runs);
            answer = again;
            left -= time * runs as f64;
            times.push(time);
        }
    }
    if times.len() < FEW {
        let all = times.is_empty().then_some(first).into_iter().chain(times);
        return (answer, quartiles(&mut all.collect::<Vec<_>>())[1], None);
    }
    let [low, median, high] = quartiles(&mut times);
    (answer, median, Some([low, high]))
}

/// Lower quartile, median and upper quartile; none of an empty list is asked for.
pub fn quartiles(values: &mut [f64]) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    let at = |part: f64| {
        let place = part * (values.len() - 1) as f64;
        let low = place.floor() as usize;
        let high = (low + 1).min(values.len() - 1);
        values[low] + (values[high] - values[low]) * (place - low as f64)
    };
    [at(0.25), at(0.5), at(0.75)]
}

/// Errors that differ by less than this part are told apart by rounding, and by no chart.
const TIE: f64 = 1e-3;

/// Marks those than which no other is both faster and more accurate (the Pareto front); none that failed.
///
/// Errors within a thousandth of each other are the same, and the faster of two is on the front.
///
/// A setting of a model is the model's own choice; that of an estimator is the record, and only answers to the same record compete.
pub fn front(family: Family, methods: &mut [Measured]) {
    let reached = |m: &Measured| m.error.filter(|e| !m.failed && e.is_finite());
    let beats = |a: &Measured, b: &Measured| match (reached(a), reached(b)) {
        (Some(e), Some(error)) => {
            let clearly = e < error * (1.0 - TIE);
            (clearly || e <= error * (1.0 + TIE))
                && a.time_ns <= b.time_ns
                && (clearly || a.time_ns < b.time_ns)
        }
        _ => false,
    };
    let competes = |a: &Measured, b: &Measured| family == Family::Models || a.setting == b.setting;
    let marked: Vec<bool> = methods
        .iter()
        .map(|m| reached(m).is_some() && !methods.iter().any(|other| competes(other, m) && beats(other, m)))
        .collect();
    for (method, front) in methods.iter_mut().zip(marked) {
        method.front = front;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(error: Option<f64>, time_ns: f64) -> Measured {
        Measured {
            method: String::new(),
            setting: String::new(),
            ours: false,
            error,
            error_spread: None,
            time_ns,
            time_spread: None,
            failed: error.is_none(),
            why: None,
            front: false,
        }
    }

    #[test]
    fn the_front_holds_what_nothing_beats_in_both() {
        let mut all = [at(Some(1e-3), 1.0), at(Some(1e-6), 5.0), at(Some(1e-5), 6.0), at(None, 0.1)];
        front(Family::Models, &mut all);
        assert_eq!(all.map(|m| m.front), [true, true, false, false]);
    }

    #[test]
    fn of_two_errors_that_only_rounding_tells_apart_the_faster_is_on_the_front() {
        let [fast, slow] = [5.203_620_391_064_66, 5.203_620_391_064_653];
        let mut all = [at(Some(fast), 1.0), at(Some(slow), 408.0), at(Some(5.1), 408.0)];
        front(Family::Models, &mut all);
        assert_eq!(all.map(|m| m.front), [true, false, true]);
    }

    #[test]
    fn estimators_compete_on_the_same_record_only() {
        let of = |setting: &str, error, time| Measured { setting: setting.into(), ..at(error, time) };
        let mut all = [
            of("0 dB", Some(1e-1), 9.0),
            of("60 dB", Some(1e-6), 8.0),
            of("0 dB", Some(1e-1), 10.0),
            of("60 dB", None, 1.0),
        ];
        front(Family::Estimators, &mut all);
        assert_eq!(all.clone().map(|m| m.front), [true, true, false, false]);
        front(Family::Models, &mut all);
        assert_eq!(all.map(|m| m.front), [false, true, false, false]);
    }

    #[test]
    fn quartiles_of_five_are_its_second_third_and_fourth() {
        assert_eq!(quartiles(&mut [5.0, 1.0, 4.0, 2.0, 3.0]), [2.0, 3.0, 4.0]);
        assert_eq!(quartiles(&mut [7.0]), [7.0; 3]);
    }

    #[test]
    fn a_run_too_short_for_the_clock_is_measured_many_at_a_time() {
        let mut runs = 0_usize;
        let (answer, median, spread) = timed(3, true, || {
            runs += 1;
            7
        });
        assert_eq!(answer, 7);
        assert!(runs > 3, "{runs}");
        let [low, high] = spread.unwrap();
        assert!(low <= median && median <= high);
    }

    #[test]
    fn a_run_longer_than_what_may_be_spent_is_run_once() {
        let mut runs = 0;
        let ((), median, spread) = timed(20, true, || {
            runs += 1;
            std::thread::sleep(std::time::Duration::from_millis(31));
        });
        assert_eq!((runs, spread), (1, None));
        assert!(median >= 31e6, "{median}");
    }
}
