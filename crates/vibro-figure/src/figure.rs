//! Figures as data: what is shown, with which labels, in which arrangement.

use crate::{AxisSpec, Grid, Heatmap, Series, Waterfall};
use serde::{Deserialize, Serialize};

/// Panels in a grid, at the size in which they are printed.
///
/// ```
/// use vibro_figure::{AxisSpec, Figure, Plot, Series};
/// let plot = Plot::new(AxisSpec::frequency(), AxisSpec::new("Displacement amplitude", "m"))
///     .with(Series::line("sweeping up", [4.0, 5.0, 6.0], [0.001, 0.004, 0.002]))
///     .note("grazing 5.58 Hz", 5.0, 0.004);
/// let drawing = Figure::single("Response of the passive mass").panel(plot).draw();
/// assert!(drawing.svg().starts_with("<svg"));
/// ```
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// What the figure shows, in a few words. Not drawn: it names the figure for screen readers and heads
    /// its caption on a page.
    pub title: String,
    /// Caption below the figure; empty for none.
    pub caption: String,
    /// Width in mm.
    pub width: f64,
    /// Height in mm.
    pub height: f64,
    /// Panels in a row.
    pub columns: usize,
    /// Whether the panels of a column share one abscissa, named under the lowest.
    pub shared_x: bool,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
}

/// One part of a figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
// A figure has few panels: the size of the largest kind does not matter.
#[allow(clippy::large_enum_variant)]
pub enum Panel {
    /// Series over two axes.
    Plot(Plot),
    /// Spectra drawn one behind the other.
    Waterfall(Waterfall),
    /// Classes in rows and columns.
    Grid(Grid),
}

/// Series over two axes, with a map under them where wanted.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Plot {
    /// Title over the frame; empty for none.
    pub title: String,
    /// Abscissa.
    pub x: AxisSpec,
    /// Ordinate.
    pub y: AxisSpec,
    /// Map under the series.
    pub heatmap: Option<Heatmap>,
    /// Series, the later over the earlier.
    pub series: Vec<Series>,
    /// Texts that label points of the data.
    pub notes: Vec<Note>,
    /// Position of the legend.
    pub legend: Legend,
    /// True if the plot repeats an earlier panel, for example on a logarithmic axis. A page with adjustable
    /// axes omits it.
    pub again: bool,
    /// True if both axes have the same scale in points per unit, so that a circle is round. Both axes must
    /// be linear and have one unit.
    pub square: bool,
}

/// A text with a line to the point that it labels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Note {
    /// The text.
    pub text: String,
    /// Abscissa of the point, in the unit of the axis.
    pub x: f64,
    /// Ordinate of the point, in the unit of the axis.
    pub y: f64,
}

/// Position of the legend, the list of the names of the series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Legend {
    /// In the frame at a place without data; if there is none, to the right of the frame or above it.
    #[default]
    Auto,
    /// To the right of the frame.
    Right,
    /// Over the frame.
    Above,
    /// Nowhere.
    Hidden,
}

impl Figure {
    /// A figure as wide as one column of a journal, 86 mm × 62 mm.
    pub fn single(title: impl Into<String>) -> Figure {
        Figure { title: title.into(), width: 86.0, height: 62.0, columns: 1, ..Figure::default() }
    }

    /// A figure as wide as two columns of a journal, 178 mm × 90 mm.
    pub fn double(title: impl Into<String>) -> Figure {
        Figure { width: 178.0, height: 90.0, ..Figure::single(title) }
    }

    /// Sets the caption.
    pub fn caption(self, caption: impl Into<String>) -> Figure {
        Figure { caption: caption.into(), ..self }
    }

    /// Sets the height in mm.
    pub fn height(self, millimetres: f64) -> Figure {
        Figure { height: millimetres, ..self }
    }

    /// Sets the number of panels in a row.
    pub fn columns(self, columns: usize) -> Figure {
        Figure { columns, ..self }
    }

    /// Gives the panels of a column one abscissa, named under the lowest.
    pub fn shared_x(self) -> Figure {
        Figure { shared_x: true, ..self }
    }

    /// Adds a panel.
    pub fn panel(mut self, panel: impl Into<Panel>) -> Figure {
        self.panels.push(panel.into());
        self
    }
}

impl Plot {
    /// An empty plot over two axes.
    pub fn new(x: AxisSpec, y: AxisSpec) -> Plot {
        Plot { x, y, ..Plot::default() }
    }

    /// Sets the title over the frame.
    pub fn title(self, title: impl Into<String>) -> Plot {
        Plot { title: title.into(), ..self }
    }

    /// Adds a series over those before it.
    pub fn with(mut self, series: Series) -> Plot {
        self.series.push(series);
        self
    }

    /// Labels a point of the data, given in the units of the axes.
    pub fn note(mut self, text: impl Into<String>, x: f64, y: f64) -> Plot {
        self.notes.push(Note { text: text.into(), x, y });
        self
    }

    /// Puts a map under the series.
    pub fn heatmap(self, heatmap: Heatmap) -> Plot {
        Plot { heatmap: Some(heatmap), ..self }
    }

    /// Sets the position of the legend.
    pub fn legend(self, legend: Legend) -> Plot {
        Plot { legend, ..self }
    }

    /// Gives both axes the same scale in points per unit.
    pub fn square(self) -> Plot {
        Plot { square: true, ..self }
    }

    /// Marks the plot as a repeat of an earlier panel.
    pub fn again(self) -> Plot {
        Plot { again: true, ..self }
    }
}

macro_rules! panels {
    ($($kind:ident),*) => {$(
        impl From<$kind> for Panel {
            fn from(panel: $kind) -> Panel {
                Panel::$kind(panel)
            }
        }
    )*};
}

panels!(Plot, Waterfall, Grid);
