//! stereo-formats
