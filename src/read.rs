//! Files to records: one file a format, one ordered sniff table.
//!
//! ```no_run
//! use vibroimpact::read::Reader;
//! let recording = Reader::new().from_path("TRACE01.DAT")?;
//! for record in &recording.records {
//!     println!("{} {} {}", record.meta().name, record.len(), record.meta().unit);
//! }
//! # Ok::<(), vibroimpact::Error>(())
//! ```

mod abscissa;
mod ascii;
mod choose;
mod csv;
mod cut_off;
mod decibel;
mod footer;
mod format;
mod header;
mod mat;
mod missing;
mod reader;
mod source;
mod sweep;
mod sweep_list;
mod text;
mod traces;
mod uff;
mod uff58;
pub(crate) mod wav;

pub mod number;

pub use format::Format;
pub use header::{Header, Summary};
pub use reader::{Options, Reader, Recording, gathered};
pub use source::Source;
pub use sweep::SweepReader;
pub use sweep_list::{SweepList, inside};
pub use traces::Traces;
pub use wav::WavStream;
