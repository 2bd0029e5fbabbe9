//! Measured sweeps against the model: overlay and fit, in `vibro compare` and in a campaign.

use super::draws::PairBands;
use super::{figures, findings_of, responses, tables};
use crate::analysis::answer::Answer;
use crate::analysis::compared_rig::{ComparedRig, Sliders};
use crate::analysis::job::Job;
use crate::analysis::model::{choose::climbed, rig_left_out};
use crate::analysis::progress::Progress;
use crate::campaign::Campaign;
use crate::compare::{Fit, Overlay, Predicting, overlay};
use crate::error::{Error, Place, Result};
use crate::measure::response::Response;
use crate::model::Rig;
use crate::record::Finding;
use crate::report::Table;
use serde_json::json;

/// Fits the parameters that `[fit]` of a campaign lists; `None` where it lists none.
///
/// # Errors
/// As [`crate::compare::fit()`].
pub fn fit(campaign: &Campaign, rig: &Rig, responses: &[Response]) -> Result<Option<Fit>> {
    if campaign.fit.parameters.is_empty() {
        return Ok(None);
    }
    let force = campaign.excitation.and_then(|e| e.force);
    // Only a linear contact has a stiffness in N/m. A stated contact damper fixes the restitution, which then
    // cannot be fitted.
    let straight = campaign.contact.filter(|c| c.exponent.is_none_or(|n| n == 1.0) && c.damping.is_none());
    let contact = straight.and_then(|c| c.stiffness);
    crate::compare::fit(rig, force, contact, predicting(campaign).pace(), responses, &campaign.fit).map(Some)
}

/// The sweeps of a campaign over the prediction for a rig.
pub(super) fn overlaid(campaign: &Campaign, rig: &Rig, responses: &[Response]) -> Result<Overlay> {
    overlay(rig, campaign.excitation.and_then(|e| e.force), &predicting(campaign), responses)
}

/// Model and contact with which a campaign predicts.
pub(super) fn predicting(campaign: &Campaign) -> Predicting {
    Predicting { model: campaign.model, contact: campaign.contact }
}

/// Overlay of a campaign's sweeps on the prediction for its rig, with the fit that `[fit]` requests.
///
/// # Errors
/// If the campaign has no rig, a sweep cannot be read, or the data allow no overlay or no fit.
pub fn compared(campaign: &Campaign, progress: &dyn Progress) -> Result<Answer> {
    let rig = stated_rig(campaign)?;
    let responses = responses(campaign, progress)?;
    let overlay = overlaid(campaign, &rig, &responses)?;
    answered(campaign, &rig, (&responses, &overlay), None)
}

/// The rig of a campaign.
///
/// # Errors
/// If it has none.
pub(super) fn stated_rig(campaign: &Campaign) -> Result<Rig> {
    campaign.rig.ok_or_else(|| {
        Error::input(Place::file(campaign.path()), "the campaign has no [rig]", "the rig to compare with")
            .hint("add a [rig] table; keys left out take the values of the thesis' rig")
    })
}

/// The answer of an overlay, with the fit that `[fit]` requests, and with bands of drawn rigs.
pub(super) fn answered(
    campaign: &Campaign,
    rig: &Rig,
    (responses, overlay): (&[Response], &Overlay),
    bands: Option<&PairBands>,
) -> Result<Answer> {
    let fit = fit(campaign, rig, responses)?;
    let mut answer = shown(campaign, responses, overlay, (fit.as_ref(), bands));
    answer.result = Answer::of(overlay)?.result;
    answer.result.insert("fit".to_owned(), json!(fit));
    if let Some(bands) = bands {
        bands.add_to(&mut answer)?;
    }
    answer.findings.extend(findings_of(responses));
    Ok(answer)
}

/// Findings, figures and tables of overlay and fit.
fn shown(
    campaign: &Campaign,
    responses: &[Response],
    overlay: &Overlay,
    (fit, bands): (Option<&Fit>, Option<&PairBands>),
) -> Answer {
    let mut answer = Answer::default();
    // First, because every prediction depends on the assumed keys of the rig.
    answer.add("", rig_left_out("[rig]", &campaign.rig_left_out()));
    answer.add("", &overlay.findings);
    answer.figure("overlay", figures::overlay(&campaign.name, overlay, responses, bands));
    answer.csv("pairs", &tables::pairs(overlay));
    answer.table("peaks", tables::peaks(overlay));
    answer.tables.extend([tables::scores(overlay), climbed(overlay)]);
    if let Some(fit) = fit {
        answer.add("", &fit.findings);
        answer.figure("fit", figures::fit(&campaign.name, fit));
        answer.table("fit", tables::fitted(fit));
        answer.tables.push(tables::fit_rungs(fit));
        answer.csv("fit_points", &tables::fit_points(fit));
    }
    answer
}

/// Overlays the responses of a campaign on its rig and fits the parameters that it asks for.
///
/// # Errors
/// If a result cannot be written as JSON. Data that allow no overlay or no fit give a finding, and the other
/// analyses continue.
pub fn run(job: &mut Job<'_>, responses: &[Response]) -> Result<Option<Table>> {
    let campaign = job.campaign;
    let mut rig = campaign.rig.filter(|_| campaign.compute.overlay && !responses.is_empty());
    if rig.is_some() && responses.iter().all(|r| r.mass.is_none() || r.direction.is_none()) {
        job.found.add("", [Finding::caution("no-mass-named")]);
        rig = None;
    }
    if rig.is_none() && !campaign.fit.parameters.is_empty() {
        job.found.add("", [Finding::caution("fit-without-rig")]);
    }
    let (mut overlay, mut fitted) = (None, None);
    if let Some(rig) = &rig {
        overlay = job.found("overlay", overlaid(campaign, rig, responses));
        fitted = job.found("fit", fit(campaign, rig, responses)).flatten();
        if let Some(overlay) = &overlay {
            job.show("", "", shown(campaign, responses, overlay, (fitted.as_ref(), None)));
        }
        let stiffness = campaign.contact.and_then(|contact| contact.stiffness);
        let sliders = overlay.as_ref().and_then(|overlay| Sliders::of(rig, overlay, stiffness));
        job.found.compared = overlay.is_some().then_some(ComparedRig { rig: *rig, sliders });
    }
    job.put("rig", &rig)?;
    job.put("overlay", &overlay)?;
    job.put("fit", &fitted)?;
    Ok(overlay.as_ref().map(tables::agreement))
}
