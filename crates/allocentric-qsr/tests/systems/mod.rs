//! Random reference systems for the laws.
#![allow(dead_code, reason = "each law uses some of them")]

use allocentric_qsr::{DepthClass, DepthReference};
use proptest::prelude::*;

/// A system with these bounds after 0, in millimetres.
pub(crate) fn system(bounds_mm: impl IntoIterator<Item = u32>) -> DepthReference {
    let classes = std::iter::once(0)
        .chain(bounds_mm)
        .enumerate()
        .map(|(k, from_mm)| DepthClass {
            short: format!("k{k}"),
            name: format!("class_{k}"),
            from_mm,
        })
        .collect();
    DepthReference::new("random", classes).expect("ascending bounds divide the distances")
}

/// Up to eight classes with bounds below `top_mm`.
pub(crate) fn systems(top_mm: u32) -> impl Strategy<Value = DepthReference> {
    proptest::collection::btree_set(1..top_mm, 0..8).prop_map(system)
}

/// The four systems of the paper.
pub(crate) fn presets() -> Vec<DepthReference> {
    DepthReference::PRESETS
        .map(|name| DepthReference::preset(name).expect("every preset has a name"))
        .to_vec()
}
