//! Tables, files and the page that shows the figures of a campaign.

pub mod files;
pub mod job;
pub mod page;
pub mod pictures;
pub mod tables;

mod growing;
mod html;
mod output;
mod table;
pub mod words;

pub use growing::Growing;
pub use html::Page;
pub use output::Output;
pub use table::{Cell, Column, Table};
pub use vibro_figure::{
    AxisSpec, Drawing, Figure, Grid, Heatmap, Ink, Key, Kind, Legend, Marker, Note, Panel, Peak, Plot, Row,
    Scale, Series, Shape, Stroke, Waterfall, colour,
};
