//! The measuring campaign: simulated sweeps of the rig, and the files that the analyser would store of them.

use super::analyser::{self, BASE_BAND, BLOCK, INTERVAL, LINES, SAMPLES};
use super::noise::PairedNoise;
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use vibro_model::portrait::Samples;
use vibro_model::{Motion, Rig, Simulation, Sine, State};
use vibro_record::Result;

/// Force amplitude in N. At this force the rig of the thesis shows the in-phase (grazing) resonance in sweeps
/// in both directions, but the out-of-phase (clapping) resonance only in the sweep up.
const FORCE: f64 = 0.1;

/// Coefficient of restitution. The clapping branch ends where the force no longer supplies the losses in
/// dampers and impacts: at 10.67 Hz for this value, and at 10.79 Hz for 0.998, the restitution of the
/// thesis' contact (1e5 N/m, 0.1 N s/m).
const RESTITUTION: f64 = 0.98;

/// Frequencies of the generator in Hz, ascending; none lies on a line of the analyser (multiples of 0.05 Hz).
const FREQUENCIES: [f64; 40] = [
    4.013, 4.267, 4.518, 4.772, 4.981, 5.137, 5.262, 5.343, 5.417, 5.471, 5.508, 5.546, 5.592, 5.664, 5.758,
    5.883, 6.038, 6.287, 6.609, 6.941, 7.268, 7.572, 7.884, 8.189, 8.513, 8.827, 9.132, 9.436, 9.718, 9.967,
    10.183, 10.364, 10.478, 10.567, 10.622, 10.689, 10.861, 11.262, 11.918, 12.842,
];

/// Time in s from a frequency step to its measurement: the slowest transient without impacts decays to
/// e^{−16}.
const SETTLE: f64 = 40.0;

/// Direction of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    Up,
    Down,
}

impl Direction {
    /// Word for the direction in `TRUTH.csv`.
    fn word(self) -> &'static str {
        if self == Direction::Up { "up" } else { "down" }
    }

    /// File names of the force spectrum and the two velocity spectra of point `number`, eleven characters
    /// each.
    fn names(self, number: usize) -> [String; 3] {
        let (long, short) = if self == Direction::Up { ("UP", 'U') } else { ("DN", 'D') };
        [
            format!("F{long}{number:04}.DAT"),
            format!("V1{short}{number:04}.DAT"),
            format!("V2{short}{number:04}.DAT"),
        ]
    }
}

/// One point of a sweep: a block of the settled motion.
pub struct Point {
    direction: Direction,
    /// Number of the point from 1, in the order of measurement.
    number: usize,
    /// Excitation frequency in Hz.
    frequency: f64,
    /// Phase of the force in rad at the start of the block.
    phase: f64,
    /// States at the converter's sampling times, and the state at the end of the block.
    states: Vec<State>,
    /// Impacts per cycle, such as `1` or `2/2`, or `irregular`.
    impacts_per_cycle: String,
}

/// Simulates a sweep in `direction`, calls `show` with each point, and stops after `last` points.
pub fn simulate(direction: Direction, last: usize, mut show: impl FnMut(&Point) -> Result<()>) -> Result<()> {
    let rig = Rig { restitution: RESTITUTION, ..Rig::thesis() };
    let mut frequencies = FREQUENCIES;
    if direction == Direction::Down {
        frequencies.reverse();
    }
    let mut motion = Simulation::new(&rig, &Sine { force: FORCE, frequency: frequencies[0] })?;
    for (i, frequency) in frequencies.into_iter().enumerate().take(last) {
        motion.set_frequency(frequency)?;
        motion.run(motion.time() + SETTLE, |_| {})?;
        let (phase, impacts_per_cycle) = (motion.phase(), impacts_per_cycle(motion.clone())?);
        let until = motion.time() + SAMPLES as f64 * INTERVAL;
        let mut samples = Samples::new(motion.time(), INTERVAL, until);
        motion.advance(until, &mut |piece| samples.take(&piece))?;
        let mut states = samples.states;
        states.push(motion.state());
        show(&Point { direction, number: i + 1, frequency, phase, states, impacts_per_cycle })?;
    }
    Ok(())
}

/// Impacts per cycle of the periodic motion, or `irregular`; `2/2` has two impacts in a period of two cycles.
///
/// States at one phase of the force are compared in the last cycles of a block. The motion is periodic with q
/// cycles if every state differs from the one q cycles later by less than a thousandth of the largest state.
fn impacts_per_cycle(mut motion: Simulation) -> Result<String> {
    /// Longest period in cycles that is recognised.
    const LONGEST_PERIOD: usize = 12;
    let period = 1.0 / motion.frequency();
    let cycles = (BLOCK / period) as usize;
    let mut strobe = Vec::with_capacity(cycles);
    let start = motion.time();
    for n in 1..=cycles {
        let mut impacts = 0_usize;
        motion.run(start + n as f64 * period, |leg| impacts += usize::from(leg.impact().is_some()))?;
        strobe.push((motion.state(), impacts));
    }
    let tail = &strobe[cycles.saturating_sub(3 * LONGEST_PERIOD)..];
    let size = |s: &State| s.x1.abs() + s.x2.abs() + (s.v1.abs() + s.v2.abs()) * period / TAU;
    let largest = tail.iter().map(|(s, _)| size(s)).fold(0.0, f64::max);
    let close = |a: &State, b: &State| {
        let difference = State { x1: a.x1 - b.x1, v1: a.v1 - b.v1, x2: a.x2 - b.x2, v2: a.v2 - b.v2 };
        size(&difference) < 1e-3 * largest
    };
    let repeats = |q: &usize| tail.iter().zip(&tail[*q..]).all(|((a, _), (b, _))| close(a, b));
    Ok(match (1..=LONGEST_PERIOD).find(repeats) {
        Some(q) => {
            // An impact at the compared phase may be counted in the cycle before or after it. The mean over
            // many periods, rounded, is not affected.
            let whole = tail.len() / q * q;
            let total: usize = tail[tail.len() - whole..].iter().map(|(_, n)| n).sum();
            let p = (total as f64 / (whole / q) as f64).round() as usize;
            if q == 1 { p.to_string() } else { format!("{p}/{q}") }
        }
        None => "irregular".to_owned(),
    })
}

impl Point {
    /// Names and contents of the force spectrum and both velocity spectra, with the noise of
    /// realisation number `draw`.
    pub fn files(&self, draw: u64) -> [(String, String); 3] {
        let omega = TAU * self.frequency;
        let force: Vec<f64> =
            (0..SAMPLES).map(|i| FORCE * (omega * i as f64 * INTERVAL + self.phase).cos()).collect();
        // Mean velocity over an interval of the converter: exactly the change of displacement divided by the
        // interval. At 13 Hz averaging lowers the amplitude by 0.01 %.
        let mean = |x: fn(&State) -> f64| -> Vec<f64> {
            self.states.windows(2).map(|pair| (x(&pair[1]) - x(&pair[0])) / INTERVAL).collect()
        };
        let noise = |channel| PairedNoise::new(draw, self.direction as u64, self.number as u64, channel);
        let spectra = [
            analyser::force(&force, &mut noise(0)),
            analyser::velocity(&mean(|s| s.x1), &mut noise(1)),
            analyser::velocity(&mean(|s| s.x2), &mut noise(2)),
        ];
        let mut names = self.direction.names(self.number).into_iter();
        spectra.map(|spectrum| (names.next().unwrap_or_default(), analyser::print(&spectrum)))
    }

    /// Row of `TRUTH.csv`: displacement amplitudes in m at the excitation frequency, from this block with the
    /// Hann window and without noise.
    pub fn truth(&self) -> String {
        let omega = TAU * self.frequency;
        let (mut sums, mut weight) = ([Complex64::ZERO; 2], 0.0);
        for (i, state) in self.states.iter().take(SAMPLES).enumerate() {
            let wave = Complex64::cis(-omega * i as f64 * INTERVAL) * analyser::hann(i);
            sums[0] += wave * state.x1;
            sums[1] += wave * state.x2;
            weight += analyser::hann(i);
        }
        let [x1, x2] = sums.map(|sum| 2.0 * sum.norm() / weight);
        format!(
            "{},{},{:.3},{x1:.6e},{x2:.6e},{}\n",
            self.direction.word(),
            self.number,
            self.frequency,
            self.impacts_per_cycle
        )
    }
}

/// First line of `TRUTH.csv`: frequency in Hz, amplitudes in m.
pub fn truth_header() -> String {
    "direction,point,frequency,x1,x2,impacts_per_cycle\n".to_owned()
}

/// Name and content of the list file of one mass. The content is, one a line: number of points, number of
/// spectral lines, base band in Hz, file names of the force spectra, file names of the response spectra.
pub fn list(direction: Direction, mass: usize) -> (String, String) {
    let names: Vec<[String; 3]> = (1..=FREQUENCIES.len()).map(|number| direction.names(number)).collect();
    let mut text = format!("{}\n{LINES}\n{BASE_BAND}\n", names.len());
    for column in [0, mass] {
        for name in &names {
            let _ = writeln!(text, "data/{}", name[column]);
        }
    }
    (format!("{}{mass}.TXT", direction.word().to_uppercase()), text)
}
