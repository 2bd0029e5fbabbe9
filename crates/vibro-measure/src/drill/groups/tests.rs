use super::*;
use crate::drill::{Beam, Edge, From};
use crate::synthetic::Normal;

fn options(masses: Option<(f64, f64)>) -> DrillOptions {
    let mut options = DrillOptions::new(1.0, Beam::new(0.0, From::Axis).unwrap(), 1, Edge::Rising);
    (options.mass, options.struck_mass) = (masses.map(|m| m.0), masses.map(|m| m.1));
    options
}

/// Impacts of turns in a row from (phase, before, after).
fn impacts(of: &[(f64, f64, f64)]) -> Vec<Impact> {
    let one = |(cycle, (phase, before, after)): (usize, &(f64, f64, f64))| Impact {
        cycle,
        group: 99,
        time: cycle as f64 + phase,
        phase: *phase,
        phase_std: 0.0,
        before: *before,
        before_std: 0.0,
        after: *after,
        after_std: 0.0,
        clipped: false,
    };
    of.iter().enumerate().map(one).collect()
}

#[test]
fn front_and_rear_and_a_stray() {
    let of = [
        (0.98, 7.0, -1.0),
        (0.45, -4.0, 1.0),
        (0.02, 8.0, -2.0),
        (0.47, -4.2, 1.2),
        (0.99, 7.5, -1.5),
        (0.30, 30.0, 0.0),
        (0.03, 7.5, -1.5),
        (0.44, -4.1, 1.1),
    ];
    // Ten times that, with one stray: 41 impacts towards the front, of which chance leaves two gaps of 0.12 turn.
    let mut ten = of.repeat(10);
    let mut strays = 0;
    ten.retain(|i| {
        strays += usize::from(i.1 == 30.0);
        i.1 != 30.0 || strays == 1
    });
    let mut all = impacts(&ten);
    let groups = groups(&mut all, &Residuals::default(), 40, &options(Some((0.1, 0.2))));
    // Squares of jumps: in front ten times 64 + 100 + 81 + 81, the stray 900, behind ten times 25 + 29 + 27 or so.
    assert_eq!(groups.iter().map(|g| g.n).collect::<Vec<_>>(), [40, 1, 30]);
    assert_eq!(all.iter().take(8).map(|i| i.group).collect::<Vec<_>>(), [0, 2, 0, 2, 0, 1, 0, 2]);
    let front = &groups[0];
    // (−0.02 + 0.02 − 0.01 + 0.03)/4, across the edge of the turn.
    assert!((front.phase.value - 0.005).abs() < 1e-12 && front.share == 1.0, "{front:?}");
    assert!((front.before.value - 7.5).abs() < 1e-12 && (front.after.value + 1.5).abs() < 1e-12);
    // Separation ½(v − v′) − v′ = 4.5 + 1.5 in the mean, approach 7.5.
    assert!((front.restitution.as_ref().unwrap().value - 6.0 / 7.5).abs() < 1e-12);
    // Behind, 3.3/12.3: the struck mass is not there.
    let rear = groups[2].restitution.as_ref().unwrap();
    assert!((rear.value - 3.3 / 12.3).abs() < 1e-12 && rear.std.is_some(), "{rear:?}");
    assert!(groups[1].before.std.is_none() && front.before.std.is_some());
    assert!(groups.iter().all(|g| g.findings.is_empty()), "{groups:?}");
}

#[test]
fn a_strong_stray_does_not_stand_for_all() {
    let mut of = vec![(0.3, 7.0, -2.0); 20];
    of.push((0.7, 30.0, 0.0));
    let groups = groups(&mut impacts(&of), &Residuals::default(), 20, &options(None));
    assert_eq!((groups.len(), groups[0].n, groups[1].n), (2, 20, 1));
}

#[test]
fn impacts_at_all_phases_have_no_mean_phase() {
    let of: Vec<_> = (0..40).map(|k| ((0.37 * f64::from(k)).fract(), 5.0, -1.0)).collect();
    let groups = groups(&mut impacts(&of), &Residuals::default(), 40, &options(None));
    assert_eq!((groups.len(), groups[0].n, groups[0].phase.std), (1, 40, None));
    assert!(groups[0].before.std.is_some());
    assert_eq!(groups[0].findings[0].code, "drill-phase-undirected");
    assert!(super::groups(&mut [], &Residuals::default(), 3, &options(None)).is_empty());
}

/// Of 1000 records of `n` impacts: parts that have more than one group, and whose one group has no mean phase.
fn parts(n: usize, mut phase: impl FnMut(usize) -> f64) -> (f64, f64) {
    let (mut split, mut round) = (0, 0);
    for _ in 0..1000 {
        let of: Vec<_> = (0..n).map(|k| (phase(k).rem_euclid(1.0), 5.0, -1.0)).collect();
        let found = groups(&mut impacts(&of), &Residuals::default(), n, &options(None));
        split += usize::from(found.len() > 1);
        round += usize::from(
            found.len() == 1
                && found[0].findings.iter().any(|f| f.code == "drill-phase-undirected")
                && found[0].phase.std.is_none(),
        );
    }
    (1e-3 * split as f64, 1e-3 * round as f64)
}

#[test]
fn chance_makes_no_groups() {
    let mut noise = Normal(4);
    for n in [6, 10, 20, 40, 60] {
        let uniform = parts(n, |_| noise.uniform());
        println!("{n} impacts at any phase, seed 4: {uniform:?} in groups, all round");
        // One in a hundred is grouped, one in a hundred seems to prefer a phase; 1000 records scatter by 0.4 % at 2 %: four times that.
        assert!(uniform.0 < 0.026 && uniform.1 > 0.964, "{n}: {uniform:?}");
        let normal = parts(n, |_| 0.08 * noise.next());
        println!("{n} impacts about one phase, scatter 0.08 turn: {normal:?}");
        // A lone impact 0.1 turn from the rest, 1.25 standard deviations, is rare but no chance of even phases: n(n − 1)/2 pairs do
        // not tell how likely. Where chance leaves less than that gap no more than a few in a hundred may be parted. Ten
        // impacts are enough to show that they prefer a phase.
        assert!(normal.0 < 0.07 && (n < 10 || normal.1 < 0.02), "{n}: {normal:?}");
    }
}

#[test]
fn what_is_apart_is_parted() {
    let mut noise = Normal(5);
    for n in [12, 20, 60] {
        // Half of the impacts half a turn later, of the same direction; scatter 0.01 turn.
        let two = parts(n, |k| 0.5 * (k % 2) as f64 + 0.01 * noise.next());
        println!("{n} impacts at two phases, seed 5: {two:?}");
        assert_eq!(two, (1.0, 0.0), "{n}");
    }
}

#[test]
fn means_without_the_fastest_are_covered_up_to_the_limit() {
    means_without_the_fastest(&[1]);
}

#[test]
#[ignore = "Monte Carlo: cargo test --release -- --ignored"]
fn means_without_any_of_the_fastest_are_covered_up_to_the_limit() {
    means_without_the_fastest(&[1, 2, 4]);
}

fn means_without_the_fastest(left_out: &[usize]) {
    let mut noise = Normal(6);
    for &clipped in left_out {
        // Fewest impacts of which so many may be left out.
        let all = (clipped..100_000).find(|n| !range_bias(clipped, *n)).unwrap();
        assert!(range_bias(clipped, all - 1));
        let inside = (0..2000).filter(|_| {
            let values: Vec<f64> = (0..all).map(|_| noise.next()).collect();
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            let highest = sorted[all - clipped];
            let mean = Mean::of(&values.into_iter().filter(|v| *v < highest).collect::<Vec<f64>>());
            mean.value.abs() < 1.96 * mean.std.unwrap()
        });
        let part = 0.05 * inside.count() as f64;
        println!("{clipped} of {all} impacts left out, seed 6: {part:.1} % of 2000 intervals hold the truth");
        // 94.0 % of a normal distribution 0.3 from its middle; 2000 scatter by 0.5 %, four times that.
        assert!((92.0..=98.0).contains(&part), "{part}");
    }
}

#[test]
fn a_ratio_of_sums_and_its_propagated_uncertainty() {
    // R = 0.2 in every impact whatever the speed, which varies in no order: nothing scatters. Then a speed of approach that is not known.
    let of: Vec<_> = (0..12)
        .map(|k| (0.5, 10.0 + 0.2 * f64::from(7 * k % 12), -0.2 * (10.0 + 0.2 * f64::from(7 * k % 12))))
        .collect();
    let found = groups(&mut impacts(&of), &Residuals::default(), 12, &options(None));
    let r = found[0].restitution.as_ref().unwrap();
    assert!((r.value - 0.2).abs() < 1e-12 && r.std.unwrap() < 1e-12, "{r:?}");
    let of: Vec<_> =
        (0..12).map(|k| (0.5, if k % 5 < 2 { 1.0 } else { -0.8 }, -3.0 - f64::from(k % 3))).collect();
    let found = groups(&mut impacts(&of), &Residuals::default(), 12, &options(None));
    assert_eq!(found[0].restitution, None);
    assert_eq!(found[0].findings[0].code, "drill-approach-unclear");
}
