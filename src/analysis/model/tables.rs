//! Tables of the model.

mod ladder;
mod orbit;
mod sweep;

pub use ladder::{chosen, climbed, motions, rungs, sensitivity, stretches, summaries, where_chosen, why};
pub use orbit::{branches, changes, course, no_impact, orbits, soft, verdicts};
pub use sweep::{Followed, FollowedMark, FollowedPoint, branch_points, followed, sweep, sweep_named};
