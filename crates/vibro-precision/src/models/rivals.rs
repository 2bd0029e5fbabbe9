//! Methods that follow a motion: the library's own, and common others, each implemented here in its usual
//! form, and correctly.

#[cfg(feature = "diffsol")]
mod diffsol;
mod stages;
mod stepper;

use super::ours;
use super::task::{Log, Task};
use crate::OutcomeWithReason;
#[cfg(feature = "diffsol")]
use diffsol::{
    Diffsol::{Bdf, Tsit45},
    followed,
};
use stages::through;
pub use stages::{Locate, Trajectory, events};
pub use stepper::IntegratorKind;
use stepper::IntegratorKind::{Dop853, Rk4, Rk45};
#[cfg(test)]
pub use stepper::Stepper;
use stepper::{classical, euler, fixed_step_loop, moreau};

/// A method that follows a motion.
#[derive(Clone, Copy)]
pub struct Method {
    /// Name in charts.
    pub name: &'static str,
    /// Whether it is a method of this library.
    pub ours: bool,
    /// Whether another library computes it; else it is code of this project.
    pub other_program: bool,
    /// Words before and after a value of its setting; `None` where it has no setting.
    pub setting: Setting,
    /// Follows a task with a setting and returns its log.
    pub follow: Follow,
}

/// Follows a task with a setting.
type Follow = fn(&Task, f64) -> Result<Log, OutcomeWithReason>;
/// Words before and after a value of a setting; `None` without one.
type Setting = Option<[&'static str; 2]>;

/// Steps per cycle of the excitation.
const STEPS: Setting = Some(["", " steps a cycle"]);
/// Relative tolerance of the integrator.
const TOLERANCE: Setting = Some(["tolerance ", ""]);
/// Contact stiffness in N/m.
const STIFFNESS: Setting = Some(["k₃ ", " N/m"]);

impl Method {
    /// A method of this library.
    const fn own(name: &'static str, setting: Setting, follow: Follow) -> Method {
        Method { name, ours: true, other_program: false, setting, follow }
    }

    /// A common method, coded in this project.
    const fn rival(name: &'static str, setting: Setting, follow: Follow) -> Method {
        Method { name, ours: false, other_program: false, setting, follow }
    }

    /// A method that another library computes.
    #[cfg(feature = "diffsol")]
    const fn other(name: &'static str, follow: Follow) -> Method {
        Method { name, ours: false, other_program: true, setting: TOLERANCE, follow }
    }

    /// A value of the setting in words.
    pub fn words(&self, value: f64) -> String {
        match self.setting {
            None => String::new(),
            Some([before, after]) if (1.0..1e5).contains(&value) => format!("{before}{value}{after}"),
            Some([before, after]) => format!("{before}{value:.0e}{after}"),
        }
    }
}

pub const FLIGHTS: Method = Method::own("exact flights", None, |t, _| ours::flights(t));
pub const RIGID: Method = Method { name: "exact flights, rigid", ..FLIGHTS };
pub const SWEPT: Method = Method::own("exact flights", Some(["phase within ", " rad"]), ours::swept);
pub const STANDING: Method = Method::own("closed form, no rate", Some(["", " frequencies"]), ours::standing);
pub const CLOSED: Method = Method::own("closed form", None, |t, _| ours::closed_form(t));
pub const SOFT: Method = Method::own("soft-corrected closed form", None, |t, _| ours::soft_form(t));
pub const KELVIN_VOIGT: Method = Method::own("exact Kelvin–Voigt", None, |t, _| ours::kelvin_voigt(t));
pub const EULER: Method = Method::rival("Euler loop", STEPS, |t, n| fixed_step_loop(t, euler, n));
pub const RK4_LOOP: Method = Method::rival("RK4 loop", STEPS, |t, n| fixed_step_loop(t, classical, n));
pub const MOREAU: Method = Method::rival("Moreau time stepping", STEPS, |t, n| fixed_step_loop(t, moreau, n));
pub const RK4_ENDS: Method = Method::rival("RK4, sign test", STEPS, |t, n| ends(t, Rk4(n)));
pub const RK45_ENDS: Method = Method::rival("RK45, sign test", TOLERANCE, |t, r| ends(t, Rk45(r)));
pub const RK45_RESTLESS: Method =
    Method::rival("RK45, no rule for rest", TOLERANCE, |t, r| ends(&rests(t, false), Rk45(r)));
pub const RK45_DENSE: Method = Method::rival("RK45, dense events", TOLERANCE, |t, r| dense(t, Rk45(r)));
pub const DOP853_DENSE: Method = Method::rival("DOP853, dense events", TOLERANCE, |t, r| dense(t, Dop853(r)));
pub const DOP853_RESTS: Method =
    Method::rival("DOP853, rule for rest", TOLERANCE, |t, r| dense(&rests(t, true), Dop853(r)));
pub const STIFF_SPRING: Method = Method::rival("stiff spring, RK45", STIFFNESS, |t, k| stiff(t, k, 1e-8));
/// The stiff spring with a larger tolerance, where the error of the stiffness is larger still.
pub const ROUGH_SPRING: Method = Method { follow: |t, k| stiff(t, k, 1e-6), ..STIFF_SPRING };
pub const RK45_THROUGH: Method =
    Method::rival("RK45 straight through", TOLERANCE, |t, r| through(t, Rk45(r)));
pub const RK45_CONTACT: Method = Method { name: "RK45 through the contact", ..RK45_THROUGH };
pub const RK4_THROUGH: Method = Method::rival("RK4 straight through", STEPS, |t, n| through(t, Rk4(n)));
pub const RK45_TOUCH: Method = Method::rival("RK45, touch to parting", TOLERANCE, |t, r| touch(t, Rk45(r)));
pub const DOP853_TOUCH: Method =
    Method::rival("DOP853, touch to parting", TOLERANCE, |t, r| touch(t, Dop853(r)));
#[cfg(feature = "diffsol")]
pub const TSIT45: Method = Method::other("diffsol TSIT45, sign test", |t, r| followed(t, None, Tsit45(r)));
#[cfg(feature = "diffsol")]
pub const TSIT45_RESTS: Method =
    Method::other("diffsol TSIT45, rule for rest", |t, r| followed(&rests(t, true), None, Tsit45(r)));
#[cfg(feature = "diffsol")]
pub const TSIT45_TOUCH: Method = Method { follow: |t, r| followed(t, Some(t.spring()), Tsit45(r)), ..TSIT45 };
#[cfg(feature = "diffsol")]
pub const BDF_TOUCH: Method =
    Method::other("diffsol BDF, sign test", |t, r| followed(t, Some(t.spring()), Bdf(r)));

/// Events located by signs at the ends of steps.
fn ends(task: &Task, kind: IntegratorKind) -> Result<Log, OutcomeWithReason> {
    events(task, None, kind, Locate::Ends)
}

/// Events located in the dense output.
fn dense(task: &Task, kind: IntegratorKind) -> Result<Log, OutcomeWithReason> {
    events(task, None, kind, Locate::Dense)
}

/// A contact of the task's stiffness, with touch and parting located in the dense output.
fn touch(task: &Task, kind: IntegratorKind) -> Result<Log, OutcomeWithReason> {
    events(task, Some(task.spring()), kind, Locate::Dense)
}

/// A spring of stiffness `k` in N/m in place of rigid impacts.
fn stiff(task: &Task, k: f64, tolerance: f64) -> Result<Log, OutcomeWithReason> {
    through(&Task { stiffness: k, ..*task }, Rk45(tolerance))
}

/// The task with or without the rule for rest.
fn rests(task: &Task, rests: bool) -> Task {
    Task { rests, ..*task }
}
