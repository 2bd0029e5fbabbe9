//! What a record of a pulse cannot tell, as sentences.

use super::fit::{Fitted, Trust};
use super::{Instrument, LowPass, PulseFit, PulseOptions, PulseResult};
use crate::residuals::{Whiteness, student};

/// Names of the parameters of the contact of spring and damper, in the order of the fit.
const NAMES: [&str; 5] = ["onset", "baseline", "initial velocity", "ξ", "frequency"];

/// Sentences on a fitted pulse, the first of `fits` being that of spring and damper.
pub(super) fn doubts(
    main: &Fitted,
    trust: Trust,
    whiteness: &Whiteness,
    fits: &[PulseFit],
    result: &PulseResult,
    options: &PulseOptions,
) -> Vec<String> {
    let mut said = Vec::new();
    let xi = &result.xi;
    // Without an uncertainty, as behind an instrument that is not known, ξ may be off by 0.1 and more.
    let spread = xi.std.map_or(0.1, |s| 2.0 * s);
    if xi.value + spread >= 0.5 {
        said.push(
            "ξ is, or may be, 1/2 or more: the force is then largest at the onset, the pulse has no peak inside, and ξ hangs on the shape of the onset."
                .to_owned(),
        );
    }
    if xi.value - spread < 0.0 {
        said.push("ξ is not above 0 by more than it may be off: no damping is seen.".to_owned());
    }
    match &options.instrument {
        Instrument::Flat => {}
        Instrument::Unknown => said.push(
            "It is not known whether the instrument has a low-pass. The models are fitted as if it had none; if it has one, ξ may be off by 0.1 and more though the fit looks right, so there is no uncertainty. Give --low-pass HZ and --order N, or --low-pass none."
                .to_owned(),
        ),
        Instrument::LowPass(filter) => said.extend(near_corner(result.duration.value, filter)),
    }
    for (i, one) in NAMES.iter().enumerate() {
        for (j, other) in NAMES.iter().enumerate().skip(i + 1) {
            let r = main.fit.correlation(i, j);
            if r.abs() > 0.99 {
                said.push(format!("The record hardly tells {one} from {other} (correlation {r:.4})."));
            }
        }
    }
    let free = main.fit.degrees_of_freedom();
    if student(free).is_none() {
        said.push(format!(
            "The fit leaves {free} degrees of freedom, too few for a standard uncertainty: it needs three. Sample faster."
        ));
    }
    if trust == Trust::Refused {
        let low_pass = match options.instrument.low_pass() {
            None => "the low-pass of the instrument is needed (--low-pass HZ, --order N)",
            Some(_) => "the low-pass is another than stated, or the contact another than modelled",
        };
        said.push(format!(
            "The pulse does not begin as the contact of spring and damper must, and its residuals are not white noise: {low_pass}. ξ and all that follows would be far off, and are refused."
        ));
    } else if whiteness.rejected() {
        said.push(format!(
            "The residuals of the contact of spring and damper are not white noise: a wrong model, a wrong low-pass or coloured noise. Its uncertainties are enlarged by a factor of {:.2}, which covers noise but not a wrong model.",
            whiteness.inflation
        ));
    }
    let best = fits.iter().min_by(|a, b| a.aicc.total_cmp(&b.aicc));
    if let (Some(best), Some(main)) = (best, fits.first()) {
        let ahead = main.aicc - best.aicc;
        // A difference of 10 leaves no support for the worse model (Burnham & Anderson 2002, 2.6).
        if ahead > 10.0 {
            let below = match trust {
                Trust::Refused => "its parameters stand in `fits`",
                Trust::Widened(_) => {
                    "ξ, frequency and restitution below are those of a model that does not hold"
                }
            };
            said.push(format!(
                "The record prefers the model {} to the contact of spring and damper (AICc smaller by {ahead:.0}): {below}.",
                best.model
            ));
        } else if fits.iter().any(|f| f.model != main.model && f.aicc < main.aicc + 2.0) {
            said.push("The record does not tell the models apart (AICc within 2).".to_owned());
        }
    }
    said
}

/// The flag of a pulse about as short as the filter's own.
fn near_corner(duration: f64, filter: &LowPass) -> Option<String> {
    (duration * filter.corner() < 2.0).then(|| {
        format!(
            "The pulse lasts {:.4} µs, and 1/duration = {:.4} kHz is within a factor of two of the low-pass at {:.4} kHz or beyond it: the shape is mostly the filter's, and corner and order must be right.",
            duration * 1e6,
            1e-3 / duration,
            filter.corner() * 1e-3
        )
    })
}
