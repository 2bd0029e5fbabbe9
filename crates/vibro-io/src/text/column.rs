//! One column of a text, and checks of its values: counters, clocks, channel numbers, repeated values.

use super::names::{Name, label};
use crate::assemble::kind_of;
use crate::held::{Held, rises};
use crate::level::above;
use num_complex::Complex64;
use std::borrow::Cow;
use vibro_record::units::{Quantity, Unit};
use vibro_record::{AxisKind, Clock, Values};

/// A column of a text.
pub struct Column {
    /// Place in the row, counted from 1.
    pub at: usize,
    pub name: Name,
    pub values: Held,
    /// For a channel of a lower rate: first row with a value, and rows from one value to the next.
    pub sparse: Option<(usize, usize)>,
}

impl Column {
    /// The values, or the real parts of complex values; empty if values were not kept.
    pub fn reals(&self) -> Cow<'_, [f64]> {
        match &self.values {
            Held::Values(Values::Complex(values)) => values.iter().map(|v| v.re).collect(),
            held => held.reals().into(),
        }
    }

    pub fn rises(&self) -> bool {
        !matches!(self.values, Held::Summary(_)) && rises(&self.reals())
    }

    /// Whether the values rise in even steps, as a clock or counter does, and have no unit of another
    /// quantity.
    pub fn rises_evenly(&self) -> bool {
        let unit = self.name.unit.as_deref();
        let other = unit.is_some_and(|unit| Unit::parse(unit).is_none_or(|unit| kind_of(&unit).is_none()));
        let values = Some(self.values.reals()).filter(|values| !other && values.len() > 10);
        // Stops at the first step of another size, which most measured records have early.
        let even = |(low, high): (f64, f64), step: f64| {
            let (low, high) = (low.min(step), high.max(step));
            (low > 0.0 && high <= 2.0 * low).then_some((low, high))
        };
        let steps =
            |values: &[f64]| values.windows(2).map(|w| w[1] - w[0]).try_fold((f64::INFINITY, 0.0), even);
        values.is_some_and(|values| {
            steps(values)
                .is_some_and(|(low, high)| high - low <= 1e-3 * high || Clock::of(values, 0.0).is_some())
        })
    }

    /// Whether the column holds the instants of `axis` with another start or unit: `elapsed (s)` beside
    /// milliseconds since 1970.
    pub fn is_clock_of(&self, axis: &Column) -> bool {
        let time = axis.name.axis(true) == Some(AxisKind::Time);
        let (Some(own_unit), true) = (self.name.seconds(), time) else { return false };
        let (own, other) = (self.reals(), axis.reals());
        let (Some(first), Some(last)) = (own.first(), own.last()) else { return false };
        let units = axis.name.seconds().map_or(vec![1.0, 1e-3, 1e-6, 1e-9], |unit| vec![unit]);
        // Largest difference: 1 % of a step. It allows for the rounding of nanoseconds since 1970, which as
        // doubles are multiples of 256.
        let most = 1e-2 * (last - first) / own.len() as f64;
        // The same instants stay this close throughout; another clock drifts away.
        let is_same = |unit: f64| {
            let off = |(v, t): (&f64, &f64)| ((v - first) - unit / own_unit * (t - other[0])).abs();
            own.iter().zip(other.iter()).all(|pair| off(pair) <= most)
        };
        own.len() == other.len() && units.into_iter().any(is_same)
    }

    pub fn counts(&self) -> bool {
        let values = self.reals();
        let first = values.first().copied().unwrap_or(0.0);
        self.name.may_count()
            && !matches!(self.values, Held::Summary(_))
            && values.iter().enumerate().all(|(i, v)| *v == first + i as f64)
    }

    /// Two neighbouring values of a sample counter between which samples are missing. A counter holds
    /// rising whole numbers, in at least 90 % of the rows rising by one.
    pub fn leaves_out(&self) -> Option<[f64; 2]> {
        let values = self.reals();
        let steps = || values.windows(2).map(|pair| pair[1] - pair[0]);
        let ones = steps().filter(|step| *step == 1.0).count();
        let rises = steps().all(|step| step >= 1.0 && step.fract() == 0.0);
        let counts = self.name.may_count() && !matches!(self.values, Held::Summary(_)) && rises;
        let first = steps().position(|step| step > 1.0).filter(|_| counts)?;
        (10 * ones >= 9 * (values.len() - 1)).then(|| [values[first], values[first + 1]])
    }

    /// First and another value of a column that gives the channel or sensor number of each row: whole
    /// numbers in a fixed cycle, or a few repeated ones in a column whose name says so.
    pub fn numbers_channels(&self) -> Option<[f64; 2]> {
        let values = self.values.first_values();
        let first = *values.first().filter(|_| self.sparse.is_none() && self.name.unit.is_none())?;
        let turn = values.iter().take(TURNS + 1).skip(1).position(|v| *v == first)? + 1;
        let mut known: Vec<f64> = Vec::new();
        for v in values {
            if v.fract() != 0.0 || known.len() > TURNS {
                return None;
            }
            if !known.contains(v) {
                known.push(*v);
            }
        }
        let in_turns = || {
            known.len() == turn
                && values.len() >= 4 * turn
                && values.iter().zip(values.iter().skip(turn)).all(|(a, b)| a == b)
        };
        let named = || NUMBERED.contains(&self.name.last_word().as_str()) && 4 * known.len() <= values.len();
        (known.len() > 1 && (in_turns() || named())).then(|| [first, known[1]])
    }

    /// Whether the unit is missing, unknown or that of a signal (voltage, ratio): a scale factor may still
    /// have to be applied to such values.
    pub fn may_be_signal(&self) -> bool {
        let unit = self.name.unit.as_deref().and_then(Unit::parse);
        unit.is_none_or(|unit| {
            matches!(unit.quantity(), Quantity::Voltage | Quantity::Other | Quantity::Ratio)
        })
    }

    /// Makes the magnitude of a frequency response function, or its level in dB over a unit such as 1 m/N,
    /// complex if the next column, `behind`, is its phase. Returns whether it is.
    pub fn take_phase(&mut self, behind: &Column) -> bool {
        let reference = self.name.unit.as_deref().map(Unit::parse_or_opaque).and_then(|u| u.reference());
        let unit = reference.clone().or_else(|| self.name.unit.as_deref().and_then(Unit::parse));
        let is_function = unit.is_some_and(|unit| unit.quantity().is_function());
        let (sizes, phases) = (self.reals(), behind.reals());
        let plain = !self.values.is_complex() && sizes.len() == phases.len();
        let usable = is_function && plain && (reference.is_some() || sizes.iter().all(|size| *size >= 0.0));
        let Some(factor) = behind.name.phase().filter(|_| usable) else { return false };
        let magnitude = |size: f64| reference.as_ref().map_or(size, |reference| above(reference, size));
        let pairs = sizes.iter().zip(phases.iter());
        let values = pairs.map(|(size, phase)| Complex64::from_polar(magnitude(*size), factor * phase));
        self.values = Values::Complex(values.collect()).into();
        if let Some(reference) = reference {
            self.name.unit = Some(reference.symbol().to_owned());
        }
        true
    }

    pub fn label(&self) -> String {
        label(&self.name.name, self.at)
    }
}

/// Most channels or sensors in a table with a column of channel numbers (`TURNS`), and last words of that
/// column's name (`NUMBERED`).
const TURNS: usize = 64;
const NUMBERED: [&str; 9] = ["channel", "chan", "ch", "sensor", "node", "device", "probe", "id", "kanal"];
