use std::io::Read;

use dorsal::v1_gabor::Binocular;

use crate::bag::{Bag, BagMessage, NotABag};
use crate::cdr::NotCdr;
use crate::ros_image::image_stamp_ns;
use crate::stamp_pairs::{Side, StampPairs};

/// The stereo pairs of a bag, in the order of the file: messages of two topics, paired by the stamps in their headers.
#[derive(Debug)]
pub struct BagPairs<R> {
    bag: Bag<R>,
    left: String,
    pairs: StampPairs<BagMessage>,
    came: Binocular<u64>,
}

/// Why a bag gives no further pair.
#[derive(Debug, thiserror::Error)]
pub enum NoPair {
    /// The file is no bag, or no whole one.
    #[error(transparent)]
    Bag(#[from] NotABag),
    /// A message on one of the topics has no stamp.
    #[error("message {number} on {topic}, a {kind}")]
    Stamp {
        /// The topic.
        topic: String,
        /// Which of its messages, from 1 on.
        number: u64,
        /// Its type.
        kind: String,
        /// What is wrong with it.
        #[source]
        cause: NotCdr,
    },
}

impl<R: Read> BagPairs<R> {
    /// The pairs of these two topics whose stamps are at most `tolerance_ns` apart.
    pub fn new(source: R, topics: Binocular<&str>, tolerance_ns: u64) -> Self {
        Self {
            bag: Bag::new(source, [topics.left, topics.right]),
            left: topics.left.to_owned(),
            pairs: StampPairs::new(tolerance_ns),
            came: Binocular { left: 0, right: 0 },
        }
    }

    /// The bag, which knows the topics that were met so far.
    #[must_use]
    pub const fn bag(&self) -> &Bag<R> {
        &self.bag
    }

    /// How many messages of each eye came so far.
    #[must_use]
    pub const fn came(&self) -> Binocular<u64> {
        self.came
    }

    /// How many of them stayed alone ([`StampPairs::dropped`]).
    #[must_use]
    pub fn dropped(&self) -> Binocular<u64> {
        self.pairs.dropped()
    }

    fn advance(&mut self) -> Result<Option<(u64, Binocular<BagMessage>)>, NoPair> {
        for message in self.bag.by_ref() {
            let message = message?;
            let (side, number) = if *message.topic == *self.left {
                (Side::Left, &mut self.came.left)
            } else {
                (Side::Right, &mut self.came.right)
            };
            *number += 1;
            let stamp_ns = image_stamp_ns(&message.bytes).map_err(|cause| NoPair::Stamp {
                topic: message.topic.to_string(),
                number: *number,
                kind: message.kind.to_string(),
                cause,
            })?;
            if let Some(pair) = self.pairs.push(side, stamp_ns, message) {
                return Ok(Some(pair));
            }
        }
        Ok(None)
    }
}

impl<R: Read> Iterator for BagPairs<R> {
    /// The left eye's stamp in nanoseconds, and both messages.
    type Item = Result<(u64, Binocular<BagMessage>), NoPair>;

    fn next(&mut self) -> Option<Self::Item> {
        self.advance().transpose()
    }
}
