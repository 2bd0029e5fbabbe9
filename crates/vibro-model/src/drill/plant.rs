//! Equations of motion between two events: which contacts act, how the seal slips, how the air flows.
//!
//! All forces but those of curved contacts are linear in the state, with the pressure as a part of it. So the
//! borders of a stage are linear too, and their first crossing in a step's polynomial cannot be missed.

use super::chain::{CONSTRAINTS, Chain, ROWS, Restraint, STUCK};
use super::flow::{Flow, FlowRegime, GAS_CONSTANT, LINEAR_RATIO};
use super::machine::{Interface, Machine};
use super::motion::{NO_SPEED, PARTING};
use super::rungs::Rung;
use crate::law::{Law, LawDamping};

/// Size of the state: positions and velocities of striker, intermediate piston and bit, pressure and mass of
/// the air.
pub(super) const SIZE: usize = 8;
/// State: see [`SIZE`].
pub(super) type Vector = [f64; SIZE];
/// Pressure in Pa.
pub(super) const PRESSURE: usize = 6;
/// Mass of the air in kg.
pub(super) const GAS: usize = 7;
/// Pull in N, and relative pull of a curved contact, that counts as none: a billionth of a weight of 1 N.
const NO_FORCE: f64 = 1e-9;
/// Part of the time to a branch point of a force that a step may take, multiple of the time since one that
/// the first step takes, and factor on the tolerance in the first step into a curved contact. Larger steps
/// are found to be rejected.
const BEFORE_BRANCH: f64 = 0.6;
const BEHIND_BRANCH: f64 = 3.0;
const FIRST_ERROR: f64 = 5e4;
/// Largest step times natural frequency (rad/s) of a contact. Steps at the limit of stability, at about 6,
/// have an end within the tolerance, but a dense output that is a thousand times worse.
const STABLE: f64 = 5.0;
/// Number of components that forces depend on.
const LINEAR: usize = 7;

/// Linear function of the first components of the state.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Line {
    pub weights: [f64; LINEAR],
    pub offset: f64,
}

impl Line {
    fn of(terms: &[(usize, f64)], offset: f64) -> Line {
        let mut line = Line { offset, ..Line::default() };
        for (i, weight) in terms {
            line.weights[*i] += weight;
        }
        line
    }

    #[inline]
    pub fn value(&self, y: &Vector) -> f64 {
        self.weights.iter().zip(y).map(|(w, y)| w * y).sum::<f64>() + self.offset
    }

    fn add(&mut self, factor: f64, other: &Line) {
        self.weights.iter_mut().zip(&other.weights).for_each(|(sum, w)| *sum += factor * w);
        self.offset += factor * other.offset;
    }

    /// Factor times the line.
    fn times(mut self, factor: f64) -> Line {
        let line = self;
        self.add(factor - 1.0, &line);
        self
    }
}

/// Stage of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    /// Apart.
    Apart,
    /// Rigid bodies that move together.
    Held,
    /// Compliant, with a force that pushes.
    Pushing,
    /// Compliant and still indented, without force.
    Released,
}

/// What ends the present equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Watch {
    Meets(usize),
    Separates(usize),
    ForceEnds(usize),
    ForceReturns(usize),
    /// A held contact would have to pull.
    Pulls(usize),
    /// The striker's velocity falls to zero.
    Stops,
    /// A stuck striker begins to slip in this direction.
    Slips(f64),
    /// The flow enters another regime.
    Flows(FlowRegime),
    /// The striker enters another stretch of the vents.
    Vents(usize),
}

/// Machine on a rung, with its present equations of motion.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Plant {
    pub machine: Machine,
    pub chain: Chain,
    pub laws: [Option<Law>; 4],
    pub stages: [Stage; 4],
    /// Overlap in m that is no contact, after bodies at rest against each other have parted.
    pub slack: [f64; 4],
    /// Whether the striker sticks in its seal.
    pub stuck: bool,
    /// Direction in which it slips: −1, 0 or 1.
    pub slip: f64,
    pub flow: FlowRegime,
    pub stretch: usize,
    pub watches: Vec<(Watch, Line)>,
    forces: [Line; 3],
    /// Accelerations per component of the state that forces depend on, and with all of them 0.
    accelerations: [[f64; 3]; LINEAR + 1],
    holds: [Line; CONSTRAINTS],
    restraint: Restraint,
    conductance: [f64; 2],
    /// Whether a contact that is not linear pushes.
    curved: bool,
}

impl Plant {
    /// The machine with what the rung knows of it, all bodies apart.
    pub fn new(machine: &Machine, rung: Rung) -> Plant {
        let mut machine = machine.clone();
        if rung < Rung::Vented {
            machine.flow = Flow::SEALED;
        }
        if rung < Rung::Friction {
            (machine.striker.friction, machine.striker.damping) = (0.0, 0.0);
        }
        let laws = Interface::ALL.map(|k| {
            let compliant = rung >= Rung::Compliant || k == Interface::Damper;
            machine.contacts[k as usize].law.filter(|_| compliant)
        });
        Plant {
            chain: Chain::new(&machine),
            laws,
            stages: [Stage::Apart; 4],
            slack: [0.0; 4],
            stuck: false,
            slip: 0.0,
            flow: FlowRegime::Even,
            stretch: 0,
            watches: Vec::new(),
            forces: [Line::default(); 3],
            accelerations: [[0.0; 3]; LINEAR + 1],
            holds: [Line::default(); CONSTRAINTS],
            restraint: Restraint { response: [[0.0; 3]; 3], forces: [[0.0; 3]; CONSTRAINTS] },
            conductance: [0.0; 2],
            curved: false,
            machine,
        }
    }

    /// Constraints that act.
    pub fn kept(&self) -> [bool; CONSTRAINTS] {
        std::array::from_fn(|k| if k == STUCK { self.stuck } else { self.stages[k] == Stage::Held })
    }

    /// Makes the equations of the present stages; `false` where their constraints depend on each other.
    pub fn assemble(&mut self) -> bool {
        let Some(restraint) = self.chain.restraint(self.kept()) else { return false };
        let m = &self.machine;
        let (area, seal) = (m.cushion.area, m.striker);
        let weight = self.chain.masses.map(|mass| mass * m.gravity);
        self.forces = weight.map(|weight| Line::of(&[], weight));
        let ambient = area * m.cushion.ambient + seal.friction * self.slip;
        self.forces[0].add(1.0, &Line::of(&[(PRESSURE, area), (3, -seal.damping)], -ambient));
        self.curved = false;
        for k in (0..4).filter(|k| self.stages[*k] == Stage::Pushing) {
            match self.laws[k] {
                Some(law) if law.is_linear() => {
                    let push = self.linear_force(k, &law);
                    for (force, row) in self.forces.iter_mut().zip(&ROWS[k]) {
                        force.add(*row, &push);
                    }
                }
                _ => self.curved = true,
            }
        }
        let combined = |weights: &[f64; 3]| {
            let mut sum = Line::default();
            weights.iter().zip(&self.forces).for_each(|(w, force)| sum.add(*w, force));
            sum
        };
        let lines = restraint.response.map(|row| combined(&row));
        self.accelerations =
            std::array::from_fn(|i| lines.map(|line| line.weights.get(i).copied().unwrap_or(line.offset)));
        self.holds = restraint.forces.map(|row| combined(&row));
        self.restraint = restraint;
        self.conductance = self.machine.flow.conductance(self.stretch);
        self.watch();
        true
    }

    /// Gap of an interface as a line, and its rate of approach.
    fn gap_lines(&self, k: usize) -> (Line, Line) {
        let at = |first: usize, sign: f64| -> [(usize, f64); 3] {
            std::array::from_fn(|j| (first + j, sign * ROWS[k][j]))
        };
        (Line::of(&at(0, 1.0), self.chain.offsets[k]), Line::of(&at(3, -1.0), 0.0))
    }

    /// kδ + cδ̇ of an interface.
    fn linear_force(&self, k: usize, law: &Law) -> Line {
        let (gap, approach) = self.gap_lines(k);
        let mut force = gap.times(-law.stiffness);
        force.add(law.damping, &approach);
        force
    }

    fn watch(&mut self) {
        let mut watches = std::mem::take(&mut self.watches);
        watches.clear();
        for k in 0..4 {
            let (gap, approach) = self.gap_lines(k);
            let factor = || {
                // The factor of the force that may change its sign while the surfaces are indented.
                let law = self.laws[k].filter(|law| !matches!(law.form.damping, LawDamping::Lossless))?;
                let mut factor = approach.times(law.damping);
                factor.offset += 1.0;
                let force = if law.is_linear() { self.linear_force(k, &law) } else { factor };
                (law.damping != 0.0).then_some(force)
            };
            // A little more than zero: rounding must not open and close a contact at rest.
            let separates = Line { offset: PARTING - gap.offset, ..gap.times(-1.0) };
            match self.stages[k] {
                Stage::Apart => {
                    watches.push((Watch::Meets(k), Line { offset: gap.offset + self.slack[k], ..gap }));
                }
                Stage::Held => watches.push((Watch::Pulls(k), self.holds[k])),
                Stage::Pushing => {
                    watches.push((Watch::Separates(k), separates));
                    let ends = factor().map(|force| Line { offset: force.offset + NO_FORCE, ..force });
                    watches.extend(ends.map(|force| (Watch::ForceEnds(k), force)));
                }
                Stage::Released => {
                    watches.push((Watch::Separates(k), separates));
                    watches.extend(factor().map(|force| (Watch::ForceReturns(k), force.times(-1.0))));
                }
            }
        }
        let m = &self.machine;
        if self.stuck {
            for direction in [1.0, -1.0] {
                // The seal's force is opposite to the direction in which the striker would slip.
                let mut reserve = self.holds[STUCK].times(direction);
                reserve.offset += m.striker.friction;
                watches.push((Watch::Slips(direction), reserve));
            }
        } else if self.slip != 0.0 {
            watches.push((Watch::Stops, Line::of(&[(3, self.slip)], NO_SPEED)));
        }
        if !m.flow.is_sealed() {
            for (ratio, rising, beyond) in m.flow.borders(self.flow).into_iter().flatten() {
                let sign = if rising { -1.0 } else { 1.0 };
                let border = Line::of(&[(PRESSURE, sign)], -sign * ratio * m.cushion.ambient);
                watches.push((Watch::Flows(beyond), border));
            }
            let row = |i: usize| m.flow.vents.get(i).map(|vent| vent.position);
            if let Some(below) = self.stretch.checked_sub(1).and_then(row) {
                watches.push((Watch::Vents(self.stretch - 1), Line::of(&[(0, 1.0)], -below)));
            }
            if let Some(above) = row(self.stretch) {
                watches.push((Watch::Vents(self.stretch + 1), Line::of(&[(0, -1.0)], above)));
            }
        }
        self.watches = watches;
    }

    /// Indentation in m and its rate in m/s.
    fn indentation(&self, k: usize, y: &Vector) -> [f64; 2] {
        let [x, v] = halves(y);
        [-self.chain.gap(k, &x), Chain::approach(k, &v)]
    }

    /// Force in N of the law of a contact that pushes, and its elastic part. It is smooth beyond the ends of
    /// the stage: there it may pull.
    #[inline]
    fn law_forces(&self, k: usize, [depth, rate]: [f64; 2]) -> [f64; 2] {
        let force = |law: &Law, rate: f64| (law.form.force)(law, depth, rate);
        match &self.laws[k] {
            Some(law) if law.is_linear() || depth > 0.0 => [force(law, rate), force(law, 0.0)],
            _ => [0.0; 2],
        }
    }

    /// Bound in s on a step from here at the present rates: most of the time to a branch point of a force,
    /// where a flow ends or a curved contact parts; within the stability of a contact that stays.
    pub fn step_bound(&self, y: &Vector, rate: &Vector, tolerance: f64) -> f64 {
        let time = |left: f64, speed: f64| if speed > 0.0 { left / speed } else { f64::INFINITY };
        let over = y[PRESSURE] - self.machine.cushion.ambient;
        let even = match self.flow {
            _ if self.conductance == [0.0; 2] => f64::INFINITY,
            FlowRegime::Out => time(over, -rate[PRESSURE]),
            FlowRegime::In => time(-over, rate[PRESSURE]),
            _ => f64::INFINITY,
        };
        let pushing = (0..4).filter(|k| self.stages[*k] == Stage::Pushing);
        let contact = pushing.filter_map(|k| {
            let law = self.laws[k]?;
            let [depth, approach] = self.indentation(k, y);
            let slope = law.exponent * law.stiffness * depth.max(0.0).powf(law.exponent - 1.0);
            let stable = STABLE / (slope * self.chain.compliance(k)).sqrt();
            let branch = if law.is_linear() { f64::INFINITY } else { BEFORE_BRANCH * time(depth, -approach) };
            // What is left of a force at its end is within the tolerance.
            Some(stable.min(branch).max(self.first_step(k, y, tolerance)))
        });
        contact.fold(BEFORE_BRANCH * even, f64::min)
    }

    /// Step in s for a contact that begins, or ends. With its speed V it has a time scale T,
    /// V² = k(VT)^{n+1}/M; a force that begins with the power n of the time gives an error with the power
    /// n + 1.
    pub fn first_step(&self, k: usize, y: &Vector, tolerance: f64) -> f64 {
        let Some(law) = self.laws[k] else { return f64::INFINITY };
        let speed = self.indentation(k, y)[1].abs().max(NO_SPEED);
        let rise = law.exponent + 1.0;
        let time =
            (self.chain.compliance(k) * law.stiffness).powf(-1.0 / rise) * speed.powf((2.0 - rise) / rise);
        time * if law.is_linear() { 0.1 } else { (FIRST_ERROR * tolerance).powf(1.0 / rise) }
    }

    /// First step in s behind a border of the regime of even pressures, which lie half of it from the branch
    /// point of the flow.
    pub fn even_step(&self, t: f64, y: &Vector) -> f64 {
        let rate = self.rate(self.machine.crank.at(t), y)[PRESSURE];
        let half = (1.0 - LINEAR_RATIO) * self.machine.cushion.ambient;
        BEHIND_BRANCH * half / rate.abs().max(f64::MIN_POSITIVE)
    }

    fn law_force(&self, k: usize, y: &Vector) -> f64 {
        self.law_forces(k, self.indentation(k, y))[0]
    }

    /// Forces in N on the bodies by contacts that are not linear.
    fn curved_forces(&self, y: &Vector) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for k in (0..4).filter(|k| self.curved && self.stages[*k] == Stage::Pushing) {
            if self.laws[k].is_some_and(|law| !law.is_linear()) {
                let force = self.law_force(k, y);
                sum.iter_mut().zip(&ROWS[k]).for_each(|(sum, row)| *sum += row * force);
            }
        }
        sum
    }

    /// Force in N that keeps a constraint.
    pub fn hold(&self, k: usize, y: &Vector) -> f64 {
        let extra = self.curved_forces(y);
        let curved: f64 = self.restraint.forces[k].iter().zip(extra).map(|(row, f)| row * f).sum();
        self.holds[k].value(y) + curved
    }

    /// Whether the value of a watched line is not all of what is watched.
    pub fn is_curved(&self, watch: Watch) -> bool {
        self.curved && matches!(watch, Watch::Pulls(_) | Watch::Slips(_))
    }

    /// Velocities in m/s after plastic impacts of all constraints that act, and their impulses in N s.
    pub fn projected(&self, velocities: &[f64; 3]) -> ([f64; 3], [f64; CONSTRAINTS]) {
        self.chain.projected(&self.restraint, velocities)
    }

    /// Force in N of a contact, 0 where it is apart.
    pub fn contact_force(&self, k: usize, y: &Vector) -> f64 {
        match self.stages[k] {
            Stage::Held => self.hold(k, y),
            Stage::Pushing => self.law_force(k, y),
            _ => 0.0,
        }
    }

    /// Force in N on the housing, towards the bit, by air, seal and buffer; the piston is without mass.
    pub fn handle_force(&self, y: &Vector) -> f64 {
        let (cushion, seal) = (&self.machine.cushion, self.machine.striker);
        let friction = if self.stuck { -self.hold(STUCK, y) } else { seal.friction * self.slip };
        let air = (y[PRESSURE] - cushion.ambient) * cushion.area;
        friction + seal.damping * y[3] - air - self.contact_force(Interface::Buffer as usize, y)
    }

    /// Volume in m³ of the cushion at a time (s) of the turn.
    pub fn volume(&self, t: f64, y: &Vector) -> f64 {
        self.machine.cushion.volume(y[0], self.machine.crank.at(t)[0])
    }

    /// Energy in J of the indented contacts.
    pub fn elastic(&self, y: &Vector) -> f64 {
        let indented = (0..4).filter(|k| matches!(self.stages[*k], Stage::Pushing | Stage::Released));
        let energy = |k: usize| {
            let depth = self.indentation(k, y)[0].max(0.0);
            self.laws[k]
                .map_or(0.0, |law| law.stiffness * depth.powf(law.exponent + 1.0) / (law.exponent + 1.0))
        };
        indented.map(energy).sum()
    }

    /// Mass flow ṁ in kg/s into the cushion of this volume (m³), and `RTṁ` of what flows, in W.
    #[inline]
    fn flow(&self, volume: f64, y: &Vector) -> [f64; 2] {
        let [start, slope] = self.conductance;
        let conductance = start + slope * y[0];
        if conductance == 0.0 {
            return [0.0; 2];
        }
        let cushion = &self.machine.cushion;
        let temperature = y[PRESSURE] * volume / (y[GAS] * GAS_CONSTANT);
        let pressures = [y[PRESSURE], cushion.ambient];
        let temperatures = [temperature, cushion.temperature];
        let [flow, at] = self.machine.flow.rate(self.flow, conductance, pressures, temperatures);
        [flow, GAS_CONSTANT * at * flow]
    }

    /// Powers in W of the piston on the air against ambient pressure, and lost in the seal, in compliant
    /// contacts and by the flow −∂E/∂p (n/V) `RTṁ`; with position and velocity of the piston.
    pub fn powers(&self, [piston, piston_velocity]: [f64; 2], y: &Vector) -> [f64; 4] {
        let (cushion, seal) = (&self.machine.cushion, self.machine.striker);
        let [_, filled] = self.flow(cushion.volume(y[0], piston), y);
        let flow =
            if filled == 0.0 { 0.0 } else { -cushion.exponent * cushion.expansion(y[PRESSURE]) * filled };
        let indented = (0..4).filter(|k| matches!(self.stages[*k], Stage::Pushing | Stage::Released));
        let lost = |k: usize| {
            let [depth, approach] = self.indentation(k, y);
            let [force, elastic] = self.law_forces(k, [depth, approach]);
            let force = if self.stages[k] == Stage::Pushing { force } else { 0.0 };
            (force - elastic) * approach
        };
        [
            (y[PRESSURE] - cushion.ambient) * cushion.area * piston_velocity,
            (seal.friction * self.slip + seal.damping * y[3]) * y[3],
            indented.map(lost).sum(),
            flow,
        ]
    }

    /// Derivative of the state, with position and velocity of the piston.
    #[inline]
    pub fn rate(&self, [piston, piston_velocity]: [f64; 2], y: &Vector) -> Vector {
        let cushion = &self.machine.cushion;
        let mut rate = [0.0; SIZE];
        rate[..3].copy_from_slice(&y[3..6]);
        let mut accelerations = self.accelerations[LINEAR];
        for (column, y) in self.accelerations.iter().zip(&y[..LINEAR]) {
            accelerations.iter_mut().zip(column).for_each(|(sum, weight)| *sum += weight * y);
        }
        rate[3..6].copy_from_slice(&accelerations);
        if self.curved {
            let extra = self.curved_forces(y);
            for (rate, row) in rate[3..6].iter_mut().zip(&self.restraint.response) {
                *rate += row.iter().zip(&extra).map(|(p, f)| p * f).sum::<f64>();
            }
        }
        let volume = cushion.volume(y[0], piston);
        let growth = cushion.area * (y[3] - piston_velocity);
        let pressure = y[PRESSURE];
        let [flow, filled] = self.flow(volume, y);
        rate[GAS] = flow;
        rate[PRESSURE] = cushion.exponent / volume * (filled - pressure * growth);
        rate
    }
}

/// Positions and velocities of a state.
pub(super) fn halves(y: &Vector) -> [[f64; 3]; 2] {
    [[y[0], y[1], y[2]], [y[3], y[4], y[5]]]
}
