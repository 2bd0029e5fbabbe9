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
        let (least, settled) = (&self.settled.least, &self.settled);
        let problem = &least.problem;
        let mut found = self.contradictions();
        let n = problem.rows().0;
        let many = |part: usize| part as f64 > LOST * (n + part) as f64;
        if let Some(lost) = self.lost.filter(|lost| many(*lost)) {
            found.push(Finding::doubt("contact-too-long").count("lost", lost).count("n", n + lost));
        }
        if many(settled.far) {
            found.push(
                Finding::doubt("many-outliers").count("outliers", settled.far).count("n", n + settled.far),
            );
        }
        let correlated = least.whiteness.rejected();
        let guessed = problem.data.guessed;
        if !guessed && least.reduced > POOR && (least.beyond_chance() || correlated) {
            found.push(Finding::doubt("lack-of-fit").number("ratio", least.reduced.sqrt()));
        }
        if (guessed || least.reduced > 1.0) && student(problem.freedom()).is_none() {
            found.push(Finding::doubt("too-few-residuals").count("freedom", problem.freedom()));
        }
        if !settled.agreed {
            found.push(Finding::doubt("motions-not-settled"));
        }
        if !least.minimum.converged {
            found.push(Finding::doubt("least-squares-not-reached"));
        }
        found
    }

    /// Priors and bounds that the points contradict, and a least sum of squares that lies elsewhere.
    fn contradictions(&self) -> Vec<Finding> {
        let (problem, setting) = (&self.settled.least.problem, self.settled.setting());
        let mut found = Vec::new();
        for (i, unknown) in problem.unknowns.iter().enumerate() {
            let (name, unit) = (unknown.parameter.name(), unknown.parameter.unit());
            if let Some([known, std]) = unknown.prior {
                // The answer lies (s² − p²)/s² of the way from the prior, of uncertainty s, to what the points alone say, p being its own:
                // over √(s² − p²), that is the distance of both over their uncertainties.
                let taken = (std * std - self.std(i).powi(2)).max(TAKEN * std * std).sqrt();
                let deviations = (setting.get(unknown.parameter) - known).abs() / taken;
                if deviations > APART {
                    let pull =
                        Finding::doubt("prior-contradicted").about(name).number("deviations", deviations);
                    found.push(pull.number("prior", known).number("std", std).name("unit", unit));
                }
            }
            if let Some(limit) = self.uncertainty.limits[i].filter(|limit| limit.pull > PULLED) {
                let pull = Finding::doubt("bound-contradicted").about(name).number("deviations", limit.pull);
                found.push(pull.number("bound", limit.value).name("unit", unit));
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
        let sound = fit.doubt.is_none();
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
        if let (Some(rung), Some(own)) = (fit.rungs.iter().find(|r| r.chosen), fit.rungs.last())
            && rung.model != own.model
        {
            let other = Finding::caution("simpler-model-predicts-as-well").name("model", rung.model.name());
            found.push(other.name("fitted", own.model.name()));
        }
        if data.guessed {
            let part = GUESS * fit.reduced_chi_squared.sqrt();
            found.push(Finding::caution("amplitude-std-from-residuals").number("part", part));
        } else {
            if data.without_std > 0 {
                found.push(Finding::caution("amplitude-std-assumed").count("n", data.without_std));
            }
            if fit.reduced_chi_squared.is_nan() {
                found.push(Finding::caution("no-degrees-of-freedom"));
            } else if sound && least.beyond_chance() {
                let ratio = fit.reduced_chi_squared.sqrt();
                found.push(Finding::caution("residuals-larger-than-stated").number("ratio", ratio));
            }
        }
        if sound && least.whiteness.rejected() {
            let inflation = least.whiteness.inflation;
            found.push(Finding::caution("residuals-correlated").number("inflation", inflation));
        }
        if sound && self.lost.is_none() {
            found.push(Finding::caution("rigid-impacts-assumed"));
        }
        let left = fit.left_out;
        if left.clear() > 0 {
            let out = Finding::caution("amplitudes-left-out").count("n", left.clear());
            let out = out.count("all", fit.n + left.clear()).count("other", left.other_motion);
            found.push(out.count("far", left.far + left.wavering).count("soft", left.soft));
        }
        if fit.agreeing * 2 < fit.starts {
            let few = Finding::caution("few-starts-agree").count("agreeing", fit.agreeing);
            found.push(few.count("starts", fit.starts));
        }
        let unused = |p: &&Parameter| !entry.parameters.contains(p);
        for parameter in entry.prior.keys().chain(entry.bounds.keys()).filter(unused) {
            found.push(Finding::caution("prior-or-bounds-unused").about(parameter.name()));
        }
        found
    }

    /// Why the parameter number `i` is not identifiable; `None` where the whole answer is in doubt.
    fn unidentified(&self, fit: &Fit, i: usize, reason: Unidentified) -> Option<Finding> {
        let finding = match reason {
            Unidentified::InDoubt => return None,
            Unidentified::NeedsImpacts => Finding::doubt("parameter-needs-impacts"),
            Unidentified::AtLimit => {
                let limit = self.uncertainty.limits[i]?.value;
                Finding::doubt("parameter-at-limit")
                    .number("limit", limit)
                    .name("unit", fit.parameters[i].parameter.unit())
            }
            Unidentified::Combination => {
                let tied = |j: &usize| *j != i && self.uncertainty.is_tied(i, *j);
                let others = (0..fit.parameters.len()).filter(tied);
                let others: Vec<&str> = others.map(|j| fit.parameters[j].parameter.name()).collect();
                Finding::doubt("parameter-in-combination").name("others", others.join(", "))
            }
            Unidentified::TooUncertain => Finding::doubt("parameter-too-uncertain"),
        };
        Some(finding.about(fit.parameters[i].parameter.name()))
    }
}
