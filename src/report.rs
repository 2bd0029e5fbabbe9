//! What a person reads: tables, figures, files, one page, and the words for findings. Nothing here knows an analysis.

pub mod files;
pub mod layout;
pub mod words;

mod html;
mod output;
mod table;

pub use html::Page;
pub use output::Output;
pub use table::{Cell, Column, Table};
pub use vibro_figure::{
    AxisSpec, Drawing, Figure, Grid, Heatmap, Ink, Kind, Legend, Marker, Note, Panel, Plot, Scale, Series,
    Shape, Stroke, Waterfall, colour,
};
