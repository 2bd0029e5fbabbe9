//! Sentences of findings of models and their ladder, by code.

pub(super) const WORDS: &[(&str, &str)] = &[
    // Why a rung of the ladder answers for a scene, or does not.
    ("masses-meet", "Mass 1 alone moves up to {largest.4 m}, the gap is {gap.4 m}: the masses meet."),
    (
        "masses-stay-clear",
        "Mass 1 alone moves up to {largest.4 m}, the gap is {gap.4 m}: the masses need not meet.",
    ),
    (
        "clearance-not-sure",
        "The masses stay clear by {clearance.2 m}, no more than the gap's uncertainty of {std.2 m}.",
    ),
    ("other-motion", "The rig is in another motion."),
    ("rest-leads-to", "From rest it settles into {motion} (impacts/cycles)."),
    ("way-leads-to", "Coming that way it is in {motion} (impacts/cycles)."),
    ("rest-not-settled", "From rest it has not settled within {cycles:cycle}."),
    ("way-not-settled", "Coming that way it has not settled within {cycles:cycle}."),
    ("rest-unclear", "From rest it has not settled within {cycles:cycle} and may reach another motion."),
    ("settled", "Settled within {cycles:cycle}."),
    ("not-settled", "Not settled within {cycles:cycle}: the answer is a mean on the way."),
    (
        "mean-of-cycles",
        "The answer is the mean over the second half of {cycles:cycle}, standard error {error.2 %}.",
    ),
    ("orbit-missing", "No motion with one impact a cycle satisfies the equations."),
    (
        "orbit-overlaps",
        "In the solution with one impact a cycle the masses pass through each other by {depth m}.",
    ),
    (
        "orbit-not-stable",
        "The motion with one impact a cycle is {stability} (largest multiplier {radius.5}).",
    ),
    (
        "orbit-near-grazing",
        "The motion with one impact a cycle is {distance.2 m} from grazing; the gap's uncertainty is {std.2 m}.",
    ),
    (
        "orbit-not-robust",
        "The motion with one impact a cycle is not stable at all gaps within the uncertainty of {std.2 m}.",
    ),
    (
        "orbit-real",
        "The motion with one impact a cycle is admissible, stable (largest multiplier {radius.5}) and {distance.2 m} from grazing.",
    ),
    ("spring-needed", "A spring contact needs exponent 1; the stated contact is curved."),
    ("stiffness-unknown", "The contact stiffness is unknown."),
    ("stiffness-known", "The contact stiffness is {stiffness N/m}."),
    ("nothing-to-correct", "The closed form does not hold, so there is nothing to correct."),
    (
        "corrected-motion-missing",
        "With a contact of this duration there is no motion with one impact a cycle.",
    ),
    ("contact-short-enough", "The contact lasts {share %} of the cycle; the correction holds up to 2.5 %."),
    (
        "damper-sets-restitution",
        "The contact's spring and damper give a restitution of {restitution}; it replaces the rig's {stated}.",
    ),
    ("exponent-unknown", "No contact exponent is stated."),
    (
        "exponent-assumed",
        "Curved bodies (exponent {exponent}) of the same duration and rebound are compared.",
    ),
    ("impacts-missing", "There are no impacts whose law could matter."),
    ("law-known", "The contact law is stated."),
    ("buffer-missing", "The spring holds mass 1 both ways: the rig has no buffer."),
    ("spring-loose", "The spring of mass 1 only pushes; this model lets it pull as well."),
    (
        "spring-only-pushes",
        "The spring of mass 1 only pushes, beyond {gap m}. Only the motion from rest is known; no richer model checks it.",
    ),
    ("history-not-followed", "The direction of the sweep is not followed for a loose mass."),
    (
        "mean-not-known",
        "The standard error of the mean is {ratio.2} times what is allowed. Try a larger [tolerance].",
    ),
    ("answer-not-checked", "No richer model checks the answer."),
    ("answer-holds", "The answer moves by {change %} at {rung}, within what is allowed."),
    ("answer-moves", "The answer moves by {change %} at {rung}, more than is allowed."),
    // What a choice found.
    (
        "several-motions",
        "{n} coexisting motions: {motions}<, unstable {unstable}>. Set [history] to the direction from which the frequency came.",
    ),
    (
        "rare-motions",
        "{n:motion} with less than one impact a cycle {n?is/are} possible too: {motions}. A knock may lead there.",
    ),
    (
        "other-motions-searched",
        "Other motions were searched from {states} states and in closed form up to {cycles} cycles; there may be more.",
    ),
    (
        "search-cut",
        "Other motions were searched from {states} of {of} states only. There may be more; set [history] to rule them out.",
    ),
    (
        "stiffness-not-needed",
        "Contact stiffness unknown: from {low.1 N/m} to {high.1 N/m} the answer stays within the tolerance.",
    ),
    (
        "stiffness-needed",
        "No model can be chosen without {needs}: from {low.1 N/m} to {high.1 N/m} the answer moves by up to {change %}\
         <, by {still %} at the stiffest><, within the tolerance from {enough_from.1 N/m} on><; failed at {failed.1 N/m}>.",
    ),
    ("contact-unknown", "No model can be chosen without {needs}."),
    (
        "no-rung",
        "No model can be chosen: no answer is settled and confirmed by a richer model. Try a larger [tolerance].",
    ),
    (
        "law-within",
        "Curved bodies of the same contact duration and rebound move the answer by {change %}, within the tolerance.",
    ),
    (
        "law-matters",
        "Curved bodies of the same contact duration and rebound move the answer of {rung} by {change %}: measure the law of the contact.",
    ),
    (
        "gap-within",
        "The gap's uncertainty of {std.2 m} moves the answer by {smaller %} and {larger %}, within the tolerance.",
    ),
    (
        "gap-matters",
        "The gap's uncertainty of {std.2 m} moves the answer beyond the tolerance<, by {smaller %} if smaller><, by {larger %} if larger>.",
    ),
];
