//! Progress for a person at a terminal; nothing anywhere else.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// A bar on standard error where that is a terminal and no JSON was asked for.
pub fn bar(json: bool) -> ProgressBar {
    let bar = ProgressBar::no_length();
    if json || !std::io::stderr().is_terminal() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
        return bar;
    }
    if let Ok(style) = ProgressStyle::with_template("{msg:24} {wide_bar} {pos}/{len}") {
        bar.set_style(style);
    }
    bar
}

/// A sign on standard error, on the same terms as [`bar`], that work of unknown length goes on. It goes when it is dropped.
pub struct Busy(ProgressBar);

impl Busy {
    /// Shows `what` is done.
    pub fn with(json: bool, what: &'static str) -> Busy {
        let bar = bar(json);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}, {elapsed}") {
            bar.set_style(style);
        }
        bar.set_message(what);
        bar.enable_steady_tick(Duration::from_millis(200));
        Busy(bar)
    }
}

impl Drop for Busy {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

impl crate::analysis::Progress for ProgressBar {
    fn start(&self, what: &str, steps: usize) {
        self.set_length(steps as u64);
        self.set_position(0);
        self.set_message(what.to_owned());
    }

    fn step(&self) {
        self.inc(1);
    }

    fn done(&self) {
        self.finish_and_clear();
    }
}
