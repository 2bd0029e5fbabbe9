//! Writes the records of the estimators' scenes to a folder, for `benches/peers/estimators.py`:
//! `cargo run --release -p vibro-precision --example records -- FOLDER [--quick]`.

use std::path::Path;
use vibro_precision::estimators::write_records;
use vibro_record::{Error, Result};

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or_else(|| Error::usage("no folder", "records FOLDER [--quick]"))?;
    write_records(Path::new(&folder), arguments.next().is_some_and(|a| a == "--quick"))
}
