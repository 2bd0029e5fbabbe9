//! Benchmark scene: chaotic motion at one point of a chaotic frequency window; methods are compared by mean
//! and deviation of the approach speeds, since no two computations agree on the motion for long.

use super::super::rivals::{self as by, IntegratorKind, Locate, events};
use super::super::task::{Log, Task};
use super::{NO_SETTING, Setup, Verdict};
use crate::{BenchmarkScene, Family};
use rayon::prelude::*;
use vibro_model::Rig;
use vibro_record::Result;

/// Restitution, force in N and frequency in Hz of a motion that stays chaotic for 200 000 cycles: no method
/// can follow it, but all can give its statistics.
const POINT: (f64, f64, f64) = (0.97, 0.3, 5.61);
/// Cycles left out at the beginning, and cycles after them that enter the statistics of every method.
const SETTLE: f64 = 100.0;
const CYCLES: f64 = 4000.0;
/// Number of starts from which the truth is computed; no method starts from them.
const TRUTH_STARTS: usize = 10;
/// Error in standard errors above which the statistics count as those of another motion. With a scatter
/// estimated from ten starts, chance exceeds it in one of 300 cases.
const LARGEST_ERROR: f64 = 4.0;

/// The task of the scene: the motion that starts with mass 1 at `x1` (m), all else at rest, over this many
/// cycles after the first [`SETTLE`].
fn chaotic_task(x1: f64, cycles: f64) -> Task {
    let (restitution, force, frequency) = POINT;
    let rig = Rig { restitution, ..Rig::thesis() };
    let at_rest = Task::sine(rig, force, frequency, (SETTLE + cycles) / frequency);
    Task { start: [x1, 0.0, 0.0, 0.0], ..at_rest }
}

/// Mean and standard deviation of the approach speeds in m/s.
fn statistics(log: &Log) -> [f64; 2] {
    moments(log.impacts.iter().filter(|i| i.0 > SETTLE / POINT.2).map(|i| i.1))
}

/// Mean and sample standard deviation.
fn moments(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    [mean, (values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt()]
}

/// The statistics of each start of the truth, by integration of order 8 with a tight tolerance. No method
/// uses these starts, so the truth contains no run of a method.
fn truth_runs() -> Result<Vec<[f64; 2]>> {
    let statistics_from = |start: usize| {
        let task = chaotic_task(-1e-4 * (start + 1) as f64, CYCLES);
        Ok(statistics(&events(&task, None, IntegratorKind::Dop853(1e-12), Locate::Dense)?))
    };
    (0..TRUTH_STARTS).into_par_iter().map(statistics_from).collect()
}

/// The scene with its judge and its methods.
pub(super) fn scene() -> Result<Setup> {
    let runs = truth_runs()?;
    let truth = [0, 1].map(|i| moments(runs.iter().map(|run| run[i])));
    // Relative standard error of the difference between a method's statistics and the truth.
    let scatter = truth.map(|[mean, std]| std / mean * (1.0 + 1.0 / TRUTH_STARTS as f64).sqrt());
    let judge = move |log: &[Log]| -> Verdict {
        let found = statistics(&log[0]);
        let error = [0, 1].map(|i| (found[i] / truth[i][0] - 1.0).abs());
        // A statistic that is NaN fails, too.
        if let Some(i) = (0..2).find(|i| error[*i].is_nan() || error[*i] > LARGEST_ERROR * scatter[*i]) {
            let (name, part) = (["mean", "standard deviation"][i], 100.0 * error[i]);
            return Err(format!(
                "the {name} of the approach speeds is {part:.1} % off: those of another motion"
            ));
        }
        // The error of a method is never given below one standard error of the statistic, since that much
        // is sampling scatter.
        Ok((0..2).map(|i| error[i].max(scatter[i])).fold(0.0, f64::max))
    };
    let (restitution, force, frequency) = POINT;
    let [mean, std] = scatter.map(|s| 100.0 * s);
    let texts = [
        "chaotic window".to_owned(),
        format!(
            "At R {restitution}, {force} N and {frequency} Hz no two computations agree for long: mean and standard deviation of the \
     approach speeds over {CYCLES} cycles, whose standard errors are {mean:.1} and {std:.1} %. Below them errors are chance, and told as \
     them; beyond {LARGEST_ERROR} of them it is another motion."
        ),
        "larger relative error of mean and deviation".to_owned(),
        format!(
            "order 8, tolerance 1e-12, from {TRUTH_STARTS} other starts; standard errors from their scatter"
        ),
    ];
    // Settings by method: steps per cycle, tolerance, or contact stiffness in N/m.
    let methods = vec![
        (by::FLIGHTS, NO_SETTING),
        (by::EULER, &[100.0, 1e3]),
        (by::RK4_LOOP, &[100.0, 1e3]),
        (by::MOREAU, &[100.0, 1e3]),
        (by::RK45_ENDS, &[1e-3, 1e-6, 1e-9]),
        (by::DOP853_DENSE, &[1e-6, 1e-9]),
        (by::ROUGH_SPRING, &[1e6]),
    ];
    let (scene, tasks) = (BenchmarkScene::new(Family::Models, texts), vec![chaotic_task(0.0, CYCLES)]);
    Ok(Setup { scene, tasks, methods, judge: Box::new(judge) })
}

#[cfg(test)]
mod tests {
    use super::super::super::ours;
    use super::*;

    #[test]
    fn the_window_stays_irregular() {
        let log = ours::flights(&chaotic_task(0.0, 20_000.0)).unwrap();
        let mut last: Vec<f64> = log.impacts.iter().rev().take(1000).map(|i| i.1).collect();
        last.sort_by(f64::total_cmp);
        // A motion that repeats after fewer than 500 impacts has every speed at least twice.
        last.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        assert!(last.len() > 990, "{}", last.len());
    }

    /// A start that led to another motion than the others would have different statistics.
    #[test]
    fn other_starts_scatter_alike() {
        let all = truth_runs().unwrap();
        for i in 0..2 {
            let [mean, std] = moments(all.iter().map(|run| run[i]));
            // None of n = 10 numbers can deviate from their mean by more than (n − 1)/√n = 2.85 of their
            // sample standard deviations; 2.6 is rare.
            assert!(all.iter().all(|run| (run[i] - mean).abs() < 2.6 * std), "{all:?}");
        }
    }

    #[test]
    fn moments_of_four_numbers() {
        let [mean, std] = moments([1.0, 2.0, 3.0, 6.0].into_iter());
        assert!((mean - 3.0).abs() < 1e-15 && (std - (14.0_f64 / 3.0).sqrt()).abs() < 1e-15);
    }
}
