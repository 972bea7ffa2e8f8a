use dorsal_scan::ScanLook;

use crate::times::Times;

/// One look of a scan and what it took.
#[derive(Debug)]
pub(crate) struct ScanStep {
    pub(crate) look: ScanLook,
    pub(crate) times: Times,
}
