//! What a person reads: tables, figures, files, one page, and the words for findings. This folder depends
//! on no
//! analysis.

pub(crate) mod files;
pub(crate) mod layout;
pub mod words;

mod cell;
mod column;
mod html;
mod output;
mod table;

pub use cell::Cell;
pub use column::Column;
pub use files::Picture;
pub use html::Page;
pub use output::Output;
pub use table::Table;
pub(crate) use vibro_figure::{
    AxisSpec, Class, Figure, Grid, Heatmap, Ink, Legend, Marker, Medium, Panel, Plot, Series, Stroke,
    Waterfall, colour,
};
