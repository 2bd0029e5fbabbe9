//! The motion of an orbit from just after an impact to just before the next, as a sequence of smooth
//! stretches.

use super::turns::Signal;
use crate::flow::{Flight, State};

/// Successive flights from impact to impact. An impulse or a step of the force ends a flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Time from impact to impact in s.
    pub period: f64,
    /// Duration of each stretch in s, and its motion; at least one.
    pub stretches: Vec<(f64, Flight)>,
}

impl Course {
    /// A course of one stretch.
    pub fn smooth(period: f64, flight: &Flight) -> Course {
        Course { period, stretches: vec![(period, *flight)] }
    }

    /// State at `t` (s), 0 ≤ `t` ≤ T; at 0 the state after the impact, at T the state before the next.
    pub fn state(&self, mut t: f64) -> State {
        let last = self.stretches.len() - 1;
        for (duration, stretch) in &self.stretches[..last] {
            if t < *duration {
                return stretch.state(t);
            }
            t -= duration;
        }
        self.stretches[last].1.state(t)
    }

    /// Rates (v₁, a₁, v₂, a₂) of the state just before and just after the impact.
    pub fn rates(&self) -> ([f64; 4], [f64; 4]) {
        let (duration, last) = &self.stretches[self.stretches.len() - 1];
        (last.rate(*duration), self.stretches[0].1.rate(0.0))
    }

    /// Rounding error of a computed gap in m.
    pub fn noise(&self) -> f64 {
        self.stretches.iter().map(|(_, stretch)| stretch.noise()).fold(0.0, f64::max)
    }

    /// Ranges of both displacements, and the smallest gap between the impacts.
    pub fn survey(&self) -> Excursion {
        // A minimum of the gap closer in time to the impact than this is the impact itself: without rebound
        // the gap begins at zero rate.
        let margin = 1e-9 * self.period;
        let inside = |t: f64| t > margin && t < self.period - margin;
        let mut survey = Excursion { ranges: [(f64::INFINITY, f64::NEG_INFINITY); 2], closest: None };
        let (mut before, mut start) = (None::<f64>, 0.0);
        for (duration, stretch) in &self.stretches {
            let duration = *duration;
            let (first, last) = (stretch.series(0.0), stretch.series(duration));
            // The gap has a minimum, smooth or a corner, where two stretches join.
            if inside(start) && before.is_some_and(|rate| rate < 0.0 && first[1][1] >= first[0][1]) {
                survey.near(stretch.gap + first[1][0] - first[0][0]);
            }
            before = Some(last[1][1] - last[0][1]);
            for mass in 0..2 {
                survey.reach(mass, first[mass][0]);
                survey.reach(mass, last[mass][0]);
            }
            stretch.each_turn(duration, |signal, t, value, bend| match signal {
                Signal::X1 => survey.reach(0, value),
                Signal::X2 => survey.reach(1, value),
                // The rate rises through zero: a minimum of the gap.
                Signal::Gap if bend > 0.0 && inside(start + t) => survey.near(value),
                Signal::Gap => {}
            });
            start += duration;
        }
        survey
    }
}

/// Extremes of a course.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excursion {
    /// Smallest and largest x₁ and x₂ in m.
    pub ranges: [(f64, f64); 2],
    /// Smallest minimum of the gap in m between the impacts; `None` where the gap has no minimum there.
    pub closest: Option<f64>,
}

impl Excursion {
    fn reach(&mut self, mass: usize, x: f64) {
        let (low, high) = &mut self.ranges[mass];
        (*low, *high) = (low.min(x), high.max(x));
    }

    fn near(&mut self, gap: f64) {
        self.closest = Some(self.closest.map_or(gap, |c| c.min(gap)));
    }
}
