//! Sweeps against the model: overlay and fit.

use super::{figures, tables};
use crate::analysis::Job;
use crate::analysis::model::tables::climbed;
use crate::campaign::Campaign;
use crate::compare::{Fit, Overlay, Predicting, overlay};
use crate::error::Result;
use crate::measure::response::Response;
use crate::model::Rig;
use crate::record::Finding;

/// The finding that keys of the rig are not given and were taken from the thesis' rig.
pub(crate) fn rig_left_out(campaign: &Campaign) -> Option<Finding> {
    let keys = campaign.rig_left_out();
    let found = Finding::doubt("rig-left-out").name("table", "[rig]").name("keys", keys.join(", "));
    (!keys.is_empty()).then_some(found)
}

/// The parameters that a campaign asks for; `None` where it asks for none.
///
/// # Errors
/// As [`crate::compare::fit()`].
pub fn fit(campaign: &Campaign, rig: &Rig, responses: &[Response]) -> Result<Option<Fit>> {
    if campaign.fit.parameters.is_empty() {
        return Ok(None);
    }
    let force = campaign.excitation.and_then(|e| e.force);
    // A curved contact has no stiffness in N/m, and a damper that is stated leaves no restitution to be found.
    let straight = campaign.contact.filter(|c| c.exponent.is_none_or(|n| n == 1.0) && c.damping.is_none());
    let contact = straight.and_then(|c| c.stiffness);
    let pace = Predicting::from(campaign).pace;
    crate::compare::fit(rig, force, contact, pace, responses, &campaign.fit).map(Some)
}

fn overlaid(job: &mut Job<'_>, responses: &[Response]) -> Result<Option<(Rig, Overlay)>> {
    let campaign = job.campaign;
    let Some(rig) = campaign.rig.filter(|_| campaign.compute.overlay) else { return Ok(None) };
    if responses.iter().all(|r| r.mass.is_none() || r.direction.is_none()) {
        if !responses.is_empty() {
            job.tell("", &Finding::caution("no-mass-named"));
        }
        return Ok(None);
    }
    let force = campaign.excitation.and_then(|e| e.force);
    Ok(Some((rig, overlay(&rig, force, &campaign.into(), responses)?)))
}

/// Overlays the responses of a campaign on its rig and fits the parameters that it asks for.
///
/// # Errors
/// If the overlay is not possible. Data that allow no fit are no reason to give up the rest.
pub fn run(job: &mut Job<'_>, responses: &[Response]) -> Result<()> {
    let (rig, overlay) = overlaid(job, responses)?.unzip();
    let mut found = None;
    if let Some((rig, overlay)) = rig.as_ref().zip(overlay.as_ref()) {
        // All that follows rests on it.
        job.tell("", &rig_left_out(job.campaign).into_iter().collect::<Vec<_>>());
        job.tell("", &overlay.findings);
        let title = job.title.clone();
        job.shown.figures.push(("overlay".to_owned(), figures::overlay(&title, overlay, responses)));
        job.shown.tables.extend([tables::peaks(overlay), tables::scores(overlay), climbed(overlay)]);
        job.shown.constants = constants(rig);
        job.file("pairs.csv".to_owned(), tables::pairs(overlay).csv());
        job.file("peaks.csv".to_owned(), tables::peaks(overlay).csv());
        let fitted = fit(job.campaign, rig, responses);
        found = job.found("fit", fitted)?.flatten();
    }
    if let Some(fit) = &found {
        job.tell("", &fit.findings);
        let title = job.title.clone();
        job.shown.figures.push(("fit".to_owned(), figures::fit(&title, fit)));
        job.shown.tables.extend([tables::fitted(fit), tables::fit_rungs(fit)]);
        job.file("fit.csv".to_owned(), tables::fitted(fit).csv());
        job.file("fit_points.csv".to_owned(), tables::fit_points(fit).csv());
    }
    job.put("rig", &rig)?;
    job.put("overlay", &overlay)?;
    job.put("fit", &found)
}

fn constants(rig: &Rig) -> Vec<(String, String)> {
    let all = [
        ("m1, excited mass", format!("{} kg", rig.m1)),
        ("m2, passive mass", format!("{} kg", rig.m2)),
        ("k1", format!("{} N/m", rig.k1)),
        ("k2", format!("{} N/m", rig.k2)),
        ("c1", format!("{} N s/m", rig.c1)),
        ("c2", format!("{} N s/m", rig.c2)),
        ("gap", format!("{} m", rig.gap)),
        ("restitution", rig.restitution.to_string()),
    ];
    all.map(|(name, value)| (name.to_owned(), value)).to_vec()
}
