//! stereo-scenes
