//! Files to records: one file a format, one ordered sniff table.
//!
//! ```no_run
//! use vibro_io::Reader;
//! let recording = Reader::new().from_path("TRACE01.DAT")?;
//! for record in &recording.records {
//!     println!("{} {} {}", record.meta().name, record.len(), record.meta().unit);
//! }
//! # Ok::<(), vibro_record::Error>(())
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
mod stream;
mod sweep;
mod sweep_list;
mod text;
mod uff;
mod uff58;
pub(crate) mod wav;

pub mod number;
pub mod write;

pub use format::Format;
pub use header::{Header, Summary};
pub use reader::{Options, Reader, Recording, gathered};
pub use source::Source;
pub use sweep::SweepReader;
pub use sweep_list::{SweepList, inside};
pub use wav::WavStream;
