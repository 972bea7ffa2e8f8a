use std::fmt;

/// Words that cannot be understood: the command ends with exit code 2, as for arguments that the
/// parser refuses.
#[derive(Debug)]
pub(crate) struct WrongCall(pub(crate) String);

impl fmt::Display for WrongCall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; see --help", self.0)
    }
}

impl std::error::Error for WrongCall {}
