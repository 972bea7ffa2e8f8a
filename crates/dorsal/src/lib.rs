//! dorsal
