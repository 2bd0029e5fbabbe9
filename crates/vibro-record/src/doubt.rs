//! Doubts: a finding that a number may be wrong, which cannot be made without taking its uncertainty away.

use super::{Estimate, Finding, code};
use std::collections::BTreeMap;

/// Numbers with standard uncertainties, which a [`Doubt`] about them takes away.
pub trait Uncertain {
    /// Takes the standard uncertainties away.
    fn doubt(&mut self);

    /// As [`Uncertain::doubt`], of all numbers, where the whole record is in doubt: those, too, that a doubt
    /// about the values leaves.
    fn doubt_all(&mut self) {
        self.doubt();
    }

    /// As [`Uncertain::doubt`], of the numbers that grow with the values of the record, where only their unit
    /// is in doubt. A number by itself does not tell whether it does: its struct does.
    fn doubt_scale(&mut self) {}
}

/// Implements [`Uncertain`] for a struct by its fields that have uncertainties; those that grow with the
/// values of the record stand behind `scaled:`.
///
/// ```
/// use vibro_record::{Estimate, Finding, Uncertain, uncertain};
/// struct Mode { frequency: Estimate, amplitude: Option<Estimate>, lines: usize }
/// uncertain!(Mode: frequency; scaled: amplitude);
/// let frequency = Estimate::new(50.0, Some(0.1), "Hz", 8, "line fit");
/// let mut mode = Mode { frequency, amplitude: None, lines: 8 };
/// let found = Finding::doubt("two-modes").count("lines", mode.lines).of(&mut mode);
/// assert_eq!((&*found.code, mode.frequency.std), ("two-modes", None));
/// ```
#[macro_export]
macro_rules! uncertain {
    ($type:ty: $($field:ident),* $(; scaled: $($scaled:ident),+)?) => {
        impl $crate::Uncertain for $type {
            fn doubt(&mut self) {
                $($crate::Uncertain::doubt(&mut self.$field);)*
                $($($crate::Uncertain::doubt(&mut self.$scaled);)+)?
            }

            fn doubt_scale(&mut self) {
                $($crate::Uncertain::doubt_scale(&mut self.$field);)*
                $($($crate::Uncertain::doubt(&mut self.$scaled);)+)?
            }
        }
    };
}

uncertain!(Estimate: std);

/// A standard uncertainty by itself.
impl Uncertain for Option<f64> {
    fn doubt(&mut self) {
        *self = None;
    }
}

impl<T: Uncertain> Uncertain for Option<T> {
    fn doubt(&mut self) {
        self.iter_mut().for_each(T::doubt);
    }

    fn doubt_scale(&mut self) {
        self.iter_mut().for_each(T::doubt_scale);
    }
}

impl<T: Uncertain> Uncertain for [T] {
    fn doubt(&mut self) {
        self.iter_mut().for_each(T::doubt);
    }

    fn doubt_scale(&mut self) {
        self.iter_mut().for_each(T::doubt_scale);
    }
}

impl<T: Uncertain, const N: usize> Uncertain for [T; N] {
    fn doubt(&mut self) {
        self.as_mut_slice().doubt();
    }

    fn doubt_scale(&mut self) {
        self.as_mut_slice().doubt_scale();
    }
}

impl<T: Uncertain> Uncertain for Vec<T> {
    fn doubt(&mut self) {
        self.as_mut_slice().doubt();
    }

    fn doubt_scale(&mut self) {
        self.as_mut_slice().doubt_scale();
    }
}

impl<K, T: Uncertain> Uncertain for BTreeMap<K, T> {
    fn doubt(&mut self) {
        self.values_mut().for_each(T::doubt);
    }

    fn doubt_scale(&mut self) {
        self.values_mut().for_each(T::doubt_scale);
    }
}

/// Some of the numbers of an answer: `[&mut mode.frequency, &mut mode.zeta]`.
impl<T: Uncertain + ?Sized> Uncertain for &mut T {
    fn doubt(&mut self) {
        (**self).doubt();
    }

    fn doubt_scale(&mut self) {
        (**self).doubt_scale();
    }
}

/// A doubt that does not name its numbers yet. [`Doubt::of`] makes it a finding, and takes the standard
/// uncertainties of these numbers away: an answer cannot have both.
#[must_use = "a doubt is a finding once it names its numbers"]
#[derive(Debug, Clone, PartialEq)]
pub struct Doubt(pub(crate) Finding);

impl Doubt {
    /// As [`Finding::number`].
    pub fn number(self, name: &'static str, value: f64) -> Doubt {
        Doubt(self.0.number(name, value))
    }

    /// As [`Finding::count`].
    pub fn count(self, name: &'static str, n: usize) -> Doubt {
        Doubt(self.0.count(name, n))
    }

    /// As [`Finding::name`].
    pub fn name(self, name: &'static str, text: impl Into<String>) -> Doubt {
        Doubt(self.0.name(name, text))
    }

    /// As [`Finding::about`].
    pub fn about(self, subject: impl Into<String>) -> Doubt {
        Doubt(self.0.about(subject))
    }

    /// The finding. The numbers that it is about lose their standard uncertainties.
    pub fn of(self, numbers: &mut (impl Uncertain + ?Sized)) -> Finding {
        numbers.doubt();
        self.0
    }

    /// The finding of a reader or a model, whose numbers never have an uncertainty.
    pub fn without_estimate(self) -> Finding {
        self.0
    }
}

/// Takes the standard uncertainties of numbers away if a reader's finding on their record is a doubt: what is
/// computed from values or times that may be wrong may be wrong by more. A unit that may be wrong leaves
/// those that do not depend on it, such as frequencies and damping ratios.
pub fn doubt_with_record<'a>(
    findings: impl IntoIterator<Item = &'a Finding>,
    numbers: &mut (impl Uncertain + ?Sized),
) {
    for found in findings.into_iter().filter(|found| found.is_doubt()) {
        if code::UNIT_DOUBTS.contains(&&*found.code) {
            numbers.doubt_scale();
        } else {
            numbers.doubt_all();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_doubt_takes_the_uncertainty_of_what_it_names_and_of_nothing_else() {
        let estimate = |value: f64| Estimate::new(value, Some(0.1), "Hz", 3, "counted");
        let (mut one, mut listed) = (Some(estimate(1.0)), vec![estimate(2.0), estimate(3.0)]);
        let (mut other, mut std) = (estimate(4.0), Some(0.2));
        let named: &mut [&mut dyn Uncertain] = &mut [&mut one, &mut listed, &mut std];
        let found = Finding::doubt("x").number("part", 0.5).about("laser").of(named);
        assert_eq!((found.get("part"), found.subject.as_deref()), (Some(0.5), Some("laser")));
        assert_eq!(found.severity(), crate::Severity::Doubt);
        assert!(one.iter().chain(&listed).all(|e| e.std.is_none() && e.value > 0.0) && std.is_none());
        assert_eq!(other.std, Some(0.1));
        let mut named = BTreeMap::from([("other", &mut other)]);
        named.doubt();
        assert_eq!(other.std, None);
    }
}
