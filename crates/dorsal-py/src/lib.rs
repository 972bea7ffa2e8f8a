//! The Rust half of the Python package `dorsal`: arrays in, arrays and records out.
//!
//! Everything here is a door. Arrays become the planes of the levels, once and checked; the levels run without
//! Python's lock, on threads of this process; what they made is shown to NumPy without a copy, and what is a
//! record goes over as JSON, from which the package's Python half makes its plain objects. What a function means
//! is told where users read it, in `python/dorsal`.

mod concourse;
mod depth;
mod disparity;
mod eye;
mod eye_array;
mod field;
mod files;
mod look;
mod look_plan;
mod memory;
mod plane_store;
mod plane_view;
mod qsr;
mod recording;
mod refusal;
mod rig;
mod room;
mod scene_record;
mod shared;
mod threads;
mod v1;

use pyo3::prelude::*;

/// The native half of the package `dorsal`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::concourse::{Concourse, ask_together, contradictions_together};
    #[pymodule_export]
    use crate::depth::{Depth, locate, segment, triangulate};
    #[pymodule_export]
    use crate::disparity::flow;
    #[pymodule_export]
    use crate::eye::luma;
    #[pymodule_export]
    use crate::field::Field;
    #[pymodule_export]
    use crate::files::{read_labels, read_picture};
    #[pymodule_export]
    use crate::look::{Look, look};
    #[pymodule_export]
    use crate::memory::Memory;
    #[pymodule_export]
    use crate::qsr::{compose, composition_table, qualify, system};
    #[pymodule_export]
    use crate::recording::{Recording, rig_of_recording};
    #[pymodule_export]
    use crate::refusal::Refused;
    #[pymodule_export]
    use crate::rig::Rig;
    #[pymodule_export]
    use crate::room::Room;
    #[pymodule_export]
    use crate::shared::SharedMap;
    #[pymodule_export]
    use crate::threads::set_threads;
    #[pymodule_export]
    use crate::v1::respond;

    use super::{Bound, PyModule, PyModuleMethods, PyResult};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
