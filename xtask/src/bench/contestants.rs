/// Ours, and what they are called.
pub(super) const RESPONSES: &str = "responses of both eyes";
pub(super) const VECTOR: &str = "vector pyramid";
pub(super) const NO_LOOK_BACK: &str = "vector pyramid, no look back";
pub(super) const ONE_WARP: &str = "vector pyramid, one warp";
/// The same steps and bits as [`NO_LOOK_BACK`], the responses held.
pub(super) const UNFUSED: &str = "responses, then matching";
pub(super) const DENSE_FAST: &str = "dense, fast";
pub(super) const DENSE_FULL: &str = "dense, fast, whole range";
pub(super) const DENSE_BEST: &str = "dense, best";
pub(super) const DENSE_VERGED: &str = "dense, fast, verged pair";
pub(super) const DEPTHS: &str = "depths of a field";
pub(super) const OBJECTS: &str = "objects and relations";
pub(super) const LOOK: &str = "whole look";

pub(super) const OURS: [&str; 12] = [
    RESPONSES,
    VECTOR,
    NO_LOOK_BACK,
    ONE_WARP,
    UNFUSED,
    DENSE_FAST,
    DENSE_FULL,
    DENSE_BEST,
    DENSE_VERGED,
    DEPTHS,
    OBJECTS,
    LOOK,
];

/// Those that run on two threads too.
pub(super) const ON_TWO: [&str; 4] = [VECTOR, NO_LOOK_BACK, DENSE_FAST, LOOK];
