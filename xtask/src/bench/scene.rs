use std::path::Path;
use std::sync::OnceLock;

use anyhow::Context;
use disparity_pyramid::{
    DenseMatcher, DenseParams, DenseWorkspace, DisparityField, EyeView, SearchRange,
};
use dorsal::Names;
use egocentric_depth::{LabelImage, StereoRig};
use stereo_formats::rig_toml;
use stereo_scenes::{Exposure, Room, render};
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};

use super::SHIFTS;
use super::pair::{parallel_gaze, read_pair, write_pair};

/// What the contestants see at one size, held in memory.
pub(super) struct Scene {
    pub(super) bank: FilterBank,
    /// The room as its head sees it, with eyes that converge: the vector pyramid's pair.
    pub(super) verged: Binocular<LumaImage>,
    /// The same room by parallel eyes: the dense estimator's pair.
    pub(super) parallel: Binocular<LumaImage>,
    /// Those of the parallel eyes.
    pub(super) rig: StereoRig,
    /// The things in the left image of the parallel pair, and their names.
    pub(super) labels: LabelImage,
    pub(super) names: Names,
    disparity: OnceLock<DisparityField>,
}

impl Scene {
    /// The project's room at this size.
    pub(super) fn render(size: Size) -> anyhow::Result<Self> {
        let room = Room::demo();
        let gaze = room.head().resized(size).fixate(room.fixation_m())?;
        let verged = render(&room, &gaze, Exposure::default())?.images;
        let gaze = parallel_gaze(&room, size)?;
        let view = render(&room, &gaze, Exposure::default())?;
        Self::new(verged, view.images, gaze.rig(), view.truth.labels)
    }

    fn new(
        verged: Binocular<LumaImage>,
        parallel: Binocular<LumaImage>,
        rig: StereoRig,
        labels: LabelImage,
    ) -> anyhow::Result<Self> {
        let size = verged.left.size();
        let room = Room::demo();
        let names = room.names().map(|(label, name)| (label, name.to_owned()));
        Ok(Self {
            bank: FilterBank::plan(GaborParams::default().fitted_to(size), size)?,
            names: names.collect(),
            verged,
            parallel,
            rig,
            labels,
            disparity: OnceLock::new(),
        })
    }

    /// Writes all of it to files in a folder that is there, the pictures with 8 bits.
    pub(super) fn write(&self, folder: &Path) -> anyhow::Result<()> {
        write_pair(&self.verged, folder, "verged")?;
        write_pair(&self.parallel, folder, "parallel")?;
        rig_toml::write(folder.join("rig.toml"), &self.rig)?;
        stereo_formats::label_png::write(folder.join("labels.png"), &self.labels)?;
        Ok(())
    }

    /// Reads what was written.
    pub(super) fn read(folder: &Path) -> anyhow::Result<Self> {
        Self::new(
            read_pair(folder, "verged")?,
            read_pair(folder, "parallel")?,
            rig_toml::read(folder.join("rig.toml"))?,
            stereo_formats::label_png::read(folder.join("labels.png"))?,
        )
    }

    pub(super) const fn size(&self) -> Size {
        self.bank.size()
    }

    /// The field of the parallel pair, from which levels 3 and 4 go on; estimated when it is asked for
    /// first.
    pub(super) fn disparity(&self) -> anyhow::Result<&DisparityField> {
        if self.disparity.get().is_none() {
            let matcher = DenseMatcher::plan(DenseParams::fast(), self.size())?;
            let mut field = DisparityField::default();
            let views = self.parallel.as_ref().map(EyeView::grey);
            let mut workspace = DenseWorkspace::new();
            matcher.estimate_into(&views, search()?, &mut workspace, &mut field)?;
            self.disparity.get_or_init(|| field);
        }
        self.disparity.get().context("it was just estimated")
    }
}

/// What the dense estimators search.
pub(super) fn search() -> anyhow::Result<SearchRange> {
    Ok(SearchRange::new(1 - SHIFTS as i32, 0)?)
}
