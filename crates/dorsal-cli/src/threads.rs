use std::num::NonZeroUsize;

use anyhow::Context as _;
use clap::Args;

/// How many threads may work at once.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Threads {
    /// Threads that work at once [default: one for each core]
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
}

impl Threads {
    /// Gives the process its pool of threads; whatever works in parallel afterwards works there.
    pub(crate) fn install(self) -> anyhow::Result<()> {
        let Some(threads) = self.threads else {
            return Ok(());
        };
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.get())
            .build_global()
            .with_context(|| format!("{threads} threads cannot be started; try fewer"))
    }
}
