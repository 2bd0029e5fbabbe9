//! Figures as data, drawn as SVG and PNG.
//!
//! A [`Figure`] is data: panels with axes and series, no drawing. [`Figure::draw`] turns it into a
//! [`Drawing`], which is written as SVG or PNG. Drawing needs nothing but the figure, so that figures can be
//! drawn in parallel; the same figure gives the same bytes on every machine.
//!
//! ```
//! use vibro_figure::{AxisSpec, Figure, Plot, Series};
//! let (time, force) = (vec![0.0, 1e-4, 2e-4, 3e-4], vec![0.0, 80.0, 60.0, 0.0]);
//! let plot = Plot::new(AxisSpec::new("time", "s"), AxisSpec::new("force", "N"));
//! let drawing = Figure::single("Contact").panel(plot.with(Series::line("hammer", time, force))).draw();
//! assert!(drawing.svg().contains("Contact"));
//! ```

pub mod colour;

mod axis;
mod canvas;
mod draw;
mod figure;
mod font;
mod forms;
mod frame;
mod grid;
mod heatmap;
mod interactive;
mod legend;
mod medium;
mod notes;
mod path;
mod pixels;
mod plot;
mod png;
mod series;
mod style;
mod ticks;
mod waterfall;

pub use axis::{AxisSpec, Scale};
pub use canvas::escaped;
pub use draw::Drawing;
pub use figure::{Figure, Legend, Note, Panel, Plot};
pub use grid::{Class, Grid};
pub use heatmap::Heatmap;
pub use interactive::Matrices;
pub use medium::Medium;
pub use series::{Ink, Marker, Series, Shape, Stroke};
pub use waterfall::Waterfall;

// Used by several modules.
use axis::{Axis, Extent, Room};
use canvas::{Anchor, Canvas, Image, Pen, Text};
use colour::{BLACK, GREY, PALE, Rgb, WHITE};
use forms::Form;
use frame::{Insets, Place, Ruler, Side, fitted};
use heatmap::{Key, ascending, fits};
use legend::KeyList;
use notes::Clutter;
use path::{Point, Rect, clipped, thinned};
use plot::Sheet;
use ticks::Ticks;
