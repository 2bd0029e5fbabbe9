//! The crate diffsol, used as its manual shows: a root function for the contact, the state set anew behind it, and on from there.
//!
//! It compares the signs of the root function at the ends of its steps.

use std::cell::Cell;

use ::diffsol::{
    NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations, OdeSolverMethod, OdeSolverStopReason,
    Vector, VectorCommon, error::DiffsolError,
};

use super::super::task::{Fault, Task, Told};
use super::Spring;
use super::events::{merged, parted};
use super::stepper::{FLOOR, first_step};

/// A method of the crate with its relative tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Diffsol {
    /// Tsitouras' order 5 in explicit steps.
    Tsit45(f64),
    /// Backward differences, orders 1 to 5.
    Bdf(f64),
}

impl Diffsol {
    /// Its setting in words.
    pub fn setting(self) -> String {
        format!("tolerance {:.0e}", self.relative())
    }

    /// Its relative tolerance.
    pub fn relative(self) -> f64 {
        match self {
            Diffsol::Tsit45(r) | Diffsol::Bdf(r) => r,
        }
    }
}

/// Where the masses are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    Apart,
    /// At rest against each other.
    Together,
    /// Pushed apart by spring and damper of the contact.
    Touching,
    /// The contact's force is zero, its surfaces are not yet back at their rest.
    Released,
}

/// An instant of the motion.
#[derive(Debug, Clone, Copy)]
struct Instant {
    t: f64,
    y: [f64; 4],
    stage: Stage,
}

/// Part of the whole time that is too short to be followed: the crate takes a stop this close for one that it has reached.
const SHORT: f64 = 1e-12;

impl From<DiffsolError> for Fault {
    fn from(error: DiffsolError) -> Fault {
        Fault::Refused(format!("diffsol: {error}"))
    }
}

/// Follows the motion with impacts at once; masses that press each other stay together below the approach speed `sticks` (m/s).
///
/// # Errors
/// Those of the crate, and if the budget is spent.
pub fn impacts(task: &Task, how: Diffsol, sticks: Option<f64>) -> Result<Told, Fault> {
    let mut told = Told::default();
    let rate = |stage, t: f64, y: &[f64; 4]| match stage {
        Stage::Together => task.together(t, y),
        _ => task.apart(t, y),
    };
    let falls = |stage, t: f64, y: &[f64; 4]| match stage {
        Stage::Together => [task.hold(t, y), 1.0],
        _ => [task.gap(y), 1.0],
    };
    follow(task, how, rate, falls, |Instant { t, mut y, stage }, _| {
        if stage == Stage::Together {
            if let Some(last) = told.sticks.last_mut() {
                last[1] = t;
            }
            let (t, y) = parted(task, t, y);
            return Instant { t, y, stage: Stage::Apart };
        }
        let approach = task.collide(&mut y);
        told.impacts.push((t, approach));
        if sticks.is_some_and(|speed| approach < speed) && task.hold(t, &y) > 0.0 {
            told.sticks.push([t, f64::INFINITY]);
            return Instant { t, y: merged(task, &y), stage: Stage::Together };
        }
        Instant { t, y: lifted(task, y), stage: Stage::Apart }
    })?;
    Ok(told)
}

/// Follows the motion with a contact of spring and damper, from touch to the end of the force to parting.
///
/// # Errors
/// As [`impacts`].
pub fn contacts(task: &Task, how: Diffsol, spring: &Spring) -> Result<Told, Fault> {
    let mut told = Told::default();
    let rate = |stage, t: f64, y: &[f64; 4]| {
        task.pushed(t, y, if stage == Stage::Touching { spring.bound(task, y) } else { 0.0 })
    };
    let falls = |stage, _: f64, y: &[f64; 4]| match stage {
        Stage::Touching => [spring.bound(task, y), 1.0],
        Stage::Released => [-task.gap(y), -spring.bound(task, y)],
        _ => [task.gap(y), 1.0],
    };
    follow(task, how, rate, falls, |Instant { t, y, stage }, which| match (stage, which) {
        (Stage::Touching, _) if task.gap(&y) < 0.0 => Instant { t, y, stage: Stage::Released },
        (Stage::Touching, _) | (Stage::Released, 0) => Instant { t, y: lifted(task, y), stage: Stage::Apart },
        (Stage::Released, _) => Instant { t, y, stage: Stage::Touching },
        _ => {
            told.impacts.push((t, y[1] - y[3]));
            Instant { t, y, stage: Stage::Touching }
        }
    })?;
    Ok(told)
}

/// A hair apart, as in the crate's bouncing ball: a root function that starts at zero or below is not seen to fall.
fn lifted(task: &Task, mut y: [f64; 4]) -> [f64; 4] {
    y[0] = y[0].min(y[2] + task.rig.gap - f64::EPSILON);
    y
}

/// Integrates stage by stage; `meet` tells where it goes on when one of `falls` has fallen through zero.
fn follow(
    task: &Task,
    how: Diffsol,
    rate: impl Fn(Stage, f64, &[f64; 4]) -> [f64; 4],
    falls: impl Fn(Stage, f64, &[f64; 4]) -> [f64; 2],
    meet: impl FnMut(Instant, usize) -> Instant,
) -> Result<(), Fault> {
    let stage = Cell::new(Stage::Apart);
    let now = |t: f64, y: &[f64]| rate(stage.get(), t, &four(y));
    let first = task.first();
    let mut problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .h0(first_step(task, 0.0, &first))
        .rtol(how.relative())
        .atol(FLOOR.map(|floor| how.relative() * floor))
        .rhs_implicit(
            |y, _, t, rate| rate.copy_from_slice(&now(t, y)),
            // The rate is linear in the state, apart from the drive.
            |_, _, t, v, product| {
                let [moved, still] = [now(t, v), now(t, &[0.0; 4])];
                product.copy_from_slice(&std::array::from_fn::<f64, 4, _>(|i| moved[i] - still[i]));
            },
        )
        .init(|_, _, y| y.copy_from_slice(&first), first.len())
        .root(|y, _, t, values| values.copy_from_slice(&falls(stage.get(), t, &four(y))), 2)
        .build()?;
    // Counted over the whole run, 50 of them as it comes; a step that Newton's method does not solve is shortened, and one too short is an
    // error all the same.
    problem.ode_options.max_nonlinear_solver_failures = usize::MAX;
    match how {
        Diffsol::Tsit45(_) => run(task, problem.tsit45()?, &stage, &rate, &falls, meet),
        Diffsol::Bdf(_) => run(task, problem.bdf::<NalgebraLU<f64>>()?, &stage, &rate, &falls, meet),
    }
}

/// Steps a solver to the end.
fn run<'a, E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a>(
    task: &Task,
    mut solver: impl OdeSolverMethod<'a, E>,
    stage: &Cell<Stage>,
    rate: impl Fn(Stage, f64, &[f64; 4]) -> [f64; 4],
    falls: impl Fn(Stage, f64, &[f64; 4]) -> [f64; 2],
    mut meet: impl FnMut(Instant, usize) -> Instant,
) -> Result<(), Fault> {
    let (mut t, mut y, mut left) = (0.0, task.first(), task.most);
    solver.set_stop_time(task.until)?;
    while task.until - t > SHORT * task.until {
        if left == 0 {
            return Err(task.stalled(t));
        }
        left -= 1;
        let before = falls(stage.get(), t, &y);
        match solver.step()? {
            OdeSolverStopReason::RootFound(time, which) if before[which] > 0.0 => {
                let met = Instant {
                    t: time,
                    y: four(solver.interpolate(time)?.inner().as_slice()),
                    stage: stage.get(),
                };
                let next = meet(met, which);
                (t, y) = (next.t, next.y);
                stage.set(next.stage);
                let state = solver.state_mut();
                state.y.inner_mut().copy_from_slice(&y);
                state.dy.inner_mut().copy_from_slice(&rate(next.stage, t, &y));
                *state.t = t;
                *state.h = first_step(task, t, &y);
                continue;
            }
            // It rises. The crate's search begins anew only when it is told that the state may have changed.
            OdeSolverStopReason::RootFound(..) => {
                solver.state_mut();
            }
            _ => {}
        }
        (t, y) = (solver.state().t, four(solver.state().y.inner().as_slice()));
        if stage.get() == Stage::Together {
            // The force bends with the excitation: its sign is tested eight times a cycle at least.
            let state = solver.state_mut();
            *state.h = state.h.min(task.cycle() / 8.0);
        }
    }
    Ok(())
}

fn four(y: &[f64]) -> [f64; 4] {
    std::array::from_fn(|i| y[i])
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use vibro_model::{Rig, State};

    /// Displacement in m from which both masses start.
    const START: f64 = 1e-3;
    const STEPS: u64 = 5_000;

    /// Two equal masses without dampers let go a gap of nothing apart: each meets its mirror image, and the distance between them
    /// follows z″ = −ω²z.
    fn mirrored(restitution: f64, until: f64) -> (Task, f64) {
        let thesis = Rig::thesis();
        let rig = Rig { m2: thesis.m1, k2: thesis.k1, c1: 0.0, c2: 0.0, gap: 0.0, restitution, ..thesis };
        let omega = (rig.k1 / rig.m1).sqrt();
        let start = State { x1: -START, x2: START, ..State::REST };
        let sine = Task::sine(rig, 0.0, omega / std::f64::consts::TAU, until / omega);
        (Task { start, most: STEPS, ..sine }, omega)
    }

    /// What all steps together can leave of (ωz, z′) in m/s: the norm of four errors is below 1, so each is below twice its tolerance,
    /// and z is the difference of two. Between contacts neither grows.
    fn allowed(how: Diffsol, omega: f64) -> f64 {
        let step = omega * (FLOOR[0] + START) + (FLOOR[1] + omega * START);
        STEPS as f64 * 4.0 * how.relative() * step
    }

    #[test]
    fn equal_masses_meet_every_half_period_and_part_with_r_times_their_speed() {
        let (task, omega) = mirrored(0.7, FRAC_PI_2 + 3.5 * PI);
        for how in [Diffsol::Tsit45(1e-6), Diffsol::Tsit45(1e-9), Diffsol::Tsit45(1e-12), Diffsol::Bdf(1e-9)]
        {
            let told = impacts(&task, how, None).unwrap();
            assert_eq!(told.impacts.len(), 4, "{how:?}");
            for (n, (time, approach)) in told.impacts.iter().enumerate() {
                let speed = 2.0 * omega * START * 0.7_f64.powi(n as i32);
                // At an impact without acceleration an error turns round and shrinks by R, as the speed does.
                let off = allowed(how, omega);
                assert!(
                    (time - (FRAC_PI_2 + PI * n as f64) / omega).abs() < off / (omega * speed),
                    "{how:?}"
                );
                assert!((approach - speed).abs() < off, "{how:?}: {approach} {speed}");
            }
        }
    }

    #[test]
    fn equal_masses_on_a_contact_of_spring_and_damper_meet_when_two_oscillations_say() {
        let (task, omega) = mirrored(0.7, FRAC_PI_2 + 2.75 * PI);
        let spring = Spring { stiffness: 1e3, damping: 2.0 };
        let (mass, k, c) = (task.rig.m1, spring.stiffness, spring.damping);
        // z″ = −ω²z − 2(kz + cz′)/m in contact, from (0, V).
        let (decay, stiff) = (c / mass, (omega * omega + 2.0 * k / mass).sqrt());
        let ring = (stiff * stiff - decay * decay).sqrt();
        let (mut time, mut speed) = (FRAC_PI_2 / omega, 2.0 * omega * START);
        let mut touches = Vec::new();
        while time < task.until {
            touches.push((time, speed));
            // kz + cz′ = 0.
            let lasts = (PI - (c * ring / (k - c * decay)).atan()) / ring;
            let (sin, cos) = (ring * lasts).sin_cos();
            let left = speed * (-decay * lasts).exp();
            let (z, v) = (left * sin / ring, left * (cos - decay / ring * sin));
            time += lasts + (2.0 * PI - (omega * z).atan2(v)) / omega;
            speed = v.hypot(omega * z);
        }
        assert_eq!(touches.len(), 3);
        for how in [Diffsol::Tsit45(1e-9), Diffsol::Tsit45(1e-12), Diffsol::Bdf(1e-9)] {
            let told = contacts(&task, how, &spring).unwrap();
            assert_eq!(told.impacts.len(), 3, "{how:?}");
            for (n, (found, truth)) in told.impacts.iter().zip(&touches).enumerate() {
                // In contact (Ωz, z′) does not grow: a contact makes (ωz, z′) larger by Ω/ω at most.
                let off = allowed(how, omega) * (stiff / omega).powi(n as i32);
                assert!((found.0 - truth.0).abs() < off / (omega * truth.1), "{how:?}: {found:?} {truth:?}");
                assert!((found.1 - truth.1).abs() < off, "{how:?}: {found:?} {truth:?}");
            }
        }
    }

    #[test]
    fn what_the_crate_cannot_do_is_its_own_word_and_a_spent_budget_stalls() {
        let (task, _) = mirrored(0.7, 10.0);
        let impossible = impacts(&task, Diffsol::Tsit45(1e-30), None);
        assert!(
            matches!(&impossible, Err(Fault::Refused(why)) if why.starts_with("diffsol: ")),
            "{impossible:?}"
        );
        let short = Task { most: 3, ..task };
        assert!(matches!(impacts(&short, Diffsol::Tsit45(1e-6), None), Err(Fault::Stalled(_))));
    }
}
