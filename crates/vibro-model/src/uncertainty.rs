//! Parameters drawn from their uncertainties.

use super::excitation::Excitation;
use super::parameter::Parameter;
use super::rig::Rig;
use serde::{Deserialize, Serialize};
use vibro_math::Noise;
use vibro_record::{Error, Result};

/// Standard uncertainties of the parameters of a rig and of its excitation, each in the unit of its
/// parameter.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Uncertainty {
    /// Of the excited mass, kg.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub m1: Option<f64>,
    /// Of the passive mass, kg.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub m2: Option<f64>,
    /// Of the excited mass' spring, N/m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k1: Option<f64>,
    /// Of the passive mass' spring, N/m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k2: Option<f64>,
    /// Of the excited mass' damper, N s/m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub c1: Option<f64>,
    /// Of the passive mass' damper, N s/m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub c2: Option<f64>,
    /// Of the gap, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gap: Option<f64>,
    /// Of the restitution.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub restitution: Option<f64>,
    /// Of the force, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    /// Of the impulse, N s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub impulse: Option<f64>,
    /// Of the width of a pulse, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
}

/// Values of a parameter that are drawn before it counts as impossible: a parameter of which one value in 100
/// is possible gets none in one of 23 000 draws.
const TRIES: usize = 1000;

impl Uncertainty {
    /// The parameters whose uncertainty is stated, with it.
    pub fn all(&self) -> impl Iterator<Item = (Parameter, f64)> {
        let stated = [
            (Parameter::M1, self.m1),
            (Parameter::M2, self.m2),
            (Parameter::K1, self.k1),
            (Parameter::K2, self.k2),
            (Parameter::C1, self.c1),
            (Parameter::C2, self.c2),
            (Parameter::Gap, self.gap),
            (Parameter::Restitution, self.restitution),
            (Parameter::Force, self.force),
            (Parameter::Impulse, self.impulse),
            (Parameter::Width, self.width),
        ];
        stated.into_iter().filter_map(|(parameter, std)| Some((parameter, std?)))
    }

    /// Part of the drawn values of each parameter that are impossible, from 1000 of them.
    pub fn impossible(&self, rig: &Rig, excitation: &Excitation) -> Vec<(Parameter, f64)> {
        let part = |(parameter, std): (Parameter, f64)| {
            let (mut rig, mut excitation) = (*rig, excitation.clone());
            let estimate = parameter.place_in(&mut rig, &mut excitation).map_or(f64::NAN, |place| *place);
            let mut noise = Noise::new(0);
            let impossible =
                (0..TRIES).filter(|_| parameter.check(estimate + std * noise.normal()).is_err()).count();
            (parameter, impossible as f64 / TRIES as f64)
        };
        self.all().map(part).collect()
    }

    /// Rig and excitation with parameters drawn from normal distributions, which the draws of one `number`
    /// are the same on every machine. An impossible value, such as a restitution above 1, is drawn again.
    ///
    /// Source: JCGM 101:2008, 6.4.7 (normal distribution of a quantity known by estimate and standard
    /// uncertainty).
    ///
    /// ```
    /// use vibro_model::{Rig, Sine, Uncertainty};
    /// let (rig, sine) = (Rig::thesis(), Sine { force: 0.5, frequency: 11.0 }.into());
    /// let uncertainty = Uncertainty { gap: Some(1e-5), ..Uncertainty::default() };
    /// let (drawn, _) = uncertainty.drawn(&rig, &sine, 7)?;
    /// assert!((drawn.gap - rig.gap).abs() < 6e-5 && drawn.gap != rig.gap);
    /// assert_eq!((drawn.m1, uncertainty.drawn(&rig, &sine, 7)?.0), (rig.m1, drawn));
    /// # Ok::<(), vibro_record::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the excitation lacks a parameter, or hardly any value of a parameter is possible.
    pub fn drawn(&self, rig: &Rig, excitation: &Excitation, number: u64) -> Result<(Rig, Excitation)> {
        let mut noise = Noise::new(number);
        let (mut rig, mut excitation) = (*rig, excitation.clone());
        for (parameter, std) in self.all() {
            let (name, kind) = (parameter.name(), excitation.kind());
            let place = parameter.place_in(&mut rig, &mut excitation).ok_or_else(|| {
                let found = format!("an uncertainty of {name} under an excitation of kind {kind}");
                Error::usage(found, "a parameter that this excitation has")
            })?;
            let estimate = *place;
            let values = std::iter::repeat_with(|| estimate + std * noise.normal()).take(TRIES);
            *place = values.into_iter().find(|value| parameter.check(*value).is_ok()).ok_or_else(|| {
                Error::refused(format!("no possible value of {name} near {estimate} ± {std}"))
                    .hint(format!("a smaller uncertainty of {name}"))
            })?;
        }
        Ok((rig, excitation))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::{Impulses, Sine};

    /// Mean and standard deviation of 4000 draws have relative standard errors of 1.6 and 1.1 % of the
    /// standard deviation; the limits are 4.5 of them.
    #[test]
    fn draws_have_the_stated_mean_and_deviation() {
        let (rig, sine) = (Rig::thesis(), Sine { force: 0.5, frequency: 11.0 }.into());
        let of = Uncertainty { gap: Some(1e-4), force: Some(0.02), ..Uncertainty::default() };
        let draws: Vec<[f64; 2]> = (0..4000)
            .map(|number| {
                let (rig, excitation) = of.drawn(&rig, &sine, number).unwrap();
                [(rig.gap - 1e-3) / 1e-4, (excitation.size() - 0.5) / 0.02]
            })
            .collect();
        for i in 0..2 {
            let mean = draws.iter().map(|d| d[i]).sum::<f64>() / 4000.0;
            let variance = draws.iter().map(|d| (d[i] - mean).powi(2)).sum::<f64>() / 3999.0;
            assert!(mean.abs() < 0.072 && (variance.sqrt() - 1.0).abs() < 0.05, "{mean} {variance}");
        }
        let product = draws.iter().map(|d| d[0] * d[1]).sum::<f64>() / 4000.0;
        assert!(product.abs() < 0.072, "{product}");
    }

    #[test]
    fn impossible_values_are_drawn_again() {
        let (rig, sine) = (Rig { restitution: 0.98, ..Rig::thesis() }, Sine { force: 0.5, frequency: 11.0 });
        let of = Uncertainty { restitution: Some(0.05), ..Uncertainty::default() };
        let values = (0..300).map(|n| of.drawn(&rig, &sine.into(), n).unwrap().0.restitution);
        let values: Vec<f64> = values.collect();
        assert!(values.iter().all(|r| (0.0..=1.0).contains(r)) && values.iter().any(|r| *r > 0.99));
        let blow = Excitation::Impulse(Impulses { impulse: 1e-3, frequency: 5.0 });
        let width = Uncertainty { width: Some(1e-3), ..Uncertainty::default() };
        assert!(width.drawn(&rig, &blow, 0).unwrap_err().to_string().contains("an uncertainty of width"));
        let wild = Rig { restitution: -1e9, ..rig };
        assert!(of.drawn(&wild, &blow, 0).unwrap_err().to_string().contains("no possible value"));
    }
}
