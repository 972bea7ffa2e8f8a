use std::hint::black_box;

use disparity_pyramid::{DisparityField, MatchParams, MatchWorkspace, estimate_into};

use super::contender::Contender;
use super::responding::Responding;
use super::scene::Scene;

/// The vector pyramid as it was before both levels became one visit: all responses first, then the
/// matching, which reads them.
pub(super) struct Unfused<'a> {
    responding: Responding<'a>,
    params: MatchParams,
    workspace: MatchWorkspace,
    field: DisparityField,
}

impl<'a> Unfused<'a> {
    pub(super) fn plan(scene: &'a Scene, params: MatchParams) -> Self {
        Self {
            responding: Responding::plan(scene),
            params,
            workspace: MatchWorkspace::new(),
            field: DisparityField::default(),
        }
    }
}

impl Contender for Unfused<'_> {
    fn run(&mut self) -> anyhow::Result<()> {
        let Self {
            responding,
            params,
            workspace,
            field,
        } = self;
        responding.run()?;
        estimate_into(&responding.responses, *params, workspace, field)?;
        black_box(field);
        Ok(())
    }
}
