use crate::depth_reference::DepthReference;
use crate::{Case, DepthSet, Mode, compose};

/// Systems of so many classes have their sets in one byte, and the composition of every two sets
/// in one table.
const NARROW: usize = 8;

/// Systems of so many classes have their sets in two bytes.
const MIDDLE: usize = 16;

/// The sound composition of sets of distance classes, planned once as look-ups of whole sets.
///
/// A composition of sets is the union over their members, so a table of sets follows from the
/// table of classes, one lowest member at a time.
#[derive(Clone, Debug)]
pub(crate) struct WordTable {
    classes: usize,
    /// The composition of two classes, as bits, by first and second.
    base: Vec<u32>,
    /// The composition of two sets, by first and second; empty for systems of more classes.
    sets: Vec<u8>,
}

impl WordTable {
    pub(crate) fn plan(reference: &DepthReference) -> Self {
        let all = reference.all();
        let classes = all.len();
        let cell = |i, j| {
            compose(reference, Case::One, Mode::Sound, i, j)
                .depth
                .bits()
        };
        let base: Vec<u32> = all
            .iter()
            .flat_map(|i| all.iter().map(move |j| cell(DepthSet::from(i), j.into())))
            .collect();
        let mut table = Self {
            classes,
            base,
            sets: Vec::new(),
        };
        if table.is_narrow() {
            let size = 1 << classes;
            let mut sets = vec![0u8; size * size];
            for first in 0..size {
                for second in 1..size {
                    let rest = sets[first * size + (second & (second - 1))];
                    let lowest = second.trailing_zeros() as usize;
                    sets[first * size + second] = rest | table.against(first as u32, lowest) as u8;
                }
            }
            table.sets = sets;
        }
        table
    }

    /// Whether a set fits in a byte.
    pub(crate) const fn is_narrow(&self) -> bool {
        self.classes <= NARROW
    }

    /// Whether a set fits in two bytes.
    pub(crate) const fn is_middle(&self) -> bool {
        self.classes <= MIDDLE
    }

    /// Every class.
    pub(crate) fn all(&self) -> u32 {
        DepthSet::first(self.classes).bits()
    }

    /// A set with one class.
    fn against(&self, first: u32, second: usize) -> u32 {
        let members = (0..self.classes).filter(|class| first >> class & 1 == 1);
        members.fold(0, |sum, class| {
            sum | self.base[class * self.classes + second]
        })
    }
}

/// A set of distance classes in as many bits as the system needs.
pub(crate) trait Word: Copy + Eq + std::fmt::Debug {
    /// What one set composes to with every other.
    type Row<'t>;

    fn of_bits(bits: u32) -> Self;
    fn bits(self) -> u32;
    fn row(table: &WordTable, first: Self) -> Self::Row<'_>;
    fn compose(row: &Self::Row<'_>, second: Self) -> Self;
}

impl Word for u8 {
    type Row<'t> = &'t [Self];

    fn of_bits(bits: u32) -> Self {
        bits as Self
    }

    fn bits(self) -> u32 {
        self.into()
    }

    fn row(table: &WordTable, first: Self) -> &[Self] {
        let size = 1 << table.classes;
        &table.sets[usize::from(first) * size..][..size]
    }

    fn compose(row: &&[Self], second: Self) -> Self {
        row[usize::from(second)]
    }
}

impl Word for u16 {
    /// By byte of the second set, so that two look-ups serve 16 classes.
    type Row<'t> = Box<[[Self; 256]; 2]>;

    fn of_bits(bits: u32) -> Self {
        bits as Self
    }

    fn bits(self) -> u32 {
        self.into()
    }

    fn row(table: &WordTable, first: Self) -> Box<[[Self; 256]; 2]> {
        let mut row = Box::new([[0; 256]; 2]);
        for (byte, sums) in row.iter_mut().enumerate() {
            *sums = byte_sums(table, first.into(), byte).map(|sum| sum as Self);
        }
        row
    }

    fn compose(row: &Box<[[Self; 256]; 2]>, second: Self) -> Self {
        let [a, b] = second.to_le_bytes().map(usize::from);
        row[0][a] | row[1][b]
    }
}

impl Word for u32 {
    /// By byte of the second set, so that four look-ups serve 32 classes.
    type Row<'t> = Box<[[Self; 256]; 4]>;

    fn of_bits(bits: Self) -> Self {
        bits
    }

    fn bits(self) -> Self {
        self
    }

    fn row(table: &WordTable, first: Self) -> Box<[[Self; 256]; 4]> {
        let mut row = Box::new([[0; 256]; 4]);
        for (byte, sums) in row.iter_mut().enumerate() {
            *sums = byte_sums(table, first, byte);
        }
        row
    }

    fn compose(row: &Box<[[Self; 256]; 4]>, second: Self) -> Self {
        let [a, b, c, d] = second.to_le_bytes().map(usize::from);
        row[0][a] | row[1][b] | row[2][c] | row[3][d]
    }
}

/// What a set composes to with every set of the eight classes of one byte, one lowest member at a
/// time.
fn byte_sums(table: &WordTable, first: u32, byte: usize) -> [u32; 256] {
    let mut sums = [0; 256];
    for second in 1..256usize {
        let class = 8 * byte + second.trailing_zeros() as usize;
        let lowest = if class < table.classes {
            table.against(first, class)
        } else {
            0
        };
        sums[second] = sums[second & (second - 1)] | lowest;
    }
    sums
}
