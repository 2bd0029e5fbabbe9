//! The crate diffsol, used as its manual shows: a root function for the contact, after which the state is set
//! and the integration continues.
//!
//! The crate compares the signs of the root function at the ends of its steps.

use super::super::task::{Log, Spring, Task};
use super::stages::{Guard, Locate, Stage, System, Trajectory};
use super::stepper::{FLOOR, IntegratorKind, first_step};
use crate::{Outcome, OutcomeWithReason};
use ::diffsol::{
    NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations, OdeSolverMethod, OdeSolverStopReason,
    Vector, VectorCommon, error::DiffsolError,
};
use std::cell::Cell;

/// A method of the crate with its relative tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Diffsol {
    /// Tsitouras' order 5 in explicit steps.
    Tsit45(f64),
    /// Backward differences, orders 1 to 5.
    Bdf(f64),
}

/// Share of the whole time that is left out at the end: the crate treats a stop time this close as reached.
const NEGLIGIBLE: f64 = 1e-12;

impl From<DiffsolError> for OutcomeWithReason {
    fn from(error: DiffsolError) -> OutcomeWithReason {
        OutcomeWithReason::new(Outcome::Refused, format!("diffsol: {error}"))
    }
}

/// Follows the motion with rigid impacts, or with a contact.
pub fn followed(task: &Task, spring: Option<Spring>, how: Diffsol) -> Result<Log, OutcomeWithReason> {
    let (Diffsol::Tsit45(relative) | Diffsol::Bdf(relative)) = how;
    let trajectory = Trajectory::new(task, spring, IntegratorKind::Rk45(relative), Locate::Ends);
    let (system, stage, first) = (trajectory.system, Cell::new(trajectory.stage), trajectory.y);
    let now = |t: f64, y: &[f64]| system.rate(stage.get(), t, &state_of(y));
    let mut problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .h0(first_step(task, 0.0, &first))
        .rtol(relative)
        .atol(FLOOR.map(|floor| relative * floor))
        .rhs_implicit(
            |y, _, t, rate| rate.copy_from_slice(&now(t, y)),
            // The derivative is linear in the state, apart from the drive.
            |_, _, t, v, product| {
                let [moved, still] = [now(t, v), now(t, &[0.0; 4])];
                product.copy_from_slice(&std::array::from_fn::<f64, 4, _>(|i| moved[i] - still[i]));
            },
        )
        .init(|_, _, y| y.copy_from_slice(&first), first.len())
        .root(|y, _, t, values| values.copy_from_slice(&falls(&system, stage.get(), t, &state_of(y))), 2)
        .build()?;
    // The crate counts failures of Newton's method over the whole run and allows 50 by default. A failed step
    // is shortened in any case, and a step that is too short is still an error.
    problem.ode_options.max_nonlinear_solver_failures = usize::MAX;
    match how {
        Diffsol::Tsit45(_) => run(trajectory, problem.tsit45()?, &stage),
        Diffsol::Bdf(_) => run(trajectory, problem.bdf::<NalgebraLU<f64>>()?, &stage),
    }
}

/// Functions that end a stage when they fall through zero; 1 where there is no further one.
fn falls(system: &System<'_>, stage: Stage, t: f64, y: &[f64; 4]) -> [f64; 2] {
    system.guards(stage).map(|guard| guard.map_or(1.0, |g: Guard| g.value(system.task, t, y)))
}

/// Steps a solver to the end of the task.
fn run<'a, E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a>(
    mut now: Trajectory<'_>,
    mut solver: impl OdeSolverMethod<'a, E>,
    stage: &Cell<Stage>,
) -> Result<Log, OutcomeWithReason> {
    let (system, task) = (now.system, now.system.task);
    let mut left = task.most;
    solver.set_stop_time(task.until)?;
    while task.until - now.t > NEGLIGIBLE * task.until {
        if left == 0 {
            return Err(task.stalled(now.t));
        }
        left -= 1;
        let before = falls(&system, now.stage, now.t, &now.y);
        match solver.step()? {
            OdeSolverStopReason::RootFound(time, which) if before[which] > 0.0 => {
                now.apply_event(which, time, state_of(solver.interpolate(time)?.inner().as_slice()));
                if now.stage == Stage::Apart {
                    // A tiny gap, as in the crate's bouncing ball: a fall is not detected where the root
                    // function starts at or below zero.
                    now.y[0] = now.y[0].min(now.y[2] + task.rig.gap - f64::EPSILON);
                }
                stage.set(now.stage);
                let state = solver.state_mut();
                state.y.inner_mut().copy_from_slice(&now.y);
                state.dy.inner_mut().copy_from_slice(&system.rate(now.stage, now.t, &now.y));
                *state.t = now.t;
                *state.h = first_step(task, now.t, &now.y);
                continue;
            }
            // The function rises. The crate continues its search only after the state may have been changed.
            OdeSolverStopReason::RootFound(..) => {
                solver.state_mut();
            }
            _ => {}
        }
        (now.t, now.y) = (solver.state().t, state_of(solver.state().y.inner().as_slice()));
        if now.stage == Stage::Together {
            // The force varies with the excitation: its sign is tested at least eight times a cycle.
            let state = solver.state_mut();
            *state.h = state.h.min(task.cycle() / 8.0);
        }
    }
    Ok(now.log)
}

/// A state of the crate as an array.
fn state_of(y: &[f64]) -> [f64; 4] {
    std::array::from_fn(|i| y[i])
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use vibro_model::Rig;

    /// Displacement in m from which both masses start.
    const START: f64 = 1e-3;
    const STEPS: u64 = 5_000;

    fn relative(how: Diffsol) -> f64 {
        let (Diffsol::Tsit45(relative) | Diffsol::Bdf(relative)) = how;
        relative
    }

    /// Two equal masses without dampers, released with a gap of zero in equilibrium: each meets its mirror
    /// image, and the distance z between them follows z″ = −ω²z.
    fn mirrored(restitution: f64, until: f64) -> (Task, f64) {
        let thesis = Rig::thesis();
        let rig = Rig { m2: thesis.m1, k2: thesis.k1, c1: 0.0, c2: 0.0, gap: 0.0, restitution, ..thesis };
        let omega = (rig.k1 / rig.m1).sqrt();
        let start = [-START, 0.0, START, 0.0];
        let sine = Task::sine(rig, 0.0, omega / std::f64::consts::TAU, until / omega);
        (Task { start, most: STEPS, ..sine }, omega)
    }

    /// Largest error of (ωz, z′) in m/s after all steps: the norm of four errors is below 1, so each is below
    /// twice its tolerance, and z is the difference of two. Between contacts neither grows.
    fn allowed(how: Diffsol, omega: f64) -> f64 {
        let step = omega * (FLOOR[0] + START) + (FLOOR[1] + omega * START);
        STEPS as f64 * 4.0 * relative(how) * step
    }

    #[test]
    fn equal_masses_meet_every_half_period_and_part_with_r_times_their_speed() {
        let (task, omega) = mirrored(0.7, FRAC_PI_2 + 3.5 * PI);
        for how in [Diffsol::Tsit45(1e-6), Diffsol::Tsit45(1e-9), Diffsol::Tsit45(1e-12), Diffsol::Bdf(1e-9)]
        {
            let log = followed(&task, None, how).unwrap();
            assert_eq!(log.impacts.len(), 4, "{how:?}");
            for (n, (time, approach)) in log.impacts.iter().enumerate() {
                let speed = 2.0 * omega * START * 0.7_f64.powi(n as i32);
                // An impact without acceleration changes the sign of an error and reduces it by R, as the
                // speed.
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
        let spring = Spring { damping: 2.0, ..Spring::new(&task.rig, 1e3) };
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
            let log = followed(&task, Some(spring), how).unwrap();
            assert_eq!(log.impacts.len(), 3, "{how:?}");
            for (n, (found, truth)) in log.impacts.iter().zip(&touches).enumerate() {
                // In contact (Ωz, z′) does not grow: a contact enlarges (ωz, z′) by Ω/ω at most.
                let off = allowed(how, omega) * (stiff / omega).powi(n as i32);
                assert!((found.0 - truth.0).abs() < off / (omega * truth.1), "{how:?}: {found:?} {truth:?}");
                assert!((found.1 - truth.1).abs() < off, "{how:?}: {found:?} {truth:?}");
            }
        }
    }

    #[test]
    fn what_the_crate_cannot_do_is_its_own_word_and_a_spent_budget_stalls() {
        let (task, _) = mirrored(0.7, 10.0);
        let impossible = followed(&task, None, Diffsol::Tsit45(1e-30));
        assert!(
            matches!(&impossible, Err(found) if found.outcome == Outcome::Refused && found.why.starts_with("diffsol: ")),
            "{impossible:?}"
        );
        let short = Task { most: 3, ..task };
        assert_eq!(followed(&short, None, Diffsol::Tsit45(1e-6)).unwrap_err().outcome, Outcome::Stalled);
    }
}
