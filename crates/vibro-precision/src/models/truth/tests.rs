use super::super::rivals::{Kind, Locate, events};
use super::super::scenes::{GOLDEN_B, GOLDEN_C, task_b, task_c};
use super::*;
use vibro_model::Rig;

#[test]
fn impacts_of_scene_b_are_those_of_arithmetic_with_40_digits() {
    let told = motion(&task_b(2.0), None);
    let speeds = [
        0.078_330_829_224_466_23,
        0.147_727_906_853_932_83,
        0.233_773_950_612_516_77,
        0.283_306_967_791_457_3,
    ];
    for ((number, time), speed) in GOLDEN_B.into_iter().zip(speeds) {
        let found = told.impacts[number - 1];
        // A few roundings (1e-15) in each of 512 steps a cycle over 22 cycles, all to one side: 1e-11 rad of the cycle, 2e-13 s; five times
        // that.
        assert!((found.0 - time).abs() < 1e-12, "{number}: {:e}", found.0 - time);
        assert!((found.1 / speed - 1.0).abs() < 5e-11, "{number}: {:e}", found.1 / speed - 1.0);
    }
}

#[test]
fn chatter_rest_and_release_of_scene_c_are_those_of_arithmetic_with_40_digits() {
    let told = motion(&task_c(), None);
    let found = [told.sticks[0][0], told.sticks[0][1], told.sticks[1][0]];
    for (found, golden) in found.iter().zip(GOLDEN_C) {
        // The series leaves out what the pressing acceleration changes in the 2w/(a(1 − R)) = 7e-7/a s after the last rebound.
        assert!((found - golden).abs() < 1e-10, "{found} {golden}");
    }
}

/// Work of the exciting force over a cycle of the settled motion, and what dampers and impact take: by Simpson's rule on the
/// states, which the follower does not use.
#[test]
fn a_settled_cycle_spends_what_the_force_gives() {
    let task = task_b(2.0);
    let found = settled(&task, None, 400.0).unwrap();
    let mode = Course::new(&task, None).apart;
    let rig = task.rig;
    let [x1, v1, x2, v2] = found.before;
    let common = (rig.m1 * v1 + rig.m2 * v2) / (rig.m1 + rig.m2);
    let back = -rig.restitution * (v1 - v2);
    let y = [x1, common + rig.m2 / (rig.m1 + rig.m2) * back, x2, common - rig.m1 / (rig.m1 + rig.m2) * back];
    let (h, n) = (task.cycle() / mode::STEPS as f64, mode::STEPS);
    let mut at = mode.instant(found.phase / (TAU * task.frequency), &y);
    let [mut work, mut damped] = [0.0; 2];
    for i in 0..=n {
        let weight = h / 3.0 * if i == 0 || i == n { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
        work += weight * task.force * at.1[4] * at.1[1];
        damped += weight * (rig.c1 * at.1[1] * at.1[1] + rig.c2 * at.1[3] * at.1[3]);
        at = mode.step(0, &at);
    }
    let lost = 0.5 * rig.reduced_mass() * (1.0 - rig.restitution.powi(2)) * found.speed().powi(2);
    // Simpson's rule leaves (2π/512)⁴/180 = 1e-10 of what oscillates.
    assert!((work / (damped + lost) - 1.0).abs() < 1e-8, "{work} {damped} {lost}");
}

#[test]
fn a_contact_is_followed_as_by_integration_of_order_8() {
    for restitution in [0.1, 0.7, 1.0] {
        let rig = Rig { restitution, ..Rig::thesis() };
        let task = Task { rig, ..task_b(0.6) };
        let own = motion(&task, Some(&task.spring()));
        let other = events(&task, Some(task.spring()), Kind::Dop853(1e-13), Locate::Dense).unwrap();
        assert!(own.impacts.len() > 3);
        assert_eq!(own.impacts.len(), other.impacts.len());
        for (a, b) in own.impacts.iter().zip(&other.impacts) {
            // Errors of 1e-13 a step of the integration, some hundred steps.
            assert!((a.0 - b.0).abs() < 1e-10 && (a.1 - b.1).abs() < 1e-9, "{a:?} {b:?}");
        }
    }
}
