use std::collections::BTreeMap;
use std::hint::black_box;

use anyhow::Context;
use disparity_pyramid::{
    DenseParams, DisparityField, EyeView, MatchParams, SearchRange, VectorMatcher,
};
use v1_gabor::{BankWorkspace, Binocular, FilterBank, LumaImage, V1Responses};

use super::SHIFTS;
use super::contestants::{
    DENSE_BEST, DENSE_FAST, DENSE_FULL, DENSE_VERGED, LOOK, NO_LOOK_BACK, ONE_WARP, RESPONSES,
    VECTOR,
};
use super::dense_stream::DenseStream;
use crate::whole_look::WholeLook;

/// What runs of ours need, planned once as for a stream of frames.
pub(super) struct Ours {
    images: Binocular<LumaImage>,
    /// The same room by parallel eyes: the dense estimator's pair.
    parallel: Binocular<LumaImage>,
    bank: FilterBank,
    workspace: BankWorkspace,
    responses: Binocular<V1Responses>,
    /// One for each setting.
    vector: BTreeMap<&'static str, VectorMatcher>,
    field: DisparityField,
    dense: BTreeMap<&'static str, DenseStream>,
    search: SearchRange,
    look: WholeLook,
}

impl Ours {
    pub(super) fn plan(
        bank: FilterBank,
        look: WholeLook,
        images: Binocular<LumaImage>,
        parallel: Binocular<LumaImage>,
    ) -> anyhow::Result<Self> {
        let size = bank.size();
        let params = MatchParams::default();
        let settings = [
            (VECTOR, params),
            (
                NO_LOOK_BACK,
                MatchParams {
                    left_right_px: None,
                    ..params
                },
            ),
            (ONE_WARP, MatchParams::one_warp()),
        ];
        let vector = settings
            .into_iter()
            .map(|(name, params)| Ok((name, VectorMatcher::plan(bank.clone(), params)?)));
        let fast = DenseParams::fast();
        let whole = DenseParams {
            narrow_px: None,
            ..fast
        };
        let dense = [
            (DENSE_FAST, fast),
            (DENSE_FULL, whole),
            (DENSE_BEST, DenseParams::best()),
            (DENSE_VERGED, fast),
        ];
        let dense = dense
            .into_iter()
            .map(|(name, params)| Ok((name, DenseStream::plan(params, size)?)));
        Ok(Self {
            parallel,
            dense: dense.collect::<anyhow::Result<_>>()?,
            vector: vector.collect::<anyhow::Result<_>>()?,
            workspace: bank.workspace(),
            responses: Binocular {
                left: bank.silence(),
                right: bank.silence(),
            },
            bank,
            field: DisparityField::default(),
            search: SearchRange::new(1 - SHIFTS as i32, 0)?,
            look,
            images,
        })
    }

    /// One run of the contestant of this name.
    pub(super) fn run(&mut self, name: &str) -> anyhow::Result<()> {
        if let Some(matcher) = self.vector.get_mut(name) {
            matcher.estimate_into(&self.images, &mut self.field)?;
            black_box(&self.field);
            return Ok(());
        }
        if name == RESPONSES {
            return self.respond();
        }
        if name == LOOK {
            return self.look.look();
        }
        let pair = if name == DENSE_VERGED {
            &self.images
        } else {
            &self.parallel
        };
        let views = pair.as_ref().map(EyeView::grey);
        let stream = self
            .dense
            .get_mut(name)
            .with_context(|| format!("nobody is called {name}"))?;
        let DenseStream {
            matcher,
            workspace,
            field,
        } = stream;
        matcher.estimate_into(&views, self.search, workspace, field)?;
        black_box(field);
        Ok(())
    }

    fn respond(&mut self) -> anyhow::Result<()> {
        let Self {
            images,
            bank,
            workspace,
            responses,
            ..
        } = self;
        bank.respond_into(&images.left, workspace, &mut responses.left)?;
        bank.respond_into(&images.right, workspace, &mut responses.right)?;
        Ok(())
    }
}
