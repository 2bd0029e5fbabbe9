use super::*;
use crate::drill::{AngleOrigin, Beam, Edge};
use vibro_math::Noise;

fn options(masses: Option<(f64, f64)>) -> DrillOptions {
    let mut options = DrillOptions::new(1.0, Beam::new(0.0, AngleOrigin::Axis).unwrap(), 1, Edge::Rising);
    (options.mass, options.struck_mass) = (masses.map(|m| m.0), masses.map(|m| m.1));
    options
}

/// Impacts of successive turns with (phase, velocity before, velocity after), always 1 s apart.
fn impacts(of: &[(f64, f64, f64)]) -> Vec<Impact> {
    let one = |(cycle, (phase, before, after)): (usize, &(f64, f64, f64))| Impact {
        cycle,
        group: 99,
        time: cycle as f64,
        time_std: Some(0.0),
        phase: *phase,
        phase_std: Some(0.0),
        first_contact: *before,
        first_contact_std: Some(0.0),
        before: *before,
        before_std: Some(0.0),
        after: *after,
        after_std: Some(0.0),
        clipped: false,
    };
    of.iter().enumerate().map(one).collect()
}

fn grouped(impacts: &mut [Impact], turns: usize, options: &DrillOptions) -> Vec<Group> {
    let residuals = vec![[Vec::new(), Vec::new()]; impacts.len()];
    groups(impacts, &residuals, 0, turns, options, &Offset { value: 0.0, std: None })
}

#[test]
fn front_and_rear() {
    let of = [
        (0.98, 7.0, -1.0),
        (0.45, -4.0, 1.0),
        (0.02, 8.0, -2.0),
        (0.47, -4.2, 1.2),
        (0.99, 7.5, -1.5),
        (0.03, 7.5, -1.5),
        (0.44, -4.1, 1.1),
    ];
    let mut all = impacts(&of.repeat(10));
    let groups = grouped(&mut all, 40, &options(Some((0.1, 0.2))));
    // The group with the larger sum of squared velocity changes comes first: front 10·(64 + 100 + 81 + 81)
    // m²/s², rear about 10·(25 + 29 + 27).
    assert_eq!(groups.iter().map(|g| g.n).collect::<Vec<_>>(), [40, 30]);
    assert_eq!(all.iter().take(7).map(|i| i.group).collect::<Vec<_>>(), [0, 1, 0, 1, 0, 0, 1]);
    let front = &groups[0];
    // (−0.02 + 0.02 − 0.01 + 0.03)/4: phases on both sides of the beginning of a turn.
    assert!((front.phase.value - 0.005).abs() < 1e-12 && front.share == 1.0, "{front:?}");
    assert!((front.before.value - 7.5).abs() < 1e-12 && (front.after.value + 1.5).abs() < 1e-12);
    // Mean separation ½(v − v′) − v′ = 4.5 + 1.5 m/s with ½ the ratio of masses, mean approach 7.5 m/s.
    assert!((front.restitution.as_ref().unwrap().value - 6.0 / 7.5).abs() < 1e-12);
    // At the rear there is no struck mass: −v′/v = 3.3/12.3.
    let rear = groups[1].restitution.as_ref().unwrap();
    assert!((rear.value - 3.3 / 12.3).abs() < 1e-12 && rear.std.is_some(), "{rear:?}");
    assert!(front.before.std.is_some());
    assert!(groups.iter().all(|g| g.findings.is_empty()), "{groups:?}");
}

/// Two blows a turn in one direction, with velocities and phases that scatter by chance.
#[test]
fn two_unlike_blows_a_turn_are_two_groups_and_two_alike_are_one() {
    let of = |weak: f64| {
        let mut noise = Noise::new(11);
        let turn = |cycle: usize| {
            let mut blow = |phase: f64, speed: f64| Impact {
                cycle,
                time: cycle as f64 + phase,
                ..impacts(&[(phase + 0.01 * noise.normal(), speed + 0.2 * noise.normal(), -0.78 * speed)])[0]
            };
            [blow(0.25, 9.59), blow(0.75, weak)]
        };
        (0..45).flat_map(turn).collect::<Vec<Impact>>()
    };
    let mut all = of(5.4);
    let groups = grouped(&mut all, 45, &options(None));
    assert_eq!(groups.iter().map(|g| (g.n, g.share)).collect::<Vec<_>>(), [(45, 1.0), (45, 1.0)]);
    for (group, (phase, speed)) in groups.iter().zip([(0.25, 9.59), (0.75, 5.4)]) {
        // Means of 45: 0.2/√45 = 0.03 and 0.01/√45 = 0.0015.
        let (before, at) = (&group.before, &group.phase);
        assert!((before.value - speed).abs() < 5.0 * before.std.unwrap() && before.std.unwrap() < 0.06);
        assert!((at.value - phase).abs() < 5.0 * at.std.unwrap() && at.std.unwrap() < 0.004, "{at:?}");
    }
    assert!(all.iter().all(|i| i.group == usize::from(i.phase > 0.5)));
    assert_eq!(grouped(&mut of(9.59), 45, &options(None)).len(), 1);
}

#[test]
fn impacts_at_all_phases_have_no_mean_phase() {
    let of: Vec<_> = (0..40).map(|k| ((0.37 * f64::from(k)).fract(), 5.0, -1.0)).collect();
    let groups = grouped(&mut impacts(&of), 40, &options(None));
    assert_eq!((groups.len(), groups[0].n, groups[0].phase.std), (1, 40, None));
    assert!(groups[0].before.std.is_some());
    assert_eq!(groups[0].findings[0].code, "drill-phase-undirected");
    assert!(grouped(&mut [], 3, &options(None)).is_empty());
}

/// Fraction of 1000 records of `n` impacts that are found to have no mean phase.
fn undirected(n: usize, mut phase: impl FnMut(usize) -> f64) -> f64 {
    let mut count = 0;
    for _ in 0..1000 {
        let of: Vec<_> = (0..n).map(|k| (phase(k).rem_euclid(1.0), 5.0, -1.0)).collect();
        let found = grouped(&mut impacts(&of), n, &options(None));
        let undirected = found[0].findings.iter().any(|f| f.code == "drill-phase-undirected");
        count += usize::from(undirected && found[0].phase.std.is_none());
    }
    1e-3 * f64::from(count as u32)
}

#[test]
fn chance_prefers_no_phase() {
    let mut noise = Noise::new(4);
    for n in [6, 10, 20, 40, 60] {
        // By chance 5 % of random records prefer a phase. 1000 records scatter by 0.7 %: four times that.
        let uniform = undirected(n, |_| noise.uniform());
        assert!(uniform > 0.92, "{n}: {uniform}");
        let normal = undirected(n, |_| 0.08 * noise.normal());
        assert!(normal < 0.02, "{n}: {normal}");
        // Half of the impacts come half a turn later: the mean phase is far from all of them.
        let two = undirected(n, |k| 0.5 * (k % 2) as f64 + 0.01 * noise.normal());
        assert_eq!(two, 1.0, "{n}");
    }
}

#[test]
fn impacts_beyond_the_range_are_in_no_mean_and_leave_no_uncertainty() {
    let mut all = impacts(&[(0.5, 7.0, -1.0); 20]);
    (all[3].clipped, all[3].before) = (true, 6.0);
    let found = &grouped(&mut all, 20, &options(None))[0];
    assert_eq!((found.n, found.clipped, found.before.n, found.before.std), (20, 1, 19, None));
    assert!((found.before.value - 7.0).abs() < 1e-12);
    assert_eq!(found.findings[0].code, "drill-impacts-over-range");
}

#[test]
fn a_ratio_of_sums_and_its_propagated_uncertainty() {
    // R = 0.2 in every impact, at every speed: the ratio does not scatter.
    let of: Vec<_> = (0..12)
        .map(|k| (0.5, 10.0 + 0.2 * f64::from(7 * k % 12), -0.2 * (10.0 + 0.2 * f64::from(7 * k % 12))))
        .collect();
    let found = grouped(&mut impacts(&of), 12, &options(None));
    let r = found[0].restitution.as_ref().unwrap();
    assert!((r.value - 0.2).abs() < 1e-12 && r.std.unwrap() < 1e-12, "{r:?}");
}

/// Twenty impacts whose speeds spread over 0.01 m/s.
fn twenty(before: f64, after: f64, std: f64) -> Vec<Impact> {
    let speed = |v: f64, k: usize| v + 0.01 * ((k * 7 % 20) as f64 / 19.0 - 0.5);
    (0..20)
        .map(|k| Impact {
            cycle: k,
            group: 0,
            time: k as f64,
            time_std: Some(0.0),
            phase: 0.5,
            phase_std: Some(1e-3),
            first_contact: speed(before, k),
            first_contact_std: Some(std),
            before: speed(before, k),
            before_std: Some(std),
            after: speed(after, k * k),
            after_std: Some(std),
            clipped: false,
        })
        .collect()
}

#[test]
fn what_strikes_has_a_restitution_and_what_is_struck_has_none() {
    // 0.1 kg at 5 m/s on 0.3 kg: they part at 0.4 · 5 m/s; momentum leaves −0.25 and 1.75 m/s.
    let found = restitution(
        &twenty(5.0, -0.25, 0.02).iter().collect::<Vec<_>>(),
        true,
        &options(Some((0.1, 0.3))),
        &|_| 0.0,
    )
    .unwrap();
    // Each speed scatters by 0.003 m/s; tolerance: four times that of the mean of 20.
    assert!((found.value - 0.4).abs() < 4.0 * 0.003 / 20f64.sqrt(), "{found:?}");
    let why = |i: &[Impact], o| restitution(&i.iter().collect::<Vec<_>>(), true, &o, &|_| 0.0).unwrap_err();
    assert_eq!(why(&twenty(0.01, 2.7, 0.02), options(None)).code, "drill-not-striking");
    // Struck from behind while it moves.
    assert_eq!(why(&twenty(0.5, 4.0, 0.02), options(None)).code, "drill-not-striking");
    for after in [-5.5, 2.5] {
        let why = why(&twenty(5.0, after, 0.02), options(None));
        assert_eq!(why.code, "drill-restitution-impossible");
        assert!((why.get("value").unwrap() + after / 5.0).abs() < 1e-3, "{why:?}");
    }
}

#[test]
fn what_has_no_uncertainty_explains_nothing() {
    // Three impacts give no uncertainty: R = 1.1 is not significantly above 1 and is kept.
    let found =
        restitution(&twenty(5.0, -5.5, 0.02)[..3].iter().collect::<Vec<_>>(), true, &options(None), &|_| 0.0);
    let found = found.unwrap();
    assert!((found.value - 1.1).abs() < 0.01 && found.std.is_none(), "{found:?}");
}

#[test]
fn a_striker_whose_speed_varies_by_half_still_strikes() {
    // Speeds from 1.1 to 9 m/s in no order, mean 5 m/s, each returned with 0.3 of it. The mean of twenty is
    // uncertain by 11 %, but the ratio is the same in all.
    let mut all = twenty(5.0, -1.5, 0.02);
    for (k, impact) in all.iter_mut().enumerate() {
        impact.before = 1.1 + 7.9 * ((k * 7) % 20) as f64 / 19.0;
        impact.after = -0.3 * impact.before;
    }
    let found = restitution(&all.iter().collect::<Vec<_>>(), true, &options(None), &|_| 0.0);
    assert!((found.as_ref().unwrap().value - 0.3).abs() < 1e-12, "{found:?}");
}

#[test]
fn what_is_not_known_of_an_offset_is_in_all_means_and_a_large_one_leaves_no_uncertainty() {
    let group = |value| {
        let found = grouped(&mut twenty(5.0, -1.0, 0.02), 20, &options(Some((0.1, 0.3))));
        found.into_iter().next().unwrap().allowing(&Offset { value, std: Some(0.2) }, Some(0.1))
    };
    let small = group(0.4);
    let std = |e: &Option<Estimate>| e.as_ref().unwrap().std.unwrap();
    // The mean speeds scatter by only 0.001 m/s: the uncertainties are those of the offset, 0.2 m/s. R
    // changes with it by (1 + R)/v, the energies by m v and m (v − v′).
    let r = small.restitution.as_ref().unwrap().value;
    let expected = [0.2, 0.2, (1.0 + r) / 5.0 * 0.2, 0.1 * 5.0 * 0.2, 0.1 * 6.0 * 0.2];
    let (before, after) = (small.before.std.unwrap(), small.after.std.unwrap());
    let stated = [before, after, std(&small.restitution), std(&small.energy), std(&small.energy_given)];
    for (stated, expected) in stated.into_iter().zip(expected) {
        assert!((stated / expected - 1.0).abs() < 0.01, "{stated} {expected}");
    }
    let large = group(-0.6);
    assert!(large.before.std.is_none() && large.energy_given.is_some_and(|e| e.std.is_none()));
    assert_eq!(large.findings[0].code, "drill-mean-velocity");
}

#[test]
fn impacts_of_a_velocity_that_rings_have_no_uncertainty_and_two_a_turn_have() {
    let of = |second: f64| {
        let mut normal = Noise::new(7);
        let mut all: Vec<Impact> = (0..20)
            .flat_map(|cycle| {
                let mut two = impacts(&[(0.3, 6.0 + 0.1 * normal.normal(), -1.5), (second, 6.1, -1.4)]);
                for impact in &mut two {
                    (impact.cycle, impact.time) = (cycle, cycle as f64 + impact.phase);
                }
                two
            })
            .collect();
        let group = grouped(&mut all, 20, &options(None)).remove(0);
        let rings = group.findings.iter().any(|found| found.code == "drill-ringing");
        (rings, group.before.std.is_none(), group.phase.std.is_none())
    };
    assert_eq!(of(0.32), (true, true, true));
    assert_eq!((of(0.7).0, of(0.7).1), (false, false));
}

#[test]
fn fits_that_lead_beyond_the_record_give_no_velocities() {
    let group = |reach: f64| grouped(&mut twenty(6.0, -1.5, 0.1), 20, &options(None)).remove(0).within(reach);
    // The strongest of twenty impacts lie near 6 m/s.
    let (kept, refused) = (group(5.5), group(4.0));
    assert!((kept.before.value - 6.0).abs() < 0.2 && kept.restitution.is_some());
    assert!(refused.before.value.is_nan() && refused.after.value.is_nan() && refused.restitution.is_none());
    assert!(refused.findings.iter().any(|found| found.code == "drill-velocity-impossible"));
}

/// Residuals √7 P₃, as of a cubic fitted by a parabola: the bias is that cubic at the contact.
#[test]
fn what_parabolas_leave_in_common_is_in_the_uncertainty() {
    let places = 40;
    let cubic = |k: usize| {
        let x = 2.0 * (k as f64 + 0.5) / f64::from(places) - 1.0;
        0.5 * x * (5.0 * x * x - 3.0) * 7f64.sqrt()
    };
    let mut noise = Noise::new(8);
    let mut all = impacts(&[(0.3, 6.0, -1.2); 30]);
    for impact in &mut all {
        (impact.before, impact.after) = (6.0 + 0.001 * noise.normal(), -1.2 + 0.001 * noise.normal());
    }
    let mut of = |rms: f64| {
        let one = |_| (0..places as usize).map(|k| rms * cubic(k) + 0.001 * noise.normal()).collect();
        (0..30).map(one).collect::<Vec<Vec<f64>>>()
    };
    let (quiet, bent) = (of(0.0), of(0.05));
    let residuals: Vec<[Vec<f64>; 2]> = quiet.into_iter().zip(bent).map(|(a, b)| [a, b]).collect();
    let found =
        groups(&mut all, &residuals, 5, 30, &options(Some((0.14, 0.42))), &Offset { value: 0.0, std: None });
    let [group] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!(group.findings.iter().map(|f| f.code.as_ref()).collect::<Vec<_>>(), ["drill-lack-of-fit"]);
    // The contact is 5 samples after the end of 40: x = 1 + 2·5/40 = 1.25.
    let bias = 0.05 * 7f64.sqrt() * 0.5 * 1.25 * (5.0 * 1.25 * 1.25 - 3.0);
    let near = |std: Option<f64>, expected: f64| (std.unwrap() / expected - 1.0).abs() < 0.02;
    assert!(group.before.std.unwrap() < 0.001 && near(group.after.std, bias), "{group:?} {bias}");
    assert!(near(group.energy_given.as_ref().unwrap().std, 0.14 * 1.2 * bias));
    // R = ((v − v′)/3 − v′)/v, the ratio of the masses being 1/3.
    assert!(near(group.restitution.as_ref().unwrap().std, (1.0 + 1.0 / 3.0) / 6.0 * bias));
    assert_eq!(group.phase.std, None);
}
