//! One result in a table.

use crate::measure::Estimate;
use serde::{Deserialize, Serialize};

/// One result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number without uncertainty; NaN counts as missing.
    Number(f64),
    /// A value with its standard uncertainty, where known.
    Estimate {
        /// Value.
        value: f64,
        /// Standard uncertainty in the unit of the value.
        std: Option<f64>,
    },
    /// No value.
    Missing,
}

macro_rules! cells {
    ($($of:ty, $from:ident => $cell:expr;)*) => {
        $(impl From<$of> for Cell {
            fn from($from: $of) -> Cell {
                $cell
            }
        })*
    };
}

cells! {
    &str, text => Cell::Text(text.to_owned());
    String, text => Cell::Text(text);
    f64, value => Cell::Number(value);
    usize, count => Cell::Number(count as f64);
    &Estimate, estimate => Cell::Estimate { value: estimate.value, std: estimate.std };
    bool, yes => Cell::from(if yes { "yes" } else { "no" });
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Cell {
        value.map_or(Cell::Missing, Into::into)
    }
}

impl Cell {
    /// The number, if there is one and it is not NaN.
    pub(super) fn value(&self) -> Option<f64> {
        match self {
            Cell::Number(value) | Cell::Estimate { value, .. } if !value.is_nan() => Some(*value),
            _ => None,
        }
    }

    /// The standard uncertainty, if it is finite and above zero.
    pub(super) fn std(&self) -> Option<f64> {
        match self {
            Cell::Estimate { std, .. } => std.filter(|s| s.is_finite() && *s > 0.0),
            _ => None,
        }
    }
}
