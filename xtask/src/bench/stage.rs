/// A step of the way whose function stands by itself in the program, so that callgrind knows what it takes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage {
    /// What it is called in the page.
    pub(super) name: &'static str,
    /// The end of the function's path.
    function: &'static str,
    /// How far it is indented: a part of the last one above that is less.
    pub(super) depth: usize,
}

const fn stage(depth: usize, name: &'static str, function: &'static str) -> Stage {
    Stage {
        name,
        function,
        depth,
    }
}

/// Those of a whole look.
pub(super) const OF_A_LOOK: [Stage; 16] = [
    stage(
        0,
        "the range, by the vector pyramid",
        "DenseLook::prepare_in",
    ),
    stage(
        1,
        "levels 1 and 2, both ways",
        "VectorMatcher::estimate_into",
    ),
    stage(2, "warps and fits", "refine::Row::dispatch"),
    stage(2, "medians", "Medians::smooth_valid"),
    stage(0, "the dense estimator", "DenseMatcher::estimate_into"),
    stage(1, "costs and paths", "aggregate::aggregate"),
    stage(1, "surface cells", "slanted_cells::fit_surfaces"),
    stage(
        1,
        "choices between surfaces",
        "surface_choice::choose_surfaces",
    ),
    stage(1, "hyperacuity", "heard_codes::sharpen_by_codes"),
    stage(1, "votes", "voting::vote"),
    stage(1, "confidence", "confidence::confidence"),
    stage(0, "depths", "triangulate::triangulate_into"),
    stage(1, "their uncertainty", "DisparitySigma::of_into"),
    stage(0, "objects", "locate::locate_into"),
    stage(0, "relations", "QualitativeScene::qualify_with"),
    stage(
        0,
        "filters of both estimators, within the above",
        "dispatch::Rows::respond",
    ),
];

/// Those of the vector pyramid alone.
pub(super) const OF_THE_PYRAMID: [Stage; 4] = [
    stage(0, "filters", "dispatch::Rows::respond"),
    stage(0, "warps and fits", "refine::Row::dispatch"),
    stage(0, "medians", "Medians::smooth_valid"),
    stage(0, "patches", "speckles::reject_speckles"),
];

impl Stage {
    /// Whether callgrind's name is that of this function.
    pub(super) fn is(&self, name: &str) -> bool {
        name.ends_with(self.function)
    }
}
