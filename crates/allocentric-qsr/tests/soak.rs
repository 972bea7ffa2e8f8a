//! A long life in a restless room.

mod room;
mod soak_life;

#[test]
fn a_long_life() {
    soak_life::soak(900, |_| {});
}
