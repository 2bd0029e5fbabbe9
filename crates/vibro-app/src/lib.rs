//! The whole tool on a page: files that are dropped on it become a campaign, which runs in the browser. The
//! page sends each [`Request`] to a [`Workbench`], which answers in JSON or with the bytes of a file.
//!
//! ```
//! use vibro_app::{Reply, Request, Workbench};
//! let mut bench = Workbench::default();
//! bench.add("let_go.csv", b"t [s],x [mm]\n0,1\n0.001,0.9\n0.002,0.7\n".to_vec())?;
//! let Reply::Json(seen) = bench.answer(&Request::Look, &())? else { panic!("no JSON") };
//! assert_eq!(seen["recordings"][0]["path"], "let_go.csv");
//! # Ok::<(), vibroimpact::Error>(())
//! ```

mod archive;
mod page;
mod picture;
mod recording;
mod request;
mod table;
mod words;
mod workbench;

pub use picture::Picture;
pub use recording::SeenRecording;
pub use request::{Reply, Request};
pub use table::SeenTable;
pub use workbench::Workbench;
