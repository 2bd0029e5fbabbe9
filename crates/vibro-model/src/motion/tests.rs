use crate::contact::Compliant;
use crate::excitation::{Excitation, Impulses, Pulses, Sine};
use crate::flow::State;
use crate::law::Law;
use crate::motion::Motion;
use crate::rig::Rig;
use crate::simulate::Simulation;
use crate::sweep::{Observable, Pace, Plan};
use vibro_record::Direction;

const FREQUENCIES: [f64; 6] = [3.0, 4.0, 5.7, 7.1, 8.0, 11.0];

fn at_once(rig: &Rig, excitation: &Excitation, state: State, phase: f64) -> Simulation {
    Simulation::from_state(rig, excitation, state, phase).unwrap()
}

fn giving(rig: &Rig, excitation: &Excitation, state: State, phase: f64) -> Compliant {
    let law = Law::spring(1e5, 3.0);
    Compliant::new(rig, excitation, law, state, phase).unwrap()
}

/// Matrix product.
fn times(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|i| [0, 1].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

/// e^{At} of mass 1 alone, by the Taylor series for t/1024 and ten squarings.
fn exponential(rig: &Rig, t: f64) -> [[f64; 2]; 2] {
    let h = t / 1024.0;
    let a = [[0.0, h], [-rig.k1 / rig.m1 * h, -rig.c1 / rig.m1 * h]];
    let (mut sum, mut term) = ([[1.0, 0.0], [0.0, 1.0]], [[1.0, 0.0], [0.0, 1.0]]);
    for n in 1..20 {
        term = times(term, a).map(|row| row.map(|v| v / f64::from(n)));
        sum = [0, 1].map(|i| [0, 1].map(|j| sum[i][j] + term[i][j]));
    }
    (0..10).fold(sum, |e, _| times(e, e))
}

/// A sweep over the impulse follows z ← e^{AT}(z + (0, J/m₁)), with the impulse J of the step to which the
/// cycle belongs.
fn swept<M: Motion>(make: impl Fn(&Rig, &Excitation, State, f64) -> M) {
    let rig = Rig::thesis();
    for frequency in FREQUENCIES {
        for (settle, measure) in [(1, 1), (0, 1), (7, 2)] {
            let excitation = Excitation::Impulse(Impulses { impulse: 1e-5, frequency });
            let mut motion = make(&rig, &excitation, State::REST, 0.0);
            let pace = Pace::Steps { points: 6, settle, measure };
            let plan = Plan { from: 1e-5, to: 1e-4, pace, observable: Observable::Peak };
            let phi = exponential(&rig, 1.0 / frequency);
            let (mut z, mut steps): ([f64; 2], _) = ([0.0, 0.0], 0);
            let mut compare = |motion: &dyn Motion, impulse: Option<f64>| {
                let State { x1, v1, x2, v2 } = motion.state();
                // Some 60 cycles, each with a few roundings of at most 0.1 mm and 4 mm/s (1e-20 m and 1e-18
                // m/s); the ten squarings of the exponential have a relative error of 1e-13.
                let close = (x1 - z[0]).abs() < 1e-17 + 1e-12 * z[0].abs().max(1e-5)
                    && (v1 - z[1]).abs() < 1e-15 + 1e-12 * z[1].abs().max(1e-4);
                assert!(close && x2 == 0.0 && v2 == 0.0, "{frequency} Hz, step {steps}: {x1} {v1} {z:?}");
                steps += 1;
                for _ in 0..impulse.map_or(0, |_| settle + measure) {
                    let v = z[1] + impulse.unwrap_or(0.0) / rig.m1;
                    z = [phi[0][0] * z[0] + phi[0][1] * v, phi[1][0] * z[0] + phi[1][1] * v];
                }
            };
            plan.steps(&mut motion, Direction::Up, |motion, value| {
                compare(motion, Some(value));
                motion.set_excitation(&excitation.at_size(value))?;
                Ok((frequency, value))
            })
            .unwrap();
            compare(&motion, None);
        }
    }
}

#[test]
fn a_sweep_over_the_impulse_is_a_linear_recursion() {
    swept(at_once);
    swept(giving);
}

/// Compares a motion that is stopped and restarted with one that continues.
fn resumed<M: Motion>(make: impl Fn(&Rig, &Excitation, State, f64) -> M) {
    let rig = Rig { gap: 2e-4, ..Rig::thesis() };
    for frequency in FREQUENCIES {
        let excitations = [
            Excitation::Impulse(Impulses { impulse: 1e-3, frequency }),
            Excitation::Pulse(Pulses { force: 0.2, width: 0.03, frequency }),
            Excitation::Sine(Sine { force: 0.1, frequency }),
        ];
        for excitation in excitations {
            for stop in [0.0, 0.2, 1.0, 2.0, 2.5] {
                let mut whole = make(&rig, &excitation, State::REST, 0.0);
                whole.advance(3.0 / frequency, &mut |_| {}).unwrap();
                let mut first = make(&rig, &excitation, State::REST, 0.0);
                first.advance(stop / frequency, &mut |_| {}).unwrap();
                let mut second = make(&rig, &excitation, first.state(), first.phase());
                second.advance((3.0 - stop) / frequency, &mut |_| {}).unwrap();
                let (a, b) = (whole.state(), second.state());
                // Rounding of 1 mm and 0.1 m/s, amplified by some impacts in three cycles; one impulse
                // changes the speed by 8 mm/s.
                let close = (a.x1 - b.x1).abs() < 1e-13 && (a.v1 - b.v1).abs() < 1e-10;
                assert!(close && (a.v2 - b.v2).abs() < 1e-10, "{excitation:?} {stop}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn a_motion_goes_on_from_its_state_and_phase() {
    resumed(at_once);
    resumed(giving);
}

#[test]
fn a_motion_goes_on_from_the_very_impulse() {
    let rig = Rig { gap: 1.0, ..Rig::thesis() };
    let excitation = Excitation::Impulse(Impulses { impulse: 1e-3, frequency: 8.0 });
    let mut first = at_once(&rig, &excitation, State::REST, 0.0);
    first.fly(1.0).unwrap();
    assert_eq!(first.state().v1, 1e-3 / rig.m1);
    let mut second = at_once(&rig, &excitation, first.state(), first.phase());
    let leg = second.fly(0.1).unwrap();
    assert_eq!((leg.duration, leg.state(0.0).v1), (0.1, 1e-3 / rig.m1));
}

#[test]
fn an_excitation_of_another_kind_is_refused() {
    let sine = Excitation::Sine(Sine { force: 0.1, frequency: 5.0 });
    let impulses = Excitation::Impulse(Impulses { impulse: 1e-3, frequency: 5.0 });
    let rig = Rig::thesis();
    let mut motions = (at_once(&rig, &sine, State::REST, 0.0), giving(&rig, &sine, State::REST, 0.0));
    assert!(motions.0.set_excitation(&impulses).is_err() && motions.1.set_excitation(&impulses).is_err());
}
