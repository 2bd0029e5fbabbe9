//! The figures of this toolkit: results in, [`super::Figure`] out.

mod branches;
mod drill;
mod failures;
mod fit;
mod frf;
mod impacts;
mod ladder;
mod motion;
mod orbit;
mod overlay;
mod precision;
mod pulse;
mod regimes;
mod response;
mod spectrum;
mod sweep;
mod waterfall;

pub use branches::branches;
pub use drill::drill;
pub use failures::failures;
pub use fit::fit;
pub use frf::{frf, nyquist};
pub use impacts::{drop, impacts};
pub use ladder::{ladder, ladder_over};
pub use motion::{phase_plane, poincare, traces};
pub use orbit::orbit;
pub use overlay::overlay;
pub use precision::precision;
pub use pulse::pulse;
pub use regimes::regimes;
pub use response::response;
pub use spectrum::{lines, spectrum, transfer};
pub use sweep::sweep;
pub use waterfall::{map, waterfall};

use crate::report::{Figure, Panel};

/// Letters (a), (b), … before the titles of the plots of a figure that has several.
fn lettered(mut figure: Figure) -> Figure {
    if figure.panels.len() > 1 {
        for (letter, panel) in ('a'..='z').zip(&mut figure.panels) {
            if let Panel::Plot(plot) = panel {
                plot.title.insert_str(0, &format!("({letter}) "));
            }
        }
    }
    figure
}
