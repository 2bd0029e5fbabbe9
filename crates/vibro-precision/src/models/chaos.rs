//! A chaotic window: no method can follow the motion, all can be asked for its statistics.

use super::entry::{Entries, Verdict};
use super::ours;
use super::rivals::{Events, Kind, Loop, events, marched, moreau, penalty};
use super::scene_b::{spring, steps};
use super::task::{Task, Told};
use crate::{Family, Scene};
use rayon::prelude::*;
use vibro_model::{Rig, State};
use vibro_record::Error;

/// Restitution, force in N and frequency in Hz of the window, which has been irregular for 200 000 cycles.
const RESTITUTION: f64 = 0.97;
const FORCE: f64 = 0.3;
const FREQUENCY: f64 = 5.61;
/// Cycles left out at the beginning, cycles of a batch, and batches that every method reads.
const SETTLE: f64 = 100.0;
const BATCH: f64 = 1000.0;
const READ: usize = 4;
/// Other starts that the truth is computed from, and batches of each.
const STARTS: usize = 8;
const LONG: usize = 5;
/// Further off than so many standard errors the statistics are those of another motion: of normal errors one in 16 000 is.
const ALLOWED: f64 = 4.0;

/// The motion from rest through so many batches.
fn task(batches: usize) -> Task {
    let rig = Rig { restitution: RESTITUTION, ..Rig::thesis() };
    Task::sine(rig, FORCE, FREQUENCY, (SETTLE + BATCH * batches as f64) / FREQUENCY)
}

/// Mean and standard deviation of the approach speeds in each batch.
fn batches(told: &Told, count: usize) -> Option<Vec<[f64; 2]>> {
    let at = |batch: usize| (SETTLE + BATCH * batch as f64) / FREQUENCY;
    let one = |batch: usize| {
        let inside = told.impacts.iter().filter(|i| i.0 > at(batch) && i.0 <= at(batch + 1));
        let speeds: Vec<f64> = inside.map(|i| i.1).collect();
        (speeds.len() > 10).then(|| moments(&speeds))
    };
    (0..count).map(one).collect()
}

/// Mean over the batches of each figure, and their scatter.
fn over(batches: &[[f64; 2]]) -> [[f64; 2]; 2] {
    [0, 1].map(|i| moments(&batches.iter().map(|b| b[i]).collect::<Vec<_>>()))
}

fn moments(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    [mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt()]
}

/// Batches of the truth: integration of order 8 with tight tolerance, from starts that no method is given, so that no run of a method is among them.
fn truth(starts: usize) -> vibro_record::Result<Vec<[f64; 2]>> {
    let one = |start: usize| {
        let state = State { x1: -1e-4 * (start + 1) as f64, ..State::REST };
        let other = Task { start: state, ..task(LONG) };
        let told = events(&other, &Events::dense(Kind::Dop853(1e-12)))
            .map_err(|fault| Error::refused(format!("the truth of the chaotic window: {fault}")))?;
        batches(&told, LONG).ok_or_else(|| Error::refused("the chaotic window has no impacts"))
    };
    let all: Vec<_> = (0..starts).into_par_iter().map(one).collect::<vibro_record::Result<_>>()?;
    Ok(all.concat())
}

/// Measures every method.
///
/// # Errors
/// If the truth cannot be integrated, or has a batch without impacts.
pub fn scene(quick: bool) -> vibro_record::Result<Scene> {
    let long = over(&truth(STARTS)?);
    // Standard error of what a method reads, relative, that of the truth included.
    let share = (1.0 / READ as f64 + 1.0 / (STARTS * LONG) as f64).sqrt();
    let scatter = long.map(|[mean, std]| std / mean * share);
    let judge = |told: &Told| -> Verdict {
        let found = over(&batches(told, READ).ok_or("the impacts die out")?);
        let off = [0, 1].map(|i| (found[i][0] / long[i][0] - 1.0).abs());
        for (i, name) in ["mean", "standard deviation"].iter().enumerate() {
            let errors = off[i] / scatter[i];
            // Not a number is no statistics either.
            if errors.is_nan() || errors > ALLOWED {
                return Err(format!(
                    "the {name} of the approach speeds is {:.1} % off, {errors:.0} standard errors: the statistics of another motion",
                    100.0 * off[i]
                ));
            }
        }
        // Below a standard error both are chance, and all methods alike.
        Ok((0..2).map(|i| off[i].max(scatter[i])).fold(0.0, f64::max))
    };
    let short = task(READ);
    let mut entries = Entries::new(quick);
    let few = |all: &[f64]| if quick { all[..1].to_vec() } else { all.to_vec() };
    entries.ours("exact flights", "", || ours::flights(&short), judge);
    for n in few(&[100.0, 1e3]) {
        entries.rival("Euler loop", &steps(n), || marched(&short, Loop::Euler, n), judge);
    }
    for n in few(&[100.0, 1e3]) {
        entries.rival("RK4 loop", &steps(n), || marched(&short, Loop::Rk4, n), judge);
    }
    for n in few(&[100.0, 1e3]) {
        entries.rival("Moreau time stepping", &steps(n), || moreau(&short, n), judge);
    }
    for r in few(&[1e-3, 1e-6, 1e-9]) {
        let how = Events::ends(Kind::Rk45(r));
        entries.rival("RK45, sign test", &how.kind.setting(), || events(&short, &how), judge);
    }
    for r in few(&[1e-6, 1e-9]) {
        let how = Events::dense(Kind::Dop853(r));
        entries.rival("DOP853, dense events", &how.kind.setting(), || events(&short, &how), judge);
    }
    for k in few(&[1e6]) {
        let contact = spring(&short.rig, k);
        let setting = format!("k₃ {k:.0e} N/m");
        entries.rival("stiff spring, RK45", &setting, || penalty(&short, &contact, Kind::Rk45(1e-6)), judge);
    }
    Ok(Scene {
        name: "chaotic window".to_owned(),
        family: Family::Models,
        says: format!(
            "At R {RESTITUTION}, {FORCE} N and {FREQUENCY} Hz no two computations agree for long: mean and standard deviation of the \
             approach speeds over {} cycles, whose standard errors are {:.1} and {:.1} %. Below them errors are chance, and told as them; beyond {ALLOWED} of them it is another motion.",
            BATCH * READ as f64,
            100.0 * scatter[0],
            100.0 * scatter[1]
        ),
        error_of: "larger relative error of mean and deviation".to_owned(),
        truth: format!(
            "order 8, tolerance 1e-12, from {STARTS} other starts, {} cycles in all; standard errors from the means of batches of {BATCH}",
            BATCH * (STARTS * LONG) as f64
        ),
        bound: None,
        methods: entries.done(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_stays_irregular() {
        let told = ours::flights(&task(20)).unwrap();
        let mut last: Vec<f64> = told.impacts.iter().rev().take(1000).map(|i| i.1).collect();
        last.sort_by(f64::total_cmp);
        // What repeats after fewer than 500 impacts has every speed at least twice.
        last.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        assert!(last.len() > 990, "{}", last.len());
    }

    /// Where one start led to another motion than the others, or a batch knew of the one before, the standard error would be none.
    #[test]
    fn batches_of_other_starts_scatter_alike_and_know_nothing_of_each_other() {
        let all = truth(4).unwrap();
        for i in 0..2 {
            let [mean, std] = over(&all)[i];
            let of_starts: Vec<f64> =
                all.chunks(LONG).map(|s| s.iter().map(|b| b[i]).sum::<f64>() / LONG as f64).collect();
            // Four means of five batches: beyond four of their standard errors is one in 16 000.
            for start in &of_starts {
                assert!((start - mean).abs() < ALLOWED * std / (LONG as f64).sqrt(), "{i}: {of_starts:?}");
            }
            let pairs: Vec<f64> = all
                .chunks(LONG)
                .flat_map(|s| s.windows(2).map(|w| (w[0][i] - mean) * (w[1][i] - mean)))
                .collect();
            let correlation = pairs.iter().sum::<f64>() / pairs.len() as f64 / (std * std);
            // Of 16 pairs without correlation it scatters by 1/√16.
            assert!(correlation.abs() < 0.75, "{i}: {correlation}");
        }
    }

    #[test]
    fn moments_of_four_numbers() {
        let [mean, std] = moments(&[1.0, 2.0, 3.0, 6.0]);
        assert!((mean - 3.0).abs() < 1e-15 && (std - (14.0_f64 / 3.0).sqrt()).abs() < 1e-15);
    }
}
