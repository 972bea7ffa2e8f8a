use v1_gabor::{BankWorkspace, Binocular, FilterBank, LumaImage, V1Responses};

use super::contender::Contender;
use super::scene::Scene;

/// Level 1 alone: all responses of both eyes, held.
pub(super) struct Responding<'a> {
    images: &'a Binocular<LumaImage>,
    bank: &'a FilterBank,
    workspace: BankWorkspace,
    pub(super) responses: Binocular<V1Responses>,
}

impl<'a> Responding<'a> {
    pub(super) fn plan(scene: &'a Scene) -> Self {
        let bank = &scene.bank;
        Self {
            images: &scene.verged,
            workspace: bank.workspace(),
            responses: Binocular {
                left: bank.silence(),
                right: bank.silence(),
            },
            bank,
        }
    }
}

impl Contender for Responding<'_> {
    fn run(&mut self) -> anyhow::Result<()> {
        let Self {
            images,
            bank,
            workspace,
            responses,
        } = self;
        bank.respond_into(&images.left, workspace, &mut responses.left)?;
        bank.respond_into(&images.right, workspace, &mut responses.right)?;
        Ok(())
    }
}
