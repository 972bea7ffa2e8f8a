//! A look in what earlier looks have planned and worked in says what a first look says, bit for bit, and
//! both say what the levels say one after another.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use dorsal::allocentric_qsr::QualitativeScene;
use dorsal::disparity_pyramid::{
    DenseMatcher, DenseParams, DisparityField, EyeView, MatchParams, RowAlignment, SearchRange,
    estimate,
};
use dorsal::egocentric_depth::{DepthMap, locate, triangulate};
use dorsal::v1_gabor::Size;
use dorsal::{
    DenseLook, Dorsal, Estimator, Percept, Range, RectifiedEyes, Rows, Search, sightings,
};

mod rendered_look;
use rendered_look::Frame;

const SIZE: Size = Size {
    width: 256,
    height: 192,
};

/// The levels one after another, nothing kept: what is taken for true here.
fn step_by_step(dorsal: &Dorsal, frame: &Frame) -> Percept {
    let responses = dorsal.respond(&frame.eyes).unwrap();
    let views = frame.eyes.as_ref().map(EyeView::grey);
    let (disparity, starts) = match dorsal.estimator {
        Estimator::Vector(range) => {
            let found = range.disparity(&responses, dorsal.matching).unwrap();
            (found.field, found.starts)
        }
        Estimator::Dense(look) => {
            let vectors = estimate(&responses, dorsal.matching).unwrap();
            let matcher = DenseMatcher::plan(look.params, SIZE).unwrap();
            let field = match (look.rows, look.search) {
                (Rows::AsTaken, Search::Given(search)) => matcher.estimate(&views, search),
                (Rows::AsTaken, Search::Found { .. }) => {
                    let search = SearchRange::covering(&vectors).unwrap();
                    matcher.estimate(&views, search)
                }
                (Rows::Aligned, Search::Found { .. }) => {
                    let search = SearchRange::covering(&vectors).unwrap();
                    let rows = RowAlignment::fit(&vectors).unwrap();
                    let luma = rows.align_luma(views.right.luma);
                    let mut aligned = views;
                    aligned.right = EyeView::grey(&luma);
                    matcher.estimate(&aligned, search)
                }
                (Rows::Rectified, Search::Given(search)) => {
                    let rectified = RectifiedEyes::of(&views, &dorsal.rig).unwrap();
                    let found = matcher.estimate(&rectified.views(), search);
                    Ok(rectified.as_taken(&found.unwrap()).unwrap())
                }
                other => unreachable!("{other:?} is not asked for here"),
            };
            (field.unwrap(), Vec::new())
        }
    };
    let sigma_px = dorsal.estimator.disparity_sigma().of(&disparity);
    let depth = triangulate(&disparity, &dorsal.rig);
    let depth = depth.with_disparity_sigma(sigma_px).unwrap();
    let egocentric = locate(&depth, &frame.labels, &dorsal.rig, &dorsal.locating).unwrap();
    let qualitative = QualitativeScene::qualify_with(
        sightings(&egocentric, &frame.names),
        &dorsal.reference,
        dorsal.qualifying,
    );
    Percept {
        disparity,
        starts,
        depth,
        egocentric,
        qualitative: qualitative.unwrap(),
    }
}

fn bits(depth: &DepthMap) -> Vec<(u32, u32)> {
    let sigma_px = depth.disparity_sigma_px().unwrap();
    let planes = depth.metres().into_iter().zip(sigma_px);
    planes
        .map(|(z, sigma)| (z.to_bits(), sigma.to_bits()))
        .collect()
}

fn assert_same(one: &Percept, other: &Percept, what: &str) {
    let fields: [&DisparityField; 2] = [&one.disparity, &other.disparity];
    assert!(fields[0] == fields[1], "{what}: disparity");
    assert_eq!(one.starts, other.starts, "{what}");
    assert!(bits(&one.depth) == bits(&other.depth), "{what}: depth");
    assert_eq!(one.egocentric, other.egocentric, "{what}");
    assert_eq!(one.qualitative, other.qualitative, "{what}");
}

/// The ways to look, each with a head that sees something that way.
fn ways() -> Vec<(&'static str, [Frame; 2], Estimator)> {
    let verged = || [0.0, 0.02].map(|right_m| Frame::verged(SIZE, right_m));
    let parallel = || [0.26, 0.24].map(|baseline_m| Frame::parallel(SIZE, baseline_m));
    let dense = |search, rows| {
        Estimator::Dense(DenseLook {
            params: DenseParams::fast(),
            search,
            rows,
        })
    };
    let found = Search::Found { most_dx: None };
    let given = Search::Given(SearchRange::new(-80, 60).unwrap());
    vec![
        ("given", verged(), Estimator::Vector(Range::Given)),
        ("auto", verged(), Estimator::Vector(Range::Auto)),
        ("wide", parallel(), Estimator::Vector(Range::Wide)),
        ("dense, found", parallel(), dense(found, Rows::AsTaken)),
        ("dense, given", parallel(), dense(given, Rows::AsTaken)),
        ("dense, aligned", parallel(), dense(found, Rows::Aligned)),
        ("dense, rectified", verged(), dense(given, Rows::Rectified)),
    ]
}

#[test]
fn a_look_in_kept_rooms_is_the_look() {
    for (what, [first, second], estimator) in ways() {
        let mut dorsal = first.dorsal(estimator, MatchParams::default());
        let mut percept = Percept::default();
        for frame in [&first, &second, &first] {
            dorsal.rig = frame.rig;
            dorsal
                .look_into(&frame.eyes, &frame.labels, &frame.names, &mut percept)
                .unwrap();
            let want = step_by_step(&dorsal, frame);
            assert_same(&percept, &want, what);
            let alone = dorsal.look(&frame.eyes, &frame.labels, &frame.names);
            assert_same(&alone.unwrap(), &want, what);
        }
    }
}

/// What is exchanged between two looks is planned anew, and the bits do not depend on what was before.
#[test]
fn a_look_takes_what_was_exchanged() {
    let frame = Frame::parallel(SIZE, 0.26);
    let matching = MatchParams::default();
    let mut dorsal = frame.dorsal(Estimator::default(), matching);
    let mut percept = Percept::default();
    let mut covariances = Vec::new();
    for (estimator, covariance) in [
        (Estimator::Vector(Range::Given), false),
        (Estimator::Dense(DenseLook::default()), false),
        (Estimator::Vector(Range::Given), true),
        (Estimator::Vector(Range::Given), false),
    ] {
        dorsal.estimator = estimator;
        dorsal.matching.covariance = covariance;
        dorsal
            .look_into(&frame.eyes, &frame.labels, &frame.names, &mut percept)
            .unwrap();
        covariances.push(percept.disparity.covariance().is_some());
        assert_same(&percept, &step_by_step(&dorsal, &frame), "exchanged");
    }
    assert_eq!(covariances, [false, false, true, false]);
}
