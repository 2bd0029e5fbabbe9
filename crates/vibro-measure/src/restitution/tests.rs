use super::*;
use crate::impacts::ImpactsOptions;
use vibro_record::units::Unit;
use vibro_record::{Axis, Fact, Meta, Trace};

fn finding<'a>(found: &'a Restitution, code: &str) -> Option<&'a Finding> {
    found.findings.iter().find(|f| f.code == code)
}

fn drop(height: f64, interval: f64) -> Drop {
    Drop { height, intervals: vec![interval], ..Drop::default() }
}

fn of(measured: &Measured) -> Restitution {
    restitution(measured).unwrap()
}

#[test]
fn the_thesis_drop_and_its_uncertainty() {
    let one = Drop {
        height_std: Some(0.005),
        interval_std: Some(0.004),
        gravity_std: Some(0.01),
        ..drop(0.57, 0.144)
    };
    let found = of(&Measured { drop: Some(one.clone()), contact_time: Some(0.0), ..Measured::default() });
    // The thesis prints 0.2; the numbers give 0.072·√(9.80665/1.14) = 0.211174.
    assert!((found.restitution.value - 0.211_174).abs() < 1e-6, "{found:?}");
    // Expected uncertainty from numerical derivatives.
    let slope = |change: &dyn Fn(&mut Drop), step: f64| {
        let mut other = one.clone();
        change(&mut other);
        (other.restitution(other.intervals[0]) - one.restitution(0.144)) / step
    };
    let by_height = slope(&|d| d.height += 1e-7, 1e-7) * 0.005;
    let by_gravity = slope(&|d| d.gravity += 1e-7, 1e-7) * 0.01;
    let by_interval = slope(&|d| d.intervals[0] += 1e-7, 1e-7) * 0.004;
    let expected = (by_height.powi(2) + by_gravity.powi(2) + by_interval.powi(2)).sqrt();
    // Differences over 1e-7 lose nine digits of sixteen.
    assert!((found.restitution.std.unwrap() / expected - 1.0).abs() < 1e-5, "{found:?}");
}

/// A contact time that is off by its uncertainty moves R by as much as that adds to the uncertainty of R.
#[test]
fn the_uncertainty_of_the_contact_time_is_in_that_of_r() {
    let (r, fall) = (0.8f64, (2.0 * 0.3 / GRAVITY).sqrt());
    let intervals: Vec<f64> = (1..9).map(|k| 2.0 * fall * r.powi(k) + 1e-3).collect();
    let fell = Drop { height_std: Some(1e-3), interval_std: Some(1e-4), ..drop(0.3, intervals[0]) };
    let train = Train { intervals, onset_std: Some(1e-4), ..Train::default() };
    let with = |contact: f64, std: Option<f64>| {
        let trains = vec![train.clone()];
        let (contact_time, contact_time_std) = (Some(contact), std);
        of(&Measured { drop: Some(fell.clone()), trains, contact_time, contact_time_std, velocities: None })
    };
    let (exact, uncertain, off) = (with(1e-3, None), with(1e-3, Some(1e-4)), with(1.1e-3, None));
    assert!(uncertain.by.len() == 2 && uncertain.findings == exact.findings, "{uncertain:?}");
    for ((exact, uncertain), off) in exact.by.iter().zip(&uncertain.by).zip(&off.by) {
        let std = |way: &MethodAnswer| way.restitution.std.unwrap();
        let added = (std(uncertain).powi(2) - std(exact).powi(2)).sqrt();
        let moved = (off.restitution.value - exact.restitution.value).abs();
        // Differences of the next order are as large as 0.1 ms over the shortest flight of 83 ms.
        assert!((added / moved - 1.0).abs() < 2e-3, "{added} {moved}");
    }
    let alone = Measured { trains: vec![train.clone()], contact_time_std: Some(1e-4), ..Measured::default() };
    assert!(restitution(&alone).is_err());
}

/// An interval between the onsets of impacts includes the contact time: 1 ms of 144 ms is 0.7 % of R.
#[test]
fn the_contact_time_is_taken_off() {
    let (r, contact) = (0.7, 1e-3);
    // First flight after a drop from 0.57 m: 2R√(2h/g); each later flight is R times as long.
    let first = 2.0 * r * (2.0 * 0.57 / GRAVITY).sqrt();
    let intervals: Vec<f64> = (0..6).map(|k| first * f64::powi(r, k) + contact).collect();
    let train = Train { intervals: intervals.clone(), onset_std: Some(1e-6), ..Train::default() };
    let fell = Drop { height_std: Some(1e-4), interval_std: Some(1e-6), ..drop(0.57, intervals[0]) };
    let measured = Measured { drop: Some(fell), trains: vec![train], ..Measured::default() };
    let stated = of(&Measured { contact_time: Some(contact), ..measured.clone() });
    assert!(stated.by.iter().all(|way| (way.restitution.value - r).abs() < 1e-12), "{stated:?}");
    assert!(stated.findings.is_empty() && stated.intervals == [intervals.clone()], "{stated:?}");
    let unstated = of(&measured);
    let parts = finding(&unstated, "contact-time-unsaid").unwrap().fact("parts").cloned();
    assert!((unstated.by[0].restitution.value / r - 1.0 - contact / first).abs() < 1e-12, "{unstated:?}");
    let Some(Fact::Numbers(parts)) = parts else { panic!() };
    // The finding gives the contact time over the interval, which includes it.
    assert!((parts[0] - contact / intervals[0]).abs() < 1e-12, "{parts:?}");
}

#[test]
fn impossible_drops_are_refused() {
    let why = |d: Drop| {
        restitution(&Measured { drop: Some(d), contact_time: Some(0.0), ..Measured::default() }).unwrap_err()
    };
    assert!(why(drop(0.0, 0.144)).to_string().contains("height is 0"));
    assert!(why(drop(-1.0, 0.144)).to_string().contains("height"));
    // The fall takes 0.341 s, so twice that is the longest flight.
    assert!(why(drop(0.57, 0.70)).to_string().contains("at most"));
    assert!(why(drop(0.57, 0.0)).to_string().contains("interval is 0"));
    assert_eq!(why(drop(0.57, f64::NAN)).exit_code(), 1);
    assert_eq!(restitution(&Measured::default()).unwrap_err().exit_code(), 2);
}

#[test]
fn a_train_of_bounces_and_one_that_does_not_fit() {
    let mut intervals: Vec<f64> = (0..7).map(|k| 0.4 * 0.7f64.powi(k)).collect();
    let clean = of(&Measured {
        trains: vec![Train { intervals: intervals.clone(), ..Train::default() }],
        ..Measured::default()
    });
    assert!((clean.restitution.value - 0.7).abs() < 1e-12, "{clean:?}");
    assert!(finding(&clean, "flight-outlier").is_none());
    intervals[3] *= 1.3;
    let found = of(&Measured {
        trains: vec![Train { intervals, ..Train::default() }],
        contact_time: Some(0.0),
        ..Measured::default()
    });
    let outlier = finding(&found, "flight-outlier").unwrap();
    assert_eq!((outlier.get("train"), outlier.get("flight")), (Some(1.0), Some(4.0)));
    assert!((outlier.get("expected").unwrap() / (0.4 * 0.343) - 1.0).abs() < 1e-9);
    assert_eq!(found.findings.iter().filter(|f| f.code == "flight-outlier").count(), 1);
    assert!((found.restitution.value - 0.7).abs() < 1e-9, "{found:?}");
}

#[test]
fn two_flights_give_their_ratio_without_an_uncertainty() {
    let train = Train { intervals: vec![0.3, 0.18], ..Train::default() };
    let found = of(&Measured { trains: vec![train.clone()], contact_time: Some(0.0), ..Measured::default() });
    assert!((found.restitution.value - 0.6).abs() < 1e-14 && found.restitution.std.is_none(), "{found:?}");
    // With exactly timed onsets too: one ratio does not show how R scatters.
    let timed = Train { onset_std: Some(1e-4), ..train };
    let found = of(&Measured { trains: vec![timed], contact_time: Some(0.0), ..Measured::default() });
    assert!(found.restitution.std.is_none() && finding(&found, "too-few-flights").is_some(), "{found:?}");
}

#[test]
fn growing_flights_are_refused() {
    let train = |intervals: Vec<f64>| Measured {
        trains: vec![Train { intervals, ..Train::default() }],
        ..Measured::default()
    };
    for grown in [vec![0.1, 0.2, 0.4], vec![0.3, 0.2, 0.25], vec![0.3, 0.2, 0.25, 0.1]] {
        assert!(restitution(&train(grown)).unwrap_err().to_string().contains("grow"));
    }
    // A growth below 4√6 standard uncertainties of an onset may be noise.
    let mut noisy = train(vec![0.3, 0.27, 0.243, 0.245, 0.2]);
    noisy.trains[0].onset_std = Some(1e-3);
    assert!(restitution(&noisy).is_ok());
    noisy.trains[0].onset_std = Some(1e-4);
    assert!(restitution(&noisy).is_err());
    // A stated height gives R although later flights grow: 0.9, as do the first two flights with 0.27/0.3.
    noisy.drop = Some(drop(9.80665 * (0.3f64 / 0.9).powi(2) / 8.0, 0.3));
    let found = of(&noisy);
    assert!(found.by.len() == 1 && finding(&found, "flight-times-ignored").is_some(), "{found:?}");
    // Where the first two flights give another R than the height, the sounds may not be the impacts.
    noisy.drop = Some(drop(0.57, 0.3));
    let found = of(&noisy);
    assert!(found.restitution.std.is_none() && finding(&found, "methods-far-apart").is_some(), "{found:?}");
}

/// A voice during the bounces after a fall of 0.5 m with R = 0.7, whose flights last 0.447 s and less: its
/// sounds, some 2.4 ms apart, lie between them.
#[test]
fn a_voice_among_bounces_is_doubted_and_a_hand_is_not() {
    let flights = (0..5).map(|k| 0.447 * 0.7f64.powi(k));
    let voice: Vec<f64> =
        [0.0025, 0.0024].into_iter().chain(flights.clone().flat_map(|f| [f, 0.0023])).collect();
    let mut heard = Measured {
        drop: Some(Drop { height_std: Some(1e-3), interval_std: Some(1e-5), ..drop(0.5, voice[0]) }),
        trains: vec![Train { intervals: voice, ..Train::default() }],
        ..Measured::default()
    };
    let found = of(&heard);
    assert_eq!(finding(&found, "drop-flights-grow").and_then(|f| f.get("n")), Some(5.0));
    assert_eq!((found.restitution.std, found.by.len()), (None, 1), "{found:?}");
    heard.drop = None;
    assert!(restitution(&heard).unwrap_err().to_string().contains("other sounds"));
    // A hand picks the body up 2 s later.
    let intervals = flights.chain([2.0, 1.5]).collect();
    heard.drop = Some(Drop { height_std: Some(1e-3), interval_std: Some(1e-5), ..drop(0.5, 0.447) });
    heard.trains = vec![Train { intervals, ..Train::default() }];
    let found = of(&heard);
    assert!((found.restitution.value - 0.7).abs() < 1e-3 && found.restitution.std.is_some(), "{found:?}");
}

#[test]
fn velocities_of_both_masses_and_by_momentum() {
    // 0.2 kg at 3 m/s on 0.5 kg at rest with R = 0.4.
    let (m1, m2, v, r) = (0.2, 0.5, 3.0, 0.4);
    let w1 = v * (m1 - r * m2) / (m1 + m2);
    let w2 = v * m1 * (1.0 + r) / (m1 + m2);
    let all = Velocities {
        before: (v, 0.0),
        after1: Some(w1),
        after2: Some(w2),
        masses: Some((m1, m2)),
        std: Some(0.01),
    };
    let found = of(&Measured { velocities: Some(all.clone()), ..Measured::default() });
    assert_eq!(found.by.len(), 3);
    assert!(
        found.agree == Some(true) && found.by.iter().all(|w| (w.restitution.value - r).abs() < 1e-14),
        "{found:?}"
    );
    // Expected uncertainty from numerical derivatives, for the method by momentum with the speed of mass 1.
    let alone = |v1: f64, v2: f64, w: f64| {
        let some = Velocities { before: (v1, v2), after1: Some(w), after2: None, ..all.clone() };
        of(&Measured { velocities: Some(some), ..Measured::default() }).restitution
    };
    let (h, u) = (1e-6, 0.01);
    let base = alone(v, 0.0, w1);
    let d = [alone(v + h, 0.0, w1), alone(v, h, w1), alone(v, 0.0, w1 + h)]
        .map(|x| (x.value - base.value) / h * u);
    let expected = d.iter().map(|d| d * d).sum::<f64>().sqrt();
    // Differences over 1e-6 have a truncation error of that size.
    assert!((base.std.unwrap() / expected - 1.0).abs() < 1e-5, "{base:?} {expected}");
    let why = |before, after1| {
        let v = Velocities { before, after1: Some(after1), masses: Some((m1, m2)), ..Velocities::default() };
        restitution(&Measured { velocities: Some(v), ..Measured::default() }).unwrap_err().to_string()
    };
    assert!(why((1.0, 2.0), 0.0).contains("do not approach"));
    assert!(why((3.0, 0.0), -3.0).contains("outside 0 to 1"));
}

#[test]
fn a_restitution_outside_its_range_within_its_uncertainty_is_an_answer() {
    let velocities = |after: (f64, f64), masses, std| Velocities {
        before: (1.0, 0.0),
        after1: Some(after.0),
        after2: Some(after.1),
        masses,
        std,
    };
    let of_velocities =
        |v: &Velocities| restitution(&Measured { velocities: Some(v.clone()), ..Measured::default() });
    // R = 0.005 by both speeds after, −0.0004 by that of mass 1 and 0.27 by that of mass 2.
    let plastic = velocities((0.02, 0.025), Some((1.0, 50.0)), Some(0.05));
    let found = of_velocities(&plastic).unwrap();
    assert!(found.by.len() == 3 && (found.by[1].restitution.value + 0.0004).abs() < 1e-9, "{found:?}");
    // R = 1.005, u = 0.02·√(2 + 2·1.005²) or less.
    let elastic = velocities((-0.3, 0.705), None, Some(0.02));
    assert!((of_velocities(&elastic).unwrap().restitution.value - 1.005).abs() < 1e-12);
    // Refused beyond 2 u, or where u is unknown.
    for std in [Some(0.001), None] {
        let sure = Velocities { std, ..elastic.clone() };
        assert!(of_velocities(&sure).unwrap_err().to_string().contains("outside 0 to 1"));
    }
    assert!(of_velocities(&Velocities { std: Some(1e-5), ..plastic }).is_err());
}

#[test]
fn methods_that_disagree_are_not_averaged() {
    let d = Drop { height_std: Some(0.001), interval_std: Some(0.001), ..drop(0.57, 0.144) };
    let intervals = vec![0.144, 0.072, 0.036, 0.018, 0.009];
    let train = Train { intervals, onset_std: Some(1e-4), ..Train::default() };
    let found =
        of(&Measured { drop: Some(d), trains: vec![train], contact_time: Some(0.0), ..Measured::default() });
    assert!(
        found.agree == Some(false) && found.restitution.value.is_nan() && found.by.len() == 2,
        "{found:?}"
    );
    assert!(finding(&found, "methods-disagree").is_some(), "{:?}", found.findings);
}

/// A height typed in mm, and a second impact that was missed: answers far apart disagree although none has
/// an uncertainty.
#[test]
fn answers_far_apart_disagree_without_uncertainties() {
    for (height, intervals) in [(570.0, vec![0.144, 0.03]), (0.57, vec![0.144, 0.015])] {
        let train = Train { intervals, ..Train::default() };
        let found = of(&Measured {
            drop: Some(drop(height, 0.144)),
            trains: vec![train],
            contact_time: Some(0.0),
            ..Measured::default()
        });
        assert!(found.agree == Some(false) && found.restitution.value.is_nan(), "{found:?}");
        assert!(finding(&found, "methods-far-apart").is_some(), "{:?}", found.findings);
    }
}

/// After a fall of 0.57 m with R = 0.8 the flights are 2 √(2h/g) Rⁿ. In a record that begins with the second
/// impact, height and first flight give R² instead of R.
#[test]
fn a_record_that_begins_with_the_second_impact_is_told_by_the_square() {
    let flight = |n: i32| 2.0 * (2.0 * 0.57 / GRAVITY).sqrt() * 0.8f64.powi(n);
    for first in [1, 2] {
        let intervals: Vec<f64> = (first..first + 5).map(flight).collect();
        let d = Drop { height_std: Some(0.002), ..drop(0.57, intervals[0]) };
        let train = Train { intervals, onset_std: Some(1e-4), ..Train::default() };
        let found = of(&Measured {
            drop: Some(d),
            trains: vec![train],
            contact_time: Some(0.0),
            ..Measured::default()
        });
        assert_eq!(found.agree, Some(first == 1), "{found:?}");
        assert_eq!(finding(&found, "first-impact-unheard").is_some(), first == 2, "{:?}", found.findings);
    }
}

#[test]
fn what_cannot_be_compared_is_left_open() {
    let alone = Train { intervals: vec![0.5, 0.4, 0.32, 0.256, 0.2048], ..Train::default() };
    let found = of(&Measured { trains: vec![alone], contact_time: Some(0.0), ..Measured::default() });
    assert_eq!((found.agree, found.by.len()), (None, 1), "{found:?}");
    let train = Train { intervals: vec![0.144, 0.03], ..Train::default() };
    let d = Drop { interval_std: Some(0.001), height_std: Some(0.001), ..drop(0.57, 0.144) };
    let found =
        of(&Measured { drop: Some(d), trains: vec![train], contact_time: Some(0.0), ..Measured::default() });
    assert!(found.agree.is_none() && found.restitution.value.is_finite(), "{found:?}");
}

#[test]
fn two_drops_have_no_uncertainty_and_five_a_bootstrap() {
    let drops = |intervals: &[f64]| {
        let d =
            Drop { height: 0.57, height_std: Some(1e-3), intervals: intervals.to_vec(), ..Drop::default() };
        of(&Measured { drop: Some(d), contact_time: Some(0.0), ..Measured::default() })
    };
    let all = [0.140, 0.142, 0.144, 0.146, 0.148];
    let found = drops(&all[..2]);
    assert!(found.restitution.std.is_none() && found.bootstrap_std.is_none(), "{found:?}");
    assert!(finding(&found, "drop-without-uncertainty").is_some(), "{:?}", found.findings);
    // Three drops: s = 2 ms. With two degrees of freedom, Student's quantile for a coverage c is c√(2/(1 −
    // c²)), against 1.96 of the normal distribution at c = 0.95. The height adds half of its relative
    // uncertainty 1/570. Quantiles are computed to 1e-9.
    let found = drops(&all[..3]).restitution;
    let student = 0.95 * (2.0 / (1.0 - 0.95f64.powi(2))).sqrt();
    let timing = student / 1.959_963_984_540_054 * 2e-3 / 3f64.sqrt() / 0.142;
    let expected = found.value * timing.hypot(0.5e-3 / 0.57);
    assert!((found.std.unwrap() / expected - 1.0).abs() < 1e-8, "{found:?}");
    assert!(drops(&all[..4]).restitution.std.is_some());
    let found = drops(&all);
    // Variance of the mean of a bootstrap sample: Σd²/n² = 40e-6/25. Over 2000 samples it scatters by
    // 1/√4000 = 1.6 %; tolerance: four times that.
    let expected = (40e-6f64 / 25.0).sqrt() / 0.144 * found.restitution.value;
    assert!((found.bootstrap_std.unwrap() / expected - 1.0).abs() < 0.064, "{found:?}");
}

#[test]
fn two_drops_have_an_uncertainty_only_where_what_is_stated_explains_their_scatter() {
    let of_two = |stated: f64| {
        let d = Drop {
            height: 0.57,
            height_std: Some(1e-3),
            intervals: vec![0.142, 0.146],
            interval_std: Some(stated),
            ..Drop::default()
        };
        of(&Measured { drop: Some(d), contact_time: Some(0.0), ..Measured::default() })
    };
    // Σ(d − d̄)² = 8e-6 s²: χ² with one degree of freedom exceeds 3.841, its 95 % quantile, where the stated
    // uncertainty is below 1.443 ms.
    assert!(of_two(1.45e-3).restitution.std.is_some());
    let found = of_two(1.43e-3);
    assert!(found.restitution.std.is_none(), "{found:?}");
    assert!(finding(&found, "drop-without-uncertainty").is_some(), "{:?}", found.findings);
}

/// A first flight shows one bounce: its uncertainty is at least the scatter of R, however well the onsets are
/// timed. If only R scatters, the logarithms of the ratios of successive flights have the variance s², those
/// of two first flights 2s², and all are independent.
#[test]
fn a_drop_is_no_surer_than_the_flights_behind_it_scatter() {
    let of_drops = |trains: &[&[f64]]| {
        let train = |t: &&[f64]| Train { intervals: t.to_vec(), onset_std: Some(1e-6), ..Train::default() };
        let trains: Vec<Train> = trains.iter().map(train).collect();
        // The height of a fall with R = 0.75, as the flights have it: the methods agree.
        let height = GRAVITY * (0.4f64 / 0.75).powi(2) / 8.0;
        let drop = Drop { height, height_std: Some(1e-6), ..Drop::default() }.beginning(&trains);
        let found =
            of(&Measured { drop: Some(drop), trains, contact_time: Some(0.0), ..Measured::default() });
        let drop = found.by.into_iter().find(|way| way.method == "drop").unwrap().restitution;
        drop.std.unwrap() / drop.value
    };
    let log = |a: f64, b: f64| (b / a).ln();
    // Two ratios: one degree of freedom.
    let s = (log(0.4, 0.3) - log(0.3, 0.22)).abs() / 2f64.sqrt();
    let one = of_drops(&[&[0.4, 0.3, 0.22]]) / (12.706_205 / 1.959_964 * s);
    // One ratio in each train, and that of the first flights: two degrees of freedom.
    let squares = (log(0.4, 0.3) - log(0.402, 0.297)).powi(2) / 2.0 + log(0.4, 0.402).powi(2) / 2.0;
    let two = of_drops(&[&[0.4, 0.3], &[0.402, 0.297]])
        / (4.302_653 / 1.959_964 * (squares / 2.0).sqrt() / 2f64.sqrt());
    // The onsets, uncertain by 1 µs, add a relative (√2e-6/0.4/0.01)²/2 = 6e-8, and the height no more.
    assert!((one - 1.0).abs() < 1e-6 && (two - 1.0).abs() < 1e-6, "{one} {two}");
}

/// Three trains with R = 0.6 and three with 0.8 come from two bodies, six with 0.6 from one. R scatters by
/// 1 % from bounce to bounce.
#[test]
fn trains_of_two_bodies_are_said_to_differ() {
    let mut noise = vibro_math::Noise::new(41);
    let mut of_trains = |r: [f64; 6]| {
        let mut train = |r: f64| {
            let next = |flight: &f64| Some(flight * r * (0.01 * noise.normal()).exp());
            let intervals = std::iter::successors(Some(0.4), next).take(6).collect();
            Train { intervals, onset_std: Some(1e-6), ..Train::default() }
        };
        let trains = r.map(&mut train).to_vec();
        of(&Measured { trains, contact_time: Some(0.0), ..Measured::default() })
    };
    let two = of_trains([0.6, 0.6, 0.6, 0.8, 0.8, 0.8]);
    let found = finding(&two, "trains-differ").expect("said");
    // A scatter of 1 % per bounce over five ratios leaves 0.45 % of R.
    let off = [("low", 0.6), ("high", 0.8)].map(|(end, r)| (found.get(end).unwrap() / r - 1.0).abs());
    assert!(off.iter().all(|off| *off < 0.02), "{off:?}");
    assert!(finding(&of_trains([0.6; 6]), "trains-differ").is_none());
}

/// Plastic contact: R falls with the fifth root of the speed (K. L. Johnson, *Contact Mechanics*, 1985, eq.
/// 11.47), to which a flight time is proportional. A steady R that scatters by 2 % may be reported as
/// changing in one of a hundred trains. The quantile 0.9995 gives none in forty trains with a probability of
/// 96 %.
#[test]
fn a_restitution_that_depends_on_speed_is_said_to_change() {
    let changes = |intervals: Vec<f64>| {
        let trains = vec![Train { intervals, onset_std: Some(1e-5), ..Train::default() }];
        let found = of(&Measured { trains, contact_time: Some(0.0), ..Measured::default() });
        finding(&found, "restitution-changes").map(|f| [f.get("first").unwrap(), f.get("last").unwrap()])
    };
    let by_speed = |flight: &f64| Some(flight * 0.78 * (flight / 0.6).powf(-0.2));
    let [first, last] = changes(std::iter::successors(Some(0.6), by_speed).take(8).collect()).expect("said");
    // ln R = −0.2 ln v, and ln v is not linear in the number of the bounce: it bends by a tenth of its fall.
    let truth = [0.78, 0.78 * 0.78f64.powf(-0.2 * (0..6).map(|k| 0.8f64.powi(k)).sum::<f64>())];
    assert!(first / truth[0] - 1.0 < 0.03 && last > first + 0.05 && (last / truth[1] - 1.0).abs() < 0.03);
    let mut noise = vibro_math::Noise::new(42);
    let mut steady = || {
        let next = |flight: &f64| Some(flight * 0.78 * (0.02 * noise.normal()).exp());
        std::iter::successors(Some(0.6), next).take(8).collect::<Vec<f64>>()
    };
    let said = (0..40).filter(|_| changes(steady()).is_some()).count();
    assert!(said <= 1, "{said}");
}

#[test]
fn there_is_no_uncertainty_without_that_of_the_height_and_of_the_timing() {
    let of_drops = |height_std: Option<f64>, interval_std: Option<f64>, intervals: &[f64]| {
        let d =
            Drop { height: 0.57, height_std, interval_std, intervals: intervals.to_vec(), ..Drop::default() };
        of(&Measured { drop: Some(d), contact_time: Some(0.0), ..Measured::default() })
    };
    let four = [0.140, 0.142, 0.144, 0.146];
    for intervals in [&four[..1], &four] {
        let found = of_drops(None, Some(1e-6), intervals);
        assert!(found.restitution.std.is_none(), "{found:?}");
        assert!(finding(&found, "drop-without-uncertainty").is_some(), "{:?}", found.findings);
        assert!(of_drops(Some(1e-3), Some(1e-6), intervals).restitution.std.is_some());
    }
    // Variance of the mean Σd²/(n(n − 1)) = 20e-6/12; Student's distribution of 3 degrees of freedom has the
    // standard deviation √3.
    let timing = (20e-6f64 / 12.0 * 3.0).sqrt() / 0.143 * of_drops(None, None, &four).restitution.value;
    let found = of_drops(None, None, &four);
    let alone = finding(&found, "drop-without-uncertainty").unwrap().get("timing").unwrap();
    assert!((alone / timing - 1.0).abs() < 1e-12, "{alone} {timing}");
    let found = of_drops(Some(1e-4), None, &four[..1]);
    assert!(found.restitution.std.is_none(), "{found:?}");
    assert!(finding(&found, "drop-without-uncertainty").is_some(), "{:?}", found.findings);
    assert!(of_drops(Some(1e-4), None, &four).restitution.std.is_some());
}

/// Five equal first flights, and a height that was read 5 mm too high. Without an uncertainty of the height,
/// drop and train cannot disagree.
#[test]
fn drops_without_the_uncertainty_of_their_height_do_not_disagree_with_a_train() {
    let flights = [0.4, 0.248, 0.153_8, 0.095_3, 0.059_1, 0.036_6];
    let d = |height_std| Drop { height: 0.515, height_std, intervals: vec![0.4; 5], ..Drop::default() };
    let train = || Train { intervals: flights.to_vec(), ..Train::default() };
    let found = of(&Measured {
        drop: Some(d(None)),
        trains: vec![train(); 2],
        contact_time: Some(0.0),
        ..Measured::default()
    });
    assert!(found.agree.is_none() && found.restitution.value.is_finite(), "{found:?}");
    assert_eq!(found.restitution.method, found.by[1].restitution.method);
    let found = of(&Measured {
        drop: Some(d(Some(0.01))),
        trains: vec![train(); 2],
        contact_time: Some(0.0),
        ..Measured::default()
    });
    assert_eq!(found.agree, Some(true), "{found:?}");
}

#[test]
fn findings_of_steady_trains_do_not_concern_bounces() {
    use crate::impacts::{ImpactsOptions, impacts};
    use vibro_record::{Axis, Meta, Trace};
    let times: Vec<f64> = (0..8).map(|k| 0.1 + 0.4 * (1.0 - 0.7f64.powi(k)) / 0.3).collect();
    let pulse = |t: f64| (-0.5 * (t / 5e-4).powi(2)).exp();
    let values = (0..15_000).map(|i| times.iter().map(|at| pulse(f64::from(i) * 1e-4 - at)).sum()).collect();
    let meta = Meta::new("contact", Unit::parse("V").unwrap());
    let trace = Trace { meta, axis: Axis::time(0.0, 1e-4, 15_000), values };
    let concerns = ["impacts-irregular", "intervals-drift", "impacts-bounce"];
    let irregular = |findings: &[Finding]| findings.iter().any(|f| concerns.contains(&f.code.as_ref()));
    let steady = impacts(&trace, &ImpactsOptions::default()).unwrap().findings;
    assert!(irregular(&steady) && steady.iter().any(|f| f.code == "impacts-bounce"), "{steady:?}");
    let found = Train::of(&trace, &ImpactsOptions::default(), None).unwrap().1;
    assert!(found.times.len() == 8 && !irregular(&found.findings), "{:?}", found.findings);
}

/// Force of a ball of restitution `r` dropped from 0.3 m: half sines of `contact` s, their heights
/// proportional to the speed. Noise is added, and hum of this amplitude whose frequency varies, so that it
/// cannot be removed as a sine.
fn force(r: f64, contact: f64, hum: f64, seed: u64) -> Trace {
    let (rate, mut noise) = (20_000.0, vibro_math::Noise::new(seed));
    let (mut speed, mut at, mut begins) = ((2.0 * GRAVITY * 0.3f64).sqrt(), 0.4, Vec::new());
    let mut values: Vec<f64> = Vec::new();
    while begins.len() < 8 {
        begins.push((at, speed));
        speed *= r;
        at += contact + 2.0 * speed / GRAVITY;
    }
    let mut phase = noise.uniform();
    for i in 0..((at + 0.3) * rate) as usize {
        let t = i as f64 / rate;
        phase += (50.0 + 3.0 * (9.0 * t).sin()) / rate;
        values.push(2e-3 * noise.normal() + hum * (std::f64::consts::TAU * phase).sin());
    }
    for (at, speed) in &begins {
        for (i, v) in
            values.iter_mut().enumerate().skip((at * rate) as usize + 1).take((contact * rate) as usize)
        {
            *v += speed * (std::f64::consts::PI * (i as f64 / rate - at) / contact).sin();
        }
    }
    let meta = Meta::new("force", Unit::parse("N").unwrap());
    let axis = Axis::time(0.0, 1.0 / rate, values.len());
    Trace { meta, axis, values }
}

fn train_in(trace: &Trace) -> Train {
    let how = ImpactsOptions { threshold: Some(Train::THRESHOLD), ..Default::default() };
    Train::of(trace, &how, None).unwrap().0
}

/// A height in mm, or a thousand times too large: it is named, with the one that the flights fit.
#[test]
fn a_height_that_the_flights_contradict_is_named_first() {
    let how = ImpactsOptions { threshold: Some(Train::THRESHOLD), ..Default::default() };
    let full = |height| Drop { height, ..Drop::default() }.full_flight();
    let trace = force(0.6, 1e-3, 0.0, 4);
    assert!(Train::of(&trace, &how, full(0.3)).is_ok());
    for (typed, meant) in [(30.0, "0.3 m (30 cm)"), (300.0, "0.3 m (300 mm)")] {
        let refused = Train::of(&trace, &how, full(typed)).unwrap_err();
        assert!(refused.to_string().contains(&format!("did you mean {meant}?")), "{refused}");
        assert_eq!(refused.settings().collect::<Vec<_>>(), ["height"], "{refused}");
    }
    let refused = Train::of(&trace, &how, full(500.0)).unwrap_err();
    assert_eq!(refused.settings().collect::<Vec<_>>(), ["height"], "{refused}");
    let text = refused.to_string();
    let fit = text.split("fit a fall of ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    // The contact of 1 ms makes the first flight of 0.3 s longer by 0.4 % and the second by 0.7 %: R is off
    // by 0.3 % and the height by 2·(0.4 + 0.3) %. Three digits are shown.
    let height: f64 = fit.parse().unwrap();
    let height = if text.contains(&format!("{fit} mm")) { 1e-3 * height } else { height };
    assert!((height / 0.3 - 1.0).abs() < 0.02, "{text}");
}

#[test]
fn a_contact_longer_than_a_flight_is_refused_by_its_key() {
    let train = Train { intervals: vec![0.586, 0.4, 0.28], ..Train::default() };
    let drop = Some(drop(0.57, 0.586));
    for measured in
        [Measured { trains: vec![train], ..Measured::default() }, Measured { drop, ..Measured::default() }]
    {
        let refused = restitution(&Measured { contact_time: Some(5.0), ..measured }).unwrap_err();
        assert_eq!(refused.settings().collect::<Vec<_>>(), ["contact_time"], "{refused}");
        assert!(
            refused.to_string().contains("a contact time of 5.00 s is no shorter than the flight of"),
            "{refused}"
        );
    }
}

#[test]
fn a_contact_that_the_force_shows_is_taken_off() {
    for (seed, contact) in [(1, 0.5e-3), (2, 2e-3), (3, 5e-3)] {
        let train = train_in(&force(0.75, contact, 0.0, seed));
        let seen = train.contact.clone().unwrap();
        assert!((seen.value - contact).abs() < 2.0 * seen.std.unwrap(), "{seen:?} for {contact}");
        let found = of(&Measured { trains: vec![train.clone()], ..Measured::default() });
        let off = (found.restitution.value - 0.75).abs();
        assert!(off < 2.0 * found.restitution.std.unwrap(), "{contact}: {:?}", found.restitution);
        assert!(
            finding(&found, "contact-time-seen").is_some()
                && finding(&found, "contact-time-unsaid").is_none()
        );
        // A stated contact time is used instead.
        let stated =
            of(&Measured { trains: vec![train], contact_time: Some(contact), ..Measured::default() });
        assert!(
            finding(&stated, "contact-time-seen").is_none() && (stated.restitution.value - 0.75).abs() < 5e-4
        );
    }
}

/// A contact c adds c/Δt to the logarithm of each flight: over n flights ln R is too large by
/// c(1/Δtₙ − 1/Δt₁)/(n − 1).
#[test]
fn the_bias_by_contact_is_that_of_the_fit() {
    let (r, c) = (0.7f64, 1e-4);
    let flights: Vec<f64> = (0..5).map(|k| 0.4 * r.powi(k)).collect();
    let train = |c: f64| Train { intervals: flights.iter().map(|f| f + c).collect(), ..Train::default() };
    let one = |c: f64, stated| {
        of(&Measured { trains: vec![train(c)], contact_time: stated, ..Measured::default() })
    };
    let Some(Fact::Numbers(parts)) =
        finding(&one(c, None), "contact-time-unsaid").unwrap().fact("parts").cloned()
    else {
        panic!()
    };
    let moved = one(c, Some(0.0)).restitution.value / r - 1.0;
    // Without onset noise the fit is the mean of the ratios. Tolerance: terms of second order in c over the
    // last flight, 1e-4/0.096, and the weights of the fit.
    assert!((parts[0] * c / 1e-3 / moved - 1.0).abs() < 0.1, "{parts:?} {moved}");
}

#[test]
fn bounces_below_hum_are_found_above_it() {
    let train = train_in(&force(0.81, 0.4e-3, 8.0, 5));
    assert!(train.intervals.len() >= 3, "{train:?}");
    let found = of(&Measured { trains: vec![train], ..Measured::default() });
    let (value, std) = (found.restitution.value, found.restitution.std);
    assert!(std.is_none_or(|std| (value - 0.81).abs() < 2.0 * std), "{value} {std:?}");
}

/// A ratio of flights does not depend on the error of the clock; R from height and flight does.
#[test]
fn the_clock_is_in_what_depends_on_it() {
    let (r, clock) = (0.7, 1e-3);
    let first = 2.0 * r * (2.0 * 0.57 / GRAVITY).sqrt();
    let train = |clock| Train {
        intervals: (0..6).map(|k| first * f64::powi(r, k)).collect(),
        onset_std: Some(1e-7),
        clock,
        ..Train::default()
    };
    let answer = |clock| {
        let trains = vec![train(clock)];
        let fell = Drop { height: 0.57, height_std: Some(1e-6), ..Drop::default() }.beginning(&trains);
        of(&Measured { drop: Some(fell), trains, contact_time: Some(0.0), ..Measured::default() })
    };
    let (exact, uncertain) = (answer(0.0), answer(clock));
    let std = |found: &Restitution, way: usize| found.by[way].restitution.std.unwrap();
    assert!(
        (std(&uncertain, 0) / std(&exact, 0).hypot(clock * uncertain.by[0].restitution.value) - 1.0).abs()
            < 1e-9
    );
    assert_eq!(std(&uncertain, 1), std(&exact, 1));
}

/// Flights that differ in the fourth digit are printed with four.
#[test]
fn flights_of_rivals_show_that_they_differ() {
    assert_eq!(train::apart([0.76712, 0.76743]), ["0.7671 s", "0.7674 s"]);
    assert_eq!(train::apart([0.1, 0.2]), ["0.100 s", "0.200 s"]);
}

/// Two drops in one record: the part that the error proposes holds the bounces of one of them.
#[test]
fn an_advice_was_tried() {
    let rate = 8000.0;
    let mut values = vec![0.0; 30_000];
    let bounces = [0.3, 0.72, 1.014, 1.22, 2.3, 2.72, 3.014, 3.22];
    for (k, time) in bounces.into_iter().enumerate() {
        let from = (time * rate) as usize;
        for (i, v) in values[from..].iter_mut().enumerate().take(400) {
            *v += 0.7f64.powi((k % 4) as i32) * (-(i as f64) / 60.0).exp() * (0.9 * i as f64).cos();
        }
    }
    let axis = Axis::time(0.0, 1.0 / rate, values.len());
    let trace = Trace { meta: Meta::new("sound", Unit::none()), axis, values };
    let how = ImpactsOptions { threshold: Some(Train::THRESHOLD), ..Default::default() };
    let refused = Train::of(&trace, &how, None).unwrap_err();
    assert_eq!(refused.code(), Some(Train::UNTOLD));
    let advice = refused.settings_with(|key, value| format!("{key} = {value}")).concat();
    let (_, span) = advice.split_once("span = [").expect("a part is named");
    let ends: Vec<f64> = span.split([',', ']']).filter_map(|end| end.trim().parse().ok()).collect();
    let part = trace.axis.between(ends[0], ends[1]);
    let part = Trace {
        axis: trace.axis.part(part.clone()),
        values: trace.values[part].to_vec(),
        meta: trace.meta.clone(),
    };
    let (train, _) = Train::of(&part, &how, None).unwrap();
    // Onsets are timed to a sample or two.
    assert!((train.intervals[1] / train.intervals[0] - 0.7).abs() < 0.005, "{:?}", train.intervals);
}
