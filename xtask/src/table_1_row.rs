use anyhow::Context;
use disparity_pyramid::{DisparityField, MatchParams, estimate, estimate_monogenic};
use serde::Serialize;
use v1_gabor::{
    Binocular, Family, FilterBank, GaborParams, LumaImage, MonogenicBank, MonogenicParams,
    SteerableOrder, SteerableParams, V1Responses,
};

/// The filters of a row of Table 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Filters {
    Gabor,
    S4,
    S2,
    Sqf,
}

/// How the responses of two eyes become disparities.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Matcher {
    /// The paper's steps, both components: the protocol of the table.
    Published,
    /// The paper's steps, with the vertical component held at 0.
    PublishedRowsOnly,
    /// The paper's steps, with a second warp a scale.
    PublishedTwoWarps,
    /// This library's default.
    Default,
}

/// One row of the table as it is run here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Row {
    /// Its place among the paper's rows.
    pub(crate) printed: usize,
    pub(crate) filters: Filters,
    pub(crate) matcher: Matcher,
}

impl Filters {
    /// In the order of the paper's first four rows.
    pub(crate) const ALL: [Self; 4] = [Self::Gabor, Self::S4, Self::S2, Self::Sqf];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Gabor => "Gabor",
            Self::S4 => "s4",
            Self::S2 => "s2",
            Self::Sqf => "SQF",
        }
    }

    /// The oriented family, with its default parameters; `None` for the spherical one.
    fn oriented(self) -> Option<Family> {
        let steerable = |order| SteerableParams {
            order,
            ..SteerableParams::default()
        };
        match self {
            Self::Gabor => Some(GaborParams::default().into()),
            Self::S4 => Some(steerable(SteerableOrder::Fourth).into()),
            Self::S2 => Some(steerable(SteerableOrder::Second).into()),
            Self::Sqf => None,
        }
    }

    /// What both eyes' oriented filters say; `None` for the spherical family.
    pub(crate) fn respond(
        self,
        eyes: &Binocular<LumaImage>,
    ) -> anyhow::Result<Option<Binocular<V1Responses>>> {
        let size = eyes.left.size();
        let Some(family) = self.oriented() else {
            return Ok(None);
        };
        let bank = FilterBank::plan(family.fitted_to(size), size)
            .context("level 1 has no bank for these images")?;
        Ok(Some(eyes.as_ref().try_map(|eye| bank.respond(eye))?))
    }
}

impl Matcher {
    pub(crate) fn params(self) -> MatchParams {
        match self {
            Self::Published => MatchParams::as_published(),
            Self::PublishedRowsOnly => MatchParams {
                rows_only: true,
                ..MatchParams::as_published()
            },
            Self::PublishedTwoWarps => MatchParams {
                warps: 2,
                finest_warps: 2,
                ..MatchParams::as_published()
            },
            Self::Default => MatchParams::default(),
        }
    }
}

impl Row {
    /// The disparity of a pair.
    pub(crate) fn look(self, eyes: &Binocular<LumaImage>) -> anyhow::Result<DisparityField> {
        let params = self.matcher.params();
        let field = match self.filters.respond(eyes)? {
            Some(responses) => estimate(&responses, params),
            None => {
                let size = eyes.left.size();
                let bank = MonogenicBank::plan(MonogenicParams::default().fitted_to(size), size)
                    .context("level 1 has no bank for these images")?;
                let responses = eyes.as_ref().try_map(|eye| bank.respond(eye))?;
                estimate_monogenic(&responses, params)
            }
        };
        field.context("level 2 cannot match these eyes")
    }
}
