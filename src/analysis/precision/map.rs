//! Failure maps: the limits of methods.

use crate::precision::{FailureMap, Family, Outcome};
use crate::report::colour::{BLACK, Rgb, SERIES, WHITE};
use crate::report::{Class, Figure, Grid};
use crate::units::notation::typeset;

/// Outcomes with their letters, colours and the share of white in these; letters tell them apart without
/// colour.
pub const OUTCOMES: [(Outcome, &str, Rgb, f64); 6] = [
    (Outcome::Right, "+", SERIES[2], 0.45),
    (Outcome::Refused, "–", SERIES[5], 0.45),
    (Outcome::Wrong, "W", SERIES[1], 0.45),
    (Outcome::Stalled, "S", SERIES[4], 0.45),
    (Outcome::Crashed, "C", BLACK, 0.7),
    (Outcome::NotAsked, "·", WHITE, 0.0),
];

/// One map for each quantity of a family, or a single one where borders name none, with names for the
/// files.
pub fn maps(family: Family, map: &FailureMap) -> Vec<(String, Figure)> {
    let name = family.name();
    let named_map = |(quantity, part): (&str, FailureMap)| match quantity {
        "" => (name.to_owned(), grid(&part, format!("Where {name} break"))),
        _ => (format!("{name} {quantity}"), grid(&part, format!("Where {name} break: {quantity}"))),
    };
    map.parts().into_iter().map(named_map).collect()
}

/// Methods across, scenes of each border down, with the outcome in each cell.
fn grid(map: &FailureMap, title: String) -> Figure {
    let kind = |(outcome, letter, colour, white): (Outcome, &str, Rgb, f64)| Class {
        name: outcome.name().to_owned(),
        letter: letter.to_owned(),
        colour: colour.tint(white),
    };
    let methods = map.methods();
    let mut grid = Grid::new(methods.iter().map(|&m| m.to_owned()).collect(), OUTCOMES.map(kind).to_vec());
    // The cells of a row are adjacent.
    for row in map.cells.chunk_by(|a, b| (&a.border, &a.scene) == (&b.border, &b.scene)) {
        let outcome_index = |method: &&str| {
            let cell = row.iter().find(|c| c.method == **method);
            let outcome = cell.map_or(Outcome::NotAsked, |c| c.outcome);
            OUTCOMES.iter().position(|o| o.0 == outcome)
        };
        grid = grid.row(&row[0].border, &typeset(&row[0].scene), methods.iter().map(outcome_index).collect());
    }
    let height = grid.height();
    Figure::double(title).height(height).panel(grid).caption(
        "What each method did at the borders of what it can, decided by a check with the truth: right (+), refused with a reason (–), \
         wrong without a word on the cause (W), stalled (S), crashed (C). Not asked (·): the method has nothing to say to that scene, or its \
         truth is not known. Common methods stand beside those of this library; they are coded in this project.",
    )
}
