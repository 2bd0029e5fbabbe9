//! Models of the motion, on scenes with a known truth.

mod borders;
mod chaos;
mod chatter;
mod check;
mod corrected;
mod entry;
mod failures;
mod grazing;
mod in_order;
mod ours;
mod rivals;
mod scene_b;
mod slow_sweep;
mod soft;
mod task;
mod truth;

use super::Scene;
use vibro_record::Result;

/// Every scene of the models, each method measured; `quick` takes fewer settings and repeats.
///
/// # Errors
/// If a scene cannot be built.
pub fn scenes(quick: bool, progress: &mut dyn FnMut(&str)) -> Result<Vec<Scene>> {
    let mut found = Vec::new();
    for seconds in [2.0, 100.0] {
        progress(&format!("scene B over {seconds} s"));
        found.push(scene_b::scene(seconds, quick)?);
    }
    for depth in if quick { &[1e-6, 1e-12][..] } else { &[1e-3, 1e-6, 1e-9, 1e-12] } {
        progress(&format!("grazing by {depth:.0e} m"));
        found.push(grazing::scene(*depth, quick)?);
    }
    progress("scene C");
    found.push(chatter::scene(quick));
    for stiffness in [1e8, 1e6, 1e4] {
        progress(&format!("soft contact, {stiffness:.0e} N/m"));
        found.push(soft::scene(stiffness, quick)?);
    }
    progress("chaotic window");
    found.push(chaos::scene(quick)?);
    progress("slow sweep");
    found.push(slow_sweep::scene(quick)?);
    Ok(found)
}

pub use failures::failures;
