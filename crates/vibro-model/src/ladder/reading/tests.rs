use super::{BRIEF, MotionReader, Settling, drifts, mean};
use crate::excitation::{Excitation, Sine};
use crate::flow::State;
use crate::ladder::Question;
use crate::ladder::question::APART;
use crate::ladder::tests::fastest;
use crate::motion::Motion;
use crate::observable::Observable;
use crate::orbit::no_impact;
use crate::rig::Rig;
use crate::simulate::Simulation;
use std::f64::consts::TAU;
use vibro_math::Noise;
use vibro_math::runge_kutta::{Dop853, Integrator, Tolerance};

/// Values x ← ρx + noise with uniform noise: an autoregression; the mean of n values has the variance
/// σ²(1 + ρ)/(1 − ρ)/n.
fn correlated(seed: u64, n: usize, rho: f64) -> Vec<[f64; 2]> {
    let mut noise = Noise::new(seed);
    let mut even = || noise.uniform() - 0.5;
    let mut x = 0.0;
    let all: Vec<f64> = (0..n + 100)
        .map(|_| {
            x = rho * x + even();
            x
        })
        .collect();
    all[100..].iter().map(|x| [10.0 + x; 2]).collect()
}

#[test]
fn a_standard_error_covers_what_it_should() {
    // Of 1000 means of 32 values with a correlation of 0.3, about 5 % should be farther than two standard
    // errors from the true mean; with estimated errors it is 8 ± 1 %. If the values counted as independent,
    // the errors would be smaller by √(1.3/0.7) = 1.36, and 15 % would be outside.
    let far = |rho: f64| {
        let outside = |seed: u64| {
            let found = mean(&correlated(seed, 32, rho), true);
            (found.value[0] - 10.0).abs() > 2.0 * found.spread[0]
        };
        (1..=1000).filter(|seed| outside(*seed)).count()
    };
    assert!(far(0.0) < 80 && far(0.3) < 120, "{} {}", far(0.0), far(0.3));
}

#[test]
fn many_means_of_one_motion_are_not_told_apart() {
    // 500 sets of twenty pairs. With two known standard errors, 1 − 0.954²⁰ = 61 % of the sets have a pair
    // that differs. Estimated errors are never smaller than those of independent values, and often larger:
    // fewer sets have such a pair, but more than a quarter. With `APART`, which allows for all comparisons
    // of a search, 1 % of the sets (5 ± 2.2) may have one.
    let question = Question { tolerance: 1e-4, ..Question::new(Observable::Fundamental) };
    let told = |errors: f64| {
        let pair = |seed: u64| {
            let [a, b] = [2 * seed, 2 * seed + 1].map(|seed| mean(&correlated(seed, 32, 0.0), true));
            !a.agrees(&b, &question, errors)
        };
        (0..500).filter(|set| (20 * set..20 * set + 20).any(pair)).count()
    };
    assert!(told(2.0) > 125 && told(APART) < 12, "{} {}", told(2.0), told(APART));
}

#[test]
fn a_drift_is_told_from_scatter() {
    let told = |rho: f64, slope: f64| {
        let one = |seed: u64| {
            let mut values = correlated(seed, 32, rho);
            for (i, v) in values.iter_mut().enumerate() {
                *v = v.map(|v| v + slope * i as f64);
            }
            drifts(&values)
        };
        (1..=1000).filter(|seed| one(*seed)).count()
    };
    // Φ(−2.5) = 0.6 % of independent values; a total rise of ten standard deviations (0.29 each) is always
    // detected.
    assert!(told(0.0, 0.0) < 15, "{}", told(0.0, 0.0));
    assert_eq!(told(0.0, 5.0 * 0.29 / 32.0 * 2.0), 1000);
    // Few values suffice: a straight line of six has the ratio 5/17.5.
    let line: Vec<[f64; 2]> = (0..6).map(|i| [f64::from(i); 2]).collect();
    assert!(drifts(&line) && !drifts(&[[1.0; 2]; 6]));
}

/// First time in s at which x₁ of mass 1 alone, from rest, reaches the gap: by numerical integration,
/// independent of the flights.
fn first_touch(rig: &Rig, sine: &Sine, until: f64) -> f64 {
    let omega = TAU * sine.frequency;
    let rate = |t: f64, y: &[f64; 2]| {
        [y[1], (sine.force * (omega * t).cos() - rig.k1 * y[0] - rig.c1 * y[1]) / rig.m1]
    };
    let tolerance = Tolerance { relative: 1e-10, floor: [rig.gap, rig.gap * omega] };
    let mut plain = Integrator::<Dop853, 2>::new(rate, 0.0, [0.0; 2], 1e-3, tolerance);
    while plain.time() < until {
        let start = plain.time();
        let step = plain.step(rate, until).unwrap();
        if let Some(t) = step.first_fall(&[-1.0, 0.0], rig.gap) {
            return start + t;
        }
    }
    f64::INFINITY
}

#[test]
fn a_slow_growth_towards_the_gap_is_not_the_end() {
    // Little damping at resonance: the amplitude A(1 − e^{−bt}) with A = 1.3 mm exceeds the gap of 1 mm only
    // after 1900 cycles. Until then there is no impact, and every impact speed is 0.
    let rig = Rig { c1: 1e-3, c2: 1e-3, ..Rig::thesis() };
    let sine = Sine { force: 4.272_235_95e-5, frequency: 5.230_365_15 };
    let found = no_impact(&rig, &Excitation::Sine(sine)).unwrap();
    let decay = rig.c1 / (2.0 * rig.m1);
    let closed = -(1.0 - rig.gap / found.largest).ln() / decay;
    let touched = first_touch(&rig, &sine, 2.0 * closed);
    // The amplitude grows by bA a second: the tolerance covers a cycle more or less, and the detuning of a
    // damped resonance.
    assert!((touched / closed - 1.0).abs() < 0.01 && touched * sine.frequency > 1800.0, "{touched} {closed}");
    let question = Question::new(Observable::ImpactSpeed);
    let clearance = Some(rig.gap - found.largest);
    let reader = MotionReader { clearance, ..MotionReader::new(&rig, sine.frequency, &question) };
    let mut motion = Simulation::new(&rig, &sine).unwrap();
    let reading = reader.read(&mut motion).unwrap();
    assert!(f64::from(reading.cycles) > touched * sine.frequency && reading.speed > 0.0, "{reading:?}");
    // The state alone is enough: without the clearance the reading lasts as long.
    let blind =
        MotionReader::new(&rig, sine.frequency, &question).read(&mut Simulation::new(&rig, &sine).unwrap());
    assert!(f64::from(blind.unwrap().cycles) > touched * sine.frequency);
}

#[test]
fn a_motion_that_ends_a_thousandth_beyond_the_gap_does_not_settle_without_impacts() {
    let rig = Rig::thesis();
    let unit = no_impact(&rig, &Excitation::Sine(Sine { force: 1.0, frequency: 9.0 })).unwrap().largest;
    let question = Question::new(Observable::ImpactSpeed);
    let read = |part: f64| {
        let sine = Sine { force: part * rig.gap / unit, frequency: 9.0 };
        let clearance = Some(rig.gap * (1.0 - part));
        let reader = MotionReader { clearance, ..MotionReader::new(&rig, 9.0, &question) };
        reader.read(&mut Simulation::new(&rig, &sine).unwrap()).unwrap()
    };
    let over = read(1.001);
    assert!(over.speed > 0.0 || over.end == Settling::Under, "{over:?}");
    // Well below the gap the motion settles, when e^{−bt} has fallen to the required part.
    let under = read(0.5);
    assert!(under.end == Settling::Settled && under.speed == 0.0, "{under:?}");
}

#[test]
fn a_pattern_that_no_block_holds_whole_is_read_whole() {
    // Four impacts in eight cycles, in blocks of sixty cycles: the reference speeds are read directly.
    let (rig, sine) = (Rig::thesis(), Sine { force: 0.3, frequency: 12.9701 });
    let state = State { x1: -4e-3, v1: 0.3, x2: -1e-3, v2: -0.2 };
    let start = Simulation::from_state(&rig, &sine, state, 0.0).unwrap();
    let question = Question { tolerance: 1e-3, ..Question::new(Observable::ImpactSpeed) };
    let reading = MotionReader::new(&rig, sine.frequency, &question).read(&mut start.clone()).unwrap();
    assert_eq!((reading.end, reading.regime.to_string().as_str()), (Settling::Settled, "4/8"));
    let mut motion = start;
    motion.run(4000.0 / sine.frequency, |_| {}).unwrap();
    let mut speeds = Vec::new();
    let until = motion.time() + 8.0 / sine.frequency;
    motion.run(until, |leg| speeds.extend(leg.impact().map(|i| i.approach_velocity))).unwrap();
    assert_eq!(speeds.len(), 4);
    let mean = speeds.iter().sum::<f64>() / 4.0;
    // Settled to 2 % of the tolerance.
    assert!((reading.answer.value[0] / mean - 1.0).abs() < 2e-5, "{} {mean}", reading.answer.value[0]);
    // A block of 60 cycles holds four cycles more than whole patterns of 8: a mean over one block would be
    // off by up to 4/60 of the spread of the speeds.
    assert!(speeds.iter().any(|v| (v / mean - 1.0).abs() > 0.05), "{speeds:?}");
}

#[test]
fn a_pattern_longer_than_a_brief_reading_is_read_to_its_end() {
    // Nine impacts in thirteen cycles: whole patterns need thirteen blocks of sixty cycles, more than the
    // twelve of a brief reading.
    let (rig, frequency) = (Rig { restitution: 0.664_347_826_087, ..Rig::thesis() }, 14.235_294_117_647);
    let mut motion = Simulation::new(&rig, &Sine { force: 0.9, frequency }).unwrap();
    motion.run(6000.0 / frequency, |_| {}).unwrap();
    let question = Question::new(Observable::ImpactSpeed);
    let reader = MotionReader::new(&rig, frequency, &question);
    let reading = MotionReader { blocks: reader.blocks.min(BRIEF), ..reader }.read(&mut motion).unwrap();
    assert_eq!((reading.end, reading.regime.to_string().as_str()), (Settling::Settled, "9/13"));
    let speeds = fastest(&mut motion, 13);
    let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
    // Settled to 2 % of the tolerance.
    assert!((reading.answer.value[0] / mean - 1.0).abs() < 4e-4, "{reading:?} {mean}");
    // Three means over thirteen blocks each need fifteen blocks.
    assert_eq!(reading.cycles, 15 * 60);
}
