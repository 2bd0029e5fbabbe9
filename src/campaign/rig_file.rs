//! A rig file where a campaign should stand.

use crate::error::{Error, Place};
use crate::model::Rig;
use std::path::Path;

/// Tables that a rig file has beside these keys.
const SCENE: [&str; 3] = ["excitation", "contact", "buffer"];

/// The complaint about a rig file where a campaign should stand.
pub(super) fn complaint(path: &Path, text: &str) -> Option<Error> {
    let table = toml::from_str::<toml::Table>(text).ok()?;
    let of_rig = |key: &String| Rig::KEYS.contains(&key.as_str());
    let is_rig =
        table.keys().any(of_rig) && table.keys().all(|key| of_rig(key) || SCENE.contains(&key.as_str()));
    is_rig.then(|| {
        let expected = "a campaign: the rig's keys under [rig], and what was measured, such as [[sweep]]";
        Error::input(Place::file(path), "this is a rig, not a campaign", expected).hint(format!(
            "`vibro model orbit {}` tells what the rig does; docs/campaign.md shows a campaign",
            path.display()
        ))
    })
}
