use rayon::ThreadPool;
use serde::Serialize;

use super::contender::contender;
use super::scene::Scene;
use crate::counting_allocator::CountingAllocator;

/// What one contestant asks of the allocator.
#[derive(Debug, Serialize)]
pub(crate) struct MemoryUse {
    pub(crate) name: &'static str,
    /// The most that it held at once, from its plan to its third frame, beyond the images: with filters,
    /// buffers and results.
    pub(crate) workspace_bytes: usize,
    pub(crate) bytes_a_pixel: f64,
    /// Allocations of more than 4096 bytes in each of its second and third frame: the more of the two.
    pub(crate) large_allocations_a_frame: usize,
}

impl MemoryUse {
    /// Plans a contestant for itself and runs three frames.
    pub(super) fn measure(
        name: &'static str,
        scene: &Scene,
        pool: &ThreadPool,
    ) -> anyhow::Result<Self> {
        // Inputs of the upper levels are there before counting begins.
        scene.disparity()?;
        pool.install(|| {
            let before = CountingAllocator::begin();
            let mut contender = contender(name, scene)?;
            contender.run()?;
            let mut most = CountingAllocator::most();
            let mut large = 0;
            for _ in 0..2 {
                CountingAllocator::begin();
                contender.run()?;
                most = most.max(CountingAllocator::most());
                large = large.max(CountingAllocator::large_ones());
            }
            let workspace_bytes = most.saturating_sub(before);
            Ok(Self {
                name,
                workspace_bytes,
                bytes_a_pixel: workspace_bytes as f64 / scene.size().area() as f64,
                large_allocations_a_frame: large,
            })
        })
    }
}
