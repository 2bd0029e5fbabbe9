//! Where methods break.

use crate::compare::precision::{FailureMap, Outcome};
use crate::report::colour::{BLACK, Rgb, SERIES, WHITE};
use crate::report::{Figure, Grid, Kind};
use crate::units::notation::typeset;

/// Outcomes with their letters and colours; the letters tell them apart without colour.
const OUTCOMES: [(Outcome, &str, Rgb); 6] = [
    (Outcome::Right, "+", SERIES[2]),
    (Outcome::Refused, "–", SERIES[5]),
    (Outcome::Wrong, "W", SERIES[1]),
    (Outcome::Stalled, "S", SERIES[4]),
    (Outcome::Crashed, "C", BLACK),
    (Outcome::NotAsked, "·", WHITE),
];

/// A picture of each quantity (of all where borders name none), with a name for its file.
pub fn failures(map: &FailureMap) -> Vec<(String, Figure)> {
    let family = map.family.name();
    let one = |(quantity, part): (&str, FailureMap)| {
        if quantity.is_empty() {
            (family.to_owned(), grid(&part, format!("Where {family} break")))
        } else {
            (format!("{family} {quantity}"), grid(&part, format!("Where {family} break: {quantity}")))
        }
    };
    map.parts().into_iter().map(one).collect()
}

/// Methods across, scenes of each border down, what came in each cell.
fn grid(map: &FailureMap, title: String) -> Figure {
    let kinds = OUTCOMES
        .iter()
        .map(|(outcome, letter, colour)| Kind {
            name: outcome.name().to_owned(),
            letter: (*letter).to_owned(),
            colour: if *outcome == Outcome::Crashed { colour.tint(0.7) } else { colour.tint(0.45) },
        })
        .collect();
    let methods = map.methods();
    let mut grid = Grid::new(methods.iter().map(|&m| m.to_owned()).collect(), kinds);
    let mut rows: Vec<(&str, &str)> = Vec::new();
    for cell in &map.cells {
        if !rows.contains(&(cell.border.as_str(), cell.scene.as_str())) {
            rows.push((&cell.border, &cell.scene));
        }
    }
    for (border, scene) in &rows {
        let of = |method: &&str| {
            let cell =
                map.cells.iter().find(|c| c.method == **method && c.border == *border && c.scene == *scene);
            let outcome = cell.map_or(Outcome::NotAsked, |c| c.outcome);
            OUTCOMES.iter().position(|o| o.0 == outcome)
        };
        grid = grid.row(*border, typeset(scene), methods.iter().map(of).collect());
    }
    let height = grid.height();
    Figure::double(title).height(height).panel(grid).caption(
        "What each method did at the borders of what it can, decided by a check with the truth: right (+), refused with a reason (–), \
         wrong without a word on the cause (W), stalled (S), crashed (C). Not asked (·): the method has nothing to say to that scene, or its \
         truth is not known.",
    )
}
