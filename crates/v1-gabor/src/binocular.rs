/// One value for each eye.
///
/// Two values of one kind never travel as two bare arguments: which eye is which stands in the
/// field's name, so they cannot be swapped by accident.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Binocular<T> {
    /// What belongs to the left eye, the reference.
    pub left: T,
    /// What belongs to the right eye.
    pub right: T,
}

impl<T> Binocular<T> {
    /// The same pair, borrowed.
    pub const fn as_ref(&self) -> Binocular<&T> {
        Binocular {
            left: &self.left,
            right: &self.right,
        }
    }

    /// Does the same to both eyes, the left one first.
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> Binocular<U> {
        Binocular {
            left: f(self.left),
            right: f(self.right),
        }
    }

    /// Does the same to both eyes, the left one first, and stops at the first failure.
    ///
    /// # Errors
    /// What `f` returns for the first eye on which it fails.
    pub fn try_map<U, E>(self, mut f: impl FnMut(T) -> Result<U, E>) -> Result<Binocular<U>, E> {
        Ok(Binocular {
            left: f(self.left)?,
            right: f(self.right)?,
        })
    }

    /// The pair with the eyes exchanged.
    #[must_use]
    pub fn swapped(self) -> Self {
        Self {
            left: self.right,
            right: self.left,
        }
    }
}
