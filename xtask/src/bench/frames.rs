use std::path::PathBuf;

use clap::Args;

use super::contender::contender;
use super::scene::Scene;

/// Run one contestant of the bench for some frames, on one thread
///
/// What `cargo xtask bench --counts` has counted; the scene is a folder that it wrote.
#[derive(Args, Debug)]
pub(crate) struct Options {
    /// What the bench calls it
    name: String,
    /// Folder of the scene
    #[arg(long, value_name = "DIR")]
    scene: PathBuf,
    /// How many frames
    #[arg(long, value_name = "N", default_value_t = 1)]
    frames: u16,
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| {
        let scene = Scene::read(&options.scene)?;
        let mut contender = contender(&options.name, &scene)?;
        for _ in 0..options.frames {
            contender.run()?;
        }
        Ok(())
    })
}
