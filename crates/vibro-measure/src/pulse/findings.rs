//! What a fitted pulse leaves open.

use super::fit::Fitted;
use super::{Instrument, PulseFit, PulseOptions, PulseResult};
use crate::residuals::Whiteness;
use vibro_record::Finding;

/// A difference of Akaike's criterion that leaves no support for the worse model (Burnham & Anderson, Model Selection and Multimodel
/// Inference, 2002, section 2.6).
const NO_SUPPORT: f64 = 10.0;

/// Half of the interval in which ξ lies where it has no uncertainty, as behind an unknown instrument.
const UNKNOWN: f64 = 0.1;

/// Findings on a fitted pulse, the first of `fits` being that of spring and damper. `widened` is `None` where its parameters are refused.
pub(super) fn findings(
    main: &Fitted,
    widened: Option<f64>,
    whiteness: &Whiteness,
    fits: &[PulseFit],
    result: &PulseResult,
    options: &PulseOptions,
) -> Vec<Finding> {
    let mut found = Vec::new();
    let xi = &result.xi;
    let spread = xi.std.map_or(UNKNOWN, |s| 2.0 * s);
    if xi.value + spread >= 0.5 {
        found.push(Finding::caution("pulse-no-inner-peak").number("xi", xi.value));
    }
    if xi.value - spread < 0.0 {
        found.push(Finding::caution("pulse-no-damping").number("xi", xi.value));
    }
    match &options.instrument {
        Instrument::Flat => {}
        Instrument::Unknown => found.push(Finding::doubt("pulse-instrument-unknown")),
        Instrument::LowPass(filter) => {
            let duration = result.duration.value;
            if duration * filter.corner() < 2.0 {
                found.push(
                    Finding::caution("pulse-near-corner")
                        .number("duration", duration)
                        .number("corner", filter.corner()),
                );
            }
        }
    }
    if widened.is_none() {
        found.push(match options.instrument.low_pass() {
            None => Finding::doubt("pulse-low-pass-missing"),
            Some(_) => Finding::doubt("pulse-onset-unlike"),
        });
    } else if whiteness.rejected() {
        found.push(Finding::caution("pulse-residuals-coloured").number("factor", whiteness.inflation));
    }
    let Some(best) = fits.iter().min_by(|a, b| a.aicc.total_cmp(&b.aicc)) else { return found };
    let own = fits.iter().find(|f| f.model == main.model).map_or(best.aicc, |f| f.aicc);
    if own - best.aicc > NO_SUPPORT {
        found.push(
            Finding::caution("pulse-other-model")
                .name("model", best.model.name())
                .number("ahead", own - best.aicc),
        );
    }
    found
}
