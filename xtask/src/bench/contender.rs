use super::contestants::{
    DENSE_BEST, DENSE_FAST, DENSE_FULL, DENSE_VERGED, DEPTHS, LOOK, NO_LOOK_BACK, OBJECTS,
    ONE_WARP, RESPONSES, UNFUSED, VECTOR,
};
use super::dense_stream::DenseStream;
use super::depths::Depths;
use super::matching::Matching;
use super::objects::Objects;
use super::responding::Responding;
use super::scene::Scene;
use super::unfused::Unfused;
use super::whole_look::WholeLook;
use disparity_pyramid::{DenseParams, MatchParams};

/// One of ours, planned as for a stream of frames.
pub(super) trait Contender: Send {
    /// One frame, over the one before.
    fn run(&mut self) -> anyhow::Result<()>;
}

/// Plans the contestant of this name before a scene, which it borrows.
pub(super) fn contender<'a>(
    name: &str,
    scene: &'a Scene,
) -> anyhow::Result<Box<dyn Contender + 'a>> {
    let params = MatchParams::default();
    let fast = DenseParams::fast();
    let whole = DenseParams {
        narrow_px: None,
        ..fast
    };
    let one_way = MatchParams {
        left_right_px: None,
        ..params
    };
    Ok(match name {
        RESPONSES => Box::new(Responding::plan(scene)),
        VECTOR => Box::new(Matching::plan(scene, params)?),
        NO_LOOK_BACK => Box::new(Matching::plan(scene, one_way)?),
        ONE_WARP => Box::new(Matching::plan(scene, MatchParams::one_warp())?),
        UNFUSED => Box::new(Unfused::plan(scene, one_way)),
        DENSE_FAST => Box::new(DenseStream::plan(fast, &scene.parallel)?),
        DENSE_FULL => Box::new(DenseStream::plan(whole, &scene.parallel)?),
        DENSE_BEST => Box::new(DenseStream::plan(DenseParams::best(), &scene.parallel)?),
        DENSE_VERGED => Box::new(DenseStream::plan(fast, &scene.verged)?),
        DEPTHS => Box::new(Depths::plan(scene)?),
        OBJECTS => Box::new(Objects::plan(scene)?),
        LOOK => Box::new(WholeLook::plan(scene)),
        _ => anyhow::bail!("nobody is called {name}"),
    })
}
