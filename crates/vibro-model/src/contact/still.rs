//! The path of a piece of motion that lasts no time.

use crate::flow::State;
use crate::motion::Path;

/// A state that lasts no time.
pub(super) struct Still(pub State);

impl Path for Still {
    fn state(&self, _: f64) -> State {
        self.0
    }
}
