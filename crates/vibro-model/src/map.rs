//! Maps of regime and stability over two parameters.

use super::excitation::Excitation;
use super::floquet;
use super::flow::State;
use super::forcing::Forcing;
use super::motion::Motion;
use super::parameter::Parameter;
use super::periodic::PeriodicOrbit;
use super::regime::{Pattern, Regime};
use super::regime::{Strike, Watch};
use super::rig::Rig;
use super::scales;
use super::simulate::Simulation;
use nalgebra::Matrix4;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use vibro_record::{Error, Result};

/// Equally spaced values of one parameter: finite ends, the lower one first, and 2 to 1e6 values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct MapAxis {
    /// The parameter.
    #[serde(deserialize_with = "named")]
    pub key: Parameter,
    /// First value.
    pub low: f64,
    /// Last value.
    pub high: f64,
    /// Number of values.
    pub n: usize,
}

/// A parameter by its name: of a map all may be varied, of a campaign's fit only some.
fn named<'de, D: Deserializer<'de>>(from: D) -> std::result::Result<Parameter, D::Error> {
    let name = String::deserialize(from)?;
    Parameter::named(&name).ok_or_else(|| D::Error::custom(format!("no parameter is called {name}")))
}

impl MapAxis {
    /// The `i`-th value.
    pub fn value(&self, i: usize) -> f64 {
        if i == 0 { self.low } else { self.low + (self.high - self.low) * (i as f64 / (self.n - 1) as f64) }
    }

    /// All values.
    pub fn values(&self) -> Vec<f64> {
        (0..self.n).map(|i| self.value(i)).collect()
    }
}

impl std::str::FromStr for MapAxis {
    type Err = Error;

    /// `name:low:high:n`.
    fn from_str(text: &str) -> Result<MapAxis> {
        let parse = || {
            let mut parts = text.split(':');
            let key = Parameter::named(parts.next()?)?;
            let mut number = || parts.next()?.trim().parse::<f64>().ok().filter(|v| v.is_finite());
            let (low, high) = (number()?, number()?);
            let n = parts.next()?.trim().parse().ok()?;
            (parts.next().is_none() && low < high && (2..=MOST_VALUES).contains(&n)).then_some(MapAxis {
                key,
                low,
                high,
                n,
            })
        };
        parse().ok_or_else(|| {
            let names: Vec<_> = Parameter::all().map(Parameter::name).collect();
            Error::usage(
                format!("axis {text:?}"),
                "NAME:LOW:HIGH:N with LOW below HIGH and N from 2 to 1000000",
            )
            .hint(format!("NAME is one of {}", names.join(", ")))
        })
    }
}

/// Largest number of values of an axis.
const MOST_VALUES: usize = 1_000_000;
/// Largest number of cells, which take 17 bytes each.
const MOST_CELLS: u64 = 10_000_000_000;

/// Axes, rig and excitation of a map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The rig; the parameters of the axes are overwritten.
    pub rig: Rig,
    /// Excitation of mass 1.
    pub excitation: Excitation,
    /// Parameter of the horizontal axis.
    pub x: MapAxis,
    /// Parameter of the vertical axis.
    pub y: MapAxis,
    /// Cycles of a cell, from rest. A cell ends earlier when the motion repeats within 1e-6, or is within
    /// 1e-3 of a stable motion and approaches it.
    pub cycles: u32,
}

/// Result of one cell of a map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cell {
    /// The regime; `None` where the rig cannot be computed there (an undamped mass at its resonance).
    pub regime: Option<Regime>,
    /// Largest modulus of the Floquet multipliers over the period of the pattern (of one cycle without
    /// impacts); `None` without one.
    pub spectral_radius: Option<f64>,
}

/// Fraction of a cell's cycles that count as transient if the motion has not settled earlier; its regime is
/// judged from the remaining cycles.
const SETTLING_SHARE: f64 = 0.6;
/// A cell ends early if the motion approaches a stable one, and its last repetitions differ by less than
/// this.
const NEARLY_SETTLED: f64 = 1e-3;
/// Number of cycles between two tests whether the motion has settled.
const TEST_INTERVAL: u32 = 16;

impl Plan {
    /// Checks the plan.
    ///
    /// # Errors
    /// If both axes vary the same parameter, or one that the excitation does not have; if a corner of the map
    /// is impossible or has a negative gap; if there are fewer than 4 cycles a cell.
    pub fn check(&self) -> Result<()> {
        if self.x.key == self.y.key {
            return Err(Error::usage(format!("both axes vary {}", self.x.key.name()), "two parameters"));
        }
        for axis in [&self.x, &self.y] {
            if axis.key.set(&mut self.rig.clone(), &mut self.excitation.clone(), axis.low).is_none() {
                let (found, kind) = (axis.key.name(), self.excitation.kind());
                return Err(Error::usage(
                    format!("an axis of {found} under an excitation of kind {kind}"),
                    "a parameter that this excitation has",
                ));
            }
        }
        if self.cells() > MOST_CELLS {
            let found = format!("a map of {:.1e} cells", self.cells() as f64);
            return Err(Error::usage(found, "at most 1e10, which take 170 GB").hint("several maps"));
        }
        if self.cycles < 4 {
            return Err(Error::usage(format!("{} cycles a cell", self.cycles), "at least 4"));
        }
        for (column, row) in [(0, 0), (self.x.n - 1, 0), (0, self.y.n - 1), (self.x.n - 1, self.y.n - 1)] {
            let (rig, excitation) = self.at(column, row);
            scales::check(&rig, &excitation)?;
            if rig.gap < 0.0 {
                return Err(Error::usage(
                    format!("gap is {} m", rig.gap),
                    "0 or more: cells start with both masses at their own rest",
                ));
            }
        }
        Ok(())
    }

    /// Rig and excitation of a cell.
    pub fn at(&self, column: usize, row: usize) -> (Rig, Excitation) {
        let (mut rig, mut excitation) = (self.rig, self.excitation.clone());
        // `check` has refused parameters that the excitation does not have.
        let _ = self.x.key.set(&mut rig, &mut excitation, self.x.value(column));
        let _ = self.y.key.set(&mut rig, &mut excitation, self.y.value(row));
        (rig, excitation)
    }

    /// Checks that the cells take at most 1e8 cycles in all.
    ///
    /// # Errors
    /// If they take more.
    pub fn check_work(&self) -> Result<()> {
        scales::check_work(self.x.n as f64 * self.y.n as f64 * f64::from(self.cycles))
    }

    /// Number of cells.
    pub fn cells(&self) -> u64 {
        self.x.n as u64 * self.y.n as u64
    }

    /// Computes a cell, counted from 0 along the rows.
    pub fn cell(&self, number: u64) -> Cell {
        let n = self.x.n as u64;
        let (rig, excitation) = self.at((number % n) as usize, (number / n) as usize);
        cell(&rig, &excitation, self.cycles)
    }
}

/// Regime and spectral radius of the motion that is reached from rest.
pub fn cell(rig: &Rig, excitation: &Excitation, cycles: u32) -> Cell {
    judged(rig, excitation, cycles).unwrap_or(Cell { regime: None, spectral_radius: None })
}

/// As [`cell`], with the error of a rig that cannot be computed.
fn judged(rig: &Rig, excitation: &Excitation, cycles: u32) -> Result<Cell> {
    let mut motion = Simulation::new(rig, excitation)?;
    let frequency = excitation.frequency();
    let settling = (SETTLING_SHARE * f64::from(cycles)) as u32;
    let mut watch = Watch::new(&motion);
    let mut follow = |motion: &mut Simulation, cycles: u32| {
        watch = Watch::new(motion);
        let until = motion.time() + f64::from(cycles) / frequency;
        motion.advance(until, &mut |piece| watch.take(&piece))?;
        Ok((watch.pattern(), watch.strikes.len()))
    };
    let mut passed = 0;
    while passed < settling {
        let tested = TEST_INTERVAL.min(settling - passed);
        let (found, seen) = follow(&mut motion, tested)?;
        passed += tested;
        if let Regime::Periodic { impacts, cycles } = found.regime
            // The pattern has repeated at least three times, and is settled or approaches a stable motion.
            && seen >= 3 * impacts as usize
            && 3 * cycles <= tested
            && (found.settled
                || matches!(excitation, Excitation::Sine(_)) && found.distance.is_some_and(|d| d < NEARLY_SETTLED))
            && let Some(cell) = periodic(rig, excitation, &found)
            && cell.spectral_radius.is_some_and(|r| r < 1.0)
        {
            return Ok(cell);
        }
    }
    let (found, _) = follow(&mut motion, cycles - passed)?;
    let regime = Some(found.regime);
    Ok(match found.regime {
        Regime::Periodic { .. } => periodic(rig, excitation, &found)
            .unwrap_or(Cell { regime: Some(Regime::Irregular), spectral_radius: None }),
        Regime::NoImpact => Cell { regime, spectral_radius: Some(free_radius(rig, excitation)) },
        _ => Cell { regime, spectral_radius: None },
    })
}

/// The cell of a pattern. Under a sine force the pattern's periodic orbit gives the shortest period, if the
/// orbit is admissible and not unstable. Without this orbit the pattern counts only if settled.
fn periodic(rig: &Rig, excitation: &Excitation, found: &Pattern) -> Option<Cell> {
    let Regime::Periodic { cycles, .. } = found.regime else { return None };
    let cell_of_pattern = |settled: bool| {
        let spectral_radius = radius(rig, excitation, cycles, &found.strikes);
        settled.then_some(Cell { regime: Some(found.regime), spectral_radius })
    };
    let Excitation::Sine(sine) = excitation else { return cell_of_pattern(true) };
    let orbit =
        PeriodicOrbit::from_strikes(rig, sine, cycles, &found.strikes).and_then(PeriodicOrbit::shortest);
    match orbit {
        Ok(orbit) if orbit.validity.admissible && orbit.validity.stable != Some(false) => Some(Cell {
            regime: Some(Regime::Periodic { impacts: orbit.impacts(), cycles: orbit.cycles }),
            spectral_radius: orbit.spectral_radius(),
        }),
        // A simulation stays near an unstable motion for a while, and leaves it.
        Ok(orbit) if orbit.validity.admissible && orbit.validity.stable == Some(false) => None,
        _ => cell_of_pattern(found.settled),
    }
}

/// Spectral radius along a pattern of impacts; `None` under several sines, whose force does not follow from
/// one phase.
fn radius(rig: &Rig, excitation: &Excitation, cycles: u32, strikes: &[Strike]) -> Option<f64> {
    if matches!(excitation, Excitation::Sines(_)) {
        return None;
    }
    let ([first, second], [m1, _]) = (rig.oscillators(), rig.masses());
    let rate = |s: &State, force: f64| {
        [s.v1, force / m1 + first.acceleration(s.x1, s.v1), s.v2, second.acceleration(s.x2, s.v2)]
    };
    let mut whole = Matrix4::identity();
    for (i, strike) in strikes.iter().enumerate() {
        let impulse = rig.exchange() * strike.approach_velocity;
        let before = strike.before;
        let after = rig.struck(before, impulse);
        let end = strikes
            .get(i + 1)
            .map_or_else(|| strikes[0].time + f64::from(cycles) / excitation.frequency(), |next| next.time);
        let force = Forcing::new(excitation, strike.phase).ok()?.force(0.0);
        let (before, after) = (rate(&before, force), rate(&after, force));
        whole = floquet::monodromy(rig, end - strike.time, &before, &after).0 * whole;
    }
    floquet::multipliers(&whole).ok().map(|m| m[0].norm())
}

/// Spectral radius of a cycle T without impacts: e^{−bT}, with the smaller decay rate b of both masses. Above
/// critical damping the decay rate of a mass is that of its slower decay.
fn free_radius(rig: &Rig, excitation: &Excitation) -> f64 {
    let decay = rig.oscillators().map(|o| o.slowest());
    (-decay[0].min(decay[1]) / excitation.frequency()).exp()
}

#[cfg(test)]
mod tests;
