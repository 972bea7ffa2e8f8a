use std::collections::VecDeque;

use crate::word_table::{Word, WordTable};

/// A symmetric matrix of relation sets and the queue of pairs whose narrowing has not yet been
/// carried to the others.
///
/// The fixpoint of narrowing is one, whatever the order of the queue: every step replaces a set by
/// its intersection with a composition, compositions are monotone, and sets are finite.
#[derive(Clone, Debug)]
pub(crate) struct PathClosure<W> {
    count: usize,
    cells: Vec<W>,
    queue: VecDeque<(u32, u32)>,
    /// One bit for every cell: whether its pair waits in the queue.
    waiting: Vec<u64>,
}

/// One set that became smaller.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Narrowing {
    /// The pair, the smaller place first.
    pub(crate) pair: (u32, u32),
    /// The third place of the composition.
    pub(crate) through: u32,
    /// The set before.
    pub(crate) before: u32,
    /// The set after; zero is the contradiction.
    pub(crate) after: u32,
}

/// A pair for which nothing is left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clash;

impl<W: Word> PathClosure<W> {
    /// Every pair of so many places may be in any class; a place is at itself.
    pub(crate) fn universal(count: usize, all: u32) -> Self {
        let mut cells = vec![W::of_bits(all); count * count];
        for place in 0..count {
            // Zero is the distance to itself, and only the first class holds zero.
            cells[place * count + place] = W::of_bits(1);
        }
        Self {
            count,
            cells,
            queue: VecDeque::new(),
            waiting: vec![0; (count * count).div_ceil(64)],
        }
    }

    pub(crate) fn at(&self, i: usize, j: usize) -> u32 {
        self.cells[i * self.count + j].bits()
    }

    /// What the sets and the marks of the queue take, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.cells.as_slice()) + size_of_val(self.waiting.as_slice())
    }

    /// The pair of places, smaller first.
    fn pair(i: usize, j: usize) -> (u32, u32) {
        (i.min(j) as u32, i.max(j) as u32)
    }

    /// Puts a set in place, both ways.
    pub(crate) fn set(&mut self, i: usize, j: usize, bits: u32) {
        self.cells[i * self.count + j] = W::of_bits(bits);
        self.cells[j * self.count + i] = W::of_bits(bits);
    }

    /// Puts a set in place, to be carried to the others.
    pub(crate) fn impose(&mut self, i: usize, j: usize, bits: u32) {
        self.set(i, j, bits);
        self.enqueue(i, j);
    }

    fn enqueue(&mut self, i: usize, j: usize) {
        let (low, high) = Self::pair(i, j);
        let bit = low as usize * self.count + high as usize;
        let word = &mut self.waiting[bit / 64];
        if *word >> (bit % 64) & 1 == 0 {
            *word |= 1 << (bit % 64);
            self.queue.push_back((low, high));
        }
    }

    fn dequeue(&mut self) -> Option<(usize, usize)> {
        let (low, high) = self.queue.pop_front()?;
        let (low, high) = (low as usize, high as usize);
        let bit = low * self.count + high;
        self.waiting[bit / 64] &= !(1 << (bit % 64));
        Some((low, high))
    }

    /// Empties the queue without carrying anything further.
    pub(crate) fn abandon(&mut self) {
        while self.dequeue().is_some() {}
    }

    /// Carries every waiting narrowing to the others, until none waits.
    pub(crate) fn settle(
        &mut self,
        table: &WordTable,
        log: &mut Vec<Narrowing>,
    ) -> Result<(), Clash> {
        // Places whose set with i, or with j, a visit narrows; one buffer for all visits.
        let mut narrowed = Vec::new();
        while let Some((i, j)) = self.dequeue() {
            let row = W::row(table, self.cells[i * self.count + j]);
            for (from, to) in [(i, j), (j, i)] {
                self.sweep(from, to, &row, W::of_bits(table.all()), &mut narrowed);
                for (k, after) in narrowed.drain(..) {
                    log.push(Narrowing {
                        pair: Self::pair(from, k),
                        through: to as u32,
                        before: self.at(from, k),
                        after: W::bits(after),
                    });
                    self.set(from, k, after.bits());
                    if after.bits() == 0 {
                        return Err(Clash);
                    }
                    self.enqueue(from, k);
                }
            }
        }
        Ok(())
    }

    /// The places k whose set with `from` shrinks to its intersection with the composition
    /// through `to`.
    ///
    /// A network of sparse constraints is universal nearly everywhere, and whatever composes with
    /// everything gives everything; so eight universal sets in a row are passed over together.
    #[inline]
    fn sweep(
        &self,
        from: usize,
        to: usize,
        row: &W::Row<'_>,
        all: W,
        narrowed: &mut Vec<(usize, W)>,
    ) {
        let cells = |place: usize| &self.cells[place * self.count..][..self.count];
        let (ours, theirs) = (cells(from), cells(to));
        for (chunk, (ours, theirs)) in ours.chunks(8).zip(theirs.chunks(8)).enumerate() {
            if theirs.iter().all(|&set| set == all) {
                continue;
            }
            for (at, (&ours, &theirs)) in ours.iter().zip(theirs).enumerate() {
                let after = ours.bits() & W::compose(row, theirs).bits();
                if after != ours.bits() {
                    let k = 8 * chunk + at;
                    if k != from && k != to {
                        narrowed.push((k, W::of_bits(after)));
                    }
                }
            }
        }
    }
}
