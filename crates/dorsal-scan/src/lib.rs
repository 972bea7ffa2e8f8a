//! A head that scans a rendered room: fixation by fixation a map grows, and stands beside the truth.
//!
//! The head looks in turn at what is least known, and then at what is least sure ([`Why`]). Its
//! cameras are noisy, its lenses are not quite the calibrated ones, its encoders err, its right eye has
//! slipped in its mount ([`HeadErrors`]); every look corrects the rig by what it sees, and the memory
//! takes it in with the errors that are left. Half way one object is moved. [`Score`] holds the map
//! against the room, [`ask_all`] asks it what a robot would.
//!
//! ```no_run
//! use dorsal_scan::{Scan, ScanParams};
//! use stereo_scenes::Room;
//!
//! let mut scan = Scan::begin(Room::scan(), ScanParams::default())?;
//! while let Some(fixation) = scan.next() {
//!     let moved = scan.stir();
//!     let shown = scan.show(&fixation)?;
//!     let look = scan.perceive(shown, moved)?;
//!     println!("{}: {}", look.number, look.shown.fixation.why);
//! }
//! println!("{}", scan.score()?);
//! # Ok::<(), dorsal_scan::NoScan>(())
//! ```
//!
//! What is simulated ([`Scan::show`]) and what a robot does ([`Scan::perceive`]) are two steps, so that
//! a clock can stand beside either. Labels stand for the *what* stream, which this project does not
//! have: they are those of the rendered room.
mod asked;
mod attention;
mod chance;
mod field;
mod fixation;
mod footprint;
mod head_errors;
mod random_room;
mod relocation;
mod scan;
mod scan_look;
mod score;
mod true_places;

pub use asked::{Asked, HAND_AT_M, ask_all, figure_12, hand_way, knows_figure_12};
pub use field::Field;
pub use fixation::{Fixation, Why};
pub use head_errors::HeadErrors;
pub use random_room::random_room;
pub use relocation::Relocation;
pub use scan::{LAST_LOOKS, NoScan, Scan, ScanParams};
pub use scan_look::{ScanLook, Shown};
pub use score::{HAND_M, Off, Pairs, Score, Ways};
pub use true_places::{TruePlace, TruePlaces};
