//! Sentences of findings of fits and comparisons, by code.

pub(super) const WORDS: &[(&str, &str)] = &[
    // The overlay.
    (
        "responses-not-overlaid",
        "{n:response} {n?is/are} not overlaid: no displacement, no mass or no direction. State `mass` and `quantity` of each sweep.",
    ),
    (
        "stated-force-differs",
        "Measured force: median {median.4 N}, up to {part %} from the stated {stated.4 N}. Remove `excitation.force` to predict each point for its own.",
    ),
    (
        "force-as-measured",
        "No force stated: each point is predicted for its measured force, {low N} to {high N}.",
    ),
    (
        "force-not-measured",
        "{subject}: no measured force; the median of the other sweeps, {median.4 N}, is used. State `excitation.force`.",
    ),
    (
        "model-not-chosen",
        "{needs} unknown: {model} assumed.< At {frequency.4 Hz} the amplitude depends on it by up to {part %}.> State it in the campaign.",
    ),
    (
        "points-off-prediction",
        "{subject}: {n:point} more than 5 % and 5 standard uncertainties off the prediction; the worst at {frequency.4 Hz}, {measured m} measured, {predicted m} predicted.",
    ),
    (
        "coexisting-solutions",
        "{n:point} {n?has/have} several stable motions; the prediction follows a simulated sweep from rest ({cycles} cycles per point).",
    ),
    (
        "irregular-motion",
        "{n:point} {n?has/have} an irregular predicted motion; the amplitude is the mean over {cycles} cycles. Compare it with its scatter.",
    ),
    (
        "motion-not-predicted",
        "{n:point} {n?has/have} no prediction: the simulated motion cannot be followed there.",
    ),
    // Doubts of a whole fit: no parameter has an uncertainty.
    (
        "prior-contradicted",
        "{subject}: the points contradict its prior {prior.4 @unit} ± {std @unit} by {deviations} standard uncertainties. Check prior, calibration and force.",
    ),
    (
        "bound-contradicted",
        "{subject}: the points ask for a value beyond its bound {bound.4 @unit} by {deviations} standard uncertainties. Widen the bounds or check fixed values.",
    ),
    (
        "least-squares-elsewhere",
        "{subject}: its profile falls {fall} below the answer, so the least sum of squares was not found. Set more `starts` of the fit.",
    ),
    (
        "contact-too-long",
        "{lost} of {n} amplitudes: the contact lasts too long for the closed form. Check `contact.stiffness`, or sweep at a smaller force.",
    ),
    (
        "many-outliers",
        "{outliers} of {n} amplitudes are outliers to the motions of the fitted rig. Start nearer to the rig, with more `starts`.",
    ),
    (
        "lack-of-fit",
        "Residuals {ratio} times the stated uncertainties. Check units, scaling, which mass is which, fixed values, `fit.calibration` and `fit.scatter`.",
    ),
    (
        "too-few-residuals",
        "{freedom} degrees of freedom are too few to estimate the noise from the residuals. Fit fewer parameters or measure more points.",
    ),
    (
        "motions-not-settled",
        "The motions of some points still changed in the last round. Start nearer to the rig.",
    ),
    (
        "least-squares-not-reached",
        "The search ended before the least sum of squares. Start nearer to the rig or fit fewer parameters.",
    ),
    // One parameter has no uncertainty.
    (
        "parameter-needs-impacts",
        "{subject} is not identifiable: no point shows a motion with impacts. Measure where the masses meet.",
    ),
    ("parameter-at-limit", "{subject} is not identifiable: the points do not tell it from {limit @unit}."),
    (
        "parameter-in-combination",
        "{subject} is not identifiable alone, only in combination with {others}. Fix one of them or state a prior.",
    ),
    (
        "parameter-too-uncertain",
        "{subject} is not identifiable: half or twice its value fits as well. Fix it or state a prior.",
    ),
    // What the uncertainties allow for.
    (
        "calibration-assumed",
        "Calibration uncertainty not stated: {part %} assumed. A calibration error scales gap and force. State `fit.calibration`.",
    ),
    ("rests-on-prior", "{subject} rests on its prior; the points determine it less well."),
    (
        "force-differs-from-stated",
        "The fitted force is {ratio} times the stated or measured one. Check the load cell and the scaling of the amplitudes.",
    ),
    (
        "simpler-model-predicts-as-well",
        "The {model} model predicts held-out points as well as the fitted {fitted}; `rungs` has its values.",
    ),
    (
        "amplitude-std-from-residuals",
        "No amplitude has a standard uncertainty; the residuals show {part %} of each. State `fit.scatter` where it is known.",
    ),
    (
        "amplitude-std-assumed",
        "{n:amplitude} without a standard uncertainty; the median relative one of the others is used.",
    ),
    (
        "no-degrees-of-freedom",
        "As many parameters as amplitudes and priors: the fit cannot show whether the model is right.",
    ),
    (
        "residuals-larger-than-stated",
        "Residuals {ratio} times the stated uncertainties of the points; those of the parameters are widened as much.",
    ),
    (
        "residuals-correlated",
        "Residuals are correlated along frequency: the model lacks something. Uncertainties are widened {inflation} times.",
    ),
    (
        "amplitudes-left-out",
        "{n} of {all} amplitudes are left out: {other} of other motions, {far} outliers or changing, {soft} with too long a contact.",
    ),
    (
        "few-starts-agree",
        "{agreeing} of {starts} starting points led to this answer. Check it with more `starts` of the fit.",
    ),
    ("prior-or-bounds-unused", "{subject} has a prior or bounds but is not fitted: they are not used."),
    (
        "rigid-impacts-assumed",
        "Rigid impacts assumed. State `contact.stiffness` to take the contact's compliance out of the amplitudes.",
    ),
];
