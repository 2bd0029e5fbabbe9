//! Figures, tables and the page that shows them.
//!
//! A [`Figure`] is data: panels with axes and series, no drawing. [`Figure::draw`] makes a [`Drawing`] of it,
//! which is written as SVG or PNG. Drawing needs nothing but the figure, so that many can be drawn at once;
//! the same figure gives the same bytes on every machine.

pub mod colour;
pub mod files;
pub mod job;
pub mod page;
pub mod pictures;
pub mod tables;

mod axis;
mod draw;
mod figure;
mod font;
mod grid;
mod growing;
mod heatmap;
mod horizon;
mod html;
mod output;
mod path;
mod png;
mod projection;
mod series;
mod table;
mod ticks;
mod waterfall;

pub use axis::{AxisSpec, Scale};
pub use draw::Drawing;
pub use figure::{Figure, Legend, Note, Panel, Plot};
pub use grid::{Grid, Kind, Row};
pub use growing::Growing;
pub use heatmap::{Heatmap, Key};
pub use html::Page;
pub use output::Output;
pub use series::{Ink, Marker, Series, Shape, Stroke};
pub use table::{Cell, Column, Table};
pub use waterfall::{Peak, Waterfall};
