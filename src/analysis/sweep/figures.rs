//! Figures of sweeps, and of sweeps against the model.

mod fit;
mod force;
mod overlay;
mod receptance;
mod response;
mod waterfall;

pub use fit::fit;
pub use overlay::overlay;
pub use receptance::receptance;
pub use response::response;
pub use waterfall::{map, waterfall};

use crate::analysis::answer::Answer;
use crate::measure::response::Response;
use force::force;

/// Adds the figures of responses over frequency: amplitude, and receptance and force where they are known.
pub fn responses(answer: &mut Answer, title: &str, responses: &[Response]) {
    answer.figure("response", response(title, responses));
    answer.figure("receptance", receptance(title, responses));
    answer.figure("force", force(title, responses));
}
