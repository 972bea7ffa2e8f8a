use crate::SearchRange;
use crate::dense::padding::Padding;
use crate::dense::pixel_cost::LANES;
use crate::dense::wide::Wide;
use crate::dense::winner::{FIRST_PLACES, NO_SHIFT};

/// What the sums of one eye's row tell the pixels of the other eye's: the shift of the pixel that asks
/// least to lead there, counted from what the pixel's own best shift costs ([`OWN_SHARE`]).
///
/// Sums as they are favour what is easy to match: something behind a thin surface has texture around it
/// that lends it a low sum, though the other eye cannot see it there.
#[derive(Clone, Debug, Default)]
pub(crate) struct OtherEye {
    blocks: Vec<Block>,
    /// The least offer of all blocks.
    least: Vec<u8>,
    /// How the rows of the other eye are padded.
    padding: Padding,
}

/// What a block of shifts tells, pixel by pixel of a padded row: the least offer, and its shift's place
/// in the block. Places are counted within blocks of as many as a byte tells apart.
#[derive(Clone, Debug, Default)]
struct Block {
    least: Vec<u8>,
    place: Vec<u8>,
}

/// Places that are counted together: a vector that begins at any of them ends at one that a byte
/// still tells apart.
const BLOCK: usize = 256 - LANES;

/// Of what a pixel's own best shift costs, one part in so many counts where it tells the other eye. All
/// of it (1) loses thin surfaces, nothing of it what is behind others.
const OWN_SHARE: u8 = 5;

/// What does not count of the sums of a pixel whose least is this.
#[inline(always)]
const fn own(least: u8) -> u8 {
    least - least / OWN_SHARE
}

impl OtherEye {
    /// Makes room for a row.
    pub(crate) fn fit(&mut self, width: usize, search: SearchRange) {
        self.padding = Padding::of(search);
        let stride = self.padding.stride(width);
        let blocks = search.shifts().div_ceil(BLOCK);
        self.blocks.resize_with(blocks, Block::default);
        for block in &mut self.blocks {
            block.least.resize(stride, 0);
            block.place.resize(stride, 0);
        }
        self.least.resize(width, 0);
    }

    /// Before the first pixel of a row, where nothing has been told.
    pub(crate) fn begin(&mut self) {
        for block in &mut self.blocks {
            block.least.fill(NO_SHIFT);
        }
    }

    /// Offers the sums of pixel `x`, from the `first` shift on and `least` of all, to the pixels that its
    /// shifts lead to, and to the padding where they lead out of view.
    #[inline(always)]
    pub(crate) fn hear<W: Wide>(
        &mut self,
        wide: W,
        x: usize,
        first: usize,
        (sums, least): (&[[u8; LANES]], u8),
    ) {
        let seen_first = self.padding.first(x) + first;
        let (own, nothing) = (wide.splat(own(least)), wide.splat(NO_SHIFT));
        for (i, offer) in sums.iter().enumerate() {
            let place = first + i * LANES;
            // Mostly there is one block, and nothing to divide.
            let (block, within) = match place < BLOCK {
                true => (0, place),
                false => (place / BLOCK, place % BLOCK),
            };
            // Beyond the last shift nothing is offered.
            let Some(block) = self.blocks.get_mut(block) else {
                return;
            };
            let seen = seen_first + i * LANES..seen_first + (i + 1) * LANES;
            let ([least], [best]) = (
                block.least[seen.clone()].as_chunks_mut::<LANES>().0,
                block.place[seen].as_chunks_mut::<LANES>().0,
            ) else {
                return;
            };
            let places = wide.add(wide.load(&FIRST_PLACES), wide.splat(within as u8));
            let (sum, held) = (wide.load(offer), wide.load(least));
            // What is no shift asks for everything.
            let offer = wide.if_less(sum, nothing, wide.sub(sum, own), nothing);
            let chosen = wide.if_less(offer, held, places, wide.load(best));
            wide.store(chosen, best);
            wide.store(wide.min(offer, held), least);
        }
    }

    /// The shift that leads to each pixel with the least offer, NaN where none does.
    #[inline(always)]
    pub(crate) fn tell(&mut self, search: SearchRange, other_dx: &mut [f32]) {
        let width = other_dx.len();
        let start = self.padding.place(0);
        let held = &mut self.least[..width];
        held.fill(NO_SHIFT);
        other_dx.fill(f32::NAN);
        for (block, told) in self.blocks.iter().enumerate() {
            let first = (search.least_dx() + (block * BLOCK) as i32) as f32;
            let (sums, places) = (&told.least[start..][..width], &told.place[start..][..width]);
            for x in 0..width {
                let less = sums[x] < held[x];
                let dx = first + f32::from(places[x]);
                other_dx[x] = if less { dx } else { other_dx[x] };
                held[x] = if less { sums[x] } else { held[x] };
            }
        }
    }
}
