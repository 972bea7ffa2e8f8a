use std::collections::VecDeque;

use dorsal::v1_gabor::Binocular;

/// Pairs what two cameras took at the same time, each with a stamp, and counts what stays alone.
///
/// Each eye's stamps rise. A message is paired with the one of the other eye whose stamp is nearest among
/// those that have come, at most the tolerance away; messages that are older than that can have no
/// partner any more.
#[derive(Debug)]
pub struct StampPairs<T> {
    tolerance_ns: u64,
    waiting: Binocular<VecDeque<(u64, T)>>,
    dropped: Binocular<u64>,
}

/// One of the two eyes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The left eye.
    Left,
    /// The right eye.
    Right,
}

/// How many messages of one eye wait at the most: of an eye whose partner is silent only the newest are
/// kept.
const MOST_WAITING: usize = 32;

impl<T> StampPairs<T> {
    /// Pairs of stamps at most `tolerance_ns` apart.
    #[must_use]
    pub fn new(tolerance_ns: u64) -> Self {
        Self {
            tolerance_ns,
            waiting: Binocular {
                left: VecDeque::new(),
                right: VecDeque::new(),
            },
            dropped: Binocular { left: 0, right: 0 },
        }
    }

    /// Takes a message; gives the pair that it completes, with the left eye's stamp.
    pub fn push(&mut self, side: Side, stamp_ns: u64, message: T) -> Option<(u64, Binocular<T>)> {
        let (own, own_dropped, other, other_dropped) = match side {
            Side::Left => (
                &mut self.waiting.left,
                &mut self.dropped.left,
                &mut self.waiting.right,
                &mut self.dropped.right,
            ),
            Side::Right => (
                &mut self.waiting.right,
                &mut self.dropped.right,
                &mut self.waiting.left,
                &mut self.dropped.left,
            ),
        };
        let apart = |(other_ns, _): &(u64, T)| other_ns.abs_diff(stamp_ns);
        let nearest = (0..other.len()).min_by_key(|&at| apart(&other[at]));
        if let Some(at) = nearest.filter(|&at| apart(&other[at]) <= self.tolerance_ns) {
            *other_dropped += at as u64;
            other.drain(..at);
            // What waited on this side is older, and its partners have just gone by.
            *own_dropped += own.len() as u64;
            own.clear();
            let (other_ns, other) = other.pop_front()?;
            return Some(match side {
                Side::Left => (
                    stamp_ns,
                    Binocular {
                        left: message,
                        right: other,
                    },
                ),
                Side::Right => (
                    other_ns,
                    Binocular {
                        left: other,
                        right: message,
                    },
                ),
            });
        }
        let too_old = other.partition_point(|(other_ns, _)| *other_ns < stamp_ns);
        *other_dropped += too_old as u64;
        other.drain(..too_old);
        if other.is_empty() {
            own.push_back((stamp_ns, message));
            if own.len() > MOST_WAITING {
                own.pop_front();
                *own_dropped += 1;
            }
        } else {
            // The other eye is ahead of it already.
            *own_dropped += 1;
        }
        None
    }

    /// How many messages of each eye stayed alone, with those that still wait.
    #[must_use]
    pub fn dropped(&self) -> Binocular<u64> {
        Binocular {
            left: self.dropped.left + self.waiting.left.len() as u64,
            right: self.dropped.right + self.waiting.right.len() as u64,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const PERIOD_NS: u64 = 33_000_000;

    proptest! {
        /// Whatever each eye misses and however its clock trembles, exactly the moments that both eyes
        /// took become pairs, and every message is in a pair or counted.
        #[test]
        fn what_both_eyes_took_is_paired(
            moments in prop::collection::vec((any::<bool>(), any::<bool>(), 0..5_000_000u64, 0..5_000_000u64), 0..40),
            late in 0..3usize,
        ) {
            let mut arrivals = Vec::new();
            for (moment, &(left, right, left_off, right_off)) in moments.iter().enumerate() {
                let stamp = moment as u64 * PERIOD_NS;
                if left {
                    arrivals.push((moment, Side::Left, stamp + left_off));
                }
                if right {
                    // The right eye's messages may come some frames late.
                    arrivals.push((moment + late, Side::Right, stamp + right_off));
                }
            }
            arrivals.sort_by_key(|&(when, side, _)| (when, side == Side::Right));
            let mut pairs = StampPairs::new(5_000_000);
            let mut found = Vec::new();
            let mut sent = 0;
            for (_, side, stamp) in arrivals {
                sent += 1;
                if let Some((_, pair)) = pairs.push(side, stamp, stamp / PERIOD_NS) {
                    prop_assert_eq!(pair.left, pair.right);
                    found.push(pair.left);
                }
            }
            let both: Vec<u64> = (0u64..)
                .zip(&moments)
                .filter(|(_, (left, right, _, _))| *left && *right)
                .map(|(moment, _)| moment)
                .collect();
            prop_assert_eq!(&found, &both);
            let dropped = pairs.dropped();
            prop_assert_eq!(dropped.left + dropped.right + 2 * both.len() as u64, sent);
        }
    }

    #[test]
    fn an_eye_without_a_partner_keeps_little() {
        let mut pairs = StampPairs::new(1);
        for stamp in 0..1000 {
            assert!(pairs.push(Side::Left, stamp * 10, ()).is_none());
        }
        assert_eq!(pairs.waiting.left.len(), MOST_WAITING);
        assert_eq!(pairs.dropped().left, 1000);
    }
}
