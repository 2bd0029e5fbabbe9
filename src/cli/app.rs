//! `vibro app`: the whole tool as one page.

use super::{print, stdout};
use crate::error::{Error, Result};
use crate::read::{Folder, Owner};
use crate::record::{shown, typed};
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct App {
    /// Folder for vibro.html
    #[arg(value_name = "DIR", default_value = ".")]
    out: PathBuf,
}

/// The page, which `crates/vibro-app/build.sh` makes; empty in a command that was built without it.
const PAGE: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/vibro.html"));

/// Name of the page.
pub const NAME: &str = "vibro.html";

impl super::CommandArgs for App {
    fn run(&self, json: bool) -> Result<u8> {
        if PAGE.is_empty() {
            let found = "this vibro was built without the page";
            let hint = format!("take {NAME} from a release, or build it: crates/vibro-app/build.sh FOLDER");
            return Err(Error::refused(found).hint(hint));
        }
        let elsewhere = format!("--out {}", typed(print::unused(Path::new("page"))));
        let mut output = print::output(Folder::from(self.out.as_path()), Owner::Results, elsewhere)?;
        output.write(NAME, PAGE)?;
        output.commit()?;
        let path = self.out.join(NAME);
        if json {
            stdout::object(json!({ "written": path.display().to_string(), "warnings": [], "findings": [] }))?;
        } else {
            stdout::text(&format!(
                "wrote {}: open it in a browser and drop recordings on it\n",
                shown(&path)
            ))?;
        }
        Ok(0)
    }
}
