use std::fmt;

/// The four atomic cases of Figure 2, by the points from which the two distances are measured.
///
/// Both premises are ternary: c is placed with respect to a and b (`c, ab`), and d with respect
/// to b and c (`d, bc`). A distance is measured either from the first or from the second point
/// of the pair that gives the direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Case {
    /// From the pairs' common line: |bc| and |cd| give |bd|.
    ///
    /// The paper's text calls the result `Dab` in one place; it is `Dbd`.
    One,
    /// |ac| and |cd| give |ad|.
    ///
    /// The paper's text calls the premises `Dbc` and `Dcd` in one place; the first is `Dac`.
    Two,
    /// |bc| and |bd| give |cd|. Seen from an observer at b this turns distances from the
    /// observer into a distance between two objects.
    Three,
    /// |ac| and |bd| share no point, so they give nothing, unless |ab| is known.
    Four,
}

impl Case {
    /// The number the paper gives it, 1 to 4.
    #[must_use]
    pub const fn number(self) -> u8 {
        self as u8 + 1
    }

    /// The case of this number, 1 to 4.
    #[must_use]
    pub const fn numbered(number: u8) -> Option<Self> {
        match number {
            1 => Some(Self::One),
            2 => Some(Self::Two),
            3 => Some(Self::Three),
            4 => Some(Self::Four),
            _ => None,
        }
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "CASE {}", self.number())
    }
}
