//! Ways to follow a motion: the library's own, and what else is done, each written as it usually is, and correctly.

#[cfg(feature = "diffsol")]
mod diffsol;
mod loops;
mod stages;
mod stepper;

use super::ours;
use super::task::{Spring, Task, Told};
use crate::failure::Found;
#[cfg(feature = "diffsol")]
use diffsol::{
    Diffsol::{Bdf, Tsit45},
    followed,
};
use loops::{classical, euler, marched, moreau};
pub use stages::{Course, Locate, events, through};
pub use stepper::{Kind, Stepper};

/// A way to follow a motion.
#[derive(Clone, Copy)]
pub struct Method {
    /// Name in charts.
    pub name: &'static str,
    /// Whether it is one of this library's.
    pub ours: bool,
    /// A value of its setting in words.
    pub setting: fn(f64) -> String,
    /// The motion of a task by a setting.
    pub follow: fn(&Task, f64) -> Result<Told, Found>,
}

type Follow = fn(&Task, f64) -> Result<Told, Found>;

const fn own(name: &'static str, setting: fn(f64) -> String, follow: Follow) -> Method {
    Method { name, ours: true, setting, follow }
}

const fn rival(name: &'static str, setting: fn(f64) -> String, follow: Follow) -> Method {
    Method { name, ours: false, setting, follow }
}

fn none(_: f64) -> String {
    String::new()
}

fn steps(n: f64) -> String {
    format!("{n} steps a cycle")
}

fn tolerance(relative: f64) -> String {
    format!("tolerance {relative:.0e}")
}

fn stiffness(k: f64) -> String {
    format!("k₃ {k:.0e} N/m")
}

fn deviation(phase: f64) -> String {
    format!("phase within {phase:.0e} rad")
}

fn frequencies(n: f64) -> String {
    format!("{n} frequencies")
}

pub const FLIGHTS: Method = own("exact flights", none, |t, _| ours::flights(t));
pub const RIGID: Method = Method { name: "exact flights, rigid", ..FLIGHTS };
pub const SWEPT: Method = own("exact flights", deviation, ours::swept);
pub const STANDING: Method = own("closed form, no rate", frequencies, ours::standing);
pub const CLOSED: Method = own("closed form", none, |t, _| ours::closed_form(t));
pub const SOFT: Method = own("soft-corrected closed form", none, |t, _| ours::soft_form(t));
pub const KELVIN_VOIGT: Method = own("exact Kelvin–Voigt", none, |t, _| ours::kelvin_voigt(t));
pub const EULER: Method = rival("Euler loop", steps, |t, n| marched(t, euler, n));
pub const RK4_LOOP: Method = rival("RK4 loop", steps, |t, n| marched(t, classical, n));
pub const MOREAU: Method = rival("Moreau time stepping", steps, |t, n| marched(t, moreau, n));
pub const RK4_ENDS: Method =
    rival("RK4, sign test", steps, |t, n| events(t, None, Kind::Rk4(n), Locate::Ends));
pub const RK45_ENDS: Method =
    rival("RK45, sign test", tolerance, |t, r| events(t, None, Kind::Rk45(r), Locate::Ends));
pub const RK45_RESTLESS: Method = rival("RK45, no rule for rest", tolerance, |t, r| {
    events(&Task { rests: false, ..*t }, None, Kind::Rk45(r), Locate::Ends)
});
pub const RK45_DENSE: Method =
    rival("RK45, dense events", tolerance, |t, r| events(t, None, Kind::Rk45(r), Locate::Dense));
pub const DOP853_DENSE: Method =
    rival("DOP853, dense events", tolerance, |t, r| events(t, None, Kind::Dop853(r), Locate::Dense));
pub const DOP853_RESTS: Method = rival("DOP853, rule for rest", tolerance, |t, r| {
    events(&Task { rests: true, ..*t }, None, Kind::Dop853(r), Locate::Dense)
});
pub const STIFF_SPRING: Method =
    rival("stiff spring, RK45", stiffness, |t, k| through(t, &Spring::new(&t.rig, k), Kind::Rk45(1e-8)));
/// In larger steps, for motions whose other errors are larger.
pub const ROUGH_SPRING: Method =
    Method { follow: |t, k| through(t, &Spring::new(&t.rig, k), Kind::Rk45(1e-6)), ..STIFF_SPRING };
pub const RK45_THROUGH: Method =
    rival("RK45 straight through", tolerance, |t, r| through(t, &t.spring(), Kind::Rk45(r)));
pub const RK45_CONTACT: Method = Method { name: "RK45 through the contact", ..RK45_THROUGH };
pub const RK4_THROUGH: Method =
    rival("RK4 straight through", steps, |t, n| through(t, &t.spring(), Kind::Rk4(n)));
pub const RK45_TOUCH: Method = rival("RK45, touch to parting", tolerance, |t, r| {
    events(t, Some(t.spring()), Kind::Rk45(r), Locate::Dense)
});
pub const DOP853_TOUCH: Method = rival("DOP853, touch to parting", tolerance, |t, r| {
    events(t, Some(t.spring()), Kind::Dop853(r), Locate::Dense)
});
#[cfg(feature = "diffsol")]
pub const TSIT45: Method = rival("diffsol TSIT45, sign test", tolerance, |t, r| followed(t, None, Tsit45(r)));
#[cfg(feature = "diffsol")]
pub const TSIT45_RESTS: Method = rival("diffsol TSIT45, rule for rest", tolerance, |t, r| {
    followed(&Task { rests: true, ..*t }, None, Tsit45(r))
});
#[cfg(feature = "diffsol")]
pub const TSIT45_TOUCH: Method =
    rival("diffsol TSIT45, sign test", tolerance, |t, r| followed(t, Some(t.spring()), Tsit45(r)));
#[cfg(feature = "diffsol")]
pub const BDF_TOUCH: Method =
    rival("diffsol BDF, sign test", tolerance, |t, r| followed(t, Some(t.spring()), Bdf(r)));
