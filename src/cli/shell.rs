//! `vibro completions` and `vibro man`, generated from the definition of the commands.

use super::stdout;
use crate::error::{Error, Result};
use clap_complete::Shell;

#[derive(Debug, clap::Args)]
pub struct Completions {
    /// bash, zsh, fish, elvish or powershell
    #[arg(index = 1)]
    shell: Shell,
}

#[derive(Debug, clap::Args)]
pub struct Man {}

impl super::CommandArgs for Completions {
    fn run(&self, _: bool) -> Result<u8> {
        let mut text = Vec::new();
        clap_complete::generate(self.shell, &mut super::command(), "vibro", &mut text);
        stdout::text(&String::from_utf8_lossy(&text))?;
        Ok(0)
    }
}

impl super::CommandArgs for Man {
    fn run(&self, _: bool) -> Result<u8> {
        let mut text = Vec::new();
        let page = clap_mangen::Man::new(super::command());
        page.render(&mut text).map_err(|e| Error::io("write", "the manual page", e))?;
        stdout::text(&String::from_utf8_lossy(&text))?;
        Ok(0)
    }
}
