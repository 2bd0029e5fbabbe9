//! `vibro plan`: what a test will tell before it is made.

use super::question::{Asked, Question};
use crate::analysis::{Answer, plan};
use crate::error::Result;
use crate::report::files::Names;
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct Plan {
    /// plan.toml with an instrument and guesses of the truth
    #[arg(index = 1)]
    plan: PathBuf,
    /// Folder for figures as SVG and PNG, and tables as CSV
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Question for Plan {
    fn allow_outside(&self) -> bool {
        false
    }

    fn work(&self) -> &'static str {
        "computing"
    }

    fn names(&self) -> Names {
        plan::FILES
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.plan.clone()]
    }

    fn out(&self) -> Option<&Path> {
        self.out.as_deref()
    }

    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        plan::answer(asked.folder, &self.plan, asked.progress)
    }
}
