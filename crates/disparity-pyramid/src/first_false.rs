/// Flags that are looked at together.
const BLOCK: usize = 32;

/// The first place that is not set. Where most are, blocks of them are passed over at once.
pub(crate) fn first_false(flags: &[bool]) -> Option<usize> {
    let all = |block: &&[bool; BLOCK]| block.iter().fold(true, |all, flag| all & flag);
    let (blocks, _) = flags.as_chunks::<BLOCK>();
    let start = BLOCK * blocks.iter().take_while(all).count();
    let place = flags[start..].iter().position(|flag| !flag)?;
    Some(start + place)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn it_is_the_first(length in 0usize..200, unset in prop::collection::vec(0usize..200, 0..3)) {
            let flags: Vec<bool> = (0..length).map(|i| !unset.contains(&i)).collect();
            prop_assert_eq!(first_false(&flags), flags.iter().position(|flag| !flag));
        }
    }
}
