//! What a person must know of a fit.

use super::answer::{Answer, Fit};
use super::data::GUESS;
use super::uncertainty::Unidentified;
use crate::campaign::{FitEntry, Parameter};
use crate::measure::residuals::student;
use crate::record::Finding;

/// A prior and the points contradict each other by so many standard uncertainties of both: chance does so in one of 1.7 million cases.
const APART: f64 = 5.0;
/// Smallest part of a prior's variance that the points can have taken away and be told from rounding.
const TAKEN: f64 = 0.01;
/// Standard deviations by which the points must pull a parameter over a bound to contradict it: chance does so in one of 700 cases.
const PULLED: f64 = 3.0;
/// One standard uncertainty raises the sum of squares by 1: a profile that falls by as much has found another answer.
const FALL: f64 = 1.0;
/// Part of the amplitudes that may be outliers, or lost to a long contact, before the answer is in doubt.
const LOST: f64 = 0.1;
/// χ²/ν beyond which residuals say more of the model than of noise: what it lacks moves parameters by more than is left of it in the
/// residuals, which the parameters take up as far as they can.
const POOR: f64 = 1.25;
/// A force that differs by more than this part is another one: a load cell is calibrated to 1 or 2 %.
const OTHER: f64 = 0.05;

impl Answer<'_> {
    /// Why the answer as a whole may be wrong, and its uncertainties mean nothing.
    pub fn doubts(&self) -> Vec<Finding> {
        let (least, settled, problem) = (&self.settled.least, &self.settled, &self.settled.least.problem);
        let (n, freedom, guessed) = (problem.rows().0, problem.freedom(), problem.data.guessed);
        let many = |code, key, part: usize| {
            let many = part as f64 > LOST * (n + part) as f64;
            many.then(|| Finding::doubt(code).count(key, part).count("n", n + part))
        };
        let poor = least.reduced > POOR && (least.beyond_chance() || least.whiteness.rejected());
        let scaled = guessed || least.reduced > 1.0;
        let of_all = [
            many("contact-too-long", "lost", self.lost.unwrap_or(0)),
            many("many-outliers", "outliers", settled.far),
            (!guessed && poor).then(|| Finding::doubt("lack-of-fit").number("ratio", least.reduced.sqrt())),
            (scaled && student(freedom).is_none())
                .then(|| Finding::doubt("too-few-residuals").count("freedom", freedom)),
            (!settled.agreed).then(|| Finding::doubt("motions-not-settled")),
            (!least.minimum.converged).then(|| Finding::doubt("least-squares-not-reached")),
        ];
        self.contradictions().into_iter().chain(of_all.into_iter().flatten()).collect()
    }

    /// Priors and bounds that the points contradict, and a least sum of squares that lies elsewhere.
    fn contradictions(&self) -> Vec<Finding> {
        let (problem, setting) = (&self.settled.least.problem, self.settled.setting());
        let mut found = Vec::new();
        for (i, unknown) in problem.unknowns.iter().enumerate() {
            let (name, unit) = (unknown.parameter.name(), unknown.parameter.unit());
            let pulled = |code, deviations| Finding::doubt(code).about(name).number("deviations", deviations);
            if let Some([known, std]) = unknown.prior {
                // The answer lies (s² − p²)/s² of the way from the prior, of uncertainty s, to what the points alone say, p being its own:
                // over √(s² − p²), that is the distance of both over their uncertainties.
                let taken = (std * std - self.std(i).powi(2)).max(TAKEN * std * std).sqrt();
                let deviations = (setting.get(unknown.parameter) - known).abs() / taken;
                if deviations > APART {
                    let prior = pulled("prior-contradicted", deviations).number("prior", known);
                    found.push(prior.number("std", std).name("unit", unit));
                }
            }
            if let Some(limit) = self.uncertainty.limits[i].filter(|limit| limit.pull > PULLED) {
                let bound = pulled("bound-contradicted", limit.pull).number("bound", limit.value);
                found.push(bound.name("unit", unit));
            }
        }
        if let Some(profile) = self.profile.as_ref().filter(|p| p.fall() > FALL) {
            let name = profile.parameter.name();
            found.push(Finding::doubt("least-squares-elsewhere").about(name).number("fall", profile.fall()));
        }
        found
    }

    /// All findings but the doubts of the whole answer.
    pub fn cautions(&self, fit: &Fit, entry: &FitEntry) -> Vec<Finding> {
        let (least, data) = (&self.settled.least, self.settled.least.problem.data);
        let (whiteness, ratio, sound) =
            (&least.whiteness, fit.reduced_chi_squared.sqrt(), fit.doubt.is_none());
        let mut found = Vec::new();
        if entry.calibration.is_none() {
            found.push(Finding::caution("calibration-assumed").number("part", data.calibration));
        }
        for (i, parameter) in fit.parameters.iter().enumerate() {
            let name = parameter.parameter.name();
            found.extend(parameter.reason.and_then(|reason| self.unidentified(fit, i, reason)));
            if parameter.rests_on_prior {
                found.push(Finding::caution("rests-on-prior").about(name));
            }
            let ratio = parameter.estimate.value / parameter.start;
            let free = parameter.parameter == Parameter::Force && parameter.prior.is_none();
            if free && sound && (ratio - 1.0).abs() > OTHER {
                found.push(Finding::caution("force-differs-from-stated").number("ratio", ratio));
            }
        }
        let chosen = fit.rungs.iter().find(|r| r.chosen).zip(fit.rungs.last());
        let left = fit.left_out;
        let stated = !data.guessed;
        let of_all = [
            chosen.filter(|(rung, own)| rung.model != own.model).map(|(rung, own)| {
                let other =
                    Finding::caution("simpler-model-predicts-as-well").name("model", rung.model.name());
                other.name("fitted", own.model.name())
            }),
            data.guessed
                .then(|| Finding::caution("amplitude-std-from-residuals").number("part", GUESS * ratio)),
            (stated && data.without_std > 0)
                .then(|| Finding::caution("amplitude-std-assumed").count("n", data.without_std)),
            (stated && ratio.is_nan()).then(|| Finding::caution("no-degrees-of-freedom")),
            (stated && sound && least.beyond_chance())
                .then(|| Finding::caution("residuals-larger-than-stated").number("ratio", ratio)),
            (sound && whiteness.rejected())
                .then(|| Finding::caution("residuals-correlated").number("inflation", whiteness.inflation)),
            (sound && self.lost.is_none()).then(|| Finding::caution("rigid-impacts-assumed")),
            (left.clear() > 0).then(|| {
                let out = Finding::caution("amplitudes-left-out").count("n", left.clear());
                let out = out.count("all", fit.n + left.clear()).count("other", left.other_motion);
                out.count("far", left.far + left.wavering).count("soft", left.soft)
            }),
            (fit.agreeing * 2 < fit.starts).then(|| {
                let few = Finding::caution("few-starts-agree").count("agreeing", fit.agreeing);
                few.count("starts", fit.starts)
            }),
        ];
        found.extend(of_all.into_iter().flatten());
        let unused = entry.prior.keys().chain(entry.bounds.keys()).filter(|p| !entry.parameters.contains(p));
        found.extend(unused.map(|p| Finding::caution("prior-or-bounds-unused").about(p.name())));
        found
    }

    /// Why the parameter number `i` is not identifiable; `None` where the whole answer is in doubt.
    fn unidentified(&self, fit: &Fit, i: usize, reason: Unidentified) -> Option<Finding> {
        let parameter = fit.parameters[i].parameter;
        let finding = match reason {
            Unidentified::InDoubt => return None,
            Unidentified::NeedsImpacts => Finding::doubt("parameter-needs-impacts"),
            Unidentified::AtLimit => {
                let limit = self.uncertainty.limits[i]?.value;
                Finding::doubt("parameter-at-limit").number("limit", limit).name("unit", parameter.unit())
            }
            Unidentified::Combination => {
                let tied = (0..fit.parameters.len()).filter(|j| *j != i && self.uncertainty.is_tied(i, *j));
                let others: Vec<&str> = tied.map(|j| fit.parameters[j].parameter.name()).collect();
                Finding::doubt("parameter-in-combination").name("others", others.join(", "))
            }
            Unidentified::TooUncertain => Finding::doubt("parameter-too-uncertain"),
        };
        Some(finding.about(parameter.name()))
    }
}
