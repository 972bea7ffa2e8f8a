use std::io::Write as _;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// What is said on standard error while the command works: a spinner, if it is a terminal, and
/// notes. A quiet console says nothing.
#[derive(Debug)]
pub(crate) struct Console {
    spinner: ProgressBar,
    quiet: bool,
}

impl Console {
    pub(crate) fn new(quiet: bool) -> Self {
        // Standard error that is no terminal shows no spinner: indicatif sees to that.
        let target = if quiet {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let spinner = ProgressBar::with_draw_target(None, target)
            .with_style(ProgressStyle::default_spinner());
        if !spinner.is_hidden() {
            spinner.enable_steady_tick(Duration::from_millis(100));
        }
        Self { spinner, quiet }
    }

    /// Says what is being done from now on.
    pub(crate) fn step(&self, what: impl Into<String>) {
        self.spinner.set_message(what.into());
    }

    /// Says something the user should know, and no more: that standard error is closed is no
    /// reason to fail.
    pub(crate) fn note(&self, note: &str) {
        if !self.quiet {
            self.spinner.suspend(|| {
                let _ = writeln!(std::io::stderr(), "note: {note}");
            });
        }
    }

    /// Takes the spinner away, so that results stand alone on the screen.
    pub(crate) fn clear(&self) {
        self.spinner.finish_and_clear();
    }
}
