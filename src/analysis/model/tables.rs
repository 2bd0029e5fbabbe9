//! Tables of the model.

mod ladder;
mod orbit;
mod sweep;

pub(crate) use ladder::{
    chosen, climbed, motions, rungs, sensitivity, stretches, summaries, where_chosen, why,
};
pub(crate) use orbit::{branches, changes, course, no_impact, orbits, soft, verdicts};
pub(crate) use sweep::{Followed, FollowedPoint, branch_points, followed, sweep, sweep_named};
