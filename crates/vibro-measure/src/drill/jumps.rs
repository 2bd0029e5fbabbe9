//! Impacts as jumps of a velocity.
//!
//! On both sides of the contact the velocity is fitted by a parabola; both are continued to the middle of
//! the contact, where the measured velocity passes half way between them. This treats the impact as an
//! instant, as the balance of momentum requires. A straight line would be more precise in noise, but biased
//! where the drive accelerates the striker: by 0.04 m/s over 0.5 ms, for a stroke of 7.5 m/s at 50 Hz.

use super::faults::State;
use super::parabola::{FEWEST, Parabola};
use super::turns::Turn;
use super::{Impact, TurnsFrom, turns};
use crate::residuals::Whiteness;
use vibro_record::{median, sort_by_number};

/// Most impacts in a turn: one at the front and one at the rear, and as many again where a turn holds two
/// cycles of the machine.
const MOST: usize = 4;
/// Smallest jump that counts, over the largest of its turn, and over the median of these largest jumps.
pub(crate) const PART: f64 = 0.25;
/// Share of a jump's height between two neighbouring samples above which the jump counts as shorter than one
/// sample.
const AT_ONCE: f64 = 0.8;
/// Least height of a jump over its standard uncertainty: noise at the thousand or so samples of a turn does
/// not reach it.
const CLEAR: f64 = 6.0;
/// Fraction of a jump's height. The time from it to half the height shows how long the contact takes.
const BEGUN: f64 = 0.1;
/// Time from first contact to half the jump, over the time from [`BEGUN`] to half: ½/(½ − acos(0.8)/π) for a
/// half-sine contact force.
const HALF: f64 = 1.694;
/// Standard uncertainty of [`HALF`]: for a constant force the ratio is 1.25, and all values between are
/// equally likely.
const SHAPE: f64 = 0.13;

/// A jump, kept until all are known.
#[derive(Debug, Clone)]
struct Jump {
    cycle: usize,
    turn: Turn,
    /// Position of the impact in samples.
    at: f64,
    /// Fits before and after the contact.
    sides: [Parabola; 2],
    /// Step between the two samples around this position, in the unit of the velocity.
    step: f64,
    /// Fraction of the interval between these two samples that lies before this position.
    share: f64,
    clipped: bool,
    /// Samples from [`BEGUN`] of the jump to half of it; NaN if [`BEGUN`] is not crossed within the contact.
    rise: f64,
}

impl Jump {
    fn height(&self) -> f64 {
        (self.sides[1].value - self.sides[0].value).abs()
    }
}

/// Finds the jumps of one turn after the other.
pub(super) struct Jumps<'a> {
    values: &'a [f64],
    states: &'a [State],
    /// Samples from the end of a fit to the middle of the contact.
    pub gap: usize,
    length: usize,
    /// Samples before the beginning of a turn in which an impact still belongs to that turn.
    lead: f64,
    found: Vec<Jump>,
    largest: Vec<f64>,
    /// Number of turns whose impact lies in a fault of the velocity.
    pub hidden: usize,
}

impl<'a> Jumps<'a> {
    /// Jumps in these numbered turns, or in parts of a record whose turns are not known. Contacts take
    /// `contact` samples at most; fits use `fit` samples on each side. Where impacts begin the turns, the
    /// impact that begins a turn belongs to it, even if it is found a little earlier.
    pub fn of(
        values: &'a [f64],
        states: &'a [State],
        (contact, fit): (f64, f64),
        turns: impl Iterator<Item = (usize, Turn)>,
        turns_from: Option<TurnsFrom>,
    ) -> Jumps<'a> {
        let gap = ((0.5 * contact).ceil() as usize).max(1);
        let length = (fit.round() as usize).max(FEWEST);
        let lead = if turns_from == Some(TurnsFrom::Impacts) { gap as f64 } else { 0.0 };
        let most = if turns_from.is_some() { MOST } else { usize::MAX };
        let (found, largest) = (Vec::new(), Vec::new());
        let mut jumps = Jumps { values, states, gap, length, lead, found, largest, hidden: 0 };
        turns.for_each(|(cycle, turn)| jumps.search(cycle, turn, most));
        jumps
    }

    /// Searches a turn for `most` jumps at most, the largest step first.
    fn search(&mut self, cycle: usize, turn: Turn, most: usize) {
        let (start, end) = (turn.start - self.lead, turn.end - self.lead);
        let (from, to) = (start.ceil() as usize, end.ceil() as usize);
        let steps: Vec<f64> = (from..to).map(|i| self.step(i)).collect();
        let mut open = vec![true; steps.len()];
        let top = steps.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let (mut largest, mut disturbed) = (None, false);
        let mut high: Vec<usize> = (0..steps.len()).filter(|k| steps[*k].abs() > PART * top).collect();
        sort_by_number(&mut high, |a| steps[*a].abs());
        let mut tried = 0;
        while let Some(k) = high.pop().filter(|_| tried < most) {
            if !open[k] {
                continue;
            }
            tried += 1;
            let reach = 2 * self.gap + self.averaged();
            open[k.saturating_sub(reach)..(k + reach).min(steps.len())].fill(false);
            let Some(jump) = self.refine(cycle, turn, from + k) else {
                disturbed = disturbed || self.disturbed(from + k);
                continue;
            };
            if (start..end).contains(&jump.at) {
                largest = largest.or(Some(jump.height()));
                self.found.push(jump);
            }
        }
        self.hidden += usize::from(largest.is_none() && disturbed);
        self.largest.extend(largest);
    }

    /// Number of samples in each of the two means of [`Jumps::step`].
    fn averaged(&self) -> usize {
        (self.length / 4).max(3)
    }

    /// Difference between the means after and before sample `i`, without the samples of the contact; 0 at the
    /// ends of the record.
    fn step(&self, i: usize) -> f64 {
        let m = self.averaged();
        let mean = |from: usize| Some(self.values.get(from..from + m)?.iter().sum::<f64>() / m as f64);
        let before = (i + 1).checked_sub(self.gap + m).and_then(mean);
        mean(i + self.gap).zip(before).map_or(0.0, |(behind, before)| behind - before)
    }

    /// Whether a fault lies within the contact at sample `at`.
    fn disturbed(&self, at: usize) -> bool {
        let near = at.saturating_sub(self.gap)..(at + self.gap + 1).min(self.states.len());
        self.states.get(near).is_some_and(|s| s.iter().any(|s| !s.measured()))
    }

    /// The jump near a sample. The fits are made three times, each time around the latest crossing.
    fn refine(&self, cycle: usize, turn: Turn, near: usize) -> Option<Jump> {
        let (values, states) = (self.values, self.states);
        let mut at = near as f64;
        let mut found = None;
        for _ in 0..3 {
            let left = (at - self.gap as f64).floor() as isize;
            let right = (at + self.gap as f64).ceil() as isize;
            let length = self.length as isize - 1;
            let before = Parabola::through(values, states, at, left - length..=left)?;
            let after = Parabola::through(values, states, at, right..=right + length)?;
            let middle = 0.5 * (before.value + after.value);
            let inside = left.max(0) as usize..right as usize;
            let mut crossings = inside.filter_map(|i| Some((i, turns::between(values, i, middle)?)));
            let (i, first) = crossings.next()?;
            let last = crossings.next_back().map_or(first, |crossing| crossing.1);
            at = 0.5 * (first + last);
            let begun = before.value + BEGUN * (after.value - before.value);
            let began = (left.max(0) as usize..=i).rev().find_map(|k| turns::between(values, k, begun));
            let reached = (left - length).max(0) as usize..=(right + length) as usize;
            found = Some(Jump {
                cycle,
                turn,
                at,
                sides: [before, after],
                step: values[i + 1] - values[i],
                share: at - i as f64,
                clipped: states.get(reached).is_some_and(|s| s.contains(&State::Clipped)),
                rise: began.map_or(f64::NAN, |began| at - began),
            });
        }
        found.filter(|jump| {
            let variance: f64 = jump.sides.iter().map(Parabola::variance).sum();
            jump.height() > CLEAR * variance.sqrt() && !self.disturbed(jump.at.round() as usize)
        })
    }

    /// All impacts in the order of time, at `rate` samples a second, with reference edges of standard
    /// uncertainty `edge` samples; and the residuals of their fits.
    pub fn finish(mut self, rate: f64, edge: f64) -> (Vec<Impact>, Vec<[Vec<f64>; 2]>) {
        let typical = median(&self.largest);
        self.found.retain(|j| j.height() >= PART * typical);
        sort_by_number(&mut self.found, |a| a.at);
        let noise = [0, 1].map(|k| {
            let sides = || self.found.iter().map(|j| &j.sides[k]);
            let variance = sides().map(|s| s.squares).sum::<f64>() / sides().map(|s| s.freedom).sum::<f64>();
            // A laser's decoder limits the bandwidth of its noise, so neighbouring samples are correlated.
            let residuals: Vec<&[f64]> = sides().map(|s| s.residuals.as_slice()).collect();
            (variance, variance * Whiteness::of(&residuals).inflation.powi(2))
        });
        // Time from first contact to the middle of the contact, in samples. One median serves all impacts:
        // contacts of one machine are alike.
        let rise = median(self.found.iter().map(|j| j.rise).filter(|rise| rise.is_finite()));
        let (half, half_std) = (HALF * rise, (SHAPE * rise).hypot(1.0 / 12f64.sqrt()));
        let impact = |j: &Jump| {
            let approach = &j.sides[0];
            let [before, after] = [0, 1].map(|k| noise[k].1 * j.sides[k].leverage);
            let length = j.turn.end - j.turn.start;
            // An impact found before its turn begins is the one that begins it.
            let phase = ((j.at - j.turn.start) / length).max(0.0);
            // The crossing lies between two samples; the level that is crossed is the mean of both values.
            let weight = (1.0 - j.share).powi(2) + j.share * j.share;
            let crossed = 0.5 * (noise[0].0 + noise[1].0) * weight + 0.25 * (before + after);
            // A jump within one sample may lie anywhere in it.
            let sampling = if j.step.abs() > AT_ONCE * j.height() { 1.0 / 12.0 } else { 0.0 };
            let time = crossed / (j.step * j.step) + sampling;
            let edges = edge * edge * ((1.0 - phase).powi(2) + phase * phase);
            Impact {
                cycle: j.cycle,
                group: 0,
                time: j.at / rate,
                time_std: Some(time.sqrt() / rate),
                phase,
                phase_std: Some((time + edges).sqrt() / length),
                first_contact: approach.beside(-half),
                first_contact_std: Some(before.sqrt().hypot(approach.slope * half_std)),
                before: approach.value,
                before_std: Some(before.sqrt()),
                after: j.sides[1].value,
                after_std: Some(after.sqrt()),
                clipped: j.clipped,
            }
        };
        let impacts = self.found.iter().map(impact).collect();
        (impacts, self.found.into_iter().map(|j| j.sides.map(|s| s.residuals)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    /// A velocity that rises with 2000 m/s² and a bend to 7.5 m/s at the impact at sample `at`, then −1.5 m/s
    /// with 1000 m/s²; the contact takes 6 samples.
    fn trace(at: f64) -> Vec<f64> {
        let dt = 1e-5;
        let before = |s: f64| 7.5 + 2000.0 * s + 1e5 * s * s;
        let after = |s: f64| -1.5 + 1000.0 * s;
        (0..2000)
            .map(|i| {
                let s = f64::from(i) - at;
                let mix = 0.5 + 0.5 * (std::f64::consts::PI * (s / 6.0).clamp(-0.5, 0.5)).sin();
                (1.0 - mix) * before(s * dt) + mix * after(s * dt)
            })
            .collect()
    }

    fn one(values: &[f64], states: &[State]) -> (Vec<Impact>, usize) {
        let turn = std::iter::once((4, Turn { start: 100.0, end: 1900.0 }));
        let jumps = Jumps::of(values, states, (20.0, 50.0), turn, Some(TurnsFrom::Reference));
        let hidden = jumps.hidden;
        (jumps.finish(1e5, 0.0).0, hidden)
    }

    #[test]
    fn speeds_and_instant_of_a_jump() {
        for at in [700.0, 700.25, 700.5, 933.9] {
            let values = trace(at);
            let (impacts, hidden) = one(&values, &vec![State::Good; values.len()]);
            assert_eq!((impacts.len(), hidden), (1, 0));
            let i = impacts[0];
            // Without noise a parabola is fitted exactly: sums of 50 squares of numbers near 1, a condition
            // of about 1e4.
            assert!((i.before - 7.5).abs() < 1e-3 && (i.after + 1.5).abs() < 1e-3, "{i:?}");
            // The contact begins three samples before its middle: 7.5 − 0.06 m/s, and a bend of 10⁻⁴ m/s. Its
            // length is known to half a sample.
            assert!(
                i.first_contact_std.is_some_and(|std| (i.first_contact - 7.44).abs() < std && std < 0.01),
                "{i:?}"
            );
            // The cubic between samples of the sine is off by (π/6)⁴·4.5·9/16/24 = 0.008 m/s, at a slope of
            // 2.3 m/s a sample.
            assert!((i.time * 1e5 - at).abs() < 4e-3, "{i:?}");
            assert!((i.phase - (at - 100.0) / 1800.0).abs() < 3e-6 && i.cycle == 4);
        }
    }

    #[test]
    fn an_impact_in_a_drop_out_is_hidden_and_one_beside_it_is_not() {
        let values = trace(700.0);
        let mut states = vec![State::Good; values.len()];
        states[695..702].fill(State::Bridged);
        assert_eq!(one(&values, &states), (Vec::new(), 1));
        states[..750].fill(State::Good);
        states[720..730].fill(State::Bridged);
        let (impacts, hidden) = one(&values, &states);
        assert!((impacts[0].after + 1.5).abs() < 1e-3 && hidden == 0);
    }

    #[test]
    fn an_impact_whose_fits_reach_the_end_of_the_range_is_clipped() {
        let values = trace(700.0);
        let mut states = vec![State::Good; values.len()];
        states[685..688].fill(State::Clipped);
        let (impacts, hidden) = one(&values, &states);
        assert!(impacts.len() == 1 && impacts[0].clipped && hidden == 0);
        // Clipped samples before the fits, which begin 60 samples before the impact, do not count.
        states.fill(State::Good);
        states[500..600].fill(State::Clipped);
        assert!(!one(&values, &states).0[0].clipped);
    }

    #[test]
    fn a_smooth_motion_has_no_impact() {
        let values: Vec<f64> = (0..2000).map(|i| 5.0 * (f64::from(i) * 0.004).sin()).collect();
        let mut noise = Noise::new(3);
        let values: Vec<f64> = values.iter().map(|v| v + 0.05 * (noise.uniform() - 0.5)).collect();
        assert_eq!(one(&values, &vec![State::Good; 2000]), (Vec::new(), 0));
    }
}
