//! Benchmark scenes of models: the question, the methods with their settings, and the truth.

mod chaos;

use super::rivals::{self as by, IntegratorKind, Locate, Method, events};
use super::task::{Log, Task};
use super::{ours, truth};
use crate::results::Measurement;
use crate::{BenchmarkScene, Family, MeasuredMethod, OutcomeWithReason, timed};
use std::f64::consts::TAU;
use vibro_model::{Compliance, Rig, Sine, Steady};
use vibro_record::{Error, Result, median};

/// The error of a method's answer, or the reason why it has none.
type Verdict = std::result::Result<f64, String>;
/// Compares the logs of all tasks with the truth.
type Judge = dyn Fn(&[Log]) -> Verdict;

/// A method with the settings to run.
type Run = (Method, &'static [f64]);

/// A scene before it is measured.
struct Setup {
    scene: BenchmarkScene,
    /// Motions that are followed one after another; the time of one answer is their mean.
    tasks: Vec<Task>,
    methods: Vec<Run>,
    judge: Box<Judge>,
}

/// Repetitions of an answer in a full and in a quick run; their median time is reported.
const REPETITIONS: [usize; 2] = [15, 3];

impl Setup {
    /// Runs, times and judges every method; with `quick`, for the first half of its settings only.
    fn measured(self, quick: bool) -> BenchmarkScene {
        let measure = |method: &Method, setting: f64| {
            let follow = || self.tasks.iter().map(|task| (method.follow)(task, setting)).collect();
            let (log, time) = timed(REPETITIONS[usize::from(quick)], quick, follow);
            let fault = |f: OutcomeWithReason| format!("{}: {}", f.outcome.name(), f.why);
            let log: std::result::Result<Vec<_>, OutcomeWithReason> = log;
            let answer = log.map_err(fault).and_then(|log| (self.judge)(&log));
            let (name, setting) = ((method.name, method.ours), method.words(setting));
            let measured = MeasuredMethod::new(name, setting, time / self.tasks.len() as f64, answer);
            MeasuredMethod { other_program: method.other_program, ..measured }
        };
        let count = |settings: &[f64]| if quick { settings.len().div_ceil(2) } else { settings.len() };
        let methods =
            self.methods.iter().flat_map(|(m, all)| all[..count(all)].iter().map(|s| measure(m, *s)));
        BenchmarkScene { methods: methods.collect(), ..self.scene }
    }
}

/// Every scene of the models, still to be measured; `quick` takes fewer settings, repeats and scenes.
pub fn scenes(quick: bool) -> Vec<Measurement> {
    fn of(quick: bool, setup: impl FnOnce() -> Result<Setup> + 'static) -> Measurement {
        Box::new(move || Ok(setup()?.measured(quick)))
    }
    let depths: &[f64] = if quick { &[1e-6, 1e-12] } else { &[1e-3, 1e-6, 1e-9, 1e-12] };
    let mut all = vec![of(quick, || scene_b(2.0)), of(quick, || scene_b(100.0))];
    all.extend(depths.iter().map(|depth| of(quick, || grazing(*depth))));
    all.push(of(quick, || Ok(scene_c())));
    all.extend(SOFT_CONTACTS.map(|(stiffness, cycles)| of(quick, move || soft(stiffness, cycles))));
    all.extend([of(quick, chaos::scene), of(quick, slow_sweep)]);
    all
}

/// Settings of a method that has none: it is run once.
const NO_SETTING: &[f64] = &[0.0];

/// Methods with fixed steps, by the steps per cycle; the largest numbers take about a second.
const LOOPS: [Run; 3] =
    [(by::EULER, &[100.0, 1e3, 1e4]), (by::RK4_LOOP, &[100.0, 1e3, 1e4]), (by::MOREAU, &[100.0, 1e3, 1e4])];
/// Methods that locate impacts, by their relative tolerances.
const EVENTS: &[Run] = &[
    (by::RK45_ENDS, &[1e-3, 1e-6, 1e-9, 1e-12]),
    (by::RK45_DENSE, &[1e-3, 1e-6, 1e-9, 1e-12]),
    (by::DOP853_DENSE, &[1e-6, 1e-9, 1e-12, 1e-14]),
    #[cfg(feature = "diffsol")]
    (by::TSIT45, &[1e-4, 1e-6, 1e-9, 1e-12]),
];

/// Frequency in Hz at which the ratio ν = ω/Ω₁ to the natural frequency of mass 1 has this value.
pub(super) fn at(rig: &Rig, nu: f64) -> f64 {
    nu * (rig.k1 / rig.m1).sqrt() / TAU
}

/// Number and time in s of impacts of scene B, by arithmetic with 40 digits (Newton on the equations of
/// motion).
pub(super) const GOLDEN_B: [(usize, f64); 5] = [
    (1, 0.030_744_282_246_676_34),
    (2, 0.144_162_776_471_947_4),
    (3, 0.237_270_475_783_159_57),
    (22, 1.970_065_574_977_416),
    (1098, 99.932_500_537_538_15),
];

/// Largest error in s of the reference impact times that were not computed with 40 digits: ten times the
/// error that their own test finds up to 2 s. Errors decay after that.
const TRUTH_ERROR: f64 = 1e-11;

/// The task of scene B: from rest, and no impact is slow or grazing.
pub(super) fn task_b(until: f64) -> Task {
    let rig = Rig::thesis();
    Task::sine(rig, 0.5, at(&rig, 2.1), until)
}

/// Scene B: the times of all impacts of a motion from rest.
fn scene_b(seconds: f64) -> Result<Setup> {
    let task = task_b(seconds);
    let golden = GOLDEN_B.iter().filter(|g| g.1 < seconds);
    let count = golden.clone().next_back().map_or(0, |g| g.0);
    // Time of each impact and its uncertainty, in s.
    let followed = truth::motion(&task, None)?.impacts;
    let mut truth: Vec<[f64; 2]> = followed.iter().take(count).map(|i| [i.0, TRUTH_ERROR]).collect();
    for (number, time) in golden {
        truth[number - 1] = [*time, 0.0];
    }
    // An error is never given below the rounding of the time.
    let least = f64::EPSILON * seconds / 2.0;
    let judge = move |log: &[Log]| -> Verdict {
        let last = truth[count - 1][0] + 0.5 * task.cycle();
        let times: Vec<f64> = log[0].impacts.iter().map(|i| i.0).filter(|t| *t < last).collect();
        if times.len() != count {
            let n = times.len();
            return Err(format!("{n} impacts up to {last:.2} s instead of {count}: not the same motion"));
        }
        Ok(times.iter().zip(&truth).map(|(t, [time, off])| (t - time).abs() - off).fold(least, f64::max))
    };
    let texts = [
        format!("scene B, {seconds} s"),
        format!(
            "From rest under 0.5 N at ν 2.1, every impact crossed at speed: the times of the impacts up to {seconds} s."
        ),
        "largest error of an impact time (s)".to_owned(),
        format!(
            "impacts 1, 2, 3, 22 and 1098: Newton's method on the equations of motion with 40 digits; all others: integration of \
     order 8 to 1e-13, beyond {TRUTH_ERROR:.0e} s; smaller errors than {least:.0e} s, the rounding of the time, are told as that"
        ),
    ];
    let methods = [
        &[(by::FLIGHTS, NO_SETTING)],
        &LOOPS[..],
        &[(by::RK4_ENDS, &[30.0, 100.0, 300.0, 1e3])],
        EVENTS,
        &[(by::STIFF_SPRING, &[1e5, 1e6, 1e8])],
    ]
    .concat();
    let scene = BenchmarkScene::new(Family::Models, texts);
    Ok(Setup { scene, tasks: vec![task], methods, judge: Box::new(judge) })
}

/// Number of starts of the motion that reaches the other mass, and of the one that misses it.
const STARTS: usize = 8;

/// A motion that reaches `depth` in m into the other mass, or misses it by −`depth`, and the time of its
/// impact in s.
///
/// Mass 1 is on its forced motion `A cos ω(t − t_p)` and mass 2 rests, so with the gap A − d they meet at
/// `t_p − 2 asin(√(d/2A))/ω`, or never. The difference A − Δ is exact, so d is that of the rounded gap Δ.
pub(super) fn grazing_task(depth: f64, start: usize) -> Result<(Task, Option<f64>)> {
    let rig = Rig::thesis();
    let frequency = at(&rig, 2.1);
    let steady = Steady::new(&rig, &Sine { force: 0.5, frequency })?;
    let (amplitude, omega) = (steady.amplitude(), steady.omega);
    let gap = amplitude - depth;
    // The starts place the peak at different phases of a fixed step, so that no step size is favoured.
    let peak = (0.3 + 0.043_217 * start as f64) / frequency;
    let turn = omega * peak;
    let task = Task {
        rig: Rig { gap, ..rig },
        phase: -turn - steady.response.arg(),
        start: [amplitude * turn.cos(), amplitude * omega * turn.sin(), 0.0, 0.0],
        ..Task::sine(rig, 0.5, frequency, peak + 0.25 / frequency)
    };
    let reached = amplitude - gap;
    let time = (reached > 0.0).then(|| peak - 2.0 * (reached / (2.0 * amplitude)).sqrt().asin() / omega);
    Ok((task, time))
}

/// Scene of grazing: whether a method finds an impact that is barely reached, and its time.
fn grazing(depth: f64) -> Result<Setup> {
    let starts =
        [depth, -depth].into_iter().flat_map(|d| (0..STARTS).map(move |start| grazing_task(d, start)));
    let (tasks, truth): (Vec<Task>, Vec<Option<f64>>) =
        starts.collect::<Result<Vec<_>>>()?.into_iter().unzip();
    let judge = move |log: &[Log]| -> Verdict {
        let (mut missed, mut invented, mut errors) = (0, 0, Vec::new());
        for (log, truth) in log.iter().zip(&truth) {
            match (log.impacts.first(), truth) {
                (Some(found), Some(truth)) => errors.push((found.0 - truth).abs().max(1e-17)),
                (None, Some(_)) => missed += 1,
                (Some(_), None) => invented += 1,
                (None, None) => {}
            }
        }
        if missed + invented > 0 {
            return Err(format!(
                "{missed} of {STARTS} impacts are not seen, {invented} of {STARTS} seen that are none"
            ));
        }
        Ok(median(&errors))
    };
    let texts = [
        format!("grazing {depth:.0e} m"),
        format!(
            "A motion that reaches {depth:.0e} m into the other mass, and one that misses it by as much, each from {STARTS} starts: is \
     the impact seen, and when?"
        ),
        "median error of the impact's time (s)".to_owned(),
        "the forced motion A cos ω(t − tₚ) meets the gap A − d at tₚ − 2 asin(√(d/2A))/ω".to_owned(),
    ];
    let methods =
        [&[(by::FLIGHTS, NO_SETTING)], &LOOPS[..], &[(by::RK4_ENDS, &[100.0, 1e3, 1e4])], EVENTS].concat();
    Ok(Setup { scene: BenchmarkScene::new(Family::Models, texts), tasks, methods, judge: Box::new(judge) })
}

/// End of the first chatter of scene C, release, and end of the second chatter in s, by arithmetic with 40
/// digits.
pub(super) const GOLDEN_C: [f64; 3] =
    [0.152_721_089_353_360_45, 0.220_247_418_265_660_51, 0.574_521_373_816_090_7];

/// The task of scene C: the pre-loaded rig from x₁ = −2 mm, whose impacts accumulate to rest before it is
/// released.
pub(super) fn task_c() -> Task {
    let rig = Rig { gap: -5e-4, ..Rig::thesis() };
    Task {
        start: [-2e-3, 0.0, 0.0, 0.0],
        most: 500_000,
        rests: true,
        ..Task::sine(rig, 0.35, at(&rig, 0.45), 0.6)
    }
}

/// Scene C: chatter to rest, release, and chatter again.
fn scene_c() -> Setup {
    let judge = |log: &[Log]| -> Verdict {
        let Log { impacts, sticks } = &log[0];
        let [first, second, ..] = sticks[..] else {
            let (n, m) = (impacts.len(), sticks.len());
            return Err(format!("{n} impacts, and {m} times at rest against each other instead of 2"));
        };
        let found = [first[0], first[1], second[0]];
        Ok(found.iter().zip(&GOLDEN_C).map(|(f, g)| (f - g).abs()).fold(1e-17, f64::max))
    };
    let texts = [
        "scene C",
        "Pressed together by their springs, the masses chatter to rest, are released and chatter again: the times of both ends \
         and of the release. Methods with events let the masses rest below the speed that their tolerance resolves.",
        "largest error of the three times (s)",
        "arithmetic with 40 digits",
    ];
    let first = [
        (by::FLIGHTS, NO_SETTING),
        (by::EULER, &[1e3, 1e4, 1e5]),
        (by::RK4_LOOP, &[1e3, 1e4, 1e5]),
        (by::MOREAU, &[1e3, 1e4, 1e5]),
        (by::RK45_RESTLESS, &[1e-6]),
        (by::RK4_ENDS, &[100.0, 1e3]),
    ];
    let (scene, methods) = (BenchmarkScene::new(Family::Models, texts), [&first, EVENTS].concat());
    Setup { scene, tasks: vec![task_c()], methods, judge: Box::new(judge) }
}

/// Stiffness in N/m of contacts, and cycles until the motion is read. The transient shrinks each cycle by the
/// largest multiplier: 0.970 for the rigid orbit, so 0.970¹²⁵⁰ is below 1e-16. For the softest contact it is
/// −0.9945, so 3000 cycles and the mean of the last sixteen impacts leave 2e-10 of it.
const SOFT_CONTACTS: [(f64, f64); 3] = [(1e8, 1250.0), (1e6, 1250.0), (1e4, 3000.0)];
/// Number of impacts at the end whose mean approach speed is compared.
const AVERAGED: usize = 16;

/// Scene of a soft contact: the settled approach speed.
fn soft(stiffness: f64, cycles: f64) -> Result<Setup> {
    let task = task_b(0.0);
    let task = Task { stiffness, until: cycles * task.cycle(), most: 100_000_000, ..task };
    let share = Compliance::new(&task.rig, stiffness, None)?.duration * task.frequency;
    let truth = truth::settled(&task, Some(task.spring()), 2000.0)?
        .ok_or_else(|| Error::refused("the motion with the soft contact does not settle"))?
        .speed();
    let judge = move |log: &[Log]| -> Verdict {
        let impacts = &log[0].impacts;
        let last = &impacts[impacts.len().saturating_sub(AVERAGED)..];
        if last.is_empty() {
            return Err("no impacts".to_owned());
        }
        let speed = last.iter().map(|i| i.1).sum::<f64>() / last.len() as f64;
        let error = (speed / truth - 1.0).abs();
        let grows = "the steps are too long: it grows beyond all bounds";
        if error < 100.0 { Ok(error.max(1e-16)) } else { Err(grows.to_owned()) }
    };
    let texts = [
        format!("soft contact {stiffness:.0e} N m⁻¹"),
        format!(
            "Spring and damper in the contact, {:.2} % of the period in contact: the approach speed once the motion has settled \
     ({cycles} cycles).",
            100.0 * share
        ),
        "relative error of the settled approach speed".to_owned(),
        "the motion that repeats, by Newton's method on integration of order 8 to 1e-13".to_owned(),
    ];
    let methods = vec![
        (by::CLOSED, NO_SETTING),
        (by::SOFT, NO_SETTING),
        (by::RIGID, NO_SETTING),
        (by::KELVIN_VOIGT, NO_SETTING),
        (by::RK45_THROUGH, &[1e-3, 1e-6, 1e-9]),
        (by::RK4_THROUGH, &[1e3, 1e4]),
        (by::RK45_TOUCH, &[1e-3, 1e-6, 1e-9, 1e-12]),
        (by::DOP853_TOUCH, &[1e-6, 1e-9, 1e-12]),
        #[cfg(feature = "diffsol")]
        (by::TSIT45_TOUCH, &[1e-4, 1e-6, 1e-9, 1e-12]),
        #[cfg(feature = "diffsol")]
        (by::BDF_TOUCH, &[1e-4, 1e-6, 1e-9, 1e-12]),
    ];
    let scene = BenchmarkScene::new(Family::Models, texts);
    Ok(Setup { scene, tasks: vec![task], methods, judge: Box::new(judge) })
}

/// Start and end in Hz and rate in Hz/s of a slow sweep over a vibro-impact resonance, and the time in s
/// during which the transient of its start matters.
const FROM: f64 = 10.2;
const TO: f64 = 10.8;
const RATE: f64 = 0.02;
const TRANSIENT: f64 = 5.0;

/// Scene of a slow sweep: the largest approach speed over a resonance.
fn slow_sweep() -> Result<Setup> {
    let task = Task { rate: RATE, ..Task::sine(Rig::thesis(), 0.5, FROM, (TO - FROM) / RATE) };
    let largest = |log: &Log| log.impacts.iter().filter(|i| i.0 > TRANSIENT).map(|i| i.1).fold(0.0, f64::max);
    let truth = largest(&events(&task, None, IntegratorKind::Dop853(1e-13), Locate::Dense)?);
    let truth_error = (largest(&ours::swept(&task, 1e-7)?) / truth - 1.0).abs();
    let judge = move |log: &[Log]| -> Verdict {
        let speed = largest(&log[0]);
        if speed > 0.0 {
            Ok((speed / truth - 1.0).abs().max(truth_error))
        } else {
            Err("no impacts".to_owned())
        }
    };
    let texts = [
        "slow sweep".to_owned(),
        format!(
            "Up from {FROM} to {TO} Hz at {RATE} Hz/s, over the peak of the motion with one impact a cycle: the largest approach speed."
        ),
        "relative error of the largest approach speed".to_owned(),
        format!(
            "order 8 with located events, tolerance 1e-13; exact flights in fine steps differ from it by {truth_error:.0e}, so smaller errors are told as \
     that"
        ),
    ];
    let methods = [
        &[(by::STANDING, &[11.0, 61.0][..]), (by::SWEPT, &[0.1, 1e-2, 1e-3, 1e-4, 1e-5])],
        &LOOPS[..],
        &[(by::RK45_ENDS, &[1e-3, 1e-6, 1e-9, 1e-12]), (by::DOP853_DENSE, &[1e-6, 1e-9, 1e-12])],
    ]
    .concat();
    let scene = BenchmarkScene::new(Family::Models, texts);
    Ok(Setup { scene, tasks: vec![task], methods, judge: Box::new(judge) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_impact_counts_and_the_truth_is_that_of_40_digits() {
        for until in [2.0, 100.0] {
            let task = task_b(until);
            let truth = truth::motion(&task, None).unwrap();
            for (number, time) in GOLDEN_B.into_iter().filter(|g| g.1 < until) {
                assert!((truth.impacts[number - 1].0 - time).abs() < TRUTH_ERROR, "{number}");
            }
            let setup = scene_b(until).unwrap();
            let log = ours::flights(&task).unwrap();
            assert!((setup.judge)(std::slice::from_ref(&log)).unwrap() < 1e-13);
            // An impact that none of the golden numbers covers.
            let mut late = log;
            late.impacts[10].0 += 1e-6;
            assert!(((setup.judge)(&[late]).unwrap() - 1e-6).abs() < 2.0 * TRUTH_ERROR);
        }
    }
}
